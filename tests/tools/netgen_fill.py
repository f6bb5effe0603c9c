#!/usr/bin/env python3
"""Fills a closed surface of triangles with tetrahedra by Netgen, which keeps the surface.

usage: netgen_fill.py SURFACE NAME

Needs Debian's python3-netgen. Writes NAME.node and NAME.ele as TetGen does. Exit code: 0 if the volume is filled; 1 if
not, with a line "netgen: ..." that says why.
"""

import sys

import dihedral
import surface_files
from netgen import meshing


def mesh_of(surface):
    mesh = meshing.Mesh(dim=3)
    points = [mesh.Add(meshing.MeshPoint(meshing.Pnt(*point))) for point in surface.points]
    inside = mesh.Add(meshing.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    is_inside_out = dihedral.signed_volume(surface) < 0
    for face in surface.faces:
        corners = face[::-1] if is_inside_out else face
        mesh.Add(meshing.Element2D(inside, [points[corner] for corner in corners]))
    return mesh


def write_mesh(mesh, name):
    points = [point.p for point in mesh.Points()]
    with open(f"{name}.node", "w", encoding="ascii") as out:
        out.write(f"{len(points)} 3 0 0\n")
        for i, (x, y, z) in enumerate(points, 1):
            out.write(f"{i} {x!r} {y!r} {z!r}\n")
    tetrahedra = [[corner.nr for corner in element.vertices] for element in mesh.Elements3D()]
    with open(f"{name}.ele", "w", encoding="ascii") as out:
        out.write(f"{len(tetrahedra)} 4 0\n")
        for i, corners in enumerate(tetrahedra, 1):
            out.write(f"{i} " + " ".join(map(str, corners)) + "\n")


def main(path, name):
    mesh = mesh_of(surface_files.read_surface(path))
    try:
        mesh.GenerateVolumeMesh(meshing.MeshingParameters())
    except Exception as error:  # its own exceptions have no common type here
        print("netgen:", str(error).strip().splitlines()[-1])
        return 1
    if len(mesh.Elements3D()) == 0:
        print("netgen: no volume")
        return 1
    write_mesh(mesh, name)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
