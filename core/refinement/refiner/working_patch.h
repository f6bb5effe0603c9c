/// Stores a patch while it is refined.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <memory_resource>
#include <utility>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/refiner/patch_boundary.h"
#include "core/refinement/refiner/patch_start.h"
#include "core/refinement/refiner/refiner_scratch.h"
#include "core/refinement/refiner/task_queues.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/segments/vertex_place.h"
#include "core/triangulation/delaunay_mesh.h"

namespace remesh {

/// A place for a new point, with the cavity that the point would have. The cavity is valid until the next operation of
/// the mesh.
struct PointPlace {
  std::uint32_t hiding_side = kNone;  ///< the side that hides the place, in which case there is no cavity; or kNone
  DelaunayMesh::Cavity cavity;

  bool is_hidden() const { return hiding_side != kNone; }
  bool has_room() const { return cavity.has_room; }
};

/// A triangle meets the goals, or it waits to be treated, or it misses a goal and stays for a reason.
class TriangleState {
 public:
  static constexpr TriangleState good() { return TriangleState(kGood); }
  /// The triangle meets the goals, and thinning out has tried the points around it since it was made.
  static constexpr TriangleState settled() { return TriangleState(kSettled); }
  static constexpr TriangleState waiting() { return TriangleState(kWaiting); }
  explicit constexpr TriangleState(UnrefinedReason why) : value_(static_cast<std::uint8_t>(why)) {}

  bool is_good() const { return value_ == kGood || value_ == kSettled; }
  bool is_settled() const { return value_ == kSettled; }
  bool is_waiting() const { return value_ == kWaiting; }
  /// The triangle must be one that stays.
  UnrefinedReason reason() const {
    assert(!is_good() && !is_waiting());
    return static_cast<UnrefinedReason>(value_);
  }

 private:
  static constexpr std::uint8_t kGood = 0xff, kWaiting = 0xfe, kSettled = 0xfd;
  explicit constexpr TriangleState(std::uint8_t value) : value_(value) {}

  std::uint8_t value_;
};

/// The columns of a curved patch run along its surface's axis. The angle between two columns is the max turn of an
/// edge. So a point between columns would have neighbours that are too far away, and their edges would have to be
/// divided in turn.
struct Columns {
  double start = 0, width = 0;  ///< angles around the axis; without columns the width is 0
};

/// All data of a patch that is kept between the turns of its refinement. The classes that refine the patch work on it
/// together.
struct WorkingPatch {
  /// Input: `chart` must outlive this object.
  WorkingPatch(PatchStart start, const PatchToRefine& patch, const PatchChart& patch_chart,
               std::pmr::memory_resource* memory)
      : mesh(std::move(start.mesh)),
        places(std::move(start.places)),
        boundary(std::move(start.boundary)),
        chart(patch_chart),
        in_space(memory),
        states(memory),
        own_cuts(memory) {
    if (chart.curved() == nullptr) return;
    in_space.reserve(places.size());
    for (std::uint32_t v = 0; v < places.size(); ++v)
      in_space.push_back(places[v].is_original() ? chart.curved()->space_point(patch.position(v)) : space_point_of(v));
  }

  DelaunayMesh mesh;
  std::pmr::vector<VertexPlace> places;  ///< one per vertex of the mesh
  PatchBoundary boundary;
  const PatchChart& chart;
  /// The vertices in space, one per vertex of the mesh. It is empty unless the patch is curved.
  std::pmr::vector<SpacePoint> in_space;
  Columns columns;                         ///< only of a curved patch with an axis
  std::pmr::vector<TriangleState> states;  ///< one per triangle of the mesh
  /// A triangle with a shorter shortest edge is in a higher queue. There are eight queues for each octave of the
  /// squared length. Within a queue, the first in is the first out; so where all triangles are alike, they are treated
  /// layer after layer.
  TaskQueues<TriangleTask> waiting;
  std::pmr::vector<Cut> own_cuts;  ///< cuts that were made here and not yet sent to other patches
  /// A segment that had to be cut where rounding left no room for the cut; invalid if there is none.
  SegmentId impossible;

  bool is_free(std::uint32_t v) const { return places[v].is_free(); }
  MinSpacing spacing_of(std::uint32_t v) const {
    const VertexPlace& place = places[v];
    return place.is_on_segment() ? boundary.spacing_on(place.segment()) : place.spacing();
  }
  void set_place(std::uint32_t v, const VertexPlace& place) {
    if (v == places.size())
      places.push_back(place);
    else
      places[v] = place;
    if (chart.curved() == nullptr) return;
    in_space.resize(places.size());
    in_space[v] = space_point_of(v);
  }
  /// Returns the place on the nearest column at the same height. Without columns, returns the place itself.
  Vec2 in_column(Vec2 p) const {
    if (!(columns.width > 0)) return p;
    const SurfaceMap& map = chart.curved()->map();
    const SurfaceMap::Around at = map.around(chart.to_space(p));
    const double column = std::nearbyint((at.angle - columns.start) / columns.width);
    return chart.to_plane(map.point(SurfaceMap::Around{columns.start + column * columns.width, at.way}));
  }
  /// Returns the place in space of a vertex of a curved patch that was added by refinement.
  SpacePoint space_point_of(std::uint32_t v) const {
    const VertexPlace& place = places[v];
    return chart.curved()->space_point(place.is_on_segment() ? boundary.position(place.segment(), place.parameter())
                                                             : chart.to_space(mesh.point(v)));
  }

  /// Finds the cavity of a point. The search begins at a triangle. A point that is not finite has no room: where the
  /// map of a curved surface ends, there is no place on a column.
  PointPlace look_at(Vec2 p, std::uint32_t triangle) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return {kNone, {p, {}, {}, false}};
    const DelaunayMesh::Location at = mesh.locate(triangle, p);
    if (at.is_hidden) return {mesh.side(at.half_edge), {p, {}, {}, false}};
    return {kNone, mesh.find_cavity(p, at.half_edge / 3)};
  }

  /// Puts a triangle into the queue.
  /// Input: the square of its shortest edge.
  void wait(const TriangleTask& task, double shortest_squared) {
    // The bits are the exponent and three bits of the mantissa, as the number stores them. Squared lengths within the
    // frame are at most 8.
    const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(shortest_squared) >> 49);
    constexpr std::int64_t kLargest = (1023 + 4) << 3;
    waiting.push(static_cast<std::size_t>(std::max<std::int64_t>(0, kLargest - bits)), task);
  }
  /// Returns whether the triangle is still the one that was put into the queue.
  bool is_live(const TriangleTask& task) const {
    const std::uint32_t h = task.half_edge;
    return mesh.from(h) == task.a && mesh.to(h) == task.b && mesh.apex(h) == task.c;
  }
};

}  // namespace remesh
