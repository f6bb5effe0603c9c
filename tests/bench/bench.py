#!/usr/bin/env python3
"""Measures this project, its parts and its peers on the same work in one run, alternating, and writes one table.

usage: bench.py BUILD_FOLDER [--runs N] [--faces N] [--largest N] [--mesh PATH]... [--step PATH]... [--before PROGRAM]
                [--only PART]...

Writes bench/table.md and bench/table.json into the parent of the build folder, and prints the table; the part `growth`
also draws bench/growth.svg. Every figure is the median of the runs; what counts is the ratio to the row that it names,
as machines and their moods differ. The bounds are the project's own: a ratio above one is told. Peers that could not be
had are named as not measured. The part `cad` finds the tessellations of STEP files in the folder `tessellated` beside
the build folder, where `./dev bench` puts them.
"""

import argparse
import pathlib
import sys
import time

from cad import measure_cad
from coarse import measure_coarse
from free import measure_free
from in_the_plane import measure_polygons, measure_refinement
from organic import measure_organic
from programs import Bench
from scaling import measure_growth
from solids import measure_solids
from surface import measure_surface
from table import Table
from through_http import measure_http
from versions import measure_versions

PARTS = {
    "polygons": measure_polygons,
    "refinement": measure_refinement,
    "surface": measure_surface,
    "coarse": measure_coarse,
    "free": measure_free,
    "cad": measure_cad,
    "organic": measure_organic,
    "solids": measure_solids,
    "versions": measure_versions,
    "http": measure_http,
    "growth": measure_growth,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--faces", type=int, default=1_000_000, help="of the large inputs")
    parser.add_argument("--largest", type=int, default=1_000_000, help="where growth ends")
    parser.add_argument("--mesh", action="append", type=pathlib.Path, default=[], metavar="PATH",
                        help="for the parts coarse and free, instead of their own")
    parser.add_argument("--step", action="append", default=[], type=pathlib.Path, metavar="PATH",
                        help="a STEP file for the part cad")
    parser.add_argument("--before", type=pathlib.Path, metavar="PROGRAM",
                        help="the command line of another commit, for the part versions")
    parser.add_argument("--only", action="append", choices=list(PARTS), metavar="PART", help=", ".join(PARTS))
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    folder = build.parent / "bench"
    folder.mkdir(exist_ok=True)
    bench = Bench(build, folder, arguments.runs, arguments.faces, arguments.largest, tuple(arguments.mesh),
                  tuple(arguments.step), build.parent / "tessellated",
                  arguments.before and arguments.before.resolve())
    table = Table()
    for part in arguments.only or PARTS:
        start = time.monotonic()
        PARTS[part](bench, table)
        # a later part that fails must not take with it what was measured
        table.write(folder)
        print(f"bench: {part} took {time.monotonic() - start:.0f} s", file=sys.stderr)
    print(table.markdown(), end="")


if __name__ == "__main__":
    main()
