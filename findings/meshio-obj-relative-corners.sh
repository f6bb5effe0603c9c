#!/usr/bin/env bash
# In an OBJ file, a face may count its corners back from where it stands: -1 is the last vertex so far, -2 the one
# before it. Programs that write a file part by part use that, since no part then has to know how many vertices are in
# front of it. meshio 5.0.0 takes such a number as it is and subtracts one from it, as it does from the numbers of
# vertices, so that -1 becomes -2. There is no error, and the numbers even work: numpy counts negative ones back from
# the end of the whole list. So each face has other vertices than in the file, and equal numbers of different parts are
# the same face. Of a file of three parts, meshio makes the last part three times, one vertex off. In an OBJ file made
# of it the faces stand behind all vertices, so it has the last part three times, and no face of the first two. An STL
# file has three equal triangles. A VTU file has negative numbers of points, which is not allowed there. meshio does not
# say a word about the numbers; for the VTU file it warns that text is for debugging, as it always does.
#
# Wavefront's description of OBJ has negative numbers as a regular way to refer to vertices, relative to the place of
# the face in the file. meshio's reader does not mention them.
#
# Seen with Debian's python3-meshio 7.0.0-3, which is meshio 5.0.0, for triangles at z = 0, z = 5 and z = 9, each after
# its own vertices:
#   numbered from 1: z = 0 0 0, z = 5 5 5, z = 9 9 9
#   counted back: z = 5 9 9, z = 5 9 9, z = 5 9 9
#   counted back, as OBJ: f -3 -2 -1, f -3 -2 -1, f -3 -2 -1
#   counted back, as STL: z = 5 9 9, z = 5 9 9, z = 5 9 9
#   counted back, as VTU: connectivity -4 -3 -2 -4 -3 -2 -4 -3 -2
#
# This script fetches that package and what it imports into a temporary folder, reads and writes these files, and fails
# if the behaviour is no longer so. It needs Debian bookworm's package lists and its Python 3.11, and changes nothing
# outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

packages=(python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 python3-pygments
  python3-markdown-it python3-mdurl python3-importlib-metadata python3-zipp libblas3 liblapack3 libgfortran5
  libquadmath0)
apt-get download -qq "${packages[@]}" 2>/dev/null
for package in *.deb; do dpkg -x "$package" root; done

# A triangle at each height, with its vertices in front of it.
first=1
for z in 0 5 9; do
  printf 'v 0 0 %d\nv 1 0 %d\nv 0 1 %d\n' $z $z $z | tee -a numbered.obj >>counted.obj
  echo "f $first $((first + 1)) $((first + 2))" >>numbered.obj
  echo 'f -3 -2 -1' >>counted.obj
  first=$((first + 3))
done

cat >read.py <<'PYTHON'
import re

import meshio

assert meshio.__version__ == "5.0.0", meshio.__version__
seen = []

def heights(mesh):
    triangles = [cell for block in mesh.cells for cell in block.data]
    return ", ".join("z = " + " ".join(f"{z:g}" for z in mesh.points[cell][:, 2]) for cell in triangles)

seen.append(f"numbered from 1: {heights(meshio.read('numbered.obj'))}")
mesh = meshio.read("counted.obj")
seen.append(f"counted back: {heights(mesh)}")
meshio.write("again.obj", mesh)
lines = [line.strip() for line in open("again.obj")]
faces = [line for line in lines if line.startswith("f ")]
assert [line for line in lines if line.startswith(("v ", "f "))][-3:] == faces # all vertices come first
seen.append(f"counted back, as OBJ: {', '.join(faces)}")
meshio.write("again.stl", mesh)
corners = [line.split()[3] for line in open("again.stl") if line.split()[:1] == ["vertex"]]
triangles = [corners[at:at + 3] for at in range(0, len(corners), 3)]
told = ", ".join("z = " + " ".join(f"{float(z):g}" for z in triangle) for triangle in triangles)
seen.append(f"counted back, as STL: {told}")
meshio.vtu.write("again.vtu", mesh, binary=False)
numbers = re.search(r'Name="connectivity"[^>]*>([^<]*)<', open("again.vtu").read()).group(1)
seen.append(f"counted back, as VTU: connectivity {' '.join(numbers.split())}")
print("\n".join(seen))
expected = [
    "numbered from 1: z = 0 0 0, z = 5 5 5, z = 9 9 9",
    "counted back: z = 5 9 9, z = 5 9 9, z = 5 9 9",
    "counted back, as OBJ: f -3 -2 -1, f -3 -2 -1, f -3 -2 -1",
    "counted back, as STL: z = 5 9 9, z = 5 9 9, z = 5 9 9",
    "counted back, as VTU: connectivity -4 -3 -2 -4 -3 -2 -4 -3 -2",
]
assert seen == expected, "it has changed"
PYTHON
libraries=$folder/root/usr/lib/x86_64-linux-gnu
PYTHONPATH=$folder/root/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$libraries:$libraries/blas:$libraries/lapack \
  /usr/bin/python3.11 -B -S read.py >output 2>&1 || { cat output; exit 1; }
grep -v 'VTU ASCII files are only meant for debugging' output | tee told
if grep -v '^counted\|^numbered' told; then echo "it has changed: meshio tells"; exit 1; fi
