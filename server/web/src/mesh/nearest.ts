// Distances from points to a set of triangles, by a tree of boxes.

/** Triangles in a leaf. */
const kLeaf = 6;

/** Positions: nine numbers for each triangle. */
export class NearestTriangles {
  /** Triangles, so that those of a node stand together. */
  private readonly order: Uint32Array;
  /** Of node n: six numbers, least and largest coordinates. Its children are 2 n + 1 and 2 n + 2. */
  private readonly boxes: Float32Array;
  private readonly levels: number;
  /** Where a search begins: the triangle that the last one found. */
  private last = 0;
  private readonly stack = new Uint32Array(128);

  constructor(private readonly positions: Float32Array) {
    const count = positions.length / 9;
    this.order = Uint32Array.from({ length: count }, (_, t) => t);
    this.levels = Math.max(Math.ceil(Math.log2(Math.max(count, 1) / kLeaf)), 0);
    this.boxes = new Float32Array(6 * (2 ** (this.levels + 1) - 1));
    this.build();
  }

  /** Triangles of a node: the same part of all for every node of a level. */
  private range(level: number, place: number): [number, number] {
    const count = this.order.length;
    return [Math.floor((count * place) / 2 ** level), Math.floor((count * (place + 1)) / 2 ** level)];
  }

  private build(): void {
    const middles = new Float32Array(this.positions.length / 3);
    for (let t = 0; 3 * t < middles.length; ++t) {
      for (let axis = 0; axis < 3; ++axis) {
        const at = 9 * t + axis;
        middles[3 * t + axis] = this.positions[at]! + this.positions[at + 3]! + this.positions[at + 6]!;
      }
    }
    for (let level = 0; level <= this.levels; ++level) {
      for (let place = 0; place < 2 ** level; ++place) {
        const node = 2 ** level - 1 + place;
        const [begin, end] = this.range(level, place);
        const axis = this.measure(node, begin, end);
        if (level < this.levels) this.divide(middles, axis, begin, end, this.range(level + 1, 2 * place)[1]);
      }
    }
  }

  /** Finds the box of a node. Output: the axis along which it is longest. */
  private measure(node: number, begin: number, end: number): number {
    const box = this.boxes.subarray(6 * node, 6 * node + 6);
    box.fill(Infinity, 0, 3).fill(-Infinity, 3, 6);
    for (let i = begin; i < end; ++i) {
      const first = 9 * this.order[i]!;
      for (let k = 0; k < 9; ++k) {
        const [x, axis] = [this.positions[first + k]!, k % 3];
        if (x < box[axis]!) box[axis] = x;
        if (x > box[3 + axis]!) box[3 + axis] = x;
      }
    }
    const extents = [0, 1, 2].map((axis) => box[3 + axis]! - box[axis]!);
    return extents.indexOf(Math.max(...extents));
  }

  /** Puts the triangles so that those before `middle` are not beyond those behind it. */
  private divide(middles: Float32Array, axis: number, begin: number, end: number, middle: number): void {
    const { order } = this;
    let [low, high] = [begin, end - 1];
    while (low < high) {
      const pivot = middles[3 * order[(low + high) >>> 1]! + axis]!;
      let [i, j] = [low, high];
      while (i <= j) {
        while (middles[3 * order[i]! + axis]! < pivot) ++i;
        while (middles[3 * order[j]! + axis]! > pivot) --j;
        if (i > j) break;
        const swapped = order[i]!;
        order[i++] = order[j]!;
        order[j--] = swapped;
      }
      if (middle <= j) high = j;
      else if (middle >= i) low = i;
      else return;
    }
  }

  /** The distance from a point to the nearest triangle; infinite where there is none. */
  distance(x: number, y: number, z: number): number {
    if (this.order.length === 0) return Infinity;
    let least = this.squaredToTriangle(this.last, x, y, z);
    const { stack } = this;
    let size = 0;
    stack[size++] = 0;
    const inner = 2 ** this.levels - 1;
    while (size > 0) {
      const node = stack[--size]!;
      if (this.squaredToBox(node, x, y, z) >= least) continue;
      if (node >= inner) {
        const [begin, end] = this.range(this.levels, node - inner);
        for (let i = begin; i < end; ++i) {
          const squared = this.squaredToTriangle(this.order[i]!, x, y, z);
          if (squared < least) [least, this.last] = [squared, this.order[i]!];
        }
        continue;
      }
      const [left, right] = [2 * node + 1, 2 * node + 2];
      const isLeftNearer = this.squaredToBox(left, x, y, z) < this.squaredToBox(right, x, y, z);
      stack[size++] = isLeftNearer ? right : left;
      stack[size++] = isLeftNearer ? left : right;
    }
    return Math.sqrt(least);
  }

  private squaredToBox(node: number, x: number, y: number, z: number): number {
    const { boxes } = this;
    const at = 6 * node;
    const dx = Math.max(boxes[at]! - x, 0, x - boxes[at + 3]!);
    const dy = Math.max(boxes[at + 1]! - y, 0, y - boxes[at + 4]!);
    const dz = Math.max(boxes[at + 2]! - z, 0, z - boxes[at + 5]!);
    return dx * dx + dy * dy + dz * dz;
  }

  /** Of the region of the triangle (corner, edge or inside) that is nearest. */
  private squaredToTriangle(triangle: number, x: number, y: number, z: number): number {
    const p = this.positions;
    const at = 9 * triangle;
    const [ax, ay, az] = [p[at]! - x, p[at + 1]! - y, p[at + 2]! - z];
    const [bx, by, bz] = [p[at + 3]! - x, p[at + 4]! - y, p[at + 5]! - z];
    const [cx, cy, cz] = [p[at + 6]! - x, p[at + 7]! - y, p[at + 8]! - z];
    const [ux, uy, uz] = [bx - ax, by - ay, bz - az];
    const [vx, vy, vz] = [cx - ax, cy - ay, cz - az];
    const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const nn = nx * nx + ny * ny + nz * nz;
    if (nn > 0) {
      // On which side of each edge the point is, seen along the normal.
      const side = (px: number, py: number, pz: number, qx: number, qy: number, qz: number): number =>
        nx * (py * qz - pz * qy) + ny * (pz * qx - px * qz) + nz * (px * qy - py * qx);
      const isInside =
        side(ax, ay, az, bx, by, bz) >= 0 && side(bx, by, bz, cx, cy, cz) >= 0 && side(cx, cy, cz, ax, ay, az) >= 0;
      if (isInside) {
        const height = nx * ax + ny * ay + nz * az;
        return (height * height) / nn;
      }
    }
    return Math.min(
      squaredToSegment(ax, ay, az, bx, by, bz),
      squaredToSegment(bx, by, bz, cx, cy, cz),
      squaredToSegment(cx, cy, cz, ax, ay, az),
    );
  }
}

/** From 0. */
function squaredToSegment(ax: number, ay: number, az: number, bx: number, by: number, bz: number): number {
  const [dx, dy, dz] = [bx - ax, by - ay, bz - az];
  const dd = dx * dx + dy * dy + dz * dz;
  const part = dd > 0 ? Math.min(Math.max(-(ax * dx + ay * dy + az * dz) / dd, 0), 1) : 0;
  const [x, y, z] = [ax + part * dx, ay + part * dy, az + part * dz];
  return x * x + y * y + z * z;
}
