#include "core/verify/patches/height_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "core/base/stoppable.h"
#include "core/verify/model/fixed_width_integers.h"

namespace remesh::verification {
namespace {

/// A point with its height over the plane.
struct Raised {
  Vec2 at;
  double height = 0;
};

/// A triangle over the plane.
using Facet = std::array<Raised, 3>;

/// An edge from left to right which has a triangle above it.
struct LowerEdge {
  Vec2 left, right;
  std::uint32_t facet;
};

/// Orders edges from bottom to top, among edges that some vertical line meets. They do not cross, because they belong
/// to one triangulation. If the triangulation is not valid, the order may be wrong, and probes then miss their
/// triangle.
class Below {
 public:
  using is_transparent = void;
  explicit Below(double grid) : grid_(grid) {}

  bool operator()(const LowerEdge* a, const LowerEdge* b) const {
    if (a == b) return false;
    if (b->left.x < a->left.x) return side(*b, *a) < 0;
    return side(*a, *b) > 0;
  }
  bool operator()(const Raised& p, const LowerEdge* e) const { return p.at.y < height_of(*e, p.at.x); }

 private:
  /// Output: positive if b, which begins no further left than a, is above a.
  int side(const LowerEdge& a, const LowerEdge& b) const {
    const int at_begin = orientation(a.left, a.right, b.left, grid_);
    return at_begin != 0 ? at_begin : orientation(a.left, a.right, b.right, grid_);
  }
  static double height_of(const LowerEdge& e, double x) {
    const double t = (x - e.left.x) / (e.right.x - e.left.x);
    return e.left.y + t * (e.right.y - e.left.y);
  }
  double grid_;
};

class HeightMeasure {
 public:
  /// Input:  triangles that turn counter-clockwise, with coordinates on the grid, and that meet as in a
  ///         triangulation.
  HeightMeasure(std::vector<Facet> facets, double grid, RunControl& control)
      : facets_(std::move(facets)), grid_(grid), control_(control) {
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < facets_.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        check();
        const Vec2 from = facets_[f][i].at, to = facets_[f][(i + 1) % 3].at;
        if (from.x < to.x) edges_.push_back({from, to, f});
      }
    sort_stoppable(edges_.begin(), edges_.end(), control_, [](const LowerEdge& a, const LowerEdge& b) {
      return a.left != b.left ? a.left < b.left : a.right < b.right;
    });
  }

  /// The largest difference of height.
  /// Output: infinity if one of the probes is over no facet.
  double run(std::vector<Raised> probes) const {
    sort_stoppable(probes.begin(), probes.end(), control_,
                   [](const Raised& a, const Raised& b) { return a.at < b.at; });
    Active active((Below(grid_)));
    std::vector<const LowerEdge*> by_right;
    for (const LowerEdge& e : edges_) by_right.push_back(&e);
    sort_stoppable(by_right.begin(), by_right.end(), control_,
                   [](const LowerEdge* a, const LowerEdge* b) { return a->right.x < b->right.x; });
    // Each edge that is inserted or removed costs a search among the active edges.
    StopCheck check(control_);

    std::size_t next_edge = 0, next_end = 0;
    const auto remove_ended = [&](double x, bool is_inclusive) {
      for (; next_end < by_right.size(); ++next_end) {
        check();
        const double right = by_right[next_end]->right.x;
        if (is_inclusive ? right > x : right >= x) return;
        active.erase(by_right[next_end]);
      }
    };
    const auto insert_before = [&](double x, bool is_inclusive) {
      for (; next_edge < edges_.size(); ++next_edge) {
        check();
        const LowerEdge& e = edges_[next_edge];
        if (is_inclusive ? e.left.x > x : e.left.x >= x) return;
        // Edges that end where this one begins are removed first, because only edges over a common vertical line have
        // an order.
        remove_ended(e.left.x, true);
        active.insert(&e);
      }
    };
    double largest = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      check();
      const Raised& probe = probes[i];
      // On a vertical line of the triangulation, the triangles on its left are tried first, then those on its right.
      insert_before(probe.at.x, false);
      remove_ended(probe.at.x, false);
      double difference = measure(active, probe);
      if (!std::isfinite(difference)) {
        remove_ended(probe.at.x, true);
        insert_before(probe.at.x, true);
        difference = measure(active, probe);
      }
      if (!std::isfinite(difference)) return difference;
      largest = std::max(largest, difference);
    }
    return largest;
  }

 private:
  using Active = std::set<const LowerEdge*, Below>;

  /// The height difference to the triangle over the highest edge that is not above the probe.
  /// Output: infinity if the probe is not inside that triangle.
  double measure(const Active& active, const Raised& probe) const {
    const auto above = active.upper_bound(probe);
    if (above == active.begin()) return HUGE_VAL;
    const Facet& facet = facets_[(*std::prev(above))->facet];
    double weight[3], sum = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec2 from = facet[(i + 1) % 3].at, side = facet[(i + 2) % 3].at - from;
      weight[i] = cross(side, probe.at - from);
      // A negative weight means that the probe is on the outer side of this edge of the triangle. The probe may be
      // there because coordinates are rounded to the grid. Only a probe that is further out than this rounding is
      // outside the triangle.
      if (weight[i] < -2 * (grid_ + 0x1p-50) * norm(side)) return HUGE_VAL;
      weight[i] = std::max(weight[i], 0.0);
      sum += weight[i];
    }
    double covered = 0;
    for (int i = 0; i < 3; ++i) covered += (sum > 0 ? weight[i] / sum : 1.0 / 3) * facet[i].height;
    return std::fabs(probe.height - covered);
  }

  std::vector<Facet> facets_;
  std::vector<LowerEdge> edges_;  ///< sorted by their left end
  double grid_;
  RunControl& control_;
};

Raised raise(const Frame& frame, const Vec3& point) {
  const Vec3 d = point - frame.origin;
  return {{dot(d, frame.x_axis) / frame.scale, dot(d, frame.y_axis) / frame.scale}, dot(d, frame.normal)};
}

/// The wanted vertices of some faces, each once.
template <class IsWanted>
std::vector<Raised> collect_probes(const NumberedClaim& numbered, const Frame& frame, const Faces& faces,
                                   std::span<const std::uint32_t> of_patch, const IsWanted& is_wanted,
                                   RunControl& control) {
  std::vector<VertexId> wanted;
  StopCheck check(control);
  for (const std::uint32_t f : of_patch)
    for (const VertexId v : faces.face(f)) {
      check();
      if (is_wanted(v)) wanted.push_back(v);
    }
  sort_unique(wanted, control);
  std::vector<Raised> probes;
  probes.reserve(wanted.size());
  for (const VertexId v : wanted) {
    check();
    probes.push_back(raise(frame, numbered.points[v.value]));
  }
  return probes;
}

}  // namespace

double largest_height_of_dropped(const NumberedClaim& numbered, std::size_t patch, const BoundaryGraph& input_seams,
                                 RunControl& control) {
  const Frame frame = numbered.frames[patch];
  std::vector<Facet> facets;
  StopCheck check(control);
  for (const std::uint32_t f : numbered.output_by_patch[patch]) {
    check();
    const auto face = numbered.output.face(f);
    Facet& facet = facets.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      facet[i] = {numbered.corner_uv[3 * f + i], raise(frame, numbered.output_point(face[i])).height};
  }
  return HeightMeasure(std::move(facets), frame.grid, control)
      .run(collect_probes(
          numbered, frame, numbered.input, numbered.input_by_patch[patch],
          [&](VertexId v) { return !numbered.is_in_output[v.value] && !input_seams.has(v); }, control));
}

double largest_height_of_new(const NumberedClaim& numbered, std::size_t patch, const BoundaryGraph& output_seams,
                             RunControl& control) {
  const Frame frame = numbered.frames[patch];
  // The input has no stored plane coordinates. They may lie slightly outside the frame's square.
  const auto to_grid = [&](Vec2 uv) {
    return Vec2{std::nearbyint(uv.x / frame.grid) * frame.grid, std::nearbyint(uv.y / frame.grid) * frame.grid};
  };
  const auto is_near = [](Vec2 uv) { return std::fabs(uv.x) < 2 && std::fabs(uv.y) < 2; };
  std::vector<Facet> facets;
  StopCheck check(control);
  for (const std::uint32_t f : numbered.input_by_patch[patch]) {
    check();
    const auto face = numbered.input.face(f);
    if (face.size() != 3) return HUGE_VAL;
    Facet& facet = facets.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      facet[i] = raise(frame, numbered.points[face[i].value]);
      facet[i].at = to_grid(facet[i].at);
      if (!is_near(facet[i].at)) return HUGE_VAL;
    }
    if (orientation(facet[0].at, facet[1].at, facet[2].at, frame.grid) <= 0) return HUGE_VAL;
  }
  return HeightMeasure(std::move(facets), frame.grid, control)
      .run(collect_probes(
          numbered, frame, numbered.output, numbered.output_by_patch[patch],
          [&](VertexId v) { return numbered.is_new(v) && !output_seams.has(v); }, control));
}

}  // namespace remesh::verification
