"""Boundaries with names in the programs that go on: Gmsh, TetGen, FreeFEM, Netgen and OpenFOAM.

usage: programs_test.py REMESH

A box has three groups, one with a blank and letters that are not ASCII, one with 200 letters, and three materials across them.
It is remeshed by label=group and by label=material, and each program has to have three boundaries of the right area. This is
part of `./dev read-back`; written_formats_test.py has the rest. Exit code 77: a program is not installed.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

# The bottom and the top; the front and the right side; the back and the left side of a box of 2 x 3 x 4.
NAMES = {"group": ["inlet", "Wand größe 1", "n" * 200], "material": ["steel", "zinc 2", "oak"]}
AREAS = {"group": [12.0, 20.0, 20.0], "material": [14.0, 14.0, 24.0]}
PORTABLE = {"group": ["inlet", "Wand_gr__e_1", "n" * 120], "material": ["steel", "zinc_2", "oak"]}
FACES = [("4 3 2 1", 0, 0), ("5 6 7 8", 0, 1), ("1 2 6 5", 1, 0), ("2 3 7 6", 1, 2), ("3 4 8 7", 2, 1), ("4 1 5 8", 2, 2)]


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def part():
    lines = ["v %g %g %g" % (x, y, z) for z in (0, 4) for x, y in ((0, 0), (2, 0), (2, 3), (0, 3))]
    for corners, group, material in FACES:
        lines += [f"g {NAMES['group'][group]}", f"usemtl {NAMES['material'][material]}", f"f {corners}"]
    return "\n".join(lines) + "\n"


def run(command, folder, **more):
    result = subprocess.run(command, capture_output=True, text=True, timeout=600, cwd=folder, **more)
    check(result.returncode == 0, f"{' '.join(command)}: exit code {result.returncode}: {result.stdout}{result.stderr}")
    return result.stdout


def near(found, wanted, what):
    check(all(abs(f - w) <= 1e-9 * w for f, w in zip(found, wanted, strict=True)), f"{what}: the areas are {found}")


def area_of(points):
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points
    u, v = (bx - ax, by - ay, bz - az), (cx - ax, cy - ay, cz - az)
    cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return sum(x * x for x in cross) ** 0.5 / 2


def with_tetgen(folder, kind):
    for form in ("smesh", "mesh"):
        run(["tetgen", "-pYAQ", f"part.{form}"], folder)
        rows = {}
        for ending in ("node", "face"):
            with open(os.path.join(folder, f"part.1.{ending}"), encoding="ascii") as file:
                lines = [line.split() for line in file if not line.startswith("#")][1:]
            rows[ending] = {int(line[0]): line[1:] for line in lines}
        areas = [0.0, 0.0, 0.0]
        for a, b, c, marker in ((int(x) for x in row[:4]) for row in rows["face"].values()):
            areas[marker - 1] += area_of([[float(x) for x in rows["node"][v][:3]] for v in (a, b, c)])
        near(areas, AREAS[kind], f"tetgen, {form}, {kind}")


def with_freefem(folder, kind):
    with open(os.path.join(folder, "part.edp"), "w", encoding="ascii") as file:
        file.write('load "msh3"\nmeshS Th = readmeshS("part.mesh");\n'
                   'for (int i = 1; i <= 3; i++) cout << "AREA " << i << " " << int2d(Th, i)(1.) << endl;\n')
    program = shutil.which("FreeFem++-nw") or shutil.which("FreeFem++")
    environment = {**os.environ, "FF_LOADPATH": "/usr/lib/freefem++"}
    text = run([program, "-nw", "-ne", "part.edp"], folder, env=environment)
    areas = [float(value) for value in re.findall(r"^AREA \d (\S+)", text, re.MULTILINE)]
    check(len(areas) == 3, f"freefem, {kind}: {text}")
    check(all(abs(f - w) <= 1e-4 * w for f, w in zip(areas, AREAS[kind], strict=True)), f"freefem, {kind}: {areas}")


def with_gmsh(folder, kind):
    for form in ("msh", "msh41"):
        text = open(os.path.join(folder, f"part.{form}"), encoding="utf-8").read()
        with open(os.path.join(folder, "part.geo"), "w", encoding="utf-8") as file:
            file.write(f'Merge "part.{form}";\n' + "\n".join(re.findall(r"^.*;$", text.split("$EndComments")[0], re.MULTILINE)))
        run(["gmsh", "-3", "part.geo", "-o", "filled.msh", "-format", "msh2"], folder)
        lines = open(os.path.join(folder, "filled.msh"), encoding="utf-8").read().splitlines()
        begin = lines.index("$PhysicalNames") + 2
        names = dict(re.fullmatch(r'(\d+ \d+) "(.*)"', line).groups() for line in lines[begin : lines.index("$EndPhysicalNames")])
        begin = lines.index("$Nodes") + 2
        points = {line.split()[0]: [float(x) for x in line.split()[1:]] for line in lines[begin : lines.index("$EndNodes")]}
        areas, filled = dict.fromkeys(PORTABLE[kind], 0.0), 0
        for row in (line.split() for line in lines[lines.index("$Elements") + 2 : lines.index("$EndElements")]):
            if row[1] == "2":
                areas[names[f"2 {row[3]}"]] += area_of([points[v] for v in row[5:8]])
            filled += row[1] == "4" and names[f"3 {row[3]}"] == "volume"
        near(list(areas.values()), AREAS[kind], f"gmsh, {form}, {kind}")
        check(filled > 0, f"gmsh, {form}: no tetrahedra")


def with_netgen(folder, kind):
    """The recipe for Netgen: its own readers of files keep no boundaries, so the triangles are handed over."""
    from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint
    from netgen.csg import Pnt

    lines = open(os.path.join(folder, "part.mesh"), encoding="utf-8").read().splitlines()
    names = dict(re.match(r"# reference (\d+): (.*)", line).groups() for line in lines if line.startswith("# reference"))
    begin, triangles = lines.index("Vertices") + 2, lines.index("Triangles") + 2
    mesh = Mesh(dim=3)
    points = [mesh.Add(MeshPoint(Pnt(*map(float, line.split()[:3])))) for line in lines[begin : triangles - 2]]
    for number, name in names.items():
        mesh.Add(FaceDescriptor(surfnr=int(number), domin=1, domout=0, bc=int(number)))
        mesh.SetBCName(int(number) - 1, name)
    for line in lines[triangles : lines.index("End")]:
        *corners, reference = map(int, line.split())
        mesh.Add(Element2D(reference, [points[v - 1] for v in corners]))
    mesh.GenerateVolumeMesh()
    check(len(mesh.Elements3D()) > 0, "netgen: no tetrahedra")
    check([mesh.GetBCName(i) for i in range(3)] == PORTABLE[kind], f"netgen, {kind}: the names differ")
    areas = [0.0, 0.0, 0.0]
    for element in mesh.Elements2D():
        areas[element.index - 1] += area_of([mesh[v].p for v in element.vertices])
    near(areas, AREAS[kind], f"netgen, {kind}")


def with_openfoam(folder, kind):
    # Debian's programs do not know where their own settings are.
    environment = {**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam", "FOAM_ETC": "/usr/share/openfoam/etc"}
    text = run(["surfaceCheck", "part.stl"], folder, env=environment)
    regions = re.findall(r"^(\S+)\t\d+$", text[text.index("Region\tSize") :], re.MULTILINE)
    check(regions == PORTABLE[kind], f"openfoam, {kind}: the regions are {regions}")
    check("Surface is closed" in text, f"openfoam, {kind}: {text}")


PROGRAMS = {"tetgen": with_tetgen, "gmsh": with_gmsh, "FreeFem++": with_freefem, "netgen": with_netgen,
            "surfaceCheck": with_openfoam}


def is_installed(name):
    if name != "netgen":
        return shutil.which(name) is not None
    try:
        import netgen.meshing  # noqa: F401
    except ImportError:
        return False
    return True


def main():
    remesh = os.path.abspath(sys.argv[1])
    for kind in ("group", "material"):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "source.obj"), "w", encoding="utf-8") as file:
                file.write(part())
            forms = {"part.smesh": ["smesh"], "part.mesh": ["mesh"], "part.msh": ["msh"], "part.stl": ["stl_ascii"],
                     "part.msh41": ["msh", "--msh-version", "4.1"]}
            for name, form in forms.items():
                run([remesh, "source.obj", "-o", name, "--format", *form, "--label", kind, "--max-edge-length", "1", "--report",
                     "report.json"], folder)
                with open(os.path.join(folder, "report.json"), encoding="utf-8") as file:
                    renamed = {label["from"]: label["to"] for label in json.load(file)["renamed_labels"]}
                wanted = {a: b for a, b in zip(NAMES[kind], PORTABLE[kind], strict=True) if a != b}
                check(renamed == wanted, f"{name}, {kind}: the report has the names {renamed}")
            for program, test in PROGRAMS.items():
                if is_installed(program):
                    test(folder, kind)
                    print(f"ok: {program}, {kind}")
    missing = [program for program in PROGRAMS if not is_installed(program)]
    if missing:
        print(f"SKIPPED: NOT READ BY {', '.join(missing)}: not installed")
    return 77 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
