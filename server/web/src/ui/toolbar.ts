import type { SurfaceKind } from "../service/types.ts";
import { front } from "../view/orbit.ts";
import type { Colouring } from "../view/surface_model.ts";
import { type Section, type Viewer, kSides } from "../view/viewer.ts";
import { byId } from "./dom.ts";
import { showLegend } from "./legend.ts";

/**
 * How the views are drawn: colours, edges, cameras, the section. Output: what is to be called when the kinds of surfaces
 * on the screen have changed.
 */
export function wireToolbar(viewer: Viewer, kinds: () => SurfaceKind[]): () => void {
  const colouring = byId<HTMLSelectElement>("colouring");
  const colour = (): void => {
    viewer.colours = colouring.value as Colouring;
    explain();
  };
  const explain = (): void => {
    showLegend(byId("legend"), colouring.value as Colouring, viewer.palette.scale, kinds());
  };
  colouring.value = "patch";
  colouring.addEventListener("change", colour);
  colour();
  const lines = byId<HTMLInputElement>("lines");
  lines.addEventListener("change", () => (viewer.lines = lines.checked));
  const linked = byId<HTMLInputElement>("linked");
  linked.addEventListener("change", () => {
    viewer.areLinked = linked.checked;
    if (linked.checked) viewer.move("before", () => {});
  });
  byId("fit").addEventListener("click", () => {
    for (const side of kSides) viewer.fit(side);
  });
  wireSection(viewer);
  return explain;
}

function wireSection(viewer: Viewer): void {
  const axis = byId<HTMLSelectElement>("section-axis");
  const part = byId<HTMLInputElement>("section-part");
  const flip = byId("section-flip");
  const section = (): Section | null => {
    if (axis.value === "") return null;
    const isFlipped = flip.getAttribute("aria-pressed") === "true";
    return { axis: Number(axis.value) as Section["axis"], part: Number(part.value) / 1000, isFlipped };
  };
  const cut = (): void => {
    byId("section-place").hidden = axis.value === "";
    viewer.setSection(section());
  };
  axis.addEventListener("change", () => {
    // What is nearer to the eye goes, so that the cut is seen.
    const isBehind = axis.value !== "" && front(viewer.orbit("before")).getComponent(Number(axis.value)) < 0;
    flip.setAttribute("aria-pressed", String(isBehind));
    cut();
  });
  part.addEventListener("input", cut);
  flip.addEventListener("click", () => {
    flip.setAttribute("aria-pressed", String(flip.getAttribute("aria-pressed") !== "true"));
    cut();
  });
}
