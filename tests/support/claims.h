/// The claims of recognition about a mesh, face by face, and an independent check that they fit.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/output/report/report.h"
#include "tests/support/plain_surfaces.h"

namespace remesh::test {

/// The claims about the faces of a mesh.
struct Claims {
  Report report;
  IdVector<FaceId, PatchId> face_patch;  ///< by face of the input; invalid if it was dropped

  const IdVector<SurfaceId, RecognisedSurface>& surfaces() const { return report.surfaces.surfaces; }
  /// Returns the surface to which a face of the input is said to belong. It is invalid if the face was dropped.
  SurfaceId surface_of(FaceId f) const;
  /// Returns the kind that is claimed for a face. It is kFree for a face that was dropped.
  SurfaceKind kind_of(FaceId f) const;
  /// True if the face belongs to a surface that is neither a plane nor free.
  bool is_curved(FaceId f) const;
};

/// Runs the pipeline without refinement, and takes what the result says of the input's faces.
Claims claims_of(const PolygonMesh& mesh, RunControl& control, int workers = 1, Options options = {});

/// How well a claimed surface fits the facets that it is claimed for.
struct ClaimFit {
  SurfaceId surface;
  std::size_t corners = 0;  ///< the corners of facets that were measured, each of them once
  double deviation = 0;     ///< the largest distance of such a corner from the surface, in model units
  Vec3 farthest;            ///< the corner at that distance
  double tilt_deg = 0;      ///< the largest angle between a facet and the surface at the facet's middle
};

/// Measures all claims but planes and free regions.
/// A vertex is measured if some claimed facet has a true corner there. A vertex in the middle of a facet's side, or
/// within a facet, may lie on a chord, so it says nothing about the surface. The corners are found from the angles of
/// the faces alone, without the core's essential vertices.
/// Input:  `rounding_step` - a vertex counts as a true corner if it is farther from the straight line than rounding by
///         this step explains.
std::vector<ClaimFit> fit_of_claims(const PolygonMesh& mesh, const Claims& claims, double rounding_step);

/// Returns the float step at the largest coordinate, which is the rounding step of a file that holds floats.
double float_step(const PolygonMesh& mesh);
/// Returns the step to which the numbers of a file were rounded when they were written: the last place of the largest
/// one, if all of them are decimals of few digits or all are floats. It is 0 if they are neither.
double written_step(const PolygonMesh& mesh);
/// Returns the corners of a face.
std::vector<Vec3> corners_of(const PolygonMesh& mesh, FaceId f);
/// Returns the area of a face with any number of corners.
double area_of(const PolygonMesh& mesh, FaceId f);

}  // namespace remesh::test
