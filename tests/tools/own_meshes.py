"""Makes the small meshes of tests/data and the README.md that tells what they are: own_meshes.py [--check] [FOLDER]

Every mesh is drawn here by hand, with an answer that follows from its geometry. --check writes nothing and compares what
would be written with what is there. Exit code: 0 - written, or the same; 1 - what differs is listed.
"""

import math
import os
import struct
import sys

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "data")


class Mesh:
    """Points and polygons, which are counter-clockwise as seen from outside."""

    def __init__(self, points=(), faces=()):
        self.points = list(points)
        self.faces = [list(face) for face in faces]

    def add(self, other):
        first = len(self.points)
        self.points += other.points
        self.faces += [[first + v for v in face] for face in other.faces]
        return self

    def add_points(self, *points):
        self.points += points
        return [len(self.points) - len(points) + i for i in range(len(points))]

    def mapped(self, place):
        return Mesh([place(p) for p in self.points], self.faces)

    def turned_over(self):
        return Mesh(self.points, [face[::-1] for face in self.faces])

    def welded(self):
        """Points with equal coordinates become one."""
        number = {}
        for p in self.points:
            number.setdefault(p, len(number))
        return Mesh(number, [[number[self.points[v]] for v in face] for face in self.faces])

    def triangles(self):
        """A fan of triangles for each polygon, which must be convex."""
        return Mesh(self.points, [[f[0], f[i], f[i + 1]] for f in self.faces for i in range(1, len(f) - 1)])


def grid(origin, u, v, columns, rows):
    """Quads of a parallelogram, which faces along u x v."""
    def at(i, j):
        return tuple(o + i * a / columns + j * b / rows for o, a, b in zip(origin, u, v))

    points = [at(i, j) for j in range(rows + 1) for i in range(columns + 1)]
    faces = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            faces.append([a, a + 1, a + columns + 2, a + columns + 1])
    return Mesh(points, faces)


def box(low, high, cells=(1, 1, 1)):
    """The order of its sides is that of their normals: -z, +z, -y, +y, -x, +x."""
    (x, y, z), (nx, ny, nz) = low, cells
    a, b, c = (h - l for l, h in zip(low, high))
    mesh = Mesh()
    for side in (grid((x, y, z), (0, b, 0), (a, 0, 0), ny, nx), grid((x, y, high[2]), (a, 0, 0), (0, b, 0), nx, ny),
                 grid((x, y, z), (a, 0, 0), (0, 0, c), nx, nz), grid((x, high[1], z), (0, 0, c), (a, 0, 0), nz, nx),
                 grid((x, y, z), (0, 0, c), (0, b, 0), nz, ny), grid((high[0], y, z), (0, b, 0), (0, 0, c), ny, nz)):
        mesh.add(side)
    return mesh.welded()


def prism(base, height, cells=1):
    """Over a counter-clockwise polygon. Its sides are cut into `cells` along the height."""
    n = len(base)
    points = [(x, y, height * k / cells) for k in range(cells + 1) for x, y in base]
    faces = [list(range(n))[::-1], [cells * n + i for i in range(n)]]
    faces += [[k * n + i, k * n + (i + 1) % n, (k + 1) * n + (i + 1) % n, (k + 1) * n + i]
              for k in range(cells) for i in range(n)]
    return Mesh(points, faces)


def turned(mesh, degrees, axis):
    """Turned about an axis through the origin (the formula of Rodrigues)."""
    length = math.hypot(*axis)
    k = [a / length for a in axis]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def place(p):
        along = sum(a * b for a, b in zip(k, p))
        cross = (k[1] * p[2] - k[2] * p[1], k[2] * p[0] - k[0] * p[2], k[0] * p[1] - k[1] * p[0])
        return tuple(c * p[i] + s * cross[i] + (1 - c) * along * k[i] for i in range(3))

    return mesh.mapped(place)


# Formats


def number(x):
    """Twelve decimals are the same whatever the last bits of the system's sines are."""
    x = round(x, 12) + 0.0
    return str(int(x)) if x == int(x) else repr(x)


def line(word, values):
    return " ".join([word, *values] if word else values) + "\n"


def point_lines(mesh, word):
    return "".join(line(word, map(number, p)) for p in mesh.points)


def obj(mesh, labels=None):
    """`labels` has the lines that stand before a face, by its number."""
    text = point_lines(mesh, "v")
    for i, face in enumerate(mesh.faces):
        text += (labels or {}).get(i, "") + line("f", (str(v + 1) for v in face))
    return text.encode()


def off(mesh):
    text = f"OFF\n{len(mesh.points)} {len(mesh.faces)} 0\n" + point_lines(mesh, "")
    return (text + "".join(line(str(len(f)), map(str, f)) for f in mesh.faces)).encode()


def ply_header(mesh, form):
    return (f"ply\nformat {form} 1.0\nelement vertex {len(mesh.points)}\n" +
            "".join(f"property double {axis}\n" for axis in "xyz") +
            f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n")


def ply_text(mesh):
    return (ply_header(mesh, "ascii") + point_lines(mesh, "") +
            "".join(line(str(len(f)), map(str, f)) for f in mesh.faces)).encode()


def ply_binary(mesh):
    data = b"".join(struct.pack("<3d", *p) for p in mesh.points)
    return ply_header(mesh, "binary_little_endian").encode() + data + b"".join(
        struct.pack(f"<B{len(f)}i", len(f), *f) for f in mesh.faces)


def stl_text(corners, decimals):
    """`corners` has three points for each triangle."""
    text = "solid own\n"
    for triangle in corners:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join("vertex " + " ".join(f"{x:.{decimals}f}" for x in p) + "\n" for p in triangle)
        text += "endloop\nendfacet\n"
    return (text + "endsolid own\n").encode()


def stl_binary(mesh):
    data = b"own".ljust(80) + struct.pack("<I", len(mesh.faces))
    for face in mesh.faces:
        data += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *mesh.points[v]) for v in face) + bytes(2)
    return data


def corners_of(mesh):
    return [[mesh.points[v] for v in face] for face in mesh.triangles().faces]


# Meshes: each returns the bytes of the file.


def box_of_quads():
    return obj(box((0, 0, 0), (2, 3, 4), (2, 3, 4)))


def cylinder_of_facets():
    angles = [2 * math.pi * i / 24 for i in range(24)]
    return off(prism([(math.cos(a), math.sin(a)) for a in angles], 2))


SPHERE_RINGS, SPHERE_SIDES = 6, 8


def sphere():
    """Rings of trapezoids, which are plane, between two caps of triangles."""
    mesh = Mesh([(0.0, 0.0, -1.0)])
    for ring in range(1, SPHERE_RINGS):
        height, radius = -math.cos(math.pi * ring / SPHERE_RINGS), math.sin(math.pi * ring / SPHERE_RINGS)
        mesh.points += [(radius * math.cos(2 * math.pi * i / SPHERE_SIDES),
                         radius * math.sin(2 * math.pi * i / SPHERE_SIDES), height) for i in range(SPHERE_SIDES)]
    top, = mesh.add_points((0.0, 0.0, 1.0))
    for i in range(SPHERE_SIDES):
        j = (i + 1) % SPHERE_SIDES
        mesh.faces.append([0, 1 + j, 1 + i])
        for ring in range(SPHERE_RINGS - 2):
            first = 1 + ring * SPHERE_SIDES
            mesh.faces.append([first + i, first + j, first + SPHERE_SIDES + j, first + SPHERE_SIDES + i])
        last = 1 + (SPHERE_RINGS - 2) * SPHERE_SIDES
        mesh.faces.append([last + i, last + j, top])
    return off(mesh)


def sphere_measures():
    """The sums of its trapezoids and frustums: (area, volume)."""
    area = volume = 0
    share = math.sin(2 * math.pi / SPHERE_SIDES) * SPHERE_SIDES / 2  # of a regular polygon's area in its radius squared
    for ring in range(SPHERE_RINGS):
        (z0, r0), (z1, r1) = ((-math.cos(math.pi * k / SPHERE_RINGS), math.sin(math.pi * k / SPHERE_RINGS))
                              for k in (ring, ring + 1))
        apothem, half = math.cos(math.pi / SPHERE_SIDES), math.sin(math.pi / SPHERE_SIDES)
        area += SPHERE_SIDES * (r0 + r1) * half * math.hypot(z1 - z0, apothem * (r1 - r0))
        volume += share * (z1 - z0) * (r0 * r0 + r0 * r1 + r1 * r1) / 3
    return area, volume


def roof_sheet():
    mesh = grid((0, 0, 0), (4, 0, 0), (0, 3, 0), 4, 3)
    mesh.add(grid((4, 0, 0), (0, 0, 3), (0, 3, 0), 3, 3))
    return obj(mesh.welded().triangles())


def plate_with_bridged_hole():
    outer, hole = [(0, 0), (6, 0), (6, 4), (0, 4)], [(2, 1), (2, 3), (4, 3), (4, 1)]
    mesh = Mesh([(x, y, z) for z in (0, 1) for x, y in outer + hole])
    # One polygon goes around, over the bridge from corner 0 to corner 4, around the hole, and over the bridge back.
    way = [0, 1, 2, 3, 0, 4, 5, 6, 7, 4]
    mesh.faces = [way[::-1], [8 + v for v in way]]
    mesh.faces += [[first + i, first + (i + 1) % 4, 8 + first + (i + 1) % 4, 8 + first + i]
                   for first in (0, 4) for i in range(4)]
    return obj(mesh)


def t_junctions():
    mesh = box((0, 0, 0), (2, 2, 2))
    del mesh.faces[1]
    return obj(mesh.add(grid((0, 0, 2), (2, 0, 0), (0, 2, 0), 2, 2)).welded())


def duplicate_faces():
    mesh = box((0, 0, 0), (2, 2, 2))
    first, second = mesh.faces[1], mesh.faces[4]
    mesh.faces += [first[:], second[2:] + second[:2]]
    return obj(mesh)


def inside_out():
    return stl_binary(box((0, 0, 0), (1, 2, 3)).turned_over().triangles())


def cavity():
    mesh = box((0, 0, 0), (6, 6, 6)).add(box((1, 1, 1), (5, 5, 5)).turned_over())
    return ply_text(mesh.add(box((2, 2, 2), (4, 4, 4))))


def needles():
    mesh = box((0, 0, 0), (4, 2, 1))
    bottom, top, front, back, left, right = mesh.faces
    corner = {p: i for i, p in enumerate(mesh.points)}
    row = [corner[0, 2, 1]] + mesh.add_points(*((k / 8, 2, 1) for k in range(1, 32))) + [corner[4, 2, 1]]
    a, b = corner[0, 0, 1], corner[4, 0, 1]
    c, d = corner[0, 2, 0], corner[4, 2, 0]
    mesh.faces = [front, left, right, [a, b, row[-1]], [d, c, row[0]]]
    for near, far in zip(row, row[1:]):
        mesh.faces += [[a, far, near], [d, near, far]]
    # A point beside the middle of a side: the triangle over that side is a sliver.
    p, = mesh.add_points((2, 2.0**-20, 0))
    mesh.faces += [[bottom[i], bottom[(i + 1) % 4], p] for i in range(4)]
    return obj(mesh)


def touching_edge():
    return off(box((0, 0, 0), (1, 1, 1)).add(box((1, 1, 0), (2, 2, 1))).welded())


def touching_wall():
    first, second = box((0, 0, 0), (2, 2, 2)), box((2, 0, 0), (4, 2, 2))
    return obj(first.add(second), {0: "o first\n", 6: "o second\n"})


def labels():
    mesh = box((0, 0, 0), (2, 1, 1), (2, 1, 1))
    left = [face for face in mesh.faces if all(mesh.points[v][0] <= 1 for v in face)]
    right = [face for face in mesh.faces if face not in left]
    return obj(Mesh(mesh.points, left + right),
               {0: "o part\ng left\nusemtl red\n", len(left): "g right\nusemtl blue\n"})


def crack():
    """Two sides of a turned box are one unit of the last place beside the others, as after an export in two parts."""
    corners = corners_of(turned(box((0, 0, 0), (3, 2, 1)), 31, (1, 2, 3)))
    return stl_text([[(x + 1e-6, y, z) for x, y, z in triangle] if i < 4 else triangle
                     for i, triangle in enumerate(corners)], 6)


def noisy():
    mesh = Mesh()
    cubes = ((0, 0), (1, 0), (0, 1))
    for x, y in cubes:
        side = box((10 * x, 10 * y, 0), (10 * x + 10, 10 * y + 10, 10))
        beside = [None, None, (x, y - 1), (x, y + 1), (x - 1, y), (x + 1, y)]
        side.faces = [face for face, other in zip(side.faces, beside) if other not in cubes]
        mesh.add(side)
    return stl_text(corners_of(turned(mesh, 37, (1, -2, 2))), 3)


def octahedron():
    points = [(3.0, 0.0, 0.0), (-3.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, -3.0, 0.0), (0.0, 0.0, 3.0), (0.0, 0.0, -3.0)]
    around = [0, 2, 1, 3]
    faces = [[around[i], around[(i + 1) % 4], 4] for i in range(4)] + [[around[(i + 1) % 4], around[i], 5] for i in range(4)]
    return ply_binary(Mesh(points, faces))


def pages():
    mesh = Mesh()
    for x, y in ((2, 0), (0, 2), (-2, 0)):
        mesh.add(grid((0, 0, 0), (x, y, 0), (0, 0, 3), 2, 3))
    return obj(mesh.welded())


def mixed_winding():
    mesh = prism([(0, 0), (4, 0), (0, 3)], 2)
    for i in (1, 3):
        mesh.faces[i].reverse()
    return off(mesh)


def soup():
    """Every face has its own points; one face has no area, and one point belongs to no face."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4)]
    mesh = Mesh()
    for face in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]):
        mesh.add(Mesh([points[v] for v in face], [[0, 1, 2]]))
    mesh.add(Mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [[0, 1, 2]]))
    mesh.add_points((1, 1, 1))
    return obj(mesh)


def wedge():
    return obj(prism([(0, 0), (4, 0), (4, 1.5)], 2))


class Fact:
    """One row of the table. README tells what the columns are."""

    def __init__(self, make, ending, text, area, volume, euler, bodies, patches, triangles, rim=0.0, sharpest=90.0,
                 precision=1e-11, told="-"):
        self.name = make.__name__ + "." + ending
        self.make, self.text = make, text
        self.area, self.volume, self.rim = area, volume, rim
        self.euler, self.bodies, self.patches, self.triangles = euler, bodies, patches, triangles
        self.sharpest, self.precision, self.told = sharpest, precision, told

    def row(self):
        cells = [f"`{self.name}`", self.text, f"{self.area:.12g}", "-" if self.volume is None else f"{self.volume:.12g}",
                 f"{self.rim:g}", self.euler, self.bodies, self.patches, self.triangles, f"{self.sharpest:.4g}",
                 f"{self.precision:g}", self.told]
        return "| " + " | ".join(map(str, cells)) + " |\n"


def facts():
    side = 2 * math.sin(math.pi / 24)
    cap = 12 * math.sin(2 * math.pi / 24)
    sphere_area, sphere_volume = sphere_measures()
    # The sharpest corner of the sphere is that of the caps' triangles at the poles.
    reach = 2 * math.sin(math.pi / SPHERE_RINGS / 2)
    base = 2 * math.sin(math.pi / SPHERE_RINGS) * math.sin(math.pi / SPHERE_SIDES)
    pole = 2 * math.degrees(math.asin(base / 2 / reach))
    return [
        Fact(box_of_quads, "obj", "a closed box of 2 x 3 x 4, of quads", 52, 24, 2, 1, 6, 12),
        Fact(cylinder_of_facets, "off", "a prism over 24 sides of a circle of radius 1, 2 high; area 2 * 12 sin(15) + "
             "24 * 2 sin(7.5) * 2", 2 * cap + 24 * side * 2, 2 * cap, 2, 1, 26, 2 * 22 + 48),
        Fact(sphere, "off", f"a sphere of radius 1, of {SPHERE_RINGS} rings of {SPHERE_SIDES}; measures are sums over its "
             "trapezoids and frustums", sphere_area, sphere_volume, 2, 1, SPHERE_RINGS * SPHERE_SIDES,
             2 * SPHERE_SIDES + 2 * (SPHERE_RINGS - 2) * SPHERE_SIDES, sharpest=pole),
        Fact(roof_sheet, "obj", "an open sheet of 4 x 3 and 3 x 3, folded by 90 degrees", 21, None, 1, 1, 2, 4, rim=20, told="open_boundary"),
        Fact(plate_with_bridged_hole, "obj", "a plate of 6 x 4 x 1 with a hole of 2 x 2; top and bottom are one polygon "
             "each, with a bridge to the hole", 2 * 20 + 20 + 8, 20, 0, 1, 10, 2 * 8 + 16),
        Fact(t_junctions, "obj", "a box of 2 x 2 x 2, whose top has points on edges of the sides that do not know them",
             24, 8, 2, 1, 6, 12, told="t_junction"),
        Fact(duplicate_faces, "obj", "a box of 2 x 2 x 2 with two of its faces twice", 24, 8, 2, 1, 6, 12, told="duplicate_face"),
        Fact(inside_out, "stl", "a box of 1 x 2 x 3, all faces inwards; binary", 22, -6, 2, 1, 6, 12, told="inside_out"),
        Fact(cavity, "ply", "a cube of 6 with a cavity of 4, and in it a cube of 2; text", 6 * (36 + 16 + 4),
             216 - 64 + 8, 6, 3, 18, 36),
        Fact(needles, "obj", "a box of 4 x 2 x 1 of needles, and a sliver of angles near 0 and 180 degrees", 28, 8, 2, 1,
             6, 12),
        Fact(touching_edge, "off", "two cubes of 1 that touch along an edge, which has four faces", 12, 2, 3, 1, 12, 24,
             told="non_manifold_edge"),
        Fact(touching_wall, "obj", "two cubes of 2, each an object with its whole skin, that touch in a side", 48, 16, 4,
             1, 12, 24, told="overlapping_faces"),
        Fact(labels, "obj", "a box of 2 x 1 x 1; its halves have their own group and material", 10, 2, 2, 1, 10, 20),
        Fact(crack, "stl", "a turned box of 3 x 2 x 1, with two sides 0.000001 beside the others; text of 6 decimals", 22,
             6, 2, 1, 6, 12, precision=1e-6, told="seam"),
        Fact(noisy, "stl", "an L of three cubes of 10, turned and rounded to text of 3 decimals", 1400, 3000, 2, 1, 8,
             2 * 4 + 6 * 2, precision=1e-4),
        Fact(octahedron, "ply", "a regular octahedron with corners at distance 3; binary", 36 * math.sqrt(3), 36, 2, 1, 8,
             8, sharpest=60),
        Fact(pages, "obj", "three sheets of 2 x 3 that share an edge", 18, None, 1, 1, 3, 6, rim=21,
             told="open_boundary, non_manifold_edge"),
        Fact(mixed_winding, "off", "a prism over a triangle of 3, 4 and 5, 2 high; two of its faces look inwards", 36, 12, 2,
             1, 5, 8, sharpest=math.degrees(math.atan2(3, 4)), told="inconsistent_winding"),
        Fact(soup, "obj", "a tetrahedron with three edges of 4, every face with its own points, a face without area and "
             "an unused point", 24 + 8 * math.sqrt(3), 64 / 6, 2, 1, 4, 4, sharpest=45,
             told="duplicate_vertex, zero_area_face, unused_vertex"),
        Fact(wedge, "obj", "a prism over a triangle with sides of 4 and 1.5 at a right angle, 2 high",
             6 + 2 * (5.5 + math.sqrt(18.25)), 6, 2, 1, 5, 8, sharpest=math.degrees(math.atan2(1.5, 4))),
    ]


README = """# Meshes of our own

`python3 -B tests/tools/own_meshes.py` makes the meshes of the table and this file; the test `tools.own_meshes` fails if
one of them differs from what it makes. `bracket.obj` is the part in the figures, and `./dev figures` makes it.

`tests/core/own_meshes_test.cpp` remeshes each mesh and compares the result with this table. Its numbers follow from
geometry, not from a run:

- Area, volume (negative if all faces look inwards, none if the sheet is open), the length of the rim, and the Euler
  number V - E + F are those of the shape that the text tells of, once its defects are mended.
- Bodies are the parts that have no vertex in common.
- Patches are the plane parts between edges and labels.
- Triangles are those of a run without refinement. A patch with n corners and h holes has n - 2 + 2 h.
- The sharpest corner of a face, in degrees, tells whether an angle bound can be met everywhere.
- Measures are exact within the precision, relative to the area or volume itself. It allows for coordinates that were
  rounded in the file.
- The last column has the diagnostics that the report must have, among others. A mesh that has none is without defect.

| file | what it is | area | volume | rim | Euler | bodies | patches | triangles | sharpest | precision | told |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""


def files():
    rows = ""
    for fact in facts():
        yield fact.name, fact.make()
        rows += fact.row()
    yield "README.md", (README + rows).encode()


def main():
    arguments = [a for a in sys.argv[1:] if a != "--check"]
    folder = arguments[0] if arguments else FOLDER
    differs = 0
    for name, content in files():
        path = os.path.join(folder, name)
        if "--check" not in sys.argv:
            with open(path, "wb") as file:
                file.write(content)
            continue
        with open(path, "rb") if os.path.exists(path) else open(os.devnull, "rb") as file:
            if file.read() != content:
                print(f"{path} is not what own_meshes.py makes")
                differs = 1
    return differs


if __name__ == "__main__":
    sys.exit(main())
