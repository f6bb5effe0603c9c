"""Part `http`: the daemon beside the command line, and beside the work alone."""

import functools
import http.client
import pathlib
import re
import shutil
import statistics
import sys
import time

from programs import WORKERS, seconds

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from remeshd import Daemon  # noqa: E402

SHORT = 3  # times as many runs of what is short as of other works


def connect(daemon):
    return http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=300)


def post(connection, body):
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


def measure_http(bench, table):
    with Daemon(bench.program("remeshd"), "--workers", str(WORKERS)) as daemon:
        measure_large(bench, table, daemon)
        measure_small(bench, table, daemon)


def measure_large(bench, table, daemon):
    path = bench.input("box", bench.faces)
    body = path.read_bytes()

    def through_http():
        connection = connect(daemon)
        took, _ = post(connection, body)
        connection.close()
        return took / 1000

    results = bench.by_turns({"http": through_http, "alone": lambda: bench.remesh(path, "--refine", "false")}, SHORT)
    case = f"box, {len(body) >> 20} MB through HTTP"
    alone = seconds(results["alone"])
    table.add(case, "command line", alone, "s")
    table.add(case, "HTTP", statistics.median(results["http"]), "s", "command line", alone, 1.15)


def measure_small(bench, table, daemon):
    case = "1,000 faces through HTTP"
    path = bench.input("box", 1000)
    body = path.read_bytes()
    connection = connect(daemon)
    took = [post(connection, body) for _ in range(200)]
    connection.close()
    table.add(case, "the work", statistics.median(work for _, work in took), "ms")
    table.add(case, "HTTP over it", statistics.median(total - work for total, work in took), "ms", "1 ms", 1, 1)
    if not shutil.which("wrk"):
        table.leave_out(case, "answered", "wrk could not be had")
        return

    def script(name, fields):
        """Of wrk: what it sends."""
        file = bench.folder / name
        file.write_text(f'local file = io.open("{path}", "rb")\nwrk.method = "POST"\nwrk.body = file:read("*a")\n' +
                        "".join(f'wrk.headers["{key}"] = "{value}"\n' for key, value in fields.items()))
        return file

    plain = {"Content-Type": "model/obj"}
    scripts = {"kept": script("kept.lua", plain), "once": script("once.lua", {**plain, "Connection": "close"})}

    def possible():
        return float(bench.run(bench.program("remesh_cases"), "--rate", "1000", str(WORKERS), "1").output)

    def answered(connections):
        output = bench.run("wrk", "-t1", "-c8", "-d1s", "-s", scripts[connections],
                           f"http://127.0.0.1:{daemon.port}/v1/remesh?refine=false&format=obj").output
        if "Non-2xx" in output:
            sys.exit(f"remeshd refuses under wrk:\n{output}")
        return float(re.search(r"Requests/sec:\s+([\d.]+)", output)[1])

    results = bench.by_turns({"possible": possible, **{name: functools.partial(answered, name) for name in scripts}}, SHORT)
    possible_rate, kept, one_each = (statistics.median(results[name]) for name in ["possible", "kept", "once"])
    table.add(case, "answered without HTTP", possible_rate, "a second")
    table.add(case, "answered, connections kept", kept, "a second")
    table.add(case, "time a request", 1000 / kept, "ms", "without HTTP", 1000 / possible_rate, round(1 / 0.7, 2))
    table.add(case, "answered, a connection each", one_each, "a second")
    table.add(case, "time a request, a connection each", 1000 / one_each, "ms", "without HTTP", 1000 / possible_rate)
