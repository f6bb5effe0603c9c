#include "core/verify/polygons/caps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/core/verify/example.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using FaceLists = std::vector<std::vector<std::uint32_t>>;

const std::vector<Vec3> kCorners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                 {0, 0, 4}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4}};
/// A box without its lid. The last face is a side.
const FaceLists kOpenBox{{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
const std::vector<std::uint32_t> kLid{4, 5, 6, 7};

/// A claim that the last face of a surface was made to close a hole of the others.
struct CapClaim {
  std::vector<Vec3> corners = kCorners;
  FaceLists others = kOpenBox;
  std::vector<std::uint32_t> lid = kLid;
  FaceId source{4};
  std::vector<FaceId> caps{};  ///< empty: the last face
  double corner_height = 4;    ///< of a corner of the lid in the surface

  std::string failures() const {
    const PolygonMesh input = shapes::from_lists(corners, others);
    FaceLists all = others;
    all.push_back(lid);
    const PolygonMesh closed = shapes::from_lists(corners, all);
    Example e = example(closed, shapes::fan_triangulated(closed));
    e.surface.face_source[FaceId(others.size())] = source;
    e.surface.caps = caps.empty() ? std::vector<FaceId>{FaceId(others.size())} : caps;
    e.surface.positions.change([&](std::vector<Vec3>& positions) { positions[6].z = corner_height; });
    e.allow_intersections();
    e.input = &input;
    return all_words(e.verify());
  }
};

const char* const kRefuted = "the face that closes a hole at input face";

TEST(check_caps, a_flat_face_in_its_rim_is_right) { EXPECT_EQ(CapClaim().failures(), ""); }

TEST(check_caps, a_source_that_does_not_stand_at_the_rim_is_found) {
  CapClaim claim;
  // The floor is the last one now.
  claim.others = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {3, 2, 1, 0}};
  EXPECT_THAT(claim.failures(), HasSubstr(kRefuted));
}

TEST(check_caps, a_lid_that_is_bent_is_found) {
  CapClaim claim;
  claim.corner_height = 3.9;
  EXPECT_THAT(claim.failures(), HasSubstr(kRefuted));
}

TEST(check_caps, a_lid_at_edges_of_other_lids_is_found) {
  CapClaim claim;
  claim.caps = {FaceId(4), FaceId(5)};
  EXPECT_THAT(claim.failures(), HasSubstr(kRefuted));
}

TEST(check_caps, a_lid_at_an_edge_with_more_faces_is_found) {
  CapClaim claim;
  claim.corners.push_back({2, 0, 6});
  claim.others.insert(claim.others.begin(), {4, 5, 8});
  claim.source = FaceId(5);
  EXPECT_THAT(claim.failures(), HasSubstr(kRefuted));
}

TEST(check_caps, a_lid_that_covers_only_a_part_of_the_hole_is_found) {
  CapClaim claim;
  claim.lid = {4, 5, 6};
  EXPECT_THAT(claim.failures(), HasSubstr(kRefuted));
}

TEST(check_caps, a_lid_that_meets_another_face_is_found) {
  for (const double top : {3.0, 4.0, 5.0}) {
    CapClaim claim;
    claim.corners.insert(claim.corners.end(), {{1, 1, 1}, {2, 1, 1}, {1, 1, top}});
    claim.others.insert(claim.others.begin(), {8, 9, 10});
    claim.source = FaceId(5);
    if (top < 4)
      EXPECT_THAT(claim.failures(), Not(HasSubstr(kRefuted)));
    else
      EXPECT_THAT(claim.failures(), HasSubstr(kRefuted)) << top;
  }
}

}  // namespace
}  // namespace remesh
