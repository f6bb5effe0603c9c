"""What the parts of the benchmark share: the programs, their inputs, and how they are run."""

import dataclasses
import functools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

WORKERS = 2


@dataclasses.dataclass
class Run:
    seconds: float
    peak_bytes: int
    output: str
    report: dict = None

    def milliseconds_between_files(self):
        """Of remesh: all but reading and writing."""
        times = self.report["timing_ms"]
        return times["total"] - times.get("read", 0) - times.get("write", 0)


@dataclasses.dataclass(frozen=True)
class Bench:
    build: pathlib.Path
    folder: pathlib.Path  # for inputs, outputs and the results
    runs: int
    faces: int  # of the large inputs
    largest: int  # where growth ends

    def program(self, name):
        return self.build / name

    @functools.lru_cache(maxsize=None)
    def input(self, shape, faces):
        """An OBJ file with about so many triangles; a shape of remesh_cases."""
        path = self.folder / f"{shape}_{faces}.obj"
        if not path.exists():
            unfinished = path.with_suffix(".part")
            with open(unfinished, "wb") as file:
                subprocess.run([self.program("remesh_cases"), "--write", shape, str(faces)], stdout=file, check=True)
            unfinished.rename(path)
        return path

    def remesh(self, path, *options, workers=WORKERS, output="out.obj"):
        """The command line, with its report."""
        report = self.folder / "report.json"
        run = run_process([self.program("remesh"), path, "-o", self.folder / output, "--report", report,
                           "--workers", str(workers), *options])
        run.report = json.loads(report.read_bytes())
        return run

    def by_turns(self, works):
        """The results of all works, by their names. They take turns, so that all see the same moods of the machine."""
        results = {name: [] for name in works}
        for _ in range(self.runs):
            for name, work in works.items():
                results[name].append(work())
        return results


def run_process(arguments):
    """Runs it to its end; what it prints to standard output is kept, what it tells otherwise is passed on."""
    with tempfile.TemporaryFile() as output:
        start = time.perf_counter()
        child = subprocess.Popen(arguments, stdout=output)
        _, status, usage = os.wait4(child.pid, 0)
        seconds = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"{' '.join(map(str, arguments))} failed")
        output.seek(0)
        return Run(seconds, usage.ru_maxrss * 1024, output.read().decode())


def median(figure, runs):
    return statistics.median(map(figure, runs))


def seconds(runs):
    return median(lambda run: run.seconds, runs)


def peak_bytes(runs):
    return median(lambda run: run.peak_bytes, runs)


def face_count(path):
    return path.read_bytes().count(b"\nf ")
