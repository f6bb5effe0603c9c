// Tests that gaps which are narrower than the details that are removed ask for no size, and wider ones still do.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "core/remesh.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

Options with_details_of(double defeature_size) {
  Options options;
  options.proximity = 1;
  options.min_angle_deg = 20;
  options.defeature_size = defeature_size;
  return options;
}

/// Two plates over each other.
PolygonMesh two_plates(double thick, double apart) {
  const PolygonMesh plate = shapes::box({1, 0.7, thick});
  return shapes::joined(plate, shapes::moved(plate, {0, 0, thick + apart}));
}

std::size_t faces_of(const PolygonMesh& mesh, const Options& options) {
  const Result result = refined(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true());
  return result.mesh.faces.size();
}

TEST(min_gap, narrow_gaps_between_plates_do_not_count) {
  // 10 is so far away that the plates do not see each other. Where they are near, walls see a triangle of the other
  // plate aslant at some corners, as they do if all gaps count.
  // If they did, there would be 3,000,000 faces.
  const std::size_t alone = faces_of(two_plates(0.1, 10), with_details_of(0.01));
  for (const double apart : {1e-3, 1e-5}) {
    const PolygonMesh mesh = two_plates(0.1, apart);
    const Result result = refined(mesh, with_details_of(0.01));
    EXPECT_TRUE(result.report.verified.all_true()) << apart;
    EXPECT_LT(static_cast<double>(result.mesh.faces.size()), 2 * static_cast<double>(alone)) << apart;
    EXPECT_GT(static_cast<double>(result.mesh.faces.size()), 0.9 * static_cast<double>(alone)) << apart;
    EXPECT_EQ(listed(result.report), 0u) << apart << ": " << listed_in_words(result.report);
    // The report tells of it all the same.
    ASSERT_TRUE(result.report.smallest_gap) << apart;
    EXPECT_NEAR(*result.report.smallest_gap, apart, 1e-9);
  }
}

TEST(min_gap, the_thickness_of_plates_counts_beside_a_narrow_gap) {
  const Options options = with_details_of(0.01);
  const Result result = refined(two_plates(0.1, 1e-3), options);
  // Each edge of the two large sides of a plate is about as long as the plate is thick, and longer at the rims.
  EXPECT_GT(result.mesh.faces.size(), 4 * static_cast<std::size_t>(0.7 / (0.1 * 0.1 * std::sqrt(3) / 4)));
}

TEST(min_gap, gaps_that_are_wide_enough_count_as_before) {
  for (const double apart : {0.02, 0.05}) {
    const PolygonMesh mesh = two_plates(0.1, apart);
    Options options = with_details_of(0.01), without = options;
    without.defeature_size = 0;
    const Result result = refined(mesh, options), before = refined(mesh, without);
    EXPECT_TRUE(result.report.verified.all_true()) << apart;
    EXPECT_NEAR(static_cast<double>(result.mesh.faces.size()) / static_cast<double>(before.mesh.faces.size()), 1, 0.05)
        << apart;
  }
}

TEST(min_gap, a_gap_that_closes_counts_where_it_is_wide) {
  // The upper plate is tilted, so that the gap grows from 0.001 to 0.07.
  const PolygonMesh plate = shapes::box({1, 0.7, 0.1});
  PolygonMesh tilted = shapes::moved(shapes::rotated(plate, {0, 1, 0}, -4), {0, 0, 0.101});
  const PolygonMesh mesh = shapes::joined(plate, tilted);
  Options options = with_details_of(0.02);
  const Result result = refined(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true());
  const std::size_t alone = faces_of(two_plates(0.1, 10), options);
  EXPECT_GT(result.mesh.faces.size(), alone);
  options.defeature_size = 0;
  EXPECT_LT(result.mesh.faces.size(), faces_of(mesh, options));
}

}  // namespace
}  // namespace remesh
