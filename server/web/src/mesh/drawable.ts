// What is drawn of a mesh, as arrays that go to the graphics card as they are and between threads without a copy.
import { kNonManifold, kOpen, mergeEqualPoints, twins } from "./adjacency.ts";
import { measureAll } from "./quality.ts";
import { type Surface, faceCount } from "./surface.ts";
import { triangulate } from "./triangulate.ts";
import { type Vector, dot, normalOf } from "./vector.ts";

export type Point = [number, number, number];

/** Where model units lie in the views': (x - centre) / radius. Both views have the same, so that they agree. */
export interface Frame {
  centre: Point;
  radius: number;
}

export interface Drawable {
  frame: Frame;
  /** Bounding box, in the frame. */
  box: { min: Point; max: Point };
  /** As in the file, in model units. */
  points: Float64Array;
  corners: Uint32Array;
  /** The face of the file that each triangle is a part of; ascending. */
  face: Uint32Array;
  /** Corners of each triangle, in the frame. */
  positions: Float32Array;
  /** Four numbers for each triangle, see kValue. */
  values: Float32Array;
  /** Edges of one triangle only, and of three or more. */
  openEdges: number;
  nonManifoldEdges: number;
}

/** Numbers of a triangle in `values`. */
export const kValue = { minAngle: 0, radiusEdgeRatio: 1, patch: 2, flags: 3, count: 4 } as const;
/** Bits of kValue.flags; those of edges are shifted by the corner that the edge is across from. */
export const kFlag = { diagonal: 1, feature: 8, open: 64, kept: 512, smooth: 1024, nonManifold: 8192 } as const;
/** Where it is not known, or the face was dropped. */
export const kNoPatch = -1;

/** Faces that lie flatter against each other than this are drawn as one. */
const kFlat = Math.cos((2 * Math.PI) / 180);

export interface Patches {
  /** Of each face of the file; null where it was dropped. */
  ofFace: ArrayLike<number | null>;
  /** Patches that could not be remeshed freely. */
  kept: ReadonlySet<number>;
  /** The surface of each patch: boundaries between patches of one surface are smooth. */
  surfaceOf: ArrayLike<number>;
}

/** A surface made ready to be drawn; it stays to be coloured again when its patches are known. */
export class Draft {
  private readonly triangles;
  private readonly twin: Int32Array;
  private readonly measured: Float32Array;
  private readonly box: { min: Point; max: Point };
  readonly frame: Frame;

  constructor(
    private readonly surface: Surface,
    frame: Frame | null = null,
  ) {
    this.triangles = triangulate(surface);
    const { corners } = this.triangles;
    this.twin = twins(corners, mergeEqualPoints(surface.points));
    this.measured = new Float32Array(kValue.count * this.triangles.face.length);
    measureAll(surface.points, corners, this.measured);
    // As the daemon measures it: a spike of a polygon counts, though no triangle shows it.
    this.box = boundingBox(surface.points, surface.corners);
    this.frame = frame ?? frameOf(this.box);
  }

  get faces(): number {
    return faceCount(this.surface);
  }
  get pointCount(): number {
    return this.surface.points.length / 3;
  }
  get minAngle(): number {
    let least = 180;
    for (let t = 0; t < this.measured.length; t += kValue.count) least = Math.min(least, this.measured[t]!);
    return least;
  }
  get size(): Point {
    return [0, 1, 2].map((axis) => this.box.max[axis]! - this.box.min[axis]!) as Point;
  }

  /** `values` of a drawable. */
  values(patches: Patches | null): Float32Array {
    const values = this.measured.slice();
    const { face, diagonals } = this.triangles;
    const patchOf = (t: number): number => patches?.ofFace[face[t]!] ?? kNoPatch;
    for (let t = 0; t < face.length; ++t) {
      const patch = patchOf(t);
      let flags = diagonals[t]! * kFlag.diagonal;
      if (patches?.kept.has(patch)) flags |= kFlag.kept;
      for (let k = 0; k < 3; ++k) {
        const twin = this.twin[3 * t + k]!;
        if (twin < 0) {
          flags |= (kFlag.open | kFlag.feature) << k;
          if (twin === kNonManifold) flags |= kFlag.nonManifold << k;
        } else {
          const other = (twin / 3) | 0;
          const beyond = patchOf(other);
          if (patches ? beyond !== patch : this.isBend(t, other)) flags |= kFlag.feature << k;
          if (beyond !== patch && patches?.surfaceOf[beyond] === patches?.surfaceOf[patch]) flags |= kFlag.smooth << k;
        }
      }
      values[kValue.count * t + kValue.patch] = patch;
      values[kValue.count * t + kValue.flags] = flags;
    }
    return values;
  }

  drawable(patches: Patches | null): Drawable {
    const { corners, face } = this.triangles;
    const { centre, radius } = this.frame;
    const { points } = this.surface;
    const positions = new Float32Array(3 * corners.length);
    for (let c = 0; c < corners.length; ++c) {
      for (let axis = 0; axis < 3; ++axis) {
        positions[3 * c + axis] = (points[3 * corners[c]! + axis]! - centre[axis]!) / radius;
      }
    }
    const inFrame = (p: Point): Point => p.map((x, axis) => (x - centre[axis]!) / radius) as Point;
    let [open, nonManifold] = [0, 0];
    for (const twin of this.twin) {
      if (twin === kOpen) ++open;
      if (twin === kNonManifold) ++nonManifold;
    }
    return {
      frame: this.frame,
      box: { min: inFrame(this.box.min), max: inFrame(this.box.max) },
      points: points.slice(),
      corners: corners.slice(),
      face: face.slice(),
      positions,
      values: this.values(patches),
      openEdges: open,
      nonManifoldEdges: nonManifold,
    };
  }

  private isBend(t: number, other: number): boolean {
    const a = this.normal(t),
      b = this.normal(other);
    // A triangle without area has no direction: no line beside it.
    return dot(a, b) < kFlat * Math.hypot(...a) * Math.hypot(...b);
  }

  private normal(t: number): Vector {
    const { corners } = this.triangles;
    return normalOf(this.surface.points, 3 * corners[3 * t]!, 3 * corners[3 * t + 1]!, 3 * corners[3 * t + 2]!);
  }
}

function boundingBox(points: Float64Array, corners: Uint32Array): { min: Point; max: Point } {
  const min: Point = [Infinity, Infinity, Infinity];
  const max: Point = [-Infinity, -Infinity, -Infinity];
  for (const corner of corners) {
    for (let axis = 0; axis < 3; ++axis) {
      const x = points[3 * corner + axis]!;
      if (x < min[axis]!) min[axis] = x;
      if (x > max[axis]!) max[axis] = x;
    }
  }
  return { min, max };
}

function frameOf(box: { min: Point; max: Point }): Frame {
  const centre = [0, 1, 2].map((axis) => (box.min[axis]! + box.max[axis]!) / 2) as Point;
  const radius = Math.hypot(...[0, 1, 2].map((axis) => box.max[axis]! - box.min[axis]!)) / 2;
  return { centre, radius: radius > 0 && Number.isFinite(radius) ? radius : 1 };
}

/** Triangles of a face of the file: [first, end). */
export function trianglesOfFace(drawable: Drawable, face: number): [number, number] {
  const lowerBound = (value: number): number => {
    let [low, high] = [0, drawable.face.length];
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (drawable.face[middle]! < value) low = middle + 1;
      else high = middle;
    }
    return low;
  };
  return [lowerBound(face), lowerBound(face + 1)];
}

/** The triangle whose centroid is nearest to a place, given in model units. */
export function nearestTriangle({ positions, frame }: Drawable, at: Point): number {
  const place = at.map((x, axis) => (x - frame.centre[axis]!) / frame.radius);
  let [best, least] = [-1, Infinity];
  for (let t = 0; 9 * t < positions.length; ++t) {
    let distance = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const first = 9 * t + axis;
      const d = (positions[first]! + positions[first + 3]! + positions[first + 6]!) / 3 - place[axis]!;
      distance += d * d;
    }
    if (distance < least) [best, least] = [t, distance];
  }
  return best;
}
