#include "core/patches/recognition/revolution_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

/// The smallest number of bands that are joined. Fewer bands about one axis are cones and cylinders of their own.
constexpr std::size_t kMinBands = 4;

/// A band of facets between two circles about an axis.
struct Band {
  AnalyticSurface shape;
  double tolerance = 0;      ///< of its claim
  std::array<Vec2, 2> rims;  ///< distance from the axis and height above the shape's origin, of both circles
};

/// Joins the bands of a table.
class BandJoiner {
 public:
  BandJoiner(const FacetGraph& graph, ClaimTable& table, RunControl& control)
      : graph_(graph), table_(table), control_(control) {}

  void join_all() {
    StopCheck check(control_);
    std::vector<std::optional<Band>> bands;
    for (const SurfaceClaim& claim : table_.claims) bands.push_back(band_of(claim));
    UnionFind groups(table_.claims.size());
    for (std::uint32_t c = 0; c < table_.claims.size(); ++c) {
      if (!bands[c]) continue;
      std::vector<std::uint32_t> beside;
      for (const PatchId p : table_.claims[c].facets)
        graph_.for_each_neighbour(p, [&](PatchId q) {
          check();
          if (table_.owner[q] != kNone && table_.owner[q] != c && bands[table_.owner[q]])
            beside.push_back(table_.owner[q]);
        });
      sort_unique(beside);
      for (const std::uint32_t d : beside)
        if (are_about_one_axis(*bands[c], *bands[d])) groups.join(c, d);
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t c = 0; c < table_.claims.size(); ++c)
      if (bands[c]) members[groups.find(c)].push_back(c);
    for (const auto& [root, group] : members)
      if (group.size() >= kMinBands) join(group, bands);
  }

 private:
  std::optional<Band> band_of(const SurfaceClaim& claim) const {
    const SurfaceKind kind = claim.shape.kind;
    if (claim.facets.empty() || (kind != SurfaceKind::kCone && kind != SurfaceKind::kCylinder)) return std::nullopt;
    double low = HUGE_VAL, high = -HUGE_VAL;
    const auto height_of = [&](const Vec3& p) { return dot(p - claim.shape.origin, claim.shape.axis); };
    for (const PatchId p : claim.facets)
      graph_.for_each_corner(p, [&](const Vec3& q) {
        low = std::min(low, height_of(q));
        high = std::max(high, height_of(q));
      });
    const double slack = 2 * claim.tolerance;
    for (const PatchId p : claim.facets) {
      bool is_between = false;
      graph_.for_each_corner(p, [&](const Vec3& q) {
        const double z = height_of(q);
        if (z > low + slack && z < high - slack) is_between = true;
      });
      if (is_between) return std::nullopt;
    }
    const auto rim = [&](double z) {
      return Vec2{kind == SurfaceKind::kCylinder ? claim.shape.radius : z * std::tan(claim.shape.half_angle), z};
    };
    return Band{claim.shape, claim.tolerance, {rim(low), rim(high)}};
  }

  /// Returns whether two bands have one axis and share a rim.
  static bool are_about_one_axis(const Band& a, const Band& b) {
    const double slack = 6 * std::max(a.tolerance, b.tolerance);
    const auto centre = [](const Band& band, int i) { return band.shape.origin + band.rims[i].y * band.shape.axis; };
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        if (norm(centre(a, i) - centre(b, j)) <= slack && std::fabs(a.rims[i].x - b.rims[j].x) <= slack &&
            std::fabs(dot(a.shape.axis, b.shape.axis)) * std::min(a.rims[i].x, 1.0) >=
                std::min(a.rims[i].x, 1.0) - slack)
          return true;
    return false;
  }

  /// Makes one surface of revolution of some bands.
  void join(std::span<const std::uint32_t> group, std::span<const std::optional<Band>> bands) {
    // The axes of the bands have independent errors, so a mean is taken.
    const Vec3 direction = canonical_direction(bands[group.front()]->shape.axis);
    Vec3 axes, centres;
    for (const std::uint32_t c : group) {
      const AnalyticSurface& band = bands[c]->shape;
      axes += (dot(band.axis, direction) < 0 ? -1.0 : 1.0) * band.axis;
      for (const Vec2& rim : bands[c]->rims) centres += band.origin + rim.y * band.axis;
    }
    SurfaceClaim joined;
    joined.shape.kind = SurfaceKind::kRevolution;
    joined.shape.axis = normalized(axes);
    joined.shape.origin = (0.5 / static_cast<double>(group.size())) * centres;
    joined.side = table_.claims[group.front()].side;
    for (const std::uint32_t c : group) {
      for (const Vec2& rim : bands[c]->rims) {
        const Vec3 centre = bands[c]->shape.origin + rim.y * bands[c]->shape.axis;
        joined.profile.push_back({rim.x, dot(centre - joined.shape.origin, joined.shape.axis)});
      }
      SurfaceClaim& band = table_.claims[c];
      if (band.side != joined.side) joined.side = 0;
      joined.facets.insert(joined.facets.end(), band.facets.begin(), band.facets.end());
      joined.area += band.area;
      joined.tolerance = std::max(joined.tolerance, band.tolerance);
      joined.deviation = std::max(joined.deviation, band.deviation);
      joined.bands.push_back(band);
      band.facets.clear();
    }
    // Neighbouring bands share a rim.
    std::sort(joined.profile.begin(), joined.profile.end(), [](Vec2 a, Vec2 b) { return a.y < b.y; });
    const double slack = 2 * joined.tolerance;
    const auto is_same = [&](Vec2 a, Vec2 b) { return norm(a - b) <= slack; };
    joined.profile.erase(std::unique(joined.profile.begin(), joined.profile.end(), is_same), joined.profile.end());
    table_.add(std::move(joined));
  }

  const FacetGraph& graph_;
  ClaimTable& table_;
  RunControl& control_;
};

}  // namespace

void join_bands(const FacetGraph& graph, ClaimTable& table, RunControl& control) {
  BandJoiner(graph, table, control).join_all();
}

}  // namespace remesh
