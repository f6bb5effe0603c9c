#include "core/patches/surface_recognition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/surface_fit.h"
#include "core/patches/facet_graph.h"
#include "core/patches/surface_claims.h"
#include "core/patches/surface_records.h"
#include "core/patches/surface_seeds.h"

namespace remesh {
namespace {

/// A claim replaces smaller ones if its area is larger than the largest of theirs by this factor.
constexpr double kMuchLarger = 1.3, kMuchLargerIfDoubtful = 6;

/// A facet over which so many surfaces were given up is no seed any more.
constexpr std::uint8_t kMaxAttempts = 3;

/// A band is compared with its neighbours if all of its corners are this close to it, in tolerances.
constexpr double kCloseFit = 0.4;

/// So many bands about one axis are a surface of revolution.
constexpr std::size_t kMinBands = 4;

/// A claim is an island if it has at most so many facets, if so much of its border is with one or more regions of many
/// facets that nobody claims, and if it is smaller than this part of the largest of them.
constexpr std::size_t kMaxIsland = 40, kMinSea = 40;
constexpr double kIslandShore = 0.6, kIslandArea = 0.05;

/// A kind with more parameters is chosen only if its area is larger by this factor.
constexpr double kLarger = 1.02;

/// The facets of a band around an axis have their corners on a cone, on a sphere and on tori. They deviate less from the
/// cone than from the others.
constexpr double kNearer = 0.9;

/// Makes the claims of all facets.
class Recogniser {
 public:
  Recogniser(const FacetGraph& graph, double tolerance, RunControl& control)
      : graph_(graph),
        grower_(graph, tolerance, control),
        owner_(graph.size(), kNone),
        attempts_(graph.size(), 0),
        tried_(graph.size(), 0),
        check_(control),
        control_(control) {}

  std::vector<Claim> run() {
    const std::vector<SurfaceSeed> seeds = find_seeds(graph_, control_);
    claim_ruled(seeds);
    replace_bands();
    // Facets of claims that were replaced in part are free again.
    claim_ruled(seeds);
    claim_scattered(seeds);
    join_bands();
    drop_islands();
    return take_claims();
  }

 private:
  bool is_free(PatchId p) const { return owner_[p] == kNone; }

  /// Claims surfaces that two facets determine.
  void claim_ruled(std::span<const SurfaceSeed> seeds) {
    SeedGuesses guesses(graph_);
    StopCheck check(control_);
    for (const SurfaceSeed& seed : seeds) {
      check();
      const std::array<PatchId, 2> pair{seed.facet, graph_.beyond(seed.side)};
      if (!is_free(pair[0]) || !is_free(pair[1])) continue;
      if (attempts_[pair[0]] >= kMaxAttempts || attempts_[pair[1]] >= kMaxAttempts) continue;
      std::optional<Claim> best;
      for (const AnalyticSurface& guess : guesses.of(seed)) grow(guess, pair, Taken::kFree, best);
      if (best && best->shape.kind == SurfaceKind::kSphere && is_close(*best)) ask_again(best);
      if (!best) continue;
      add(std::move(*best));
      replace_band(static_cast<std::uint32_t>(claims_.size() - 1));
    }
  }

  /// Tries the other kinds on the facets of a sphere. If these are a band, any surface of revolution fits.
  void ask_again(std::optional<Claim>& best) {
    std::vector<PatchId> seed;
    sample(best->facets, seed);
    collect(seed);
    const double height = grower_.chord_height(best->shape, seed);
    const auto attempt = [&](const std::optional<AnalyticSurface>& guess) {
      const auto fitted =
          guess ? fit_from(*guess, points_, {grower_.tolerance(), 20 * grower_.tolerance()}) : std::nullopt;
      if (fitted && grower_.chord_height(*fitted, seed) < kNearer * height) grow(*fitted, seed, Taken::kFree, best);
    };
    attempt(guess_cylinder(points_, places_));
    attempt(guess_cone(points_, places_));
    attempt(guess_torus(points_, places_));
  }

  /// Stores the corners and middles of facets.
  void collect(std::span<const PatchId> facets) {
    points_.clear();
    places_.clear();
    for (const PatchId p : facets) {
      places_.push_back(grower_.place_of(p));
      graph_.for_each_corner(p, [&](const Vec3& q) { points_.push_back(q); });
    }
  }

  /// Grows those kinds of surfaces that normals help to guess from facets that were collected.
  void try_kinds(std::span<const PatchId> seed, Taken may_replace, std::optional<Claim>& best) {
    const auto attempt = [&](const std::optional<AnalyticSurface>& guess) {
      const auto fitted =
          guess ? fit_from(*guess, points_, {grower_.tolerance(), 20 * grower_.tolerance()}) : std::nullopt;
      if (fitted) grow(*fitted, seed, may_replace, best);
    };
    attempt(guess_cylinder(points_, places_));
    attempt(guess_cone(points_, places_));
    attempt(guess_torus(points_, places_));
  }

  /// Grows a surface, and takes it if it is better. Facets over which it was given up are soon left alone.
  void grow(const AnalyticSurface& guess, std::span<const PatchId> seed, Taken may_replace,
            std::optional<Claim>& best) {
    take_larger(grower_.grow(guess, seed, may_replace), best);
    for (const PatchId p : grower_.given_up())
      if (attempts_[p] < kMaxAttempts) ++attempts_[p];
  }

  static void take_larger(std::optional<Claim> claim, std::optional<Claim>& best) {
    if (!claim) return;
    if (!best) {
      best = std::move(claim);
      return;
    }
    if (is_better(*claim, *best)) best = std::move(claim);
  }

  /// The larger surface is better. Of two that are about as large, it is the one from which the facets deviate less, or
  /// else the one with fewer parameters.
  static bool is_better(const Claim& a, const Claim& b) {
    if (a.area > kLarger * b.area) return true;
    if (b.area > kLarger * a.area) return false;
    if (a.chord_height < kNearer * b.chord_height) return true;
    if (b.chord_height < kNearer * a.chord_height) return false;
    return parameter_count(a.shape.kind) < parameter_count(b.shape.kind);
  }

  void add(Claim claim) {
    const auto id = static_cast<std::uint32_t>(claims_.size());
    for (const PatchId p : claim.facets) {
      owner_[p] = id;
      grower_.set_taken(p, Taken::kWeakly);
    }
    claims_.push_back(std::move(claim));
  }

  /// Each band of facets around a torus or sphere is also a piece of a cone. Claims the larger surface instead.
  void replace_bands() {
    for (std::uint32_t c = 0; c < claims_.size(); ++c) replace_band(c);
  }

  /// Returns whether a claim fits so well that it may be a piece of something larger that fits as well.
  bool is_close(const Claim& claim) const { return claim.deviation <= kCloseFit * grower_.tolerance(); }

  void replace_band(std::uint32_t c) {
    if (!is_close(claims_[c])) return;
    std::vector<std::pair<std::uint32_t, PatchId>> beside;  // owner and facet
    for (const PatchId p : claims_[c].facets)
      graph_.for_each_neighbour(p, [&](PatchId q) {
        check_();
        if (owner_[q] != c && graph_.may_be_seed(q)) beside.push_back({owner_[q], q});
      });
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (std::size_t begin = 0, end = 0; begin < beside.size(); begin = end) {
      others_.clear();
      while (end < beside.size() && beside[end].first == beside[begin].first) others_.push_back(beside[end++].second);
      if (!are_compared_.insert(std::minmax(c, beside[begin].first)).second) continue;
      if (replace_with(c, others_)) return;
    }
  }

  /// Claims a surface of a band and of facets beside it, if it is larger.
  bool replace_with(std::uint32_t c, std::span<const PatchId> others) {
    const AnalyticSurface band = claims_[c].shape;
    seed_.clear();
    sample(claims_[c].facets, seed_);
    sample(others, seed_);
    collect(seed_);
    std::optional<Claim> best;
    if (const auto sphere = guess_sphere(points_)) grow(*sphere, seed_, Taken::kWeakly, best);
    if (band.kind == SurfaceKind::kCone || band.kind == SurfaceKind::kCylinder)
      if (const auto torus = guess_torus(points_, band.origin, band.axis)) grow(*torus, seed_, Taken::kWeakly, best);
    if (!best) try_kinds(seed_, Taken::kWeakly, best);
    return best && replace(std::move(*best));
  }

  /// Takes some facets of a list, evenly chosen.
  static void sample(std::span<const PatchId> facets, std::vector<PatchId>& chosen) {
    constexpr std::size_t kMaxSample = 16;
    const std::size_t step = (facets.size() + kMaxSample - 1) / kMaxSample;
    for (std::size_t i = 0; i < facets.size(); i += step) chosen.push_back(facets[i]);
  }

  /// Adds a claim in the place of those whose facets it has, if it is much larger than each of them.
  bool replace(Claim claim) {
    std::vector<std::uint32_t> owners;
    double largest = 0;
    for (const PatchId p : claim.facets)
      if (owner_[p] != kNone) owners.push_back(owner_[p]);
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
    for (const std::uint32_t o : owners) largest = std::max(largest, claims_[o].area);
    if (!(claim.area > kMuchLarger * largest)) return false;
    // Three or four bands of any surface of revolution are nearly a torus.
    if (!is_close(claim) && !(claim.area > kMuchLargerIfDoubtful * largest)) return false;
    add(std::move(claim));
    for (const std::uint32_t o : owners) {
      Claim& old = claims_[o];
      std::erase_if(old.facets, [&](PatchId p) { return owner_[p] != o; });
      old.area = 0;
      for (const PatchId p : old.facets) old.area += graph_.area(p);
      constexpr std::size_t kMinFacets = 4;
      const bool has_axis = old.shape.kind == SurfaceKind::kCone || old.shape.kind == SurfaceKind::kCylinder;
      if (has_axis && old.facets.size() >= kMinFacets) continue;
      for (const PatchId p : old.facets) {
        owner_[p] = kNone;
        grower_.set_taken(p, Taken::kFree);
      }
      old.facets.clear();
    }
    return true;
  }

  /// Claims surfaces whose edges are no rulings, from a facet pair with its neighbours.
  void claim_scattered(std::span<const SurfaceSeed> seeds) {
    std::vector<PatchId> around;
    StopCheck check(control_);
    for (const SurfaceSeed& seed : seeds) {
      check();
      const PatchId f = seed.facet, g = graph_.beyond(seed.side);
      if (!is_free(f) || !is_free(g) || tried_[f] != 0 || tried_[g] != 0) continue;
      around.assign({f, g});
      for (const PatchId p : {f, g})
        graph_.for_each_neighbour(p, [&](PatchId q) {
          if (is_free(q) && graph_.may_be_curved(q)) around.push_back(q);
        });
      std::sort(around.begin() + 2, around.end());
      around.erase(std::unique(around.begin() + 2, around.end()), around.end());
      std::erase_if(around, [&, i = 0](PatchId p) mutable { return i++ >= 2 && (p == f || p == g); });
      for (const PatchId p : around) tried_[p] = 1;
      collect(around);
      if (around.size() < 4) continue;
      std::optional<Claim> best;
      try_kinds(around, Taken::kFree, best);
      if (best) add(std::move(*best));
    }
  }

  /// Joins bands of cones and cylinders about one axis, which meet smoothly, to surfaces of revolution. They have no
  /// sphere or torus in common, or these would have replaced them.
  void join_bands() {
    StopCheck check(control_);
    std::vector<std::optional<Band>> bands;
    for (const Claim& claim : claims_) bands.push_back(band_of(claim));
    UnionFind groups(claims_.size());
    for (std::uint32_t c = 0; c < claims_.size(); ++c) {
      if (!bands[c]) continue;
      std::vector<std::uint32_t> beside;
      for (const PatchId p : claims_[c].facets)
        graph_.for_each_neighbour(p, [&](PatchId q) {
          check();
          if (owner_[q] != kNone && owner_[q] != c && bands[owner_[q]]) beside.push_back(owner_[q]);
        });
      std::sort(beside.begin(), beside.end());
      beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
      for (const std::uint32_t d : beside)
        if (are_about_one_axis(*bands[c], *bands[d])) groups.join(c, d);
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t c = 0; c < claims_.size(); ++c)
      if (bands[c]) members[groups.find(c)].push_back(c);
    for (const auto& [root, group] : members)
      if (group.size() >= kMinBands) join(group, bands);
  }

  /// A band of facets between two circles about an axis.
  struct Band {
    AnalyticSurface shape;
    std::array<Vec2, 2> rims;  ///< distance from the axis and height above the shape's origin, of both circles
  };

  std::optional<Band> band_of(const Claim& claim) const {
    const SurfaceKind kind = claim.shape.kind;
    if (claim.facets.empty() || (kind != SurfaceKind::kCone && kind != SurfaceKind::kCylinder)) return std::nullopt;
    double low = HUGE_VAL, high = -HUGE_VAL;
    const auto height_of = [&](const Vec3& p) { return dot(p - claim.shape.origin, claim.shape.axis); };
    for (const PatchId p : claim.facets)
      graph_.for_each_corner(p, [&](const Vec3& q) {
        low = std::min(low, height_of(q));
        high = std::max(high, height_of(q));
      });
    const double slack = 2 * grower_.tolerance();
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
    return Band{claim.shape, {rim(low), rim(high)}};
  }

  /// Returns whether two bands have one axis and share a rim.
  bool are_about_one_axis(const Band& a, const Band& b) const {
    const double slack = 6 * grower_.tolerance();
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
    // The errors of the bands' axes are independent.
    const Vec3 direction = canonical_direction(bands[group.front()]->shape.axis);
    Vec3 axes, centres;
    for (const std::uint32_t c : group) {
      const AnalyticSurface& band = bands[c]->shape;
      axes += (dot(band.axis, direction) < 0 ? -1.0 : 1.0) * band.axis;
      for (const Vec2& rim : bands[c]->rims) centres += band.origin + rim.y * band.axis;
    }
    Claim joined;
    joined.shape.kind = SurfaceKind::kRevolution;
    joined.shape.axis = normalized(axes);
    joined.shape.origin = (0.5 / static_cast<double>(group.size())) * centres;
    joined.side = claims_[group.front()].side;
    for (const std::uint32_t c : group) {
      for (const Vec2& rim : bands[c]->rims) {
        const Vec3 centre = bands[c]->shape.origin + rim.y * bands[c]->shape.axis;
        joined.profile.push_back({rim.x, dot(centre - joined.shape.origin, joined.shape.axis)});
      }
      Claim& band = claims_[c];
      if (band.side != joined.side) joined.side = 0;
      joined.facets.insert(joined.facets.end(), band.facets.begin(), band.facets.end());
      joined.area += band.area;
      joined.deviation = std::max(joined.deviation, band.deviation);
      band.facets.clear();
    }
    // Neighbouring bands share a rim.
    std::sort(joined.profile.begin(), joined.profile.end(), [](Vec2 a, Vec2 b) { return a.y < b.y; });
    const double slack = 2 * grower_.tolerance();
    const auto is_same = [&](Vec2 a, Vec2 b) { return norm(a - b) <= slack; };
    joined.profile.erase(std::unique(joined.profile.begin(), joined.profile.end(), is_same), joined.profile.end());
    add(std::move(joined));
  }

  /// Drops small claims in the middle of facets that nobody claims. They fit by chance, because a small piece of any
  /// smooth surface is nearly a piece of a cylinder or a torus.
  void drop_islands() {
    StopCheck check(control_);
    IdVector<PatchId, std::uint32_t> region_of(graph_.size(), kNone);
    std::vector<double> region_area;
    std::vector<PatchId> region;
    const auto is_unclaimed = [&](PatchId p) { return is_free(p) && graph_.may_be_curved(p); };
    for (std::size_t i = 0; i < graph_.size(); ++i) {
      if (!is_unclaimed(PatchId(i)) || region_of[PatchId(i)] != kNone) continue;
      const auto id = static_cast<std::uint32_t>(region_area.size());
      region.assign({PatchId(i)});
      region_of[PatchId(i)] = id;
      double area = 0;
      for (std::size_t k = 0; k < region.size(); ++k) {
        area += graph_.area(region[k]);
        graph_.for_each_neighbour(region[k], [&](PatchId q) {
          check();
          if (!is_unclaimed(q) || region_of[q] != kNone) return;
          region_of[q] = id;
          region.push_back(q);
        });
      }
      // A few facets are planes rather than a surface of their own.
      region_area.push_back(region.size() >= kMinSea ? area : 0);
    }
    for (Claim& claim : claims_) {
      if (claim.facets.empty() || claim.facets.size() > kMaxIsland) continue;
      double border = 0, shore = 0, sea = 0;
      for (const PatchId p : claim.facets)
        for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
          check();
          const PatchId q = graph_.beyond(s);
          if (q.is_valid() && owner_[q] == owner_[p]) continue;
          const double length = norm(graph_.position(graph_.vertex_after(p, s)) - graph_.position(graph_.vertex(s)));
          border += length;
          if (!q.is_valid() || region_of[q] == kNone) continue;
          const double area = region_area[region_of[q]];
          if (area > 0) shore += length;
          sea = std::max(sea, area);
        }
      if (shore <= kIslandShore * border || claim.area >= kIslandArea * sea) continue;
      for (const PatchId p : claim.facets) owner_[p] = kNone;
      claim.facets.clear();
    }
  }

  std::vector<Claim> take_claims() {
    std::erase_if(claims_, [](const Claim& c) { return c.facets.empty(); });
    return std::move(claims_);
  }

  const FacetGraph& graph_;
  ClaimGrower grower_;
  IdVector<PatchId, std::uint32_t> owner_;    ///< index of the claim, or kNone
  IdVector<PatchId, std::uint8_t> attempts_;  ///< how many surfaces were given up that had come to a facet
  IdVector<PatchId, std::uint8_t> tried_;     ///< whether a facet was in the seed of a scattered surface
  std::vector<Claim> claims_;
  std::vector<Vec3> points_;
  std::vector<FacetPlace> places_;
  std::vector<PatchId> seed_, others_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> are_compared_;  ///< claims that have no larger surface in common
  StopCheck check_;
  RunControl& control_;
};

}  // namespace

RecognisedSurfaces recognise_surfaces(const Facets& facets, const RecognitionRules& rules, RunControl& control) {
  const FacetGraph graph(facets, rules.feature_angle_deg, control);
  std::vector<Claim> claims;
  if (graph.has_smooth_edges()) claims = Recogniser(graph, rules.tolerance / facets.surface.unit, control).run();
  return make_records(facets, graph, std::move(claims), rules, control);
}

}  // namespace remesh
