#include "core/mending/preparation.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/diagnostic.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/mending/edges/cracks.h"
#include "core/mending/edges/double_walls.h"
#include "core/mending/edges/holes.h"
#include "core/mending/edges/seams.h"
#include "core/mending/edges/t_junctions.h"
#include "core/mending/faces/duplicate_faces.h"
#include "core/mending/faces/input_defects.h"
#include "core/mending/faces/winding.h"
#include "core/mending/polygons/covered_polygons.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/mending/polygons/mend_faces.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mending/weld/bending_noise.h"
#include "core/mending/weld/weld.h"
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
    // Makes vertices with equal coordinates, or nearly equal ones, one vertex.
    watch.enter(Stage::kWeld);
    prepared_.change([&](Surface& surface) {
      surface = weld(input_, options_.barriers, summary_.diagnostics, control_, options_.weld_tolerance);
      return true;
    });
    control_.check();
    watch.enter(Stage::kQuality);
    measure();
    watch.enter(Stage::kWeld);
    choose_tolerance();
    mend();
    summary_.statistics.mended_euler = is_as_measured_ ? summary_.statistics.euler : euler();
    report_open_edges();
    return std::move(prepared_);
  }

 private:
  const Surface& surface() const { return prepared_.surface(); }
  const Adjacency& adjacency() { return prepared_.adjacency(control_); }

  void measure() {
    const auto& positions = surface().positions.items();
    // Local units are about as large as the diagonal. Spikes as thin as the rounding of full doubles do not count for
    // the area.
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
    // Facets of a curved surface may be rounded without a visible bend, and a few numbers do not prove the rounding.
    const double possible = kToleranceSteps * std::max(rounding.step(), rounding.possible_step());
    prepared_.rounding_tolerance = std::max(automatic, std::min(possible, kPossibleRounding * diagonal_of_faces()));
    prepared_.printed_step = std::max(rounding.step(), rounding.doubtful_step());
    spike_rounding_ = std::min(kToleranceSteps * rounding.possible_step(),
                               kToleranceCeiling * summary_.statistics.bounding_box.diagonal());
    // If the caller's tolerance is larger than the digits explain, the caller wants larger bends to be flattened, too.
    const bool are_digits_noise = rounding.is_decimal && automatic == kToleranceSteps * rounding.possible_step();
    if (are_digits_noise && summary_.plane_tolerance <= automatic) prepared_.printed_steps = rounding.possible_steps;
  }

  /// The diagonal of the bounding box of all faces with an area. A face without area may have a corner anywhere, which
  /// has nothing to do with the size of the model.
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
      report_cap(rounding, tolerance.explained, automatic);
    return automatic;
  }

  void report_cap(const Rounding& rounding, double explained, double automatic) {
    const std::string are = rounding.steps == rounding.possible_steps ? "are" : "may be";
    summary_.diagnostics.push_back(
        {DiagnosticCode::kRoundingCapped,
         1,
         {},
         "the coordinates " + are + " rounded to steps of " + number_text(rounding.possible_step()) +
             ", which would justify a plane_tolerance of " + number_text(explained) + "; " + number_text(automatic) +
             " was used, because the automatic value is at most 1e-4 of the bounding box's diagonal; faces bend by no "
             "more than this rounding explains, so one plane may have become several patches; plane_tolerance=" +
             number_text(explained) + " would make it one patch, but also flatten details of that size"});
  }

  void mend() {
    const Repair& repair = options_.repair;
    const double tolerance = summary_.plane_tolerance / surface().unit;
    std::vector<Diagnostic>& found = summary_.diagnostics;
    // Faces without area are dropped.
    if (repair.degenerate && !are_clearly_sound())
      change([&](Surface& s) { return clean_faces(s, limits_.keep_verbatim, MendMode::kYes, found, control_); });
    // Faces that repeat other faces are dropped.
    const std::size_t place = found.size();
    std::vector<Diagnostic> repeated;
    // Polygons become comparable with the triangles that lie over them.
    if (repair.duplicates && limits_.is_joining_allowed)
      change([&](Surface& s) { return cut_covered_polygons(s, adjacency(), tolerance, control_); });
    const bool is_repeated = change([&](Surface& s) {
      return drop_duplicate_faces(s, adjacency(), input_.labels, mend_if(repair.duplicates), repeated, control_);
    });
    // Seams are closed. Those whose two sides have the same vertices come first, because one body's seam may lie on
    // another body's edges, and would be split there on one side only. Then edges are split at the vertices that lie on
    // them, so that each edge of the other seams gets its partner, and these seams are closed.
    Seams seams({std::min(rounding_, summary_.plane_tolerance) / surface().unit, repair.winding});
    const MendMode mend_seams = mend_if(repair.seams && limits_.is_joining_allowed);
    const auto close_seams = [&](Surface& s) { return seams.close(s, adjacency(), mend_seams, control_); };
    const bool is_joined = mend_seams == MendMode::kYes && change(close_seams);
    const MendMode mend_t_junctions = mend_if(repair.t_junctions && limits_.is_joining_allowed);
    bool is_split = split_at_vertices(tolerance, mend_t_junctions);
    // If vertices are welded within a tolerance, vertices within it of an edge belong on that edge, too. The smaller
    // tolerance comes first, because it also splits thin faces.
    if (const double near = options_.weld_tolerance / surface().unit;
        near > tolerance && mend_t_junctions == MendMode::kYes) {
      const bool is_split_again = split_at_vertices(near, mend_t_junctions);
      is_split = is_split || is_split_again;
    }
    const bool is_joined_again = (is_split || mend_seams == MendMode::kNo) && change(close_seams);
    seams.report(found);
    // Faces on both sides of a seam, or of edges that were split, may repeat each other now, because only since then do
    // they have the same vertices.
    if ((is_joined || is_split || is_joined_again) && repair.duplicates)
      drop_new_duplicates(repeated, is_repeated ? 1 : 0);
    found.insert(found.begin() + static_cast<std::ptrdiff_t>(place), repeated.begin(), repeated.end());
    // Double walls get separate edges on each side.
    if (repair.duplicates && limits_.is_joining_allowed)
      change([&](Surface& s) {
        return part_double_walls(s, adjacency(), input_.labels, tolerance, limits_.keep_verbatim, control_);
      });
    // Faces without a plane are split, and faces without area are dropped. Neither opens the surface.
    std::vector<Diagnostic> mended;
    const bool is_mended = !are_clearly_sound() && change([&](Surface& s) {
      return mend_faces(s, tolerance, limits_.keep_verbatim, mend_if(repair.degenerate), mended, control_,
                        spike_rounding_ / s.unit);
    });
    for (Diagnostic& d : mended) add_to(found, std::move(d));
    if (is_mended) prepared_.without_area = faces_without_area(surface(), control_);
    // Neighbours get the same orientation. Closed shells get the right orientation if that is asked for.
    change([&](Surface& s) {
      return unify_winding(s, adjacency(), input_.labels, mend_if(repair.winding), found, control_);
    });
    const MendMode mend_holes = mend_if(repair.holes && limits_.is_joining_allowed);
    const HoleRules rules{mend_holes, options_.max_hole_edges, options_.defeature_size.value_or(0),
                          summary_.statistics.bounding_box.diagonal(), summary_.plane_tolerance};
    const bool are_closed = change(
        [&](Surface& s) { return close_holes(s, adjacency(), input_.labels, rules, found, holes_left_, control_); });
    if (repair.holes && !limits_.is_joining_allowed)
      holes_left_.text += "; none was closed, because the result with the new faces failed its own check";
    if (are_closed && !prepared_.without_area.empty()) prepared_.without_area = faces_without_area(surface(), control_);
    if (!is_solid())
      change([&](Surface& s) {
        return turn_inside_out(s, adjacency(), input_.labels, mend_if(repair.inside_out), found, control_);
      });
  }

  /// Changes the surface by one kind of mending. Returns whether it has changed.
  template <class Mending>
  bool change(const Mending& mending) {
    const bool is_changed = prepared_.change(mending);
    control_.check();
    if (is_changed) is_as_measured_ = false;
    return is_changed;
  }

  /// The Euler number of the surface as it is now.
  std::int64_t euler() {
    return static_cast<std::int64_t>(surface().vertex_count()) - static_cast<std::int64_t>(adjacency().edge_count()) +
           static_cast<std::int64_t>(surface().face_count());
  }

  bool split_at_vertices(double tolerance, MendMode mend) {
    std::vector<Diagnostic> told;
    const bool is_changed = change([&](Surface& s) {
      return split_t_junctions(s, adjacency(), tolerance, limits_.keep_verbatim, mend, told, control_);
    });
    for (Diagnostic& d : told) add_to(summary_.diagnostics, std::move(d));
    return is_changed;
  }

  /// Drops faces that repeat others since seams were closed, unless that would open the surface. It may do so if only
  /// some parts of two copies have become one.
  /// Input:   `told` has the diagnostics on repeated faces so far. The first `dropped` of them are on faces that were
  ///          dropped.
  /// Output:  if the surface changed, `told` has the diagnostics on both passes.
  void drop_new_duplicates(std::vector<Diagnostic>& told, std::size_t dropped) {
    std::vector<Diagnostic> all, again;
    prepared_.change(
        [&](Surface& s) { return drop_duplicate_faces(s, adjacency(), input_.labels, MendMode::kNo, all, control_); });
    if (all.empty()) return;
    Surface without = surface();
    if (!drop_duplicate_faces(without, adjacency(), input_.labels, MendMode::kYes, again, control_)) return;
    const Adjacency edges(without.vertex_count(), without.face_begin, without.corners, control_);
    if (edges.odd_edges().size() > adjacency().odd_edges().size()) return;
    change([&](Surface& s) {
      s = std::move(without);
      return true;
    });
    told.resize(dropped);
    for (Diagnostic& d : again) add_to(told, std::move(d));
  }

  /// Adds a finding to the diagnostic with the same message. If there is none, appends the finding to the list.
  static void add_to(std::vector<Diagnostic>& diagnostics, Diagnostic&& found) {
    const auto same = std::find_if(diagnostics.begin(), diagnostics.end(),
                                   [&](const Diagnostic& d) { return d.message == found.message; });
    if (same == diagnostics.end()) return diagnostics.push_back(std::move(found));
    const std::uint64_t count = same->count + found.count;
    for (const std::uint64_t element : found.elements) same->add(element);
    same->count = count;
  }

  /// Adds to the diagnostic on open edges which holes and cracks mending has left.
  void report_open_edges() {
    std::vector<Diagnostic>& found = summary_.diagnostics;
    const auto open = std::find_if(found.begin(), found.end(),
                                   [](const Diagnostic& d) { return d.code == DiagnosticCode::kOpenBoundary; });
    if (open == found.end()) return;
    open->add(holes_left_);
    const CrackRules rules{std::min(rounding_, summary_.plane_tolerance), summary_.plane_tolerance};
    open->add(describe_cracks(find_cracks(surface(), adjacency(), rules.rounding, control_), input_, options_, rules,
                              control_));
  }

  /// Returns whether all faces are triangles whose angles are so far from 0 that mend_faces would find nothing to do.
  /// The sides of an angle are differences of two doubles. They are right up to some 1e-16 of their lengths, unless
  /// they are too small for a double.
  bool are_clearly_sound() {
    constexpr double kClearAngle = 1e-6, kClearLength = 1e-100;
    const Quality& measured = summary_.statistics.quality;
    return is_as_measured_ && limits_.keep_verbatim.empty() && adjacency().are_triangles() &&
           measured.min_angle_deg > kClearAngle &&
           measured.edge_length.min > kClearLength * summary_.statistics.bounding_box.diagonal();
  }

  /// Returns whether the surface is closed, in one piece, and clearly of positive volume. Then nothing of it is inside
  /// out.
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
  Advice holes_left_;           ///< what is told about the open holes
  double rounding_ = 0;         ///< in model units; how far the rounding of coordinates may move a point
  double spike_rounding_ = 0;   ///< in model units; the same for the step that the digits allow without proof
  bool is_as_measured_ = true;  ///< nothing has been mended since the surface was measured
};

}  // namespace

const Adjacency& Prepared::adjacency(RunControl& control) {
  if (!derived_.adjacency)
    derived_.adjacency =
        std::make_unique<Adjacency>(surface_.vertex_count(), surface_.face_begin, surface_.corners, control);
  return *derived_.adjacency;
}

const FaceGeometries& Prepared::geometry(RunControl& control) {
  if (derived_.geometry.empty()) derived_.geometry = face_geometry(surface_, control);
  return derived_.geometry;
}

const std::vector<VertexId>& Prepared::pinched(RunControl& control) {
  if (!derived_.pinched) derived_.pinched = pinched_vertices(surface_, adjacency(control), control);
  return *derived_.pinched;
}

Prepared prepare(const PolygonMesh& input, const Options& options, const MendingLimits& limits, InputSummary& summary,
                 Stopwatch& watch, RunControl& control) {
  return Preparation(input, options, limits, summary, control).run(watch);
}

}  // namespace remesh
