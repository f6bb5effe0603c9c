#include "core/refinement/size_misses.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/blocks.h"
#include "core/base/large_first.h"

namespace remesh {
namespace {

/// Several threads look at a patch with more triangles than this.
constexpr std::size_t kLarge = 1000;
/// This is the number of triangles in a task. Each takes some microseconds.
constexpr std::size_t kTriangles = 256;

/// This is a relative slack for rounding when edges are compared with the sizes that were aimed at.
constexpr double kAimSlack = 1 + 1e-9;

/// Has the measures of a triangle. Lengths and places are in local units, so that no square under- or overflows.
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

  /// Returns the largest size at a place for which an edge is still too long.
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
    crossing_.reserve(2 * bounds.crossing.size());
    for (const auto& [p, q] : bounds.crossing) {
      crossing_.emplace_back(p, q);
      crossing_.emplace_back(q, p);
    }
    std::sort(crossing_.begin(), crossing_.end());
  }

  void run() {
    const auto work = [&](std::size_t p) { return first_[p + 1] - first_[p]; };
    for_large_first(meshes_.size(), kLarge, work, control_, [&](std::size_t p) {
      const std::vector<PatchId> crossing = crossing_of(PatchId(p));
      for_blocks(work(p), kTriangles, control_, [&](std::size_t begin, std::size_t end) {
        const auto first = static_cast<std::uint32_t>(begin), last = static_cast<std::uint32_t>(end);
        if (bounds_.gaps != nullptr)
          look_for_gaps(PatchId(p), crossing, first, last);
        else
          look_at_edges(PatchId(p), first, last);
      });
    });
    const auto& misses = refinement_.misses_sizes;
    if (std::find(misses.begin(), misses.end(), 1) == misses.end()) refinement_.misses_sizes.clear();
  }

 private:
  std::vector<PatchId> crossing_of(PatchId p) const {
    std::vector<PatchId> found;
    for (auto it = std::lower_bound(crossing_.begin(), crossing_.end(), std::pair(p, PatchId(0)));
         it != crossing_.end() && it->first == p; ++it)
      found.push_back(it->second);
    return found;
  }

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

  /// Returns the gap at a place below which the triangle is too large for the place.
  double too_small_gap(const Measured& triangle, const Vec3& place) const {
    return triangle.too_small_size(place, slope_) * bounds_.goals.proximity - tolerance_;
  }

  bool allows(const SizeField& sizes, double length, const Vec3& middle) const {
    return sizes.allows(length * surface_.unit, in_model(middle));
  }

  double size_of(double gap) const { return (gap + tolerance_) / bounds_.goals.proximity; }

  void look_for_gaps(PatchId p, std::span<const PatchId> crossing, std::uint32_t begin, std::uint32_t end) {
    const PatchMesh& patch = meshes_[PatchId(p)];
    std::vector<Measured> measured;
    measured.reserve(end - begin);
    for (std::uint32_t t = begin; t < end; ++t) measured.push_back(measure(patch, t));
    const auto gap_at = [&](const Vec3& place, double limit) {
      if (!(limit > tolerance_)) return HUGE_VAL;
      return bounds_.gaps->at(in_model(place), p, limit * surface_.unit, crossing) / surface_.unit;
    };
    // The centroids are looked at first. Most triangles that are too large are so there, and their edges need no
    // search.
    for (std::uint32_t t = begin; t < end; ++t) {
      const Measured& here = measured[t - begin];
      const double limit = too_small_gap(here, here.centroid);
      if (const double gap = gap_at(here.centroid, limit); gap < limit) note(p, t, here, size_of(gap));
    }
    for (std::uint32_t t = begin; t < end; ++t) {
      const Measured& here = measured[t - begin];
      for (std::uint32_t k = 0; k < 3; ++k) {
        // The middle of an edge inside the patch is looked at once for both its triangles, if they are in one block.
        const std::uint32_t h = 3 * t + k, twin = patch.mesh.twin(h);
        const bool is_shared = twin != Triangulation2d::kNoHalfEdge && twin / 3 >= begin && twin / 3 < end;
        if (is_shared && twin / 3 < t) continue;
        const Vec3& middle = here.middle[k];
        double limit = is_missed(p, t) == 0 ? too_small_gap(here, middle) : 0, limit_there = 0;
        if (is_shared && is_missed(p, twin / 3) == 0) limit_there = too_small_gap(measured[twin / 3 - begin], middle);
        const double gap = gap_at(middle, std::max(limit, limit_there));
        if (gap < limit) note(p, t, here, size_of(gap));
        if (gap < limit_there) note(p, twin / 3, measured[twin / 3 - begin], size_of(gap));
      }
    }
  }

  void look_at_edges(PatchId p, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t t = begin; t < end; ++t) {
      const Measured here = measure(meshes_[PatchId(p)], t);
      const auto is_too_long = [&](std::size_t k) {
        return !allows(*bounds_.graded, here.length[k] / Goals::kSizeSlack, here.middle[k]);
      };
      // All segments were taken into account when sizes were chosen. So an edge that is as short as was aimed at can be
      // too long only because of the floor.
      if (is_too_long(0) || is_too_long(1) || is_too_long(2)) note(p, t, here, 0);
    }
  }

  /// Notes that a triangle misses its bound. Some place of the triangle asks for `size`.
  void note(PatchId p, std::uint32_t t, const Measured& triangle, double size) {
    is_missed(p, t) = 1;
    if (is_frozen_[p] != 0) return;
    UnrefinedReason& reason = refinement_.reason[first_[p.value] + t];
    const double floor = bounds_.sizes.floor() / surface_.unit;
    const auto is_as_aimed_at = [&](std::size_t k) {
      const double length = triangle.length[k] / kAimSlack;
      return length <= std::min(floor, largest_) || allows(bounds_.sizes, length, triangle.middle[k]);
    };
    // A triangle at a sharp corner of the input may have a small angle, but must not be too large.
    const bool is_excuse = reason == UnrefinedReason::kInputAngle || reason == UnrefinedReason::kAcrossInputAngle;
    if (!is_excuse && !(is_as_aimed_at(0) && is_as_aimed_at(1) && is_as_aimed_at(2))) return;
    if (floor < size)
      reason = UnrefinedReason::kEffort;
    else
      reason = bounds_.sizes.is_floor_asked() ? UnrefinedReason::kMinEdgeLength : UnrefinedReason::kSizeFloor;
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
  std::vector<std::pair<PatchId, PatchId>> crossing_;
};

}  // namespace

void note_size_misses(const Surface& surface, const PatchMeshes& meshes,
                      const IdVector<PatchId, std::uint8_t>& is_frozen, const VaryingBounds& bounds,
                      Refinement& refinement, RunControl& control) {
  MissSearch(surface, meshes, is_frozen, bounds, refinement, control).run();
}

}  // namespace remesh
