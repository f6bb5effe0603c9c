"""Angles: the dihedral ones of tetrahedra and of a surface's edges, and the corners of faces. In degrees."""

import itertools
import math


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def least_dihedral(a, b, c, d):
    """The smallest of a tetrahedron's six dihedral angles; 0 if it has no volume.

    Along an edge with direction e the two faces have normals e x p and e x q, and the sine of their angle is
    |e| |six volumes| over the product of their lengths: exact for angles near 0, where a cosine alone is not.
    """
    ab, ac, ad = minus(b, a), minus(c, a), minus(d, a)
    bc, bd, cd = minus(c, b), minus(d, b), minus(d, c)
    volume = abs(dot(cross(ab, ac), ad))
    if volume == 0:
        return 0.0
    n_abc, n_abd, n_acd, n_bcd = cross(ab, ac), cross(ab, ad), cross(ac, ad), cross(bc, bd)
    return math.degrees(
        min(
            math.atan2(length(ab) * volume, dot(n_abc, n_abd)),
            math.atan2(length(ac) * volume, -dot(n_abc, n_acd)),
            math.atan2(length(ad) * volume, dot(n_abd, n_acd)),
            math.atan2(length(bc) * volume, dot(n_abc, n_bcd)),
            math.atan2(length(bd) * volume, -dot(n_abd, n_bcd)),
            math.atan2(length(cd) * volume, dot(n_acd, n_bcd)),
        )
    )


def least_corner(surface):
    """The smallest angle at a corner of all faces."""
    return min(least_corner_of(surface, face) for face in surface.faces)


def least_corner_of(surface, face):
    least = 180.0
    for i, b in enumerate(face):
        p = minus(surface.points[face[i - 1]], surface.points[b])
        q = minus(surface.points[face[(i + 1) % len(face)]], surface.points[b])
        least = min(least, math.degrees(math.atan2(length(cross(p, q)), dot(p, q))))
    return least


def face_normal(surface, face):
    """Newell's: twice the area long."""
    origin = surface.points[face[0]]
    normal = (0.0, 0.0, 0.0)
    for b, c in zip(face[1:], face[2:]):
        n = cross(minus(surface.points[b], origin), minus(surface.points[c], origin))
        normal = (normal[0] + n[0], normal[1] + n[1], normal[2] + n[2])
    return normal


def signed_volume(surface):
    """Six times what a closed surface encloses; negative if it is inside out."""
    origin = surface.points[0]
    return sum(dot(face_normal(surface, face), minus(surface.points[face[0]], origin)) for face in surface.faces)


def sharp_edges(surface, degrees):
    """The edges, as pairs of points, at which two faces meet under less than that, with the solid between them.

    Which side the solid is on tells the winding; where that is not consistent, either side counts. A face so thin that
    rounding could turn it (a height of a millionth of the diagonal) has no direction and makes no edge sharp.
    """
    edges = surface.half_edges()
    is_oriented = all(len(along) == len(against) for along, against in edges.values())
    outward = -1 if is_oriented and signed_volume(surface) < 0 else 1
    thin = 1e-6 * surface.diagonal()
    normals = []
    for face in surface.faces:
        normal = face_normal(surface, face)
        twice_area = length(normal)
        longest = max(math.dist(surface.points[face[i - 1]], surface.points[b]) for i, b in enumerate(face))
        normals.append(tuple(x / twice_area for x in normal) if twice_area > thin * longest else None)

    found = []
    for (a, b), (along, against) in edges.items():
        ends = surface.points[a], surface.points[b]
        direction = minus(ends[1], ends[0])
        # each face's normal, and the direction in which it leaves the edge
        leaving = [(normals[f], cross(normals[f], direction)) for f in along if normals[f]]
        leaving += [(normals[f], cross(direction, normals[f])) for f in against if normals[f]]
        for (n, p), (m, q) in itertools.combinations(leaving, 2):
            angle = math.degrees(math.atan2(length(cross(p, q)), dot(p, q)))
            is_solid_between = not is_oriented or outward * dot(n, q) < 0
            if angle < degrees and is_solid_between:
                found.append(ends)
                break
    return found


class NearSegments:
    """Tells whether a point lies on one of many segments, to a tolerance; by a grid of cells along them."""

    def __init__(self, segments, tolerance, cell):
        self.tolerance = tolerance
        self.cell = cell
        self.cells = {}
        for p, q in segments:
            steps = max(1, math.ceil(2 * math.dist(p, q) / cell))
            touched = set()
            for i in range(steps + 1):
                t = i / steps
                touched.update(self._around([p[k] + t * (q[k] - p[k]) for k in range(3)]))
            for key in touched:
                self.cells.setdefault(key, []).append((p, q))

    def _key(self, point):
        return tuple(math.floor(x / self.cell) for x in point)

    def _around(self, point):
        i, j, k = self._key(point)
        return ((i + x, j + y, k + z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1))

    def __contains__(self, point):
        for p, q in self.cells.get(self._key(point), ()):
            along = minus(q, p)
            t = max(0.0, min(1.0, dot(minus(point, p), along) / dot(along, along)))
            nearest = [p[k] + t * along[k] for k in range(3)]
            if math.dist(point, nearest) <= self.tolerance:
                return True
        return False
