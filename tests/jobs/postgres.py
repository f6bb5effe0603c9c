"""A PostgreSQL of its own for a test, from Debian's packages, on loopback and in a temporary folder.

postgres.py COMMAND [ARGUMENT]...: runs the command with its URL in REMESHD_TEST_STORE. Exit code 77: there is no PostgreSQL.
"""

import contextlib
import glob
import os
import pwd
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time


UNPACKED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../build/unpacked")


def find_programs():
    """The folder of initdb, postgres and psql: installed, or unpacked by ./dev; or None."""
    for root in ("/", UNPACKED):
        for found in sorted(glob.glob(f"{root}/usr/lib/postgresql/*/bin/initdb"), reverse=True):
            folder = os.path.dirname(os.path.realpath(found))
            if os.path.exists(f"{folder}/psql"):
                return folder
    return None


def account_to_run_as():
    """What to give subprocess so that the server, which refuses to run as root, does not."""
    if os.getuid() != 0:
        return {}
    for name in ("postgres", "nobody"):
        try:
            account = pwd.getpwnam(name)
            return {"user": account.pw_uid, "group": account.pw_gid, "extra_groups": []}
        except KeyError:
            continue
    raise RuntimeError("there is no account for PostgreSQL to run as")


def reachable(programs, folder, account):
    """The programs, copied into the folder where that account cannot start them where they are."""
    with contextlib.suppress(OSError):
        if subprocess.run([f"{programs}/initdb", "--version"], check=False, stdout=subprocess.DEVNULL, cwd="/",
                          **account).returncode == 0:
            return programs
    version = os.path.basename(os.path.dirname(programs))
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(programs)))))
    for part in (f"usr/lib/postgresql/{version}", f"usr/share/postgresql/{version}"):
        shutil.copytree(os.path.join(root, part), os.path.join(folder, part), symlinks=True)
    return os.path.join(folder, f"usr/lib/postgresql/{version}/bin")


def free_port():
    """A port that is free. It is below those that clients are given, so it stays free while a daemon is away."""
    for port in random.sample(range(12000, 32000), 1000):
        with contextlib.closing(socket.socket()) as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise RuntimeError("there is no free port")


class Postgres:
    """A server for the length of a `with`; it can be killed and started again."""

    def __init__(self, settings=()):
        self.folder = tempfile.mkdtemp(prefix="remeshd-postgres-")
        self.user = account_to_run_as()
        if self.user:
            os.chown(self.folder, self.user["user"], self.user["group"])
        self.programs = reachable(find_programs(), self.folder, self.user)
        self.data = os.path.join(self.folder, "data")
        self.port = free_port()
        self.url = f"postgres://remeshd@127.0.0.1:{self.port}/postgres"
        self.process = None
        self.settings = [f"--{setting}" for setting in
                         ("listen_addresses=127.0.0.1", f"port={self.port}", f"unix_socket_directories={self.folder}",
                          *settings)]
        subprocess.run([f"{self.programs}/initdb", "-D", self.data, "-A", "trust", "-U", "remeshd", "--no-sync", "-E", "UTF8",
                        "--locale=C"], check=True, stdout=subprocess.DEVNULL, cwd="/", **self.user)

    def start(self):
        log = open(os.path.join(self.folder, "log"), "ab")
        self.process = subprocess.Popen([f"{self.programs}/postgres", "-D", self.data, *self.settings], stdout=log, stderr=log,
                                        cwd="/", start_new_session=True, **self.user)
        self.wait_until_ready()

    def wait_until_ready(self):
        for _ in range(3000):  # minutes: the machine may be busy
            if self.process.poll() is not None:  # the lock of a killed one may still be held for a moment
                time.sleep(0.2)
                return self.start()
            ready = subprocess.run([f"{self.programs}/pg_isready", "-q", "-h", "127.0.0.1", "-p", str(self.port)], check=False)
            if ready.returncode == 0:
                return None
            time.sleep(0.05)
        raise RuntimeError("PostgreSQL does not start: " + open(os.path.join(self.folder, "log")).read()[-2000:])

    def kill(self):
        """As a failing host would: the whole process group, at once."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def signal(self, number):
        """To the server and to all of its processes, each of which has a group of its own."""
        os.kill(self.process.pid, number)
        for status in glob.glob("/proc/[0-9]*/stat"):
            with contextlib.suppress(OSError), open(status, encoding="utf-8", errors="replace") as file:
                pid, parent = int(status.split("/")[2]), int(file.read().rpartition(")")[2].split()[1])
                if parent == self.process.pid:
                    os.kill(pid, number)

    def query(self, sql):
        """Rows of strings."""
        answer = subprocess.run([f"{self.programs}/psql", "-qAtX", "-F", "\t", "-v", "ON_ERROR_STOP=1", "-c", sql, self.url],
                                check=True, capture_output=True, text=True, cwd="/",
                                env={**os.environ, "PGOPTIONS": "-c default_transaction_read_only=off"})
        return [line.split("\t") for line in answer.stdout.splitlines()]

    def change(self, statements):
        """One transaction."""
        subprocess.run([f"{self.programs}/psql", "-qX", "-1", "-v", "ON_ERROR_STOP=1", self.url], check=True,
                       input=";\n".join(statements) + ";\n", capture_output=True, text=True, cwd="/")

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            os.kill(self.process.pid, signal.SIGINT)  # the fast way down
            try:
                self.process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                self.kill()
        shutil.rmtree(self.folder, ignore_errors=True)


def main():
    if find_programs() is None:
        print("SKIPPED: there is no PostgreSQL (Debian: postgresql-15)")
        return 77
    with Postgres(["fsync=off"]) as server:  # no host fails here, and a busy disk takes seconds
        return subprocess.run(sys.argv[1:], check=False, env={**os.environ, "REMESHD_TEST_STORE": server.url}).returncode


if __name__ == "__main__":
    sys.exit(main())
