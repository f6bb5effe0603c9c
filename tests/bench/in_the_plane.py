"""Parts `polygons` and `refinement`: remesh_bench, which runs CGAL beside ours in one process."""

import json

SMALLEST_SIZE = 10_000  # of remesh_bench


def rows_of_remesh_bench(bench, part):
    file = bench.folder / f"{part}.json"
    bench.run(bench.program("remesh_bench"), "--only", part, "--json", file, str(max(bench.faces, SMALLEST_SIZE)))
    return json.loads(file.read_text())


def by_case(rows):
    """{(case, size): {what: row}}, in the order of the rows."""
    cases = {}
    for row in rows:
        cases.setdefault((row["case"], row["size"]), {})[row["what"]] = row
    return cases


def measure_polygons(bench, table):
    for (case, size), rows in by_case(rows_of_remesh_bench(bench, "polygons")).items():
        label = f"{size:,} {case}"
        theirs = rows["CGAL, without carving"]["ms"]
        is_bounded = (case, size) == ("corners of a star", 100_000)
        table.add(label, "CGAL, without carving", theirs, "ms")
        table.add(label, "with carving", rows["triangulate_patch"]["ms"], "ms", "CGAL", theirs,
                  0.8 if is_bounded else None)


def measure_refinement(bench, table):
    rows = rows_of_remesh_bench(bench, "refinement")
    beside_cgal = [row for row in rows if row["part"] == "refinement"]
    for (case, _), of in by_case(beside_cgal).items():
        ours, theirs = of["remesh_surface"], of["CGAL Mesh_2"]
        label = f"{case}, 20.7 degrees"
        is_bounded = not case.startswith("comb")
        table.add(label, "CGAL Mesh_2", theirs["triangles"], "triangles")
        table.add(label, "refined", ours["triangles"], "triangles", "CGAL", theirs["triangles"],
                  0.85 if is_bounded else None)
        table.add(label, "CGAL Mesh_2", microseconds_a_triangle(theirs), "us a triangle")
        table.add(label, "refined", microseconds_a_triangle(ours), "us a triangle", "CGAL",
                  microseconds_a_triangle(theirs), 0.25 if case.startswith("star") else None)
    large, *others = [row for row in rows if row["part"] == "patches"]
    case = "refinement, 25 degrees"
    table.add(case, large["case"], microseconds_a_triangle(large), "us a triangle")
    for row in others:
        table.add(case, f"{row['case']}, {row['size']:,} faces in", microseconds_a_triangle(row), "us a triangle",
                  "the plate", microseconds_a_triangle(large), 3)


def microseconds_a_triangle(row):
    return 1000 * row["ms"] / row["triangles"]
