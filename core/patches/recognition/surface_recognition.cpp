#include "core/patches/recognition/surface_recognition.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/geometry/surfaces/surface_fit.h"
#include "core/patches/recognition/explained_height.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/free_regions.h"
#include "core/patches/recognition/loose_claims.h"
#include "core/patches/recognition/recognised_list.h"
#include "core/patches/recognition/region_growing.h"
#include "core/patches/recognition/revolution_bands.h"
#include "core/patches/recognition/seed_filter.h"
#include "core/patches/recognition/surface_bends.h"
#include "core/patches/recognition/surface_seeds.h"

namespace remesh {
namespace {

/// A claim fits by chance if it has at most kMaxFacets facets, if more than kFreeShare of its border is with seas, and
/// if its area is below kMaxAreaShare of the largest sea's. A sea is a free region.
constexpr std::size_t kMaxFacets = 40;
constexpr double kFreeShare = 0.6, kMaxAreaShare = 0.05;

/// A claim does not fit by chance if it has at least this many facets and if all of their corners are within this part
/// of the tolerance.
constexpr std::size_t kMinClear = 9;
constexpr double kClear = 0.1;

/// Drops small claims in the middle of many facets that belong to no claim. They fit by chance, because a small piece
/// of any smooth surface is nearly a piece of a cylinder or a torus.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
void drop_false_fits(const FacetGraph& graph, ClaimTable& table, RunControl& control) {
  StopCheck check(control);
  std::optional<FreeRegions> seas;  // on most surfaces none is needed
  for (SurfaceClaim& claim : table.claims) {
    if (claim.facets.empty() || claim.facets.size() > kMaxFacets) continue;
    if (claim.facets.size() >= kMinClear && claim.deviation <= kClear * claim.tolerance) continue;
    if (!seas) seas.emplace(graph, table, control);
    double border = 0, shore = 0, sea = 0;
    for (const PatchId p : claim.facets)
      for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s) {
        check();
        const PatchId q = graph.beyond(s);
        if (q.is_valid() && table.owner[q] == table.owner[p]) continue;
        const double length = norm(graph.position(graph.end_vertex(s)) - graph.position(graph.vertex(s)));
        border += length;
        if (!q.is_valid()) continue;
        const double area = seas->area_of(q);
        if (area > 0) shore += length;
        sea = std::max(sea, area);
      }
    if (shore <= kFreeShare * border || claim.area >= kMaxAreaShare * sea) continue;
    for (const PatchId p : claim.facets) table.owner[p] = kNone;
    claim.facets.clear();
  }
}

/// A claim replaces smaller ones if its area is larger than the largest of theirs by this factor. The second factor is
/// for claims that are not close (see kCloseFit).
constexpr double kMuchLarger = 1.3, kMuchLargerIfDoubtful = 6;

/// A facet is no longer a seed after this many growths that reached it were given up.
constexpr std::uint8_t kMaxAttempts = 3;

/// A claim is close if all of its corners are within this many tolerances of its surface, or if rounding alone explains
/// nearly all of them: programs compute points where two surfaces meet less exactly than other points. Only close
/// claims are tried together with their neighbours.
constexpr double kCloseFit = 0.4;

/// Corners may be off their surface by this part of the chord height that the turn between two facets implies.
constexpr double kMaxOfHeight = 1.0 / 3;

/// If corners are off their surface, fewer facets than this determine no surface.
constexpr std::size_t kMinCluster = 4;

/// How much work growths without a result may take: in any case, for each facet of the mesh, and for each facet that
/// has been claimed. Where nothing is claimed, as on scans, the search ends soon.
struct VainWork {
  std::uint64_t free, per_facet, per_claimed;
};

/// The bound on all growths, on those of one pass that begin with two facets, and on those of one pass that begin with
/// a fit to facets around an edge. See experiments.md, Growths in vain.
constexpr VainWork kMaxVain{25'000'000, 100, 0}, kMaxVainOfRuled{1'000'000, 10, 2000}, kMaxVainOfPass{600'000, 2, 2000};

/// Two areas count as equal unless one is larger by this factor.
constexpr double kLarger = 1.02;

/// The facets of a band around an axis have their corners on a cone, on a sphere and on tori. Their chord height is
/// smallest on the surface from which they were made: there it is below this part of the chord heights on the others.
constexpr double kNearer = 0.9;

/// Makes the claims of all facets.
/// This class is larger than the bound because it has a short function for each way in which claims begin.
class Recogniser {
 public:
  Recogniser(const FacetGraph& graph, const RecognitionRules& rules, double unit, RunControl& control)
      : graph_(graph),
        min_tolerance_(rules.tolerance / unit),
        max_tolerance_(std::max(rules.tolerance, rules.printed) / unit),
        grower_(graph, control),
        table_(graph.size()),
        attempts_(graph.size(), 0),
        tried_(graph.size(), 0),
        guesses_(graph),
        check_(control),
        control_(control) {}

  std::vector<SurfaceClaim> run() {
    claim_ruled();
    replace_bands();
    // Facets of claims that were replaced in part are free again.
    if (are_any_freed_) claim_ruled();
    claim_scattered();
    drop_unexplained();
    claim_ruled();
    claim_clusters();
    join_bands(graph_, table_, control_);
    drop_bends(graph_, table_, control_);
    drop_false_fits(graph_, table_, control_);
    return take_claims();
  }

 private:
  /// Returns how far corners may be off a surface that grows from a seed: the distance that proven rounding explains,
  /// or else the distance that printed digits explain. The latter counts only up to a part of the chord height, because
  /// any smooth surface would fit otherwise.
  double tolerance_at(const SurfaceSeed& seed) const {
    return std::clamp(kMaxOfHeight * implied_chord_height(graph_, seed.facet, seed.side), min_tolerance_,
                      max_tolerance_);
  }

  bool is_free(PatchId p) const { return table_.owner[p] == kNone; }

  std::array<PatchId, 2> pair_of(const SurfaceSeed& seed) const { return {seed.facet, graph_.beyond(seed.side)}; }

  /// Calls claim(batch, is_enough) for batches of seeds in order, until growths without a result take too much work:
  /// first for a sample of the seeds, so that the large surfaces of a large mesh are found, and then for the others.
  template <class IsWanted, class Claim>
  void for_seeds(const VainWork& max, const IsWanted& is_wanted, const Claim& claim) {
    constexpr double kSample = 16384;
    constexpr std::size_t kFirstBatch = 256, kMaxBatch = 8192;
    const double part = kSample / static_cast<double>(graph_.size());
    const std::uint64_t before = wasted_;
    const auto is_enough = [&] { return is_exhausted() || wasted_ - before > bound_of(max); };
    std::vector<SurfaceSeed> batch;
    for (const bool is_sampled : {true, false}) {
      if (is_enough() || (!is_sampled && part >= 1)) return;
      SeedQueue seeds(
          find_seeds(graph_, control_,
                     [&](SurfaceSeed& seed) { return is_in_sample(seed, part) == is_sampled && is_wanted(seed); }),
          graph_, control_);
      const SurfaceSeed* next = seeds.next();
      for (std::size_t size = kFirstBatch; next != nullptr; size = std::min(2 * size, kMaxBatch)) {
        for (batch.clear(); next != nullptr && batch.size() < size; next = seeds.next()) batch.push_back(*next);
        claim(batch, is_enough);
        if (is_enough()) return;
      }
    }
  }

  /// Calls claim(seed) for seeds of free facets in the same way.
  template <class Claim>
  void for_free_seeds(const Claim& claim) {
    const auto is_wanted = [&](const SurfaceSeed& seed) {
      const auto [f, g] = pair_of(seed);
      return is_free(f) && is_free(g);
    };
    for_seeds(kMaxVainOfPass, is_wanted, [&](std::span<const SurfaceSeed> batch, const auto& is_enough) {
      for (const SurfaceSeed& seed : batch) {
        check_();
        if (is_enough()) return;
        claim(seed);
      }
    });
  }
  void claim_scattered() {
    for_free_seeds([&](const SurfaceSeed& seed) { claim_scattered(seed); });
  }
  void claim_clusters() {
    for_free_seeds([&](const SurfaceSeed& seed) { claim_cluster(seed); });
  }

  /// Claims surfaces that two facets determine. Before facets are claimed one surface after another, those seeds are
  /// found from which a surface would grow, batch by batch, because a claim may take the facets of later batches.
  void claim_ruled() {
    const auto is_wanted = [&](SurfaceSeed& seed) {
      if (!is_to_be_tried(seed)) return false;
      seed.kinds = kinds_that_may_begin(graph_, seed, max_tolerance_);
      return !seed.kinds.is_empty();
    };
    for_seeds(kMaxVainOfRuled, is_wanted, [&](std::span<const SurfaceSeed> batch, const auto& is_enough) {
      for (const std::vector<SurfaceSeed>& of_block : growing_seeds(batch))
        for (const SurfaceSeed& seed : of_block) {
          check_();
          if (is_enough()) return;
          claim_ruled(seed);
        }
    });
  }

  std::vector<std::vector<SurfaceSeed>> growing_seeds(std::span<const SurfaceSeed> batch) const {
    constexpr std::size_t kBlock = 64;
    return map_blocks<std::vector<SurfaceSeed>>(batch.size(), kBlock, control_,
                                                [&](std::size_t begin, std::size_t end) {
                                                  std::vector<SurfaceSeed> growing;
                                                  SeedGuesses guesses(graph_);
                                                  for (const SurfaceSeed& seed : batch.subspan(begin, end - begin))
                                                    if (may_any_grow(seed, guesses)) growing.push_back(seed);
                                                  return growing;
                                                });
  }

  bool may_any_grow(const SurfaceSeed& seed, SeedGuesses& guesses) const {
    if (!is_to_be_tried(seed)) return false;
    const double tolerance = tolerance_at(seed);
    const std::vector<AnalyticSurface>& of_seed = guesses.of(seed);
    return std::any_of(of_seed.begin(), of_seed.end(),
                       [&](const AnalyticSurface& guess) { return may_grow(graph_, guess, pair_of(seed), tolerance); });
  }

  bool is_to_be_tried(const SurfaceSeed& seed) const {
    const auto [f, g] = pair_of(seed);
    if (!is_free(f) || !is_free(g)) return false;
    if (attempts_[f] >= kMaxAttempts || attempts_[g] >= kMaxAttempts) return false;
    // The other pairs of facets have been tried before.
    return !must_be_explained_ || was_dropped_[f] != 0 || was_dropped_[g] != 0;
  }

  void claim_ruled(const SurfaceSeed& seed) {
    if (!is_to_be_tried(seed)) return;
    std::optional<SurfaceClaim> best;
    tolerance_ = tolerance_at(seed);
    for (const AnalyticSurface& guess : guesses_.of(seed)) grow(guess, pair_of(seed), Taken::kFree, best);
    if (best && best->shape.kind == SurfaceKind::kSphere && is_close(*best)) ask_again(best);
    if (!best) return;
    add(std::move(*best));
    replace_band(static_cast<std::uint32_t>(table_.claims.size() - 1));
  }

  /// Tries the other kinds on facets that a sphere fits. If these facets are a single ring around an axis, their
  /// corners lie on two circles, and a sphere through two circles proves nothing: a cone or a torus fits as well.
  void ask_again(std::optional<SurfaceClaim>& best) {
    std::vector<PatchId> seed;
    sample(best->facets, seed);
    collect(seed);
    const double height = sum_of_heights(best->shape, seed);
    const auto attempt = [&](const std::optional<AnalyticSurface>& guess) {
      const auto fitted = guess ? fit_from(*guess, points_, {tolerance_, 20 * tolerance_}) : std::nullopt;
      if (fitted && sum_of_heights(*fitted, seed) < kNearer * height) grow(*fitted, seed, Taken::kFree, best);
    };
    attempt(guess_cylinder(points_, places_));
    attempt(guess_cone(points_, places_));
    attempt(guess_torus(points_, places_));
  }

  double sum_of_heights(const AnalyticSurface& shape, std::span<const PatchId> facets) const {
    const SurfaceGauge gauge(shape);
    double sum = 0;
    for (const PatchId p : facets) sum += chord_height(graph_, gauge, p);
    return sum;
  }

  /// Stores the corners and middles of facets.
  void collect(std::span<const PatchId> facets) {
    points_.clear();
    places_.clear();
    for (const PatchId p : facets) {
      places_.push_back({graph_.mean_corner(p), graph_.normal(p)});
      graph_.for_each_corner(p, [&](const Vec3& q) { points_.push_back(q); });
    }
  }

  /// Grows, from the collected facets, surfaces of those kinds for which normals help to guess the start.
  void try_kinds(std::span<const PatchId> seed, Taken may_replace, std::optional<SurfaceClaim>& best) {
    constexpr std::uint64_t kWorkOfGuess = 40;
    wasted_ += kWorkOfGuess * points_.size();
    const auto attempt = [&](const std::optional<AnalyticSurface>& guess) {
      const auto fitted = guess ? fit_from(*guess, points_, {tolerance_, 20 * tolerance_}) : std::nullopt;
      if (fitted) grow(*fitted, seed, may_replace, best);
    };
    if (is_doubtful_) attempt(guess_sphere(points_));
    attempt(guess_cylinder(points_, places_));
    attempt(guess_cone(points_, places_));
    attempt(guess_torus(points_, places_));
  }

  /// Grows a surface, and takes it if it is better. Facets of growths that were given up are soon not tried again.
  void grow(const AnalyticSurface& guess, std::span<const PatchId> seed, Taken may_replace,
            std::optional<SurfaceClaim>& best) {
    if (is_exhausted()) return;
    const std::uint64_t before = grower_.work();
    std::optional<SurfaceClaim> claim = grower_.grow(guess, seed, {tolerance_, may_replace, is_doubtful_});
    if (!claim) wasted_ += grower_.work() - before;
    if (claim && !claim->is_explained && must_be_explained_) claim.reset();
    take_larger(std::move(claim), best);
    for (const PatchId p : grower_.given_up())
      if (attempts_[p] < kMaxAttempts) ++attempts_[p];
  }

  std::uint64_t bound_of(const VainWork& max) const {
    return max.free + max.per_facet * graph_.size() + max.per_claimed * claimed_;
  }

  /// Returns whether growths without a result have taken so much work that the rest of the facets is left free.
  bool is_exhausted() const { return wasted_ > bound_of(kMaxVain); }

  static void take_larger(std::optional<SurfaceClaim> claim, std::optional<SurfaceClaim>& best) {
    if (!claim) return;
    if (!best) {
      best = std::move(claim);
      return;
    }
    if (is_better(*claim, *best)) best = std::move(claim);
  }

  /// The larger surface is better. Of two surfaces of about the same size, the one that the facets explain is better,
  /// or else the one from which they deviate less, or else the one with fewer parameters.
  static bool is_better(const SurfaceClaim& a, const SurfaceClaim& b) {
    if (a.area > kLarger * b.area) return true;
    if (b.area > kLarger * a.area) return false;
    if (a.is_explained != b.is_explained) return a.is_explained;
    if (a.chord_height < kNearer * b.chord_height) return true;
    if (b.chord_height < kNearer * a.chord_height) return false;
    return parameter_count(a.shape.kind) < parameter_count(b.shape.kind);
  }

  void add(SurfaceClaim claim) {
    claimed_ += claim.facets.size();
    for (const PatchId p : claim.facets) grower_.set_taken(p, Taken::kWeakly);
    table_.add(std::move(claim));
  }

  /// Each band of facets around a torus or sphere is also a piece of a cone. The larger surface is claimed instead.
  void replace_bands() {
    for (std::uint32_t c = 0; c < table_.claims.size(); ++c) replace_band(c);
  }

  /// Returns whether a claim fits so well that it may be a piece of a larger surface that fits as well.
  bool is_close(const SurfaceClaim& claim) const {
    return claim.is_clear || claim.deviation <= kCloseFit * claim.tolerance;
  }

  void replace_band(std::uint32_t c) {
    if (is_exhausted()) return;
    if (!is_close(table_.claims[c])) return;
    std::vector<std::pair<std::uint32_t, PatchId>> beside;  // owner and facet
    for (const PatchId p : table_.claims[c].facets)
      graph_.for_each_neighbour(p, [&](PatchId q) {
        check_();
        if (table_.owner[q] != c && graph_.may_be_seed(q)) beside.push_back({table_.owner[q], q});
      });
    sort_unique(beside);
    for (std::size_t begin = 0, end = 0; begin < beside.size(); begin = end) {
      others_.clear();
      while (end < beside.size() && beside[end].first == beside[begin].first) others_.push_back(beside[end++].second);
      if (!are_compared_.insert(std::minmax(c, beside[begin].first)).second) continue;
      if (replace_with(c, others_)) return;
    }
  }

  /// Claims a surface from a band and facets beside it, if this surface is larger.
  bool replace_with(std::uint32_t c, std::span<const PatchId> others) {
    const AnalyticSurface band = table_.claims[c].shape;
    tolerance_ = table_.claims[c].tolerance;
    seed_.clear();
    sample(table_.claims[c].facets, seed_);
    sample(others, seed_);
    collect(seed_);
    std::optional<SurfaceClaim> best;
    if (const auto sphere = guess_sphere(points_)) grow(*sphere, seed_, Taken::kWeakly, best);
    if (band.kind == SurfaceKind::kCone || band.kind == SurfaceKind::kCylinder)
      if (const auto torus = guess_torus(points_, band.origin, band.axis)) grow(*torus, seed_, Taken::kWeakly, best);
    if (!best) try_kinds(seed_, Taken::kWeakly, best);
    return best && replace(std::move(*best));
  }

  /// Takes an evenly chosen sample of a list of facets.
  static void sample(std::span<const PatchId> facets, std::vector<PatchId>& chosen) {
    constexpr std::size_t kMaxSample = 16;
    const std::size_t step = (facets.size() + kMaxSample - 1) / kMaxSample;
    for (std::size_t i = 0; i < facets.size(); i += step) chosen.push_back(facets[i]);
  }

  /// Replaces the claims whose facets a new claim has, if the new claim is much larger than each of them.
  bool replace(SurfaceClaim claim) {
    std::vector<std::uint32_t> owners;
    double largest = 0;
    for (const PatchId p : claim.facets)
      if (table_.owner[p] != kNone) owners.push_back(table_.owner[p]);
    sort_unique(owners);
    for (const std::uint32_t o : owners) largest = std::max(largest, table_.claims[o].area);
    if (!(claim.area > kMuchLarger * largest)) return false;
    // Three or four bands of any surface of revolution are nearly a torus.
    if (!is_close(claim) && !(claim.area > kMuchLargerIfDoubtful * largest)) return false;
    add(std::move(claim));
    for (const std::uint32_t o : owners) {
      SurfaceClaim& old = table_.claims[o];
      std::erase_if(old.facets, [&](PatchId p) { return table_.owner[p] != o; });
      old.area = 0;
      for (const PatchId p : old.facets) old.area += graph_.area(p);
      constexpr std::size_t kMinFacets = 4;
      const bool has_axis = old.shape.kind == SurfaceKind::kCone || old.shape.kind == SurfaceKind::kCylinder;
      if (has_axis && old.facets.size() >= kMinFacets) continue;
      are_any_freed_ = are_any_freed_ || !old.facets.empty();
      for (const PatchId p : old.facets) {
        table_.owner[p] = kNone;
        grower_.set_taken(p, Taken::kFree);
      }
      old.facets.clear();
    }
    return true;
  }

  /// Claims a surface whose edges are no rulings, from a pair of facets with its neighbours.
  void claim_scattered(const SurfaceSeed& seed) {
    const std::array<PatchId, 2> pair = pair_of(seed);
    const auto is_in_pair = [&](PatchId p) { return p == pair[0] || p == pair[1]; };
    if (!is_to_be_seeded(pair, kTried)) return;
    seed_.assign(pair.begin(), pair.end());
    for (const PatchId p : pair)
      graph_.for_each_neighbour(p, [&](PatchId q) {
        if (is_free(q) && graph_.may_be_curved(q) && !is_in_pair(q)) seed_.push_back(q);
      });
    std::sort(seed_.begin() + 2, seed_.end());
    seed_.erase(std::unique(seed_.begin() + 2, seed_.end()), seed_.end());
    for (const PatchId p : seed_) tried_[p] = kTried;
    constexpr std::size_t kMinScattered = 4;
    if (seed_.size() < kMinScattered) return;
    collect(seed_);
    tolerance_ = tolerance_at(seed);
    std::optional<SurfaceClaim> best;
    try_kinds(seed_, Taken::kFree, best);
    if (best) add(std::move(*best));
  }

  bool is_to_be_seeded(std::span<const PatchId> pair, std::uint8_t tried) const {
    return std::all_of(pair.begin(), pair.end(), [&](PatchId p) { return is_free(p) && tried_[p] < tried; });
  }

  /// Claims a surface whose corners rounding has moved so far that two facets determine nothing, or whose corners a
  /// program has put beside the surface. Growths begin from all free facets near a seed.
  void claim_cluster(const SurfaceSeed& seed) {
    const std::array<PatchId, 2> pair = pair_of(seed);
    if (!is_to_be_seeded(pair, kTriedInCluster)) return;
    if (attempts_[pair[0]] >= kMaxAttempts || attempts_[pair[1]] >= kMaxAttempts) return;
    find_cluster(seed, seed_);
    for (const PatchId p : pair) tried_[p] = kTriedInCluster;
    if (seed_.size() < kMinCluster) return;
    collect(seed_);
    std::optional<SurfaceClaim> best;
    tolerance_ = tolerance_at(seed);
    try_kinds(seed_, Taken::kFree, best);
    if (!best) {
      tolerance_ = std::max(tolerance_, kMaxOfHeight * implied_height(seed_));
      is_doubtful_ = true;
      try_kinds(seed_, Taken::kFree, best);
      is_doubtful_ = false;
      if (best && !is_loose_claim_proven(graph_, *best, control_)) best.reset();
    }
    if (best) add(std::move(*best));
  }

  /// Drops claims whose facets are farther away than the turns between them explain. Until now, such claims were
  /// useful: they show which facets belong together, as a ring around a torus is a piece of a sphere, too.
  void drop_unexplained() {
    must_be_explained_ = true;
    was_dropped_.assign(graph_.size(), 0);
    for (SurfaceClaim& claim : table_.claims) {
      if (claim.facets.empty() || claim.is_explained) continue;
      for (const PatchId p : claim.facets) {
        table_.owner[p] = kNone;
        grower_.set_taken(p, Taken::kFree);
        was_dropped_[p] = 1;
      }
      claim.facets.clear();
    }
  }

  /// Returns the largest chord height that the turns between some facets imply.
  double implied_height(std::span<const PatchId> cluster) const {
    double height = 0;
    for (const PatchId p : cluster)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
        const PatchId q = graph_.beyond(s);
        if (q.is_valid() && std::find(cluster.begin(), cluster.end(), q) != cluster.end())
          height = std::max(height, implied_chord_height(graph_, p, s));
      }
    return height;
  }

  /// Finds the facets of a seed and whole rings of their free neighbours of about the same size, until there are enough
  /// for a guess.
  void find_cluster(const SurfaceSeed& seed, std::vector<PatchId>& cluster) const {
    constexpr std::size_t kEnough = 8, kTooMany = 64;
    constexpr double kAlike = 4;
    cluster.assign({seed.facet, graph_.beyond(seed.side)});
    const double area = kAlike * std::max(graph_.area(cluster[0]), graph_.area(cluster[1]));
    for (std::size_t begin = 0; cluster.size() < kEnough;) {
      const std::size_t end = cluster.size();
      std::vector<PatchId> ring;
      for (std::size_t i = begin; i < end; ++i)
        graph_.for_each_neighbour(cluster[i], [&](PatchId q) {
          if (is_free(q) && graph_.may_be_seed(q) && graph_.area(q) <= area) ring.push_back(q);
        });
      sort_unique(ring);
      std::erase_if(ring, [&](PatchId q) { return std::find(cluster.begin(), cluster.end(), q) != cluster.end(); });
      if (ring.empty() || cluster.size() + ring.size() > kTooMany) return;
      cluster.insert(cluster.end(), ring.begin(), ring.end());
      begin = end;
    }
  }

  std::vector<SurfaceClaim> take_claims() {
    std::erase_if(table_.claims, [](const SurfaceClaim& c) { return c.facets.empty(); });
    return std::move(table_.claims);
  }

  const FacetGraph& graph_;
  double min_tolerance_, max_tolerance_;         ///< the range of `tolerance_`
  double tolerance_ = 0;                         ///< of the growths of this seed
  bool is_doubtful_ = false;                     ///< whether the growths of this seed are doubtful
  IdVector<PatchId, std::uint8_t> was_dropped_;  ///< whether a facet was in a claim that was dropped
  bool are_any_freed_ = false;                   ///< whether a claim was replaced that had more facets
  bool must_be_explained_ = false;               ///< if true, no claim is made whose distance the facets do not explain
  ClaimGrower grower_;
  ClaimTable table_;
  IdVector<PatchId, std::uint8_t> attempts_;  ///< by facet: how many growths that reached it were given up
  static constexpr std::uint8_t kTried = 1, kTriedInCluster = 2;
  IdVector<PatchId, std::uint8_t> tried_;  ///< whether a facet was in the seed of a scattered surface, or in a cluster
  std::vector<Vec3> points_;
  std::vector<FacetPlace> places_;
  SeedGuesses guesses_;
  std::uint64_t wasted_ = 0;  ///< work of growths without a result
  std::size_t claimed_ = 0;   ///< facets of all claims that were made
  std::vector<PatchId> seed_, others_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> are_compared_;  ///< pairs of claims that were tried together
  StopCheck check_;
  RunControl& control_;
};

}  // namespace

RecognisedSurfaces recognise_surfaces(const Facets& facets, const RecognitionRules& rules, RunControl& control) {
  const FacetGraph graph(facets, rules.feature_angle_deg, control);
  std::vector<SurfaceClaim> claims;
  if (graph.has_smooth_edges()) claims = Recogniser(graph, rules, facets.surface.unit, control).run();
  return make_recognised_list(facets, graph, std::move(claims), rules, control);
}

}  // namespace remesh
