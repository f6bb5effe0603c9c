import { Scanner } from "./scanner.ts";
import { type Surface, SurfaceBuilder, UnreadableMesh } from "./surface.ts";

const kMagic = /^(ST)?(C)?(N)?(4)?(n)?OFF(\s+BINARY)?$/;

export function readOff(bytes: Uint8Array): Surface {
  const scanner = new Scanner(bytes);
  scanner.hasMore();
  const begin = scanner.at;
  const first = scanner.line().replace(/\s*#.*/, "");
  const magic = kMagic.exec(first);
  if (magic?.[4] !== undefined) throw new UnreadableMesh("Points with four coordinates cannot be drawn.");
  if (magic?.[6] !== undefined) return readBinary(bytes, scanner.at, magic);
  // The counts may stand on the first line.
  if (magic === null) {
    scanner.at = begin;
    if (/^\w*OFF\s/.test(first)) scanner.word();
  }
  return readText(scanner, magic?.[5] !== undefined);
}

function readText(scanner: Scanner, hasDimension: boolean): Surface {
  const next = (): number => {
    if (!scanner.hasMore()) throw new UnreadableMesh("The file ends too early.");
    return scanner.number();
  };
  if (hasDimension && next() !== 3) throw new UnreadableMesh("Its points do not have three coordinates.");
  const [points, faces] = [next(), next()];
  next();
  const surface = new SurfaceBuilder();
  for (let i = 0; i < points; ++i) {
    surface.addPoint(next(), next(), next());
    scanner.nextLine(); // colours and normals
  }
  for (let f = 0; f < faces; ++f) {
    for (let left = next(); left > 0; --left) surface.addCorner(next());
    surface.endFace();
    scanner.nextLine();
  }
  return surface.finish();
}

function readBinary(bytes: Uint8Array, begin: number, magic: RegExpExecArray): Surface {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = begin;
  const integer = (): number => view.getInt32((at += 4) - 4);
  const surface = new SurfaceBuilder();
  try {
    if (magic[5] !== undefined) integer();
    const [points, faces] = [integer(), integer()];
    integer();
    // In Geomview's order: the point, its normal, its colour, its texture coordinates.
    const more = (magic[3] ? 12 : 0) + (magic[2] ? 16 : 0) + (magic[1] ? 8 : 0);
    for (let i = 0; i < points; ++i, at += 12 + more) {
      surface.addPoint(view.getFloat32(at), view.getFloat32(at + 4), view.getFloat32(at + 8));
    }
    for (let f = 0; f < faces; ++f) {
      for (let left = integer(); left > 0; --left) surface.addCorner(integer());
      surface.endFace();
      at += 4 * integer();
    }
  } catch (error) {
    if (error instanceof RangeError) throw new UnreadableMesh("The file ends too early.");
    throw error;
  }
  return surface.finish();
}
