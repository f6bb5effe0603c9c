#!/usr/bin/env python3
"""Are there as many faces as target_faces asks for? Remeshes all meshes below the given folders without a target, and then
with each of three targets that is above that number of faces. Writes two Markdown tables to standard output: the shares of
the runs within a tenth of the target, after how many attempts, and the runs that are further away.

Exit code: 0; 2 for misuse. With --strict, 1 if fewer than 90 % of the runs are within a tenth.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

import tool
from tool import print_table, say

TARGETS = (2_000, 10_000, 50_000)
OFF = 0.1
CORPUS = [pathlib.Path("../shared/meshes") / folder for folder in ("planar-cad", "curved-cad", "curved", "polygons", "seed")]


def run(asked, mesh, folder, *options):
    """The faces of a result, and the attempts it took; None if there is no result."""
    command = [asked.remesh, str(mesh), "-o", f"{folder}/result.obj", "--trace", *asked.options, *options]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=asked.time_limit).stderr
    except subprocess.TimeoutExpired:
        return None
    found = re.search(r" in, ([\d,]+) out;", told)
    return (int(found.group(1).replace(",", "")), told.count("remesh: attempt ")) if found else None


def main(arguments):
    parser = tool.make_parser(__doc__, [])
    parser.add_argument("--strict", action="store_true", help="fail if fewer than 90 %% are within a tenth")
    parser.add_argument("paths", nargs="*", metavar="PATH", help="files or folders; by default the shared meshes")
    asked = tool.parse(parser, arguments, [], CORPUS)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for mesh in asked.files:
            say(str(mesh))
            before = run(asked, mesh, folder)
            for target in TARGETS:
                if before and before[0] < target and (after := run(asked, mesh, folder, f"--target-faces={target}")):
                    rows.append((mesh.name, target, before[0], *after))
    near = [row for row in rows if abs(row[3] / row[1] - 1) <= OFF]
    table = [["target", "runs", "within a tenth", "of these in one attempt"]]
    for target in TARGETS:
        of_target = [row for row in near if row[1] == target]
        table.append([f"{target:,}", str(sum(row[1] == target for row in rows)), str(len(of_target)),
                      str(sum(row[4] == 1 for row in of_target))])
    print_table(table)
    print()
    print_table([["mesh", "target", "without", "faces", "attempts"]] +
                [[row[0], *(f"{value:,}" for value in row[1:])] for row in rows if row not in near])
    return 1 if asked.strict and len(near) < 0.9 * len(rows) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
