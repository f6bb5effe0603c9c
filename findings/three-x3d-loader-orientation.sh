#!/usr/bin/env bash
# three-x3d-loader 0.4.0 reads the faces of an X3D file (IndexedFaceSet) for three.js. It turns all of them inside out,
# unless the file says ccw="TRUE" in capital letters, which is not how X3D's XML files have it. Where a file says
# nothing of ccw, or says ccw="true", which means the same, a closed part has the negative of its volume. A file that
# says ccw="false" comes out the same way, so the two orientations cannot be told apart.
#
# The last face is left out unless a -1 stands behind it, so that a closed part is open. A part that is there again
# elsewhere (USE) is an empty mesh there. And IndexedTriangleSet, which is how X3D has a mesh of triangles, is nothing
# at all. There is no error and no warning in any of these cases.
#
# X3D's standard (ISO/IEC 19775-1) has TRUE as the default of ccw, which means that the corners of a face run
# counter-clockwise as seen from outside. It lets the last face be followed by a -1 or not, and has a node with USE
# stand for the node of that name with all that is in it. The XML encoding (ISO/IEC 19776-1) has true and false in
# small letters. The order of the corners matters to whoever remeshes: it tells what is inside, so a volume mesher
# fills the outside or refuses, and offsets go the wrong way.
#
# Seen with npm's three-x3d-loader 0.4.0 and three 0.82.1, the one that it was developed with, for a tetrahedron of the
# volume 1000 whose corners run counter-clockwise as seen from outside:
#   no ccw: 4 facets, volume -1000
#   ccw="true": 4 facets, volume -1000
#   ccw="TRUE": 4 facets, volume 1000
#   ccw="false": 4 facets, volume -1000                  this one is right
#   no -1 at the end: 3 facets, volume -1000             the volume is still the same since a corner is at the origin
#   used again at x = 200: 4 facets, volume -1000        right is 8 facets, volume 2000
#   IndexedTriangleSet: 0 facets, volume 0
#
# This script installs these packages in a temporary folder, reads the files, and fails if the behaviour is no longer
# so. It ends with 77 if the packages cannot be had. It needs node and npm, and changes nothing outside of the folder
# but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  three-x3d-loader@0.4.0 three@0.82.1 xmldom@0.1.31 >npm.log 2>&1 || { cat npm.log; exit 77; }

cat >orientation.js <<'JAVASCRIPT'
const assert = require("node:assert");
const THREE = require("three");
require("three-x3d-loader")(THREE);

const complaints = [];
const print = console.log;
for (const name of ["log", "warn", "error"]) {
  console[name] = (...words) => complaints.push(words.join(" "));
}

const points = '<Coordinate point="0 0 0, 10 0 0, 0 20 0, 0 0 30"/>';
const faces = "0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3";
const part = (field, end = " -1") =>
  `<IndexedFaceSet ${field} coordIndex="${faces}${end}">${points}</IndexedFaceSet>`;
const again = `<Transform translation="100 0 0"><Shape DEF="Part">${part("")}</Shape></Transform>
<Transform translation="200 0 0"><Shape USE="Part"/></Transform>`;
const triangles = `<IndexedTriangleSet index="${faces.replaceAll(" -1", "")}">${points}</IndexedTriangleSet>`;

function read(shapes) {
  const scene = new THREE.X3DLoader().parse(`<?xml version="1.0" encoding="UTF-8"?>
<X3D profile="Interchange" version="3.3"><Scene>${shapes}</Scene></X3D>`);
  scene.updateMatrixWorld(true);
  let [facets, volume] = [0, 0];
  scene.traverse((object) => {
    for (const { a, b, c } of (object.geometry && object.geometry.faces) || []) {
      const [p, q, r] = [a, b, c].map((number) =>
        object.geometry.vertices[number].clone().applyMatrix4(object.matrixWorld));
      facets += 1;
      volume += p.dot(q.cross(r)) / 6;
    }
  });
  return `${facets} facets, volume ${Number(volume.toFixed(6))}`;
}
const shape = (geometry) => `<Shape>${geometry}</Shape>`;

const seen = [
  `no ccw: ${read(shape(part("")))}`,
  ...["true", "TRUE", "false"].map((word) => `ccw="${word}": ${read(shape(part(`ccw="${word}"`)))}`),
  `no -1 at the end: ${read(shape(part("", "")))}`,
  `used again at x = 200: ${read(again)}`,
  `IndexedTriangleSet: ${read(shape(triangles))}`,
];
print(seen.join("\n"));
assert.deepStrictEqual(seen, [
  "no ccw: 4 facets, volume -1000",
  'ccw="true": 4 facets, volume -1000',
  'ccw="TRUE": 4 facets, volume 1000',
  'ccw="false": 4 facets, volume -1000',
  "no -1 at the end: 3 facets, volume -1000",
  "used again at x = 200: 4 facets, volume -1000",
  "IndexedTriangleSet: 0 facets, volume 0",
], "it has changed");
assert.deepStrictEqual(complaints, [], "it has changed: the loader tells");
JAVASCRIPT
for name in three-x3d-loader three; do node -p "'$name ' + require('$name/package.json').version"; done
node orientation.js
