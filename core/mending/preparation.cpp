#include "core/mending/preparation.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "core/base/diagnostic.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/mending/bending_noise.h"
#include "core/mending/cracks.h"
#include "core/mending/duplicate_faces.h"
#include "core/mending/input_defects.h"
#include "core/mending/mend_faces.h"
#include "core/mending/seams.h"
#include "core/mending/t_junctions.h"
#include "core/mending/triangulated.h"
#include "core/mending/weld.h"
#include "core/mending/winding.h"
#include "core/mesh/pinched_vertices.h"
#include "core/mesh/quality.h"
#include "core/mesh/statistics.h"

namespace remesh {
namespace {

class Preparation {
 public:
  Preparation(const PolygonMesh& input, const Options& options, const MendingLimits& limits, InputSummary& summary,
              RunControl& control)
      : input_(input), options_(options), limits_(limits), summary_(summary), control_(control) {}

  Prepared run(Stopwatch& watch) {
    // Vertices with equal coordinates, or nearly equal ones, become one.
    watch.enter(Stage::kWeld);
    surface() = weld(input_, options_.barriers, summary_.diagnostics, control_, options_.weld_tolerance);
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
    // Local units are about as large as the diagonal. The spikes of a mesh of full doubles are no part of its area.
    const Triangulated triangles(surface(), control_, kToleranceFloor);
    summary_.statistics =
        measure_surface(positions, surface().face_begin, surface().corners, adjacency(), triangles.corners(), control_);
    const double unit = surface().unit;
    if (triangles.excess_area() > 0) summary_.statistics.area -= triangles.excess_area() * unit * unit;
    summary_.statistics.vertices = input_.vertex_count();
    summary_.statistics.faces = input_.face_count();
    find_defects(surface(), adjacency(), prepared_.pinched(control_), summary_.diagnostics, control_);
  }

  void choose_tolerance() {
    const Rounding rounding = rounding_of(surface().positions.items(), control_);
    summary_.rounding_step = rounding.step();
    summary_.plane_tolerance_is_automatic = !options_.plane_tolerance.has_value();
    const double automatic = automatic_tolerance_of(rounding);
    summary_.plane_tolerance = options_.plane_tolerance.value_or(automatic);
    rounding_ = automatic;
    spike_rounding_ = std::min(kToleranceSteps * rounding.possible_step(),
                               kToleranceCeiling * summary_.statistics.bounding_box.diagonal());
    // Who asks for more than the digits explain wants to flatten what bends by more, too.
    const bool are_digits_noise = rounding.is_decimal && automatic == kToleranceSteps * rounding.possible_step();
    if (are_digits_noise && summary_.plane_tolerance <= automatic) prepared_.printed_steps = rounding.possible_steps;
  }

  /// The diagonal of the bounding box of all faces with an area. A face without one may have a corner anywhere, which
  /// says nothing about how large the model is.
  double diagonal_of_faces() {
    if (summary_.statistics.quality.min_angle_deg > 0) return summary_.statistics.bounding_box.diagonal();
    const FaceGeometries& of_face = prepared_.geometry(control_);
    Box3 box;
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < surface().face_count(); ++f) {
      check();
      if (!(of_face[FaceId(f)].area > 0)) continue;
      for (const VertexId v : surface().face(FaceId(f))) box.add(surface().positions[v]);
    }
    return box.is_empty() ? summary_.statistics.bounding_box.diagonal() : box.diagonal();
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
    summary_.diagnostics.push_back(
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
    const double tolerance = summary_.plane_tolerance / surface().unit;
    std::vector<Diagnostic>& found = summary_.diagnostics;
    const auto if_changed = [&](bool is_changed) {
      control_.check();
      if (!is_changed) return;
      prepared_.release();
      is_as_measured_ = false;
    };
    // Faces that repeat others go.
    const std::size_t place = found.size();
    std::vector<Diagnostic> repeated;
    const bool is_repeated =
        drop_duplicate_faces(surface(), adjacency(), input_.labels, mend_if(repair.duplicates), repeated, control_);
    if_changed(is_repeated);
    // Seams close, first where both sides have the same vertices: one body's seam may lie on another's edges, and would
    // be split there on one side only. Then edges are split at the vertices that lie on them, so that each edge of
    // other seams has its partner, and these close.
    Seams seams({std::min(rounding_, summary_.plane_tolerance) / surface().unit, repair.winding});
    const Mend mend_seams = mend_if(repair.seams && limits_.is_joining_allowed);
    const bool is_joined = mend_seams == Mend::kYes && seams.close(surface(), adjacency(), mend_seams, control_);
    if_changed(is_joined);
    const Mend mend_t_junctions = mend_if(repair.t_junctions && limits_.is_joining_allowed);
    bool is_split = split_at_vertices(tolerance, mend_t_junctions);
    if_changed(is_split);
    // Whoever welds vertices wants them on edges, too. The smaller tolerance comes first: it splits thin faces as well.
    if (const double near = options_.weld_tolerance / surface().unit;
        near > tolerance && mend_t_junctions == Mend::kYes) {
      const bool is_split_again = split_at_vertices(near, mend_t_junctions);
      if_changed(is_split_again);
      is_split = is_split || is_split_again;
    }
    const bool is_joined_again =
        (is_split || mend_seams == Mend::kNo) && seams.close(surface(), adjacency(), mend_seams, control_);
    if_changed(is_joined_again);
    seams.tell(found);
    // Faces over seams may repeat each other only now.
    if ((is_joined || is_joined_again) && repair.duplicates && drop_new_duplicates(repeated, is_repeated ? 1 : 0))
      if_changed(true);
    found.insert(found.begin() + static_cast<std::ptrdiff_t>(place), repeated.begin(), repeated.end());
    // Faces without a plane are split, faces without an area dropped; nothing opens.
    const bool is_mended =
        !are_clearly_sound() && mend_faces(surface(), tolerance, limits_.as_it_is, mend_if(repair.degenerate), found,
                                           control_, spike_rounding_ / surface().unit);
    if_changed(is_mended);
    if (is_mended) prepared_.without_area = faces_without_area(surface(), control_);
    // Neighbours look the same way, and closed shells the way they should if that is asked for.
    if_changed(unify_winding(surface(), adjacency(), mend_if(repair.winding), found, control_));
    if (!is_solid())
      if_changed(turn_inside_out(surface(), adjacency(), input_.labels, mend_if(repair.inside_out), found, control_));
  }

  bool split_at_vertices(double tolerance, Mend mend) {
    std::vector<Diagnostic> told;
    const bool is_changed =
        split_t_junctions(surface(), adjacency(), tolerance, limits_.as_it_is, mend, told, control_);
    for (Diagnostic& d : told) add_to(summary_.diagnostics, std::move(d));
    return is_changed;
  }

  /// Drops the faces that repeat others since seams have closed, if that opens nothing: parts of two copies may have
  /// become one, and others not.
  /// Input:   what was told of repeated faces before, of which the first `dropped` tell what is no longer there.
  /// Output:  whether the surface changed; `told` is what is to be told of both times then.
  bool drop_new_duplicates(std::vector<Diagnostic>& told, std::size_t dropped) {
    std::vector<Diagnostic> all, again;
    drop_duplicate_faces(surface(), adjacency(), input_.labels, Mend::kNo, all, control_);
    if (all.empty()) return false;
    Surface without = surface();
    if (!drop_duplicate_faces(without, adjacency(), input_.labels, Mend::kYes, again, control_)) return false;
    const Adjacency edges(without.vertex_count(), without.face_begin, without.corners, control_);
    if (edges.odd_edges().size() > adjacency().odd_edges().size()) return false;
    surface() = std::move(without);
    told.resize(dropped);
    for (Diagnostic& d : again) add_to(told, std::move(d));
    return true;
  }

  /// Adds what was found to one that tells of the same, or to the end.
  static void add_to(std::vector<Diagnostic>& diagnostics, Diagnostic&& found) {
    const auto same = std::find_if(diagnostics.begin(), diagnostics.end(),
                                   [&](const Diagnostic& d) { return d.message == found.message; });
    if (same == diagnostics.end()) return diagnostics.push_back(std::move(found));
    const std::uint64_t count = same->count + found.count;
    for (const std::uint64_t element : found.elements) same->add(element);
    same->count = count;
  }

  /// Adds to what is told of open edges how wide the cracks are that mending has left.
  void tell_cracks() {
    std::vector<Diagnostic>& found = summary_.diagnostics;
    const auto open = std::find_if(found.begin(), found.end(),
                                   [](const Diagnostic& d) { return d.code == DiagnosticCode::kOpenBoundary; });
    if (open == found.end()) return;
    const CrackRules rules{std::min(rounding_, summary_.plane_tolerance), summary_.plane_tolerance};
    open->message += describe_cracks(find_cracks(surface(), adjacency(), rules.rounding, control_), input_, options_,
                                     rules, control_);
  }

  /// Are all faces triangles, and their angles so far from 0 that the measures show what mend_faces would prove of one
  /// after the other? The sides of an angle are differences of two doubles: right to some 1e-16 of themselves, where
  /// they are not too small for a double.
  bool are_clearly_sound() {
    constexpr double kClearAngle = 1e-6, kClearLength = 1e-100;
    const Quality& measured = summary_.statistics.quality;
    return is_as_measured_ && limits_.as_it_is.empty() && adjacency().are_triangles() &&
           measured.min_angle_deg > kClearAngle &&
           measured.edge_length.min > kClearLength * summary_.statistics.bounding_box.diagonal();
  }

  /// Is it closed, of one piece and clearly of positive volume? Then nothing of it is inside out.
  bool is_solid() {
    constexpr double kClearly = 1e-9;
    const MeshStatistics& input = summary_.statistics;
    return is_as_measured_ && input.components == 1 && input.volume &&
           *input.volume > kClearly * input.area * input.bounding_box.diagonal() && prepared_.pinched(control_).empty();
  }

  const PolygonMesh& input_;
  const Options& options_;
  const MendingLimits& limits_;
  InputSummary& summary_;
  RunControl& control_;
  Prepared prepared_;
  double rounding_ = 0;         ///< model units: how far the rounding of coordinates may move a point
  double spike_rounding_ = 0;   ///< model units: the same, by the step that the digits allow without proof
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

Prepared prepare(const PolygonMesh& input, const Options& options, const MendingLimits& limits, InputSummary& summary,
                 Stopwatch& watch, RunControl& control) {
  return Preparation(input, options, limits, summary, control).run(watch);
}

}  // namespace remesh
