// A mesh file of any format that the daemon reads, told by its content as the daemon does.
import { readJson } from "./read_json.ts";
import { readObj } from "./read_obj.ts";
import { readOff } from "./read_off.ts";
import { readPly } from "./read_ply.ts";
import { isBinaryStl, readBinaryStl, readTextStl } from "./read_stl.ts";
import { type Surface, UnreadableMesh } from "./surface.ts";

/** Errors: UnreadableMesh. */
export async function readMesh(file: Uint8Array): Promise<Surface> {
  const bytes = await unpacked(file);
  try {
    return reader(bytes)(bytes);
  } catch (error) {
    if (error instanceof UnreadableMesh) throw error;
    if (error instanceof SyntaxError) throw new UnreadableMesh("It is not valid JSON.");
    throw new UnreadableMesh("Its content does not match its format.");
  }
}

async function unpacked(bytes: Uint8Array): Promise<Uint8Array> {
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  try {
    const stream = new Blob([bytes as BlobPart]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new UnreadableMesh("Its gzip data is broken.");
  }
}

/** A solid's name, which comes before the first facet, may have 4096 bytes. */
const kHead = 8192;

function reader(bytes: Uint8Array): (bytes: Uint8Array) => Surface {
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, kHead)).replace(/^\u00ef\u00bb\u00bf/, "");
  if (/^ply\s/.test(head)) return readPly;
  if (/^\s*\{/.test(head)) return readJson;
  if (/^(\s*#.*\n)*\s*(ST)?C?N?4?n?OFF\b/.test(head)) return readOff;
  if (/^(\s*(#|;|!|\/\/).*\n)*\s*solid\b/i.test(head) && /\bfacet\b|\bendsolid\b/i.test(head)) return readTextStl;
  if (isBinaryStl(bytes)) return readBinaryStl;
  if (/^\s*(v|vn|vt|f|o|g|mtllib|usemtl|s|#)\s/m.test(head)) return readObj;
  throw new UnreadableMesh("It is not a mesh in a format that this page can read.");
}
