// The numbers of one triangle, by Verdict's definitions, as in the daemon's report.
import { cross, dot, fromTo } from "./vector.ts";

const kDegrees = 180 / Math.PI;

export interface TriangleNumbers {
  /** At each corner. */
  angles: [number, number, number];
  /** Of the edge across from each corner. */
  lengths: [number, number, number];
  area: number;
  minAngle: number;
  /** Circumradius over shortest edge; infinite where there is no area. */
  radiusEdgeRatio: number;
}

/** `ids`: offsets of the three points' coordinates in `points`. */
export function measureTriangle(points: Float64Array, a: number, b: number, c: number): TriangleNumbers {
  const corners = [a, b, c];
  const lengths: [number, number, number] = [0, 0, 0];
  const angles: [number, number, number] = [0, 0, 0];
  let doubled = 0;
  for (let i = 0; i < 3; ++i) {
    const [p, q, r] = [corners[i]!, corners[(i + 1) % 3]!, corners[(i + 2) % 3]!];
    const [u, v] = [fromTo(points, p, q), fromTo(points, p, r)];
    doubled = Math.hypot(...cross(u, v));
    angles[i] = Math.atan2(doubled, dot(u, v)) * kDegrees;
    lengths[i] = Math.hypot(...fromTo(points, q, r));
  }
  const shortest = Math.min(...lengths);
  return {
    angles,
    lengths,
    area: doubled / 2,
    minAngle: Math.min(...angles),
    radiusEdgeRatio: (lengths[0] * lengths[1] * lengths[2]) / (2 * doubled) / shortest || Infinity,
  };
}

/** Smallest angle in degrees and radius-edge ratio of every triangle, into items 0 and 1 of each four of `values`. */
export function measureAll(points: Float64Array, corners: Uint32Array, values: Float32Array): void {
  for (let t = 0; 3 * t < corners.length; ++t) {
    const a = 3 * corners[3 * t]!,
      b = 3 * corners[3 * t + 1]!,
      c = 3 * corners[3 * t + 2]!;
    const u = fromTo(points, a, b),
      v = fromTo(points, a, c),
      w = fromTo(points, b, c),
      normal = cross(u, v);
    const doubled = Math.sqrt(dot(normal, normal));
    const uu = dot(u, u),
      vv = dot(v, v),
      ww = dot(w, w);
    const shortest = Math.min(uu, vv, ww);
    // The smallest angle is across from the shortest edge.
    const cosine = (uu + vv + ww) / 2 - shortest;
    values[4 * t] = Math.atan2(doubled, cosine) * kDegrees;
    const ratio = Math.sqrt((uu * vv * ww) / shortest) / (2 * doubled);
    values[4 * t + 1] = Number.isFinite(ratio) ? ratio : 1e30;
  }
}
