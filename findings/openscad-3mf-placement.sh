#!/usr/bin/env bash
# A 3MF file has a list of objects, and a list of what is to be built of them: each item names an object and may have a
# matrix that moves and turns it. An object may also be made of others, each with a matrix. OpenSCAD 2021.01 takes the
# meshes out of the list of objects and looks at nothing else. Every part comes out where its own vertices are, as it
# was before it was placed. Two copies of a part become one, an assembly falls into its pieces at the origin, one inside
# the other, and a part that is in the file but not to be built is there, too. The unit is not looked at either. There
# is no warning, and slicers write files in which each part has its place as a matrix, so most of them are affected.
#
# The core specification of 3MF has the matrix applied to the item or component, and forbids to put out objects that no
# item refers to. The unit is an attribute of the model. OpenSCAD's own message for such a file tells the number of
# facets only. Assimp 5.2.5 places the parts rightly. OpenSCAD's pull request 5527, of December 2024, is to bring that
# to later versions.
#
# Seen with Debian's openscad 2021.01-6, for a part of 10 by 20 by 30 with one corner at the origin:
#   plain: 4 facets, 0 0 0 to 10 20 30
#   moved: 4 facets, 0 0 0 to 10 20 30          one item at x = 100; right is 100 0 0 to 110 20 30
#   turned: 4 facets, 0 0 0 to 10 20 30         one item, by 90 degrees about z; right is -20 0 0 to 0 10 30
#   twice: 4 facets, 0 0 0 to 10 20 30          two items, at x = 100 and 200; right is 100 0 0 to 210 20 30
#   assembly: 4 facets, 0 0 0 to 10 20 30       two components, at x = 50 and 70; right is 50 0 0 to 80 20 30
#   spare: 8 facets, 0 0 0 to 510 20 30         with a second object at x = 500 that is in no item
#   inches: 4 facets, 0 0 0 to 10 20 30         in millimetres that is 254 508 762
#
# This script fetches that package, and all that it needs, into a temporary folder, converts seven files to STL, and
# fails if the behaviour is no longer so. It needs Debian bookworm's package lists and python3, and changes nothing
# outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that OpenSCAD needs: about 175 packages, 92 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install openscad=2021.01-6 >apt.log 2>&1 || { cat apt.log; exit 1; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
libraries=$folder/root/usr/lib/x86_64-linux-gnu
openscad() {
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$libraries:$libraries/blas:$libraries/lapack:$folder/root/usr/lib \
    QT_QPA_PLATFORM=offscreen HOME=$folder "$folder/root/usr/bin/openscad" "$@"
}
version=$(openscad --version 2>&1)
echo "$version"
test "$version" = 'OpenSCAD version 2021.01'

cat >write.py <<'PYTHON'
import zipfile

def mesh(number, x):
    corners = [(x, 0, 0), (x + 10, 0, 0), (x, 20, 0), (x, 0, 30)]
    facets = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    points = "".join('<vertex x="%d" y="%d" z="%d"/>' % corner for corner in corners)
    triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % facet for facet in facets)
    return (f'<object id="{number}" type="model"><mesh><vertices>{points}</vertices>'
        f'<triangles>{triangles}</triangles></mesh></object>')

def moved(x):
    return f'transform="1 0 0 0 1 0 0 0 1 {x} 0 0"'

def write(name, objects, items, unit="millimeter"):
    head = '<?xml version="1.0" encoding="UTF-8"?>\n'
    package = "http://schemas.openxmlformats.org/package/2006/"
    vendor = "http://schemas.microsoft.com/3dmanufacturing/"
    with zipfile.ZipFile(name + ".3mf", "w") as archive:
        archive.writestr("[Content_Types].xml", f'{head}<Types xmlns="{package}content-types">'
            '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        archive.writestr("_rels/.rels", f'{head}<Relationships xmlns="{package}relationships"><Relationship Id="model" '
            f'Target="/3D/part.model" Type="{vendor}2013/01/3dmodel"/></Relationships>')
        archive.writestr("3D/part.model", f'{head}<model unit="{unit}" xmlns="{vendor}core/2015/02">'
            f'<resources>{objects}</resources><build>{items}</build></model>')

part = mesh(1, 0)
pair = (f'<object id="2" type="model"><components><component objectid="1" {moved(50)}/>'
    f'<component objectid="1" {moved(70)}/></components></object>')
write("plain", part, '<item objectid="1"/>')
write("moved", part, f'<item objectid="1" {moved(100)}/>')
write("turned", part, '<item objectid="1" transform="0 1 0 -1 0 0 0 0 1 0 0 0"/>')
write("twice", part, f'<item objectid="1" {moved(100)}/><item objectid="1" {moved(200)}/>')
write("assembly", part + pair, '<item objectid="2"/>')
write("spare", part + mesh(2, 500), '<item objectid="1"/>')
write("inches", part, '<item objectid="1"/>', "inch")
PYTHON
cat >measure.py <<'PYTHON'
import sys

lines = [line.split() for line in open(sys.argv[1])]
corners = [tuple(map(float, line[1:])) for line in lines if line[:1] == ["vertex"]]
columns = list(zip(*corners))
box = " to ".join(" ".join(f"{end(column):g}" for column in columns) for end in (min, max))
print(f"{len(corners) // 3} facets, {box}")
PYTHON
python3 write.py
for name in plain moved turned twice assembly spare inches; do
  echo "import(\"$name.3mf\");" >$name.scad
  openscad -o $name.stl $name.scad >$name.log 2>&1 || { cat $name.log; exit 1; }
  if grep -iE 'warn|error' $name.log; then echo "it has changed: OpenSCAD tells"; exit 1; fi
  echo "$name: $(python3 measure.py $name.stl)"
done | tee seen
diff - seen <<'SEEN'
plain: 4 facets, 0 0 0 to 10 20 30
moved: 4 facets, 0 0 0 to 10 20 30
turned: 4 facets, 0 0 0 to 10 20 30
twice: 4 facets, 0 0 0 to 10 20 30
assembly: 4 facets, 0 0 0 to 10 20 30
spare: 8 facets, 0 0 0 to 510 20 30
inches: 4 facets, 0 0 0 to 10 20 30
SEEN
