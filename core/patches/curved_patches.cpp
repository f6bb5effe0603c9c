#include "core/patches/curved_patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

constexpr double kPi = std::numbers::pi;

/// A piece whose map is to be one-to-one leaves at least this angle free around an axis. The map of a sphere reaches
/// this far beyond the equator at most.
constexpr double kFreeAngle = kPi / 3, kBeyondEquator = kPi / 18;

/// An interval of angles that a facet covers, from `begin` on, which is between 0 and a full turn.
struct Covered {
  double begin, width;
};

double within_turn(double angle) {
  const double turns = angle / (2 * kPi);
  return angle - std::floor(turns) * 2 * kPi;
}

/// The largest gap between intervals of angles.
struct Gap {
  double width = 0;
  double middle_of_covered = 0;
};

Gap largest_gap(std::vector<Covered>& covered, const RunControl& control) {
  const auto before = [](const Covered& a, const Covered& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.width < b.width;
  };
  sort_stoppable(covered.begin(), covered.end(), control, before);
  // The interval that reaches farthest may reach beyond a full turn, up to where the first ones begin.
  double reached = -2 * kPi;
  for (const Covered& c : covered) reached = std::max(reached, c.begin + c.width - 2 * kPi);
  Gap gap;
  for (const Covered& c : covered) {
    if (c.begin - reached > gap.width) gap = {c.begin - reached, within_turn(0.5 * (reached + c.begin) + kPi)};
    reached = std::max(reached, c.begin + c.width);
  }
  return gap;
}

/// Returns the area of a flat facet, in squared local units. In these, the rounding is the same at every scale.
double area_of(const Surface& surface, std::span<const FaceId> faces, StopCheck& check) {
  Vec3 twice;
  for (const FaceId f : faces) {
    check();
    const auto face = surface.face(f);
    for (std::size_t i = 2; i < face.size(); ++i)
      twice +=
          cross(surface.local[face[i - 1]] - surface.local[face[0]], surface.local[face[i]] - surface.local[face[0]]);
  }
  return norm(twice) / 2;
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
        min_cosine_(std::cos(feature_angle_deg * kPi / 180)),
        limits_(limits),
        rungs_(rungs),
        control_(control),
        check_(control),
        sector_(facets.count(), 0),
        piece_(facets.count()) {}

  CurvedPatches run() {
    find_candidates();
    if (std::find(is_candidate_.begin(), is_candidate_.end(), 1) == is_candidate_.end()) return {};
    // First the sheets, which are all facets that hang together. A sheet without a map is divided into sectors.
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
      is_candidate_[p] = is_wanted && rung_of(p) != CurvedRung::kFacet ? 1 : 0;
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
  std::vector<std::vector<PatchId>> members(UnionFind& sets) {
    std::vector<std::vector<PatchId>> all;
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

  template <class Take>
  void for_each_corner(PatchId p, const Take& take) {
    for (const FaceId f : facets_.faces_of(p))
      for (const VertexId v : surface_.face(f)) {
        check_();
        take(surface_.positions[v]);
      }
  }

  /// Returns the middle of a facet's bounding box.
  Vec3 middle_of(PatchId p) {
    Box3 box;
    for_each_corner(p, [&](const Vec3& corner) { box.add(corner); });
    return 0.5 * box.min + 0.5 * box.max;
  }

  Vec3 smallest_corner(const std::vector<PatchId>& sheet) {
    Vec3 smallest;
    bool is_first = true;
    for (const PatchId p : sheet)
      for_each_corner(p, [&](const Vec3& corner) {
        if (is_first || corner < smallest) smallest = corner;
        is_first = false;
      });
    return smallest;
  }

  /// Two angles of a point: around the axis and, on a torus, around the tube.
  struct Angles {
    double around, tube;
  };
  struct AngleFrame {
    const AnalyticSurface& shape;
    Axes axes;
    /// Returns the distance of a point from the axis.
    double radius(const Vec3& p) const {
      const Vec3 q = axes.along(p - shape.origin);
      return std::hypot(q.x, q.y);
    }
    Angles of(const Vec3& p) const {
      const Vec3 q = axes.along(p - shape.origin);
      return {std::atan2(q.y, q.x), std::atan2(q.z, std::hypot(q.x, q.y) - shape.radius)};
    }
  };
  /// Makes axes in which the angles of a sheet are measured. They depend on the sheet's smallest corner.
  AngleFrame frame_of(const std::vector<PatchId>& sheet) {
    const AnalyticSurface& shape = shape_of(sheet.front());
    return {shape, SurfaceMap(shape, {smallest_corner(sheet), false}).axes()};
  }

  /// Returns the interval of angles that the corners of a facet cover.
  Covered covered_by(PatchId p, double middle, const AngleFrame& frame, double Angles::*which) {
    double low = 0, high = 0;
    // The apex of a cone has no angle around the axis.
    constexpr double kOnAxis = 1e-3;
    const double least = kOnAxis * frame.radius(middle_of(p));
    for_each_corner(p, [&](const Vec3& corner) {
      if (!(frame.radius(corner) > least)) return;
      double turn = frame.of(corner).*which - middle;
      turn -= std::nearbyint(turn / (2 * kPi)) * 2 * kPi;
      low = std::min(low, turn);
      high = std::max(high, turn);
    });
    return {within_turn(middle + low), high - low};
  }

  Gap gap_of(const std::vector<PatchId>& sheet, const AngleFrame& frame, double Angles::*which) {
    std::vector<Covered> covered;
    covered.reserve(sheet.size());
    for (const PatchId p : sheet) covered.push_back(covered_by(p, frame.of(middle_of(p)).*which, frame, which));
    return largest_gap(covered, control_);
  }

  void divide_sheets() {
    for (const std::vector<PatchId>& sheet : members(piece_)) {
      const AnalyticSurface& shape = shape_of(sheet.front());
      if (shape.kind == SurfaceKind::kSphere) {
        divide_sphere(sheet, shape);
        continue;
      }
      const AngleFrame frame = frame_of(sheet);
      const bool is_around = gap_of(sheet, frame, &Angles::around).width < kFreeAngle;
      const bool is_tube = shape.kind == SurfaceKind::kTorus && gap_of(sheet, frame, &Angles::tube).width < kFreeAngle;
      if (!is_around && !is_tube) continue;
      // Sectors begin at the angles of a corner. If corners are even, facets end where sectors do.
      const Angles first = frame.of(smallest_corner(sheet));
      for (const PatchId p : sheet) {
        const Angles at = frame.of(middle_of(p));
        if (is_around && within_turn(at.around - first.around) >= kPi) sector_[p] |= 1;
        if (is_tube && within_turn(at.tube - first.tube) >= kPi) sector_[p] |= 2;
      }
    }
  }

  /// Returns the mean direction of a sheet of a sphere, or that of its smallest corner if the sheet is nearly closed.
  Vec3 pole_of(const std::vector<PatchId>& sheet, const AnalyticSurface& shape) {
    Vec3 sum;
    for (const PatchId p : sheet) {
      const double size = norm(middle_of(p) - shape.origin);
      if (size > 0)
        sum += area_of(surface_, facets_.faces_of(p), check_) * ((1 / size) * (middle_of(p) - shape.origin));
    }
    double area = 0;
    for (const PatchId p : sheet) area += area_of(surface_, facets_.faces_of(p), check_);
    constexpr double kClear = 0.05;
    return norm(sum) > kClear * area ? normalized(sum) : normalized(smallest_corner(sheet) - shape.origin);
  }

  void divide_sphere(const std::vector<PatchId>& sheet, const AnalyticSurface& shape) {
    const Vec3 pole = pole_of(sheet, shape);
    double lowest = 1;
    for (const PatchId p : sheet)
      for_each_corner(
          p, [&](const Vec3& corner) { lowest = std::min(lowest, dot(normalized(corner - shape.origin), pole)); });
    if (lowest >= -std::sin(kBeyondEquator)) return;
    for (const PatchId p : sheet) sector_[p] = dot(middle_of(p) - shape.origin, pole) < 0 ? 1 : 0;
  }

  /// Returns the largest distance of a piece's corners from a point.
  double reach_of(const std::vector<PatchId>& piece, const Vec3& point) {
    double reach = 0;
    for (const PatchId p : piece)
      for_each_corner(p, [&](const Vec3& corner) { reach = std::max(reach, norm(corner - point)); });
    return reach;
  }

  /// Returns a point in the direction of the middle of a piece, seen from the axis or the centre. From there, the map
  /// is as even as it can be. Its distance is of the size of the model, so that a scaling changes no direction.
  Vec3 middle_of_piece(const std::vector<PatchId>& piece, const AnalyticSurface& shape) {
    if (shape.kind == SurfaceKind::kSphere) return shape.origin + shape.radius * pole_of(piece, shape);
    const AngleFrame frame = frame_of(piece);
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

  /// Returns 1 if all facets look away from the axis or centre, -1 if all look towards it, and otherwise 0.
  int side_of(const std::vector<PatchId>& piece, const AnalyticSurface& shape) {
    int side = 0;
    for (const PatchId p : piece) {
      const int here = dot(facets_.planes[p].normal, shape.normal(middle_of(p))) > 0 ? 1 : -1;
      if (side == -here) return 0;
      side = here;
    }
    return side;
  }

  bool has_map(const std::vector<PatchId>& piece, const AnalyticSurface& shape) {
    if (shape.kind == SurfaceKind::kSphere) {
      const Vec3 pole = pole_of(piece, shape);
      double lowest = 1;
      for (const PatchId p : piece)
        for_each_corner(
            p, [&](const Vec3& corner) { lowest = std::min(lowest, dot(normalized(corner - shape.origin), pole)); });
      return lowest > -std::cos(kFreeAngle / 2);
    }
    const AngleFrame frame = frame_of(piece);
    return gap_of(piece, frame, &Angles::around).width >= kFreeAngle / 2 &&
           (shape.kind != SurfaceKind::kTorus || gap_of(piece, frame, &Angles::tube).width >= kFreeAngle / 2);
  }

  CurvedPatches make_patches() {
    CurvedPatches result;
    // The first facet of a joined patch stands for it.
    IdVector<PatchId, PatchId> first(facets_.count());
    IdVector<PatchId, std::uint32_t> curved_of(facets_.count(), kNone);
    std::vector<CurvedPatch> curved;
    std::vector<Plane> planes;
    for (std::size_t p = 0; p < facets_.count(); ++p) first[PatchId(p)] = PatchId(p);
    for (const std::vector<PatchId>& piece : members(piece_)) {
      const SurfaceId s = recognised_.of_patch[piece.front()];
      const AnalyticSurface& shape = recognised_.surfaces[s].shape;
      const int side = side_of(piece, shape);
      if (side == 0 || !has_map(piece, shape)) continue;
      for (const PatchId p : piece) first[p] = piece.front();
      curved_of[piece.front()] = static_cast<std::uint32_t>(curved.size());
      const bool is_tight =
          std::any_of(piece.begin(), piece.end(), [&](PatchId p) { return rung_of(p) == CurvedRung::kTightened; });
      curved.push_back({s, SurfaceMap(shape, {middle_of_piece(piece, shape), side < 0}),
                        is_tight ? limits_[s.value].tightened() : limits_[s.value]});
      planes.push_back(mean_plane(piece));
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
    result.surfaces.surfaces = recognised_.surfaces;
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

  /// Returns a plane with the mean normal through the mean of the facets' planes' origins, in local units.
  Plane mean_plane(const std::vector<PatchId>& piece) {
    Plane mean;
    double area = 0;
    for (const PatchId p : piece) {
      const double share = area_of(surface_, facets_.faces_of(p), check_);
      mean.normal += share * facets_.planes[p].normal;
      mean.origin += share * facets_.planes[p].origin;
      area += share;
    }
    mean.origin = area > 0 ? (1 / area) * mean.origin : facets_.planes[piece.front()].origin;
    mean.normal = normalized(mean.normal);
    if (!(norm_squared(mean.normal) > 0.5)) mean.normal = facets_.planes[piece.front()].normal;
    return mean;
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
