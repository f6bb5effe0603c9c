/// The surfaces of a STEP file's faces, which a tessellation of that file was made from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/plain_surfaces.h"

namespace remesh::recognition {

/// One face of a STEP file and its triangles.
struct StepFace {
  int number = 0;           ///< in the STEP file, from 1
  std::uint32_t first = 0;  ///< the first of its triangles
  std::uint32_t count = 0;
  test::PlainSurface surface;  ///< of kind kFree if the face is free-form
  std::string detail;          ///< the kind of surface that a free-form face has in the file
};

/// Reads the table beside a tessellation: NAME.surfaces.tsv for NAME.stl.
/// Output: nothing if there is no such table.
/// Errors: std::runtime_error - the table cannot be understood.
std::optional<std::vector<StepFace>> truth_beside(const std::string& mesh_path);

/// Measures of the triangles of a STEP face against its surface.
struct FaceShape {
  double area = 0;
  double off = 0;          ///< the largest distance of a corner from the face's surface
  double turn_deg = 0;     ///< how much of a turn around the axis the face covers; for a sphere, its width in degrees
  double tube_deg = 0;     ///< torus: how much of a turn around the tube it covers
  double length = 0;       ///< cone: its extent along a ruling
  std::size_t facets = 0;  ///< the number of planar patches among its triangles
};
FaceShape shape_of(const PolygonMesh& mesh, const StepFace& face, const IdVector<FaceId, PatchId>& face_patch);

/// How far a claimed surface is from the true one over a STEP face.
struct ClaimError {
  bool is_kind_right = false;
  double distance = 0;      ///< the largest distance of points of the true surface from the claimed one
  double radius = 0;        ///< the largest error of a radius; for a cone, that of the half angle times its length
  double radius_bound = 0;  ///< the largest error that rounding explains
  bool is_right(double step) const;
};
/// Compares a claim with the truth.
/// The distance is taken at the face's corners, and at the middles of its triangles and their sides, all moved onto the
/// true surface. It may be 9 steps.
/// A radius may be wrong by three times the step, or by three times the distance by which the face's own corners are
/// off, if that is larger. An arc of less than 90 degrees shows its radius only by its height over the chord. If a
/// face turns by less, the bound grows as that height shrinks. A torus has two arcs; its larger radius depends on both.
ClaimError error_of(const PolygonMesh& mesh, const StepFace& face, const FaceShape& shape,
                    const test::PlainSurface& claim, double step);

}  // namespace remesh::recognition
