"""Checks that no class of the core is larger than one person can keep in mind.

usage: class_sizes.py [--all] [ROOT]

A class has at most 15 data members and 350 lines. Its lines are those of its definition and of the functions that are
defined outside of it, in all files; blank lines and comments within them count, too. A class may be larger if the
comment above it says why, in a sentence that begins with "This class is larger than the bound because".
Static members do not count as data members. The members of a class inside another one count for the inner class alone.
Its lines count for both classes, unless it is only declared there and defined elsewhere.

Exit code: 0 - no class is too large; 1 - those that are too large are listed. --all prints the size of every class.
"""

import os
import re
import sys
import tempfile

TOP = "core"
MAX_MEMBERS = 15
MAX_LINES = 350
EXCUSE = "This class is larger than the bound because "

# Comments, literals and preprocessor lines hide braces from whoever counts them.
HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:\\\n|[^\n])*',
                    re.DOTALL | re.MULTILINE)
DIGIT_SEPARATOR = re.compile(r"(?<=[0-9a-fA-F])'(?=[0-9a-fA-F])")
TOKEN = re.compile(r"[A-Za-z_]\w*|::|->|<<=|[0-9][\w.]*|\S")
NOT_MEMBERS = {"using", "typedef", "friend", "static_assert", "template", "static", "operator", "extern"}
ACCESS = {"public", "protected", "private"}


class Token:
    def __init__(self, text, line):
        self.text, self.line = text, line


class Class:
    def __init__(self, path, name, first_line):
        self.path, self.name, self.first_line = path, name, first_line
        self.lines = 0
        self.members = 0


def tokens_of(text):
    text = DIGIT_SEPARATOR.sub("_", text)
    plain = HIDDEN.sub(lambda match: re.sub(r"[^\n]", " ", match.group(0)), text)
    line, at = 1, 0
    for match in TOKEN.finditer(plain):
        line += plain.count("\n", at, match.start())
        at = match.start()
        yield Token(match.group(0), line)


def without_template(head):
    """The words of a declaration without `template <...>` and access specifiers before it."""
    words = [token.text for token in head]
    while words:
        if words[0] in ACCESS and words[1:2] == [":"]:
            words = words[2:]
        elif words[0] == "template":
            depth, end = 0, 1
            while end < len(words):
                depth += {"<": 1, ">": -1}.get(words[end], 0)
                end += 1
                if depth == 0:
                    break
            words = words[end:]
        else:
            break
    return words


def outside_of_angles(words):
    """The words with "<...>" and "(...)" taken out; "(" itself stays."""
    out, angles, parentheses = [], 0, 0
    for word in words:
        if word == ")":
            parentheses -= 1
        elif word == ">" and angles > 0 and parentheses == 0:
            angles -= 1
        elif angles == 0 and parentheses == 0 and word != "<":
            out.append(word)
        if word == "(":
            parentheses += 1
        elif word == "<" and parentheses == 0:
            angles += 1
    return out


def class_name(words):
    """The name of the class that a declaration defines, such as ["Outer", "Inner"]; None if it defines none."""
    if not words or words[0] not in ("class", "struct", "union"):
        return None
    name = []
    for word in words[1:]:
        if word == "::":
            continue
        if not re.match(r"[A-Za-z_]", word) or word == "final":
            break
        name.append(word)
    return name


def function_owner(words):
    """The names before the function's own in a definition such as `void Outer::Inner::f()`."""
    words = outside_of_angles(words)
    if "(" not in words:
        return []
    at = words.index("(") - 1
    if "operator" in words[:at + 1]:
        at = words.index("operator")
    if at > 0 and words[at - 1] == "~":
        at -= 1
    owner = []
    while at >= 2 and words[at - 1] == "::" and re.match(r"[A-Za-z_]", words[at - 2]):
        owner.insert(0, words[at - 2])
        at -= 2
    return owner


def count_members(head):
    """The number of data members that a declaration in a class makes."""
    words = without_template(head)
    if not words or NOT_MEMBERS & set(words):
        return 0
    if words[0] in ("class", "struct", "union", "enum") and len(words) <= 2 + words.count("::") * 2 + words.count("class"):
        return 0
    plain = outside_of_angles(words)
    first = plain[:plain.index("=")] if "=" in plain else plain
    if "(" in first:
        return 0
    return plain.count(",") + 1


class Reader:
    """Finds the classes of one file, and the functions of classes that are defined outside of them."""

    def __init__(self, path, text):
        self.path = path
        self.classes = []
        self.functions = []  # (names before the function's own, lines)
        self.tokens = list(tokens_of(text))
        self.read()

    def skip_braces(self, at):
        """The index behind the brace that closes the one at `at`."""
        depth = 0
        while at < len(self.tokens):
            depth += {"{": 1, "}": -1}.get(self.tokens[at].text, 0)
            at += 1
            if depth == 0:
                break
        return at

    def read(self):
        # An entry is a class, or None for a namespace.
        scopes, head, at = [], [], 0
        while at < len(self.tokens):
            token = self.tokens[at]
            owner = scopes[-1] if scopes else None
            if token.text == ";":
                if owner is not None:
                    owner.members += count_members(head)
                head, at = [], at + 1
            elif token.text == "}":
                if scopes:
                    closed = scopes.pop()
                    if closed is not None:
                        closed.lines += token.line - closed.first_line + 1
                head, at = [], at + 1
            elif token.text == "{":
                words = without_template(head)
                name = class_name(words)
                if words[:1] == ["namespace"] or words[:2] in (["inline", "namespace"], ["extern", "C"]):
                    scopes.append(None)
                    head, at = [], at + 1
                elif name:
                    outer = [owner.name] if owner is not None else []
                    made = Class(self.path, "::".join(outer + name), head[0].line)
                    self.classes.append(made)
                    scopes.append(made)
                    head, at = [], at + 1
                else:
                    end = self.skip_braces(at)
                    if words[:1] == ["enum"]:
                        head = []
                    elif "(" in outside_of_angles(words) and "=" not in outside_of_angles(words):
                        # The name of an operator is no initialiser.
                        if owner is None and function_owner(words):
                            lines = self.tokens[end - 1].line - head[0].line + 1
                            self.functions.append((function_owner(words), lines))
                        head = []
                    at = end
            else:
                head.append(token)
                at += 1


def sources(root):
    for folder, folders, names in os.walk(os.path.join(root, TOP)):
        folders.sort()
        for name in sorted(names):
            if name.endswith((".h", ".cpp")):
                yield os.path.relpath(os.path.join(folder, name), root)


def read_text(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


def find_classes(root):
    readers = [Reader(path, read_text(root, path)) for path in sources(root)]
    shared = {}
    for reader in readers:
        if reader.path.endswith(".h"):
            for each in reader.classes:
                shared.setdefault(each.name, each)
    for reader in readers:
        own = {each.name: each for each in reader.classes}
        for owner, lines in reader.functions:
            for begin in range(len(owner)):
                name = "::".join(owner[begin:])
                found = own.get(name) or shared.get(name)
                if found is not None:
                    found.lines += lines
                    break
    return [each for reader in readers for each in reader.classes]


def comment_above(root, each):
    lines = read_text(root, each.path).split("\n")
    text, at = [], each.first_line - 2
    while at >= 0 and lines[at].strip().startswith("//"):
        text.insert(0, lines[at].strip().lstrip("/").strip())
        at -= 1
    return " ".join(text)


def find_faults(root):
    for each in find_classes(root):
        if each.members <= MAX_MEMBERS and each.lines <= MAX_LINES:
            continue
        if EXCUSE not in comment_above(root, each):
            yield (f"{each.path}:{each.first_line}: {each.name} has {each.members} data members and {each.lines} lines; "
                   f"at most {MAX_MEMBERS} and {MAX_LINES} are usual, and the comment above it does not say why it has more")


def check_itself():
    """The test counts the classes of a small tree as a reader would."""
    header = """
/// A comment with a brace { in it.
class Outer : public Base<int, 2> {
 public:
  explicit Outer(int a) : a_(a), b_{a} {}
  struct Inner {
    int x = 0, y = 0;
    std::function<void(int)> call;
  };
  enum class Kind { kOne, kTwo } kind = Kind::kOne;
  int f() const;
  bool operator<(const Outer& other) const { return a_ < other.a_; }
  template <class T>
  void g(T t);

 private:
  struct Hidden;
  static constexpr int kNone = 0;
  friend class Other;
  using Map = std::map<int, Inner>;
  int a_, b_;
  std::map<int, std::pair<int, int>> c_;
  std::vector<int> d_ = {1, 2}, e_{3};
  const char* text_ = "};";
};
"""
    source = """
struct Outer::Hidden {
  int h;
};
namespace {
int Outer::f() const {
  return 0;
}
int free(int a) { return a; }
}
"""
    many = "".join(f"  int m{i}_;\n" for i in range(MAX_MEMBERS + 1))
    excuse = f"/// A class.\n/// {EXCUSE}it must be.\n"
    with tempfile.TemporaryDirectory() as root:
        os.mkdir(os.path.join(root, TOP))
        files = {"a.h": header, "a.cpp": source, "b.h": f"class Many {{\n{many}}};\n{excuse}class Excused {{\n{many}}};\n"}
        for name, text in files.items():
            with open(os.path.join(root, TOP, name), "w", encoding="utf-8") as file:
                file.write(text)
        found = {each.name: (each.members, each.lines) for each in find_classes(root)}
        faults = list(find_faults(root))
    expected = {"Outer": (7, 23 + 3), "Outer::Inner": (3, 4), "Outer::Hidden": (1, 3), "Many": (16, 18), "Excused": (16, 18)}
    if found != expected or len(faults) != 1 or "Many" not in faults[0]:
        raise AssertionError(f"the test does not count as it should: {found}, {faults}")


def main():
    check_itself()
    arguments = [a for a in sys.argv[1:] if a != "--all"]
    here = os.path.dirname(os.path.abspath(__file__))
    root = os.path.abspath(arguments[0]) if arguments else os.path.dirname(os.path.dirname(here))
    if "--all" in sys.argv:
        for each in sorted(find_classes(root), key=lambda each: -each.lines):
            print(f"{each.members:4} members {each.lines:5} lines  {each.name}  {each.path}")
        return 0
    faults = list(find_faults(root))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
