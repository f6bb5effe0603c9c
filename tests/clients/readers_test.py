"""Slow readers of large answers against a real remeshd: readers_test.py REMESHD

64 clients read answers of 100 MB at 1 to 10 KB/s, and one reads at 250 KB/s. The slow ones must be cut within five minutes, and
until then hold no memory and nobody up; the fast one gets all of its answer, which takes seven minutes.
"""

import concurrent.futures
import contextlib
import hashlib
import http.client
import pathlib
import re
import sys
import tempfile
import threading
import time

from daemons import PATIENCE, SQUARE, Daemon, ask, expect

READERS = 64
LARGE = "max_edge_length=0.00098"  # makes an answer of a little more than 100 MB from the square
MIN_ANSWER = 100_000_000  # bytes
MAX_MEMORY = 64 << 20  # of all answers together
MAX_WAIT = 2  # seconds until another client is answered
MAX_CUT = 300  # seconds until a slow reader is cut
GOOD_RATE = 250_000  # bytes a second


class Reader:
    """A client that asks for a result and reads it at a rate."""

    def __init__(self, port, path, rate):
        self.rate = rate
        self.refusals = 0
        while True:
            self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=2 * PATIENCE)
            self.connection.request("GET", path, headers={"Connection": "close"})
            self.answer = self.connection.getresponse()
            if self.answer.status != 503:
                break
            # Memory for so many answers at once is short before the first ones are on their way.
            self.refusals += 1
            self.connection.close()
            time.sleep(1)
        expect(self.answer.status == 200, f"a result was answered with {self.answer.status}")

    def read(self, is_over=lambda: False):
        """Output: the number of bytes that came, and their sum."""
        digest = hashlib.sha256()
        size = 0
        began = time.monotonic()
        with contextlib.closing(self.connection):
            while not is_over():
                time.sleep(max(0, began + size / self.rate - time.monotonic()))
                try:
                    piece = self.answer.read1(max(1000, self.rate // 10))
                except (OSError, http.client.HTTPException):
                    break
                if not piece:
                    break
                size += len(piece)
                digest.update(piece)
        return size, digest.hexdigest()


class Watcher:
    """Another client, which asks twice a second, and looks at the memory of the daemon."""

    def __init__(self, daemon):
        self.daemon = daemon
        self.waits = []
        self.statuses = set()
        self.memory = []
        self.is_over = threading.Event()
        self.thread = threading.Thread(target=self._watch)
        self.thread.start()

    def _watch(self):
        while not self.is_over.wait(0.5):
            began = time.monotonic()
            answer = ask(self.daemon.port, "POST", "/v1/remesh", SQUARE)
            self.waits.append(time.monotonic() - began)
            self.statuses.add(answer.status)
            self.memory.append(memory_of(self.daemon))

    def end(self):
        self.is_over.set()
        self.thread.join()


def memory_of(daemon):
    """The bytes that the daemon holds, but for the files that it has mapped."""
    status = pathlib.Path(f"/proc/{daemon.process.pid}/status").read_text()
    return sum(int(number) << 10 for number in re.findall(r"^Rss(?:Anon|Shmem):\s+(\d+)", status, re.MULTILINE))


def make_result(port):
    """The path of the large result of a job, its size and its sum."""
    job = ask(port, "POST", f"/v1/jobs?{LARGE}", SQUARE)
    expect(job.status == 202, f"the job: {job.status} {job.body[:200]}")
    links = job.json()["links"]
    began = time.monotonic()
    while ask(port, "GET", links["self"]).json()["state"] != "succeeded":
        expect(time.monotonic() - began < 10 * PATIENCE, "the job does not end")
        time.sleep(1)
    result = ask(port, "GET", links["result"])
    expect(result.status == 200 and len(result.body) >= MIN_ANSWER, f"{result.status}, {len(result.body)} bytes")
    return links["result"], len(result.body), hashlib.sha256(result.body).hexdigest()


def cut_lines(daemon, path, total):
    """The lines of the log about the answers that ended early."""
    return [line for line in list(daemon.log)
            if line.get("path") == path and line.get("status") == 200 and line.get("bytes_out", 0) < total]


def main():
    with tempfile.TemporaryDirectory() as folder:
        flags = ("--store", "sqlite", "--state-dir", folder, "--memory-budget", "1GiB", "--max-connections-per-address", "256")
        with Daemon(sys.argv[1], *flags) as daemon, concurrent.futures.ThreadPoolExecutor(READERS + 1) as threads:
            path, total, wanted_sum = make_result(daemon.port)
            before = memory_of(daemon)
            watcher = Watcher(daemon)
            try:
                good = threads.submit(Reader(daemon.port, path, GOOD_RATE).read)
                are_cut = threading.Event()
                began = time.monotonic()
                rates = [1000 + 9000 * number // (READERS - 1) for number in range(READERS)]
                with concurrent.futures.ThreadPoolExecutor(4) as starters:
                    readers = list(starters.map(lambda rate: Reader(daemon.port, path, rate), rates))
                all_begun = time.monotonic() - began
                slow = [threads.submit(reader.read, are_cut.is_set) for reader in readers]
                time.sleep(15)
                watched = len(watcher.memory)
                print(f"{READERS} readers have begun after {all_begun:.0f} s and {sum(r.refusals for r in readers)} refusals",
                      flush=True)
                time.sleep(30)
                held = max(watcher.memory[watched:])
                while len(slow) > len(cut_lines(daemon, path, total)):
                    if time.monotonic() - began > MAX_CUT + all_begun + 30:
                        break
                    time.sleep(1)
                are_cut.set()
                cuts = [line["ms"] / 1000 for line in cut_lines(daemon, path, total)]
                print(f"{len(cuts)} slow readers were cut, the last one {max(cuts, default=0):.0f} s after its request", flush=True)
                size, digest = good.result()
                time.sleep(2)
                print(f"the whole daemon held {held / 1e6:.1f} MB with {READERS + 1} answers of {total} bytes, and "
                      f"{before / 1e6:.1f} MB before them", flush=True)
            finally:
                watcher.end()
            print(f"the reader of {GOOD_RATE} bytes a second got {size} of {total} bytes")
            print(f"other clients were answered within {max(watcher.waits):.2f} s, with {watcher.statuses}")
            expect(watcher.statuses == {200}, f"another client was answered with {watcher.statuses}")
            expect(max(watcher.waits) <= MAX_WAIT, f"another client waited {max(watcher.waits):.2f} s")
            expect(held <= MAX_MEMORY, f"slow readers hold {held} bytes of memory")
            expect(len(cuts) == READERS and max(cuts) <= MAX_CUT, f"slow readers were cut after {sorted(cuts)} s")
            expect((size, digest) == (total, wanted_sum), "the reader that is fast enough got something else")
    return 0


if __name__ == "__main__":
    sys.exit(main())
