#include "core/mending/polygons/mend_faces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <span>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/mending/polygons/degenerate_faces.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/mending/polygons/polygon_cuts.h"
#include "core/mending/polygons/polygon_spikes.h"
#include "core/mending/polygons/polygon_split.h"
#include "core/mesh/unused_vertices.h"

namespace remesh {
namespace {

/// Counts the faces that are mended, by their defects.
struct MendedFaces {
  Diagnostic repeated{DiagnosticCode::kDuplicateVertex,
                      0,
                      {},
                      "faces had a corner twice in a row, in the input or after welding, and now have it once; "
                      "`elements` lists these faces by number"};
  Diagnostic nonplanar{
      DiagnosticCode::kNonplanarPolygon,
      0,
      {},
      "polygons whose corners do not lie in one plane were triangulated; other triangles over the same "
      "corners would be another surface, and all distances in this report are from the triangles that "
      "were chosen"};
  Diagnostic crossing{
      DiagnosticCode::kNonplanarPolygon,
      0,
      {},
      "polygons cross themselves, so no triangulation of them is valid; they were cut into fans of triangles "
      "that overlap"};
  Diagnostic zero_area{DiagnosticCode::kZeroAreaFace,
                       0,
                       {},
                       "faces have no area; they were dropped, except those in patches with the status `kept`"};
  Diagnostic spiked{
      DiagnosticCode::kZeroAreaFace,
      0,
      {},
      "polygons have spikes, where the outline runs back over itself; the spikes have no area and were dropped"};

  /// All of them, in the order in which they are reported.
  std::array<Diagnostic*, 5> all() { return {&repeated, &nonplanar, &crossing, &zero_area, &spiked}; }
};

class Mending {
 public:
  Mending(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& keep_verbatim, MendMode degenerate,
          RunControl& control, double possible_rounding)
      : surface_(surface),
        plane_tolerance_(plane_tolerance),
        possible_rounding_(possible_rounding),
        keep_verbatim_(keep_verbatim),
        degenerate_(degenerate),
        control_(control) {
    if (degenerate == MendMode::kNo)
      counts_.zero_area.message =
          "faces have no area; those with three different corners were left, because `repair` does not include "
          "`degenerate`";
  }

  /// Drops repeated corners and faces without area, and makes no other change to polygons that have an area.
  bool clean(std::vector<Diagnostic>& diagnostics) {
    if (are_all([&](FaceId f) { return is_clean(f); })) return false;
    cleaned_.emplace();
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      check();
      take_face(FaceId(f));
    }
    if (counts_.repeated.count == 0 && counts_.zero_area.count == 0) return false;
    // The faces that stay are counted when the other faces are mended.
    counts_.zero_area.count = 0;
    counts_.zero_area.elements.clear();
    drop_marked();
    const std::vector<FaceId>& sources = *cleaned_;
    std::vector<std::uint8_t> is_left(sources.size(), 0);
    for (const FaceId source : surface_.face_source) {
      check();
      const auto at = std::lower_bound(sources.begin(), sources.end(), source);
      if (at != sources.end() && *at == source) is_left[static_cast<std::size_t>(at - sources.begin())] = 1;
    }
    for (std::size_t i = 0; i < is_left.size(); ++i)
      if (is_left[i] == 0) counts_.zero_area.add(sources[i].value);
    tell(diagnostics);
    return true;
  }

  bool run(std::vector<Diagnostic>& diagnostics) {
    const std::size_t faces = surface_.face_count();
    if (keep_verbatim_.empty() && are_all([&](FaceId f) { return is_sound(f); })) return false;
    is_degenerate_.reserve(faces);
    const double before = control_.told_fraction();
    // The other half of the progress is for the work after this loop.
    constexpr double kShare = 0.5;
    for (std::size_t f = 0; f < faces; ++f) {
      if (f % 4096 == 0)
        control_.progress(before + (1 - before) * kShare * (static_cast<double>(f) / static_cast<double>(faces)));
      take_face(FaceId(f));
    }
    cuts_.reset();
    drop_marked();
    tell(diagnostics);
    return true;
  }

 private:
  /// Gives the surface its new faces, without those that have no area.
  void drop_marked() {
    surface_.take_faces(std::move(mended_));
    if (degenerate_ == MendMode::kYes &&
        std::find(is_degenerate_.begin(), is_degenerate_.end(), 1) != is_degenerate_.end())
      drop_degenerate_faces(surface_, is_degenerate_, keep_verbatim_, control_);
    if (surface_.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kWeld, "no face of the mesh has an area");
    drop_unused_vertices(surface_, control_);
  }

  void tell(std::vector<Diagnostic>& diagnostics) {
    for (Diagnostic* d : counts_.all())
      if (d->count > 0) diagnostics.push_back(std::move(*d));
  }

  // Original coordinates, scaled exactly, so that a line of the input is a line here.
  Vec3 exact(VertexId v) const { return (1 / surface_.unit) * surface_.positions[v]; }

  bool are_collinear(std::span<const VertexId> loop) const {
    // All corners are tested against the first two, which are different points.
    for (std::size_t i = 2; i < loop.size(); ++i)
      if (!is_collinear(exact(loop[0]), exact(loop[1]), exact(loop[i]))) return false;
    return true;
  }

  /// Returns whether a face is a triangle with an area. Most faces are, and need no mending.
  bool is_sound(FaceId f) const { return surface_.face(f).size() == 3 && !is_without_area(surface_, f); }

  /// Returns whether a face has an area and no corner twice in a row. A polygon that runs back along itself is not
  /// clean, though it may have an area.
  bool is_clean(FaceId f) const {
    const auto loop = surface_.face(f);
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (loop[i] == loop[(i + 1) % loop.size()] || loop[i] == loop[(i + 2) % loop.size()]) return false;
    return !are_collinear(loop);
  }

  template <class Is>
  bool are_all(const Is& is) const {
    std::atomic<bool> are = true;
    for_blocks(surface_.face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end && are; ++f)
        if (!is(FaceId(f))) are = false;
    });
    return are;
  }

  void emit(std::span<const VertexId> loop, FaceId source, std::uint32_t label, bool is_degenerate) {
    mended_.add_face(loop, source, label);
    is_degenerate_.push_back(is_degenerate);
  }

  bool is_verbatim(FaceId source) const { return !keep_verbatim_.empty() && keep_verbatim_[source.value] != 0; }

  bool has_repeated_corner() {
    sorted_loop_ = loop_;
    std::sort(sorted_loop_.begin(), sorted_loop_.end());
    return std::adjacent_find(sorted_loop_.begin(), sorted_loop_.end()) != sorted_loop_.end();
  }

  /// Returns whether the loop vanishes if all edges are removed that the loop directly runs back along.
  bool cancels_itself() const {
    std::vector<VertexId> left;
    for (const VertexId v : loop_) {
      if (left.size() >= 2 && left[left.size() - 2] == v)
        left.pop_back();
      else
        left.push_back(v);
    }
    std::size_t first = 0, end = left.size();
    while (end - first >= 3) {  // also removes such edges across the loop's end
      if (left[first + 1] == left[end - 1]) {
        ++first;
        --end;
      } else if (left[end - 2] == left[first]) {
        end -= 2;
      } else {
        break;
      }
    }
    return end - first < 3;
  }

  void count_without_area(FaceId source) {
    counts_.zero_area.add(source.value);
    if (cleaned_) cleaned_->push_back(source);
  }

  void take_face(FaceId f) {
    const FaceId source = surface_.face_source[f];
    const std::uint32_t label = surface_.label(f);
    loop_.clear();
    for (const VertexId v : surface_.face(f))
      if (loop_.empty() || loop_.back() != v) loop_.push_back(v);
    while (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
    if (cancels_itself()) {  // dropping the face opens nothing
      count_without_area(source);
      return;
    }
    if (are_collinear(loop_)) {
      count_without_area(source);
      for (std::size_t i = 1; i + 1 < loop_.size(); ++i)
        emit_triangle({loop_[0], loop_[i], loop_[i + 1]}, source, label, true);
      return;
    }
    if (loop_.size() < surface_.face(f).size()) counts_.repeated.add(source.value);
    if (loop_.size() == 3 || cleaned_) {
      emit(loop_, source, label, false);
      return;
    }
    points_.clear();
    for (const VertexId v : loop_) points_.push_back(surface_.local[v]);
    PolygonSplit split = split_points();
    if (split.has_spikes()) {
      take_spikes(split, f, label);
      if (loop_.size() < 3) return;
      if (loop_.size() == 3) {
        emit_triangle({loop_[0], loop_[1], loop_[2]}, source, label, are_collinear(loop_));
        return;
      }
    }
    if (split.kind == PolygonKind::kSelfCrossing) {
      counts_.crossing.add(source.value);
    } else if (split.kind == PolygonKind::kNotPlanar) {
      counts_.nonplanar.add(source.value);
    } else if (!is_verbatim(source) && !has_repeated_corner()) {
      emit(loop_, source, label, false);
      return;
    }
    for (const PolygonCuts::Corners& triangle : cuts().cut(loop_, split))
      emit_triangle(triangle, source, label, are_collinear(triangle));
  }

  /// Splits the polygon in points_. If it crosses itself, no triangulation is right. But the reason may be a spike that
  /// was rounded further than is proven, so the polygon is split again with a larger tolerance for spikes.
  PolygonSplit split_points() {
    PolygonSplit split = split_polygon(points_, plane_tolerance_, control_);
    if (split.kind != PolygonKind::kSelfCrossing || possible_rounding_ <= plane_tolerance_) return split;
    PolygonSplit rounded = split_polygon(points_, {plane_tolerance_, possible_rounding_}, control_);
    const bool is_better = rounded.has_spikes() && rounded.kind != PolygonKind::kSelfCrossing;
    return is_better ? rounded : split;
  }

  PolygonCuts& cuts() {
    if (!cuts_) cuts_.emplace(surface_, control_);
    return *cuts_;
  }

  /// Takes the spikes off the loop, and adapts the split to the rest of the loop.
  void take_spikes(PolygonSplit& split, FaceId f, std::uint32_t label) {
    const FaceId source = surface_.face_source[f];
    const auto corners_of = [&](const std::array<std::uint32_t, 3>& needle) {
      return PolygonCuts::Corners{loop_[needle[0]], loop_[needle[1]], loop_[needle[2]]};
    };
    // Needles that are not exactly on a line are dropped if no other face shares an edge with any of them. Otherwise
    // all of them become faces.
    StopCheck check(control_);
    drops_needles_ = degenerate_ == MendMode::kYes && split.spike_tolerance > 0 &&
                     std::all_of(split.spikes.needles.begin(), split.spikes.needles.end(), [&](const auto& needle) {
                       check();
                       const PolygonCuts::Corners t = corners_of(needle);
                       return are_collinear(t) || is_missed_by_nobody(t, f);
                     });
    bool is_one_gone = false;
    for (const auto& needle : split.spikes.needles) {
      check();
      if (take_needle(corners_of(needle), split.spike_tolerance, source, label)) is_one_gone = true;
    }
    if (is_one_gone) counts_.spiked.add(source.value);
    const std::vector<std::uint32_t>& outline = split.spikes.outline;
    for (auto& triangle : split.triangles)
      for (std::uint32_t& corner : triangle)
        corner = static_cast<std::uint32_t>(std::lower_bound(outline.begin(), outline.end(), corner) - outline.begin());
    for (std::size_t i = 0; i < outline.size(); ++i) loop_[i] = loop_[outline[i]];
    loop_.resize(outline.size());
  }

  /// Returns whether no other face shares the sides of a needle.
  bool is_missed_by_nobody(const PolygonCuts::Corners& t, FaceId f) {
    return !cuts().is_of_others(t[0], t[1], f) && !cuts().is_of_others(t[1], t[2], f);
  }

  /// Handles a triangle that was cut off a polygon. If it is exactly on a line, it is a face without area like any
  /// other. If it is on a line only in local units, it stays.
  /// Returns: whether the triangle is dropped, now or later as a face without area.
  bool take_needle(const PolygonCuts::Corners& t, double tolerance, FaceId source, std::uint32_t label) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
    const bool is_degenerate = are_collinear(t);
    const bool is_dropped = !is_degenerate && drops_needles_ &&
                            is_needle(surface_.local[t[0]], surface_.local[t[1]], surface_.local[t[2]], tolerance);
    if (!is_dropped) emit_triangle(t, source, label, is_degenerate);
    return is_dropped || (is_degenerate && degenerate_ == MendMode::kYes);
  }

  /// Emits a triangle, unless it has a repeated corner; the edges of such a triangle cancel each other.
  void emit_triangle(const std::array<VertexId, 3>& t, FaceId source, std::uint32_t label, bool is_degenerate) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) emit(t, source, label, is_degenerate);
  }

  Surface& surface_;
  double plane_tolerance_;
  double possible_rounding_;
  const std::vector<std::uint8_t>& keep_verbatim_;
  MendMode degenerate_;
  RunControl& control_;
  /// The input faces in which clean() has found faces without an area, ascending. clean() leaves polygons with an area
  /// as they are only in these input faces.
  std::optional<std::vector<FaceId>> cleaned_;
  std::optional<PolygonCuts> cuts_;
  FaceList mended_;
  std::vector<std::uint8_t> is_degenerate_;
  std::vector<VertexId> loop_, sorted_loop_;
  /// True if needles of the current polygon that are not exactly on a line are dropped.
  bool drops_needles_ = false;
  std::vector<Vec3> points_;
  MendedFaces counts_;
};

}  // namespace

bool clean_faces(Surface& surface, const std::vector<std::uint8_t>& keep_verbatim, MendMode degenerate,
                 std::vector<Diagnostic>& diagnostics, RunControl& control) {
  return Mending(surface, 0, keep_verbatim, degenerate, control, 0).clean(diagnostics);
}

bool mend_faces(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& keep_verbatim,
                MendMode degenerate, std::vector<Diagnostic>& diagnostics, RunControl& control,
                double possible_rounding) {
  return Mending(surface, plane_tolerance, keep_verbatim, degenerate, control, possible_rounding).run(diagnostics);
}

}  // namespace remesh
