"""Every written format, read back by programs that are not ours: meshio, VTK, Gmsh and TetGen.

usage: written_formats_test.py REMESH

A part with groups and materials is remeshed to each format. The JSON answer, read by Python's own parser, tells what must
be in the others: the same vertices, bit for bit (in STL: rounded to floats), and the same faces. Exit code 77: a reader is
not installed, and what it would have read was not tested.
"""

import importlib.util
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

PART = """o body
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0.1 0.2 0.7
v 1 0 0.6666666666666666
v 1 1 0.7
v 0 1 0.7
g Größe 3--4
usemtl steel
f 4 3 2 1
g "walls" & <roof>
f 5 6 7
f 5 7 8
usemtl zinc
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""

FORMATS = ["obj", "stl", "ply", "off", "vtu", "msh", "mesh"]
# Other forms of these formats, with the options that ask for them.
FORMS = {
    "msh41": ["--format", "msh", "--msh-version", "4.1"],
    "by_material": ["--format", "msh", "--msh-version", "4.1", "--label", "material"],
    "stl_ascii": ["--format", "stl_ascii"],
    "ply_ascii": ["--format", "ply_ascii"],
    "smesh": ["--format", "smesh"],
    "json": ["--format", "json"],
}


def to_float(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


class Expected:
    """The mesh as the JSON answer has it."""

    def __init__(self, mesh, report):
        self.points = [tuple(map(float, v)) for v in mesh["vertices"]]
        self.faces = [tuple(f) for f in mesh["faces"]]
        self.patches = mesh["face_patch"]
        self.surfaces = [report["patches"][p]["surface"] for p in self.patches]
        self.labels = mesh.get("labels")
        self.min_angle_deg = report["output"]["quality"]["min_angle_deg"]

    def boundary_names(self, kind):
        """The names that the groups or materials of the faces have in files for mesh programs."""
        labels = self.labels[kind]
        return [re.sub("[^A-Za-z0-9_.-]", "_", labels["names"][i]) for i in labels["of_face"]]

    def markers(self):
        return [g + 1 for g in self.labels["group"]["of_face"]]


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def check_mesh(expected, points, faces, what):
    """The same vertices in the same order, to the last bit, and the same faces."""
    points = [tuple(float(x) for x in p) for p in points]
    faces = [tuple(int(i) for i in f) for f in faces]
    check(points == expected.points, f"{what}: the vertices differ")
    check(faces == expected.faces, f"{what}: the faces differ")


def check_soup(expected, triangles, what):
    """The corners of each triangle in turn, rounded to floats."""
    rounded = [tuple(to_float(x) for x in p) for p in expected.points]
    wanted = [tuple(rounded[v] for v in face) for face in expected.faces]
    found = [tuple(tuple(float(x) for x in p) for p in triangle) for triangle in triangles]
    check(found == wanted, f"{what}: the triangles differ")


def with_meshio(labelled, plain):
    import meshio

    for kind in FORMATS:
        # Its PLY reader stumbles over any property of faces in binary files.
        expected, path = plain if kind == "ply" else labelled
        if kind == "msh":
            mesh = meshio.read(path[kind], file_format="gmsh")
        else:
            mesh = meshio.read(path[kind])
        faces = mesh.cells_dict["triangle"]
        what = f"meshio, {kind}"
        if kind == "stl":
            check_soup(expected, mesh.points[faces], what)
        else:
            check_mesh(expected, mesh.points, faces, what)
        if kind == "vtu":
            check(list(mesh.cell_data["patch"][0]) == expected.patches, f"{what}: the patches differ")
        if kind in ("vtu", "msh"):
            check([int(s) for s in mesh.cell_data["surface"][0]] == expected.surfaces, f"{what}: the surfaces differ")
        if kind == "msh":
            names = {tag: name for name, (tag, _) in mesh.field_data.items()}
            groups = [names[tag] for tag in mesh.cell_data["gmsh:physical"][0]]
            check(groups == expected.boundary_names("group"), f"{what}: the groups differ")
        if kind == "mesh":
            check(list(mesh.cell_data["medit:ref"][0]) == expected.markers(), f"{what}: the references differ")
        print(f"ok: {what}")
    expected, path = labelled
    # Version 4 has the faces of one patch after the other.
    mesh = meshio.read(path["msh41"], file_format="gmsh")
    names = {tag: name for name, (tag, dimension) in mesh.field_data.items() if dimension == 2}
    found = []
    for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True):
        found += [(*(int(v) for v in face), names[tag]) for face, tag in zip(block.data, tags, strict=True)]
    wanted = [(*face, name) for face, name in zip(expected.faces, expected.boundary_names("group"), strict=True)]
    check(sorted(found) == sorted(wanted), "meshio, msh 4.1: the faces or their groups differ")
    check([tuple(map(float, p)) for p in mesh.points] == expected.points, "meshio, msh 4.1: the vertices differ")
    print("ok: meshio, msh 4.1")
    mesh = meshio.read(path["ply_ascii"], file_format="ply")
    check_mesh(expected, mesh.points, mesh.cells_dict["triangle"], "meshio, ply_ascii")
    check(list(mesh.cell_data["group"][0]) == expected.labels["group"]["of_face"], "meshio, ply_ascii: the groups differ")
    print("ok: meshio, ply_ascii")
    # As text, all digits of the doubles are there.
    mesh = meshio.read(path["stl_ascii"], file_format="stl")
    found = [tuple(tuple(map(float, mesh.points[v])) for v in face) for face in mesh.cells_dict["triangle"]]
    check(found == [tuple(expected.points[v] for v in face) for face in expected.faces], "meshio, stl_ascii differs")
    print("ok: meshio, stl_ascii")


def with_vtk(labelled, _):
    import vtk

    expected, path = labelled

    def points_of(data):
        return [data.GetPoint(i) for i in range(data.GetNumberOfPoints())]

    def read(reader, file_name):
        reader.SetFileName(file_name)
        reader.Update()
        check(reader.GetErrorCode() == 0, f"vtk cannot read {file_name}")
        return reader.GetOutput()

    def cells_of(data):
        faces = []
        ids = vtk.vtkIdList()
        for c in range(data.GetNumberOfCells()):
            data.GetCellPoints(c, ids)
            faces.append(tuple(ids.GetId(i) for i in range(ids.GetNumberOfIds())))
        return faces

    grid = read(vtk.vtkXMLUnstructuredGridReader(), path["vtu"])
    check_mesh(expected, points_of(grid), cells_of(grid), "vtk, vtu")
    cell_data = grid.GetCellData()
    values = lambda name: [cell_data.GetArray(name).GetValue(i) for i in range(grid.GetNumberOfCells())]
    with open(path["vtu"], encoding="utf-8") as file:
        text = file.read()
    check(values("patch") == expected.patches, "vtk, vtu: the patches differ")
    check(values("surface") == expected.surfaces, "vtk, vtu: the surfaces differ")
    for kind in ("object", "group", "material"):
        labels = expected.labels[kind]
        check(values(kind) == labels["of_face"], f"vtk, vtu: the {kind}s differ")
        for i, name in enumerate(labels["names"]):
            comment = f"<!-- {kind} {i}: {name} -->".replace("3--4", "3-?4")
            check(comment in text, f"vtk, vtu: the name {name} is missing")
        array = grid.GetFieldData().GetArray(f"{kind}_names")
        names = [array.GetComponentName(i) for i in range(array.GetNumberOfComponents())]
        check(names == labels["names"], f"vtk, vtu: the names of {kind}s differ")
    # Verdict itself, as VTK has it inside, says what the quality is.
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(grid)
    for name, measure in (
        ("min_angle_deg", quality.SetTriangleQualityMeasureToMinAngle),
        ("aspect_ratio", quality.SetTriangleQualityMeasureToAspectRatio),
    ):
        measure()
        quality.Update()
        theirs = quality.GetOutput().GetCellData().GetArray("Quality")
        for i, ours in enumerate(values(name)):
            check(abs(theirs.GetValue(i) - ours) <= 1e-9 * abs(ours), f"vtk, vtu: {name} of cell {i} differs")
    check(min(values("min_angle_deg")) == expected.min_angle_deg, "vtk, vtu: the least angle differs")
    print("ok: vtk, vtu")

    # These two read into floats.
    stl = vtk.vtkSTLReader()
    stl.MergingOff()
    soup = read(stl, path["stl"])
    check_soup(expected, [[soup.GetPoint(v) for v in face] for face in cells_of(soup)], "vtk, stl")
    print("ok: vtk, stl")
    surface = read(vtk.vtkPLYReader(), path["ply"])
    check_soup(expected, [[surface.GetPoint(v) for v in face] for face in cells_of(surface)], "vtk, ply")
    print("ok: vtk, ply")


def with_gmsh(labelled, _):
    import gmsh

    expected, path = labelled

    def physical_groups(dimension):
        found = {}
        for dim, tag in gmsh.model.getPhysicalGroups(dimension):
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
                found[int(entity)] = gmsh.model.getPhysicalName(dim, tag)
        return found

    def triangles():
        """The corners and the entity of each triangle by its number."""
        found = {}
        for _, entity in gmsh.model.getEntities(2):
            _, elements, nodes = gmsh.model.mesh.getElements(2, entity)
            for i, element in enumerate(elements[0] if len(elements) else []):
                found[int(element)] = (tuple(int(n) - 1 for n in nodes[0][3 * i : 3 * i + 3]), entity)
        return found

    def check_vertices(what):
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        points = {int(t): tuple(coordinates[3 * i : 3 * i + 3]) for i, t in enumerate(tags)}
        check([points[i + 1] for i in range(len(expected.points))] == expected.points, f"{what}: the vertices differ")

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for form, kind in (("msh", "group"), ("msh41", "group"), ("by_material", "material")):
        what = f"gmsh, {form}"
        gmsh.clear()
        gmsh.merge(path[form])
        check_vertices(what)
        group_of, found = physical_groups(2), triangles()
        order = sorted(found)
        check([found[e][0] for e in order] == expected.faces, f"{what}: the faces differ")
        check([found[e][1] - 1 for e in order] == expected.patches, f"{what}: the patches differ")
        check([group_of[found[e][1]] for e in order] == expected.boundary_names(kind), f"{what}: the {kind}s differ")
        views = gmsh.view.getTags()
        check(len(views) == 1, f"{what}: there is not one view")
        _, elements, values, _, _ = gmsh.view.getModelData(views[0], 0)
        surface_of = {int(element): int(value[0]) for element, value in zip(elements, values, strict=True)}
        check([surface_of[e] for e in order] == expected.surfaces, f"{what}: the surfaces differ")
        print(f"ok: {what}")

        # The lines in the comments fill the surface, and leave its triangles and groups as they are.
        with open(path[form], encoding="utf-8") as file:
            comments = file.read().split("$EndComments")[0]
        lines = [line for line in comments.splitlines() if line.endswith(";")]
        source = path[form] + ".geo"
        with open(source, "w", encoding="utf-8") as file:
            file.write(f'Merge "{path[form]}";\n' + "\n".join(lines))
        gmsh.clear()
        gmsh.merge(source)
        gmsh.model.mesh.generate(3)
        check(set(physical_groups(3).values()) == {"volume"}, f"{what}, filled: there is no group of the volume")
        # It has given new numbers to the nodes.
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        points = {int(t): tuple(coordinates[3 * i : 3 * i + 3]) for i, t in enumerate(tags)}
        found = sorted((*sorted(points[v + 1] for v in f), physical_groups(2)[e]) for f, e in triangles().values())
        names = expected.boundary_names(kind)
        wanted = sorted((*sorted(expected.points[v] for v in f), n) for f, n in zip(expected.faces, names, strict=True))
        check(found == wanted, f"{what}, filled: the faces or their {kind}s differ")
        check(sum(len(tags) for tags in gmsh.model.mesh.getElements(3)[1]) > 0, f"{what}, filled: no tetrahedra")
        print(f"ok: {what}, filled")

    gmsh.clear()
    gmsh.merge(path["mesh"])
    check_vertices("gmsh, mesh")
    found = triangles()
    check([found[e] for e in sorted(found)] == list(zip(expected.faces, expected.markers(), strict=True)),
          "gmsh, mesh: the faces or their references differ")
    print("ok: gmsh, mesh")
    gmsh.clear()
    gmsh.merge(path["ply_ascii"])
    check(sum(len(tags) for tags in gmsh.model.mesh.getElements(2)[1]) == len(expected.faces), "gmsh, ply_ascii differs")
    print("ok: gmsh, ply_ascii")
    gmsh.finalize()


def with_tetgen(labelled, _):
    """TetGen fills the solid, with the surface as it is (-Y), and writes both again, with markers and regions (-A)."""
    expected, path = labelled
    for kind in ("off", "mesh", "smesh"):
        what = f"tetgen, {kind}"
        run = subprocess.run(["tetgen", "-pYAQ", path[kind]], capture_output=True, text=True, timeout=600)
        check(run.returncode == 0, f"{what}: exit code {run.returncode}: {run.stdout}{run.stderr}")

        def rows(ending):
            with open(os.path.splitext(path[kind])[0] + ending, encoding="ascii") as file:
                lines = [line.split() for line in file if not line.startswith("#")]
            check(len(lines) == int(lines[0][0]) + 1, f"{what}: {ending} is cut short")
            return [line[1:] for line in lines[1:]]

        points = [tuple(float(x) for x in row) for row in rows(".1.node")[: len(expected.points)]]
        # It prints 16 digits, one too few for all doubles.
        for found, wanted in zip(points, expected.points, strict=True):
            check(all(abs(f - w) <= 1e-15 for f, w in zip(found, wanted)), f"{what}: the vertices differ")
        first = 0 if kind == "off" else 1
        markers = [1] * len(expected.faces) if kind == "off" else expected.markers()
        faces = sorted((*sorted(int(i) - first for i in row[:3]), int(row[3])) for row in rows(".1.face"))
        wanted = sorted((*sorted(face), marker) for face, marker in zip(expected.faces, markers, strict=True))
        check(faces == wanted, f"{what}: the faces or their markers differ")
        check({row[4] for row in rows(".1.ele")} == {"1"}, f"{what}: the tetrahedra are not one region")
        print(f"ok: {what}")


# Programs that need a screen.
WITH_SCREEN = ("blender", "freecad", "paraview", "meshlab", "prusa-slicer", "netgen")


def has_module(line):
    module = re.search(r"import (meshio|vtk)", line)
    return module is None or importlib.util.find_spec(module.group(1)) is not None


def with_recipes(remesh, folder):
    """The lines that the report has for each format, run as they stand. The programs find all triangles."""
    source = os.path.join(folder, "source.obj")
    with open(source, "w", encoding="utf-8") as file:
        file.write(PART)
    # Debian's OpenFOAM and FreeFEM do not know where their own files are.
    environment = os.environ | {"PATH": "/usr/bin:" + os.environ["PATH"], "WM_PROJECT_DIR": "/usr/share/openfoam",
                                "FOAM_ETC": "/usr/share/openfoam/etc", "FF_LOADPATH": "/usr/lib/freefem++"}
    done = 0
    for form in FORMATS + [options[1] for name, options in FORMS.items() if name == options[1]]:
        place = os.path.join(folder, form)
        os.mkdir(place)
        ending = form.split("_")[0]
        subprocess.run([remesh, source, "-o", f"part.{ending}", "--format", form, "--report", "report.json", "--quiet"],
                       check=True, timeout=600, cwd=place)
        with open(os.path.join(place, "report.json"), encoding="utf-8") as file:
            report = json.load(file)
        check(report["recipe"], f"{form}: the report has no recipe")
        if form == "msh":
            with open(os.path.join(place, "part.msh"), encoding="utf-8") as file:
                comments = file.read().split("$EndComments")[0]
            geo = next(row["geo"] for row in report["recipe"] if row["program"] == "Gmsh")
            check(geo == [line for line in comments.splitlines() if line.endswith(";")] and len(geo) == 3, f"geo: {geo}")
        for row in report["recipe"]:
            what, lines = f"{row['program']}, {form}", "\n".join(row["lines"])
            command = lines.splitlines()[-1].split()[0] if lines else ""
            if not lines or command in WITH_SCREEN or not shutil.which(command) or not has_module(lines):
                continue
            ran = subprocess.run(["sh", "-ec", lines], capture_output=True, text=True, timeout=600, cwd=place, env=environment)
            check(ran.returncode == 0, f"{what}: {lines}: {ran.stdout}{ran.stderr}")
            faces = report["output"]["faces"]
            if command == "tetgen":
                with open(os.path.join(place, "part.1.ele"), encoding="ascii") as file:
                    check(int(file.readline().split()[0]) >= 6, f"{what}: there are too few tetrahedra")
            elif command == "gmsh":
                written = "filled.msh" if form == "msh" else "part.msh"
                with open(os.path.join(place, written), encoding="utf-8") as file:
                    found = file.read()
                count = int(re.search(r"\$Elements\n\d+ (\d+)", found).group(1))
                # With the volume there are its tetrahedra.
                check(count > faces if form == "msh" else count == faces, f"{what}: {count} elements")
                check(form != "msh" or '"volume"' in found, f"{what}: no volume")
            else:
                counts = [int(count) for count in re.findall(r"(?<![\w.])\d+(?![\w.])", ran.stdout)]
                # meshio has a block of triangles for each group of OBJ.
                in_blocks = sum(int(count) for count in re.findall(r"triangle: (\d+)", ran.stdout))
                check(faces in [*counts, in_blocks], f"{what}: not {faces} triangles: {ran.stdout}")
            done += 1
            print(f"ok: {what}, by its recipe")
    check(done > 10 or shutil.which("tetgen") is None, "hardly any program was tried")


def remesh_to_all(remesh, folder, part):
    """What is expected, and the path of the file of each format."""
    os.mkdir(folder)
    source = os.path.join(folder, "part.obj")
    with open(source, "w", encoding="utf-8") as file:
        file.write(part)
    path = {}
    forms = {kind: ["--format", kind] for kind in FORMATS} | FORMS
    for kind, options in forms.items():
        ending = options[1].split("_")[0]
        path[kind] = os.path.join(folder, f"{kind}.{ending}")
        subprocess.run([remesh, source, "-o", path[kind], *options, "--max-edge-length", "0.3"], check=True, timeout=600)
    with open(path["json"], encoding="utf-8") as file:
        answer = json.load(file)
    expected = Expected(answer["mesh"], answer["report"])
    check(len(expected.faces) > 50, "the part was not refined")
    return expected, path


def main():
    remesh = sys.argv[1]
    skipped = []
    unlabelled = "".join(line for line in PART.splitlines(True) if line[0] in "vf")
    with tempfile.TemporaryDirectory() as folder:
        labelled = remesh_to_all(remesh, os.path.join(folder, "labelled"), PART)
        plain = remesh_to_all(remesh, os.path.join(folder, "plain"), unlabelled)
        for name, test in (("meshio", with_meshio), ("vtk", with_vtk), ("gmsh", with_gmsh)):
            try:
                __import__(name)
            except ImportError:
                skipped.append(name)
                continue
            test(labelled, plain)
        os.mkdir(os.path.join(folder, "recipes"))
        with_recipes(os.path.abspath(remesh), os.path.join(folder, "recipes"))
        if shutil.which("tetgen") is None:
            skipped.append("tetgen")
        else:
            with_tetgen(labelled, plain)
    if skipped:
        print(f"SKIPPED: NOT READ BACK BY {', '.join(skipped)}: not installed for {sys.executable}")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
