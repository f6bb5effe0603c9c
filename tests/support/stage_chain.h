/// Runs the stages from weld to the patches' triangles one after another on a small mesh. The values of each stage
/// can be read.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/report/report.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/coplanar_regions.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/patches/planar/patches.h"

namespace remesh {

/// Runs weld and mend_faces alone.
/// Input: the tolerance in model units.
Surface mended(const PolygonMesh& mesh, double plane_tolerance, std::vector<Diagnostic>& diagnostics);
Surface mended(const PolygonMesh& mesh, double plane_tolerance = 1e-6);

/// Returns the mesh with an integer group for each face. There is a barrier wherever the group changes.
PolygonMesh with_groups(PolygonMesh mesh, const std::vector<std::uint32_t>& group_of_face);

class StageChain {
 public:
  /// Input: `plane_tolerance` - in model units; `forced` - positions that stay in any case.
  explicit StageChain(const PolygonMesh& mesh, double plane_tolerance = 1e-6, const std::vector<Vec3>& forced = {});
  StageChain(const StageChain&) = delete;
  StageChain& operator=(const StageChain&) = delete;

  VertexId at(const Vec3& position) const;
  bool is_essential(const Vec3& position) const { return essential[at(position)]; }
  /// Returns the sorted positions of the essential vertices.
  std::vector<Vec3> essential_places() const;
  /// Returns the patch of a face of the input. If the face was split, it is the patch of its first piece.
  PatchId patch_of(std::size_t input_face) const;
  /// Returns how many coplanar regions the faces are in.
  std::size_t region_count() const;
  std::uint32_t loop_count(PatchId p) const { return loops.patch_begin[p.value + 1] - loops.patch_begin[p.value]; }
  /// Returns the corners of a loop in its direction.
  std::vector<Vec3> loop_points(std::uint32_t loop) const;

  const PatchCharts& charts() const { return triangulated.charts; }

  mutable RunControl control;
  Surface surface;
  double tolerance;  ///< in local units
  Adjacency adjacency;
  FaceGeometries geometry;
  Regions regions;
  PatchSet patches;
  BoundaryLoops loops;
  EssentialVertices essential;
  TriangulatedPatches triangulated;
  PatchMeshes& meshes = triangulated.meshes;
};

}  // namespace remesh
