"""Tests of the tools beside this file, against analytic answers."""

import contextlib
import gzip
import io
import math
import pathlib
import random
import struct
import sys
import tempfile
import unittest

import dihedral
import surface_files
import volume_check
from surface_files import Surface

CUBE_POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CUBE_FACES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
CUBE_TRIANGLES = [(f[0], f[i], f[i + 1]) for f in CUBE_FACES for i in (1, 2)]


def turned_inside_out(surface):
    return Surface(surface.points, [face[::-1] for face in surface.faces])


def prism(polygon):
    """Of height 1 over a polygon that is counter-clockwise in the plane."""
    n = len(polygon)
    points = [(x, y, z) for z in (0.0, 1.0) for x, y in polygon]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return Surface(points, [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides])


class Dihedral(unittest.TestCase):
    def test_a_regular_tetrahedron_has_70_53_degrees(self):
        corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
        self.assertAlmostEqual(dihedral.least_dihedral(*corners), 70.528779365509, places=11)

    def test_the_corner_of_a_cube_has_54_74_degrees_whatever_the_order(self):
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        for _ in range(24):
            random.shuffle(corners)
            self.assertAlmostEqual(dihedral.least_dihedral(*corners), math.degrees(math.atan(math.sqrt(2))), places=11)

    def test_each_of_the_six_edges_is_looked_at(self):
        # Two faces that meet under 10 degrees along the edge of the first two corners; the other angles are larger.
        angle = math.radians(10)
        wedge = [(-1, 0, 0), (1, 0, 0), (0.1, 1, 0), (-0.1, math.cos(angle), math.sin(angle))]
        for i in range(4):
            for j in range(4):
                if i == j:
                    continue
                rest = iter(wedge[2:])
                corners = [wedge[0] if k == i else wedge[1] if k == j else next(rest) for k in range(4)]
                self.assertAlmostEqual(dihedral.least_dihedral(*corners), 10, places=11)

    def test_angles_near_0_are_not_lost_in_rounding(self):
        angle = 1e-9
        corners = [(0, 0, 0), (1, 0, 0), (0.4, 1, 0), (0.6, math.cos(angle), math.sin(angle))]
        self.assertAlmostEqual(dihedral.least_dihedral(*corners) / math.degrees(angle), 1, places=6)
        self.assertEqual(dihedral.least_dihedral((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)), 0)

    def test_a_wedge_is_sharp_and_a_slot_of_the_same_angle_is_not(self):
        tip = (math.cos(math.radians(20)), math.sin(math.radians(20)))
        wedge = prism([(0, 0), (1, 0), tip])
        for surface in (wedge, turned_inside_out(wedge)):
            self.assertEqual([set(e) for e in dihedral.sharp_edges(surface, 30)], [{(0, 0, 0), (0, 0, 1)}])
            self.assertEqual(dihedral.sharp_edges(surface, 19.9), [])
        slot = prism([(0, 0), tip, (-2, 3), (-2, -3), (3, -3), (1, 0)])
        self.assertEqual(dihedral.sharp_edges(slot, 30), [])
        self.assertEqual(dihedral.sharp_edges(turned_inside_out(slot), 30), [])

    def test_points_on_segments_are_told_from_points_beside_them(self):
        numbers = random.Random(1)
        point = lambda: tuple(numbers.uniform(-1, 1) for _ in range(3))
        segments = [(point(), point()) for _ in range(20)]
        near = dihedral.NearSegments(segments, 1e-6, 0.1)
        for p, q in segments:
            for t in (0, 0.37, 1):
                self.assertIn(tuple(p[k] + t * (q[k] - p[k]) for k in range(3)), near)
            self.assertNotIn(tuple(p[k] + 1.001 * (q[k] - p[k]) for k in range(3)), near)
            across = dihedral.cross(dihedral.minus(q, p), (0.3, 0.5, 0.7))
            off = [1e-5 / dihedral.length(across) * x for x in across]
            self.assertNotIn(tuple(p[k] + off[k] for k in range(3)), near)
        self.assertNotIn((0, 0, 0), dihedral.NearSegments([], 1, 1))


class SurfaceFiles(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = pathlib.Path(self._folder.name)

    def read(self, name, data):
        (self.folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
        return surface_files.read_surface(self.folder / name)

    def expect_cube(self, surface, faces):
        self.assertEqual(sorted(surface.points), sorted(tuple(map(float, p)) for p in CUBE_POINTS))
        self.assertEqual(len(surface.faces), faces)
        self.assertTrue(surface.is_closed())
        self.assertAlmostEqual(dihedral.signed_volume(surface) / 6, 1)

    def test_a_cube_is_a_cube_in_every_format(self):
        points = "".join(f"v {x} {y} {z}\n" for x, y, z in CUBE_POINTS)
        obj = points + "".join("f " + " ".join(f"{c + 1}//1" for c in f) + "\n" for f in CUBE_FACES)
        self.expect_cube(self.read("a.obj", "vn 0 0 1\n# f 1 2 3\n" + obj), 6)
        self.expect_cube(self.read("a.obj.gz", gzip.compress(obj.encode())), 6)
        backwards = points + "".join("f " + " ".join(str(c - 8) for c in f) + "\n" for f in CUBE_FACES)
        self.expect_cube(self.read("b.OBJ", backwards), 6)

        lines = [" ".join(map(str, p)) for p in CUBE_POINTS]
        faces = [f"4 {' '.join(map(str, f))}" for f in CUBE_FACES]
        self.expect_cube(self.read("a.off", "OFF # text\n\n8 6 0\n" + "\n".join(lines + [f + " 9 9" for f in faces])), 6)
        self.expect_cube(self.read("b.off", "OFF 8 6 0\n" + "\n".join(lines + faces)), 6)

        corners = [CUBE_POINTS[c] for triangle in CUBE_TRIANGLES for c in triangle]
        text = "solid cube\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
        self.expect_cube(self.read("a.stl", text), 12)
        triangles = [corners[i : i + 3] for i in range(0, 36, 3)]
        binary = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for p in t for x in p), 0) for t in triangles)
        self.expect_cube(self.read("b.STL", b"solid".ljust(80) + struct.pack("<I", 12) + binary), 12)

        head = (
            "ply\nformat {} 1.0\nelement vertex 8\nproperty float x\nproperty double y\nproperty float z\n"
            "property uchar red\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
        )
        text = head.format("ascii") + "".join(line + " 255\n" for line in lines) + "\n".join(faces)
        self.expect_cube(self.read("a.ply", text), 6)
        for name, order in (("little", "<"), ("big", ">")):
            body = b"".join(struct.pack(order + "fdfB", *p, 255) for p in CUBE_POINTS)
            body += b"".join(struct.pack(order + "B4i", 4, *f) for f in CUBE_FACES)
            self.expect_cube(self.read("b.ply", head.format(f"binary_{name}_endian").encode() + body), 6)

    def test_what_is_no_surface_is_refused(self):
        for name, data in {
            "a.obj": "v 0 0 0\n",
            "b.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
            "c.obj": "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "a.off": "OFF\n8 6 0\n0 0 0\n",
            "a.ply": b"ply\n",
            "a.stl": b"",
        }.items():
            with self.assertRaises(surface_files.NotASurface, msg=name):
                self.read(name, data)

    def test_a_hole_is_seen(self):
        self.assertFalse(Surface(CUBE_POINTS, CUBE_FACES[1:]).is_closed())

    def test_what_is_written_as_obj_reads_back_to_the_same_bits(self):
        numbers = random.Random(2)
        points = [tuple(numbers.uniform(-1, 1) * 10.0 ** numbers.randint(-9, 9) for _ in range(3)) for _ in range(30)]
        surface = Surface(points, [(i, i + 1, i + 2) for i in range(0, 30, 3)])
        surface_files.write_obj(surface, self.folder / "out.obj")
        back = surface_files.read_surface(self.folder / "out.obj")
        self.assertEqual((back.points, back.faces), (surface.points, surface.faces))


def volume_of(points, tetrahedra):
    """Errors: a tetrahedron is flat. The sum of what they enclose."""
    whole = 0
    for a, b, c, d in ([points[corner] for corner in corners] for corners in tetrahedra):
        edges = [dihedral.minus(p, a) for p in (b, c, d)]
        volume = abs(dihedral.dot(dihedral.cross(edges[0], edges[1]), edges[2])) / 6
        assert volume > 0
        whole += volume
    return whole


def outside_of(points, tetrahedra):
    """The triangles, as sets of points, that only one tetrahedron has."""
    counts = {}
    for corners in tetrahedra:
        for left_out in range(4):
            triangle = frozenset(points[c] for i, c in enumerate(corners) if i != left_out)
            counts[triangle] = counts.get(triangle, 0) + 1
    return {triangle for triangle, count in counts.items() if count == 1}


class Netgen(unittest.TestCase):
    def setUp(self):
        if not volume_check.has_netgen():
            print("SKIPPED: netgen is not installed (Debian's python3-netgen)", file=sys.stderr, flush=True)
            self.skipTest("netgen is not installed")

    def fill(self, surface, seconds=60):
        with tempfile.TemporaryDirectory() as folder:
            return volume_check.netgen(surface, pathlib.Path(folder), seconds)

    def test_it_fills_a_surface_and_keeps_it(self):
        cube = Surface(CUBE_POINTS, CUBE_TRIANGLES)
        prism_of_seven = volume_check.in_triangles(
            prism([(math.cos(2 * math.pi * i / 7), math.sin(2 * math.pi * i / 7)) for i in range(7)])
        )
        for surface in (cube, turned_inside_out(cube), prism_of_seven):
            points, tetrahedra = self.fill(surface)
            self.assertAlmostEqual(volume_of(points, tetrahedra), abs(dihedral.signed_volume(surface)) / 6, places=12)
            self.assertEqual(
                outside_of(points, tetrahedra),
                {frozenset(surface.points[c] for c in face) for face in surface.faces},
            )

    def test_what_it_cannot_fill_it_tells_in_a_few_words(self):
        open_cube = Surface(CUBE_POINTS, CUBE_TRIANGLES[:-1])
        with self.assertRaises(volume_check.ToolFailed) as caught:
            self.fill(open_cube)
        self.assertRegex(str(caught.exception), "^[^\\n]{2,40}$")
        with self.assertRaisesRegex(volume_check.ToolFailed, "no end in 0.01 s"):
            self.fill(Surface(CUBE_POINTS, CUBE_TRIANGLES), 0.01)


class Verdict(unittest.TestCase):
    def failures(self, before, after, note=""):
        names = (volume_check.KEPT, volume_check.SPLIT)
        rows = [volume_check.Row("part", kind, volumes=dict(zip(names, v))) for kind, v in zip("io", (before, after))]
        rows[1].note = note
        return volume_check.failures_of(*rows, at_least=3, at_most=1.5)

    def test_the_output_must_mesh_where_the_input_does_and_be_better(self):
        volume, failed = volume_check.Volume, volume_check.Volume(failure="crashed")
        input_volumes = volume(10, 0.1, 0.1), volume(1000, 6, 6)
        self.assertEqual(self.failures(input_volumes, [volume(1500, 1, 3)]), [])
        self.assertEqual(len(self.failures(input_volumes, [volume(1501, 2.9, 2.9)])), 2)
        self.assertEqual(self.failures([failed, volume(6, 35, 35)], [volume(1000, 4, 4)]), [])
        self.assertEqual(len(self.failures(input_volumes, [failed])), 1)
        self.assertEqual(len(self.failures([failed, volume(100, 6, 6)], [failed])), 1)
        self.assertEqual(self.failures([failed, failed], [failed]), [])
        self.assertEqual(self.failures(input_volumes, [], note="remesh: crashed"), ["remesh: crashed"])

    def test_what_others_cannot_mesh_is_told_but_not_judged(self):
        volume, failed = volume_check.Volume, volume_check.Volume(failure="crashed")
        rows = [volume_check.Row("part", kind) for kind in ("input", "output")]
        for row in rows:
            row.volumes = {volume_check.KEPT: volume(100, 6, 6), volume_check.SPLIT: volume(100, 6, 6)}
        rows[0].volumes.update({"gmsh -3": volume(100, 6, 6), "netgen": failed})
        rows[1].volumes.update({"gmsh -3": failed, "netgen": failed})
        self.assertEqual(
            volume_check.others_of(*rows),
            ["gmsh -3: crashed; the input: meshed", "netgen: crashed; the input: crashed"],
        )
        self.assertEqual(volume_check.failures_of(*rows, at_least=3, at_most=1.5), [])
        self.assertEqual(volume_check.others_of(rows[0], volume_check.Row("part", "output")), [])

    def test_a_tool_that_hangs_or_crashes_is_told_from_one_that_refuses(self):
        with self.assertRaisesRegex(volume_check.ToolFailed, "no end in 0.2 s"):
            volume_check.run(["sleep", "60"], "/", 0.2)
        self.assertEqual(volume_check.run(["sh", "-c", "kill -SEGV $$"], "/", 10), (-11, ""))
        self.assertEqual(volume_check.how_it_ended(-11), "SIGSEGV")
        self.assertEqual(volume_check.run(["sh", "-c", "echo no; exit 3"], "/", 10), (3, "no\n"))

    def test_polygons_become_triangles_only_where_a_fan_is_right(self):
        cube = volume_check.in_triangles(Surface(CUBE_POINTS, CUBE_FACES))
        self.assertEqual(len(cube.faces), 12)
        with self.assertRaises(volume_check.ToolFailed):
            volume_check.in_triangles(prism([(0, 0), (4, 0), (1, 1), (0, 4)][1:] + [(0, 0)]))

    def test_flat_tetrahedra_are_counted_apart_from_sharp_edges(self):
        def mesher(surface, folder, seconds):
            height = math.tan(math.radians(2))  # of a flat one, with two angles near 2 degrees
            points = {0: (0, 0, 0), 1: (1, 0, 0), 2: (0.5, 1, 0), 3: (0.5, -1, 2 * height), 4: (0.5, 0.5, 1)}
            return points, [(0, 1, 2, 4), (0, 1, 2, 3), (0, 1, 3, 2)]

        for sharp, flat in (((), 2), ({(0, 0, 0)}, 0)):
            volume = volume_check.mesh_volume(mesher, None, sharp, 1, 5)
            self.assertEqual((volume.tetrahedra, volume.flat), (3, flat))
            self.assertLess(volume.worst_deg, 5)
            self.assertEqual(volume.worst_apart_deg < 5, flat > 0)

    def test_orders_are_counted_over_those_that_could_be_meshed(self):
        volume, failed = volume_check.Volume, volume_check.Volume(failure="crashed")
        row = volume_check.Row("a|b", "output", volumes={volume_check.KEPT: volume(10, 4, 4)})
        row.orders = [volume(20, 1, 1, flat=3), failed, volume(30, 5, 5)]
        none = volume_check.Row("c", "output", volumes={volume_check.KEPT: failed}, orders=[failed])
        with contextlib.redirect_stdout(io.StringIO()) as said:
            volume_check.print_orders([volume_check.Row("c", "input"), row, none], 3)
        lines = [line.split() for line in said.getvalue().splitlines() if line.startswith("| ")][2:]
        self.assertEqual(" ".join(lines[0]), "| a\\|b | 3 of 4 | 20 | 1 | 4 | 5 | 1 | 2 |")
        self.assertEqual(" ".join(lines[1]), "| c | 0 of 2 | | | | | | |")

    def test_a_renumbered_surface_is_the_same_surface(self):
        surface = Surface(CUBE_POINTS, CUBE_FACES)
        other = volume_check.renumbered(surface, 1)
        self.assertNotEqual((other.points, other.faces), (surface.points, surface.faces))
        again = volume_check.renumbered(surface, 1)
        self.assertEqual((other.points, other.faces), (again.points, again.faces))
        corners = lambda s: sorted([s.points[c] for c in face] for face in s.faces)
        self.assertEqual(corners(other), corners(surface))


if __name__ == "__main__":
    unittest.main()
