#include "api/report_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>

#include "api/quoting.h"
#include "core/base/error.h"
#include "core/io/format_spec.h"

namespace remesh::api {
namespace {

/// Checks for cancellation every few thousand elements of a long list.
class Pace {
 public:
  explicit Pace(RunControl& control) : control_(control) {}
  void operator()() {
    if ((++count_ & 4095u) == 0) control_.check_and_move();
  }

 protected:
  RunControl& control_;
  std::uint32_t count_ = 0;
};

/// Does the same, and reserves memory for the rest of a list whose elements have about the same length. Growing by
/// doubling would copy half a gigabyte of text, and such a copy cannot be cancelled.
class PaceOfList : Pace {
 public:
  PaceOfList(RunControl& control, JsonWriter& json, std::size_t elements)
      : Pace(control), json_(json), begin_(json.size()), elements_(elements) {}
  void operator()() {
    Pace::operator()();
    if ((count_ & 4095u) != 0) return;
    const double of_each = static_cast<double>(json_.size() - begin_) / count_;
    constexpr double kSlack = 1.02;
    const auto expected = begin_ + static_cast<std::size_t>(kSlack * of_each * static_cast<double>(elements_));
    if (json_.capacity() < expected) json_.reserve(expected + expected / 16);
  }

 private:
  JsonWriter& json_;
  std::size_t begin_, elements_;
};

void write_point(JsonWriter& json, const Vec3& p) {
  json.begin_array();
  json.number(p.x);
  json.number(p.y);
  json.number(p.z);
  json.end_array();
}

void write_places(JsonWriter& json, const std::vector<Vec3>& places) {
  json.key("places");
  json.begin_array();
  for (const Vec3& place : places) write_point(json, place);
  json.end_array();
}

void write_range(JsonWriter& json, std::string_view name, const Range& range) {
  json.key(name);
  json.begin_object();
  json.member("min", range.min);
  json.member("mean", range.mean);
  json.member("max", range.max);
  json.end_object();
}

void write_histogram(JsonWriter& json, std::string_view name, const Histogram& histogram) {
  json.key(name);
  json.begin_object();
  json.key("edges");
  json.begin_array();
  for (const double edge : histogram.edges) json.number(edge);
  json.end_array();
  json.key("counts");
  json.begin_array();
  for (const std::uint64_t count : histogram.counts) json.integer(count);
  json.end_array();
  json.end_object();
}

void write_quality(JsonWriter& json, const Quality& quality) {
  json.begin_object();
  json.member("min_angle_deg", quality.min_angle_deg);
  json.member("max_angle_deg", quality.max_angle_deg);
  write_range(json, "radius_edge_ratio", quality.radius_edge_ratio);
  write_range(json, "aspect_ratio", quality.aspect_ratio);
  write_range(json, "edge_length", quality.edge_length);
  write_range(json, "area", quality.area);
  write_histogram(json, "angle_histogram_deg", quality.angle_histogram_deg);
  write_histogram(json, "radius_edge_histogram", quality.radius_edge_histogram);
  json.end_object();
}

/// Writes a box, or null if it is empty.
void write_box(JsonWriter& json, std::string_view name, const Box3& box) {
  json.key(name);
  if (box.is_empty()) return json.null();
  json.begin_object();
  json.key("min");
  write_point(json, box.min);
  json.key("max");
  write_point(json, box.max);
  json.end_object();
}

void write_statistics_members(JsonWriter& json, const MeshStatistics& mesh) {
  json.member("vertices", mesh.vertices);
  json.member("faces", mesh.faces);
  json.member("components", mesh.components);
  json.member("boundary_edges", mesh.boundary_edges);
  json.member("non_manifold_edges", mesh.non_manifold_edges);
  json.member("closed", mesh.closed);
  json.key("euler");
  json.signed_integer(mesh.euler);
  if (mesh.mended_euler) {
    json.key("mended_euler");
    json.signed_integer(*mesh.mended_euler);
  }
  json.member("area", mesh.area);
  json.member("volume", mesh.volume);
  json.member("intersecting_pairs", mesh.intersecting_pairs);
  write_box(json, "bounding_box", mesh.bounding_box);
  json.key("quality");
  write_quality(json, mesh.quality);
}

/// Writes the statistics of the input, and what its format tells of the coordinates.
void write_input(JsonWriter& json, const Report& report) {
  json.begin_object();
  write_statistics_members(json, report.input);
  if (!report.input_unit.empty()) json.member("unit", report.input_unit);
  if (!report.input_up_axis.empty()) json.member("up_axis", report.input_up_axis);
  json.end_object();
}

/// Writes the statistics of the output, and the effect of the output format on the coordinates.
void write_output(JsonWriter& json, const Report& report) {
  json.begin_object();
  write_statistics_members(json, report.output);
  json.member("rounding", report.output_rounding);
  json.key("origin");
  if (report.output_origin) {
    write_point(json, *report.output_origin);
  } else {
    json.null();
  }
  json.end_object();
}

void write_options(JsonWriter& json, const RequestOptions& options) {
  json.begin_object();
  for (const OptionSpec& spec : option_table()) {
    json.key(spec.name);
    write_option_value(json, option_value(spec, options));
  }
  json.end_object();
}

/// Writes the numbers that describe a surface of its kind: its position and its size.
void write_shape(JsonWriter& json, const RecognisedSurface& surface) {
  const AnalyticSurface& shape = surface.shape;
  const SurfaceKind kind = shape.kind;
  if (kind == SurfaceKind::kFree) return;
  json.key("point");
  write_point(json, shape.origin);
  if (kind == SurfaceKind::kPlane) {
    json.key("normal");
    write_point(json, shape.axis);
    json.member("offset", dot(shape.axis, shape.origin));
  } else if (kind != SurfaceKind::kSphere) {
    json.key("axis");
    write_point(json, shape.axis);
  }
  if (kind == SurfaceKind::kCylinder || kind == SurfaceKind::kSphere) json.member("radius", shape.radius);
  if (kind == SurfaceKind::kTorus) {
    json.member("major_radius", shape.radius);
    json.member("minor_radius", shape.minor_radius);
  }
  if (kind == SurfaceKind::kCone) json.member("half_angle_deg", shape.half_angle * 180 / std::numbers::pi);
  if (kind == SurfaceKind::kRevolution) {
    json.key("profile");
    json.begin_array();
    for (const Vec2& at : surface.profile) {
      json.begin_array();
      json.number(at.x);
      json.number(at.y);
      json.end_array();
    }
    json.end_array();
  }
}

/// Writes the reason why a free region belongs to no surface, and the kind of surface that comes nearest to it.
void write_freedom(JsonWriter& json, const RecognisedSurface& region) {
  json.member("reason", reason_name(region.reason));
  const bool has_nearest = region.nearest_kind != SurfaceKind::kFree;
  json.member("nearest_kind", has_nearest ? std::optional(kind_name(region.nearest_kind)) : std::nullopt);
  json.member("nearest_deviation", has_nearest ? std::optional(region.nearest_deviation) : std::nullopt);
}

/// The distance that was proven; nothing for an analysis, which has no result.
std::optional<double> proven(double bound, ReportKind kind) {
  return kind == ReportKind::kRemesh ? std::optional(bound) : std::nullopt;
}

void write_surface(JsonWriter& json, SurfaceId id, const RecognisedSurface& surface, ReportKind kind) {
  const bool is_free = surface.shape.kind == SurfaceKind::kFree;
  const bool is_curved = !is_free && surface.shape.kind != SurfaceKind::kPlane;
  json.begin_object();
  json.member("id", std::uint64_t{id.value});
  json.member("kind", kind_name(surface.shape.kind));
  write_shape(json, surface);
  if (is_curved) {
    json.member("side", side_name(surface.side));
    json.member("sweep_deg", surface.sweep_deg);
  }
  json.member("patches", surface.patches);
  json.member("faces", surface.faces);
  json.member("area", surface.area);
  if (is_curved) {
    json.member("input_chord_height", surface.input_chord_height);
    json.member("input_turn_deg", surface.input_turn_deg);
    json.member("facets_per_turn", surface.facets_per_turn > 0 ? std::optional(surface.facets_per_turn) : std::nullopt);
    json.member("remeshed", surface.is_remeshed);
    json.member("elements_per_circle", surface.elements_per_circle);
    json.member("tolerance", surface.allowed);
    json.member("volume_offset", surface.outside);
  }
  json.member("bound", proven(surface.bound, kind));
  if (!is_free) {
    json.member("fit_tolerance", surface.tolerance);
    json.member("fit_deviation", surface.deviation);
  }
  write_box(json, "bounding_box", surface.extent);
  if (is_free) write_freedom(json, surface);
  json.end_object();
}

void write_surfaces(JsonWriter& json, const RecognisedSurfaces& surfaces, ReportKind kind, RunControl& control) {
  PaceOfList pace(control, json, surfaces.surfaces.size());
  json.begin_array();
  SurfaceId id(0);
  for (const RecognisedSurface& surface : surfaces.surfaces) {
    pace();
    write_surface(json, id, surface, kind);
    ++id.value;
  }
  json.end_array();
}

void write_patches(JsonWriter& json, const std::vector<PatchSummary>& patches, const RecognisedSurfaces& surfaces,
                   ReportKind kind, RunControl& control) {
  // Surfaces follow after the patches. Most surfaces take less than twice as much text as a patch.
  PaceOfList pace(control, json, patches.size() + 2 * surfaces.surfaces.size());
  json.begin_array();
  for (std::size_t id = 0; id < patches.size(); ++id) {
    pace();
    const PatchSummary& patch = patches[id];
    json.begin_object();
    json.member("id", std::uint64_t{id});
    const SurfaceId surface = surfaces.of_patch[PatchId(id)];
    json.member("kind", kind_name(surfaces.surfaces[surface].shape.kind));
    json.member("surface", std::uint64_t{surface.value});
    json.key("normal");
    write_point(json, patch.normal);
    json.member("offset", patch.offset);
    json.member("area", patch.area);
    json.member("input_faces", patch.input_faces);
    json.member("output_faces", patch.output_faces);
    json.member("loops", std::uint64_t{patch.loops});
    json.member("essential_vertices", std::uint64_t{patch.essential_vertices});
    json.member("status", status_name(patch.status));
    const std::string_view reason = reason_name(patch.reason);
    json.member("reason", reason.empty() ? std::nullopt : std::optional(reason));
    json.member("deviation", patch.deviation);
    json.member("bound", proven(patch.bound, kind));
    json.end_object();
  }
  json.end_array();
}

void write_renamed_labels(JsonWriter& json, const std::vector<RenamedLabel>& renamed) {
  json.begin_array();
  for (const RenamedLabel& label : renamed) {
    json.begin_object();
    json.member("from", label.from);
    json.member("to", label.to);
    json.end_object();
  }
  json.end_array();
}

void write_diagnostics(JsonWriter& json, const std::vector<Diagnostic>& diagnostics) {
  json.begin_array();
  for (const Diagnostic& diagnostic : diagnostics) {
    json.begin_object();
    json.member("code", diagnostic_name(diagnostic.code));
    json.member("count", diagnostic.count);
    json.key("elements");
    json.begin_array();
    for (const std::uint64_t element : diagnostic.elements) json.integer(element);
    json.end_array();
    json.member("message", diagnostic.message);
    json.key("remedies");
    json.begin_array();
    for (const Remedy& remedy : diagnostic.remedies) {
      json.begin_object();
      json.member("options", remedy.options);
      json.member("effect", remedy.effect);
      json.end_object();
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
}

/// Writes whether a volume mesher would accept the surface, and if not, the reasons and places.
void write_volume_ready(JsonWriter& json, const std::vector<VolumeObstacle>& obstacles) {
  json.begin_object();
  json.member("ready", obstacles.empty());
  json.key("reasons");
  json.begin_array();
  for (const VolumeObstacle& obstacle : obstacles) {
    json.begin_object();
    json.member("code", diagnostic_name(obstacle.code));
    json.member("count", obstacle.count);
    write_places(json, obstacle.places);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_unrefined(JsonWriter& json, const std::vector<Unrefined>& unrefined) {
  json.begin_array();
  for (const Unrefined& left : unrefined) {
    json.begin_object();
    json.member("reason", unrefined_name(left.reason));
    json.member("count", left.count);
    write_places(json, left.places);
    json.end_object();
  }
  json.end_array();
}

void write_verdict(JsonWriter& json, const Verdict& verdict) {
  json.begin_object();
  json.member("surface", verdict.surface);
  json.member("conforming", verdict.conforming);
  json.member("delaunay", verdict.delaunay);
  json.member("quality", verdict.quality);
  json.member("deviation", verdict.deviation);
  json.end_object();
}

/// Writes the bound on the distance between input and result, or null if there is none.
void write_distance_bound(JsonWriter& json, const std::optional<DistanceBound>& bound) {
  json.key("distance_bound");
  if (!bound) return json.null();
  json.begin_object();
  json.member("output_to_input", bound->output_to_input);
  json.member("input_to_output", bound->input_to_output);
  json.end_object();
}

/// Writes the predicted numbers of faces by the number of elements per circle, or null if nothing is curved.
void write_predictions(JsonWriter& json, const std::map<int, std::uint64_t>& faces) {
  json.key("predicted_faces_by_elements_per_circle");
  if (faces.empty()) return json.null();
  json.begin_object();
  for (const auto& [elements, count] : faces) json.member(std::to_string(elements), count);
  json.end_object();
}

void write_times(JsonWriter& json, const StageTimes& times) {
  json.begin_object();
  for (int s = 0; s < kStageCount; ++s) {
    const Stage stage = static_cast<Stage>(s);
    if (times.ran(stage)) json.member(stage_name(stage), times.of(stage));
  }
  json.member("total", times.total());
  json.end_object();
}

/// Writes {"names": [...], "of_face": [...]}.
void write_labels(JsonWriter& json, std::string_view kind, const LabelSet& labels, Pace& pace) {
  if (!labels.is_used()) return;
  json.key(kind);
  json.begin_object();
  json.key("names");
  json.begin_array();
  for (const std::string& name : labels.names) json.string(name);
  json.end_array();
  json.key("of_face");
  json.begin_array();
  for (const std::uint32_t label : labels.of_face) {
    pace();
    json.integer(label);
  }
  json.end_array();
  json.end_object();
}

bool is_integer_text(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos &&
         (text == "0" || text.front() != '0');
}

/// Writes the labels of the input. Groups whose names are all integers become `face_groups`, the form in which JSON
/// input has them. Other labels are written by name.
void write_face_labels(JsonWriter& json, const FaceLabels& labels, Pace& pace) {
  const LabelSet& group = labels.group;
  const bool are_numbers = group.is_used() && std::all_of(group.names.begin(), group.names.end(), is_integer_text);
  if (are_numbers) {
    json.key("face_groups");
    json.begin_array();
    for (const std::uint32_t label : group.of_face) {
      pace();
      json.raw(group.names[label]);
    }
    json.end_array();
  }
  const bool has_named_groups = group.is_used() && !are_numbers;
  if (!labels.object.is_used() && !has_named_groups && !labels.material.is_used()) return;
  json.key("labels");
  json.begin_object();
  write_labels(json, "object", labels.object, pace);
  if (has_named_groups) write_labels(json, "group", group, pace);
  write_labels(json, "material", labels.material, pace);
  json.end_object();
}

}  // namespace

void write_option_value(JsonWriter& json, const OptionValue& value) {
  std::visit(
      [&](const auto& v) {
        using V = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<V, std::monostate>) {
          json.null();
        } else if constexpr (std::is_same_v<V, bool>) {
          json.boolean(v);
        } else if constexpr (std::is_same_v<V, double>) {
          json.number(v);
        } else if constexpr (std::is_same_v<V, std::uint64_t>) {
          json.integer(v);
        } else {
          json.string(v);
        }
      },
      value);
}

double StageTimes::total() const {
  double sum = 0;
  for (const double ms : ms_) sum += std::max(ms, 0.0);
  return sum;
}

void write_programs(JsonWriter& json, Format format, std::span<const std::string> filling) {
  json.begin_array();
  for (const ReadingProgram& program : format_spec(format).programs) {
    json.begin_object();
    json.member("program", program.program);
    json.member("takes", program.takes);
    json.key("lines");
    json.begin_array();
    for (std::string_view rest = program.next; !rest.empty();) {
      const auto [line, others] = cut(rest, '\n');
      json.string(line);
      rest = others;
    }
    json.end_array();
    if (program.program == "Gmsh" && !filling.empty()) {
      json.key("geo");
      json.begin_array();
      for (const std::string& line : filling) json.string(line);
      json.end_array();
    }
    json.end_object();
  }
  json.end_array();
}

void write_solids(JsonWriter& json, const std::optional<SolidCounts>& solids) {
  json.key("solids");
  if (!solids) return json.null();
  json.begin_object();
  json.member("curves", std::uint64_t{solids->curves});
  json.member("cut_patches", std::uint64_t{solids->cut_patches});
  json.member("shared_triangles", std::uint64_t{solids->shared});
  json.member("coplanar_classes", std::uint64_t{solids->coplanar_classes});
  json.member("cells", solids->cells ? std::optional<std::uint64_t>(*solids->cells) : std::nullopt);
  json.member("dropped_pieces", std::uint64_t{solids->dropped});
  json.member("turned_shells", std::uint64_t{solids->turned});
  json.member("rounds", std::uint64_t{solids->rounds});
  json.member("intersecting_pairs", std::uint64_t{solids->left});
  json.member("moved", solids->moved);
  json.end_object();
}

void write_report(JsonWriter& json, const Report& report, const RequestOptions& options, ReportKind kind,
                  const StageTimes& times, RunControl& control) {
  RequestOptions used = with_defaults({report.options, options.preset, options.format, options.writing});
  used.core.plane_tolerance = report.first_plane_tolerance;
  if (report.min_edge_length > 0) used.core.min_edge_length = report.min_edge_length;
  const bool is_remesh = kind == ReportKind::kRemesh;

  json.begin_object();
  json.member("version", version());
  json.key("options");
  write_options(json, used);
  json.key("tolerance");
  json.begin_object();
  json.member("automatic", report.plane_tolerance_is_automatic);
  json.member("rounding_step", report.rounding_step);
  json.member("volume_bound", report.volume_bound);
  json.end_object();
  json.key("input");
  write_input(json, report);
  if (is_remesh) {
    json.key("output");
    write_output(json, report);
  }
  json.key("patches");
  write_patches(json, report.patches, report.surfaces, kind, control);
  json.key("surfaces");
  write_surfaces(json, report.surfaces, kind, control);
  write_distance_bound(json, report.distance_bound);
  write_solids(json, report.solids);
  json.key("diagnostics");
  write_diagnostics(json, report.diagnostics);
  if (is_remesh) {
    json.key("renamed_labels");
    write_renamed_labels(json, report.renamed_labels);
    json.key("recipe");
    write_programs(json, options.format.value_or(Format::kJson), report.filling_lines);
  }
  json.key("volume_ready");
  write_volume_ready(json, report.volume_obstacles);
  if (!is_remesh) {
    json.member("predicted_faces", report.predicted_faces);
    write_predictions(json, report.predicted_faces_by_elements_per_circle);
  }
  json.member("smallest_gap", report.smallest_gap);
  const double largest = report.largest_edge_for_target;
  json.member("largest_edge_for_target", largest > 0 && std::isfinite(largest) ? std::optional(largest) : std::nullopt);
  if (is_remesh) {
    json.key("unrefined");
    write_unrefined(json, report.unrefined);
    json.member("refinement_rounds", std::uint64_t{report.refinement_rounds});
    json.key("verified");
    write_verdict(json, report.verified);
  }
  json.key("timing_ms");
  write_times(json, times);
  json.end_object();
}

void write_mesh(JsonWriter& json, const Result& result, RunControl& control) {
  Pace pace(control);
  json.begin_object();
  json.key("vertices");
  json.begin_array();
  for (const Vec3& p : result.mesh.positions) {
    pace();
    write_point(json, p);
  }
  json.end_array();
  json.key("faces");
  json.begin_array();
  for (const Triangle& face : result.mesh.faces) {
    pace();
    json.begin_array();
    for (const VertexId v : face) json.integer(v.value);
    json.end_array();
  }
  json.end_array();
  json.key("face_patch");
  json.begin_array();
  for (const PatchId patch : result.face_patch) {
    pace();
    json.integer(patch.value);
  }
  json.end_array();
  json.key("face_source");
  json.begin_array();
  for (const FaceId source : result.face_source) {
    pace();
    json.integer(source.value);
  }
  json.end_array();
  json.key("input_face_patch");
  json.begin_array();
  for (const PatchId patch : result.input_face_patch) {
    pace();
    if (patch.is_valid()) {
      json.integer(patch.value);
    } else {
      json.null();
    }
  }
  json.end_array();
  write_face_labels(json, result.mesh.labels, pace);
  json.end_object();
}

}  // namespace remesh::api
