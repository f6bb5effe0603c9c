#!/usr/bin/env python3
"""Tests of what bench.py makes of its figures, the table and the plot, and of what it measures meshes with."""

import math
import pathlib
import random
import struct
import tempfile
import types
import unittest
import unittest.mock
import xml.etree.ElementTree

import cad
import coarse
import free
import organic
import plot
import solids
import step_surfaces
import versions

import dihedral  # found as step_surfaces finds it
from programs import Bench, Run
from scaling import add_growth
from step_surfaces import Face, StepSurfaces
from surface_files import Surface
from table import Table

SVG = "{http://www.w3.org/2000/svg}"


class TableTest(unittest.TestCase):
    def test_a_ratio_above_its_bound_is_told_and_one_at_it_is_not(self):
        table = Table()
        table.add("box", "slow", 3.0, "s", "the other", 2.0, 1.4)
        table.add("box", "fair", 3.0, "s", "the other", 2.0, 1.5)
        self.assertEqual([row["what"] for row in table.above_bounds()], ["slow"])
        slow, fair = table.markdown().splitlines()[2:]
        self.assertIn("**1.50**", slow)
        self.assertNotIn("**", fair)

    def test_a_figure_without_a_ratio_is_held_to_the_bound_itself(self):
        table = Table()
        table.add("box", "many", 2, "files", bound=1)
        table.add("box", "few", 1, "files", bound=1)
        self.assertEqual([row["what"] for row in table.above_bounds()], ["many"])
        many, few = table.markdown().splitlines()[2:]
        self.assertIn("**2 files**", many)
        self.assertNotIn("**", few)

    def test_what_was_not_measured_says_why(self):
        table = Table()
        table.leave_out("box", "peer", "it could not be had")
        self.assertEqual(table.above_bounds(), [])
        self.assertIn("not measured: it could not be had", table.markdown())

    def test_growth_is_told_for_exactly_ten_times_the_faces(self):
        table = Table()
        # twenty times the faces in thirty times the time and forty times the memory
        add_growth(table, "box", [(1000, 1.0, 1 << 20), (20_000, 30.0, 40 << 20)], 200)
        grown = [row for row in table.rows if row["against"] == "1,000 faces"]
        self.assertEqual([(row["what"], row["ratio"]) for row in grown], [("time", 15.0), ("memory", 20.0)])


class SolidsTest(unittest.TestCase):
    @staticmethod
    def table(peer):
        report = {"timing_ms": {"weld": 500}, "input": {"faces": 600}, "output": {"faces": 400}}
        table = Table()
        runs = {"remesh": [Run(3.0, 10 << 20, "", report)]}
        if peer:
            runs["CGAL"] = [Run(9.0, 0, '{"process_ms": 2000}')]
        solids.add_rows(table, "spheres", runs, 0.2, 2.0)
        return table

    def test_stage_and_command_are_held_to_parts_of_what_the_peer_takes_without_reading(self):
        table = self.table(peer=True)
        self.assertEqual([(row["what"], row["ratio"]) for row in table.rows if row["bound"]],
                         [("remesh, mending and uniting", 0.25), ("remesh, file to file", 1.5)])
        self.assertEqual([row["what"] for row in table.above_bounds()], ["remesh, mending and uniting"])

    def test_memory_is_told_by_the_faces_of_input_and_result(self):
        self.assertIn(10485.8, [row["value"] for row in self.table(peer=False).rows])

    def test_without_the_peers_nothing_is_held_to_a_bound(self):
        table = self.table(peer=False)
        self.assertEqual([row for row in table.rows if row["bound"]], [])
        self.assertEqual(table.markdown().count("not measured"), 2)


class OrganicTest(unittest.TestCase):
    @staticmethod
    def table(seconds, has_peer=True):
        table = Table()
        results = {what: [Run(taken, 4 << 20, "")] for what, taken in seconds.items()}
        organic.add_rows(table, "ball", 10_000, results, has_peer)
        return table

    def test_times_are_held_to_parts_of_the_peers_and_memory_to_bytes_a_face(self):
        table = self.table({"remesh, one core": 0.9, "remesh, two cores": 0.4, organic.CGAL: 1.0})
        self.assertEqual([row["what"] for row in table.above_bounds()], ["remesh, one core"])
        memory = [row for row in table.rows if row["what"].endswith("memory")]
        self.assertEqual([row["ratio"] for row in memory], [round((4 << 20) / 10_000 / 500, 3)] * 2)

    def test_without_the_peer_the_times_stand_alone(self):
        table = self.table({"remesh, one core": 0.9}, has_peer=False)
        self.assertEqual([row["ratio"] for row in table.rows if row["what"] == "remesh, one core"], [None])
        self.assertIn("not measured", table.markdown())


class VersionsTest(unittest.TestCase):
    def test_a_build_that_is_slower_is_told(self):
        table = Table()
        results = {"this build": [Run(1.1, 1 << 20, "")], "the one before": [Run(1.0, 2 << 20, "")]}
        versions.add_rows(table, "box", results)
        self.assertEqual([row["what"] for row in table.above_bounds()], ["time"])

    def test_without_a_commit_it_says_what_is_missing(self):
        table = Table()
        versions.measure_versions(Bench(None, None, 1, 1, 1), table)
        self.assertIn("--against", table.markdown())


class CoarseTest(unittest.TestCase):
    OURS = {"faces_in": 400, "faces": 100, "proven": 0.02, "distance": 0.01, "diagonal": 20.0}

    def rows(self, **theirs):
        table = Table()
        coarse.add_rows(table, "part.stl", self.OURS, {"adaptive": None, "planar": None, **theirs})
        return table

    def test_more_than_half_of_the_faces_of_a_peer_is_told_and_half_is_not(self):
        half = self.rows(planar={"faces": 200, "distance": 0.01}, adaptive={"faces": 201, "distance": 0.01})
        self.assertEqual(half.above_bounds(), [])
        more = self.rows(planar={"faces": 199, "distance": 0.01}, adaptive={"faces": 201, "distance": 0.01})
        self.assertEqual([row["against"] for row in more.above_bounds()], [coarse.PEERS["planar"]])

    def test_distances_are_told_in_thousandths_of_the_diagonal(self):
        table = self.rows(planar={"faces": 300, "distance": 0.008})
        told = {row["what"]: row["value"] for row in table.rows if row["unit"] == "thousandths"}
        self.assertEqual(told, {"remesh, proven distance": 1.0, "remesh, measured distance": 0.5,
                                f"{coarse.PEERS['planar']}, measured distance": 0.4})

    def test_a_peer_without_a_result_says_why_and_does_not_count(self):
        text = self.rows(planar={"faces": None}).markdown()
        self.assertIn(f"{coarse.PEERS['adaptive']} | not measured: it failed or took too long", text)
        self.assertIn(f"{coarse.PEERS['planar']} | not measured: with no tolerance", text)
        table = Table()
        coarse.add_medians(table, {"adaptive": [], "planar": [0.9, 0.1, 0.4]})
        self.assertEqual([(row["value"], row["bound"]) for row in table.rows], [(0.4, 0.5)])


class FreeTest(unittest.TestCase):
    OURS = free.Made(100, 26.0, 0, seconds=1.0, distance=0.01, listed=0)

    def table(self, is_smooth, tolerance=1e-3, ours=OURS, **theirs):
        table = Table()
        made = {name: free.Made(faces, 20.0, 5) for name, faces in theirs.items()}
        free.add_rows(table, "scan.ply", is_smooth, tolerance, 400, 0.02, ours, {**dict.fromkeys(free.PEERS), **made})
        free.add_medians(table, [(is_smooth, tolerance, free.ratios_to(ours, made))])
        return table

    def above(self, *arguments, **options):
        return [(row["case"], row["against"]) for row in self.table(*arguments, **options).above_bounds()]

    def test_smooth_surfaces_are_held_to_peers_that_bound_angles(self):
        self.assertEqual(self.above(True, **{"CGAL adaptive": 400, "Gmsh": 300, free.SIMPLIFIER: 10}), [])
        case = "scan.ply, within 0.001 of the diagonal"
        self.assertEqual(self.above(True, **{"CGAL adaptive": 160, "Gmsh": 300}),
                         [(case, "the best peer with angles"),
                          ("median of 1 smooth surfaces within 0.001", "the best peer with angles")])
        sharp = free.Made(100, 24.0, 1, seconds=1.0, distance=0.01, listed=1)
        self.assertEqual(self.above(True, ours=sharp), [(case, None)])

    def test_scans_are_held_to_a_simplifier_in_the_median(self):
        self.assertEqual(self.above(False, **{"CGAL adaptive": 10, free.SIMPLIFIER: 100}), [])
        self.assertEqual(self.above(False, **{free.SIMPLIFIER: 99}),
                         [("median of 1 scans within 0.001", free.SIMPLIFIER)])

    def test_scans_hardly_get_more_faces_within_small_tolerances(self):
        many = free.Made(521, 26.0, 0, seconds=1.0, distance=0.01, listed=0)
        self.assertEqual(self.above(False, tolerance=1e-4, ours=many),
                         [("scan.ply, within 0.0001 of the diagonal", "the input")])

    def test_a_peer_without_a_result_is_told(self):
        self.assertIn("Gmsh | not measured: it could not be had", self.table(False).markdown())

    def test_the_largest_parameter_that_is_near_enough_is_found(self):
        # The search also ends where a mesh has more than four times the faces of the input.
        for largest, faces_in, least, most in [(0.3, 100, 34, 37), (7, 100, 1, 2), (0.05, 10, None, None)]:
            with tempfile.TemporaryDirectory() as folder:
                best = self.searched(pathlib.Path(folder), largest, faces_in)
            self.assertEqual(best is None, least is None)
            if best:
                self.assertLessEqual(least, best.faces)
                self.assertLessEqual(best.faces, most)

    def searched(self, folder, largest, faces_in):
        """By a peer that makes the fewer faces the larger its parameter is, and is near enough up to the largest one."""
        tried = []

        def write(path, faces):
            path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * faces)

        def make(after, parameter):
            tried.append(parameter)
            write(after, math.ceil(10 / parameter))

        write(folder / "in.obj", faces_in)
        with unittest.mock.patch.object(free, "is_within", lambda *_: tried[-1] <= largest):
            return free.searched(Bench(None, folder, 1, 1, 1), folder / "in.obj", 1, make)


class PlotTest(unittest.TestCase):
    def draw(self, points):
        panel = plot.Panel("seconds")
        panel.add("box", points)
        return xml.etree.ElementTree.fromstring(plot.draw([panel], "faces"))

    def test_decades_are_equally_far_apart(self):
        dots = self.draw([(10, 1), (100, 10), (1000, 100)]).findall(f".//{SVG}circle")
        x, y = ([float(dot.get(name)) for dot in dots] for name in ["cx", "cy"])
        self.assertEqual(len(dots), 3)
        self.assertAlmostEqual(x[1] - x[0], x[2] - x[1], delta=0.2)
        self.assertAlmostEqual(y[0] - y[1], plot.HEIGHT / 2, delta=0.2)
        self.assertAlmostEqual(y[1] - y[2], plot.HEIGHT / 2, delta=0.2)

    def test_the_line_in_proportion_stays_within_the_panel(self):
        drawing = self.draw([(10, 1), (1000, 2)])
        dashed = next(line for line in drawing.iter(f"{SVG}polyline") if line.get("stroke-dasharray"))
        for point in dashed.get("points").split():
            x, y = map(float, point.split(","))
            self.assertTrue(0 <= x <= plot.WIDTH and 0 <= y <= plot.HEIGHT, point)


def random_point(numbers, size=1.0):
    return tuple(numbers.uniform(-size, size) for _ in range(3))


class FaceTest(unittest.TestCase):
    """Each formula, against the nearest of many points of the surface, in a frame that no axis is along."""

    AXIS = (2 / 7, 3 / 7, 6 / 7)
    SIDE = (6 / 7, 2 / 7, -3 / 7)
    ACROSS = (-3 / 7, 6 / 7, -2 / 7)
    ORIGIN = (0.3, -0.2, 0.5)
    STEPS = 400

    def place(self, x, y, z):
        """A point by its coordinates in the frame."""
        frame = zip(self.ORIGIN, self.SIDE, self.ACROSS, self.AXIS)
        return tuple(o + x * s + y * a + z * h for o, s, a, h in frame)

    def nearest(self, point, profile):
        """`profile`: points (radius, height) that turn about the axis."""
        x, y, height = (sum((p - o) * e for p, o, e in zip(point, self.ORIGIN, axis))
                        for axis in (self.SIDE, self.ACROSS, self.AXIS))
        return min(math.hypot(math.hypot(x, y) - r, height - h) for r, h in profile)

    def check(self, face, profile):
        numbers = random.Random(3)
        for i in range(40):
            point = random_point(numbers, 2) if i % 2 else self.place(*random_point(numbers, 0.3))
            self.assertAlmostEqual(face.distance(point), self.nearest(point, profile), delta=1e-3)

    def test_formulas_agree_with_points_of_the_surface(self):
        many = [i / self.STEPS for i in range(-10 * self.STEPS, 10 * self.STEPS + 1)]
        circle = [(math.cos(math.pi * t), math.sin(math.pi * t)) for t in many if abs(t) <= 1]
        self.check(Face("plane", self.ORIGIN, self.AXIS), [(r, 0) for r in many if r >= 0])
        self.check(Face("cylinder", self.ORIGIN, self.AXIS, 0.7), [(0.7, h) for h in many])
        self.check(Face("sphere", self.ORIGIN, None, 0.7), [(0.7 * c, 0.7 * s) for c, s in circle if c >= 0])
        c, s = math.cos(math.radians(20)), math.sin(math.radians(20))
        self.check(Face("cone", self.ORIGIN, self.AXIS, half_angle_deg=20), [(s * t, c * t) for t in many if t >= 0])
        for ring, tube in ((0.9, 0.3), (0.4, 0.8)):
            profile = [(abs(ring + tube * c), tube * s) for c, s in circle]
            self.check(Face("torus", self.ORIGIN, self.AXIS, ring, tube), profile)

    def test_a_surface_of_another_kind_has_no_formula(self):
        self.assertEqual(Face("other").distance((1, 2, 3)), 0)
        with self.assertRaises(ValueError):
            Face("helix", (0, 0, 0), (0, 0, 1)).distance((1, 2, 3))


class StepSurfacesTest(unittest.TestCase):
    def test_the_distance_to_a_triangle_is_the_one_to_its_nearest_point(self):
        numbers = random.Random(4)
        steps = 60
        for _ in range(60):
            a, b, c = (random_point(numbers) for _ in range(3))
            point = random_point(numbers, 1.5)
            nearest = min(
                math.dist(point, [p + i / steps * (q - p) + j / steps * (r - p) for p, q, r in zip(a, b, c)])
                for i in range(steps + 1) for j in range(steps + 1 - i))
            spacing = max(math.dist(a, b), math.dist(b, c), math.dist(c, a)) / steps
            distance = step_surfaces.distance_to_triangle(point, a, b, c)
            self.assertLessEqual(distance, nearest + 1e-12)
            self.assertGreaterEqual(distance, nearest - spacing)
        # without area
        self.assertAlmostEqual(step_surfaces.distance_to_triangle((1, 1, 0), (0, 0, 0), (1, 0, 0), (3, 0, 0)), 1)
        self.assertAlmostEqual(step_surfaces.distance_to_triangle((1, 1, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)),
                               math.sqrt(2))

    def test_the_tree_finds_what_all_triangles_give(self):
        numbers = random.Random(5)
        faces = [Face("other"), Face("other", chord=0.3), Face("plane", (0, 0, 0), (0, 0, 1), chord=0.05),
                 Face("sphere", (0, 0, 0), None, 1)]
        triangles = []
        for _ in range(300):
            corner = random_point(numbers, 3)
            others = [tuple(x + 0.3 * y for x, y in zip(corner, random_point(numbers))) for _ in range(2)]
            triangles.append((corner, *others, numbers.randrange(4)))
        surfaces = StepSurfaces(triangles, faces)
        for _ in range(200):
            point = random_point(numbers, 4)
            expected = min(max(faces[f].distance(point),
                               step_surfaces.distance_to_triangle(point, a, b, c) - faces[f].chord)
                           for a, b, c, f in triangles)
            self.assertAlmostEqual(surfaces.distance(point), expected, places=12)
            self.assertAlmostEqual(surfaces.distance(point, expected / 2), expected, places=12)
            self.assertLessEqual(surfaces.distance(point, 2 * expected), 2 * expected)

    def test_pieces_are_short_and_cover_what_they_are_of(self):
        numbers = random.Random(6)
        area = lambda a, b, c: dihedral.length(dihedral.cross(dihedral.minus(b, a), dihedral.minus(c, a))) / 2
        triangles = [tuple(random_point(numbers) for _ in range(3)) + (face,) for face in range(20)]
        pieces = step_surfaces.cut_to_length(triangles, 0.3)
        for a, b, c, _ in pieces:
            self.assertLessEqual(max(math.dist(a, b), math.dist(b, c), math.dist(c, a)), 0.3)
        for *corners, face in triangles:
            own = [piece[:3] for piece in pieces if piece[3] == face]
            self.assertAlmostEqual(sum(area(*piece) for piece in own), area(*corners))
            normal = dihedral.cross(dihedral.minus(corners[1], corners[0]), dihedral.minus(corners[2], corners[0]))
            for piece in own:
                for p in piece:
                    self.assertLess(step_surfaces.distance_to_triangle(p, *corners), 1e-12)
                turned = dihedral.cross(dihedral.minus(piece[1], piece[0]), dihedral.minus(piece[2], piece[0]))
                self.assertGreater(dihedral.dot(normal, turned), 0)

    def hole(self, pieces, radius, height):
        """Triangles of a round hole's wall and of the plate's top around it, to twice the radius."""
        ring = lambda r, z: [(r * math.cos(2 * math.pi * i / pieces), r * math.sin(2 * math.pi * i / pieces), z)
                             for i in range(pieces)]
        strip = lambda p, q: [t for i in range(pieces) for t in
                              ((p[i - 1], p[i], q[i]), (p[i - 1], q[i], q[i - 1]))]
        return strip(ring(radius, height), ring(radius, 0)), strip(ring(2 * radius, height), ring(radius, height))

    def test_a_surface_ends_where_its_face_does(self):
        radius, height, fine = 2.0, 1.0, 144
        wall, top = self.hole(fine, radius, height)
        chord = radius * (1 - math.cos(math.pi / fine))
        surfaces = StepSurfaces([(*t, 0) for t in wall] + [(*t, 1) for t in top],
                                [Face("cylinder", (0, 0, 0), (0, 0, 1), radius, chord=chord),
                                 Face("plane", (0, 0, height), (0, 0, 1))])
        # in the plane of the top, but in the hole, and under the wall
        self.assertAlmostEqual(surfaces.distance((0.5, 0, height)), radius - 0.5, delta=chord)
        self.assertAlmostEqual(surfaces.distance((radius, 0, -0.4)), 0.4, delta=2 * chord)
        # eight pieces, whose middles are off by their chord height wherever on the wall they are
        coarse = [p for t in self.hole(8, radius, height)[0] for p in t]
        mesh = Surface(coarse, [(i, i + 1, i + 2) for i in range(0, len(coarse), 3)])
        self.assertAlmostEqual(surfaces.greatest_distance(mesh), radius * (1 - math.cos(math.pi / 8)), places=12)

    def test_it_reads_what_the_tessellation_tells(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            triangles = [((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((0, 0, 3), (1, 0, 3), (0, 1, 4))]
            records = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for p in t for x in p), 0) for t in triangles)
            (folder / "a.stl").write_bytes(bytes(80) + struct.pack("<I", 2) + records)
            (folder / "a.surfaces.tsv").write_text(
                "face\tfirst\tcount\tkind\tpx\tpy\tpz\tax\tay\taz\tr1\tr2\thalf_angle\tside\tarea\toff\tchord\tdetail\n"
                "1\t0\t1\tplane\t0\t0\t0\t0\t0\t1\t\t\t\t1\t0.5\t0\t0.125\t\n"
                "2\t1\t0\tsphere\t0\t0\t9\t\t\t\t5\t\t\t1\t0\t0\t0\t\n"
                "3\t1\t1\tother\t\t\t\t\t\t\t\t\t\t\t0.5\t\t\tbspline\n")
            surfaces = step_surfaces.read_step_surfaces(folder / "a.stl")
        self.assertEqual([face.kind for face in surfaces.faces], ["plane", "sphere", "other"])
        self.assertEqual(surfaces.faces[1].r1, 5)
        self.assertEqual(surfaces.distance((0.2, 0.2, 0.5)), 0.5)
        # the plane's triangle ends at x = 1, and may be 0.125 from its face
        self.assertAlmostEqual(surfaces.distance((1.5, 0, 0)), 0.375)
        self.assertAlmostEqual(surfaces.distance((0, 0, 2.5)), 0.5)


class CadTest(unittest.TestCase):
    def test_an_angle_that_only_rounding_puts_below_is_not_counted(self):
        self.assertEqual(cad.count_below([25 * (1 - 1e-12), 24.99, 25, 60]), 1)

    def test_the_medians_are_over_files_and_small_angles_are_held_in_each(self):
        meshed = lambda faces, below, distance: cad.Meshed(faces, below, 20, distance, 1.0)
        pairs = [(meshed(100, 0, 1.0), meshed(200, 0, 2.0)),
                 (meshed(300, 5, 3.0), meshed(100, 4, 1.0)),
                 (meshed(90, 7, 0.8), meshed(100, 9, 1.0))]
        table = Table()
        cad.add_medians(table, pairs)
        told = {row["what"]: (row["value"], row["bound"]) for row in table.rows}
        self.assertEqual(told["remesh, faces"], (0.9, 1.2))
        self.assertEqual(told["remesh, faces where there are most"], (3, 2))
        self.assertEqual(told["remesh, distance"], (0.8, 1))
        self.assertEqual(told["remesh, more below 25 degrees than Gmsh"], (1, 0))
        self.assertEqual([row["what"] for row in table.above_bounds()],
                         ["remesh, faces where there are most", "remesh, more below 25 degrees than Gmsh"])

    def test_what_there_is_nothing_to_measure_with_is_left_out_and_says_so(self):
        table = Table()
        with tempfile.TemporaryDirectory() as folder:
            bench = types.SimpleNamespace(steps=(), tessellated=pathlib.Path(folder))
            cad.measure_cad(bench, table)
            self.assertEqual(cad.measure_step(bench, table, pathlib.Path("part.step")), [])
        nothing, part = table.rows
        self.assertIn("not measured: ../shared/meshes/step is not there", nothing["unit"])
        self.assertIn("part.step", part["case"])
        self.assertIn("not measured: it was not tessellated", part["unit"])

    def test_a_file_that_gmsh_cannot_mesh_has_our_figures_and_says_so(self):
        table = Table()
        cad.add_step(table, "part", cad.Meshed(10, 0, 30, 0.1, 1.0), None)
        self.assertEqual([row["value"] for row in table.rows if row["what"] == "remesh"], [10, 0, 0, 30, 0.1, 1.0])
        self.assertEqual(table.rows[-1]["unit"], "not measured: it failed")


if __name__ == "__main__":
    unittest.main()
