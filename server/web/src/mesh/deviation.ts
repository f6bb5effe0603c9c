// How far two surfaces are apart, as it is measured at places of both.
import { NearestTriangles } from "./nearest.ts";

export interface Deviation {
  /** Of each triangle: the largest distance of its places from the other surface, in the frame. */
  before: Float32Array;
  after: Float32Array;
  /** Of all places. */
  max: number;
  /** Of all places, by the areas of their triangles. */
  mean: number;
}

/**
 * Input: corners of triangles in the frame, as they are drawn. Each triangle is measured at its corners, at the middles of its
 * edges and in its middle. So the distance of the surfaces may be larger, but on a triangle before a convex surface it is not.
 */
export function deviationOf(before: Float32Array, after: Float32Array): Deviation {
  const sum = { weighted: 0, area: 0 };
  const measured = {
    before: measure(before, new NearestTriangles(after), sum),
    after: measure(after, new NearestTriangles(before), sum),
  };
  let max = 0;
  for (const distances of [measured.before, measured.after]) for (const d of distances) if (d > max) max = d;
  return { ...measured, max, mean: sum.area > 0 ? sum.weighted / sum.area : 0 };
}

/** Corners are floats of at most 1, so that smaller distances are nothing but their rounding. */
const kRounding = 2 ** -21;

/** Weights of the corners of each place. */
const kPlaces = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
  [0, 0.5, 0.5],
  [0.5, 0, 0.5],
  [0.5, 0.5, 0],
  [1 / 3, 1 / 3, 1 / 3],
];

function measure(
  positions: Float32Array,
  other: NearestTriangles,
  total: { weighted: number; area: number },
): Float32Array {
  const largest = new Float32Array(positions.length / 9);
  for (let t = 0; t < largest.length; ++t) {
    const at = 9 * t;
    let sum = 0;
    for (const [i, j, k] of kPlaces) {
      const place = (axis: number): number =>
        i! * positions[at + axis]! + j! * positions[at + 3 + axis]! + k! * positions[at + 6 + axis]!;
      const found = other.distance(place(0), place(1), place(2));
      const distance = found > kRounding ? found : 0;
      sum += distance;
      if (distance > largest[t]!) largest[t] = distance;
    }
    const area = areaOf(positions, at);
    total.area += area;
    total.weighted += (area * sum) / kPlaces.length;
  }
  return largest;
}

function areaOf(p: Float32Array, at: number): number {
  const [ux, uy, uz] = [p[at + 3]! - p[at]!, p[at + 4]! - p[at + 1]!, p[at + 5]! - p[at + 2]!];
  const [vx, vy, vz] = [p[at + 6]! - p[at]!, p[at + 7]! - p[at + 1]!, p[at + 8]! - p[at + 2]!];
  return Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
}
