#!/usr/bin/env bash
# The OBJ reader of vtk.js 37.4.3 cuts a file into one surface for each group if its splitMode is "g" (or for each
# material, with "usemtl"), and names each surface after its group. If faces stand before the first line "g", all names
# are off by one: the faces without a group get the name of the first group, the faces of the first group that of the
# second, and so on; the last group has no name. The surfaces themselves are right, so nothing looks wrong, but whoever
# takes the boundaries by their names gives the inlet's conditions to the wall, and the outlet's to the inlet.
#
# Wavefront's description of OBJ makes such files valid: a line "g" is a state that holds for the elements after it, and
# elements before any such line belong to a group of the name "default". Programs write such files where only some faces
# were put into a group. The same file with the line "g default" in front is read rightly.
#
# Seen with npm's @kitware/vtk.js 37.4.3, for a wall of z = 0, an inlet of z = 1 and an outlet of z = 2:
#   g default in front: default is at z = 0, inlet is at z = 1, outlet is at z = 2
#   no g in front:      inlet is at z = 0, outlet is at z = 1, undefined is at z = 2
#
# This script installs that package in a temporary folder, reads both files, and fails if the behaviour is no longer so.
# It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" --legacy-peer-deps \
  @kitware/vtk.js@37.4.3 >npm.log

cat >ungrouped.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 0 0 2
v 1 0 2
v 0 1 2
f 1 2 3
g inlet
f 4 5 6
g outlet
f 7 8 9
OBJ
# The same with the name that the first face has by default.
sed 's/^f 1 2 3$/g default\n&/' ungrouped.obj >grouped.obj

cat >read.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import fs from "node:fs";
import vtkOBJReader from "@kitware/vtk.js/IO/Misc/OBJReader.js";

function read(path) {
  const reader = vtkOBJReader.newInstance({ splitMode: "g" });
  reader.parseAsText(fs.readFileSync(path, "utf8"));
  return Array.from({ length: reader.getNumberOfOutputPorts() }, (_, port) => {
    const surface = reader.getOutputData(port);
    assert.strictEqual(surface.getNumberOfCells(), 1);
    return `${surface.get("name").name} is at z = ${surface.getBounds()[4]}`;
  }).join(", ");
}
const grouped = read("grouped.obj");
const ungrouped = read("ungrouped.obj");
console.log("g default in front:", grouped);
console.log("no g in front:     ", ungrouped);
assert.strictEqual(grouped, "default is at z = 0, inlet is at z = 1, outlet is at z = 2");
assert.strictEqual(ungrouped, "inlet is at z = 0, outlet is at z = 1, undefined is at z = 2", "it has changed");
JAVASCRIPT
node -p '"@kitware/vtk.js " + JSON.parse(fs.readFileSync("node_modules/@kitware/vtk.js/package.json")).version'
node read.mjs
