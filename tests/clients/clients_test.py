"""HTTP clients that are not ours against a real remeshd: clients_test.py REMESHD [--full]

Each client that is there uploads in all of its styles, pauses between requests on kept connections, sends hundreds of small
uploads at once, and uploads slowly what is refused at once. Clients that are not there are named. --full adds the clients that
must be compiled, takes all pauses, and lasts a quarter of an hour.
"""

import collections
import concurrent.futures
import contextlib
import hashlib
import http.client
import importlib.util
import itertools
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import programs
from daemons import PATIENCE, ROOT, SQUARE, Daemon, expect

KEY = "clients-test-key-0123456789"
MESH = ROOT / "tests" / "data" / "bracket.obj"
FULL = "--full" in sys.argv
CONNECTIONS = 20 if FULL else 5
# With an idle timeout of 3 s, as it once was, many clients lose requests after pauses of about this length.
PAUSES = [1, 2, 3, 5, 10, 60] if FULL else [3]
ROUNDS = 10 if FULL else 2
RATE_OF_PAUSES = 100  # requests a second, so that the test is about pauses and not about load
RATE = 2_000_000  # bytes a second of a slow upload


def has(module):
    return importlib.util.find_spec(module) is not None


class PlainSession:
    """Python's http.client, on one connection, which it does not open anew."""

    def __init__(self, port):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)

    def close(self):
        self.connection.close()

    def post(self, path, body, headers=None):
        self.connection.request("POST", path, body, headers or {})
        answer = self.connection.getresponse()
        return answer.status, answer.read()


class RequestsSession:
    def __init__(self, port):
        import requests
        self.session = requests.Session()
        self.base = f"http://127.0.0.1:{port}"

    def close(self):
        self.session.close()

    def post(self, path, body, headers=None):
        answer = self.session.post(self.base + path, data=body, headers=headers, timeout=PATIENCE)
        return answer.status_code, answer.content

    def post_form(self, path, file):
        with file.open("rb") as mesh:
            answer = self.session.post(self.base + path, files={"mesh": mesh}, timeout=PATIENCE)
        return answer.status_code, answer.content


class Urllib3Session:
    def __init__(self, port):
        import urllib3
        self.pool = urllib3.HTTPConnectionPool("127.0.0.1", port, retries=False, timeout=PATIENCE)

    def close(self):
        self.pool.close()

    def post(self, path, body, headers=None):
        answer = self.pool.request("POST", path, body=body, headers=headers)
        return answer.status, answer.data

    def post_form(self, path, file):
        answer = self.pool.request("POST", path, fields={"mesh": (file.name, file.read_bytes())})
        return answer.status, answer.data


class HttpxSession:
    def __init__(self, port):
        import httpx
        self.client = httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE)

    def close(self):
        self.client.close()

    def post(self, path, body, headers=None):
        answer = self.client.post(path, content=body, headers=headers)
        return answer.status_code, answer.content

    def post_form(self, path, file):
        with file.open("rb") as mesh:
            answer = self.client.post(path, files={"mesh": mesh})
        return answer.status_code, answer.content


class AiohttpSession:
    def __init__(self, port):
        import aiohttp
        import asyncio
        self.aiohttp = aiohttp
        self.loop = asyncio.new_event_loop()
        self.base = f"http://127.0.0.1:{port}"
        self.session = self.loop.run_until_complete(self._open())

    async def _open(self):
        return self.aiohttp.ClientSession(timeout=self.aiohttp.ClientTimeout(total=PATIENCE))

    async def _post(self, path, **arguments):
        async with self.session.post(self.base + path, **arguments) as answer:
            return answer.status, await answer.read()

    async def _pieces(self, body):
        for piece in body:
            yield piece

    def close(self):
        self.loop.run_until_complete(self.session.close())
        self.loop.close()

    def post(self, path, body, headers=None):
        data = body if isinstance(body, bytes) else self._pieces(body)
        return self.loop.run_until_complete(self._post(path, data=data, headers=headers))

    def post_form(self, path, file):
        with file.open("rb") as mesh:
            return self.loop.run_until_complete(self._post(path, data={"mesh": mesh}))


SESSIONS = {"http.client": PlainSession}
for _module, _session in (("requests", RequestsSession), ("urllib3", Urllib3Session), ("httpx", HttpxSession),
                          ("aiohttp", AiohttpSession)):
    if has(_module):
        SESSIONS[_module] = _session
    else:
        print(f"SKIPPED: Python has no {_module} here")


@contextlib.contextmanager
def opened(name, port):
    """A session of Python's client of this name, for the length of a `with`."""
    session = SESSIONS[name](port)
    try:
        yield session
    finally:
        session.close()


def command_uploads(port):
    """The same upload by programs: pairs of a name and what it got."""
    url = f"http://127.0.0.1:{port}/v1/remesh"
    commands = {
        "curl --data-binary": ["curl", "-sS", "--data-binary", f"@{MESH}", url],
        "curl in chunks": ["curl", "-sS", "-H", "Transfer-Encoding: chunked", "--data-binary", f"@{MESH}", url],
        "curl of HTTP/1.0": ["curl", "-sS", "--http1.0", "--data-binary", f"@{MESH}", url],
        "curl with a form": ["curl", "-sS", "-F", f"mesh=@{MESH}", url],
        "wget --post-file": ["wget", "-q", "-O", "-", f"--post-file={MESH}", url],
    }
    for name, command in commands.items():
        if shutil.which(command[0]):
            yield name, subprocess.run(command, check=True, capture_output=True, timeout=PATIENCE).stdout
        else:
            print(f"SKIPPED: there is no {command[0]}")


def pieces(body, size):
    for begin in range(0, len(body), size):
        yield body[begin:begin + size]


def check_uploads(program, commands):
    """Every style of every client gives the same bytes."""
    body = MESH.read_bytes()
    with Daemon(program) as daemon:
        wanted = PlainSession(daemon.port).post("/v1/remesh", body)
        expect(wanted[0] == 200, f"an upload: {wanted}")
        count = 1
        for name in SESSIONS:
            with opened(name, daemon.port) as client:
                styles = {"whole": lambda: client.post("/v1/remesh", body),
                          "generator": lambda: client.post("/v1/remesh", pieces(body, 10_000))}
                if hasattr(client, "post_form"):
                    styles["form"] = lambda: client.post_form("/v1/remesh", MESH)
                for style, upload in styles.items():
                    expect(upload() == wanted, f"{name}, {style}: another answer")
                    count += 1
        for name, got in command_uploads(daemon.port):
            expect(got == wanted[1], f"{name}: another answer: {got[:200]}")
            count += 1
        wanted_sum = hashlib.sha256(wanted[1]).hexdigest()
        for name, command in commands.items():
            url = f"http://127.0.0.1:{daemon.port}/v1/remesh"
            lines = programs.run(command, "upload", url, MESH, timeout=PATIENCE)
            expect(lines, f"the client in {name} uploaded nothing")
            for line in lines:
                expect(line.status == "200" and line.rest == wanted_sum, f"another answer: {line}")
                count += 1
    print(f"{count} styles of uploads give the same bytes")


class Curl:
    """curl, which keeps its connection between the addresses that one call is given."""

    def command(self, url, file, pause):
        return ["curl", "-sS", "--rate", f"{60 // pause}/m", "-o", "/dev/null", "-w", "%{http_code}\\n", "--data-binary",
                f"@{file}", f"{url}&max_output_faces=[1000-{1000 + ROUNDS}]"]

    def statuses(self, done):
        return done.stdout.split()


class Wget:
    """wget, whose log tells the statuses."""

    def command(self, url, file, pause):
        urls = [f"{url}&max_output_faces={number}" for number in range(1000, 1001 + ROUNDS)]
        return ["wget", "-S", "--tries=1", f"--wait={pause}", "-O", "/dev/null", f"--post-file={file}", *urls]

    def statuses(self, done):
        return [line.split()[1] for line in done.stderr.splitlines() if line.strip().startswith("HTTP/1.1 ")]


def session_pause(name, port, pause):
    """The statuses that a session of Python gets on one connection."""
    statuses = []
    with opened(name, port) as client:
        for number in range(ROUNDS + 1):
            time.sleep(pause if number else 0)
            try:
                statuses.append(str(client.post("/v1/remesh?refine=false", SQUARE)[0]))
            except Exception as error:  # every client has errors of its own
                statuses.append(f"lost: {error!r}")
    return [(name, status) for status in statuses]


def tool_pause(name, tool, url, file, pause):
    command = tool.command(url, file, pause)
    done = subprocess.run(command, capture_output=True, text=True, timeout=10 * PATIENCE + 2 * pause * ROUNDS)
    return [(name, status) for status in tool.statuses(done)]


def program_pause(command, url, file, pause):
    lines = programs.run(command, "pause", url, file, pause, ROUNDS, CONNECTIONS, timeout=10 * PATIENCE + 2 * pause * ROUNDS)
    return [(line.client, line.status if line.status != "lost" else f"lost: {line.rest}") for line in lines]


def check_pause(program, commands, file, pause):
    """Some clients at once, each on its connections. Output: what failed."""
    tools = {name: tool for name, tool in (("curl", Curl()), ("wget", Wget())) if shutil.which(name)}
    statuses = collections.defaultdict(collections.Counter)
    with Daemon(program, "--max-connections-per-address", "1024", "--max-connections", "1024") as daemon:
        url = f"http://127.0.0.1:{daemon.port}/v1/remesh?refine=false"
        uses = [[(session_pause, name, daemon.port, pause)] * CONNECTIONS for name in SESSIONS]
        uses += [[(tool_pause, name, tool, url, file, pause)] * CONNECTIONS for name, tool in tools.items()]
        uses += [[(program_pause, command, url, file, pause)] for command in commands.values()]
        at_once = math.ceil(RATE_OF_PAUSES * pause / CONNECTIONS)
        with concurrent.futures.ThreadPoolExecutor(CONNECTIONS * len(uses)) as threads:
            for begin in range(0, len(uses), at_once):
                running = []
                for client in uses[begin:begin + at_once]:
                    running += [threads.submit(*use) for use in client]
                    time.sleep(pause / at_once)  # so that their rounds come one after another
                for done in running:
                    for name, status in done.result():
                        statuses[name][status] += 1
    wanted = {"200": CONNECTIONS * (ROUNDS + 1)}
    faults = {name: dict(counter) for name, counter in statuses.items() if counter != wanted}
    print(f"pauses of {pause} s: {len(statuses) - len(faults)} of {len(statuses)} clients lost none of {wanted['200']} requests",
          flush=True)
    return [f"pauses of {pause} s: {name}: {counter}" for name, counter in faults.items()]


def check_pauses(program, commands):
    """No request is lost on connections that were idle for a while."""
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(1) as threads:
        file = pathlib.Path(folder) / "square.obj"
        file.write_bytes(SQUARE)
        # The longest pause takes as long as all others.
        longest = threads.submit(check_pause, program, commands, file, PAUSES[-1])
        faults = sum((check_pause(program, commands, file, pause) for pause in PAUSES[:-1]), []) + longest.result()
    expect(not faults, "\n".join(faults))


def check_small_ones(program):
    """Of 500 small uploads, 50 at a time, none is refused."""
    with Daemon(program) as daemon:
        numbers = itertools.count()

        def use(_):
            client = PlainSession(daemon.port)
            statuses = set()
            while next(numbers) < 500:
                statuses.add(client.post("/v1/remesh", SQUARE)[0])
            return statuses

        with concurrent.futures.ThreadPoolExecutor(50) as threads:
            statuses = set().union(*threads.map(use, range(50)))
        expect(statuses == {200}, f"small uploads were answered with {statuses}")
        if shutil.which("curl"):
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder) / "square.obj"
                path.write_bytes(SQUARE)
                command = ["curl", "-sS", "-Z", "--parallel-max", "50", "-w", "%{http_code}\\n", "-o", "/dev/null",
                           "--data-binary", f"@{path}", f"http://127.0.0.1:{daemon.port}/v1/remesh?max_output_faces=[1001-1100]"]
                lines = subprocess.run(command, check=True, capture_output=True, text=True, timeout=PATIENCE).stdout.split()
                expect(set(lines) == {"200"} and len(lines) == 100, f"curl -Z got {lines}")
    print("500 small uploads by 50 at a time and 100 by curl -Z: none refused")


def slowly(size):
    piece = b"#" * 65536
    began = time.monotonic()
    for sent in range(0, size, len(piece)):
        time.sleep(max(0, began + sent / RATE - time.monotonic()))
        yield piece


def check_early_answers(program, commands):
    """A slow upload that is refused at once sees the answer."""
    size = 20_000_000 if FULL else 4_000_000

    def see(name, status, port):
        try:
            with opened(name, port) as client:
                got = str(client.post("/v1/remesh", slowly(size), {"Content-Type": "model/obj"})[0])
        except Exception as error:  # every client has errors of its own
            got = f"lost: {error!r}"
        return [(name, status, got)]

    def see_by_program(command, status, port):
        lines = programs.run(command, "early", f"http://127.0.0.1:{port}/v1/remesh", size, RATE, timeout=3 * PATIENCE)
        return [(line.client, status, line.status if line.status != "lost" else f"lost: {line.rest}") for line in lines]

    with Daemon(program, key=KEY) as keyed, Daemon(program, "--max-body", "1MiB") as small:
        with concurrent.futures.ThreadPoolExecutor(100) as threads:
            cases = ((401, keyed.port), (413, small.port))
            uses = [threads.submit(see, name, *case) for name in SESSIONS for case in cases]
            uses += [threads.submit(see_by_program, command, *case) for command in commands.values() for case in cases]
            results = sum((done.result() for done in uses), [])
    faults = [f"{name}: {got} instead of {status}" for name, status, got in results if got != str(status)]
    print(f"{len(results) - len(faults)} of {len(results)} slow uploads see the 401 or the 413 that came before their end")
    expect(not faults, "\n".join(faults))


def main():
    # Hundreds of threads that wait for the interpreter would otherwise wake up two hundred times a second each.
    sys.setswitchinterval(0.5)
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        commands = programs.make_ready(FULL, pathlib.Path(folder))
        check_uploads(program, commands)
        check_small_ones(program)
        check_early_answers(program, commands)
        check_pauses(program, commands)
    return 0


if __name__ == "__main__":
    sys.exit(main())
