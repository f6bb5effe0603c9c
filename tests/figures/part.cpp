#include "tests/figures/part.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/options.h"
#include "core/mending/polygons/mend_faces.h"
#include "core/mending/weld/weld.h"
#include "core/mesh/face_geometry.h"
#include "core/output/report/report.h"
#include "core/patches/planar/coplanar_regions.h"

namespace remesh::figures {

Part make_part(const PolygonMesh& mesh, double plane_tolerance, RunControl& control) {
  std::vector<Diagnostic> diagnostics;
  Surface surface = weld(mesh, Barriers{}, diagnostics, control);
  surface.detach();
  const double tolerance = plane_tolerance / surface.unit;
  mend_faces(surface, tolerance, {}, MendMode::kYes, diagnostics, control);
  Adjacency adjacency(surface.vertex_count(), surface.face_begin, surface.corners, control);
  const IdVector<FaceId, std::uint32_t> zone(surface.face_count(), 0);
  const IdVector<FaceId, std::uint8_t> rung(surface.face_count(), 0);
  Regions regions;
  regions.of_face.resize(surface.face_count());
  coplanar_regions(surface, adjacency, face_geometry(surface, control),
                   {tolerance, Options{}.normal_tolerance, &zone, &rung}, regions, control);
  PatchSet set = patches(surface, adjacency, regions, control);
  return {std::move(surface), std::move(adjacency), std::move(set), tolerance};
}

Triangle corners_of(const Surface& surface, FaceId f) {
  const auto corners = surface.face(f);
  return {corners[0], corners[1], corners[2]};
}

}  // namespace remesh::figures
