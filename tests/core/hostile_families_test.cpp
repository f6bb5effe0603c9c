/// Tests that the families of hostile surfaces are remeshed, verified, and told of, with the same bytes for any number
/// of workers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/remesh.h"
#include "tests/support/hostile_families.h"
#include "tests/support/invariance.h"
#include "tests/support/remeshed.h"
#include "tests/support/sanitizer.h"

namespace remesh {
namespace {

const Diagnostic* told(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.diagnostics.begin(), report.diagnostics.end(),
                                  [&](const Diagnostic& d) { return d.code == code; });
  return found == report.diagnostics.end() ? nullptr : &*found;
}

STAGE(hostile_families, test::kWorkers) {
  for (const hostile::Family& family : hostile::families()) {
    const Result result = remeshed(family.make(unless_sanitized(500, 100)), Options{}, {trial.workers});
    EXPECT_TRUE(result.report.verified.all_true()) << family.name;
    trial.mesh(result.mesh);
    for (const Diagnostic& d : result.report.diagnostics) trial.in_order(d.message, d.elements);
  }
}

TEST(hostile_families, what_was_not_looked_at_is_told) {
  // More than 16 pairs for each of these triangles, and 2^14 more, intersect.
  const Report many = remeshed(hostile::family("soup_in_a_cube").make(3000), Options{}, {1}).report;
  const Diagnostic* const cut = told(many, DiagnosticCode::kIncompleteCheck);
  ASSERT_NE(cut, nullptr);
  EXPECT_GT(cut->count, 0u);
  EXPECT_LE(cut->count, 3000u);
  for (const char* text : {"% of the faces were held against all others", "pairs intersect in all",
                           "intersections that the input does not have"})
    EXPECT_NE(cut->message.find(text), std::string::npos) << cut->message;
  const Diagnostic* const crossing = told(many, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(crossing, nullptr);
  EXPECT_EQ(crossing->count, 16u * 3000 + 16'384);
  EXPECT_EQ(crossing->elements.size(), Diagnostic::kMaxElements);
  const auto& obstacles = many.volume_obstacles;
  EXPECT_TRUE(std::any_of(obstacles.begin(), obstacles.end(),
                          [](const VolumeObstacle& o) { return o.code == DiagnosticCode::kIncompleteCheck; }));

  const Report few = remeshed(hostile::family("parallel_needles").make(3000), Options{}, {1}).report;
  EXPECT_EQ(told(few, DiagnosticCode::kIncompleteCheck), nullptr);
  EXPECT_EQ(told(few, DiagnosticCode::kSelfIntersection), nullptr);
}

}  // namespace
}  // namespace remesh
