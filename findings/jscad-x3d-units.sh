#!/usr/bin/env bash
# X3D has metres and radians unless a file says otherwise in a "unit" statement. JSCAD's writer of X3D, which is
# @jscad/x3d-serializer 2.4.13, has an option "unit", for which its description lists millimeter, inch, feet, meter and
# micrometer, and its page has an example with inches. The option does nothing: the files are the same, byte for byte,
# and none has a unit statement. A part of 10 by 20 by 30 millimetres is one of as many metres, whatever one asks for.
#
# JSCAD's reader (@jscad/x3d-deserializer 2.2.13) says on its page that lengths and angles can be changed by a unit
# statement. They cannot. A part in a file whose unit is the inch comes out with the same numbers as in one whose unit
# is the metre. A turn by 90 in a file whose angles are degrees is one by 90 radians, which is 116.6 degrees after
# fourteen full turns, so that the part stands askew. The field scaleOrientation of a Transform, which tells along which
# axes it stretches, is not taken either: its name is looked up in small letters, and so is the factor of a unit. There
# is no error and no warning in any of these cases.
#
# X3D's standard (ISO/IEC 19775-1, 3.3 and later) has the unit statement with a factor to metres and to radians, and
# scaleOrientation as a turn before the stretch and back after it. The writer of AMF in the same family of packages
# writes the unit that its option says.
#
# Seen with npm's @jscad/x3d-serializer 2.4.13, @jscad/x3d-deserializer 2.2.13 and @jscad/amf-serializer 2.1.23:
#   writer of X3D, 5 units: 1 kind of file, 0 unit statements
#   writer of AMF, 5 units: millimeter, inch, feet, meter, micrometer
#   reader, no unit: 2 by 4 by 6
#   reader, inches: 2 by 4 by 6                              right is 0.0254 times as much
#   reader, a turn by half of pi: 4 by 2 by 6
#   reader, a turn by 90 degrees: 4.472 by 3.58 by 6         right is 4 by 2 by 6
#   reader, a stretch along a diagonal: 4 by 4 by 6          right is 5 by 7 by 6
#
# This script installs these packages in a temporary folder, writes and reads such files, and fails if the behaviour is
# no longer so. It needs node and npm, and changes nothing outside of the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  @jscad/x3d-serializer@2.4.13 @jscad/x3d-deserializer@2.2.13 @jscad/amf-serializer@2.1.23 @jscad/modeling@2.13.0 \
  @jscad/io-utils@2.0.33 @jscad/array-utils@2.1.4 >npm.log

cat >units.js <<'JAVASCRIPT'
const assert = require("node:assert");
const amf = require("@jscad/amf-serializer");
const x3d = require("@jscad/x3d-serializer");
const { deserialize } = require("@jscad/x3d-deserializer");
const { measurements, primitives } = require("@jscad/modeling");

const complaints = [];
const print = console.log;
for (const name of ["log", "warn", "error"]) {
  console[name] = (...words) => complaints.push(words.join(" "));
}

const units = ["millimeter", "inch", "feet", "meter", "micrometer"];
const part = primitives.cuboid({ size: [10, 20, 30] });
const files = units.map((unit) => x3d.serialize({ unit, metadata: false }, part).join(""));
const amfUnits = units.map((unit) => amf.serialize({ unit }, part).join("").match(/<amf[^>]* unit="(\w+)"/)[1]);

function read(unit, field) {
  const source = `<?xml version="1.0" encoding="UTF-8"?>
<X3D profile="Immersive" version="3.3">
  <head>${unit}</head>
  <Scene><Transform ${field}><Shape><Box size="2 4 6"/></Shape></Transform></Scene>
</X3D>`;
  const [low, high] = measurements.measureAggregateBoundingBox(deserialize({ output: "geometry" }, source));
  return high.map((end, axis) => Number((end - low[axis]).toPrecision(4))).join(" by ");
}
const inch = '<unit category="length" name="inch" conversionFactor="0.0254"/>';
const degree = `<unit category="angle" name="degree" conversionFactor="${Math.PI / 180}"/>`;

const seen = [
  `writer of X3D, ${units.length} units: ${new Set(files).size} kind of file, ` +
    `${files.filter((file) => /<unit/i.test(file)).length} unit statements`,
  `writer of AMF, ${units.length} units: ${amfUnits.join(", ")}`,
  `reader, no unit: ${read("", "")}`,
  `reader, inches: ${read(inch, "")}`,
  `reader, a turn by half of pi: ${read("", `rotation="0 0 1 ${Math.PI / 2}"`)}`,
  `reader, a turn by 90 degrees: ${read(degree, 'rotation="0 0 1 90"')}`,
  `reader, a stretch along a diagonal: ${read("", `scale="2 1 1" scaleOrientation="0 0 1 ${Math.PI / 4}"`)}`,
];
print(seen.join("\n"));
assert.deepStrictEqual(seen, [
  "writer of X3D, 5 units: 1 kind of file, 0 unit statements",
  "writer of AMF, 5 units: millimeter, inch, feet, meter, micrometer",
  "reader, no unit: 2 by 4 by 6",
  "reader, inches: 2 by 4 by 6",
  "reader, a turn by half of pi: 4 by 2 by 6",
  "reader, a turn by 90 degrees: 4.472 by 3.58 by 6",
  "reader, a stretch along a diagonal: 4 by 4 by 6",
], "it has changed");
assert.deepStrictEqual(complaints, [], "it has changed: JSCAD tells");
JAVASCRIPT
for name in x3d-serializer x3d-deserializer amf-serializer; do
  node -p "'@jscad/$name ' + require('@jscad/$name/package.json').version"
done
node units.js
