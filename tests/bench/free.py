"""Part `free`: free-form surfaces within a proven distance, beside the fewest faces of peers at the same distance.

The peers promise no distance. So each runs with several of its own parameters, and the coarsest mesh counts that
`remesh --compare` proves to be within the distance of the input, in both directions. All inputs are triangles.
"""

import dataclasses
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys

from coarse import SHARED
from programs import face_count, seconds

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import dihedral  # noqa: E402
import surface_files  # noqa: E402

# Parts of the diagonal, with the bounds on our faces beside the best peer's: in the median, and on each surface.
TOLERANCES = {1e-3: (0.35, 0.6), 1e-4: (0.55, 0.8)}
SMOOTH = ["ball", "terrain", "knot", "enneper", "isosurface"]
SMOOTH_FACES = 100_820
SCANS = """
    spot.ply casting.off fandisk.obj body.obj.gz conrod.stl block.off DTC-scaled.stl.gz NACA0012.obj.gz
""".split()
SIMPLIFIER = "meshoptimizer"
BEST = "the best peer with angles"
# On scans, in the median.
BOUND_BESIDE_SIMPLIFIER = {1e-3: 1}
BOUND_ON_FACES_IN = {1e-3: None, 1e-4: 1.3}
MIN_ANGLE_DEG = 25
PATIENCE_SECONDS = 120
# A peer that needs so many times the faces of the input is no longer asked.
HOPELESS = 4
# A parameter is searched to this factor, from the distance times the last number to the distance times the second.
STEP, LARGEST, SMALLEST = 1.1, 64, 1 / 64
# Elements per full turn for Gmsh.
ELEMENTS = [12, 25, 50, 100, 200]
SIMPLIFY = pathlib.Path(__file__).resolve().parent / "simplify_peer.mjs"
GMSH = """Merge "{}";
ClassifySurfaces{{40 * Pi / 180, 1, 1, Pi}};
CreateGeometry;
Mesh.MeshSizeFromCurvature = {};
Mesh.Algorithm = 6;
Mesh 2;
Save "{}";
"""


@dataclasses.dataclass
class Made:
    faces: int
    least_deg: float
    below: int  # triangles below the angle
    seconds: float = None
    distance: float = None  # proven
    listed: int = None  # in the report


def measure_free(bench, table):
    ratios = []
    for path, is_smooth in surfaces_of(bench):
        if not path.exists():
            table.leave_out(path.name, "all", "there is no such file")
            continue
        surface = surface_files.read_surface(path)
        surface.faces = [(face[0], b, c) for face in surface.faces for b, c in zip(face[1:], face[2:])]
        before = bench.folder / "free_in.obj"
        surface_files.write_obj(surface, before)
        for tolerance in TOLERANCES:
            distance = tolerance * surface.diagonal()
            ours = our_result(bench, before, tolerance)
            theirs = {name: peer(bench, before, distance) for name, peer in PEERS.items()}
            print(f"bench: {path.name} within {tolerance:g}: {ours.faces} faces, "
                  f"{ {name: made and made.faces for name, made in theirs.items()} }", file=sys.stderr)
            add_rows(table, path.name, is_smooth, tolerance, len(surface.faces), distance, ours, theirs)
            ratios.append((is_smooth, tolerance, ratios_to(ours, theirs)))
            table.write(bench.folder)
    add_medians(table, ratios)


def surfaces_of(bench):
    """The paths, and whether each is fine and smooth."""
    if bench.meshes:
        return [(path, False) for path in bench.meshes]
    smooth = [(bench.input(shape, SMOOTH_FACES), True) for shape in SMOOTH]
    return smooth + [(find(name), False) for name in SCANS]


def find(name):
    """A file of the shared meshes, whatever its folder."""
    return next(iter(sorted(SHARED.rglob(name))), SHARED / name)


def our_result(bench, before, tolerance):
    output = "free_out.obj"
    runs = [bench.remesh(before, "--surface-tolerance-fraction", str(tolerance), output=output)
            for _ in range(bench.runs)]
    bound = runs[-1].report["distance_bound"]
    return dataclasses.replace(looked_at(bench.folder / output), seconds=seconds(runs),
                               distance=max(bound["output_to_input"], bound["input_to_output"]),
                               listed=sum(row["count"] for row in runs[-1].report["unrefined"]))


def looked_at(path):
    surface = surface_files.read_surface(path)
    angles = [dihedral.least_corner_of(surface, face) for face in surface.faces]
    return Made(len(angles), min(angles), sum(angle < MIN_ANGLE_DEG * (1 - 1e-9) for angle in angles))


def is_within(bench, before, after, distance):
    """Whether our proof says so. A mesh that cannot be read is not."""
    try:
        done = subprocess.run([bench.program("remesh"), "--compare", before, after, "--tolerance", repr(distance)],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=PATIENCE_SECONDS)
    except subprocess.TimeoutExpired:
        return False
    return bool(done.stdout) and json.loads(done.stdout).get("within", False)


class Search:
    """The coarsest of the meshes that one peer makes."""

    def __init__(self, bench, before, distance):
        self.bench, self.before, self.distance = bench, before, distance
        self.most = HOPELESS * face_count(before)
        self.best = None
        self.is_hopeless = False

    def tries(self, make):
        """Whether what `make` writes to a path is near enough; the fewest faces are kept."""
        after = self.bench.folder / "free_peer.obj"
        after.unlink(missing_ok=True)
        try:
            make(after)
        except (OSError, surface_files.NotASurface, subprocess.SubprocessError):
            return False
        self.is_hopeless = after.exists() and face_count(after) > self.most
        if self.is_hopeless or not after.exists() or face_count(after) == 0:
            return False
        if not is_within(self.bench, self.before, after, self.distance):
            return False
        if self.best is None or face_count(after) < self.best.faces:
            self.best = looked_at(after)
        return True


def searched(bench, before, distance, make):
    """By a parameter that is about a distance: doubled or halved to where the mesh is just near enough, and then made
    larger again in small steps."""
    search = Search(bench, before, distance)
    good, bad = distance, None
    if search.tries(lambda after: make(after, good)):
        while not bad and good < LARGEST * distance:
            if search.tries(lambda after: make(after, 2 * good)):
                good *= 2
            else:
                bad = 2 * good
    else:
        bad, good = good, good / 2
        while not search.tries(lambda after: make(after, good)):
            good, bad = good / 2, good
            if good < SMALLEST * distance or search.is_hopeless:
                return None
    while bad and bad > STEP * good:
        middle = math.sqrt(good * bad)
        if search.tries(lambda after: make(after, middle)):
            good = middle
        else:
            bad = middle
    return search.best


def run(*command):
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=PATIENCE_SECONDS, check=True)


def by_cgal(bench, before, distance):
    if not bench.program("coarse_peer").exists():
        return None
    return searched(bench, before, distance, lambda after, tolerance: run(
        bench.program("coarse_peer"), "adaptive_once", before, after, repr(tolerance), repr(distance)))


def by_meshoptimizer(bench, before, distance):
    modules = bench.folder / "node_modules"
    if not shutil.which("node") or not (modules / "meshoptimizer").exists():
        return None
    return searched(bench, before, distance, lambda after, error: run(
        "node", SIMPLIFY, modules, before, after, repr(error)))


def by_gmsh(bench, before, distance):
    """With more and more elements per full turn, until the mesh is near enough."""
    if not shutil.which("gmsh"):
        return None
    stl, made, script = (bench.folder / name for name in ["free_in.stl", "free_gmsh.stl", "free.geo"])
    surface_files.write_stl(surface_files.read_surface(before), stl)
    search = Search(bench, before, distance)

    def make(after, elements):
        made.unlink(missing_ok=True)
        script.write_text(GMSH.format(stl, elements, made))
        run("gmsh", "-", script)
        surface_files.write_obj(surface_files.read_surface(made), after)

    for elements in ELEMENTS:
        if search.tries(lambda after: make(after, elements)) or search.is_hopeless:
            break
    return search.best


PEERS = {"CGAL adaptive": by_cgal, "Gmsh": by_gmsh, SIMPLIFIER: by_meshoptimizer}


def add_rows(table, name, is_smooth, tolerance, faces_in, distance, ours, theirs):
    case = f"{name}, within {tolerance:g} of the diagonal"
    bounds = TOLERANCES[tolerance]
    table.add(case, "remesh", ours.faces, "faces", "the input", faces_in,
              None if is_smooth else BOUND_ON_FACES_IN[tolerance])
    table.add(case, "remesh, proven distance", ours.distance, "model units", "the tolerance", distance)
    table.add(case, "remesh, least angle", ours.least_deg, "degrees")
    below = f"triangles below {MIN_ANGLE_DEG} degrees"
    table.add(case, "remesh", ours.below, below, bound=0 if is_smooth else None)
    table.add(case, "remesh", ours.listed, "triangles listed in the report")
    table.add(case, "remesh", ours.seconds, "s")
    for peer, made in theirs.items():
        if not made:
            table.leave_out(case, peer, "it could not be had, or nothing that it made was proven to be so near")
            continue
        table.add(case, peer, made.faces, "faces")
        table.add(case, peer, made.below, below)
        table.add(case, "remesh", ours.faces, "faces", peer, made.faces)
    best = ratios_to(ours, theirs).get(BEST)
    if is_smooth and best:
        table.add(case, "remesh", ours.faces, "faces", BEST, ours.faces / best, bounds[1])


def ratios_to(ours, theirs):
    """Our faces beside those of each peer, and of the best one that bounds angles, which a simplifier does not."""
    ratios = {peer: ours.faces / made.faces for peer, made in theirs.items() if made}
    with_angles = [ratio for peer, ratio in ratios.items() if peer != SIMPLIFIER]
    return ratios | ({BEST: max(with_angles)} if with_angles else {})


def add_medians(table, ratios):
    """Input: whether a surface is smooth, the tolerance, and the ratios to the peers, for each surface."""
    for tolerance, (bound, _) in TOLERANCES.items():
        for name, is_smooth, peer, limit in [("smooth surfaces", True, BEST, bound),
                                             ("scans", False, SIMPLIFIER, BOUND_BESIDE_SIMPLIFIER.get(tolerance))]:
            found = [all_of[peer] for smooth, at, all_of in ratios
                     if smooth == is_smooth and at == tolerance and peer in all_of]
            if found:
                table.add(f"median of {len(found)} {name} within {tolerance:g}", "remesh", statistics.median(found),
                          "of its faces", peer, 1, limit)
