// The numbers of one triangle, by Verdict's definitions, as in the daemon's report.

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
    const ux = points[q]! - points[p]!,
      uy = points[q + 1]! - points[p + 1]!,
      uz = points[q + 2]! - points[p + 2]!;
    const vx = points[r]! - points[p]!,
      vy = points[r + 1]! - points[p + 1]!,
      vz = points[r + 2]! - points[p + 2]!;
    const cross = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    angles[i] = Math.atan2(cross, ux * vx + uy * vy + uz * vz) * kDegrees;
    lengths[i] = Math.hypot(points[r]! - points[q]!, points[r + 1]! - points[q + 1]!, points[r + 2]! - points[q + 2]!);
    doubled = cross;
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
    const ux = points[b]! - points[a]!,
      uy = points[b + 1]! - points[a + 1]!,
      uz = points[b + 2]! - points[a + 2]!;
    const vx = points[c]! - points[a]!,
      vy = points[c + 1]! - points[a + 1]!,
      vz = points[c + 2]! - points[a + 2]!;
    const wx = vx - ux,
      wy = vy - uy,
      wz = vz - uz;
    const nx = uy * vz - uz * vy,
      ny = uz * vx - ux * vz,
      nz = ux * vy - uy * vx;
    const doubled = Math.sqrt(nx * nx + ny * ny + nz * nz);
    const uu = ux * ux + uy * uy + uz * uz,
      vv = vx * vx + vy * vy + vz * vz,
      ww = wx * wx + wy * wy + wz * wz;
    const shortest = Math.min(uu, vv, ww);
    // The smallest angle is across from the shortest edge.
    const cosine = (uu + vv + ww) / 2 - shortest;
    values[4 * t] = Math.atan2(doubled, cosine) * kDegrees;
    const ratio = Math.sqrt((uu * vv * ww) / shortest) / (2 * doubled);
    values[4 * t + 1] = Number.isFinite(ratio) ? ratio : 1e30;
  }
}
