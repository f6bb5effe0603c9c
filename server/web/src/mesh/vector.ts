// Vectors between points of a surface. Offsets are those of the points' coordinates.

export type Vector = [number, number, number];

export function fromTo(points: Float64Array, from: number, to: number): Vector {
  return [points[to]! - points[from]!, points[to + 1]! - points[from + 1]!, points[to + 2]! - points[from + 2]!];
}

export function dot(u: Vector, v: Vector): number {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

export function cross(u: Vector, v: Vector): Vector {
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

/** Of a triangle, counter-clockwise from where it points; as long as twice the area. */
export function normalOf(points: Float64Array, a: number, b: number, c: number): Vector {
  return cross(fromTo(points, a, b), fromTo(points, a, c));
}
