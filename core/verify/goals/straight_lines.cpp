#include "core/verify/goals/straight_lines.h"

#include <algorithm>

#include "core/base/stoppable.h"

namespace remesh::verification {
namespace {

/// True if v lies between a and b, to rounding.
bool is_between(const Vec3& v, const Vec3& a, const Vec3& b) {
  const Vec3 line = b - a, d = v - a;
  const double length = norm(line);
  const double reach = std::max({largest_coordinate(v), largest_coordinate(a), largest_coordinate(b)});
  // All three points may have been rounded.
  return length > 0 && norm(cross(line, d)) <= 3 * NumberedClaim::rounding(reach) * length && dot(d, line) > 0 &&
         dot(v - b, line) < 0;
}

}  // namespace

StraightLines::StraightLines(const NumberedClaim& numbered, const BoundaryGraph& seams, RunControl& control)
    : line_of_(numbered.points.size(), kNone) {
  const auto is_inner = [&](VertexId v) {
    if (!seams.is_passage(v)) return false;
    const auto [a, b] = seams.neighbours(v);
    // Where a curve was cut anew, its new vertices are bends.
    const bool is_on_line = numbered.is_new(v) && !numbered.is_any_curved(seams.uses_at(v));
    return is_on_line || is_between(numbered.output_point(v), numbered.output_point(a), numbered.output_point(b));
  };
  seams.for_each_chain(
      control, is_inner,
      [&](const Chain& chain, std::span<const VertexId> vertices) {
        const auto line = static_cast<std::uint32_t>(lines_.size());
        lines_.push_back({chain.low, chain.high, seams.edges()[chain.edge].uses});
        for (const VertexId v : vertices.subspan(1, vertices.size() - 2)) line_of_[v.value] = line;
        for (const Use& use : lines_.back().uses) {
          reaches_.push_back({chain.low, use.patch(), chain.high, line});
          reaches_.push_back({chain.high, use.patch(), chain.low, line});
        }
      },
      [](const Edge&, VertexId, Stray) {});
  sort_stoppable(reaches_.begin(), reaches_.end(), control);
}

std::span<const StraightLines::Reach> StraightLines::reaches(VertexId v, PatchId patch,
                                                             std::array<Reach, 2>& inner) const {
  if (const std::uint32_t line = line_of_[v.value]; line != kNone) {
    const auto& [low, high, uses] = lines_[line];
    if (!has_patch(uses, patch)) return {};
    inner = {Reach{v, patch, low, line}, Reach{v, patch, high, line}};
    return inner;
  }
  const auto before = [&](const Reach& r) { return std::pair(r.from, r.patch) < std::pair(v, patch); };
  const auto same = [&](const Reach& r) { return r.from == v && r.patch == patch; };
  const auto begin = std::partition_point(reaches_.begin(), reaches_.end(), before);
  return {begin, std::partition_point(begin, reaches_.end(), same)};
}

std::span<const StraightLines::Reach> StraightLines::towards(std::span<const Reach> reaches, VertexId end) {
  const auto begin =
      std::partition_point(reaches.begin(), reaches.end(), [end](const Reach& r) { return r.end < end; });
  return {begin, std::partition_point(begin, reaches.end(), [end](const Reach& r) { return r.end == end; })};
}

}  // namespace remesh::verification
