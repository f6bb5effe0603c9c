/// Stores a patch while it is refined.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory_resource>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/refinement/delaunay_mesh.h"
#include "core/refinement/min_spacing.h"
#include "core/refinement/patch_boundary.h"
#include "core/refinement/patch_start.h"
#include "core/refinement/refiner_scratch.h"
#include "core/refinement/segment_cuts.h"
#include "core/refinement/task_queues.h"
#include "core/refinement/triangle_state.h"
#include "core/refinement/vertex_place.h"

namespace remesh {

/// This is a place for a new point, with the cavity that the point would have. The cavity is valid until the next
/// operation of the mesh.
struct PointPlace {
  std::uint32_t hiding_side = kNone;  ///< the side that hides the place; then there is no cavity. kNone: none
  DelaunayMesh::Cavity cavity;

  bool is_hidden() const { return hiding_side != kNone; }
  bool has_room() const { return cavity.has_room; }
};

/// This is everything that a patch has while it is refined and that it keeps between its turns. The classes that refine
/// the patch work on it together.
struct WorkingPatch {
  WorkingPatch(PatchStart start, std::pmr::memory_resource* memory)
      : mesh(std::move(start.mesh)),
        places(std::move(start.places)),
        boundary(std::move(start.boundary)),
        states(memory),
        own_cuts(memory) {}

  DelaunayMesh mesh;
  std::pmr::vector<VertexPlace> places;  ///< one per vertex of the mesh
  PatchBoundary boundary;
  std::pmr::vector<TriangleState> states;  ///< one per triangle of the mesh
  /// The shorter a triangle's shortest edge is, the higher is its queue. There are eight queues for each octave of the
  /// squared length. Within a queue, the first in is the first out; so where all triangles are alike, they are treated
  /// layer after layer.
  TaskQueues<TriangleTask> waiting;
  std::pmr::vector<Cut> own_cuts;  ///< cuts that were made here and not yet told to other patches
  /// This is a segment that had to be cut where rounding left no room for the cut, or else it is invalid.
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
  }

  /// Looks for the cavity of a point. The search begins at a triangle.
  PointPlace look_at(Vec2 p, std::uint32_t triangle) {
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
