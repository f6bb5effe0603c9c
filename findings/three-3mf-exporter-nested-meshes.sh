#!/usr/bin/env bash
# three-3mf-exporter 45.2.0 writes a scene of three.js as 3MF. It looks for parts below groups, but not below meshes: a
# mesh that hangs on another mesh is left out. three.js itself builds such scenes when it reads glTF. A node of a glTF
# file that has a mesh of its own and other nodes below it becomes a mesh with meshes below it. So a housing with its
# lid and its screws as children becomes the housing alone. An InstancedMesh, which is one mesh in many places, becomes
# one part at the origin, whatever the places are. There is no error and no warning.
#
# And the numbers are written as they are, as millimetres, although glTF's are metres: what is 2 metres wide becomes 2
# millimetres. The package has no option for it. With that go five decimals, so that a foil of 4 micrometres has no
# thickness, and one of 12.7 micrometres has 10.
#
# glTF's specification (2.0) has any node with a mesh, children, or both, with the children placed relative to it, and
# metres for all lengths. The manual of three.js has children at every Object3D, of which Mesh is one. 3MF's core
# specification lets a unit be micron, millimeter, centimeter, inch, foot or meter.
#
# Seen with npm's three-3mf-exporter 45.2.0 and three 0.134.0, for a box of 2 by 2 by 2 metres with two others, at
# x = 10 and x = 20, from a glTF file or as an InstancedMesh:
#   beside each other: 3 parts, x from 0 to 22 millimeter
#   below a group: 3 parts, x from 0 to 22 millimeter
#   below the first one: 1 part, x from 0 to 2 millimeter            right is 3 parts, x from 0 to 22
#   each below the one before: 1 part, x from 0 to 2 millimeter      right is 3 parts, x from 0 to 22
#   as instances: 1 part, x from 0 to 2 millimeter                   right is 3 parts, x from 0 to 22
#   thickness of foils: 0.00001 for 0.0000127, 0.00000 for 0.000004
# The numbers of x are those of the model before it is moved to the middle of the printer's bed, which the package's
# page announces.
#
# This script installs these packages in a temporary folder, reads and writes the scenes, and fails if the behaviour is
# no longer so. It ends with 77 if the packages cannot be had. It needs node and npm, and changes nothing outside of
# the folder but npm's cache.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

npm install --no-save --no-audit --no-fund --ignore-scripts --loglevel=error --prefix "$folder" \
  three-3mf-exporter@45.2.0 three@0.134.0 jszip@3.10.1 fast-xml-parser@5.0.9 >npm.log 2>&1 || { cat npm.log; exit 77; }

cat >nested.mjs <<'JAVASCRIPT'
import assert from "node:assert";
import JSZip from "jszip";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { exportTo3MF } from "three-3mf-exporter";

globalThis.self = globalThis; // where the loader of three.js looks for a browser's names
const complaints = [];
const print = console.log;
for (const name of ["log", "warn", "error"]) {
  console[name] = (...words) => complaints.push(words.join(" "));
}

// A box with one corner at the origin, as the only mesh of a binary glTF file with these nodes.
function glb(size, nodes, roots) {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((number) =>
    size.map((edge, axis) => edge * ((number >> axis) & 1)));
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const numbers = sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  const arrays = [new Float32Array(corners), new Uint16Array(numbers)];
  const data = Buffer.concat(arrays.map(({ buffer }) => Buffer.from(buffer)));
  const text = JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: roots }], nodes,
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 8, type: "VEC3", min: [0, 0, 0], max: size.map(Math.fround) },
      { bufferView: 1, componentType: 5123, count: 36, type: "SCALAR" },
    ],
    bufferViews: [{ buffer: 0, byteLength: 96 }, { buffer: 0, byteOffset: 96, byteLength: 72 }],
    buffers: [{ byteLength: 168 }],
  });
  const json = Buffer.from(text.padEnd(4 * Math.ceil(text.length / 4)));
  const words = (...values) => Buffer.from(new Uint32Array(values).buffer);
  const file = Buffer.concat([words(0x46546c67, 2, 28 + json.length + data.length), words(json.length, 0x4e4f534a),
    json, words(data.length, 0x004e4942), data]);
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.length);
}
const load = (file) => new Promise((done, failed) => {
  new GLTFLoader().parse(file, "", (gltf) => done(gltf.scene), failed);
});
const write = async (scene) => {
  const archive = await JSZip.loadAsync(await (await exportTo3MF(scene)).arrayBuffer());
  return archive.file("3D/3dmodel.model").async("string");
};

// The parts that are built, and where they are along x. Nothing is turned here, so shifts are all that counts.
function describe(model) {
  const objects = new Map(Array.from(model.matchAll(/<object id="(\d+)".*?<\/object>/gs), ([text, id]) => [id, text]));
  const shift = (text) => Number(text.match(/transform="([^"]*)"/)[1].split(" ")[9]);
  const places = (id) => {
    const inner = Array.from(objects.get(id).matchAll(/<component objectid="(\d+)"[^>]*>/g));
    const own = Array.from(objects.get(id).matchAll(/<vertex x="([^"]*)"/g), ([, x]) => Number(x));
    return own.length > 0 ? [own]
      : inner.flatMap(([text, child]) => places(child).map((part) => part.map((x) => x + shift(text))));
  };
  const parts = Array.from(model.matchAll(/<item objectid="(\d+)"[^>]*>/g)).flatMap(([text, id]) =>
    places(id).map((part) => part.map((x) => x + shift(text))));
  const all = parts.flat();
  const wide = Math.max(...all) - Math.min(...all);
  const middle = (Math.max(...all) + Math.min(...all)) / 2;
  assert.ok(Math.abs(middle - 128) < 1e-4);
  const word = parts.length === 1 ? "part" : "parts";
  return `${parts.length} ${word}, x from 0 to ${Number(wide.toFixed(4))} ${model.match(/<model unit="(\w+)"/)[1]}`;
}
const box = [2, 2, 2];
const at = (x, node = {}) => ({ mesh: 0, translation: [x, 0, 0], ...node });
const read = async (nodes, roots) => {
  const scene = await load(glb(box, nodes, roots));
  let meshes = 0;
  scene.traverse((object) => { meshes += object.isMesh ? 1 : 0; });
  assert.strictEqual(meshes, 3); // three.js has all of them
  return describe(await write(scene));
};
const instances = async () => {
  const [{ geometry }] = (await load(glb(box, [at(0)], [0]))).children;
  const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshBasicMaterial(), 3);
  [0, 10, 20].forEach((x, number) => mesh.setMatrixAt(number, new THREE.Matrix4().makeTranslation(x, 0, 0)));
  return describe(await write(new THREE.Scene().add(mesh)));
};
const thickness = async (metres) => {
  const model = await write(await load(glb([2, 2, metres], [at(0)], [0])));
  return Array.from(model.matchAll(/ z="([^"]*)"/g), ([, z]) => z).sort().pop();
};

const seen = [
  `beside each other: ${await read([at(0), at(10), at(20)], [0, 1, 2])}`,
  `below a group: ${await read([{ children: [1, 2, 3] }, at(0), at(10), at(20)], [0])}`,
  `below the first one: ${await read([at(0, { children: [1, 2] }), at(10), at(20)], [0])}`,
  `each below the one before: ${await read([at(0, { children: [1] }), at(10, { children: [2] }), at(10)], [0])}`,
  `as instances: ${await instances()}`,
  `thickness of foils: ${await thickness(0.0000127)} for 0.0000127, ${await thickness(0.000004)} for 0.000004`,
];
print(seen.join("\n"));
assert.deepStrictEqual(seen, [
  "beside each other: 3 parts, x from 0 to 22 millimeter",
  "below a group: 3 parts, x from 0 to 22 millimeter",
  "below the first one: 1 part, x from 0 to 2 millimeter",
  "each below the one before: 1 part, x from 0 to 2 millimeter",
  "as instances: 1 part, x from 0 to 2 millimeter",
  "thickness of foils: 0.00001 for 0.0000127, 0.00000 for 0.000004",
], "it has changed");
assert.deepStrictEqual(complaints, [], "it has changed: the exporter tells");
JAVASCRIPT
for name in three-3mf-exporter three; do
  echo "$name $(sed -n 's/^ *"version": "\(.*\)",*$/\1/p' "node_modules/$name/package.json")"
done
node nested.mjs
