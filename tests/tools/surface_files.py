"""Surfaces as files, for the tools beside this one: OBJ, OFF, PLY and STL in, what TetGen and Gmsh read out.

A reader of its own, so that what is compared with does not pass through the program that is tested.
"""

import gzip
import math
import pathlib
import struct

ENDINGS = (".obj", ".off", ".ply", ".stl")


class NotASurface(Exception):
    """The file cannot be read as a surface."""


class Surface:
    """Points, each of them used, no two with equal coordinates; faces as tuples of indices, counter-clockwise."""

    def __init__(self, points, faces):
        """Welds equal points, drops corners that repeat and faces with fewer than three, and points without a face."""
        index_of = {}
        self.points = []
        self.faces = []
        for face in faces:
            corners = []
            for corner in face:
                point = tuple(x + 0.0 for x in points[corner])  # -0 is 0
                if not all(map(math.isfinite, point)):
                    raise NotASurface("a coordinate is no number")
                if point not in index_of:
                    index_of[point] = len(self.points)
                    self.points.append(point)
                if index_of[point] not in corners[-1:]:
                    corners.append(index_of[point])
            if len(corners) > 1 and corners[0] == corners[-1]:
                corners.pop()
            if len(corners) >= 3:
                self.faces.append(tuple(corners))
        if not self.faces:
            raise NotASurface("no face")

    def half_edges(self):
        """For each pair of points that a face goes along, from smaller to larger: the faces that go so, and against."""
        edges = {}
        for f, face in enumerate(self.faces):
            for i, b in enumerate(face):
                a = face[i - 1]
                edges.setdefault((min(a, b), max(a, b)), ([], []))[a > b].append(f)
        return edges

    def is_closed(self):
        return all(len(along) + len(against) > 1 for along, against in self.half_edges().values())

    def diagonal(self):
        return math.dist([min(x) for x in zip(*self.points)], [max(x) for x in zip(*self.points)])


def is_surface_file(path):
    return name_without_gz(path).lower().endswith(ENDINGS)


def name_without_gz(path):
    name = pathlib.Path(path).name
    return name[:-3] if name.lower().endswith(".gz") else name


def read_surface(path):
    """Errors: NotASurface, OSError."""
    data = pathlib.Path(path).read_bytes()
    if str(path).lower().endswith(".gz"):
        data = gzip.decompress(data)
    ending = pathlib.Path(name_without_gz(path)).suffix.lower()
    reader = {".obj": read_obj, ".off": read_off, ".ply": read_ply, ".stl": read_stl}.get(ending)
    if reader is None:
        raise NotASurface(f"no format ends in {ending!r}")
    try:
        return Surface(*reader(data))
    except (ValueError, IndexError, KeyError, StopIteration, struct.error) as error:
        raise NotASurface(f"cannot be read: {error}") from error


def read_obj(data):
    points, faces = [], []
    for line in data.decode("utf-8", "replace").replace("\r\n", "\n").replace("\\\n", " ").splitlines():
        words = line.split("#", 1)[0].split()
        if words[:1] == ["v"]:
            points.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            faces.append([c - 1 if c > 0 else len(points) + c for c in corners])
    return points, faces


def read_off(data):
    lines = (line.split("#", 1)[0].split() for line in data.decode("utf-8", "replace").splitlines())
    lines = (words for words in lines if words)
    words = next(lines)
    if words[0].upper() == "OFF":
        words = words[1:] or next(lines)
    point_count, face_count = int(words[0]), int(words[1])
    points = [tuple(map(float, next(lines)[:3])) for _ in range(point_count)]
    faces = []
    for _ in range(face_count):
        words = next(lines)
        faces.append([int(word) for word in words[1 : 1 + int(words[0])]])
    return points, faces


def read_stl(data):
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        floats = (struct.unpack_from("<9f", data, at + 12) for at in range(84, len(data), 50))
        points = [triangle[i : i + 3] for triangle in floats for i in (0, 3, 6)]
    else:
        words = (line.split() for line in data.decode("utf-8", "replace").splitlines())
        points = [tuple(map(float, w[1:4])) for w in words if len(w) >= 4 and w[0].lower() == "vertex"]
    return points, [(i, i + 1, i + 2) for i in range(0, len(points) - 2, 3)]


def read_ply(data):
    """Text and binary of both byte orders; properties that are not coordinates or corners are passed over."""
    end = data.index(b"end_header")
    body = data.index(b"\n", end) + 1
    header = [line.split() for line in data[:end].decode("ascii", "replace").splitlines()]
    order = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[
        next(words[1] for words in header if words[:1] == ["format"])
    ]
    elements = []
    for words in header:
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])

    number = ply_text_numbers(data[body:]) if order is None else ply_binary_numbers(data, body, order)
    points, faces = [], []
    for element, count, properties in elements:
        for _ in range(count):
            row = {}
            for what in properties:
                if what[0] == "list":
                    row[what[-1]] = [number(what[2]) for _ in range(int(number(what[1])))]
                else:
                    row[what[-1]] = number(what[0])
            if element == "vertex":
                points.append((row["x"], row["y"], row["z"]))
            elif element == "face":
                corners = row["vertex_indices"] if "vertex_indices" in row else row["vertex_index"]
                faces.append([int(c) for c in corners])
    return points, faces


def ply_text_numbers(text):
    words = iter(text.split())
    return lambda kind: float(next(words))


def ply_binary_numbers(data, at, order):
    code_of = {
        "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
        "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
        "float64": "d",
    }  # fmt: skip
    packs = {kind: struct.Struct(order + code) for kind, code in code_of.items()}

    def number(kind):
        nonlocal at
        pack = packs[kind]
        (value,) = pack.unpack_from(data, at)
        at += pack.size
        return value

    return number


def write_obj(surface, path):
    """Coordinates as the shortest text that reads back to the same double; so in all writers here."""
    with open(path, "w", encoding="ascii") as out:
        for x, y, z in surface.points:
            out.write(f"v {x!r} {y!r} {z!r}\n")
        for face in surface.faces:
            out.write("f " + " ".join(str(corner + 1) for corner in face) + "\n")


def write_stl(surface, path):
    """As text, with all digits."""
    with open(path, "w", encoding="ascii") as file:
        file.write("solid\n")
        for face in surface.faces:
            file.write("facet normal 0 0 0\nouter loop\n")
            for corner in face:
                file.write("vertex {!r} {!r} {!r}\n".format(*surface.points[corner]))
            file.write("endloop\nendfacet\n")
        file.write("endsolid\n")


def write_smesh(surface, path):
    """TetGen's piecewise linear complex: a facet for each face."""
    with open(path, "w", encoding="ascii") as out:
        out.write(f"{len(surface.points)} 3 0 0\n")
        for i, (x, y, z) in enumerate(surface.points):
            out.write(f"{i} {x!r} {y!r} {z!r}\n")
        out.write(f"{len(surface.faces)} 0\n")
        for face in surface.faces:
            out.write(f"{len(face)} " + " ".join(map(str, face)) + "\n")
        out.write("0\n0\n")


def write_msh(surface, path):
    """Gmsh's format 2.2: all faces, which are triangles, in one discrete surface."""
    with open(path, "w", encoding="ascii") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
        out.write(f"$Nodes\n{len(surface.points)}\n")
        for i, (x, y, z) in enumerate(surface.points, 1):
            out.write(f"{i} {x!r} {y!r} {z!r}\n")
        out.write(f"$EndNodes\n$Elements\n{len(surface.faces)}\n")
        for i, (a, b, c) in enumerate(surface.faces, 1):
            out.write(f"{i} 2 2 0 1 {a + 1} {b + 1} {c + 1}\n")
        out.write("$EndElements\n")
