"""Part `organic`: surfaces whose facets are patches of their own, beside CGAL's remeshing of planar patches.

A displaced ball, a terrain of noise and an isosurface stand for scans, castings and organic models. Without refinement
both programs give back the facets, so that the time is that of reading, of looking for planes, and of writing; ours has
the proof besides.
"""

from programs import face_count, peak_bytes, seconds

SHAPES = ["ball", "terrain", "isosurface"]
SIZES = [100_000, 1_000_000, 10_000_000]
CGAL = "CGAL planar remeshing"
BYTES_A_FACE = 500
BOUNDS = {"remesh, one core": 0.8, "remesh, two cores": 0.5}


def measure_organic(bench, table):
    has_peer = bench.program("coarse_peer").exists()
    for shape in SHAPES:
        before = None
        for size in [size for size in SIZES if size <= bench.faces]:
            path = bench.input(shape, size)
            faces = face_count(path)
            results = bench.by_turns(works_on(bench, path, has_peer))
            add_rows(table, f"{shape}, {faces:,} faces", faces, results, has_peer)
            took = seconds(results["remesh, two cores"])
            if before:
                before_faces, before_took = before
                table.add(f"{shape}, {faces:,} faces", "remesh, two cores", took, "s", f"{before_faces:,} faces",
                          before_took * faces / before_faces / 10, 12)
            before = faces, took
            table.write(bench.folder)


def works_on(bench, path, has_peer):
    unrefined = ["--refine", "false"]
    works = {
        "remesh, one core": lambda: bench.remesh_alone(path, *unrefined, workers=1),
        "remesh, two cores": lambda: bench.remesh_alone(path, *unrefined),
        "remesh, two cores, 25 degrees": lambda: bench.remesh_alone(path),
    }
    if has_peer:
        works[CGAL] = lambda: bench.run(bench.program("coarse_peer"), "planes", path, bench.folder / "planes.obj")
    return works


def add_rows(table, case, faces, results, has_peer):
    if has_peer:
        peer = seconds(results[CGAL])
        table.add(case, CGAL, peer, "s")
    else:
        table.leave_out(case, CGAL, "CGAL 6.0 or newer could not be had")
    for what, runs in results.items():
        if what == CGAL:
            continue
        if has_peer:
            table.add(case, what, seconds(runs), "s", CGAL, peer, BOUNDS.get(what))
        else:
            table.add(case, what, seconds(runs), "s")
        table.add(case, f"{what}, memory", peak_bytes(runs) / faces, "bytes a face", f"{BYTES_A_FACE} bytes",
                  BYTES_A_FACE, 1 if what in BOUNDS else None)
