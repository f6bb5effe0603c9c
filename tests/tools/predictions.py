#!/usr/bin/env python3
"""Is the number of faces that an analysis predicts near the number that the result has? Remeshes all meshes below the
given folders with several bounds on angles and sizes, and writes two Markdown tables to standard output: how many
predictions are right within a factor of 1.5 and of 3, for each setting, and those that are furthest from the result.
What it is doing goes to standard error.

A run is left out if it fails, does not end in time, or is limited by the number of faces that are allowed.

Exit code: 0; 2 for misuse. With --strict, 1 if fewer than 90 % of all predictions are right within a factor of 1.5, or
any is wrong by more than a factor of 3.
"""

import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile

import tool
from tool import print_table, say

NEAR, FAR = 1.5, 3.0
SETTINGS = {
    "angle alone": [],
    "max_edge_fraction": ["--max-edge-fraction", "0.02"],
    "proximity": ["--proximity", "0.5"],
    "both": ["--max-edge-fraction", "0.02", "--proximity", "0.5"],
}
CORPUS = pathlib.Path("../shared/meshes")


@dataclasses.dataclass
class Row:
    """One mesh at one setting."""

    part: str
    setting: str
    angle_deg: float
    before: int = 0
    predicted: int = 0
    after: int = 0
    floor: bool = False  # whether min_edge_length=auto has found one
    failure: str = ""

    def error(self):
        """The factor between prediction and result, at least 1."""
        return max(self.predicted / self.after, self.after / self.predicted)


def report_of(command, folder, seconds):
    """Output: the report, or the reason why there is none."""
    try:
        done = subprocess.run(
            [*command, "--report", "report.json"],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, f"no end in {seconds:g} s"
    if done.returncode != 0:
        return None, (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return json.loads((folder / "report.json").read_text(encoding="utf-8")), ""


def compare(path, row, asked):
    """Fills the row."""
    options = ["--min-angle-deg", f"{row.angle_deg:g}", *SETTINGS[row.setting], *asked.options]
    options += ["--max-output-faces", str(asked.budget), "--workers", str(asked.workers)]
    with tempfile.TemporaryDirectory(prefix="predictions-") as name:
        folder = pathlib.Path(name)
        remeshed, row.failure = report_of(
            [asked.remesh, str(path.resolve()), "-o", "out.obj", *options], folder, asked.time_limit
        )
        if row.failure:
            return
        if any(entry["reason"] == "budget" for entry in remeshed["unrefined"]):
            row.failure = "limited by the number of faces"
            return
        row.before, row.after = remeshed["input"]["faces"], remeshed["output"]["faces"]
        row.floor = isinstance(remeshed["options"]["min_edge_length"], float)
        analyzed, row.failure = report_of(
            [asked.remesh, str(path.resolve()), "--analyze", *options], folder, asked.time_limit
        )
        if row.failure:
            return
        row.predicted = analyzed["predicted_faces"]


def share(rows, factor):
    return f"{100 * sum(row.error() <= factor for row in rows) / len(rows):.1f} %"


def print_settings(rows):
    within = [f"within {NEAR:g}", f"within {FAR:g}"]
    table = [["setting", "angle", "runs", *within, "too low", "too high"]]
    groups = [(setting, angle) for setting in SETTINGS for angle in sorted({row.angle_deg for row in rows})]
    for setting, angle in [*groups, ("all", 0)]:
        here = [row for row in rows if setting == "all" or (row.setting, row.angle_deg) == (setting, angle)]
        if not here:
            continue
        low = sum(row.after > FAR * row.predicted for row in here)
        high = sum(row.predicted > FAR * row.after for row in here)
        name = f"{angle:g}" if angle else ""
        table.append([setting, name, str(len(here)), share(here, NEAR), share(here, FAR), str(low), str(high)])
    print_table(table)


def print_worst(rows, count):
    table = [["part", "setting", "angle", "faces", "predicted", "result", "factor", "floor"]]
    for row in sorted(rows, key=lambda row: -row.error())[:count]:
        cells = [row.part, row.setting, f"{row.angle_deg:g}", str(row.before), str(row.predicted), str(row.after)]
        table.append(cells + [f"{row.predicted / row.after:.3g}", "yes" if row.floor else ""])
    print_table(table)


def parse_arguments(arguments):
    parser = tool.make_parser(__doc__, [])
    parser.add_argument("paths", nargs="*", metavar="PATH", help=f"a folder, or a mesh file; by default {CORPUS}")
    parser.add_argument("--angles", default="20,25,30", metavar="DEG,...", help="(%(default)s)")
    parser.add_argument("--settings", default=",".join(SETTINGS), metavar="NAME,...", help="(%(default)s)")
    parser.add_argument("--budget", type=int, default=3000000, metavar="FACES", help="of each result (%(default)s)")
    parser.add_argument("--max-bytes", type=int, metavar="N", help="leave out files that are larger")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="threads (%(default)s)")
    parser.add_argument("--worst", type=int, default=30, metavar="N", help="rows of the second table (%(default)s)")
    parser.add_argument("--strict", action="store_true", help="tell by the exit code whether predictions are right")
    asked = tool.parse(parser, arguments, [], [CORPUS])
    try:
        asked.angles = [float(angle) for angle in asked.angles.split(",")]
    except ValueError:
        parser.error("--angles takes numbers with commas between them")
    asked.settings = asked.settings.split(",")
    unknown = set(asked.settings) - set(SETTINGS)
    if unknown:
        parser.error(f"there is no setting {min(unknown)}")
    if asked.max_bytes is not None:
        asked.files = [p for p in asked.files if p.stat().st_size <= asked.max_bytes]
    return asked


def main(arguments):
    asked = parse_arguments(arguments)
    rows = []
    for path in asked.files:
        for angle in asked.angles:
            for setting in asked.settings:
                row = Row(f"{path.parent.name}/{path.name}", setting, angle)
                compare(path, row, asked)
                said = row.failure or f"{row.before} faces, predicted {row.predicted}, result {row.after}"
                say(f"{row.part}, {row.setting}, {row.angle_deg:g} degrees: {said}")
                rows.append(row)
    compared = [row for row in rows if not row.failure]
    if not compared:
        say("no mesh could be remeshed")
        return 2
    print_settings(compared)
    print()
    print_worst(compared, asked.worst)
    print(f"\n{len(rows) - len(compared)} of {len(rows)} runs left out")
    if not asked.strict:
        return 0
    near = sum(row.error() <= NEAR for row in compared)
    return 0 if near >= 0.9 * len(compared) and all(row.error() <= FAR for row in compared) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
