#!/usr/bin/env bash
# An input file of Abaqus or CalculiX may have its nodes and elements in several blocks, and the line of a block of
# elements may say to which set they belong: *ELEMENT, TYPE=S3, ELSET=INLET. meshio 5.0.0 gives the first such set to
# the first block, the second one to the second, and so on, although blocks without a set count as well. So if a wall
# without a set comes first, elements of the wall are the inlet, and those of the inlet are in no set. If two blocks
# name the same set, as triangles and quadrilaterals of one boundary do, both get the elements' numbers of the last one.
# And each block *NODE replaces all nodes that were read before, while elements that are already there keep their
# numbers: a bottom and a top, each with its nodes before its elements, come out as two copies of the top. There is no
# warning.
#
# The manuals of Abaqus and CalculiX have ELSET assign the elements of that block to the set, and let a set grow if it
# is named again, and *NODE come again. CalculiX 2.20 takes all elements of such files, and each into its set.
#
# Seen with Debian's python3-meshio 7.0.0-3, which is meshio 5.0.0:
#   inlet: INLET has 2 quad, 0 triangle           3 quadrilaterals without a set, then 2 triangles in INLET
#   shared: SKIN has 2 quad, 2 triangle           3 quadrilaterals and 2 triangles, all in SKIN
#   layers: 3 points, triangles at z = 5, 5       a triangle at z = 0 and one at z = 5, each after its nodes
#
# This script fetches that package and what it imports into a temporary folder, reads the three files, and fails if the
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

nodes='*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 2., 0., 0.
4, 3., 0., 0.
5, 0., 1., 0.
6, 1., 1., 0.
7, 2., 1., 0.
8, 3., 1., 0.
9, 4., 0., 0.
10, 4., 1., 0.'
quadrilaterals='1, 1, 2, 6, 5
2, 2, 3, 7, 6
3, 3, 4, 8, 7'
triangles='4, 4, 9, 8
5, 9, 10, 8'
printf '%s\n' "$nodes" '*ELEMENT, TYPE=S4' "$quadrilaterals" '*ELEMENT, TYPE=S3, ELSET=INLET' "$triangles" >inlet.inp
printf '%s\n' "$nodes" '*ELEMENT, TYPE=S4, ELSET=SKIN' "$quadrilaterals" '*ELEMENT, TYPE=S3, ELSET=SKIN' \
  "$triangles" >shared.inp
cat >layers.inp <<'INP'
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
*ELEMENT, TYPE=S3, ELSET=BOTTOM
1, 1, 2, 3
*NODE
4, 0., 0., 5.
5, 1., 0., 5.
6, 0., 1., 5.
*ELEMENT, TYPE=S3, ELSET=TOP
2, 4, 5, 6
INP

cat >read.py <<'PYTHON'
import meshio

assert meshio.__version__ == "5.0.0", meshio.__version__
seen = []
for name in ("inlet", "shared"):
    mesh = meshio.read(name + ".inp")
    assert [(block.type, len(block.data)) for block in mesh.cells] == [("quad", 3), ("triangle", 2)]
    for label, blocks in mesh.cell_sets.items():
        sizes = (f"{len(cells)} {block.type}" for cells, block in zip(blocks, mesh.cells))
        seen.append(f"{name}: {label} has {', '.join(sizes)}")
mesh = meshio.read("layers.inp")
heights = (f"{mesh.points[cell[0]][2]:g}" for block in mesh.cells for cell in block.data)
seen.append(f"layers: {len(mesh.points)} points, triangles at z = {', '.join(heights)}")
print("\n".join(seen))
expected = [
    "inlet: INLET has 2 quad, 0 triangle",
    "shared: SKIN has 2 quad, 2 triangle",
    "layers: 3 points, triangles at z = 5, 5",
]
assert seen == expected, "it has changed"
PYTHON
libraries=$folder/root/usr/lib/x86_64-linux-gnu
PYTHONPATH=$folder/root/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$libraries:$libraries/blas:$libraries/lapack \
  /usr/bin/python3.11 -B -S read.py 2>&1 | tee output
if grep -qi warning output; then echo "it has changed: meshio tells"; exit 1; fi
