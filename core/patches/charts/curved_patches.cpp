#include "core/patches/charts/curved_patches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/base/vec.h"
#include "core/geometry/planes/frame.h"
#include "core/geometry/planes/plane.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/geometry/surfaces/surface_map.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {
namespace {

/// The connected facets of one surface. They are planar patches.
using PatchSheet = std::vector<PatchId>;

/// Measures sheets and pieces of sheets. All lengths are in model units. Only the last digits of sums depend on the
/// order of facets. This class is larger than the bound because every kind of surface has a rule of its own for where
/// it is divided, and all of these rules read the same angles of the same facets.
class SheetGeometry {
 public:
  /// Input: the surface and the facets outlive this object.
  SheetGeometry(const Surface& surface, const PatchSet& facets, const RunControl& control)
      : surface_(surface), facets_(facets), control_(control), check_(control) {}

  /// Returns whether a facet itself goes around the axis. A flat ring of a torus does, if no corner is where the torus
  /// is highest. Such a facet has no place in a map.
  bool goes_around(PatchId facet, const AnalyticSurface& shape);

  /// Returns whether a facet reaches the axis at which a torus ends, as at the tip of an ogive. Such a facet has no
  /// place in a map either.
  bool ends_at_axis(PatchId facet, const AnalyticSurface& shape);

  /// Returns the sector of each facet of a sheet, which is 0 everywhere if the sheet has a map as it is. Sectors begin
  /// at the angle of a corner. If corners are even, facets end where sectors do.
  std::vector<std::uint8_t> sectors(const PatchSheet& sheet, const AnalyticSurface& shape);

  /// Returns the corner at which a sheet is divided. The choice depends first on properties that do not change if the
  /// model is turned. The corner farthest from the middle of the sheet is taken. Of several such corners, one of the
  /// rarest kind is taken, where corners with facets of the same area are one kind. Remaining ties are broken by the
  /// smallest position.
  /// Output: a corner on the axis, such as the apex of a cone, is never taken.
  /// Cost:   O(n log n).
  Vec3 dividing_corner(const PatchSheet& sheet, const AnalyticSurface& shape);

  /// Returns whether a piece has a one-to-one map.
  bool has_map(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns a point in the direction of the middle of a piece, seen from the axis or the centre. With this middle, the
  /// map distorts the piece as little as possible. Its distance is of the size of the model, so that a scaling changes
  /// no direction.
  Vec3 middle_of_piece(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns 1 if all facets look away from the axis or centre, -1 if all look towards it, and otherwise 0.
  int side_of(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns the area of a piece, in squared local units.
  double area_of(const PatchSheet& piece);
  /// Returns a plane with the mean normal through the mean of the facets' planes' origins, in local units.
  Plane mean_plane(const PatchSheet& piece);

 private:
  /// Two angles of a point: around the axis and, on a torus, around the tube.
  struct Angles {
    double around, tube;
  };
  /// Axes in which the angles of a sheet are measured.
  struct AngleFrame {
    const AnalyticSurface& shape;
    Axes axes;
    /// Returns the distance of a point from the axis.
    double radius(const Vec3& p) const;
    Angles of(const Vec3& p) const;
  };
  /// An interval of angles that a facet covers, from `begin` on, which is between 0 and a full turn.
  struct Covered {
    double begin, width;
  };
  /// The largest gap between intervals of angles.
  struct Gap {
    double width = 0;
    double middle_of_covered = 0;
  };
  struct Corner {
    Vec3 position;
    double area = 0;  ///< of the facets around it, in squared local units
  };

  template <class Take>
  void for_each_corner(PatchId p, const Take& take);
  double area_of(PatchId p);
  Vec3 middle_of(PatchId p);
  Vec3 middle_of_box(PatchId p);
  Vec3 smallest_corner(const PatchSheet& sheet);
  std::vector<Corner> corners_of(const PatchSheet& sheet);
  Vec3 middle_of_sheet(const PatchSheet& sheet);
  static Vec3 rarest(std::vector<Corner> corners);
  double reach_of(const PatchSheet& piece, const Vec3& point);
  double lowest_on_sphere(const PatchSheet& sheet, const AnalyticSurface& shape, const Vec3& pole);
  Vec3 pole_of(const PatchSheet& sheet, const AnalyticSurface& shape);
  AngleFrame frame_of(const PatchSheet& sheet, const AnalyticSurface& shape);
  Covered covered_by(PatchId p, const AngleFrame& frame, double Angles::*which);
  bool reaches_narrow_apex(const PatchSheet& sheet, const AngleFrame& frame);
  static Gap largest_gap(std::vector<Covered>& covered, const RunControl& control);
  Gap gap_of(const PatchSheet& sheet, const AngleFrame& frame, double Angles::*which);

  const Surface& surface_;
  const PatchSet& facets_;
  const RunControl& control_;
  StopCheck check_;
};

constexpr double kPi = std::numbers::pi;

/// A piece with a one-to-one map leaves at least this angle free around the axis. The map of a sphere reaches this far
/// beyond the equator at most.
constexpr double kFreeAngle = kPi / 3, kBeyondEquator = kPi / 18;
/// The rounding of a model's coordinates must not decide between places that are the same up to a symmetry of the
/// model. So angles and lengths that differ by no more than these parts are alike.
constexpr double kAlikeAngle = 1e-6, kAlike = 1e-4;
/// A point has no angle around the axis if its distance from it is below this part of the other points' distance.
constexpr double kOnAxis = 1e-3;

double within_turn(double angle) {
  const double turns = angle / (2 * kPi);
  return angle - std::floor(turns) * 2 * kPi;
}

/// Returns whether an angle is in the second half of a turn that begins at `first`.
bool is_in_second_half(double angle, double first) { return within_turn(angle - first + kAlikeAngle) >= kPi; }

double SheetGeometry::AngleFrame::radius(const Vec3& p) const {
  const Vec3 q = axes.along(p - shape.origin);
  return std::hypot(q.x, q.y);
}

SheetGeometry::Angles SheetGeometry::AngleFrame::of(const Vec3& p) const {
  const Vec3 q = axes.along(p - shape.origin);
  return {std::atan2(q.y, q.x), std::atan2(q.z, std::hypot(q.x, q.y) - shape.radius)};
}

template <class Take>
void SheetGeometry::for_each_corner(PatchId p, const Take& take) {
  for (const FaceId f : facets_.faces_of(p))
    for (const VertexId v : surface_.face(f)) {
      check_();
      take(surface_.positions[v]);
    }
}

/// Returns the area of a flat facet, in squared local units, where the rounding is the same at every scale.
double SheetGeometry::area_of(PatchId p) {
  Vec3 twice;
  for (const FaceId f : facets_.faces_of(p)) {
    check_();
    const auto face = surface_.face(f);
    for (std::size_t i = 2; i < face.size(); ++i)
      twice += cross(surface_.local[face[i - 1]] - surface_.local[face[0]],
                     surface_.local[face[i]] - surface_.local[face[0]]);
  }
  return norm(twice) / 2;
}

/// Returns the middle of a facet's bounding box.
Vec3 SheetGeometry::middle_of_box(PatchId p) {
  Box3 box;
  for_each_corner(p, [&](const Vec3& corner) { box.add(corner); });
  return 0.5 * box.min + 0.5 * box.max;
}

/// Returns the centroid of a facet. If the model is turned, the centroid turns with it.
Vec3 SheetGeometry::middle_of(PatchId p) {
  Vec3 moment;
  double area = 0;
  const Vec3 first = surface_.local[surface_.face(facets_.faces_of(p)[0])[0]];
  for (const FaceId f : facets_.faces_of(p)) {
    check_();
    const auto face = surface_.face(f);
    for (std::size_t i = 2; i < face.size(); ++i) {
      const Vec3 a = surface_.local[face[0]] - first, b = surface_.local[face[i - 1]] - first,
                 c = surface_.local[face[i]] - first;
      const double part = dot(cross(b - a, c - a), facets_.planes[p].normal);
      area += part;
      moment += (part / 3) * (a + b + c);
    }
  }
  if (!(area > 0)) return middle_of_box(p);
  return surface_.centre + surface_.unit * (first + (1 / area) * moment);
}

Vec3 SheetGeometry::smallest_corner(const PatchSheet& sheet) {
  Vec3 smallest;
  bool is_first = true;
  for (const PatchId p : sheet)
    for_each_corner(p, [&](const Vec3& corner) {
      if (is_first || corner < smallest) smallest = corner;
      is_first = false;
    });
  return smallest;
}

/// Returns the corners of a sheet, each once, ordered by their positions.
std::vector<SheetGeometry::Corner> SheetGeometry::corners_of(const PatchSheet& sheet) {
  struct Use {
    Vec3 position;
    double area;
    PatchId facet;
  };
  std::vector<Use> uses;
  for (const PatchId p : sheet) {
    const double area = area_of(p);
    for_each_corner(p, [&](const Vec3& corner) { uses.push_back({corner, area, p}); });
  }
  // Areas are added in an order that does not depend on the numbers of facets.
  sort_stoppable(uses.begin(), uses.end(), control_, [](const Use& a, const Use& b) {
    return std::tie(a.position, a.area, a.facet) < std::tie(b.position, b.area, b.facet);
  });
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    check_();
    const bool is_known = i > 0 && uses[i].position == uses[i - 1].position;
    if (!is_known) corners.push_back({uses[i].position, 0});
    if (!is_known || uses[i].facet != uses[i - 1].facet) corners.back().area += uses[i].area;
  }
  return corners;
}

/// Returns the centroid of a sheet.
Vec3 SheetGeometry::middle_of_sheet(const PatchSheet& sheet) {
  double area = 0;
  for (const PatchId p : sheet) area += area_of(p);
  Vec3 middle;
  if (!(area > 0)) return smallest_corner(sheet);
  for (const PatchId p : sheet) middle += (area_of(p) / area) * middle_of(p);
  return middle;
}

/// Returns a corner of the rarest kind. Of two equally rare kinds, the one with the larger facets counts, and of two
/// corners of one kind the smaller one.
Vec3 SheetGeometry::rarest(std::vector<Corner> corners) {
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.area, a.position) < std::tie(b.area, b.position);
  });
  Vec3 best;
  std::size_t fewest = corners.size() + 1;
  for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
    Vec3 smallest = corners[begin].position;
    for (end = begin + 1; end < corners.size() && corners[end].area <= corners[end - 1].area * (1 + kAlike); ++end)
      smallest = std::min(smallest, corners[end].position);
    if (end - begin > fewest) continue;
    fewest = end - begin;
    best = smallest;
  }
  return best;
}

Vec3 SheetGeometry::dividing_corner(const PatchSheet& sheet, const AnalyticSurface& shape) {
  std::vector<Corner> corners = corners_of(sheet);
  const auto from_axis = [&](const Vec3& p) {
    const Vec3 way = p - shape.origin;
    return norm(way - dot(way, shape.axis) * shape.axis);
  };
  if (shape.kind != SurfaceKind::kSphere) {
    double largest = 0;
    for (const Corner& c : corners) largest = std::max(largest, from_axis(c.position));
    std::erase_if(corners, [&](const Corner& c) { return !(from_axis(c.position) > kOnAxis * largest); });
  }
  const Vec3 middle = middle_of_sheet(sheet);
  double farthest = 0;
  for (const Corner& c : corners) farthest = std::max(farthest, norm(c.position - middle));
  std::erase_if(corners, [&](const Corner& c) { return norm(c.position - middle) < farthest * (1 - kAlike); });
  return rarest(std::move(corners));
}

/// Makes the axes. Their choice does not matter, apart from rounding.
SheetGeometry::AngleFrame SheetGeometry::frame_of(const PatchSheet& sheet, const AnalyticSurface& shape) {
  return {shape, SurfaceMap(shape, {smallest_corner(sheet), false}).axes()};
}

/// Returns the interval of angles that the corners of a facet cover.
SheetGeometry::Covered SheetGeometry::covered_by(PatchId p, const AngleFrame& frame, double Angles::*which) {
  const Vec3 box = middle_of_box(p);
  const double middle = frame.of(box).*which;
  double low = 0, high = 0;
  // The apex of a cone has no angle around the axis.
  const double min_radius = kOnAxis * frame.radius(box);
  for_each_corner(p, [&](const Vec3& corner) {
    if (!(frame.radius(corner) > min_radius)) return;
    double turn = frame.of(corner).*which - middle;
    turn -= std::nearbyint(turn / (2 * kPi)) * 2 * kPi;
    low = std::min(low, turn);
    high = std::max(high, turn);
  });
  return {within_turn(middle + low), high - low};
}

SheetGeometry::Gap SheetGeometry::largest_gap(std::vector<Covered>& covered, const RunControl& control) {
  const auto before = [](const Covered& a, const Covered& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.width < b.width;
  };
  sort_stoppable(covered.begin(), covered.end(), control, before);
  // The interval that reaches farthest may reach beyond a full turn, and cover some of the first intervals' angles.
  double reached = -2 * kPi;
  for (const Covered& c : covered) reached = std::max(reached, c.begin + c.width - 2 * kPi);
  Gap gap;
  for (const Covered& c : covered) {
    if (c.begin - reached > gap.width) gap = {c.begin - reached, within_turn(0.5 * (reached + c.begin) + kPi)};
    reached = std::max(reached, c.begin + c.width);
  }
  return gap;
}

SheetGeometry::Gap SheetGeometry::gap_of(const PatchSheet& sheet, const AngleFrame& frame, double Angles::*which) {
  std::vector<Covered> covered;
  covered.reserve(sheet.size());
  for (const PatchId p : sheet) covered.push_back(covered_by(p, frame, which));
  return largest_gap(covered, control_);
}

/// Returns the sine of the latitude of the corner that is farthest from the pole.
double SheetGeometry::lowest_on_sphere(const PatchSheet& sheet, const AnalyticSurface& shape, const Vec3& pole) {
  double lowest = 1;
  for (const PatchId p : sheet)
    for_each_corner(
        p, [&](const Vec3& corner) { lowest = std::min(lowest, dot(normalized(corner - shape.origin), pole)); });
  return lowest;
}

/// Returns the mean direction of a sheet of a sphere, or that of its dividing corner if the sheet is nearly closed.
Vec3 SheetGeometry::pole_of(const PatchSheet& sheet, const AnalyticSurface& shape) {
  Vec3 sum;
  double area = 0;
  for (const PatchId p : sheet) {
    const double share = area_of(p);
    const Vec3 way = middle_of(p) - shape.origin;
    const double size = norm(way);
    area += share;
    if (size > 0) sum += share * ((1 / size) * way);
  }
  constexpr double kClear = 0.05;
  return norm(sum) > kClear * area ? normalized(sum) : normalized(dividing_corner(sheet, shape) - shape.origin);
}

bool SheetGeometry::goes_around(PatchId facet, const AnalyticSurface& shape) {
  // The facets of a cylinder or a cone run along the axis, and a sphere has none.
  if (shape.kind != SurfaceKind::kTorus) return false;
  std::vector<double> angles;
  const AngleFrame frame = frame_of({facet}, shape);
  for_each_corner(facet, [&](const Vec3& corner) { angles.push_back(frame.of(corner).around); });
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * kPi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < kPi;
}

bool SheetGeometry::ends_at_axis(PatchId facet, const AnalyticSurface& shape) {
  constexpr double kNearAxis = 0.02;
  if (shape.kind != SurfaceKind::kTorus || shape.radius > shape.minor_radius) return false;
  const AngleFrame frame = frame_of({facet}, shape);
  bool ends = false;
  for_each_corner(facet, [&](const Vec3& corner) {
    ends = ends || frame.radius(corner) < kNearAxis * (shape.radius + shape.minor_radius);
  });
  return ends;
}

/// Returns whether a sheet reaches the apex of a cone that is so narrow that half of it, unrolled, has no two triangles
/// at the apex. A single one would reach over the axis.
bool SheetGeometry::reaches_narrow_apex(const PatchSheet& sheet, const AngleFrame& frame) {
  constexpr double kMaxSine = 1.0 / 3;  // half of the cone unrolls to 60 degrees
  if (frame.shape.kind != SurfaceKind::kCone || !(std::sin(frame.shape.half_angle) < kMaxSine)) return false;
  double nearest = HUGE_VAL, farthest = 0;
  for (const PatchId p : sheet)
    for_each_corner(p, [&](const Vec3& corner) {
      nearest = std::min(nearest, frame.radius(corner));
      farthest = std::max(farthest, frame.radius(corner));
    });
  return nearest < kOnAxis * farthest;
}

std::vector<std::uint8_t> SheetGeometry::sectors(const PatchSheet& sheet, const AnalyticSurface& shape) {
  std::vector<std::uint8_t> result(sheet.size(), 0);
  if (shape.kind == SurfaceKind::kSphere) {
    const Vec3 pole = pole_of(sheet, shape);
    if (lowest_on_sphere(sheet, shape, pole) >= -std::sin(kBeyondEquator)) return result;
    for (std::size_t i = 0; i < sheet.size(); ++i)
      result[i] = dot(middle_of(sheet[i]) - shape.origin, pole) < -kAlikeAngle * shape.radius ? 1 : 0;
    return result;
  }
  const AngleFrame frame = frame_of(sheet, shape);
  const bool is_around = gap_of(sheet, frame, &Angles::around).width < kFreeAngle;
  const bool is_tube = shape.kind == SurfaceKind::kTorus && gap_of(sheet, frame, &Angles::tube).width < kFreeAngle;
  if (!is_around && !is_tube) return result;
  const Angles first = frame.of(dividing_corner(sheet, shape));
  const bool is_needle = reaches_narrow_apex(sheet, frame);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Angles at = frame.of(middle_of(sheet[i]));
    if (is_around && is_in_second_half(at.around, first.around)) result[i] |= 1;
    if (is_needle && is_in_second_half(2 * at.around, 2 * first.around)) result[i] |= 2;
    if (is_tube && is_in_second_half(at.tube, first.tube)) result[i] |= 2;
  }
  return result;
}

/// Returns the largest distance of a piece's corners from a point.
double SheetGeometry::reach_of(const PatchSheet& piece, const Vec3& point) {
  double reach = 0;
  for (const PatchId p : piece)
    for_each_corner(p, [&](const Vec3& corner) { reach = std::max(reach, norm(corner - point)); });
  return reach;
}

Vec3 SheetGeometry::middle_of_piece(const PatchSheet& piece, const AnalyticSurface& shape) {
  if (shape.kind == SurfaceKind::kSphere) return shape.origin + shape.radius * pole_of(piece, shape);
  const AngleFrame frame = frame_of(piece, shape);
  const double around = gap_of(piece, frame, &Angles::around).middle_of_covered;
  double rho = reach_of(piece, shape.origin), height = 0;
  if (shape.kind == SurfaceKind::kTorus) {
    const double tube = gap_of(piece, frame, &Angles::tube).middle_of_covered;
    rho = shape.radius + shape.minor_radius * std::cos(tube);
    height = shape.minor_radius * std::sin(tube);
  }
  const Vec3 place{rho * std::cos(around), rho * std::sin(around), height};
  return shape.origin + frame.axes.in_space(place);
}

int SheetGeometry::side_of(const PatchSheet& piece, const AnalyticSurface& shape) {
  int side = 0;
  for (const PatchId p : piece) {
    const int here = dot(facets_.planes[p].normal, shape.normal(middle_of_box(p))) > 0 ? 1 : -1;
    if (side == -here) return 0;
    side = here;
  }
  return side;
}

bool SheetGeometry::has_map(const PatchSheet& piece, const AnalyticSurface& shape) {
  if (shape.kind == SurfaceKind::kSphere)
    return lowest_on_sphere(piece, shape, pole_of(piece, shape)) > -std::cos(kFreeAngle / 2);
  const AngleFrame frame = frame_of(piece, shape);
  return gap_of(piece, frame, &Angles::around).width >= kFreeAngle / 2 &&
         (shape.kind != SurfaceKind::kTorus || gap_of(piece, frame, &Angles::tube).width >= kFreeAngle / 2);
}

double SheetGeometry::area_of(const PatchSheet& piece) {
  double area = 0;
  for (const PatchId p : piece) area += area_of(p);
  return area;
}

Plane SheetGeometry::mean_plane(const PatchSheet& piece) {
  Plane mean;
  double area = 0;
  for (const PatchId p : piece) {
    const double share = area_of(p);
    mean.normal += share * facets_.planes[p].normal;
    mean.origin += share * facets_.planes[p].origin;
    area += share;
  }
  mean.origin = area > 0 ? (1 / area) * mean.origin : facets_.planes[piece.front()].origin;
  mean.normal = normalized(mean.normal);
  if (!(norm_squared(mean.normal) > 0.5)) mean.normal = facets_.planes[piece.front()].normal;
  return mean;
}

/// Joins the facets of curved surfaces. All lengths are in model units.
class Joining {
 public:
  Joining(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
          const RecognisedSurfaces& recognised, double feature_angle_deg, std::span<const CurvedLimits> limits,
          const IdVector<FaceId, CurvedRung>& rungs, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        facets_(facets),
        recognised_(recognised),
        min_cosine_(std::cos(feature_angle_deg * std::numbers::pi / 180)),
        limits_(limits),
        rungs_(rungs),
        control_(control),
        check_(control),
        geometry_(surface, facets, control),
        sector_(facets.count(), 0),
        piece_(facets.count()) {}

  CurvedPatches run() {
    find_candidates();
    if (std::find(is_candidate_.begin(), is_candidate_.end(), 1) == is_candidate_.end()) return {};
    // First the sheets are made: all connected facets of a surface. A sheet without a map is divided into sectors.
    join_smooth(piece_);
    divide_sheets();
    UnionFind pieces(facets_.count());
    join_smooth(pieces);
    piece_ = std::move(pieces);
    return make_patches();
  }

 private:
  void find_candidates() {
    is_candidate_.assign(facets_.count(), 0);
    for (std::size_t i = 0; i < facets_.count(); ++i) {
      check_();
      const PatchId p(i);
      const SurfaceId s = recognised_.of_patch[p];
      const bool is_wanted = limits_[s.value].tolerance > 0 && SurfaceMap::can_map(recognised_.surfaces[s].shape);
      if (!is_wanted || rung_of(p) >= CurvedRung::kCoarser) continue;
      const AnalyticSurface& shape = recognised_.surfaces[s].shape;
      is_candidate_[p] = geometry_.goes_around(p, shape) || geometry_.ends_at_axis(p, shape) ? 0 : 1;
    }
  }

  /// Returns the highest rung of a facet's faces.
  CurvedRung rung_of(PatchId p) const {
    CurvedRung highest = CurvedRung::kJoined;
    if (rungs_.empty()) return highest;
    for (const FaceId f : facets_.faces_of(p)) highest = std::max(highest, rungs_[f]);
    return highest;
  }

  /// Joins neighbours over smooth edges if they are pieces of the same surface and lie in the same sector.
  void join_smooth(UnionFind& sets) {
    for (std::size_t e = 0; e < adjacency_.edge_count(); ++e) {
      check_();
      const auto around = adjacency_.half_edges(EdgeId(e));
      if (around.size() != 2 || adjacency_.twin(around[0]) != around[1]) continue;
      const FaceId f = adjacency_.face_of(around[0]), g = adjacency_.face_of(around[1]);
      const PatchId p = facets_.of_face[f], q = facets_.of_face[g];
      if (p == q || is_candidate_[p] == 0 || is_candidate_[q] == 0) continue;
      if (recognised_.of_patch[p] != recognised_.of_patch[q] || sector_[p] != sector_[q]) continue;
      if (surface_.label(f) != surface_.label(g)) continue;
      if (!(dot(facets_.planes[p].normal, facets_.planes[q].normal) >= min_cosine_)) continue;
      sets.join(p.value, q.value);
    }
  }

  const AnalyticSurface& shape_of(PatchId p) const { return recognised_.surfaces[recognised_.of_patch[p]].shape; }

  /// The facets of each set with two or more of them. The sets are in the order of their first facets.
  std::vector<PatchSheet> members(UnionFind& sets) {
    std::vector<PatchSheet> all;
    IdVector<PatchId, std::uint32_t> count(facets_.count(), 0), list(facets_.count(), kNone);
    for (std::uint32_t p = 0; p < facets_.count(); ++p) {
      check_();
      if (is_candidate_[PatchId(p)] != 0) ++count[PatchId(sets.find(p))];
    }
    for (std::uint32_t p = 0; p < facets_.count(); ++p) {
      check_();
      if (is_candidate_[PatchId(p)] == 0) continue;
      const PatchId root(sets.find(p));
      if (count[root] < 2) continue;
      if (list[root] == kNone) {
        list[root] = static_cast<std::uint32_t>(all.size());
        all.emplace_back();
      }
      all[list[root]].push_back(PatchId(p));
    }
    return all;
  }

  void divide_sheets() {
    for (const PatchSheet& sheet : members(piece_)) {
      const std::vector<std::uint8_t> sectors = geometry_.sectors(sheet, shape_of(sheet.front()));
      for (std::size_t i = 0; i < sheet.size(); ++i) sector_[sheet[i]] = sectors[i];
    }
  }

  CurvedPatches make_patches() {
    CurvedPatches result;
    // The first facet of a joined patch stands for it.
    IdVector<PatchId, PatchId> first(facets_.count());
    IdVector<PatchId, std::uint32_t> curved_of(facets_.count(), kNone);
    std::vector<CurvedPatch> curved;
    std::vector<Plane> planes;
    for (std::size_t p = 0; p < facets_.count(); ++p) first[PatchId(p)] = PatchId(p);
    for (const PatchSheet& piece : members(piece_)) {
      const SurfaceId s = recognised_.of_patch[piece.front()];
      const AnalyticSurface& shape = recognised_.surfaces[s].shape;
      const int side = geometry_.side_of(piece, shape);
      if (side == 0 || !geometry_.has_map(piece, shape)) continue;
      for (const PatchId p : piece) first[p] = piece.front();
      curved_of[piece.front()] = static_cast<std::uint32_t>(curved.size());
      const bool is_tight =
          std::any_of(piece.begin(), piece.end(), [&](PatchId p) { return rung_of(p) == CurvedRung::kTightened; });
      curved.push_back({s, SurfaceMap(shape, {geometry_.middle_of_piece(piece, shape), side < 0}),
                        is_tight ? limits_[s.value].tightened() : limits_[s.value], geometry_.area_of(piece)});
      planes.push_back(geometry_.mean_plane(piece));
    }
    if (curved.empty()) return result;
    // A patch is numbered by its first face, and so are facets.
    IdVector<PatchId, PatchId> number(facets_.count());
    PatchSet& set = result.patches;
    for (std::size_t i = 0; i < facets_.count(); ++i) {
      check_();
      const PatchId p(i);
      if (first[p] != p) {
        number[p] = number[first[p]];
        continue;
      }
      const std::uint32_t at = curved_of[p];
      number[p] = set.planes.push_back(at == kNone ? facets_.planes[p] : planes[at]);
      set.deviation.push_back(at == kNone ? facets_.deviation[p] : 0);
      result.surfaces.of_patch.push_back(recognised_.of_patch[p]);
      result.at.push_back(at == kNone ? kNone : static_cast<std::uint32_t>(result.curved.size()));
      if (at != kNone) result.curved.push_back(curved[at]);
    }
    result.surfaces.surfaces = recognised_.copy(control_).surfaces;
    for (RecognisedSurface& s : result.surfaces.surfaces) s.patches = 0;
    for (const SurfaceId s : result.surfaces.of_patch) ++result.surfaces.surfaces[s].patches;
    set.of_face.resize(surface_.face_count());
    for (std::size_t f = 0; f < surface_.face_count(); ++f) {
      check_();
      set.of_face[FaceId(f)] = number[facets_.of_face[FaceId(f)]];
    }
    auto groups = group_by<FaceId>(
        surface_.face_count(), set.count(), [&](std::uint32_t f) { return set.of_face[FaceId(f)].value; }, control_);
    set.face_begin = std::move(groups.begin);
    set.faces = std::move(groups.items);
    return result;
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& facets_;
  const RecognisedSurfaces& recognised_;
  const double min_cosine_;
  std::span<const CurvedLimits> limits_;
  const IdVector<FaceId, CurvedRung>& rungs_;
  RunControl& control_;
  StopCheck check_;
  SheetGeometry geometry_;
  IdVector<PatchId, std::uint8_t> is_candidate_;
  IdVector<PatchId, std::uint8_t> sector_;
  UnionFind piece_;
};

}  // namespace

CurvedLimits CurvedLimits::tightened() const {
  constexpr double kHeight = 0.6, kTurn = 0.75, kBoundary = 0.5;
  return {tolerance, kHeight * max_height, kTurn * max_turn, kBoundary * boundary_tolerance,
          kBoundary * boundary_sideways};
}

CurvedPatches join_curved_facets(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
                                 const RecognisedSurfaces& recognised, double feature_angle_deg,
                                 std::span<const CurvedLimits> limits, const IdVector<FaceId, CurvedRung>& rungs,
                                 RunControl& control) {
  return Joining(surface, adjacency, facets, recognised, feature_angle_deg, limits, rungs, control).run();
}

}  // namespace remesh
