import { type Numbered, type NumberedColours } from "../colouring.ts";
import { kLabels } from "../mesh/face_labels.ts";
import type { SurfaceKind } from "../service/types.ts";
import { type Axis, type StandardView, front } from "../view/orbit.ts";
import type { Colouring } from "../view/surface_model.ts";
import { type Section, type Viewer, kSides } from "../view/viewer.ts";
import { byId } from "./dom.ts";
import { type LegendText, kAngleLegend, kRatioLegend, addOpenEdges, showKinds, showLegend } from "./legend.ts";

const kNumbered: readonly string[] = ["size", "distance", ...kLabels];
const kFixedLegends: Partial<Record<Colouring, LegendText>> = { angle: kAngleLegend, ratio: kRatioLegend };

export interface ToolbarParts {
  viewer: Viewer;
  numbers: NumberedColours;
  kinds: () => SurfaceKind[];
  onColouring: () => void;
}

/**
 * How the views are drawn: colours, edges, cameras, the section. Output: what is to be called when what is known of the
 * meshes on the screen has changed.
 */
export function wireToolbar({ viewer, numbers, kinds, onColouring }: ToolbarParts): () => void {
  const colouring = byId<HTMLSelectElement>("colouring");
  const legend = byId("legend");
  const lines = byId<HTMLInputElement>("lines");
  const show = (): void => {
    const chosen = colouring.value as Colouring;
    const text = kNumbered.includes(chosen) ? numbers.use(chosen as Numbered) : (kFixedLegends[chosen] ?? null);
    // What is not known cannot be drawn.
    viewer.colours = kNumbered.includes(chosen) && !text ? "plain" : chosen;
    if (chosen === "surface") showKinds(legend, kinds());
    else showLegend(legend, text, viewer.palette.scale);
    const hasOpenEdges = kSides.some((side) => {
      const drawable = viewer.drawable(side);
      return drawable !== null && drawable.openEdges + drawable.nonManifoldEdges > 0;
    });
    if (hasOpenEdges && lines.checked) addOpenEdges(legend, viewer.palette.open);
  };
  const tell = (): void => {
    const known: readonly string[] = numbers.known;
    for (const option of colouring.options) {
      if (kNumbered.includes(option.value)) option.hidden = option.disabled = !known.includes(option.value);
    }
    show();
  };
  colouring.value = "patch";
  colouring.addEventListener("change", () => {
    show();
    onColouring();
  });
  tell();
  lines.addEventListener("change", () => {
    viewer.lines = lines.checked;
    show();
  });
  const linked = byId<HTMLInputElement>("linked");
  linked.addEventListener("change", () => {
    viewer.areLinked = linked.checked;
    if (linked.checked) viewer.move("before", () => {});
  });
  const overlay = byId<HTMLInputElement>("overlay");
  overlay.addEventListener("change", () => (viewer.overlay = overlay.checked));
  byId("fit").addEventListener("click", () => {
    for (const side of kSides) viewer.fit(side);
  });
  wireCameras(viewer);
  wireSection(viewer);
  return tell;
}

function wireCameras(viewer: Viewer): void {
  const look = byId<HTMLSelectElement>("look");
  look.addEventListener("change", () => {
    if (look.value !== "") viewer.look(look.value as StandardView);
  });
  // A view is left as soon as a camera is moved by hand.
  viewer.onMove = () => (look.value = "");
  const axis = byId<HTMLSelectElement>("up-axis");
  axis.addEventListener("change", () => (viewer.upAxis = axis.value as Axis));
}

/** The axis that a file says points upwards. */
export function setUpAxis(viewer: Viewer, axis: Axis): void {
  const select = byId<HTMLSelectElement>("up-axis");
  if (select.value === axis) return;
  select.value = axis;
  viewer.upAxis = axis;
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
