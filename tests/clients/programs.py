"""The clients in other languages than Python: programs/README.md describes them."""

import collections
import os
import pathlib
import shutil
import subprocess

FOLDER = pathlib.Path(__file__).resolve().parent / "programs"
# A name, the program that must be there, the command that makes the client ready, and the client's command.
QUICK = [("Node", "node", None, ["node", "{source}/client.mjs"]),
         ("Perl", "perl", None, ["perl", "{source}/client.pl"]),
         ("Ruby", "ruby", None, ["ruby", "{source}/client.rb"]),
         ("PHP", "php", None, ["php", "{source}/client.php"])]
# Their compilers take longer than the short form of the test.
COMPILED = [("Go", "go", ["go", "build", "-o", "{built}/client-in-go", "{source}/client.go"], ["{built}/client-in-go"]),
            ("Java", "javac", ["javac", "-d", "{built}", "{source}/Client.java"], ["java", "-cp", "{built}", "Client"])]

Line = collections.namedtuple("Line", "client status rest")


def make_ready(is_full, folder):
    """The commands of the clients that are there, by name; names the others. The folder takes what is compiled."""
    commands = {}
    for name, program, prepare, command in QUICK + COMPILED if is_full else QUICK:
        def fill(words):
            return [word.format(source=FOLDER, built=folder) for word in words]
        if not shutil.which(program):
            print(f"SKIPPED: there is no {program} for the client in {name}")
            continue
        if prepare:
            cache = {"GOCACHE": str(folder / "cache"), "GO111MODULE": "off"}
            subprocess.run(fill(prepare), check=True, env={**os.environ, **cache})
        commands[name] = fill(command)
    if not is_full:
        print("SKIPPED: the clients in Go and Java are part of --full")
    return commands


def run(command, *arguments, timeout):
    """The lines that the client prints, one a request."""
    done = subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, timeout=timeout)
    if done.returncode != 0:
        raise AssertionError(f"{command} failed: {done.stderr[-1000:]}")
    lines = done.stdout.splitlines()
    for line in lines:
        if line.startswith("SKIPPED") and arguments[0] == "upload":
            print(line)
    return [Line(*line.split(" | ", 2)) for line in lines if not line.startswith("SKIPPED")]
