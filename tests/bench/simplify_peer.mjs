// The simplification of meshoptimizer, which npm has: `node simplify_peer.mjs NODE_MODULES IN.obj OUT.obj ERROR` makes
// the faces as few as an error allows, in the file's unit, and prints how many milliseconds that took, and the faces
// before and after, as JSON. Vertices may move. Nothing promises that the error is the distance.
import {readFileSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [modules, path, output, error] = process.argv.slice(2);
const {MeshoptSimplifier: simplifier} =
    await import(pathToFileURL(join(resolve(modules), 'meshoptimizer', 'meshopt_simplifier.js')).href);
await simplifier.ready;

// Triangles, as the bench writes them.
function readObj(text) {
  const positions = [], corners = [];
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') positions.push(...words.slice(1, 4).map(Number));
    if (words[0] === 'f') corners.push(...words.slice(1, 4).map((word) => parseInt(word, 10) - 1));
  }
  return {positions, corners};
}

const start = performance.now();
const mesh = readObj(readFileSync(path, 'utf8'));
const corners = Uint32Array.from(mesh.corners), positions = Float32Array.from(mesh.positions);
const read = performance.now();
const kept = simplifier.simplifyWithUpdate(
    corners, positions, 3, new Float32Array(0), 0, [], null, 0, Number(error), ['ErrorAbsolute'])[0];
const simplified = performance.now();
const lines = [];
for (let i = 0; i < positions.length; i += 3)
  lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
for (let i = 0; i < kept; i += 3)
  lines.push(`f ${corners[i] + 1} ${corners[i + 1] + 1} ${corners[i + 2] + 1}`);
writeFileSync(output, lines.join('\n') + '\n');
const end = performance.now();
console.log(JSON.stringify(
    {read_ms: read - start, process_ms: simplified - read, write_ms: end - simplified,
     faces_in: mesh.corners.length / 3, faces_out: kept / 3}));
