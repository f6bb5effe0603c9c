#include "core/patches/planar/region_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// The planes of one surface whose faces are all on the first rung.
struct Subject {
  explicit Subject(const PolygonMesh& mesh, double plane_tolerance = 1e-4)
      : chain(mesh, plane_tolerance),
        rung(chain.surface.face_count(), 0),
        rule{chain.tolerance, 1e-6, &chain.surface.face_label, &rung},
        coplanarity(chain.surface, chain.adjacency, chain.geometry, rule, chain.control),
        planes(chain.surface, chain.geometry, coplanarity, chain.control),
        faces(chain.surface.face_count()) {
    std::iota(faces.begin(), faces.end(), 0u);
  }

  StageChain chain;
  IdVector<FaceId, std::uint8_t> rung;
  CoplanarityRule rule;
  Coplanarity coplanarity;
  RegionPlanes planes;
  std::vector<std::uint32_t> faces;  ///< all of them
};

TEST(region_planes, faces_of_one_plane_have_that_plane) {
  const Subject subject(shapes::rotated(shapes::sheet(2, 1, 6, 3), {1, 2, 3}, 40));
  const auto region = subject.planes.of_all(FaceId(0), subject.faces);
  ASSERT_TRUE(region);
  EXPECT_NEAR(dot(region->plane.normal, subject.chain.geometry[FaceId(0)].normal), 1, 1e-12);
  EXPECT_LE(region->extent.deviation, 1e-12);
  EXPECT_GT(region->extent.height, 0);
}

TEST(region_planes, the_faces_of_a_box_have_no_common_plane) {
  const Subject subject(shapes::box({1, 2, 3}, 2));
  EXPECT_FALSE(subject.planes.of_all(FaceId(0), subject.faces));
}

TEST(region_planes, the_extent_is_that_of_the_farthest_corner_and_of_the_highest_face) {
  const Subject subject(shapes::sheet(1, 1, 2, 2));
  double highest = 0;
  for (const FaceGeometry& g : subject.chain.geometry) highest = std::max(highest, g.height);
  const Plane above{{0, 0, 0.25}, {0, 0, 1}};
  const Extent extent = subject.planes.extent_of(subject.faces, above);
  EXPECT_EQ(extent.deviation, 0.25);
  EXPECT_EQ(extent.height, highest);
  EXPECT_FALSE(subject.planes.extent_if_all_fit(subject.faces, above, 0.2));
  ASSERT_TRUE(subject.planes.extent_if_all_fit(subject.faces, above, 0.3));
  EXPECT_EQ(subject.planes.extent_if_all_fit(subject.faces, above, 0.3)->deviation, 0.25);
}

TEST(region_planes, faces_on_the_last_rung_are_alone) {
  Subject subject(shapes::sheet(1, 1, 2, 2));
  subject.rung[FaceId(0)] = kSingleFace;
  EXPECT_FALSE(subject.planes.of_all(FaceId(0), subject.faces));
}

}  // namespace
}  // namespace remesh
