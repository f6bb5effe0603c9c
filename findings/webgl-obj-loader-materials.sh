#!/usr/bin/env bash
# An OBJ file may give its faces different materials: the line usemtl holds for the faces after it. webgl-obj-loader
# 2.0.8 makes a mesh of such a file whose list "indices" has the faces of one material only, the one that is named last
# in the file. The vertices are all there, and the faces of the other materials are not. A box with a red bottom and
# top and blue sides has its sides only, and it depends on the order of the file which faces are left. If the last line
# names a material that no face has, the list is empty. There is no error and no warning.
#
# The package's own page says that "indices" is what draws the triangles that make up the faces. Its function
# initMeshBuffers, with which the page has a mesh drawn, takes that list, and so does makeIndexBufferData. Another list,
# indicesPerMaterial, has all faces. The page has it among the changes of 2.0.0 and says that it holds the numbers for
# each material, but not that the other list is then only a part. Faces in front of the first usemtl are in the list of
# the first material, as if they had it.
#
# Seen with npm's webgl-obj-loader 2.0.8, for a box of six quadrilaterals, which are twelve triangles:
#   no material:         12 triangles; drawn: 12
#   red ends, then blue: 8 triangles; drawn: 8; by material: red 4, blue 8
#   blue, then red ends: 4 triangles; drawn: 4; by material: blue 8, red 4
#   and green at last:   0 triangles; drawn: 0; by material: blue 8, red 4, green 0
#   ends without one:    12 triangles; drawn: 12; by material: blue 12
# Right would be 12 each time, and 8 for the blue of the last file. "Drawn" is what initMeshBuffers prepares.
#
# This script installs that package in a temporary folder, reads the five files, and fails if the behaviour is no longer
# so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  webgl-obj-loader@2.0.8 >npm.log

cat >read.js <<'JAVASCRIPT'
const assert = require("node:assert");
const { Mesh, initMeshBuffers } = require("webgl-obj-loader");

const points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
const vertices = points.map((point) => `v ${point.join(" ")}\n`).join("");
const face = (corners) => `f ${corners.join(" ")}\n`;
const ends = [[1, 4, 3, 2], [5, 6, 7, 8]].map(face).join("");
const sides = [[1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]].map(face).join("");

// As much of WebGL as initMeshBuffers needs.
const nothing = () => {};
const gl = { createBuffer: () => ({}), bindBuffer: nothing, bufferData: nothing };

const complaints = [];
for (const name of ["warn", "error"]) {
  console[name] = (...words) => complaints.push(words.join(" "));
}
function read(title, faces) {
  const mesh = new Mesh(vertices + faces);
  initMeshBuffers(gl, mesh);
  const materials = mesh.materialNames.map((name, i) => `${name} ${mesh.indicesPerMaterial[i].length / 3}`);
  const told = `${mesh.indices.length / 3} triangles; drawn: ${mesh.indexBuffer.numItems / 3}` +
    (materials.length > 0 ? `; by material: ${materials.join(", ")}` : "");
  console.log(title.padEnd(20), told);
  return told;
}

const seen = [
  read("no material:", ends + sides),
  read("red ends, then blue:", `usemtl red\n${ends}usemtl blue\n${sides}`),
  read("blue, then red ends:", `usemtl blue\n${sides}usemtl red\n${ends}`),
  read("and green at last:", `usemtl blue\n${sides}usemtl red\n${ends}usemtl green\n`),
  read("ends without one:", `${ends}usemtl blue\n${sides}`),
];
assert.deepStrictEqual(seen, [
  "12 triangles; drawn: 12",
  "8 triangles; drawn: 8; by material: red 4, blue 8",
  "4 triangles; drawn: 4; by material: blue 8, red 4",
  "0 triangles; drawn: 0; by material: blue 8, red 4, green 0",
  "12 triangles; drawn: 12; by material: blue 12",
], "it has changed");
assert.deepStrictEqual(complaints, [], "it has changed: webgl-obj-loader tells");
JAVASCRIPT
node -p '"webgl-obj-loader " + JSON.parse(fs.readFileSync("node_modules/webgl-obj-loader/package.json")).version'
node read.js
