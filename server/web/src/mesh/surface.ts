// Surfaces as files have them: points and polygons, in the file's own order.

export interface Surface {
  /** x, y, z of each point. */
  points: Float64Array;
  /** Corners of face f: corners[begin[f] .. begin[f + 1]). */
  begin: Uint32Array;
  corners: Uint32Array;
}

/** What a file has that this page cannot read. The daemon, which reads more, has the last word on it. */
export class UnreadableMesh extends Error {}

export function faceCount(surface: Surface): number {
  return surface.begin.length - 1;
}

/** A typed array that grows. */
class Growing<T extends Float64Array | Uint32Array> {
  private length = 0;
  constructor(
    private items: T,
    private readonly make: (size: number) => T,
  ) {}

  get size(): number {
    return this.length;
  }
  push(value: number): void {
    if (this.length === this.items.length) {
      const larger = this.make(this.length * 2);
      larger.set(this.items);
      this.items = larger;
    }
    this.items[this.length++] = value;
  }
  take(): T {
    return this.items.slice(0, this.length) as T;
  }
}

const kFirstSize = 1024;

/** Takes points and faces in any order; indices are looked at when all of them are there. */
export class SurfaceBuilder {
  private readonly points = new Growing(new Float64Array(kFirstSize), (size) => new Float64Array(size));
  private readonly begin = new Growing(new Uint32Array(kFirstSize), (size) => new Uint32Array(size));
  private readonly corners = new Growing(new Uint32Array(kFirstSize), (size) => new Uint32Array(size));

  constructor() {
    this.begin.push(0);
  }
  get pointCount(): number {
    return this.points.size / 3;
  }
  addPoint(x: number, y: number, z: number): void {
    this.points.push(x);
    this.points.push(y);
    this.points.push(z);
  }
  addCorner(point: number): void {
    if (!Number.isInteger(point) || point < 0)
      throw new UnreadableMesh("A face refers to a point that does not exist.");
    this.corners.push(point);
  }
  endFace(): void {
    this.begin.push(this.corners.size);
  }

  finish(): Surface {
    const surface = { points: this.points.take(), begin: this.begin.take(), corners: this.corners.take() };
    checkSurface(surface);
    return surface;
  }
}

/** Throws UnreadableMesh for what cannot be drawn. */
export function checkSurface(surface: Surface): void {
  if (faceCount(surface) === 0) throw new UnreadableMesh("There is no face in it.");
  const count = surface.points.length / 3;
  for (const corner of surface.corners) {
    if (corner >= count) throw new UnreadableMesh("A face refers to a point that does not exist.");
  }
  for (const coordinate of surface.points) {
    if (!Number.isFinite(coordinate)) throw new UnreadableMesh("A coordinate is not a finite number.");
  }
}
