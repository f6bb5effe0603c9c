#!/usr/bin/env python3
"""Are there as many faces as target_faces asks for? Remeshes all meshes below the given folders without a target, and then
with each of three targets that is above that number of faces. Writes two Markdown tables to standard output: the shares of
the runs within a tenth of the target, after how many attempts and in how many times the time of a run with the largest
edge that the target has chosen, and the runs that are further away or took longer.

Exit code: 0; 2 for misuse. With --strict, 1 if fewer than 90 % of the runs are within a tenth, or one took too long.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import tool
from tool import print_table, say

TARGETS = (2_000, 10_000, 50_000)
OFF = 0.1
LONGEST = 2.2  # times the time of a run that is given the largest edge instead
REPEATS = 5  # of a run that took too long; the shortest counts
CORPUS = [pathlib.Path("../shared/meshes") / folder for folder in ("planar-cad", "curved-cad", "curved", "polygons", "seed")]


def run(asked, mesh, folder, *options):
    """The report of a result, and the attempts it took; None if there is no result."""
    command = [asked.remesh, str(mesh), "-o", f"{folder}/result.obj", "--report", f"{folder}/report.json", "--trace",
               *asked.options, *options]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=asked.time_limit)
    except subprocess.TimeoutExpired:
        return None
    if told.returncode != 0:
        return None
    return json.loads(pathlib.Path(folder, "report.json").read_text()), told.stderr.count("remesh: attempt ")


def faces_of(report):
    return report["output"]["faces"]


def times_longer(asked, mesh, folder, target):
    """How many times the time of a run with the largest edge that the target has chosen the run with the target takes."""
    shortest = [float("inf"), float("inf")]
    for _ in range(REPEATS):
        report, _ = run(asked, mesh, folder, target)
        if report["largest_edge_for_target"] is None:  # the other options need more faces
            return 1.0
        direct = run(asked, mesh, folder, f"--max-edge-length={report['largest_edge_for_target']!r}")
        times = [report["timing_ms"]["total"], direct[0]["timing_ms"]["total"]]
        shortest = [min(pair) for pair in zip(shortest, times)]
        if shortest[0] <= LONGEST * shortest[1]:
            break
    return shortest[0] / shortest[1]


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
                option = f"--target-faces={target}"
                if before and faces_of(before[0]) < target and (after := run(asked, mesh, folder, option)):
                    rows.append((mesh.name, target, faces_of(before[0]), faces_of(after[0]), after[1],
                                 times_longer(asked, mesh, folder, option)))
    near = [row for row in rows if abs(row[3] / row[1] - 1) <= OFF]
    slow = [row for row in rows if row[5] > LONGEST]
    table = [["target", "runs", "within a tenth", "of these in one attempt", "most attempts", "longest", f"over {LONGEST}"]]
    for target in TARGETS:
        of_target = [row for row in rows if row[1] == target]
        near_it = [row for row in near if row[1] == target]
        table.append([f"{target:,}", str(len(of_target)), str(len(near_it)), str(sum(row[4] == 1 for row in near_it)),
                      str(max((row[4] for row in of_target), default=0)),
                      f"{max((row[5] for row in of_target), default=0):.2f}", str(sum(row in slow for row in of_target))])
    print_table(table)
    print()
    print_table([["mesh", "target", "without", "faces", "attempts", "times longer"]] +
                [[row[0], *(f"{value:,}" for value in row[1:5]), f"{row[5]:.2f}"]
                 for row in rows if row not in near or row in slow])
    return 1 if asked.strict and (len(near) < 0.9 * len(rows) or slow) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
