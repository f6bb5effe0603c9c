/// Judges what recognition claims of one mesh.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/recognition/step_truth.h"
#include "tests/support/claims.h"

namespace remesh::recognition {

/// Areas of the STEP faces of one kind, in squared model units. The right, wrong and unclaimed areas add up to
/// `judged`.
struct KindAreas {
  std::size_t faces = 0;  ///< STEP faces
  std::size_t judged_faces = 0;
  double all = 0;
  double judged = 0;  ///< the area of faces that recognition can be expected to find
  double right = 0;
  double wrong_kind = 0;     ///< claimed as another kind of curved surface
  double wrong_shape = 0;    ///< the kind is right, but the place or a radius is not
  double unclaimed = 0;      ///< claimed as planes, or free, or dropped
  double claimed = 0;        ///< of all faces, judged or not: claimed as any curved surface
  double fitting = 0;        ///< free-form: claimed, and the whole face does lie on the claimed surface
  double evident = 0;        ///< the area of faces with enough evidence, whatever their corners (see right_claim.h)
  double evident_right = 0;  ///< and of those what is claimed with the right kind and radii, by the record's deviation
  double too_far = 0;        ///< free-form: claimed by a surface that is farther from the face than the record tells

  /// Adds the areas of `other` as shares of `whole`.
  void add(const KindAreas& other, double whole);
};

/// One STEP face, and the surfaces that its triangles are claimed for.
struct FaceVerdict {
  const StepFace* face = nullptr;
  FaceShape shape;
  bool is_judged = false;
  double right = 0;  ///< area
  /// The area and the error by claimed surface. The surface is invalid for planes, free regions and dropped faces.
  struct Part {
    double area = 0;
    ClaimError error;
  };
  std::map<SurfaceId, Part> parts;
};

/// Returns the time of the stage that recognises surfaces, in milliseconds.
double surfaces_ms(const Report& report);

struct JudgedFile {
  double step = 0;             ///< the float step at the largest coordinate
  double micros_per_face = 0;  ///< the shortest time of the stage `surfaces`, with one thread
  test::Claims claims;
  std::vector<test::ClaimFit> fits;
  std::map<SurfaceKind, KindAreas> kinds;  ///< empty without truth
  std::vector<FaceVerdict> verdicts;       ///< one per STEP face
};

/// A tessellation of a STEP file with smaller steps than the judged one.
struct FinerTessellation {
  PolygonMesh mesh;
  std::vector<StepFace> faces;
};

/// Judges a mesh. `truth` may be null. The faces of `truth` must outlive the answer.
/// A STEP face is judged if its corners lie within 6 steps of its surface and if it has at least 4 facets.
/// `finer` is null, or another tessellation of the same file, whose corners tell more of free-form faces.
JudgedFile judge(const PolygonMesh& mesh, const std::vector<StepFace>* truth, int runs,
                 const FinerTessellation* finer = nullptr);

}  // namespace remesh::recognition
