#!/usr/bin/env bash
# The STL writer of vtk.js 37.4.3 says in its own declaration (IO/Geometry/STLWriter.d.ts) that it turns polygons of
# more than three corners into triangles, so that no filter for that is needed before. It does not. It takes three
# corners of a polygon, and then reads on in the list as if the polygon had ended: the fourth corner counts as the size
# of the next polygon, and that polygon's size as the number of a vertex. A square tube of four quadrilaterals becomes
# five triangles, where eight are right. Some of them join vertices of different sides, and run through the inside of
# the tube. The header of the binary file still says four, so the file is 50 bytes longer than its header has it, and a
# reader that trusts the header leaves out one of the five. There is no error and no warning, since the list happens to
# end with a full triangle; with six quadrilaterals it does not, and a TypeError about an undefined number is raised.
#
# Seen with npm's @kitware/vtk.js 37.4.3, for the four sides of a cube with the vertices 0 to 3 below and 4 to 7 above:
#   binary: the header says 4 triangles, the file has 5
#   triangles: 0 1 5, 4 1 2, 5 4 2, 7 6 4, 0 4 7
#   triangles that lie in one side of the tube: 2 of 5
#   area: 2.914... where 4 is right, and the text has the same triangles
# The same tube, given as eight triangles, is written rightly.
#
# This script installs that package in a temporary folder, writes the tube, and fails if the behaviour is no longer so.
# It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" --legacy-peer-deps \
  @kitware/vtk.js@37.4.3 >npm.log

cat >write.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData.js";
import vtkSTLWriter from "@kitware/vtk.js/IO/Geometry/STLWriter.js";

const vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
const sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

function tube(polygons) {
  const data = vtkPolyData.newInstance();
  data.getPoints().setData(Float64Array.from(vertices.flat()), 3);
  data.getPolys().setData(Uint32Array.from(polygons.flatMap((polygon) => [polygon.length, ...polygon])));
  assert.strictEqual(data.getNumberOfCells(), polygons.length);
  return data;
}

const numberOf = (x, y, z) => vertices.findIndex((vertex) => vertex[0] === x && vertex[1] === y && vertex[2] === z);

function binary(data) {
  const file = vtkSTLWriter.writeSTL(data, "binary");
  const triangles = [];
  for (let at = 84; at < file.byteLength; at += 50) {
    const corner = (k) => [0, 4, 8].map((byte) => file.getFloat32(at + 12 + 12 * k + byte, true));
    triangles.push([0, 1, 2].map((k) => numberOf(...corner(k))));
  }
  return { header: file.getUint32(80, true), triangles };
}

function text(data) {
  const corners = [...vtkSTLWriter.writeSTL(data, "ascii").matchAll(/vertex (\S+) (\S+) (\S+)/g)]
    .map((match) => numberOf(...match.slice(1).map(Number)));
  return Array.from({ length: corners.length / 3 }, (_, i) => corners.slice(3 * i, 3 * i + 3));
}

function area(triangles) {
  return triangles.reduce((sum, triangle) => {
    const [a, b, c] = triangle.map((i) => vertices[i]);
    const u = b.map((x, k) => x - a[k]);
    const v = c.map((x, k) => x - a[k]);
    return sum + Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }, 0);
}
const inOneSide = (triangle) => sides.some((side) => triangle.every((corner) => side.includes(corner)));

const halves = sides.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
assert.deepStrictEqual(binary(tube(halves)), { header: 8, triangles: halves });

const { header, triangles } = binary(tube(sides));
console.log(`binary: the header says ${header} triangles, the file has ${triangles.length}`);
console.log("triangles:", triangles.map((triangle) => triangle.join(" ")).join(", "));
console.log(`triangles that lie in one side of the tube: ${triangles.filter(inOneSide).length} of ${triangles.length}`);
console.log(`area: ${area(triangles)} where 4 is right`);
assert.strictEqual(header, 4, "it has changed");
assert.deepStrictEqual(triangles, [[0, 1, 5], [4, 1, 2], [5, 4, 2], [7, 6, 4], [0, 4, 7]], "it has changed");
assert.deepStrictEqual(text(tube(sides)), triangles, "it has changed");
JAVASCRIPT
node -p '"@kitware/vtk.js " + JSON.parse(fs.readFileSync("node_modules/@kitware/vtk.js/package.json")).version'
grep -A 2 'Since VTK' node_modules/@kitware/vtk.js/IO/Geometry/STLWriter.d.ts
node write.mjs
