"""Sends drawn requests to a running remeshd, and holds every answer against the contract: drawn_requests.py REMESHD
[--requests N] [--seed N]

All operations are drawn, with parameters that the contract knows, values that it allows and others, bodies of all kinds,
and jobs that exist or not. Exit code 77: python3-jsonschema is not there.
"""

import argparse
import gzip
import json
import random
import sys
import tempfile

from contract_test import SQUARE, Contract, Daemon, ask

WORDS = ["", "true", "True", "0", "1", "-1", "0.5", "1e400", "nan", "auto", "none", "obj", "stl", "json", "25", "x" * 50,
         "%00", "%F0%9F"]
MESH = {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "faces": [[0, 1, 2, 3]]}
ACCEPTED = ["*/*", "model/obj", "application/json", "application/problem+json", "model/stl;q=0.5, */*;q=0.1", "image/png", ",",
            "text/html", "model/gltf-binary"]


class Draw:
    def __init__(self, contract, seed):
        self.contract = contract
        self.random = random.Random(seed)
        self.jobs = ["0" * 32, "x"]
        self.tags = ['"x"', "*", "x"]

    def value_of(self, schema):
        """A value that a schema allows, or one that it may not allow."""
        schema = self.contract.resolve(schema)
        choices = list(WORDS)
        for name in ("enum", "examples"):
            choices += 4 * [str(value) for value in schema.get(name, [])]
        for name in ("default", "example", "const", "minimum", "maximum"):
            if name in schema:
                choices += 4 * [json.dumps(schema[name]).strip('"')]
        return self.random.choice(choices)

    def parameters(self, described, place):
        for parameter in map(self.contract.resolve, described.get("parameters", [])):
            if parameter["in"] == place and self.random.random() < (0.1 if place == "query" else 0.3):
                value = str(parameter["example"]) if "example" in parameter and self.random.random() < 0.6 else None
                yield parameter["name"], value if value is not None else self.value_of(parameter.get("schema", {}))

    def body(self):
        """A body and the fields that describe it."""
        options = {self.random.choice(["refine", "min_angle_deg", "max_area", "format", "other"]):
                   self.random.choice([True, False, 20, -1, "x", None, [], 0.1])}
        form = (b'--b\r\nContent-Disposition: form-data; name="mesh"; filename="a.obj"\r\n\r\n' + SQUARE + b"\r\n--b--\r\n")
        bodies = [(SQUARE, {}), (SQUARE, {"Content-Type": "model/obj"}), (SQUARE, {"Content-Type": "model/stl"}),
                  (json.dumps({"mesh": MESH, "options": options}).encode(), {"Content-Type": "application/json"}),
                  (json.dumps(MESH).encode(), {"Content-Type": "application/json"}),
                  (form, {"Content-Type": "multipart/form-data; boundary=b"}),
                  (form[:80], {"Content-Type": "multipart/form-data"}),
                  (b"a=b", {"Content-Type": "application/x-www-form-urlencoded"}),
                  (b"", {}), (b"\x00" * 200, {}), (b"v 0 0 0\nf 1 2 9\n", {}), (b"#" * 200_000, {})]
        body, fields = self.random.choice(bodies)
        if self.random.random() < 0.15:
            coding = self.random.choice(["gzip", "gzip", "br", "identity"])
            body, fields = gzip.compress(body), {**fields, "Content-Encoding": coding}
        return body[:self.random.randrange(len(body))] if body and self.random.random() < 0.1 else body, fields

    def request(self, operation):
        method, path, described = self.contract.operations[operation]
        for name in ("id", "job"):
            path = path.replace("{" + name + "}", self.random.choice(self.jobs))
        query = "&".join(f"{name}={value}".replace(" ", "%20") for name, value in self.parameters(described, "query"))
        fields = {name: value.replace("\x00", "") for name, value in self.parameters(described, "header")}
        body = None
        if "requestBody" in described:
            body, of_body = self.body()
            fields.update(of_body)
        if self.random.random() < 0.3:
            fields["Accept"] = self.random.choice(ACCEPTED)
        if self.random.random() < 0.2:
            fields["Accept-Encoding"] = self.random.choice(["gzip", "identity", "*;q=0", "br"])
        if self.random.random() < 0.1:
            fields["If-None-Match"] = self.random.choice(self.tags)
        if self.random.random() < 0.1:
            fields["Range"] = self.random.choice(["bytes=0-9", "bytes=5-", "bytes=-5", "bytes=999999999-", "lines=1-2",
                                                  "bytes=9-1"])
        if self.random.random() < 0.05:
            fields["Prefer"] = "respond-async"
        return method, path + ("?" + query if query else ""), body, fields

    def learn(self, answer):
        if "etag" in answer.headers:
            self.tags.append(answer.headers["etag"])
        if answer.status == 202:
            self.jobs.append(json.loads(answer.body)["id"])
            del self.jobs[2:-20]


def described_answer(answer):
    """The answer as the document describes it, without its coding."""
    if answer.headers.get("content-encoding") == "gzip" and answer.body:
        answer.body = gzip.decompress(answer.body)
    return answer


def check(contract, operation, answer, what):
    """The answer is one of those that the operation lists, or else an error as its default describes."""
    responses = contract.operations[operation][2]["responses"]
    if str(answer.status) in responses or "default" not in responses:
        contract.check(operation, answer, answer.status, what)
        return
    content = contract.resolve(responses["default"])["content"]
    kind = answer.headers.get("content-type", "").split(";")[0]
    if answer.status < 400 or kind not in content:
        contract.fail(f"{what}: {answer.status} with the type {kind} is not in the document")
        return
    contract.seen.add((operation, str(answer.status)))
    contract.validate(json.loads(answer.body), content[kind].get("schema", {}), what)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--requests", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, Daemon(
            arguments.program, "--store", "sqlite", "--state-dir", folder, "--max-body", "100kB", "--max-output-faces", "10000",
            "--request-timeout", "5s") as daemon:
        contract = Contract(json.loads(ask(daemon.port, "GET", "/openapi.json").body))
        draw = Draw(contract, arguments.seed)
        operations = sorted(contract.operations)
        for number in range(arguments.requests):
            operation = draw.random.choice(operations)
            method, target, body, fields = draw.request(operation)
            answer = described_answer(ask(daemon.port, method, target, body, fields))
            what = f"request {number} {target} {fields}"
            if answer.status == 0:
                contract.fail(f"{what}: no answer")
                continue
            check(contract, operation, answer, what)
            draw.learn(answer)
            if len(contract.failures) > 20:
                break
        print(f"{number + 1} drawn requests of {len(operations)} operations, {len(contract.seen)} different answers, "
              f"{len(contract.failures)} contradictions")
        return 1 if contract.failures else 0


if __name__ == "__main__":
    sys.exit(main())
