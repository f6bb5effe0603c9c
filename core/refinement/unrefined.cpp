#include "core/refinement/unrefined.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// This is the relative error that rounding may add to an edge or an area.
constexpr double kRounding = 1e-9;

bool meets(const Vec3& a, const Vec3& b, const Vec3& c, const Goals& goals, double tangent) {
  // The differences are scaled, so that no square under- or overflows.
  const std::array<Vec3, 3> side{b - a, c - b, a - c};
  double longest = 0;
  for (const Vec3& s : side) longest = std::max({longest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
  if (!(longest > 0)) return goals.min_angle_deg == 0;
  const double unit = std::ldexp(1.0, -std::ilogb(longest));
  const std::array<Vec3, 3> u{unit * side[0], unit * side[1], unit * side[2]};
  const double twice_area = norm(cross(u[0], u[1]));
  for (int i = 0; i < 3; ++i) {
    if (twice_area < -dot(u[i], u[(i + 1) % 3]) * tangent) return false;
    if (norm(u[i]) / unit > goals.max_edge_length * (1 + kRounding)) return false;
  }
  return !(twice_area / 2 / unit / unit > goals.max_area * (1 + kRounding));
}

}  // namespace

UnrefinedFaces find_unrefined(std::span<const Vec3> positions, std::span<const Triangle> faces,
                              std::span<const UnrefinedReason> reason, std::span<const std::uint8_t> misses_sizes,
                              const Goals& goals, RunControl& control) {
  const double tangent = std::tan(goals.min_angle_deg * std::numbers::pi / 180);
  struct Listed {
    FaceId face;
    UnrefinedReason reason;
  };
  const auto blocks =
      map_blocks<std::vector<Listed>>(faces.size(), 8192, control, [&](std::size_t begin, std::size_t end) {
        std::vector<Listed> found;
        for (std::size_t f = begin; f < end; ++f) {
          const bool is_met = meets(positions[faces[f][0].value], positions[faces[f][1].value],
                                    positions[faces[f][2].value], goals, tangent);
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

std::vector<Unrefined> summarise_unrefined(const UnrefinedFaces& unrefined, std::span<const Vec3> positions,
                                           std::span<const Triangle> faces, const Goals& goals, RunControl& control) {
  StopCheck check(control);
  std::array<Unrefined, kUnrefinedReasonCount> by_reason;
  // A floor that was found was not asked for.
  const bool is_found = goals.faces_without_floor != Goals::kNoLimit || goals.floor_of_storage > 0;
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
