import { type Rgb, cssOf } from "../surfaces/colours.ts";
import { svg } from "./dom.ts";

/** Stripes of more colours than this cannot be told apart. */
export const kMaxStripes = 8;

/** A small box in these colours, at most kMaxStripes, side by side. The page's policy forbids styles on elements, so it is drawn. */
export function swatch(colours: readonly (Rgb | string)[]): SVGElement {
  const width = 16 / Math.max(colours.length, 1);
  return svg(
    "svg",
    { class: "swatch", viewBox: "0 0 16 12", preserveAspectRatio: "none", "aria-hidden": "true" },
    ...colours.map((colour, i) =>
      svg("rect", {
        x: i * width,
        width: width + 0.2,
        height: 12,
        fill: typeof colour === "string" ? colour : cssOf(colour),
      }),
    ),
  );
}
