"""Part `solids`: unions of shells that cross and of parts that touch, beside CGAL's autorefinement and manifold's union.

CGAL cuts a soup of triangles, as `repair=self_intersections` does, and neither unites nor proves anything. So our stage
and our whole command are held to parts of its time. manifold unites closed parts. Its time is told and not a bound. It
runs in node, if node and npm are there.
"""

import json
import pathlib
import shutil

from programs import peak_bytes, seconds

# the shape and its faces, and the bounds on the times of the stage and of the whole command beside CGAL's
WORKS = [
    ("spheres", 256_000, 1.0, 2.0),
    ("row_of_cubes", 120_000, 0.2, 0.5),
    ("bolts_in_a_plate", 100_000, 0.3, 1.0),
    ("two_boxes", 2_000_000, None, 0.5),
]
TEN_TIMES = ("spheres", 2_560_000)
BOUND_OF_TEN_TIMES = 12
UNITE = ("--repair", "+union", "--refine", "false")
MANIFOLD = pathlib.Path(__file__).resolve().parent / "manifold_peer.mjs"


def measure_solids(bench, table):
    took = {}
    for shape, faces, of_stage, of_command in WORKS:
        path = bench.input(shape, faces)
        works = {"remesh": lambda: bench.remesh(path, *UNITE)}
        if bench.program("arrange_peer").exists():
            works["CGAL"] = lambda: bench.attempt(bench.program("arrange_peer"), path)
        if shutil.which("node"):
            works["manifold"] = lambda: bench.attempt("node", MANIFOLD, bench.folder / "node_modules", path)
        results = bench.by_turns(works)
        add_rows(table, f"{shape.replace('_', ' ')}, {faces:,} faces", results, of_stage, of_command)
        took[shape] = seconds(results["remesh"])
        table.write(bench.folder)
    add_growth(bench, table, took[TEN_TIMES[0]])


def add_growth(bench, table, before):
    shape, faces = TEN_TIMES
    run = bench.remesh(bench.input(shape, faces), *UNITE)
    table.add(f"{shape}, {faces:,} faces", "remesh", run.seconds, "s", "a tenth of them", before, BOUND_OF_TEN_TIMES)


def stage_seconds(run):
    """The time of cutting and uniting, which belongs to the stage `weld` with what mends the file."""
    return run.report["timing_ms"]["weld"] / 1000


def middle(values):
    return sorted(values)[len(values) // 2]


def add_rows(table, case, results, of_stage, of_command):
    ours = results["remesh"]
    theirs = [json.loads(run.output) for run in results.get("CGAL", []) if run]
    base = middle([answer["process_ms"] / 1000 for answer in theirs]) if theirs else None
    if base is None:
        table.leave_out(case, "CGAL autorefinement", "CGAL 6.0 or newer could not be had, or it failed")
    else:
        table.add(case, "CGAL autorefinement", base, "s")
    against = "CGAL autorefinement" if base else None
    table.add(case, "remesh, mending and uniting", middle([stage_seconds(run) for run in ours]), "s", against, base,
              of_stage if base else None)
    table.add(case, "remesh, file to file", seconds(ours), "s", against, base, of_command if base else None)
    report = ours[0].report
    table.add(case, "remesh", peak_bytes(ours) / (report["input"]["faces"] + report["output"]["faces"]), "bytes a face")
    united = [json.loads(run.output) for run in results.get("manifold", []) if run]
    if united:
        table.add(case, "manifold", middle([answer["process_ms"] / 1000 for answer in united]), "s")
    else:
        table.leave_out(case, "manifold", "node or the package manifold-3d is not there, or it failed")
