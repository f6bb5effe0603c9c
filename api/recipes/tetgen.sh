#!/bin/sh
# Fills a part with tetrahedra by TetGen: tetgen.sh PART [LABEL]
# It writes part.1.node, part.1.ele and part.1.face. The last column of part.1.face is the number of a boundary, whose name
# stands in the comments of part.smesh; the last column of part.1.ele is the number of the solid. LABEL is what names the
# boundaries: auto, object, group, material, patch or surface.
set -eu
"${REMESH:-remesh}" "$1" -o part.smesh --preset volume --label "${2:-auto}"
tetgen -pqAY part.smesh
