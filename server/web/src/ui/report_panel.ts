import type { Range, Report, Statistics } from "../service/types.ts";
import { adviceList } from "./advice.ts";
import { type Child, h } from "./dom.ts";
import { histogramChart } from "./histogram.ts";
import { count, degrees, label, real, seconds, whole } from "./words.ts";

/** More would be a list to study. */
const kMostAdvice = 3;

type Row = [name: string, of: (statistics: Statistics) => string];

const range = (r: Range): string => `${real(r.min)} / ${real(r.mean)} / ${real(r.max)}`;

const kRows: Record<string, Row[]> = {
  Size: [
    ["Faces", (s) => whole(s.faces)],
    ["Vertices", (s) => whole(s.vertices)],
    ["Area", (s) => real(s.area)],
    ["Volume", (s) => (s.volume === null ? "open" : real(s.volume))],
    [
      "Extent",
      (s) =>
        s.bounding_box ? s.bounding_box.max.map((x, i) => real(x - s.bounding_box!.min[i]!)).join(" × ") : "none",
    ],
  ],
  Topology: [
    ["Closed", (s) => (s.closed ? "yes" : "no")],
    ["Components", (s) => whole(s.components)],
    ["Euler number", (s) => whole(s.euler)],
    ["Boundary edges", (s) => whole(s.boundary_edges)],
    ["Non-manifold edges", (s) => whole(s.non_manifold_edges)],
    ["Intersecting pairs", (s) => (s.intersecting_pairs === null ? "not counted" : whole(s.intersecting_pairs))],
  ],
  Shape: [
    ["Smallest angle", (s) => degrees(s.quality.min_angle_deg)],
    ["Largest angle", (s) => degrees(s.quality.max_angle_deg)],
    ["Radius-edge ratio", (s) => range(s.quality.radius_edge_ratio)],
    ["Aspect ratio", (s) => range(s.quality.aspect_ratio)],
    ["Edge length", (s) => range(s.quality.edge_length)],
    ["Triangle area", (s) => range(s.quality.area)],
  ],
};

/** What the service found out, in numbers. */
export function reportTables(report: Report): HTMLElement {
  const tables = Object.entries(kRows).map(([title, rows]) =>
    h(
      "table",
      { class: "numbers-table" },
      h("caption", {}, title, title === "Shape" && h("span", { class: "muted" }, " least / mean / most")),
      h(
        "thead",
        {},
        h("tr", {}, h("td"), h("th", { scope: "col" }, "before"), report.output && h("th", { scope: "col" }, "after")),
      ),
      h(
        "tbody",
        {},
        ...rows.map(([name, of]) =>
          h(
            "tr",
            { "data-row": name },
            h("th", { scope: "row" }, name),
            h("td", {}, of(report.input)),
            report.output && h("td", {}, of(report.output)),
          ),
        ),
      ),
    ),
  );
  const [size, topology, shape] = tables;
  return h("div", { class: "tables" }, size, topology, aboutSolids(report), aboutRun(report), timing(report), shape);
}

function factTable(title: string, facts: [string, string][]): HTMLElement {
  return h(
    "table",
    { class: "numbers-table" },
    h("caption", {}, title),
    h(
      "tbody",
      {},
      ...facts.map(([name, value]) =>
        h("tr", { "data-row": name }, h("th", { scope: "row" }, name), h("td", {}, value)),
      ),
    ),
  );
}

function aboutRun(report: Report): HTMLElement {
  const { verified, tolerance } = report;
  const verdict = (holds: boolean | null): string => (holds === null ? "not asked" : holds ? "holds" : "fails");
  const facts: [string, string][] = [
    ["Patches", whole(report.patches.length)],
    [
      "Plane tolerance",
      `${real(Number(report.options["plane_tolerance"]))}${tolerance.automatic ? " (automatic)" : ""}`,
    ],
  ];
  if (!report.output) facts.push(["Predicted faces", whole(report.predicted_faces)]);
  for (const [elements, faces] of Object.entries(report.predicted_faces_by_elements_per_circle ?? {}))
    facts.push([`Predicted with ${elements} per circle`, whole(faces)]);
  if (report.smallest_gap !== null) facts.push(["Smallest gap", real(report.smallest_gap)]);
  if (report.refinement_rounds !== undefined) facts.push(["Rounds", whole(report.refinement_rounds)]);
  facts.push(["Ready for a volume mesh", report.volume_ready.ready ? "yes" : "no"]);
  if (verified) {
    facts.push(
      ["Verified: surface", verdict(verified.surface)],
      ["Verified: conforming", verdict(verified.conforming)],
      ["Verified: Delaunay", verdict(verified.delaunay)],
      ["Verified: quality", verdict(verified.quality)],
      ["Deviation", real(verified.deviation)],
    );
  }
  if (report.distance_bound) {
    facts.push(
      ["Result to input, at most", real(report.distance_bound.output_to_input)],
      ["Input to result, at most", real(report.distance_bound.input_to_output)],
    );
  }
  return factTable(report.output ? "This run" : "This analysis", facts);
}

/** What became of faces that met, if that was asked for and some did. */
function aboutSolids({ solids }: Report): HTMLElement | null {
  if (!solids) return null;
  return factTable("Faces that met", [
    ["Curves", whole(solids.curves)],
    ["Patches that were cut", whole(solids.cut_patches)],
    ["Triangles that were shared", whole(solids.shared_triangles)],
    ["Groups of coplanar patches", whole(solids.coplanar_classes)],
    ["Cells", solids.cells === null ? "not counted" : whole(solids.cells)],
    ["Triangles that were dropped", whole(solids.dropped_pieces)],
    ["Shells that were turned over", whole(solids.turned_shells)],
    ["Rounds of joining points", whole(solids.rounds)],
    ["Pairs that still intersect", whole(solids.intersecting_pairs)],
    ["Moved by at most", real(solids.moved)],
  ]);
}

function timing(report: Report): HTMLElement {
  return factTable(
    "Time",
    Object.entries(report.timing_ms).map(([stage, ms]) => [label(stage), seconds(ms)]),
  );
}

/** The least angle that was asked for; null where none was, or nothing was refined. */
export function angleBound({ options, output }: Report): number | null {
  const ratio = options["max_radius_edge_ratio"];
  const given = options["min_angle_deg"];
  const angle =
    typeof given === "number" ? given : typeof ratio === "number" ? (Math.asin(1 / (2 * ratio)) * 180) / Math.PI : null;
  return options["refine"] === true && output && angle !== null && angle > 0 ? angle : null;
}

/** The report at a glance, with the advice that it has. */
export function qualityPanel(report: Report, onAdvice: (options: string) => void): HTMLElement {
  const { input, output } = report;
  const bound = angleBound(report);
  const remedies = report.diagnostics.flatMap((diagnostic) => diagnostic.remedies).slice(0, kMostAdvice);
  return h(
    "div",
    { class: "quality" },
    h(
      "div",
      { class: "glance" },
      tiles(report),
      remedies.length > 0 && h("h3", {}, "What would help"),
      remedies.length > 0 && adviceList(remedies, onAdvice),
    ),
    histogramChart(input.quality.angle_histogram_deg, output?.quality.angle_histogram_deg ?? null, {
      title: "Angles",
      axis: "degrees",
      format: (value) => real(value),
      bound,
      boundName: `asked for: ${bound === null ? "" : real(bound)}°`,
    }),
    histogramChart(input.quality.radius_edge_histogram, output?.quality.radius_edge_histogram ?? null, {
      title: "Radius-edge ratio",
      axis: "circumradius over shortest edge",
      format: (value) => real(Number(value.toPrecision(3))),
      bound: bound === null ? null : 1 / (2 * Math.sin((bound * Math.PI) / 180)),
      boundName: "asked for",
    }),
  );
}

function tiles({
  input,
  output,
  verified,
  unrefined,
  volume_ready,
  predicted_faces,
  distance_bound,
}: Report): HTMLElement {
  const change = (name: string, of: (s: Statistics) => string): Child =>
    h(
      "div",
      { class: "tile" },
      h("dt", {}, name),
      h(
        "dd",
        {},
        h("span", { class: output ? "was" : "" }, of(input)),
        output && h("span", { class: "now" }, of(output)),
      ),
    );
  const verdict = (name: string, isGood: boolean, text: string): Child =>
    h("div", { class: "tile" }, h("dt", {}, name), h("dd", {}, h("span", { class: isGood ? "good" : "poor" }, text)));
  const missed = unrefined?.reduce((sum, part) => sum + part.count, 0) ?? 0;
  return h(
    "dl",
    { class: "tiles" },
    change("Faces", (s) => whole(s.faces)),
    change("Smallest angle", (s) => degrees(s.quality.min_angle_deg)),
    change("Largest radius-edge ratio", (s) => real(Number(s.quality.radius_edge_ratio.max.toPrecision(3)))),
    !output && h("div", { class: "tile" }, h("dt", {}, "Predicted faces"), h("dd", {}, whole(predicted_faces))),
    verified && verdict("Verified", true, "surface, edges, shape"),
    output && h("div", { class: "tile" }, h("dt", {}, "Distance"), h("dd", { id: "measured-distance" }, "measuring …")),
    distance_bound &&
      h(
        "div",
        { class: "tile" },
        h("dt", {}, "Distance, proven"),
        h("dd", {}, `at most ${real(Math.max(distance_bound.output_to_input, distance_bound.input_to_output))}`),
      ),
    output && verdict("Below the bound", missed === 0, missed === 0 ? "none" : count(missed, "face")),
    verdict("Volume mesher", volume_ready.ready, volume_ready.ready ? "can take it" : "would refuse it"),
  );
}
