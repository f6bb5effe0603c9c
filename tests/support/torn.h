/// Surfaces that are torn apart: one vertex becomes several, each with a place of its own.
#pragma once

#include <cstdint>
#include <functional>

#include "core/mesh/mesh.h"

namespace remesh::torn {

using Displace = std::function<Vec3(const Vec3&)>;
/// True if a face with this centre belongs to the second part.
using IsSecond = std::function<bool(const Vec3& centre)>;

/// Makes a random plane through the point (0.3, 0.4, 0.2), which has no special position.
IsSecond above_a_plane(unsigned seed);
/// Moves each coordinate by up to `most` at random, differently at every call. A copy begins the sequence anew.
Displace noise(unsigned seed, double most);

/// Gives the faces of the second part their own vertices where they meet the first part. These vertices are
/// displaced.
PolygonMesh in_two(const PolygonMesh& mesh, const IsSecond& is_second, const Displace& displace);
/// Returns how many edges have a face in both parts.
std::uint64_t edges_between(const PolygonMesh& mesh, const IsSecond& is_second);
/// Gives every face its own vertices, which are all displaced.
PolygonMesh into_facets(const PolygonMesh& mesh, const Displace& displace);
/// Returns the wanted faces of a mesh and the vertices that they use.
PolygonMesh only(const PolygonMesh& mesh, const std::function<bool(FaceId)>& is_wanted);

}  // namespace remesh::torn
