"""Kills daemons, and the database, at random moments under load, and compares what clients were told with what is in the
store: crash_test.py REMESHD [--store sqlite|postgres] [--kills N] [--store-kills N] [--seed N]

Nothing that was accepted may be lost, nothing be done twice, no result be wrong. Exit code 77: the store is not there.
"""

import argparse
import collections
import contextlib
import http.client
import random
import sys
import threading
import time

from daemons import CONTINUE, FINAL, SQUARE, STOP, Daemon, Store, ask, can_use, wait_for

LEASE_S = 1.0
CLIENTS = 6
# What a client sends, and what becomes of it. Of different lengths, so that every moment of a job is hit.
CASES = [(SQUARE, f"max_edge_length={length}") for length in (0.3, 0.05, 0.02, 0.012, 0.01, 0.008)]
CASES += [(b"v 0 0 0\nf 1 2 9\n", "refine=true"), (SQUARE, "min_angle_deg=30&format=stl"), (SQUARE, "format=json")]
PATIENCE_S = 180


class Told:
    """What clients were told, for good; and what must not have been."""

    def __init__(self):
        self.lock = threading.Lock()
        self.job_of_key = {}
        self.case_of_job = {}
        self.cancelled = set()  # jobs whose DELETE was asked for
        self.final = {}
        self.wrong = []
        self.repeats = self.results = self.refusals = 0

    def wrong_if(self, condition, text):
        if condition:
            with self.lock:
                self.wrong.append(text)
        return condition

    def accepted(self, key, job, case):
        with self.lock:
            known = self.job_of_key.setdefault(key, job)
            self.case_of_job[job] = case
        self.wrong_if(known != job, f"the key {key} made {known} and {job}")

    def ended(self, job):
        outcome = (job["state"], job["finished_at"], job["problem"] and job["problem"]["code"])
        with self.lock:
            known = self.final.setdefault(job["id"], outcome)
        self.wrong_if(known != outcome, f"{job['id']} ended as {known} and as {outcome}")


class Client(threading.Thread):
    """Submits a few jobs, watches them to their end, and begins again; insists where nobody answers."""

    def __init__(self, number, fleet, told, expected, stopping):
        super().__init__(name=f"client {number}")
        self.number, self.fleet, self.told, self.expected, self.stopping = number, fleet, told, expected, stopping
        self.random = random.Random(f"client {number} {random.random()}")

    def insist(self, method, target, body=None, fields=None):
        """The first answer that is not for want of a daemon or its store."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            with contextlib.suppress(OSError, http.client.HTTPException):
                answer = ask(self.random.choice(self.fleet).port, method, target, body, fields, timeout=20)
                if answer.status != 503:
                    return answer
                self.told.refusals += 1
            if time.monotonic() > deadline:
                raise TimeoutError(f"nobody answers {method} {target}")
            time.sleep(0.02)

    def submit(self, key):
        case = self.random.randrange(len(CASES))
        mesh, query = CASES[case]
        while True:
            answer = self.insist("POST", f"/v1/jobs?{query}", mesh, {"Idempotency-Key": key})
            if self.told.wrong_if(answer.status != 202, f"submit: {answer.status} {answer.body[:200]}"):
                return None
            job = answer.json()["id"]
            self.told.accepted(key, job, case)
            if self.random.random() > 0.2:
                return job
            self.told.repeats += 1

    def watch(self, job):
        """To its end, which it tells."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            answer = self.insist("GET", f"/v1/jobs/{job}")
            if self.told.wrong_if(answer.status != 200, f"{job} is lost: {answer.status} {answer.body[:200]}"):
                return
            state = answer.json()
            if state["state"] in FINAL:
                self.told.ended(state)
                return self.check_result(job)
            if self.told.wrong_if(time.monotonic() > deadline, f"{job} does not end: {state}"):
                return
            time.sleep(0.05)

    def check_result(self, job):
        answer = self.insist("GET", f"/v1/jobs/{job}/result")
        status, body = self.expected[self.told.case_of_job[job]]
        if answer.status in (409, 410) and job in self.told.cancelled:  # cancelled, or deleted with its result
            return
        self.told.wrong_if(answer.status != status or (status == 200 and comparable(answer.body) != body),
                           f"{job}: a wrong result, {answer.status} of {len(answer.body)} bytes")
        self.told.results += 1

    def run(self):
        try:
            turn = 0
            while not self.stopping.is_set():
                jobs = [self.submit(f"{self.name} {turn} {i}") for i in range(self.random.randint(1, 6))]
                turn += 1
                for job in filter(None, jobs):
                    if self.random.random() < 0.05:
                        with self.told.lock:
                            self.told.cancelled.add(job)
                        answer = self.insist("DELETE", f"/v1/jobs/{job}")
                        self.told.wrong_if(answer.status != 204, f"cancel: {answer.status}")
                for job in filter(None, jobs):
                    self.watch(job)
        except Exception as failure:  # pylint: disable=broad-except
            self.told.wrong_if(True, f"{self.name}: {failure!r}")


def comparable(body):
    """A result without its times, which are the only thing that may differ."""
    return body.partition(b'"timing_ms":')[0]


class Chaos:
    """Ends daemons, and starts them again."""

    def __init__(self, fleet, store, seed):
        self.fleet, self.store, self.random = fleet, store, random.Random(seed)
        self.kills = self.store_kills = self.stops = 0
        self.next_stop = 2
        self.said = 0

    def strike(self):
        time.sleep(self.random.expovariate(1 / 0.15))
        daemon = self.random.choice(self.fleet)
        if self.kills >= self.next_stop:  # asleep for longer than its lease
            self.next_stop = self.kills + self.random.randrange(5, 60)
            daemon.signal(STOP)
            time.sleep(LEASE_S * 1.6)
            daemon.signal(CONTINUE)
            self.stops += 1
            return
        daemon.kill()
        self.kills += 1
        daemon.start()

    def strike_store(self):
        self.store.postgres.kill()
        time.sleep(self.random.uniform(0, 0.5))
        self.store.postgres.start()
        self.store_kills += 1

    def run(self, kills, store_kills):
        start = time.monotonic()
        every = kills / (store_kills + 1)
        while self.kills < kills:
            self.strike()
            if self.store_kills < store_kills and self.kills >= every * (self.store_kills + 1):
                self.strike_store()
            if self.kills % 100 == 0 and self.kills > self.said:
                self.said = self.kills
                print(f"  {self.kills} kills after {time.monotonic() - start:.0f} s", flush=True)


def check_store(store, fleet, told):
    """The clients' log against the store's tables and the daemons' logs."""
    rows = {row[0]: row[1:] for row in store.query("SELECT id, state, commits, attempts FROM remeshd_job")}
    for job in told.case_of_job:
        told.wrong_if(job not in rows, f"{job} was accepted and is not in the store")
    for job, (state, commits, _) in rows.items():
        told.wrong_if(job not in told.case_of_job, f"{job} is in the store and nobody was told")
        told.wrong_if(state not in FINAL, f"{job} is {state} at the end")
        told.wrong_if(int(commits) != (0 if state == "cancelled" else 1), f"{job} is {state} with {commits} commits")
        told.wrong_if(state == "cancelled" and job not in told.cancelled, f"{job} was cancelled by nobody")
        told.wrong_if(job in told.final and told.final[job][0] != state, f"{job} is {state}, told was {told.final.get(job)}")
    committed = collections.Counter(line["job"] for daemon in fleet for line in daemon.logged("job committed"))
    for job, count in committed.items():
        told.wrong_if(count > 1, f"{job} was committed {count} times")
        told.wrong_if(rows.get(job, ["cancelled"])[0] == "cancelled", f"{job} was committed and is cancelled")
    left = store.query("SELECT count(*) FROM remeshd_blob WHERE kind = 'input'")[0][0]
    told.wrong_if(left != "0", f"{left} inputs are left of jobs that have ended")
    if not store.postgres:
        told.wrong_if(store.query("PRAGMA integrity_check") != [["ok"]], "the file is damaged")
    return rows, committed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("remeshd")
    parser.add_argument("--store", default="sqlite", choices=["sqlite", "postgres"])
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--store-kills", type=int, default=0)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 30))
    wanted = parser.parse_args()
    if wanted.store_kills and wanted.store != "postgres":
        parser.error("--store-kills needs --store postgres: SQLite is no process of its own")
    if not can_use(wanted.store):
        print("SKIPPED: there is no PostgreSQL (Debian: postgresql-15)")
        return 77
    print(f"{wanted.store}: {wanted.kills} kills of daemons, {wanted.store_kills} of the store, --seed {wanted.seed}", flush=True)
    random.seed(wanted.seed)

    start = time.monotonic()
    told, stopping = Told(), threading.Event()
    with Store(wanted.store) as store:
        fleet = [Daemon(wanted.remeshd, [*store.flags, "--workers", "1", "--max-running", "2", "--job-lease", f"{LEASE_S:.0f}s",
                                         "--job-attempts", "1000"]).start() for _ in range(3)]
        try:
            expected = []
            for mesh, query in CASES:
                answer = ask(fleet[0].port, "POST", f"/v1/remesh?{query}", mesh)
                expected.append((answer.status, comparable(answer.body)))
            clients = [Client(number, fleet, told, expected, stopping) for number in range(CLIENTS)]
            for client in clients:
                client.start()
            chaos = Chaos(fleet, store, wanted.seed)
            chaos.run(wanted.kills, wanted.store_kills)
            stopping.set()
            for client in clients:
                client.join()
            wait_for(lambda: ask(fleet[0].port, "GET", "/readyz").status == 200)
        finally:
            for daemon in fleet:
                daemon.kill()
        rows, committed = check_store(store, fleet, told)

    attempts = [int(row[2]) for row in rows.values()]
    states = collections.Counter(row[0] for row in rows.values())
    print(f"  {chaos.kills} kills of daemons, {chaos.store_kills} of the store, {chaos.stops} daemons stopped beyond their "
          f"lease, in {time.monotonic() - start:.0f} s")
    print(f"  {len(told.case_of_job)} jobs accepted ({told.repeats} asked for again), {dict(states)} at the end, "
          f"{sum(count > 1 for count in attempts)} ran more than once, at most {max(attempts, default=0)} times")
    print(f"  {told.results} results compared, {len(committed)} commits in the daemons' logs, {told.refusals} answers 503")
    for text in told.wrong[:20]:
        print("  WRONG:", text)
    print("FAILED" if told.wrong else "nothing lost, nothing done twice, no wrong result", flush=True)
    return 1 if told.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
