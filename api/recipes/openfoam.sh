#!/bin/sh
# Makes a surface for OpenFOAM, and the part of system/snappyHexMeshDict that names its patches: openfoam.sh PART [LABEL]
# It writes constant/triSurface/part.stl, with a solid for each boundary, and system/part.geometry, which snappyHexMeshDict
# includes: geometry { #include "part.geometry" }. LABEL is what names the boundaries: auto, object, group, material, patch or
# surface.
set -eu
mkdir -p constant/triSurface system
"${REMESH:-remesh}" "$1" -o constant/triSurface/part.stl --format stl_ascii --preset volume --label "${2:-auto}"
{
  echo 'part.stl'
  echo '{'
  echo '    type triSurfaceMesh;'
  echo '    name part;'
  echo '    regions'
  echo '    {'
  sed -n 's/^solid \(.*\)$/        \1 { name \1; }/p' constant/triSurface/part.stl
  echo '    }'
  echo '}'
} >system/part.geometry
surfaceCheck constant/triSurface/part.stl
