#!/usr/bin/env bash
# GTS 0.7.6 is a library for triangulated surfaces, with small programs that convert, check and coarsen them. Its own
# file has ten digits of each coordinate, and is right. The ways out of it are not. gts2stl and gts2dxf write six
# digits, so a part at map coordinates comes out flat or as one point, and a tetrahedron of the height 1 loses its
# volume. gts2oogl, which writes OFF for Geomview, has six decimals instead: it keeps the map coordinates, but of a
# part in metres all that is smaller than half a micrometre becomes zero, and 25.4 micrometres become 25. There is no
# error and no warning in any of these cases.
#
# Numbers in a binary STL are floats of 32 bits, which hold all whole numbers up to 16777216 and need up to nine digits
# as text. The text file of STL has no bound on digits, nor has DXF, whose coordinates are doubles. stl2gts reads
# text and binary files alike.
#
# Seen with Debian's libgts-bin 0.7.6+darcs121130-5+b1, for tetrahedra with three edges along the axes:
#   map.stl, as gts: volume 0.166667                    edges of 1 at x = 1234567 and y = 5345678
#   map.stl, as gts, as stl: volume 0, 2 vertices       right is 4 vertices, and the volume 0.166667
#   map.stl, as gts, as dxf: volume 0, 2 vertices
#   map.stl, as gts, as off: volume 0.166667, 4 vertices
#   thin.stl, as gts, as stl: height 2.54e-05
#   thin.stl, as gts, as off: height 2.5e-05            edges of 1 and 1, and 0.0000254 high
#   foil.stl, as gts, as off: height 0                  0.0000004 high
#
# This script fetches that package, and all that it needs, into a temporary folder, converts the files, and fails if
# the behaviour is no longer so. It ends with 77 if the packages cannot be had. It needs Debian bookworm's package
# lists and python3, and changes nothing outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that these programs need: about 12 packages, 5 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install libgts-bin=0.7.6+darcs121130-5+b1 >apt.log 2>&1 || { cat apt.log; exit 77; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
gts() {
  local program=$1
  shift
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$folder/root/usr/lib/x86_64-linux-gnu \
    "$folder/root/usr/bin/$program" "$@" 2>complaints
  if grep -v '^#' complaints; then echo "it has changed: $program tells"; return 1; fi
}

cat >write.py <<'PYTHON'
import struct

# The facets of a tetrahedron at that place with edges of these lengths along the axes.
def part(place, edges):
    x, y, z = place
    corners = [place, (x + edges[0], y, z), (x, y + edges[1], z), (x, y, z + edges[2])]
    return [[corners[number] for number in facet] for facet in [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]]

def write(name, facets):
    with open(name + ".stl", "w") as file:
        file.write("solid part\n")
        for facet in facets:
            vertices = "".join("vertex %.9g %.9g %.9g\n" % corner for corner in facet)
            file.write(f"facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
        file.write("endsolid part\n")

chart = part((1234567, 5345678, 0), (1, 1, 1))
write("map", chart)
write("thin", part((0, 0, 0), (1, 1, 0.0000254)))
write("foil", part((0, 0, 0), (1, 1, 0.0000004)))
with open("map-binary.stl", "wb") as file:
    file.write(bytes(80) + struct.pack("<I", len(chart)))
    for facet in chart:
        file.write(struct.pack("<12fH", 0, 0, 0, *(value for corner in facet for value in corner), 0))
PYTHON
cat >measure.py <<'PYTHON'
import sys

# The facets of a file, each as three corners.
def facets(name):
    lines = [line.split() for line in open(name) if line.strip()]
    kind = name[-3:]
    if kind == "stl":
        corners = [tuple(map(float, line[1:])) for line in lines if line[0] == "vertex"]
        return [corners[first:first + 3] for first in range(0, len(corners), 3)]
    if kind == "off":
        vertices, faces = int(lines[0][1]), int(lines[0][2])
        points = [tuple(map(float, line[:3])) for line in lines[1:1 + vertices]]
        return [[points[int(word)] for word in line[1:4]] for line in lines[1 + vertices:1 + vertices + faces]]
    if kind == "gts":
        vertices, edges, faces = map(int, lines[0][:3])
        points = [tuple(map(float, line[:3])) for line in lines[1:1 + vertices]]
        ends = [tuple(int(word) - 1 for word in line[:2]) for line in lines[1 + vertices:1 + vertices + edges]]
        found = []
        for line in lines[1 + vertices + edges:1 + vertices + edges + faces]:
            one, two, three = (set(ends[int(word) - 1]) for word in line[:3])
            found.append([points[(pair[0] & pair[1]).pop()] for pair in ((three, one), (one, two), (two, three))])
        return found
    # DXF: a polyline whose vertices are points (flag 192) and faces (flag 128), as pairs of a code and a value
    words = [line[0] if line else "" for line in map(str.split, open(name))]
    pairs = list(zip(words[0::2], words[1::2]))
    starts = [place for place, pair in enumerate(pairs) if pair[0] == "0"]
    entities = [dict(pairs[start:end]) for start, end in zip(starts, starts[1:])]
    points = [tuple(float(entity[code]) for code in ("10", "20", "30")) for entity in entities
        if entity["0"] == "VERTEX" and entity["70"] == "192"]
    return [[points[abs(int(entity[code])) - 1] for code in ("71", "72", "73")] for entity in entities
        if entity["0"] == "VERTEX" and entity["70"] == "128"]

def volume(triangles):
    origin = triangles[0][0]
    total = 0
    for triangle in triangles:
        (a, b, c), (d, e, f), (g, h, i) = ([x - y for x, y in zip(corner, origin)] for corner in triangle)
        total += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return abs(total) / 6

def describe(name, wanted):
    triangles = facets(name)
    corners = {corner for triangle in triangles for corner in triangle}
    columns = list(zip(*corners))
    return {"volume": f"volume {volume(triangles):g}", "vertices": f"{len(corners)} vertices",
        "height": f"height {max(columns[2]) - min(columns[2]):g}"}[wanted]

print(", ".join(describe(sys.argv[1], wanted) for wanted in sys.argv[2:]))
PYTHON
python3 write.py
dpkg-deb -f archives/libgts-bin_*.deb Package Version
for name in map map-binary thin foil; do
  gts stl2gts <$name.stl >$name.gts
  gts gts2stl <$name.gts >$name-again.stl
  gts gts2oogl <$name.gts >$name.off
  gts gts2dxf <$name.gts >$name.dxf
done
{
  for name in map map-binary; do
    echo "$name.stl, as gts: $(python3 measure.py $name.gts volume)"
    echo "$name.stl, as gts, as stl: $(python3 measure.py $name-again.stl volume vertices)"
    echo "$name.stl, as gts, as dxf: $(python3 measure.py $name.dxf volume vertices)"
    echo "$name.stl, as gts, as off: $(python3 measure.py $name.off volume vertices)"
  done
  echo "thin.stl, as gts, as stl: $(python3 measure.py thin-again.stl height)"
  echo "thin.stl, as gts, as off: $(python3 measure.py thin.off height)"
  echo "foil.stl, as gts, as off: $(python3 measure.py foil.off height)"
} | tee seen
diff - seen <<'SEEN'
map.stl, as gts: volume 0.166667
map.stl, as gts, as stl: volume 0, 2 vertices
map.stl, as gts, as dxf: volume 0, 2 vertices
map.stl, as gts, as off: volume 0.166667, 4 vertices
map-binary.stl, as gts: volume 0.166667
map-binary.stl, as gts, as stl: volume 0, 2 vertices
map-binary.stl, as gts, as dxf: volume 0, 2 vertices
map-binary.stl, as gts, as off: volume 0.166667, 4 vertices
thin.stl, as gts, as stl: height 2.54e-05
thin.stl, as gts, as off: height 2.5e-05
foil.stl, as gts, as off: height 0
SEEN
