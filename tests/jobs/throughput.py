"""How the throughput of jobs grows with workers, and what part of it the store takes: throughput.py REMESHD [--store KIND] [--jobs N] [--blob-dir]

One daemon of one core, and two, each pinned to its core, work through the same queue of jobs of about a second.
"""

import argparse
import os
import sys
import time

from daemons import FIFTH, SQUARE, Daemon, Store, can_use, state_of, submit, wait_for

def start_worker(program, flags, core):
    return Daemon(program, [*flags, "--workers", "1", "--max-running", "1"], prefix=("taskset", "-c", str(core))).start()


def measure(program, kind, workers, count, with_blob_dir):
    """Seconds for all jobs, and the part of the workers' time in which they compute."""
    with Store(kind) as store:
        flags = [*store.flags, *(["--blob-dir", os.path.join(store.folder, "blobs")] if with_blob_dir else [])]
        cores = sorted(os.sched_getaffinity(0))
        serving = Daemon(program, [*flags, "--role", "serve"]).start()
        fleet = []
        try:
            fleet = [start_worker(program, flags, cores[i % len(cores)]) for i in range(workers)]
            start = time.monotonic()
            jobs = [submit(serving.port, FIFTH).json()["id"] for _ in range(count)]
            wait_for(lambda: sum(len(daemon.logged("job committed")) for daemon in fleet) == count, 600, 0.05)
            seconds = time.monotonic() - start
            work = sum(line["work_ms"] for daemon in fleet for line in daemon.logged("job committed")) / 1000
            assert all(state_of(serving.port, job)["state"] == "succeeded" for job in jobs)
            return seconds, work
        finally:
            for daemon in [serving, *fleet]:
                daemon.kill()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("remeshd")
    parser.add_argument("--store", default="postgres", choices=["sqlite", "postgres"])
    parser.add_argument("--jobs", type=int, default=40)
    parser.add_argument("--blob-dir", action="store_true", help="meshes in a folder, not in the store")
    wanted = parser.parse_args()
    if not can_use(wanted.store):
        print("SKIPPED: there is no PostgreSQL (Debian: postgresql-15)")
        return 77
    load = os.getloadavg()[0]
    times = {}
    for workers in (1, 2):
        seconds, work = measure(wanted.remeshd, wanted.store, workers, wanted.jobs, wanted.blob_dir)
        times[workers] = seconds
        print(f"{wanted.store}, {workers} worker(s): {wanted.jobs} jobs of {work / wanted.jobs:.2f} s in {seconds:.1f} s, "
              f"{wanted.jobs / seconds:.2f} a second; {100 * (1 - work / workers / seconds):.1f} % of the time is the store's, "
              "or idle at the end", flush=True)
    print(f"two against one: {times[1] / times[2]:.2f} times (load of the machine before: {load:.1f}, cores {os.cpu_count()})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
