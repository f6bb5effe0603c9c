/// Builds a mesh within its limits. It is shared by the readers of formats that announce their counts.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/format.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Parses the number in a token of text.
/// Errors: kInvalidMesh - not a number; kNonfiniteCoordinate - an infinite number, or "not a number" by name.
double parse_coordinate(std::string_view token, Place place);

/// Collects vertices and faces as a reader finds them. A `place` argument is the position in the input, for errors.
/// Holds: the invariants of PolygonMesh, once the announced vertices have been added.
class MeshBuilder {
 public:
  MeshBuilder(const ReadLimits& limits, RunControl& control) : limits_(limits), control_(control) {}

  /// Announces the counts that the file states.
  /// Input: `room_for_vertices`, `room_for_faces` - how many of each the file's length permits at most; no more
  ///        memory is reserved.
  /// Errors: kMeshTooLarge - more than the limits.
  void announce(std::uint64_t vertices, std::uint64_t faces, std::uint64_t room_for_vertices,
                std::uint64_t room_for_faces, Place place);

  /// Adds a vertex.
  /// Errors: kNonfiniteCoordinate, with the vertex.
  void add_vertex(const Vec3& position, Place place) {
    if (!is_finite(position)) throw nonfinite_vertex(place);
    mesh_.positions.push_back(position);
  }
  /// Begins a face.
  /// Errors: kInvalidMesh - fewer than three corners; kMeshTooLarge - more corners in all than 32 bits can count.
  void begin_face(std::uint64_t corners, Place place) {
    if (corners < 3) throw too_few_corners(corners, place);
    if (corners > PolygonMesh::kMaxCorners - mesh_.corners.size())
      throw too_large_error(place, "face corners", PolygonMesh::kMaxCorners);
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size() + corners));
  }
  /// Adds a corner to the face that was begun last.
  /// Errors: kIndexOutOfRange, with the face - it is none of the announced vertices.
  void add_corner(std::int64_t vertex, Place place) {
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertices_announced_) throw no_such_vertex(vertex, place);
    mesh_.corners.emplace_back(static_cast<std::uint32_t>(vertex));
  }

  const PolygonMesh& mesh() const { return mesh_; }
  PolygonMesh& mesh() { return mesh_; }

  /// Must be called once for each element. From time to time it updates the progress and checks for cancellation.
  void tick(std::size_t offset, std::size_t size) {
    constexpr std::uint32_t kTicks = 4096;
    if (++ticks_ % kTicks == 0) tell_progress(offset, size);
  }

  /// Returns the mesh.
  /// Errors: kEmptyMesh - no face.
  PolygonMesh take();

 private:
  Error nonfinite_vertex(Place place) const;
  Error too_few_corners(std::uint64_t corners, Place place) const;
  Error no_such_vertex(std::int64_t vertex, Place place) const;
  void tell_progress(std::size_t offset, std::size_t size);

  const ReadLimits& limits_;
  RunControl& control_;
  PolygonMesh mesh_;
  std::uint64_t vertices_announced_ = 0;
  std::uint32_t ticks_ = 0;
};

}  // namespace remesh
