"""The configurations of nginx and Caddy in server/README.md, before a real remeshd: proxies_test.py REMESHD

Exit code 77: neither of the two is there (`./dev setup` unpacks them).
"""

import contextlib
import pathlib
import re
import socket
import sys
import tempfile

from daemons import ENDLESS, ROOT, SQUARE, Daemon, ask, caddy, expect, find_program, nginx, wait_until

CLIENT = "127.0.0.2"  # not the address of the proxies


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


def check_nginx(program, folder):
    flags = ("--trusted-proxies", "127.0.0.1", "--allowed-hosts", "mesh.example.org", "--store", "sqlite", "--state-dir",
             str(folder / "state"))
    with Daemon(program, *flags) as daemon:
        text = documented("nginx").replace("127.0.0.1:8080", f"127.0.0.1:{daemon.port}").replace("listen 80;", "listen PORT;")
        with nginx(text, folder) as proxy:
            host = f"mesh.example.org:{proxy.port}"
            check(daemon, proxy.port, host, "", f"http://{host}")
            expect(ask(daemon.port, "GET", "/metrics", headers={"Host": "other.example.org"}).status == 421,
                   "another name is answered")


def check_caddy(program, folder):
    flags = ("--trusted-proxies", "127.0.0.1", "--public-url", "https://example.org/mesh", "--store", "sqlite", "--state-dir",
             str(folder / "state"))
    with Daemon(program, *flags) as daemon:
        text = documented("caddy").replace("127.0.0.1:8080", f"127.0.0.1:{daemon.port}")
        with caddy(text.replace("example.org {", "http://example.org:PORT {"), folder) as proxy:
            check(daemon, proxy.port, "example.org", "/mesh", "https://example.org")
            moved = ask(proxy.port, "GET", "/mesh", headers={"Host": "example.org"})
            expect(moved.headers.get("location") == "/mesh/", f"/mesh is {moved.status}")
            contract = ask(proxy.port, "GET", "/mesh/openapi.json", headers={"Host": "example.org"}).json()
            expect(contract["servers"] == [{"url": "https://example.org/mesh"}], f"servers: {contract['servers']}")


def main():
    missing = 0
    for name, check_one in (("nginx", check_nginx), ("caddy", check_caddy)):
        if not find_program(name):
            print(f"SKIPPED: there is no {name} (./dev setup unpacks one)")
            missing += 1
            continue
        with tempfile.TemporaryDirectory() as folder:
            check_one(sys.argv[1], pathlib.Path(folder))
        print(f"{name}: as documented")
    return 77 if missing == 2 else 0


if __name__ == "__main__":
    sys.exit(main())
