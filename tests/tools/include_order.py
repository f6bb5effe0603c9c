"""Checks that includes between folders go down only, in the order of include_order.txt, and that the words of seams.txt
are used only in the files named there.

usage: include_order.py [ROOT]

Exit code: 0 - both hold; 1 - the includes that go up and the words in other files are listed.
"""

import os
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def read_order(path):
    with open(path, encoding="utf-8") as file:
        lines = [line.strip() for line in file]
    return [line for line in lines if line and not line.startswith("#")]


def place(order, path):
    """The position of the listed folder that a file belongs to; None where none is listed."""
    folder = os.path.dirname(path)
    while folder:
        if folder in order:
            return order.index(folder)
        folder = os.path.dirname(folder)
    return None


def sources(root, order):
    for top in sorted({folder.split("/")[0] for folder in order}):
        for folder, folders, names in os.walk(os.path.join(root, top)):
            folders[:] = sorted(f for f in folders if f != "node_modules")
            for name in sorted(names):
                if name.endswith((".h", ".cpp")):
                    yield os.path.relpath(os.path.join(folder, name), root)


def includes(root, path):
    """The line number and the path of each include of a header of the project."""
    with open(os.path.join(root, path), encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            found = INCLUDE.match(line)
            if found:
                yield number, found.group(1)


def find_faults(root, order):
    for path in sources(root, order):
        here = place(order, path)
        for number, header in includes(root, path):
            there = place(order, header)
            if not os.path.exists(os.path.join(root, header)):
                # Headers that the build writes stand for themselves.
                continue
            if there is None:
                yield f"{path}:{number}: {header} is in no folder of the list"
            elif there > here:
                yield f"{path}:{number}: {order[here]} must not include {header}, which stands above it"


def read_seams(path):
    """The words, each with the beginnings of the paths that may use it."""
    seams = {}
    for line in read_order(path):
        word, _, paths = line.partition(":")
        seams[word] = tuple(paths.split())
    return seams


def find_strangers(root, order, seams):
    words = re.compile(r"\b(" + "|".join(map(re.escape, seams)) + r")\b")
    for path in sources(root, order):
        if not path.startswith("core/"):
            continue
        with open(os.path.join(root, path), encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                code = line.split("//", 1)[0]
                for word in sorted(set(words.findall(code))):
                    if not path.startswith(seams[word]):
                        yield f"{path}:{number}: only {', '.join(seams[word])} may use {word} (tests/tools/seams.txt)"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else os.path.dirname(os.path.dirname(here))
    order = read_order(os.path.join(here, "include_order.txt"))
    faults = list(find_faults(root, order))
    faults += find_strangers(root, order, read_seams(os.path.join(here, "seams.txt")))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
