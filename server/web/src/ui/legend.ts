import type { SurfaceKind } from "../service/types.ts";
import { type Rgb, categoryColour, colourOfKind } from "../surfaces/colours.ts";
import { kindName } from "../surfaces/groups.ts";
import { h, svg } from "./dom.ts";
import { swatch } from "./swatch.ts";
import { count } from "./words.ts";

/** What colours mean: a scale between two ends, or names. */
export type LegendText =
  | { what: string; ends: [string, string]; isReversed: boolean }
  | { what: string; names: readonly string[] };

export const kAngleLegend: LegendText = { what: "Smallest angle", ends: ["0°", "60°"], isReversed: false };
export const kRatioLegend: LegendText = { what: "Radius-edge ratio", ends: ["0.58", "≥ 4.6"], isReversed: true };

/** More names would be no legend. */
const kMaxNames = 6;

/** `scale`: colours from bad to good. */
export function showLegend(element: HTMLElement, text: LegendText | null, scale: string[]): void {
  if (!text) return element.replaceChildren();
  if ("names" in text) {
    const entries = text.names.slice(0, kMaxNames).map((name, i) => entry(categoryColour(i), name));
    const left = text.names.length - entries.length;
    return element.replaceChildren(...entries, ...(left > 0 ? [h("span", {}, `and ${count(left, "other")}`)] : []));
  }
  const colours = text.isReversed ? [...scale].reverse() : scale;
  const stops = colours.map((colour, i) => svg("stop", { offset: i / (colours.length - 1), "stop-color": colour }));
  element.replaceChildren(
    h("span", {}, text.ends[0]),
    svg(
      "svg",
      {
        viewBox: "0 0 100 10",
        preserveAspectRatio: "none",
        role: "img",
        "aria-label": `${text.what}, from ${text.ends[0]} to ${text.ends[1]}`,
      },
      svg("defs", {}, svg("linearGradient", { id: "legend-scale" }, ...stops)),
      svg("rect", { width: 100, height: 10, rx: 2, fill: "url(#legend-scale)" }),
    ),
    h("span", {}, text.ends[1]),
  );
}

/** `kinds`: the kinds of surfaces that the mesh has. */
export function showKinds(element: HTMLElement, kinds: SurfaceKind[]): void {
  element.replaceChildren(...kinds.map((kind) => entry(colourOfKind(kind), kindName(kind))));
}

/** What the red edges are. */
export function addOpenEdges(element: HTMLElement, colour: string): void {
  element.append(entry(colour, "open or non-manifold edges"));
}

function entry(colour: Rgb | string, name: string): HTMLElement {
  return h("span", { class: "legend-kind" }, swatch([colour]), name);
}
