#include "core/verify/near_faces/compared_meshes.h"

#include <set>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mending/weld/weld.h"

namespace remesh::verification {
namespace {

/// The triangles of a mesh, and the face that each is of.
struct MeshTriangles {
  MeshTriangles(const PolygonMesh& mesh, RunControl& control) : mesh(mesh) {
    std::vector<Diagnostic> diagnostics;
    const Surface surface = weld(mesh, {}, diagnostics, control);
    const Triangulated split(surface, control);
    are_split = split.are_split();
    StopCheck check(control);
    triangles.reserve(split.size());
    if (are_split) face.reserve(split.size());
    for (std::size_t t = 0; t < split.size(); ++t) {
      check();
      Triangle& triangle = triangles.emplace_back(split.triangle(t));
      for (VertexId& v : triangle) v = surface.vertex_source[v];
      if (are_split) face.push_back(surface.face_source[split.face(t)]);
    }
  }

  TriangleSet set() const { return {mesh.positions.items(), triangles}; }
  FaceId face_of(FaceId triangle) const { return are_split && triangle.is_valid() ? face[triangle.value] : triangle; }

  const PolygonMesh& mesh;
  std::vector<Triangle> triangles;
  std::vector<FaceId> face;  ///< empty if all faces are triangles
  bool are_split = false;
};

/// Replaces the numbers of triangles by those of faces.
void name_faces(const MeshTriangles& from, const MeshTriangles& to, OneWayDistance& distance) {
  distance.face = from.face_of(distance.face);
  distance.other_face = to.face_of(distance.other_face);
  std::set<FaceId> listed;
  std::vector<FarFace> faces;
  for (const FarFace& far : distance.far_faces)
    if (listed.insert(from.face_of(far.face)).second) faces.push_back({from.face_of(far.face), far.bound});
  distance.far_faces = std::move(faces);
}

}  // namespace

TwoWayDistance distance_between_meshes(const PolygonMesh& a, const PolygonMesh& b, std::optional<double> tolerance,
                                       RunControl& control) {
  control.enter(Stage::kWeld);
  const MeshTriangles of_a(a, control), of_b(b, control);
  control.enter(Stage::kVerify);
  TwoWayDistance both = distance_between(of_a.set(), of_b.set(), tolerance, control);
  name_faces(of_a, of_b, both.a_to_b);
  name_faces(of_b, of_a, both.b_to_a);
  return both;
}

}  // namespace remesh::verification
