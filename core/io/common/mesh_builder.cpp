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

void MeshBuilder::add_vertex(const Vec3& position, Place place) {
  if (!is_finite(position)) {
    throw read_error(place, Code::kNonfiniteCoordinate, "a vertex with a coordinate that is not finite")
        .at_element(mesh_.vertex_count());
  }
  mesh_.positions.push_back(position);
}

void MeshBuilder::begin_face(std::uint64_t corners, Place place) {
  if (corners < 3) {
    throw read_error(place, Code::kInvalidMesh,
                     "a face with " + std::to_string(corners) + " corners; at least 3 are needed")
        .at_element(mesh_.face_count());
  }
  if (corners > PolygonMesh::kMaxCorners - mesh_.corners.size())
    throw too_large_error(place, "face corners", PolygonMesh::kMaxCorners);
  mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size() + corners));
}

void MeshBuilder::add_corner(std::int64_t vertex, Place place) {
  if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertices_announced_) {
    throw read_error(place, Code::kIndexOutOfRange,
                     "a face refers to vertex " + std::to_string(vertex) + "; there are " +
                         std::to_string(vertices_announced_) + ", counted from 0")
        .at_element(mesh_.face_count() - 1);
  }
  mesh_.corners.emplace_back(static_cast<std::uint32_t>(vertex));
}

void MeshBuilder::tick(std::size_t offset, std::size_t size) {
  constexpr std::uint32_t kTicks = 4096;
  if (++ticks_ % kTicks != 0) return;
  control_.progress(static_cast<double>(offset) / static_cast<double>(std::max<std::size_t>(size, 1)));
}

PolygonMesh MeshBuilder::take() {
  if (mesh_.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kRead, "the file has no face");
  return std::move(mesh_);
}

}  // namespace remesh
