#!/usr/bin/env bash
# @itk-wasm/mesh-io 1.7.1 reads the faces of an OBJ file as numbers of 32 bits, but says that they have 64 bits
# (cellComponentType "int64"). So a program gets each two neighbouring numbers as one large one, and zeros for the
# second half of the list: the size of a face and its first corner are fused, and no number is a vertex. The points and
# the numbers of points and of faces are right, and nothing is raised or printed. What becomes of it depends on the
# format in which the same package writes the mesh that it has just read. STL comes out right. OFF, OBJ and VTK, by the
# same call, have a face without corners, a corner with the number 12884901890, and zeros.
#
# itk-wasm's declarations of Mesh and MeshType have cells as an array of cellBufferSize numbers, of the type that
# cellComponentType names. From OFF and VTK files of the same mesh it is that: for each cell its type, its number of
# points, and these points. The OBJ file has nothing but vertices and triangles.
#
# Seen with npm's @itk-wasm/mesh-io 1.7.1 and itk-wasm 1.0.0-b.201, for a square of two triangles:
#   from OFF: uint32 2,3,0,1,2,2,3,0,2,3
#   from OBJ: int64 12884901892,4294967296,17179869186,3,12884901890,0,0,0,0,0
#   faces in the OFF file made of OFF: 3 0 1 2 | 3 0 2 3
#   faces in the OFF file made of OBJ: 0 | 3 12884901890 0 0
#   corners in the STL file made of OBJ: 000 100 110 000 110 010
# 12884901892 is 4 + 3 * 2^32, and 4 and 3 are the type of the first cell, a polygon, and its number of points.
#
# This script installs these packages in a temporary folder, reads and writes the square, and fails if the behaviour is
# no longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @itk-wasm/mesh-io@1.7.1 itk-wasm@1.0.0-b.201 >npm.log

cat >square.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
f 1 2 3
f 1 3 4
OBJ
cat >square.off <<'MESH'
OFF
4 2 0
0 0 0
1 0 0
1 1 0
0 1 0
3 0 1 2
3 0 2 3
MESH

cat >convert.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import fs from "node:fs";
import { readMeshNode, writeMeshNode } from "@itk-wasm/mesh-io";

// The numbers of the lines that begin with one, from the fifth on: the faces, after three counts or so and four points.
function facesOf(path) {
  const lines = fs.readFileSync(path, "utf8").split("\n").map((line) => line.trim().replace(/ +/g, " "));
  return lines.filter((line) => /^\d/.test(line)).slice(5).join(" | ");
}

const offMesh = await readMeshNode("square.off");
const objMesh = await readMeshNode("square.obj");
for (const mesh of [offMesh, objMesh]) {
  assert.strictEqual(mesh.numberOfPoints, 4);
  assert.strictEqual(mesh.numberOfCells, 2);
  assert.strictEqual(mesh.cellBufferSize, 10);
  assert.deepStrictEqual([...mesh.points], [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
}
await writeMeshNode(offMesh, "of_off.off");
await writeMeshNode(objMesh, "of_obj.off");
await writeMeshNode(objMesh, "of_obj.stl");
const offCells = `${offMesh.meshType.cellComponentType} ${offMesh.cells}`;
const objCells = `${objMesh.meshType.cellComponentType} ${objMesh.cells}`;
const corners = [...fs.readFileSync("of_obj.stl", "utf8").matchAll(/vertex (\d) (\d) (\d)/g)];
const stl = corners.map((match) => match.slice(1).join("")).join(" ");
console.log("from OFF:", offCells);
console.log("from OBJ:", objCells);
console.log("faces in the OFF file made of OFF:", facesOf("of_off.off"));
console.log("faces in the OFF file made of OBJ:", facesOf("of_obj.off"));
console.log("corners in the STL file made of OBJ:", stl);

assert.strictEqual(offCells, "uint32 2,3,0,1,2,2,3,0,2,3");
assert.strictEqual(facesOf("of_off.off"), "3 0 1 2 | 3 0 2 3");
assert.strictEqual(objCells, "int64 12884901892,4294967296,17179869186,3,12884901890,0,0,0,0,0", "it has changed");
assert.strictEqual(facesOf("of_obj.off"), "0 | 3 12884901890 0 0", "it has changed");
assert.strictEqual(stl, "000 100 110 000 110 010", "it has changed");
JAVASCRIPT
for name in @itk-wasm/mesh-io itk-wasm; do
  node -p "'$name ' + JSON.parse(fs.readFileSync('node_modules/$name/package.json')).version"
done
node convert.mjs
