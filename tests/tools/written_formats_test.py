"""Every written format, read back by programs that are not ours: meshio, VTK, Gmsh and TetGen.

usage: written_formats_test.py REMESH

A part with groups and materials is remeshed to each format. The JSON answer, read by Python's own parser, tells what must
be in the others: the same vertices, bit for bit (in STL: rounded to floats), and the same faces. Exit code 77: a reader is
not installed, and what it would have read was not tested.
"""

import json
import os
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

FORMATS = ["obj", "stl", "ply", "off", "vtu", "msh"]


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

    def group_names(self):
        groups = self.labels["group"]
        return [groups["names"][g] for g in groups["of_face"]]


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
            check(groups == [n.replace('"', "'") for n in expected.group_names()], f"{what}: the groups differ")
        print(f"ok: {what}")
    # As text, all digits of the doubles are there.
    expected, path = labelled
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

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path["msh"])
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = {int(t): tuple(coordinates[3 * i : 3 * i + 3]) for i, t in enumerate(tags)}
    check([points[i + 1] for i in range(len(points))] == expected.points, "gmsh, msh: the vertices differ")

    group_of_entity = {}
    for dimension, tag in gmsh.model.getPhysicalGroups(2):
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            group_of_entity[int(entity)] = gmsh.model.getPhysicalName(dimension, tag)
    faces, patches, groups = {}, {}, {}
    for _, entity in gmsh.model.getEntities(2):
        _, elements, nodes = gmsh.model.mesh.getElements(2, entity)
        for i, element in enumerate(elements[0]):
            faces[int(element)] = tuple(int(n) - 1 for n in nodes[0][3 * i : 3 * i + 3])
            patches[int(element)] = entity - 1
            groups[int(element)] = group_of_entity[int(entity)]
    order = sorted(faces)
    check([faces[e] for e in order] == expected.faces, "gmsh, msh: the faces differ")
    check([patches[e] for e in order] == expected.patches, "gmsh, msh: the patches differ")
    names = [n.replace('"', "'") for n in expected.group_names()]
    check([groups[e] for e in order] == names, "gmsh, msh: the groups differ")
    views = gmsh.view.getTags()
    check(len(views) == 1, "gmsh, msh: there is not one view")
    _, elements, values, _, _ = gmsh.view.getModelData(views[0], 0)
    surface_of = {int(element): int(value[0]) for element, value in zip(elements, values, strict=True)}
    check([surface_of[e] for e in order] == expected.surfaces, "gmsh, msh: the surfaces differ")
    gmsh.finalize()
    print("ok: gmsh, msh")


def with_tetgen(labelled, _):
    """TetGen fills the solid that the OFF file bounds, with the surface as it is (-Y), and writes both again."""
    expected, path = labelled
    run = subprocess.run(["tetgen", "-pYQ", path["off"]], capture_output=True, text=True, timeout=600)
    check(run.returncode == 0, f"tetgen, off: exit code {run.returncode}: {run.stdout}{run.stderr}")

    def rows(ending):
        with open(path["off"].removesuffix(".off") + ending, encoding="ascii") as file:
            lines = [line.split() for line in file if not line.startswith("#")]
        check(len(lines) == int(lines[0][0]) + 1, f"tetgen, off: {ending} is cut short")
        return [line[1:] for line in lines[1:]]

    points = [tuple(float(x) for x in row) for row in rows(".1.node")[: len(expected.points)]]
    # It prints 16 digits, one too few for all doubles.
    for found, wanted in zip(points, expected.points, strict=True):
        check(all(abs(f - w) <= 1e-15 for f, w in zip(found, wanted)), "tetgen, off: the vertices differ")
    faces = sorted(sorted(int(i) for i in row[:3]) for row in rows(".1.face"))
    check(faces == sorted(sorted(face) for face in expected.faces), "tetgen, off: the faces differ")
    check(len(rows(".1.ele")) > 0, "tetgen, off: no tetrahedra")
    print("ok: tetgen, off")


def remesh_to_all(remesh, folder, part):
    """What is expected, and the path of the file of each format."""
    os.mkdir(folder)
    source = os.path.join(folder, "part.obj")
    with open(source, "w", encoding="utf-8") as file:
        file.write(part)
    path = {}
    for kind in FORMATS + ["stl_ascii", "json"]:
        path[kind] = os.path.join(folder, "out." + kind)
        command = [remesh, source, "-o", path[kind], "--format", kind, "--max-edge-length", "0.3"]
        subprocess.run(command, check=True, timeout=600)
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
