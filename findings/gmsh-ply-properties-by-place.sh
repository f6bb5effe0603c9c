#!/usr/bin/env bash
# The header of a PLY file names what each vertex and each face has, and in which order. Gmsh 4.8.4 goes by the place
# and not by the name: the first three numbers of a vertex are its coordinates, and the second to the fourth number of a
# face are its corners. So where normals stand before the coordinates, each vertex is put at its normal, and a flat part
# becomes one point. Where a label or a colour stands before the corners of a face, its number of corners is taken for
# its first corner, and its last one is left out. And of each quadrilateral one half is left out, so that a box has half
# of its surface. Gmsh says how many properties it saw, has no warning, and writes the result to any other format.
#
# Turk's description of the format ("The PLY Polygon File Format") has the lines "property" define the order in which an
# element has its properties, and lets programs add properties of their own. A face has any number of corners there.
#
# Seen with Debian's gmsh 4.8.4+ds2-3, for a box of 2 by 3 by 5, whose surface is 62:
#   plain: 12 facets, surface 62, from 0 0 0 to 2 3 5               coordinates and corners first
#   normals: 12 facets, surface 0, from 0 0 1 to 0 0 1              normals before the coordinates
#   label: 12 facets, surface 43.91, from 0 0 0 to 2 3 5            a label before the corners
#   quadrilaterals: 6 facets, surface 31, from 0 0 0 to 2 3 5       coordinates and corners first again
#
# This script fetches that package, and all that it needs, into a temporary folder, converts four files to STL, and
# fails if the behaviour is no longer so. It needs Debian bookworm's package lists and python3, and changes nothing
# outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that Gmsh needs: about 110 packages, 105 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install gmsh=4.8.4+ds2-3 >apt.log 2>&1 || { cat apt.log; exit 1; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
libraries=$folder/root/usr/lib/x86_64-linux-gnu
gmsh() {
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$libraries:$libraries/blas:$libraries/lapack HOME=$folder \
    "$folder/root/usr/bin/gmsh" "$@"
}
version=$(gmsh -version 2>&1)
echo "gmsh $version"
test "$version" = 4.8.4

cat >write.py <<'PYTHON'
vertices = [(x, y, z) for z in (0, 5) for x, y in ((0, 0), (2, 0), (2, 3), (0, 3))]
sides = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
triangles = [corners for a, b, c, d in sides for corners in ((a, b, c), (a, c, d))]
normal = ("nx", "ny", "nz")

def write(path, faces, before_vertex=(), before_face=()):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property float {name}" for name in (*before_vertex, "x", "y", "z")]
    lines += [f"element face {len(faces)}"] + [f"property int {name}" for name in before_face]
    lines += ["property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, ((0, 0, 1) if before_vertex else ()) + vertex)) for vertex in vertices]
    lines += [" ".join(map(str, ((3,) if before_face else ()) + (len(face), *face))) for face in faces]
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")

write("plain.ply", triangles)
write("normals.ply", triangles, before_vertex=normal)
write("label.ply", triangles, before_face=("label",))
write("quadrilaterals.ply", sides)
PYTHON
cat >measure.py <<'PYTHON'
import sys

lines = [line.split() for line in open(sys.argv[1])]
corners = [tuple(map(float, line[1:])) for line in lines if line[:1] == ["vertex"]]
surface = 0
for at in range(0, len(corners), 3):
    a, b, c = corners[at:at + 3]
    u, v = ([q - p for p, q in zip(a, end)] for end in (b, c))
    cross = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
    surface += sum(x * x for x in cross) ** 0.5 / 2
low, high = (" ".join(f"{end(column):g}" for column in zip(*corners)) for end in (min, max))
print(f"{len(corners) // 3} facets, surface {surface:.4g}, from {low} to {high}")
PYTHON
python3 write.py
for name in plain normals label quadrilaterals; do
  gmsh -save $name.ply -o $name.stl -format stl >$name.log 2>&1
  if grep -iE 'warning|error' $name.log; then echo "it has changed: Gmsh tells"; exit 1; fi
  echo "$name: $(python3 measure.py $name.stl)"
done | tee seen
diff - seen <<'SEEN'
plain: 12 facets, surface 62, from 0 0 0 to 2 3 5
normals: 12 facets, surface 0, from 0 0 1 to 0 0 1
label: 12 facets, surface 43.91, from 0 0 0 to 2 3 5
quadrilaterals: 6 facets, surface 31, from 0 0 0 to 2 3 5
SEEN
