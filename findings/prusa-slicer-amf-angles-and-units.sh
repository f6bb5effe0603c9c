#!/usr/bin/env bash
# An AMF file says which unit its coordinates have, and may place copies of its objects, turned by angles in degrees
# (rx, ry, rz). PrusaSlicer 2.5.0 takes the angles for radians, and does not look at the unit. So a copy that is to be
# turned by 90 degrees is turned by 90 radians, which is 116.6 degrees after fourteen full turns, and stands askew. A
# part in inches comes out as if they were millimetres, 25.4 times too small. There is no warning of either. Of the same
# part in inches as 3MF, PrusaSlicer makes one of the right size.
#
# AMF's standard (ISO/ASTM 52915) has the unit as an attribute of the file, such as millimeter or inch, and the angles
# of an instance in degrees.
#
# Seen with Debian's prusa-slicer 2.5.0+dfsg-4, for a part with edges of 10, 20 and 30 along the axes:
#   straight.amf: edges 10, 20, 30, turned by 0.0 degrees
#   degrees.amf: edges 10, 20, 30, turned by 116.6 degrees     it has an angle of 90
#   radians.amf: edges 10, 20, 30, turned by 90.0 degrees      it has an angle of 1.5707963
#   inches.amf: edges 10, 20, 30, turned by 0.0 degrees
#   inches.3mf: edges 254, 508, 762, turned by 0.0 degrees
#
# This script fetches that package, and all that it needs, into a temporary folder, converts the files to STL, and fails
# if the behaviour is no longer so. It needs Debian bookworm's package lists and python3, and changes nothing outside of
# the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that PrusaSlicer needs: about 260 packages, 209 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install prusa-slicer=2.5.0+dfsg-4 >apt.log 2>&1 || { cat apt.log; exit 1; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
libraries=$folder/root/usr/lib/x86_64-linux-gnu
slicer() {
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$libraries:$libraries/blas:$libraries/lapack HOME=$folder \
    "$folder/root/usr/bin/prusa-slicer" "$@"
}
slicer --help >help 2>&1
grep -o 'PrusaSlicer-2\.5\.0' help

cat >write.py <<'PYTHON'
import zipfile

vertices = [(0, 0, 0), (10, 0, 0), (0, 20, 0), (0, 0, 30)]
facets = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]

def amf(path, unit, angle):
    points = "".join("<vertex><coordinates><x>%d</x><y>%d</y><z>%d</z></coordinates></vertex>" % v for v in vertices)
    triangles = "".join("<triangle><v1>%d</v1><v2>%d</v2><v3>%d</v3></triangle>" % f for f in facets)
    with open(path, "w") as file:
        file.write(
            f'<?xml version="1.0" encoding="UTF-8"?>\n<amf unit="{unit}" version="1.1">\n<object id="1"><mesh>'
            f"<vertices>{points}</vertices><volume>{triangles}</volume></mesh></object>\n"
            f'<constellation id="2"><instance objectid="1"><rz>{angle}</rz></instance></constellation>\n</amf>\n')

def threemf(path, unit):
    points = "".join('<vertex x="%d" y="%d" z="%d"/>' % v for v in vertices)
    triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % f for f in facets)
    head = '<?xml version="1.0" encoding="UTF-8"?>\n'
    package = "http://schemas.openxmlformats.org/package/2006/"
    vendor = "http://schemas.microsoft.com/3dmanufacturing/"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", f'{head}<Types xmlns="{package}content-types">'
            '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        archive.writestr("_rels/.rels", f'{head}<Relationships xmlns="{package}relationships"><Relationship Id="model" '
            f'Target="/3D/part.model" Type="{vendor}2013/01/3dmodel"/></Relationships>')
        archive.writestr("3D/part.model", f'{head}<model unit="{unit}" xmlns="{vendor}core/2015/02">'
            f'<resources><object id="1" type="model"><mesh><vertices>{points}</vertices><triangles>{triangles}'
            '</triangles></mesh></object></resources><build><item objectid="1"/></build></model>')

amf("straight.amf", "millimeter", 0)
amf("degrees.amf", "millimeter", 90)
amf("radians.amf", "millimeter", 1.5707963)
amf("inches.amf", "inch", 0)
threemf("inches.3mf", "inch")
PYTHON
cat >measure.py <<'PYTHON'
import math
import struct
import sys

# The part's corner stays at the origin. So the distances of the others are its edges, and the first edge tells how it
# was turned about z.
data = open(sys.argv[1], "rb").read()
(count,) = struct.unpack_from("<I", data, 80)
corners = {struct.unpack_from("<3f", data, 96 + 50 * facet + 12 * k) for facet in range(count) for k in range(3)}
corner, *ends = sorted(corners, key=lambda point: math.dist(point, (0, 0, 0)))
edges = ", ".join(f"{math.dist(corner, end):.5g}" for end in ends)
print(f"edges {edges}, turned by {abs(math.degrees(math.atan2(ends[0][1], ends[0][0]))):.1f} degrees")
PYTHON
python3 write.py
for file in straight.amf degrees.amf radians.amf inches.amf inches.3mf; do
  slicer --export-stl --dont-arrange -o "$file.stl" "$file" >"$file.log" 2>&1
  if grep -iE 'warn|error|inch.*convert' "$file.log"; then echo "it has changed: PrusaSlicer tells"; exit 1; fi
  echo "$file: $(python3 measure.py "$file.stl")"
done | tee seen
diff - seen <<'SEEN'
straight.amf: edges 10, 20, 30, turned by 0.0 degrees
degrees.amf: edges 10, 20, 30, turned by 116.6 degrees
radians.amf: edges 10, 20, 30, turned by 90.0 degrees
inches.amf: edges 10, 20, 30, turned by 0.0 degrees
inches.3mf: edges 254, 508, 762, turned by 0.0 degrees
SEEN
