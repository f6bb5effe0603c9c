#include "core/output/result/round_for_format.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/number_text.h"
#include "core/base/parallel.h"
#include "core/base/rounded_to_float.h"
#include "core/io/formats.h"
#include "core/mending/common/body_labels.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/quality.h"
#include "core/mesh/triangle_corners.h"
#include "core/output/report/volume_mesher_check.h"
#include "core/verify/rounded_check.h"

namespace remesh {
namespace {

/// `digits` times a power of ten, as it would be read from text.
double decimal(double digits, int exponent) {
  char text[64];
  auto end = std::to_chars(text, text + sizeof text, digits, std::chars_format::fixed, 0).ptr;
  *end++ = 'e';
  end = std::to_chars(end, text + sizeof text, exponent).ptr;
  double value = 0;
  std::from_chars(text, end, value);
  return value;
}

/// A point near the middle of a box whose coordinates have few digits: they are multiples of the largest power of ten
/// that is at most half the box's longest side. An axis on which the box is no further from 0 than it is long gets the
/// coordinate 0.
Vec3 origin_near(const Box3& box) {
  const Vec3 sides = box.max - box.min;
  const double longest = std::max({sides.x, sides.y, sides.z});
  Vec3 origin;
  if (!(longest > 0) || !std::isfinite(longest)) return origin;
  const int exponent = static_cast<int>(std::floor(std::log10(longest / 2)));
  const double step = decimal(1, exponent);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::max(std::fabs(box.min[axis]), std::fabs(box.max[axis])) <= longest) continue;
    const double steps = std::round((box.min[axis] / 2 + box.max[axis] / 2) / step);
    // If the coordinate needs more digits than a double has, there is no origin with few digits.
    if (std::fabs(steps) < 0x1p53) origin[axis] = decimal(steps, exponent);
  }
  return origin;
}

/// A result's points in floats relative to an origin, and the verdict on them.
struct FloatForm {
  Vec3 origin;
  std::vector<Vec3> stored;
  double largest_move = 0;  ///< largest distance by which a point moved
  UnrefinedFaces unrefined;
  RoundedVerdict verdict;

  bool is_good() const { return !verdict.fault; }
};

class FloatRounding {
 public:
  FloatRounding(const Result& result, RunControl& control) : result_(result), control_(control) {}

  FloatForm about(const Vec3& origin) {
    FloatForm form;
    form.origin = origin;
    const std::vector<Vec3>& positions = result_.mesh.positions.items();
    form.stored.resize(positions.size());
    const auto moves =
        map_blocks<double>(positions.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
          double largest = 0;
          for (std::size_t v = begin; v < end; ++v) {
            form.stored[v] = rounded_to_float(positions[v] - origin);
            largest = std::max(largest, norm((origin + form.stored[v]) - positions[v]));
          }
          return largest;
        });
    for (const double move : moves) form.largest_move = std::max(form.largest_move, move);
    check(form);
    return form;
  }

 private:
  void check(FloatForm& form) {
    const RoundingInput& basis = result_.rounding_input;
    const std::span<const Triangle> faces = result_.mesh.faces.items();
    if (basis.is_refined) list_unrefined(form);
    const RefinementClaim refined{basis.goals, form.unrefined.faces, form.unrefined.reasons};
    RoundedClaim claim;
    claim.positions = result_.mesh.positions.items();
    claim.stored = form.stored;
    claim.origin = form.origin;
    claim.storage = Storage::kFloat;
    claim.faces = faces;
    claim.face_patch = result_.face_patch.items();
    claim.normals = basis.normals.items();
    claim.is_curved = basis.is_curved.items();
    claim.allowed_move = basis.allowed_move;
    claim.intersections = &basis.intersections;
    claim.refinement = basis.is_refined ? &refined : nullptr;
    claim.unrefined_before = basis.unrefined.faces;
    claim.reasons_before = basis.unrefined.reasons;
    claim.misses_sizes_before = basis.unrefined.misses_sizes;
    form.verdict = check_rounded(claim, control_);
  }

  /// Lists the faces that miss the goals after rounding. Faces that missed them before have the same reason as before.
  /// Faces that are larger than gaps or short edges allow stay listed, because rounding does not change that.
  void list_unrefined(FloatForm& form) const {
    const UnrefinedFaces& before = result_.rounding_input.unrefined;
    const auto& faces = result_.mesh.faces;
    std::vector<UnrefinedReason> reason(faces.size(), UnrefinedReason::kOutputRounding);
    std::vector<std::uint8_t> misses_sizes(faces.size(), 0);
    for (std::size_t i = 0; i < before.faces.size(); ++i) {
      if (i % kItemsPerBlock == 0) control_.check_and_move();
      const FaceId f = before.faces[i];
      if (f.value >= faces.size()) continue;  // the check reports this as malformed
      reason[f.value] = before.reasons[i];
      // Whatever was not known before stays as it was listed.
      misses_sizes[f.value] = before.misses_sizes[i] != 0 ? kMissesSizes : 0;
    }
    form.unrefined = find_unrefined(form.stored, faces.items(), reason, misses_sizes,
                                    goals_after_rounding(result_.rounding_input.goals, form.largest_move), control_);
  }

  const Result& result_;
  RunControl& control_;
};

std::string count_of(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string reason_text(const FloatForm& form, double allowed_move) {
  const RoundedVerdict& verdict = form.verdict;
  switch (*verdict.fault) {
    case RoundedFault::kMoved:
      return "rounding to them moves a vertex by " + number_text(verdict.largest_move, 3) + ", where at most " +
             number_text(allowed_move, 3) + " is allowed (the larger of plane_tolerance and 1e-6 of the diagonal)";
    case RoundedFault::kMerged:
      return "rounding to them puts " + count_of(verdict.count, "pair", "pairs") + " of vertices at the same place";
    case RoundedFault::kTurnedOver:
      return "rounding to them turns over " + count_of(verdict.count, "triangle", "triangles") +
             " or leaves them without area";
    case RoundedFault::kNewIntersections:
      return "rounding to them makes " + count_of(verdict.count, "pair", "pairs") +
             " of faces intersect that did not intersect before";
    case RoundedFault::kBeyondRange:
    case RoundedFault::kMalformed:
    case RoundedFault::kNotStorable:
    case RoundedFault::kUnlisted:
    case RoundedFault::kListedInVain:
    case RoundedFault::kWrongReason: break;
  }
  return "a coordinate is beyond the largest float";
}

std::string names_of_formats(Storage storage) {
  std::string names;
  for (const Format format : kFormats)
    if (is_written(format) && storage_of(format) == storage)
      names.append(names.empty() ? "" : ", ").append(format_name(format));
  return names;
}

/// Says why floats cannot hold a result.
std::string reason_to_refuse(const Result& result, const FloatForm& form) {
  double largest = 0;
  for (const Vec3& p : result.mesh.positions) largest = std::max(largest, largest_coordinate(p - form.origin));
  std::string message = names_of_formats(Storage::kFloat) + " stores coordinates as floats, ";
  if (form.verdict.fault == RoundedFault::kBeyondRange)
    message += "and the coordinate " + number_text(largest, 3) + " is beyond the largest float";
  else
    message += "which are " + number_text(step_of_floats(largest), 3) + " apart at these coordinates (up to " +
               number_text(largest, 3) + (form.origin != Vec3{} ? " from a local origin): " : "): ") +
               reason_text(form, result.rounding_input.allowed_move);
  return message;
}

/// Says what would help where floats cannot hold a result.
std::string ways_out(const Result& result, const FloatForm& form, bool would_do_about_origin) {
  std::string message;
  if (would_do_about_origin)
    message += "; with local_origin=true the result can be written relative to an origin near the mesh";
  else if (result.rounding_input.is_refined && form.verdict.fault == RoundedFault::kTurnedOver)
    message += "; longer edges may help, too: set min_edge_length";
  return message;
}

[[noreturn]] void refuse(const Result& result, const FloatForm& form, bool would_do_about_origin) {
  throw Error(Code::kNotAcceptable, Stage::kWrite,
              reason_to_refuse(result, form) + "; formats that need no rounding are " +
                  names_of_formats(Storage::kDouble) + ways_out(result, form, would_do_about_origin))
      .for_option("format");
}

/// Tells that a result is not rounded, although its format has floats.
void report_output_as_text(const FloatForm& form, bool would_do_about_origin, Result& result) {
  result.report.diagnostics.push_back({DiagnosticCode::kOutputAsText,
                                       1,
                                       {},
                                       reason_to_refuse(result, form) +
                                           "; so the coordinates are written as text, which holds all of their digits" +
                                           ways_out(result, form, would_do_about_origin)});
}

/// Describes a fault that rounding must never cause, whatever the result is. Empty if the check found no such fault.
std::string_view own_mistake(const RoundedVerdict& verdict) {
  if (!verdict.fault) return {};
  switch (*verdict.fault) {
    case RoundedFault::kMalformed: return "the arrays that describe it do not fit together";
    case RoundedFault::kNotStorable: return "a coordinate was not rounded";
    case RoundedFault::kUnlisted: return "a face misses the goals, but is not listed in `unrefined`";
    case RoundedFault::kListedInVain: return "a face meets the goals, but is listed in `unrefined`";
    case RoundedFault::kWrongReason: return "a face is listed in `unrefined` for a reason that does not apply to it";
    case RoundedFault::kBeyondRange:
    case RoundedFault::kMoved:
    case RoundedFault::kMerged:
    case RoundedFault::kTurnedOver:
    case RoundedFault::kNewIntersections: break;
  }
  return {};
}

/// The form in floats, or nothing if there is none and none is required.
std::optional<FloatForm> float_form(bool local_origin, OutputRounding rounding_wanted, Result& result,
                                    RunControl& control) {
  FloatRounding rounding(result, control);
  FloatForm own = rounding.about({});
  if (own.is_good()) return own;
  Box3 box;
  for (const Vec3& p : result.mesh.positions) box.add(p);
  const Vec3 origin = origin_near(box);
  FloatForm local;
  const bool has_origin = origin != Vec3{};
  if (has_origin) local = rounding.about(origin);
  for (const FloatForm* form : {&own, &local})
    if (const std::string_view mistake = own_mistake(form->verdict); !mistake.empty())
      throw Error(Code::kVerificationFailed, Stage::kVerify,
                  "the result failed its check once it was rounded: " + std::string(mistake));
  if (has_origin && local.is_good() && local_origin) return local;
  const FloatForm& refused = has_origin && local_origin ? local : own;
  const bool would_do_about_origin = has_origin && local.is_good();
  if (rounding_wanted == OutputRounding::kRequired) refuse(result, refused, would_do_about_origin);
  report_output_as_text(refused, would_do_about_origin, result);
  return std::nullopt;
}

}  // namespace

Rounded round_for_format(Storage storage, bool local_origin, OutputRounding rounding, Result& result,
                         RunControl& control) {
  if (storage == Storage::kDouble) return Rounded::kUnchanged;
  std::optional<FloatForm> found = float_form(local_origin, rounding, result, control);
  if (!found) return Rounded::kNotHeld;
  FloatForm& form = *found;
  RoundedVerdict& verdict = form.verdict;
  if (form.origin == Vec3{} && verdict.largest_move == 0) return Rounded::kUnchanged;
  Report& report = result.report;
  report.output_rounding = verdict.largest_move;
  if (form.origin != Vec3{}) report.output_origin = form.origin;
  report.verified.deviation += verdict.largest_move;
  if (report.distance_bound) {
    report.distance_bound->output_to_input += verdict.largest_move;
    report.distance_bound->input_to_output += verdict.largest_move;
  }
  report.verified.volume_bound += verdict.volume_bound;
  report.volume_bound += verdict.volume_bound;
  for (std::size_t p = 0; p < std::min(report.patches.size(), verdict.patch_moves.size()); ++p) {
    report.patches[p].deviation += verdict.patch_moves[p];
    report.patches[p].bound += verdict.patch_moves[p];
    if (report.surfaces.of_patch.empty()) continue;
    RecognisedSurface& surface = report.surfaces.surfaces[report.surfaces.of_patch[PatchId(p)]];
    surface.bound = std::max(surface.bound, report.patches[p].bound);
  }
  if (verdict.has_intersections) {
    report.verified.intersections = std::move(verdict.intersections);
    report.verified.are_all_intersections_known = verdict.are_all_intersections_known;
    report.verified.searched = verdict.searched;
  }
  result.mesh.positions.items() = std::move(form.stored);
  if (result.rounding_input.is_refined) result.rounding_input.unrefined = std::move(form.unrefined);
  return Rounded::kMoved;
}

void measure_output(Result& result, RunControl& control) {
  Report& report = result.report;
  const std::span<const Vec3> positions = result.mesh.positions.items();
  const std::span<const VertexId> corners = corners_of(result.mesh.faces.items());
  const auto begins = triangle_begins(result.mesh.faces.size(), control);
  const Adjacency edges(positions.size(), begins, corners, control);
  // The two tasks have serial parts that do not depend on each other, so they run at the same time.
  do_all(
      corners.size(), [&] { report.output = measure_surface(positions, begins, corners, edges, corners, control); },
      [&] {
        const BodyLabels labels =
            labels_of_result(result.rounding_input.patch_labels, result.face_patch.items(), control);
        report.volume_obstacles = find_volume_obstacles(positions, corners, edges, labels,
                                                        report.verified.intersections, report.plane_tolerance, control);
        add_incomplete_check(report.verified.searched, result.mesh.faces.size(), report.volume_obstacles);
      });
  report.output.intersecting_pairs = report.verified.intersections.size();
  report.unrefined = summarise_unrefined(result.rounding_input.unrefined, positions, result.mesh.faces.items(),
                                         result.rounding_input.goals, control);
  if (!report.output_origin) return;
  const Vec3 origin = *report.output_origin;
  Box3& box = report.output.bounding_box;
  if (!box.is_empty()) box = {box.min + origin, box.max + origin};
  for (VolumeObstacle& obstacle : report.volume_obstacles)
    for (Vec3& place : obstacle.places) place += origin;
  for (Unrefined& left : report.unrefined)
    for (Vec3& place : left.places) place += origin;
}

}  // namespace remesh
