/// The curves of patch boundaries.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// The way to find points of a boundary curve beside curved patches. It is a small value.
class CurveTrace {
 public:
  /// Chooses a way for the curve from `from` to `to`. The first choice is a circle around the axis of a surface, if
  /// both surfaces contain it. The second is the intersection of the surfaces, if they meet at a clear angle. The third
  /// is the nearest point of one surface, if it lies on the other one as well.
  /// Input:  the surface of a curved patch, and that of the patch on the other side, which may be a plane. Inside a
  ///         surface or at its open border, there is no second surface.
  /// Output: nothing if the curve is only known to be near its straight line.
  static std::optional<CurveTrace> choose(const Vec3& from, const Vec3& to, const AnalyticSurface& curved,
                                          const std::optional<AnalyticSurface>& other);

  /// Returns the place on the curve that is beside a point of its straight line. If the curve is not near, the result
  /// is the point itself.
  /// Cost: a few steps of Newton's method at most.
  Vec3 place(const Vec3& on_line, const Vec3& from, const Vec3& to) const;

 private:
  enum class Way : std::uint8_t { kCircle, kIntersection, kNearest };

  CurveTrace(Way way, const AnalyticSurface& first, const AnalyticSurface& second)
      : way_(way), first_(first), second_(second) {}

  Vec3 on_circle(const Vec3& on_line, const Vec3& from, const Vec3& to) const;
  Vec3 on_surfaces(const Vec3& on_line, const Vec3& from, const Vec3& to) const;

  Way way_;
  AnalyticSurface first_;   ///< circle: the surface around whose axis it runs
  AnalyticSurface second_;  ///< only for an intersection
};

/// A part of a patch boundary between two vertices that stay. It is a small value. The part is a straight line, or a
/// curve on the surfaces of the patches beside that line. Places on it are parameters from 0 to 1, in proportion to the
/// length of the way along the straight line from its first end.
class BoundaryCurve {
 public:
  static BoundaryCurve line(const Vec3& from, const Vec3& to) { return {from, to, nullptr}; }
  /// Input: `trace` must outlive the curve.
  static BoundaryCurve traced(const Vec3& from, const Vec3& to, const CurveTrace& trace) { return {from, to, &trace}; }

  /// Returns the length of the straight line, in model units.
  double length() const { return norm(to_ - from_); }

  /// Returns the position at a parameter. It is computed from the nearer end, so that the curve meets both ends
  /// exactly.
  Vec3 position(double t) const {
    const Vec3 on_line = t <= 0.5 ? from_ + t * (to_ - from_) : to_ + (1 - t) * (from_ - to_);
    return trace_ == nullptr || t <= 0 || t >= 1 ? on_line : trace_->place(on_line, from_, to_);
  }

 private:
  BoundaryCurve(const Vec3& from, const Vec3& to, const CurveTrace* trace) : from_(from), to_(to), trace_(trace) {}

  Vec3 from_, to_;
  const CurveTrace* trace_;
};

}  // namespace remesh
