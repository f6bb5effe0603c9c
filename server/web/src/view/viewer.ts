// The two views. One canvas lies behind both, drawn where their elements are; it is drawn when something has changed.
import {
  Color,
  ColorManagement,
  LineBasicMaterial,
  LineLoop,
  LinearSRGBColorSpace,
  type Mesh,
  PerspectiveCamera,
  Plane,
  Ray,
  Scene,
  Vector3,
  Vector4,
  WebGLRenderTarget,
  WebGLRenderer,
  BufferGeometry,
} from "three";

import { type Drawable, type Point, kValue } from "../mesh/drawable.ts";
import { type Marked, Marks } from "./marks.ts";
import { type Axis, type Orbit, type StandardView, between, kFieldOfView, lookAt, overview, place } from "./orbit.ts";
import { type Palette, kDarkPalette, kLightPalette } from "./palette.ts";
import { ThickLines } from "./thick_lines.ts";
import { Triad } from "./triad.ts";
import { type Colouring, type PatchTexture, SurfaceModel, patchTextureOf } from "./surface_model.ts";

export const kSides = ["before", "after"] as const;
export type Side = (typeof kSides)[number];

export interface Section {
  axis: 0 | 1 | 2;
  /** From one end of the surface, 0, to the other, 1. */
  part: number;
  isFlipped: boolean;
}

// Colours are those of the palettes, as they are.
ColorManagement.enabled = false;

/** A click so near to a corner means the corner. */
const kSnapPixels = 9;
const kFlightMs = 550;
/** While the camera moves, a frame that takes longer than this is drawn with fewer pixels. */
const kSlowFrameMs = 45;
const kRestMs = 180;

interface Flight {
  from: Orbit;
  to: Orbit;
  start: number;
}

class Pane {
  readonly triad = new Triad();
  readonly scene = new Scene();
  readonly marks = new Marks();
  readonly outline = new LineLoop(new BufferGeometry(), new LineBasicMaterial());
  readonly rule = new ThickLines();
  /** What is measured. */
  ruled: Mesh | null = null;
  orbit: Orbit = overview(1);
  model: SurfaceModel | null = null;

  constructor(readonly element: HTMLElement) {
    element.append(this.triad.element);
    this.outline.visible = false;
    this.outline.frustumCulled = false;
    this.scene.add(this.marks.group, this.outline);
  }
}

export class Viewer {
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(kFieldOfView);
  private readonly panes: Record<Side, Pane>;
  private readonly pickTarget = new WebGLRenderTarget(1, 1);
  private readonly dark = matchMedia("(prefers-color-scheme: dark)");
  private readonly stillness = matchMedia("(prefers-reduced-motion: reduce)");
  private isScheduled = false;
  private readonly flights = new Map<Side, Flight>();
  private lastMove = 0;
  private detail = 1;
  /** The timer of the frame that stays. */
  private rest = 0;
  private section: Section | null = null;
  private colouring: Colouring = "plain";
  private patches: PatchTexture = patchTextureOf(new Uint8Array(), false);
  private hasLines = true;
  private isOnFindings = false;
  private isOverlaid = false;
  private axis: Axis = "z";
  areLinked = true;
  /** Told that a camera was moved by hand. */
  onMove: () => void = () => {};

  constructor(
    private readonly canvas: HTMLCanvasElement,
    elements: Record<Side, HTMLElement>,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setScissorTest(true);
    this.renderer.autoClear = false;
    this.panes = { before: new Pane(elements.before), after: new Pane(elements.after) };
    const again = (): void => this.invalidate();
    new ResizeObserver(again).observe(canvas);
    this.dark.addEventListener("change", () => {
      this.paint();
      again();
    });
    this.paint();
  }

  get palette(): Palette {
    return this.dark.matches ? kDarkPalette : kLightPalette;
  }
  drawable(side: Side): Drawable | null {
    return this.panes[side].model?.drawable ?? null;
  }
  orbit(side: Side): Orbit {
    return this.panes[side].orbit;
  }
  aspect(side: Side): number {
    const { clientWidth, clientHeight } = this.panes[side].element;
    return clientHeight > 0 ? clientWidth / clientHeight : 1;
  }

  show(side: Side, drawable: Drawable | null): void {
    const pane = this.panes[side];
    if (pane.model) {
      pane.scene.remove(pane.model.mesh, pane.model.ghost);
      pane.model.overlay.removeFromParent();
      pane.model.dispose();
    }
    pane.marks.clear();
    this.rule(side, null);
    pane.model = drawable && new SurfaceModel(drawable);
    if (pane.model) pane.scene.add(pane.model.mesh, pane.model.ghost);
    this.layOver();
    this.paint();
    this.applySection();
    this.invalidate();
  }

  /** Colours the first mesh anew, now that its patches are known. */
  recolour(side: Side, values: Float32Array): void {
    const { model } = this.panes[side];
    if (model) model.values = values;
    this.invalidate();
  }

  /** For colourings that need a number of each triangle. */
  setNumbers(side: Side, numbers: Float32Array): void {
    const { model } = this.panes[side];
    if (model) model.numbers = numbers;
    this.invalidate();
  }

  /** The input's edges over the result. */
  set overlay(isOverlaid: boolean) {
    this.isOverlaid = isOverlaid;
    this.layOver();
    this.invalidate();
  }
  private layOver(): void {
    const { before, after } = this.panes;
    before.model?.overlay.removeFromParent();
    if (this.isOverlaid && before.model && after.model) after.scene.add(before.model.overlay);
  }

  /** A line between two places, in the frame. */
  rule(side: Side, ends: Float32Array | null): void {
    const pane = this.panes[side];
    if (pane.ruled) {
      pane.ruled.geometry.dispose();
      pane.scene.remove(pane.ruled);
    }
    pane.ruled = ends && pane.rule.meshOf(ends);
    if (pane.ruled) {
      pane.ruled.renderOrder = 2;
      pane.scene.add(pane.ruled);
    }
    this.invalidate();
  }

  set colours(colouring: Colouring) {
    this.colouring = colouring;
    this.paint();
    this.invalidate();
  }
  get colours(): Colouring {
    return this.colouring;
  }
  /** Tells the surfaces of patches, see patchTable. `hasChosen`: some are chosen, and the others step back. */
  setPatches(table: Uint8Array, hasChosen: boolean): void {
    this.patches.texture.dispose();
    this.patches = patchTextureOf(table, hasChosen);
    this.paint();
    this.invalidate();
  }
  set lines(hasLines: boolean) {
    this.hasLines = hasLines;
    this.paint();
    this.invalidate();
  }
  setSection(section: Section | null): void {
    this.section = section;
    this.applySection();
    this.invalidate();
  }
  select(side: Side, triangle: number): void {
    const { model } = this.panes[side];
    if (model) model.selected = triangle;
    this.invalidate();
  }
  /** Marks are drawn only while findings are looked at, where it is said what they are. */
  set showsFindings(isOnFindings: boolean) {
    this.isOnFindings = isOnFindings;
    this.paint();
    this.invalidate();
  }
  mark(side: Side, marked: Marked): void {
    const { model, marks } = this.panes[side];
    if (model) marks.show(model.drawable, marked);
    this.invalidate();
  }

  /** Changes a camera, and the other one with it if they are linked. */
  move(side: Side, change: (orbit: Orbit) => void): void {
    this.flights.clear();
    this.lastMove = performance.now();
    change(this.panes[side].orbit);
    this.onMove();
    this.follow(side);
    this.invalidate();
  }
  /** All of the surface again. */
  fit(side: Side): void {
    this.fly(side, overview(this.aspect(side), this.axis));
  }
  /** As drawings show a part, in both. */
  look(view: StandardView): void {
    for (const side of kSides) this.fly(side, overview(this.aspect(side), this.axis, view));
  }
  /** At once, in both. */
  reset(): void {
    this.flights.clear();
    for (const side of kSides) this.panes[side].orbit = overview(this.aspect(side), this.axis);
    this.invalidate();
  }
  set upAxis(axis: Axis) {
    this.axis = axis;
    this.onMove();
    this.reset();
  }
  /** To a triangle, and the size of what lies around it. */
  flyToTriangle(side: Side, triangle: number): void {
    const drawable = this.drawable(side);
    if (!drawable || triangle < 0) return;
    const corners = cornersOf(drawable, triangle);
    const centre = corners[0].clone().add(corners[1]).add(corners[2]).divideScalar(3);
    const size = Math.max(...corners.map((corner) => corner.distanceTo(centre)));
    const normal = corners[1].clone().sub(corners[0]).cross(corners[2].clone().sub(corners[0])).normalize();
    const towards = normal.lengthSq() > 0.5 ? normal.toArray() : null;
    this.fly(side, lookAt(this.panes[side].orbit, centre.toArray(), towards, size));
  }

  /** Where a triangle's middle is seen, from the lower edge of its view, 0, to the upper one, 1. */
  height(side: Side, triangle: number): number {
    const { model, orbit } = this.panes[side];
    if (!model) return 0;
    this.camera.aspect = this.aspect(side);
    place(this.camera, orbit);
    const [a, b, c] = cornersOf(model.drawable, triangle);
    return (a.add(b).add(c).divideScalar(3).project(this.camera).y + 1) / 2;
  }

  /** The point of a triangle at a place of a view, in the frame, or its corner if that is nearer than some pixels. */
  pointAt(side: Side, triangle: number, x: number, y: number): Vector3 {
    const { model, orbit, element } = this.panes[side];
    const { clientWidth: width, clientHeight: height } = element;
    this.camera.aspect = this.aspect(side);
    place(this.camera, orbit);
    const corners = cornersOf(model!.drawable, triangle);
    const near = corners.find((corner) => {
      const seen = corner.clone().project(this.camera);
      return Math.hypot(((seen.x + 1) / 2) * width - x, ((1 - seen.y) / 2) * height - y) < kSnapPixels;
    });
    if (near) return near;
    const ray = new Ray();
    ray.origin.copy(this.camera.position);
    ray.direction
      .set((x / width) * 2 - 1, 1 - (y / height) * 2, 0.5)
      .unproject(this.camera)
      .sub(ray.origin)
      .normalize();
    const plane = new Plane().setFromCoplanarPoints(...corners);
    return ray.intersectPlane(plane, new Vector3()) ?? corners[0];
  }

  /** The triangle at a place of a view, in its pixels; -1 where there is none. */
  pick(side: Side, x: number, y: number): number {
    const { model, orbit, element, scene } = this.panes[side];
    if (!model) return -1;
    const { clientWidth: width, clientHeight: height } = element;
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, Math.floor(x), Math.floor(y), 1, 1);
    place(this.camera, orbit);
    const shown = model.mesh.material;
    const others = scene.children.filter((child) => child !== model.mesh && child.visible);
    for (const child of others) child.visible = false;
    model.mesh.material = model.pickMaterial;
    this.renderer.setRenderTarget(this.pickTarget);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.clear();
    this.renderer.render(scene, this.camera);
    const pixel = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.pickTarget, 0, 0, 1, 1, pixel);
    this.renderer.setRenderTarget(null);
    model.mesh.material = shown;
    for (const child of others) child.visible = true;
    this.camera.clearViewOffset();
    return (pixel[0]! | (pixel[1]! << 8) | (pixel[2]! << 16) | (pixel[3]! << 24)) - 1;
  }

  invalidate(): void {
    if (this.isScheduled) return;
    this.isScheduled = true;
    this.canvas.removeAttribute("data-still");
    requestAnimationFrame((now) => this.draw(now));
  }

  /** What is on the canvas, at once: it is gone when the browser has shown it. */
  snapshot(): HTMLCanvasElement {
    this.detail = 1;
    this.drawAll();
    return this.canvas;
  }
  /** Where a view is on the canvas, in its pixels. */
  areaOf(side: Side): DOMRect {
    const [box, frame] = [this.panes[side].element.getBoundingClientRect(), this.canvas.getBoundingClientRect()];
    const ratio = this.canvas.width / Math.max(frame.width, 1);
    return new DOMRect(
      (box.left - frame.left) * ratio,
      (box.top - frame.top) * ratio,
      box.width * ratio,
      box.height * ratio,
    );
  }

  private fly(side: Side, to: Orbit): void {
    if (this.stillness.matches) {
      this.panes[side].orbit = to;
      this.follow(side);
    } else {
      this.flights.set(side, { from: this.panes[side].orbit, to, start: performance.now() });
    }
    this.invalidate();
  }

  private follow(side: Side): void {
    if (!this.areLinked) return;
    const other = side === "before" ? "after" : "before";
    const { orbit } = this.panes[side];
    this.panes[other].orbit = { ...orbit, target: orbit.target.clone() };
  }

  private draw(now: number): void {
    this.isScheduled = false;
    for (const [side, flight] of this.flights) this.advance(side, flight, now);
    const isMoving = performance.now() - this.lastMove < kRestMs;
    if (!isMoving) this.detail = 1;
    const start = performance.now();
    this.drawAll();
    if (isMoving) this.adapt(start);
    // Tests wait for it.
    this.canvas.toggleAttribute("data-still", this.detail === 1 && this.flights.size === 0);
  }

  /** Draws the next frames with fewer pixels if this one was slow, and what stays with all of them. */
  private adapt(start: number): void {
    // Reading a pixel waits for the card: the time is then the frame's.
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    if (performance.now() - start > kSlowFrameMs && this.detail > 0.35) this.detail *= 0.7;
    clearTimeout(this.rest);
    if (this.detail < 1) this.rest = window.setTimeout(() => this.invalidate(), kRestMs);
  }

  private drawAll(): void {
    this.fitCanvas();
    const frame = this.canvas.getBoundingClientRect();
    for (const side of kSides) this.drawPane(this.panes[side], frame);
  }

  private advance(side: Side, { from, to, start }: Flight, now: number): void {
    const part = Math.min(Math.max((now - start) / kFlightMs, 0), 1);
    this.panes[side].orbit = between(from, to, part);
    this.follow(side);
    this.lastMove = performance.now();
    if (part === 1) this.flights.delete(side);
    this.invalidate();
  }

  private fitCanvas(): void {
    const ratio = Math.min(devicePixelRatio, 2) * this.detail;
    const { clientWidth, clientHeight } = this.canvas;
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    if (
      this.canvas.width !== Math.floor(clientWidth * ratio) ||
      this.canvas.height !== Math.floor(clientHeight * ratio)
    ) {
      this.renderer.setSize(clientWidth, clientHeight, false);
    }
  }

  private drawPane(pane: Pane, frame: DOMRect): void {
    const box = pane.element.getBoundingClientRect();
    if (box.width < 1 || box.height < 1) return;
    const [x, y] = [box.left - frame.left, frame.bottom - box.bottom];
    this.renderer.setViewport(x, y, box.width, box.height);
    this.renderer.setScissor(x, y, box.width, box.height);
    this.renderer.setClearColor(new Color().setStyle(this.palette.background), 1);
    this.renderer.clear();
    pane.triad.element.toggleAttribute("hidden", !pane.model);
    if (!pane.model) return;
    pane.triad.turn(pane.orbit);
    this.camera.aspect = box.width / box.height;
    place(this.camera, pane.orbit);
    this.renderer.render(pane.scene, this.camera);
  }

  private paint(): void {
    const ratio = Math.min(devicePixelRatio, 2);
    for (const side of kSides) {
      const { model, marks, outline, rule } = this.panes[side];
      marks.paint(this.palette, ratio);
      marks.group.visible = this.isOnFindings;
      rule.paint(this.palette.mark, 3 * ratio);
      outline.material.color.setStyle(this.palette.section);
      if (!model) continue;
      model.paint(this.palette, this.hasLines ? 0.55 * ratio : 0, 0.8 * ratio);
      model.colouring = this.colouring;
      model.patches = this.patches;
    }
  }

  private applySection(): void {
    // The same plane in both: that of the first one's box, or of the other where there is no first one.
    const box = (this.panes.before.model ?? this.panes.after.model)?.drawable.box;
    for (const side of kSides) {
      const { model, outline } = this.panes[side];
      outline.visible = this.section !== null && model !== null;
      if (!model || !box) continue;
      if (!this.section) {
        model.section = new Vector4(0, 0, 0, 1);
        continue;
      }
      const { axis, part, isFlipped } = this.section;
      const sign = isFlipped ? -1 : 1;
      const at = box.min[axis] + (box.max[axis] - box.min[axis]) * part;
      const plane = new Vector4(0, 0, 0, sign * at);
      plane.setComponent(axis, sign);
      model.section = plane;
      outline.geometry.setFromPoints(rectangle(box, axis, at));
    }
  }
}

/** In the frame. */
function cornersOf({ positions }: Drawable, triangle: number): [Vector3, Vector3, Vector3] {
  const corner = (k: number): Vector3 => new Vector3().fromArray(positions, 9 * triangle + 3 * k);
  return [corner(0), corner(1), corner(2)];
}

function rectangle(box: Drawable["box"], axis: number, at: number): Vector3[] {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  const margin = 0.04;
  return [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 1],
  ].map(([i, j]) => {
    const corner: Point = [0, 0, 0];
    corner[axis] = at;
    corner[u] = i ? box.max[u]! + margin : box.min[u]! - margin;
    corner[v] = j ? box.max[v]! + margin : box.min[v]! - margin;
    return new Vector3(...corner);
  });
}

export function patchOf(drawable: Drawable, triangle: number): number {
  return drawable.values[kValue.count * triangle + kValue.patch]!;
}
