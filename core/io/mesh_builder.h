/// What the readers of formats with announced counts share: a mesh that grows within its limits.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/formats.h"
#include "core/io/read_errors.h"
#include "core/io/text.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The number in a token of text.
/// Errors: kInvalidMesh - none; kNonfiniteCoordinate - an infinite one, or "not a number" by name.
double parse_coordinate(std::string_view token, Place place);

/// Takes down vertices and faces as a reader finds them. A place is where in the input that is, for errors.
/// Holds: what PolygonMesh promises, once `vertices` of them have been added.
class MeshBuilder {
 public:
  MeshBuilder(const ReadLimits& limits, RunControl& control) : limits_(limits), control_(control) {}

  /// The counts that the file announces, and how many of each its length has room for: nothing more is reserved.
  /// Errors: kMeshTooLarge - more than the limits.
  void announce(std::uint64_t vertices, std::uint64_t faces, std::uint64_t room_for_vertices,
                std::uint64_t room_for_faces, Place place);

  /// Errors: kNonfiniteCoordinate, with the vertex.
  void add_vertex(const Vec3& position, Place place);
  /// Errors: kInvalidMesh - fewer than three corners; kMeshTooLarge - more corners than 32 bits count.
  void begin_face(std::uint64_t corners, Place place);
  /// A corner of the face that was begun last.
  /// Errors: kIndexOutOfRange, with the face - none of the vertices announced.
  void add_corner(std::int64_t vertex, Place place);

  std::uint64_t vertices_announced() const { return vertices_announced_; }
  const PolygonMesh& mesh() const { return mesh_; }
  PolygonMesh& mesh() { return mesh_; }

  /// To be called once an element: progress and a point of cancellation, now and then.
  void tick(std::size_t offset, std::size_t size);

  /// Errors: kEmptyMesh - no face.
  PolygonMesh take();

 private:
  const ReadLimits& limits_;
  RunControl& control_;
  PolygonMesh mesh_;
  std::uint64_t vertices_announced_ = 0;
  std::uint32_t ticks_ = 0;
};

}  // namespace remesh
