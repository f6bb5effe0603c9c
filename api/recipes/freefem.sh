#!/bin/sh
# Fills a part with tetrahedra in FreeFEM and tells the area of each boundary: freefem.sh PART [LABEL]
# The labels of FreeFEM are the references of part.mesh, whose comments have their names. LABEL is what names the boundaries:
# auto, object, group, material, patch or surface.
set -eu
"${REMESH:-remesh}" "$1" -o part.mesh --preset volume --label "${2:-auto}"
cat >part.edp <<'EDP'
load "msh3"
load "tetgen"
meshS surface = readmeshS("part.mesh");
// Without A, which numbers the regions, tetg of FreeFEM 4.11 ends with a segmentation fault.
mesh3 filled = tetg(surface, switch = "pqAAYYQ");
cout << "volume " << int3d(filled)(1.) << endl;
int[int] boundaries = labels(filled);
for (int i = 0; i < boundaries.n; i++)
  cout << "boundary " << boundaries[i] << " " << int2d(filled, boundaries[i])(1.) << endl;
EDP
FreeFem++ -nw part.edp
