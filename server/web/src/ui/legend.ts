import type { SurfaceKind } from "../service/types.ts";
import { colourOfKind } from "../surfaces/colours.ts";
import { kindName } from "../surfaces/groups.ts";
import type { Colouring } from "../view/surface_model.ts";
import { h, svg } from "./dom.ts";
import { swatch } from "./swatch.ts";

const kTexts: Partial<Record<Colouring, { ends: [string, string]; isReversed: boolean; what: string }>> = {
  angle: { ends: ["0°", "60°"], isReversed: false, what: "Smallest angle" },
  ratio: { ends: ["0.58", "≥ 4.6"], isReversed: true, what: "Radius-edge ratio" },
};

/** What the colours mean. `kinds`: the kinds of surfaces that the mesh has. */
export function showLegend(element: HTMLElement, colouring: Colouring, scale: string[], kinds: SurfaceKind[]): void {
  if (colouring === "surface") {
    return element.replaceChildren(
      ...kinds.map((kind) => h("span", { class: "legend-kind" }, swatch([colourOfKind(kind)]), kindName(kind))),
    );
  }
  const text = kTexts[colouring];
  if (!text) return element.replaceChildren();
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
