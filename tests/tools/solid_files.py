#!/usr/bin/env python3
"""Cuts and unites real files, and tells what is left and which volume meshers take the results.

For each file and for both repairs, without refinement and with the preset for volume meshes: the pairs of triangles
that still intersect, by the project's own test and by CGAL's; what the report says hinders a volume mesher; and whether
TetGen (-p; for a union -pY as well), Gmsh and Netgen fill the result. What is left is told for each file; only errors
of the program fail, and pairs that are left without the report telling of them.

With --rows, the rows of the table of solids take the place of files: their unions by preset=volume have to be filled by
TetGen, Gmsh and Netgen, and TetGen has to find as many regions in the arrangements of some rows as these have cells.
"""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile

import surface_files
import tool
import volume_check
from tool import say

SHARED = pathlib.Path(__file__).resolve().parents[2].parent / "shared" / "meshes"
CORPUS = [
    "planar-cad/buildings.obj.gz",
    "broken/regr01.obj",
    "broken/openscad-nonmanifold-crash.obj",
    "broken/Havocglass8_left.obj",
    "seed/SampleConsole.obj",
    "planar-cad/box.STL",
    "seed/Baby_Teapot.obj",
    "planar-cad/adns2610_dev_circuit_inv.stl",
    "reports/touching-bodies.stl",
]
REPAIRS = ["self_intersections", "union"]
WAYS = {"plain": ["--refine", "false"], "volume": ["--preset", "volume"]}
MESHERS = {
    "tetgen -p": volume_check.tetgen("-p"),
    "tetgen -pT1e-14": volume_check.tetgen("-pT1e-14"),
    "tetgen -pY": volume_check.tetgen("-pY"),
    "gmsh": volume_check.gmsh,
    "netgen": volume_check.netgen,
}
ROWS_WITH_REGIONS = {*range(1, 9), 13, 14, 15}
OF_UNIONS = ("tetgen -pY", "gmsh", "netgen")  # an arrangement may have walls between cells, which these do not take


def pairs_of(program, surface, folder):
    """The pairs that intersect by our test and by CGAL's."""
    surface_files.write_obj(surface, folder / "pairs.obj")
    done = subprocess.run([program, "--pairs-of", "pairs.obj"], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout.split()


def fill(name, surface, folder, seconds):
    for old in folder.glob("*part*"):
        old.unlink()
    (folder / "out.msh").unlink(missing_ok=True)
    try:
        _, tetrahedra = MESHERS[name](surface, folder, seconds)
    except volume_check.ToolFailed as failure:
        # TetGen ends well without a tetrahedron where the surface is open.
        return "nothing inside" if str(failure).startswith("exit code 0") else str(failure)
    return str(len(tetrahedra))


def try_file(asked, path, repair, way, meshers):
    """A row of the table, and what is wrong."""
    row = [path.name, repair, way] + [""] * (5 + len(MESHERS))
    with tempfile.TemporaryDirectory(prefix="solid-files-") as name:
        folder = pathlib.Path(name)
        command = [asked.remesh, str(path.resolve()), "-o", "out.obj", "-q", "--report", "report.json"]
        try:
            code, output = volume_check.run(
                command + ["--repair", "+" + repair, *WAYS[way], *asked.options], folder, asked.time_limit
            )
        except volume_check.ToolFailed as failure:
            return row[:3] + [str(failure)] + row[4:], str(failure)
        if code != 0:
            said = (output.strip().splitlines() or [volume_check.how_it_ended(code)])[-1]
            return row[:3] + [said[:60]] + row[4:], said
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        surface = surface_files.read_surface(folder / "out.obj")
        ours, by_cgal = pairs_of(asked.pairs, surface, folder)
        solids = report.get("solids") or {}
        told = solids.get("intersecting_pairs", 0)
        moved = solids.get("moved", 0)
        obstacles = [f"{o['count']} {o['code']}" for o in report["volume_ready"]["reasons"]]
        row[3:8] = [str(len(surface.faces)), ours, by_cgal, f"{moved:.3g}", ", ".join(obstacles) or "none"]
        for i, mesher in enumerate(MESHERS):
            if mesher in meshers and (repair == "union" or mesher not in OF_UNIONS):
                row[8 + i] = fill(mesher, surface, folder, asked.time_limit)
    hidden = int(ours) + int(by_cgal) > 0 and told == 0 and "self_intersection" not in row[7]
    return row, "pairs are left that the report does not tell" if hidden else None


def remeshed(asked, path, folder, options):
    """The surface that the program makes of a file."""
    command = [asked.remesh, str(path), "-o", str(folder / "out.obj"), "-q", *options]
    code, output = volume_check.run(command, folder, asked.time_limit)
    if code != 0:
        raise volume_check.ToolFailed(output.strip().splitlines()[-1])
    return surface_files.read_surface(folder / "out.obj")


def regions_of(surface, folder, seconds):
    """The number of regions that TetGen tells apart."""
    volume_check.tetgen("-pA")(surface, folder, seconds)
    with open(folder / "part.1.ele", encoding="ascii") as lines:
        rows = [line.split() for line in lines if not line.startswith("#")]
    return len({row[5] for row in rows[1:] if row})


def try_rows(asked):
    """Fills the unions of all rows, and counts regions. Output: what is wrong."""
    table, faults = [["row", "faces", *OF_UNIONS, "regions", "cells"]], []
    with tempfile.TemporaryDirectory(prefix="solid-rows-") as name:
        folder = pathlib.Path(name)
        written = subprocess.run([asked.pairs, "--write", name], capture_output=True, text=True, check=True)
        for line in written.stdout.splitlines():
            file, cells = line.split()
            number = int(file[4:-4].split("_")[0])
            row = [file[:-4]] + [""] * 6
            try:
                surface = remeshed(asked, folder / file, folder, ["--repair", "+union", "--preset", "volume"])
                row[1] = str(len(surface.faces))
                for i, mesher in enumerate(OF_UNIONS):
                    row[2 + i] = fill(mesher, surface, folder, asked.time_limit)
                if number in ROWS_WITH_REGIONS:
                    walls = ["--repair", "+self_intersections", "--refine", "false"]
                    arranged = remeshed(asked, folder / file, folder, walls)
                    row[5:] = [str(regions_of(arranged, folder, asked.time_limit)), cells]
            except volume_check.ToolFailed as failure:
                faults.append(f"{file}: {failure}")
            faults += [f"{file}, {m}: {r}" for m, r in zip(OF_UNIONS, row[2:]) if not r.isdigit()]
            if row[5] != row[6]:
                faults.append(f"{file}: {row[5]} regions instead of {row[6]}")
            say(" | ".join(row))
            table.append(row)
    tool.print_table(table)
    return faults


def main(arguments):
    parser = tool.make_parser(__doc__, [])
    parser.add_argument("paths", nargs="*", metavar="PATH", help="files or folders; without any, those of issue 63")
    parser.add_argument("--pairs", default="build/release/solids_table", help="the program that counts pairs")
    parser.add_argument("--rows", action="store_true", help="the rows of the table of solids instead of files")
    parser.add_argument("--way", choices=list(WAYS), action="append", help="by default all")
    asked = tool.parse(parser, arguments, [], [SHARED / name for name in CORPUS if (SHARED / name).exists()])
    asked.pairs = str(pathlib.Path(asked.pairs).resolve())
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    if asked.rows:
        faults = try_rows(asked)
        for fault in faults:
            print(f"FAILED: {fault}")
        return 1 if faults else 0
    meshers = [name for name in MESHERS if name != "netgen" or volume_check.has_netgen()]
    table = [["file", "repair", "way", "faces", "pairs", "by CGAL", "moved", "obstacles", *MESHERS]]
    faults = []
    for path in asked.files:
        for repair in REPAIRS:
            for way in asked.way or WAYS:
                row, fault = try_file(asked, path, repair, way, meshers)
                say(" | ".join(row))
                table.append(row)
                if fault:
                    faults.append(f"{path.name}, {repair}, {way}: {fault}")
    tool.print_table(table)
    for fault in faults:
        print(f"FAILED: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
