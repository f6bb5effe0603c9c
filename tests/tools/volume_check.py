#!/usr/bin/env python3
"""Does a volume mesher like what the remesher makes? Meshes the inside of parts with TetGen, Gmsh and Netgen, from the
part as it is and from the remesher's output, and compares.

For each closed part: whether the mesher succeeds, the number of tetrahedra, and the worst (smallest) dihedral angle,
over all tetrahedra and over those apart that touch no sharp edge: an edge of the input with a dihedral angle under 30
degrees, where the input itself asks for flat tetrahedra.

  tetgen -pYq1.4   keeps the surface as it is: what the surface is worth
  tetgen -pq1.4    may split its facets: the number of tetrahedra to compare with
  gmsh -3          keeps the surface
  netgen           keeps the surface

Which flat tetrahedra TetGen leaves depends on the order of vertices and faces, too: --orders tells for the output what
comes out on average, and how often it holds. The verdict is on the order as it is.

Writes a Markdown table to standard output, what it is doing to standard error. Exit code: 0 if from every part that
TetGen can mesh, it also meshes the remesher's output, within --at-least and --at-most; 1 if not; 2 for misuse. Outputs
that Gmsh or Netgen cannot mesh are told, but do not fail.
"""

import dataclasses
import os
import pathlib
import random
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

import dihedral
import surface_files
import tool
from tool import say

DEFAULT_REMESH_OPTIONS = ["--proximity", "1", "--min-angle-deg", "20"]
SHARP_DEG = 30
FEW = 1000  # tetrahedra, too few to compare


# The package is for Debian's own Python.
NETGEN_PYTHON = "/usr/bin/python3" if pathlib.Path("/usr/bin/python3").exists() else sys.executable
NETGEN_SCRIPT = pathlib.Path(__file__).resolve().parent / "netgen_fill.py"


class ToolFailed(Exception):
    """In two or three words, for the table."""


@dataclasses.dataclass
class Volume:
    """What a volume mesher made of a surface, or why nothing."""

    tetrahedra: int = 0
    worst_deg: float = 0.0
    worst_apart_deg: float = 0.0  # over tetrahedra that touch no sharp edge
    worst_place: tuple = ()  # the centroid of the one that worst_apart_deg is of
    flat: int = 0  # of those tetrahedra, below the bound
    failure: str = ""


@dataclasses.dataclass
class Row:
    """A part, or its remeshed form."""

    part: str
    surface: str
    faces: int = 0
    least_angle_deg: float = 0.0
    volumes: dict = dataclasses.field(default_factory=dict)  # by mesher
    orders: list = dataclasses.field(default_factory=list)  # under KEPT, renumbered
    note: str = ""


def run(command, folder, seconds):
    """Errors: ToolFailed - it took too long. Output: exit code, or minus the signal that ended it; all that it said."""
    with subprocess.Popen(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            output, _ = process.communicate(timeout=seconds)
        except BaseException as error:
            os.killpg(process.pid, signal.SIGKILL)
            if isinstance(error, subprocess.TimeoutExpired):
                raise ToolFailed(f"no end in {seconds:g} s") from error
            raise
    return process.returncode, output


def how_it_ended(code):
    if code == -signal.SIGABRT:
        return "gave up"
    return f"{signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def tetgen(switches):
    """A mesher: TetGen with these switches."""

    def mesh(surface, folder, seconds):
        surface_files.write_smesh(surface, folder / "part.smesh")
        # By lines, so that what it said is not lost when it ends by an exception, as Debian's does.
        code, output = run(["stdbuf", "-oL", "tetgen", switches, "part.smesh"], folder, seconds)
        if code != 0 or not (folder / "part.1.ele").exists():
            if "intersect" in output:
                raise ToolFailed("self-intersection")
            stages = re.findall(r"^(\w.*\w) ?\.\.\.", output, re.MULTILINE)
            raise ToolFailed(f"{how_it_ended(code)} {stages[-1].lower() if stages else 'reading'}")
        return read_tetgen_mesh(folder, "part.1")

    return mesh


def read_tetgen_mesh(folder, name):
    """Points by their names, and tetrahedra: of NAME.node and NAME.ele."""
    with open(folder / f"{name}.node", encoding="ascii") as lines:
        rows = (line.split() for line in lines if not line.startswith("#"))
        next(rows)
        points = {row[0]: tuple(map(float, row[1:4])) for row in rows if row}
    with open(folder / f"{name}.ele", encoding="ascii") as lines:
        rows = (line.split() for line in lines if not line.startswith("#"))
        next(rows)
        return points, [row[1:5] for row in rows if row]


def gmsh(surface, folder, seconds):
    """A mesher: Gmsh fills the volume inside one discrete surface."""
    surface_files.write_msh(in_triangles(surface), folder / "part.msh")
    (folder / "part.geo").write_text('Merge "part.msh";\nSurface Loop(1) = {1};\nVolume(1) = {1};\nMesh.SaveAll = 1;\n')
    code, output = run(["gmsh", "-3", "-nt", "1", "-format", "msh2", "-o", "out.msh", "part.geo"], folder, seconds)
    if "intersect" in output or "overlapping" in output:
        raise ToolFailed("self-intersection")
    if code != 0 or not (folder / "out.msh").exists():
        error = re.search(r"^Error +: (.{,40})", output, re.MULTILINE)
        raise ToolFailed(error.group(1).strip().lower() if error else how_it_ended(code))
    points, tetrahedra = {}, []
    section = ""
    with open(folder / "out.msh", encoding="ascii") as lines:
        for line in lines:
            row = line.split()
            if line.startswith("$"):
                section = row[0]
            elif section == "$Nodes" and len(row) == 4:
                points[row[0]] = tuple(map(float, row[1:4]))
            elif section == "$Elements" and len(row) > 6 and row[1] == "4":
                tetrahedra.append(row[-4:])
    # It goes on after an error in the volume, and writes the surface alone.
    if not tetrahedra or "Error" in output:
        raise ToolFailed("no volume")
    return points, tetrahedra


def netgen(surface, folder, seconds):
    """A mesher: Netgen, in a process of its own, as it may crash and cannot be stopped."""
    surface_files.write_obj(in_triangles(surface), folder / "part.obj")
    command = [NETGEN_PYTHON, "-B", str(NETGEN_SCRIPT), "part.obj", "part.1"]
    code, output = run(command, folder, seconds)
    if code != 0 or not (folder / "part.1.ele").exists():
        if re.search("intersect|overlap", output, re.IGNORECASE):
            raise ToolFailed("self-intersection")
        said = re.findall(r"^netgen: (.{1,40})", output, re.MULTILINE)
        raise ToolFailed(said[-1].strip().lower() if said else how_it_ended(code))
    return read_tetgen_mesh(folder, "part.1")


def has_netgen():
    tried = subprocess.run([NETGEN_PYTHON, "-c", "import netgen.meshing"], capture_output=True, check=False)
    return tried.returncode == 0


def in_triangles(surface):
    """Errors: ToolFailed - a face is not convex, and may have no fan of triangles."""
    triangles = []
    for face in surface.faces:
        whole = dihedral.face_normal(surface, face)
        for b, c in zip(face[1:], face[2:]):
            part = dihedral.face_normal(surface, (face[0], b, c))
            if dihedral.dot(whole, part) <= 0 and len(face) > 3:
                raise ToolFailed("concave polygon")
            triangles.append((face[0], b, c))
    return surface_files.Surface(surface.points, triangles)


MESHERS = {
    "tetgen -pYq1.4": tetgen("-pYq1.4"),
    "tetgen -pq1.4": tetgen("-pq1.4"),
    "gmsh -3": gmsh,
    "netgen": netgen,
}
KEPT, SPLIT = "tetgen -pYq1.4", "tetgen -pq1.4"


def renumbered(surface, seed):
    """The same surface with its points and faces in another order."""
    numbers = random.Random(seed)
    order = numbers.sample(range(len(surface.points)), len(surface.points))
    place = {old: new for new, old in enumerate(order)}
    faces = [tuple(place[corner] for corner in face) for face in surface.faces]
    return surface_files.Surface([surface.points[old] for old in order], numbers.sample(faces, len(faces)))


def mesh_volume(mesher, surface, sharp, seconds, at_least):
    """Runs a mesher in a folder of its own. `sharp`: tells of a point whether it lies on a sharp edge."""
    with tempfile.TemporaryDirectory(prefix="volume-check-") as folder:
        try:
            points, tetrahedra = mesher(surface, pathlib.Path(folder), seconds)
        except ToolFailed as failure:
            return Volume(failure=str(failure))
    if not tetrahedra:
        return Volume(failure="no tetrahedra")
    is_sharp = {p: points[p] in sharp for p in points}
    volume = Volume(len(tetrahedra), 180.0, 180.0)
    for corners in tetrahedra:
        angle = dihedral.least_dihedral(*(points[p] for p in corners))
        volume.worst_deg = min(volume.worst_deg, angle)
        if angle >= max(volume.worst_apart_deg, at_least) or any(is_sharp[p] for p in corners):
            continue
        volume.flat += angle < at_least
        if angle < volume.worst_apart_deg:
            volume.worst_apart_deg = angle
            volume.worst_place = tuple(sum(points[p][k] for p in corners) / 4 for k in range(3))
    return volume


def remesh(program, options, path, surface, seconds):
    """Errors: ToolFailed; NotASurface - what came back cannot be read."""
    with tempfile.TemporaryDirectory(prefix="volume-check-") as name:
        folder = pathlib.Path(name)
        given = pathlib.Path(path).resolve()
        if given.suffix.lower() != ".obj":  # what the program does not read itself
            given = folder / "in.obj"
            surface_files.write_obj(surface, given)
        code, output = run([program, str(given), "-o", "out.obj", *options], folder, seconds)
        if code != 0:
            said = output.strip().splitlines() or [how_it_ended(code)]
            raise ToolFailed(said[-1])
        return surface_files.read_surface(folder / "out.obj")


def check_part(path, program, options, seconds, meshers, at_least, orders):
    """The two rows of a part."""
    before = Row(path.name, "input")
    after = Row(path.name, "output")
    try:
        surface = surface_files.read_surface(path)
    except (surface_files.NotASurface, OSError) as error:
        before.note = str(error)
        return before, after
    before.faces, before.least_angle_deg = len(surface.faces), dihedral.least_corner(surface)
    if not surface.is_closed():
        before.note = "open"
        return before, after
    diagonal = surface.diagonal()
    sharp = dihedral.NearSegments(dihedral.sharp_edges(surface, SHARP_DEG), 1e-6 * diagonal, diagonal / 50)

    started = time.monotonic()
    try:
        output = remesh(program, options, path, surface, seconds)
        after.faces, after.least_angle_deg = len(output.faces), dihedral.least_corner(output)
        say(f"  remeshed in {time.monotonic() - started:.1f} s: {before.faces} faces to {after.faces}")
    except (ToolFailed, surface_files.NotASurface) as failure:
        output = None
        after.note = f"remesh: {failure}"
    for name, mesher in meshers.items():
        before.volumes[name] = mesh_volume(mesher, surface, sharp, seconds, at_least)
        say(f"  {name} of the input: {describe(before.volumes[name])}")
        if output is not None:
            after.volumes[name] = mesh_volume(mesher, output, sharp, seconds, at_least)
            say(f"  {name} of the output: {describe(after.volumes[name])}")
    if output is not None:
        for seed in range(1, orders):
            after.orders.append(mesh_volume(meshers[KEPT], renumbered(output, seed), sharp, seconds, at_least))
    return before, after


def failures_of(before, after, at_least, at_most):
    """What the output fails at, in words. A part that TetGen cannot mesh is no measure of it."""
    could = {name: volume for name, volume in before.volumes.items() if not volume.failure}
    if KEPT not in could and SPLIT not in could:
        return []
    if after.note:
        return [after.note]
    kept = after.volumes[KEPT]
    if kept.failure:
        return [f"{KEPT}: {kept.failure}"]
    failures = []
    if kept.worst_apart_deg < at_least:
        failures.append(f"worst dihedral {kept.worst_apart_deg:.3g} degrees, not {at_least:g}")
    if SPLIT in could and kept.tetrahedra > max(FEW, at_most * could[SPLIT].tetrahedra):
        failures.append(f"{kept.tetrahedra} tetrahedra, over {at_most:g} times {could[SPLIT].tetrahedra}")
    return failures


def others_of(before, after):
    """What meshers other than TetGen could not do with the output; it tells of each whether it could mesh the input."""
    found = []
    for name, volume in after.volumes.items():
        if name not in (KEPT, SPLIT) and volume.failure:
            of_input = before.volumes[name].failure
            found.append(f"{name}: {volume.failure}; the input: " + (of_input or "meshed"))
    return found


def describe(volume):
    if volume.failure:
        return volume.failure
    return (
        f"{volume.tetrahedra} tetrahedra, worst dihedral {volume.worst_deg:.3g} degrees, "
        f"apart from sharp edges {volume.worst_apart_deg:.3g} at "
        + ", ".join(f"{x:.6g}" for x in volume.worst_place)
    )


def print_volumes(rows, meshers):
    titles = ["part", "surface", "faces", "least angle"]
    for name in meshers:
        titles += [name, "worst dihedral", "apart"]
    table = [titles]
    for row in rows:
        cells = [row.part, row.surface, str(row.faces or ""), f"{row.least_angle_deg:.3g}" if row.faces else ""]
        for name in meshers:
            volume = row.volumes.get(name)
            if volume is None:
                cells += ["", "", ""]
            elif volume.failure:
                cells += [volume.failure, "", ""]
            else:
                cells += [str(volume.tetrahedra), f"{volume.worst_deg:.3g}", f"{volume.worst_apart_deg:.3g}"]
        if row.note:
            cells[4] = row.note
        table.append(cells)
    tool.print_table(table)


def print_orders(rows, at_least):
    """Of each part, over all orders that TetGen could mesh."""
    titles = ["part", "orders", "tetrahedra", "least", "median", "most", f"below {at_least:g} degrees", "with none"]
    table = [titles]
    for row in rows:
        if not row.orders:
            continue
        volumes = [v for v in [row.volumes[KEPT], *row.orders] if not v.failure]
        cells = [row.part, f"{len(volumes)} of {1 + len(row.orders)}"]
        if volumes:
            worst = [v.worst_apart_deg for v in volumes]
            cells += [f"{statistics.mean(v.tetrahedra for v in volumes):.0f}"]
            cells += [f"{x:.3g}" for x in (min(worst), statistics.median(worst), max(worst))]
            cells += [f"{statistics.mean(v.flat for v in volumes):.3g}", str(sum(v.flat == 0 for v in volumes))]
        table.append(cells + [""] * (len(titles) - len(cells)))
    print(f"\nOutputs under {KEPT}, their worst dihedral angles apart over all orders, and averages:\n")
    tool.print_table(table)


def parse_arguments(arguments):
    parser = tool.make_parser(__doc__, DEFAULT_REMESH_OPTIONS)
    parser.add_argument("paths", nargs="+", metavar="PATH", help="a folder (with those below it), or a mesh file")
    parser.add_argument("--at-least", type=float, default=3, metavar="DEG", help="of the worst dihedral (%(default)s)")
    parser.add_argument(
        "--at-most",
        type=float,
        default=1.5,
        metavar="TIMES",
        help=f"the tetrahedra of the output under {KEPT} to those of the input under {SPLIT} (%(default)s); "
        f"up to {FEW} always are well",
    )
    parser.add_argument(
        "--orders", type=int, default=1, metavar="N", help="of vertices and faces, in which TetGen is given the output"
    )
    parser.add_argument("--without-gmsh", action="store_true", help="leave out Gmsh")
    parser.add_argument("--without-netgen", action="store_true", help="leave out Netgen")
    parsed = tool.parse(parser, arguments, DEFAULT_REMESH_OPTIONS, [])
    for mesher in ["tetgen"] + ([] if parsed.without_gmsh else ["gmsh"]):
        if shutil.which(mesher) is None:
            parser.error(f"{mesher} is not installed: it is a package of Debian")
    if not parsed.without_netgen and not has_netgen():
        parser.error("Netgen is not installed: python3-netgen is a package of Debian")
    return parsed


def main(arguments):
    asked = parse_arguments(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # so that a tool that runs ends, too
    left_out = {"gmsh -3": asked.without_gmsh, "netgen": asked.without_netgen}
    meshers = {name: mesher for name, mesher in MESHERS.items() if not left_out.get(name)}
    rows, failures, others = [], [], []
    for path in asked.files:
        say(str(path))
        before, after = check_part(
            path, asked.remesh, asked.options, asked.time_limit, meshers, asked.at_least, asked.orders
        )
        if before.note:
            say(f"  {before.note}")
            rows.append(before)
            continue
        rows += [before, after]
        for failure in failures_of(before, after, asked.at_least, asked.at_most):
            say(f"  FAILED: {failure}")
            failures.append(f"{path.name}: {failure}")
        others += [f"{path.name}: {failure}" for failure in others_of(before, after)]
    print_volumes(rows, meshers)
    if asked.orders > 1:
        print_orders(rows, asked.at_least)
    print(f"\nremesh {' '.join(asked.options)}: " + (f"{len(failures)} failed" if failures else "all well"))
    for failure in failures:
        print(f"- {failure}")
    if others:
        print(f"\nOutputs that others cannot mesh, which is not judged: {len(others)}")
    for failure in others:
        print(f"- {failure}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
