"""A client of remeshd. It needs nothing but the standard library, and uses numpy where it is installed."""

from __future__ import annotations

import http.client
import importlib
import json
import os
import secrets
import sys
import threading
import time
import urllib.parse
from typing import IO, Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

__all__ = ["Cancelled", "Client", "Job", "Labels", "Problem", "Result"]

Progress = Union[bool, Callable[[str, float], None]]
Body = Union[bytes, IO[bytes]]


class Problem(Exception):
    """An error that the service answered with. Members that do not apply are None.

    >>> Problem(422, {"code": "invalid_mesh", "detail": "not a number", "line": 7}).line
    7
    """

    def __init__(self, status: int, answer: Dict[str, Any]) -> None:
        self.status = status
        self.code: str = answer.get("code", "")
        self.detail: str = answer.get("detail", "")
        self.request_id: Optional[str] = answer.get("request_id")
        self.line: Optional[int] = answer.get("line")
        self.byte: Optional[int] = answer.get("byte")
        self.element: Optional[int] = answer.get("element")
        self.option: Optional[str] = answer.get("option")
        self.limit: Optional[int] = answer.get("limit")
        place = f"line {self.line}: " if self.line is not None else f"byte {self.byte}: " if self.byte is not None else ""
        super().__init__(f"{status} {self.code}: {place}{self.detail}")


class Cancelled(Exception):
    """The caller has asked to stop."""


class Labels:
    """The labels of one kind: their names, and the index of a name for each face."""

    def __init__(self, names: List[str], of_face: Any) -> None:
        self.names = names
        self.of_face = of_face


class Result:
    """A remeshed surface.

    `vertices` and `faces` are arrays of numpy with three columns, or lists where numpy is missing. `face_patch` has the patch of
    each face. `labels` has `object`, `group` and `material` where the mesh has them. `report` is the report of the service.
    """

    def __init__(self, answer: Dict[str, Any]) -> None:
        mesh = answer["mesh"]
        self.report: Dict[str, Any] = answer["report"]
        self.vertices = _as_array(mesh["vertices"], "float64")
        self.faces = _as_array(mesh["faces"], "int64")
        self.face_patch = _as_array(mesh["face_patch"], "int64")
        self.labels = {kind: Labels(labels["names"], _as_array(labels["of_face"], "int64"))
                       for kind, labels in mesh.get("labels", {}).items()}
        groups = mesh.get("face_groups")
        if groups is not None and "group" not in self.labels:
            numbers = sorted(set(groups))
            index = {number: i for i, number in enumerate(numbers)}
            self.labels["group"] = Labels([str(n) for n in numbers], _as_array([index[g] for g in groups], "int64"))

    def flat_faces(self) -> Any:
        """The faces as PyVista has them: the number of corners before the corners of each face."""
        return _as_array([x for face in self.faces for x in (3, *(int(v) for v in face))], "int64")

    def to_meshio(self) -> Any:
        """A mesh of meshio, with the patch of each face as cell data, and a cell set for each label."""
        meshio: Any = importlib.import_module("meshio")
        sets: Dict[str, List[List[int]]] = {}
        for kind, labels in self.labels.items():
            faces_of: List[List[int]] = [[] for _ in labels.names]
            for face, label in enumerate(labels.of_face):
                faces_of[int(label)].append(face)
            for name, faces in zip(labels.names, faces_of):
                sets[f"{kind}:{name}"] = [faces]
        return meshio.Mesh(self.vertices, [("triangle", self.faces)], cell_data={"patch": [self.face_patch]}, cell_sets=sets)


class Client:
    """A service at an address.

    All members may be called from several threads at once. `retries` is how often a request is sent again if the service is
    busy (429 and 503) or cannot be reached, after the pause that it asks for.
    """

    def __init__(self, url: str = "http://localhost:8080", api_key: Optional[str] = None, retries: int = 5,
                 timeout: float = 3600) -> None:
        parts = urllib.parse.urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ValueError(f"an address such as http://localhost:8080 was expected, not {url!r}")
        self._is_tls = parts.scheme == "https"
        self._host, self._port = parts.hostname, parts.port
        self._prefix = parts.path.rstrip("/")
        self._api_key, self._retries, self._timeout = api_key, retries, timeout

    def capabilities(self) -> Dict[str, Any]:
        """The formats, options and limits of the service."""
        return self._json("GET", "/v1/capabilities")

    def remesh(self, mesh: Any, *, face_groups: Any = None, progress: Progress = False,
               cancel: Optional[threading.Event] = None, **options: Any) -> Result:
        """Remeshes a mesh.

        `mesh` is a path, bytes of a file, a pair of vertices and faces, or a mesh of meshio, trimesh or PyVista. `face_groups`
        has a number for each face of such a pair. With `progress=True` a line on standard error shows how far it is; a
        function is called with the stage and a fraction. `cancel` stops the work once it is set, and so does Ctrl-C.
        Options that are no names in Python, if there are any, can be given as a dictionary: `**{"name": value}`.
        """
        return Result(json.loads(self._work("/v1/remesh", mesh, face_groups, {**options, "format": "json"}, progress, cancel)))

    def remesh_file(self, mesh: Any, output: Union[str, "os.PathLike[str]"], *, face_groups: Any = None,
                    progress: Progress = False, cancel: Optional[threading.Event] = None, **options: Any) -> None:
        """Remeshes a mesh into a file. Its ending is the format, unless `format` is given."""
        options.setdefault("format", os.path.splitext(os.fspath(output))[1][1:].lower() or "obj")
        content = self._work("/v1/remesh", mesh, face_groups, options, progress, cancel)
        with open(output, "wb") as file:
            file.write(content)

    def analyze(self, mesh: Any, *, face_groups: Any = None, **options: Any) -> Dict[str, Any]:
        """The report of a mesh as it is."""
        answer = json.loads(self._work("/v1/analyze", mesh, face_groups, options, False, None))
        report: Dict[str, Any] = answer["report"]
        return report

    def submit(self, mesh: Any, *, face_groups: Any = None, **options: Any) -> "Job":
        """Begins a job, which goes on if this program ends."""
        # With the key, sending again after a broken connection gives the same job.
        headers = {"Idempotency-Key": secrets.token_urlsafe(24)}
        answer = json.loads(self._post("/v1/jobs" + _query(options), mesh, face_groups, headers))
        return Job(self, answer["id"])

    def job(self, identifier: str) -> "Job":
        """A job that was begun before."""
        return Job(self, identifier)

    # What follows is not for callers.

    def _work(self, path: str, mesh: Any, face_groups: Any, options: Dict[str, Any], progress: Progress,
              cancel: Optional[threading.Event]) -> bytes:
        identifier = secrets.token_urlsafe(24)
        answer: List[bytes] = []
        failure: List[BaseException] = []
        ended = threading.Event()

        def post() -> None:
            try:
                answer.append(self._post(path + _query(options), mesh, face_groups, {"X-Request-Id": identifier}, cancel))
            except BaseException as error:  # it is raised again by the thread that waits
                failure.append(error)
            ended.set()

        threading.Thread(target=post, daemon=True).start()
        try:
            self._watch(identifier, ended, progress, cancel)
        except (KeyboardInterrupt, Cancelled):
            if cancel is not None:
                cancel.set()
            try:
                self._send("DELETE", f"/v1/requests/{identifier}", b"", {})
            except (Problem, OSError, http.client.HTTPException):
                pass  # it has ended, or has not begun
            raise
        if failure:
            raise failure[0]
        return answer[0]

    def _watch(self, identifier: str, ended: threading.Event, progress: Progress, cancel: Optional[threading.Event]) -> None:
        while not ended.wait(0.1 if cancel is not None else 0.5):
            if cancel is not None and cancel.is_set():
                raise Cancelled
            if not progress:
                continue
            try:
                _show(progress, json.loads(self._send("GET", f"/v1/requests/{identifier}", b"", {})))
            except (Problem, OSError, http.client.HTTPException):
                pass  # it is not known yet, or not any more
        if progress is True:
            sys.stderr.write("\r\x1b[K")

    def _post(self, path: str, mesh: Any, face_groups: Any, headers: Dict[str, str],
              cancel: Optional[threading.Event] = None) -> bytes:
        for attempt in range(self._retries + 1):
            try:
                if isinstance(mesh, (str, os.PathLike)):
                    with open(mesh, "rb") as file:
                        return self._send("POST", path, file, headers)
                return self._send("POST", path, *_encoded(mesh, face_groups, headers))
            except Problem as problem:
                if problem.status not in (429, 503) or attempt == self._retries:
                    raise
                pause = getattr(problem, "retry_after", 1.0)
            except (ConnectionRefusedError, http.client.RemoteDisconnected):
                if attempt == self._retries:
                    raise
                pause = min(2.0**attempt, 30)
            if cancel is None:
                time.sleep(pause)
            elif cancel.wait(pause):
                raise Cancelled
        raise AssertionError("the last attempt returns or raises")

    def _send(self, method: str, path: str, body: Body, headers: Dict[str, str]) -> bytes:
        """Sends one request. Errors: Problem; OSError, http.client.HTTPException - the connection failed."""
        kind = http.client.HTTPSConnection if self._is_tls else http.client.HTTPConnection
        connection = kind(self._host, self._port, timeout=self._timeout)
        all_headers = {"Content-Type": "application/octet-stream", **headers} if method == "POST" else dict(headers)
        if self._api_key is not None:
            all_headers["Authorization"] = f"Bearer {self._api_key}"
        if not isinstance(body, bytes):
            all_headers["Content-Length"] = str(os.fstat(body.fileno()).st_size)
        try:
            try:
                connection.request(method, self._prefix + path, body=body or None, headers=all_headers)
            except (BrokenPipeError, ConnectionResetError):
                pass  # the service may have answered before it had all of the body
            answer = connection.getresponse()
            content: bytes = answer.read()
        finally:
            connection.close()
        if answer.status < 400:
            return content
        try:
            told = json.loads(content)
        except ValueError:
            told = {"detail": content[:1000].decode("utf-8", "replace")}
        problem = Problem(answer.status, told if isinstance(told, dict) else {})
        pause = answer.headers.get("Retry-After", "1")
        setattr(problem, "retry_after", min(float(pause), 60.0) if pause.isdigit() else 1.0)
        raise problem

    def _json(self, method: str, path: str) -> Dict[str, Any]:
        answer: Dict[str, Any] = json.loads(self._send(method, path, b"", {}))
        return answer


class Job:
    """A job of a service. Its `id` is enough to find it again."""

    def __init__(self, client: Client, identifier: str) -> None:
        self.id = identifier
        self._client = client
        self._path = "/v1/jobs/" + urllib.parse.quote(identifier, safe="")

    def state(self) -> Dict[str, Any]:
        """What the service tells of the job: `state`, `stage`, `fraction` and more."""
        return self._client._json("GET", self._path)

    def states(self, pause: float = 0.5) -> Iterator[Dict[str, Any]]:
        """The state again and again, until the job has ended."""
        while True:
            state = self.state()
            yield state
            if state["state"] not in ("queued", "running"):
                return
            time.sleep(pause)

    def wait(self, progress: Progress = False) -> "Job":
        """Waits until the job has ended. Errors: Problem - it has failed; Cancelled - it was cancelled."""
        last: Dict[str, Any] = {}
        for last in self.states():
            if progress:
                _show(progress, last)
        if progress is True:
            sys.stderr.write("\r\x1b[K")
        if last["state"] == "cancelled":
            raise Cancelled
        if last["state"] == "failed":
            problem = last.get("problem") or {}
            raise Problem(int(problem.get("status", 500)), problem)
        return self

    def result(self) -> Result:
        """The result of a job that has succeeded."""
        return Result(json.loads(self.file("json")))

    def file(self, format: str, **options: Any) -> bytes:
        """The result as a file of a format, with options that say how it is written."""
        return self._client._send("GET", self._path + "/result" + _query({**options, "format": format}), b"", {})

    def report(self) -> Dict[str, Any]:
        return self._client._json("GET", self._path + "/report")

    def cancel(self) -> None:
        """Cancels the job, or removes its result."""
        self._client._send("DELETE", self._path, b"", {})


def _show(progress: Progress, state: Dict[str, Any]) -> None:
    stage, fraction = str(state.get("stage") or state.get("state") or ""), float(state.get("fraction") or 0)
    if callable(progress):
        progress(stage, fraction)
    elif progress:
        sys.stderr.write(f"\r\x1b[K{100 * fraction:3.0f} % {stage}")
        sys.stderr.flush()


def _query(options: Dict[str, Any]) -> str:
    """Options as they stand in an address.

    >>> _query({"refine": False, "min_angle_deg": 25, "repair": ["winding", "seams"], "format": None})
    '?refine=false&min_angle_deg=25&repair=winding%2Cseams'
    """
    texts = {name: _text(value) for name, value in options.items() if value is not None}
    return "?" + urllib.parse.urlencode(texts) if texts else ""


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return ",".join(_text(item) for item in value)
    return repr(float(value)) if isinstance(value, float) else str(value)


def _numpy() -> Any:
    try:
        return importlib.import_module("numpy")
    except ImportError:
        return None


def _as_array(values: Any, kind: str) -> Any:
    numpy = _numpy()
    return values if numpy is None else numpy.asarray(values, dtype=kind)


def _vertices_and_faces(mesh: Any) -> Tuple[Any, Any]:
    """The arrays of a mesh of meshio, trimesh or PyVista, or a pair of them."""
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1]
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):  # meshio
        faces = [face for block in mesh.cells if block.type in ("triangle", "quad", "polygon") for face in block.data]
        return mesh.points, faces
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh
        return mesh.vertices, mesh.faces
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):  # PyVista: counts before the corners
        flat, faces, at = [int(v) for v in mesh.faces], [], 0
        while at < len(flat):
            faces.append(flat[at + 1 : at + 1 + flat[at]])
            at += 1 + flat[at]
        return mesh.points, faces
    raise TypeError(f"a path, bytes, a pair of vertices and faces, or a mesh was expected, not {type(mesh).__name__}")


def _encoded(mesh: Any, face_groups: Any, headers: Dict[str, str]) -> Tuple[bytes, Dict[str, str]]:
    """The bytes that are sent for a mesh, and their headers: binary PLY of triangles with numpy, else JSON."""
    if isinstance(mesh, (bytes, bytearray, memoryview)):
        return bytes(mesh), headers
    vertices, faces = _vertices_and_faces(mesh)
    numpy = _numpy()
    if numpy is not None and len(faces) > 0 and all(len(face) == 3 for face in faces):
        return _ply(numpy, vertices, faces, face_groups), {**headers, "Content-Type": "application/x-ply"}
    document: Dict[str, Any] = {"vertices": [[float(x) for x in point] for point in vertices],
                                "faces": [[int(v) for v in face] for face in faces]}
    if face_groups is not None:
        document["face_groups"] = [int(group) for group in face_groups]
    return json.dumps(document).encode(), {**headers, "Content-Type": "application/json"}


def _ply(numpy: Any, vertices: Any, faces: Any, face_groups: Any) -> bytes:
    points = numpy.ascontiguousarray(vertices, dtype="<f8")
    has_groups = face_groups is not None
    record = [("count", "u1"), ("corners", "<i4", 3)] + ([("group", "<i4")] if has_groups else [])
    rows = numpy.empty(len(faces), dtype=record)
    rows["count"], rows["corners"] = 3, numpy.asarray(faces)
    if has_groups:
        rows["group"] = numpy.asarray(face_groups)
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}",
            *(f"property double {axis}" for axis in "xyz"), f"element face {len(rows)}",
            "property list uchar int vertex_indices", *(["property int group"] if has_groups else []), "end_header\n"]
    content: bytes = "\n".join(head).encode() + points.tobytes() + rows.tobytes()
    return content
