#!/usr/bin/env bash
# A text STL file may hold several solids, one after the other, and OpenFOAM, Gmsh and others take each as a boundary or
# a part of its own. @jscad/stl-deserializer 2.1.30 makes a geometry of each solid, as one would hope, but looks for the
# facets in the whole file each time. So a file of N solids becomes N equal geometries, and each has the facets of all
# solids: no part is by itself, every facet is there N times, and the volumes add up to N times the volume. The
# description of its function deserialize promises a list of geometries. There is no warning, and a file of one solid is
# read rightly. The names of the solids are lost in either case.
#
# Seen with npm's @jscad/stl-deserializer 2.1.30 and @jscad/modeling 2.13.0:
#   1 solid: 1 geometry, with facets 12 and volumes 1
#   2 solids: 2 geometries, with facets 24, 24 and volumes 9, 9
#   3 solids: 3 geometries, with facets 36, 36, 36 and volumes 36, 36, 36
# The cubes have edges of 1, 2 and 3 and lie apart. Right would be facets 12, 12, 12 and volumes 1, 8, 27.
#
# This script installs these packages in a temporary folder, reads files of one, two and three cubes, and fails if the
# behaviour is no longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @jscad/stl-deserializer@2.1.30 @jscad/modeling@2.13.0 @jscad/io-utils@2.0.33 >npm.log

cat >read.js <<'JAVASCRIPT'
const assert = require("node:assert");
const { deserialize } = require("@jscad/stl-deserializer");
const { geometries, measurements } = require("@jscad/modeling");

// A cube as a solid of twelve facets that look outwards, with their true normals.
const axes = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
function cube(name, corner, size) {
  const facets = [];
  for (const [u, v, w] of axes)
    for (const side of [0, 1]) {
      const square = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([a, b]) => {
        const point = [corner, 0, 0];
        point[u] += size * a;
        point[v] += size * b;
        point[w] += size * side;
        return point;
      });
      if (side === 0) square.reverse();
      const normal = [0, 0, 0];
      normal[w] = side ? 1 : -1;
      for (const triangle of [[0, 1, 2], [0, 2, 3]])
        facets.push(`facet normal ${normal.join(" ")}\n outer loop\n` +
          triangle.map((i) => `  vertex ${square[i].join(" ")}\n`).join("") + " endloop\nendfacet\n");
    }
  return `solid ${name}\n${facets.join("")}endsolid ${name}\n`;
}

const cubes = [cube("inlet", 0, 1), cube("wall", 10, 2), cube("outlet", 20, 3)];
const seen = [];
for (const count of [1, 2, 3]) {
  const parts = deserialize({ output: "geometry" }, cubes.slice(0, count).join(""));
  const facets = parts.map((part) => geometries.geom3.toPolygons(part).length);
  const volumes = parts.map((part) => Math.round(1e6 * measurements.measureVolume(part)) / 1e6);
  console.log(`${count} solid${count > 1 ? "s" : ""}: ${parts.length} geometr${count > 1 ? "ies" : "y"}, ` +
    `with facets ${facets.join(", ")} and volumes ${volumes.join(", ")}`);
  seen.push({ facets, volumes });
}
assert.deepStrictEqual(seen, [
  { facets: [12], volumes: [1] },
  { facets: [24, 24], volumes: [9, 9] },
  { facets: [36, 36, 36], volumes: [36, 36, 36] },
], "it has changed");
JAVASCRIPT
node -p '"@jscad/stl-deserializer " + require("@jscad/stl-deserializer/package.json").version'
node read.js
