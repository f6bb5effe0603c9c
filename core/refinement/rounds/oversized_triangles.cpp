#include "core/refinement/rounds/oversized_triangles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/large_first.h"
#include "core/base/stoppable.h"
#include "core/base/work_bound.h"
#include "core/refinement/goals/unrefined.h"

namespace remesh {
namespace {

/// A patch with more triangles than this is divided among several threads.
constexpr std::size_t kLarge = 1000;
/// The number of triangles in a task. Each takes some microseconds.
constexpr std::size_t kTrianglesOfBlock = 256;

/// A relative slack for rounding when edges are compared with the sizes at which refinement aimed.
constexpr double kAimSlack = 1 + 1e-9;

/// The triangles begin .. end - 1 of a patch.
struct Block {
  PatchId patch;
  std::uint32_t begin, end;

  std::uint32_t size() const { return end - begin; }
};

/// The measures of a triangle. Lengths and places are in local units, so that no square under- or overflows.
struct Measured {
  std::array<double, 3> length;
  std::array<Vec3, 3> middle;
  Vec3 centroid;

  Measured(const Vec3& a, const Vec3& b, const Vec3& c) : centroid((1.0 / 3) * (a + b + c)) {
    const std::array<Vec3, 4> around{a, b, c, a};
    for (std::size_t k = 0; k < 3; ++k) {
      length[k] = norm(around[k + 1] - around[k]);
      middle[k] = 0.5 * (around[k] + around[k + 1]);
    }
  }

  /// Returns the largest size at a place for which at least one edge is still too long.
  double too_small_size(const Vec3& place, double slope) const {
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k)
      size = std::max(size, length[k] / Goals::kSizeSlack - slope * norm(middle[k] - place));
    return size;
  }
};

class MissSearch {
 public:
  MissSearch(const Surface& surface, const PatchMeshes& meshes, const IdVector<PatchId, std::uint8_t>& is_frozen,
             const VaryingBounds& bounds, Refinement& refinement, RunControl& control)
      : surface_(surface),
        meshes_(meshes),
        is_frozen_(is_frozen),
        bounds_(bounds),
        slope_(bounds.goals.size_slope()),
        tolerance_(bounds.plane_tolerance / surface.unit),
        largest_(bounds.sizes.largest() / surface.unit),
        refinement_(refinement),
        control_(control) {
    first_.push_back(0);
    for (const PatchMesh& patch : meshes) first_.push_back(first_.back() + patch.mesh.triangle_count());
    refinement_.misses_sizes.assign(first_.back(), 0);
    max_steps_ = kWorkOfMisses.steps(0, first_.back());
  }

  void run() {
    const auto work = [&](std::size_t p) { return first_[p + 1] - first_[p]; };
    for_large_first(meshes_.size(), kLarge, work, control_, [&](std::size_t p) {
      for_blocks(work(p), kTrianglesOfBlock, control_, [&](std::size_t begin, std::size_t end) {
        const Block block{PatchId(p), static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
        if (bounds_.gaps == nullptr)
          look_at_edges(block);
        else if (!look_for_gaps(block, share_of(block), Rest::kWaits))
          add_unfinished(block);
      });
    });
    finish();
    const auto& misses = refinement_.misses_sizes;
    if (std::all_of(misses.begin(), misses.end(), [](std::uint8_t m) { return m == 0; }))
      refinement_.misses_sizes.clear();
  }

 private:
  Vec3 position(VertexId v) const {
    if (v.value < surface_.vertex_count()) return surface_.local[v];
    return (1 / surface_.unit) * (refinement_.new_positions[v.value - surface_.vertex_count()] - surface_.centre);
  }
  Vec3 in_model(const Vec3& place) const { return surface_.centre + surface_.unit * place; }
  Measured measure(const PatchMesh& patch, std::uint32_t t) const {
    const auto corner = [&](std::uint32_t k) { return position(patch.vertices[patch.mesh.from(3 * t + k)]); };
    return {corner(0), corner(1), corner(2)};
  }
  std::uint8_t& is_missed(PatchId p, std::uint32_t t) { return refinement_.misses_sizes[first_[p.value] + t]; }

  /// Returns the gap at a place below which the triangle is too large there.
  double too_small_gap(const Measured& triangle, const Vec3& place) const {
    return triangle.too_small_size(place, slope_) * bounds_.goals.proximity - tolerance_;
  }

  bool allows(const SizeField& sizes, double length, const Vec3& middle) const {
    return sizes.allows(length * surface_.unit, in_model(middle));
  }

  double size_of(double gap) const { return (gap + tolerance_) / bounds_.goals.proximity; }

  /// Returns the steps that a block may take at first: a part of its share of the stage's steps. Nearly all blocks need
  /// less.
  std::uint64_t share_of(const Block& block) const {
    constexpr std::uint64_t kAtFirst = 4;
    return max_steps_ / kAtFirst / first_.back() * block.size();
  }

  void add_unfinished(const Block& block) {
    const std::lock_guard lock(unfinished_mutex_);
    unfinished_.push_back(block);
  }

  /// Treats again the blocks that needed more steps than they were allowed. They get the steps that the finished blocks
  /// have not used, one batch after the other. If there are many such blocks, the first ones may take far more than
  /// their share, so that at least some are completed.
  void finish() {
    constexpr std::size_t kBatches = 16, kMinBatch = 64;
    constexpr std::uint64_t kUneven = 16;
    sort_stoppable(unfinished_.begin(), unfinished_.end(), control_, [](const Block& a, const Block& b) {
      return std::tie(a.patch, a.begin) < std::tie(b.patch, b.begin);
    });
    const auto triangles_of = [](std::span<const Block> blocks) {
      std::uint64_t triangles = 0;
      for (const Block& block : blocks) triangles += block.size();
      return triangles;
    };
    std::uint64_t triangles = triangles_of(unfinished_);
    const std::size_t size = std::max(kMinBatch, unfinished_.size() / kBatches);
    for (std::size_t first = 0; first < unfinished_.size(); first += size) {
      const auto batch = std::span(unfinished_).subspan(first, std::min(size, unfinished_.size() - first));
      const std::uint64_t in_batch = triangles_of(batch);
      const std::uint64_t left = max_steps_ - std::min(max_steps_, taken_.load());
      const std::uint64_t share = left / triangles * std::min(kUneven, triangles / in_batch);
      for_blocks(batch.size(), 1, control_,
                 [&](std::size_t i, std::size_t) { look_for_gaps(batch[i], share * batch[i].size(), Rest::kUnknown); });
      triangles -= in_batch;
    }
  }

  /// The record for the triangles of a block that were not tested when the steps had been taken.
  enum class Rest {
    kWaits,    ///< nothing of the block is recorded, because it is treated again
    kUnknown,  ///< they are recorded as possibly missing their bounds
  };

  /// Returns false if there were too few steps to test all triangles of the block.
  bool look_for_gaps(const Block& block, std::uint64_t max_steps, Rest rest) {
    const PatchMesh& patch = meshes_[block.patch];
    std::vector<Measured> measured;
    measured.reserve(block.size());
    for (std::uint32_t t = block.begin; t < block.end; ++t) measured.push_back(measure(patch, t));
    std::vector<double> asked(block.size(), HUGE_VAL);
    WorkBound work(max_steps, &control_);
    const std::uint32_t seen = look_for_gaps(block, measured, work, asked);
    taken_ += work.taken();
    if (seen < block.size() && rest == Rest::kWaits) return false;
    for (std::uint32_t i = 0; i < block.size(); ++i) {
      if (asked[i] < HUGE_VAL)
        note(block.patch, block.begin + i, measured[i], asked[i]);
      else if (i >= seen && may_miss(measured[i]))
        record_unknown(block.patch, block.begin + i);
    }
    return seen == block.size();
  }

  /// Returns whether a gap may be too small for the triangle, judged by the triangle alone.
  bool may_miss(const Measured& triangle) const {
    const auto matters = [&](const Vec3& place) { return too_small_gap(triangle, place) > tolerance_; };
    return matters(triangle.centroid) || std::any_of(triangle.middle.begin(), triangle.middle.end(), matters);
  }

  /// Lowers the sizes of triangles to what their places require, if the triangles are too large there; other sizes stay
  /// as they are.
  /// Output: the number of triangles, from the first of the block on, that have been tested at all their places.
  std::uint32_t look_for_gaps(const Block& block, std::span<const Measured> measured, WorkBound& work,
                              std::span<double> asked) const {
    const Triangulation2d& mesh = meshes_[block.patch].mesh;
    // All gaps that are too small for the floor give the same reason, so the smallest of them is not needed.
    const double at_floor = bounds_.sizes.floor() / surface_.unit * bounds_.goals.proximity - tolerance_;
    // Triangles on both sides of the place may be too large for a gap. A limit of 0 means that there is no such
    // triangle.
    const auto gap_at = [&](const Vec3& place, double limit, double limit_there) {
      const auto [low, high] = std::minmax(limit, limit_there);
      if (!(high > tolerance_)) return HUGE_VAL;
      // A gap below the tolerance does not count. If the lower limit is below the tolerance, only the higher limit
      // matters.
      const double lower = low > tolerance_ ? low : high;
      const double enough = (at_floor > tolerance_ ? std::min(at_floor, lower) : lower) / kAimSlack;
      return bounds_.gaps->at(in_model(place), block.patch, high * surface_.unit, &work, enough * surface_.unit) /
             surface_.unit;
    };
    // The centroids are tested first. Most triangles that are too large are so there, and their edges need no search.
    for (std::uint32_t i = 0; i < block.size(); ++i) {
      control_.check();
      const double limit = too_small_gap(measured[i], measured[i].centroid);
      const double gap = gap_at(measured[i].centroid, limit, 0);
      if (work.is_spent()) return 0;  // the search may have ended early
      if (gap < limit) asked[i] = size_of(gap);
    }
    for (std::uint32_t i = 0; i < block.size(); ++i) {
      control_.check();
      for (std::uint32_t k = 0; k < 3; ++k) {
        // The middle of an edge inside the patch is tested once for both its triangles, if they are in one block.
        const std::uint32_t twin = mesh.twin(3 * (block.begin + i) + k);
        const bool is_shared = twin != Triangulation2d::kNoHalfEdge && twin / 3 >= block.begin && twin / 3 < block.end;
        const std::uint32_t there = is_shared ? twin / 3 - block.begin : i;
        if (there < i) continue;
        const Vec3& middle = measured[i].middle[k];
        const auto limit_of = [&](std::uint32_t j) {
          return asked[j] < HUGE_VAL ? 0 : too_small_gap(measured[j], middle);
        };
        const double limit = limit_of(i), limit_there = is_shared ? limit_of(there) : 0;
        const double gap = gap_at(middle, limit, limit_there);
        if (work.is_spent()) return i;
        if (gap < limit) asked[i] = size_of(gap);
        if (gap < limit_there) asked[there] = size_of(gap);
      }
    }
    return block.size();
  }

  void look_at_edges(const Block& block) {
    for (std::uint32_t t = block.begin; t < block.end; ++t) {
      const Measured here = measure(meshes_[block.patch], t);
      const auto is_too_long = [&](std::size_t k) {
        return !allows(*bounds_.graded, here.length[k] / Goals::kSizeSlack, here.middle[k]);
      };
      // All segments were taken into account when sizes were chosen. So an edge that is as short as was aimed at can be
      // too long only because of the floor.
      if (is_too_long(0) || is_too_long(1) || is_too_long(2)) note(block.patch, t, here, 0);
    }
  }

  /// Records that a triangle misses its bound. Some place of the triangle requires `size`.
  void note(PatchId p, std::uint32_t t, const Measured& triangle, double size) {
    is_missed(p, t) = kMissesSizes;
    if (is_frozen_[p] != 0) return;
    UnrefinedReason& reason = refinement_.reason[first_[p.value] + t];
    const double floor = bounds_.sizes.floor() / surface_.unit;
    const auto is_as_aimed_at = [&](std::size_t k) {
      const double length = triangle.length[k] / kAimSlack;
      return length <= std::min(floor, largest_) || allows(bounds_.sizes, length, triangle.middle[k]);
    };
    // A triangle at a sharp corner of the input may have a small angle, but must not be too large.
    if (!is_excuse(reason) && !(is_as_aimed_at(0) && is_as_aimed_at(1) && is_as_aimed_at(2))) return;
    if (floor < size)
      reason = UnrefinedReason::kEffort;
    else
      reason = bounds_.sizes.is_min_edge_user_limit() ? UnrefinedReason::kMinEdgeLength : UnrefinedReason::kSizeFloor;
  }

  /// A sharp corner of the input does not excuse a triangle that is too large, nor one that may be too large.
  void record_unknown(PatchId p, std::uint32_t t) {
    is_missed(p, t) = kMayMissSizes;
    if (UnrefinedReason& reason = refinement_.reason[first_[p.value] + t]; is_frozen_[p] == 0 && is_excuse(reason))
      reason = UnrefinedReason::kEffort;
  }

  static bool is_excuse(UnrefinedReason reason) {
    return reason == UnrefinedReason::kInputAngle || reason == UnrefinedReason::kAcrossInputAngle;
  }

  const Surface& surface_;
  const PatchMeshes& meshes_;
  const IdVector<PatchId, std::uint8_t>& is_frozen_;
  const VaryingBounds& bounds_;
  const double slope_;
  const double tolerance_, largest_;  ///< local units
  Refinement& refinement_;
  RunControl& control_;
  std::vector<std::size_t> first_;  ///< index of each patch's first triangle
  std::uint64_t max_steps_ = 0;
  std::atomic<std::uint64_t> taken_ = 0;
  std::mutex unfinished_mutex_;
  std::vector<Block> unfinished_;
};

}  // namespace

void record_oversized_triangles(const Surface& surface, const PatchMeshes& meshes,
                                const IdVector<PatchId, std::uint8_t>& is_frozen, const VaryingBounds& bounds,
                                Refinement& refinement, RunControl& control) {
  MissSearch(surface, meshes, is_frozen, bounds, refinement, control).run();
}

}  // namespace remesh
