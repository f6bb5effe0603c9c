#!/usr/bin/env python3
"""Does refinement end, and hold what it says, on every part? Refines all manifold surfaces below the given folders (an
edge has one face or two) at several bounds on the angles, and writes a Markdown table to standard output: the faces in
and out, the least angle, what is listed as unrefined and why, rounds, seconds, the peak of memory. What it is
doing goes to standard error.

The triangles below the bound are counted again from the output's coordinates: they must be as many as the listed ones.

Exit code: 0 if every part ended, was verified and listed what it left; 1 if not; 2 for misuse.
"""

import argparse
import collections
import concurrent.futures
import dataclasses
import json
import math
import multiprocessing
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import surface_files

# Angles of exactly the bound are the input's own; which side rounding puts them on says nothing.
ROUNDING = 1e-9
CORPUS = [pathlib.Path("../shared/meshes", folder) for folder in ("seed", "planar-cad", "curved", "polygons")]


class RunFailed(Exception):
    """In a few words, for the table."""


@dataclasses.dataclass
class Row:
    """One part at one bound."""

    part: str
    faces: int
    bound_deg: float
    result: int = 0
    least_angle_deg: float = 0.0
    listed: dict = dataclasses.field(default_factory=dict)  # count by reason
    rounds: object = ""  # empty if the report does not say
    seconds: float = 0.0
    megabytes: float = 0.0
    verified: bool = False
    failure: str = ""


def is_manifold(surface):
    return all(len(along) + len(against) <= 2 for along, against in surface.half_edges().values())


def run(command, folder, seconds):
    """Output: seconds and megabytes that it took. Errors: RunFailed.

    A process begins as a copy of the one that starts it, and that counts for its peak: only a small one may call this.
    """
    started = time.monotonic()
    with open(folder / "said", "w+", encoding="utf-8", errors="replace") as said:
        process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        timer = threading.Timer(seconds, process.kill)
        timer.start()
        try:
            _, status, usage = os.wait4(process.pid, 0)  # of this process alone, unlike RUSAGE_CHILDREN
        except BaseException:
            process.kill()
            raise
        finally:
            timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        took = time.monotonic() - started
        if process.returncode == 0:
            return took, usage.ru_maxrss / 1024
        if took >= seconds:
            raise RunFailed(f"no end in {seconds:g} s")
        said.seek(0)
        lines = said.read().strip().splitlines() or [f"exit code {process.returncode}"]
        raise RunFailed(lines[-1].removeprefix("remesh: "))


def count_below(surface, degrees):
    """The triangles with an angle under that; and those that may have one, were it not for rounding."""
    tangent = math.tan(math.radians(degrees))
    below = possible = 0
    for a, b, c in surface.faces:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = surface.points[a], surface.points[b], surface.points[c]
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = cx - bx, cy - by, cz - bz
        wx, wy, wz = ax - cx, ay - cy, az - cz
        twice_area = math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        # At the sharpest corner, the product of its sides with the cosine is the largest.
        cosine = -min(ux * vx + uy * vy + uz * vz, vx * wx + vy * wy + vz * wz, wx * ux + wy * uy + wz * uz)
        below += twice_area < (1 - ROUNDING) * tangent * cosine
        possible += twice_area < (1 + ROUNDING) * tangent * cosine
    return below, possible


def check(row, report, output):
    """Fills in the report, and what fails in words."""
    row.result = report["output"]["faces"]
    row.least_angle_deg = report["output"]["quality"]["min_angle_deg"]
    row.listed = {entry["reason"]: entry["count"] for entry in report["unrefined"]}
    row.rounds = report.get("refinement_rounds", "")
    verdict = report["verified"]
    row.verified = all(verdict[promise] is True for promise in ("surface", "conforming", "delaunay", "quality"))
    if not row.verified:
        row.failure = "not verified"
        return
    listed = sum(row.listed.values())
    below, possible = count_below(output, row.bound_deg)
    if not below <= listed <= possible:
        row.failure = f"{below} triangles below the bound, {listed} listed"


def refine(launcher, path, surface, row, asked):
    """Fills the row. `launcher` runs functions in a small process."""
    with tempfile.TemporaryDirectory(prefix="refinement-table-") as name:
        folder = pathlib.Path(name)
        given = pathlib.Path(path).resolve()
        if given.suffix.lower() != ".obj":  # what the program does not read itself
            given = folder / "in.obj"
            surface_files.write_obj(surface, given)
        command = [asked.remesh, str(given), "-o", "out.obj", "--report", "report.json"]
        command += ["--min-angle-deg", f"{row.bound_deg:g}", "--max-output-faces", str(asked.budget)]
        command += ["--workers", str(asked.workers), *asked.options]
        try:
            row.seconds, row.megabytes = launcher.submit(run, command, folder, asked.time_limit).result()
            report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
            check(row, report, surface_files.read_surface(folder / "out.obj"))
        except (RunFailed, surface_files.NotASurface) as failure:
            row.failure = str(failure)


def listed_text(listed):
    return ", ".join(f"{count} {reason}" for reason, count in listed.items())


def cells_of(row):
    start = [row.part, str(row.faces), f"{row.bound_deg:g}"]
    if row.result == 0:
        return start + [""] * 7 + [row.failure.replace("|", "\\|")]
    return start + [
        str(row.result),
        f"{row.least_angle_deg:.4g}",
        listed_text(row.listed),
        str(row.rounds),
        f"{row.seconds:.2f}",
        f"{row.megabytes:.0f}",
        "yes" if row.verified else "no",
        row.failure,
    ]


def print_table(rows):
    titles = ["part", "faces", "bound", "result", "least angle", "listed", "rounds", "s", "MB", "verified"]
    table = [titles + ["failure"]] + [cells_of(row) for row in rows]
    if not any(cells[-1] for cells in table[1:]):
        table = [cells[:-1] for cells in table]
    widths = [max(len(cells[column]) for cells in table) for column in range(len(table[0]))]
    table.insert(1, ["-" * width for width in widths])
    for cells in table:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(cells, widths)) + " |")


def print_summary(rows, skipped):
    for bound in sorted({row.bound_deg for row in rows}):
        here = [row for row in rows if row.bound_deg == bound]
        listed = collections.Counter()
        for row in here:
            listed.update(row.listed)
        failed = [row for row in here if row.failure]
        print(
            f"\n{bound:g} degrees: {len(here)} parts, {len(failed)} failed; {sum(row.faces for row in here)} faces in, "
            f"{sum(row.result for row in here)} out, {sum(row.seconds for row in here):.0f} s; "
            f"listed: {listed_text(listed) or 'nothing'}"
        )
        for reason in sorted(set(listed) - {"input_angle", "across_input_angle"}):
            parts = [f"{row.part} ({row.listed[reason]})" for row in here if reason in row.listed]
            print(f"- {reason}: {', '.join(parts)}")
        for row in failed:
            print(f"- FAILED {row.part}: {row.failure}")
    if skipped:
        print("\nNot among them: " + ", ".join(f"{part} ({why})" for part, why in skipped))


def say(text):
    print(text, file=sys.stderr, flush=True)


def parse_arguments(arguments):
    end = arguments.index("--") if "--" in arguments else len(arguments)
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="What follows -- are further options for remesh.",
    )
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATH",
        help="a folder (with those below it), or a mesh file; by default " + ", ".join(map(str, CORPUS)),
    )
    parser.add_argument("--remesh", default="build/release/remesh", help="the program; by default %(default)s")
    parser.add_argument("--bounds", default="25,30,33", metavar="DEG,...", help="(%(default)s)")
    parser.add_argument("--budget", type=int, default=3000000, metavar="FACES", help="of each result (%(default)s)")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="threads (%(default)s)")
    parser.add_argument("--time-limit", type=float, default=600, metavar="S", help="for each run (%(default)s)")
    asked = parser.parse_args(arguments[:end])
    asked.options = arguments[end + 1 :]
    try:
        asked.bounds = [float(bound) for bound in asked.bounds.split(",")]
    except ValueError:
        parser.error("--bounds takes numbers with commas between them")
    program = shutil.which(asked.remesh)
    if program is None:
        parser.error(f"there is no program {asked.remesh}; --remesh says where it is")
    asked.remesh = str(pathlib.Path(program).resolve())
    asked.files = []
    for path in map(pathlib.Path, asked.paths or CORPUS):
        found = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        asked.files += [p for p in found if surface_files.is_surface_file(p)]
    if not asked.files:
        parser.error("no OBJ, OFF, PLY or STL file there")
    return asked


def make_table(asked, launcher):
    """Output: rows; parts that are none, and why."""
    rows, skipped = [], []
    for path in asked.files:
        part = f"{path.parent.name}/{path.name}"
        try:
            surface = surface_files.read_surface(path)
        except (surface_files.NotASurface, OSError) as error:
            skipped.append((part, str(error)))
            continue
        if not is_manifold(surface):
            skipped.append((part, "not manifold"))
            continue
        for bound in asked.bounds:
            row = Row(part, len(surface.faces), bound)
            refine(launcher, path, surface, row, asked)
            say(" ".join(filter(None, cells_of(row))))
            rows.append(row)
    return rows, skipped


def main(arguments):
    asked = parse_arguments(arguments)
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as launcher:
        rows, skipped = make_table(asked, launcher)
    print_table(rows)
    print_summary(rows, skipped)
    return 1 if any(row.failure for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
