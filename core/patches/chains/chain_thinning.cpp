#include "core/patches/chains/chain_thinning.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace remesh {
namespace {

/// Angles and distances are compared with a relative slack, because they are computed with rounding.
constexpr double kThinningSlack = 1e-9;

/// Chooses the nodes of one chain. Node 0 and the last one always stay.
class ChainThinner {
 public:
  ChainThinner(std::span<const Vec3> points, std::span<const AnalyticSurface* const> surfaces,
               const ChainLimits& limits, const ChainRoom& room, const RunControl& control)
      : points_(points), room_(room), control_(control) {
    const double turn = std::min(std::numbers::pi, turn_limit(limits.max_turn) * (1 + kThinningSlack));
    max_difference_ = 2 * std::sin(turn / 2);
    for (const AnalyticSurface* surface : surfaces)
      for (const Vec3& p : points) normals_.push_back(surface->normal(p));
  }

  std::vector<std::uint32_t> run() const {
    const std::uint32_t last = last_node();
    std::vector<std::uint32_t> chosen{0};
    while (chosen.back() != last) chosen.push_back(farthest_from(chosen.back()));
    const bool is_closed = points_.front() == points_.back();
    const std::uint32_t min_pieces = std::min(is_closed ? 3u : 1u, last);
    const auto pieces = std::max(static_cast<std::uint32_t>(chosen.size() - 1), min_pieces);
    std::vector<std::uint32_t> even = evenly(pieces);
    if (is_allowed(even)) {
      chosen = std::move(even);
    } else if (chosen.size() - 1 < min_pieces) {
      // The even division of a short ring fails only if a fold is hidden between its few nodes.
      chosen.clear();
      for (std::uint32_t i = 0; i <= last; ++i) chosen.push_back(i);
    }
    return {chosen.begin() + 1, chosen.end() - 1};
  }

 private:
  std::uint32_t last_node() const { return static_cast<std::uint32_t>(points_.size() - 1); }

  /// Returns whether the nodes between two others may be dropped.
  bool is_allowed(std::uint32_t i, std::uint32_t j) const {
    if (j == i + 1) return true;
    control_.check();
    const Vec3 a = points_[i], ab = points_[j] - a;
    const double length_squared = norm_squared(ab);
    if (!(length_squared > 0)) return false;
    double reached = 0;
    for (std::uint32_t k = i + 1; k < j; ++k) {
      const Vec3 ap = points_[k] - a;
      const double along = dot(ap, ab) / length_squared;
      if (!(along > reached) || !(along < 1)) return false;
      if (!(norm(ap - along * ab) <= room_.at_node[k] * (1 + kThinningSlack))) return false;
      reached = along;
    }
    for (std::size_t begin = 0; begin < normals_.size(); begin += points_.size())
      for (std::uint32_t k = i + 1; k <= j; ++k)
        if (!(norm(normals_[begin + k] - normals_[begin + i]) <= max_difference_)) return false;
    return true;
  }

  /// Returns a node at which a piece from node i may end. It is the farthest such node, unless longer pieces become
  /// allowed again after a forbidden one.
  std::uint32_t farthest_from(std::uint32_t i) const {
    std::uint32_t step = 1;
    while (i + 2 * step <= last_node() && is_allowed(i, i + 2 * step)) step *= 2;
    // The piece from i to `allowed` is permitted, and the piece from i to `refused` is not.
    std::uint32_t allowed = i + step, refused = std::min(i + 2 * step, last_node() + 1);
    while (refused - allowed > 1) {
      const std::uint32_t middle = allowed + (refused - allowed) / 2;
      (is_allowed(i, middle) ? allowed : refused) = middle;
    }
    return allowed;
  }

  /// Returns nodes that divide the length of the chain as evenly as possible.
  std::vector<std::uint32_t> evenly(std::uint32_t pieces) const {
    std::vector<double> length(points_.size(), 0);
    for (std::size_t k = 1; k < points_.size(); ++k) length[k] = length[k - 1] + norm(points_[k] - points_[k - 1]);
    std::vector<std::uint32_t> chosen{0};
    for (std::uint32_t j = 1; j < pieces; ++j) {
      const double wanted = length.back() * (static_cast<double>(j) / pieces);
      auto k = static_cast<std::uint32_t>(std::lower_bound(length.begin(), length.end(), wanted) - length.begin());
      if (k > 0 && wanted - length[k - 1] < length[k] - wanted) --k;
      // Each of the pieces still to come must have a node left.
      chosen.push_back(std::clamp(k, chosen.back() + 1, last_node() - (pieces - j)));
    }
    chosen.push_back(last_node());
    return chosen;
  }

  bool is_allowed(std::span<const std::uint32_t> chosen) const {
    for (std::size_t j = 1; j < chosen.size(); ++j)
      if (!is_allowed(chosen[j - 1], chosen[j])) return false;
    return true;
  }

  std::span<const Vec3> points_;
  const ChainRoom& room_;
  const RunControl& control_;
  double max_difference_ = 0;  ///< the distance of two unit normals that are the largest allowed turn apart
  std::vector<Vec3> normals_;  ///< those at all points on the first surface, then on the second one, and so on
};

}  // namespace

std::vector<std::uint32_t> thin_chain(std::span<const Vec3> points, std::span<const AnalyticSurface* const> surfaces,
                                      const ChainLimits& limits, const ChainRoom& room, const RunControl& control) {
  return ChainThinner(points, surfaces, limits, room, control).run();
}

}  // namespace remesh
