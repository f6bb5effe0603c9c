#include "core/geometry/self_intersections.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/geometry/pair_search.h"
#include "core/geometry/predicates_3d.h"
#include "core/geometry/triangle_intersection.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {
namespace {

/// Between two points of cancellation.
constexpr std::size_t kFacesBetweenChecks = 4096;

/// A vertex with more faces than this is a hub: the pairs around it are found by their directions from it.
constexpr std::uint32_t kMostAtVertex = 64;

/// Directions are rounded; their boxes are made wider by this.
constexpr double kDirectionMargin = 1e-12;

/// By its box; not a triangle that holds it.
constexpr std::array kWholeSphere{Vec3{-1, -1, -1}, Vec3{1, 1, 1}, Vec3{1, 1, 1}};

/// The hubs that all faces of a node have; invalid where there are fewer than three.
using Hubs = std::array<VertexId, 3>;

bool has(const Triangle& face, VertexId v) { return std::find(face.begin(), face.end(), v) != face.end(); }

Hubs common(const Hubs& a, const Hubs& b) {
  Hubs both;
  std::copy_if(a.begin(), a.end(), both.begin(),
               [&](VertexId v) { return v.is_valid() && std::find(b.begin(), b.end(), v) != b.end(); });
  return both;
}

class Search {
 public:
  Search(std::span<const Vec3> positions, std::span<const Triangle> faces, std::span<const std::uint32_t> pieces,
         std::size_t max_pairs, RunControl& control)
      : positions_(scaled_for_predicates(positions, control)),
        faces_(faces),
        pieces_(pieces),
        max_pairs_(max_pairs),
        control_(control) {}

  SelfIntersections run() {
    find_hubs();
    find_everywhere();
    for (std::size_t begin = 0; begin < at_hub_.size() && result_.is_complete;) {
      std::size_t end = begin + 1;
      while (end < at_hub_.size() && at_hub_[end].first == at_hub_[begin].first) ++end;
      find_at_hub(begin, end);
      begin = end;
    }
    if (!result_.is_complete) result_.pairs.resize(max_pairs_);
    std::sort(result_.pairs.begin(), result_.pairs.end());
    return std::move(result_);
  }

 private:
  void find_hubs() {
    std::vector<std::uint32_t> faces_at(positions_.size(), 0);
    for (const Triangle& face : faces_)
      for (const VertexId v : face) ++faces_at[v.value];
    if (std::none_of(faces_at.begin(), faces_at.end(), [](std::uint32_t n) { return n > kMostAtVertex; })) return;
    is_hub_.resize(positions_.size());
    for (std::size_t v = 0; v < faces_at.size(); ++v) is_hub_[v] = faces_at[v] > kMostAtVertex;
    for (std::uint32_t f = 0; f < faces_.size(); ++f)
      for (const VertexId v : hubs_of(FaceId(f)))
        if (v.is_valid()) at_hub_.push_back({v, FaceId(f)});
    std::sort(at_hub_.begin(), at_hub_.end());
    at_hub_.erase(std::unique(at_hub_.begin(), at_hub_.end()), at_hub_.end());
  }

  Hubs hubs_of(FaceId f) const {
    Hubs hubs;
    std::copy_if(faces_[f.value].begin(), faces_[f.value].end(), hubs.begin(),
                 [&](VertexId v) { return is_hub_[v.value] != 0; });
    return hubs;
  }

  /// The hub at which two faces are held against each other; none if they are to be, wherever their boxes meet.
  VertexId shared_hub(FaceId f, FaceId g) const {
    VertexId first;
    if (is_hub_.empty()) return first;
    for (const VertexId v : faces_[f.value])
      if (is_hub_[v.value] && has(faces_[g.value], v)) first = std::min(first, v);
    return first;
  }

  bool do_count(FaceId f, FaceId g) const {
    if (!pieces_.empty() && pieces_[f.value] == pieces_[g.value] && pieces_[f.value] != kNoPiece) return false;
    return do_intersect(faces_[f.value], faces_[g.value], positions_);
  }

  void find_everywhere() {
    static_assert(kNoPiece == TriangleTree::kNoGroup);
    const TriangleTree tree(positions_, faces_, control_, pieces_);
    std::vector<Hubs> hubs;
    if (!is_hub_.empty()) hubs = tree.joined<Hubs>([&](std::size_t slot) { return hubs_of(tree.face(slot)); }, common);
    // The piece of all faces of a node.
    std::vector<std::uint32_t> pieces;
    if (std::any_of(pieces_.begin(), pieces_.end(), [](std::uint32_t piece) { return piece != kNoPiece; }))
      pieces = tree.joined<std::uint32_t>([&](std::size_t slot) { return pieces_[tree.face(slot).value]; },
                                          [](std::uint32_t a, std::uint32_t b) { return a == b ? a : kNoPiece; });
    const auto face_of = [&](std::size_t slot) { return tree.face(slot); };
    find_pairs(
        {tree, positions_, faces_}, face_of,
        [&](std::size_t slot, std::size_t node) {
          if (!pieces.empty() && pieces[node] != kNoPiece && pieces[node] == pieces_[face_of(slot).value]) return true;
          const Triangle& face = faces_[face_of(slot).value];
          return !hubs.empty() && std::any_of(hubs[node].begin(), hubs[node].end(),
                                              [&](VertexId v) { return v.is_valid() && has(face, v); });
        },
        [&](std::size_t slot, std::size_t other) {
          const FaceId f = face_of(slot), g = face_of(other);
          return !shared_hub(f, g).is_valid() && do_count(f, g);
        },
        max_pairs_, result_, control_);
  }

  /// Seen from a hub its faces are arcs, and two of them meet elsewhere, too, only if these arcs do.
  void find_at_hub(std::size_t begin, std::size_t end) {
    const VertexId hub = at_hub_[begin].first;
    std::vector<Vec3> corners;
    std::vector<Triangle> arcs;
    bool are_wide = false;
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kFacesBetweenChecks == 0) control_.check();
      const auto arc = around_arc(hub, faces_[at_hub_[i].second.value]);
      are_wide = are_wide || !arc;
      for (const Vec3& corner : arc.value_or(kWholeSphere)) corners.push_back(corner);
      const std::size_t n = corners.size();
      arcs.push_back({VertexId(n - 3), VertexId(n - 2), VertexId(n - 1)});
    }
    const TriangleTree tree(corners, arcs, control_);
    const auto face_of = [&](std::size_t slot) { return at_hub_[begin + tree.face(slot).value].second; };
    find_pairs(
        {tree, corners, arcs, kDirectionMargin,
         are_wide ? SearchedTriangles::kByBoxes : SearchedTriangles::kByTriangles},
        face_of, [](std::size_t, std::size_t) { return false; },
        [&](std::size_t slot, std::size_t other) {
          const FaceId f = face_of(slot), g = face_of(other);
          return shared_hub(f, g) == hub && do_count(f, g);
        },
        max_pairs_, result_, control_);
  }

  /// A triangle of directions that holds the arc: its two ends and where the tangents there cross; none if that is far
  /// away.
  std::optional<std::array<Vec3, 3>> around_arc(VertexId hub, const Triangle& face) const {
    std::array<Vec3, 2> ends;
    std::size_t n = 0;
    for (const VertexId v : face)
      if (v != hub && n < 2) ends[n++] = normalized(positions_[v.value] - positions_[hub.value]);
    if (n == 1) ends[1] = ends[0];
    const Vec3 middle = 0.5 * (ends[0] + ends[1]);
    const double cosine_squared = norm_squared(middle);
    constexpr double kWide = 0.01;  // beyond some 168 degrees
    if (cosine_squared < kWide) return std::nullopt;
    return std::array{ends[0], ends[1], (1 / cosine_squared) * middle};
  }

  std::vector<Vec3> positions_;
  std::span<const Triangle> faces_;
  std::span<const std::uint32_t> pieces_;
  std::size_t max_pairs_;
  RunControl& control_;
  std::vector<std::uint8_t> is_hub_;                 ///< per vertex; empty if none is
  std::vector<std::pair<VertexId, FaceId>> at_hub_;  ///< sorted
  SelfIntersections result_;
};

}  // namespace

SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     std::span<const std::uint32_t> pieces, std::size_t max_pairs,
                                     RunControl& control) {
  return Search(positions, faces, pieces, max_pairs, control).run();
}

}  // namespace remesh
