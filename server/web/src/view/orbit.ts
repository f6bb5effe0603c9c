// A camera that turns around a point, one axis upwards, as plain numbers.
import { type PerspectiveCamera, Vector3 } from "three";

import type { Point } from "../mesh/drawable.ts";

/** Degrees, from below to above. */
export const kFieldOfView = 32;
const kSteepest = (89.9 * Math.PI) / 180;
const kNearest = 1e-5;
const kFarthest = 40;

export type Axis = "x" | "y" | "z";

export interface Orbit {
  /** The axis that points upwards. */
  axis: Axis;
  target: Vector3;
  distance: number;
  /** Radians, around the axis and above the horizon. */
  yaw: number;
  pitch: number;
}

/** From space where z points upwards to that of the model, and back. */
function toModel([x, y, z]: Point, axis: Axis): Vector3 {
  if (axis === "z") return new Vector3(x, y, z);
  return axis === "y" ? new Vector3(x, z, -y) : new Vector3(z, x, y);
}
function fromModel([x, y, z]: Point, axis: Axis): Point {
  if (axis === "z") return [x, y, z];
  return axis === "y" ? [x, -z, y] : [y, z, x];
}

/** Yaw and pitch of the views of drawings. */
export const kStandardViews = {
  overview: [-0.62, 0.5],
  front: [0, 0],
  back: [Math.PI, 0],
  left: [Math.PI / 2, 0],
  right: [-Math.PI / 2, 0],
  top: [0, kSteepest],
  bottom: [0, -kSteepest],
} as const;
export type StandardView = keyof typeof kStandardViews;

/** From where everything is seen. */
export function overview(aspect: number, axis: Axis = "z", view: StandardView = "overview"): Orbit {
  const half = (kFieldOfView * Math.PI) / 360;
  const narrow = Math.min(half, Math.atan(Math.tan(half) * aspect));
  const [yaw, pitch] = kStandardViews[view];
  return { axis, target: new Vector3(), distance: 1.02 / Math.sin(narrow), yaw, pitch };
}

/** From the target to the camera. */
export function front({ axis, yaw, pitch }: Orbit): Vector3 {
  return toModel([Math.cos(pitch) * Math.sin(-yaw), -Math.cos(pitch) * Math.cos(yaw), Math.sin(pitch)], axis);
}

export function right({ axis, yaw }: Orbit): Vector3 {
  return toModel([Math.cos(yaw), -Math.sin(yaw), 0], axis);
}
export function up(orbit: Orbit): Vector3 {
  return front(orbit).cross(right(orbit));
}

export function place(camera: PerspectiveCamera, orbit: Orbit): void {
  camera.up.copy(toModel([0, 0, 1], orbit.axis));
  camera.position.copy(orbit.target).addScaledVector(front(orbit), orbit.distance);
  camera.lookAt(orbit.target);
  // All that there is lies in the unit ball.
  const toCentre = camera.position.length();
  camera.far = toCentre + 1.1;
  camera.near = Math.max(toCentre - 1.1, orbit.distance * 0.02, kNearest);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
}

export function turn(orbit: Orbit, yaw: number, pitch: number): void {
  orbit.yaw += yaw;
  orbit.pitch = Math.min(Math.max(orbit.pitch + pitch, -kSteepest), kSteepest);
}

/** By parts of the view's height. */
export function pan(orbit: Orbit, across: number, above: number): void {
  const height = 2 * orbit.distance * Math.tan((kFieldOfView * Math.PI) / 360);
  orbit.target.addScaledVector(right(orbit), across * height).addScaledVector(up(orbit), above * height);
  // Not out of sight.
  orbit.target.clampLength(0, 1.5);
}

/** `x` and `y`, from -1 to 1, name the place in the view that stays where it is. */
export function zoom(orbit: Orbit, factor: number, x = 0, y = 0, aspect = 1): void {
  const before = orbit.distance;
  orbit.distance = Math.min(Math.max(before * factor, kNearest), kFarthest);
  const moved = (1 - orbit.distance / before) / 2;
  pan({ ...orbit, distance: before }, x * moved * aspect, y * moved);
}

/** Where to stand to look at a place along a normal, from near enough that `size` fills a part of the view. */
export function lookAt(current: Orbit, at: Point, towards: Point | null, size: number): Orbit {
  const orbit: Orbit = { ...current, target: new Vector3(...at), distance: Math.min(size * 9, 3) };
  if (towards === null) return orbit;
  const normal = fromModel(towards, current.axis);
  // Not quite along the normal: a bit aslant shows which way things lean.
  const flat = Math.hypot(normal[0], normal[1]);
  const pitch = Math.atan2(normal[2], flat);
  orbit.yaw = flat > 0.05 ? Math.atan2(normal[0], -normal[1]) * -1 + 0.3 : current.yaw;
  orbit.pitch = Math.min(Math.max(pitch + (pitch > 0.6 ? -0.3 : 0.25), -kSteepest), kSteepest);
  return orbit;
}

/** From one to the other; the yaw takes the short way. */
export function between(from: Orbit, to: Orbit, part: number): Orbit {
  const smooth = part * part * (3 - 2 * part);
  const mix = (a: number, b: number): number => a + (b - a) * smooth;
  const turnBy = ((((to.yaw - from.yaw + Math.PI) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI)) - Math.PI;
  return {
    axis: to.axis,
    target: from.target.clone().lerp(to.target, smooth),
    distance: Math.exp(mix(Math.log(from.distance), Math.log(to.distance))),
    yaw: mix(from.yaw, from.yaw + turnBy),
    pitch: mix(from.pitch, to.pitch),
  };
}
