#include "core/verify/detail_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

using VertexPair = std::pair<VertexId, VertexId>;

class DetailProof {
 public:
  DetailProof(const DetailClaim& claim, RunControl& control) : claim_(claim), control_(control) {}

  std::optional<double> run() {
    if (!is_well_formed()) return {};
    place_points();
    if (!do_pieces_cover() || !do_images_fit()) return {};
    std::vector<Triangle> not_anchored;
    for (const Triangle& t : claim_.faces_before)
      if (!is_anchored(t[0])) not_anchored.push_back(t);
    const Shape before = shape_of(claim_.positions_before.size(), not_anchored);
    const Shape after = shape_of(claim_.positions_after.size(), claim_.faces_after);
    if (after.euler > before.euler + count_closed_rims(before.open, after.open)) return {};
    double moved = 0;
    StopCheck check(control_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      check();
      moved = std::max(moved, norm(points_[i] - goal(VertexId(i))));
    }
    // Each cut is rounded a few times, and so is each measure. Coordinates are at most 1 here.
    return (moved + 0x1p-48) / scale_;
  }

 private:
  /// The edge of the first surface on which a point lies, and how far along it; the ends are invalid for a point inside
  /// a face.
  struct OnEdge {
    VertexId from, to;
    double at = 0;
  };

  VertexId image(VertexId point) const { return claim_.map.image[point]; }
  bool is_anchored(VertexId point) const { return !image(point).is_valid(); }
  /// Returns the anchor of a point that has one.
  const DetailMap::Anchor& anchor(VertexId point) const {
    return *std::lower_bound(claim_.map.anchors.begin(), claim_.map.anchors.end(), point,
                             [](const DetailMap::Anchor& a, VertexId v) { return a.vertex < v; });
  }
  /// Returns the place to which a point goes.
  Vec3 goal(VertexId point) const {
    if (!is_anchored(point)) return scale_ * claim_.positions_after[image(point).value];
    const DetailMap::Anchor& to = anchor(point);
    Vec3 place;
    for (std::size_t k = 0; k < 3; ++k)
      place += to.weights[k] * (scale_ * claim_.positions_after[claim_.faces_after[to.face.value][k].value]);
    return place;
  }
  bool have_one_anchor(VertexId a, VertexId b) const {
    return is_anchored(a) && is_anchored(b) && anchor(a).face == anchor(b).face &&
           anchor(a).weights == anchor(b).weights;
  }
  std::size_t vertex_count() const { return claim_.positions_before.size(); }

  bool is_well_formed() const {
    const std::size_t points = vertex_count() + claim_.map.cuts.size();
    if (claim_.map.image.size() != points) return false;
    StopCheck check(control_);
    for (std::size_t i = 0; i < claim_.map.cuts.size(); ++i) {
      check();
      const DetailMap::Cut& cut = claim_.map.cuts[i];
      const std::size_t earlier = vertex_count() + i;
      if (cut.from.value >= earlier || cut.to.value >= earlier || !(cut.at > 0 && cut.at < 1)) return false;
    }
    std::size_t anchored = 0;
    for (const VertexId v : claim_.map.image) {
      anchored += v.is_valid() ? 0 : 1;
      if (v.is_valid() && v.value >= claim_.positions_after.size()) return false;
    }
    if (anchored != claim_.map.anchors.size() || !are_anchors_well_formed()) return false;
    const auto are_below = [&](const Triangle& t, std::size_t end) {
      return std::all_of(t.begin(), t.end(), [&](VertexId v) { return v.value < end; });
    };
    for (const DetailMap::Piece& piece : claim_.map.pieces) {
      check();
      if (!are_below(piece.corners, points) || piece.of.value >= claim_.faces_before.size()) return false;
    }
    const auto are_valid = [&](std::span<const Triangle> faces, std::size_t end) {
      return std::all_of(faces.begin(), faces.end(), [&](const Triangle& t) { return are_below(t, end); });
    };
    const auto are_finite = [](std::span<const Vec3> places) {
      return std::all_of(places.begin(), places.end(), [](const Vec3& p) { return is_finite(p); });
    };
    return are_valid(claim_.faces_before, vertex_count()) &&
           are_valid(claim_.faces_after, claim_.positions_after.size()) && are_finite(claim_.positions_before) &&
           are_finite(claim_.positions_after);
  }

  bool are_anchors_well_formed() const {
    StopCheck check(control_);
    for (std::size_t i = 0; i < claim_.map.anchors.size(); ++i) {
      check();
      const DetailMap::Anchor& a = claim_.map.anchors[i];
      if (i > 0 && !(claim_.map.anchors[i - 1].vertex < a.vertex)) return false;
      if (a.vertex.value >= vertex_count() || !is_anchored(a.vertex) || a.face.value >= claim_.faces_after.size())
        return false;
      const auto& [u, v, w] = a.weights;
      if (!(u >= 0 && v >= 0 && w >= 0 && std::fabs(u + v + w - 1) <= 0x1p-50)) return false;
    }
    return true;
  }

  void place_points() {
    double largest = 0;
    for (const std::span<const Vec3> places : {claim_.positions_before, claim_.positions_after})
      largest = std::max(largest, largest_coordinate(places, control_));
    if (largest > 0) scale_ = std::ldexp(1.0, -1 - std::ilogb(largest));
    StopCheck check(control_);
    for (const Vec3& p : claim_.positions_before) {
      check();
      points_.push_back(scale_ * p);
    }
    on_edge_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) on_edge_[i].from = on_edge_[i].to = VertexId(i);
    for (const DetailMap::Cut& cut : claim_.map.cuts) {
      check();
      points_.push_back(points_[cut.from.value] + cut.at * (points_[cut.to.value] - points_[cut.from.value]));
      on_edge_.push_back(between(cut));
    }
  }

  /// Finds the edge on which both ends of a cut lie.
  OnEdge between(const DetailMap::Cut& cut) const {
    const OnEdge a = on_edge_[cut.from.value], b = on_edge_[cut.to.value];
    // A vertex lies on all of its edges. The edge that counts here is the one to the other end.
    std::array<VertexId, 4> ends{a.from, a.to, b.from, b.to};
    std::sort(ends.begin(), ends.end());
    const auto last = std::unique(ends.begin(), ends.end());
    if (last - ends.begin() != 2 || !ends[1].is_valid()) return {};
    const auto along = [&](const OnEdge& p) {
      if (p.from == p.to) return p.from == ends[0] ? 0.0 : 1.0;
      return p.from == ends[0] ? p.at : 1 - p.at;
    };
    const double begin = along(a), end = along(b);
    return {ends[0], ends[1], begin + cut.at * (end - begin)};
  }

  bool do_pieces_cover() const {
    const std::vector<DetailMap::Piece>& pieces = claim_.map.pieces;
    std::size_t at = 0;
    StopCheck check(control_);
    std::vector<VertexPair> edges;
    for (std::size_t f = 0; f < claim_.faces_before.size(); ++f) {
      check();
      edges.clear();
      for (; at < pieces.size() && pieces[at].of == FaceId(f); ++at)
        for (std::size_t k = 0; k < 3; ++k) edges.push_back({pieces[at].corners[k], pieces[at].corners[(k + 1) % 3]});
      if (!is_outline(claim_.faces_before[f], edges)) return false;
    }
    return at == pieces.size();
  }

  /// Returns whether edges, after those in opposite directions have cancelled, run around a face once.
  bool is_outline(const Triangle& face, std::vector<VertexPair>& edges) const {
    std::sort(edges.begin(), edges.end());
    std::vector<VertexPair> left;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end] == edges[begin]) ++end;
      const auto opposite =
          std::equal_range(edges.begin(), edges.end(), VertexPair(edges[begin].second, edges[begin].first));
      const auto same = static_cast<std::ptrdiff_t>(end - begin), against = opposite.second - opposite.first;
      if (same - against > 1) return false;
      if (same - against == 1) left.push_back(edges[begin]);
    }
    std::size_t walked = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId from = face[k], to = face[(k + 1) % 3];
      VertexId at = from;
      double along = 0;
      do {
        const auto next = std::lower_bound(left.begin(), left.end(), VertexPair(at, VertexId(0)));
        if (next == left.end() || next->first != at || walked == left.size()) return false;
        ++walked;
        at = next->second;
        if (at == to) break;
        const OnEdge& place = on_edge_[at.value];
        const bool is_forward = place.from == from && place.to == to;
        if (!is_forward && !(place.from == to && place.to == from)) return false;
        const double reached = is_forward ? place.at : 1 - place.at;
        if (!(reached > along)) return false;
        along = reached;
      } while (true);
    }
    return walked == left.size();
  }

  bool do_images_fit() const {
    // Corners rotated so that the smallest one comes first: equal triangles in the same order are equal.
    const auto rotated = [](Triangle t) {
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      return t;
    };
    std::vector<Triangle> images, faces;
    std::vector<VertexPair> sides, edges;
    std::vector<std::uint8_t> is_used(claim_.positions_after.size(), 0);
    StopCheck check(control_);
    for (const Triangle& face : claim_.faces_after) {
      check();
      faces.push_back(rotated(face));
      for (std::size_t k = 0; k < 3; ++k) {
        is_used[face[k].value] = 1;
        edges.push_back(std::minmax(face[k], face[(k + 1) % 3]));
      }
    }
    for (const DetailMap::Piece& piece : claim_.map.pieces) {
      check();
      const auto& [a, b, c] = piece.corners;
      if (is_anchored(a) || is_anchored(b) || is_anchored(c)) {
        if (!have_one_anchor(a, b) || !have_one_anchor(a, c)) return false;
        continue;
      }
      const Triangle t{image(piece.corners[0]), image(piece.corners[1]), image(piece.corners[2])};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
        images.push_back(rotated(t));
        continue;
      }
      const auto [least, largest] = std::minmax_element(t.begin(), t.end());
      if (*least != *largest)
        sides.push_back({*least, *largest});
      else if (is_used[least->value] == 0)
        return false;
    }
    sort_stoppable(images.begin(), images.end(), control_);
    sort_stoppable(faces.begin(), faces.end(), control_);
    if (images != faces) return false;
    sort_stoppable(edges.begin(), edges.end(), control_);
    return std::all_of(sides.begin(), sides.end(),
                       [&](const VertexPair& side) { return std::binary_search(edges.begin(), edges.end(), side); });
  }

  struct Shape {
    std::int64_t euler;            ///< the number of vertices, minus that of edges, plus that of faces
    std::vector<VertexPair> open;  ///< the edges of one face
  };

  Shape shape_of(std::size_t vertices, std::span<const Triangle> faces) const {
    std::vector<VertexPair> edges;
    std::vector<std::uint8_t> is_used(vertices, 0);
    StopCheck check(control_);
    for (const Triangle& t : faces) {
      check();
      for (std::size_t k = 0; k < 3; ++k) {
        is_used[t[k].value] = 1;
        edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
      }
    }
    sort_stoppable(edges.begin(), edges.end(), control_);
    Shape shape{};
    std::int64_t count = 0;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end, ++count) {
      check();
      while (end < edges.size() && edges[end] == edges[begin]) ++end;
      if (end - begin == 1) shape.open.push_back(edges[begin]);
    }
    shape.euler = std::count(is_used.begin(), is_used.end(), 1) - count + static_cast<std::int64_t>(faces.size());
    return shape;
  }

  /// Counts the rims that are closed: rims of the first surface whose images have no vertex at an open edge. Rims with
  /// connected images count once.
  std::int64_t count_closed_rims(const std::vector<VertexPair>& before, const std::vector<VertexPair>& after) const {
    const std::size_t vertices = claim_.positions_after.size();
    std::vector<std::uint32_t> parent(vertices);
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](VertexId of) {
      std::uint32_t v = of.value;
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    StopCheck check(control_);
    for (const VertexPair& edge : before) {
      check();
      parent[root(image(edge.first))] = root(image(edge.second));
    }
    std::vector<std::uint8_t> is_rim(vertices, 0), is_open(vertices, 0);
    for (const VertexPair& edge : before) is_rim[root(image(edge.first))] = 1;
    for (const VertexPair& edge : after) is_open[root(edge.first)] = is_open[root(edge.second)] = 1;
    std::int64_t closed = 0;
    for (std::size_t v = 0; v < vertices; ++v) closed += is_rim[v] != 0 && is_open[v] == 0 ? 1 : 0;
    return closed;
  }

  const DetailClaim& claim_;
  RunControl& control_;
  double scale_ = 1;
  std::vector<Vec3> points_;
  std::vector<OnEdge> on_edge_;
};

}  // namespace

std::optional<double> prove_details(const DetailClaim& claim, RunControl& control) {
  return DetailProof(claim, control).run();
}

}  // namespace remesh
