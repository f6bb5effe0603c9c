"""Real daemons on a shared store, and a client that asks them."""

import contextlib
import glob
import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import urllib.parse

from postgres import Postgres, find_programs, free_port

SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
# Options by how long they keep one core busy, of a fast machine: hardly, some hundredths of a second, a fifth of a
# second, a second, for minutes.
QUICK = "max_edge_length=0.3"
SHORT = "max_edge_length=0.01"
FIFTH = "max_edge_length=0.0033"
SECOND = "max_edge_length=0.0015"
ENDLESS = "max_edge_length=0.0003"
# How long to wait for what should happen, in seconds. It is no bound on the daemons' speed: their workers have a low
# priority, so that a busy machine can make them twenty times as slow.
LONG_S = 120 * int(os.environ.get("REMESHD_PATIENCE", "1"))


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)

    def code(self):
        return self.json().get("code") if "json" in self.headers.get("content-type", "") else None


def ask(port, method, target, body=None, fields=None, timeout=LONG_S):
    """Errors: OSError, http.client.HTTPException - nobody answers, or not to the end."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout)
    with contextlib.closing(connection):
        connection.request(method, target, body=body, headers=fields or {})
        answer = connection.getresponse()
        return Answer(answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read())


def submit(port, query=QUICK, mesh=SQUARE, **fields):
    return ask(port, "POST", f"/v1/jobs?{query}", mesh, {name.replace("_", "-"): value for name, value in fields.items()})


def events(port, job_id, last_event_id=None, timeout=LONG_S):
    """Yields (id, event, data) until the stream ends."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout)
    with contextlib.closing(connection):
        connection.request("GET", f"/v1/jobs/{job_id}/events", headers={"Last-Event-ID": str(last_event_id)} if last_event_id
                           else {})
        answer = connection.getresponse()
        if answer.status != 200:
            return
        fields = {}
        for line in answer:
            line = line.decode().rstrip("\n")
            if line.startswith(":"):
                continue
            if line:
                name, _, value = line.partition(": ")
                fields[name] = value
            elif fields:
                yield int(fields["id"]), fields["event"], json.loads(fields["data"])
                fields = {}


def state_of(port, job_id):
    return ask(port, "GET", f"/v1/jobs/{job_id}").json()


FINAL = ("succeeded", "failed", "cancelled", "expired")


def wait_for(condition, seconds=LONG_S, step=0.02):
    """What the condition gives once it is true. Errors: TimeoutError."""
    deadline = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise TimeoutError("it does not happen")
        time.sleep(step)


def wait_for_state(port, job_id, *states, seconds=LONG_S):
    def reached():
        # The store may not answer yet.
        job = state_of(port, job_id)
        return job if job.get("state") in states else None

    return wait_for(reached, seconds)


class Daemon:
    """remeshd on a port of its own, which it has again when it is started again."""

    def __init__(self, program, flags, environment=None, prefix=()):
        self.command = [*prefix, program, "--log-format", "json", "--max-connections-per-address", "512", *flags]
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("REMESHD_")}
        self.environment.update(environment or {})
        self.port = free_port()
        self.lines = []
        self.process = None
        self.reader = None

    def start(self):
        self.process = subprocess.Popen([*self.command, "--bind", f"127.0.0.1:{self.port}"], stderr=subprocess.PIPE,
                                        env=self.environment)
        self.reader = threading.Thread(target=self.read_log, args=(self.process.stderr,), daemon=True)
        self.reader.start()
        wait_for(lambda: self.answers() or self.process.poll() is not None, step=0.01)
        if self.process.poll() is not None:
            raise RuntimeError(f"remeshd does not start: {self.lines[-3:]}")
        return self

    def read_log(self, stream):
        for line in stream:
            try:
                self.lines.append(json.loads(line))
            except ValueError:  # cut off by a kill, or no log yet
                self.lines.append({"text": line.decode(errors="replace")})

    def answers(self):
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port), timeout=1):
            return True
        return False

    def signal(self, number):
        self.process.send_signal(number)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.reader.join()

    def stop(self):
        """Output: its exit code."""
        self.process.terminate()
        code = self.process.wait(timeout=LONG_S)
        self.reader.join()
        return code

    def logged(self, event, **fields):
        return [line for line in list(self.lines)
                if line.get("event") == event and all(line.get(name) == value for name, value in fields.items())]

    def metric(self, name):
        """The sum of all that begins so."""
        text = ask(self.port, "GET", "/metrics").body.decode()
        return sum(float(line.rpartition(" ")[2]) for line in text.splitlines() if line.startswith(name))


class Store:
    """A fresh store of either kind; `flags` are what a daemon needs for it."""

    def __init__(self, kind, folder=None):
        self.kind = kind
        self.folder = folder or tempfile.mkdtemp(prefix="remeshd-jobs-")
        self.owns_folder = folder is None
        self.postgres = Postgres() if kind == "postgres" else None

    def __enter__(self):
        if self.postgres:
            self.postgres.__enter__()
        return self

    def __exit__(self, *failure):
        if self.postgres:
            self.postgres.__exit__(*failure)
        if self.owns_folder:
            shutil.rmtree(self.folder, ignore_errors=True)

    @property
    def flags(self):
        return ["--store", self.postgres.url] if self.postgres else ["--store", "sqlite", "--state-dir", self.folder]

    def query(self, sql):
        """Rows of strings."""
        if self.postgres:
            return self.postgres.query(sql)
        import sqlite3  # pylint: disable=import-outside-toplevel
        with contextlib.closing(sqlite3.connect(os.path.join(self.folder, "jobs.sqlite"), timeout=LONG_S,
                                                isolation_level=None)) as database:  # what it changes stays changed
            return [[str(value) for value in row] for row in database.execute(sql)]

    def change(self, statements):
        """One transaction."""
        if self.postgres:
            self.postgres.change(statements)
            return
        import sqlite3  # pylint: disable=import-outside-toplevel
        with contextlib.closing(sqlite3.connect(os.path.join(self.folder, "jobs.sqlite"), timeout=LONG_S,
                                                isolation_level=None)) as database:
            database.execute("BEGIN IMMEDIATE")
            for statement in statements:
                database.execute(statement)
            database.execute("COMMIT")


def can_use(kind):
    return kind == "sqlite" or find_programs() is not None


def with_clock(offset):
    """What to put before a command so that its wall clock is wrong by that ("+1h"); None where there is no libfaketime."""
    libraries = glob.glob("/usr/lib/*/faketime/libfaketimeMT.so.1")
    if not libraries:
        return None
    # AddressSanitizer ends a program into which another library comes first, unless it is told not to mind.
    options = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "verify_asan_link_order=0"]))
    return ["env", f"ASAN_OPTIONS={options}", f"LD_PRELOAD={libraries[0]}", f"FAKETIME={offset}",
            "FAKETIME_DONT_FAKE_MONOTONIC=1"]


def result_of(port, job_id, query=""):
    return ask(port, "GET", f"/v1/jobs/{job_id}/result{query}")


def quoted(text):
    return urllib.parse.quote(text)


STOP, CONTINUE = signal.SIGSTOP, signal.SIGCONT
