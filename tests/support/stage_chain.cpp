#include "tests/support/stage_chain.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "core/mending/polygons/mend_faces.h"
#include "core/mending/weld/weld.h"
#include "core/mesh/pinched_vertices.h"
#include "core/patches/planar/essential_vertices.h"

namespace remesh {

Surface mended(const PolygonMesh& mesh, double plane_tolerance, std::vector<Diagnostic>& diagnostics) {
  RunControl control;
  Surface surface = weld(mesh, Barriers{}, diagnostics, control);
  surface.detach();
  mend_faces(surface, plane_tolerance / surface.unit, {}, MendMode::kYes, diagnostics, control);
  return surface;
}

Surface mended(const PolygonMesh& mesh, double plane_tolerance) {
  std::vector<Diagnostic> diagnostics;
  return mended(mesh, plane_tolerance, diagnostics);
}

PolygonMesh with_groups(PolygonMesh mesh, const std::vector<std::uint32_t>& group_of_face) {
  mesh.labels.group.of_face.items() = group_of_face;
  const std::uint32_t count = 1 + *std::max_element(group_of_face.begin(), group_of_face.end());
  for (std::uint32_t g = 0; g < count; ++g) mesh.labels.group.names.push_back("g" + std::to_string(g));
  return mesh;
}

StageChain::StageChain(const PolygonMesh& mesh, double plane_tolerance, const std::vector<Vec3>& forced)
    : surface(mended(mesh, plane_tolerance)),
      tolerance(plane_tolerance / surface.unit),
      adjacency(surface.vertex_count(), surface.face_begin, surface.corners, control),
      geometry(face_geometry(surface, control)) {
  const IdVector<FaceId, std::uint8_t> rung(surface.face_count(), 0);
  coplanar_regions(surface, adjacency, geometry, {tolerance, 1e-6, &surface.face_label, &rung}, regions, control);
  patches = remesh::patches(surface, adjacency, regions, control);
  loops = boundary_loops(surface, adjacency, patches, control);
  IdVector<VertexId, std::uint8_t> stays(surface.vertex_count(), 0);
  for (const Vec3& p : forced) stays[at(p)] = 1;
  essential = essential_vertices(surface, adjacency, loops, stays, pinched_vertices(surface, adjacency, control),
                                 tolerance, control);
  triangulated = mesh_patches(surface, adjacency, patches, loops, essential, {}, control);
}

VertexId StageChain::at(const Vec3& position) const {
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v)
    if (surface.positions[VertexId(v)] == position) return VertexId(v);
  throw std::invalid_argument("no vertex there");
}

std::vector<Vec3> StageChain::essential_places() const {
  std::vector<Vec3> points;
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v)
    if (essential[VertexId(v)]) points.push_back(surface.positions[VertexId(v)]);
  std::sort(points.begin(), points.end());
  return points;
}

std::size_t StageChain::region_count() const {
  return std::set<RegionId>(regions.of_face.begin(), regions.of_face.end()).size();
}

PatchId StageChain::patch_of(std::size_t input_face) const {
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (surface.face_source[FaceId(f)] == FaceId(input_face)) return patches.of_face[FaceId(f)];
  throw std::invalid_argument("the face was dropped");
}

std::vector<Vec3> StageChain::loop_points(std::uint32_t loop) const {
  std::vector<Vec3> points;
  for (const std::uint32_t h : loops.loop(loop)) points.push_back(surface.positions[adjacency.from(h)]);
  return points;
}

}  // namespace remesh
