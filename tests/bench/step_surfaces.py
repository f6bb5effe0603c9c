"""The surfaces of a STEP file, as its tessellation and the table beside it tell them, and how far points are from them.

A face of the STEP file is a piece of a plane, cylinder, cone, sphere or torus, which a formula gives exactly, or it is
of another kind, and then its triangles stand for it. How far the piece reaches is known from its triangles alone. Thus
the distance of a point to a face is taken as the larger of two numbers, neither of which exceeds the true distance: the
distance to the whole surface, by the formula, and the distance to the triangles less the height of their chords. Where
the nearest point of the surface lies within the face, the first is the true distance. Nobody has to tell which face a
point belongs to: it is the nearest one, and a surface does not count beyond the edges of its face.
"""

import collections
import csv
import math
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import surface_files  # noqa: E402
from dihedral import cross, dot, length, minus  # noqa: E402

LEAF = 4  # triangles at an end of the tree
CELLS = 64  # no triangle in the tree is longer than this part of the diagonal
RECENT = 8  # triangles that are tried first, since most points are near the last ones


class Face:
    """The surface of a face; `chord` is how far its triangles may be from it."""

    def __init__(self, kind, point=None, axis=None, r1=None, r2=None, half_angle_deg=None, chord=0.0):
        self.chord = chord
        self.kind = kind
        self.point = point
        self.axis = axis
        self.r1 = r1
        self.r2 = r2
        if kind == "cone":
            self.along = math.cos(math.radians(half_angle_deg))
            self.across = math.sin(math.radians(half_angle_deg))

    def distance(self, point):
        """To the whole surface; 0 if no formula is known."""
        if self.kind == "other":
            return 0.0
        from_point = minus(point, self.point)
        if self.kind == "sphere":
            return abs(length(from_point) - self.r1)
        height = dot(from_point, self.axis)
        if self.kind == "plane":
            return abs(height)
        radius = length(cross(from_point, self.axis))
        if self.kind == "cylinder":
            return abs(radius - self.r1)
        if self.kind == "cone":  # of its two halves the one that the axis points into
            if height * self.along + radius * self.across < 0:
                return length(from_point)
            return abs(radius * self.along - height * self.across)
        if self.kind == "torus":  # a ring as thick as it is wide is met on both sides of its axis
            return min(abs(math.hypot(radius - ring, height) - self.r2) for ring in (self.r1, -self.r1))
        raise ValueError(f"no surface is called {self.kind}")


class StepSurfaces:
    """All faces of a STEP file, in a tree of boxes around their triangles."""

    def __init__(self, triangles, faces):
        """`triangles`: corners and the index of the face, (a, b, c, face)."""
        coordinates = list(zip(*(corner for triangle in triangles for corner in triangle[:3])))
        diagonal = math.dist(list(map(min, coordinates)), list(map(max, coordinates)))
        self.triangles = cut_to_length(triangles, diagonal / CELLS)
        self.faces = faces
        self._boxes, self._chords, self._rights, self._ranges = [], [], [], []
        self._order = self._build()
        self._recent = collections.deque(maxlen=RECENT)  # triangles that were near enough, the last one first

    def _build(self):
        """Each node is followed by its left child; `_rights` has the other one, or 0 at an end of the tree."""
        boxes = [
            tuple(min(x) for x in zip(a, b, c)) + tuple(max(x) for x in zip(a, b, c)) for a, b, c, _ in self.triangles
        ]
        order = list(range(len(boxes)))
        waiting = [(0, len(order), None)]
        while waiting:
            first, last, parent = waiting.pop()
            if parent is not None:
                self._rights[parent] = len(self._boxes)
            part = order[first:last]
            of_part = list(zip(*(boxes[i] for i in part)))
            box = tuple(map(min, of_part[:3])) + tuple(map(max, of_part[3:]))
            node = len(self._boxes)
            self._boxes.append(box)
            self._chords.append(max(self.faces[self.triangles[i][3]].chord for i in part))
            self._rights.append(0)
            self._ranges.append((first, last))
            if last - first <= LEAF:
                continue
            k = max(range(3), key=lambda k: box[k + 3] - box[k])
            order[first:last] = sorted(part, key=lambda i: boxes[i][k] + boxes[i][k + 3])
            middle = (first + last) // 2
            waiting += [(middle, last, node), (first, middle, None)]
        return order

    def distance(self, point, enough=0.0):
        """Of the nearest face. It is exact where it exceeds `enough`, and else some number that does not."""
        for i in self._recent:
            if self._to_triangle(i, point, math.inf) <= enough:
                return enough
        best = math.inf
        waiting = [(0.0, 0)]
        while waiting and best > enough:
            squared, node = waiting.pop()
            if squared >= (best + self._chords[node]) ** 2:
                continue
            right = self._rights[node]
            if right:
                children = [(squared_to_box(point, self._boxes[child]), child) for child in (right, node + 1)]
                waiting += sorted(children, reverse=True)  # the nearer one is taken first
                continue
            first, last = self._ranges[node]
            for i in self._order[first:last]:
                best = min(best, self._to_triangle(i, point, best))
                if best <= enough:
                    self._recent.appendleft(i)
                    break
        return best

    def _to_triangle(self, i, point, below):
        """The distance to its face as far as it reaches around this triangle; exact where it is below a number."""
        a, b, c, index = self.triangles[i]
        face = self.faces[index]
        exact = face.distance(point)
        return exact if exact >= below else max(exact, distance_to_triangle(point, a, b, c) - face.chord)

    def greatest_distance(self, surface):
        """Of the vertices, the middles of the edges and the centroids of a surface."""
        greatest = 0.0
        for point in points_of(surface):
            greatest = max(greatest, self.distance(point, greatest))
        return greatest


def cut_to_length(triangles, length):
    """The same triangles in pieces without a longer edge: the box of a long one that lies askew has much room."""
    pieces, waiting = [], list(triangles)
    while waiting:
        triangle = waiting.pop()
        a, b, c, face = triangle
        longest, i = max((math.dist(b, c), 0), (math.dist(c, a), 1), (math.dist(a, b), 2))
        if longest <= length:
            pieces.append(triangle)
            continue
        top, p, q = (a, b, c)[i], (b, c, a)[i], (c, a, b)[i]
        middle = tuple((x + y) / 2 for x, y in zip(p, q))
        waiting += [(top, p, middle, face), (top, middle, q, face)]
    return pieces


def points_of(surface):
    """Where a surface is measured; first where it is likely to be far."""
    points = surface.points
    for a, b in surface.half_edges():
        yield tuple((x + y) / 2 for x, y in zip(points[a], points[b]))
    for face in surface.faces:
        yield tuple(sum(x) / len(face) for x in zip(*(points[corner] for corner in face)))
    yield from points


def squared_to_box(point, box):
    x = max(box[0] - point[0], 0.0, point[0] - box[3])
    y = max(box[1] - point[1], 0.0, point[1] - box[4])
    z = max(box[2] - point[2], 0.0, point[2] - box[5])
    return x * x + y * y + z * z


def distance_to_triangle(point, a, b, c):
    u, v, w = minus(b, a), minus(c, a), minus(point, a)
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    # Where the foot of the point in the plane lies, in shares of the two edges, times the determinant.
    determinant = uu * vv - uv * uv
    s, t = vv * uw - uv * vw, uu * vw - uv * uw
    if determinant > 0 and s >= 0 and t >= 0 and s + t <= determinant:
        normal = cross(u, v)
        return abs(dot(normal, w)) / length(normal)
    return min(distance_to_segment(point, *ends) for ends in ((a, b), (b, c), (c, a)))


def distance_to_segment(point, a, b):
    along, away = minus(b, a), minus(point, a)
    squared = dot(along, along)
    t = max(0.0, min(1.0, dot(along, away) / squared)) if squared > 0 else 0.0
    return length((away[0] - t * along[0], away[1] - t * along[1], away[2] - t * along[2]))


def read_step_surfaces(stl):
    """The tessellation NAME.stl of a STEP file and NAME.surfaces.tsv beside it."""
    stl = pathlib.Path(stl)
    corners, _ = surface_files.read_stl(stl.read_bytes())
    faces, triangles = [], []
    with open(stl.with_suffix(".surfaces.tsv"), encoding="ascii") as rows:
        for row in csv.DictReader(rows, delimiter="\t"):
            number = lambda name: float(row[name]) if row[name] else None
            vector = lambda names: tuple(map(number, names)) if row[names[0]] else None
            for i in range(int(row["first"]), int(row["first"]) + int(row["count"])):
                triangles.append((*corners[3 * i : 3 * i + 3], len(faces)))
            faces.append(Face(row["kind"], vector(["px", "py", "pz"]), vector(["ax", "ay", "az"]), number("r1"),
                              number("r2"), number("half_angle"), number("chord") or 0.0))
    return StepSurfaces(triangles, faces)
