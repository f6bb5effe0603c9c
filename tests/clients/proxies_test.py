"""The configurations of nginx and Caddy in server/README.md, before a real remeshd: proxies_test.py REMESHD [--full]

--full adds ten minutes of bursts by 300 clients, for which both proxies keep their connections as long as is their default.
Exit code 77: neither of the two is there (`./dev setup` unpacks them).
"""

import collections
import concurrent.futures
import contextlib
import http.client
import itertools
import pathlib
import random
import re
import socket
import sys
import tempfile
import threading
import time

from daemons import ENDLESS, PATIENCE, ROOT, SQUARE, Daemon, ask, caddy, expect, find_program, nginx, wait_until

CLIENT = "127.0.0.2"  # not the address of the proxies
FULL = "--full" in sys.argv
LIMITED_CLIENTS = 200 if FULL else 20
# A body of which a proxy passes on the first part before it has the rest: Caddy collects 4 KB.
PADDED = b"# A line that means nothing.\n" * 1000 + SQUARE
FIRST_PART = 20_000
FORGED = {"X-Forwarded-For": "9.9.9.9", "Forwarded": "for=9.9.9.9", "X-Real-IP": "9.9.9.9"}
BURST_CLIENTS = 300
BURST_SECONDS = 600


def documented(language):
    """The configuration in the README."""
    text = (ROOT / "server" / "README.md").read_text(encoding="utf-8")
    return re.search(rf"```{language}\n(.*?)```", text, re.DOTALL).group(1)


def start_endless(port, host, path, request_id):
    """A connection whose request computes."""
    connection = socket.create_connection(("127.0.0.1", port), source_address=(CLIENT, 0))
    connection.sendall(f"POST {path}?{ENDLESS} HTTP/1.1\r\nHost: {host}\r\nX-Request-Id: {request_id}\r\n"
                       f"X-Forwarded-For: 9.9.9.9\r\nContent-Length: {len(SQUARE)}\r\n\r\n".encode() + SQUARE)
    return connection


def check_page(port, host, prefix):
    page = ask(port, "GET", prefix + "/", headers={"Host": host})
    expect(page.status == 200, f"the page: {page.status} {page.body[:200]}")
    files = re.findall(r'(?:src|href)="([^"#]+)"', page.body.decode())
    expect(files or b"no page" in page.body or len(page.body) < 2000, "the page names no files")
    for file in files:
        expect(not file.startswith(("/", "http")), f"the page has the absolute link {file}")
        answer = ask(port, "GET", f"{prefix}/{file}", headers={"Host": host})
        expect(answer.status == 200, f"{file} of the page: {answer.status}")


def check_sites(port, host, prefix, origin):
    headers = {"Host": host, "Origin": origin}
    answer = ask(port, "POST", prefix + "/v1/remesh", SQUARE, headers)
    expect(answer.status == 200, f"the page's own request: {answer.status} {answer.body[:300]}")
    answer = ask(port, "POST", prefix + "/v1/remesh", SQUARE, {**headers, "Origin": "https://evil.example"})
    expect(answer.status == 403, f"the request of another site's page: {answer.status}")


def check_stream_and_leaving(daemon, port, host, prefix):
    """Events come while the request runs, its client is known, and its work stops when the client leaves."""
    request_id = "proxies-test-0123456789"
    running = start_endless(port, host, prefix + "/v1/remesh", request_id)
    path = f"/v1/requests/{request_id}"
    wait_until(lambda: ask(daemon.port, "GET", path).status == 200, "the request runs")
    with contextlib.closing(socket.create_connection(("127.0.0.1", port), timeout=60)) as events:
        events.sendall(f"GET {prefix}{path}/events HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        received = b""
        while received.count(b"event: progress") < 2:
            piece = events.recv(65536)
            expect(piece, f"the stream ends early: {received[:300]}")
            received += piece
    expect(ask(daemon.port, "GET", path).status == 200, "the events came only when the request had ended")
    running.close()
    seconds = wait_until(lambda: ask(daemon.port, "GET", path).status == 404, "the work of a client that left stops")
    print(f"the work stopped {seconds:.2f} s after its client had left")

    def line():
        return next((line for line in daemon.log if line.get("id") == request_id), None)
    wait_until(line, "the request is in the log")
    expect(line().get("client") == CLIENT, f"the client in the log is wrong: {line()}")


def check_job(port, host, prefix):
    job = ask(port, "POST", prefix + "/v1/jobs", SQUARE, {"Host": host})
    expect(job.status == 202, f"a job: {job.status} {job.body[:200]}")
    links = job.json()["links"]
    expect(job.headers["location"] == links["self"], f"Location is {job.headers['location']}, self is {links['self']}")
    expect(links["self"].startswith(prefix + "/v1/jobs/"), f"the link {links['self']} lacks the prefix {prefix}")
    wait_until(lambda: ask(port, "GET", links["self"], headers={"Host": host}).json()["state"] == "succeeded", "the job ends")
    answer = ask(port, "GET", links["events"], headers={"Host": host})
    expect(f'"self":"{links["self"]}"'.encode() in answer.body, f"the links of events differ: {answer.body[:300]}")
    expect(ask(port, "GET", links["result"], headers={"Host": host}).status == 200, "the link of the result is wrong")


def check(daemon, port, host, prefix, origin):
    check_page(port, host, prefix)
    check_sites(port, host, prefix, origin)
    check_job(port, host, prefix)
    check_stream_and_leaving(daemon, port, host, prefix)


def start_nginx(daemon, folder):
    text = documented("nginx").replace("127.0.0.1:8080", f"127.0.0.1:{daemon.port}")
    return nginx(text.replace("listen 80;", "listen PORT;"), folder)


def start_caddy(daemon, folder):
    text = documented("caddy").replace("127.0.0.1:8080", f"127.0.0.1:{daemon.port}")
    return caddy(text.replace("example.org {", "http://example.org:PORT {"), folder)


# How each proxy starts, the name that the daemon has there, and the prefix.
PROXIES = {"nginx": (start_nginx, "mesh.example.org", ""), "caddy": (start_caddy, "example.org", "/mesh")}


def client_address(number):
    """An address of this machine for each client."""
    return f"127.1.{number // 200}.{number % 200 + 1}"


def start_half(port, host, path, source):
    """A connection whose upload has begun, so that it counts."""
    connection = socket.create_connection(("127.0.0.1", port), source_address=(source, 0))
    head = f"POST {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {len(PADDED)}\r\n\r\n"
    connection.sendall(head.encode() + PADDED[:FIRST_PART])
    return connection


def connections_of(daemon, sources=itertools.count(1)):
    """Asks from another address each time, since the last connection may still count."""
    text = ask(daemon.port, "GET", "/metrics", source=f"127.2.{next(sources) % 250}.1").body.decode()
    return int(re.search(r"^remeshd_http_connections (\d+)", text, re.MULTILINE).group(1))


def check_limits(program, name, folder):
    """Clients behind one proxy are limited one by one, and a forged header changes nothing."""
    start, host, prefix = PROXIES[name]
    path = prefix + "/v1/remesh"
    flags = ("--trusted-proxies", "127.0.0.1", "--allowed-hosts", "*", "--max-connections-per-address", "1",
             "--max-connections", "1024", "--min-body-rate", "1")
    forged = {"Host": host, **FORGED}
    with Daemon(program, *flags) as daemon, start(daemon, folder) as proxy, contextlib.ExitStack() as open_ones:
        clients = [client_address(number) for number in range(LIMITED_CLIENTS)]
        # Each client has its own limit, although all come from the proxy's address.
        # Not all at once, since Caddy gives up a connection that takes three seconds, as it may on a busy machine.
        halves = []
        for client in clients:
            halves.append(open_ones.enter_context(start_half(proxy.port, host, path, client)))
            if len(halves) % 20 == 0:
                wait_until(lambda: connections_of(daemon) > len(halves), "the uploads have begun")
        for client in clients:
            for headers in ({"Host": host}, forged):
                status = ask(proxy.port, "POST", path, SQUARE, headers, client).status
                expect(status == 429, f"{name}: the second request of {client} with {headers} was answered with {status}")
        status = ask(proxy.port, "POST", path, SQUARE, {"Host": host}, "127.0.0.4").status
        expect(status == 200, f"{name}: the request of a client that has no other was answered with {status}")
        for half in halves:
            half.sendall(PADDED[FIRST_PART:])
        statuses = collections.Counter(half.recv(12).decode() for half in halves)
        expect(statuses == {"HTTP/1.1 200": LIMITED_CLIENTS}, f"{name}: the first requests got {statuses}")
    print(f"{name}: {LIMITED_CLIENTS} clients are limited one by one")


def check_stranger(program):
    """The header of a client that is no trusted proxy changes nothing."""
    with Daemon(program, "--trusted-proxies", "127.0.0.1", "--max-connections-per-address", "1") as daemon:
        with start_half(daemon.port, "localhost", "/v1/remesh", CLIENT):
            wait_until(lambda: connections_of(daemon) == 2, "the upload has begun")
            for headers in ({}, FORGED):
                status = ask(daemon.port, "POST", "/v1/remesh", SQUARE, headers, CLIENT).status
                expect(status == 429, f"a stranger's second request with {headers} was answered with {status}")


def check_bursts(program, name, folder):
    """No request fails after pauses of any length, in which connections between the proxy and the daemon are idle."""
    start, host, prefix = PROXIES[name]
    draw = random.Random(1)
    moments, moment = [], 0
    while moment < BURST_SECONDS:
        moments.append(moment)
        moment += draw.uniform(1, 10)
    statuses = collections.Counter()
    lock = threading.Lock()
    began = time.monotonic() + 2

    def use(port, number):
        source = (client_address(number), 0)
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE, source_address=source)
        with contextlib.closing(connection):
            for moment in moments:
                time.sleep(max(0, began + moment - time.monotonic()))
                try:
                    connection.request("POST", prefix + "/v1/remesh?refine=false", SQUARE, {"Host": host})
                    answer = connection.getresponse()
                    answer.read()
                    status = answer.status
                except (OSError, http.client.HTTPException) as error:
                    status = repr(error)
                    connection.close()
                with lock:
                    statuses[status] += 1

    flags = ("--trusted-proxies", "127.0.0.1", "--allowed-hosts", "*", "--max-connections", "1024")
    with Daemon(program, *flags) as daemon, start(daemon, folder) as proxy:
        with concurrent.futures.ThreadPoolExecutor(BURST_CLIENTS) as threads:
            for done in [threads.submit(use, proxy.port, number) for number in range(BURST_CLIENTS)]:
                done.result()
    print(f"{name}: {len(moments)} bursts of {BURST_CLIENTS} clients were answered with {dict(statuses)}", flush=True)
    expect(set(statuses) == {200}, f"{name}: bursts were answered with {dict(statuses)}")


def check_nginx(program, folder):
    flags = ("--trusted-proxies", "127.0.0.1", "--allowed-hosts", "mesh.example.org", "--store", "sqlite", "--state-dir",
             str(folder / "state"))
    with Daemon(program, *flags) as daemon:
        with start_nginx(daemon, folder) as proxy:
            host = f"mesh.example.org:{proxy.port}"
            check(daemon, proxy.port, host, "", f"http://{host}")
            expect(ask(daemon.port, "GET", "/metrics", headers={"Host": "other.example.org"}).status == 421,
                   "another name is answered")


def check_caddy(program, folder):
    flags = ("--trusted-proxies", "127.0.0.1", "--public-url", "https://example.org/mesh", "--store", "sqlite", "--state-dir",
             str(folder / "state"))
    with Daemon(program, *flags) as daemon:
        with start_caddy(daemon, folder) as proxy:
            check(daemon, proxy.port, "example.org", "/mesh", "https://example.org")
            moved = ask(proxy.port, "GET", "/mesh", headers={"Host": "example.org"})
            expect(moved.headers.get("location") == "/mesh/", f"/mesh is {moved.status}")
            contract = ask(proxy.port, "GET", "/mesh/openapi.json", headers={"Host": "example.org"}).json()
            expect(contract["servers"] == [{"url": "https://example.org/mesh"}], f"servers: {contract['servers']}")


def main():
    # Hundreds of threads that wait for the interpreter would otherwise wake up two hundred times a second each.
    sys.setswitchinterval(0.5)
    check_stranger(sys.argv[1])
    missing = 0
    for name, check_one in (("nginx", check_nginx), ("caddy", check_caddy)):
        if not find_program(name):
            print(f"SKIPPED: there is no {name} (./dev setup unpacks one)")
            missing += 1
            continue
        with tempfile.TemporaryDirectory() as folder:
            check_one(sys.argv[1], pathlib.Path(folder))
        print(f"{name}: as documented")
        with tempfile.TemporaryDirectory() as folder:
            check_limits(sys.argv[1], name, pathlib.Path(folder))
    if FULL:
        with contextlib.ExitStack() as open_ones, concurrent.futures.ThreadPoolExecutor(2) as threads:
            folders = {name: open_ones.enter_context(tempfile.TemporaryDirectory()) for name in PROXIES if find_program(name)}
            bursts = [threads.submit(check_bursts, sys.argv[1], name, pathlib.Path(folder)) for name, folder in folders.items()]
            for done in bursts:
                done.result()
    return 77 if missing == 2 else 0


if __name__ == "__main__":
    sys.exit(main())
