#include "core/base/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/errors.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using test::error_of;

struct BadOption {
  const char* name;
  Code code;
  std::function<void(Options&)> set;
};

TEST(check_options, each_option_at_fault_is_named) {
  const std::vector<BadOption> bad = {
      {"min_angle_deg", Code::kInvalidOption, [](Options& o) { o.min_angle_deg = 33.5; }},
      {"min_angle_deg", Code::kInvalidOption, [](Options& o) { o.min_angle_deg = NAN; }},
      {"max_radius_edge_ratio", Code::kInvalidOption,
       [](Options& o) { o.min_angle_deg = o.max_radius_edge_ratio = 1; }},
      {"max_edge_length", Code::kInvalidOption, [](Options& o) { o.max_edge_length = 0; }},
      {"max_edge_fraction", Code::kInvalidOption, [](Options& o) { o.max_edge_length = o.max_edge_fraction = 1; }},
      {"max_area", Code::kInvalidOption, [](Options& o) { o.max_area = -1; }},
      {"min_edge_length", Code::kInvalidOption, [](Options& o) { o.min_edge_length = HUGE_VAL; }},
      {"min_edge_length", Code::kInvalidOption,
       [](Options& o) {
         o.min_edge_length = 2;
         o.max_edge_length = 1;
       }},
      {"proximity", Code::kInvalidOption, [](Options& o) { o.proximity = -1; }},
      {"gradation", Code::kInvalidOption, [](Options& o) { o.gradation = 1; }},
      {"weld_tolerance", Code::kInvalidOption, [](Options& o) { o.weld_tolerance = -1; }},
      {"plane_tolerance", Code::kInvalidOption, [](Options& o) { o.plane_tolerance = 0; }},
      {"plane_tolerance", Code::kInvalidOption, [](Options& o) { o.plane_tolerance = NAN; }},
      {"normal_tolerance", Code::kInvalidOption, [](Options& o) { o.normal_tolerance = -1; }},
      {"normal_tolerance", Code::kInvalidOption, [](Options& o) { o.normal_tolerance = 0.51; }},
      {"reference_axis", Code::kInvalidOption, [](Options& o) { o.reference_axis = ReferenceAxis::kGiven; }},
  };
  for (const BadOption& b : bad) {
    Options options;
    b.set(options);
    const Error error = error_of([&] { check_options(options); });
    EXPECT_EQ(code_name(error.code), code_name(b.code)) << b.name;
    EXPECT_EQ(error.option, b.name);
    EXPECT_EQ(error_of([&] {
                RunControl control;
                remesh_surface(shapes::box({1, 1, 1}), options, RunSettings{}, control);
              }).option,
              b.name);
  }
  EXPECT_NO_THROW(check_options(Options{}));
}

TEST(check_options, a_shortest_edge_above_the_longest_is_refused_also_where_that_is_a_part_of_the_diagonal) {
  Options options;
  options.max_edge_fraction = 0.01;
  const double diagonal = std::sqrt(3), longest = 0.01 * diagonal;
  for (const bool refine : {true, false}) {
    options.refine = refine;
    options.min_edge_length = longest;
    EXPECT_NO_THROW(check_options(options, diagonal));
    options.min_edge_length = 10;
    EXPECT_NO_THROW(check_options(options)) << "there are inputs for which it is not above";
    const Error error = error_of([&] {
      RunControl control;
      remesh_surface(shapes::box({1, 1, 1}), options, RunSettings{}, control);
    });
    EXPECT_EQ(error.code, Code::kInvalidOption);
    EXPECT_EQ(error.option, "min_edge_length");
  }
}

}  // namespace
}  // namespace remesh
