"""The daemon under pressure: stores that do not answer, clocks that jump, disks and memory that run out, logs that nobody
reads: pressure.py REMESHD [--short] [--store sqlite|postgres] [CASE]...

Prints a table. --short makes outages last seconds in place of a minute. Exit code 77: nothing of what was asked for is
possible on this machine.
"""

import argparse
import contextlib
import http.client
import os
import pathlib
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import types

from damaged_rows import Writer, damages
from daemons import (CONTINUE, ENDLESS, FINAL, LONG_S, QUICK, SECOND, SHORT, SQUARE, STOP, Daemon, Store, ask, can_use,
                     result_of, state_of, submit, wait_for, wait_for_state, with_clock)
from hostile_meshes import families

# No request may take longer than this, whatever the store does. The short forms, which run beside other tests, ask only
# for an answer.
ANSWER_S = 10
DRAIN_S = 2
# A daemon ends this long after its drain time at the latest. The short forms ask only that it ends, while the trouble lasts.
END_S = 2


class Impossible(Exception):
    """This machine cannot do the case."""


def expect(condition, text):
    if not condition:
        raise AssertionError(text)


class Run:
    """What a case needs, and what it found out."""

    def __init__(self, program, kind, is_short):
        self.program, self.kind, self.is_short = program, kind, is_short
        self.found = []

    def tell(self, text):
        self.found.append(text)

    @contextlib.contextmanager
    def daemon(self, store, *flags, prefix=(), lease="5s"):
        daemon = Daemon(self.program, [*store.flags, "--workers", "1", "--max-running", "1", "--job-lease", lease,
                                       "--drain-time", f"{DRAIN_S}s", *flags], prefix=prefix).start()
        try:
            yield daemon
        finally:
            daemon.kill()

    def asked(self, port, method, target, body=None, fields=None):
        """An answer in time."""
        start = time.monotonic()
        answer = ask(port, method, target, body, fields)
        took = time.monotonic() - start
        expect(self.is_short or took < ANSWER_S, f"{method} {target} was answered after {took:.1f} s")
        return answer

    def stops(self, daemon):
        start = time.monotonic()
        daemon.process.send_signal(signal.SIGTERM)
        daemon.process.wait(timeout=LONG_S)
        took = time.monotonic() - start
        expect(self.is_short or took < DRAIN_S + END_S, f"SIGTERM took {took:.1f} s")
        self.tell(f"stop {took:.1f} s")


def accepted(answer):
    expect(answer.status == 202, f"a job is accepted: {answer.status} {answer.body[:200]}")
    return answer.json()["id"]


def expect_done(daemon, job):
    """One attempt, one commit."""
    done = wait_for_state(daemon.port, job, *FINAL)
    expect(done["state"] == "succeeded", f"{done['state']}: {done['problem']}")
    expect(done["attempts"] == 1, f"{done['attempts']} attempts")
    return done


@contextlib.contextmanager
def locked(store):
    """Another process holds a lock, so that nothing can be written."""
    if store.postgres:
        command = [f"{store.postgres.programs}/psql", "-qX", store.postgres.url]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/") as psql:
            psql.stdin.write("BEGIN; LOCK TABLE remeshd_job IN EXCLUSIVE MODE; SELECT 'locked';\n")
            psql.stdin.flush()
            while "locked" not in psql.stdout.readline():
                pass
            try:
                yield
            finally:
                psql.stdin.write("ROLLBACK;\n")
                psql.stdin.close()
        return
    import sqlite3  # pylint: disable=import-outside-toplevel
    with contextlib.closing(sqlite3.connect(os.path.join(store.folder, "jobs.sqlite"), timeout=LONG_S,
                                            isolation_level=None)) as database:
        database.execute("BEGIN IMMEDIATE")
        yield
        database.execute("ROLLBACK")


@contextlib.contextmanager
def frozen(store):
    if not store.postgres:
        raise Impossible("SQLite has no server")
    store.postgres.signal(STOP)
    try:
        yield
    finally:
        store.postgres.signal(CONTINUE)


@contextlib.contextmanager
def stopped(store):
    if not store.postgres:
        raise Impossible("SQLite has no server")
    store.postgres.kill()
    try:
        yield
    finally:
        store.postgres.start()


def during(run, store, trouble, seconds):
    """A job that runs while there is trouble is done once, and so is one that waits; requests are answered meanwhile."""
    with run.daemon(store, "--store-timeout", "1s") as daemon:
        running = accepted(submit(daemon.port, SECOND))
        wait_for_state(daemon.port, running, "running", "succeeded")
        waiting = accepted(submit(daemon.port))
        refused = 0
        with trouble(store):
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                answer = run.asked(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE)
                expect(answer.status in (202, 503), f"POST: {answer.status}")
                refused += answer.status == 503
                expect(run.asked(daemon.port, "GET", "/livez").status == 200, "/livez")
                expect(run.asked(daemon.port, "GET", f"/v1/jobs/{running}").status in (200, 503), "GET")
                time.sleep(0.2)
        expect(refused, "the store could be written")
        run.tell(f"{refused} POSTs refused")
        for job in (running, waiting):
            expect_done(daemon, job)
        # What was refused does not run.
        rows = wait_for(lambda: (rows := store.query("SELECT state, count(*) FROM remeshd_job GROUP BY state"))
                        and all(state == "succeeded" for state, _ in rows) and rows)
        expect(int(rows[0][1]) == 2, f"{rows} where two jobs were accepted")
        warnings = [line for line in daemon.lines if line.get("event") == "the job store fails"]
        expect(len(warnings) <= 2 + seconds / 60, f"{len(warnings)} warnings")
        # Stopping does not wait for the store.
        accepted(submit(daemon.port, ENDLESS))
        wait_for(lambda: daemon.metric("remeshd_requests_running") == 1)
        with trouble(store):
            run.stops(daemon)
        store.query("DELETE FROM remeshd_job")


def case_lock(run, store):
    during(run, store, locked, 3 if run.is_short else 60)


def case_frozen(run, store):
    during(run, store, frozen, 3 if run.is_short else 60)


def case_outage(run, store):
    """Outages longer than the lease, again and again."""
    if not store.postgres:
        raise Impossible("SQLite has no server")
    length, count = (1.5, 3) if run.is_short else (8, 6)
    lease = "1s" if run.is_short else "5s"
    with run.daemon(store, "--store-timeout", "1s", lease=lease) as first, \
            run.daemon(store, "--store-timeout", "1s", lease=lease) as second:
        jobs = [accepted(submit(first.port, ENDLESS)) for _ in range(2)]
        for job in jobs:
            wait_for_state(first.port, job, "running")
        for _ in range(count):
            with stopped(store):
                time.sleep(length)
            wait_for(lambda: ask(first.port, "GET", "/readyz").status == 200)
            time.sleep(length / 2)
        for job in jobs:
            record = state_of(first.port, job)
            expect((record["state"], record["attempts"]) == ("running", 1), f"{record['state']}, {record['attempts']} attempts")
        # A dead worker is still missed.
        holder = first if first.logged("job claimed", job=jobs[0]) else second
        other = second if holder is first else first
        ask(other.port, "DELETE", f"/v1/jobs/{jobs[1]}")
        holder.kill()
        start = time.monotonic()
        wait_for(lambda: other.logged("job claimed", job=jobs[0]))
        run.tell(f"{count} outages, a dead worker's job taken over after {time.monotonic() - start:.1f} s")
        ask(other.port, "DELETE", f"/v1/jobs/{jobs[0]}")


def case_lost(run, store):
    """The database is replaced by an empty one."""
    with run.daemon(store) as daemon:
        old = accepted(submit(daemon.port))
        expect_done(daemon, old)
        if store.postgres:
            store.query("DROP SCHEMA public CASCADE; CREATE SCHEMA public")
        else:
            for part in ("", "-wal", "-shm"):
                pathlib.Path(store.folder, f"jobs.sqlite{part}").unlink(missing_ok=True)
        start = time.monotonic()
        job = accepted(wait_for(lambda: (answer := run.asked(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE)).status == 202
                                and answer))
        run.tell(f"again after {time.monotonic() - start:.1f} s")
        expect_done(daemon, job)
        expect(run.asked(daemon.port, "GET", f"/v1/jobs/{old}").status == 404, "a job of the lost database")


def case_password(run, store):
    """The password of the role changes, and then its file; nobody starts the daemon again."""
    if not store.postgres:
        raise Impossible("SQLite has no passwords")
    store.query("CREATE ROLE rotating SUPERUSER LOGIN PASSWORD 'first'")
    rules = pathlib.Path(store.postgres.data, "pg_hba.conf")
    rules.write_text("host all rotating 127.0.0.1/32 scram-sha-256\n" + rules.read_text(encoding="utf-8"), encoding="utf-8")
    store.query("SELECT pg_reload_conf()")
    url = store.postgres.url.replace("remeshd@", "rotating@")
    with tempfile.NamedTemporaryFile("w") as file:
        def write(password):
            file.seek(0)
            file.truncate()
            file.write(password + "\n")
            file.flush()
        write("first")
        login = types.SimpleNamespace(flags=["--store", url, "--store-password-file", file.name])
        with run.daemon(login) as daemon:
            expect_done(daemon, accepted(submit(daemon.port)))
            store.query("ALTER ROLE rotating PASSWORD 'second'")
            store.query("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'rotating'")
            wait_for(lambda: run.asked(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE).status == 503)
            write("second")
            start = time.monotonic()
            wait_for(lambda: ask(daemon.port, "GET", "/readyz").status == 200)
            expect_done(daemon, accepted(submit(daemon.port)))
            run.tell(f"again after {time.monotonic() - start:.1f} s")


def case_log(run, store):
    """Standard error is a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while os.write(writing, b"x" * 4096):
            pass
    os.set_blocking(writing, True)
    daemon = Daemon(run.program, [*store.flags, "--drain-time", f"{DRAIN_S}s"])
    try:
        daemon.process = subprocess.Popen([*daemon.command, "--bind", f"127.0.0.1:{daemon.port}"], stderr=writing,
                                          env=daemon.environment)
        wait_for(daemon.answers)
        requests = 2000 if run.is_short else 20000
        connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=LONG_S)
        with contextlib.closing(connection):
            for _ in range(requests):
                connection.request("GET", "/livez")
                connection.getresponse().read()
        run.tell(f"{requests} requests")
        run.stops(daemon)
    finally:
        daemon.process.kill()
        daemon.process.wait()
        os.close(reading)
        os.close(writing)


@contextlib.contextmanager
def volume(size):
    folder = tempfile.mkdtemp(prefix="remeshd-volume-")
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "remeshd-test", folder], check=False,
                             capture_output=True).returncode == 0
    try:
        if not mounted:
            raise Impossible("no file system can be mounted here")
        yield folder
    finally:
        if mounted:
            subprocess.run(["umount", "-l", folder], check=True)
        shutil.rmtree(folder, ignore_errors=True)


def fill(path):
    with contextlib.suppress(OSError), path.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(4096))


def expect_known(run, daemon, jobs):
    for job in jobs:
        expect(run.asked(daemon.port, "GET", f"/v1/jobs/{job}").status == 200, "GET on a full volume")


def delete(run, daemon, jobs):
    for job in jobs:
        answer = run.asked(daemon.port, "DELETE", f"/v1/jobs/{job}")
        expect(answer.status == 204, f"DELETE on a full volume: {answer.status} {answer.body[:200]}")


def fill_by_inputs(run, daemon):
    """Jobs whose results are small come until there is no room. All of them are done."""
    mesh = SQUARE + b"#" * 400_000
    jobs = []
    while (answer := run.asked(daemon.port, "POST", f"/v1/jobs?{QUICK}", mesh)).status == 202:
        jobs.append(accepted(answer))
    expect((answer.status, answer.code()) == (507, "storage_full"), f"{answer.status} {answer.code()}")
    expect("retry-after" in answer.headers, "Retry-After")
    run.tell(f"{len(jobs)} jobs, then 507")
    for job in jobs:
        expect_done(daemon, job)
    return jobs


def fill_by_results(run, daemon, size):
    """The results of small jobs need more room than there is. What is done waits until other results are deleted."""
    left = []
    while len(left) < size // 500_000 and (answer := run.asked(daemon.port, "POST", f"/v1/jobs?{SHORT}", SQUARE)).status == 202:
        left.append(accepted(answer))
    count = len(left)
    while left:
        done = [job for job in left if state_of(daemon.port, job)["state"] in FINAL]
        for job in done:
            expect_done(daemon, job)
            expect(result_of(daemon.port, job).status == 200, "a result can be read")
        if not done:
            time.sleep(0.1)
        elif len(done) < len(left) and not is_stuck(daemon, left, done):
            continue
        delete(run, daemon, done)
        left = [job for job in left if job not in done]
    run.tell(f"{count} results in turn")


def again(run, daemon):
    """There is room, so new jobs are accepted soon."""
    mesh = SQUARE + b"#" * 400_000
    start = time.monotonic()
    job = accepted(wait_for(lambda: (answer := submit(daemon.port, QUICK, mesh)).status == 202 and answer))
    run.tell(f"again after {time.monotonic() - start:.1f} s")
    expect_done(daemon, job)
    delete(run, daemon, [job])


def is_stuck(daemon, jobs, done):
    """Whether no other job ends for a second."""
    time.sleep(1)
    return sum(state_of(daemon.port, job)["state"] in FINAL for job in jobs) == len(done)


def case_disk(run, store):
    """A small volume is filled by jobs, by results, and by another's file."""
    if store.postgres:
        raise Impossible("the server's volume is its own matter")
    size = 24 if run.is_short else 200
    with volume(f"{size}m") as folder, Store("sqlite", folder) as small:
        with run.daemon(small) as daemon:
            jobs = fill_by_inputs(run, daemon)
            expect_known(run, daemon, jobs)
            delete(run, daemon, jobs)
            fill_by_results(run, daemon, size << 20)
            again(run, daemon)
            jobs = fill_by_inputs(run, daemon)
            fill(pathlib.Path(folder, "filler"))
            daemon.kill()
            daemon.start()  # on the full volume
            expect_known(run, daemon, jobs)
            delete(run, daemon, jobs[1:])
            expect(result_of(daemon.port, jobs[0]).status == 200, "what was kept can be read")
            pathlib.Path(folder, "filler").unlink()
            again(run, daemon)
            delete(run, daemon, jobs[:1])
            fill_after_a_kill(run, daemon, pathlib.Path(folder))


def fill_after_a_kill(run, daemon, folder):
    """A job is done and another one runs when the daemon is killed, and others fill the volume, again after each deletion. The
    result of the job that is done is larger than the reserve."""
    done = accepted(submit(daemon.port, "max_edge_length=0.005" if run.is_short else SECOND))
    expect_done(daemon, done)
    size, reserve = len(result_of(daemon.port, done, "?format=obj").body), (folder / "reserve").stat().st_size
    expect(size > 1.5 * reserve, f"the result has {size} bytes beside a reserve of {reserve}")
    running = accepted(submit(daemon.port, ENDLESS))
    wait_for(lambda: state_of(daemon.port, running)["state"] == "running")
    daemon.kill()
    fill(folder / "filler")
    daemon.start()
    queued = [accepted(answer) for answer in (run.asked(daemon.port, "POST", "/v1/jobs", SQUARE),) if answer.status == 202]
    for number, job in enumerate([running, *queued, done]):
        delete(run, daemon, [job])
        fill(folder / f"filler{number}")
    for filler in folder.glob("filler*"):
        filler.unlink()
    again(run, daemon)


def case_clock(run, store):
    """A daemon whose clock is ten years ahead, then behind, then right."""
    ahead, behind = with_clock("+3650d"), with_clock("-3650d")
    if ahead is None:
        raise Impossible("there is no libfaketime (Debian: faketime)")
    jobs = []
    for prefix in (ahead, behind, ()):
        with run.daemon(store, prefix=prefix) as daemon:
            jobs.append(accepted(submit(daemon.port)))
            expect_done(daemon, jobs[-1])
            for job in jobs:
                expect(state_of(daemon.port, job)["state"] == "succeeded", "no result expires")
            if not prefix:
                year = time.gmtime().tm_year
                wait_for(lambda: state_of(daemon.port, jobs[-1])["created_at"].startswith(str(year)))  # pylint: disable=cell-var-from-loop
    run.tell("10 years ahead, behind, and right")


def case_ranges(run, store):
    """Fifty clients read small parts of one large result, again and again: small requests are answered meanwhile."""
    readers, rounds = 50, 2 if run.is_short else 20
    with run.daemon(store) as daemon:
        job = accepted(submit(daemon.port, SHORT if run.is_short else "max_edge_length=0.0011"))
        expect_done(daemon, job)
        # The bytes of the STL follow from its number of faces, so each part can be judged by its place alone.
        size = int(ask(daemon.port, "HEAD", f"/v1/jobs/{job}/result?format=stl").headers["content-length"])
        expect((size - 84) % 50 == 0, f"no STL has {size} bytes")
        expect(run.is_short or size > 50e6, f"the result has {size} bytes only")
        whole = result_of(daemon.port, job, "?format=stl").body
        wrong, times, is_over = [], [], threading.Event()

        def read(reader):
            for number in range(rounds):
                begin = (7919 * (reader + readers * number)) % (size - 100)
                answer = ask(daemon.port, "GET", f"/v1/jobs/{job}/result?format=stl", fields={"Range": f"bytes={begin}-{begin + 99}"})
                if answer.status != 206 or answer.body != whole[begin:begin + 100]:
                    wrong.append((answer.status, answer.body[:100]))

        def send():
            while not is_over.is_set():
                start = time.monotonic()
                status = ask(daemon.port, "POST", f"/v1/remesh?{QUICK}", SQUARE).status
                times.append(time.monotonic() - start)
                if status != 200:
                    wrong.append((status, "a small request"))

        sender = threading.Thread(target=send)
        threads = [threading.Thread(target=read, args=(reader,)) for reader in range(readers)]
        sender.start()
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        wait_for(lambda: times)
        is_over.set()
        sender.join()
        expect(not wrong, f"{len(wrong)} wrong answers, such as {wrong[:2]}")
        run.tell(f"{readers * rounds} parts of {size / 1e6:.0f} MB, {len(times)} small requests, the slowest in {max(times):.2f} s")
        expect(run.is_short or max(times) < 1, f"a small request took {max(times):.2f} s")


def is_nothing_claimed(daemon, seconds):
    claims = len(daemon.logged("job claimed"))
    time.sleep(seconds)
    return len(daemon.logged("job claimed")) == claims


def case_damaged(run, store):
    """Rows and blobs damaged in every way that the tables allow, beside sound jobs: nobody else is harmed."""
    kinds = damages(not store.postgres)
    if run.is_short and store.postgres:
        kinds = kinds[::3]  # each takes some round trips
    with run.daemon(store, "--store-timeout", "5s", "--max-stored", "1GiB", lease="3s") as daemon:
        wait_for(lambda: ask(daemon.port, "GET", "/readyz").status == 200)
        done = accepted(submit(daemon.port))
        expect_done(daemon, done)
        writer = Writer(store, SQUARE, done)
        groups = [kinds] if run.is_short else [[kind] for kind in kinds]
        ends, slowest, problems = {}, 0.0, []
        for group in groups:
            jobs = [(secrets.token_hex(16), kind) for kind in group]
            writer.write(jobs)
            try:
                sound = [accepted(run.asked(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE)) for _ in range(20)]
                start = time.monotonic()
                for job in sound:
                    expect_done(daemon, job)
            except Exception as failure:
                errors = [line for line in daemon.lines if line.get("level") in ("warning", "error")]
                raise AssertionError(f"beside {group[0].name}: {failure!r}; the log's end is {errors[-3:]}") from failure
            slowest = max(slowest, time.monotonic() - start)
            for job, kind in jobs:
                try:
                    end = expect_sensible(run, daemon, job, kind)
                    ends[end] = ends.get(end, 0) + 1
                except Exception as failure:  # pylint: disable=broad-except
                    problems.append(f"{kind.name}: {failure!r}")
            expect(daemon.process.poll() is None, f"the daemon ended after {group[0].name}")
            delete(run, daemon, sound)
        expect(not problems, "; ".join(problems))
        errors = [line for line in daemon.lines if line.get("event") in ("the job store fails", "the job store holds damaged data")]
        expect(not errors, f"{errors[:2]}")
        expect_done(daemon, accepted(submit(daemon.port)))
        wait_for(lambda: ask(daemon.port, "GET", "/readyz").status == 200)
        # On a busy machine, the last job that was put back may still have its turn.
        expect(any(is_nothing_claimed(daemon, 2) for _ in range(8)) and is_nothing_claimed(daemon, 4),
               "something is claimed again and again")
        run.tell(f"{len(kinds)} kinds: " + ", ".join(f"{count} {end}" for end, count in sorted(ends.items())) +
                 f"; 20 sound jobs done within {slowest:.1f} s")
        run.stops(daemon)


def expect_sensible(run, daemon, job, kind):
    """What a damaged job may become, and what its client is told. Output: its state in the end."""
    def settled():
        answer = run.asked(daemon.port, "GET", f"/v1/jobs/{job}")
        expect(answer.status in (200, 404), f"GET: {answer.status} {answer.body[:200]}")
        if answer.status == 404:
            return "unknown"
        state = answer.json()["state"]
        may_wait = {"memory", "queued_ms"} & set(kind.columns)  # for a daemon that has so much, or for the time
        return state if state in FINAL or (state == "queued" and may_wait) else None
    state = wait_for(settled, step=0.05)
    for part in ("result", "report", "events"):
        if part == "events" and state not in FINAL:
            continue
        answer = run.asked(daemon.port, "GET", f"/v1/jobs/{job}/{part}")
        # This daemon has no folder, so it cannot give what may lie in the folder of another one.
        expect(answer.status != 503 or kind.name.endswith("a file"), f"{part}: {answer.status} {answer.body[:200]}")
        if answer.status >= 400:
            expect(isinstance(answer.json(), dict), f"{part}: {answer.body[:100]}")
    answer = run.asked(daemon.port, "DELETE", f"/v1/jobs/{job}")
    expect(answer.status == (404 if state == "unknown" else 204), f"DELETE: {answer.status} {answer.body[:200]}")
    answer = run.asked(daemon.port, "GET", f"/v1/jobs/{job}")
    expect(answer.status == 404 or answer.json()["state"] in FINAL, f"after DELETE: {answer.status} {answer.body[:200]}")
    return state


def case_company(run, store):
    """One large mesh after the other beside clients that send small ones: all large ones succeed, and nearly all small ones."""
    if store.postgres:
        raise Impossible("it is no matter of the store")
    length, count, small_count, budget = ("0.0016", 4, 100, 400) if run.is_short else ("0.0008", 20, 1000, 1024)
    daemon = Daemon(run.program, [*store.flags, "--workers", "2", "--max-running", "2", "--memory-budget", f"{budget}MiB"])
    small, largest = [], [0.0]
    is_over = threading.Event()
    numbers = iter(range(small_count))

    def client():
        while not is_over.is_set() and next(numbers, None) is not None:
            small.append(ask(daemon.port, "POST", f"/v1/remesh?{SHORT}", SQUARE).status)

    def watch():
        while not is_over.wait(0.05):
            largest[0] = max(largest[0], resident(daemon.process.pid) / (budget << 20))

    try:
        daemon.start()
        threads = [threading.Thread(target=client) for _ in range(8)] + [threading.Thread(target=watch)]
        for thread in threads:
            thread.start()
        large = [ask(daemon.port, "POST", f"/v1/remesh?max_edge_length={length}", SQUARE).status for _ in range(count)]
        for thread in threads[:-1]:
            thread.join()
        is_over.set()
        threads[-1].join()
    finally:
        is_over.set()
        daemon.kill()
    refused = sum(status == 503 for status in small)
    run.tell(f"{large.count(200)} of {count} large ones answered, {refused} of {len(small)} small ones refused, resident at most "
             f"{largest[0]:.2f} of the budget")
    expect(large.count(200) == count, f"the large ones: {large}")
    expect(set(small) <= {200, 503} and refused <= len(small) / 100, f"the small ones: {sorted(set(small))}, {refused} refused")
    expect(largest[0] < 1.1, f"resident at most {largest[0]:.2f} of the budget")


def case_memory(run, store):
    """Jobs that each fit the budget, all at once: each succeeds in one attempt."""
    # Each takes from 0.4 to 0.8 of the budget.
    lengths = ("0.0016",) if run.is_short else ("0.0008", "0.0011")
    counts = (3,) if run.is_short else (6, 12)
    budget = "400MiB" if run.is_short else "1GiB"
    daemon = Daemon(run.program, [*store.flags, "--workers", "2", "--max-running", "2", "--memory-budget", budget])
    largest = [0]
    stopping = threading.Event()

    def watch():
        limit = {"400MiB": 400 << 20, "1GiB": 1 << 30}[budget]
        while not stopping.wait(0.05):
            with contextlib.suppress(OSError, IndexError):
                text = pathlib.Path(f"/proc/{daemon.process.pid}/statm").read_text(encoding="ascii")
                largest[0] = max(largest[0], int(text.split()[1]) * 4096 / limit)

    try:
        daemon.start()
        watcher = threading.Thread(target=watch)
        watcher.start()
        for count in counts:
            jobs = [accepted(submit(daemon.port, f"max_edge_length={lengths[i % len(lengths)]}")) for i in range(count)]
            done = [wait_for_state(daemon.port, job, *FINAL, seconds=3 * LONG_S) for job in jobs]
            expect(all(job["state"] == "succeeded" for job in done), f"{[(job['state'], job['problem']) for job in done]}")
            expect(all(job["attempts"] == 1 for job in done), f"{[job['attempts'] for job in done]} attempts")
        back = len(daemon.logged("job given back"))
        run.tell(f"{' and '.join(map(str, counts))} jobs at once, {back} put back, resident at most {largest[0]:.2f} of the budget")
        expect(largest[0] < 1.1, f"resident at most {largest[0]:.2f} of the budget")
    finally:
        stopping.set()
        daemon.kill()


@contextlib.contextmanager
def memory_group(limit):
    """A control group with this limit of memory, for the length of a `with`: the file for the processes in it."""
    for root, name in (("/sys/fs/cgroup/memory", "memory.limit_in_bytes"), ("/sys/fs/cgroup", "memory.max")):
        folder = pathlib.Path(root, f"remeshd-test-{os.getpid()}")
        try:
            folder.mkdir()
        except OSError:
            continue
        try:
            (folder / name).write_text(str(limit), encoding="ascii")
            yield folder / "cgroup.procs"
            return
        except OSError:
            pass
        finally:
            folder.rmdir()
    raise Impossible("no control group can be made here")


def peak_of_command_line(program, mesh, options):
    """The largest memory of `remesh` on a mesh, in bytes; None where it does not succeed."""
    command = [program, str(mesh), "-o", str(mesh.with_name("result.obj")), *options]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    return usage.ru_maxrss * 1024 if status == 0 else None


def resident(pid, name="VmRSS"):
    text = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    return int(text.split(f"{name}:")[1].split()[0]) * 1024


def case_hostile(run, store):
    """Meshes that take much memory, at the default budget in a small group: the kernel kills nobody."""
    if store.postgres:
        raise Impossible("it is no matter of the store")
    limit = (512 << 20) if run.is_short else (3 << 29)
    budget = limit // 10 * 7
    command_line = str(pathlib.Path(run.program).with_name("remesh"))
    problems, counts, largest = [], {}, 0
    with memory_group(limit) as group, tempfile.TemporaryDirectory() as folder:
        prefix = ["sh", "-c", f'echo $$ > {group}; exec "$@"', "sh"]
        with run.daemon(store, "--memory-budget", str(budget), prefix=prefix) as daemon:
            for name, make in families(run.is_short):
                path = pathlib.Path(folder, "mesh.obj")
                make(path)
                fields = {"Content-Type": "model/obj"}
                if path.read_bytes()[:2] == b"\x1f\x8b":
                    fields["Content-Encoding"] = "gzip"
                pathlib.Path(f"/proc/{daemon.process.pid}/clear_refs").write_text("5", encoding="ascii")
                start = time.monotonic()
                try:
                    answer = ask(daemon.port, "POST", "/v1/remesh", path.read_bytes(), fields, timeout=600)
                except (OSError, http.client.HTTPException) as failure:
                    problems.append(f"{name}: {failure!r}")
                    if daemon.process.poll() is not None:
                        daemon.start()
                    continue
                took = time.monotonic() - start
                peak = resident(daemon.process.pid, "VmHWM") / budget
                largest = max(largest, peak)
                counts[answer.status] = counts.get(answer.status, 0) + 1
                print(f"  {name}: {answer.status} {answer.code() or ''} in {took:.1f} s, {peak:.2f} of the budget", flush=True)
                if peak > 1.1:
                    problems.append(f"{name}: {peak:.2f} of the budget")
                if answer.status not in (200, 413, 422, 503):
                    problems.append(f"{name}: {answer.status} {answer.body[:200]}")
                if answer.status in (413, 503) and "Content-Encoding" not in fields:
                    alone = peak_of_command_line(command_line, path, [])
                    if alone is not None and alone < 0.8 * budget:
                        problems.append(f"{name}: {answer.status}, but `remesh` takes {alone / budget:.2f} of the budget")
    run.tell(", ".join(f"{count} times {status}" for status, count in sorted(counts.items())) +
             f"; at most {largest:.2f} of the budget")
    expect(not problems, "; ".join(problems))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--store", choices=("sqlite", "postgres"))
    arguments = parser.parse_intermixed_args()
    program = os.path.abspath(arguments.program)
    cases = {name[len("case_"):]: case for name, case in globals().items() if name.startswith("case_")}
    for name in arguments.cases:
        if name not in cases:
            parser.error(f"there is no case {name}; the cases are {', '.join(cases)}")
    rows, failures, done = [], 0, 0
    for kind in [arguments.store] if arguments.store else ["sqlite", "postgres"]:
        if not can_use(kind):
            rows.append((kind, "all", "SKIPPED", "there is no PostgreSQL (Debian: postgresql-15)"))
            continue
        for name in arguments.cases or cases:
            run = Run(program, kind, arguments.short)
            start = time.monotonic()
            outcome = "ok"
            try:
                with Store(kind) as store:
                    cases[name](run, store)
                done += 1
            except Impossible as reason:
                outcome, run.found = "SKIPPED", [str(reason)]
            except Exception as failure:  # pylint: disable=broad-except
                traceback.print_exc()
                failures += 1
                outcome, run.found = "FAILED", [*run.found, str(failure)]
            rows.append((kind, name, f"{outcome} ({time.monotonic() - start:.1f} s)", "; ".join(run.found)))
            print("  ".join(rows[-1]), flush=True)
    print("\n| store | case | outcome | figures |\n| --- | --- | --- | --- |")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    if not done and not failures:
        return 77
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
