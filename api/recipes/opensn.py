"""Writes a remeshed part as the OBJ that OpenSn and ChiTech read: opensn.py PART [LABEL]

Their readers want less than OBJ allows: all faces in one object, corners as `vertex//normal`, no empty line. Each `usemtl`
is a new material, numbered from 0, so that the faces are sorted by LABEL: object, group or material (by default the last
of these that the part has). A flat sheet in the plane z = 0 becomes a mesh of two dimensions; the edges of its rim are a
boundary for each side of the box around it (xmin, xmax, ymin, ymax), and one for all others (inner). A closed part becomes
a surface, as for a logical volume. It writes part.obj, and tells the numbers of materials and boundaries.
"""

import collections
import json
import os
import subprocess
import sys

part = sys.argv[1]
subprocess.run([os.environ.get("REMESH", "remesh"), part, "-o", "part.json"], check=True)
with open("part.json", encoding="utf-8") as file:
    mesh = json.load(file)["mesh"]
points, faces, labels = mesh["vertices"], mesh["faces"], mesh.get("labels", {})

label = sys.argv[2] if len(sys.argv) > 2 else next((kind for kind in ("material", "group", "object") if kind in labels), "")
names = labels[label]["names"] if label else ["all"]
name_of_face = labels[label]["of_face"] if label else [0] * len(faces)
# Materials in the order in which the part has them; only those that have faces get a number.
order = sorted(range(len(faces)), key=lambda face: name_of_face[face])


def word(name):
    """The readers take the first word of a name."""
    return "_".join(name.split()) or "none"


def normal(face):
    a, b, c = (points[corner] for corner in face)
    u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
    product = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = sum(x * x for x in product) ** 0.5
    return [x / length for x in product]


def side(edge):
    """The side of the box around the sheet on which an edge of its rim lies."""
    for axis, letter in enumerate("xy"):
        values = [point[axis] for point in points]
        for end, value in (("min", min(values)), ("max", max(values))):
            if all(points[corner][axis] == value for corner in edge):
                return letter + end
    return "inner"


def record(keyword, values):
    return " ".join([keyword, *(repr(value) for value in values)])


edges = collections.Counter(frozenset(edge) for face in faces for edge in zip(face, face[1:] + face[:1]))
rim = [sorted(edge) for edge, count in edges.items() if count == 1]
if rim and any(point[2] != 0 for point in points):
    sys.exit("opensn.py: the part is neither closed nor a sheet in the plane z = 0")
if rim:
    # Cells of two dimensions are seen from above.
    faces = [face if normal(face)[2] > 0 else face[::-1] for face in faces]

records = ["# for OpenSn and ChiTech", "o part"]
records += [record("v", map(float, point)) for point in points]
records += [record("vn", normal(faces[face])) for face in order]
materials = {}
for number, face in enumerate(order, 1):
    if name_of_face[face] not in materials:
        materials[name_of_face[face]] = word(names[name_of_face[face]])
        records.append(f"usemtl {materials[name_of_face[face]]}")
    records.append("f " + " ".join(f"{corner + 1}//{number}" for corner in faces[face]))
boundaries = collections.defaultdict(list)
for edge in sorted(rim):
    boundaries[side(edge)].append(edge)
for name, members in sorted(boundaries.items()):
    records.append(f"o {name}")
    records += [f"l {a + 1} {b + 1}" for a, b in members]

with open("part.obj", "w", encoding="utf-8") as file:
    file.write("\n".join(records) + "\n")
for kind, told in (("material", materials.values()), ("boundary", sorted(boundaries))):
    for number, name in enumerate(told):
        print(f"{kind} {number}: {name}")
