"""Part `versions`: the program of this build beside that of another commit, on the same files and by turns.

The bound is that no kind of work has become slower by more than a thirtieth.
"""

from programs import peak_bytes, seconds

BOUND = 1.03
WORKS = [
    ("ball", 100_000, ["--refine", "false"]),
    ("ball", 100_000, []),
    ("terrain", 100_000, []),
    ("isosurface", 100_000, ["--refine", "false"]),
    ("box", 1_000_000, ["--refine", "false"]),
    ("bracket", 100_000, []),
    ("plate", 30_000, ["--max-edge-fraction", "0.01"]),
    ("plate", 30_000, ["--preset", "volume"]),
]


def measure_versions(bench, table):
    if bench.before is None:
        table.leave_out("this build and the one before", "all", "name a commit with --against")
        return
    for shape, faces, options in WORKS:
        path = bench.input(shape, faces)
        results = bench.by_turns({
            "this build": lambda: bench.remesh(path, *options),
            "the one before": lambda: bench.remesh(path, *options, program=bench.before),
        })
        add_rows(table, " ".join([shape, f"{faces:,} faces", *options]), results)
        table.write(bench.folder)


def add_rows(table, case, results):
    now, before = results["this build"], results["the one before"]
    table.add(case, "time", seconds(now), "s", "the build before", seconds(before), BOUND)
    table.add(case, "memory", peak_bytes(now) / 2**20, "MB", "the build before", peak_bytes(before) / 2**20, BOUND)
