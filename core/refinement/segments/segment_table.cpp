#include "core/refinement/segments/segment_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/ids.h"
#include "core/base/prefault_pages.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/patches/charts/patch_chart.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/segments/column_grid.h"
#include "core/refinement/segments/strips.h"
#include "core/refinement/sizes/local_features.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {
namespace {

/// A segment runs along a column if the angles of its ends around the axis differ by less than this part of a column,
/// and differ from the column's angle by less than this part.
constexpr double kAlong = 1e-3;
/// A cut is at least this many rows away from both ends of its segment.
constexpr double kMinRows = 0.7;
/// Beside a plane, the points serve the curved patch alone. They save more triangles there than they add in the plane
/// if the curved patch has at least this many columns.
constexpr double kManyColumns = 6;
/// A patch never asks for more cuts of one segment than this.
constexpr double kMaxCuts = 1 << 20;

bool is_ruled(const AnalyticSurface& shape) {
  return shape.kind == SurfaceKind::kCylinder || shape.kind == SurfaceKind::kCone;
}

/// Returns the cuts of a segment that runs along a column.
std::vector<double> cuts_in_rows(const SegmentTable& table, SegmentId s, const SurfaceMap& map,
                                 const ColumnGrid& grid) {
  const Vec3 start = table.position(s, 0);
  const SurfaceMap::Around from = map.around(start), to = map.around(table.position(s, 1));
  const double column = (0.5 * (from.angle + to.angle) - grid.start) / grid.width, nearest = std::nearbyint(column);
  const bool is_along = std::fabs(to.angle - from.angle) < kAlong * grid.width;
  if (!is_along || std::fabs(column - nearest) > kAlong) return {};
  const double begin = (from.way - grid.low) / grid.row, end = (to.way - grid.low) / grid.row;
  const double low = std::min(begin, end) + kMinRows, high = std::max(begin, end) - kMinRows;
  // Segments that end at the apex of a cone get no cuts. The apex is far below the lowest row.
  if (!(low > -1) || !(high - low < kMaxCuts)) return {};
  const double shift = std::fmod(std::fabs(nearest), 2);
  std::vector<double> cuts;
  for (double i = 2 * std::ceil((low - shift) / 2) + shift; i <= high; i += 2) {
    const Vec3 place = map.point(SurfaceMap::Around{from.angle, grid.low + i * grid.row});
    cuts.push_back(norm(place - start) / table[s].length);
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// Returns whether all pieces are at least as long as the segment's floor.
bool are_long_enough(const std::vector<double>& cuts, const BoundarySegment& segment) {
  double before = 0;
  for (std::size_t i = 0; i <= cuts.size(); ++i) {
    const double here = i < cuts.size() ? cuts[i] : 1;
    if (!((here - before) * segment.length > segment.floor) || !(here > before)) return false;
    before = here;
  }
  return true;
}

/// Returns where segments along the axis of a cylinder or a cone are cut before all other cuts. Such a segment is a
/// column itself, so it gets the points of a column, one in every second row. If it was halved again and again instead,
/// its points would not fit those of the columns beside it, and triangles there would have to be refined. Segments
/// beside a plane are left out if there are few columns, because the cuts would add more triangles in the plane than
/// they save.
/// Input:  the sides of the table.
/// Output: ascending parameters, only for segments with cuts. There are none if angles have no bound, if sizes have
///         one, or if the patch has no column inside. If the patches on both sides ask for different cuts, the longer
///         list is taken, and of equally long lists the smaller one.
/// Cost:   O(n) in the sides of curved patches and in the cuts.
std::map<SegmentId, std::vector<double>> column_cuts(const TriangulatedPatches& triangulated, const SegmentTable& table,
                                                     const Goals& goals, const SizeField& sizes, RunControl& control) {
  std::map<SegmentId, std::vector<double>> result;
  if (!triangulated.charts.has_curved() || goals.min_angle_deg == 0) return result;
  // Patches with sizes are filled evenly.
  if (!sizes.is_uniform() || std::isfinite(sizes.largest())) return result;
  StopCheck check(control);
  for (PatchId p(0); p.value < triangulated.size(); ++p.value) {
    check();
    const PatchChart chart = triangulated.charts[p];
    // Boundaries along the tube of a torus are curves that have been divided.
    if (chart.curved() == nullptr || !is_ruled(chart.curved()->map().shape())) continue;
    const PatchMesh& patch = triangulated.meshes[p];
    if (patch.has_rulings) continue;  // strips have no columns
    std::vector<Vec3> vertices;
    for (const VertexId v : patch.vertices) vertices.push_back(table.surface().positions[v]);
    std::vector<std::array<Vec3, 2>> sides;
    const auto own = table.sides_of_patch(p);
    for (const std::uint32_t i : own) {
      check();
      const std::uint32_t h = table.all_sides()[i].half_edge;
      sides.push_back({vertices[patch.mesh.from(h)], vertices[patch.mesh.to(h)]});
    }
    const ColumnGrid grid = column_grid(*chart.curved(), vertices, sides, control);
    if (!(grid.width > 0) || !(grid.last - grid.first > 1)) continue;
    for (const std::uint32_t i : own) {
      check();
      const SegmentId s = table.all_sides()[i].segment;
      const BoundarySegment& segment = table[s];
      if (segment.is_locked() || segment.ring_base[0] > 0 || segment.ring_base[1] > 0) continue;
      // A plane does not need the vertices of columns.
      const auto beside = table.sides(s);
      const bool has_plane = std::any_of(beside.begin(), beside.end(), [&](const SegmentSide& side) {
        return triangulated.charts[side.patch].curved() == nullptr;
      });
      if (has_plane && grid.last - grid.first < kManyColumns) continue;
      std::vector<double> cuts = cuts_in_rows(table, s, chart.curved()->map(), grid);
      if (cuts.empty() || !are_long_enough(cuts, segment)) continue;
      std::vector<double>& known = result[s];
      const bool is_better = cuts.size() != known.size() ? cuts.size() > known.size() : cuts < known;
      if (is_better) known = std::move(cuts);
    }
  }
  return result;
}

/// Returns the min length of a segment's pieces that follows from the depth of the segment below the surfaces of curved
/// patches beside it. New vertices of such a patch lie on its surface. If pieces were shorter than the segment is deep,
/// these vertices would be near in the plane and far away in space, and no triangle there would have good angles. The
/// result is about 0 if cuts follow the curve in which the surfaces meet.
double floor_below_surface(const SegmentTable& table, SegmentId s, const PatchCharts& charts) {
  double depth = 0;
  if (!charts.has_curved()) return 0;
  for (const SegmentSide& side : table.sides(s)) {
    const PatchChart chart = charts[side.patch];
    if (chart.curved() == nullptr) continue;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
      depth = std::max(depth, std::fabs(chart.height(table.position(s, t))));
  }
  constexpr double kPerDepth = 2;
  return kPerDepth * depth;
}

/// Returns the segments that would come too near to another boundary of a planar patch if they were cut on their
/// curves. In a sliver that is thinner than the cuts would move, the boundaries would cross.
/// Input:  `distance` gives the distance of each side of the table to the nearest feature, in model units.
/// Output: a segment may occur twice.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n) in the sides of the table.
std::vector<SegmentId> segments_without_room(const SegmentTable& table,
                                             const std::function<double(std::uint32_t)>& distance,
                                             const PatchCharts& charts, RunControl& control) {
  // Two boundaries that both move by half of the distance between them meet exactly.
  constexpr double kShareOfRoom = 0.5;
  std::vector<SegmentId> found;
  if (!charts.has_curved()) return found;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < table.all_sides().size(); ++i) {
    check();
    const SegmentSide& side = table.all_sides()[i];
    if (charts[side.patch].curved() != nullptr) continue;
    const SegmentId s = side.segment;
    const Vec3 &from = table.surface().positions[table[s].from], &to = table.surface().positions[table[s].to];
    double moved = 0;
    for (const double t : {0.25, 0.5, 0.75})
      moved = std::max(moved, norm(table.position(s, t) - (from + t * (to - from))));
    if (moved > kShareOfRoom * distance(i)) found.push_back(s);
  }
  return found;
}

/// Segments that meet under a smaller angle in a patch are cut on common rings. It is a little less than 60 degrees,
/// because equilateral facets do not need rings.
constexpr double kSmallAngle = (60 - 1e-6) * std::numbers::pi / 180;

/// The distance that vertices keep from features, in rounding steps of their coordinates. With this distance, rounding
/// moves no point to the other side of a feature.
constexpr double kRoundings = 0x1p10;

/// A piece of length d next to an end is cut at the largest ring that is no farther from the end than this share of d.
constexpr double kRingShare = 2.0 / 3 * (1 + 1e-9);

/// The number of segments in a task.
constexpr std::size_t kSegments = 1024;

/// Returns the largest ring base * 2^k that is at most `most`.
double ring(double base, double most) { return std::ldexp(base, std::ilogb(most / base)); }

struct SegmentUse {
  VertexId from, to;
  PatchId patch;
  std::uint32_t half_edge;

  auto key() const { return std::tie(from, to); }
  friend bool operator<(const SegmentUse& a, const SegmentUse& b) {
    return std::tie(a.from, a.to, a.patch, a.half_edge) < std::tie(b.from, b.to, b.patch, b.half_edge);
  }
};

using SegmentUses = std::vector<SegmentUse, DefaultInit<SegmentUse>>;

/// Returns the constrained half-edges that bound a patch. Edges that are constrained only for the chord rule are left
/// out.
SegmentUses segment_uses(const Surface& surface, const PatchMeshes& meshes, RunControl& control) {
  const auto blocks =
      map_blocks<std::vector<SegmentUse>>(meshes.size(), 256, control, [&](std::size_t p, std::size_t end) {
        std::vector<SegmentUse> uses;
        for (; p < end; ++p) {
          const PatchMesh& patch = meshes[PatchId(p)];
          for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
            if (!patch.mesh.is_constrained(h) || patch.is_reserved(h)) continue;
            VertexId a = patch.vertices[patch.mesh.from(h)], b = patch.vertices[patch.mesh.to(h)];
            if (surface.positions[b] < surface.positions[a]) std::swap(a, b);
            uses.push_back({a, b, PatchId(p), h});
          }
        }
        return uses;
      });
  // Sorting by the first end separates most uses, because few uses have the same first end.
  return sorted_by_key(
      concatenate<SegmentUse>(blocks, control), surface.vertex_count(),
      [](const SegmentUse& use) { return use.from.value; }, control);
}

double magnitude(const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

}  // namespace

double EvenParts::cut(double t0, double t1) const {
  const double middle = t0 + (t1 - t0) / 2;
  if (count < 2) return middle;
  const double shift = is_shifted ? 0.5 : 0;
  const auto end = [&](double part) { return (part - shift) / count; };
  const double first = t0 == 0 ? 0 : std::round(t0 * count + shift);
  const double last = t1 == 1 ? std::ceil(count + shift) : std::round(t1 * count + shift);
  if (last - first < 2 || (t0 != 0 && end(first) != t0) || (t1 != 1 && end(last) != t1)) return middle;
  return end(std::floor((first + last) / 2));
}

std::vector<std::array<VertexId, 2>> segment_ends(const PatchMeshes& meshes, RunControl& control) {
  std::vector<std::array<VertexId, 2>> ends;
  StopCheck check(control);
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
      check();
      if (!patch.mesh.is_constrained(h) || patch.is_reserved(h)) continue;
      const auto [low, high] = std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]);
      ends.push_back({low, high});
    }
  sort_unique(ends, control);
  return ends;
}

SegmentTable::SegmentTable(const Surface& surface, const TriangulatedPatches& triangulated,
                           const IdVector<PatchId, std::uint8_t>& is_frozen, const SizeField& sizes, const Goals& goals,
                           RunControl& control)
    : surface_(surface), min_edge_length_(goals.min_edge_length) {
  const PatchMeshes& meshes = triangulated.meshes;
  const SegmentUses uses = segment_uses(surface, meshes, control);
  const auto for_each_segment = [&](const auto& visit) {
    for_blocks(segments_.size(), kSegments, control, [&](std::size_t s, std::size_t end) {
      for (; s < end; ++s) visit(SegmentId(s), segments_[SegmentId(s)]);
    });
  };
  begin_ = select_ids<std::uint32_t>(uses.size(), kItemsPerBlock, control,
                                     [&](std::size_t i) { return i == 0 || uses[i].key() != uses[i - 1].key(); });
  reserve_pages(segments_.items(), begin_.size(), control);
  segments_.resize(begin_.size());
  begin_.push_back(static_cast<std::uint32_t>(uses.size()));
  reserve_pages(sides_, uses.size(), control);
  sides_.resize(uses.size());
  for_each_segment([&](SegmentId s, BoundarySegment& segment) {
    segment.from = uses[begin_[s.value]].from;
    segment.to = uses[begin_[s.value]].to;
    segment.length = curve(s).length();
    if (!goals.split_boundaries) segment.lock = Lock::kFixed;
    for (std::uint32_t i = begin_[s.value]; i < begin_[s.value + 1]; ++i) {
      sides_[i] = {s, uses[i].patch, uses[i].half_edge};
      if (is_frozen[uses[i].patch] != 0) segment.lock = Lock::kFixed;
    }
  });

  std::vector<PatchId> beside;
  const auto segment_of = [&](SegmentId s) {
    beside.clear();
    for (const SegmentSide& side : sides(s)) beside.push_back(side.patch);
    return TracedSegments::Segment{surface.positions[segments_[s].from], surface.positions[segments_[s].to], beside};
  };
  traced_ = TracedSegments(segments_.size(), segment_of, triangulated.charts, control);
  by_patch_ = group_by(
      sides_.size(), meshes.size(), [&](std::uint32_t i) { return sides_[i].patch.value; }, control);

  // For each patch, find the features that its segments see and the angles between them.
  struct Seen {
    double distance, angle;
    std::uint32_t next;  ///< index of the next side
    double grid_step;    ///< a step of the patch's grid, in model units
  };
  std::vector<Seen> seen;
  reserve_pages(seen, sides_.size(), control);
  seen.resize(sides_.size());
  for_ranges(0, meshes.size(), 64, [&](std::size_t begin, std::size_t end) {
    LocalFeatures local_features;
    std::vector<std::uint32_t> half_edges, side_of;
    for (std::size_t p = begin; p < end; ++p) {
      const auto own = sides_of_patch(PatchId(p));
      const PatchMesh& patch = meshes[PatchId(p)];
      const PatchChart chart = triangulated.charts[PatchId(p)];
      half_edges.clear();
      side_of.assign(patch.mesh.half_edge_count(), kNone);
      for (const std::uint32_t i : own) {
        half_edges.push_back(sides_[i].half_edge);
        side_of[sides_[i].half_edge] = i;
      }
      const auto features = local_features.of(patch, chart, half_edges, control);
      for (std::size_t k = 0; k < own.size(); ++k) {
        const std::uint32_t next = side_of[features[k].next_at_start];
        const Vec2 start = patch.uv[patch.mesh.from(half_edges[k])];
        seen[own[k]] = {features[k].distance, features[k].angle_at_start, next == kNone ? own[k] : next,
                        chart.grid() * chart.scale(start)};
      }
    }
  });

  // Join the ends of segments that meet under a small angle in some patch to clusters.
  const auto end_count = static_cast<std::uint32_t>(2 * segments_.size());
  clusters_ = UnionFind(end_count);
  const auto values_of_ends = [&](double value) {
    std::vector<double> values;
    reserve_pages(values, end_count, control);
    values.resize(end_count, value);
    return values;
  };
  std::vector<double> sharpest = values_of_ends(std::numbers::pi / 2);
  reserve_pages(feature_, segments_.size(), control);
  feature_.resize(segments_.size());
  std::vector<double, DefaultInit<double>> roundings(segments_.size());
  for_each_segment([&](SegmentId s, const BoundarySegment& segment) {
    double &nearest = feature_[s.value], &rounding = roundings[s.value];
    nearest = segment.length;
    rounding = 0x1p-52 * std::max(magnitude(surface.positions[segment.from]), magnitude(surface.positions[segment.to]));
    for (std::uint32_t i = begin_[s.value]; i < begin_[s.value + 1]; ++i) {
      nearest = std::min(nearest, seen[i].distance);
      rounding = std::max(rounding, seen[i].grid_step);
    }
  });
  const auto distance = [&](std::uint32_t i) { return seen[i].distance; };
  for (const SegmentId s : segments_without_room(*this, distance, triangulated.charts, control)) traced_.straighten(s);
  const auto end_at_start = [&](const SegmentSide& side) {
    const PatchMesh& patch = meshes[side.patch];
    const bool is_from = patch.vertices[patch.mesh.from(side.half_edge)] == segments_[side.segment].from;
    return SegmentEnd(side.segment, is_from);
  };
  StopCheck check(control);
  for (std::uint32_t i = 0; i < sides_.size(); ++i) {
    check();
    if (!(seen[i].angle < kSmallAngle) || seen[i].next == i) continue;
    const SegmentEnd here = end_at_start(sides_[i]);
    // The next side runs towards the vertex: it ends where this one starts.
    const SegmentEnd there = end_at_start(sides_[seen[i].next]).opposite();
    clusters_.join(here.index(), there.index());
    corners_.push_back({here, there, seen[i].angle});
    for (const SegmentEnd end : {here, there}) sharpest[end.index()] = std::min(sharpest[end.index()], seen[i].angle);
  }
  std::vector<double> shortest = values_of_ends(HUGE_VAL);
  std::vector<std::uint32_t> members(end_count, 0);
  for (std::uint32_t e = 0; e < end_count; ++e) {
    check();
    const std::uint32_t root = clusters_.find(e);
    shortest[root] = std::min(shortest[root], segments_[SegmentEnd::at(e).segment()].length);
    ++members[root];
  }
  for (std::uint32_t e = 0; e < end_count; ++e) {
    check();
    const std::uint32_t root = clusters_.find(e);
    if (members[root] > 1) ring_base(SegmentEnd::at(e)) = shortest[root] / 3;
  }

  for_each_segment([&](SegmentId s, BoundarySegment& segment) {
    const double noise = kRoundings * roundings[s.value];
    double size = feature_[s.value];
    // A place that is narrower than the shortest allowed edge cannot be cut across.
    if (!segment.is_locked() && !(size > noise)) segment.lock = Lock::kNoRoom;
    if (!segment.is_locked() && size < goals.min_edge_length) segment.lock = Lock::kAsked;
    for (const double t : {0.0, 0.5, 1.0}) size = std::min(size, sizes.at(position(s, t)));
    const double angle = std::min(sharpest[SegmentEnd(s, true).index()], sharpest[SegmentEnd(s, false).index()]);
    // Rings at an angle below 60 degrees are nearer to each other than to the corner.
    const double shortest_piece = goals.min_edge_length / std::min(1.0, 2 * std::sin(angle / 2));
    const double of_features = std::max(kFloorShare * size, noise / std::sin(angle));
    segment.floor = std::max({shortest_piece, of_features, floor_below_surface(*this, s, triangulated.charts)});
    segment.is_min_edge_user_limit = shortest_piece > of_features;
    segment.is_floor_raised = segment.floor > kFloorShare * size;
  });
}

void SegmentTable::plan_cuts(const TriangulatedPatches& triangulated, const SizeField& sizes, const Goals& goals,
                             RunControl& control) {
  const std::vector<EvenParts> parts =
      parts_along_strips(triangulated.meshes, *this, std::exchange(feature_, {}), goals, sizes, control);
  for_blocks(segments_.size(), kSegments, control, [&](std::size_t s, std::size_t end) {
    for (; s < end; ++s) segments_[SegmentId(s)].parts = parts[s];
  });
  column_cuts_ = column_cuts(triangulated, *this, goals, sizes, control);
  corner_rings_ = CornerRings(*this, std::exchange(corners_, {}), goals, sizes, control);
  UnionFind clusters = std::exchange(clusters_, UnionFind());
  // Pieces that corner rings make next to a corner are cut in halves. (If all sizes are the same, that would take up
  // to a tenth more faces.)
  if (sizes.is_uniform()) return;
  const auto end_count = static_cast<std::uint32_t>(2 * segments_.size());
  std::vector<double> first(end_count, HUGE_VAL);
  StopCheck check(control);
  for (std::uint32_t e = 0; e < end_count; ++e) {
    check();
    double& least = first[clusters.find(e)];
    if (const auto rings = corner_rings_.at(SegmentEnd::at(e)); !rings.empty()) least = std::min(least, rings.front());
  }
  for (std::uint32_t e = 0; e < end_count; ++e)
    if (const double base = first[clusters.find(e)]; std::isfinite(base)) ring_base(SegmentEnd::at(e)) = base;
}

std::optional<double> SegmentTable::place_cut(const BoundarySegment& s, double t0, double t1) const {
  const double length = (t1 - t0) * s.length;
  const bool at_from = t0 == 0 && s.ring_base[0] > 0;
  const bool at_to = t1 == 1 && s.ring_base[1] > 0;
  const bool use_from = at_from && (!at_to || s.ring_base[0] <= s.ring_base[1]);
  const double t = use_from ? ring(s.ring_base[0], kRingShare * length) / s.length
                   : at_to  ? 1 - ring(s.ring_base[1], kRingShare * length) / s.length
                            : s.parts.cut(t0, t1);
  if (!(t > t0 && t < t1)) return std::nullopt;
  return t;
}

std::optional<double> SegmentTable::cut(SegmentId id, double t0, double t1) const {
  const BoundarySegment& s = segments_[id];
  if (s.is_locked()) return std::nullopt;
  const std::optional<double> t = place_cut(s, t0, t1);
  if (t && std::min(*t - t0, t1 - *t) * s.length < s.floor) return std::nullopt;
  return t;
}

}  // namespace remesh
