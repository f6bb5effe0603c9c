// What the report points at, as groups of places to go to.
import type { Point } from "../mesh/drawable.ts";
import type { Report } from "../service/types.ts";
import type { Side } from "../view/viewer.ts";
import { h } from "./dom.ts";
import { label, real, sentence, whole } from "./words.ts";

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
  targets: Target[];
}

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
};

export function findingsOf(report: Report): Finding[] {
  const places = (points: Point[]): Target[] => points.map((at) => ({ kind: "place", at }));
  const found: Finding[] = [];
  for (const { reason, count, places: points } of report.unrefined ?? []) {
    found.push({
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
        title: `Patches ${status}`,
        text: `These patches are striped in the views. Reasons: ${reasons}.`,
        count: patches.length,
        isWorse: true,
        side: report.output ? "after" : "before",
        targets: patches.slice(0, 100).map(({ id }) => ({ kind: "patch", patch: id })),
      });
    }
  }
  for (const { code, count, places: points } of report.volume_ready.reasons) {
    found.push({
      title: `In a volume mesher's way: ${label(code).toLowerCase()}`,
      text: kObstacles[code] ?? "A volume mesher may fail here.",
      count,
      isWorse: true,
      side: report.output ? "after" : "before",
      targets: places(points),
    });
  }
  for (const { code, count, elements, message } of report.diagnostics) {
    const areVertices = kOfVertices.includes(code) && !/`elements` lists (the|these) faces/.test(message);
    const targets = elements.map(
      (element): Target => (areVertices ? { kind: "vertex", vertex: element } : { kind: "face", face: element }),
    );
    const text = `${sentence(message).replace(/; `elements` lists [^;]*/, "")}.`;
    found.push({ title: label(code), text, count, isWorse: !kHarmless.includes(code), side: "before", targets });
  }
  return found;
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

/** Groups on the left, their places on the right. */
export class FindingsPanel {
  private readonly targets = h("div", { class: "targets" });

  constructor(
    private readonly panel: HTMLElement,
    private readonly onGroup: (finding: Finding) => void,
    private readonly onTarget: (finding: Finding, index: number) => void,
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
    const { targets, count } = finding;
    const buttons = targets.map((target, index) =>
      h(
        "button",
        {
          type: "button",
          "aria-pressed": "false",
          click: () => {
            for (const other of buttons) other.setAttribute("aria-pressed", String(other === buttons[index]));
            this.onTarget(finding, index);
          },
        },
        nameOf(target),
      ),
    );
    const isCut = targets.length > 0 && targets.length < count;
    this.targets.replaceChildren(
      h("p", {}, finding.text, isCut ? ` The first ${whole(targets.length)} of ${whole(count)}:` : ""),
      h("ul", { "aria-label": `Places: ${finding.title}` }, ...buttons.map((item) => h("li", {}, item))),
    );
    this.onGroup(finding);
  }
}
