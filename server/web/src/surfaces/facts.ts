// Tells what is known of one surface, in words and numbers.
import type { Point } from "../mesh/drawable.ts";
import type { RecognisedSurface } from "../service/types.ts";
import { degrees, real, sentence, whole } from "../ui/words.ts";
import { extentOf, kindName, shortReason } from "./groups.ts";

/** Coordinates of unit vectors below this are rounding. */
const kNoDirection = 1e-6;
/** A sweep that is less than this short of a full turn is one. */
const kFullTurn = 359.99;

/** What is smaller than `step` is written as 0. */
function rounded(x: number, step: number): string {
  return real(Math.abs(x) < step ? 0 : x);
}
function vector(p: Point, step: number): string {
  return p.map((x) => rounded(x, step)).join(", ");
}

/** Spheres have none, because they have no axis. */
export function sweepOf({ kind, sweep_deg }: RecognisedSurface): string {
  if (sweep_deg === undefined || kind === "sphere") return "";
  return sweep_deg >= kFullTurn ? "full turn" : degrees(sweep_deg);
}

const kSides: Record<NonNullable<RecognisedSurface["side"]>, string> = {
  convex: "convex",
  concave: "concave",
  both: "both sides",
};
export function sideOf({ side }: RecognisedSurface): string {
  return side ? kSides[side] : "";
}

const kSideMeanings: Partial<Record<RecognisedSurface["kind"], Record<"convex" | "concave", string>>> = {
  cylinder: { convex: "shaft, rounding", concave: "hole, fillet" },
  cone: { convex: "tip, chamfer", concave: "countersink" },
  sphere: { convex: "ball", concave: "socket" },
};

/** "concave (hole, fillet)" */
function sideInWords(surface: RecognisedSurface): string {
  const { kind, side } = surface;
  const meaning = side && side !== "both" ? kSideMeanings[kind]?.[side] : undefined;
  return meaning ? `${sideOf(surface)} (${meaning})` : sideOf(surface);
}

/** Why a free region is of no kind, in a sentence. */
export function whyFree(surface: RecognisedSurface): string {
  const { reason, nearest_kind, nearest_deviation } = surface;
  const nearest = nearest_kind && nearest_kind !== "free" ? kindName(nearest_kind) : null;
  const off = nearest_deviation == null ? "" : `, which it misses by ${real(nearest_deviation)}`;
  switch (reason) {
    case "no_kind_fits":
      return nearest
        ? `No kind of surface passes through all vertices. The nearest one is a ${nearest}${off}.`
        : "No kind of surface passes through all vertices.";
    case "few_facets":
      return `${nearest ? `A ${nearest} fits` : "Several kinds fit"}, but so few facets prove nothing.`;
    case "uneven_facets":
      return `${nearest ? `A ${nearest} fits` : "A kind of surface fits"}, but the facets are so uneven that they are probably meant to be flat.`;
    default:
      return sentence(shortReason(surface));
  }
}

/** Names and values for a list; those that a kind does not have are left out. */
export function factsOf(surface: RecognisedSurface): [name: string, value: string][] {
  const { kind, point, axis, radius, half_angle_deg, profile, fit_tolerance = 0 } = surface;
  const extent = extentOf(surface);
  const step = Math.max(fit_tolerance, 1e-9 * Math.hypot(...extent));
  const facts: [string, string][] = [];
  const fact = (name: string, value: string | number | null | undefined): void => {
    if (value != null && value !== "") facts.push([name, typeof value === "number" ? real(value) : value]);
  };
  fact("Radius", radius);
  fact("Diameter", radius === undefined ? null : 2 * radius);
  fact("Radius of the ring", surface.major_radius);
  fact("Radius of the tube", surface.minor_radius);
  fact(
    "Half angle",
    half_angle_deg === undefined ? null : `${real(half_angle_deg)}° (${real(2 * half_angle_deg)}° across)`,
  );
  if (profile && profile.length > 0) {
    const radii = profile.map(([r]) => r);
    const heights = profile.map(([, h]) => h);
    const range = (all: number[]): string => `${real(Math.min(...all))} to ${real(Math.max(...all))}`;
    fact("Profile", `${whole(profile.length)} points, radius ${range(radii)}, height ${range(heights)}`);
  }
  fact("Axis", axis && vector(axis, kNoDirection));
  fact("Normal", surface.normal && vector(surface.normal, kNoDirection));
  fact("Offset", surface.offset === undefined ? null : rounded(surface.offset, step));
  const isCentred = kind === "sphere" || kind === "torus";
  fact(isCentred ? "Centre" : kind === "cone" ? "Apex" : "Through", point && vector(point, step));
  fact("Sweep", sweepOf(surface));
  fact("Side", sideInWords(surface));
  fact("Chord height", surface.input_chord_height);
  fact("Turn of an edge", surface.input_turn_deg === undefined ? null : degrees(surface.input_turn_deg));
  fact("Facets per turn", surface.facets_per_turn ? real(surface.facets_per_turn) : null);
  fact("Edges per turn", surface.elements_per_circle ? real(surface.elements_per_circle) : null);
  fact("Faces", whole(surface.faces));
  fact("Patches", whole(surface.patches));
  fact("Area", surface.area);
  fact("Extent", extent.map(real).join(" × "));
  fact("Deviation of corners", surface.fit_deviation);
  fact("Fit tolerance", surface.fit_tolerance);
  fact("Surface tolerance", surface.tolerance);
  fact("Vertices outside by", surface.volume_offset);
  fact("Proven distance", surface.bound);
  return facts;
}
