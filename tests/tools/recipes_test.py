"""The recipes of api/recipes with the programs that they need: recipes_test.py REMESH REMESHD

A box with three groups is filled; its volume and its three boundaries must come out. Exit
code 77: none of the programs is installed.
"""

import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "support"))
from remeshd import Daemon  # noqa: E402

RECIPES = ROOT / "api/recipes"
# A box of 2 x 3 x 4: the bottom and the top, the front and the right side, the back and the left side.
AREAS = [12.0, 20.0, 20.0]
NAMES = ["inlet", "Wand_1", "rest"]
PART = """v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4
g inlet\nf 4 3 2 1\nf 5 6 7 8\ng Wand 1\nf 1 2 6 5\nf 2 3 7 6\ng rest\nf 3 4 8 7\nf 4 1 5 8\n"""


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def near(found, wanted):
    return len(found) == len(wanted) and all(abs(f - w) <= 1e-4 * w for f, w in zip(found, wanted))


def rows(path):
    with open(path, encoding="ascii") as file:
        return [line.split() for line in file if not line.startswith("#")][1:]


def volume(points, tetrahedra):
    total = 0.0
    for a, b, c, d in tetrahedra:
        (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = ([points[q][i] - points[a][i] for i in range(3)] for q in (b, c, d))
        total += abs(ux * (vy * wz - vz * wy) - uy * (vx * wz - vz * wx) + uz * (vx * wy - vy * wx)) / 6
    return total


def tetgen(folder, _):
    points = {row[0]: [float(x) for x in row[1:4]] for row in rows(folder / "part.1.node")}
    check(near([volume(points, (row[1:5] for row in rows(folder / "part.1.ele")))], [24.0]), "tetgen: the volume")
    check({row[4] for row in rows(folder / "part.1.face")} == {"1", "2", "3"}, "tetgen: the markers")


def gmsh(folder, _):
    text = (folder / "filled.msh").read_text(encoding="utf-8")
    names = re.findall(r'^[23] \d+ "(.*)"$', text, re.MULTILINE)
    check(sorted(names) == sorted([*NAMES, "volume"]), f"gmsh: the names are {names}")
    check(int(re.search(r"\$Elements\n\d+ (\d+)", text).group(1)) > 12, "gmsh: no tetrahedra")


def netgen(folder, told):
    check(re.search(r"[1-9]\d* tetrahedra, boundaries " + ", ".join(NAMES), told), f"netgen: {told}")
    check(all(name in (folder / "part.vol").read_text(encoding="utf-8") for name in NAMES), "netgen: the names")


def freefem(_, told):
    found = [float(x) for x in re.findall(r"^volume (\S+)", told, re.MULTILINE)]
    check(near(found, [24.0]), f"freefem: the volume is {found}: {told}")
    areas = dict(re.findall(r"^boundary (\d+) (\S+)", told, re.MULTILINE))
    check(near([float(areas[str(i)]) for i in (1, 2, 3)], AREAS) and len(areas) == 3, f"freefem: {areas}")


def openfoam(folder, told):
    check("Surface is closed" in told, f"openfoam: {told}")
    text = (folder / "system/part.geometry").read_text(encoding="utf-8")
    check(re.findall(r"(\S+) \{ name \1; \}", text) == NAMES, f"openfoam: {text}")


def paraview(_, told):
    check(re.search(r"[1-9]\d* triangles with .*patch.*\ngroups: inlet, Wand 1, rest", told), f"paraview: {told}")


def as_opensn_reads(path):
    """The records of a file by the rules of OpenSn's and ChiTech's readers, which were read in their sources: the words of a
    line are apart by single blanks, a face has as many corners as pairs of slashes, each `usemtl` is a new material, all
    faces are in one object, and the other objects have lines. Output: vertices, normals, faces, their materials, lines.
    """
    points, normals, faces, materials, lines, objects = [], [], [], [], {}, []
    material = -1
    for line in path.read_text(encoding="utf-8").split("\n")[:-1]:
        check(line.strip() and "  " not in line, "opensn: their readers stop at an empty line")
        keyword, *words = line.split(" ")
        if keyword == "o":
            objects.append(words[0])
        elif keyword == "usemtl":
            material += 1
        elif keyword in ("v", "vn"):
            (points if keyword == "v" else normals).append([float(word) for word in words])
        elif keyword == "f":
            check(line.count("/") == 2 * len(words) and objects == [objects[0]], f"opensn: {line}")
            faces.append([int(word.split("/")[0]) - 1 for word in words])
            check(all(0 < int(word.split("/")[-1]) <= len(normals) for word in words), f"opensn: no normal: {line}")
            materials.append(material)
        elif keyword == "l":
            lines.setdefault(objects[-1], []).append([int(word) - 1 for word in words])
    check(objects[0] not in lines and all(corner < len(points) for face in faces for corner in face), "opensn: the faces")
    return points, normals, faces, materials, lines


def opensn(folder, told):
    points, _, faces, materials, lines = as_opensn_reads(folder / "part.obj")
    check(not lines and near([volume([*points, [0, 0, 0]], [[*face, len(points)] for face in faces])], [24.0]), "opensn: the volume")
    areas = [0.0] * 3
    for face, material in zip(faces, materials):
        a, b, c = (points[corner] for corner in face)
        u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
        areas[material] += 0.5 * sum((u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2]) ** 2 for i in range(3)) ** 0.5
    check(near(areas, AREAS), f"opensn: the areas are {areas}")
    check(told.splitlines() == ["material 0: inlet", "material 1: Wand_1", "material 2: rest"], f"opensn: {told}")


# A square of 4 with a square hole of 2, as four corners of fuel and moderator by turns, which is seen from below.
SHEET = """v 0 0 0\nv 2 0 0\nv 4 0 0\nv 0 2 0\nv 4 2 0\nv 0 4 0\nv 2 4 0\nv 4 4 0\nv 2 1 0\nv 3 2 0\nv 2 3 0\nv 1 2 0
usemtl fuel\nf 1 4 12 9 2\nusemtl moderator\nf 2 9 10 5 3\nusemtl fuel\nf 5 10 11 7 8\nusemtl moderator\nf 4 6 7 11 12\n"""


def opensn_sheet(folder, told):
    points, normals, faces, materials, lines = as_opensn_reads(folder / "part.obj")
    check(all(normal == [0, 0, 1] for normal in normals), "opensn: the sheet is seen from above")
    areas = [0.0, 0.0]
    for face, material in zip(faces, materials):
        (ax, ay, _), (bx, by, _), (cx, cy, _) = (points[corner] for corner in face)
        areas[material] += 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    check(near(areas, [7.0, 7.0]), f"opensn: the areas are {areas}")
    # Every line is the edge of one face alone, and the lines of a boundary are as long as its side.
    edges = [frozenset(edge) for face in faces for edge in zip(face, face[1:] + face[:1])]
    check(all(edges.count(frozenset(line)) == 1 for members in lines.values() for line in members), "opensn: the edges")
    lengths = {name: sum(math.dist(points[a], points[b]) for a, b in members) for name, members in lines.items()}
    check(list(lengths) == ["inner", "xmax", "xmin", "ymax", "ymin"], f"opensn: the boundaries are {lengths}")
    check(near(list(lengths.values()), [4 * math.sqrt(2), 4, 4, 4, 4]), f"opensn: the lengths are {lengths}")
    check("material 0: fuel\nmaterial 1: moderator\nboundary 0: inner\n" in told, f"opensn: {told}")


def main():
    remesh, remeshd = (os.path.abspath(path) for path in sys.argv[1:])
    # Debian's OpenFOAM and FreeFEM do not know where their own files are.
    environment = {**os.environ, "REMESH": remesh, "PATH": "/usr/bin:" + os.environ["PATH"], "FF_LOADPATH": "/usr/lib/freefem++",
                   "WM_PROJECT_DIR": "/usr/share/openfoam", "FOAM_ETC": "/usr/share/openfoam/etc"}
    done, missing = [], []

    def run(command, folder):
        result = subprocess.run(command, capture_output=True, text=True, timeout=600, cwd=folder, env=environment)
        check(result.returncode == 0, f"{command}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
        done.append(command)
        return result.stdout

    def has_module(name):
        return subprocess.run(["/usr/bin/python3", "-c", f"import {name}"], capture_output=True).returncode == 0

    recipes = {"opensn.py": (opensn, True), "tetgen.sh": (tetgen, shutil.which("tetgen")), "gmsh.sh": (gmsh, shutil.which("gmsh")),
               "netgen.py": (netgen, has_module("netgen.meshing")), "freefem.sh": (freefem, shutil.which("FreeFem++")),
               "openfoam.sh": (openfoam, shutil.which("surfaceCheck")), "paraview.py": (paraview, has_module("vtk"))}
    for recipe, (test, is_there) in recipes.items():
        if not is_there:
            missing.append(recipe)
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "source.obj").write_text(PART, encoding="utf-8")
            program = "/usr/bin/python3" if recipe.endswith(".py") else "sh"
            test(folder, run([program, str(RECIPES / recipe), "source.obj"], folder))
            print(f"ok: {recipe}")
    with tempfile.TemporaryDirectory() as name:
        pathlib.Path(name, "sheet.obj").write_text(SHEET, encoding="utf-8")
        opensn_sheet(pathlib.Path(name), run(["/usr/bin/python3", str(RECIPES / "opensn.py"), "sheet.obj"], name))
        print("ok: opensn.py, of a sheet")
    if shutil.which("node"):
        with tempfile.TemporaryDirectory() as folder, Daemon(remeshd) as daemon:
            pathlib.Path(folder, "source.obj").write_text(PART, encoding="utf-8")
            told = run(["node", str(RECIPES / "browser.mjs"), f"http://127.0.0.1:{daemon.port}", "source.obj"], folder)
            check(re.match(r"[1-9]\d* triangles, closed: true, ready for a volume mesher: true", told), told)
            print("ok: browser.mjs")
    if missing:
        print(f"SKIPPED: NOT RUN: {', '.join(missing)}: their programs are not installed")
    return 0 if done else 77


if __name__ == "__main__":
    sys.exit(main())
