// What the report points at, as groups of places to go to.
import { type Drawable, type Point, kValue } from "../mesh/drawable.ts";
import { type LineSet, crossings, nonManifoldEdges, openEdges, trianglesBelow } from "../mesh/line_sets.ts";
import type { Diagnostic, Remedy, Report } from "../service/types.ts";
import type { Side } from "../view/viewer.ts";
import { adviceList } from "./advice.ts";
import { h } from "./dom.ts";
import { angleBound } from "./report_panel.ts";
import { count, label, real, sentence, whole } from "./words.ts";

export type Target =
  | { kind: "place"; at: Point }
  | { kind: "face"; face: number }
  | { kind: "vertex"; vertex: number }
  | { kind: "patch"; patch: number };

export interface Finding {
  title: string;
  text: string;
  count: number;
  isWorse: boolean;
  side: Side;
  /** What the report lists: the first of them. */
  targets: Target[];
  /** All of them, where the page finds them by itself; then they are gone through instead of the targets. */
  lines: LineSet | null;
  /** All faces that it is about, where the page finds them by itself. */
  faces: number[] | null;
  remedies: Remedy[];
}
export type Drawables = Record<Side, Drawable | null>;

/** Obstacles for a volume mesher that an option can remove, with an explanation of each. */
const kObstacles: Record<string, string> = {
  open_boundary:
    "An edge has only one face, so the surface has holes. Tick holes among the repairs to close small flat ones, and set max hole edges for larger ones.",
  inside_out:
    "A closed shell has the wrong orientation: a body faces inwards, or a cavity outwards. Tick inside out among the repairs to turn it over.",
};
/** Diagnostics whose elements are vertices, unless the message says that they are faces. */
const kOfVertices = ["duplicate_vertex", "t_junction", "non_manifold_vertex", "unused_vertex"];
/** Diagnostics that are no reason for concern. */
const kHarmless = ["attribute_dropped", "trailing_bytes", "unused_vertex", "duplicate_vertex", "curved_surface"];

const kUnrefined: Record<string, string> = {
  input_angle: "The face fills a corner of the input that is sharper than the bound.",
  across_input_angle:
    "Its shortest edge joins two edges of the input that meet in a sharp corner; splitting would only repeat it nearer to the corner.",
  size_floor: "A new point would lie too near to another one, or a gap there asks for edges below the smallest size.",
  min_edge_length: "A new point would make an edge shorter than allowed.",
  budget: "The result would have had more faces than allowed.",
  boundary_locked: "It needs a new point on a boundary that must not be split.",
  effort: "Refinement ended before it met the bound, because its work is limited in proportion to the result.",
  output_rounding: "It met the bounds until the output format rounded its corners.",
  surface_tolerance:
    "The surface was made coarser here, and the tolerance, or an edge that stays, allows no better triangle.",
};

export function findingsOf(report: Report, drawables: Drawables): Finding[] {
  const places = (points: Point[]): Target[] => points.map((at) => ({ kind: "place", at }));
  const side: Side = report.output ? "after" : "before";
  const nothing = { lines: null, faces: null, remedies: [] };
  const found: Finding[] = [];
  const bound = angleBound(report);
  const below = drawables.after && bound !== null ? trianglesBelow(drawables.after, bound) : null;
  if (below && below.triangle.length > 0) {
    found.push({
      ...nothing,
      title: `Triangles below ${real(bound!)}°`,
      text: "All triangles of the result with a smaller angle than was asked for. The reasons follow.",
      count: below.triangle.length,
      isWorse: true,
      side: "after",
      targets: [],
      lines: below,
    });
  }
  for (const { reason, count, places: points } of report.unrefined ?? []) {
    found.push({
      ...nothing,
      title: `Below the bound: ${label(reason).toLowerCase()}`,
      text: kUnrefined[reason] ?? "",
      count,
      isWorse: true,
      side: "after",
      targets: places(points),
    });
  }
  for (const status of ["kept", "reduced"] as const) {
    const patches = report.patches.filter((patch) => patch.status === status);
    const reasons = [...new Set(patches.map((patch) => label(patch.reason ?? "no reason given").toLowerCase()))].join(
      ", ",
    );
    if (patches.length > 0) {
      found.push({
        ...nothing,
        title: `Patches ${status}`,
        text: `These patches are striped in the views. Reasons: ${reasons}.`,
        count: patches.length,
        isWorse: true,
        side,
        targets: patches.slice(0, 100).map(({ id }) => ({ kind: "patch", patch: id })),
      });
    }
  }
  for (const { code, count, places: points } of report.volume_ready.reasons) {
    found.push({
      ...nothing,
      title: `In a volume mesher's way: ${label(code).toLowerCase()}`,
      text: kObstacles[code] ?? "A volume mesher may fail here.",
      count,
      isWorse: true,
      side,
      targets: places(points),
      lines: drawables[side] && edgesOf(code, drawables[side]),
    });
  }
  for (const diagnostic of report.diagnostics) {
    const { code, count, elements, message, remedies } = diagnostic;
    const areVertices = kOfVertices.includes(code) && !/`elements` lists (the|these) faces/.test(message);
    const targets = elements.map(
      (element): Target => (areVertices ? { kind: "vertex", vertex: element } : { kind: "face", face: element }),
    );
    found.push({
      title: label(code),
      text: `${sentence(message).replace(/; `elements` lists [^;]*/, "")}.`,
      count,
      isWorse: !kHarmless.includes(code),
      side: "before",
      targets,
      lines: drawables.before && linesOf(diagnostic, drawables.before),
      faces: code === "curved_surface" && drawables.before ? curvedFaces(report, count, drawables.before) : null,
      remedies,
    });
  }
  return found;
}

/** All edges that a code is about; null where it is about something else, or the page sees none. */
function edgesOf(code: string, drawable: Drawable): LineSet | null {
  const edges =
    code === "open_boundary" ? openEdges(drawable) : code === "non_manifold_edge" ? nonManifoldEdges(drawable) : null;
  return edges && edges.triangle.length > 0 ? edges : null;
}

function linesOf({ code, elements }: Diagnostic, drawable: Drawable): LineSet | null {
  if (code !== "self_intersection") return edgesOf(code, drawable);
  const pairs = elements.flatMap((face, i): [number, number][] => (i % 2 === 0 ? [[face, elements[i + 1]!]] : []));
  const lines = crossings(drawable, pairs);
  return lines.triangle.length > 0 ? lines : null;
}

/**
 * The faces of all curved surfaces, or of those that were remeshed, or of those that were not: whichever has the number
 * of faces that is told. Null where none has, or where it is not known to which surface a face belongs.
 */
function curvedFaces({ surfaces, patches }: Report, count: number, drawable: Drawable): number[] | null {
  const curved = surfaces.filter(({ kind }) => kind !== "plane");
  const asked = [curved, curved.filter((s) => s.remeshed), curved.filter((s) => !s.remeshed)].find(
    (some) => some.reduce((sum, { faces }) => sum + faces, 0) === count,
  );
  if (!asked) return null;
  const ids = new Set(asked.map(({ id }) => id));
  const faces = new Set<number>();
  for (let t = 0; t < drawable.face.length; ++t) {
    const patch = patches[drawable.values[kValue.count * t + kValue.patch]!];
    if (patch && ids.has(patch.surface)) faces.add(drawable.face[t]!);
  }
  return faces.size === count ? [...faces] : null;
}

export function nameOf(target: Target): string {
  switch (target.kind) {
    case "place":
      return target.at.map((x) => real(x)).join(", ");
    case "face":
      return `Face ${whole(target.face)}`;
    case "vertex":
      return `Vertex ${whole(target.vertex)}`;
    case "patch":
      return `Patch ${whole(target.patch)}`;
  }
}

/** More buttons than these are of no use to a reader; "Next" goes through all. */
const kMaxListed = 100;

/** How many places of a finding can be gone to. */
function stopsOf({ lines, targets }: Finding): number {
  return lines ? lines.triangle.length : targets.length;
}
function nameOfStop({ lines, targets }: Finding, index: number): string {
  return lines ? `Triangle ${whole(lines.triangle[index]!)}` : nameOf(targets[index]!);
}

/** Groups on the left, their places on the right. */
export class FindingsPanel {
  private readonly targets = h("div", { class: "targets" });

  constructor(
    private readonly panel: HTMLElement,
    private readonly onGroup: (finding: Finding) => void,
    private readonly onTarget: (finding: Finding, index: number) => void,
    private readonly onAdvice: (options: string) => void,
  ) {}

  show(findings: Finding[]): void {
    if (findings.length === 0) {
      this.panel.replaceChildren(
        h("p", { class: "nothing" }, "Nothing to report: every bound holds, and nothing was repaired or dropped."),
      );
      return;
    }
    const groups = findings.map((finding) => {
      const button = h(
        "button",
        { type: "button", "aria-pressed": "false", click: () => this.open(finding, button, groups) },
        h("span", { class: finding.isWorse ? "dot worse" : "dot", "aria-hidden": "true" }),
        h("span", { class: "group-title" }, finding.title),
        h("span", { class: "group-count" }, whole(finding.count)),
      );
      return button;
    });
    this.panel.replaceChildren(
      h(
        "div",
        { class: "findings" },
        h("ul", { class: "groups", "aria-label": "Findings" }, ...groups.map((group) => h("li", {}, group))),
        this.targets,
      ),
    );
    this.open(findings[0]!, groups[0]!, groups);
  }

  private open(finding: Finding, button: HTMLElement, groups: HTMLElement[]): void {
    for (const group of groups) group.setAttribute("aria-pressed", String(group === button));
    const stops = stopsOf(finding);
    let at = -1;
    const place = h("span", { class: "muted", "aria-live": "polite" });
    const goTo = (index: number): void => {
      at = (index + stops) % stops;
      buttons.forEach((other, i) => other.setAttribute("aria-pressed", String(i === at)));
      place.textContent = `${whole(at + 1)} of ${whole(stops)}`;
      this.onTarget(finding, at);
    };
    const buttons = Array.from({ length: Math.min(stops, kMaxListed) }, (_, index) =>
      h("button", { type: "button", "aria-pressed": "false", click: () => goTo(index) }, nameOfStop(finding, index)),
    );
    const step = (text: string, by: number): HTMLElement =>
      h("button", { type: "button", class: "step", click: () => goTo(at < 0 && by < 0 ? stops - 1 : at + by) }, text);
    this.targets.replaceChildren(
      h("p", {}, finding.text),
      ...(finding.remedies.length > 0 ? [adviceList(finding.remedies, this.onAdvice)] : []),
      h(
        "p",
        { class: "mark-legend" },
        h("span", { class: finding.lines ? "mark-key line" : "mark-key", "aria-hidden": "true" }),
        legendOf(finding),
      ),
      ...(stops > 1 ? [h("p", { class: "steps" }, step("Previous", -1), step("Next", 1), place)] : []),
      h("ul", { "aria-label": `Places: ${finding.title}` }, ...buttons.map((item) => h("li", {}, item))),
    );
    this.onGroup(finding);
  }
}

/** What is marked in the views, and whether that is all. */
function legendOf({ lines, faces, targets, count: counted, side }: Finding): string {
  const where = `marked in this colour in the view ${side}, while this tab is open.`;
  const shown = lines?.shown ?? faces?.length ?? targets.length;
  if (shown === 0) return "Nothing of it is marked in the views.";
  // Bounds are judged in doubles by the service and in floats here, so that one triangle may be missing.
  const isAll = faces !== null || shown >= counted || lines?.segmentsPerItem === 3;
  const part = isAll ? "" : `, for ${whole(shown)} of the ${whole(counted)} that are reported,`;
  if (lines) {
    const marked = count(lines.triangle.length, ...lines.item);
    return `${isAll ? "All " : ""}${marked}${part} ${lines.triangle.length === 1 ? "is" : "are"} ${where} The chosen one is yellow, also behind others.`;
  }
  const which = isAll ? `All ${whole(shown)}` : `The first ${whole(shown)} of ${whole(counted)}`;
  return `${which} ${shown === 1 ? "is" : "are"} ${where}`;
}
