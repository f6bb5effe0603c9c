"""The contract that a real remeshd serves, as tools of npm read it: contract_clients_test.py REMESHD

Redocly's lint has no warnings, openapi-typescript makes types of it that compile, and a program with openapi-fetch works.
Exit code 77: what contract/package.json names is not installed (`./dev clients-http` installs it).
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from daemons import Daemon, ask, expect

SOURCE = pathlib.Path(__file__).resolve().parent / "contract"


def run(folder, program, *arguments):
    environment = {**os.environ, "REDOCLY_TELEMETRY": "off", "REDOCLY_SUPPRESS_UPDATE_NOTICE": "true"}
    done = subprocess.run([folder / "node_modules" / ".bin" / program, *arguments], cwd=folder, capture_output=True, text=True,
                          env=environment, timeout=300)
    expect(done.returncode == 0, f"{program}: {done.stdout[-2000:]} {done.stderr[-2000:]}")
    return done.stdout


def main():
    if not (SOURCE / "node_modules").exists():
        print("SKIPPED: tests/clients/contract has no node_modules")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in ("package.json", "tsconfig.json", "use.ts"):
            shutil.copy(SOURCE / file, folder)
        (folder / "node_modules").symlink_to(SOURCE / "node_modules")
        with Daemon(sys.argv[1], "--store", "sqlite", "--state-dir", str(folder / "state")) as daemon:
            (folder / "openapi.json").write_bytes(ask(daemon.port, "GET", "/openapi.json").body)
            problems = json.loads(run(folder, "redocly", "lint", "openapi.json", "--format=json"))["problems"]
            listed = [(problem["location"][0].get("pointer"), problem["message"]) for problem in problems]
            expect(not problems, f"Redocly finds {listed}")
            run(folder, "openapi-typescript", "openapi.json", "-o", "api.ts")
            run(folder, "tsc", "-p", ".")
            url = f"http://127.0.0.1:{daemon.port}"
            done = subprocess.run(["node", "use.js", url], cwd=folder, capture_output=True, text=True, timeout=300)
            expect(done.returncode == 0, f"the program with openapi-fetch: {done.stderr[-2000:]}")
    print("Redocly has no warnings; the types compile, and the program that uses them works")
    return 0


if __name__ == "__main__":
    sys.exit(main())
