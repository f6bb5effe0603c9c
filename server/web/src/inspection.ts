// What of the surfaces is looked at: one chosen triangle with its numbers, and what a finding points at.
import { kValue, nearestTriangle, type Point, trianglesOfFace } from "./mesh/drawable.ts";
import type { RecognisedSurface, Report } from "./service/types.ts";
import type { SurfaceChoice } from "./surface_choice.ts";
import { byId } from "./ui/dom.ts";
import type { Finding, Target } from "./ui/findings.ts";
import { surfaceCard } from "./ui/surface_card.ts";
import { triangleNumbers } from "./ui/triangle_numbers.ts";
import { kNothingMarked } from "./view/marks.ts";
import { type Side, type Viewer, kSides, patchOf } from "./view/viewer.ts";

/** What is known of the surfaces on the screen. */
export interface Told {
  report: Report;
  /** For each face of the result the input face under it. */
  source: Uint32Array | null;
}

/** Numbers of a triangle below this part of its view stand above it. */
const kLow = 0.45;

export class Inspection {
  told: Told | null = null;
  private selected: Side | null = null;

  constructor(
    private readonly viewer: Viewer,
    private readonly surfaces: SurfaceChoice,
  ) {}

  /** Whether a triangle or a surface has its card in a view. */
  get hasCard(): boolean {
    return this.selected !== null;
  }
  /** Drops all that is chosen. */
  clear(): void {
    if (this.surfaces.hasChosen) this.surfaces.choose([]);
    this.clearTriangle();
  }
  private clearTriangle(): void {
    if (this.selected === null) return;
    this.viewer.select(this.selected, -1);
    byId(`${this.selected}-numbers`).hidden = true;
    this.selected = null;
  }

  /** A click: where surfaces are coloured it chooses the one under it, else the triangle. */
  pick(side: Side, triangle: number): void {
    const drawable = this.viewer.drawable(side);
    const isFace = drawable && triangle >= 0 && 3 * triangle < drawable.corners.length;
    const surface = isFace && this.viewer.colours === "surface" ? this.surfaceOf(side, triangle) : null;
    // A second click lets it go.
    if (surface && this.surfaces.isChosen(surface)) this.clear();
    else if (surface) this.showSurface(side, triangle, surface);
    else this.select(side, triangle);
  }

  /** Surfaces that were chosen in the panel. */
  chooseSurfaces(ids: number[]): void {
    this.clearTriangle();
    this.surfaces.choose(ids);
  }

  private surfaceOf(side: Side, triangle: number): RecognisedSurface | null {
    const drawable = this.viewer.drawable(side);
    return drawable && this.surfaces.ofPatch(patchOf(drawable, triangle));
  }

  private showSurface(side: Side, triangle: number, surface: RecognisedSurface): void {
    this.clearTriangle();
    this.selected = side;
    this.surfaces.choose([surface.id]);
    this.showCard(
      side,
      surfaceCard({
        surface,
        colour: this.surfaces.colourOf(surface),
        face: this.viewer.drawable(side)!.face[triangle]!,
        onFace: () => this.select(side, triangle),
        onClose: () => this.close(side),
      }),
      this.viewer.height(side, triangle),
    );
  }

  private close(side: Side): void {
    this.clear();
    byId(side).focus();
  }

  private showCard(side: Side, card: HTMLElement, height: number): void {
    const panel = byId(`${side}-numbers`);
    const hadFocus = panel.contains(document.activeElement);
    panel.replaceChildren(card);
    panel.classList.toggle("above", height < kLow);
    panel.hidden = false;
    if (hadFocus) card.querySelector<HTMLElement>(".link, button")?.focus();
  }

  /** Shows a triangle's numbers, where they do not cover it; drops those of another one. */
  select(side: Side, triangle: number, height = this.viewer.height(side, triangle)): void {
    this.clear();
    const drawable = this.viewer.drawable(side);
    if (!drawable || triangle < 0 || 3 * triangle >= drawable.corners.length) return;
    this.selected = side;
    this.viewer.select(side, triangle);
    const before = this.viewer.drawable("before");
    const source = side === "after" ? this.told?.source?.[drawable.face[triangle]!] : undefined;
    const surface = this.surfaceOf(side, triangle);
    this.showCard(
      side,
      triangleNumbers({
        drawable,
        triangle,
        report: this.told?.report ?? null,
        surface,
        source: before && source !== undefined ? source : null,
        onSource: (face) => this.select("before", before ? trianglesOfFace(before, face)[0] : -1),
        onSurface: () => surface && this.showSurface(side, triangle, surface),
        onClose: () => this.close(side),
      }),
      height,
    );
  }

  /** To one of the places of a finding. */
  goTo(finding: Finding, index: number): void {
    const triangle = this.mark(finding, index);
    if (triangle < 0) return;
    this.viewer.flyToTriangle(finding.side, triangle);
    // It comes to the middle.
    this.select(finding.side, triangle, 0.5);
  }

  clearMarks(): void {
    for (const side of kSides) this.viewer.mark(side, kNothingMarked);
  }

  /** Marks all that a finding points at. Output: the triangle of the chosen one, or -1. */
  mark({ side, targets, lines, faces }: Finding, chosen: number): number {
    this.clearMarks();
    const drawable = this.viewer.drawable(side);
    if (!drawable) return -1;
    if (lines) {
      this.viewer.mark(side, { ...kNothingMarked, lines, chosen });
      return lines.triangle[chosen] ?? -1;
    }
    const places = targets.flatMap((target): Point[] => {
      if (target.kind === "place") return [target.at];
      if (target.kind !== "vertex") return [];
      const [x, y, z] = drawable.points.subarray(3 * target.vertex, 3 * target.vertex + 3);
      return [[x!, y!, z!]];
    });
    const listed = targets.flatMap((target) => (target.kind === "face" ? [target.face] : []));
    this.viewer.mark(side, { ...kNothingMarked, places, faces: faces ?? listed, chosen });
    const target = targets[chosen];
    return target ? this.triangleOf(side, target) : -1;
  }

  private triangleOf(side: Side, target: Target): number {
    const drawable = this.viewer.drawable(side)!;
    switch (target.kind) {
      case "place":
        return nearestTriangle(drawable, target.at);
      case "face": {
        const [begin, end] = trianglesOfFace(drawable, target.face);
        return begin < end ? begin : -1;
      }
      case "vertex":
        return Math.floor(drawable.corners.indexOf(target.vertex) / 3);
      case "patch": {
        for (let t = 0; t < drawable.face.length; ++t) {
          if (drawable.values[kValue.count * t + kValue.patch] === target.patch) return t;
        }
        return -1;
      }
    }
  }
}
