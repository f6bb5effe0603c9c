#!/usr/bin/env bash
# PLY stores each face as a list of any number of vertices. The PLY loader of loaders.gl 4.4.5 takes triangles and
# quadrilaterals, and leaves out every face of five or more corners without an error, a warning or a count that would
# show it. So a closed prism over a pentagon, of five quadrilaterals and two pentagons, arrives as a tube that is open at
# both ends. Where all faces have five or more corners, nothing but a point cloud is left: the mesh says that its
# topology is a list of points. The description of the format (Turk, "The PLY Polygon File Format") names polygons of any
# number of corners as what it was made for.
#
# Seen with npm's @loaders.gl/ply and @loaders.gl/core 4.4.5:
#   prism of 2 pentagons and 5 quadrilaterals: triangle-list, 10 triangles, 10 edges with one triangle
#   the same prism, cut into triangles:        triangle-list, 16 triangles, 0 edges with one triangle
#   a pentagon:                                point-list, 0 triangles, 0 edges with one triangle
#
# This script installs these packages in a temporary folder, reads the three files, and fails if the behaviour is no
# longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @loaders.gl/ply@4.4.5 @loaders.gl/core@4.4.5 >npm.log

cat >read.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import fs from "node:fs";
import { parse } from "@loaders.gl/core";
import { PLYLoader } from "@loaders.gl/ply";

function ply(points, faces) {
  return [
    "ply", "format ascii 1.0",
    `element vertex ${points.length}`, "property float x", "property float y", "property float z",
    `element face ${faces.length}`, "property list uchar int vertex_indices", "end_header",
    ...points.map((p) => p.join(" ")), ...faces.map((f) => [f.length, ...f].join(" ")), "",
  ].join("\n");
}

async function read(title, points, faces) {
  const bytes = new TextEncoder().encode(ply(points, faces));
  const mesh = await parse(bytes.buffer, PLYLoader, { worker: false });
  const corners = Array.from(mesh.indices?.value ?? []);
  const uses = new Map();
  corners.forEach((v, i) => {
    const w = corners[i % 3 === 2 ? i - 2 : i + 1];
    const edge = `${Math.min(v, w)} ${Math.max(v, w)}`;
    uses.set(edge, (uses.get(edge) ?? 0) + 1);
  });
  const open = [...uses.values()].filter((n) => n === 1).length;
  const told = `${mesh.topology}, ${corners.length / 3} triangles, ${open} edges with one triangle`;
  console.log(title.padEnd(42), told);
  return told;
}

const pentagon = [[2, 0], [3, 1], [1, 2], [-1, 1], [0, 0]];
const points = [...pentagon.map(([x, y]) => [x, y, 0]), ...pentagon.map(([x, y]) => [x, y, 1])];
const prism = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9]];
for (let i = 0; i < 5; ++i) prism.push([i, (i + 1) % 5, 5 + ((i + 1) % 5), 5 + i]);
const triangles = prism.flatMap((face) => face.slice(2).map((v, i) => [face[0], face[i + 1], v]));

const whole = await read("prism of 2 pentagons and 5 quadrilaterals:", points, prism);
const cut = await read("the same prism, cut into triangles:", points, triangles);
const alone = await read("a pentagon:", points.slice(0, 5), [[0, 1, 2, 3, 4]]);
assert.strictEqual(cut, "triangle-list, 16 triangles, 0 edges with one triangle");
assert.strictEqual(whole, "triangle-list, 10 triangles, 10 edges with one triangle", "it has changed");
assert.strictEqual(alone, "point-list, 0 triangles, 0 edges with one triangle", "it has changed");
JAVASCRIPT
node -p '"@loaders.gl/ply " + JSON.parse(fs.readFileSync("node_modules/@loaders.gl/ply/package.json")).version'
node read.mjs
