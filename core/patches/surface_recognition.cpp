#include "core/patches/surface_recognition.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/surface_fit.h"
#include "core/patches/facet_graph.h"
#include "core/patches/surface_claims.h"
#include "core/patches/surface_records.h"
#include "core/patches/surface_seeds.h"

namespace remesh {
namespace {

/// A claim replaces smaller ones if its area is larger than the largest of theirs by this factor.
constexpr double kMuchLarger = 1.3;

/// A facet over which so many surfaces were given up is no seed any more.
constexpr std::uint8_t kMaxAttempts = 6;

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
        control_(control) {}

  std::vector<Claim> run() {
    const std::vector<SurfaceSeed> seeds = find_seeds(graph_, control_);
    claim_ruled(seeds);
    replace_bands();
    claim_scattered(seeds);
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
      if (best && best->shape.kind == SurfaceKind::kSphere) ask_again(best);
      if (best) add(std::move(*best));
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
    StopCheck check(control_);
    std::vector<PatchId> seed;
    for (std::uint32_t c = 0; c < claims_.size(); ++c) {
      const SurfaceKind kind = claims_[c].shape.kind;
      const bool has_axis = kind == SurfaceKind::kCone || kind == SurfaceKind::kCylinder;
      std::vector<std::pair<std::uint32_t, PatchId>> beside;  // owner and facet
      for (const PatchId p : claims_[c].facets)
        graph_.for_each_neighbour(p, [&](PatchId q) {
          check();
          if (owner_[q] != c && graph_.may_be_curved(q)) beside.push_back({owner_[q], q});
        });
      std::sort(beside.begin(), beside.end());
      beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
      for (std::size_t begin = 0, end = 0; begin < beside.size(); begin = end) {
        while (end < beside.size() && beside[end].first == beside[begin].first) ++end;
        seed.clear();
        sample(claims_[c].facets, seed);
        const std::size_t of_claim = seed.size();
        std::vector<PatchId> others;
        for (std::size_t i = begin; i < end; ++i) others.push_back(beside[i].second);
        sample(others, seed);
        if (seed.size() == of_claim) continue;
        collect(seed);
        const AnalyticSurface& band = claims_[c].shape;
        std::optional<Claim> best;
        if (const auto sphere = guess_sphere(points_)) grow(*sphere, seed, Taken::kWeakly, best);
        if (const auto torus = has_axis ? guess_torus(points_, band.origin, band.axis) : std::nullopt)
          grow(*torus, seed, Taken::kWeakly, best);
        if (!best) try_kinds(seed, Taken::kWeakly, best);
        if (best && replace(std::move(*best))) break;
      }
    }
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
    add(std::move(claim));
    for (const std::uint32_t o : owners) {
      Claim& old = claims_[o];
      std::erase_if(old.facets, [&](PatchId p) { return owner_[p] != o; });
      old.area = 0;
      for (const PatchId p : old.facets) old.area += graph_.area(p);
      constexpr std::size_t kMinFacets = 4;
      if (old.facets.size() >= kMinFacets) continue;
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
