/// The charts of patches. A chart answers every question that refinement, which works in a plane, has about the surface
/// in space.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/planes/frame.h"
#include "core/geometry/planes/projection.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_chart.h"
#include "core/patches/charts/curved_patches.h"

namespace remesh {

/// The choice of the patches' x axes (see make_frame).
struct ProjectionRule {
  ReferenceAxis axis = ReferenceAxis::kDominantEdge;
  Vec3 direction;
};

/// A map between a patch in space and a plane. It is a small value. Places in the plane have coordinates within [-1, 1]
/// that are multiples of `grid()`; lengths in space are in model units. The chart of a plane is a projection. That of a
/// curved patch is a map that keeps angles, so only the scale differs from place to place.
class PatchChart {
 public:
  PatchChart() = default;
  /// Makes the chart of a plane.
  /// Input: `offset` is the way from the frame's plane, whose origin is a vertex, to the plane that fits the patch
  ///        best. It is null if the two planes are the same up to rounding.
  explicit PatchChart(const Frame& frame, const Vec3& offset = {}) : frame_(frame), offset_(offset) {}
  /// Makes the chart of a curved patch.
  /// Input: `curved` must outlive this object. Of the frame, only the scale, the grid and the axes count.
  PatchChart(const Frame& frame, const CurvedChart& curved) : frame_(frame), curved_(&curved) {}

  /// Returns the map and the limits of a curved patch. They are null for a plane.
  const CurvedChart* curved() const { return curved_; }

  /// Returns the place of a point in the plane, rounded to the grid.
  Vec2 to_plane(const Vec3& position) const {
    if (curved_ == nullptr) return remesh::to_plane(frame_, position);
    return on_grid((1 / frame_.scale) * (curved_->map().flat(position) - curved_->middle));
  }
  /// Returns the point at a place. The vertices of the patch's boundary lie there up to the plane tolerance.
  Vec3 to_space(Vec2 place) const {
    return curved_ == nullptr ? remesh::to_space(frame_, place) : curved_->map().point(in_map(place));
  }
  /// Returns the position of a new vertex at a place. It lies on the surface that fits the patch best.
  Vec3 new_position(Vec2 place) const { return to_space(place) + offset_; }

  /// Returns the length in space of a short way in the plane at a place, per length of that way. For a plane it is the
  /// same power of two everywhere.
  double scale(Vec2 place) const {
    return curved_ == nullptr ? frame_.scale : frame_.scale * curved_->map().stretch(in_map(place));
  }
  /// Coordinates in the plane are multiples of this power of two.
  double grid() const { return frame_.grid; }
  /// Returns the point of the grid next to a place.
  Vec2 on_grid(Vec2 place) const {
    return {std::nearbyint(place.x / grid()) * grid(), std::nearbyint(place.y / grid()) * grid()};
  }
  /// Returns the shortest way in the plane, a multiple of the grid, that does not vanish when the position's
  /// coordinates are rounded.
  double visible_step(Vec2 place, const Vec3& position) const;

  /// Returns the unit normal of the surface at a place.
  Vec3 normal(Vec2 place) const { return curved_ == nullptr ? frame_.normal : curved_->map().normal(in_map(place)); }
  /// Returns the distance of a point from the surface, positive on the side to which the normal points.
  double height(const Vec3& position) const {
    return curved_ == nullptr ? dot(position - frame_.origin, frame_.normal) : curved_->height(position);
  }
  /// Returns three axes along the patch: two along the surface and its normal. Those of a curved patch are along its
  /// surface's axis.
  Axes axes() const { return Axes(frame_); }

  /// Returns the surface on which new vertices of the patch lie.
  AnalyticSurface surface() const {
    if (curved_ != nullptr) return curved_->map().shape();
    return {SurfaceKind::kPlane, frame_.origin + offset_, frame_.normal};
  }

  /// Returns the frame of a plane's chart. That of a curved patch has no meaning but its scale and grid.
  const Frame& plane() const { return frame_; }

 private:
  Vec2 in_map(Vec2 place) const { return frame_.scale * place + curved_->middle; }

  Frame frame_;
  Vec3 offset_;
  const CurvedChart* curved_ = nullptr;
};

/// Returns axes for a patch that has no chart: its normal, and its longest border edge.
Axes axes_along(const Vec3& normal, std::span<const Edge3> border);

/// The frames of some patches.
struct ListedFrames {
  std::vector<std::uint32_t> of_patch;  ///< index in `frames`, or kNone
  std::vector<Frame> frames;
};

/// The charts of all patches, in flat arrays. A triangle that is a patch of its own has no stored chart: there may be a
/// million of them, and the chart is computed from the three corners for each call.
class PatchCharts {
 public:
  PatchCharts() = default;
  PatchCharts(PatchCharts&&) = default;  // a copy's charts would refer to the original
  PatchCharts& operator=(PatchCharts&&) = default;
  /// Makes room for the charts of all patches. The surface and the patches must outlive this object.
  /// Input: `curved` tells which patches are curved; it may be null if none is.
  PatchCharts(const Surface& surface, const PatchSet& patches, const CurvedPatches* curved, const ProjectionRule& rule,
              RunControl& control);

  std::size_t size() const { return stored_at_.size(); }
  bool has_curved() const { return !curved_.empty(); }
  PatchChart operator[](PatchId p) const {
    return stored_at_[p] != kNone ? stored_[stored_at_[p]] : with_offset(p, frame_of_triangle(p));
  }

  /// Returns the frames of all charts but those of triangles for which `is_kept` is true. The verifier gets them as a
  /// part of the pipeline's claim.
  ListedFrames frames(const std::function<bool(PatchId)>& is_kept, RunControl& control) const;
  /// Returns the unit normals of all charts; those of curved patches are null.
  IdVector<PatchId, Vec3> normals(RunControl& control) const;

  /// The following functions make the chart of a patch and keep it. Different threads may do so for different patches.
  /// Their results serve only to lay vertices into the plane.
  ///
  /// Makes a projection along the patch's normal.
  /// Input: the corners of the patch and the edges between them; the step of its plane coordinates (see Frame::grid).
  PatchChart project(PatchId p, std::span<const Vec3> points, std::span<const Edge3> edges, double grid);
  /// Lays a triangle into the plane along its longest side.
  /// Input: the patch is a single triangle.
  PatchChart lay_out(PatchId p);
  /// Returns the corners of such a triangle. The first two are the ends of its longest side.
  std::array<VertexId, 3> corners_from_longest(PatchId p) const;

 private:
  /// The way in which the chart of a patch that is a single triangle was made.
  enum class TriangleKind : std::uint8_t { kCoarseGrid, kFineGrid, kLaidOut };

  bool is_triangle(PatchId p) const;
  PatchChart develop(PatchId p, std::span<const Vec3> points, double grid);
  Frame projection(PatchId p, std::span<const Vec3> points, std::span<const Edge3> edges, double grid) const;
  Frame layout(PatchId p) const;
  Frame frame_of_triangle(PatchId p) const;
  PatchChart with_offset(PatchId p, const Frame& frame) const;

  const Surface* surface_ = nullptr;
  const PatchSet* patches_ = nullptr;
  ProjectionRule rule_;
  IdVector<PatchId, std::uint32_t> stored_at_;  ///< index in `stored_`, or kNone
  std::vector<PatchChart> stored_;
  IdVector<PatchId, std::uint32_t> curved_at_;     ///< index in `curved_`, or kNone; empty if no patch is curved
  std::vector<CurvedChart> curved_;                ///< the stored charts refer to these
  IdVector<PatchId, TriangleKind> triangle_kind_;  ///< only for patches without a stored chart
};

}  // namespace remesh
