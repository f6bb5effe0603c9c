"""Holds a running remeshd against the contract that it serves: contract_test.py REMESHD

Every operation and every status that openapi.json names is provoked, every example is sent or validated, and every answer
must be one that the document describes: its status, its type, its headers, its body (JSON Schema 2020-12).
Exit code 77: python3-jsonschema is not there.
"""

import contextlib
import functools
import json
import math
import pathlib
import re
import signal
import socket
import sys
import tempfile
import time

try:
    from jsonschema import Draft202012Validator, RefResolver
except ImportError:
    print("SKIPPED: python3-jsonschema is not installed")
    sys.exit(77)

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import remeshd  # noqa: E402
import requests_as_written  # noqa: E402

KEY = "contract-test-key-0123456789"
PATIENCE = 120  # seconds for what must happen; long, so that a busy machine is not mistaken for a fault
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
# More work than any test here waits for.
ENDLESS = "max_edge_length=0.0003"


class Answer:
    def __init__(self, raw):
        head, _, self.body = raw.partition(b"\r\n\r\n")
        lines = head.decode("latin-1").split("\r\n")
        self.status = int(lines[0].split()[1]) if lines[0].startswith("HTTP/1.1 ") else 0
        self.headers = {name.lower(): value for name, _, value in (line.partition(": ") for line in lines[1:])}


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)


def wait_until(condition, what):
    """Waits for what must happen."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"this did not happen within {PATIENCE} s: {what}")
        time.sleep(0.01)


def receive(connection):
    raw = b""
    while True:
        piece = connection.recv(65536)
        if not piece:
            return Answer(raw)
        raw += piece


def request_bytes(method, target, body=None, fields=None):
    lines = [f"{method} {target} HTTP/1.1", "Host: localhost", "Connection: close"]
    lines += [f"{name}: {value}" for name, value in (fields or {}).items()]
    if body is not None:
        lines.append(f"Content-Length: {len(body)}")
    return "\r\n".join(lines).encode() + b"\r\n\r\n" + (body or b"")


def ask(port, method, target, body=None, fields=None):
    with contextlib.closing(connect(port)) as connection:
        connection.sendall(request_bytes(method, target, body, fields))
        return receive(connection)


class Daemon(remeshd.Daemon):
    def start_endless(self, request_id, body=SQUARE):
        """A connection whose request computes."""
        connection = connect(self.port)
        connection.sendall(request_bytes("POST", f"/v1/remesh?{ENDLESS}", body, {"X-Request-Id": request_id}))

        def computes():
            answer = ask(self.port, "GET", f"/v1/requests/{request_id}")
            return answer.status == 200 and json.loads(answer.body)["stage"] != "queued"

        wait_until(computes, "the request starts")
        return connection

    def drain(self):
        """Tells it to stop, and returns once it does."""
        self.process.send_signal(signal.SIGTERM)
        wait_until(lambda: ask(self.port, "GET", "/readyz").status == 503, "the daemon drains")


class Contract:
    def __init__(self, document):
        self.document = document
        self.resolver = RefResolver("", document)
        self.seen = set()
        self.failures = []
        self.operations = {}
        for path, item in document["paths"].items():
            for method in ("get", "post", "put", "patch", "delete"):
                if method in item:
                    self.operations[item[method]["operationId"]] = (method.upper(), path, item[method])

    def fail(self, text):
        self.failures.append(text)
        print("FAILED:", text)

    def resolve(self, node):
        while "$ref" in node:
            node = self.resolver.resolve(node["$ref"])[1]
        return node

    def validate(self, value, schema, what):
        for error in Draft202012Validator(schema, resolver=self.resolver).iter_errors(value):
            self.fail(f"{what}: {'/'.join(map(str, error.absolute_path))}: {error.message[:200]}")

    def check(self, operation, answer, status, what=""):
        """An answer has the status expected, and is one that the operation describes."""
        method, path, described = self.operations[operation]
        what = f"{method} {path} {status} {what}"
        if answer.status != status:
            self.fail(f"{what}: got {answer.status} {answer.body[:300]}")
            return
        self.seen.add((operation, str(status)))
        if str(status) not in described["responses"]:
            self.fail(f"{what}: the status is not in the document")
            return
        response = self.resolve(described["responses"][str(status)])
        for name, header in response.get("headers", {}).items():
            value = answer.headers.get(name.lower())
            if value is not None:
                self.validate(value, self.resolve(header)["schema"], f"{what}: header {name}")
            elif name != "Content-Disposition":
                self.fail(f"{what}: no header {name}")
        content = response.get("content", {})
        if not content:
            return
        kind = answer.headers.get("content-type", "").split(";")[0]
        if kind not in content:
            self.fail(f"{what}: the type {kind} is not in the document")
        elif kind.endswith("json"):
            value = json.loads(answer.body)
            self.validate(value, content[kind].get("schema", {}), what)
            if kind == "application/problem+json" and value["status"] != status:
                self.fail(f"{what}: the problem says {value['status']}")

    def check_examples(self, node, place=""):
        """Each example in the document is what its own schema describes."""
        if isinstance(node, list):
            for i, item in enumerate(node):
                self.check_examples(item, f"{place}/{i}")
            return
        if not isinstance(node, dict):
            return
        if "schema" in node and isinstance(node["schema"], dict):
            if "example" in node:
                self.validate(node["example"], node["schema"], f"example at {place}")
            for name, example in node.get("examples", {}).items():
                self.validate(example["value"], node["schema"], f"example {name} at {place}")
        for name, item in node.items():
            if name not in ("example", "examples"):
                self.check_examples(item, f"{place}/{name}")

    def check_all_seen(self):
        for operation, (method, path, described) in self.operations.items():
            for status in described["responses"]:
                if status != "default" and (operation, status) not in self.seen:
                    self.fail(f"{method} {path}: status {status} was not provoked")


def check_parameters(contract):
    """Every example of a parameter, one at a time, is taken."""
    for parameter in contract.document["components"]["parameters"].values():
        if parameter["in"] == "query" and "example" in parameter:
            value = parameter["example"]
            text = json.dumps(value) if isinstance(value, bool) else str(value)
            needed = "repair=%2Bholes&" if parameter["name"] == "max_hole_edges" else ""
            yield f"{needed}{parameter['name']}={text}"


def check_options(contract, daemon):
    """What the schema of a body lets in, the daemon takes, and what it does not let in, is refused."""
    body = Draft202012Validator(contract.document["components"]["schemas"]["MeshWithOptions"], resolver=contract.resolver)
    square = {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "faces": [[0, 1, 2, 3]]}
    cases = [{"mesh": {**square, "faces": [[0, 1.0, second, 3]]}} for second in (2.0, 2.5, "2", -1)]
    for option in contract.document["components"]["schemas"]["Options"]["properties"]:
        values = [None, True, {}, -1, 0, 1, 1.5, 2.0, 100, "1", "x", "auto", "none", [], ["x"], [1, 0]]
        if option in ("repair", "barriers", "reference_axis"):  # of their words the schema knows the type only
            values = [value for value in values if not isinstance(value, (str, list))]
        needed = {"repair": "+holes"} if option == "max_hole_edges" else {}
        cases += [{"mesh": square, "options": {**needed, option: value}} for value in values]
    for case in cases:
        answer = ask(daemon.port, "POST", "/v1/remesh", json.dumps(case).encode(), {"Content-Type": "application/json"})
        code = json.loads(answer.body).get("code")
        if body.is_valid(case) == (code in ("invalid_option", "invalid_mesh", "index_out_of_range")):
            contract.fail(f"{json.dumps(case)} is {'' if body.is_valid(case) else 'not '}valid, but {answer.body[:200]}")


def turned(outline, steps=24):
    """A mesh of quads: an outline of (radius, height) that turns around the z axis."""
    vertices = [[radius * math.cos(2 * math.pi * i / steps), radius * math.sin(2 * math.pi * i / steps), height]
                for radius, height in outline for i in range(steps)]
    faces = [[row * steps + i, row * steps + (i + 1) % steps, (row + 1) * steps + (i + 1) % steps, (row + 1) * steps + i]
             for row in range(len(outline) - 1) for i in range(steps)]
    return {"vertices": vertices, "faces": faces}


def curved_parts():
    """One mesh for each kind of surface."""
    turns = [2 * math.pi * i / 24 for i in range(25)]
    wavy = turned([(3 + 0.1 * i, 0.4 * i) for i in range(8)])
    for i, vertex in enumerate(wavy["vertices"]):
        vertex[2] += 0.05 * math.sin(7 * i)
    return {
        "plane": turned([(2, 0), (1, 0)]),
        "cylinder": turned([(2, 0), (2, 3)]),
        "cone": turned([(2, 0), (1, 3)]),
        "sphere": turned([(2 * math.cos(a), 2 * math.sin(a)) for a in turns[-5:-1] + turns[:6]]),
        "torus": turned([(5 + math.cos(a), math.sin(a)) for a in turns]),
        "free": wavy,
    }


def check_plain(contract, daemon):
    port = daemon.port
    for operation, path in (("getCapabilities", "/v1/capabilities"), ("getOpenapi", "/openapi.json"),
                            ("getMetrics", "/metrics"), ("isLive", "/livez"), ("isReady", "/readyz")):
        contract.check(operation, ask(port, "GET", path), 200)
    for operation in ("remesh", "analyze"):
        target = contract.operations[operation][1]
        body = contract.resolve(contract.operations[operation][2]["requestBody"])
        for kind, media in body["content"].items():
            examples = {name: example["value"] for name, example in media.get("examples", {}).items()}
            if "example" in media:
                examples["the example"] = media["example"]
            for name, value in examples.items():
                sent = value.encode() if isinstance(value, str) else json.dumps(value).encode()
                contract.check(operation, ask(port, "POST", target, sent, {"Content-Type": kind}), 200, f"{kind} {name}")
        form = (b"--b\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a.obj\"\r\n\r\n" + SQUARE +
                b"\r\n--b\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{\"refine\": false}\r\n--b--\r\n")
        form_type = {"Content-Type": "multipart/form-data; boundary=b"}
        contract.check(operation, ask(port, "POST", target, form, form_type), 200, "form")
        for name, mesh in curved_parts().items():
            answer = ask(port, "POST", target, json.dumps(mesh).encode(), {"Content-Type": "application/json"})
            contract.check(operation, answer, 200, name)
            kinds = {surface["kind"] for surface in json.loads(answer.body)["report"]["surfaces"]}
            if name not in kinds:
                contract.fail(f"{target}: no {name} among {kinds}")
        for option in check_parameters(contract):
            contract.check(operation, ask(port, "POST", f"{target}?{option}", SQUARE), 200, option)
        contract.check(operation, ask(port, "POST", f"{target}?refin=true", SQUARE), 400, "unknown option")
        contract.check(operation, ask(port, "POST", target, b"{\"mesh\":", {"Content-Type": "application/json"}), 400,
                       "half a document")
        contract.check(operation, ask(port, "POST", target, SQUARE, {"Accept": "image/png"}), 406)
        contract.check(operation, ask(port, "POST", target), 411)
        contract.check(operation, ask(port, "POST", target, b"#" * 200_000), 413)
        contract.check(operation, ask(port, "POST", target, SQUARE, {"Content-Encoding": "br"}), 415)
        for mesh in (b"", SQUARE + b"f 1 2 9\n", SQUARE + b"v nan 0 0\n", SQUARE + b"v x\n"):
            contract.check(operation, ask(port, "POST", target, mesh), 422, str(mesh[-8:]))
        contract.check(operation, ask(port, "POST", target, SQUARE, {"A": "b" * 40_000}), 431)
        coding = request_bytes("POST", target, None, {"Transfer-Encoding": "gzip, chunked"})
        with contextlib.closing(connect(port)) as connection:
            connection.sendall(coding)
            contract.check(operation, receive(connection), 501)
    check_compare(contract, port)
    unknown = "/v1/requests/0123456789abcdef"
    contract.check("getRequest", ask(port, "GET", unknown), 404)
    contract.check("cancelRequest", ask(port, "DELETE", unknown), 404)
    contract.check("watchRequest", ask(port, "GET", unknown + "/events"), 404)


def check_requests_as_written(contract, daemon):
    """Whatever people write, the answer is a result, or an error that names the next step."""
    for written, query, fields, body, status, words in requests_as_written.ROWS:
        answer = ask(daemon.port, "POST", f"/v1/remesh{query}", body, fields)
        contract.check("remesh", answer, status, written)
        if answer.status >= 400 and (not words or words not in json.loads(answer.body)["detail"]):
            contract.fail(f"{written}: {answer.body.decode()} does not say {words}")
    for path in ("/remesh", "/api/v1/remesh", "/v1/remeshing"):
        answer = ask(daemon.port, "POST", path, SQUARE)
        if answer.status != 404 or "/openapi.json" not in json.loads(answer.body)["detail"]:
            contract.fail(f"POST {path}: {answer.status} {answer.body.decode()}")


def field_names(node):
    """Of the headers that the document describes: those that a client may send, those that it gets."""
    sent, received = set(), set()
    if isinstance(node, dict):
        if node.get("in") == "header":
            sent.add(node["name"].lower())
        if "description" in node and isinstance(node.get("headers"), dict):
            received |= {name.lower() for name in node["headers"]}
    for item in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        sent_there, received_there = field_names(item)
        sent |= sent_there
        received |= received_there
    return sent, received


def check_origins(contract, program):
    """A page of an origin that is let in may send every header of the document, and read every one."""
    sent, received = field_names(contract.document)
    received -= {"allow", "www-authenticate"}  # for programs: a page learns no more from them than from the status
    with Daemon(program, "--cors-origin", "https://tool.example") as daemon:
        fields = {"Origin": "https://tool.example", "Access-Control-Request-Method": "POST"}
        allowed = ask(daemon.port, "OPTIONS", "/v1/jobs", None, fields).headers["access-control-allow-headers"]
        exposed = ask(daemon.port, "POST", "/v1/remesh", SQUARE, fields).headers["access-control-expose-headers"]
    for names, header in ((sent, allowed), (received, exposed)):
        missing = names - set(header.lower().split(", "))
        if missing:
            contract.fail(f"pages of other origins do without {sorted(missing)}")


def check_keys(contract, daemon):
    for operation, (method, path, _) in contract.operations.items():
        if "401" not in contract.operations[operation][2]["responses"]:
            continue
        target = path.replace("{id}", "0123456789abcdef")
        body, kind = form_of(a=SQUARE, b=SQUARE) if operation == "compare" else (SQUARE, {})
        if method != "POST":
            body = None
        contract.check(operation, ask(daemon.port, method, target, body), 401)
        for fields in ({**kind, "X-API-Key": KEY}, {**kind, "Authorization": f"Bearer {KEY}"}):
            if ask(daemon.port, method, target, body, fields).status not in (200, 202, 404):
                contract.fail(f"{method} {path}: the key is not taken")


def check_running(contract, program):
    """What can only be seen while something computes."""
    with Daemon(program, "--max-running", "1", "--queue-size", "1") as daemon:
        first = daemon.start_endless("contract-running-1")
        path = "/v1/requests/contract-running-1"
        contract.check("getRequest", ask(daemon.port, "GET", path), 200)
        with contextlib.closing(connect(daemon.port)) as events:
            events.sendall(request_bytes("GET", path + "/events"))
            received = b""
            while b"\n\n" not in received.partition(b"\r\n\r\n")[2]:
                received += events.recv(65536)
            contract.check("watchRequest", Answer(received), 200)
            state = json.loads(re.search(rb"data: (.*)\n", received).group(1))
            contract.validate(state, {"$ref": "#/components/schemas/RequestState"}, "an event")
        contract.check("cancelRequest", ask(daemon.port, "DELETE", path), 204)
        contract.check("remesh", receive(first), 499)
    with Daemon(program, "--max-running", "1", "--queue-size", "1") as daemon:
        large = SQUARE + b"#" * (1 << 20) + b"\n"  # so many small ones may wait as their work permits
        held = [daemon.start_endless("contract-running-2", large), connect(daemon.port)]
        held[1].sendall(request_bytes("POST", f"/v1/remesh?{ENDLESS}", large, {"X-Request-Id": "contract-running-3"}))
        wait_until(lambda: ask(daemon.port, "GET", "/v1/requests/contract-running-3").status == 200, "the request waits")
        for operation in ("remesh", "analyze", "compare"):
            answer = ask(daemon.port, "POST", contract.operations[operation][1], large)
            contract.check(operation, answer, 503, "overloaded")
            if "retry-after" not in answer.headers:
                contract.fail("503 without Retry-After")
        daemon.drain()
        contract.check("isReady", ask(daemon.port, "GET", "/readyz"), 503, "draining")


def form_of(**files):
    """A form with these files, and its header."""
    body = b"".join(b"--b\r\nContent-Disposition: form-data; name=\"%s\"; filename=\"%s.obj\"\r\n\r\n%s\r\n"
                    % (name.encode(), name.encode(), content) for name, content in files.items())
    return body + b"--b--\r\n", {"Content-Type": "multipart/form-data; boundary=b"}


def check_compare(contract, port):
    target = "/v1/compare"
    checked = functools.partial(contract.check, "compare")
    raised = SQUARE.replace(b" 0\n", b" 0.5\n", 4)
    form, fields = form_of(a=SQUARE, b=raised)
    for query, within in (("", None), ("?tolerance=0.6", True), ("?tolerance=0.4", False)):
        answer = ask(port, "POST", target + query, form, fields)
        checked(answer, 200, query)
        found = json.loads(answer.body)
        if found["within"] is not within or found["a_to_b"]["bound"] < 0.5:
            contract.fail(f"{target}{query}: {found}")
    for query in ("?tolerance=0", "?tolerance=x", "?tolerance=1&tolerance=1", "?refine=false"):
        checked(ask(port, "POST", target + query, form, fields), 400, query)
    for files in ({"a": SQUARE}, {"a": SQUARE, "mesh": SQUARE}):
        checked(ask(port, "POST", target, *form_of(**files)), 400, str(list(files)))
    checked(ask(port, "POST", target, form, {**fields, "Accept": "image/png"}), 406)
    checked(ask(port, "POST", target), 411)
    checked(ask(port, "POST", target, b"#" * 200_000), 413)
    checked(ask(port, "POST", target, SQUARE), 415)
    checked(ask(port, "POST", target, form, {**fields, "Content-Encoding": "br"}), 415)
    for mesh in (b"", SQUARE + b"f 1 2 9\n"):
        answer = ask(port, "POST", target, *form_of(a=SQUARE, b=mesh))
        checked(answer, 422, str(mesh[-8:]))
        if "\"b\"" not in json.loads(answer.body)["detail"]:
            contract.fail(f"{target}: {answer.body} does not say that it is about the second mesh")
    checked(ask(port, "POST", target, form, {**fields, "A": "b" * 40_000}), 431)
    with contextlib.closing(connect(port)) as connection:
        connection.sendall(request_bytes("POST", target, None, {"Transfer-Encoding": "gzip, chunked"}))
        checked(receive(connection), 501)


def big_sheet(n):
    lines = [f"v {x} {y} {(x * 7919 + y * 104729) % 1000 / 1000}" for y in range(n + 1) for x in range(n + 1)]
    for y in range(n):
        for x in range(n):
            a = y * (n + 1) + x + 1
            lines += [f"f {a} {a + 1} {a + n + 2}", f"f {a} {a + n + 2} {a + n + 1}"]
    return "\n".join(lines).encode()


def check_limits(contract, program):
    sheet = big_sheet(250)
    with Daemon(program, "--request-timeout", "50ms") as daemon:
        def begun(target, body, fields=None):
            """The answer once it is worked on: on a busy machine no thread may start in so short a time."""
            answers = []

            def is_begun():
                answers.append(ask(daemon.port, "POST", target, body, fields))
                return answers[-1].status != 503

            wait_until(is_begun, "a thread starts within the time of a request")
            return answers[-1]

        contract.check("remesh", begun(f"/v1/remesh?{ENDLESS}", SQUARE), 504)
        contract.check("analyze", begun("/v1/analyze", sheet), 504)
        contract.check("compare", begun("/v1/compare", *form_of(a=sheet, b=sheet)), 504)
    with Daemon(program, "--max-connections-per-address", "1") as daemon:
        with contextlib.closing(connect(daemon.port)) as held:
            # Asked for its body, it is in its place.
            held.sendall(request_bytes("POST", "/v1/remesh", fields={"Content-Length": "1", "Expect": "100-continue"}))
            held.recv(1)
            for operation in ("remesh", "analyze", "compare", "submitJob"):
                contract.check(operation, ask(daemon.port, "POST", contract.operations[operation][1], SQUARE), 429)
            for operation in ("isLive", "isReady"):
                contract.check(operation, ask(daemon.port, "GET", contract.operations[operation][1]), 429)
    with Daemon(program) as daemon:
        large = big_sheet(300)
        for operation, body, fields in (("analyze", large, {}), ("compare", *form_of(a=large, b=large))):
            with contextlib.closing(connect(daemon.port)) as connection:
                fields = {**fields, "X-Request-Id": "contract-cancelled"}
                connection.sendall(request_bytes("POST", contract.operations[operation][1], body, fields))
                wait_until(lambda: ask(daemon.port, "DELETE", "/v1/requests/contract-cancelled").status == 204,
                           "it can be cancelled")
                contract.check(operation, receive(connection), 499)


def submit(daemon, query="", body=SQUARE, fields=None):
    return json.loads(ask(daemon.port, "POST", f"/v1/jobs?{query}", body, fields).body)["id"]


def wait_until_ended(daemon, job, *states):
    wait_until(lambda: json.loads(ask(daemon.port, "GET", f"/v1/jobs/{job}").body)["state"] in states,
               f"the job is {' or '.join(states)}")


def check_refused_jobs(contract, port):
    post = functools.partial(ask, port, "POST", "/v1/jobs")
    refused = functools.partial(contract.check, "submitJob")
    refused(ask(port, "POST", "/v1/jobs?refin=true", SQUARE), 400)
    refused(post(SQUARE, {"Accept": "image/png"}), 406)
    refused(post(), 411)
    refused(post(b"#" * 200_000), 413)
    refused(post(SQUARE, {"Content-Encoding": "br"}), 415)
    refused(post(SQUARE, {"A": "b" * 40_000}), 431)
    post(SQUARE, {"Idempotency-Key": "one"})
    refused(post(SQUARE + b"\n", {"Idempotency-Key": "one"}), 422)
    unknown = "/v1/jobs/" + "0" * 32
    for operation, method, path in (("getJob", "GET", ""), ("cancelJob", "DELETE", ""), ("getJobResult", "GET", "/result"),
                                    ("getJobReport", "GET", "/report"), ("watchJob", "GET", "/events")):
        contract.check(operation, ask(port, method, unknown + path), 404)
    contract.check("listJobs", ask(port, "GET", "/v1/jobs"), 403)


def check_result(contract, port, job, status):
    contract.check("getJobResult", ask(port, "GET", f"/v1/jobs/{job}/result"), status)
    contract.check("getJobReport", ask(port, "GET", f"/v1/jobs/{job}/report"), status)


def check_jobs(contract, program, folder):
    store = ("--store", "sqlite", "--state-dir", folder)
    with Daemon(program, *store, "--max-body", "100kB", "--drain-time", f"{PATIENCE}s") as daemon:
        port = daemon.port
        check_refused_jobs(contract, port)
        contract.check("remesh", ask(port, "POST", "/v1/remesh", SQUARE, {"Prefer": "respond-async"}), 202)
        accepted = ask(port, "POST", "/v1/jobs?refine=false", SQUARE)
        contract.check("submitJob", accepted, 202)
        job = json.loads(accepted.body)["id"]
        wait_until_ended(daemon, job, "succeeded")
        contract.check("getJob", ask(port, "GET", f"/v1/jobs/{job}"), 200)
        check_result(contract, port, job, 200)
        for kind in ("obj", "json", "stl", "ply", "off", "vtu", "msh", "mesh", "smesh", "ply_ascii", "glb"):
            contract.check("getJobResult", ask(port, "GET", f"/v1/jobs/{job}/result?format={kind}"), 200, kind)
        for operation, name in (("getJobResult", "result"), ("getJobReport", "report")):
            path = f"/v1/jobs/{job}/{name}"
            tag = ask(port, "GET", path).headers["etag"]
            contract.check(operation, ask(port, "GET", path, None, {"If-None-Match": tag}), 304)
            contract.check(operation, ask(port, "GET", path, None, {"Range": "bytes=2-5", "If-Range": tag}), 206)
            contract.check(operation, ask(port, "GET", path, None, {"Range": "bytes=999999999-"}), 416)
            contract.check(operation, ask(port, "GET", path, None, {"If-Match": "\"another\""}), 412)
            contract.check(operation, ask(port, "GET", path, None, {"If-Match": tag}), 200)
        contract.check("getJobResult", ask(port, "GET", f"/v1/jobs/{job}/result?refine=false"), 400)
        contract.check("getJobResult", ask(port, "GET", f"/v1/jobs/{job}/result", None, {"Accept": "image/png"}), 406)
        stream = ask(port, "GET", f"/v1/jobs/{job}/events")
        contract.check("watchJob", stream, 200)
        contract.validate(json.loads(re.search(rb"data: (.*)\n", stream.body).group(1)), {"$ref": "#/components/schemas/Job"},
                          "an event")
        version = re.search(rb"id: (.*)\n", stream.body).group(1).decode()
        contract.check("watchJob", ask(port, "GET", f"/v1/jobs/{job}/events", None, {"Last-Event-ID": version}), 204)
        failed = submit(daemon, body=SQUARE + b"f 1 2 9\n")
        wait_until_ended(daemon, failed, "failed")
        contract.check("getJob", ask(port, "GET", f"/v1/jobs/{failed}"), 200, "failed")
        check_result(contract, port, failed, 422)

        running = submit(daemon, ENDLESS)
        wait_until_ended(daemon, running, "running")
        contract.check("getJob", ask(port, "GET", f"/v1/jobs/{running}"), 200, "running")
        check_result(contract, port, running, 409)
        daemon.drain()
        contract.check("submitJob", ask(port, "POST", "/v1/jobs", SQUARE), 503, "draining")
        contract.check("cancelJob", ask(port, "DELETE", f"/v1/jobs/{running}"), 204)
    # Short times, in a daemon of its own, as nothing else must be done in them.
    with Daemon(program, *store, "--head-timeout", "1s", "--result-ttl", "1s") as daemon:
        for operation in ("remesh", "analyze", "compare", "submitJob"):
            with contextlib.closing(connect(daemon.port)) as connection:
                target = contract.operations[operation][1]
                connection.sendall(request_bytes("POST", target, None, {"Content-Length": "500"}))
                contract.check(operation, receive(connection), 408)
        job = submit(daemon)
        wait_until_ended(daemon, job, "expired")
        check_result(contract, daemon.port, job, 410)
    with Daemon(program, *store, key=KEY) as daemon:
        mine = {"X-API-Key": KEY}
        ask(daemon.port, "POST", "/v1/jobs", SQUARE, mine)
        contract.check("listJobs", ask(daemon.port, "GET", "/v1/jobs", None, mine), 200)


def main():
    program = sys.argv[1]
    with Daemon(program, "--max-body", "100kB") as daemon:
        document = json.loads(ask(daemon.port, "GET", "/openapi.json").body)
        contract = Contract(document)
        contract.check_examples(document)
        for schema in document["components"]["schemas"].values():
            Draft202012Validator.check_schema(schema)
        check_plain(contract, daemon)
        check_requests_as_written(contract, daemon)
        check_options(contract, daemon)
        contract.check("submitJob", ask(daemon.port, "POST", "/v1/jobs", SQUARE), 501)
    with tempfile.TemporaryDirectory() as folder:
        with Daemon(program, "--store", "sqlite", "--state-dir", folder, key=KEY) as daemon:
            check_keys(contract, daemon)
        check_jobs(contract, program, folder)
    check_origins(contract, program)
    check_running(contract, program)
    check_limits(contract, program)
    contract.check_all_seen()
    print(f"{len(contract.operations)} operations, {len(contract.seen)} statuses provoked, "
          f"{len(contract.failures)} failures")
    return 1 if contract.failures else 0


if __name__ == "__main__":
    sys.exit(main())
