// The parts of the contract (api/openapi.yaml) that the page reads.
import type { Point } from "../mesh/drawable.ts";

export interface OptionSpec {
  name: string;
  type: "boolean" | "number" | "integer" | "string";
  group: string;
  default: boolean | number | string | null;
  unset?: string;
  minimum?: number;
  exclusive_minimum?: number;
  maximum?: number;
  values?: string[];
  is_list?: boolean;
  excludes?: string;
  description: string;
}
export interface Format {
  name: string;
  media_type: string;
  ending: string;
  endings: string[];
  about: string;
  programs: ReadingProgram[];
}
export interface ReadingProgram {
  program: string;
  takes: string;
  lines: string[];
}
export interface Capabilities {
  name: string;
  versions: { remeshd: string; api: string };
  formats: { input: Format[]; output: Format[] };
  options: OptionSpec[];
  limits: Record<string, number>;
}

export interface Range {
  min: number;
  mean: number;
  max: number;
}
export interface Histogram {
  edges: number[];
  counts: number[];
}
export interface Quality {
  min_angle_deg: number;
  max_angle_deg: number;
  radius_edge_ratio: Range;
  aspect_ratio: Range;
  edge_length: Range;
  area: Range;
  angle_histogram_deg: Histogram;
  radius_edge_histogram: Histogram;
}
export interface Statistics {
  /** Of the input, if its format tells it. */
  up_axis?: "x" | "y" | "z" | null;
  vertices: number;
  faces: number;
  components: number;
  boundary_edges: number;
  non_manifold_edges: number;
  closed: boolean;
  euler: number;
  area: number;
  volume: number | null;
  intersecting_pairs: number | null;
  bounding_box: { min: Point; max: Point } | null;
  quality: Quality;
}
export type SurfaceKind = "plane" | "cylinder" | "cone" | "sphere" | "torus" | "revolution" | "free";
/** A surface that the facets of the input were made from, or a region for which none was found. */
export interface RecognisedSurface {
  /** Its place in the report's list. */
  id: number;
  kind: SurfaceKind;
  patches: number;
  /** Faces of the input. */
  faces: number;
  area: number;
  bounding_box: { min: Point; max: Point } | null;
  /** Which of the following are there depends on the kind. */
  point?: Point;
  axis?: Point;
  normal?: Point;
  offset?: number;
  radius?: number;
  major_radius?: number;
  minor_radius?: number;
  half_angle_deg?: number;
  /** Pairs of distance from the axis and height along it. */
  profile?: [number, number][];
  side?: "convex" | "concave" | "both";
  sweep_deg?: number;
  input_chord_height?: number;
  input_turn_deg?: number;
  facets_per_turn?: number | null;
  remeshed?: boolean;
  elements_per_circle?: number | null;
  /** How far input and result may be apart on it. */
  tolerance?: number;
  /** How far vertices lie outside of it, so that its volume is kept; null if they lie on it. */
  volume_offset?: number | null;
  /** How far they are apart at most, as it was proven; null in an analysis. */
  bound: number | null;
  /** How far corners of facets may be from it, and how far they are. */
  fit_tolerance?: number;
  fit_deviation?: number;
  reason?: "no_kind_fits" | "few_facets" | "uneven_facets";
  nearest_kind?: SurfaceKind | null;
  nearest_deviation?: number | null;
}
export interface Patch {
  id: number;
  /** The kind and the id of the surface that it is a piece of. */
  kind: SurfaceKind;
  surface: number;
  normal: Point;
  area: number;
  input_faces: number;
  output_faces: number;
  status: "remeshed" | "reduced" | "kept";
  reason: string | null;
  deviation: number;
  bound: number | null;
}
/** Options in the form of a query, and what they would do, as the end of a sentence. */
export interface Remedy {
  options: string;
  effect: string;
}
export interface Diagnostic {
  code: string;
  count: number;
  elements: number[];
  message: string;
  remedies: Remedy[];
}
export interface Places {
  count: number;
  places: Point[];
}
/** What became of faces that met. */
export interface Solids {
  curves: number;
  cut_patches: number;
  shared_triangles: number;
  coplanar_classes: number;
  cells: number | null;
  dropped_pieces: number;
  turned_shells: number;
  rounds: number;
  intersecting_pairs: number;
  moved: number;
}
/** Of a remeshing, or of an analysis, which lacks what only a remeshing has. */
export interface Report {
  version: string;
  options: Record<string, boolean | number | string | null>;
  tolerance: { automatic: boolean; rounding_step: number; volume_bound: number };
  input: Statistics;
  output?: Statistics;
  patches: Patch[];
  surfaces: RecognisedSurface[];
  distance_bound: { output_to_input: number; input_to_output: number } | null;
  solids: Solids | null;
  diagnostics: Diagnostic[];
  volume_ready: { ready: boolean; reasons: ({ code: string } & Places)[] };
  /** Of an analysis. */
  predicted_faces: number;
  predicted_faces_by_elements_per_circle?: Record<string, number> | null;
  smallest_gap: number | null;
  unrefined?: ({ reason: string } & Places)[];
  refinement_rounds?: number;
  verified?: { surface: boolean; conforming: boolean; delaunay: boolean; quality: boolean | null; deviation: number };
  timing_ms: Record<string, number>;
}
/** One number for each face, an index of a name. */
export interface Labels {
  names: string[];
  of_face: number[];
}
export interface AnswerMesh {
  vertices: Point[];
  faces: Point[];
  face_patch: number[];
  face_source: number[];
  input_face_patch?: (number | null)[];
  face_groups?: number[];
  labels?: Partial<Record<"object" | "group" | "material", Labels>>;
}
export interface Answer {
  mesh: AnswerMesh;
  report: Report;
}
export interface RequestState {
  id: string;
  stage: string;
  /** Of the whole run. */
  fraction: number;
  left_s: number | null;
  elapsed_s: number;
}
export interface Job {
  id: string;
  state: "queued" | "running" | "succeeded" | "failed" | "cancelled" | "expired";
  fraction: number;
  problem: Problem | null;
}
export interface Problem {
  title: string;
  status: number;
  detail: string;
  code: string;
  request_id?: string;
  line?: number;
  byte?: number;
  element?: number;
  option?: string;
  limit?: number;
}
