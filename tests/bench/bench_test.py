#!/usr/bin/env python3
"""Tests of what bench.py makes of its figures: the table, and the plot."""

import unittest
import xml.etree.ElementTree

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
