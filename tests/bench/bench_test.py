#!/usr/bin/env python3
"""Tests of what bench.py makes of its figures: the table, and the plot."""

import unittest
import xml.etree.ElementTree

import coarse
import plot
from scaling import add_growth
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


if __name__ == "__main__":
    unittest.main()
