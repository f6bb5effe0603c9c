#!/usr/bin/env python3
"""Does progress tell how far a run is? Remeshes meshes below the given folders over HTTP, drawn with options of many kinds,
and asks for the progress of each run meanwhile. Writes a Markdown table of the runs to standard output: those that went
back, and how far the fraction was from the share of the time, in the median of what was told of a run.

Exit code: 0; 2 for misuse. 1 if a run went back, or if runs of over 2 s were more than 0.2 away in their median.
"""

import argparse
import gzip
import http.client
import json
import pathlib
import random
import statistics
import sys
import threading
import time
import uuid

import surface_files
from tool import print_table, say

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import remeshd  # noqa: E402

SETTINGS = ["", "min_angle_deg=30", "max_edge_fraction=0.003", "max_edge_fraction=0.002", "target_faces=200000",
            "target_faces=400000", "proximity=1", "proximity=2&max_edge_fraction=0.004", "preset=volume&target_faces=300000",
            "elements_per_circle=64&max_edge_fraction=0.003", "surface_tolerance_fraction=0.001",
            "surface_tolerance_fraction=0.0005&max_edge_fraction=0.004", "refine=false", "max_edge_fraction=0.002&preset=exact"]
CORPUS = [pathlib.Path("../shared/meshes") / folder for folder in ("planar-cad", "curved-cad", "curved", "polygons", "seed")]
LONG_S, ALLOWED = 2.0, 0.2
PERIOD_S = 0.02
LIMIT_S = 15  # runs that take longer are left out


def request(port, method, path, body=None, headers=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=300)
    connection.request(method, path, body, headers or {})
    answer = connection.getresponse()
    text = answer.read()
    connection.close()
    return answer.status, text


def run(port, mesh, setting, name):
    """What was told: (elapsed seconds, fraction, stage); and the status."""
    body = mesh.read_bytes()
    if mesh.suffix == ".gz":
        body = gzip.decompress(body)
    told, status = [], []
    post = threading.Thread(target=lambda: status.append(
        request(port, "POST", f"/v1/remesh?{setting}", body, {"X-Request-Id": name, "Accept": "model/obj"})[0]))
    post.start()
    while post.is_alive():
        code, text = request(port, "GET", f"/v1/requests/{name}")
        if code == 200:
            answer = json.loads(text)
            told.append((answer["elapsed_s"], answer["fraction"], answer["stage"]))
        time.sleep(PERIOD_S)
    post.join()
    return told, status[0]


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--remeshd", default="build/release/remeshd", help="the program; by default %(default)s")
    parser.add_argument("--runs", type=int, default=50, metavar="N", help="that succeed (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the draw (%(default)s)")
    parser.add_argument("paths", nargs="*", metavar="PATH", help="files or folders; by default the shared meshes")
    asked = parser.parse_args(arguments)
    meshes = [file for path in map(pathlib.Path, asked.paths or CORPUS)
              for file in (sorted(path.rglob("*")) if path.is_dir() else [path]) if surface_files.is_surface_file(file)]
    if not meshes:
        parser.error("no surface there")
    draw = random.Random(asked.seed)
    rows, attempts = [], 0
    with remeshd.Daemon(asked.remeshd, f"--request-timeout={LIMIT_S}s") as daemon:
        while len(rows) < asked.runs and (attempts := attempts + 1) <= 4 * asked.runs:
            mesh, setting = draw.choice(meshes), draw.choice(SETTINGS)
            say(f"{mesh.name} {setting}")
            told, status = run(daemon.port, mesh, setting, uuid.uuid4().hex)
            if status != 200 or not told:
                continue
            total = told[-1][0]
            fractions = [fraction for _, fraction, _ in told]
            goes_back = any(after < before for before, after in zip(fractions, fractions[1:]))
            off = statistics.median(abs(fraction - elapsed / max(total, 1e-9)) for elapsed, fraction, _ in told)
            rows.append((mesh.name, setting or "defaults", total, off, goes_back))
            say(f"  {total:.1f} s, off by {off:.2f}" + (", and it went back" if goes_back else ""))
    long = [row for row in rows if row[2] > LONG_S]
    off = statistics.median(row[3] for row in long) if long else float("nan")
    print_table([["runs", "went back", f"over {LONG_S:g} s", "off in the median", f"of these over {ALLOWED:g}", "largest"],
                 [str(len(rows)), str(sum(row[4] for row in rows)), str(len(long)), f"{off:.2f}",
                  str(sum(row[3] > ALLOWED for row in long)), f"{max((row[3] for row in long), default=0):.2f}"]])
    print()
    print_table([["mesh", "options", "seconds", "off"]] + [[row[0], row[1], f"{row[2]:.1f}", f"{row[3]:.2f}"] for row in long])
    return 1 if any(row[4] for row in rows) or off > ALLOWED else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
