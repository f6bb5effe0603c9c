#!/usr/bin/env python3
"""Counts the instructions of the fixed cases under callgrind and holds them to the counts that are kept.

usage: instructions.py PROGRAM COUNTS.json [--update]

Instructions do not depend on how busy a machine is: a case that takes a twentieth more than it did has become slower.
Fewer is told, too, so that the kept counts follow. Other compilers and libraries count differently: what is kept is
Debian bookworm's, built as `./dev build` does.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

BOUND = 0.03


def count(program, case):
    """The instructions of one case, its preparation not counted."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=*run_case*",
             f"--callgrind-out-file={folder}/out", program, case],
            capture_output=True, text=True)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found or int(found[1]) == 0:
        sys.exit(f"{case}: not counted\n{run.stderr}")
    return int(found[1])


def main(program, path, *flags):
    path = pathlib.Path(path)
    kept = json.loads(path.read_text()) if path.exists() else {}
    cases = subprocess.run([program, "--list"], capture_output=True, text=True, check=True).stdout.split()
    counted, failed = {}, False
    print(f"{'case':24}{'instructions':>16}{'kept':>16}{'ratio':>8}")
    for case in cases:
        counted[case] = count(program, case)
        ratio = counted[case] / kept[case] if case in kept else None
        verdict = "new" if ratio is None else "MORE" if ratio > 1 + BOUND else "fewer" if ratio < 1 - BOUND else ""
        failed |= verdict in ("new", "MORE")
        ratio_text = "" if ratio is None else f"{ratio:.3f}"
        print(f"{case:24}{counted[case]:16,}{kept.get(case, 0):16,}{ratio_text:>8} {verdict}", flush=True)
    if "--update" in flags:
        path.write_text(json.dumps(counted, indent=2) + "\n")
        return
    if failed:
        sys.exit(f"more instructions than kept in {path}; where that is meant, ./dev bench --update writes them anew")


if __name__ == "__main__":
    main(*sys.argv[1:])
