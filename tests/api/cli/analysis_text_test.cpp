#include "api/cli/analysis_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace remesh::cli {
namespace {

using testing::EndsWith;

TEST(analysis_text, faces_are_predicted_by_elements_per_circle_where_something_is_curved) {
  Report report;
  report.predicted_faces = 1234;
  EXPECT_THAT(analysis_text(report, "a.stl"), EndsWith("\na remeshing with these options makes about 1,234 faces\n"));
  report.predicted_faces_by_elements_per_circle = {{36, 4000}, {8, 120}, {16, 999}};
  EXPECT_THAT(analysis_text(report, "a.stl"),
              EndsWith("\na remeshing with these options makes about 1,234 faces\n"
                       "with --elements-per-circle 8 / 16 / 36: about 120 / 999 / 4,000 faces\n"));
}

}  // namespace
}  // namespace remesh::cli
