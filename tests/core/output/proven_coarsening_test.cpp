#include "core/output/run/proven_coarsening.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/geometry/triangles/triangle_intersection.h"
#include "core/mesh/adjacency.h"
#include "tests/support/free_shapes.h"
#include "tests/support/hausdorff.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// A smooth surface without features.
class proven_coarsening : public testing::Test {
 protected:
  void use(const PolygonMesh& mesh) {
    const TriangleMesh triangles = shapes::as_triangles(mesh);
    positions_ = triangles.positions;
    faces_ = triangles.faces;
    const Adjacency adjacency(mesh.vertex_count(), mesh.face_begin, mesh.corners, control_);
    for (std::uint32_t h = 0; h < mesh.corners.size(); ++h) twins_.push_back(adjacency.twin(h));
    edges_.assign(mesh.corners.size(), FreeForm::Edge::kSmooth);
  }
  static CoarseningFaults no_faults(const Coarsened&) { return {}; }
  std::optional<ProvenCoarsening> run(double tolerance, const LastFaults& last_faults = no_faults) {
    std::vector<VertexId> itself;
    for (VertexId v(0); v.value < positions_.size(); ++v.value) itself.push_back(v);
    return coarsen_with_proof(
        {positions_, faces_, twins_, edges_}, {positions_.items(), around_, itself}, {tolerance, 25},
        [](const Coarsened&) { return true; }, last_faults, fault_, control_);
  }
  template <class Surface>
  static std::vector<Corners3> corners_of(const Surface& positions, const IdVector<FaceId, Triangle>& faces) {
    std::vector<Corners3> corners;
    for (const Triangle& t : faces) corners.push_back({positions[t[0]], positions[t[1]], positions[t[2]]});
    return corners;
  }

  static int crossing_pairs(const Coarsened& made) {
    int pairs = 0;
    for (FaceId f(0); f.value < made.faces.size(); ++f.value)
      for (FaceId g(f.value + 1); g.value < made.faces.size(); ++g.value)
        if (do_intersect(made.faces[f], made.faces[g], made.positions.items())) ++pairs;
    return pairs;
  }

  RunControl control_;
  IdVector<VertexId, Vec3> positions_;
  IdVector<FaceId, Triangle> faces_;
  std::vector<std::uint32_t> twins_;
  std::vector<FreeForm::Edge> edges_;
  std::vector<Triangle> around_;
  CoarseningFault fault_ = CoarseningFault::kNone;
};

TEST_F(proven_coarsening, the_distance_is_within_the_tolerance_and_not_below_that_of_the_oracle) {
  PolygonMesh ball = shapes::sphere(4);
  for (Vec3& p : ball.positions) p = (0.8 + 0.05 * std::sin(7 * p.x) * std::cos(6 * p.z)) * normalized(p);
  use(ball);
  const double tolerance = 0.01;
  const auto made = run(tolerance);
  ASSERT_TRUE(made);
  EXPECT_EQ(fault_, CoarseningFault::kNone);
  EXPECT_LT(made->surface.faces.size(), faces_.size() / 4);
  const auto before = corners_of(positions_, faces_), now = corners_of(made->surface.positions, made->surface.faces);
  EXPECT_LE(test::hausdorff(before, now, 0.01 * tolerance), tolerance);
}

/// Two sheets that are nearer to each other than the tolerance would be made to cross.
TEST_F(proven_coarsening, thin_skins_do_not_cross) {
  PolygonMesh upper = shapes::sheet(1, 1, 20, 20), lower = shapes::sheet(1, 1, 20, 20);
  const auto height = [](const Vec3& p) { return 0.05 * std::sin(6 * p.x) * std::sin(5 * p.y); };
  for (Vec3& p : upper.positions) p.z = height(p) + 0.002;
  for (Vec3& p : lower.positions) p.z = height(p);
  use(shapes::joined(upper, lower));
  const double tolerance = 0.01;
  const auto made = run(tolerance);
  ASSERT_TRUE(made);
  EXPECT_LT(made->surface.faces.size(), faces_.size());
  EXPECT_EQ(crossing_pairs(made->surface), 0);
  EXPECT_GT(crossing_pairs(CoarseSheet({positions_, faces_, twins_, edges_}, {tolerance, 25}, control_).result()), 0);
}

/// A surface that is proven may still have faults as it will be written. It is refined there, and not given up.
TEST_F(proven_coarsening, a_surface_with_faults_in_the_end_is_refined) {
  use(bumpy_ball(4));
  const auto plain = run(0.01);
  ASSERT_TRUE(plain);
  int calls = 0;
  const auto refined = run(0.01, [&](const Coarsened& made) {
    CoarseningFaults faults;
    if (++calls == 1)
      for (FaceId f(0); f.value < made.faces.size() / 200 + 1; ++f.value) faults.far_faces.push_back(f);
    return faults;
  });
  ASSERT_TRUE(refined);
  EXPECT_EQ(calls, 2);
  EXPECT_GT(refined->surface.faces.size(), plain->surface.faces.size());
}

}  // namespace
}  // namespace remesh
