"""Checks what a script can see of plain English in comments and names.

usage: english.py [--count] [ROOT]

- No constant is called kMost or kLeast, since kMax and kMin are the usual words.
- No comment begins with a fragment: "What ...", "Whether ...", "That ...", "So many ...", or "Of ...", "Where ...",
  "When ...", "As ...", "With ...", "Without ..." without a comma behind which the main clause could follow.
- No member is documented by a preposition and a pronoun alone, as in "of both".
- No suite of tests has a capital letter in its name.

Exit code: 0 - nothing was found; 1 - what was found is listed. --count prints only how much that is in each folder.
"""

import collections
import os
import re
import sys

TOPS = ("core", "api", "server", "tests")
NAME = re.compile(r"\bk(Most|Least)[A-Z]\w*")
ALWAYS = re.compile(r"^(What|Whether|That|So (many|much|far)) ")
WITHOUT_CLAUSE = re.compile(r"^(Of|Where|When|As|With|Without) [^,:?]*?([.;]|$)")
SUITE = re.compile(r"^(TEST|TEST_F|TEST_P)\((\w*[A-Z]\w*)")
LABEL = re.compile(r"^(Input|Output|Holds|Errors|Cost|Source|Returns|usage):")
PREPOSITION = re.compile(r"///< (of|in|by|at|from|to|with|for|on|as|than) (it|them|both|these|those|that|this|all|each|one|any|anything|the \w+)[.;]?$")


def sources(root):
    for top in TOPS:
        for folder, folders, names in os.walk(os.path.join(root, top)):
            folders[:] = sorted(f for f in folders if f not in ("node_modules", "build"))
            for name in sorted(names):
                if name.endswith((".h", ".cpp")):
                    yield os.path.relpath(os.path.join(folder, name), root)


def comment_blocks(lines):
    """The first line's number and the text of each comment that stands on lines of its own."""
    begin, text = 0, []
    for number, line in enumerate(lines, 1):
        stripped = line.strip()
        if stripped.startswith("//"):
            words = stripped.lstrip("/").strip()
            if text and LABEL.match(words):
                yield begin, " ".join(text)
                text = []
            if LABEL.match(words):
                continue
            if not text:
                begin = number
            text.append(words)
        elif text:
            yield begin, " ".join(text)
            text = []
    if text:
        yield begin, " ".join(text)


def find_faults(root):
    for path in sources(root):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            lines = file.read().split("\n")
        for number, line in enumerate(lines, 1):
            for name in NAME.finditer(line):
                yield path, number, f"the name {name.group()} has kMax or kMin for its usual word"
            suite = SUITE.match(line)
            if suite:
                yield path, number, f"the suite {suite.group(2)} has capital letters; the others are in snake_case"
            if PREPOSITION.search(line):
                yield path, number, "a preposition alone says little: " + line.split("///<")[1].strip()
        for number, text in comment_blocks(lines):
            if ALWAYS.match(text) or WITHOUT_CLAUSE.match(text):
                yield path, number, "the comment begins with a fragment: " + text[:70]


def main():
    arguments = [a for a in sys.argv[1:] if a != "--count"]
    root = os.path.abspath(arguments[0]) if arguments else os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    faults = list(find_faults(root))
    if "--count" in sys.argv:
        counts = collections.Counter("/".join(path.split("/")[:2]) for path, _, _ in faults)
        for folder, count in sorted(counts.items()):
            print(f"{count:5} {folder}")
        return 0
    for path, number, text in faults:
        print(f"{path}:{number}: {text}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
