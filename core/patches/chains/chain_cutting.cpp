#include "core/patches/chains/chain_cutting.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/geometry/surfaces/section_curve.h"
#include "core/geometry/triangles/distances.h"
#include "core/patches/chains/chain_sections.h"
#include "core/patches/chains/chain_thinning.h"
#include "core/patches/charts/curved_chart.h"

namespace remesh {
namespace {

/// A chord of a chain without a formula may leave its surfaces sideways as well as in depth. So the distance of a
/// dropped node from its chord is at most this share of the tolerance, unless another limit is given.
constexpr double kShareOfThinning = 0.5;

constexpr double kSlack = 1e-9;

/// A chain is believed to run along a plane section if at least this many nodes lie in one plane. Three always do.
constexpr std::size_t kMinNodesOfPlane = 4;

using Nodes = std::vector<ChainNode>;

/// Returns the angle by which a chain bends in the middle one of three places.
double bend(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::atan2(norm(cross(b - a, c - b)), dot(b - a, c - b));
}

/// Cuts one chain.
class ChainCutter {
 public:
  ChainCutter(std::uint32_t chain, const ChainSides& sides, const ChainCutting& cutting, std::vector<ChainCut>& cuts)
      : chain_(chain),
        sides_(sides),
        cutting_(cutting),
        cuts_(cuts),
        fit_(cutting.rules.fit_tolerance),
        limits_{HUGE_VAL, HUGE_VAL, {}, 1} {
    for (const PatchSurface& side : sides.curved) {
      limits_.tolerance = std::min(limits_.tolerance, side.tolerance);
      fit_ = std::max(fit_, side.fit_tolerance);
      sideways_ = std::min(sideways_, side.sideways > 0 ? side.sideways : kShareOfThinning * side.tolerance);
      limits_.max_turn = std::min(limits_.max_turn, side.max_turn);
      limits_.depths.push_back({side.shape, (is_seam() ? CurvedChart::kDepthOfEdges : 1) * side.max_depth});
    }
  }

  bool run(std::span<const ChainNode> nodes) {
    if (is_forced(nodes)) return false;
    if (cut_along_section(nodes)) return is_limited_;
    for (const Nodes& part : split_at_bends(nodes))
      if (part.size() == nodes.size() || !cut_along_section(part)) thin(part);
    return is_limited_;
  }

 private:
  const Vec3& at(const ChainNode& node) const { return cutting_.surface.positions[node.vertex]; }

  std::vector<Vec3> points_of(std::span<const ChainNode> nodes) const {
    std::vector<Vec3> points;
    points.reserve(nodes.size());
    for (const ChainNode& node : nodes) points.push_back(at(node));
    return points;
  }

  /// Returns whether the chain divides a ball into two patches. Triangles at such a chain are deeper than its pieces,
  /// and no option asks for their number.
  bool is_seam() const {
    return sides_.planes.empty() && sides_.curved.size() == 2 && sides_.curved[0].shape->kind == SurfaceKind::kSphere &&
           sides_.curved[0].shape->origin == sides_.curved[1].shape->origin &&
           sides_.curved[0].shape->radius == sides_.curved[1].shape->radius;
  }

  /// Returns whether the ladder has forced a vertex inside of the chain, or both ends of a chain of one piece.
  bool is_forced(std::span<const ChainNode> nodes) const {
    const auto is_forced_at = [&](const ChainNode& node) { return cutting_.forced[node.vertex] != 0; };
    if (nodes.size() == 2) return is_forced_at(nodes.front()) && is_forced_at(nodes.back());
    if (nodes.front().before != kNone && is_forced_at(nodes.front())) return true;
    return std::any_of(nodes.begin() + 1, nodes.end() - 1, is_forced_at);
  }

  /// Divides the chain evenly if it has a formula. Returns whether it has one.
  bool cut_along_section(std::span<const ChainNode> nodes) {
    const std::vector<Vec3> points = points_of(nodes);
    const std::optional<SectionChain> chain = section_through(points);
    if (!chain) return false;
    const auto room = [&](double limit) { return room_along(points, limit); };
    ChainLimits limits = limits_;
    limits.tolerance = std::min(limits.tolerance, tolerance_along(*chain, points));
    limits.min_pieces = pieces_for_width(nodes);
    SectionChain::Division division = chain->divide(limits, fit_, room, cutting_.control);
    is_limited_ = is_limited_ || division.is_limited;
    if (!division.is_changed) return true;
    cuts_.push_back({{nodes.begin(), nodes.end()}, std::move(division.kept), std::move(division.points), {}, true});
    cuts_.back().middle = chain->place(0.5);
    return true;
  }

  /// Returns the min number of pieces that are short enough for the width of each curved patch beside the chain. The
  /// width is the patch's area over the chain's length.
  double pieces_for_width(std::span<const ChainNode> nodes) const {
    double length = 0, area = HUGE_VAL;
    for (std::size_t i = 1; i < nodes.size(); ++i)
      length += norm(cutting_.surface.local[nodes[i].vertex] - cutting_.surface.local[nodes[i - 1].vertex]);
    for (const PatchSurface& side : sides_.curved) area = std::min(area, side.area);
    const double longest = cutting_.rules.max_length_per_width * area / length;
    return longest > 0 ? std::ceil(length / longest * (1 - kSlack)) : 1;
  }

  /// Finds a surface and a plane whose section the chain is.
  std::optional<SectionChain> section_through(std::span<const Vec3> points) const {
    std::vector<Vec3> distinct(points.begin(), points.end());
    if (points.front() == points.back()) distinct.pop_back();
    for (const PatchSurface& side : sides_.curved) {
      const std::vector<Plane> planes = sides_.planes.empty() ? planes_through(distinct, *side.shape) : sides_.planes;
      for (const Plane& plane : planes) {
        const auto curve = SectionCurve::through(distinct, *side.shape, plane, fit_);
        if (!curve) continue;
        auto chain = SectionChain::along(*curve, points);
        if (!chain || !is_on_all(*chain, points.size() - 1)) continue;
        // A plane polygon may be meant as a polygon. Only pieces that turn as little as facets do belong to a curve.
        if (sides_.planes.empty() && chain->largest_turn() > cutting_.rules.feature_angle * (1 + kSlack)) continue;
        return chain;
      }
    }
    return {};
  }

  /// Returns whether the curve stays on the surfaces of all patches beside the chain.
  bool is_on_all(const SectionChain& chain, std::size_t pieces) const {
    const double fit = 2 * fit_;
    for (std::size_t i = 0; i < pieces; ++i) {
      const Vec3 p = chain.middle(i);
      for (const PatchSurface& side : sides_.curved)
        if (!(std::fabs(side.shape->distance(p)) <= fit)) return false;
      for (const Plane& plane : sides_.planes)
        if (!(std::fabs(plane.distance(p)) <= fit)) return false;
    }
    return true;
  }

  /// Returns the max distance of chords from a section for which they stay near it along a surface, too. An oblique
  /// section of a cylinder bends along the surface as well as across it, and so do most circles on spheres and tori.
  double tolerance_along(const SectionChain& chain, std::span<const Vec3> points) const {
    double tolerance = HUGE_VAL;
    for (const PatchSurface& side : sides_.curved) {
      // The limits of a cone already allow for circles around its axis that bend along it.
      const bool is_cone = side.shape->kind == SurfaceKind::kCone;
      if (side.along == 0 || (is_cone && is_around_axis(points, *side.shape))) continue;
      double largest_part = 0;
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec3 middle = chain.middle(i), way = middle - 0.5 * (points[i] + points[i + 1]);
        const double across = dot(way, side.shape->normal(middle)), length = norm_squared(way);
        if (length > 0) largest_part = std::max(largest_part, 1 - across * across / length);
      }
      if (largest_part > 0) tolerance = std::min(tolerance, side.along / std::sqrt(largest_part));
    }
    return tolerance;
  }

  bool is_around_axis(std::span<const Vec3> points, const AnalyticSurface& surface) const {
    return std::all_of(points.begin(), points.end(),
                       [&](const Vec3& p) { return std::fabs(dot(p - points.front(), surface.axis)) <= 2 * fit_; });
  }

  /// Returns planes in which some points may lie: the one across the axis of a surface, and the one that fits them.
  std::vector<Plane> planes_through(std::span<const Vec3> points, const AnalyticSurface& surface) const {
    std::vector<Plane> planes;
    const auto count = static_cast<double>(points.size());
    const Vec3 first = points.front();
    Vec3 mean;
    for (const Vec3& p : points) mean += (1 / count) * (p - first);
    const Vec3 middle = first + mean;
    if (surface.kind != SurfaceKind::kSphere) planes.push_back({middle, surface.axis});
    if (points.size() >= kMinNodesOfPlane) {
      Vec3 area;
      for (std::size_t i = 0; i < points.size(); ++i)
        area += cross(points[i] - middle, points[(i + 1) % points.size()] - middle);
      const Vec3 normal = normalized(area);
      if (norm_squared(normal) > 0) planes.push_back({middle, normal});
    }
    return planes;
  }

  /// Finds how far the chain may move at each node and in the middle of each piece, up to a limit.
  ChainRoom room_along(std::span<const Vec3> points, double limit) const {
    ChainRoom room;
    const auto room_at = [&](const Vec3& p) {
      cutting_.control.check();
      double least = limit;
      for (const PatchId patch : sides_.planar) least = cutting_.gaps.room(chain_, patch, p, least);
      room.is_limited = room.is_limited || least < limit;
      return least;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_end = i == 0 || i + 1 == points.size();
      room.at_node.push_back(is_end ? limit : room_at(points[i]));
      if (i > 0) room.in_middle.push_back(room_at(0.5 * (points[i - 1] + points[i])));
    }
    return room;
  }

  bool is_bent(const Vec3& a, const Vec3& b, const Vec3& c) const {
    return bend(a, b, c) > cutting_.rules.feature_angle * (1 + kSlack);
  }

  /// Splits a chain where it bends. A ring that bends begins at the smallest of these places.
  std::vector<Nodes> split_at_bends(std::span<const ChainNode> nodes) const {
    Nodes all(nodes.begin(), nodes.end());
    const std::size_t last = all.size() - 1;
    if (all.front().before != kNone) {
      std::size_t first = last;
      for (std::size_t i = 0; i < last; ++i) {
        const bool bends = is_bent(at(all[(i + last - 1) % last]), at(all[i]), at(all[i + 1]));
        if (bends && (first == last || at(all[i]) < at(all[first]))) first = i;
      }
      all.pop_back();
      std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(first % last), all.end());
      all.push_back(all.front());
    }
    std::vector<Nodes> parts(1);
    for (std::size_t i = 0; i <= last; ++i) {
      parts.back().push_back(all[i]);
      if (i > 0 && i < last && is_bent(at(all[i - 1]), at(all[i]), at(all[i + 1]))) parts.push_back({all[i]});
    }
    return parts;
  }

  /// Returns the largest distance of a node from the chord over it.
  static double largest_distance(std::span<const Vec3> points, std::span<const std::uint32_t> kept) {
    double largest = 0;
    std::size_t first = 0;
    for (std::size_t j = 0; j <= kept.size(); ++j) {
      const std::size_t last = j < kept.size() ? kept[j] : points.size() - 1;
      for (std::size_t i = first + 1; i < last; ++i)
        largest = std::max(largest, norm(points[i] - nearest_on_segment(points[i], points[first], points[last])));
      first = last;
    }
    return largest * (1 + kSlack);
  }

  /// Drops nodes of a chain without a formula.
  void thin(const Nodes& nodes) {
    if (nodes.size() < 3) return;
    const std::vector<Vec3> points = points_of(nodes);
    std::vector<const AnalyticSurface*> surfaces;
    for (const PatchSurface& side : sides_.curved) surfaces.push_back(side.shape);
    ChainRoom room{std::vector<double>(points.size(), sideways_), {}, false};
    std::vector<std::uint32_t> kept = thin_chain(points, surfaces, limits_, room, cutting_.control);
    if (kept.size() + 2 == nodes.size()) return;
    room = room_along(points, std::min(sideways_, largest_distance(points, kept)));
    if (room.is_limited) {
      // The middles of the pieces beside a node limit the node's room, too.
      for (std::size_t i = 1; i + 1 < points.size(); ++i)
        room.at_node[i] = std::min({room.at_node[i], room.in_middle[i - 1], room.in_middle[i]});
      std::vector<std::uint32_t> fewer_dropped = thin_chain(points, surfaces, limits_, room, cutting_.control);
      is_limited_ = is_limited_ || fewer_dropped.size() > kept.size();
      kept = std::move(fewer_dropped);
      if (kept.size() + 2 == nodes.size()) return;
    }
    cuts_.push_back({nodes, std::move(kept), {}, {}, false});
  }

  std::uint32_t chain_;
  const ChainSides& sides_;
  const ChainCutting& cutting_;
  std::vector<ChainCut>& cuts_;
  double fit_;  ///< the largest distance of an essential vertex from the surfaces
  ChainLimits limits_;
  double sideways_ = HUGE_VAL;  ///< how far a dropped node may be off its chord
  bool is_limited_ = false;
};

}  // namespace

bool cut_chain(std::uint32_t chain, std::span<const ChainNode> nodes, const ChainSides& sides,
               const ChainCutting& cutting, std::vector<ChainCut>& cuts) {
  return ChainCutter(chain, sides, cutting, cuts).run(nodes);
}

}  // namespace remesh
