// What findings point at, drawn over a surface: points at places, faces, and lines. What lies behind the surface is not
// seen, so that nobody takes it for a part of what is before it; only the chosen line is, so that it is found.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLSL3,
  Group,
  Mesh,
  MeshBasicMaterial,
  Points,
  ShaderMaterial,
} from "three";

import { type Drawable, type Point, trianglesOfFace } from "../mesh/drawable.ts";
import type { LineSet } from "../mesh/line_sets.ts";
import type { Palette } from "./palette.ts";
import { ThickLines } from "./thick_lines.ts";

const kVertex = /* glsl */ `
  uniform float size;
  in float chosen;
  out float isChosen;
  void main() {
    isChosen = chosen;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    // In front of the surface that it lies on.
    gl_Position.z -= 0.004 * gl_Position.w;
    gl_PointSize = size * (chosen > 0.5 ? 1.7 : 1.0);
  }
`;
const kFragment = /* glsl */ `
  uniform vec3 mark;
  uniform vec3 rim;
  in float isChosen;
  out vec4 colour;
  void main() {
    float r = length(gl_PointCoord - 0.5) * 2.0;
    if (r > 1.0) discard;
    // A ring around the chosen one, so that what it marks stays to be seen.
    if (isChosen > 0.5 && r < 0.62) discard;
    colour = vec4(r > 0.78 ? rim : mark, 1.0);
  }
`;

export interface Marked {
  places: Point[];
  faces: number[];
  lines: LineSet | null;
  /** Which of the places or items of lines, or -1. */
  chosen: number;
}
export const kNothingMarked: Marked = { places: [], faces: [], lines: null, chosen: -1 };

export class Marks {
  readonly group = new Group();
  private readonly pointMaterial = pointMaterial();
  private readonly lines = new ThickLines();
  private readonly chosenLines = new ThickLines();
  private readonly faceMaterial = new MeshBasicMaterial({
    side: DoubleSide,
    transparent: true,
    opacity: 0.72,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -2,
  });

  constructor() {
    this.group.renderOrder = 1;
    this.chosenLines.material.depthTest = false;
  }

  /** Places and faces are those of `drawable`'s file; places in model units. */
  show(drawable: Drawable, { places, faces, lines, chosen }: Marked): void {
    this.clear();
    if (lines) this.showLines(lines, chosen);
    if (faces.length > 0) this.group.add(new Mesh(facesOf(drawable, faces), this.faceMaterial));
    if (places.length === 0) return;
    const { centre, radius } = drawable.frame;
    const geometry = new BufferGeometry();
    const positions = places.flatMap((place) => place.map((x, axis) => (x - centre[axis]!) / radius));
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
    geometry.setAttribute(
      "chosen",
      new BufferAttribute(
        Float32Array.from(places, (_, i) => Number(i === chosen)),
        1,
      ),
    );
    const points = new Points(geometry, this.pointMaterial);
    points.frustumCulled = false;
    this.group.add(points);
  }

  private showLines({ segments, segmentsPerItem }: LineSet, chosen: number): void {
    this.group.add(this.lines.meshOf(segments));
    const size = 6 * segmentsPerItem;
    if (chosen < 0) return;
    const last = this.chosenLines.meshOf(segments.slice(size * chosen, size * (chosen + 1)));
    last.renderOrder = 2;
    this.group.add(last);
  }

  clear(): void {
    for (const child of [...this.group.children]) {
      (child as Mesh).geometry.dispose();
      this.group.remove(child);
    }
  }

  paint(palette: Palette, pixelRatio: number): void {
    this.faceMaterial.color.setStyle(palette.mark);
    this.lines.paint(palette.mark, 2.5 * pixelRatio);
    this.chosenLines.paint(palette.selected, 4 * pixelRatio);
    const { uniforms } = this.pointMaterial;
    (uniforms["mark"]!.value as Color).setStyle(palette.mark);
    (uniforms["rim"]!.value as Color).setStyle(palette.markRim);
    uniforms["size"]!.value = 11 * pixelRatio;
  }
}

function pointMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: kVertex,
    fragmentShader: kFragment,
    transparent: true,
    depthWrite: false,
    uniforms: {
      size: { value: 11 },
      mark: { value: new Color() },
      rim: { value: new Color() },
    },
  });
}

function facesOf(drawable: Drawable, faces: number[]): BufferGeometry {
  const pieces = faces.map((face) => {
    const [begin, end] = trianglesOfFace(drawable, face);
    return drawable.positions.subarray(9 * begin, 9 * end);
  });
  const positions = new Float32Array(pieces.reduce((sum, piece) => sum + piece.length, 0));
  let at = 0;
  for (const piece of pieces) {
    positions.set(piece, at);
    at += piece.length;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  return geometry;
}
