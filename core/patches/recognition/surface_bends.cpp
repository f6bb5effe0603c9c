#include "core/patches/recognition/surface_bends.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/patches/recognition/free_regions.h"

namespace remesh {
namespace {

/// A torus with corners at no more than this number of angles around its axis is a short piece of its tube.
constexpr std::size_t kMaxAngles = 3;

/// Two corners have the same angle if their angles differ by less than this part of the largest step between angles.
constexpr double kSameAngle = 0.1;

/// A side crosses the tube if the cosine between the two is below the first number. Two tubes continue each other only
/// if the cosine between them is above the second.
constexpr double kAcrossTube = 0.5, kAlongTube = 0.7;

/// Two tubes have the same radius if their radii differ by at most this many tolerances.
constexpr double kSameRadius = 4;

/// Two rows are alike if neither is longer than the other by this factor.
constexpr double kAlikeRows = 2.5;

/// A bend shows if the tube's distance from a row is more than this multiple of the distance of the row's corners, and
/// this part of the tolerance, which covers rounding.
constexpr double kDeviations = 2, kRoundingPart = 0.1;

/// A tube bends at a claim if it bends at this part of the sides across it. The first number is for sides where the
/// next piece of the tube is a claim as well. The second one is for sides with free facets or another torus, which
/// prove less.
constexpr double kMinBend = 0.4, kMinFreeBend = 0.8;

/// A claim at the end of a tube has only one side where the tube may continue. It is a piece of the free facets beyond
/// if its area is below this part of their area.
constexpr double kMaxEnd = 0.2;

/// A tube at one place.
struct Tube {
  Vec3 direction;
  double radius;
};

bool is_tube(SurfaceKind kind) {
  return kind == SurfaceKind::kCylinder || kind == SurfaceKind::kCone || kind == SurfaceKind::kTorus;
}

Tube tube_at(const AnalyticSurface& s, const Vec3& p) {
  if (s.kind == SurfaceKind::kTorus) return {normalized(cross(s.axis, p - s.origin)), s.minor_radius};
  return {s.axis, s.kind == SurfaceKind::kCylinder ? s.radius : s.distance_from_axis(p)};
}

/// Drops the claims of a table.
class BendDropper {
 public:
  BendDropper(const FacetGraph& graph, ClaimTable& table, RunControl& control)
      : graph_(graph), table_(table), control_(control), check_(control) {}

  void free_in_parallel() {
    UnionFind tubes(table_.claims.size());
    std::vector<std::uint32_t> bent, ends;
    for (std::uint32_t c = 0; c < table_.claims.size(); ++c) {
      const SurfaceClaim& claim = table_.claims[c];
      if (claim.facets.empty() || !is_tube(claim.shape.kind)) continue;
      const Bends bends = join_tubes(c, tubes);
      if (!(bends.any > 0) || !is_short(claim)) continue;
      if (bends.of_claims > kMinBend * bends.across || bends.any > kMinFreeBend * bends.across)
        bent.push_back(c);
      else if (bends.any > kMinFreeBend * bends.smooth)
        ends.push_back(c);
    }
    if (bent.empty() && ends.empty()) return;
    std::vector<bool> is_bent(table_.claims.size(), false);
    for (const std::uint32_t c : bent) is_bent[tubes.find(c)] = true;
    for (std::uint32_t c = 0; c < table_.claims.size() && !bent.empty(); ++c)
      if (!table_.claims[c].facets.empty() && is_bent[tubes.find(c)] && is_short(table_.claims[c])) drop(c);
    const FreeRegions regions(graph_, table_, control_);
    for (const std::uint32_t c : ends)
      if (!table_.claims[c].facets.empty() && is_end_of_larger(table_.claims[c], regions)) drop(c);
  }

 private:
  /// Lengths of sides that cross a tube at the ends of a claim.
  struct Bends {
    double across = 0;     ///< the length of all such sides
    double smooth = 0;     ///< the length of the sides with a facet beyond
    double of_claims = 0;  ///< of sides beyond which another claim continues the tube in another direction
    double any = 0;        ///< of sides beyond which the tube continues in another direction
  };

  void drop(std::uint32_t c) {
    for (const PatchId p : table_.claims[c].facets) table_.owner[p] = kNone;
    table_.claims[c].facets.clear();
  }

  /// Returns whether a claim is small beside a free region that begins at its end.
  bool is_end_of_larger(const SurfaceClaim& claim, const FreeRegions& regions) {
    double area = 0;
    for (const PatchId p : claim.facets)
      graph_.for_each_neighbour(p, [&](PatchId q) {
        check_();
        area = std::max(area, regions.area_of(q));
      });
    return claim.area < kMaxEnd * area;
  }

  bool is_inside(const SurfaceClaim& claim, PatchId q) const {
    return q.is_valid() && table_.owner[q] == table_.owner[claim.facets.front()];
  }

  /// Returns whether a claim is so short a piece of a tube that some round surface always fits.
  bool is_short(const SurfaceClaim& claim) {
    if (claim.shape.kind == SurfaceKind::kTorus) return has_few_angles(claim);
    std::vector<VertexId> corners, border;
    for (const PatchId p : claim.facets)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
        check_();
        if (graph_.is_corner(s)) corners.push_back(graph_.vertex(s));
        if (is_inside(claim, graph_.beyond(s))) continue;
        border.push_back(graph_.vertex(s));
        border.push_back(graph_.end_vertex(s));
      }
    sort_stoppable(border.begin(), border.end(), control_);
    return std::all_of(corners.begin(), corners.end(),
                       [&](VertexId v) { return std::binary_search(border.begin(), border.end(), v); });
  }

  bool has_few_angles(const SurfaceClaim& torus) {
    const AnalyticSurface& s = torus.shape;
    const Vec3 x = normalized(cross(s.axis, std::fabs(s.axis.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 y = cross(s.axis, x);
    std::vector<double> angles;
    for (const PatchId p : torus.facets)
      graph_.for_each_corner(p, [&](const Vec3& q) {
        check_();
        angles.push_back(std::atan2(dot(q - s.origin, y), dot(q - s.origin, x)));
      });
    sort_stoppable(angles.begin(), angles.end(), control_);
    std::vector<double> steps;
    for (std::size_t i = 1; i < angles.size(); ++i) steps.push_back(angles[i] - angles[i - 1]);
    steps.push_back(angles.front() + 2 * std::acos(-1.0) - angles.back());
    // The largest of all steps leads around the other side, where the torus has no facets.
    sort_stoppable(steps.begin(), steps.end(), control_, std::greater<>());
    std::size_t count = 1;
    while (count < steps.size() && steps[count] > kSameAngle * steps[1]) ++count;
    return count <= kMaxAngles;
  }

  /// Returns how far a facet reaches in a direction.
  double length_along(PatchId p, const Vec3& direction) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    graph_.for_each_corner(p, [&](const Vec3& q) {
      low = std::min(low, dot(q, direction));
      high = std::max(high, dot(q, direction));
    });
    return high - low;
  }

  enum class Beyond : std::uint8_t { kEnd, kTube, kFreeBend, kBend };

  /// Returns what follows beyond a smooth side of a claim that crosses its tube. If the tube bends there by an angle
  /// over a row, the row's distance from the tube is an eighth of the product of angle and length; otherwise there is
  /// no bend.
  Beyond beyond(const SurfaceClaim& claim, PatchId p, PatchId q, const Tube& tube, const Vec3& place) const {
    // A ring has as many corners as its border has sides, and each side would need a test of all corners.
    if (!graph_.may_be_seed(p) || !graph_.may_be_seed(q)) return Beyond::kEnd;
    const double length = length_along(p, tube.direction), next = length_along(q, tube.direction);
    const bool are_alike = length <= kAlikeRows * next && next <= kAlikeRows * length;
    const auto is_bend = [&](double sine, double noise) {
      return are_alike && std::min(length, next) * std::asin(std::clamp(std::fabs(sine), 0.0, 1.0)) / 8 > noise;
    };
    const auto noise_of = [](const SurfaceClaim& of) {
      return std::max(kDeviations * of.deviation, kRoundingPart * of.tolerance);
    };
    if (table_.owner[q] == kNone) {
      const double turn = dot(graph_.normal(q) - graph_.normal(p), tube.direction);
      return is_bend(turn, noise_of(claim)) ? Beyond::kFreeBend : Beyond::kEnd;
    }
    const SurfaceClaim& other = table_.claims[table_.owner[q]];
    if (!is_tube(other.shape.kind)) return Beyond::kEnd;
    const Tube goes_on = tube_at(other.shape, place);
    if (std::fabs(goes_on.radius - tube.radius) > kSameRadius * std::max(claim.tolerance, other.tolerance) ||
        !(std::fabs(dot(goes_on.direction, tube.direction)) > kAlongTube))
      return Beyond::kEnd;
    // Three rings always lie on a torus, so pieces of a hose follow each other as tori with different centres.
    if (claim.shape.kind == SurfaceKind::kTorus && other.shape.kind == SurfaceKind::kTorus &&
        norm(other.shape.origin - claim.shape.origin) > kSameRadius * std::max(claim.tolerance, other.tolerance))
      return Beyond::kFreeBend;
    const double sine = norm(cross(goes_on.direction, tube.direction));
    return is_bend(sine, std::max(noise_of(claim), noise_of(other))) ? Beyond::kBend : Beyond::kTube;
  }

  /// Joins a claim with the claims that continue its tube. Returns how the tube continues at the claim's ends.
  Bends join_tubes(std::uint32_t c, UnionFind& tubes) {
    const SurfaceClaim& claim = table_.claims[c];
    Bends bends;
    for (const PatchId p : claim.facets)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
        check_();
        const PatchId q = graph_.beyond(s);
        if (is_inside(claim, q)) continue;
        const Vec3 &a = graph_.position(graph_.vertex(s)), &b = graph_.position(graph_.end_vertex(s));
        const Vec3 place = 0.5 * (a + b);
        const Tube tube = tube_at(claim.shape, place);
        const double length = norm(b - a);
        if (!(std::fabs(dot(b - a, tube.direction)) < kAcrossTube * length)) continue;
        bends.across += length;
        if (!q.is_valid()) continue;
        bends.smooth += length;
        const Beyond what = beyond(claim, p, q, tube, place);
        if (what == Beyond::kBend) bends.of_claims += length;
        if (what == Beyond::kBend || what == Beyond::kFreeBend) bends.any += length;
        if (what != Beyond::kEnd && table_.owner[q] != kNone) tubes.join(c, table_.owner[q]);
      }
    return bends;
  }

  const FacetGraph& graph_;
  ClaimTable& table_;
  RunControl& control_;
  StopCheck check_;
};

}  // namespace

void drop_bends(const FacetGraph& graph, ClaimTable& table, RunControl& control) {
  BendDropper(graph, table, control).free_in_parallel();
}

}  // namespace remesh
