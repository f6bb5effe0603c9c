#include "core/verify/height_measure.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/verify/exact.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kCheckEvery = 4096;

/// An edge from left to right, with a triangle above it.
struct LowerEdge {
  Vec2 left, right;
  std::uint32_t face;
};

/// A vertex to be measured: plane coordinates and height.
struct Probe {
  Vec2 at;
  double height;
};

/// From below to above, among edges that some vertical line meets. They do not cross, for they belong to one
/// triangulation; in a false one the order may be false, and probes then miss their triangle.
class Below {
 public:
  using is_transparent = void;
  explicit Below(double grid) : grid_(grid) {}

  bool operator()(const LowerEdge* a, const LowerEdge* b) const {
    if (a == b) return false;
    if (b->left.x < a->left.x) return side(*b, *a) < 0;
    return side(*a, *b) > 0;
  }
  bool operator()(const Probe& p, const LowerEdge* e) const { return p.at.y < height_of(*e, p.at.x); }

 private:
  /// > 0: b, which begins no further left, is above a.
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
  HeightMeasure(const Model& model, std::size_t patch) : model_(model), frame_(model.frames[patch]), patch_(patch) {}

  double run(std::span<const std::uint8_t> is_on_boundary, RunControl& control) {
    collect_probes(is_on_boundary);
    collect_edges();
    Active active(Below(frame_.grid));
    std::vector<const LowerEdge*> by_right;
    for (const LowerEdge& e : edges_) by_right.push_back(&e);
    std::sort(by_right.begin(), by_right.end(),
              [](const LowerEdge* a, const LowerEdge* b) { return a->right.x < b->right.x; });

    std::size_t next_edge = 0, next_end = 0;
    const auto remove_ended = [&](double x, bool is_inclusive) {
      for (; next_end < by_right.size(); ++next_end) {
        const double right = by_right[next_end]->right.x;
        if (is_inclusive ? right > x : right >= x) return;
        active.erase(by_right[next_end]);
      }
    };
    const auto insert_before = [&](double x, bool is_inclusive) {
      for (; next_edge < edges_.size(); ++next_edge) {
        const LowerEdge& e = edges_[next_edge];
        if (is_inclusive ? e.left.x > x : e.left.x >= x) return;
        // Those that end where this one begins go first: only edges over a common line have an order.
        remove_ended(e.left.x, true);
        active.insert(&e);
      }
    };
    double largest = 0;
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      if (i % kCheckEvery == 0) control.check();
      const Probe& probe = probes_[i];
      // On a vertical line of the triangulation, the triangles on its left are asked first, then those on its right.
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

  void collect_probes(std::span<const std::uint8_t> is_on_boundary) {
    std::vector<VertexId> gone;
    for (const std::uint32_t f : model_.input_by_patch[patch_])
      for (const VertexId v : model_.input.face(f))
        if (!model_.is_kept[v.value] && !is_on_boundary[v.value]) gone.push_back(v);
    std::sort(gone.begin(), gone.end());
    gone.erase(std::unique(gone.begin(), gone.end()), gone.end());
    for (const VertexId v : gone) {
      const Vec3 d = model_.points[v.value] - frame_.origin;
      probes_.push_back({{dot(d, frame_.x_axis) / frame_.scale, dot(d, frame_.y_axis) / frame_.scale}, height(v)});
    }
    std::sort(probes_.begin(), probes_.end(), [](const Probe& a, const Probe& b) { return a.at < b.at; });
  }

  void collect_edges() {
    for (const std::uint32_t f : model_.output_by_patch[patch_])
      for (std::uint32_t i = 0; i < 3; ++i) {
        const Vec2 from = model_.corner_uv[3 * f + i], to = model_.corner_uv[3 * f + (i + 1) % 3];
        if (from.x < to.x) edges_.push_back({from, to, f});
      }
    std::sort(edges_.begin(), edges_.end(), [](const LowerEdge& a, const LowerEdge& b) {
      return a.left != b.left ? a.left < b.left : a.right < b.right;
    });
  }

  double height(VertexId v) const { return dot(model_.points[v.value] - frame_.origin, frame_.normal); }

  /// Height difference to the triangle over the highest edge that is not above the probe; infinity if it is not inside.
  double measure(const Active& active, const Probe& probe) const {
    const auto above = active.upper_bound(probe);
    if (above == active.begin()) return HUGE_VAL;
    const std::uint32_t f = (*std::prev(above))->face;
    const Vec2* uv = &model_.corner_uv[3 * f];
    const auto corners = model_.output.face(f);
    double weight[3], sum = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec2 side = uv[(i + 2) % 3] - uv[(i + 1) % 3];
      weight[i] = cross(side, probe.at - uv[(i + 1) % 3]);
      // Outside by more than the grid's rounding?
      if (weight[i] < -2 * (frame_.grid + 0x1p-50) * norm(side)) return HUGE_VAL;
      weight[i] = std::max(weight[i], 0.0);
      sum += weight[i];
    }
    double covered = 0;
    for (int i = 0; i < 3; ++i) covered += (sum > 0 ? weight[i] / sum : 1.0 / 3) * height(corners[i]);
    return std::fabs(probe.height - covered);
  }

  const Model& model_;
  const Frame& frame_;
  const std::size_t patch_;
  std::vector<Probe> probes_;     ///< from left to right
  std::vector<LowerEdge> edges_;  ///< by their left end
};

}  // namespace

double largest_height_difference(const Model& model, std::size_t patch, std::span<const std::uint8_t> is_on_boundary,
                                 RunControl& control) {
  return HeightMeasure(model, patch).run(is_on_boundary, control);
}

}  // namespace remesh::verification
