import { Scanner } from "./scanner.ts";
import { type Surface, SurfaceBuilder, UnreadableMesh } from "./surface.ts";

const kBackslash = 92;
const kV = 118;
const kF = 102;

/** Joins lines that end in a backslash. */
function withoutContinuations(bytes: Uint8Array): Uint8Array {
  if (!bytes.includes(kBackslash)) return bytes;
  const joined = bytes.slice();
  for (let at = joined.indexOf(kBackslash); at >= 0; at = joined.indexOf(kBackslash, at + 1)) {
    const end = joined[at + 1] === 13 ? at + 2 : at + 1;
    if (joined[end] === 10) joined.fill(32, at, end + 1);
  }
  return joined;
}

/** Points and faces of Wavefront OBJ; everything else is left to the daemon. */
export function readObj(bytes: Uint8Array): Surface {
  const scanner = new Scanner(withoutContinuations(bytes));
  const surface = new SurfaceBuilder();
  while (!scanner.isAtEnd) {
    if (scanner.hasWord()) {
      const key = scanner.bytes[scanner.at]!;
      const begin = scanner.at;
      scanner.skipWord();
      if (scanner.at - begin === 1) {
        // Flat drawings leave z out.
        if (key === kV) surface.addPoint(scanner.number(), scanner.number(), scanner.hasWord() ? scanner.number() : 0);
        else if (key === kF) readFace(scanner, surface);
      }
    }
    scanner.nextLine();
  }
  return surface.finish();
}

function readFace(scanner: Scanner, surface: SurfaceBuilder): void {
  while (scanner.hasWord() && scanner.bytes[scanner.at] !== 35 /* # */) {
    // "7", "7/2", "7//5", "-1/2/3": the number before the first slash.
    const { bytes } = scanner;
    let at = scanner.at;
    const isNegative = bytes[at] === 45;
    if (isNegative || bytes[at] === 43) ++at;
    let index = 0;
    const first = at;
    for (; bytes[at]! >= 48 && bytes[at]! <= 57; ++at) index = index * 10 + (bytes[at]! - 48);
    if (at === first || index === 0) throw new UnreadableMesh("A face's corner is not a number from 1.");
    scanner.skipWord();
    surface.addCorner(isNegative ? surface.pointCount - index : index - 1);
  }
  surface.endFace();
}
