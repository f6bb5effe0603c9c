// Remeshes a file by a service from JavaScript, in a browser or in Node 18: node browser.mjs URL PART
// With three.js, GLTFLoader takes the answer to format=glb as it is.
import { readFile } from "node:fs/promises";

const [url, part] = process.argv.slice(2);
const answer = await fetch(`${url}/v1/remesh?format=json&preset=volume`, { method: "POST", body: await readFile(part) });
const { mesh, report, detail } = await answer.json();
if (!answer.ok) throw new Error(detail);
console.log(`${mesh.faces.length} triangles, closed: ${report.output.closed}, ready for a volume mesher: ${report.volume_ready.ready}`);
