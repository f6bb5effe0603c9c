"""Fills a part with tetrahedra by Netgen: netgen.py PART [LABEL]

It writes part.vol, in which the boundaries have their names. Netgen's own readers of files lose boundaries or refuse surfaces, so
the triangles are handed over. LABEL is what names the boundaries: auto, object, group, material, patch or surface.
"""

import os
import re
import subprocess
import sys

# This file must not be taken for Netgen's module, which has the same name.
sys.path = [path for path in sys.path if os.path.abspath(path) != os.path.dirname(os.path.abspath(__file__))]
from netgen.csg import Pnt  # noqa: E402
from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint  # noqa: E402


def main():
    part, label = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "auto"
    remesh = os.environ.get("REMESH", "remesh")
    subprocess.run([remesh, part, "-o", "part.mesh", "--preset", "volume", "--label", label], check=True)
    with open("part.mesh", encoding="utf-8") as file:
        lines = file.read().splitlines()
    names = dict(re.match(r"# reference (\d+): (.*)", line).groups() for line in lines if line.startswith("# reference"))
    points_begin, faces_begin = lines.index("Vertices") + 2, lines.index("Triangles") + 2
    mesh = Mesh(dim=3)
    points = [mesh.Add(MeshPoint(Pnt(*map(float, line.split()[:3])))) for line in lines[points_begin : faces_begin - 2]]
    for number, name in names.items():
        mesh.Add(FaceDescriptor(surfnr=int(number), domin=1, domout=0, bc=int(number)))
        mesh.SetBCName(int(number) - 1, name)
    for line in lines[faces_begin : lines.index("End")]:
        *corners, reference = map(int, line.split())
        mesh.Add(Element2D(reference, [points[v - 1] for v in corners]))
    mesh.GenerateVolumeMesh()
    mesh.Save("part.vol")
    print(f"{len(mesh.Elements3D())} tetrahedra, boundaries {', '.join(names.values())}")


main()
