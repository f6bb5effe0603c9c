#!/usr/bin/env bash
# A DXF file may hold a surface as entities 3DFACE, each of which has four corners. @jscad/dxf-deserializer 2.3.30 asks
# whether there is a fourth corner by its x alone, and takes zero for none. So a quadrilateral whose fourth corner lies
# at x = 0 becomes a triangle of the first three corners, and the other half of it is gone. A box that begins at x = 0,
# as most parts do that were drawn from the origin, has holes on up to five of its six sides, and which sides have them
# depends on the corner from which each face was written. The same box, moved by 10 along x, is read rightly. Moved
# along y it is not. There is no error and no warning, and both outputs, "geometry" and the default "script", have the
# holes. A remesher then gets an open surface, and the volume is anything.
#
# Autodesk's reference of DXF has the codes 13, 23 and 33 of a 3DFACE as x, y and z of the fourth corner, which equals
# the third one where only three were entered. So a fourth corner at x = 0 is a number like any other. The page of the
# package has 3DFACE among the entities that are converted, without a restriction.
#
# Seen with npm's @jscad/dxf-deserializer 2.3.30 and @jscad/modeling 2.13.0, for a box of 2 by 3 by 5 from six
# quadrilaterals, whose volume is 30 and whose surface is 62, and for the same box with each face written from its
# second or its third corner on:
#   at x = 10: corners 4 4 4 4 4 4, volume 30, surface 62
#   at x = 0: corners 4 3 3 4 3 4, volume 25, surface 46.5
#   at x = 0, from the second corners: corners 3 3 3 3 3 4, volume 20, surface 38.5
#   at x = 0, from the third corners: corners 3 4 4 3 3 4, volume 25, surface 46.5
#   at x = 0 and y = 10: corners 4 3 3 4 3 4, volume 41.667, surface 46.5
#   at x = 0, as a script: corners 4 3 3 4 3 4, volume 25, surface 46.5
#
# This script installs these packages in a temporary folder, reads the files, and fails if the behaviour is no longer
# so. It ends with 77 if the packages cannot be had. It needs node and npm, and changes nothing outside of the folder
# but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @jscad/dxf-deserializer@2.3.30 @jscad/modeling@2.13.0 @jscad/io-utils@2.0.33 >npm.log 2>&1 ||
  { cat npm.log; exit 77; }

cat >corners.js <<'JAVASCRIPT'
const assert = require("node:assert");
const { deserialize } = require("@jscad/dxf-deserializer");
const { geometries, measurements } = require("@jscad/modeling");

const complaints = [];
const print = console.log;
for (const name of ["log", "warn", "error"]) {
  console[name] = (...words) => complaints.push(words.join(" "));
}

// The box with one corner at x, y, and each face written from its corner number "first" on, counted from 0.
function box({ x = 0, y = 0, first = 0 }) {
  const corner = (number) => [x + 2 * (number & 1), y + 3 * ((number >> 1) & 1), 5 * ((number >> 2) & 1)];
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const entities = sides.map((side) => {
    const turned = [...side.slice(first), ...side.slice(0, first)];
    const codes = turned.map((number, place) =>
      corner(number).map((value, axis) => `${10 * (axis + 1) + place}\n${value.toFixed(1)}\n`).join(""));
    return `0\n3DFACE\n8\n0\n${codes.join("")}`;
  });
  return `0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n` +
    `0\nSECTION\n2\nENTITIES\n${entities.join("")}0\nENDSEC\n0\nEOF\n`;
}
function describe(parts) {
  const [part, ...others] = [parts].flat(Infinity);
  assert.strictEqual(others.length, 0);
  const corners = geometries.geom3.toPolygons(part).map((polygon) => polygon.vertices.length).join(" ");
  const [volume, surface] = [measurements.measureVolume(part), measurements.measureArea(part)];
  return `corners ${corners}, volume ${Number(volume.toFixed(3))}, surface ${Number(surface.toFixed(3))}`;
}
const read = (where) => describe(deserialize({ output: "geometry" }, box(where)));
function run(script) {
  const made = { exports: {} };
  new Function("require", "module", "exports", script)(require, made, made.exports);
  return describe(made.exports.main());
}

const seen = [
  `at x = 10: ${read({ x: 10 })}`,
  `at x = 0: ${read({})}`,
  `at x = 0, from the second corners: ${read({ first: 1 })}`,
  `at x = 0, from the third corners: ${read({ first: 2 })}`,
  `at x = 0 and y = 10: ${read({ y: 10 })}`,
  `at x = 0, as a script: ${run(deserialize({}, box({})))}`,
];
print(seen.join("\n"));
assert.deepStrictEqual(seen, [
  "at x = 10: corners 4 4 4 4 4 4, volume 30, surface 62",
  "at x = 0: corners 4 3 3 4 3 4, volume 25, surface 46.5",
  "at x = 0, from the second corners: corners 3 3 3 3 3 4, volume 20, surface 38.5",
  "at x = 0, from the third corners: corners 3 4 4 3 3 4, volume 25, surface 46.5",
  "at x = 0 and y = 10: corners 4 3 3 4 3 4, volume 41.667, surface 46.5",
  "at x = 0, as a script: corners 4 3 3 4 3 4, volume 25, surface 46.5",
], "it has changed");
assert.deepStrictEqual(complaints, [], "it has changed: JSCAD tells");
JAVASCRIPT
node -p "'@jscad/dxf-deserializer ' + require('@jscad/dxf-deserializer/package.json').version"
node corners.js
