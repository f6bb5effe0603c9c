// Which triangles share an edge.

/** Stands for the other side of an edge of one triangle. */
export const kOpen = -1;
/** Of an edge of three or more. */
export const kNonManifold = -2;

function tableSize(items: number): number {
  return 2 ** Math.ceil(Math.log2(Math.max(2 * items, 16)));
}

/** For each point the first one with the same coordinates: STL files repeat them for each triangle. */
export function mergeEqualPoints(points: Float64Array): Uint32Array {
  const count = points.length / 3;
  // Adding 0 makes -0 the 0 that it is equal to.
  const bits = new Uint32Array(points.map((x) => x + 0).buffer);
  const mask = tableSize(count) - 1;
  const table = new Int32Array(mask + 1).fill(-1);
  const first = new Uint32Array(count);
  for (let p = 0; p < count; ++p) {
    let hash = 0;
    for (let i = 6 * p; i < 6 * p + 6; ++i) hash = Math.imul(hash ^ bits[i]!, 0x9e3779b1) ^ (hash >>> 15);
    let slot = (hash ^ (hash >>> 16)) & mask;
    for (; table[slot]! >= 0; slot = (slot + 1) & mask) {
      const q = table[slot]!;
      if (
        points[3 * p] === points[3 * q] &&
        points[3 * p + 1] === points[3 * q + 1] &&
        points[3 * p + 2] === points[3 * q + 2]
      )
        break;
    }
    if (table[slot]! < 0) table[slot] = p;
    first[p] = table[slot]!;
  }
  return first;
}

/**
 * Half-edge 3 t + k is the edge of triangle t across from its corner k.
 * Output: for each the half-edge on the other side, kOpen or kNonManifold.
 */
export function twins(corners: Uint32Array, merged: Uint32Array): Int32Array {
  const mask = tableSize(corners.length) - 1;
  const table = new Int32Array(mask + 1).fill(-1);
  const twin = new Int32Array(corners.length).fill(kOpen);
  const end = (h: number, step: number): number => merged[corners[h - (h % 3) + ((h + step) % 3)]!]!;
  for (let h = 0; h < corners.length; ++h) {
    const a = end(h, 1),
      b = end(h, 2);
    const low = Math.min(a, b),
      high = Math.max(a, b);
    let slot = Math.imul(low, 0x9e3779b1) ^ Math.imul(high, 0x85ebca6b);
    slot = (slot ^ (slot >>> 15)) & mask;
    for (; table[slot]! >= 0; slot = (slot + 1) & mask) {
      const g = table[slot]!;
      const c = end(g, 1),
        d = end(g, 2);
      if (Math.min(c, d) === low && Math.max(c, d) === high) break;
    }
    const other = table[slot]!;
    if (other < 0) {
      table[slot] = h;
    } else if (twin[other] === kOpen) {
      twin[other] = h;
      twin[h] = other;
    } else {
      if (twin[other]! >= 0) twin[twin[other]!] = kNonManifold;
      twin[other] = twin[h] = kNonManifold;
    }
  }
  return twin;
}
