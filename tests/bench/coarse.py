"""Part `coarse`: the fewest faces within a tolerance, beside what two methods of CGAL need at the same distance.

The methods promise no distance. So the distance of our result from the input is measured, and they are run with the
largest tolerance with which they stay within it. All distances are measured by the same program, in both directions.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import surface_files  # noqa: E402

SHARED = pathlib.Path(os.environ.get("REMESHD_CORPUS") or
                      pathlib.Path(__file__).resolve().parents[2].parent / "shared" / "meshes")
MESHES = """
    planar-cad/plate_holes.STL planar-cad/1002_tray_bottom.STL planar-cad/part1.stl curved/shape.stl
    broken/featuretype.STL curved-cad/fe_part1.stl curved-cad/round.stl curved-cad/sv_cylinder.stl
    curved-cad/hx_tube.stl.gz curved-cad/singleOrifice.stl curved-cad/sh2.stl curved-cad/object.stl
""".split()
TOLERANCE = 1e-3  # of the diagonal
# Distances below this part of the diagonal are rounding.
ROUNDING = 1e-6
PEERS = {"adaptive": "CGAL adaptive isotropic remeshing", "planar": "CGAL planar remeshing"}
BOUND = 0.5
PATIENCE_SECONDS = 900


def measure_coarse(bench, table):
    if not bench.program("coarse_peer").exists():
        table.leave_out("the coarsest mesh within a tolerance", "all", "CGAL 6.0 or newer could not be had")
        return
    ratios = {method: [] for method in PEERS}
    for path in bench.meshes or [SHARED / name for name in MESHES]:
        if not path.exists():
            table.leave_out(path.name, "all", "there is no such file")
            continue
        ours, theirs = compare(bench, path)
        add_rows(table, path.name, ours, theirs)
        for method, peer in theirs.items():
            if peer and peer["faces"]:
                ratios[method].append(ours["faces"] / peer["faces"])
        table.write(bench.folder)
        print(f"bench: {path.name}: {ours['faces']} faces, {theirs}", file=sys.stderr)
    add_medians(table, ratios)


def compare(bench, path):
    """Our result and those of the peers, by the names of their methods. A peer that fails has None."""
    surface = surface_files.read_surface(path)
    before = bench.folder / "coarse_in.obj"
    surface_files.write_obj(surface, before)
    output = "coarse_out.obj"
    report = bench.remesh(path, "--refine", "false", "--surface-tolerance-fraction", str(TOLERANCE),
                          output=output).report
    measured = ask(bench, "distance", before, bench.folder / output)
    bound = report["distance_bound"]
    ours = {"faces_in": len(surface.faces), "faces": report["output"]["faces"],
            "proven": max(bound["output_to_input"], bound["input_to_output"]),
            "distance": measured["distance"] if measured else None, "diagonal": surface.diagonal()}
    allowed = max(ours["distance"] or ours["proven"], ROUNDING * ours["diagonal"])
    theirs = {method: ask(bench, method, before, bench.folder / f"coarse_{method}.obj", repr(allowed))
              for method in PEERS}
    return ours, theirs


def ask(bench, *arguments):
    """The answer of coarse_peer; None if it fails or takes too long."""
    try:
        done = subprocess.run([bench.program("coarse_peer"), *arguments], stdout=subprocess.PIPE, text=True,
                              timeout=PATIENCE_SECONDS)
        return json.loads(done.stdout) if done.returncode == 0 else None
    except subprocess.TimeoutExpired:
        return None


def add_rows(table, name, ours, theirs):
    """Distances are told in thousandths of the diagonal."""
    case = f"{name}, within {TOLERANCE:g} of the diagonal"
    thousandth = ours["diagonal"] / 1000
    table.add(case, "remesh", ours["faces"], "faces", "the input", ours["faces_in"], 1)
    table.add(case, "remesh, proven distance", ours["proven"] / thousandth, "thousandths")
    if ours["distance"] is None:
        table.leave_out(case, "remesh, measured distance", "it took too long")
    else:
        table.add(case, "remesh, measured distance", ours["distance"] / thousandth, "thousandths")
    for method, title in PEERS.items():
        peer = theirs[method]
        if not peer:
            table.leave_out(case, title, "it failed or took too long")
        elif not peer["faces"]:
            table.leave_out(case, title, "with no tolerance it stays within the distance")
        else:
            table.add(case, title, peer["faces"], "faces")
            table.add(case, f"{title}, measured distance", peer["distance"] / thousandth, "thousandths")
            table.add(case, "remesh", ours["faces"], "faces", title, peer["faces"], BOUND)


def add_medians(table, ratios):
    for method, title in PEERS.items():
        if ratios[method]:
            table.add(f"median of {len(ratios[method])} surfaces", "remesh", statistics.median(ratios[method]),
                      "of the peer's faces", title, 1, BOUND)
