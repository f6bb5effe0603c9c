"""Tests of refinement_table.py, against analytic answers and a remesher that says what it is told to."""

import contextlib
import io
import json
import math
import pathlib
import stat
import sys
import tempfile
import unittest

import refinement_table
import surface_files
from surface_files import Surface

EQUILATERAL = Surface([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, math.sqrt(0.75), 0.0)], [(0, 1, 2)])


def flat_triangle(degrees):
    """Isosceles, with that angle at both ends of its base."""
    return Surface([(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, math.tan(math.radians(degrees)), 0.0)], [(0, 1, 2)])


class CountBelow(unittest.TestCase):
    def test_a_triangle_counts_as_soon_as_one_angle_is_below(self):
        self.assertEqual(refinement_table.count_below(flat_triangle(24.9), 25), (1, 1))
        self.assertEqual(refinement_table.count_below(flat_triangle(25.1), 25), (0, 0))

    def test_the_small_angle_may_be_at_any_corner(self):
        points = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.4, 0.0)]  # 21.8 degrees at the first
        for turn in range(3):
            surface = Surface(points, [tuple((k + turn) % 3 for k in range(3))])
            self.assertEqual(refinement_table.count_below(surface, 25), (1, 1))
            self.assertEqual(refinement_table.count_below(surface, 21), (0, 0))

    def test_each_triangle_counts_once(self):
        self.assertEqual(refinement_table.count_below(EQUILATERAL, 61), (1, 1))

    def test_an_angle_of_exactly_the_bound_is_below_for_rounding_alone(self):
        self.assertEqual(refinement_table.count_below(EQUILATERAL, 60), (0, 1))


class Manifold(unittest.TestCase):
    def test_three_pages_on_one_edge_are_not(self):
        points = [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)]
        pages = [(0, 1, 2), (0, 1, 3), (1, 0, 4)]
        self.assertTrue(refinement_table.is_manifold(Surface(points, pages[1:])))
        self.assertFalse(refinement_table.is_manifold(Surface(points, pages)))


class Table(unittest.TestCase):
    """The whole program, with a remesher that gives back its input and this report."""

    def run_with(self, surface, listed, verified=True, program=None):
        report = {
            "refinement_rounds": 3,
            "output": {"faces": len(surface.faces), "quality": {"min_angle_deg": 12.5}},
            "unrefined": [{"reason": reason, "count": count} for reason, count in listed.items()],
            "verified": {"surface": True, "conforming": True, "delaunay": True, "quality": verified},
        }
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            remesh = folder / "remesh"
            copy = (
                "import pathlib, shutil, sys\n"
                "shutil.copyfile(sys.argv[1], 'out.obj')\n"
                f"pathlib.Path('report.json').write_text({json.dumps(report)!r})\n"
            )
            remesh.write_text(f"#!{sys.executable}\n" + (copy if program is None else program))
            remesh.chmod(remesh.stat().st_mode | stat.S_IXUSR)
            surface_files.write_obj(surface, folder / "part.obj")
            out = io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
                code = refinement_table.main(
                    [str(folder / "part.obj"), "--remesh", str(remesh), "--bounds", "25", "--time-limit", "20"]
                )
            return code, out.getvalue()

    def test_what_is_listed_and_below_the_bound_is_well(self):
        code, text = self.run_with(flat_triangle(10), {"input_angle": 1})
        self.assertEqual(code, 0)
        self.assertIn("1 input_angle", text)
        self.assertIn("| yes", text)
        self.assertIn("25 degrees: 1 parts, 0 failed; 1 faces in, 1 out", text)

    def test_a_triangle_below_the_bound_that_is_not_listed_is_a_failure(self):
        code, text = self.run_with(flat_triangle(10), {})
        self.assertEqual(code, 1)
        self.assertIn("1 triangles below the bound, 0 listed", text)

    def test_a_listed_triangle_that_meets_the_bound_is_a_failure(self):
        self.assertEqual(self.run_with(EQUILATERAL, {"size_floor": 1})[0], 1)

    def test_an_angle_of_exactly_the_bound_may_be_listed_or_not(self):
        for listed in ({}, {"input_angle": 1}):
            self.assertEqual(self.run_with(flat_triangle(25), listed)[0], 0)

    def test_what_is_not_verified_is_a_failure(self):
        code, text = self.run_with(EQUILATERAL, {}, verified=False)
        self.assertEqual(code, 1)
        self.assertIn("not verified", text)

    def test_the_last_words_of_a_remesher_that_fails_are_in_the_table(self):
        code, text = self.run_with(EQUILATERAL, {}, program="import sys\nsys.exit('remesh: output_too_large: no')\n")
        self.assertEqual(code, 1)
        self.assertIn("| output_too_large: no", text)

    def test_the_memory_is_that_of_the_remesher_alone(self):
        large = bytearray(200 << 20)
        _, text = self.run_with(EQUILATERAL, {})
        titles, _, row = ([cell.strip() for cell in line.split("|")] for line in text.splitlines()[:3])
        megabytes = float(row[titles.index("MB")])
        self.assertGreater(megabytes, 1)
        self.assertLess(megabytes, len(large) >> 21)


if __name__ == "__main__":
    unittest.main()
