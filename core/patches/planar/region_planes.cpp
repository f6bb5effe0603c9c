#include "core/patches/planar/region_planes.h"

#include <atomic>
#include <cmath>

#include "core/base/blocks.h"
#include "core/geometry/planes/plane_fit.h"

namespace remesh {
namespace {

/// For fewer faces than this, growing and merging costs less than fitting a plane to their corners.
constexpr std::size_t kFacesForCorners = 32;

constexpr std::size_t kSumBlock = 4096;

}  // namespace

/// Sums over blocks of faces, in the order of the faces.
template <class Sum, class Add>
Sum RegionPlanes::sum_over(std::span<const std::uint32_t> faces, const Add& add) const {
  const auto sum_block = [&](std::size_t begin, std::size_t end) {
    Sum sum;
    for (std::size_t i = begin; i < end; ++i) add(FaceId(faces[i]), sum);
    return sum;
  };
  if (faces.size() <= kSumBlock) return sum_block(0, faces.size());
  Sum all;
  for (const Sum& sum : map_blocks<Sum>(faces.size(), kSumBlock, control_, sum_block)) all.add(sum);
  return all;
}

std::optional<FittedPlane> RegionPlanes::of_all(FaceId seed, std::span<const std::uint32_t> island) const {
  if (rule_.is_single(seed)) return std::nullopt;
  const PlaneSums fit = sum_of(seed, island);
  if (!(fit.area > 0)) return std::nullopt;
  const double half_slab = kHalfSlab * rule_.tolerance(seed);
  Plane plane = fit.plane();
  std::optional<Extent> extent = extent_if_all_fit(island, plane, half_slab);
  if (!extent && island.size() >= kFacesForCorners && move_to_corners(plane, island, half_slab))
    extent = extent_if_all_fit(island, plane, half_slab);
  return extent ? std::optional(FittedPlane{plane, *extent}) : std::nullopt;
}

/// Replaces a plane by the one nearest to all corners, and moves that to the middle of the corners' range, because a
/// few of them may be far away on one side.
/// Output: whether all corners might lie in a slab about the plane.
bool RegionPlanes::move_to_corners(Plane& plane, std::span<const std::uint32_t> faces, double half_slab) const {
  struct Moments : PointMoments {
    void add(const PointMoments& other) { merge(other); }
    using PointMoments::add;
  };
  const auto moments = sum_over<Moments>(faces, [&](FaceId f, Moments& sum) {
    for (const VertexId v : surface_.face(f)) sum.add(surface_.local[v]);
  });
  const PlaneFit fit = fit_plane(moments);
  if (fit.rms > half_slab + kFitRounding) return false;
  const bool is_turned = dot(fit.normal, plane.normal) < 0;
  plane = {moments.mean(), is_turned ? -fit.normal : fit.normal};
  struct Range {
    double low = HUGE_VAL, high = -HUGE_VAL;
    void add(const Range& other) {
      low = std::min(low, other.low);
      high = std::max(high, other.high);
    }
  };
  const auto range = sum_over<Range>(faces, [&](FaceId f, Range& sum) {
    for (const VertexId v : surface_.face(f)) {
      const double distance = plane.distance(surface_.local[v]);
      sum.add({distance, distance});
    }
  });
  plane.origin += (range.low + range.high) / 2 * plane.normal;
  return range.high - range.low <= 2 * half_slab;
}

std::optional<Extent> RegionPlanes::extent_if_all_fit(std::span<const std::uint32_t> faces, const Plane& plane,
                                                      double tol) const {
  std::atomic<bool> do_fit = true;
  const auto extent = sum_over<Extent>(faces, [&](FaceId f, Extent& sum) {
    if (!do_fit) return;
    if (!rule_.fits(f, plane, tol, sum.deviation)) do_fit = false;
    sum.height = std::max(sum.height, rule_.height(f));
  });
  return do_fit ? std::optional(extent) : std::nullopt;
}

Extent RegionPlanes::extent_of(std::span<const std::uint32_t> faces, const Plane& plane) const {
  return sum_over<Extent>(faces, [&](FaceId f, Extent& sum) { sum.add({rule_.distance(f, plane), rule_.height(f)}); });
}

PlaneSums RegionPlanes::sum_of(FaceId seed, std::span<const std::uint32_t> faces) const {
  return sum_over<PlaneSums>(faces, [&](FaceId f, PlaneSums& sum) {
    if (!rule_.is_thin(f) || f == seed) sum.add(geometry_[f], face_centre(surface_, f));
  });
}

}  // namespace remesh
