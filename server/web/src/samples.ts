// Three parts to begin with, as a CAD program would export them: exact planes, and whatever triangles fill them.
import { ShapeUtils } from "three/src/extras/ShapeUtils.js";
import { Vector2 } from "three/src/math/Vector2.js";

import type { Point } from "./mesh/drawable.ts";

type Flat = [number, number];
type Loop = Flat[];

const kQuarterSteps = 5;

/** Planar faces with holes, cut into triangles by ears: needles, as exported ones are. */
class Part {
  private readonly ids = new Map<string, number>();
  private readonly points: Point[] = [];
  private readonly faces: number[][] = [];

  /** A face in the plane that `lift` spans, seen from the side from which `outline` and `holes` turn left. */
  face(lift: (p: Flat) => Point, outline: Loop, holes: Loop[] = []): void {
    const flat = [outline, ...holes].map((loop) => loop.map(([x, y]) => new Vector2(x, y)));
    const all = [outline, ...holes].flat();
    for (const triangle of ShapeUtils.triangulateShape(flat[0]!, flat.slice(1))) {
      const corners = triangle.map((i) => flat.flat()[i]!);
      const area = ShapeUtils.area(corners);
      this.faces.push((area < 0 ? [...triangle].reverse() : triangle).map((i) => this.id(lift(all[i]!))));
    }
  }

  /** The band between two lifts of a chain of points; seen from its right side. */
  band(from: (p: Flat) => Point, to: (p: Flat) => Point, chain: Loop, isClosed = true): void {
    for (let i = 0; i + (isClosed ? 0 : 1) < chain.length; ++i) {
      const [p, q] = [chain[i]!, chain[(i + 1) % chain.length]!];
      const [a, b, c, d] = [from(p), from(q), to(q), to(p)].map((point) => this.id(point)) as [
        number,
        number,
        number,
        number,
      ];
      this.faces.push([a, b, c], [a, c, d]);
    }
  }

  obj(title: string): string {
    const line = (key: string, numbers: number[]): string => `${key} ${numbers.join(" ")}\n`;
    return (
      `# ${title}: a sample of remeshd's page, in millimetres\n` +
      this.points.map((p) => line("v", p)).join("") +
      this.faces
        .map((face) =>
          line(
            "f",
            face.map((i) => i + 1),
          ),
        )
        .join("")
    );
  }

  private id(point: Point): number {
    // Six decimals, as files have them.
    const rounded = point.map((x) => Number(x.toFixed(6)) + 0) as Point;
    const key = rounded.join(" ");
    const known = this.ids.get(key);
    if (known !== undefined) return known;
    this.ids.set(key, this.points.length);
    return this.points.push(rounded) - 1;
  }
}

function arc(centre: Flat, radius: number, fromDeg: number, toDeg: number): Loop {
  const steps = Math.round((Math.abs(toDeg - fromDeg) / 90) * kQuarterSteps);
  return Array.from({ length: steps + 1 }, (_, i) => {
    const angle = ((fromDeg + ((toDeg - fromDeg) * i) / steps) * Math.PI) / 180;
    return [centre[0] + radius * Math.cos(angle), centre[1] + radius * Math.sin(angle)];
  });
}
const circle = (centre: Flat, radius: number): Loop => arc(centre, radius, 0, 360).slice(0, -1);
const slot = (x0: number, x1: number, y: number, radius: number): Loop => [
  ...arc([x1, y], radius, -90, 90),
  ...arc([x0, y], radius, 90, 270),
];
const roundedBox = (x: number, y: number, r: number): Loop => [
  ...arc([x - r, y - r], r, 0, 90),
  ...arc([r - x, y - r], r, 90, 180),
  ...arc([r - x, r - y], r, 180, 270),
  ...arc([x - r, r - y], r, 270, 360),
];
const reversed = (loop: Loop): Loop => [...loop].reverse();
const level =
  (z: number) =>
  ([x, y]: Flat): Point => [x, y, z];

/** Two plates with holes that meet at a right angle. */
function bracket(): string {
  const part = new Part();
  const [length, half, height, thick, corner] = [84, 32, 92, 10, 14];
  // In the plates' own planes: u away from the bend, v along it.
  const end = (reach: number): Loop => [
    ...arc([reach - corner, corner - half], corner, -90, 0),
    ...arc([reach - corner, half - corner], corner, 0, 90),
  ];
  const plate = (near: number, reach: number): Loop => [[near, -half], ...end(reach), [near, half]];
  const baseHoles = [slot(38, 62, -14, 5), slot(38, 62, 14, 5), circle([24, 0], 6)];
  const wallHoles = [
    circle([62, 0], 15),
    circle([32, -20], 4),
    circle([32, 20], 4),
    circle([82, -22], 3),
    circle([82, 22], 3),
  ];
  const base =
    (z: number) =>
    ([u, v]: Flat): Point => [u, v, z];
  const wall =
    (x: number) =>
    ([u, v]: Flat): Point => [x, v, u];
  const mirrored =
    (lift: (p: Flat) => Point) =>
    ([u, v]: Flat): Point =>
      lift([u, -v]);
  const flip = (loops: Loop[]): Loop[] => loops.map((loop) => loop.map(([u, v]): Flat => [u, -v]));

  part.face(base(thick), plate(thick, length), baseHoles);
  part.face(mirrored(base(0)), plate(0, length), flip(baseHoles));
  part.face(mirrored(wall(thick)), plate(thick, height), flip(wallHoles));
  part.face(wall(0), plate(0, height), wallHoles);
  part.band(base(0), base(thick), end(length), false);
  part.band(wall(thick), wall(0), end(height), false);
  for (const hole of baseHoles) part.band(base(thick), base(0), hole);
  for (const hole of wallHoles) part.band(wall(0), wall(thick), hole);
  const [a, b] = [length - corner, height - corner];
  const side: Loop = [
    [0, 0],
    [a, 0],
    [a, thick],
    [thick, thick],
    [thick, b],
    [0, b],
  ];
  part.face(([x, z]) => [x, -half, z], side);
  part.face(
    ([x, z]) => [-x, half, z],
    side.map(([x, z]): Flat => [-x, z]),
  );
  return part.obj("bracket");
}

/** A flange with bolt holes, two steps on it, and a bore through all. */
function steppedHub(): string {
  const part = new Part();
  const flange = roundedBox(40, 40, 12);
  const bolts = (
    [
      [-28, -28],
      [28, -28],
      [28, 28],
      [-28, 28],
    ] as Flat[]
  ).map((centre) => circle(centre, 5));
  const [lower, upper, bore] = [circle([0, 0], 26), circle([0, 0], 18), circle([0, 0], 9)];
  const below = ([x, y]: Flat): Point => [x, -y, 0];
  part.face(
    below,
    flange,
    [...bolts, bore].map((loop) => loop.map(([x, y]): Flat => [x, -y])),
  );
  part.face(level(8), flange, [...bolts, lower]);
  part.face(level(26), lower, [upper]);
  part.face(level(44), upper, [bore]);
  part.band(level(0), level(8), flange);
  part.band(level(8), level(26), lower);
  part.band(level(26), level(44), upper);
  for (const hole of bolts) part.band(level(0), level(8), reversed(hole));
  part.band(level(0), level(44), reversed(bore));
  return part.obj("stepped hub");
}

/** Walls far thinner than they are wide, and slots in the floor. */
function thinTray(): string {
  const part = new Part();
  const [wall, floor, height] = [1.6, 2, 24];
  const outer = roundedBox(60, 40, 8);
  const inner = roundedBox(60 - wall, 40 - wall, 8 - wall);
  const slots = [-24, -12, 0, 12, 24].map((y) => slot(-36, 36, y, 2));
  part.face(
    ([x, y]) => [x, -y, 0],
    outer,
    slots.map((loop) => loop.map(([x, y]): Flat => [x, -y])),
  );
  part.face(level(floor), inner, slots);
  part.face(level(height), outer, [inner]);
  part.band(level(0), level(height), outer);
  part.band(level(floor), level(height), reversed(inner));
  for (const hole of slots) part.band(level(0), level(floor), reversed(hole));
  return part.obj("thin tray");
}

export interface Sample {
  name: string;
  file: string;
  obj: () => string;
}
export const kSamples: Sample[] = [
  { name: "Bracket", file: "bracket.obj", obj: bracket },
  { name: "Hub", file: "stepped-hub.obj", obj: steppedHub },
  { name: "Tray", file: "thin-tray.obj", obj: thinTray },
];
