#include "core/base/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
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
      {"surface_tolerance_fraction", Code::kInvalidOption,
       [](Options& o) { o.surface_tolerance = o.surface_tolerance_fraction = 0.01; }},
      {"surface_tolerance_fraction", Code::kInvalidOption,
       [](Options& o) { o.surface_tolerance = o.surface_tolerance_fraction = 0; }},
      {"surface_tolerance", Code::kInvalidOption, [](Options& o) { o.surface_tolerance = -1; }},
      {"elements_per_circle", Code::kInvalidOption, [](Options& o) { o.elements_per_circle = 2.9; }},
      {"elements_per_circle", Code::kInvalidOption, [](Options& o) { o.elements_per_circle = 1001; }},
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
      {"max_hole_edges", Code::kInvalidOption, [](Options& o) { o.max_hole_edges = 10; }},
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

void set(Options& options, const NumberOption& option, double value) {
  std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), std::optional<std::uint64_t> Options::*>) {
          options.*member = static_cast<std::uint64_t>(value);
        } else {
          options.*member = value;
        }
      },
      option.member);
}

TEST(check_options, each_number_is_taken_at_the_ends_of_its_range_and_refused_beyond_them) {
  for (const NumberOption& option : number_options()) {
    SCOPED_TRACE(option.name);
    const NumberRange& range = option.range;
    const auto check = [&](double value) {
      Options options;
      options.repair.holes = true;  // max_hole_edges needs this
      set(options, option, value);
      check_options(options);
    };
    const auto expect_refused = [&](double value) {
      const Error error = error_of([&] { check(value); });
      EXPECT_EQ(error.code, Code::kInvalidOption);
      EXPECT_EQ(error.option, option.name);
      EXPECT_NE(std::string_view(error.what()).find(range.text()), std::string_view::npos) << error.what();
    };
    if (range.above_minimum) {
      EXPECT_NO_THROW(check(std::nextafter(range.minimum, HUGE_VAL)));
      expect_refused(range.minimum);
    } else {
      EXPECT_NO_THROW(check(range.minimum));
    }
    const bool is_whole = std::holds_alternative<std::optional<std::uint64_t> Options::*>(option.member);
    if (range.maximum) {
      EXPECT_NO_THROW(check(*range.maximum));
      expect_refused(is_whole ? *range.maximum + 1 : std::nextafter(*range.maximum, HUGE_VAL));
    }
    if (is_whole) {
      expect_refused(0);
      continue;
    }
    for (const double value : {std::nextafter(range.minimum, -HUGE_VAL), -1.0, HUGE_VAL, -HUGE_VAL, double(NAN)})
      expect_refused(value);
  }
}

TEST(number_range, its_text_follows_the_words_a_number) {
  EXPECT_EQ((NumberRange{.minimum = 0, .maximum = 33}).text(), "from 0 to 33");
  EXPECT_EQ((NumberRange{.minimum = 0.918}).text(), "of at least 0.918");
  EXPECT_EQ((NumberRange{.minimum = 1, .above_minimum = true}).text(), "above 1");
  EXPECT_EQ((NumberRange{.minimum = 0, .above_minimum = true, .maximum = 0.5}).text(), "above 0 and at most 0.5");
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
