"""A real remeshd, and the proxies that may stand before it, for the tests beside it."""

import contextlib
import http.client
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from remeshd import Daemon  # noqa: E402, F401 - for the tests beside this file

ROOT = pathlib.Path(__file__).resolve().parents[2]
UNPACKED = ROOT / "build" / "unpacked" / "usr"
PATIENCE = 120  # seconds for what must happen; long, so that a busy machine is not mistaken for a fault
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
# More work than any test here waits for.
ENDLESS = "max_edge_length=0.0003"


def find_program(name):
    """The path of a program that is installed or unpacked; None if it is not there."""
    for folder in ("bin", "sbin"):
        if (UNPACKED / folder / name).exists():
            return str(UNPACKED / folder / name)
    return shutil.which(name) or shutil.which(name, path="/usr/sbin:/sbin")


def free_port():
    with contextlib.closing(socket.create_server(("127.0.0.1", 0))) as server:
        return server.getsockname()[1]


def wait_until(condition, what):
    """Waits for a condition. Returns the seconds that it took."""
    began = time.monotonic()
    while not condition():
        if time.monotonic() - began > PATIENCE:
            raise AssertionError(f"this did not happen within {PATIENCE} s: {what}")
        time.sleep(0.005)
    return time.monotonic() - began


class Proxy:
    """A program that listens on a port, for the length of a `with`."""

    def __init__(self, command, port, folder):
        environment = {**os.environ, "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
        with (folder / "proxy.log").open("wb") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
        self.port = port
        self.folder = folder

    def __enter__(self):
        wait_until(self._listens, "the proxy listens")
        return self

    def _listens(self):
        if self.process.poll() is not None:
            raise AssertionError("the proxy ended at its start: " + (self.folder / "proxy.log").read_text()[-500:])
        with contextlib.suppress(OSError):
            socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
            return True
        return False

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


def nginx(configuration, folder):
    """Starts nginx with the given part of an `http` block, in which PORT is the port to listen on."""
    port = free_port()
    paths = "".join(f"{kind}_temp_path {folder}/{kind};\n" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
    text = (f"daemon off;\npid {folder}/pid;\nerror_log stderr;\nworker_processes 1;\nevents {{ worker_connections 4096; }}\n"
            f"http {{\naccess_log off;\n{paths}{configuration.replace('PORT', str(port))}\n}}\n")
    if os.geteuid() == 0:
        text = "user root;\n" + text
    path = folder / "nginx.conf"
    path.write_text(text)
    return Proxy([find_program("nginx"), "-p", str(folder), "-e", "stderr", "-c", str(path)], port, folder)


def caddy(configuration, folder):
    """Starts Caddy with the given sites, in which PORT is the port to listen on."""
    port = free_port()
    path = folder / "Caddyfile"
    path.write_text("{\n\tadmin off\n\tauto_https off\n}\n" + configuration.replace("PORT", str(port)))
    return Proxy([find_program("caddy"), "run", "--adapter", "caddyfile", "--config", str(path)], port, folder)


class Answer:
    def __init__(self, response):
        self.status = response.status
        self.headers = {name.lower(): value for name, value in response.getheaders()}
        self.body = response.read()

    def json(self):
        return json.loads(self.body)


def ask(port, method, target, body=None, headers=None, source="127.0.0.1"):
    """One request on a connection of its own."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE, source_address=(source, 0))
    with contextlib.closing(connection):
        connection.request(method, target, body, {"Connection": "close", **(headers or {})})
        return Answer(connection.getresponse())


def expect(is_true, what):
    if not is_true:
        raise AssertionError(what)
