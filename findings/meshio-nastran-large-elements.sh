#!/usr/bin/env bash
# Each line of a Nastran file may have its numbers in fields of 8 or of 16 characters; an asterisk behind the first word
# says that they have 16. meshio 5.0.0 knows that of points (GRID*), but of no element: it passes over CTRIA3*,
# CQUAD4*, CTETRA* and the rest as if they were words that it need not know. Where some elements of a file have such
# fields, these are missing; where all have, what comes out is a cloud of points. There is no warning and no error.
# meshio writes such lines itself if it is asked for them (cell_format="fixed-large"), and reads its own file back
# without any element.
#
# And a point may have its coordinates in a system of its own, which the third field of GRID names: CORD2C is a
# cylinder's (radius, angle in degrees, height). meshio takes such coordinates as they stand for x, y and z. A point of
# the radius 2 at 90 degrees, which is x = 0, y = 2, comes out at x = 2, y = 90. The number of the system is kept as
# point data with the name nastran:ref, but its description, and so the place of the point, is not to be had. If some
# points name a system and others do not, there are fewer numbers than points, and nothing tells which they belong to.
#
# Nastran's description of bulk data has all entries in either width, mixed as one likes, and the third field of GRID as
# the coordinate system in which the point is given. meshio's own comments in its reader cite that description.
#
# Seen with Debian's python3-meshio 7.0.0-3, which is meshio 5.0.0:
#   small.bdf: 4 points, 2 triangles                 two CTRIA3
#   mixed.bdf: 4 points, 1 triangles                 one CTRIA3, and the other as CTRIA3*
#   large.bdf: 4 points, 0 triangles                 two CTRIA3*
#   written with cell_format fixed-small: 4 points, 2 triangles when read again
#   written with cell_format fixed-large: 4 points, 0 triangles when read again
#   cylinder.bdf: points 0 0 0, 2 0 0, 2 90 0, nastran:ref 5, 5
#
# This script fetches that package and what it imports into a temporary folder, reads these files, and fails if the
# behaviour is no longer so. It needs Debian bookworm's package lists and its Python 3.11, and changes nothing outside
# of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

packages=(python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 python3-pygments
  python3-markdown-it python3-mdurl python3-importlib-metadata python3-zipp libblas3 liblapack3 libgfortran5
  libquadmath0)
apt-get download -qq "${packages[@]}" 2>/dev/null
for package in *.deb; do dpkg -x "$package" root; done

# A square of four points, and the triangles that are given: "123" or "134", with an asterisk for wide fields.
nastran() {
  printf 'BEGIN BULK\n'
  printf 'GRID    %-16s%-8s%-8s%-8s\n' 1 0. 0. 0. 2 1. 0. 0. 3 1. 1. 0. 4 0. 1. 0.
  local number=0 triangle corners
  for triangle in "$@"; do
    number=$((number + 1))
    corners=("${triangle:0:1}" "${triangle:1:1}" "${triangle:2:1}")
    if [[ $triangle = *'*' ]]; then
      printf 'CTRIA3* %-16d%-16d%-16s%-16s\n*       %-16s\n' $number 1 "${corners[@]}"
    else
      printf 'CTRIA3  %-8d%-8d%-8s%-8s%-8s\n' $number 1 "${corners[@]}"
    fi
  done
  printf 'ENDDATA\n'
}
nastran 123 134 >small.bdf
nastran 123 '134*' >mixed.bdf
nastran '123*' '134*' >large.bdf
cat >cylinder.bdf <<'BDF'
BEGIN BULK
CORD2C  5               0.      0.      0.      0.      0.      1.
+       1.      0.      0.
GRID    1               0.      0.      0.
GRID    2       5       2.      0.      0.
GRID    3       5       2.      90.     0.
CTRIA3  1       1       1       2       3
ENDDATA
BDF

cat >read.py <<'PYTHON'
import meshio

assert meshio.__version__ == "5.0.0", meshio.__version__
seen = []

def count(mesh):
    assert all(block.type == "triangle" for block in mesh.cells)
    return f"{len(mesh.points)} points, {sum(len(block.data) for block in mesh.cells)} triangles"

for name in ("small", "mixed", "large"):
    seen.append(f"{name}.bdf: {count(meshio.read(name + '.bdf'))}")
mesh = meshio.read("small.bdf")
for width in ("fixed-small", "fixed-large"):
    meshio.nastran.write(width + ".bdf", mesh, cell_format=width)
    lines = [line for line in open(width + ".bdf") if line.startswith("CTRIA3")]
    assert len(lines) == 2 and all(line.startswith("CTRIA3*") == (width == "fixed-large") for line in lines)
    seen.append(f"written with cell_format {width}: {count(meshio.read(width + '.bdf'))} when read again")
mesh = meshio.read("cylinder.bdf")
points = ", ".join(" ".join(f"{x:g}" for x in point) for point in mesh.points)
systems = ", ".join(str(system) for system in mesh.point_data["nastran:ref"])
seen.append(f"cylinder.bdf: points {points}, nastran:ref {systems}")
print("\n".join(seen))
expected = [
    "small.bdf: 4 points, 2 triangles",
    "mixed.bdf: 4 points, 1 triangles",
    "large.bdf: 4 points, 0 triangles",
    "written with cell_format fixed-small: 4 points, 2 triangles when read again",
    "written with cell_format fixed-large: 4 points, 0 triangles when read again",
    "cylinder.bdf: points 0 0 0, 2 0 0, 2 90 0, nastran:ref 5, 5",
]
assert seen == expected, "it has changed"
PYTHON
libraries=$folder/root/usr/lib/x86_64-linux-gnu
PYTHONPATH=$folder/root/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$libraries:$libraries/blas:$libraries/lapack \
  /usr/bin/python3.11 -B -S read.py 2>&1 | tee output
if grep -qi warning output; then echo "it has changed: meshio tells"; exit 1; fi
