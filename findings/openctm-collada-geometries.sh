#!/usr/bin/env bash
# ctmconv, the converter of OpenCTM 1.0.3, reads COLLADA files (.dae). If a file has two geometries, the faces of the
# second one get the vertices of the first: the first part is there twice, and the second is not, though its vertices
# are. Of each geometry it reads one list of triangles only. So of a part with two materials, which has a list for
# each, the faces of the second material are missing. A list of the kind polylist, which Blender 2.7 and others write,
# is not read at all: the result is a file without faces, and ctmconv says that it was saved. And the scene is not
# looked at. Every geometry comes out once where its own vertices are, however it was moved, however often it is used,
# and even if no node uses it. The unit is not taken, either. There is no error and no warning in any of these cases.
#
# COLLADA's specification (1.4.1) has any number of geometries in the library, each with its own sources, to which its
# indices refer. A mesh holds any number of the elements triangles, polylist and others, in any order, and a node has
# translate, matrix and so on for what it instantiates.
#
# Seen with Debian's openctm-tools 1.0.3+dfsg1-2.1+b3, for a tetrahedron with edges of 10, 20 and 30 along the axes:
#   one: 4 facets, 0 0 0 to 10 20 30
#   two: 8 facets, 0 0 0 to 10 20 30, 4 of them different, 8 vertices      a second one at x = 500; right is 8 different
#   materials: 2 facets, 0 0 0 to 10 20 30         two lists of 2; right is 4 facets
#   polylist: 0 facets                             one list of 4; right is 4 facets
#   moved: 4 facets, 0 0 0 to 10 20 30             a node at x = 100; right is 100 0 0 to 110 20 30
#   twice: 4 facets, 0 0 0 to 10 20 30             nodes at x = 100 and 200; right is 8 facets
#   spare: 8 facets, 0 0 0 to 10 20 30, 4 of them different, 8 vertices    no node has the second one; right is 4 facets
#   inches: 4 facets, 0 0 0 to 10 20 30            the same numbers as with millimetres
#
# This script fetches that package, and all that it needs, into a temporary folder, converts these files, and fails if
# the behaviour is no longer so. It ends with 77 if the packages cannot be had. It needs Debian bookworm's package
# lists and python3, and changes nothing outside of the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# With an empty list of what is installed, apt fetches all that ctmconv needs: about 130 packages, 83 MB.
mkdir -p archives/partial
touch status
apt-get -qq -o Dir::State::status="$folder/status" -o Dir::Cache::archives="$folder/archives" \
  -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1 --no-install-recommends --download-only -y \
  install openctm-tools=1.0.3+dfsg1-2.1+b3 >apt.log 2>&1 || { cat apt.log; exit 77; }
rm archives/libc6_*.deb # the C library has to be that of the loader
for package in archives/*.deb; do dpkg -x "$package" root; done
convert() {
  LD_LIBRARY_PATH=$folder/root/lib/x86_64-linux-gnu:$folder/root/usr/lib/x86_64-linux-gnu \
    "$folder/root/usr/bin/ctmconv" "$1" "$2" >convert.log 2>&1 || { cat convert.log; exit 1; }
  grep -q '^Saving' convert.log
  if grep -iE 'warn|error' convert.log; then echo "it has changed: ctmconv tells"; exit 1; fi
}

cat >write.py <<'PYTHON'
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]

# The faces of the geometry with that name, as an element of that kind.
def faces(kind, part, triangles):
    count = "<vcount>" + " ".join("3" for _ in triangles) + "</vcount>" if kind == "polylist" else ""
    numbers = " ".join("%d %d %d" % triangle for triangle in triangles)
    return (f'<{kind} count="{len(triangles)}"><input semantic="VERTEX" source="#{part}-vertices" offset="0"/>'
        f'{count}<p>{numbers}</p></{kind}>')

def geometry(part, x, elements):
    corners = [(x, 0, 0), (x + 10, 0, 0), (x, 20, 0), (x, 0, 30)]
    numbers = " ".join("%d %d %d" % corner for corner in corners)
    names = "".join(f'<param name="{axis}" type="float"/>' for axis in "XYZ")
    return (f'<geometry id="{part}"><mesh><source id="{part}-source"><float_array id="{part}-array" count="12">'
        f'{numbers}</float_array><technique_common><accessor source="#{part}-array" count="4" stride="3">{names}'
        f'</accessor></technique_common></source><vertices id="{part}-vertices">'
        f'<input semantic="POSITION" source="#{part}-source"/></vertices>{elements}</mesh></geometry>')

def node(part, place=""):
    return f'<node>{place}<instance_geometry url="#{part}"/></node>'

def write(name, geometries, nodes, unit='name="millimeter" meter="0.001"'):
    with open(name + ".dae", "w") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n'
            '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>'
            '<created>2020-01-01T00:00:00Z</created><modified>2020-01-01T00:00:00Z</modified>'
            f'<unit {unit}/><up_axis>Z_UP</up_axis></asset>'
            f'<library_geometries>{geometries}</library_geometries>'
            f'<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>'
            '<scene><instance_visual_scene url="#scene"/></scene></COLLADA>\n')

one = geometry("a", 0, faces("triangles", "a", FACES))
write("one", one, node("a"))
other = geometry("b", 500, faces("triangles", "b", FACES))
write("two", one + other, node("a") + node("b"))
write("spare", one + other, node("a"))
halves = faces("triangles", "a", FACES[:2]) + faces("triangles", "a", FACES[2:])
write("materials", geometry("a", 0, halves), node("a"))
write("polylist", geometry("a", 0, faces("polylist", "a", FACES)), node("a"))
write("moved", one, node("a", "<translate>100 0 0</translate>"))
write("twice", one, node("a", "<translate>100 0 0</translate>") + node("a", "<translate>200 0 0</translate>"))
write("inches", one, node("a"), 'name="inch" meter="0.0254"')
PYTHON
cat >measure.py <<'PYTHON'
import sys

words = [line.split() for line in open(sys.argv[1]) if line.strip()]
points, facets = int(words[1][0]), int(words[1][1])
vertices = [tuple(map(float, line)) for line in words[2:2 + points]]
triangles = [tuple(vertices[int(word)] for word in line[1:4]) for line in words[2 + points:]]
assert words[0] == ["OFF"] and len(triangles) == facets
text = f"{facets} facets"
if facets:
    columns = list(zip(*(corner for triangle in triangles for corner in triangle)))
    text += ", " + " to ".join(" ".join(f"{end(column):g}" for column in columns) for end in (min, max))
if facets == 8:
    text += f", {len({frozenset(triangle) for triangle in triangles})} of them different, {points} vertices"
print(text)
PYTHON
python3 write.py
dpkg-deb -f archives/openctm-tools_*.deb Package Version
for name in one two materials polylist moved twice spare inches; do
  convert $name.dae $name.off
  echo "$name: $(python3 measure.py $name.off)"
done >seen
cat seen
diff - seen <<'SEEN'
one: 4 facets, 0 0 0 to 10 20 30
two: 8 facets, 0 0 0 to 10 20 30, 4 of them different, 8 vertices
materials: 2 facets, 0 0 0 to 10 20 30
polylist: 0 facets
moved: 4 facets, 0 0 0 to 10 20 30
twice: 4 facets, 0 0 0 to 10 20 30
spare: 8 facets, 0 0 0 to 10 20 30, 4 of them different, 8 vertices
inches: 4 facets, 0 0 0 to 10 20 30
SEEN
