// Tests what a run says of faces that met: by figures of the table of solids that do not depend on diagonals.

#include <gtest/gtest.h>

#include <optional>

#include "tests/solids/solid_rows.h"
#include "tests/support/remeshed.h"

namespace remesh {
namespace {

Options repairing(bool is_union) {
  Options options = unrefined();
  options.repair.self_intersections = true;
  options.repair.make_union = is_union;
  return options;
}

std::optional<SolidCounts> counts_of(int number, bool is_union) {
  for (const SolidRow& row : solid_rows())
    if (row.number == number) return remeshed(as_one(row.parts), repairing(is_union)).report.solids;
  return {};
}

TEST(solid_stage, the_report_counts_what_met_and_what_became_of_it) {
  // By row: patches that are cut, groups of coplanar patches, cells, and triangles that a union drops.
  struct Known {
    int row;
    std::size_t cut_patches, coplanar_classes, cells, dropped;
  };
  // Row 1: the corners of both boxes inside each other, each of three squares of two triangles. Rows 3 and 4: a square
  // wall, whose sides have different diagonals, so that both are cut into four triangles.
  for (const Known& known : {Known{1, 6, 0, 3, 12}, Known{3, 2, 1, 2, 4}, Known{4, 2, 1, 2, 4}}) {
    SCOPED_TRACE(known.row);
    const std::optional<SolidCounts> whole = counts_of(known.row, false), united = counts_of(known.row, true);
    ASSERT_TRUE(whole && united);
    for (const SolidCounts& counts : {*whole, *united}) {
      EXPECT_EQ(counts.cut_patches, known.cut_patches);
      EXPECT_EQ(counts.coplanar_classes, known.coplanar_classes);
      EXPECT_EQ(counts.cells, known.cells);
      EXPECT_EQ(counts.rounds, 0u);
      EXPECT_EQ(counts.left, 0u);
      EXPECT_EQ(counts.moved, 0);
      EXPECT_EQ(counts.turned, 0u);
    }
    EXPECT_EQ(whole->dropped, 0u);
    EXPECT_EQ(united->dropped, known.dropped);
  }
  EXPECT_EQ(counts_of(13, false)->coplanar_classes, 6u);
  EXPECT_EQ(counts_of(13, false)->cells, 7u);
  // Nothing meets here but a common corner.
  EXPECT_FALSE(counts_of(8, false));
}

TEST(solid_stage, without_the_options_nothing_is_counted) {
  const SolidRow row = solid_rows().front();
  EXPECT_FALSE(remeshed(as_one(row.parts)).report.solids);
}

}  // namespace
}  // namespace remesh
