#include "core/refinement/goals/unrefined.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The relative error that rounding may add to an edge or an area.
constexpr double kRounding = 1e-9;

/// The sides of a triangle, scaled so that no square under- or overflows.
class Sides {
 public:
  Sides(const Vec3& a, const Vec3& b, const Vec3& c) : side_{b - a, c - b, a - c} {
    double longest = 0;
    for (const Vec3& s : side_) longest = std::max({longest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
    if (!(longest > 0)) return;
    unit_ = std::ldexp(1.0, -std::ilogb(longest));
    for (Vec3& s : side_) s = unit_ * s;
    twice_area_ = norm(cross(side_[0], side_[1]));
  }

  /// Returns whether the corners are one point.
  bool is_point() const { return unit_ == 0; }
  double length(int i) const { return norm(side_[i]) / unit_; }
  double area() const { return twice_area_ / 2 / unit_ / unit_; }
  bool has_angle_below(double tangent) const {
    for (int i = 0; i < 3; ++i)
      if (twice_area_ < along(i) * tangent) return true;
    return is_point() && tangent > 0;
  }
  double least_angle_deg() const {
    double largest = 0;
    for (int i = 0; i < 3; ++i) largest = std::max(largest, along(i));
    return is_point() ? 0 : std::atan2(twice_area_, largest) * 180 / std::numbers::pi;
  }

 private:
  /// The cosine of the angle between two sides, times their lengths. It is largest at the smallest angle.
  double along(int i) const { return -dot(side_[i], side_[(i + 1) % 3]); }

  std::array<Vec3, 3> side_;
  double unit_ = 0, twice_area_ = 0;
};

bool meets(const Sides& sides, const Goals& goals, double tangent) {
  if (sides.has_angle_below(tangent)) return false;
  if (sides.is_point()) return true;
  for (int i = 0; i < 3; ++i)
    if (sides.length(i) > goals.max_edge_length * (1 + kRounding)) return false;
  return !(sides.area() > goals.max_area * (1 + kRounding));
}

Sides sides_of(std::span<const Vec3> positions, const Triangle& t) {
  return {positions[t[0].value], positions[t[1].value], positions[t[2].value]};
}

double tangent_of(double degrees) { return std::tan(degrees * std::numbers::pi / 180); }

}  // namespace

UnrefinedFaces find_unrefined(std::span<const Vec3> positions, std::span<const Triangle> faces,
                              std::span<const UnrefinedReason> reason, std::span<const std::uint8_t> misses_sizes,
                              const Goals& goals, RunControl& control) {
  const double tangent = tangent_of(goals.min_angle_deg);
  struct Listed {
    FaceId face;
    UnrefinedReason reason;
  };
  const auto blocks =
      map_blocks<std::vector<Listed>>(faces.size(), 8192, control, [&](std::size_t begin, std::size_t end) {
        std::vector<Listed> found;
        for (std::size_t f = begin; f < end; ++f) {
          const bool is_met = meets(sides_of(positions, faces[f]), goals, tangent);
          const std::uint8_t misses = misses_sizes.empty() ? 0 : misses_sizes[f];
          if (!is_met || misses != 0)
            found.push_back({FaceId(f), is_met && misses == kMayMissSizes ? UnrefinedReason::kEffort : reason[f]});
        }
        return found;
      });
  UnrefinedFaces result;
  StopCheck check(control);
  for (const auto& block : blocks)
    for (const auto& [f, why] : block) {
      check();
      result.faces.push_back(f);
      result.reasons.push_back(why);
      result.misses_sizes.push_back(misses_sizes.empty() ? 0 : misses_sizes[f.value]);
    }
  return result;
}

SmallAngles small_angles(std::span<const Vec3> positions, std::span<const VertexId> corners, double bound_deg,
                         RunControl& control) {
  const double tangent = tangent_of(bound_deg);
  SmallAngles total;
  for (const SmallAngles& block :
       map_blocks<SmallAngles>(corners.size() / 3, 8192, control, [&](std::size_t begin, std::size_t end) {
         SmallAngles found;
         for (std::size_t t = begin; t < end; ++t) {
           const Sides sides = sides_of(positions, {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
           if (sides.has_angle_below(tangent)) found.add({1, sides.least_angle_deg()});
         }
         return found;
       }))
    total.add(block);
  return total;
}

std::vector<Unrefined> summarise_unrefined(const UnrefinedFaces& unrefined, std::span<const Vec3> positions,
                                           std::span<const Triangle> faces, const Goals& goals, RunControl& control) {
  StopCheck check(control);
  std::array<Unrefined, kUnrefinedReasonCount> by_reason;
  // The user did not ask for a floor that the program has found.
  const bool is_found = goals.faces_without_min_edge != Goals::kNoLimit || goals.min_edge_of_storage > 0;
  const auto told = [&](UnrefinedReason reason) {
    return reason == UnrefinedReason::kMinEdgeLength && is_found ? UnrefinedReason::kSizeFloor : reason;
  };
  for (std::size_t i = 0; i < unrefined.faces.size(); ++i) {
    check();
    const Triangle& face = faces[unrefined.faces[i].value];
    Vec3 centre;
    for (const VertexId v : face) centre += (1.0 / 3) * positions[v.value];
    by_reason[static_cast<std::size_t>(told(unrefined.reasons[i]))].add(centre);
  }
  std::vector<Unrefined> result;
  for (int r = 0; r < kUnrefinedReasonCount; ++r) {
    by_reason[r].reason = static_cast<UnrefinedReason>(r);
    if (by_reason[r].count > 0) result.push_back(std::move(by_reason[r]));
  }
  return result;
}

}  // namespace remesh
