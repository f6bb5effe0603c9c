#!/usr/bin/env bash
# An AMF file may place copies of its objects: an instance has a shift (deltax, deltay, deltaz) and three angles in
# degrees (rx, ry, rz). Assimp 5.2.5 takes the angles for shifts. Each angle that is written replaces the shift along
# its axis, and nothing is ever turned. So a copy that is to be turned by 90 degrees about z stands 90 millimetres too
# high, as it was. Worse is the harmless looking case: where the angles are written as zeros, as PrusaSlicer writes them
# for every part, all copies come out at the origin, one inside the other. There is no warning. A file that has shifts
# only is read rightly.
#
# AMF's standard (ISO/ASTM 52915, on constellations) has the angles in degrees, about x first, then y, then z. All of
# the six elements may be left out, so the same placement can be written with and without zeros.
#
# Seen with Debian's assimp-utils 5.2.5~ds0-1+b1, for copies of a part of 10 by 20 by 30 millimetres, with one corner at
# the origin:
#   shifted: 100 0 0 to 110 20 30, 200 0 0 to 210 20 30     copies at x = 100 and x = 200
#   zeros: 0 0 0 to 10 20 30, 0 0 0 to 10 20 30             the same, with angles of zero
#   turned: 100 0 90 to 110 20 120                          at x = 100, turned by 90; right is 80 0 0 to 100 10 30
#
# This script fetches that package, and all that it needs, into a temporary folder, converts three files to STL, and
# fails if the behaviour is no longer so. It needs Debian bookworm's package lists and python3, and changes nothing
# outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that assimp needs: 9 packages, 7 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install assimp-utils=5.2.5~ds0-1+b1 >apt.log 2>&1 || { cat apt.log; exit 1; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
assimp() {
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$folder/root/usr/lib/x86_64-linux-gnu \
    "$folder/root/usr/bin/assimp" "$@"
}
sed -n 's/^Version:/assimp-utils/p' <(dpkg -f archives/assimp-utils_*.deb)

# A tetrahedron with edges of 10, 20 and 30 along the axes, and the instances that the arguments are.
amf() {
  cat <<'AMF'
<?xml version="1.0" encoding="UTF-8"?>
<amf unit="millimeter" version="1.1">
  <object id="1">
    <mesh>
      <vertices>
        <vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates></vertex>
        <vertex><coordinates><x>10</x><y>0</y><z>0</z></coordinates></vertex>
        <vertex><coordinates><x>0</x><y>20</y><z>0</z></coordinates></vertex>
        <vertex><coordinates><x>0</x><y>0</y><z>30</z></coordinates></vertex>
      </vertices>
      <volume>
        <triangle><v1>0</v1><v2>2</v2><v3>1</v3></triangle>
        <triangle><v1>0</v1><v2>1</v2><v3>3</v3></triangle>
        <triangle><v1>1</v1><v2>2</v2><v3>3</v3></triangle>
        <triangle><v1>2</v1><v2>0</v2><v3>3</v3></triangle>
      </volume>
    </mesh>
  </object>
  <constellation id="2">
AMF
  printf '    <instance objectid="1">%s</instance>\n' "$@"
  printf '  </constellation>\n</amf>\n'
}
zeros='<rx>0</rx><ry>0</ry><rz>0</rz>'
amf '<deltax>100</deltax>' '<deltax>200</deltax>' >shifted.amf
amf "<deltax>100</deltax>$zeros" "<deltax>200</deltax>$zeros" >zeros.amf
amf '<deltax>100</deltax><rz>90</rz>' >turned.amf

cat >boxes.py <<'PYTHON'
import sys

# The box around each four facets of a text STL file, which are a copy of the part.
lines = [line.split() for line in open(sys.argv[1])]
corners = [tuple(map(float, line[1:])) for line in lines if line[:1] == ["vertex"]]
boxes = []
for at in range(0, len(corners), 12):
    columns = list(zip(*corners[at:at + 12]))
    boxes.append(" to ".join(" ".join(f"{end(column):g}" for column in columns) for end in (min, max)))
print(", ".join(boxes))
PYTHON
for name in shifted zeros turned; do
  assimp export $name.amf $name.stl >$name.log
  if grep -iE 'warn|error' $name.log; then echo "it has changed: assimp tells"; exit 1; fi
  echo "$name: $(python3 boxes.py $name.stl)"
done | tee seen
diff - seen <<'SEEN'
shifted: 100 0 0 to 110 20 30, 200 0 0 to 210 20 30
zeros: 0 0 0 to 10 20 30, 0 0 0 to 10 20 30
turned: 100 0 90 to 110 20 120
SEEN
