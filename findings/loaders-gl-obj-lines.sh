#!/usr/bin/env bash
# An OBJ file may have lines (l) and points (p) beside its faces. Blender, for one, writes an edge that has no face as a
# line. The OBJ loader of loaders.gl 4.5.2 puts the ends of lines into the same list as the corners of triangles, in the
# order of the file, and says that the whole list is triangles (mode 4). So a line of two points moves all that comes
# after it by two corners, and each triangle there has corners of two faces. Lines after the faces become triangles that
# are not in the file. It does not matter whether the lines are an object (o) of their own. There is no warning, and
# nothing in the mesh from which one could tell the lines.
#
# Wavefront's description of OBJ has points, lines and faces as elements of a file that follow each other in any order.
#
# Seen with npm's @loaders.gl/obj and @loaders.gl/core 4.5.2, for a cube of 12 triangles:
#   no line:                    36 corners, 12 of the 12 triangles and 0 others
#   a line before the faces:    38 corners, 2 of the 12 triangles and 10 others
#   a line after six of them:   38 corners, 6 of the 12 triangles and 6 others
#   lines as an object after:   46 corners, 12 of the 12 triangles and 3 others
#
# This script installs these packages in a temporary folder, reads the four files, and fails if the behaviour is no
# longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @loaders.gl/obj@4.5.2 @loaders.gl/core@4.5.2 >npm.log

cat >read.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import { parse } from "@loaders.gl/core";
import { OBJLoader } from "@loaders.gl/obj";

const points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
const sides = [[4, 3, 2, 1], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];
const triangles = sides.flatMap(([a, b, c, d]) => [[a, b, c], [c, d, a]]);
const vertices = points.map((point) => `v ${point.join(" ")}\n`).join("");
const faces = (from, to) => triangles.slice(from, to).map((corners) => `f ${corners.join(" ")}\n`).join("");
const known = new Set(triangles.map((corners) => [...corners].sort().join(" ")));

async function read(title, text) {
  const mesh = await parse(text, OBJLoader, { worker: false });
  assert.strictEqual(mesh.mode, 4); // triangles
  assert.strictEqual(mesh.indices, undefined);
  const values = Array.from(mesh.attributes.POSITION.value);
  const corners = Array.from({ length: values.length / 3 }, (_, i) =>
    1 + points.findIndex((point) => point.every((x, k) => x === values[3 * i + k])));
  const read = Array.from({ length: Math.floor(corners.length / 3) }, (_, i) =>
    corners.slice(3 * i, 3 * i + 3).sort().join(" "));
  const right = new Set(read.filter((triangle) => known.has(triangle))).size;
  const told = `${corners.length} corners, ${right} of the 12 triangles and ${read.length - right} others`;
  console.log(title.padEnd(27), told);
  return told;
}

const seen = [
  await read("no line:", vertices + faces(0, 12)),
  await read("a line before the faces:", `${vertices}l 1 2\n${faces(0, 12)}`),
  await read("a line after six of them:", `${vertices}${faces(0, 6)}l 1 2\n${faces(6, 12)}`),
  await read("lines as an object after:", `${vertices}o cube\n${faces(0, 12)}o edges\nl 1 2 3 4 1\nl 5 6 7 8 5\n`),
];
assert.deepStrictEqual(seen, [
  "36 corners, 12 of the 12 triangles and 0 others",
  "38 corners, 2 of the 12 triangles and 10 others",
  "38 corners, 6 of the 12 triangles and 6 others",
  "46 corners, 12 of the 12 triangles and 3 others",
], "it has changed");
JAVASCRIPT
node -p '"@loaders.gl/obj " + JSON.parse(fs.readFileSync("node_modules/@loaders.gl/obj/package.json")).version'
node read.mjs
