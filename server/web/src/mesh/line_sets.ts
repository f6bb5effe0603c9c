// What a report counts, as lines over a surface: all of it, where the page can find it by itself.
import { type Drawable, type Point, kFlag, kValue, trianglesOfFace } from "./drawable.ts";
import { type Vector, cross, dot } from "./vector.ts";

/** Items of one or more segments each, and for each item the triangle to look at. */
export interface LineSet {
  /** Two points of each segment, in the frame. */
  segments: Float32Array;
  segmentsPerItem: number;
  triangle: Uint32Array;
  /** What an item is, as a word and its plural. */
  item: [one: string, many: string];
  /** How many of what the report counts have items: of pairs of faces that cross, for example. */
  shown: number;
}

/** The edges across from the corners that `holds` names, each as an item. */
function edgesWhere(
  { positions, values }: Drawable,
  item: LineSet["item"],
  holds: (flags: number, k: number) => boolean,
): LineSet {
  const found: number[] = [];
  for (let t = 0; 9 * t < positions.length; ++t) {
    const flags = values[kValue.count * t + kValue.flags]!;
    for (let k = 0; k < 3; ++k) if (holds(flags, k)) found.push(3 * t + k);
  }
  const segments = new Float32Array(6 * found.length);
  found.forEach((half, i) => {
    const first = 9 * Math.floor(half / 3);
    [1, 2].forEach((step, end) => {
      const corner = first + 3 * ((half + step) % 3);
      segments.set(positions.subarray(corner, corner + 3), 6 * i + 3 * end);
    });
  });
  const triangle = Uint32Array.from(found, (half) => Math.floor(half / 3));
  return { segments, segmentsPerItem: 1, triangle, item, shown: found.length };
}

export function openEdges(drawable: Drawable): LineSet {
  return edgesWhere(
    drawable,
    ["open edge", "open edges"],
    (flags, k) => (flags & (kFlag.open << k)) !== 0 && (flags & (kFlag.nonManifold << k)) === 0,
  );
}
export function nonManifoldEdges(drawable: Drawable): LineSet {
  const isNonManifold = (flags: number, k: number): boolean => (flags & (kFlag.nonManifold << k)) !== 0;
  return edgesWhere(drawable, ["edge of more than two faces", "edges of more than two faces"], isNonManifold);
}

/** Angles are kept as floats, so that one that holds a bound exactly may be this part of it below. */
const kRounding = 1e-6;

/** The outlines of all triangles with an angle below the bound. */
export function trianglesBelow(drawable: Drawable, minAngle: number): LineSet {
  const found: number[] = [];
  for (let t = 0; t < drawable.face.length; ++t) {
    if (drawable.values[kValue.count * t + kValue.minAngle]! < minAngle * (1 - kRounding)) found.push(t);
  }
  return outlines(drawable, found);
}

function outlines({ positions }: Drawable, triangles: readonly number[]): LineSet {
  const segments = new Float32Array(18 * triangles.length);
  triangles.forEach((t, i) => {
    [0, 1, 1, 2, 2, 0].forEach((k, end) => {
      const corner = 9 * t + 3 * k;
      segments.set(positions.subarray(corner, corner + 3), 18 * i + 3 * end);
    });
  });
  const shown = triangles.length;
  return {
    segments,
    segmentsPerItem: 3,
    triangle: Uint32Array.from(triangles),
    item: ["triangle", "triangles"],
    shown,
  };
}

/** Where pairs of faces cross: a line for each pair; none where they only touch or lie in one plane. */
export function crossings(drawable: Drawable, pairs: readonly [number, number][]): LineSet {
  const segments: number[] = [];
  const triangle: number[] = [];
  let shown = 0;
  for (const [f, g] of pairs) {
    const before = triangle.length;
    const [begin, end] = trianglesOfFace(drawable, f);
    const [otherBegin, otherEnd] = trianglesOfFace(drawable, g);
    for (let t = begin; t < end; ++t) {
      for (let u = otherBegin; u < otherEnd; ++u) {
        const line = crossing(cornersOf(drawable, t), cornersOf(drawable, u));
        if (!line) continue;
        segments.push(...line[0], ...line[1]);
        triangle.push(t);
      }
    }
    if (triangle.length > before) ++shown;
  }
  return {
    segments: Float32Array.from(segments),
    segmentsPerItem: 1,
    triangle: Uint32Array.from(triangle),
    item: ["line where two faces cross", "lines where two faces cross"],
    shown,
  };
}

function cornersOf({ positions }: Drawable, triangle: number): [Vector, Vector, Vector] {
  const corner = (k: number): Vector =>
    [...positions.subarray(9 * triangle + 3 * k, 9 * triangle + 3 * k + 3)] as Vector;
  return [corner(0), corner(1), corner(2)];
}

const minus = (p: Point, q: Point): Vector => [p[0] - q[0], p[1] - q[1], p[2] - q[2]];

function crossing(a: Vector[], b: Vector[]): [Vector, Vector] | null {
  const found = [...piercings(a, b), ...piercings(b, a)];
  let farthest: [Vector, Vector] | null = null;
  let most = 0;
  for (const p of found) {
    for (const q of found) {
      const distance = Math.hypot(...minus(p, q));
      if (distance > most) [farthest, most] = [[p, q], distance];
    }
  }
  return farthest;
}

/** Where edges of `a` pass through `b`. */
function piercings(a: Vector[], b: Vector[]): Vector[] {
  const [o, p, q] = b as [Vector, Vector, Vector];
  const normal = cross(minus(p, o), minus(q, o));
  const heights = a.map((corner) => dot(normal, minus(corner, o)));
  return [0, 1, 2].flatMap((i) => {
    const j = (i + 1) % 3;
    const [from, to] = [heights[i]!, heights[j]!];
    if (from === to || from * to > 0) return [];
    const part = from / (from - to);
    const at = a[i]!.map((x, axis) => x + part * (a[j]![axis]! - x)) as Vector;
    const isInside = [0, 1, 2].every((k) => dot(normal, cross(minus(b[(k + 1) % 3]!, b[k]!), minus(at, b[k]!))) >= 0);
    return isInside ? [at] : [];
  });
}
