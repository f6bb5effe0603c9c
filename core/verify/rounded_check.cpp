#include "core/verify/rounded_check.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/rounded_to_float.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/intersections/patch_intersections.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/triangle_corners.h"
#include "core/verify/goals/goal_check.h"
#include "core/verify/model/fixed_width_integers.h"

namespace remesh {
namespace {

using verification::Standing;

/// The limits of the search for intersections. If the intersections of the verified mesh are all known, the search has
/// to find all new ones.
SearchLimits limits_of_search(const RoundedClaim& claim) {
  SearchLimits limits(SearchLimits::kEnoughPairs);
  const InputIntersections* const known = claim.intersections;
  if (known == nullptr) return limits;
  if (!known->is_complete)
    limits.max_steps = SearchLimits::few_steps_for(claim.faces.size());
  else
    limits.is_expected = [known, patch = claim.face_patch](FaceId f, FaceId g) {
      return known->has(patch[f.value], patch[g.value]);
    };
  return limits;
}

/// A run of consecutive verified triangles that belong to one patch.
struct FaceRun {
  PatchId patch;
  std::uint32_t faces = 0;
  double move = 0;          ///< largest move of their corners
  bool is_moved = false;    ///< the stored points differ from the verified ones
  bool is_positive = true;  ///< seen along an axis, all of them are positively oriented
  double swept_volume = 0;  ///< bound on the volume between the verified and the stored triangles
};

/// The plane coordinates of a patch along the axis that it faces most. They are taken without arithmetic, so nothing
/// is rounded.
class Flattening {
 public:
  explicit Flattening(const Vec3& normal) {
    const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
    axis_ = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    is_turned_ = normal[axis_] < 0;
  }
  Vec2 operator()(const Vec3& p) const {
    const Vec2 flat{p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]};
    return is_turned_ ? Vec2{flat.y, flat.x} : flat;
  }

 private:
  int axis_ = 0;
  bool is_turned_ = false;
};

/// A number without a pattern for each vertex. Different vertices have different numbers.
/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014 (the mixer of splitmix64).
std::uint64_t scrambled(VertexId v) {
  std::uint64_t x = (std::uint64_t{v.value} + 1) * 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// True if the triangle certainly points along the normal. The computation errs by a few roundings of the product
/// of two sides.
bool looks_along(const std::array<Vec3, 3>& t, const Vec3& normal) {
  constexpr double kNoise = 1e-14;
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  return dot(cross(ab, ac), normal) > kNoise * norm(ab) * norm(ac);
}

class StoredCheck {
 public:
  StoredCheck(const RoundedClaim& claim, RunControl& control)
      : claim_(claim), control_(control), has_origin_(claim.origin != Vec3{}) {}

  RoundedVerdict run() {
    if (!is_well_formed()) {
      fail(RoundedFault::kMalformed, 1);
      return std::move(verdict_);
    }
    const bool is_good = check_numbers() && check_moves();
    if (!is_good || !is_any_moved()) return std::move(verdict_);
    if (check_places() && check_triangles() && check_goals()) check_intersections();
    return std::move(verdict_);
  }

 private:
  bool fail(RoundedFault fault, std::uint64_t count) {
    verdict_.fault = fault;
    verdict_.count = count;
    return false;
  }

  /// Counts the indices of 0 .. n - 1 for which `is_wrong` is true.
  /// Output: true if there are none.
  template <class IsWrong>
  bool check_all(RoundedFault fault, std::size_t n, const IsWrong& is_wrong) {
    const auto counts = map_blocks<std::uint64_t>(n, kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      std::uint64_t count = 0;
      for (std::size_t i = begin; i < end; ++i) count += is_wrong(i) ? 1 : 0;
      return count;
    });
    const std::uint64_t count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    return count == 0 || fail(fault, count);
  }

  bool is_well_formed() const {
    const auto are_ascending = [&](std::span<const FaceId> faces) {
      return std::adjacent_find(faces.begin(), faces.end(), std::greater_equal<>()) == faces.end() &&
             (faces.empty() || faces.back().value < claim_.faces.size());
    };
    if (!claim_.is_curved.empty() && claim_.is_curved.size() != claim_.normals.size()) return false;
    if (claim_.stored.size() != claim_.positions.size() || claim_.face_patch.size() != claim_.faces.size())
      return false;
    const std::size_t listed = claim_.unrefined_before.size();
    if (claim_.reasons_before.size() != listed || claim_.misses_sizes_before.size() != listed ||
        !are_ascending(claim_.unrefined_before))
      return false;
    const RefinementClaim* const now = claim_.refinement;
    if (now != nullptr && (now->unrefined.size() != now->reasons.size() || !are_ascending(now->unrefined)))
      return false;
    const auto is_vertex = [&](VertexId v) { return v.value < claim_.positions.size(); };
    return std::all_of(claim_.faces.begin(), claim_.faces.end(),
                       [&](const Triangle& face) { return std::all_of(face.begin(), face.end(), is_vertex); }) &&
           std::all_of(claim_.face_patch.begin(), claim_.face_patch.end(),
                       [&](PatchId p) { return p.value < claim_.normals.size(); });
  }

  bool check_numbers() {
    const auto is_stored = [&](double x) { return claim_.storage == Storage::kDouble || rounded_to_float(x) == x; };
    return check_all(RoundedFault::kBeyondRange, claim_.stored.size(),
                     [&](std::size_t v) { return !is_finite(claim_.stored[v]); }) &&
           check_all(RoundedFault::kNotStorable, claim_.stored.size(), [&](std::size_t v) {
             const Vec3& p = claim_.stored[v];
             return !(is_stored(p.x) && is_stored(p.y) && is_stored(p.z));
           });
  }

  /// Checks the moves of all vertices, and finds the largest move of each patch.
  bool check_moves() {
    moves_.resize(claim_.stored.size());
    for_blocks(moves_.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        moves_[v] = norm((claim_.origin + claim_.stored[v]) - claim_.positions[v]);
    });
    for (const double move : moves_) verdict_.largest_move = std::max(verdict_.largest_move, move);
    verdict_.patch_moves.assign(claim_.normals.size(), 0);
    const auto blocks =
        map_blocks<std::vector<FaceRun>>(claim_.faces.size(), kItemsPerBlock, control_,
                                         [&](std::size_t begin, std::size_t end) { return runs_of(begin, end); });
    for (const auto& runs : blocks)
      for (const FaceRun& run : runs) {
        double& move = verdict_.patch_moves[run.patch.value];
        move = std::max(move, run.move);
        verdict_.volume_bound += run.swept_volume;
        runs_.push_back(run);
      }
    return check_all(RoundedFault::kMoved, moves_.size(),
                     [&](std::size_t v) { return !(moves_[v] <= claim_.allowed_move); });
  }

  std::vector<FaceRun> runs_of(std::size_t begin, std::size_t end) const {
    std::vector<FaceRun> runs;
    for (std::size_t f = begin; f < end; ++f) {
      const PatchId p = claim_.face_patch[f];
      if (runs.empty() || runs.back().patch != p) runs.push_back({p});
      FaceRun& run = runs.back();
      ++run.faces;
      const Flattening flat(claim_.normals[p.value]);
      const auto [a, b, c] = corners(claim_.stored, f);
      run.is_positive = run.is_positive && !is_curved(p) && orient2d(flat(a), flat(b), flat(c)) > 0;
      if (!is_moved(f)) continue;
      run.is_moved = true;
      double move = 0;
      for (const VertexId v : claim_.faces[f]) move = std::max(move, moves_[v.value]);
      run.move = std::max(run.move, move);
      run.swept_volume += swept_volume(f, move);
    }
    return runs;
  }

  /// A bound on the volume that a triangle sweeps if its corners move by no more than `move`: its largest area on the
  /// way times the move.
  double swept_volume(std::size_t f, double move) const {
    const auto [a, b, c] = corners(claim_.positions, f);
    const double area = norm(cross(b - a, c - a)) / 2;
    return move * (area + move * (norm(b - a) + norm(c - a)) + 2 * move * move);
  }

  bool is_curved(PatchId p) const { return !claim_.is_curved.empty() && claim_.is_curved[p.value] != 0; }

  bool is_any_moved() const {
    return has_origin_ || std::any_of(runs_.begin(), runs_.end(), [](const FaceRun& run) { return run.is_moved; });
  }
  /// With an origin, every vertex counts as moved. Even if a reader gets back the exact point, the point was rounded
  /// when the origin was subtracted.
  bool is_moved(std::size_t f) const {
    const auto& [a, b, c] = claim_.faces[f];
    return has_origin_ || moves_[a.value] != 0 || moves_[b.value] != 0 || moves_[c.value] != 0;
  }

  std::array<Vec3, 3> corners(std::span<const Vec3> positions, std::size_t f) const {
    const auto& [a, b, c] = claim_.faces[f];
    return {positions[a.value], positions[b.value], positions[c.value]};
  }

  bool check_places() {
    std::vector<std::uint32_t> order(claim_.stored.size());
    std::iota(order.begin(), order.end(), 0u);
    sort_stoppable(order.begin(), order.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
      const Vec3 &p = claim_.stored[a], &q = claim_.stored[b];
      return p != q ? p < q : a < b;
    });
    return check_all(RoundedFault::kMerged, order.size(),
                     [&](std::size_t i) { return i > 0 && claim_.stored[order[i]] == claim_.stored[order[i - 1]]; });
  }

  bool check_triangles() {
    return check_all(RoundedFault::kTurnedOver, claim_.faces.size(),
                     [&](std::size_t f) { return is_moved(f) && is_turned_over(f); });
  }

  /// A triangle that had an area and pointed along its patch's normal, as far as doubles tell, must still do so. Any
  /// other triangle may point in any direction, but must not lose its area.
  bool is_turned_over(std::size_t f) const {
    const PatchId p = claim_.face_patch[f];
    const auto after = corners(claim_.stored, f);
    if (!is_curved(p) && looks_along(after, claim_.normals[p.value])) return false;
    const auto before = corners(claim_.positions, f);
    const Vec3 normal =
        is_curved(p) ? normalized(cross(before[1] - before[0], before[2] - before[0])) : claim_.normals[p.value];
    if (is_curved(p) && looks_along(after, normal)) return false;
    if (verification::is_collinear(before[0], before[1], before[2])) return false;
    if (verification::is_collinear(after[0], after[1], after[2])) return true;
    return !looks_along(before, -normal);
  }

  bool check_goals() {
    if (claim_.refinement == nullptr) return true;
    const RefinementClaim& now = *claim_.refinement;
    const Goals goals = goals_after_rounding(now.goals, verdict_.largest_move);
    const auto standing_now = [&](std::size_t f) { return standing(goals, claim_.stored, f); };
    return check_all(RoundedFault::kUnlisted, claim_.faces.size(),
                     [&](std::size_t f) {
                       return is_moved(f) && !is_listed(now.unrefined, f) && standing_now(f) == Standing::kMisses;
                     }) &&
           check_all(RoundedFault::kListedInVain, now.unrefined.size(),
                     [&](std::size_t i) {
                       const FaceId f = now.unrefined[i];
                       return standing_now(f.value) == Standing::kMeets && !is_listed_for_sizes(f);
                     }) &&
           check_all(RoundedFault::kWrongReason, now.unrefined.size(),
                     [&](std::size_t i) { return !is_reason(now.unrefined[i], now.reasons[i]); });
  }

  Standing standing(const Goals& goals, std::span<const Vec3> positions, std::size_t f) const {
    const auto [a, b, c] = corners(positions, f);
    return verification::standing_of(goals, a, b, c);
  }

  static bool is_listed(std::span<const FaceId> faces, std::size_t f) {
    return std::binary_search(faces.begin(), faces.end(), FaceId(f));
  }

  /// Returns whether the face was in the list of unrefined faces before rounding, because it misses a bound that varies
  /// from place to place. The check of the mesh before rounding has tested whether it may be in that list.
  bool is_listed_for_sizes(FaceId f) const {
    const auto before = std::lower_bound(claim_.unrefined_before.begin(), claim_.unrefined_before.end(), f);
    return before != claim_.unrefined_before.end() && *before == f &&
           claim_.misses_sizes_before[before - claim_.unrefined_before.begin()] != 0;
  }

  bool is_reason(FaceId f, UnrefinedReason reason) const {
    const auto before = std::lower_bound(claim_.unrefined_before.begin(), claim_.unrefined_before.end(), f);
    const bool was_listed = before != claim_.unrefined_before.end() && *before == f;
    if (reason != UnrefinedReason::kOutputRounding)
      return was_listed && claim_.reasons_before[before - claim_.unrefined_before.begin()] == reason;
    return !was_listed && is_moved(f.value) &&
           standing(claim_.refinement->goals, claim_.positions, f.value) != Standing::kMisses;
  }

  bool is_known(PatchId p, PatchId q) const {
    return claim_.intersections != nullptr && claim_.intersections->has(p, q);
  }

  bool check_intersections() {
    const std::vector<std::uint8_t> is_simple = simple_patches();
    std::vector<Vec3> normals(claim_.normals.begin(), claim_.normals.end());
    for (std::size_t p = 0; p < normals.size(); ++p)
      if (is_curved(PatchId(p))) normals[p] = {0, 0, 1};  // any direction serves
    const bool is_known_complete = claim_.intersections == nullptr || claim_.intersections->is_complete;
    SelfIntersections found =
        patch_intersections({claim_.stored, corners_of(claim_.faces), claim_.face_patch, normals, is_simple},
                            limits_of_search(claim_), control_);
    std::uint64_t count = 0;
    if (is_known_complete)
      for (const auto& [f, g] : found.pairs)
        if (!is_known(claim_.face_patch[f.value], claim_.face_patch[g.value])) ++count;
    verdict_.has_intersections = true;
    verdict_.are_all_intersections_known = is_known_complete && found.is_complete;
    verdict_.intersections = std::move(found.pairs);
    verdict_.searched = found.searched;
    return count == 0 || fail(RoundedFault::kNewIntersections, count);
  }

  /// Marks the patches in which certainly no face meets another face of the same patch, and the patches for which that
  /// does not matter because such faces met before rounding.
  /// Suppose that all triangles of a patch are positive, seen along an axis. Then the number of triangles over a point
  /// is the number of times that the patch's boundary winds around it. The boundary winds at most once if it was simple
  /// before and no two of its edges meet now. The edges do not meet if the triangles at them do not. So only the
  /// triangles at the boundary are compared with each other, in the plane. If they meet, or if some triangle is not
  /// positive, the patch is not called simple, and patch_intersections tests all of its triangles in space.
  std::vector<std::uint8_t> simple_patches() {
    struct Seen {
      std::uint64_t faces = 0;
      bool is_moved = false, is_positive = true;
    };
    std::vector<Seen> seen(claim_.normals.size());
    for (const FaceRun& run : runs_) {
      Seen& of_patch = seen[run.patch.value];
      of_patch.faces += run.faces;
      of_patch.is_moved = of_patch.is_moved || run.is_moved;
      of_patch.is_positive = of_patch.is_positive && run.is_positive;
    }
    std::vector<std::uint8_t> is_simple(seen.size(), 1), is_asked(seen.size(), 0);
    bool is_any_asked = false;
    for (std::uint32_t p = 0; p < seen.size(); ++p) {
      if (!seen[p].is_moved || seen[p].faces <= kFewFaces || is_known(PatchId(p), PatchId(p))) continue;
      if (seen[p].is_positive)
        is_any_asked = (is_asked[p] = 1) != 0;
      else
        is_simple[p] = 0;
    }
    if (is_any_asked) find_overlaps(is_asked, is_simple);
    return is_simple;
  }

  /// Removes the mark `is_simple` from those given patches whose triangles at the boundary meet in the plane.
  void find_overlaps(const std::vector<std::uint8_t>& is_asked, std::vector<std::uint8_t>& is_simple) {
    const std::vector<std::uint8_t> is_rim = rim_vertices();
    const auto rim = select_ids<FaceId>(claim_.faces.size(), kItemsPerBlock, control_, [&](std::size_t f) {
      const auto& [a, b, c] = claim_.faces[f];
      return is_asked[claim_.face_patch[f].value] != 0 && is_rim[a.value] + is_rim[b.value] + is_rim[c.value] >= 2;
    });
    // The faces of each patch are copied onto a plane of its own, with vertices of its own.
    using Key = std::pair<PatchId, VertexId>;
    std::vector<Key> keys;
    keys.reserve(3 * rim.size());
    for (const FaceId f : rim)
      for (const VertexId v : claim_.faces[f.value]) keys.emplace_back(claim_.face_patch[f.value], v);
    sort_unique(keys, control_);
    control_.check();
    const double unit = std::exp2(std::ilogb(std::max(largest_coordinate(claim_.stored, control_), 0x1p-900)));
    std::vector<Vec3> flat(keys.size());
    for_blocks(keys.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto [p, v] = keys[i];
        const Vec2 at = Flattening(claim_.normals[p.value])(claim_.stored[v.value]);
        flat[i] = {at.x, at.y, unit * p.value};
      }
    });
    std::vector<Triangle> faces(rim.size());
    for_blocks(faces.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (int k = 0; k < 3; ++k) {
          const Key key(claim_.face_patch[rim[i].value], claim_.faces[rim[i].value][k]);
          faces[i][k] =
              VertexId(static_cast<std::size_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin()));
        }
    });
    const SelfIntersections found = self_intersections(
        flat, faces, {}, {SearchLimits::kEnoughPairs, SearchLimits::steps_for(faces.size())}, control_);
    for (const auto& [f, g] : found.pairs) is_simple[claim_.face_patch[rim[f.value].value].value] = 0;
    if (found.is_complete) return;
    for (std::size_t p = 0; p < is_simple.size(); ++p)
      if (is_asked[p] != 0) is_simple[p] = 0;
  }

  /// Marks the vertices on the boundary of a patch: they have faces of several patches, or the faces around them are
  /// not closed. Around an inner vertex, every neighbour is once the next corner of a face and once the previous one.
  /// So if the neighbours' numbers are added as next corners and subtracted as previous corners, the sum is 0.
  std::vector<std::uint8_t> rim_vertices() {
    std::vector<std::atomic<std::uint64_t>> sum(claim_.stored.size());
    std::vector<std::atomic<std::uint32_t>> patch(claim_.stored.size());
    std::vector<std::uint8_t> is_rim(claim_.stored.size(), 0);
    for_blocks(patch.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) patch[v].store(kNone, std::memory_order_relaxed);
    });
    for_blocks(claim_.faces.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        for (int k = 0; k < 3; ++k) {
          const Triangle& face = claim_.faces[f];
          const std::uint32_t v = face[k].value;
          sum[v].fetch_add(scrambled(face[(k + 1) % 3]) - scrambled(face[(k + 2) % 3]), std::memory_order_relaxed);
          std::uint32_t known = kNone;
          const bool is_first =
              patch[v].compare_exchange_strong(known, claim_.face_patch[f].value, std::memory_order_relaxed);
          if (!is_first && known != claim_.face_patch[f].value)
            std::atomic_ref(is_rim[v]).store(1, std::memory_order_relaxed);
        }
    });
    for_blocks(is_rim.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        if (sum[v].load(std::memory_order_relaxed) != 0) is_rim[v] = 1;
    });
    return is_rim;
  }

  const RoundedClaim& claim_;
  RunControl& control_;
  const bool has_origin_;
  std::vector<double> moves_;  ///< the move of each vertex
  std::vector<FaceRun> runs_;
  RoundedVerdict verdict_;
};

}  // namespace

Goals goals_after_rounding(const Goals& goals, double move) {
  constexpr double kMaxShare = 9e-7;
  Goals after = goals;
  after.max_edge_length += std::min(2 * move, kMaxShare * goals.max_edge_length);
  // The height over each side of the largest permitted equilateral triangle grows by at most twice the move.
  const double side = std::sqrt(4 / std::numbers::sqrt3 * goals.max_area);
  const double growth = (side + 2 * move) / side;
  if (growth > 1) after.max_area *= std::min(growth * growth, 1 + kMaxShare);
  return after;
}

RoundedVerdict check_rounded(const RoundedClaim& claim, RunControl& control) {
  return StoredCheck(claim, control).run();
}

}  // namespace remesh
