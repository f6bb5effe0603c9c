"""Compares the results of two builds of `remesh`: the same vertices and faces, bit for bit.

usage: compare_results.py OLD NEW [--skip TEXT]... [--limit MB] PATH...

Each mesh file of the paths is remeshed by both programs with three sets of options: without refinement, with the
defaults, and with bounds on gaps and angles. The vertices, the faces and the patch of each face must be the same, and so
must the exit codes. Comments, messages and times may differ. Files whose path contains a TEXT are left out, and so are
files of more than so many MB (default: 1); both are counted.

Exit code: 0 - the results are the same; 1 - some differ, and are listed.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile

OPTION_SETS = [["--refine", "false"], [], ["--proximity", "1", "--min-angle-deg", "20"]]
ENDINGS = (".obj", ".stl", ".ply", ".off", ".json")


def mesh_files(paths):
    for path in paths:
        if os.path.isfile(path):
            yield path
        for folder, folders, names in os.walk(path):
            folders.sort()
            for name in sorted(names):
                if name.lower().removesuffix(".gz").endswith(ENDINGS):
                    yield os.path.join(folder, name)


def outcome(program, path, options, seconds):
    """What must not change: the exit code and the mesh, as the digits that were written."""
    with tempfile.TemporaryDirectory() as folder:
        written = os.path.join(folder, "out.json")
        command = [program, path, "-o", written, "--format", "json", *options]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
        except subprocess.TimeoutExpired:
            return ("timeout", "")
        if run.returncode != 0:
            return (run.returncode, run.stderr.split(":")[1] if ":" in run.stderr else run.stderr)
        with open(written, encoding="utf-8") as file:
            # Numbers stay as they are written, so that no digit is lost.
            answer = json.load(file, parse_float=str, parse_int=str)
        mesh = answer["mesh"]
        return (0, [mesh["vertices"], mesh["faces"], mesh.get("face_patch")])


def difference(old, new):
    if old[0] != new[0]:
        return f"exit code or end {old[0]} and {new[0]}"
    if old == new:
        return None
    if old[0] != 0:
        return f"errors {old[1]} and {new[1]}"
    names = ("vertices", "faces", "patches of faces")
    parts = [f"{name} ({len(a)} and {len(b)})" for name, a, b in zip(names, old[1], new[1]) if a != b]
    return "different " + ", ".join(parts)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("paths", nargs="+", metavar="PATH")
    parser.add_argument("--skip", action="append", default=[])
    parser.add_argument("--limit", type=float, default=1, help="largest file, MB")
    parser.add_argument("--seconds", type=float, default=120, help="for one run")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()

    files, left_out = [], 0
    for path in mesh_files(arguments.paths):
        is_left_out = any(text in path for text in arguments.skip) or os.path.getsize(path) > arguments.limit * 1e6
        left_out += is_left_out
        if not is_left_out:
            files.append(path)

    def compare(case):
        path, options = case
        run = lambda program: outcome(program, path, options, arguments.seconds)
        return path, options, difference(run(arguments.old), run(arguments.new))

    cases = [(path, options) for path in files for options in OPTION_SETS]
    differing = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for path, options, text in pool.map(compare, cases):
            if text:
                differing += 1
                print(f"{path} {' '.join(options)}: {text}", flush=True)
    print(f"{len(cases)} runs of {len(files)} files, {differing} differ; {left_out} files left out")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
