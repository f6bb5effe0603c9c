import { mergeEqualPoints } from "./adjacency.ts";
import { Scanner } from "./scanner.ts";
import { type Surface, SurfaceBuilder, UnreadableMesh, checkSurface } from "./surface.ts";

const kHead = 84;
const kFacet = 50;

export function isBinaryStl(bytes: Uint8Array): boolean {
  if (bytes.length < kHead) return false;
  const count = new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);
  return bytes.length >= kHead + kFacet * count && (count > 0 || bytes.length === kHead);
}

export function readBinaryStl(bytes: Uint8Array): Surface {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const count = view.getUint32(80, true);
  const points = new Float64Array(9 * count);
  for (let f = 0; f < count; ++f) {
    const at = kHead + kFacet * f + 12;
    for (let i = 0; i < 9; ++i) points[9 * f + i] = view.getFloat32(at + 4 * i, true);
  }
  const surface = {
    points,
    begin: Uint32Array.from({ length: count + 1 }, (_, f) => 3 * f),
    corners: Uint32Array.from({ length: 3 * count }, (_, c) => c),
  };
  checkSurface(surface);
  return merged(surface);
}

/** STL repeats a point for each triangle: equal ones are one, numbered by first appearance, as the daemon has them. */
function merged({ points, begin, corners }: Surface): Surface {
  const first = mergeEqualPoints(points);
  const number = new Uint32Array(first.length);
  const kept = new Float64Array(points.length);
  let count = 0;
  for (let p = 0; p < first.length; ++p) {
    if (first[p] !== p) continue;
    kept.set(points.subarray(3 * p, 3 * p + 3), 3 * count);
    number[p] = count++;
  }
  return { points: kept.slice(0, 3 * count), begin, corners: corners.map((corner) => number[first[corner]!]!) };
}

const kKeywords = /^(solid|facet|normal|outer|loop|vertex|end|endloop|endfacet|endsolid)$/;
const kComment = /^(#|;|!|\/\/)/;

export function readTextStl(bytes: Uint8Array): Surface {
  const scanner = new Scanner(bytes);
  const surface = new SurfaceBuilder();
  let corners = 0;
  // Lines that begin with no keyword may stand before the first solid, and between a solid's name and its first facet.
  let isInHead = true;
  while (!scanner.isAtEnd) {
    let word = scanner
      .word()
      .toLowerCase()
      .replace(/^\u00ef\u00bb\u00bf/, "");
    if (word === "end") word += scanner.word().toLowerCase();
    if (word === "vertex") {
      surface.addCorner(surface.pointCount);
      surface.addPoint(scanner.number(), scanner.number(), scanner.number());
      ++corners;
    } else if (word === "endloop") {
      if (corners < 3) throw new UnreadableMesh("A facet has less than three corners.");
      surface.endFace();
      corners = 0;
    } else if (word === "facet") {
      isInHead = false;
    } else if (word === "solid") {
      isInHead = true;
    }
    // "outer loop vertex ..." may stand on one line.
    const isForWholeLine = word === "solid" || word === "endsolid" || kComment.test(word);
    const isOfHead = isInHead && !kKeywords.test(word);
    if (!scanner.hasWord() || isForWholeLine || isOfHead) scanner.nextLine();
  }
  return merged(surface.finish());
}
