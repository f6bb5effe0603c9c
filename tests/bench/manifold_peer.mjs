// The union of the components of an OBJ file by manifold, which npm has: `node manifold_peer.mjs NODE_MODULES IN.obj`
// prints how many milliseconds that took, and the faces before and after, as JSON. Each component is a closed part.
import {readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [modules, path] = process.argv.slice(2);
const {default: load} = await import(pathToFileURL(join(resolve(modules), 'manifold-3d', 'manifold.js')).href);
const wasm = await load();
wasm.setup();

function readObj(text) {
  const positions = [], faces = [];
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') positions.push(words.slice(1, 4).map(Number));
    if (words[0] === 'f') faces.push(words.slice(1, 4).map((word) => parseInt(word, 10) - 1));
  }
  return {positions, faces};
}

// The faces of each component, which hang together over vertices.
function componentsOf({positions, faces}) {
  const root = positions.map((_, i) => i);
  const find = (i) => {
    while (root[i] !== i) i = root[i] = root[root[i]];
    return i;
  };
  for (const face of faces) for (const v of face) root[find(v)] = find(face[0]);
  const all = new Map();
  for (const face of faces) {
    const key = find(face[0]);
    if (!all.has(key)) all.set(key, []);
    all.get(key).push(face);
  }
  return [...all.values()];
}

function partOf(positions, faces) {
  const number = new Map();
  for (const face of faces) for (const v of face) if (!number.has(v)) number.set(v, number.size);
  const mesh = new wasm.Mesh({
    numProp: 3,
    vertProperties: Float32Array.from([...number.keys()].flatMap((v) => positions[v])),
    triVerts: Uint32Array.from(faces.flat().map((v) => number.get(v))),
  });
  return new wasm.Manifold(mesh);
}

const begin = performance.now();
const mesh = readObj(readFileSync(path, 'utf8'));
const parts = componentsOf(mesh);
const read = performance.now();
const united = wasm.Manifold.union(parts.map((faces) => partOf(mesh.positions, faces)));
const facesOut = united.numTri();
const end = performance.now();
console.log(JSON.stringify(
    {read_ms: read - begin, process_ms: end - read, write_ms: 0, faces_in: mesh.faces.length, faces_out: facesOut}));
