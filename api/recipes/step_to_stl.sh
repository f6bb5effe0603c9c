#!/bin/sh
# Makes triangles of a STEP file: step_to_stl.sh PART.step [EDGES]
# EDGES are the edges of a full turn: 40 are 0.3 % of the radius away from the true surface, 16 are 2 %. It takes Gmsh, or
# FreeCAD where there is no Gmsh, by the angle between facets and a distance of a thousandth of the size.
set -eu
edges=${2:-40}
if command -v gmsh >/dev/null; then
  gmsh "$1" -2 -clcurv "$edges" -o part.stl
else
  PART=$1 EDGES=$edges freecadcmd <<'PYTHON'
import math, os, Part, MeshPart
shape = Part.Shape(); shape.read(os.environ["PART"])
angle = 2 * math.pi / int(os.environ["EDGES"])
MeshPart.meshFromShape(shape, LinearDeflection=shape.BoundBox.DiagonalLength / 1000, AngularDeflection=angle).write("part.stl")
PYTHON
fi
