#include "core/base/options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/base/error.h"
#include "core/base/number_text.h"

namespace remesh {
namespace {

constexpr NumberRange kAboveZero{.minimum = 0, .above_minimum = true};
constexpr NumberRange kNotNegative{.minimum = 0};

constexpr std::array<NumberOption, 20> kNumberOptions{{
    {"min_angle_deg", &Options::min_angle_deg, {.minimum = 0, .maximum = Options::kMaxMinAngleDeg}},
    // The minimum is 1 / (2 sin 33 degrees), cut after three decimals.
    {"max_radius_edge_ratio", &Options::max_radius_edge_ratio, {.minimum = 0.918}},
    {"max_edge_length", &Options::max_edge_length, kAboveZero},
    {"max_edge_fraction", &Options::max_edge_fraction, kAboveZero},
    {"max_area", &Options::max_area, kAboveZero},
    {"target_faces", &Options::target_faces, {.minimum = 1}},
    {"target_edge_length", &Options::target_edge_length, kAboveZero},
    {"min_edge_length", &Options::min_edge_length, kNotNegative},
    {"defeature_size", &Options::defeature_size, kNotNegative},
    {"proximity", &Options::proximity, kNotNegative},
    {"gradation", &Options::gradation, {.minimum = 1, .above_minimum = true}},
    {"max_output_faces", &Options::max_output_faces, {.minimum = 1}},
    {"plane_tolerance", &Options::plane_tolerance, kAboveZero},
    {"feature_angle_deg", &Options::feature_angle_deg, {.minimum = 0, .maximum = 180}},
    {"surface_tolerance", &Options::surface_tolerance, kNotNegative},
    {"surface_tolerance_fraction", &Options::surface_tolerance_fraction, kNotNegative},
    // A polygon needs at least three edges to enclose an area.
    {"elements_per_circle", &Options::elements_per_circle, {.minimum = 3, .maximum = 1000}},
    {"normal_tolerance", &Options::normal_tolerance, {.minimum = 0, .maximum = 0.5}},
    {"weld_tolerance", &Options::weld_tolerance, kNotNegative},
    {"max_hole_edges", &Options::max_hole_edges, {.minimum = 3, .maximum = 1'000'000}},
}};

/// Returns the value of an option; nothing if it is not set.
std::optional<double> value_of(const NumberOption& option, const Options& options) {
  return std::visit(
      [&](auto member) -> std::optional<double> {
        if constexpr (std::is_same_v<decltype(member), double Options::*>)
          return options.*member;
        else
          return options.*member ? std::optional(static_cast<double>(*(options.*member))) : std::nullopt;
      },
      option.member);
}

[[noreturn]] void invalid(std::string_view option, const std::string& what) {
  const std::string name(option);
  throw Error(Code::kInvalidOption, Stage::kQueued, "option " + name + " " + what).for_option(name);
}

/// Errors: Code::kInvalidOption - there is a target and an option that a target chooses itself.
void check_target(const Options& options) {
  const std::string_view target = options.target_faces ? "target_faces" : "target_edge_length";
  if (options.target_faces && options.target_edge_length)
    invalid("target_edge_length", "and target_faces exclude each other: give only one of them");
  if (!options.refine) invalid(target, "needs refine=true: without refinement there is nothing to choose");
  for (const auto& [name, is_given] : {std::pair("max_edge_length", options.max_edge_length.has_value()),
                                       std::pair("max_edge_fraction", options.max_edge_fraction.has_value())})
    if (is_given) invalid(target, "chooses the largest edge, so it excludes " + std::string(name));
}

}  // namespace

bool NumberRange::contains(double value) const {
  const bool is_large_enough = above_minimum ? value > minimum : value >= minimum;
  return std::isfinite(value) && is_large_enough && !(maximum && value > *maximum);
}

std::string NumberRange::text() const {
  if (maximum && !above_minimum) return "from " + shortest_text(minimum) + " to " + shortest_text(*maximum);
  return (above_minimum ? "above " : "of at least ") + shortest_text(minimum) +
         (maximum ? " and at most " + shortest_text(*maximum) : "");
}

std::span<const NumberOption> number_options() { return kNumberOptions; }

const NumberRange* number_range(std::string_view name) {
  const auto* option =
      std::find_if(kNumberOptions.begin(), kNumberOptions.end(), [&](const NumberOption& o) { return o.name == name; });
  return option == kNumberOptions.end() ? nullptr : &option->range;
}

bool is_target_given(const Options& options) { return options.target_faces || options.target_edge_length; }

bool is_curved_resolution_given(const Options& options) {
  return options.elements_per_circle || options.surface_tolerance || options.surface_tolerance_fraction;
}

bool are_fine_facets_coarsened(const Options& options) {
  return options.coarsens_fine_facets && !is_curved_resolution_given(options) && options.refine &&
         options.split_boundaries && !options.keep_boundary_vertices;
}

void check_options(const Options& options) {
  for (const NumberOption& option : number_options()) {
    const std::optional<double> value = value_of(option, options);
    if (value && !option.range.contains(*value)) invalid(option.name, "must be a number " + option.range.text());
  }
  if (options.min_angle_deg && options.max_radius_edge_ratio)
    invalid("max_radius_edge_ratio", "and min_angle_deg exclude each other: give only one of them");
  if (options.max_edge_length && options.max_edge_fraction)
    invalid("max_edge_fraction", "and max_edge_length exclude each other: give only one of them");
  if (is_target_given(options)) check_target(options);
  if (options.surface_tolerance && options.surface_tolerance_fraction)
    invalid("surface_tolerance_fraction", "and surface_tolerance exclude each other: give only one of them");
  if (options.min_edge_length && options.max_edge_length && *options.min_edge_length > *options.max_edge_length)
    invalid("min_edge_length", "must not be larger than max_edge_length");
  if (options.max_hole_edges && !options.repair.holes)
    invalid("max_hole_edges", "has an effect only if repair contains the word holes, for example repair=+holes");
  if (options.reference_axis == ReferenceAxis::kGiven &&
      (!is_finite(options.reference_direction) || options.reference_direction == Vec3{}))
    invalid("reference_axis", "must be three finite numbers that are not all 0");
}

void check_options(const Options& options, double diagonal) {
  if (options.min_edge_length && options.max_edge_fraction &&
      *options.min_edge_length > *options.max_edge_fraction * diagonal)
    invalid("min_edge_length", "must not be larger than the edge length that max_edge_fraction gives");
}

}  // namespace remesh
