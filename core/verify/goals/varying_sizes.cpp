#include "core/verify/goals/varying_sizes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"

namespace remesh::verification {
namespace {

/// A bound on the relative error of a graded length, because boxes are stored in single precision.
constexpr double kSingle = 1e-5;

}  // namespace

VaryingSizes::Graded::Graded(std::vector<Segment> segments, const NumberedClaim& numbered, double slope,
                             RunControl& control)
    : slope_(slope), segments_(std::move(segments)) {
  Box3 box;
  for (std::size_t v = 0; v < numbered.surface_vertex_count; ++v) box.add(numbered.points[v]);
  centre_ = 0.5 * box.min + 0.5 * box.max;
  const auto entries = BoxTree<Length>::make_entries(segments_.size(), control, [&](std::size_t i, auto& entry) {
    const auto& [a, b, size] = segments_[i];
    entry.box.add(a - centre_);
    entry.box.add(b - centre_);
    entry.tag.value = size;
  });
  const auto offset = [&](Length length) { return offset_of_size(std::max(0.0, length.value), slope_); };
  tree_ = BoxTree<Length>(entries, control, Offsets<decltype(offset)>{offset});
}

bool VaryingSizes::Graded::is_too_long(double length, const Vec3& middle) const {
  const Vec3 p = middle - centre_;
  double best = length;
  tree_.search(
      best,
      [&](const BoxTree<Length>::Entry& entry) {
        return entry.tag.value + slope_ * std::sqrt(squared_distance(entry.box, p)) * (1 - kSingle);
      },
      [&](std::size_t slot) {
        const auto& [a, b, size] = segments_[tree_.number(slot)];
        const Vec3 nearest = nearest_on_segment(middle, a, b);
        if (size + slope_ * norm(nearest - middle) < length) best = -HUGE_VAL;
      });
  return best != length;
}

VaryingSizes::VaryingSizes(const Claim& claim, const NumberedClaim& numbered, const BoundaryGraph& input_seams,
                           const BoundaryGraph& output_seams, RunControl& control)
    : numbered_(numbered), proximity_(claim.refinement->goals.proximity), slope_(claim.refinement->goals.size_slope()) {
  if (proximity_ > 0) {
    facets_.emplace(claim, numbered, input_seams, control);
    return;
  }
  std::vector<Segment> lines, pieces;
  const auto add = [&](std::vector<Segment>& to, VertexId low, VertexId high) {
    const Vec3 a = numbered.output_point(low), b = numbered.output_point(high);
    to.push_back({a, b, norm(b - a)});
  };
  // Where a curve was cut anew, the result does not show which of its vertices existed before refinement, and so how
  // long the pieces were. Then the size that such a curve requires is not certain. Its possible pieces are its edges,
  // and a piece that was cut further is no farther from these edges than they are long.
  StopCheck check(control);
  for (const Edge& edge : output_seams.edges()) {
    check();
    if (!numbered.is_any_curved(edge.uses)) continue;
    add(pieces, edge.low, edge.high);
    pieces.back().size *= -slope_;
  }
  StraightLines(numbered, output_seams, control)
      .for_each_line([&](VertexId low, VertexId high, std::span<const Use> uses) {
        if (!numbered.is_any_curved(uses)) add(lines, low, high);
      });
  // These pieces run between vertices of the input. They may be too short, because a new vertex may happen to have the
  // place of a dropped one.
  output_seams.for_each_chain(
      control, [&](VertexId v) { return output_seams.is_passage(v) && numbered.is_new(v); },
      [&](const Chain& chain, std::span<const VertexId>) {
        if (!numbered.is_any_curved(output_seams.edges()[chain.edge].uses)) add(pieces, chain.low, chain.high);
      },
      [](const Edge&, VertexId, Stray) {});
  lines_ = Graded(std::move(lines), numbered, slope_, control);
  pieces_ = Graded(std::move(pieces), numbered, slope_, control);
}

bool VaryingSizes::is_missed_clearly(std::uint32_t f) const { return is_missed(f, GapCheck::Doubt::kIsNone); }
bool VaryingSizes::may_be_missed(std::uint32_t f) const { return is_missed(f, GapCheck::Doubt::kCounts); }

bool VaryingSizes::is_missed(std::uint32_t f, GapCheck::Doubt doubt) const {
  const bool must_be_clear = doubt == GapCheck::Doubt::kIsNone;
  const double slack = Goals::kSizeSlack * (must_be_clear ? kClearly : 1 / kClearly);
  const auto corner = numbered_.output.face(f);
  std::array<Vec3, 3> middle;
  std::array<double, 3> length{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = numbered_.output_point(corner[k]), b = numbered_.output_point(corner[(k + 1) % 3]);
    middle[k] = 0.5 * (a + b);
    length[k] = norm(b - a);
  }
  if (!facets_) {
    const Graded& graded = must_be_clear ? lines_ : pieces_;
    for (std::size_t k = 0; k < 3; ++k)
      if (graded.is_too_long(length[k] / slack, middle[k])) return true;
    return false;
  }
  const PatchId patch = numbered_.output.patch[f];
  const auto is_missed_at = [&](const Vec3& place) {
    double size = 0;  // an edge is too long if the size here is smaller than this
    for (std::size_t k = 0; k < 3; ++k) size = std::max(size, length[k] / slack - slope_ * norm(middle[k] - place));
    // Both sides of the gap may be off the places for which sizes were made, by the tolerance.
    const double off = (must_be_clear ? -2 : 2) * numbered_.tolerance;
    return facets_->is_any_within(place, patch, size * proximity_ - numbered_.tolerance + off, doubt);
  };
  return is_missed_at((1.0 / 3) * (middle[0] + middle[1] + middle[2])) ||
         std::any_of(middle.begin(), middle.end(), is_missed_at);
}

}  // namespace remesh::verification
