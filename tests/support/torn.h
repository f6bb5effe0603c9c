/// Surfaces torn apart: what was one vertex is several, each with a place of its own.
#pragma once

#include <cstdint>
#include <functional>

#include "core/mesh/mesh.h"

namespace remesh::torn {

using Displace = std::function<Vec3(const Vec3&)>;
/// Whether a face with this centre belongs to the second part.
using IsSecond = std::function<bool(const Vec3& centre)>;

/// A random plane through a point that is in the middle of nothing: (0.3, 0.4, 0.2).
IsSecond above_a_plane(unsigned seed);
/// Each coordinate moved by up to `most`, at random, differently at every call. Copies begin anew.
Displace noise(unsigned seed, double most);

/// The faces of the second part have vertices of their own where they meet the first one; these are displaced.
PolygonMesh in_two(const PolygonMesh& mesh, const IsSecond& is_second, const Displace& displace);
/// How many edges have a face in both parts.
std::uint64_t edges_between(const PolygonMesh& mesh, const IsSecond& is_second);
/// Every face has vertices of its own, all displaced.
PolygonMesh into_facets(const PolygonMesh& mesh, const Displace& displace);
/// The wanted faces of a mesh, and the vertices that they use.
PolygonMesh only(const PolygonMesh& mesh, const std::function<bool(FaceId)>& is_wanted);

}  // namespace remesh::torn
