#!/usr/bin/env bash
# VTK's own text files (.vtk) hold labels and other numbers of the faces in one of two ways: as SCALARS, or as one of
# the arrays of a FIELD, of which there may be several. VTK writes all arrays as FIELD but the few that were made the
# active ones. The reader of vtk.js 37.4.3 reads SCALARS and passes over FIELD. So the labels that VTK has written for
# the faces of a part are gone, and the mesh has no cell data at all. The reader has FIELD in its lists of words, as a
# thing to be added to a mesh's arrays, but no code that reads it.
#
# And it takes texture coordinates for groups of three, however many the file says. Six points with two each become four
# groups of three numbers: the first point gets a number of the second one, and the last two points get none. There is
# no error and no warning in either case.
#
# VTK's description of the format ("VTK File Formats") has FIELD among the data of points and cells, and the number of
# texture coordinates of a point, from 1 to 3, behind their name. VTK 9.1 reads both.
#
# Seen with npm's @kitware/vtk.js 37.4.3, for two squares of two triangles each:
#   SCALARS: 4 cells, cell data label = 7 7 8 8
#   FIELD: 4 cells, no cell data
#   both: 4 cells, cell data label = 7 7 8 8          and a FIELD with the array size after it
#   texture coordinates of 6 points: 4 of 3 numbers, the second one is 0 1 0          right is 6 of 2, and 0.5 0
#
# This script installs that package in a temporary folder, reads the files, and fails if the behaviour is no longer so.
# It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" --legacy-peer-deps \
  @kitware/vtk.js@37.4.3 >npm.log

# Two squares beside each other, cut into triangles.
mesh='# vtk DataFile Version 4.2
two squares
ASCII
DATASET POLYDATA
POINTS 6 float
0 0 0 1 0 0 2 0 0
0 1 0 1 1 0 2 1 0
POLYGONS 4 16
3 0 1 4
3 0 4 3
3 1 2 5
3 1 5 4'
scalars='SCALARS label int 1
LOOKUP_TABLE default
7 7 8 8'
field='FIELD FieldData 1
label 1 4 int
7 7 8 8'
printf '%s\n' "$mesh" 'CELL_DATA 4' "$scalars" >scalars.vtk
printf '%s\n' "$mesh" 'CELL_DATA 4' "$field" >field.vtk
printf '%s\n' "$mesh" 'CELL_DATA 4' "$scalars" "${field/label/size}" >both.vtk
printf '%s\n' "$mesh" 'POINT_DATA 6' 'TEXTURE_COORDINATES place 2 float' '0 0 0.5 0 1 0' '0 1 0.5 1 1 1' >texture.vtk

cat >read.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import fs from "node:fs";
import vtkPolyDataReader from "@kitware/vtk.js/IO/Legacy/PolyDataReader.js";

function read(path) {
  const reader = vtkPolyDataReader.newInstance();
  reader.parseAsText(fs.readFileSync(path, "utf8"));
  const mesh = reader.getOutputData();
  assert.strictEqual(mesh.getNumberOfPoints(), 6);
  assert.deepStrictEqual([...mesh.getPolys().getData()], [3, 0, 1, 4, 3, 0, 4, 3, 3, 1, 2, 5, 3, 1, 5, 4]);
  return mesh;
}

function cells(path) {
  const mesh = read(path);
  assert.strictEqual(mesh.getFieldData().getArrays().length, 0); // it is not kept there either
  const text = (array) => `${array.getName()} = ${[...array.getData()].join(" ")}`;
  const arrays = mesh.getCellData().getArrays().map(text);
  return `${mesh.getNumberOfCells()} cells, ${arrays.length > 0 ? `cell data ${arrays.join(", ")}` : "no cell data"}`;
}

const told = [];
for (const name of ["warn", "error"]) {
  console[name] = (...words) => told.push(words.join(" "));
}
const texture = read("texture.vtk").getPointData().getTCoords();
const seen = [
  `SCALARS: ${cells("scalars.vtk")}`,
  `FIELD: ${cells("field.vtk")}`,
  `both: ${cells("both.vtk")}`,
  `texture coordinates of 6 points: ${texture.getNumberOfTuples()} of ${texture.getNumberOfComponents()} numbers, ` +
    `the second one is ${[...texture.getTuple(1)].join(" ")}`,
];
console.log(seen.join("\n"));
assert.deepStrictEqual(seen, [
  "SCALARS: 4 cells, cell data label = 7 7 8 8",
  "FIELD: 4 cells, no cell data",
  "both: 4 cells, cell data label = 7 7 8 8",
  "texture coordinates of 6 points: 4 of 3 numbers, the second one is 0 1 0",
], "it has changed");
assert.deepStrictEqual(told, [], "it has changed: vtk.js tells");
JAVASCRIPT
node -p '"@kitware/vtk.js " + JSON.parse(fs.readFileSync("node_modules/@kitware/vtk.js/package.json")).version'
node read.mjs
