// Binary glTF as it is written: the validator of the Khronos Group finds no fault in it, and three.js loads the triangles
// that the JSON answer has, with a material for each boundary.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import validator from "gltf-validator";
import { bracket, root, startDaemon } from "./support.mjs";

const kThree = join(root, "server/web/node_modules/three");
let daemon;
let three;
let loader;

before(async () => {
  daemon = await startDaemon();
  // The loader looks for addresses of pictures, of which there are none.
  globalThis.self ??= globalThis;
  three = await import(pathToFileURL(join(kThree, "build/three.module.js")));
  const { GLTFLoader } = await import(pathToFileURL(join(kThree, "examples/jsm/loaders/GLTFLoader.js")));
  loader = new GLTFLoader();
});
after(() => daemon?.stop());

async function remesh(body, query) {
  const response = await fetch(`${daemon.origin}/v1/remesh?${new URLSearchParams(query)}`, { method: "POST", body });
  assert.equal(response.status, 200, await (response.ok ? "" : response.clone().text()));
  return response;
}

/** The corners of all triangles of a mesh of three, with the name of their material, in the coordinates of the file. */
function trianglesOf(object, digits) {
  const found = [];
  object.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const { position } = mesh.geometry.attributes;
    const index = mesh.geometry.index.array;
    for (let i = 0; i < index.length; i += 3) {
      const corners = [0, 1, 2].map((c) => [0, 1, 2].map((axis) => position.getComponent(index[i + c], axis)));
      found.push(JSON.stringify([corners, digits ? mesh.material.name : ""]));
    }
  });
  return found.sort();
}

const kBox = `v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4
g inlet\nf 4 3 2 1\nf 5 6 7 8\ng Wand\nf 1 2 6 5\nf 2 3 7 6\ng rest\nf 3 4 8 7\nf 4 1 5 8\n`;
const kInputs = { box: kBox, bracket: readFileSync(bracket) };

for (const [name, body] of Object.entries(kInputs)) {
  for (const query of [{}, { label: "patch" }, { label: "surface" }, { glb_colours: "quality" }]) {
    test(`${name} with ${JSON.stringify(query)} is valid and loads with the right triangles`, async () => {
      const wanted = await (await remesh(body, { ...query, format: "json", refine: "false" })).json();
      const bytes = new Uint8Array(
        await (await remesh(body, { ...query, format: "glb", refine: "false" })).arrayBuffer(),
      );
      const { issues, info } = await validator.validateBytes(bytes);
      assert.equal(
        issues.numErrors + issues.numWarnings + issues.numInfos + issues.numHints,
        0,
        JSON.stringify(issues),
      );
      assert.equal(info.totalTriangleCount, wanted.mesh.faces.length);

      const { scene } = await loader.parseAsync(bytes.buffer, "");
      const hasNames = name === "box" && Object.keys(query).length === 0;
      const groups = wanted.mesh.labels?.group;
      const expected = wanted.mesh.faces.map((face, f) =>
        JSON.stringify([
          face.map((v) => wanted.mesh.vertices[v].map(Math.fround)),
          hasNames ? groups.names[groups.of_face[f]] : "",
        ]),
      );
      assert.deepEqual(trianglesOf(scene, hasNames), expected.sort());

      // The z axis points upwards: the scene is as high as the part.
      const size = new three.Box3().setFromObject(scene).getSize(new three.Vector3());
      const { min, max } = wanted.report.output.bounding_box;
      for (const [axis, of] of [
        ["x", 0],
        ["y", 2],
        ["z", 1],
      ])
        assert.ok(Math.abs(size[axis] - (max[of] - min[of])) < 1e-5 * size.length(), axis);
      const colours = new Set();
      scene.traverse(({ material }) => material && colours.add(`${material.name} ${material.color.getHexString()}`));
      assert.ok(colours.size >= (query.glb_colours ? 1 : 3), [...colours].join());
    });
  }
}
