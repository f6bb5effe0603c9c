"""What the parts of the benchmark share: the programs, their inputs, and how they are run."""

import dataclasses
import functools
import json
import pathlib
import statistics
import subprocess
import sys

WORKERS = 2


@dataclasses.dataclass
class Run:
    seconds: float
    peak_bytes: int
    output: str
    report: dict = None


@dataclasses.dataclass(frozen=True)
class Bench:
    build: pathlib.Path
    folder: pathlib.Path  # for inputs, outputs and the results
    runs: int
    faces: int  # of the large inputs
    largest: int  # where growth ends
    meshes: tuple = ()  # files that the part `coarse` remeshes instead of its own
    steps: tuple = ()  # STEP files
    tessellated: pathlib.Path = None  # where NAME-ANGLE.stl and its surfaces are for each of them
    before: pathlib.Path = None  # the program `remesh` of another commit

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

    def run(self, *command):
        """To its end; what it prints to standard output is kept."""
        run = self.attempt(*command, stderr=None)
        if run is None:
            sys.exit(f"{' '.join(map(str, command))} failed")
        return run

    def attempt(self, *command, stderr=subprocess.DEVNULL):
        """The same of a program that may fail; then None, and nobody hears what it says of it."""
        figures = self.folder / "measured.json"
        done = subprocess.run([self.program("measured"), figures, *command], stdout=subprocess.PIPE, stderr=stderr,
                              text=True)
        if done.returncode != 0:
            return None
        measured = json.loads(figures.read_text())
        return Run(measured["seconds"], measured["peak_bytes"], done.stdout)

    def remesh(self, path, *options, workers=WORKERS, output="out.obj", program=None):
        """The command line, with its report."""
        report = self.folder / "report.json"
        run = self.remesh_alone(path, "--report", report, *options, workers=workers, output=output, program=program)
        run.report = json.loads(report.read_bytes())
        return run

    def remesh_alone(self, path, *options, workers=WORKERS, output="out.obj", program=None):
        """The command line without a report, which has a line for each patch and peers do not have."""
        return self.run(program or self.program("remesh"), path, "-o", self.folder / output, "--workers", str(workers),
                        *options)

    def by_turns(self, works, times=1):
        """The results of all works, by their names. They take turns, so that all see the same moods of the machine.
        `times`: as many runs as asked for, for works that are short beside those moods."""
        results = {name: [] for name in works}
        for _ in range(self.runs * times):
            for name, work in works.items():
                results[name].append(work())
        return results


def median(figure, runs):
    return statistics.median(map(figure, runs))


def seconds(runs):
    return median(lambda run: run.seconds, runs)


def peak_bytes(runs):
    return median(lambda run: run.peak_bytes, runs)


def face_count(path):
    with open(path, "rb") as file:
        return sum(line.startswith(b"f ") for line in file)
