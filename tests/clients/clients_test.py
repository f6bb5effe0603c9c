"""HTTP clients that are not ours against a real remeshd: clients_test.py REMESHD [--full]

Each client that is there uploads in all of its styles, pauses between requests on kept connections, sends hundreds of small
uploads at once, and uploads slowly what is refused at once. Clients that are not there are named. --full takes all pauses and
20 connections, and half an hour.
"""

import concurrent.futures
import http.client
import importlib.util
import itertools
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from daemons import PATIENCE, ROOT, SQUARE, Daemon, expect

KEY = "clients-test-key-0123456789"
MESH = ROOT / "tests" / "data" / "bracket.obj"
FULL = "--full" in sys.argv
CONNECTIONS = 20
# With an idle timeout of 3 s, as it once was, many clients lose requests after pauses of about this length.
PAUSES = [1, 2, 3, 5, 10, 60] if FULL else [3]
ROUNDS = 10 if FULL else 2
RATE = 2_000_000  # bytes a second of a slow upload


def has(module):
    return importlib.util.find_spec(module) is not None


class PlainSession:
    """Python's http.client, on one connection, which it does not open anew."""

    def __init__(self, port):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)

    def post(self, path, body, headers=None):
        self.connection.request("POST", path, body, headers or {})
        answer = self.connection.getresponse()
        return answer.status, answer.read()


class RequestsSession:
    def __init__(self, port):
        import requests
        self.session = requests.Session()
        self.base = f"http://127.0.0.1:{port}"

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

NODE_UPLOADS = """
const [url, path] = process.argv.slice(1);
const { readFileSync, createReadStream } = require("node:fs");
(async () => {
  const bytes = readFileSync(path);
  const form = new FormData();
  form.append("mesh", new Blob([bytes]), "part.obj");
  for (const options of [{ body: bytes }, { body: form }, { body: createReadStream(path), duplex: "half" }]) {
    const answer = await fetch(url, { method: "POST", ...options });
    const text = Buffer.from(await answer.arrayBuffer()).toString("base64");
    console.log(answer.status + " " + text);
  }
})();
"""


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
    if shutil.which("node"):
        import base64
        answers = subprocess.run(["node", "-e", NODE_UPLOADS, url, str(MESH)], check=True, capture_output=True,
                                 timeout=PATIENCE, text=True).stdout.splitlines()
        for number, line in enumerate(answers):
            status, text = line.split(" ")
            yield f"fetch of Node, style {number}: {status}", base64.b64decode(text)


def pieces(body, size):
    for begin in range(0, len(body), size):
        yield body[begin:begin + size]


def check_uploads(program):
    """Every style of every client gives the same bytes."""
    body = MESH.read_bytes()
    with Daemon(program) as daemon:
        wanted = PlainSession(daemon.port).post("/v1/remesh", body)
        expect(wanted[0] == 200, f"an upload: {wanted}")
        count = 1
        for name, session in SESSIONS.items():
            client = session(daemon.port)
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
    print(f"{count} styles of uploads give the same bytes")


def check_pauses(program):
    """No request is lost on connections that were idle for a while."""
    with Daemon(program, "--max-connections-per-address", "512") as daemon:
        def use(name, session, pause):
            client = session(daemon.port)
            for _ in range(ROUNDS):
                status, _ = client.post("/v1/remesh?refine=false", SQUARE)
                expect(status == 200, f"{name}, pause of {pause} s: {status}")
                time.sleep(pause)
            client.post("/v1/remesh?refine=false", SQUARE)

        for pause in PAUSES:
            with concurrent.futures.ThreadPoolExecutor(CONNECTIONS * len(SESSIONS)) as threads:
                uses = [threads.submit(use, name, session, pause) for name, session in SESSIONS.items()
                        for _ in range(CONNECTIONS)]
                for done in uses:
                    done.result()
            print(f"pauses of {pause} s: no request lost of {CONNECTIONS * len(SESSIONS) * (ROUNDS + 1)}")


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


def check_early_answers(program):
    """A slow upload that is refused at once sees the answer."""
    size = 20_000_000 if FULL else 8_000_000

    def see(name, session, status, port, body):
        got = session(port).post("/v1/remesh", body, {"Content-Type": "model/obj"})
        expect(got[0] == status, f"{name}: {got[0]} instead of {status}")

    with Daemon(program, key=KEY) as keyed, Daemon(program, "--max-body", "1MiB") as small:
        with concurrent.futures.ThreadPoolExecutor(2 * len(SESSIONS)) as threads:
            uses = [threads.submit(see, name, session, status, daemon.port, slowly(size))
                    for name, session in SESSIONS.items() for status, daemon in ((401, keyed), (413, small))]
            for done in uses:
                done.result()
    print("slow uploads see the 401 and the 413 that came before their end")


def main():
    program = sys.argv[1]
    check_uploads(program)
    check_small_ones(program)
    check_early_answers(program)
    check_pauses(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
