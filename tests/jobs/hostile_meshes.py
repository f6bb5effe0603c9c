"""Meshes that take much memory for their size, as OBJ: pairs of a name and a function that writes one to a path."""

import gzip
import math
import random


def write(path, vertices, faces):
    """Faces are lists of numbers from 0."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices)
        file.writelines("f " + " ".join(str(number + 1) for number in face) + "\n" for face in faces)


def components(count):
    """Triangles that do not touch each other."""
    def make(path):
        side = math.isqrt(count) + 1
        corners = ((0, 0, 0), (0.6, 0, 0.1), (0, 0.6, 0.2))
        write(path, ((i % side + x, i // side + y, z) for i in range(count) for x, y, z in corners),
              ((3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)))
    return make


def around(count, height, is_bumpy=False):
    """Facets about one vertex: a flat fan, or a cone with this height."""
    def make(path):
        def rim(i):
            angle = 2 * math.pi * i / count
            return math.cos(angle), math.sin(angle), (i % 2) * 0.1 if is_bumpy else 0
        write(path, [(0, 0, height), *map(rim, range(count))], ((0, i + 1, (i + 1) % count + 1) for i in range(count)))
    return make


def soup(count):
    """Random triangles in a cube, which cross each other."""
    def make(path):
        source = random.Random(count)
        write(path, ([source.random() for _ in range(3)] for _ in range(3 * count)),
              ((3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)))
    return make


def sheet(side):
    """A bumpy one: each face is a patch."""
    def make(path):
        source = random.Random(side)
        write(path, ((x, y, source.random()) for y in range(side) for x in range(side)),
              (face for y in range(side - 1) for x in range(side - 1) for a in [y * side + x]
               for face in ((a, a + 1, a + side + 1), (a, a + side + 1, a + side))))
    return make


def star(count):
    """One polygon."""
    def make(path):
        write(path, ((r * math.cos(2 * math.pi * i / count), r * math.sin(2 * math.pi * i / count), 0)
                     for i in range(count) for r in [1 + 0.5 * (i % 2)]), [range(count)])
    return make


def tangle(count):
    """One polygon that crosses itself."""
    def make(path):
        source = random.Random(count)
        write(path, ((source.random(), source.random(), 0) for _ in range(count)), [range(count)])
    return make


def groups(count):
    """Each face is a group of its own, with a long name."""
    def make(path):
        components(count)(path)
        with open(path, encoding="ascii") as file:
            lines = file.readlines()
        with open(path, "w", encoding="ascii") as file:
            for number, line in enumerate(lines):
                if line.startswith("f"):
                    file.write(f"g {'long' * 100}{number}\n")
                file.write(line)
    return make


def packed(make):
    """The same, compressed."""
    def make_packed(path):
        make(path)
        with open(path, "rb") as file:
            data = file.read()
        with gzip.open(path, "wb", compresslevel=6) as file:
            file.write(data)
    return make_packed


def families(is_short):
    """Names and makers. The short ones are a tenth as large."""
    small = 10 if is_short else 1
    plain = {}
    for count in (100_000, 300_000, 1_000_000):
        count //= small
        plain[f"{count} facets of a fan"] = around(count, 0)
        plain[f"{count} facets of a cone"] = around(count, 1)
        plain[f"{count} facets of a bumpy cone"] = around(count, 1, is_bumpy=True)
        plain[f"a soup of {count}"] = soup(count)
        plain[f"{count} components"] = components(count)
        plain[f"a star of {count} corners"] = star(count)
        plain[f"a tangle of {count} corners"] = tangle(count)
    for side in (300, 700):
        plain[f"a bumpy sheet of {2 * side * side // small} faces"] = sheet(int(side / math.sqrt(small)))
    plain[f"{200_000 // small} groups with long names"] = groups(200_000 // small)
    yield from plain.items()
    for name, make in plain.items():
        yield f"{name}, gzip", packed(make)
