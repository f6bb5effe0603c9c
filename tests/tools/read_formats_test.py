"""Files that other programs write, read by remesh: those of Gmsh, meshio and VTK in all their variants.

usage: read_formats_test.py REMESH

Each program writes a box with two groups, or what it can hold of it, in every format and variant that remesh reads. The JSON
answer of remesh must have the same vertices, faces and groups. Exit code 77: a program is not installed, and nothing was read
that it would have written.
"""

import json
import os
import subprocess
import sys
import tempfile

POINTS = [(x, y, z) for z in (0.0, 1.1) for x, y in ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0 / 3.0), (0.0, 1.0 / 3.0))]
QUADS = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]
# The bottom and the top are one group, the sides another one.
GROUPS = [7] * 4 + [9] * 8


def check(condition, message):
    if not condition:
        raise AssertionError(message)


class Reader:
    def __init__(self, remesh, folder):
        self.remesh, self.folder = remesh, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def check(self, what, path, labels=None, points=None):
        """Reads a file, and compares the faces and their groups. The labels are names; None: there must be none."""
        command = [self.remesh, path, "--format", "json", "-o", self.path("read.json"), "--refine", "false", "--plane-tolerance",
                   "1e-6", "--barriers", "none", "--report", self.path("report.json")]
        run = subprocess.run(command, capture_output=True, text=True, timeout=600)
        check(run.returncode == 0, f"{what}: {run.stderr}")
        with open(self.path("report.json"), encoding="utf-8") as file:
            found = json.load(file)["input"]
        check((found["vertices"], found["faces"], found["closed"]) == (8, 12, True), f"{what}: {found}")
        # Every vertex of a box is essential, so the remeshed box has the vertices of the file.
        with open(self.path("read.json"), encoding="utf-8") as file:
            mesh = json.load(file)["mesh"]
        vertices = sorted(tuple(map(float, v)) for v in mesh["vertices"])
        check(vertices == sorted(points or POINTS), f"{what}: the vertices differ")
        groups = mesh.get("labels", {}).get("group")
        names = [groups["names"][i] for i in groups["of_face"]] if groups else [str(g) for g in mesh.get("face_groups", [])]
        # The first group has the faces that are level.
        wanted = [labels[0 if len({mesh["vertices"][v][2] for v in face}) == 1 else -1] for face in mesh["faces"]] if labels else []
        check(names == wanted, f"{what}: the groups are {names}")
        print(f"ok: {what}")


def from_gmsh(reader):
    import gmsh

    names = ["level faces"] * 4 + ["sides"] * 8
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for tag, faces in ((1, range(4)), (2, range(4, 12))):
        gmsh.model.addDiscreteEntity(2, tag)
        if tag == 1:
            gmsh.model.mesh.addNodes(2, 1, list(range(11, 19)), [x for p in POINTS for x in p])
        gmsh.model.mesh.addElementsByType(tag, 2, [f + 1 for f in faces], [v + 11 for f in faces for v in TRIANGLES[f]])
        gmsh.model.addPhysicalGroup(2, [tag], 7 if tag == 1 else 9)
        gmsh.model.setPhysicalName(2, 7 if tag == 1 else 9, names[0 if tag == 1 else -1])
    for version in (2.2, 4.1):
        for binary in (0, 1):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            path = reader.path(f"gmsh-{version}-{binary}.msh")
            gmsh.write(path)
            reader.check(f"gmsh, msh {version}, {'binary' if binary else 'text'}", path, names)
    gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
    for ending in ("mesh", "vtk"):
        for binary in (0, 1) if ending == "vtk" else (0,):
            gmsh.option.setNumber("Mesh.Binary", binary)
            path = reader.path(f"gmsh-{binary}.{ending}")
            gmsh.write(path)
            # It writes fourteen digits in Medit's format, and no groups in VTK's.
            digits = [tuple(float(f"{x:.14g}") for x in p) for p in POINTS]
            groups, points = (["7"] * 4 + ["9"] * 8, digits) if ending == "mesh" else (None, POINTS)
            reader.check(f"gmsh, {ending}, {'binary' if binary else 'text'}", path, groups, points)
    gmsh.option.setNumber("Mesh.Binary", 0)
    # It writes fourteen decimals in Abaqus' format, and six or nine in Nastran's, whose properties are its surfaces.
    gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
    gmsh.option.setNumber("Mesh.SaveElementTagType", 1)
    for ending, style, decimals in (("inp", 0, 14), ("bdf", 0, 6), ("bdf", 1, 6), ("bdf", 2, 9)):
        gmsh.option.setNumber("Mesh.BdfFieldFormat", style)
        path = reader.path(f"gmsh-{style}.{ending}")
        gmsh.write(path)
        groups = ["level_faces", "sides"] if ending == "inp" else ["1", "2"]
        reader.check(f"gmsh, {ending}, {style}", path, groups, [tuple(round(x, decimals) for x in p) for p in POINTS])
    gmsh.finalize()


def from_meshio(reader):
    import meshio
    import numpy

    def mesh(**cell_data):
        return meshio.Mesh(numpy.array(POINTS), [("triangle", numpy.array(TRIANGLES))],
                           cell_data={name: [numpy.array(values)] for name, values in cell_data.items()})

    labels = [str(g) for g in GROUPS]
    for kind, binary in (("gmsh22", False), ("gmsh22", True), ("gmsh", False), ("gmsh", True)):
        path = reader.path(f"meshio-{kind}-{binary}.msh")
        data = {"gmsh:physical": GROUPS, "gmsh:geometrical": GROUPS} if kind == "gmsh22" else {}
        meshio.write(path, mesh(**data), file_format=kind, binary=binary)
        reader.check(f"meshio, {kind}, {'binary' if binary else 'text'}", path, labels if data else None)
    meshio.write(reader.path("meshio.mesh"), mesh(**{"medit:ref": GROUPS}))
    reader.check("meshio, mesh", reader.path("meshio.mesh"), labels)
    sets = meshio.Mesh(numpy.array(POINTS), [("triangle", numpy.array(TRIANGLES[:4])), ("triangle", numpy.array(TRIANGLES[4:]))],
                       cell_sets={"level faces": [numpy.arange(4), []], "sides": [[], numpy.arange(8)]})
    meshio.write(reader.path("meshio.inp"), sets)
    reader.check("meshio, inp", reader.path("meshio.inp"), ["level faces", "sides"])
    # It writes eleven or twelve digits.
    meshio.write(reader.path("meshio.bdf"), mesh(**{"nastran:ref": GROUPS}))
    reader.check("meshio, bdf", reader.path("meshio.bdf"), labels, [tuple(float(f"{x:.11e}") for x in p) for p in POINTS])
    for binary, compression in ((False, None), (True, None), (True, "zlib")):
        path = reader.path(f"meshio-{binary}-{compression}.vtu")
        meshio.write(path, mesh(group=GROUPS), binary=binary, compression=compression)
        # As text it writes twelve digits.
        points = POINTS if binary else [tuple(float(f"{x:.11e}") for x in p) for p in POINTS]
        reader.check(f"meshio, vtu, {'binary' if binary else 'text'}, {compression}", path, labels, points)
    for kind in ("vtk42", "vtk51"):
        for binary in (False, True):
            path = reader.path(f"meshio-{kind}-{binary}.vtk")
            try:
                meshio.write(path, mesh(group=GROUPS), file_format=kind, binary=binary)
            except (meshio.WriteError, SystemExit, KeyError):
                meshio.write(path, mesh(group=GROUPS), file_format="vtk", binary=binary)
            reader.check(f"meshio, {kind}, {'binary' if binary else 'text'}", path, labels)


def from_vtk(reader):
    import vtk

    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for p in POINTS:
        points.InsertNextPoint(*p)
    group = vtk.vtkIntArray()
    group.SetName("group")
    grid, surface, cells = vtk.vtkUnstructuredGrid(), vtk.vtkPolyData(), vtk.vtkCellArray()
    for face, label in zip(TRIANGLES, GROUPS, strict=True):
        ids = vtk.vtkIdList()
        for v in face:
            ids.InsertNextId(v)
        grid.InsertNextCell(vtk.VTK_TRIANGLE, ids)
        cells.InsertNextCell(ids)
        group.InsertNextValue(label)
    surface.SetPolys(cells)
    labels = [str(g) for g in GROUPS]
    for kind, data, xml, legacy in (("vtu", grid, vtk.vtkXMLUnstructuredGridWriter, vtk.vtkUnstructuredGridWriter),
                                    ("vtp", surface, vtk.vtkXMLPolyDataWriter, vtk.vtkPolyDataWriter)):
        data.SetPoints(points)
        data.GetCellData().AddArray(group)
        for mode in ("Ascii", "Binary", "Appended", "AppendedRaw"):
            for packing in ("None", "ZLib"):
                for header in (32, 64):
                    for order in ("Little", "Big"):
                        writer = xml()
                        path = reader.path(f"vtk-{mode}-{packing}-{header}-{order}.{kind}")
                        writer.SetFileName(path)
                        writer.SetInputData(data)
                        getattr(writer, f"SetDataModeTo{mode.removesuffix('Raw')}")()
                        writer.SetEncodeAppendedData(mode == "Appended")
                        getattr(writer, f"SetCompressorTypeTo{packing}")()
                        writer.SetBlockSize(64)
                        getattr(writer, f"SetHeaderTypeToUInt{header}")()
                        getattr(writer, f"SetByteOrderTo{order}Endian")()
                        check(writer.Write() == 1, f"vtk cannot write {path}")
                        reader.check(f"vtk, {kind}, {mode}, {packing}, {header}, {order}", path, labels)
        for version in (42, 51):
            for binary in (False, True):
                writer = legacy()
                path = reader.path(f"vtk-{kind}-{version}-{binary}.vtk")
                writer.SetFileName(path)
                writer.SetInputData(data)
                writer.SetFileVersion(version)
                writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
                check(writer.Write() == 1, f"vtk cannot write {path}")
                # As text it writes eleven digits.
                reader.check(f"vtk, {kind} as vtk {version}, {'binary' if binary else 'text'}", path, labels,
                             None if binary else [tuple(float(f"{x:.11g}") for x in p) for p in POINTS])


def main():
    skipped = []
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader(sys.argv[1], folder)
        for name, test in (("gmsh", from_gmsh), ("meshio", from_meshio), ("vtk", from_vtk)):
            try:
                __import__(name)
            except ImportError:
                skipped.append(name)
                continue
            test(reader)
    if skipped:
        print(f"SKIPPED: NOTHING READ THAT IS WRITTEN BY {', '.join(skipped)}: not installed for {sys.executable}")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
