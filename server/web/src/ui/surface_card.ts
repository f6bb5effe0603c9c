import type { RecognisedSurface } from "../service/types.ts";
import type { Rgb } from "../surfaces/colours.ts";
import { factsOf, whyFree } from "../surfaces/facts.ts";
import { kindName, sizeOf } from "../surfaces/groups.ts";
import { h } from "./dom.ts";
import { swatch } from "./swatch.ts";
import { sentence, whole } from "./words.ts";

/** "Cylinder, r 2.5" */
export function nameOfSurface(surface: RecognisedSurface): string {
  const name = sentence(kindName(surface.kind));
  const size = surface.kind === "free" ? "" : sizeOf(surface);
  return size === "" ? name : `${name}, ${size}`;
}

/** All that is known of a surface, as a list of names and values. */
export function surfaceFacts(surface: RecognisedSurface): HTMLElement {
  return h(
    "div",
    { class: "surface-facts" },
    surface.kind === "free" && h("p", {}, whyFree(surface)),
    h("dl", {}, ...factsOf(surface).map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value)))),
  );
}

export interface ShownSurface {
  surface: RecognisedSurface;
  colour: Rgb;
  /** The face of the file that was clicked. */
  face: number;
  onFace: () => void;
  onClose: () => void;
}

/** The surface under a click, for a corner of its view. */
export function surfaceCard({ surface, colour, face, onFace, onClose }: ShownSurface): HTMLElement {
  return h(
    "div",
    { class: "card" },
    h(
      "div",
      { class: "card-head" },
      h("h3", {}, swatch([colour]), nameOfSurface(surface)),
      h("button", { type: "button", class: "quiet close", "aria-label": "Close the numbers", click: onClose }, "×"),
    ),
    surfaceFacts(surface),
    h("p", {}, h("button", { type: "button", class: "link", click: onFace }, `Numbers of face ${whole(face)}`)),
  );
}
