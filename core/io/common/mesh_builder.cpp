#include "core/io/common/mesh_builder.h"

#include <algorithm>
#include <utility>

namespace remesh {

double parse_coordinate(std::string_view token, Place place) {
  const Real real = parse_real(token);
  switch (real.fault) {
    case RealFault::kNone: break;
    case RealFault::kNotANumber:
      throw read_error(place, Code::kInvalidMesh, "a coordinate that is not a number: " + cited(token));
    case RealFault::kNotFinite:
      throw read_error(place, Code::kNonfiniteCoordinate, "a coordinate that is not finite: " + cited(token));
  }
  return real.value;
}

void MeshBuilder::announce(std::uint64_t vertices, std::uint64_t faces, std::uint64_t room_for_vertices,
                           std::uint64_t room_for_faces, Place place) {
  if (vertices > limits_.max_vertices) throw too_large_error(place, "vertices", limits_.max_vertices);
  if (faces > limits_.max_faces) throw too_large_error(place, "faces", limits_.max_faces);
  vertices_announced_ = vertices;
  const auto face_room = static_cast<std::size_t>(std::min(faces, room_for_faces));
  mesh_.positions.reserve(static_cast<std::size_t>(std::min(vertices, room_for_vertices)));
  mesh_.face_begin.reserve(face_room + 1);
  mesh_.corners.reserve(3 * face_room);
}

Error MeshBuilder::nonfinite_vertex(Place place) const {
  return read_error(place, Code::kNonfiniteCoordinate, "a vertex with a coordinate that is not finite")
      .at_element(mesh_.vertex_count());
}

Error MeshBuilder::too_few_corners(std::uint64_t corners, Place place) const {
  return read_error(place, Code::kInvalidMesh,
                    "a face with " + std::to_string(corners) + " corners; at least 3 are needed")
      .at_element(mesh_.face_count());
}

Error MeshBuilder::no_such_vertex(std::int64_t vertex, Place place) const {
  return read_error(place, Code::kIndexOutOfRange,
                    "a face refers to vertex " + std::to_string(vertex) + "; there are " +
                        std::to_string(vertices_announced_) + ", counted from 0")
      .at_element(mesh_.face_count() - 1);
}

void MeshBuilder::tell_progress(std::size_t offset, std::size_t size) {
  control_.progress(static_cast<double>(offset) / static_cast<double>(std::max<std::size_t>(size, 1)));
}

PolygonMesh MeshBuilder::take() {
  if (mesh_.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kRead, "the file has no face");
  return std::move(mesh_);
}

}  // namespace remesh
