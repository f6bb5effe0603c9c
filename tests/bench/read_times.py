"""How fast files are read, beside meshio: read_times.py READ_TIMES [--faces N]

A bumpy sheet of N triangles (400,000) is written in each format and variant by meshio where it can, else by remesh or here.
Both read it three times; the smallest processor time counts. Prints a table in Markdown: megabytes of the file a second
(of a compressed one: of what is in it), and how many times as fast as meshio. Where both leave the unpacking to zlib, the time
of zlib alone, which is the same for both, is told and taken from both. Exit code: 1 if text is read with less than 50 MB/s,
binary data with less than 200, or a file less than three times as fast as by meshio; 77 if meshio is missing.
"""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import zipfile
import zlib

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from tool import print_table, say  # noqa: E402

TEXT_MB, BINARY_MB, TIMES = 50, 200, 3
# The name of a file, and how meshio writes it; None where meshio has no such writer.
FILES = {
    "a.obj": {"file_format": "obj"},
    "text.stl": {"file_format": "stl", "binary": False},
    "binary.stl": {"file_format": "stl", "binary": True},
    "text.ply": {"file_format": "ply", "binary": False},
    "binary.ply": {"file_format": "ply", "binary": True},
    "a.off": {"file_format": "off"},
    "text.vtu": {"file_format": "vtu", "binary": False},
    "plain.vtu": {"file_format": "vtu", "binary": True, "compression": None},
    "zlib.vtu": {"file_format": "vtu", "binary": True, "compression": "zlib"},
    "text.vtk": {"file_format": "vtk", "binary": False},
    "binary.vtk": {"file_format": "vtk", "binary": True},
    "text22.msh": {"file_format": "gmsh22", "binary": False},
    "binary22.msh": {"file_format": "gmsh22", "binary": True},
    "text41.msh": {"file_format": "gmsh", "binary": False},
    "binary41.msh": {"file_format": "gmsh", "binary": True},
    "a.mesh": {"file_format": "medit"},
    "a.inp": {"file_format": "abaqus"},
    "a.bdf": {"file_format": "nastran"},
    "a.json": None,
    "a.glb": None,
    "a.3mf": None,
}


def sheet(faces):
    import numpy

    n = max(int((faces / 2) ** 0.5), 2)
    random = numpy.random.default_rng(1)
    x, y = numpy.meshgrid(numpy.arange(n + 1.0), numpy.arange(n + 1.0), indexing="ij")
    points = numpy.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1) + 0.2 * random.random((x.size, 3))
    corner = (numpy.arange(n)[:, None] * (n + 1) + numpy.arange(n)).ravel()
    return points, numpy.concatenate([numpy.stack([corner, corner + n + 1, corner + n + 2], axis=1),
                                      numpy.stack([corner, corner + n + 2, corner + 1], axis=1)])


def as_glb(points, faces):
    """One mesh of floats and 32-bit indices."""
    data = points.astype("<f4").tobytes() + faces.astype("<u4").tobytes()
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 12 * len(points)},
             {"buffer": 0, "byteOffset": 12 * len(points), "byteLength": 12 * len(faces)}]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                  "min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()},
                 {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}]
    head = json.dumps({"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data)}], "bufferViews": views,
                       "accessors": accessors, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                       "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}).encode()
    head += b" " * (-len(head) % 4)
    chunks = [len(head).to_bytes(4, "little"), b"JSON", head, len(data).to_bytes(4, "little"), b"BIN\0", data]
    body = b"".join(chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


def write_3mf(path, points, faces):
    vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in points.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces.tolist())
    model = ('<?xml version="1.0"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
             f'<resources><object id="1" type="model"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles>'
             '</mesh></object></resources><build><item objectid="1"/></build></model>')
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("[Content_Types].xml", '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/'
                      'content-types"><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-'
                      '3dmodel+xml"/></Types>')
        file.writestr("_rels/.rels", '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/'
                      'relationships"><Relationship Id="r" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/'
                      '3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        file.writestr("3D/3dmodel.model", model)
    return len(model)


def written(folder, points, faces):
    """The files, and the bytes in them where they are compressed."""
    import meshio

    inside = {}
    for name, how in FILES.items():
        path = folder / name
        say(f"writing {name}")
        if how is not None:
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                meshio.write(path, meshio.Mesh(points, [("triangle", faces)]), **how)
        elif name.endswith(".json"):
            path.write_text(json.dumps({"vertices": points.tolist(), "faces": faces.tolist()}), encoding="utf-8")
        elif name.endswith(".glb"):
            path.write_bytes(as_glb(points, faces))
        else:
            inside[name] = write_3mf(path, points, faces)
    inside["zlib.vtu"] = points.nbytes + faces.nbytes + 9 * len(faces)  # cells also have an offset of 8 bytes and a type
    return inside


def by_meshio(path, how):
    """The smallest processor time in milliseconds, and how much of it was zlib's; None if meshio does not read the file."""
    import meshio

    unpack, of_zlib, times = zlib.decompress, [], []

    def timed(*arguments, **options):
        start = time.process_time()
        try:
            return unpack(*arguments, **options)
        finally:
            of_zlib.append(time.process_time() - start)

    zlib.decompress = timed
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            for _ in range(3):
                of_zlib.clear()
                start = time.process_time()
                try:
                    meshio.read(path, file_format=how["file_format"].replace("gmsh22", "gmsh"))
                except (Exception, SystemExit):  # pylint: disable=broad-except
                    return None
                times.append((1e3 * (time.process_time() - start), 1e3 * sum(of_zlib)))
    finally:
        zlib.decompress = unpack
    return min(times)


def main():
    try:
        import meshio  # noqa: F401
    except ImportError:
        print("SKIPPED: meshio is not installed")
        return 77
    program = os.path.abspath(sys.argv[1])
    asked = int(sys.argv[sys.argv.index("--faces") + 1]) if "--faces" in sys.argv else 400_000
    points, faces = sheet(asked)
    rows, is_slow = [["file", "MB", "MB/s", "ms", "meshio, ms", "zlib, ms", "times as fast"]], False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        inside = written(folder, points, faces)
        for file, how in FILES.items():
            told = subprocess.run([program, str(folder / file)], capture_output=True, text=True, check=True).stdout.split("\t")
            if int(told[2]) != len(faces):
                raise AssertionError(f"{file}: {told[2]} faces of {len(faces)}")
            size, ms = inside.get(file, int(told[1])) / 1e6, float(told[3])
            theirs, of_zlib = (by_meshio(folder / file, how) if how else None) or (None, 0)
            own, their_own = ms - of_zlib, (theirs or 0) - of_zlib
            is_binary = file.startswith(("binary", "plain", "zlib")) or file.endswith(".glb")
            marks = ["" if 1e3 * size / ms >= (BINARY_MB if is_binary else TEXT_MB) else " (slow)",
                     "" if theirs is None or their_own >= TIMES * own else " (slow)"]
            is_slow = is_slow or any(marks)
            rows.append([file, f"{size:.1f}", f"{1e3 * size / ms:.0f}{marks[0]}", f"{ms:.0f}", f"{theirs:.0f}" if theirs else "-",
                         f"{of_zlib:.0f}" if of_zlib else "-", f"{their_own / own:.1f}{marks[1]}" if theirs else "-"])
    print_table(rows)
    return 1 if is_slow else 0


if __name__ == "__main__":
    sys.exit(main())
