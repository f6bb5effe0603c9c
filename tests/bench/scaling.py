"""Part `growth`: ten times the work beside the work."""

import math

import plot
from programs import face_count, peak_bytes, seconds

PLATE = ("plate", 100)  # few corners, so that the longest edge alone says how many faces
PLATE_AREA = 12


def length_for(bench, faces):
    """The longest edge that makes about so many faces of the plate."""
    length = math.sqrt(3 * PLATE_AREA / faces)
    made = bench.remesh(bench.input(*PLATE), "--max-edge-length", str(length)).report["output"]["faces"]
    return length * math.sqrt(made / faces)


def measure_growth(bench, table):
    sizes = [10**e for e in range(4, 9) if 10**e <= bench.largest]
    times, peaks = plot.Panel("seconds, file to file"), plot.Panel("bytes at the peak")
    unrefined, refined = "box, not refined", "plate, refined"
    points = {unrefined: [], refined: []}  # of each size: faces, seconds, bytes
    for size in sizes:
        path = bench.input("box", size)
        length = str(length_for(bench, size))
        results = bench.by_turns({
            unrefined: lambda: bench.remesh(path, "--refine", "false"),
            refined: lambda: bench.remesh(bench.input(*PLATE), "--max-edge-length", length),
        })
        faces = {unrefined: face_count(path), refined: results[refined][0].report["output"]["faces"]}
        for name, runs in results.items():
            points[name].append((faces[name], seconds(runs), peak_bytes(runs)))
    for name, bytes_a_face in [(unrefined, 200), (refined, 300)]:
        add_growth(table, name, points[name], bytes_a_face)
        times.add(name, [(n, s) for n, s, _ in points[name]])
        peaks.add(name, [(n, b) for n, _, b in points[name]])
    (bench.folder / "growth.svg").write_text(plot.draw([times, peaks], "faces"))


def add_growth(table, name, points, bytes_a_face):
    """Ratios are for exactly ten times the faces."""
    before = None
    for faces, took, peak in points:
        case = f"{name}, {faces:,} faces"
        if before is None:
            table.add(case, "time", took, "s")
            table.add(case, "memory", peak / 2**20, "MB")
        else:
            before_faces, before_took, before_peak = before
            tenth = faces / before_faces / 10
            table.add(case, "time", took, "s", f"{before_faces:,} faces", before_took * tenth, 12)
            table.add(case, "memory", peak / 2**20, "MB", f"{before_faces:,} faces", before_peak * tenth / 2**20, 11)
        # of small ones most is the program itself
        table.add(case, "memory", peak / faces, "bytes a face", f"{bytes_a_face} bytes", bytes_a_face,
                  1 if faces > 500_000 else None)
        before = (faces, took, peak)
