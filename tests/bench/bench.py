#!/usr/bin/env python3
"""Measures this project, its parts and its peers on the same work in one run, alternating, and writes one table.

usage: bench.py BUILD_FOLDER [--runs N] [--faces N] [--only io|way|http]...

Writes bench/table.md and bench/table.json into the parent of the build folder, and prints the table. Every figure is
the median of the runs; what counts is the ratio to the row that it names, as machines and their moods differ. The
bounds are the project's own: a ratio above one is told.
"""

import argparse
import concurrent.futures
import http.client
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import time

WORKERS = 2


class Table:
    def __init__(self):
        self.rows = []

    def add(self, case, what, value, unit, against=None, base=None, bound=None):
        """A figure and, beside another one, the ratio that counts."""
        ratio = value / base if base else None
        self.rows.append({"case": case, "what": what, "value": round(value, 3), "unit": unit, "against": against,
                          "ratio": ratio and round(ratio, 3), "bound": bound})

    def markdown(self):
        lines = ["| case | what | median | against | ratio | bound |", "| --- | --- | ---: | --- | ---: | ---: |"]
        for row in self.rows:
            ratio = "" if row["ratio"] is None else f"{row['ratio']:.2f}"
            bound = "" if row["bound"] is None else f"{row['bound']}"
            if row["bound"] is not None and row["ratio"] > row["bound"]:
                ratio = f"**{ratio}**"
            lines.append(f"| {row['case']} | {row['what']} | {row['value']:.4g} {row['unit']} | {row['against'] or ''} "
                         f"| {ratio} | {bound} |")
        return "\n".join(lines) + "\n"


def run_process(arguments):
    """Seconds, and bytes at the peak."""
    start = time.perf_counter()
    child = subprocess.Popen(arguments, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{arguments[0]} failed")
    return time.perf_counter() - start, usage.ru_maxrss * 1024


def measure_io(table, build, files, runs):
    for name, path in files.items():
        output = subprocess.run([build / "io_bench", path, str(runs)], capture_output=True, text=True, check=True).stdout
        ms = {what: statistics.median(times) for what, times in json.loads(output).items()}
        loop, events = ms["from_chars loop"], ms["nlohmann-json, events"]
        case = f"{name}, text"
        table.add(case, "loop on std::from_chars", loop, "ms")
        table.add(case, "tinyobjloader", ms["tinyobjloader"], "ms", "the loop", loop)
        table.add(case, "OBJ in, one thread", ms["read_obj, 1 thread"], "ms", "the loop", loop, 1.5)
        table.add(case, "OBJ in, two threads", ms["read_obj, 2 threads"], "ms", "one thread",
                  ms["read_obj, 1 thread"], 1)
        table.add(case, "OBJ out, one thread", ms["write_obj, 1 thread"], "ms", "the loop", loop, 3)
        table.add(case, "OBJ out, two threads", ms["write_obj, 2 threads"], "ms", "one thread",
                  ms["write_obj, 1 thread"], 1)
        table.add(case, "nlohmann-json's events", events, "ms")
        table.add(case, "JSON in", ms["read_json"], "ms", "the events", events, 0.4)


def measure_way(table, build, files, runs, folder):
    """File to file, beside reading the file alone."""
    for name, path in files.items():
        faces = path.read_bytes().count(b"\nf ")
        seconds, peaks, reading = [], [], []
        for _ in range(runs):
            took, peak = run_process([build / "remesh", path, "-o", folder / "out.obj", "--refine", "false",
                                      "--workers", str(WORKERS)])
            seconds.append(took)
            peaks.append(peak)
            output = subprocess.run([build / "io_bench", path, "1"], capture_output=True, text=True, check=True).stdout
            reading.append(json.loads(output)["tinyobjloader"][0] / 1000)
        alone = statistics.median(reading)
        case = f"{name}, file to file"
        table.add(case, "tinyobjloader reads", alone, "s")
        table.add(case, "remesh, two threads", statistics.median(seconds), "s", "reading alone", alone, 0.5)
        table.add(case, "remesh, memory", statistics.median(peaks) / faces, "bytes a face", "182 bytes a face", 182, 1)


class Daemon:
    """A daemon on a free port, for as long as the block."""

    def __init__(self, build, workers):
        self.process = subprocess.Popen([build / "remeshd", "--bind", "127.0.0.1:0", "--store", "none", "--workers", str(workers)],
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for line in self.process.stdout:
            found = re.search(r"127\.0\.0\.1:(\d+)", line)
            if found:
                self.port = int(found[1])
                break
        else:
            sys.exit("remeshd does not start")
        # The log must not fill its pipe.
        self.drain = concurrent.futures.ThreadPoolExecutor(1)
        self.drain.submit(self.process.stdout.read)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.drain.shutdown()

    def post(self, connection, body):
        """Milliseconds on the wire, and those that the daemon spent on the work itself."""
        start = time.perf_counter()
        connection.request("POST", "/v1/remesh?refine=false&format=obj", body, {"Content-Type": "model/obj"})
        answer = connection.getresponse()
        answer.read()
        took = 1000 * (time.perf_counter() - start)
        if answer.status != 200:
            sys.exit(f"remeshd answered {answer.status}")
        work = re.search(r"total;dur=([\d.]+)", answer.headers["Server-Timing"])
        return took, float(work[1])


def measure_http(table, build, files, runs, folder):
    small = subprocess.run([build / "remesh_cases", "--write", "box", "1000"], capture_output=True, check=True).stdout
    name, path = next(iter(files.items()))
    with Daemon(build, WORKERS) as daemon:
        body = path.read_bytes()
        through_http, alone = [], []
        for _ in range(runs):
            connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=300)
            through_http.append(daemon.post(connection, body)[0] / 1000)
            connection.close()
            alone.append(run_process([build / "remesh", path, "-o", folder / "out.obj", "--refine", "false",
                                      "--workers", str(WORKERS)])[0])
        case = f"{name}, {len(body) >> 20} MB through HTTP"
        table.add(case, "command line", statistics.median(alone), "s")
        table.add(case, "HTTP", statistics.median(through_http), "s", "command line", statistics.median(alone), 1.15)

        connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=300)
        took = [daemon.post(connection, small) for _ in range(200)]
        case = "1,000 faces through HTTP"
        work = statistics.median(work for _, work in took)
        table.add(case, "the work", work, "ms")
        table.add(case, "HTTP over it", statistics.median(total - work for total, work in took), "ms", "1 ms", 1, 1)
        if shutil.which("wrk"):
            script = folder / "post.lua"
            (folder / "small.obj").write_bytes(small)
            script.write_text(f'local file = io.open("{folder}/small.obj", "rb")\nwrk.method = "POST"\n'
                              'wrk.body = file:read("*a")\nwrk.headers["Content-Type"] = "model/obj"\n')
            possible, answered = [], []
            for _ in range(runs):
                rate = subprocess.run([build / "remesh_cases", "--rate", "1000", str(WORKERS), "2"],
                                      capture_output=True, text=True, check=True).stdout
                possible.append(float(rate))
                output = subprocess.run(["wrk", "-t1", "-c8", "-d2s", "-s", script,
                                         f"http://127.0.0.1:{daemon.port}/v1/remesh?refine=false&format=obj"],
                                        capture_output=True, text=True, check=True).stdout
                if "Non-2xx" in output:
                    sys.exit(f"remeshd refuses under wrk:\n{output}")
                answered.append(float(re.search(r"Requests/sec:\s+([\d.]+)", output)[1]))
            table.add(case, "answered without HTTP", statistics.median(possible), "a second")
            table.add(case, "answered", statistics.median(answered), "a second")
            table.add(case, "time a request", 1000 / statistics.median(answered), "ms", "without HTTP",
                      1000 / statistics.median(possible), round(1 / 0.7, 2))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--faces", type=int, default=1_000_000)
    parser.add_argument("--only", action="append", choices=["io", "way", "http"])
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    folder = build.parent / "bench"
    folder.mkdir(exist_ok=True)
    files = {}
    for name in ["box", "bracket"]:
        files[name] = folder / f"{name}_{arguments.faces}.obj"
        if not files[name].exists():
            with open(files[name], "wb") as file:
                subprocess.run([build / "remesh_cases", "--write", name, str(arguments.faces)], stdout=file, check=True)
    table = Table()
    wanted = arguments.only or ["io", "way", "http"]
    if "io" in wanted:
        measure_io(table, build, files, arguments.runs)
    if "way" in wanted:
        measure_way(table, build, files, arguments.runs, folder)
    if "http" in wanted:
        measure_http(table, build, files, arguments.runs, folder)
    (folder / "table.md").write_text(table.markdown())
    (folder / "table.json").write_text(json.dumps(table.rows, indent=2) + "\n")
    print(table.markdown(), end="")


if __name__ == "__main__":
    main()
