import { ShapeUtils } from "three/src/extras/ShapeUtils.js";
import { Vector2 } from "three/src/math/Vector2.js";

import { type Surface, faceCount } from "./surface.ts";

export interface Triangles {
  /** Three points of each triangle. */
  corners: Uint32Array;
  /** The face of the file that each triangle is a part of; ascending. */
  face: Uint32Array;
  /** Bit k: the edge across from corner k is a diagonal of its polygon, not an edge of the file. */
  diagonals: Uint8Array;
}

/** Cuts polygons into triangles for drawing. */
export function triangulate(surface: Surface): Triangles {
  const { begin, corners } = surface;
  const faces = faceCount(surface);
  let count = 0;
  for (let f = 0; f < faces; ++f) count += Math.max(begin[f + 1]! - begin[f]! - 2, 0);
  const out = {
    corners: new Uint32Array(3 * count),
    face: new Uint32Array(count),
    diagonals: new Uint8Array(count),
  };
  let t = 0;
  for (let f = 0; f < faces; ++f) {
    const first = begin[f]!;
    const sides = begin[f + 1]! - first;
    if (sides < 3) continue;
    for (const [a, b, c] of sides === 3 ? [[0, 1, 2]] : cut(surface, first, sides)) {
      out.corners[3 * t] = corners[first + a!]!;
      out.corners[3 * t + 1] = corners[first + b!]!;
      out.corners[3 * t + 2] = corners[first + c!]!;
      out.face[t] = f;
      const isSide = (i: number, j: number): boolean => (i + 1) % sides === j || (j + 1) % sides === i;
      out.diagonals[t] = (isSide(b!, c!) ? 0 : 1) | (isSide(c!, a!) ? 0 : 2) | (isSide(a!, b!) ? 0 : 4);
      ++t;
    }
  }
  // A polygon that crosses itself may have had fewer triangles than its corners promise.
  return {
    corners: out.corners.subarray(0, 3 * t),
    face: out.face.subarray(0, t),
    diagonals: out.diagonals.subarray(0, t),
  };
}

/** A polygon's triangles, in its plane by Newell's normal; those of three corners by numbers from 0. */
function cut(surface: Surface, first: number, sides: number): number[][] {
  const { points, corners } = surface;
  const at = (i: number, axis: number): number => points[3 * corners[first + (i % sides)]! + axis]!;
  const normal = [0, 0, 0];
  for (let i = 0; i < sides; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      normal[axis]! += (at(i, u) - at(i + 1, u)) * (at(i, v) + at(i + 1, v));
    }
  }
  let dropped = 0;
  for (let axis = 1; axis < 3; ++axis) if (Math.abs(normal[axis]!) > Math.abs(normal[dropped]!)) dropped = axis;
  const sign = normal[dropped]! < 0 ? -1 : 1;
  const [u, v] = [(dropped + 1) % 3, (dropped + 2) % 3];
  const flat = Array.from({ length: sides }, (_, i) => new Vector2(at(i, u), sign * at(i, v)));
  return ShapeUtils.triangulateShape(flat, []);
}
