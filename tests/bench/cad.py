"""Part `cad`: a STEP file meshed by Gmsh, beside this project on the triangles that a CAD program makes of it.

Both are asked for as many edges per circle, and both are held against the surfaces of the STEP file.
"""

import dataclasses
import shutil
import statistics
import sys

from programs import seconds
from step_surfaces import read_step_surfaces

import dihedral  # found as step_surfaces finds it
import surface_files

ELEMENTS_PER_CIRCLE = 16
MIN_ANGLE_DEG = 25  # what remesh keeps by default
GIVEN_DEG = (5, 10, 20)  # the angles of the tessellations that remesh is given
TRUTH_DEG = 5  # of the one that tells how far faces reach, and where free-form faces lie


@dataclasses.dataclass
class Meshed:
    """What a program made of a file."""

    faces: int
    below: int  # triangles with an angle below MIN_ANGLE_DEG
    least_deg: float
    distance: float
    seconds: float
    listed: int = 0  # of those triangles the ones that the report of remesh tells of


def measure_cad(bench, table):
    if not bench.steps:
        table.leave_out("STEP files", "remesh beside Gmsh", "../shared/meshes/step is not there, and --step names none")
    elif shutil.which("gmsh") is None:
        table.leave_out("STEP files", "remesh beside Gmsh", "gmsh could not be had")
    else:
        add_medians(table, [pair for step in bench.steps for pair in measure_step(bench, table, step)])


def measure_step(bench, table, step):
    """What remesh and Gmsh made of it, a pair for each tessellation. Gmsh meshes the file itself, so that its mesh is
    the same in all of them."""
    given = {angle: bench.tessellated / f"{step.stem}-{angle}.stl" for angle in GIVEN_DEG}
    truth = bench.tessellated / f"{step.stem}-{TRUTH_DEG}.stl"
    if not all(path.exists() for path in (truth, *given.values())):
        table.leave_out(f"{step.name}, {ELEMENTS_PER_CIRCLE} elements per circle", "remesh beside Gmsh",
                        "it was not tessellated (occt-draw, ../shared/tools)")
        return []
    by_gmsh = bench.folder / f"{step.stem}_by_Gmsh.stl"
    outputs = {angle: bench.folder / f"{step.stem}-{angle}_by_remesh.obj" for angle in GIVEN_DEG}
    ways = {"Gmsh": lambda: bench.attempt(
        "gmsh", step, "-2", "-setnumber", "Mesh.MeshSizeFromCurvature", str(ELEMENTS_PER_CIRCLE), "-v", "1", "-nt",
        "1", "-format", "stl", "-o", by_gmsh)}
    for angle in GIVEN_DEG:
        ways[angle] = lambda angle=angle: bench.remesh(
            given[angle], "--elements-per-circle", str(ELEMENTS_PER_CIRCLE), workers=1, output=outputs[angle].name)
    results = bench.by_turns(ways)
    print(f"bench: {step.name}: looking at the meshes", file=sys.stderr)
    surfaces = read_step_surfaces(truth)
    theirs = look_at(surfaces, by_gmsh, results["Gmsh"]) if None not in results["Gmsh"] else None
    pairs = []
    for angle in GIVEN_DEG:
        ours = look_at(surfaces, outputs[angle], results[angle])
        ours.listed = sum(row["count"] for row in results[angle][-1].report["unrefined"])
        add_step(table, f"{step.name} in steps of {angle} degrees, {ELEMENTS_PER_CIRCLE} elements per circle", ours,
                 theirs)
        if theirs:
            pairs.append((ours, theirs))
    return pairs


def look_at(surfaces, path, runs):
    surface = surface_files.read_surface(path)
    angles = [dihedral.least_corner_of(surface, face) for face in surface.faces]
    return Meshed(len(angles), count_below(angles), min(angles), surfaces.greatest_distance(surface), seconds(runs))


def count_below(angles):
    """Rounding alone puts none below."""
    return sum(angle < MIN_ANGLE_DEG * (1 - 1e-9) for angle in angles)


FIGURES = [
    ("faces", "faces", lambda meshed: meshed.faces),
    ("below", f"triangles below {MIN_ANGLE_DEG} degrees", lambda meshed: meshed.below),
    ("least", "degrees, the least angle", lambda meshed: meshed.least_deg),
    ("distance", "model units from the STEP surfaces", lambda meshed: meshed.distance),
    ("time", "s, one thread", lambda meshed: meshed.seconds),
]


def add_step(table, case, ours, theirs):
    for name, unit, of in FIGURES:
        if theirs:
            table.add(case, "Gmsh", of(theirs), unit)
            table.add(case, "remesh", of(ours), unit, "Gmsh", None if name == "least" else of(theirs))
        else:
            table.add(case, "remesh", of(ours), unit)
        if name == "below":
            table.add(case, "remesh", ours.listed, "of them listed in the report")
    if not theirs:
        table.leave_out(case, "Gmsh", "it failed")


def add_medians(table, pairs):
    """Over all files: the bounds are on faces and distance in the median, and on faces and small angles in each file."""
    if not pairs:
        return
    case = f"median of {len(pairs)} tessellated STEP files"
    for what, of, bound in [("faces", lambda m: m.faces, 1.2), ("distance", lambda m: m.distance, 1),
                            ("time", lambda m: m.seconds, None)]:
        ratios = [of(ours) / of(theirs) for ours, theirs in pairs if of(theirs) > 0]
        if ratios:
            table.add(case, f"remesh, {what}", statistics.median(ratios), "times Gmsh's", "Gmsh", 1, bound)
    most = max(ours.faces / theirs.faces for ours, theirs in pairs)
    table.add(case, "remesh, faces where there are most", most, "times Gmsh's", "Gmsh", 1, 2)
    table.add(case, f"remesh, more below {MIN_ANGLE_DEG} degrees than Gmsh",
              sum(ours.below > theirs.below for ours, theirs in pairs), "files", bound=0)
