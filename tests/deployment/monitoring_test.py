"""docker/monitoring, by Prometheus itself: monitoring_test.py REMESHD

promtool reads the files. A daemon with keys then does and refuses all that is counted, Prometheus scrapes it by the jobs of
prometheus.yaml, and every query of the rules and of the dashboard is asked there. Exit code 77: there is no Prometheus.
"""

import contextlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "jobs"))

# pylint: disable=wrong-import-position
from daemons import ENDLESS, FINAL, QUICK, SQUARE, Daemon, ask, free_port, wait_for

FILES = ROOT / "docker" / "monitoring"
KEYS = {"scraper": "scraper-0123456789", "user": "user-0123456789abc"}
# Labels that Prometheus gives, and the one of buckets.
OF_PROMETHEUS = {"job", "instance", "le"}


def expect(condition, text):
    if not condition:
        sys.exit(f"FAILED: {text}")


def program(name):
    unpacked = ROOT / "build" / "unpacked" / "usr" / "bin" / name
    return shutil.which(name) or (str(unpacked) if unpacked.exists() else None)


def replaced(text, old, new):
    expect(text.count(old) == 1, f"prometheus.yaml has {old!r} {text.count(old)} times")
    return text.replace(old, new)


def configuration(folder, ops_port, port):
    """prometheus.yaml as it is, but for addresses and times."""
    text = (FILES / "prometheus.yaml").read_text(encoding="utf-8")
    text, count = re.subn(r"dns_sd_configs:\n(      .*\n)+", f"static_configs:\n      - targets: ['127.0.0.1:{ops_port}']\n", text)
    expect(count == 1, "prometheus.yaml has no dns_sd_configs")
    text = replaced(text, "scheme: https", "scheme: http")
    text = replaced(text, "mesh.example.org", f"127.0.0.1:{port}")
    text = replaced(text, "scrape_interval: 15s", "scrape_interval: 1s")
    (folder / "prometheus.yaml").write_text(text, encoding="utf-8")
    shutil.copy(FILES / "alerts.yaml", folder)
    (folder / "remeshd-key").write_text(KEYS["scraper"], encoding="ascii")
    return str(folder / "prometheus.yaml")


def provoke(daemon, folder):
    """All that is counted, but what happens to nobody: errors of ours and lines of the log that are lost."""
    key = {"X-API-Key": KEYS["user"]}
    expect(ask(daemon.port, "POST", f"/v1/remesh?{QUICK}", SQUARE, key).status == 200, "a request")
    expect(ask(daemon.port, "POST", f"/v1/remesh?{QUICK}", SQUARE).status == 401, "a request without a key")
    jobs = [ask(daemon.port, "POST", f"/v1/jobs?{QUICK}", mesh, key).json()["id"] for mesh in (SQUARE, b"v 0 0\n")]
    for job in jobs:
        wait_for(lambda: ask(daemon.port, "GET", f"/v1/jobs/{job}", fields=key).json()["state"] in FINAL)  # pylint: disable=cell-var-from-loop
    import sqlite3  # pylint: disable=import-outside-toplevel
    with contextlib.closing(sqlite3.connect(folder / "jobs.sqlite", isolation_level=None)) as database:
        database.execute("BEGIN IMMEDIATE")
        wait_for(lambda: ask(daemon.port, "POST", f"/v1/jobs?{QUICK}", SQUARE, key).status == 503)
    wait_for(lambda: ask(daemon.port, "POST", f"/v1/remesh?{QUICK}", SQUARE, key).status == 429)


def get(port, path, **query):
    url = f"http://127.0.0.1:{port}/api/v1/{path}?{urllib.parse.urlencode(query)}"
    try:
        with urllib.request.urlopen(url, timeout=10) as answer:
            return json.load(answer)["data"]
    except urllib.error.HTTPError as error:
        sys.exit(f"FAILED: {query}: {error.read().decode()}")


def queries_of_dashboard():
    dashboard = json.loads((FILES / "dashboard.json").read_text(encoding="utf-8"))
    taken, ids, queries = set(), set(), []
    for panel in dashboard["panels"]:
        place = panel["gridPos"]
        cells = {(x, y) for x in range(place["x"], place["x"] + place["w"]) for y in range(place["y"], place["y"] + place["h"])}
        expect(not cells & taken and place["x"] + place["w"] <= 24, f"the panel {panel['title']} lies upon another one")
        expect(panel["id"] not in ids, f"the panel {panel['title']} has the number of another one")
        taken |= cells
        ids.add(panel["id"])
        queries += [target["expr"].replace("$__rate_interval", "10s") for target in panel.get("targets", [])]
    return queries


def labels_asked(query):
    """Output: the names of metrics, each with the labels that its selector names, and the labels of all `by (...)`."""
    names = [(name, set(re.findall(r"(\w+)\s*(?:=~|!=|!~|=)\s*\"", matchers)))
             for name, matchers in re.findall(r"\b((?:remeshd|process)_\w+|up)\b(?:\{([^}]*)\})?", query)]
    by = {label for group in re.findall(r"\bby \(([^)]*)\)", query) for label in group.replace(" ", "").split(",")}
    return names, by


def check_queries(port):
    rules = [rule["query"] for group in get(port, "rules")["groups"] for rule in group["rules"]]
    expect(len(rules) >= 10, f"{len(rules)} rules")
    shown = queries_of_dashboard()
    known = {}
    for series in get(port, "series", **{"match[]": '{job=~"remeshd.*"}'}):
        known.setdefault(series["__name__"], set()).update(series)
    for query in rules + shown:
        names, by = labels_asked(query)
        expect(names, f"no metric in {query}")
        for name, labels in names:
            expect(name in known, f"the daemon has no {name}: {query}")
            expect(labels <= known[name] | OF_PROMETHEUS, f"{name} has no label of {labels - known[name]}: {query}")
            expect(by <= known[name] | OF_PROMETHEUS, f"{name} has no label of {by - known[name]}: {query}")
        get(port, "query", query=query)
    # The rates of what was just counted are there once it was scraped twice.
    for query in shown:
        wait_for(lambda: get(port, "query", query=query)["result"])  # pylint: disable=cell-var-from-loop
    keys = {series["metric"]["key"] for series in get(port, "query", query="remeshd_key_requests_total")["result"]}
    expect(keys == set(KEYS), f"the keys are told as {keys}")
    return len(rules), len(shown)


def main():
    promtool, prometheus = program("promtool"), program("prometheus")
    if not promtool or not prometheus:
        print("SKIPPED: there is no Prometheus (Debian: prometheus)")
        return 77
    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        shutil.copytree(FILES, folder / "as-it-is")
        (folder / "as-it-is" / "remeshd-key").touch()
        subprocess.run([promtool, "check", "config", folder / "as-it-is" / "prometheus.yaml"], check=True)
        subprocess.run([promtool, "test", "rules", ROOT / "tests" / "deployment" / "alerts_test.yaml"], check=True)

        (folder / "keys").write_text("".join(f"{name} {key}\n" for name, key in KEYS.items()), encoding="ascii")
        ops_port = free_port()
        daemon = Daemon(os.path.abspath(sys.argv[1]),
                        ["--store", "sqlite", "--state-dir", str(folder), "--api-key-file", str(folder / "keys"), "--ops-bind",
                         f"127.0.0.1:{ops_port}", "--job-lease", "1s", "--store-timeout", "1s", "--max-rate-per-key", "20"])
        stack.callback(lambda: daemon.kill())  # pylint: disable=unnecessary-lambda
        # A worker dies, and the next daemon takes its job over.
        daemon.start()
        key = {"X-API-Key": KEYS["user"]}
        job = ask(daemon.port, "POST", f"/v1/jobs?{ENDLESS}", SQUARE, key).json()["id"]
        wait_for(lambda: ask(daemon.port, "GET", f"/v1/jobs/{job}", fields=key).json()["state"] == "running")
        daemon.kill()
        daemon.start()
        port = free_port()
        command = [prometheus, f"--config.file={configuration(folder, ops_port, daemon.port)}", f"--storage.tsdb.path={folder}/data",
                   f"--web.listen-address=127.0.0.1:{port}", "--log.level=warn"]
        server = subprocess.Popen(command)
        stack.callback(lambda: (server.terminate(), server.wait()))
        wait_for(lambda: ask(daemon.port, "GET", f"/v1/jobs/{job}", fields=key).json()["attempts"] == 2)
        expect(ask(daemon.port, "DELETE", f"/v1/jobs/{job}", fields=key).status == 204, "DELETE")
        provoke(daemon, folder)
        with contextlib.suppress(OSError):
            wait_for(lambda: server.poll() is not None or is_answering(port))
        expect(server.poll() is None, "prometheus does not start")
        wait_for(lambda: [one["value"][1] for one in get(port, "query", query="up")["result"]] == ["1", "1"])
        wait_for(lambda: get(port, "query", query='remeshd_key_requests_total{code="429"}')["result"])
        rules, shown = check_queries(port)
        print(f"{rules} rules and {shown} queries of the dashboard: nothing wrong")
    return 0


def is_answering(port):
    with contextlib.suppress(OSError), urllib.request.urlopen(f"http://127.0.0.1:{port}/-/ready", timeout=1) as answer:
        return answer.status == 200
    return False


if __name__ == "__main__":
    sys.exit(main())
