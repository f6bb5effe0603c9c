"""Three real daemons on one store, and clients that submit, poll, stream, cancel and repeat: jobs_test.py REMESHD REMESH sqlite|postgres [WORD]...

With words, only the tests that have one of them in their names.

Leases are short here (--job-lease), all else is as it is served. Exit code 77: the store is not there.
"""

import contextlib
import gzip
import http.client
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback

from daemons import (CONTINUE, ENDLESS, FIFTH, LONG_S, QUICK, SECOND, SHORT, SQUARE, STOP, Daemon, Store, ask, can_use,
                     events, result_of, state_of, submit, wait_for, wait_for_state, with_clock)

LEASE_S = 2
PROGRAM = CLIENT = ""


def expect(condition, text):
    if not condition:
        raise AssertionError(text)


def expect_sooner_than(seconds, start, text):
    """Expects that less time has passed since `start`, which is a value of time.monotonic().

    All bounds on time in this file stand here. They hold on a busy machine, because the work takes little, and a fault
    makes it wait for half a minute or more beyond it.
    """
    took = time.monotonic() - start
    expect(took < seconds, f"{text}: it took {took:.1f} s, and the bound is {seconds:.1f} s")


def expect_soon_after_the_lease(lease_s, start):
    """Expects that the lease of a worker that died at `start` was judged by its own length, and not by the default of 30 s.

    It takes the lease and a quarter of it. The rest, in which a job is claimed, is for others on the machine.
    """
    expect_sooner_than(lease_s * 1.25 + 20, start, "the job of a dead worker is claimed")


def expect_equal(got, wanted, text):
    expect(got == wanted, f"{text}: {got!r} in place of {wanted!r}")


@contextlib.contextmanager
def daemons(store, count, *flags, prefixes=(), lease=f"{LEASE_S}s"):
    started = []
    try:
        for i in range(count):
            prefix = prefixes[i] if i < len(prefixes) else ()
            started.append(Daemon(PROGRAM, [*store.flags, "--workers", "1", "--max-running", "1", "--job-lease", lease,
                                            *flags], prefix=prefix).start())
        yield started
    finally:
        for daemon in started:
            daemon.kill()


def accepted(answer):
    expect_equal(answer.status, 202, f"a job is accepted ({answer.body[:200]})")
    job = answer.json()
    expect_equal(answer.headers["location"], f"/v1/jobs/{job['id']}", "Location")
    expect("retry-after" in answer.headers, "Retry-After")
    return job["id"]


def worker_of(fleet, job_id):
    """The daemon that claimed it last."""
    def found():
        claims = [(line["token"], daemon) for daemon in fleet for line in daemon.logged("job claimed", job=job_id)]
        return max(claims, key=lambda claim: claim[0])[1] if claims else None

    return wait_for(found)


def test_jobs_are_submitted_anywhere_and_answered_everywhere(store):
    with daemons(store, 3) as fleet:
        direct = ask(fleet[0].port, "POST", f"/v1/remesh?{SHORT}", SQUARE)
        as_stl = ask(fleet[0].port, "POST", f"/v1/remesh?{SHORT}&format=stl", SQUARE)
        failures = []

        def client(number):
            try:
                job = accepted(submit(fleet[number % 3].port, SHORT, Idempotency_Key=f"client {number}"))
                seen = list(events(fleet[(number + 1) % 3].port, job))
                expect_equal(seen[-1][1], "end", "the last event")
                expect_equal(seen[-1][2]["state"], "succeeded", "its state")
                expect([event[0] for event in seen] == sorted({event[0] for event in seen}), "ids rise")
                result = result_of(fleet[(number + 2) % 3].port, job)
                expect(result.body == direct.body, "the bytes are those of /v1/remesh")
                expect_equal(result.headers["remesh-summary"], direct.headers["remesh-summary"], "the summary")
                expect(result_of(fleet[0].port, job, "?format=stl").body == as_stl.body, "the same as STL")
                report = ask(fleet[number % 3].port, "GET", f"/v1/jobs/{job}/report").json()
                packed = ask(fleet[number % 3].port, "GET", f"/v1/jobs/{job}/report", None, {"Accept-Encoding": "gzip"})
                expect_equal(json.loads(gzip.decompress(packed.body)), report, "the report, compressed")
                expect(report["verified"]["surface"], "verified")
                expect_equal(accepted(submit(fleet[(number + 1) % 3].port, SHORT, Idempotency_Key=f"client {number}")), job,
                             "the same key is the same job, done or not")
            except Exception as failure:  # pylint: disable=broad-except
                failures.append(failure)

        clients = [threading.Thread(target=client, args=(number,)) for number in range(12)]
        for thread in clients:
            thread.start()
        for thread in clients:
            thread.join()
        expect(not failures, f"{len(failures)} clients failed, the first: {failures[:1]}")
        wait_for(lambda: sum(len(daemon.logged("job committed")) for daemon in fleet) >= 12)
        commits = [len(daemon.logged("job committed")) for daemon in fleet]
        expect_equal(sum(commits), 12, "commits")
        expect(sum(count > 0 for count in commits) >= 2, "more than one daemon has worked")


def test_the_contract_of_a_job_that_runs(store):
    with daemons(store, 2) as (first, second):
        job = accepted(ask(first.port, "POST", f"/v1/remesh?{ENDLESS}", SQUARE, {"Prefer": "respond-async"}))
        running = wait_for_state(second.port, job, "running")
        expect_equal(running["attempts"], 1, "attempts")
        early = result_of(second.port, job)
        expect_equal((early.status, early.code()), (409, "job_not_finished"), "the result of a running job")
        stream = events(second.port, job)
        version, kind, _ = next(stream)
        expect_equal(kind, "progress", "the first event")
        later = next(events(first.port, job, last_event_id=version))
        expect(later[0] > version, "Last-Event-ID: nothing is told twice")
        start = time.monotonic()
        for daemon in (second, first, second):
            expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}").status, 204, "DELETE")
        expect_equal([event for event in stream][-1][2]["state"], "cancelled", "the stream's last word")
        cancelled = result_of(first.port, job)
        expect_equal((cancelled.status, cancelled.code()), (409, "cancelled"), "the result of a cancelled job")
        expect_equal(cancelled.json()["request_id"], job, "its request_id")
        # Its worker is free soon. Otherwise it would compute for minutes.
        quick = [accepted(submit(first.port)) for _ in range(4)]
        for other in quick:
            wait_for_state(first.port, other, "succeeded")
        expect_sooner_than(60, start, "a cancelled job frees its worker")


def test_refusals(store):
    with daemons(store, 1) as (daemon,):
        for target in ("0" * 32, "x", "A" * 32):
            expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{target}").status, 404, f"job {target}")
        expect_equal(submit(daemon.port, "refin=true").code(), "unknown_option", "an option is checked at once")
        expect_equal(submit(daemon.port, "format=doc").code(), "invalid_option", "a format too")
        expect_equal(submit(daemon.port, Content_Encoding="br").status, 415, "a coding too")
        expect_equal(submit(daemon.port, Idempotency_Key="").code(), "malformed_request", "an empty key")
        accepted(submit(daemon.port, Idempotency_Key="one"))
        for other in (submit(daemon.port, SHORT, Idempotency_Key="one"), submit(daemon.port, mesh=SQUARE + b"\n",
                                                                               Idempotency_Key="one")):
            expect_equal((other.status, other.code()), (422, "idempotency_key_reused"), "a key with another request")
        bad = accepted(submit(daemon.port, mesh=b"v 0 0 0\nf 1 2 9\n"))
        failed = wait_for_state(daemon.port, bad, "failed")
        expect_equal(failed["problem"]["code"], "index_out_of_range", "the problem is told")
        expect_equal(failed["problem"]["request_id"], bad, "its request_id")
        expect_equal(failed["attempts"], 1, "errors of the input never retry")
        for part in ("result", "report"):
            answer = ask(daemon.port, "GET", f"/v1/jobs/{bad}/{part}")
            expect_equal((answer.status, answer.code()), (422, "index_out_of_range"), f"{part} of a failed job")
        done = accepted(submit(daemon.port))
        wait_for_state(daemon.port, done, "succeeded")
        expect_equal(result_of(daemon.port, done, "?refine=false").code(), "unknown_option", "a result has one option")
        expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{done}/result", None, {"Accept": "image/png"}).status, 406, "406")
        expect_equal(ask(daemon.port, "GET", "/v1/jobs").status, 403, "no listing without a key")


def form(boundary, mesh=SQUARE, name="part.obj"):
    """A form with a mesh as `curl -F` sends it, and its media type."""
    head = f'--{boundary}\r\nContent-Disposition: form-data; name="mesh"; filename="{name}"\r\nContent-Type: model/obj\r\n\r\n'
    return head.encode() + mesh + f"\r\n--{boundary}--\r\n".encode(), f"multipart/form-data; boundary={boundary}"


def test_a_form_sent_again_is_the_same_request_whatever_its_boundary(store):
    with daemons(store, 1) as (daemon,):
        def send(*arguments, **fields):
            body, media_type = form(*arguments, **fields)
            return submit(daemon.port, mesh=body, Content_Type=media_type, Idempotency_Key="of a form")

        job = accepted(send("first-0123"))
        expect_equal(accepted(send("second-4567")), job, "the same parts between other boundaries")
        for other in (send("third-89", mesh=SQUARE + b"\n"), send("third-89", name="other.obj")):
            expect_equal((other.status, other.code()), (422, "idempotency_key_reused"), "another form")
        broken = submit(daemon.port, mesh=b"no form", Content_Type="multipart/form-data; boundary=x", Idempotency_Key="y")
        expect_equal((broken.status, broken.code()), (400, "malformed_multipart"), "what is no form")


def test_the_result_of_a_failed_job_is_no_refusal(store):
    with daemons(store, 1, "--max-faces", "1") as (daemon,):
        job = accepted(submit(daemon.port))
        wait_for_state(daemon.port, job, "failed")
        for part in ("result", "report"):
            answer = ask(daemon.port, "GET", f"/v1/jobs/{job}/{part}")
            expect_equal((answer.status, answer.code()), (413, "mesh_too_large"), f"the {part}")
            wait_for(lambda: daemon.logged("request", path=f"/v1/jobs/{job}/{part}", code="mesh_too_large"))  # pylint: disable=cell-var-from-loop
        expect_equal(daemon.metric("remeshd_http_rejected_total{"), 0, "no limit has turned a request away")


def test_results_are_within_the_memory_budget(store):
    with daemons(store, 1) as (daemon,):
        job = accepted(submit(daemon.port, FIFTH))
        wait_for_state(daemon.port, job, "succeeded")
        wait_for(lambda: daemon.metric("remeshd_memory_reserved_bytes") == 0)
        # Much more than a connection takes: the rest waits for whoever reads.
        slow = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=LONG_S)
        with contextlib.closing(slow):
            slow.request("GET", f"/v1/jobs/{job}/result")
            answer = slow.getresponse()
            size = int(answer.headers["Content-Length"])
            expect(size > 8_000_000, f"{size} bytes are many")
            expect(daemon.metric("remeshd_memory_reserved_bytes") >= size, "the answer is counted until it is sent")
            answer.close()
        wait_for(lambda: daemon.metric("remeshd_memory_reserved_bytes") == 0)
        expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{job}/report").status, 200, "the report")
        line, = wait_for(lambda: daemon.logged("request", path=f"/v1/jobs/{job}/report"))
        expect("work_ms" in line, "it is read and compressed by the pool")


def test_what_is_written_is_closed_to_others(store):
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as files:
        for path in (folder, files):
            os.chmod(path, 0o755)
        with contextlib.ExitStack() as stack:
            other = store if store.postgres else stack.enter_context(Store("sqlite", folder))
            daemon, = stack.enter_context(daemons(other, 1, "--blob-dir", files))
            wait_for_state(daemon.port, accepted(submit(daemon.port)), "succeeded")
            written = [path for parent in (folder, files) for path in pathlib.Path(parent).rglob("*")]
            expect(written, "there is something")
            for path in written:
                expect_equal(path.stat().st_mode & 0o077, 0, str(path))


def test_a_job_can_be_followed_in_the_log(store):
    with daemons(store, 1) as (daemon,):
        good, bad = accepted(submit(daemon.port)), accepted(submit(daemon.port, mesh=b"v 0 0 0\nf 1 2 9\n"))
        for job, code in ((good, None), (bad, "index_out_of_range")):
            wait_for(lambda: daemon.logged("request", path="/v1/jobs", job=job))  # pylint: disable=cell-var-from-loop
            line, = wait_for(lambda: daemon.logged("job committed", job=job))  # pylint: disable=cell-var-from-loop
            expect_equal(line.get("code"), code, "its code")
            if job == good:
                expect(line["input_faces"] == 2 and line["output_faces"] > 2 and line["refinement"] >= 0, f"its work: {line}")
        wait_for(lambda: daemon.metric('remeshd_jobs_total{code="index_out_of_range",outcome="failed"}') == 1)
        expect_equal(daemon.metric('remeshd_jobs_total{outcome="succeeded"}'), 1, "the good one")


def test_a_job_that_has_ended_can_be_deleted(store):
    with daemons(store, 1) as (daemon,):
        done, bad = accepted(submit(daemon.port)), accepted(submit(daemon.port, mesh=b"v 0 0 0\nf 1 2 9\n"))
        wait_for_state(daemon.port, done, "succeeded")
        wait_for_state(daemon.port, bad, "failed")
        for _ in range(2):
            for job in (done, bad):
                expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}").status, 204, "DELETE")
        expect_equal(state_of(daemon.port, done)["state"], "expired", "the state of one that had a result")
        for part in ("result", "report"):
            answer = ask(daemon.port, "GET", f"/v1/jobs/{done}/{part}")
            expect_equal((answer.status, answer.code()), (410, "result_expired"), part)
        expect_equal(state_of(daemon.port, bad)["problem"]["code"], "index_out_of_range", "a failure stays as it is")
        expect_equal(store.query(f"SELECT count(*) FROM remeshd_blob WHERE job IN ('{done}', '{bad}')"), [["0"]], "what is kept")


def test_what_is_in_force_is_logged_at_the_start(store):
    daemon = Daemon(PROGRAM, [*store.flags, "--queue-size", "7", "--memory-budget", "512MiB"], {"REMESHD_MAX_BODDY": "1MiB"})
    try:
        daemon.start()
        line, = wait_for(lambda: daemon.logged("listening"))
        expect_equal([line[name] for name in ("queue_size", "memory_budget", "keys", "role")], [7, "512MiB", 0, "both"], "settings")
        expect(line["store"].startswith("postgres") if store.postgres else line["state_dir"] == store.folder, f"the store: {line}")
        wait_for(lambda: daemon.logged("no setting has this variable", variable="REMESHD_MAX_BODDY"))
    finally:
        daemon.kill()


def test_an_older_daemon_leaves_a_newer_store_alone_until_it_is_brought_back(store):
    with daemons(store, 2) as (running, again):
        kept = accepted(submit(running.port))
        wait_for_state(running.port, kept, "succeeded")
        version = store.query("SELECT version FROM remeshd_schema")[0][0]
        store.query("UPDATE remeshd_schema SET version = 99")
        try:
            # It goes on where it runs, and serves all but jobs where it starts.
            wait_for_state(running.port, accepted(submit(running.port)), "succeeded")
            again.kill()
            again.start()
            wait_for(lambda: [line for line in again.lines if "newer version of remeshd" in str(line)])
            expect_equal(ask(again.port, "GET", "/readyz").status, 503, "/readyz")
            expect_equal(ask(again.port, "GET", "/livez").status, 200, "/livez")
            expect_equal(ask(again.port, "POST", f"/v1/remesh?{QUICK}", SQUARE).status, 200, "a request")
            expect_equal(submit(again.port).status, 503, "a job")
        finally:
            store.query(f"UPDATE remeshd_schema SET version = {version}")
        wait_for(lambda: ask(again.port, "GET", "/readyz").status == 200)
        expect_equal(result_of(again.port, kept).status, 200, "what was kept before")


def test_what_another_version_has_kept_is_refused_and_harms_nothing_else(store):
    with daemons(store, 1) as (daemon,):
        job, sound = accepted(submit(daemon.port)), accepted(submit(daemon.port))
        for one in (job, sound):
            wait_for_state(daemon.port, one, "succeeded")
        other = "overlay(data placing 'REMESHD0'::bytea from 1)" if store.postgres else \
            "CAST(CAST('REMESHD0' AS BLOB) || substr(data, 9) AS BLOB)"
        # In SQLite, texts are joined, so what stands behind the mark may be cut off; the mark is looked at first.
        store.query(f"UPDATE remeshd_blob SET data = {other} WHERE job = '{job}' AND kind = 'mesh' AND part = 0")
        answer = result_of(daemon.port, job)
        expect_equal((answer.status, answer.code()), (500, "internal"), "the result")
        expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{job}/report").status, 200, "the report")
        expect_equal(state_of(daemon.port, job)["state"], "succeeded", "the state")
        expect_equal(result_of(daemon.port, sound).status, 200, "another result")
        expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}").status, 204, "DELETE")
        # A job that waits has its options as they were sent.
        with daemons(store, 1, "--role", "serve") as (front,):
            daemon.signal(STOP)
            waiting = accepted(submit(front.port))
            store.query(f"UPDATE remeshd_job SET request = replace(request, 'max_edge_length', 'option_of_later') "
                        f"WHERE id = '{waiting}'")
            daemon.signal(CONTINUE)
            failed = wait_for_state(front.port, waiting, "failed")
            expect_equal((failed["problem"]["status"], failed["problem"]["code"]), (400, "unknown_option"), "the problem")


def test_keys_have_their_limits_under_load(store):
    """One key of three sends as much as it can: the others notice nothing, and it runs no more than it may."""
    keys = {"greedy": "greedy-0123456789ab", "second": "second-0123456789ab", "third": "third-0123456789abc"}
    with tempfile.NamedTemporaryFile("w") as file:
        file.write("".join(f"{name} {key}\n" for name, key in keys.items()))
        file.flush()
        daemon = Daemon(PROGRAM, [*store.flags, "--workers", "2", "--max-running", "2", "--api-key-file", file.name,
                                  "--max-running-per-key", "1", "--max-rate-per-key", "600"]).start()
        statuses = {name: [] for name in keys}
        waits, is_over = set(), threading.Event()

        def client(name):
            while not is_over.is_set():
                answer = ask(daemon.port, "POST", f"/v1/remesh?{SHORT}", SQUARE, {"X-API-Key": keys[name]})
                statuses[name].append(answer.status)
                if answer.status == 429:
                    waits.add((answer.code(), int(answer.headers["retry-after"]) > 0))
                    time.sleep(0.01)

        threads = []
        try:
            jobs = [accepted(submit(daemon.port, FIFTH, X_API_Key=keys["greedy"])) for _ in range(3)]
            threads = [threading.Thread(target=client, args=(name,)) for name in ["greedy"] * 6 + ["second", "third"]]
            for thread in threads:
                thread.start()
            # The jobs of one key run one after the other, though there are places.
            running = [0]

            def all_done():
                running[0] = max([running[0], *(int(count) for count, in store.query(
                    "SELECT count(*) FROM remeshd_job WHERE state = 'running' GROUP BY owner"))])
                return all(ask(daemon.port, "GET", f"/v1/jobs/{job}", fields={"X-API-Key": keys["greedy"]}).json()["state"]
                           == "succeeded" for job in jobs)

            wait_for(all_done)
            wait_for(lambda: all(200 in given for given in statuses.values()) and 429 in statuses["greedy"])
        finally:
            is_over.set()
            for thread in threads:
                thread.join()
            daemon.kill()
        expect_equal(running[0], 1, "jobs of the key at once")
        expect_equal(waits, {("rate_limited", True)}, "what the refused are told")
        expect(set(statuses["greedy"]) <= {200, 429, 503}, f"the greedy key: {set(statuses['greedy'])}")
        for name in ("second", "third"):
            expect(429 not in statuses[name], f"{name} is refused for another's requests")


def test_results_expire(store):
    with daemons(store, 1, "--result-ttl", "1s") as (daemon,):
        job = accepted(submit(daemon.port))
        wait_for_state(daemon.port, job, "succeeded")
        expired = wait_for_state(daemon.port, job, "expired")
        expect(expired["finished_at"], "what was is still told")
        for part in ("result", "report"):
            answer = ask(daemon.port, "GET", f"/v1/jobs/{job}/{part}")
            expect_equal((answer.status, answer.code()), (410, "result_expired"), part)


def test_a_lost_file_is_the_loss_of_its_job_alone(store):
    with tempfile.TemporaryDirectory() as folder, daemons(store, 1, "--blob-dir", folder) as (daemon,):
        lost, kept = (accepted(submit(daemon.port)) for _ in range(2))
        for job in (lost, kept):
            wait_for_state(daemon.port, job, "succeeded")
        for file in pathlib.Path(folder).glob(f"*/{lost}.*"):
            file.unlink()
        for part in ("result", "report"):
            answer = ask(daemon.port, "GET", f"/v1/jobs/{lost}/{part}")
            expect_equal((answer.status, answer.code()), (500, "internal"), f"the lost {part}")
        wait_for(lambda: any(lost in line["error"] for line in daemon.logged("request failed")))
        expect_equal(ask(daemon.port, "GET", "/readyz").status, 200, "/readyz")
        expect_equal(result_of(daemon.port, kept).status, 200, "another's result")


def test_json_is_checked_when_it_comes(store):
    with daemons(store, 1) as (daemon,):
        def send(body):
            answer = submit(daemon.port, mesh=body, Content_Type="application/json")
            return answer.status, answer.code()

        mesh = b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]}'
        expect_equal(send(mesh)[0], 202, "a mesh")
        expect_equal(send(b'{"mesh": ' + mesh + b', "options": {"refin": 1}}'), (400, "unknown_option"), "an option in the body")
        expect_equal(send(mesh[:-10]), (400, "malformed_json"), "JSON that is cut off")


def test_what_may_be_stored_is_limited(store):
    with daemons(store, 1, "--max-stored", "1MiB") as (daemon,):
        store.query("DELETE FROM remeshd_blob")
        store.query("UPDATE remeshd_job SET stored = 0")
        large = SQUARE + b"#" * 900_000
        job = accepted(submit(daemon.port, ENDLESS, mesh=large))
        refused = submit(daemon.port, mesh=large)
        expect_equal((refused.status, refused.code()), (507, "storage_full"), "beyond the limit")
        wait_for(lambda: daemon.metric("remeshd_jobs_stored_bytes") >= 900_000)
        expect_equal(ask(daemon.port, "GET", "/readyz").status, 200, "/readyz")
        expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}").status, 204, "DELETE")
        wait_for_state(daemon.port, accepted(submit(daemon.port, mesh=large)), "succeeded")


def test_jobs_belong_to_the_key_that_made_them(store):
    with tempfile.NamedTemporaryFile("w") as keys:
        mine, yours = {"X-API-Key": "key-of-the-first-0123"}, {"X-API-Key": "key-of-the-second-012"}
        keys.write("\n".join([mine["X-API-Key"], yours["X-API-Key"]]))
        keys.flush()
        with daemons(store, 1, "--api-key-file", keys.name) as (daemon,):
            job = accepted(ask(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE, {**mine, "Idempotency-Key": "same"}))
            other = accepted(ask(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE, {**yours, "Idempotency-Key": "same"}))
            expect(job != other, "keys of idempotency are each client's own")
            for path in ("", "/result", "/report", "/events"):
                expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{job}{path}", None, yours).status, 404, "of another: " + path)
                expect_equal(ask(daemon.port, "GET", f"/v1/jobs/{job}{path}").status, 401, "without a key: " + path)
            expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}", None, yours).status, 404, "cancelling another's")
            listed = ask(daemon.port, "GET", "/v1/jobs", None, mine).json()["jobs"]
            expect_equal([entry["id"] for entry in listed], [job], "the list")
            wait_for(lambda: ask(daemon.port, "GET", f"/v1/jobs/{job}", None, mine).json()["state"] == "succeeded")


def test_a_dead_worker_s_job_runs_again(store):
    with daemons(store, 3) as fleet:
        direct = ask(fleet[0].port, "POST", f"/v1/remesh?{SECOND}", SQUARE)
        job = accepted(submit(fleet[0].port, SECOND))
        dead = worker_of(fleet, job)
        dead.kill()
        others = [daemon for daemon in fleet if daemon is not dead]
        start = time.monotonic()
        wait_for(lambda: any(daemon.logged("job claimed", job=job) for daemon in others))
        expect_soon_after_the_lease(LEASE_S, start)
        done = wait_for_state(others[0].port, job, "succeeded")
        expect_equal(done["attempts"], 2, "attempts")
        expect(result_of(others[1].port, job).body == direct.body, "the result")
        dead.start()
        expect(sum(daemon.metric('remeshd_job_retries_total{reason="worker_crashed"}') for daemon in others) >= 1, "retries")


def test_a_job_that_kills_its_workers_fails(store):
    with daemons(store, 1, "--job-attempts", "2", lease="500ms") as (daemon,):
        job = accepted(submit(daemon.port, ENDLESS))
        for attempt in (1, 2):
            wait_for(lambda: state_of(daemon.port, job)["attempts"] == attempt)  # pylint: disable=cell-var-from-loop
            daemon.kill()
            daemon.start()
        failed = wait_for_state(daemon.port, job, "failed")
        expect_equal(failed["problem"]["code"], "worker_crashed", "the problem")
        kept = store.query(f"SELECT count(*) FROM remeshd_blob WHERE job = '{job}' AND kind = 'input'")
        expect_equal(kept, [["1"]], "the input is kept")


def test_a_stopping_daemon_gives_its_job_back(store):
    with daemons(store, 2, "--drain-time", "500ms") as fleet:
        job = accepted(submit(fleet[0].port, ENDLESS))
        first = worker_of(fleet, job)
        expect_equal(first.stop(), 0, "its exit code")
        other = fleet[1] if first is fleet[0] else fleet[0]
        wait_for(lambda: other.logged("job claimed", job=job))
        expect_equal(state_of(other.port, job)["attempts"], 1, "the attempt is not counted, as one of a dead worker would be")
        # With time enough it is finished.
        expect_equal(ask(other.port, "DELETE", f"/v1/jobs/{job}").status, 204, "cancel")
        first.start()


def test_who_watches_a_job_does_not_hold_up_a_stop(store):
    # If it waited for the stream, that would be for the drain time, which is longer than the patience of `stop`.
    with daemons(store, 1, "--role", "serve", "--drain-time", f"{3 * LONG_S}s") as (daemon,):
        job = accepted(submit(daemon.port))
        stream = events(daemon.port, job)
        version, kind, _ = next(stream)
        expect_equal(kind, "progress", "the first event")
        expect_equal(daemon.stop(), 0, "its exit code")
        expect_equal(list(stream), [], "the stream ends, without an end of the job")
        daemon.start()
        expect_equal(ask(daemon.port, "DELETE", f"/v1/jobs/{job}").status, 204, "cancel")
        expect_equal([event[1] for event in events(daemon.port, job, last_event_id=version)], ["end"], "it goes on")


def stop_between_writes(first, second):
    """Stops a daemon while others can write. If it is stopped in the middle of a write, it holds SQLite's lock."""
    for _ in range(20):
        first.signal(STOP)
        if submit(second.port).status == 202:
            return
        first.signal(CONTINUE)
        time.sleep(0.2)
    raise TimeoutError("the daemon is always stopped in the middle of a write")


def test_a_worker_that_was_stopped_is_refused(store):
    with daemons(store, 2) as fleet:
        direct = ask(fleet[0].port, "POST", f"/v1/remesh?{SECOND}", SQUARE)
        job = accepted(submit(fleet[0].port, SECOND))
        first = worker_of(fleet, job)
        second = fleet[1] if first is fleet[0] else fleet[0]
        time.sleep(0.2)
        stop_between_writes(first, second)
        stopped = time.monotonic()
        done = wait_for_state(second.port, job, "succeeded")
        expect_equal(done["attempts"], 2, "attempts")
        time.sleep(max(0.0, 2 * LEASE_S - (time.monotonic() - stopped)))
        before = state_of(second.port, job)
        result = result_of(second.port, job)
        first.signal(CONTINUE)
        wait_for(lambda: first.logged("job lost", job=job) or first.logged("job refused", job=job))
        time.sleep(1)
        expect(not first.logged("job committed", job=job), "the first does not commit")
        expect_equal(len(second.logged("job committed", job=job)), 1, "the second has committed")
        expect_equal(state_of(second.port, job), before, "nothing has changed")
        expect(result_of(first.port, job).body == result.body == direct.body, "byte for byte")
        accepted(submit(first.port))


def test_clocks_that_differ_by_an_hour_do_no_harm(store):
    prefixes = [with_clock("+1h"), with_clock("-1h")]
    if None in prefixes:
        print("  SKIPPED: there is no libfaketime (Debian: faketime)")
        return
    # It is long, so that a worker on a busy machine renews it in time.
    lease_s = 5
    with daemons(store, 3, prefixes=prefixes, lease=f"{lease_s}s") as fleet:
        jobs = [accepted(submit(fleet[i % 3].port, FIFTH if i % 4 == 0 else SHORT)) for i in range(12)]
        finished = [wait_for_state(fleet[(i + 1) % 3].port, job, "succeeded", "failed")
                    for i, job in enumerate(jobs)]
        expect_equal({job["state"] for job in finished}, {"succeeded"}, "all succeed")
        expect_equal({job["attempts"] for job in finished}, {1}, "no lease runs out early")
        expect(all(job["created_at"] <= job["started_at"] <= job["finished_at"] for job in finished), "times in order")
        wait_for(lambda: all(daemon.logged("job committed") for daemon in fleet))
        # And a dead one is still missed.
        job = accepted(submit(fleet[0].port, ENDLESS))
        dead = worker_of(fleet, job)
        dead.kill()
        others = [daemon for daemon in fleet if daemon is not dead]
        start = time.monotonic()
        wait_for(lambda: any(daemon.logged("job claimed", job=job) for daemon in others))
        expect_soon_after_the_lease(lease_s, start)
        ask(others[0].port, "DELETE", f"/v1/jobs/{job}")


def expect_out_of_order(daemon):
    """A daemon whose store fails: it says so, and lives."""
    def refused():
        answer = submit(daemon.port)
        return (answer.status, answer.code(), "retry-after" in answer.headers) == (503, "store_unavailable", True)

    wait_for(refused)
    wait_for(lambda: ask(daemon.port, "GET", "/readyz").status == 503)
    expect_equal(ask(daemon.port, "GET", "/livez").status, 200, "/livez")
    expect_equal(ask(daemon.port, "POST", f"/v1/remesh?{QUICK}", SQUARE).status, 200, "what needs no store")
    expect(daemon.metric("remeshd_store_errors_total") > 0, "errors are counted")


def expect_in_order(daemon, job):
    wait_for(lambda: ask(daemon.port, "GET", "/readyz").status == 200)
    wait_for_state(daemon.port, job, "succeeded")
    # A connection that the outage broke may be found out only by the next request, which is refused and tried again.
    again = accepted(wait_for(lambda: (answer := submit(daemon.port)).status != 503 and answer))
    wait_for_state(daemon.port, again, "succeeded")


def test_a_store_that_cannot_be_written_is_told_and_recovers(store):
    with daemons(store, 1) as (daemon,):
        job = accepted(submit(daemon.port, FIFTH))
        wait_for_state(daemon.port, job, "running", "succeeded")
        if store.postgres:
            store.query("ALTER SYSTEM SET default_transaction_read_only = on")
            store.query("SELECT pg_reload_conf()")
        else:  # no file may grow: what the system says then is what a full disk is
            resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))
        try:
            expect_out_of_order(daemon)
        finally:
            if store.postgres:
                store.query("ALTER SYSTEM RESET default_transaction_read_only")
                store.query("SELECT pg_reload_conf()")
            else:
                resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        expect_in_order(daemon, job)


def test_a_full_disk_is_told_and_costs_nothing(store):
    """A real one: SQLite's file on a file system of a few megabytes."""
    if store.postgres:
        return
    with tempfile.TemporaryDirectory() as folder:
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=6m", "remeshd-test", folder], check=False,
                          capture_output=True).returncode != 0:
            print("  SKIPPED: no file system can be mounted here")
            return
        try:
            with Store("sqlite", folder) as small, daemons(small, 1) as (daemon,):
                kept = accepted(submit(daemon.port, SHORT))
                wait_for_state(daemon.port, kept, "succeeded")
                before = result_of(daemon.port, kept).body
                filler = pathlib.Path(folder, "filler")
                with contextlib.suppress(OSError), filler.open("wb") as file:
                    while True:
                        file.write(bytes(4096))
                        file.flush()
                refused = submit(daemon.port, mesh=SQUARE + b"#" * 100_000)
                expect_equal((refused.status, refused.code()), (507, "storage_full"), "a new job")
                expect_equal(ask(daemon.port, "GET", "/livez").status, 200, "/livez")
                expect(result_of(daemon.port, kept).body == before, "what is kept can be read")
                filler.unlink()
                again = accepted(wait_for(lambda: (answer := submit(daemon.port, SHORT)).status == 202 and answer))
                expect_in_order(daemon, again)
                expect_equal(state_of(daemon.port, kept)["state"], "succeeded", "nothing is lost")
                expect(result_of(daemon.port, kept).body == before, "what was kept can be read again")
        finally:
            subprocess.run(["umount", folder], check=True)


@contextlib.contextmanager
def away(postgres):
    """The tests that follow find it in its place, however this one ends."""
    postgres.kill()
    try:
        yield
    finally:
        postgres.start()


def test_a_store_that_goes_away_comes_back(store):
    if not store.postgres:
        return
    with daemons(store, 2) as (daemon, other):
        job = accepted(submit(daemon.port, FIFTH))
        wait_for_state(daemon.port, job, "running", "succeeded")
        with away(store.postgres):
            expect_out_of_order(daemon)
        expect_in_order(daemon, job)
        expect_in_order(other, job)
        # A daemon that starts without its store waits for it.
        with contextlib.ExitStack() as stack:
            with away(store.postgres):
                early, = stack.enter_context(daemons(store, 1))
                expect_equal(ask(early.port, "GET", "/readyz").status, 503, "not ready")
            expect_in_order(early, job)


def test_the_queue_has_an_end(store):
    with daemons(store, 1, "--role", "serve", "--max-queued-jobs", "3") as (daemon,):
        jobs = [accepted(submit(daemon.port)) for _ in range(3)]
        answer = wait_for(lambda: (answer := submit(daemon.port)).status != 202 and answer)
        expect_equal((answer.status, answer.code()), (503, "overloaded"), "beyond the limit")
        with daemons(store, 1, "--role", "work"):
            wait_for_state(daemon.port, jobs[-1], "succeeded")
            accepted(wait_for(lambda: (answer := submit(daemon.port)).status == 202 and answer))


def test_roles(store):
    with daemons(store, 1, "--role", "serve") as (serving,):
        job = accepted(submit(serving.port))
        time.sleep(0.5)
        expect_equal(state_of(serving.port, job)["state"], "queued", "nobody works")
        with daemons(store, 1, "--role", "work") as (working,):
            wait_for_state(serving.port, job, "succeeded")
            expect_equal(ask(working.port, "POST", "/v1/remesh", SQUARE).status, 404, "a worker only works")
            expect_equal(ask(working.port, "GET", "/readyz").status, 200, "but is watched")
            for name in ("remeshd_jobs_queued ", "remeshd_jobs_running ", "remeshd_job_oldest_queued_seconds ",
                         'remeshd_jobs_total{outcome="succeeded"} ',
                         'remeshd_job_retries_total{reason="worker_crashed"}', 'remeshd_store_latency_seconds_count{op="commit"} '):
                wait_for(lambda: f"\n{name}" in ask(working.port, "GET", "/metrics").body.decode())  # pylint: disable=cell-var-from-loop


@contextlib.contextmanager
def command_line(daemon, mesh, *options):
    """remesh --server, in a folder of its own. Gives the process, and the folder."""
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/part.obj", "wb") as file:
            file.write(mesh)
        command = [CLIENT, "part.obj", "-o", "out.stl", "--report", "report.json", "--server", f"http://127.0.0.1:{daemon.port}"]
        with subprocess.Popen([*command, *options], cwd=folder, stderr=subprocess.PIPE, text=True) as process:
            yield process, pathlib.Path(folder)


def test_parts_of_a_result_are_those_of_the_whole(store):
    with daemons(store, 1) as (daemon,):
        job = accepted(submit(daemon.port, SHORT))
        wait_for_state(daemon.port, job, "succeeded")
        path = f"/v1/jobs/{job}/result?format=ply"
        whole = ask(daemon.port, "GET", path)
        head = ask(daemon.port, "HEAD", path)
        expect_equal(int(head.headers["content-length"]), len(whole.body), "the size that HEAD tells")
        for begin, end in ((0, 0), (1000, 2000), (len(whole.body) - 5, len(whole.body) - 1)):
            part = ask(daemon.port, "GET", path, fields={"Range": f"bytes={begin}-{end}"})
            expect_equal((part.status, part.body), (206, whole.body[begin:end + 1]), f"bytes {begin} to {end}")
            expect_equal(part.headers["etag"], whole.headers["etag"], "the tag")
        expect_equal(ask(daemon.port, "GET", path).body, whole.body, "the whole, again")
        ask(daemon.port, "DELETE", f"/v1/jobs/{job}")
        expect_equal(ask(daemon.port, "GET", path, fields={"Range": "bytes=0-0"}).status, 410, "after its deletion")


def test_the_command_line_uses_jobs(store):
    with daemons(store, 1) as (daemon,):
        direct = ask(daemon.port, "POST", f"/v1/remesh?{SHORT}&format=stl", SQUARE)
        with command_line(daemon, SQUARE, "--max-edge-length", "0.01") as (process, folder):
            expect_equal(process.wait(LONG_S), 0, "exit code")
            told = process.stderr.read()
            expect(told.startswith("remesh: 2 faces in, ") and told.count("\n") == 1, f"the result is told, not {told}")
            expect(folder.joinpath("out.stl").read_bytes() == direct.body, "the server's bytes")
            expect(json.loads(folder.joinpath("report.json").read_text())["verified"]["surface"], "the report")
        with command_line(daemon, SQUARE + b"f 1 2 9\n") as (process, folder):
            expect_equal(process.wait(LONG_S), 1, "exit code of a bad mesh")
            expect(process.stderr.read().startswith("remesh: part.obj:7: index_out_of_range: "), "where it is bad")
            expect(not folder.joinpath("out.stl").exists(), "nothing is written")
        with command_line(daemon, SQUARE, "--max-area", "-1") as (process, _):
            expect_equal(process.wait(LONG_S), 2, "exit code of a bad option")


def test_the_command_line_cancels_when_interrupted(store):
    with daemons(store, 1) as (daemon,):
        before = len(daemon.logged("job claimed"))
        with command_line(daemon, SQUARE, "--max-edge-length", "0.0003") as (process, _):
            job = wait_for(lambda: daemon.logged("job claimed")[before:])[0]["job"]
            process.send_signal(signal.SIGINT)
            expect_equal(process.wait(LONG_S), 1, "exit code")
            expect("cancelled" in process.stderr.read(), "it says so")
        wait_for_state(daemon.port, job, "cancelled")


def test_the_command_line_waits_for_a_server_that_is_away(store):
    with daemons(store, 1) as (daemon,):
        with command_line(daemon, SQUARE, "--quiet", "--max-edge-length", "0.005") as (process, folder):
            wait_for(lambda: daemon.logged("job claimed"))
            daemon.kill()
            time.sleep(0.5)
            daemon.start()
            expect_equal((process.wait(LONG_S), process.stderr.read()), (0, ""), "exit code and complaints")
            expect(folder.joinpath("out.stl").stat().st_size > 1000, "a result")


def main():
    global PROGRAM, CLIENT  # pylint: disable=global-statement
    PROGRAM, CLIENT = (os.path.abspath(program) for program in sys.argv[1:3])
    kind = sys.argv[3]
    wanted = sys.argv[4:]
    if not can_use(kind):
        print("SKIPPED: there is no PostgreSQL (Debian: postgresql-15)")
        return 77
    failures = 0
    tests = [(name, test) for name, test in globals().items() if name.startswith("test_")]
    with Store(kind) as store:
        for name, test in tests:
            if wanted and not any(word in name for word in wanted):
                continue
            start = time.monotonic()
            try:
                test(store)
                print(f"ok      {name} ({time.monotonic() - start:.1f} s)", flush=True)
            except Exception:  # pylint: disable=broad-except
                failures += 1
                print(f"FAILED  {name}", flush=True)
                traceback.print_exc()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
