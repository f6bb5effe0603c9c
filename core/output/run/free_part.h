/// The part of a surface that has no formula, as it is given to the stage that makes it coarser.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/free_form.h"
#include "core/geometry/triangles/distances.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Holds a surface, with what was recognised of it.
struct FreeContext {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  const RecognisedSurfaces& recognised;
  std::span<const std::pair<FaceId, FaceId>> crossing;  ///< faces that intersect each other; they stay
  double feature_angle_deg;                             ///< edges that turn by more stay
};

/// The role of a face in the stage that makes free surfaces coarser.
enum class FaceRole : std::uint8_t {
  kStays,  ///< belongs to a curved surface, crosses another face, or closes a hole
  kPlane,  ///< belongs to a plane, which keeps its plane
  kFree    ///< belongs to no surface, and may be replaced by others
};

/// Returns the roles of all faces. A plane that is no larger than some facets and goes over smoothly into free ones is
/// free as well, and so is one of small facets that is smooth all around, and so are needles side by side.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n), in parallel.
FilledIdVector<FaceId, FaceRole> roles_of(const FreeContext& context, const Triangulated& triangles,
                                          RunControl& control);

/// The triangles of the free faces, and those of other faces that have a vertex with them in common.
/// This class is larger than the bound because it has an array for each of the engine's.
struct FreePart {
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n).
  FreePart(const FreeContext& context, const Triangulated& triangles, const FilledIdVector<FaceId, FaceRole>& roles,
           RunControl& control);

  bool is_empty() const { return free_faces == 0; }
  bool is_whole() const { return kept.empty(); }
  FreeForm form() const { return {positions, faces, twins, edges, {}, is_of_plane, is_held}; }
  bool is_free(FaceId f) const { return is_of_plane[f.value] == 0; }
  Corners3 corners(FaceId f) const {
    const Triangle& t = faces[f];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }

  IdVector<VertexId, Vec3> positions;   ///< in local units
  IdVector<VertexId, VertexId> vertex;  ///< the surface's vertex
  IdVector<FaceId, Triangle> faces;
  IdVector<FaceId, FaceId> face;           ///< the surface's face
  IdVector<FaceId, std::uint32_t> region;  ///< the number of the plane, or of the label of free faces
  std::vector<std::uint32_t> twins;
  std::vector<FreeForm::Edge> edges;
  std::vector<std::uint8_t> is_of_plane;  ///< per face: whether the face is not free; those that stay count as well
  std::vector<std::uint8_t> is_held;      ///< per vertex
  std::vector<Triangle> kept;             ///< the triangles of all other faces, with the surface's vertices
  std::size_t free_faces = 0;
};

/// Returns the number of plane patches of free faces that have a corner below this angle, in degrees. A corner is the
/// sum of the angles of the patch's triangles there. Refinement cannot do anything about such corners.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
std::size_t sharp_patches(const FreeContext& context, const FreePart& part, double min_angle_deg, RunControl& control);

}  // namespace remesh
