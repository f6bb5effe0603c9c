#!/bin/sh
# Fills a part with tetrahedra by Gmsh: gmsh.sh PART [LABEL]
# It writes filled.msh, in which the boundaries and the volume are physical groups. The triangles stay as they are. LABEL is
# what names the boundaries: auto, object, group, material, patch or surface.
set -eu
"${REMESH:-remesh}" "$1" -o part.msh --preset volume --label "${2:-auto}"
# Gmsh's own lines that make volumes of the surfaces stand in the comments of the file, and in the report as `recipe`.
{ echo 'Merge "part.msh";'; grep ';$' part.msh; } >part.geo
gmsh -3 part.geo -o filled.msh
