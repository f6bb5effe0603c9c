#include "core/mending/polygons/degenerate_faces.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/mending/weld/weld.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Loops = std::vector<std::vector<std::uint32_t>>;

/// A large triangle, and two small ones on the other side of its first edge. Between them are two degenerate triangles,
/// on whose line there are two more vertices.
const std::vector<Vec3> kPositions{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 0, 0}, {2, 0, 0}, {0, -3, 0}};
const Loops kFaces{{0, 1, 2}, {1, 0, 3}, {1, 3, 4}, {0, 5, 3}, {3, 5, 4}, {4, 5, 1}};
const std::vector<std::uint8_t> kIsDegenerate{0, 1, 1, 0, 0, 0};

Loops after_drop(const std::vector<std::uint8_t>& keep_verbatim) {
  const PolygonMesh mesh = shapes::from_lists(kPositions, kFaces);
  RunControl control;
  std::vector<Diagnostic> diagnostics;
  Surface surface = weld(mesh, {}, diagnostics, control);
  drop_degenerate_faces(surface, kIsDegenerate, keep_verbatim, control);
  Loops loops;
  for (FaceId f(0); f.value < surface.face_count(); ++f.value) {
    loops.emplace_back();
    for (const VertexId v : surface.face(f)) loops.back().push_back(v.value);
  }
  return loops;
}

TEST(drop_degenerate_faces, the_face_beyond_gets_the_vertices_in_its_own_direction) {
  EXPECT_EQ(after_drop({}), (Loops{{0, 3, 4, 1, 2}, {0, 5, 3}, {3, 5, 4}, {4, 5, 1}}));
}

TEST(drop_degenerate_faces, a_cluster_stays_as_a_whole_if_a_verbatim_face_would_get_its_vertices) {
  EXPECT_EQ(after_drop({1, 0, 0, 0, 0, 0}), kFaces);
}

}  // namespace
}  // namespace remesh
