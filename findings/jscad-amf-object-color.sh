#!/usr/bin/env bash
# An AMF file may give each object a colour. @jscad/amf-deserializer 2.3.13 promises a list of geometries, and that it
# takes the colours of objects. But where an object has a colour of its own, the list has the colour in the place of the
# geometry: four numbers, and the part is gone. Nothing is raised or printed. The writer of STL in the same family of
# packages leaves out what is no geometry, and prints that some objects could not be written. So a red bolt and a nut
# without a colour become the nut alone.
#
# AMF's standard (ISO/ASTM 52915) lets an object, a volume, a triangle, a vertex and a material have a colour. With the
# same colour at the volume, the part is read rightly. So it is with output "script", which is the default: the code has
# the part, with its colour.
#
# Seen with npm's @jscad/amf-deserializer 2.3.13, @jscad/stl-serializer 2.1.23 and @jscad/modeling 2.13.0, for a file of
# two objects, a tetrahedron of the volume 1 and one of the volume 8:
#   no colour:                   volume 1.000, volume 8.000; STL: 8 facets
#   colour of the first volume:  volume 1.000, volume 8.000; STL: 8 facets
#   colour of the first object:  no geometry but [1,0,0,1], volume 8.000; STL: 4 facets
#
# This script installs these packages in a temporary folder, reads the three files, and fails if the behaviour is no
# longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @jscad/amf-deserializer@2.3.13 @jscad/stl-serializer@2.1.23 @jscad/modeling@2.13.0 @jscad/io-utils@2.0.33 \
  @jscad/array-utils@2.1.4 >npm.log

cat >read.js <<'JAVASCRIPT'
const assert = require("node:assert");
const { deserialize } = require("@jscad/amf-deserializer");
const { serialize } = require("@jscad/stl-serializer");
const { geometries, measurements } = require("@jscad/modeling");

// A tetrahedron with edges along the axes, of the volume size^3 / 6.
function object(id, size, objectColor, volumeColor) {
  const corners = [[0, 0, 0], [size, 0, 0], [0, size, 0], [0, 0, size]];
  const facets = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
  const element = (name) => (value) => `<${name}>${value}</${name}>`;
  const vertex = (point) => element("vertex")(element("coordinates")(
    ["x", "y", "z"].map((axis, i) => element(axis)(point[i])).join("")));
  const triangle = (facet) => element("triangle")(facet.map((corner, i) => element(`v${i + 1}`)(corner)).join(""));
  return `<object id="${id}">${objectColor}<mesh>` +
    `<vertices>${corners.map(vertex).join("")}</vertices>` +
    `<volume>${volumeColor}${facets.map(triangle).join("")}</volume></mesh></object>`;
}

const red = "<color><r>1</r><g>0</g><b>0</b></color>";
function read(objectColor, volumeColor) {
  const one = Math.cbrt(6);
  const amf = `<?xml version="1.0" encoding="UTF-8"?>\n<amf unit="millimeter" version="1.1">` +
    `${object(1, one, objectColor, volumeColor)}${object(2, 2 * one, "", "")}</amf>`;
  const parts = deserialize({ output: "geometry" }, amf);
  const told = parts.map((part) => geometries.geom3.isA(part)
    ? `volume ${measurements.measureVolume(part).toFixed(3)}` : `no geometry but ${JSON.stringify(part)}`);
  const stl = serialize({ binary: false }, parts).join("");
  return `${told.join(", ")}; STL: ${stl.match(/facet normal/g).length} facets`;
}

const seen = [read("", ""), read("", red), read(red, "")];
console.log("no colour:                  ", seen[0]);
console.log("colour of the first volume: ", seen[1]);
console.log("colour of the first object: ", seen[2]);
assert.deepStrictEqual(seen, [
  "volume 1.000, volume 8.000; STL: 8 facets",
  "volume 1.000, volume 8.000; STL: 8 facets",
  "no geometry but [1,0,0,1], volume 8.000; STL: 4 facets",
], "it has changed");
JAVASCRIPT
node -p '"@jscad/amf-deserializer " + require("@jscad/amf-deserializer/package.json").version'
node read.js
