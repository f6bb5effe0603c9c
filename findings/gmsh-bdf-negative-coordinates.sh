#!/usr/bin/env bash
# How many digits of a coordinate Gmsh 4.8.4 writes to a Nastran file (.bdf) depends on its sign. Unless told otherwise
# it writes fields of 8 characters. Below 0.001 and from a million on, a positive coordinate keeps three digits there
# and a negative one two. In between, a negative one is cut off where the field ends, and not rounded. So a part that is
# symmetric is not any more, one that is given in metres has thin walls that are some per cent off, and a house at map
# coordinates comes out as one point. Gmsh says that it is done, without a warning, and reads the file back without one.
#
# Fields of 8 characters can hold more. Nastran's description of bulk data lets a real number have its exponent without
# the E, as -1.24-4 or -1.235+6, and Nastran programs write them so; 1234568. has 8 characters and seven digits. Gmsh's
# list of options (gmsh -help_options) has Mesh.BdfFieldFormat for the kind of the fields, 0 for free, 1 for small, 2
# for large, and says nothing of digits or signs. With 0, the numbers are the same as with 1. With 2 they are right.
#
# Seen with Debian's gmsh 4.8.4+ds2-3, a coordinate and what the file has:
#        0.000124   1.24E-04          -0.000124   -1.2E-04    which is 3 % off
#        1000.129   1000.129          -1000.129   -1000.12    the nearest in 8 characters is -1000.13
#        123456.9   123456.9          -123456.9   -123456.    the nearest in 8 characters is -123457.
#       1234567.8   1.23E+06         -1234567.8   -1.2E+06    which is 34567.8 off
# A square of 1 by 1 at x = 1234567 and y = 5345678 has its four vertices in one place: 1.23E+06 5.35E+06.
#
# This script fetches that package, and all that it needs, into a temporary folder, converts two small meshes, and fails
# if the behaviour is no longer so. It needs Debian bookworm's package lists, and changes nothing outside of the folder.
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
export LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$libraries:$libraries/blas:$libraries/lapack HOME=$folder
gmsh() { "$folder/root/usr/bin/gmsh" "$@"; }
version=$(gmsh -version 2>&1)
echo "gmsh $version"
test "$version" = 4.8.4

# Two triangles in Gmsh's own format, from four lines of coordinates.
mesh() {
  # shellcheck disable=SC2016 # the names of the sections begin with a dollar sign
  printf '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 %s\n2 %s\n3 %s\n4 %s\n$EndNodes\n' "$@"
  # shellcheck disable=SC2016
  printf '$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n'
}
# The coordinates of the four nodes in a file with fields of 8 characters, a node a line.
coordinates() { sed -n 's/^GRID.\{20\}\(.\{8\}\)\(.\{8\}\)\(.\{8\}\).*/\1 \2 \3/p' "$1"; }

mesh '0.000124 1000.129 123456.9' '-0.000124 -1000.129 -123456.9' '1234567.8 0 0' '-1234567.8 0 0' >signs.msh
mesh '1234567 5345678 0' '1234568 5345678 0' '1234568 5345679 0' '1234567 5345679 0' >map.msh
{
  gmsh -save signs.msh -o signs.bdf
  gmsh -save map.msh -o map.bdf
  gmsh -save signs.bdf -o back.msh -format msh2
  gmsh -save -setnumber Mesh.BdfFieldFormat 0 signs.msh -o free.bdf
  gmsh -save -setnumber Mesh.BdfFieldFormat 2 signs.msh -o large.bdf
} >log 2>&1
if grep -iE 'warning|error' log; then echo "it has changed: Gmsh tells"; exit 1; fi

echo "positive and negative coordinates in signs.bdf:"
coordinates signs.bdf | tee signs.seen
echo "a square of 1 by 1 in map.bdf:"
coordinates map.bdf | tee map.seen
diff - signs.seen <<'SEEN'
1.24E-04 1000.129 123456.9
-1.2E-04 -1000.12 -123456.
1.23E+06 0.00E+00 0.00E+00
-1.2E+06 0.00E+00 0.00E+00
SEEN
test "$(sort -u map.seen)" = '1.23E+06 5.35E+06 0.00E+00'
grep -qx 'GRID,2,0,-1.2E-04,-1000.12,-123456.' free.bdf                 # free fields are no better
grep -q '^GRID\* *4 *0 *-1234567.8 ' large.bdf                          # large ones are right
grep -qx '2 -0.00012 -1000.12 -123456' back.msh                         # and this is what Gmsh reads back
