#include "core/mending/mend_faces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <span>

#include "core/base/blocks.h"
#include "core/base/parallel.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/predicates.h"
#include "core/mending/polygon_cuts.h"
#include "core/mending/polygon_spikes.h"
#include "core/mending/polygon_split.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/unused_vertices.h"

namespace remesh {
namespace {

/// Loops with a few nanoseconds per item check for cancellation once in this many items.
constexpr std::uint32_t kBetweenChecks = 1 << 14;

class Mending {
 public:
  Mending(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& as_it_is, Mend degenerate,
          RunControl& control, double possible_rounding)
      : surface_(surface),
        plane_tolerance_(plane_tolerance),
        possible_rounding_(possible_rounding),
        as_it_is_(as_it_is),
        degenerate_(degenerate),
        control_(control) {}

  bool run(std::vector<Diagnostic>& diagnostics) {
    const std::size_t faces = surface_.face_count();
    if (as_it_is_.empty() && are_all_sound()) return false;
    is_degenerate_.reserve(faces);
    for (std::size_t f = 0; f < faces; ++f) {
      if (f % 4096 == 0) control_.progress(static_cast<double>(f) / static_cast<double>(faces));
      take_face(FaceId(f));
    }
    cuts_.reset();
    surface_.take_faces(std::move(mended_));
    if (degenerate_ == Mend::kYes && std::find(is_degenerate_.begin(), is_degenerate_.end(), 1) != is_degenerate_.end())
      drop_degenerate();
    if (surface_.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kWeld, "no face of the mesh has an area");
    drop_unused_vertices(surface_, control_);
    for (Diagnostic* d : {&repeated_, &nonplanar_, &crossing_, &zero_area_, &spiked_})
      if (d->count > 0) diagnostics.push_back(std::move(*d));
    return true;
  }

 private:
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

  bool are_all_sound() const {
    std::atomic<bool> are_sound = true;
    for_blocks(surface_.face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end && are_sound; ++f)
        if (!is_sound(FaceId(f))) are_sound = false;
    });
    return are_sound;
  }

  void emit(std::span<const VertexId> loop, FaceId source, std::uint32_t label, bool is_degenerate) {
    mended_.add_face(loop, source, label);
    is_degenerate_.push_back(is_degenerate);
  }

  bool is_as_it_is(FaceId source) const { return !as_it_is_.empty() && as_it_is_[source.value] != 0; }

  bool has_repeated_corner() {
    sorted_loop_ = loop_;
    std::sort(sorted_loop_.begin(), sorted_loop_.end());
    return std::adjacent_find(sorted_loop_.begin(), sorted_loop_.end()) != sorted_loop_.end();
  }

  /// Returns whether nothing is left of the loop after every edge is removed that the loop runs back along directly.
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

  void take_face(FaceId f) {
    const FaceId source = surface_.face_source[f];
    const std::uint32_t label = surface_.label(f);
    loop_.clear();
    for (const VertexId v : surface_.face(f))
      if (loop_.empty() || loop_.back() != v) loop_.push_back(v);
    while (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
    if (cancels_itself()) {  // dropping the face opens nothing
      zero_area_.add(source.value);
      return;
    }
    if (are_collinear(loop_)) {
      zero_area_.add(source.value);
      for (std::size_t i = 1; i + 1 < loop_.size(); ++i)
        emit_triangle({loop_[0], loop_[i], loop_[i + 1]}, source, label, true);
      return;
    }
    if (loop_.size() < surface_.face(f).size()) repeated_.add(source.value);
    if (loop_.size() == 3) {
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
      crossing_.add(source.value);
    } else if (split.kind == PolygonKind::kNotPlanar) {
      nonplanar_.add(source.value);
    } else if (!is_as_it_is(source) && !has_repeated_corner()) {
      emit(loop_, source, label, false);
      return;
    }
    for (const PolygonCuts::Corners& triangle : cuts().cut(loop_, split))
      emit_triangle(triangle, source, label, are_collinear(triangle));
  }

  /// Splits the polygon in points_. If it crosses itself, no triangulation is right. But it may cross itself only
  /// because a spike was rounded further than is proven, so it is split again with a larger tolerance for spikes.
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
    drops_needles_ = degenerate_ == Mend::kYes && split.spike_tolerance > 0 &&
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
    if (is_one_gone) spiked_.add(source.value);
    const std::vector<std::uint32_t>& outline = split.spikes.outline;
    for (auto& triangle : split.triangles)
      for (std::uint32_t& corner : triangle)
        corner = static_cast<std::uint32_t>(std::lower_bound(outline.begin(), outline.end(), corner) - outline.begin());
    for (std::size_t i = 0; i < outline.size(); ++i) loop_[i] = loop_[outline[i]];
    loop_.resize(outline.size());
  }

  /// Returns whether no other face is at the sides of a needle.
  bool is_missed_by_nobody(const PolygonCuts::Corners& t, FaceId f) {
    return !cuts().is_of_others(t[0], t[1], f) && !cuts().is_of_others(t[1], t[2], f);
  }

  /// Handles a triangle that was cut off a polygon. If it is exactly on a line, it is a face without area like any
  /// other. If it is on a line only in local units, it stays.
  /// Returns: whether it is gone, or will go as a face without area.
  bool take_needle(const PolygonCuts::Corners& t, double tolerance, FaceId source, std::uint32_t label) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
    const bool is_degenerate = are_collinear(t);
    const bool is_dropped = !is_degenerate && drops_needles_ &&
                            is_needle(surface_.local[t[0]], surface_.local[t[1]], surface_.local[t[2]], tolerance);
    if (!is_dropped) emit_triangle(t, source, label, is_degenerate);
    return is_dropped || (is_degenerate && degenerate_ == Mend::kYes);
  }

  /// Emits a triangle, unless it has a repeated corner; the edges of such a triangle cancel each other.
  void emit_triangle(const std::array<VertexId, 3>& t, FaceId source, std::uint32_t label, bool is_degenerate) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) emit(t, source, label, is_degenerate);
  }

  /// Drops zero-area faces. Those that share edges lie on one line. Each such cluster hands its vertices to the faces
  /// around it.
  void drop_degenerate() {
    const Adjacency edges(surface_.vertex_count(), surface_.face_begin, surface_.corners, control_);
    UnionFind cluster(surface_.face_count());
    for (std::size_t e = 0; e < edges.edge_count(); ++e) {
      if (e % kBetweenChecks == 0) control_.check();
      std::uint32_t first = Adjacency::kNone;
      for (const std::uint32_t h : edges.half_edges(EdgeId(e))) {
        const std::uint32_t f = edges.face_of(h).value;
        if (!is_degenerate_[f]) continue;
        if (first != Adjacency::kNone) cluster.join(first, f);
        first = f;
      }
    }
    // The vertices of each cluster along its line. For collinear points, the lexicographic order is the order along the
    // line.
    std::vector<std::pair<std::uint32_t, VertexId>> on_line;
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (f % kBetweenChecks == 0) control_.check();
      if (is_degenerate_[f])
        for (const VertexId v : surface_.face(FaceId(f))) on_line.push_back({cluster.find(f), v});
    }
    const auto before = [&](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first < b.first;
      const Vec3 &p = surface_.positions[a.second], &q = surface_.positions[b.second];
      return p != q ? p < q : a.second < b.second;
    };
    sort_all(on_line.begin(), on_line.end(), [&](const auto& a, const auto& b) {
      control_.check();
      return before(a, b);
    });
    on_line.erase(std::unique(on_line.begin(), on_line.end()), on_line.end());

    // A cluster stays if it would hand a vertex to a face that must not get any.
    std::vector<std::uint8_t> stays(surface_.face_count(), 0);
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (f % kBetweenChecks == 0) control_.check();
      if (!is_as_it_is(surface_.face_source[FaceId(f)])) continue;
      for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h)
        if (const std::uint32_t line = cluster_beyond(edges, cluster, h); line != Adjacency::kNone) stays[line] = 1;
    }

    FaceList out;
    std::size_t inserted = 0;
    const std::size_t most = 4 * surface_.corners.size() + 1'000'000;
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (is_degenerate_[f] && !stays[cluster.find(f)]) continue;
      for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h) {
        if (h % kBetweenChecks == 0) control_.check();
        out.corners.push_back(surface_.corners[h]);
        const std::uint32_t line = cluster_beyond(edges, cluster, h);
        if (line == Adjacency::kNone || stays[line]) continue;
        const auto from = std::lower_bound(on_line.begin(), on_line.end(), std::pair{line, edges.from(h)}, before);
        const auto to = std::lower_bound(on_line.begin(), on_line.end(), std::pair{line, edges.to(h)}, before);
        inserted += static_cast<std::size_t>(std::abs(to - from));
        if (inserted > most)
          throw Error(Code::kInvalidMesh, Stage::kWeld, "zero-area faces nest too deeply to be mended")
              .at_element(surface_.face_source[FaceId(f)].value);
        if (from < to)
          for (auto it = from + 1; it < to; ++it) out.corners.push_back(it->second);
        else
          for (auto it = from; it-- > to + 1;) out.corners.push_back(it->second);
      }
      out.face_begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
      out.face_source.push_back(surface_.face_source[FaceId(f)]);
      if (!surface_.face_label.empty()) out.face_label.push_back(surface_.face_label[FaceId(f)]);
    }
    surface_.take_faces(std::move(out));
  }

  std::uint32_t cluster_beyond(const Adjacency& edges, UnionFind& cluster, std::uint32_t half_edge) const {
    for (const std::uint32_t h : edges.half_edges(edges.edge_of(half_edge)))
      if (is_degenerate_[edges.face_of(h).value]) return cluster.find(edges.face_of(h).value);
    return Adjacency::kNone;
  }

  Surface& surface_;
  double plane_tolerance_;
  double possible_rounding_;
  const std::vector<std::uint8_t>& as_it_is_;
  Mend degenerate_;
  RunControl& control_;
  std::optional<PolygonCuts> cuts_;
  FaceList mended_;
  std::vector<std::uint8_t> is_degenerate_;
  std::vector<VertexId> loop_, sorted_loop_;
  /// True if needles of the current polygon that are not exactly on a line are dropped.
  bool drops_needles_ = false;
  std::vector<Vec3> points_;
  Diagnostic repeated_{DiagnosticCode::kDuplicateVertex,
                       0,
                       {},
                       "faces had a corner twice in a row, in the input or after welding, and now have it once; "
                       "`elements` lists these faces by number"};
  Diagnostic nonplanar_{
      DiagnosticCode::kNonplanarPolygon, 0, {}, "polygons whose corners do not lie in one plane were triangulated"};
  Diagnostic crossing_{
      DiagnosticCode::kNonplanarPolygon,
      0,
      {},
      "polygons cross themselves, so no triangulation of them is valid; they were cut into fans of triangles "
      "that overlap"};
  Diagnostic zero_area_{DiagnosticCode::kZeroAreaFace,
                        0,
                        {},
                        "faces have no area; they were dropped, except those in patches with the status `kept`"};
  Diagnostic spiked_{
      DiagnosticCode::kZeroAreaFace,
      0,
      {},
      "polygons have spikes, where the outline runs back over itself; the spikes have no area and were dropped"};
};

}  // namespace

bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 && orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
         orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

bool is_without_area(const Surface& surface, FaceId f) {
  const auto loop = surface.face(f);
  // Original coordinates, scaled exactly, so that a line of the input is a line here.
  const auto exact = [&](int i) { return (1 / surface.unit) * surface.positions[loop[i]]; };
  return loop.size() == 3 && is_collinear(exact(0), exact(1), exact(2));
}

std::vector<FaceId> faces_without_area(const Surface& surface, RunControl& control) {
  return select_ids<FaceId>(surface.face_count(), kItemsPerBlock, control,
                            [&](std::size_t f) { return is_without_area(surface, FaceId(f)); });
}

bool mend_faces(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& as_it_is, Mend degenerate,
                std::vector<Diagnostic>& diagnostics, RunControl& control, double possible_rounding) {
  return Mending(surface, plane_tolerance, as_it_is, degenerate, control, possible_rounding).run(diagnostics);
}

}  // namespace remesh
