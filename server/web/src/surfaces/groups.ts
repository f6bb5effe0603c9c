// The surfaces of a report, put in order for a reader: equal ones stand together.
import type { Point } from "../mesh/drawable.ts";
import type { RecognisedSurface, SurfaceKind } from "../service/types.ts";
import { count, real } from "../ui/words.ts";

/** Surfaces of one kind and one size, for example all holes of one radius. */
export interface SurfaceGroup {
  kind: SurfaceKind;
  /** The size in words, for example "r 2.5"; empty if the kind has no size. */
  size: string;
  /** From the largest area to the smallest. */
  surfaces: RecognisedSurface[];
}

/** Curved kinds come first, because people ask for them. */
export const kKinds: readonly SurfaceKind[] = ["cylinder", "cone", "sphere", "torus", "revolution", "free", "plane"];

const kNames: Record<SurfaceKind, [one: string, many: string]> = {
  cylinder: ["cylinder", "cylinders"],
  cone: ["cone", "cones"],
  sphere: ["sphere", "spheres"],
  torus: ["torus", "tori"],
  revolution: ["surface of revolution", "surfaces of revolution"],
  free: ["free region", "free regions"],
  plane: ["plane", "planes"],
};
export function kindName(kind: SurfaceKind, n = 1): string {
  return kNames[kind][n === 1 ? 0 : 1];
}

const kReasons: Record<NonNullable<RecognisedSurface["reason"]>, string> = {
  no_kind_fits: "no kind fits",
  few_facets: "too few facets",
  uneven_facets: "uneven facets",
};
/** The reason why a free region belongs to no kind, in two or three words. */
export function shortReason({ reason }: RecognisedSurface): string {
  return reason ? kReasons[reason] : "";
}

/** The lengths of the box of its facets. */
export function extentOf({ bounding_box: box }: RecognisedSurface): Point {
  return box ? (box.max.map((x, axis) => x - box.min[axis]!) as Point) : [0, 0, 0];
}

/** The numbers by which surfaces of a kind are told to be equal. The first of them is the one that sorts them. */
function sizesOf(surface: RecognisedSurface): number[] {
  switch (surface.kind) {
    case "cylinder":
    case "sphere":
      return [surface.radius ?? 0];
    case "cone":
      return [surface.half_angle_deg ?? 0];
    case "torus":
      return [surface.major_radius ?? 0, surface.minor_radius ?? 0];
    case "revolution":
      return [Math.max(0, ...(surface.profile ?? []).map(([radius]) => radius))];
    default:
      return [];
  }
}

/** The size of one surface in words; empty for planes. */
export function sizeOf(surface: RecognisedSurface): string {
  const [first, second] = sizesOf(surface).map(real);
  switch (surface.kind) {
    case "cylinder":
    case "sphere":
      return `r ${first}`;
    case "cone":
      return `${first}°`;
    case "torus":
      return `r ${first} and ${second}`;
    case "revolution":
      return `r up to ${first}`;
    case "free":
      return shortReason(surface);
    case "plane":
      return "";
  }
}

/** Sizes that differ by a smaller part of themselves look the same to a reader. */
const kSamePart = 1e-4;
/** Sizes that differ by a larger part of themselves are never the same, however short an arc tells them. */
const kOtherPart = 1e-2;

/** How far a size may be off: an arc of a small angle tells its radius with less certainty than a full turn does. */
function uncertainty(surface: RecognisedSurface): number {
  const { kind, fit_tolerance = 0, sweep_deg = 360 } = surface;
  if (kind === "cone") {
    const extent = Math.hypot(...extentOf(surface));
    return extent > 0 ? (fit_tolerance / extent) * (180 / Math.PI) : 0;
  }
  if (kind === "sphere") return fit_tolerance;
  const half = (Math.min(sweep_deg, 180) / 2) * (Math.PI / 180);
  return half > 0 ? fit_tolerance / (1 - Math.cos(half)) : Infinity;
}

function areEqual(a: RecognisedSurface, b: RecognisedSurface): boolean {
  if (a.kind === "free") return a.reason === b.reason;
  const [ofA, ofB] = [sizesOf(a), sizesOf(b)];
  const slack = uncertainty(a) + uncertainty(b);
  return ofA.every((x, i) => {
    const y = ofB[i]!;
    const size = Math.max(Math.abs(x), Math.abs(y));
    return Math.abs(x - y) <= Math.min(Math.max(slack, kSamePart * size), kOtherPart * size);
  });
}

/**
 * Puts equal surfaces together. Output: groups in the order of kKinds; within a kind from the smallest size to the
 * largest, and kinds without a size from the largest area to the smallest.
 */
export function groupSurfaces(surfaces: readonly RecognisedSurface[]): SurfaceGroup[] {
  return kKinds.flatMap((kind) => {
    const groups: RecognisedSurface[][] = [];
    const sorted = surfaces.filter((surface) => surface.kind === kind).sort(bySize);
    for (const surface of sorted) {
      // Free regions are put together by their reasons, of which there are few; the others are sorted by size.
      const candidates = kind === "free" ? groups : groups.slice(-kNearGroups);
      const equal = candidates.find((group) => areEqual(group[0]!, surface));
      if (equal) equal.push(surface);
      else groups.push([surface]);
    }
    return groups.map((group) => {
      group.sort((a, b) => b.area - a.area || a.id - b.id);
      return { kind, size: sizeOf(group[0]!), surfaces: group };
    });
  });
}
/** Tori of one major radius may have several minor ones, so that equal tori are not always next to each other. */
const kNearGroups = 16;

function bySize(a: RecognisedSurface, b: RecognisedSurface): number {
  const [ofA, ofB] = [sizesOf(a), sizesOf(b)];
  for (let i = 0; i < ofA.length; ++i) if (ofA[i] !== ofB[i]) return ofA[i]! - ofB[i]!;
  return b.area - a.area || a.id - b.id;
}

/** "8 cylinders of r 2.5" */
export function nameOfGroup({ kind, size, surfaces }: SurfaceGroup): string {
  const what = count(surfaces.length, kindName(kind), kindName(kind, 2));
  if (size === "") return what;
  return kind === "free" ? `${what}: ${size}` : `${what} of ${size}`;
}

/** Sizes of one kind that a sentence lists; a longer list is for the table. */
const kListed = 6;

/** One line that tells what a mesh contains: "14 cylinders: 8 of r 2.5, 6 of r 3.175; 28 cones of 45°; 1 torus". */
export function summaryOf(groups: readonly SurfaceGroup[]): string {
  const parts = kKinds.flatMap((kind) => {
    const ofKind = groups.filter((group) => group.kind === kind);
    if (ofKind.length === 0) return [];
    if (ofKind.length === 1) return [kind === "free" ? nameOfFree(ofKind) : nameOfGroup(ofKind[0]!)];
    if (kind === "free") return [nameOfFree(ofKind)];
    const total = ofKind.reduce((sum, { surfaces }) => sum + surfaces.length, 0);
    const listed = ofKind.slice(0, kListed).map(({ size, surfaces }) => `${surfaces.length} of ${size}`);
    const rest = ofKind.length - listed.length;
    if (rest > 0) listed.push(`and ${count(rest, "more size")}`);
    return [`${count(total, kindName(kind), kindName(kind, 2))}: ${listed.join(", ")}`];
  });
  return parts.join("; ");
}

function nameOfFree(groups: readonly SurfaceGroup[]): string {
  const total = groups.reduce((sum, { surfaces }) => sum + surfaces.length, 0);
  return count(total, kindName("free"), kindName("free", 2));
}
