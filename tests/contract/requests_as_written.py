"""The ways in which people write a request, collected from the habits of users of other services and programs.

Each row is what was written, the request that it becomes, and the answer: a status, and for an error the words of its
detail that name the next step.
"""

import base64
import gzip
import json

SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
MESH = {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "faces": [[0, 1, 2, 3]]}
JSON = {"Content-Type": "application/json"}
# What curl -d and --data-binary send of themselves.
URLENCODED = {"Content-Type": "application/x-www-form-urlencoded"}
STL = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n"


def form(*parts):
    """A form of parts (name, content) and files (name, content, file name) or (name, content, file name, type)."""
    body = b""
    for name, content, *file in parts:
        content = content.encode() if isinstance(content, str) else content
        body += b"--frontier\r\nContent-Disposition: form-data; name=\"" + name.encode() + b"\""
        body += b"; filename=\"" + file[0].encode() + b"\"" if file else b""
        body += b"\r\nContent-Type: " + file[1].encode() if len(file) > 1 else b""
        body += b"\r\n\r\n" + content + b"\r\n"
    return {"Content-Type": "multipart/form-data; boundary=frontier"}, body + b"--frontier--\r\n"


def form_row(written, status, words, *parts, query=""):
    fields, body = form(*parts)
    return (written, query, fields, body, status, words)


PART = ("file", SQUARE, "part.obj", "application/octet-stream")
ROWS = (
    # Forms that are answered.
    form_row("curl -F file=@part.obj", 200, "", PART),
    form_row("curl -F mesh=@part.obj", 200, "", ("mesh", SQUARE, "part.obj")),
    form_row("curl -F model=@part.obj", 200, "", ("model", SQUARE, "part.obj")),
    form_row("curl -F upload=@part.obj", 200, "", ("upload", SQUARE, "part.obj")),
    form_row("curl -F data=@part.obj", 200, "", ("data", SQUARE, "part.obj")),
    form_row("curl -F file=@part.obj -F preset=volume", 200, "", PART, ("preset", "volume")),
    form_row("curl -F preset=volume -F file=@part.obj", 200, "", ("preset", "volume"), PART),
    form_row("curl -F 'options={\"refine\": false}' -F mesh=@part.obj", 200, "", ("options", '{"refine": false}'), PART),
    form_row("curl -F options=@options.json -F file=@part.obj", 200, "",
             ("options", '{"refine": false}', "options.json", "application/json"), PART),
    form_row("requests.post(files={'file': f}, data={'refine': False})", 200, "", ("refine", "False"), PART),
    form_row("a form of a browser with a field for each number", 200, "", PART, ("min_angle_deg", "20"),
             ("max_edge_length", "0.5\r\n"), ("format", "json")),
    form_row("curl -F file=@part.obj '...?refine=false'", 200, "", PART, query="?refine=false"),
    form_row("curl -F 'file=@part.stl;type=model/stl'", 200, "", ("file", STL, "part.stl", "model/stl")),
    form_row("curl -F file=@part.obj.gz", 200, "", ("file", gzip.compress(SQUARE), "part.obj.gz", "application/gzip")),
    form_row("a form with the mesh as text", 200, "", ("mesh", SQUARE)),
    form_row("a form with the mesh as JSON", 200, "", ("mesh", json.dumps(MESH))),
    form_row("curl -F file=@part.obj -F repair=+holes", 200, "", PART, ("repair", "+holes")),
    # Forms that are not.
    form_row("curl -F file=part.obj", 400, "file=@part.obj", ("file", "part.obj")),
    form_row("curl -F part=@part.obj", 400, "mesh, file, model, upload or data", ("part", SQUARE, "part.obj")),
    form_row("curl -F 'files[]=@part.obj'", 400, "mesh, file, model, upload or data", ("files[]", SQUARE, "part.obj")),
    form_row("curl -F a=@part.obj", 400, "mesh, file, model, upload or data", ("a", SQUARE, "part.obj")),
    form_row("curl -F file=@part.obj -F mesh=@other.obj", 400, "send one of them", PART, ("mesh", SQUARE, "other.obj")),
    form_row("curl -F file=@one.obj -F file=@two.obj", 400, "send one of them", PART, PART),
    form_row("curl -F preset=volume", 400, "the form has no mesh", ("preset", "volume")),
    form_row("curl -F file=@part.obj -F max_edge=2", 400, "the nearest is \"max_edge_length\"", PART, ("max_edge", "2")),
    form_row("curl -F file=@part.obj -F options=preset=volume", 400, "in the part \"options\"", PART,
             ("options", "preset=volume")),
    form_row("curl -F file=@part.obj -F refine=false -F 'options={\"refine\": true}'", 400, "refine is given twice", PART,
             ("refine", "false"), ("options", '{"refine": true}')),
    form_row("curl -F file=@part.obj -F refine=false '...?refine=true'", 400, "refine is given twice", PART,
             ("refine", "false"), query="?refine=true"),
    form_row("a form of a browser with an empty field", 400, "leave it out", PART, ("max_edge_length", "")),
    form_row("a form of a browser without a chosen file", 422, "empty", ("file", b"", "", "application/octet-stream")),
    form_row("curl -F file=@part.step", 415, "gmsh part.step -2 -clcurv 40 -o part.stl",
             ("file", "ISO-10303-21;\nHEADER;\n", "part.step")),
    # Bodies that are answered.
    ("curl --data-binary @part.obj", "", URLENCODED, SQUARE, 200, ""),
    ("curl -T part.obj -X POST", "", {}, SQUARE, 200, ""),
    ("curl -H 'Content-Type: model/obj'", "", {"Content-Type": "model/obj"}, SQUARE, 200, ""),
    ("curl -H 'Content-Type: text/plain'", "", {"Content-Type": "text/plain; charset=utf-8"}, SQUARE, 200, ""),
    ("curl -H 'Content-Type: application/sla'", "", {"Content-Type": "application/sla"}, STL, 200, ""),
    ("curl -H 'Content-Encoding: gzip'", "", {"Content-Encoding": "gzip"}, gzip.compress(SQUARE), 200, ""),
    ("requests.post(json=mesh)", "", JSON, json.dumps(MESH).encode(), 200, ""),
    ("requests.post(json={'mesh': mesh, 'options': ...})", "", JSON,
     json.dumps({"mesh": MESH, "options": {"refine": False}}).encode(), 200, ""),
    ("requests.post(json={**mesh, 'options': ...})", "", JSON,
     json.dumps({**MESH, "options": {"refine": False}}).encode(), 200, ""),
    ("?refine=0", "?refine=0", {}, SQUARE, 200, ""),
    ("?repair=+holes, not escaped", "?repair=+holes", {}, SQUARE, 200, ""),
    ("?max_output_faces=1e5", "?max_output_faces=1e5", {}, SQUARE, 200, ""),
    # Bodies that are not.
    ("curl --data-binary part.obj", "", URLENCODED, b"part.obj", 422, "--data-binary @part.obj"),
    ("curl -d @part.obj", "", URLENCODED, SQUARE.replace(b"\n", b""), 422, "use curl --data-binary"),
    ("curl -d file=@part.obj", "", URLENCODED, b"file=@part.obj", 415, "multipart/form-data"),
    ("curl --data-urlencode options=...", "", URLENCODED, b"options=%7B%7D", 415, "multipart/form-data"),
    ("requests.post(json={'mesh': mesh, 'refine': False})", "", JSON,
     json.dumps({"mesh": MESH, "refine": False}).encode(), 400, "belongs into \"options\""),
    ("requests.post(json={'mesh': base64})", "", JSON,
     json.dumps({"mesh": base64.b64encode(SQUARE).decode()}).encode(), 422, "mesh must be an object"),
    ("requests.post(json={'url': ...})", "", JSON, b'{"url": "https://host/part.stl"}', 422, "vertices"),
    ("curl --data-binary @part.iges", "", URLENCODED, b" " * 72 + b"S      1\n", 415, "gmsh part.iges"),
    ("curl --data-binary @scene.blend", "", URLENCODED, b"BLENDER-v293", 415, "blender -b scene.blend"),
    ("a page of errors in place of the file", "", URLENCODED, b"<!DOCTYPE html>\n<html>", 415, "download the file"),
    ("?maxEdgeLength=1", "?maxEdgeLength=1", {}, SQUARE, 400, "the nearest is \"max_edge_length\""),
    ("?hmax=1, as mmg has it", "?hmax=1", {}, SQUARE, 400, "the nearest is \"max_edge_length\""),
    ("?hausd=0.1, as mmg has it", "?hausd=0.1", {}, SQUARE, 400, "the nearest is \"surface_tolerance\""),
    ("?output_format=stl", "?output_format=stl", {}, SQUARE, 400, "the nearest is \"format\""),
    ("?format=STL", "?format=STL", {}, SQUARE, 400, "stl_ascii"),
    ("?refine=no", "?refine=no", {}, SQUARE, 400, "true or false"),
    ("?max_edge_length=2mm", "?max_edge_length=2mm", {}, SQUARE, 400, "a number above 0"),
    ("?max_edge_length=1,5", "?max_edge_length=1,5", {}, SQUARE, 400, "a number above 0"),
    ("?min_angle_deg=60", "?min_angle_deg=60", {}, SQUARE, 400, "from 0 to 33"),
    ("curl -H 'Accept: image/png'", "", {"Accept": "image/png"}, SQUARE, 406, "the formats that can be written"),
)
