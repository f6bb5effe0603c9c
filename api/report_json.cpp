#include "api/report_json.h"

#include <algorithm>
#include <array>
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
  json.list(std::array{p.x, p.y, p.z}, [&](double coordinate) { json.number(coordinate); });
}

void write_point(JsonWriter& json, std::string_view name, const Vec3& p) {
  json.key(name);
  write_point(json, p);
}

void write_places(JsonWriter& json, const std::vector<Vec3>& places) {
  json.list("places", places, [&](const Vec3& place) { write_point(json, place); });
}

void write_range(JsonWriter& json, std::string_view name, const Range& range) {
  json.object(name, [&] {
    json.member("min", range.min);
    json.member("mean", range.mean);
    json.member("max", range.max);
  });
}

void write_histogram(JsonWriter& json, std::string_view name, const Histogram& histogram) {
  json.object(name, [&] {
    json.values("edges", histogram.edges);
    json.values("counts", histogram.counts);
  });
}

void write_quality(JsonWriter& json, const Quality& quality) {
  json.member("min_angle_deg", quality.min_angle_deg);
  json.member("max_angle_deg", quality.max_angle_deg);
  write_range(json, "radius_edge_ratio", quality.radius_edge_ratio);
  write_range(json, "aspect_ratio", quality.aspect_ratio);
  write_range(json, "edge_length", quality.edge_length);
  write_range(json, "area", quality.area);
  write_histogram(json, "angle_histogram_deg", quality.angle_histogram_deg);
  write_histogram(json, "radius_edge_histogram", quality.radius_edge_histogram);
}

/// Writes a box, or null if it is empty.
void write_box(JsonWriter& json, std::string_view name, const Box3& box) {
  json.key(name);
  if (box.is_empty()) return json.null();
  json.object([&] {
    write_point(json, "min", box.min);
    write_point(json, "max", box.max);
  });
}

void write_statistics(JsonWriter& json, const MeshStatistics& mesh) {
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
  json.object("quality", [&] { write_quality(json, mesh.quality); });
}

/// Writes the statistics of the input, and what its format tells of the coordinates.
void write_input(JsonWriter& json, const Report& report) {
  json.object("input", [&] {
    write_statistics(json, report.input);
    if (!report.input_unit.empty()) json.member("unit", report.input_unit);
    if (!report.input_up_axis.empty()) json.member("up_axis", report.input_up_axis);
  });
}

/// Writes the statistics of the output, and the effect of the output format on the coordinates.
void write_output(JsonWriter& json, const Report& report) {
  json.object("output", [&] {
    write_statistics(json, report.output);
    json.member("rounding", report.output_rounding);
    json.key("origin");
    report.output_origin ? write_point(json, *report.output_origin) : json.null();
  });
}

void write_options(JsonWriter& json, const RequestOptions& options) {
  json.object("options", [&] {
    for (const OptionSpec& spec : option_table()) {
      json.key(spec.name);
      write_option_value(json, option_value(spec, options));
    }
  });
}

/// Writes the numbers that describe a surface of its kind: its position and its size.
void write_shape(JsonWriter& json, const RecognisedSurface& surface) {
  const AnalyticSurface& shape = surface.shape;
  const SurfaceKind kind = shape.kind;
  if (kind == SurfaceKind::kFree) return;
  write_point(json, "point", shape.origin);
  if (kind == SurfaceKind::kPlane) {
    write_point(json, "normal", shape.axis);
    json.member("offset", dot(shape.axis, shape.origin));
  } else if (kind != SurfaceKind::kSphere) {
    write_point(json, "axis", shape.axis);
  }
  if (kind == SurfaceKind::kCylinder || kind == SurfaceKind::kSphere) json.member("radius", shape.radius);
  if (kind == SurfaceKind::kTorus) {
    json.member("major_radius", shape.radius);
    json.member("minor_radius", shape.minor_radius);
  }
  if (kind == SurfaceKind::kCone) json.member("half_angle_deg", shape.half_angle * 180 / std::numbers::pi);
  if (kind != SurfaceKind::kRevolution) return;
  json.list("profile", surface.profile, [&](Vec2 at) {
    json.list(std::array{at.x, at.y}, [&](double coordinate) { json.number(coordinate); });
  });
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
}

void write_surfaces(JsonWriter& json, const RecognisedSurfaces& surfaces, ReportKind kind, RunControl& control) {
  PaceOfList pace(control, json, surfaces.surfaces.size());
  SurfaceId id(0);
  json.objects("surfaces", surfaces.surfaces, [&](const RecognisedSurface& surface) {
    pace();
    write_surface(json, id, surface, kind);
    ++id.value;
  });
}

void write_patches(JsonWriter& json, const std::vector<PatchSummary>& patches, const RecognisedSurfaces& surfaces,
                   ReportKind kind, RunControl& control) {
  // Surfaces follow after the patches. Most surfaces take less than twice as much text as a patch.
  PaceOfList pace(control, json, patches.size() + 2 * surfaces.surfaces.size());
  PatchId id(0);
  json.objects("patches", patches, [&](const PatchSummary& patch) {
    pace();
    const SurfaceId surface = surfaces.of_patch[id];
    json.member("id", std::uint64_t{id.value++});
    json.member("kind", kind_name(surfaces.surfaces[surface].shape.kind));
    json.member("surface", std::uint64_t{surface.value});
    write_point(json, "normal", patch.normal);
    json.member("offset", patch.offset);
    json.member("area", patch.area);
    json.member("input_faces", std::uint64_t{patch.input_faces});
    json.member("output_faces", std::uint64_t{patch.output_faces});
    json.member("loops", std::uint64_t{patch.loops});
    json.member("essential_vertices", std::uint64_t{patch.essential_vertices});
    json.member("status", status_name(patch.status));
    const std::string_view reason = reason_name(patch.reason);
    json.member("reason", reason.empty() ? std::nullopt : std::optional(reason));
    json.member("deviation", patch.deviation);
    json.member("bound", proven(patch.bound, kind));
  });
}

void write_renamed_labels(JsonWriter& json, const std::vector<RenamedLabel>& renamed) {
  json.objects("renamed_labels", renamed, [&](const RenamedLabel& label) {
    json.member("from", label.from);
    json.member("to", label.to);
  });
}

void write_diagnostics(JsonWriter& json, const std::vector<Diagnostic>& diagnostics) {
  json.objects("diagnostics", diagnostics, [&](const Diagnostic& diagnostic) {
    json.member("code", diagnostic_name(diagnostic.code));
    json.member("count", diagnostic.count);
    json.values("elements", diagnostic.elements);
    json.member("message", diagnostic.message);
    json.objects("remedies", diagnostic.remedies, [&](const Remedy& remedy) {
      json.member("options", remedy.options);
      json.member("effect", remedy.effect);
    });
  });
}

/// Writes whether a volume mesher would accept the surface, and if not, the reasons and places.
void write_volume_ready(JsonWriter& json, const std::vector<VolumeObstacle>& obstacles) {
  json.object("volume_ready", [&] {
    json.member("ready", obstacles.empty());
    json.objects("reasons", obstacles, [&](const VolumeObstacle& obstacle) {
      json.member("code", diagnostic_name(obstacle.code));
      json.member("count", obstacle.count);
      write_places(json, obstacle.places);
    });
  });
}

void write_unrefined(JsonWriter& json, const std::vector<Unrefined>& unrefined) {
  json.objects("unrefined", unrefined, [&](const Unrefined& left) {
    json.member("reason", unrefined_name(left.reason));
    json.member("count", left.count);
    write_places(json, left.places);
  });
}

void write_verdict(JsonWriter& json, const Verdict& verdict) {
  json.object("verified", [&] {
    json.member("surface", verdict.surface);
    json.member("conforming", verdict.conforming);
    json.member("delaunay", verdict.delaunay);
    json.member("quality", verdict.quality);
    json.member("deviation", verdict.deviation);
  });
}

/// Writes the bound on the distance between input and result, or null if there is none.
void write_distance_bound(JsonWriter& json, const std::optional<DistanceBound>& bound) {
  json.key("distance_bound");
  if (!bound) return json.null();
  json.object([&] {
    json.member("output_to_input", bound->output_to_input);
    json.member("input_to_output", bound->input_to_output);
  });
}

/// Writes the predicted numbers of faces by the number of elements per circle, or null if nothing is curved.
void write_predictions(JsonWriter& json, const std::map<int, std::uint64_t>& faces) {
  json.key("predicted_faces_by_elements_per_circle");
  if (faces.empty()) return json.null();
  json.object([&] {
    for (const auto& [elements, count] : faces) json.member(std::to_string(elements), count);
  });
}

void write_times(JsonWriter& json, const StageTimes& times) {
  json.object("timing_ms", [&] {
    for (int s = 0; s < kStageCount; ++s) {
      const Stage stage = static_cast<Stage>(s);
      if (times.ran(stage)) json.member(stage_name(stage), times.of(stage));
    }
    json.member("total", times.total());
  });
}

/// Writes {"names": [...], "of_face": [...]}.
void write_labels(JsonWriter& json, std::string_view kind, const LabelSet& labels, Pace& pace) {
  if (!labels.is_used()) return;
  json.object(kind, [&] {
    json.values("names", labels.names);
    json.list("of_face", labels.of_face, [&](std::uint32_t label) {
      pace();
      json.integer(label);
    });
  });
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
  if (are_numbers)
    json.list("face_groups", group.of_face, [&](std::uint32_t label) {
      pace();
      json.raw(group.names[label]);
    });
  const bool has_named_groups = group.is_used() && !are_numbers;
  if (!labels.object.is_used() && !has_named_groups && !labels.material.is_used()) return;
  json.object("labels", [&] {
    write_labels(json, "object", labels.object, pace);
    if (has_named_groups) write_labels(json, "group", group, pace);
    write_labels(json, "material", labels.material, pace);
  });
}

}  // namespace

void write_option_value(JsonWriter& json, const OptionValue& value) {
  std::visit(
      [&](const auto& v) {
        using V = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<V, std::monostate>)
          json.null();
        else
          json.value(v);
      },
      value);
}

double StageTimes::total() const {
  double sum = 0;
  for (const double ms : ms_) sum += std::max(ms, 0.0);
  return sum;
}

void write_programs(JsonWriter& json, std::string_view name, Format format, std::span<const std::string> filling) {
  json.objects(name, format_spec(format).programs, [&](const ReadingProgram& program) {
    json.member("program", program.program);
    json.member("takes", program.takes);
    std::vector<std::string_view> lines;
    for (std::string_view rest = program.next; !rest.empty();) {
      const auto [line, others] = cut(rest, '\n');
      lines.push_back(line);
      rest = others;
    }
    json.values("lines", lines);
    if (program.program == "Gmsh" && !filling.empty()) json.values("geo", filling);
  });
}

void write_solids(JsonWriter& json, const std::optional<SolidCounts>& solids) {
  json.key("solids");
  if (!solids) return json.null();
  json.object([&] {
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
  });
}

void write_report(JsonWriter& json, const Report& report, const RequestOptions& options, ReportKind kind,
                  const StageTimes& times, RunControl& control) {
  RequestOptions used = with_defaults({report.options, options.preset, options.format, options.writing});
  used.core.plane_tolerance = report.first_plane_tolerance;
  if (report.min_edge_length > 0) used.core.min_edge_length = report.min_edge_length;
  const bool is_remesh = kind == ReportKind::kRemesh;

  json.begin_object();
  json.member("version", version());
  write_options(json, used);
  json.object("tolerance", [&] {
    json.member("automatic", report.plane_tolerance_is_automatic);
    json.member("rounding_step", report.rounding_step);
    json.member("volume_bound", report.volume_bound);
  });
  write_input(json, report);
  if (is_remesh) write_output(json, report);
  write_patches(json, report.patches, report.surfaces, kind, control);
  write_surfaces(json, report.surfaces, kind, control);
  write_distance_bound(json, report.distance_bound);
  write_solids(json, report.solids);
  write_diagnostics(json, report.diagnostics);
  if (is_remesh) {
    write_renamed_labels(json, report.renamed_labels);
    write_programs(json, "recipe", options.format.value_or(Format::kJson), report.filling_lines);
  }
  write_volume_ready(json, report.volume_obstacles);
  if (!is_remesh) {
    json.member("predicted_faces", report.predicted_faces);
    write_predictions(json, report.predicted_faces_by_elements_per_circle);
  }
  json.member("smallest_gap", report.smallest_gap);
  const double largest = report.largest_edge_for_target;
  json.member("largest_edge_for_target", largest > 0 && std::isfinite(largest) ? std::optional(largest) : std::nullopt);
  if (is_remesh) {
    write_unrefined(json, report.unrefined);
    json.member("refinement_rounds", std::uint64_t{report.refinement_rounds});
    write_verdict(json, report.verified);
  }
  write_times(json, times);
  json.end_object();
}

void write_mesh(JsonWriter& json, const Result& result, RunControl& control) {
  Pace pace(control);
  json.begin_object();
  json.list("vertices", result.mesh.positions, [&](const Vec3& p) {
    pace();
    write_point(json, p);
  });
  json.list("faces", result.mesh.faces, [&](const Triangle& face) {
    pace();
    json.list(face, [&](VertexId v) { json.integer(v.value); });
  });
  const auto write_ids = [&](std::string_view name, const auto& ids) {
    json.list(name, ids, [&](auto id) {
      pace();
      id.is_valid() ? json.integer(id.value) : json.null();
    });
  };
  write_ids("face_patch", result.face_patch);
  write_ids("face_source", result.face_source);
  write_ids("input_face_patch", result.input_face_patch);
  write_face_labels(json, result.mesh.labels, pace);
  json.end_object();
}

}  // namespace remesh::api
