#include "core/preparation.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/mesh/pinched_vertices.h"
#include "core/quality.h"
#include "core/stages/coplanar_regions.h"
#include "core/stages/cracks.h"
#include "core/stages/duplicate_faces.h"
#include "core/stages/findings.h"
#include "core/stages/mend_faces.h"
#include "core/stages/seams.h"
#include "core/stages/t_junctions.h"
#include "core/stages/weld.h"
#include "core/stages/winding.h"

namespace remesh {
namespace {

class Preparation {
 public:
  Preparation(const PolygonMesh& input, const Options& options, const MendingLimits& limits, Report& report,
              RunControl& control)
      : input_(input), options_(options), limits_(limits), report_(report), control_(control) {}

  Prepared run(Stopwatch& watch) {
    // Vertices with equal coordinates, or nearly equal ones, become one.
    watch.enter(Stage::kWeld);
    surface() = weld(input_, options_.barriers, report_.diagnostics, control_, options_.weld_tolerance);
    control_.check();
    watch.enter(Stage::kQuality);
    measure();
    watch.enter(Stage::kWeld);
    choose_tolerance();
    mend();
    tell_cracks();
    return std::move(prepared_);
  }

 private:
  Surface& surface() { return prepared_.surface; }
  const Adjacency& adjacency() { return prepared_.adjacency(control_); }

  void measure() {
    const auto& positions = surface().positions.items();
    const Triangulated triangles(surface(), control_);
    report_.input =
        measure_surface(positions, surface().face_begin, surface().corners, adjacency(), triangles.corners(), control_);
    const double unit = surface().unit;
    if (triangles.excess_area() > 0) report_.input.area -= triangles.excess_area() * unit * unit;
    report_.input.vertices = input_.vertex_count();
    report_.input.faces = input_.face_count();
    find_defects(surface(), adjacency(), prepared_.pinched(control_), report_.diagnostics, control_);
  }

  void choose_tolerance() {
    const Rounding rounding = rounding_of(surface().positions.items(), control_);
    report_.rounding_step = rounding.step();
    report_.plane_tolerance_is_automatic = !options_.plane_tolerance.has_value();
    const double automatic = automatic_tolerance_of(rounding);
    report_.plane_tolerance = options_.plane_tolerance.value_or(automatic);
    rounding_ = automatic;
    // Who asks for more than the digits explain wants to flatten what bends by more, too.
    const bool are_digits_noise = rounding.is_decimal && automatic == kToleranceSteps * rounding.possible_step();
    if (are_digits_noise && report_.plane_tolerance <= automatic) prepared_.printed_steps = rounding.possible_steps;
  }

  /// The diagonal of the bounding box of all faces with an area. A face without one may have a corner anywhere, which
  /// says nothing about how large the model is.
  double diagonal_of_faces() {
    if (report_.input.quality.min_angle_deg > 0) return report_.input.bounding_box.diagonal();
    const FaceGeometries& of_face = prepared_.geometry(control_);
    Box3 box;
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < surface().face_count(); ++f) {
      check();
      if (!(of_face[FaceId(f)].area > 0)) continue;
      for (const VertexId v : surface().face(FaceId(f))) box.add(surface().positions[v]);
    }
    return box.is_empty() ? report_.input.bounding_box.diagonal() : box.diagonal();
  }

  double automatic_tolerance_of(const Rounding& rounding) {
    const AutomaticTolerance tolerance = automatic_tolerance(rounding, diagonal_of_faces());
    const auto are_bent_by = [&](double more_than, double at_most, std::size_t bends) {
      const double unit = surface().unit;
      return more_than < at_most && is_noise_present(surface(), adjacency(), prepared_.geometry(control_),
                                                     more_than / unit, at_most / unit, bends, control_);
    };
    const bool is_noisy =
        tolerance.if_noisy > tolerance.if_bent && are_bent_by(tolerance.value, tolerance.if_noisy, kBendsOfNoise);
    double automatic = tolerance.value;
    if (is_noisy)
      automatic = tolerance.if_noisy;
    else if (are_bent_by(tolerance.value, tolerance.if_bent, 1))
      automatic = tolerance.if_bent;
    if (!options_.plane_tolerance && tolerance.is_capped &&
        (is_noisy || are_bent_by(automatic, tolerance.explained, kBendsOfNoise)))
      tell_of_cap(rounding, tolerance.explained, automatic);
    return automatic;
  }

  void tell_of_cap(const Rounding& rounding, double explained, double automatic) {
    const auto text = [](double x) {
      std::array<char, 32> digits{};
      char* const end = digits.data() + digits.size();
      return std::string(digits.data(), std::to_chars(digits.data(), end, x, std::chars_format::general, 6).ptr);
    };
    const std::string are = rounding.steps == rounding.possible_steps ? "are" : "may be";
    report_.diagnostics.push_back(
        {DiagnosticCode::kRoundingCapped,
         1,
         {},
         "the coordinates " + are + " rounded to steps of " + text(rounding.possible_step()) +
             ", and this explains a plane_tolerance of " + text(explained) + "; " + text(automatic) +
             " was used, because the automatic one is at most 1e-4 of the bounding box's "
             "diagonal; faces bend by what the rounding explains, so planes may be in pieces; "
             "plane_tolerance=" +
             text(explained) + " joins them, and flattens details as small as that"});
  }

  void mend() {
    const Repair& repair = options_.repair;
    const double tolerance = report_.plane_tolerance / surface().unit;
    std::vector<Diagnostic>& found = report_.diagnostics;
    const auto if_changed = [&](bool is_changed) {
      control_.check();
      if (!is_changed) return;
      prepared_.release();
      is_as_measured_ = false;
    };
    // Faces that repeat others go, edges are split at the vertices that lie on them.
    if_changed(
        drop_duplicate_faces(surface(), adjacency(), input_.labels, mend_if(repair.duplicates), found, control_));
    if_changed(split_t_junctions(surface(), adjacency(), tolerance, limits_.as_it_is,
                                 mend_if(repair.t_junctions && limits_.is_joining_allowed), found, control_));
    // Seams close. Their sides have the same vertices now, so that each edge has its partner.
    if_changed(close_seams(surface(), adjacency(), std::min(rounding_, report_.plane_tolerance) / surface().unit,
                           mend_if(repair.seams && limits_.is_joining_allowed), found, control_));
    // Faces without a plane are split, faces without an area dropped; nothing opens.
    const bool is_mended = !are_clearly_sound() && mend_faces(surface(), tolerance, limits_.as_it_is,
                                                              mend_if(repair.degenerate), found, control_);
    if_changed(is_mended);
    if (is_mended) prepared_.without_area = faces_without_area(surface(), control_);
    // Neighbours look the same way, and closed shells the way they should if that is asked for.
    if_changed(unify_winding(surface(), adjacency(), mend_if(repair.winding), found, control_));
    if (!is_solid())
      if_changed(turn_inside_out(surface(), adjacency(), input_.labels, mend_if(repair.inside_out), found, control_));
  }

  /// Adds to what is told of open edges how wide the cracks are that mending has left.
  void tell_cracks() {
    std::vector<Diagnostic>& found = report_.diagnostics;
    const auto open = std::find_if(found.begin(), found.end(),
                                   [](const Diagnostic& d) { return d.code == DiagnosticCode::kOpenBoundary; });
    if (open == found.end()) return;
    const double unit = surface().unit;
    std::vector<double> widths =
        crack_widths(surface(), adjacency(), std::min(rounding_, report_.plane_tolerance) / unit, control_);
    for (double& width : widths) width *= unit;
    open->message += describe_cracks(widths, input_, options_, control_);
  }

  /// Are all faces triangles, and their angles so far from 0 that the measures show what mend_faces would prove of one
  /// after the other? The sides of an angle are differences of two doubles: right to some 1e-16 of themselves, where
  /// they are not too small for a double.
  bool are_clearly_sound() {
    constexpr double kClearAngle = 1e-6, kClearLength = 1e-100;
    const Quality& measured = report_.input.quality;
    return is_as_measured_ && limits_.as_it_is.empty() && adjacency().are_triangles() &&
           measured.min_angle_deg > kClearAngle &&
           measured.edge_length.min > kClearLength * report_.input.bounding_box.diagonal();
  }

  /// Is it closed, of one piece and clearly of positive volume? Then nothing of it is inside out.
  bool is_solid() {
    constexpr double kClearly = 1e-9;
    const MeshStatistics& input = report_.input;
    return is_as_measured_ && input.components == 1 && input.volume &&
           *input.volume > kClearly * input.area * input.bounding_box.diagonal() && prepared_.pinched(control_).empty();
  }

  const PolygonMesh& input_;
  const Options& options_;
  const MendingLimits& limits_;
  Report& report_;
  RunControl& control_;
  Prepared prepared_;
  double rounding_ = 0;         ///< model units: how far the rounding of coordinates may move a point
  bool is_as_measured_ = true;  ///< nothing has been mended since
};

}  // namespace

const Adjacency& Prepared::adjacency(RunControl& control) {
  if (!adjacency_)
    adjacency_ = std::make_unique<Adjacency>(surface.vertex_count(), surface.face_begin, surface.corners, control);
  return *adjacency_;
}

const FaceGeometries& Prepared::geometry(RunControl& control) {
  if (geometry_.empty()) geometry_ = face_geometry(surface, control);
  return geometry_;
}

const std::vector<VertexId>& Prepared::pinched(RunControl& control) {
  if (!pinched_) pinched_ = pinched_vertices(surface, adjacency(control), control);
  return *pinched_;
}

Prepared prepare(const PolygonMesh& input, const Options& options, const MendingLimits& limits, Report& report,
                 Stopwatch& watch, RunControl& control) {
  return Preparation(input, options, limits, report, control).run(watch);
}

}  // namespace remesh
