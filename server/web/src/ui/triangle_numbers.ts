import { type Drawable, kNoPatch } from "../mesh/drawable.ts";
import { measureTriangle } from "../mesh/quality.ts";
import type { RecognisedSurface, Report } from "../service/types.ts";
import { patchOf } from "../view/viewer.ts";
import { type Child, h } from "./dom.ts";
import { nameOfSurface } from "./surface_card.ts";
import { degrees, label, real, whole } from "./words.ts";

export interface Shown {
  drawable: Drawable;
  triangle: number;
  report: Report | null;
  surface: RecognisedSurface | null;
  /** The input face under it; of a result's triangle. */
  source: number | null;
  onSource: (face: number) => void;
  onSurface: () => void;
  onClose: () => void;
}

/** The numbers of one triangle, for a corner of its view. */
export function triangleNumbers(shown: Shown): HTMLElement {
  const { drawable, triangle, report, surface, source, onSource, onSurface, onClose } = shown;
  const ids = [0, 1, 2].map((k) => drawable.corners[3 * triangle + k]!);
  const numbers = measureTriangle(drawable.points, 3 * ids[0]!, 3 * ids[1]!, 3 * ids[2]!);
  const patch = patchOf(drawable, triangle);
  const details = patch === kNoPatch ? null : report?.patches[patch];
  const fact = (name: string, ...value: Child[]): Child => h("div", {}, h("dt", {}, name), h("dd", {}, ...value));
  const status =
    details && details.status !== "remeshed" ? `, ${details.status}: ${label(details.reason ?? "").toLowerCase()}` : "";
  return h(
    "div",
    { class: "card" },
    h(
      "div",
      { class: "card-head" },
      h("h3", {}, `Face ${whole(drawable.face[triangle]!)}`),
      h("button", { type: "button", class: "quiet close", "aria-label": "Close the numbers", click: onClose }, "×"),
    ),
    h(
      "dl",
      {},
      fact("Smallest angle", degrees(numbers.minAngle)),
      fact("Radius-edge ratio", real(numbers.radiusEdgeRatio)),
      fact("Area", real(numbers.area)),
      patch !== kNoPatch && fact("Patch", `${whole(patch)}${status}`),
      source !== null &&
        fact(
          "Over input face",
          h("button", { type: "button", class: "link", click: () => onSource(source) }, whole(source)),
        ),
      surface &&
        fact("Surface", h("button", { type: "button", class: "link", click: onSurface }, nameOfSurface(surface))),
    ),
    h(
      "table",
      {},
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          ...["vertex", "x", "y", "z", "angle", "edge across"].map((name) => h("th", { scope: "col" }, name)),
        ),
      ),
      h(
        "tbody",
        {},
        ...ids.map((id, k) =>
          h(
            "tr",
            {},
            h("th", { scope: "row" }, whole(id)),
            ...[0, 1, 2].map((axis) => h("td", {}, real(drawable.points[3 * id + axis]!))),
            h("td", {}, degrees(numbers.angles[k]!)),
            h("td", {}, real(numbers.lengths[k]!)),
          ),
        ),
      ),
    ),
  );
}
