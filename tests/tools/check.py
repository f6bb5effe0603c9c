"""Checks the sources and documents as text, without a build.

usage: check.py [CHECK]...

The checks are these; without a name all are made.
- links: each relative link of a Markdown file names a file or a folder, and an anchor behind `#` is that of a heading of
  that file. A source or another Markdown file that says `rules.md, NAME` names one of the rules of core/rules.md, without
  its number, and one that says `experiments.md, NAME` one of the headings of core/experiments.md. Links to other servers
  are not followed.
- english: no constant is called kMost or kLeast, since kMax and kMin are the usual words. No comment begins with a
  fragment: "What ...", "Whether ...", "That ...", "So many ...", or "Of ...", "Where ...", "When ...", "As ...",
  "With ...", "Without ..." without a comma behind which the main clause could follow. No member is documented by a
  preposition and a pronoun alone, as in "of both". No suite of tests has a capital letter in its name.
- include_order: includes between folders go down only, in the order of include_order.txt, and the words of seams.txt are
  used only in the files named there.
- include_shape: in the core, with x.h and x.cpp as one room, there are at most so many circles (rooms that include each
  other, however indirectly) as MAX_CIRCLES says; no chain of includes is longer than MAX_DEPTH files; and no folder has
  more than MAX_FILES sources. The circles and the longest chain are printed.
- class_sizes: a class of the core has at most 15 data members and 350 lines, unless the comment above it says why, in a
  sentence that begins with "This class is larger than the bound because". The lines are those of the definition and of
  the functions that are defined outside of it, with blank lines and comments. Static members do not count, and the
  members of a class inside another one count for the inner class alone.

Exit code: 0 - nothing was found; 1 - what was found is listed.
"""

import os
import pathlib
import re
import sys
import tempfile
import urllib.parse

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SKIPPED_FOLDERS = {"build", "node_modules", "__pycache__"}
CODE = (".h", ".cpp")


def files(root, endings, tops=("",)):
    for top in tops:
        for folder, folders, names in os.walk(os.path.join(root, top)):
            folders[:] = sorted(f for f in folders if f not in SKIPPED_FOLDERS and not f.startswith("."))
            for name in sorted(names):
                if name.endswith(endings):
                    yield os.path.relpath(os.path.join(folder, name), root)


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


# Links and citations.

# The cited documents, what may be cited in them, and how a heading is told from others.
CITED = {"core/rules.md": ("rule", re.compile(r"\d+\.\s+(.*)")), "core/experiments.md": ("experiment", re.compile(r"(.*)"))}
LINKS = [re.compile(pattern, re.MULTILINE) for pattern in (
    r"!?\[(?:[^\[\]]|\[[^\]]*\]\([^)]*\))*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)",
    r"\[[^\[\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)",
    r"^\s{0,3}\[[^\]]+\]:\s+<?(\S+?)>?(?:\s|$)",
    r"<(?:a|img)\b[^>]*\b(?:href|src)=\"([^\"]+)\"",
)]
FENCED = re.compile(r"^\s*(```|~~~)[^\n]*\n.*?(?:^\s*\1[^\n]*$|\Z)", re.DOTALL | re.MULTILINE)
CODE_SPAN = re.compile(r"(`+)(.+?)\1")
# A name begins with a capital letter and ends before the end of the sentence or the list.
CITATION = re.compile(r"\b(rules|experiments)\.md, (?!NAME\b)([A-Z][a-z-]+(?: [a-z-]+)*)")


def without_code_blocks(text):
    """The text with the lines of fenced blocks empty, so that line numbers stay."""
    return FENCED.sub(lambda block: "\n" * block.group(0).count("\n"), text)


def headings(text):
    return re.findall(r"^#{1,6}\s+(.*?)\s*#*\s*$", without_code_blocks(text), re.MULTILINE)


def anchors(text):
    """The anchors of the headings, as GitHub makes them: a heading that is there twice gets a number."""
    found = set()
    for heading in headings(text):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", CODE_SPAN.sub(r"\2", heading))
        anchor = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        candidate, count = anchor, 0
        while candidate in found:
            count += 1
            candidate = f"{anchor}-{count}"
        found.add(candidate)
    return found


def links(text):
    """The line number and the target of each link that is not in code."""
    plain = CODE_SPAN.sub(lambda span: " " * len(span.group(0)), without_code_blocks(text))
    found = {match.start(1): match.group(1) for pattern in LINKS for match in pattern.finditer(plain)}
    return [(plain.count("\n", 0, at) + 1, target) for at, target in sorted(found.items())]


def link_faults(root):
    for path in files(root, (".md",)):
        for number, target in links(read(root, path)):
            if re.match(r"[a-zA-Z][a-zA-Z0-9+.\-]*:|//", target):
                continue
            name, _, anchor = urllib.parse.unquote(target).partition("#")
            there = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
            if there.startswith("..") or name.startswith("/"):
                yield f"{path}:{number}: {target} leaves the repository"
            elif not os.path.exists(os.path.join(root, there)):
                yield f"{path}:{number}: there is no {there}"
            elif anchor and not (there.endswith(".md") and anchor in anchors(read(root, there))):
                yield f"{path}:{number}: {there} has no heading for #{anchor}"
    yield from citation_faults(root)


def citation_faults(root):
    cited = {}
    for document, (kind, form) in CITED.items():
        found = [form.match(heading) for heading in headings(read(root, document))]
        cited[os.path.basename(document)] = (document, kind, {match.group(1) for match in found if match})
    for path in files(root, CODE + (".ts", ".mjs", ".py", ".sh", ".txt", ".yaml", ".md")):
        if path in ("tests/tools/check.py", "tests/tools/check_test.py"):
            continue
        # A citation may go on in the next line of a comment.
        joined = re.sub(r"\n\s*(?://+|#)\s*", " ", read(root, path))
        for match in CITATION.finditer(joined):
            document, kind, names = cited[f"{match.group(1)}.md"]
            if path != document and match.group(2) not in names:
                yield f"{path}: {document} has no {kind} \"{match.group(2)}\""


# Plain English.

NAME = re.compile(r"\bk(Most|Least)[A-Z]\w*")
FRAGMENT = re.compile(r"^(What|Whether|That|So (many|much|far)) |^(Of|Where|When|As|With|Without) [^,:?]*?([.;]|$)")
SUITE = re.compile(r"^(TEST|TEST_F|TEST_P)\((\w*[A-Z]\w*)")
LABEL = re.compile(r"^(Input|Output|Holds|Errors|Cost|Source|Returns|usage):")
PREPOSITION = re.compile(r"///< (of|in|by|at|from|to|with|for|on|as|than) "
                         r"(it|them|both|these|those|that|this|all|each|one|any|anything|the \w+)[.;]?$")


def comment_blocks(lines):
    """The first line's number and the text of each comment that stands on lines of its own."""
    begin, text = 0, []
    for number, line in enumerate([*lines, ""], 1):
        is_comment = line.strip().startswith("//")
        words = line.strip().lstrip("/").strip()
        if text and (not is_comment or LABEL.match(words)):
            yield begin, " ".join(text)
            text = []
        if is_comment and not LABEL.match(words):
            begin = begin if text else number
            text.append(words)


def english_faults(root):
    for path in files(root, CODE, ("core", "api", "server", "tests")):
        lines = read(root, path).split("\n")
        for number, line in enumerate(lines, 1):
            for name in NAME.finditer(line):
                yield f"{path}:{number}: the name {name.group()} has kMax or kMin for its usual word"
            if suite := SUITE.match(line):
                yield f"{path}:{number}: the suite {suite.group(2)} has capital letters; the others are in snake_case"
            if PREPOSITION.search(line):
                yield f"{path}:{number}: a preposition alone says little: {line.split('///<')[1].strip()}"
        for number, text in comment_blocks(lines):
            if FRAGMENT.match(text):
                yield f"{path}:{number}: the comment begins with a fragment: {text[:70]}"


# The order of the folders, and the seams.

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def entries(name):
    """The lines of a list beside this file."""
    lines = [line.strip() for line in read(HERE, name).split("\n")]
    return [line for line in lines if line and not line.startswith("#")]


def place(order, path):
    """The position of the listed folder that a file belongs to; None where none is listed."""
    folder = os.path.dirname(path)
    while folder:
        if folder in order:
            return order.index(folder)
        folder = os.path.dirname(folder)
    return None


def includes(root, order):
    """The path, the line number and the header of each include of a header of the project."""
    for path in files(root, CODE, sorted({folder.split("/")[0] for folder in order})):
        text = read(root, path)
        for found in INCLUDE.finditer(text):
            # Headers that the build writes stand for themselves.
            if os.path.exists(os.path.join(root, found.group(1))):
                yield path, text.count("\n", 0, found.start(1)) + 1, found.group(1)


def include_faults(root):
    order = entries("include_order.txt")
    for path, number, header in includes(root, order):
        here, there = place(order, path), place(order, header)
        if there is None:
            yield f"{path}:{number}: {header} is in no folder of the list"
        elif there > here:
            yield f"{path}:{number}: {order[here]} must not include {header}, which stands above it"
    seams = {word: tuple(paths.split()) for word, _, paths in (line.partition(":") for line in entries("seams.txt"))}
    words = re.compile(r"\b(" + "|".join(map(re.escape, seams)) + r")\b")
    for path in files(root, CODE, ("core",)):
        for number, line in enumerate(read(root, path).split("\n"), 1):
            for word in sorted(set(words.findall(line.split("//", 1)[0]))):
                if not path.startswith(seams[word]):
                    yield f"{path}:{number}: only {', '.join(seams[word])} may use {word} (tests/tools/seams.txt)"


# Circles, the longest chain of includes, and large folders.

MAX_CIRCLES, MAX_DEPTH, MAX_FILES = 1, 18, 40


def find_circles(graph):
    """The groups of more than one room that reach each other."""
    def reach(start):
        found, waiting = {start}, [start]
        while waiting:
            new = graph[waiting.pop()] - found
            found |= new
            waiting += new
        return found

    reached = {room: reach(room) for room in graph}
    circles = {frozenset(other for other in reached[room] if room in reached[other]) for room in graph}
    return sorted(sorted(circle) for circle in circles if len(circle) > 1)


def include_shape(root):
    """The circles of rooms of the core, and the longest chain of includes, from its top to its bottom."""
    included = {path: set() for path in files(root, CODE, ("core",))}
    for path, _, header in includes(root, ["core"]):
        included[path].add(header)
    graph = {}
    for path, headers in included.items():
        graph.setdefault(os.path.splitext(path)[0], set()).update(os.path.splitext(header)[0] for header in headers)
    longest = {}

    def chain(path):
        if path not in longest:
            longest[path] = []  # headers that include each other end here; the guard ends them in the compiler, too
            longest[path] = [path, *max((chain(header) for header in sorted(included[path])), key=len, default=[])]
        return longest[path]

    return find_circles(graph), max(map(chain, included), key=len, default=[])


def include_shape_faults(root):
    circles, longest = include_shape(root)
    if len(circles) > MAX_CIRCLES:
        for circle in circles:
            yield f"core: {len(circles)} circles, at most {MAX_CIRCLES} may be: {', '.join(circle)}"
    if len(longest) > MAX_DEPTH:
        yield f"core: includes go {len(longest)} files deep, at most {MAX_DEPTH} may be: {', '.join(longest)}"
    folders = [os.path.dirname(path) for path in files(root, CODE, ("core",))]
    for folder in sorted(set(folders)):
        if folders.count(folder) > MAX_FILES:
            yield f"{folder}: {folders.count(folder)} files, at most {MAX_FILES} may be; sub-folders make them findable"


def print_include_shape(root):
    circles, longest = include_shape(root)
    print(f"core: circles of rooms: {len(circles)}; includes go {len(longest)} files deep, below {longest[0]}")
    for circle in circles:
        print(f"  circle: {', '.join(circle)}")


# The sizes of classes. What clang-format leaves in one form only is read by its indentation.

MAX_MEMBERS, MAX_LINES = 15, 350
EXCUSE = "This class is larger than the bound because "
CLASS = re.compile(r"^( *)(?:class|struct|union) (?:\[\[\w+\]\] )?([A-Za-z_][\w:]*)(?:<.*>)?(?: final)?(?: : [^;]*)?( \{|$)")
FUNCTION = re.compile(r"^(?=\S).*?\b(\w+(?:::\w+)*)(?:<[\w, ]+>)?::(?:~?\w+|operator[^(]*)\(")
NO_MEMBER = re.compile(r"^(using|typedef|friend|static_assert|template|static|extern|enum|class|struct|union|public|protected|private)\b|"
                       r"\boperator\b")
BRACKETS = re.compile(r"\([^()]*\)|\{[^{}]*\}|<[^<>]*>|\[[^\[\]]*\]")


class Class:
    def __init__(self, path, name, line):
        self.path, self.name, self.line, self.lines, self.members = path, name, line, 0, 0


def count_members(declaration):
    """The number of data members that a declaration in a class makes."""
    plain = re.sub(r'"(?:\\.|[^"\\])*"', "", declaration).replace("->", "").replace("<=", "")
    if NO_MEMBER.search(plain):
        return 0
    longer = ""
    while longer != plain:
        longer, plain = plain, BRACKETS.sub(lambda found: "@" if found.group(0)[0] == "(" else "", plain)
    return 0 if "@" in plain.split("=")[0] else plain.count(",") + 1


def read_classes(path, text):
    """The classes of a file, and the functions of classes that are defined outside: their owner's name, and lines."""
    lines = re.sub(r"//[^\n]*", "", text).split("\n")
    classes, functions, scopes, statement, number = [], [], [], "", 0

    def end_of(begin, depth):
        """The index of the line with the brace that closes what begins in a line."""
        return next(i for i in range(begin, len(lines)) if lines[i].startswith(" " * depth + "}"))

    while number < len(lines):
        line = lines[number].rstrip()
        number += 1
        depth = len(line) - len(line.lstrip())
        inside = scopes[-1][1] + 2 if scopes else 0
        if scopes and line.startswith(" " * (inside - 2) + "}"):
            made = scopes.pop()[0]
            made.lines += number - made.line + 1
            statement = ""
        elif depth == inside and not statement and (found := CLASS.match(line)) and not line.endswith((";", "}")):
            outer = [scopes[-1][0].name] if scopes else []
            first = number - 1 if lines[number - 2].lstrip().startswith("template") else number
            classes.append(Class(path, "::".join([*outer, found.group(2)]), first))
            scopes.append((classes[-1], depth))
            while not lines[number - 1].rstrip().endswith("{"):
                number += 1
        elif not scopes:
            if depth == 0 and (found := FUNCTION.match(line)) and not line.endswith(";"):
                first = number - 1 if lines[number - 2].startswith("template") else number
                if not line.endswith("}"):
                    number = end_of(number, 0) + 1
                functions.append((found.group(1).split("::"), number - first + 1))
        elif line.strip() and (statement or depth == inside) and not re.match(r" *template <.*>$", line):
            statement += line.strip() + " "
            if line.endswith("{") and ("(" in statement or statement.startswith("enum")):
                number = end_of(number, inside) + 1
                line = lines[number - 1].rstrip()
                statement += "}" + line.strip()
            if line.endswith(";"):
                scopes[-1][0].members += count_members(statement.strip()[:-1])
            if line.endswith((";", "}")):
                statement = ""
    return classes, functions


def find_classes(root):
    found = {path: read_classes(path, read(root, path)) for path in files(root, CODE, ("core",))}
    shared = {}
    for path, (classes, _) in found.items():
        if path.endswith(".h"):
            for each in classes:
                shared.setdefault(each.name, each)
    for classes, functions in found.values():
        own = {**shared, **{each.name: each for each in classes}}
        for owner, lines in functions:
            names = ["::".join(owner[begin:]) for begin in range(len(owner))]
            for name in [name for name in names if name in own][:1]:
                own[name].lines += lines
    return [each for classes, _ in found.values() for each in classes]


def class_faults(root):
    for each in find_classes(root):
        if each.members <= MAX_MEMBERS and each.lines <= MAX_LINES:
            continue
        above = "\n".join(read(root, each.path).split("\n")[:each.line - 1])
        comment = re.sub(r"\s*\n\s*///?\s*", " ", re.search(r"(?:\n[ \t]*//[^\n]*)*$", above).group(0))
        if EXCUSE not in comment:
            yield (f"{each.path}:{each.line}: {each.name} has {each.members} data members and {each.lines} lines; "
                   f"at most {MAX_MEMBERS} and {MAX_LINES} are usual, and the comment above it does not say why it has more")


CHECKS = {"links": link_faults, "english": english_faults, "include_order": include_faults,
          "include_shape": include_shape_faults, "class_sizes": class_faults}


def main():
    unknown = set(sys.argv[1:]) - set(CHECKS)
    if unknown:
        sys.exit(f"check.py: there is no check {min(unknown)}; the checks are {', '.join(CHECKS)}")
    faults = [fault for name in sys.argv[1:] or CHECKS for fault in CHECKS[name](ROOT)]
    for fault in faults:
        print(fault)
    if "include_shape" in (sys.argv[1:] or CHECKS):
        print_include_shape(ROOT)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
