#include "core/verify/patches/curved_patch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/verify/model/curved_shape.h"
#include "core/verify/model/face_measures.h"
#include "core/verify/model/fixed_width_integers.h"
#include "core/verify/patches/explained_distance.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kFacesPerCheck = 64;

/// Corners count as being at a cone's apex if their distance from it is at most this many plane tolerances.
constexpr double kSnap = 4;

/// The totals over some faces of one side of a patch.
struct CurvedReading {
  Range distance;
  Range area;           ///< sum of CurvedFace::area
  double along = 0;     ///< area of the faces that look along the surface's normal, minus that of the others
  double snapped = 0;   ///< see CurvedFace
  double reach = 0;     ///< largest coordinate
  double low_area = 0;  ///< area of faces so low that noise decides their direction
  /// The faces that do not look in a direction: the first one that is not low, and the max height of the low ones.
  struct Others {
    FaceId first;
    double height = 0;
    void add(const Others& other) {
      first = std::min(first, other.first);  // an invalid face has the largest number
      height = std::max(height, other.height);
    }
  };
  Others not_along, not_against;
  Measures measures;
  std::vector<FoundFault> faults;

  CurvedReading() { area = {0, 0}; }
  void add(const CurvedReading& other) {
    distance.add(other.distance);
    area.low += other.area.low;
    area.high += other.area.high;
    along += other.along;
    snapped = std::max(snapped, other.snapped);
    reach = std::max(reach, other.reach);
    low_area += other.low_area;
    not_along.add(other.not_along);
    not_against.add(other.not_against);
    measures.add(other.measures);
    faults.insert(faults.end(), other.faults.begin(), other.faults.end());
  }
};

class CurvedPatchCheck {
 public:
  CurvedPatchCheck(const NumberedClaim& numbered, const EdgeTable& input_edges, const Boundary& boundary, PatchId patch,
                   std::vector<FoundFault>& faults, RunControl& control)
      : numbered_(numbered),
        input_edges_(input_edges),
        boundary_(boundary),
        patch_(patch),
        surface_(*numbered.curved_surface(patch)),
        faults_(faults),
        control_(control) {}

  double run(ShapeSums& sums) {
    const auto input_faces = numbered_.input_by_patch[patch_.value],
               output_faces = numbered_.output_by_patch[patch_.value];
    if (input_faces.empty() && output_faces.empty()) return 0;
    control_.check();
    if (input_faces.empty() || output_faces.empty()) {
      report(Fault::kNoFaces);
      return 0;
    }
    if (is_unchanged(numbered_, input_edges_, patch_, control_)) return 0;
    if (!surface_.shape.is_sound() || !(surface_.tolerance >= 0) || !std::isfinite(surface_.tolerance)) {
      report(Fault::kSurface);
      return 0;
    }
    input_ = read(
        numbered_.input, input_faces, [&](VertexId v) { return numbered_.points[v.value]; },
        [](std::uint32_t, CurvedReading&) {});
    output_ = read(
        numbered_.output, output_faces, [&](VertexId v) { return numbered_.output_point(v); },
        [&](std::uint32_t f, CurvedReading& reading) { check_area(f, reading); });
    faults_.insert(faults_.end(), output_.faults.begin(), output_.faults.end());
    reach_ = std::max(input_.reach, output_.reach);
    check_facing();
    compare_area_vectors();
    compare_cover();
    const double bound = check_distance();
    // Along its boundary, a patch may move as far as its neighbours are allowed to. They answer for what is beyond its
    // own tolerance.
    if (!is_explained(std::min(bound, surface_.tolerance))) report(Fault::kUnexplained);
    sums.deviation = std::max(sums.deviation, bound);
    add_volume(sums);
    return bound;
  }

 private:
  void report(Fault fault, std::uint32_t element = 0) { faults_.push_back({patch_, fault, element}); }

  /// Reads the faces of one side, in blocks. A face may take a microsecond, or a hundred at a torus.
  template <class PointOf, class Visit>
  CurvedReading read(const Faces& faces, std::span<const std::uint32_t> of_patch, const PointOf& point_of,
                     const Visit& visit) {
    const auto read_block = [&](std::size_t begin, std::size_t end) {
      CurvedReading reading;
      std::vector<Vec3> corners;
      for (std::size_t i = begin; i < end; ++i) {
        if (i % kFacesPerCheck == 0) control_.check_and_move();
        const std::uint32_t f = of_patch[i];
        corners.clear();
        for (const VertexId v : faces.face(f)) corners.push_back(point_of(v));
        read_face(f, corners, reading);
        visit(f, reading);
      }
      return reading;
    };
    CurvedReading all;
    for (const CurvedReading& block : map_blocks<CurvedReading>(of_patch.size(), kItemsPerBlock, control_, read_block))
      all.add(block);
    return all;
  }

  void read_face(std::uint32_t f, std::vector<Vec3>& corners, CurvedReading& reading) const {
    const double twice_area = add_measures(corners, reading);
    double extent = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      extent = std::max(extent, norm(corners[i] - corners[i == 0 ? corners.size() - 1 : i - 1]));
      reading.reach = std::max(reading.reach, largest_coordinate(corners[i]));
    }
    const CurvedFace face = surface_.shape.read(corners, kSnap * numbered_.tolerance, reading.distance);
    reading.distance.add(face.distance);
    reading.snapped = std::max(reading.snapped, face.snapped);
    reading.area.low += face.area.low;
    reading.area.high += face.area.high;
    const bool is_along = face.facing.low > 0, is_against = face.facing.high < 0;
    reading.along += is_along ? twice_area : is_against ? -twice_area : 0;
    const double height = extent > 0 ? twice_area / extent : 0;
    const bool is_low = numbered_.is_within_tolerance(height, extent);
    if (is_low) reading.low_area += twice_area / 2;
    const CurvedReading::Others other =
        is_low ? CurvedReading::Others{FaceId(), height} : CurvedReading::Others{FaceId(f), 0};
    if (!is_along) reading.not_along.add(other);
    if (!is_against) reading.not_against.add(other);
  }

  /// Adds a face to the measures of its side.
  /// Output: twice its area.
  static double add_measures(std::span<const Vec3> corners, CurvedReading& reading) {
    Vec3 twice;
    double magnitude = 0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const Vec3 a = corners[i - 1] - corners[0], b = corners[i] - corners[0];
      twice += cross(a, b);
      magnitude += 9 * largest_coordinate(a) * largest_coordinate(b);
    }
    const double twice_area = norm(twice);
    Measures& measures = reading.measures;
    measures.magnitude += magnitude;
    measures.terms += corners.size() - 2;
    measures.twice_area += twice;
    measures.twice_absolute_area += twice_area;
    measures.volume += dot(corners[0], twice) / 6;
    return twice_area;
  }

  void check_area(std::uint32_t f, CurvedReading& reading) const {
    const auto face = numbered_.output.face(f);
    const Vec3 a = numbered_.output_point(face[0]), b = numbered_.output_point(face[1]),
               c = numbered_.output_point(face[2]);
    const double extent = std::max({norm(b - a), norm(c - b), norm(a - c)});
    if (!(norm(cross(b - a, c - a)) > 1e-12 * extent * extent) && is_collinear(a, b, c) &&
        !is_input_triangle(numbered_, input_edges_, patch_, face))
      reading.faults.push_back({patch_, Fault::kZeroArea, f});
  }

  /// The larger part of the input's area decides whether the patch looks along the surface's normal.
  void check_facing() {
    const bool is_along = input_.along > 0;
    const CurvedReading::Others& of_input = is_along ? input_.not_along : input_.not_against;
    const CurvedReading::Others& of_output = is_along ? output_.not_along : output_.not_against;
    if (of_input.first.is_valid()) report(Fault::kFacingAway, of_input.first.value);
    if (of_output.first.is_valid()) report(Fault::kInverted, of_output.first.value);
    low_height_ = std::max(of_input.height, of_output.height);
  }

  /// Returns whether a distance between input and output is explained by the input or allowed by the options.
  bool is_explained(double distance) const {
    const CurvedClaim& claim = surface_.claim;
    double rest = distance;
    if (claim.elements_per_circle)
      rest -= largest_radius() * (1 - std::cos(std::numbers::pi / *claim.elements_per_circle));
    if (claim.surface_tolerance)
      return NumberedClaim::is_within(rest, numbered_.scale * *claim.surface_tolerance, reach_);
    return explains_distance(numbered_, input_edges_, patch_, claim.feature_angle_deg * std::numbers::pi / 180, rest,
                             control_);
  }

  /// Returns the largest distance of the surface from its axis. For a cone, the size of its input is the limit.
  double largest_radius() const {
    if (surface_.shape.largest_radius() > 0) return surface_.shape.largest_radius();
    double largest = 0;
    StopCheck check(control_);
    for (const std::uint32_t f : numbered_.input_by_patch[patch_.value])
      for (const VertexId v : numbered_.input.face(f)) {
        check();
        largest = std::max(largest, surface_.shape.ruled(numbered_.points[v.value]).radius);
      }
    return largest;
  }

  double slivers() const { return boundary_.slivers[patch_.value]; }

  /// The area vector depends on the boundary alone (Stokes). So it may change by the slivers at the boundary, and by
  /// rounding.
  void compare_area_vectors() {
    const double change = norm(output_.measures.twice_area - input_.measures.twice_area) / 2;
    if (!(change <= slivers() * (1 + 1e-9) + input_.measures.rounding() + output_.measures.rounding()))
      report(Fault::kArea);
  }

  void compare_cover() {
    if (!surface_.shape.is_compact()) return;
    const double change = std::max(output_.area.high - input_.area.low, input_.area.high - output_.area.low);
    // At half of the radius, areas are four times as large on the surface. A low face may count with the wrong sign.
    const double uncertain = slivers() + 2 * (input_.low_area + output_.low_area);
    if (!(change + 4 * uncertain < surface_.shape.area())) report(Fault::kCover);
  }

  /// Returns a bound on the distance between input and output.
  double check_distance() {
    const Range &in = input_.distance, &out = output_.distance;
    const double limit = std::min(surface_.tolerance + numbered_.tolerance, surface_.shape.largest_depth());
    depth_ = std::max({-in.low, in.high, -out.low, out.high, 0.0});
    between_ = std::max({in.high - out.low, out.high - in.low, 0.0});
    const double snapped = input_.snapped + output_.snapped;
    const bool is_near = NumberedClaim::is_within(depth_ + snapped, limit, reach_) &&
                         NumberedClaim::is_within(between_ + snapped, limit, reach_);
    const double on_surface = boundary_.on_surface[patch_.value] + low_height_;
    const double near_pole = boundary_.near_pole[patch_.value];
    const double bound = std::max(std::hypot(between_, on_surface), between_ + 2 * near_pole) + snapped;
    // Along its boundary, the patch may move as far as its neighbours are allowed to move.
    const double allowed = std::max(surface_.tolerance + numbered_.tolerance, boundary_.allowed[patch_.value]);
    if (!is_near || !NumberedClaim::is_within(bound, allowed, reach_)) report(Fault::kDeviation);
    return bound;
  }

  /// Adds the change of volume and its bound. Along the normals of the surface, input and output of the patch enclose
  /// no more than the area that they cover times their distance; in the slivers, it may be twice the largest distance
  /// from the surface. Areas change with the distance from the surface, and they are measured on the faces. The slivers
  /// of neighbours cancel if the surface is closed. If the factor were too small, a good result would be refused, but
  /// none would be accepted for it.
  void add_volume(ShapeSums& sums) const {
    const double largest = surface_.shape.largest_depth();
    // At a cone, areas of faces grow more if the faces span a larger part of the circle around the axis. This factor
    // suffices for spans of 150 degrees.
    const double growth = std::isfinite(largest) ? 1 / (1 - std::min(depth_ / (2 * largest), 0.75)) : 2;
    const double factor = growth * growth * growth * growth;
    const double rounding = 1e-15 * reach_;
    sums.volume_change += output_.measures.volume - input_.measures.volume;
    sums.volume_bound += factor * (std::max(input_.measures.twice_absolute_area, output_.measures.twice_absolute_area) /
                                       2 * (between_ + rounding) +
                                   slivers() * (2 * depth_ + rounding)) +
                         input_.measures.rounding() + output_.measures.rounding();
  }

  const NumberedClaim& numbered_;
  const EdgeTable& input_edges_;
  const Boundary& boundary_;
  const PatchId patch_;
  const CurvedSurface& surface_;
  std::vector<FoundFault>& faults_;
  RunControl& control_;

  CurvedReading input_, output_;
  double reach_ = 0;       ///< the larger one of both sides
  double depth_ = 0;       ///< largest distance from the surface
  double between_ = 0;     ///< largest distance between input and output along a normal
  double low_height_ = 0;  ///< largest height of a low face that does not look as the patch does
};

}  // namespace

double check_curved_patch(const NumberedClaim& numbered, const EdgeTable& input_edges, const Boundary& boundary,
                          PatchId patch, ShapeSums& sums, std::vector<FoundFault>& faults, RunControl& control) {
  return CurvedPatchCheck(numbered, input_edges, boundary, patch, faults, control).run(sums);
}

}  // namespace remesh::verification
