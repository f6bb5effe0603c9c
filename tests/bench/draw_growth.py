"""Draws the times of the part `hostile` of remesh_bench.

usage: draw_growth.py ROWS.json OUT.svg
"""

import json
import pathlib
import sys

import plot


def panels_of(rows):
    """As many lines in a panel as there are colours."""
    series = {}
    for row in rows:
        if row["part"] == "hostile":
            series.setdefault(row["case"], []).append((row["size"], row["ms"] / 1000))
    names = list(series)
    panels = []
    for begin in range(0, len(names), len(plot.COLOURS)):
        panel = plot.Panel("seconds")
        for name in names[begin:begin + len(plot.COLOURS)]:
            panel.add(name.replace("_", " "), series[name])
        panels.append(panel)
    return panels


def main():
    rows = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    panels = panels_of(rows)
    if panels:
        pathlib.Path(sys.argv[2]).write_text(plot.draw(panels, "faces or corners"), encoding="utf-8")


if __name__ == "__main__":
    main()
