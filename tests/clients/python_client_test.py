"""The client of api/clients/python against the real daemon: python_client_test.py REMESHD [--full]

It is tried with numpy and without, from several threads, and installed from its folder in a fresh environment. --full sends
100 MB as well. mypy is asked where it is installed. Exit code 77: nothing could be tried.
"""

import doctest
import http.server
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import types
import venv

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIENT = ROOT / "api/clients/python"
sys.path.append(str(ROOT / "tests/support"))
from remeshd import Daemon  # noqa: E402

# The client has the same name as the module that starts a daemon.
del sys.modules["remeshd"]
sys.path.insert(0, str(CLIENT))

POINTS = [(x, y, z) for z in (0.0, 4.0) for x, y in ((0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (0.0, 3.0))]
QUADS = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def check_box(result, what):
    check(sorted(tuple(map(float, p)) for p in result.vertices) == sorted(POINTS), f"{what}: the vertices differ")
    check(len(result.faces) == 12 and result.report["output"]["volume"] == 24, f"{what}: the faces differ")


def arrays(remeshd, client):
    """What a mesh may be, with numpy and without."""
    for what, mesh in {"triangles": (POINTS, TRIANGLES), "quadrilaterals": (POINTS, QUADS),
                       "trimesh": types.SimpleNamespace(vertices=POINTS, faces=TRIANGLES),
                       "pyvista": types.SimpleNamespace(points=POINTS, faces=[x for q in QUADS for x in (4, *q)])}.items():
        result = client.remesh(mesh, refine=False)
        check_box(result, what)
        check(list(result.flat_faces())[:4] == [3, *map(int, result.faces[0])], f"{what}: flat faces")
    groups = client.remesh((POINTS, TRIANGLES), face_groups=[7] * 4 + [9] * 8, refine=False).labels["group"]
    names = sorted(groups.names[int(i)] for i in groups.of_face)
    check(names == ["7"] * 4 + ["9"] * 8, f"the groups are {names}")
    try:
        client.remesh(7)
        raise AssertionError("a number is no mesh")
    except TypeError:
        pass


def files(remeshd, client, folder):
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    source = folder / "box.obj"
    source.write_text("".join("v %r %r %r\n" % p for p in POINTS) + "".join("f %d %d %d %d\n" % tuple(v + 1 for v in q) for q in QUADS))
    for form in client.capabilities()["formats"]["output"]:
        path = folder / f"{form['name']}.{form['ending']}"
        client.remesh_file(source, path, format=form["name"], refine=False)
        if form["name"] in ("smesh",):
            check(path.stat().st_size > 100, f"{path} is short")
        else:
            check_box(client.remesh(path, refine=False), form["name"])
    check(client.analyze(source)["input"]["closed"] is True, "analyze")
    run = subprocess.run([sys.executable, "-m", "remeshd", str(source), str(folder / "out.off"), "refine=false", "--url", client.url],
                         cwd=CLIENT, env=environment, capture_output=True, text=True, timeout=600)
    check(run.returncode == 0 and run.stderr == "", f"python -m remeshd: {run.stderr}")
    check_box(client.remesh(folder / "out.off", refine=False), "python -m remeshd")
    run = subprocess.run([sys.executable, "-m", "remeshd", str(source), str(folder / "out.off"), "refin=false", "--url", client.url],
                         cwd=CLIENT, env=environment, capture_output=True, text=True, timeout=600)
    check(run.returncode == 1 and "unknown_option" in run.stderr, f"python -m remeshd: {run.stderr}")


def with_meshio(remeshd, client):
    try:
        import meshio
    except ImportError:
        return print("SKIPPED: meshio is not installed")
    mesh = client.remesh(meshio.Mesh(POINTS, [("quad", QUADS[:2]), ("triangle", TRIANGLES[4:])]), refine=False)
    check_box(mesh, "meshio")
    back = mesh.to_meshio()
    check_box(client.remesh(back, refine=False), "meshio and back")
    check(len(back.cells_dict["triangle"]) == 12 and len(set(back.cell_data["patch"][0])) == 6, "meshio: patches")


def errors(remeshd, client):
    for body, options, code, line in ((b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", {}, "index_out_of_range", 4),
                                      (b"v 0 0 0\n", {"max_area": -1}, "invalid_option", None),
                                      (b"v 0 0 0\n", {}, "empty_mesh", None)):
        try:
            client.remesh(body, **options)
            raise AssertionError(f"{code} was expected")
        except remeshd.Problem as problem:
            check((problem.code, problem.line) == (code, line) and problem.request_id, f"{code}: {problem}")
    try:
        remeshd.Client("http://127.0.0.1:9", retries=0).remesh((POINTS, QUADS))
        raise AssertionError("nobody listens there")
    except OSError:
        pass


def jobs(remeshd, client):
    seen = []
    job = client.submit((POINTS, TRIANGLES), refine=False).wait(progress=lambda stage, fraction: seen.append(fraction))
    check(seen and all(0 <= x <= 1 for x in seen), f"progress: {seen}")
    check_box(client.job(job.id).result(), "job")
    check(job.report()["output"]["faces"] == 12 and job.file("off").startswith(b"OFF"), "the files of a job")
    failed = client.submit(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")
    try:
        failed.wait()
        raise AssertionError("the job should fail")
    except remeshd.Problem as problem:
        check(problem.code == "index_out_of_range" and problem.line == 4, f"the problem of a job: {problem}")
    stopped = client.submit((POINTS, TRIANGLES), max_edge_length=0.003)
    stopped.cancel()
    try:
        stopped.wait()
        raise AssertionError("the job should be cancelled")
    except remeshd.Cancelled:
        pass


def cancellation(remeshd, client):
    """A request of minutes ends once it is cancelled, after it was seen to run."""
    cancel, stages = threading.Event(), []

    def show(stage, fraction):
        stages.append(stage)
        cancel.set()

    try:
        client.remesh((POINTS, TRIANGLES), max_edge_length=0.003, progress=show, cancel=cancel)
        raise AssertionError("it should be cancelled")
    except remeshd.Cancelled:
        check(stages and stages[0], f"stages: {stages}")


def retries(remeshd):
    """A service that is busy twice, and then answers."""
    told = []

    class Busy(http.server.BaseHTTPRequestHandler):
        def do_POST(self):
            told.append(len(self.rfile.read(int(self.headers["Content-Length"]))))
            body = json.dumps({"code": "overloaded"} if len(told) < 3 else {"report": {"input": 7}}).encode()
            self.send_response(503 if len(told) < 3 else 200)
            self.send_header("Retry-After", "0")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Busy) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_address[1]}"
        check(remeshd.Client(url).analyze(b"abc") == {"input": 7} and told == [3, 3, 3], f"retries: {told}")
        told.clear()
        try:
            remeshd.Client(url, retries=1).analyze(b"abc")
            raise AssertionError("it is busy")
        except remeshd.Problem as problem:
            check(problem.status == 503 and len(told) == 2, f"{problem}, {told}")
        server.shutdown()


def threads(remeshd, client):
    failures = []

    def work():
        try:
            check_box(client.remesh((POINTS, TRIANGLES), refine=False), "a thread")
        except Exception as error:  # noqa: BLE001
            failures.append(error)

    running = [threading.Thread(target=work) for _ in range(8)]
    for thread in running:
        thread.start()
    for thread in running:
        thread.join()
    check(not failures, f"threads: {failures}")


def documents(client):
    text = (CLIENT / "README.md").read_text(encoding="utf-8").replace("http://localhost:8080", client.url)
    text = "\n".join(line for line in text.split("\n") if not line.startswith("```"))
    test = doctest.DocTestParser().get_doctest(text, {}, "README.md", None, 0)
    check(doctest.DocTestRunner().run(test).failed == 0, "README.md of the client")


def installed(client, folder):
    """In a fresh environment, with Debian's setuptools and without a network."""
    venv.create(folder / "venv", system_site_packages=True, with_pip=False)
    python = folder / "venv/bin/python"
    pip = [str(python), "-m", "pip", "install", "--quiet", "--no-index", "--no-build-isolation", str(CLIENT)]
    run = subprocess.run(pip, capture_output=True, text=True, timeout=600, cwd=folder,
                         env={**os.environ, "PIP_DISABLE_PIP_VERSION_CHECK": "1"})
    if run.returncode != 0 and "No module named" in run.stderr:
        return print(f"SKIPPED: not installed by pip: {run.stderr.strip()}")
    check(run.returncode == 0, f"pip: {run.stderr}")
    for left in ("build", "remeshd.egg-info"):
        subprocess.run(["rm", "-rf", str(CLIENT / left)], check=True)
    code = f"import remeshd; print(remeshd.__file__, remeshd.Client({client.url!r}).capabilities()['name'])"
    told = subprocess.run([str(python), "-c", code], check=True, capture_output=True, text=True, cwd=folder, timeout=600).stdout
    check(told.split()[1] == "remeshd" and str(folder / "venv") in told, f"installed: {told}")


def typed():
    for version in ("3.9", "3.11"):
        command = [sys.executable, "-m", "mypy", "--strict", "--python-version", version, str(CLIENT / "remeshd")]
        run = subprocess.run(command, capture_output=True, text=True, timeout=600, cwd="/")
        if "No module named mypy" in run.stderr:
            return print("SKIPPED: mypy is not installed")
        check(run.returncode == 0, f"mypy {version}: {run.stdout}{run.stderr}")
    return None


def large(remeshd, client):
    """100 MB of a flat sheet come through, as binary PLY."""
    import numpy

    n = 1700
    x, y = numpy.meshgrid(numpy.arange(n, dtype=float), numpy.arange(n, dtype=float), indexing="ij")
    points = numpy.stack([x.ravel(), y.ravel(), numpy.zeros(n * n)], axis=1)
    corner = (numpy.arange(n - 1)[:, None] * n + numpy.arange(n - 1)).ravel()
    faces = numpy.concatenate([numpy.stack([corner, corner + n, corner + n + 1], axis=1),
                               numpy.stack([corner, corner + n + 1, corner + 1], axis=1)])
    check(points.nbytes + 13 * len(faces) > 100_000_000, "it is too small")
    result = client.remesh((points, faces), refine=False)
    check(len(result.faces) == 2 and result.report["input"]["faces"] == len(faces), "100 MB: the faces differ")


def main():
    program, full = sys.argv[1], "--full" in sys.argv
    remeshd = importlib.import_module("remeshd")
    check(doctest.testmod(remeshd).failed == 0, "the doctest of the client")
    with tempfile.TemporaryDirectory() as name, Daemon(program, "--store", "sqlite", "--state-dir", name + "/state") as daemon:
        folder = pathlib.Path(name)
        client = remeshd.Client(f"http://127.0.0.1:{daemon.port}")
        client.url = f"http://127.0.0.1:{daemon.port}"
        has_numpy = importlib.util.find_spec("numpy") is not None
        if has_numpy:
            arrays(remeshd, client)
            with_meshio(remeshd, client)
        hidden, sys.modules["numpy"] = sys.modules.get("numpy"), None
        arrays(remeshd, client)
        sys.modules.pop("numpy") if hidden is None else sys.modules.update(numpy=hidden)
        files(remeshd, client, folder)
        errors(remeshd, client)
        jobs(remeshd, client)
        cancellation(remeshd, client)
        retries(remeshd)
        threads(remeshd, client)
        documents(client)
        installed(client, folder)
        if full and has_numpy:
            large(remeshd, client)
    typed()
    print("ok")
    return 0


if __name__ == "__main__":
    sys.exit(main())
