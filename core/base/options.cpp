#include "core/base/options.h"

#include <cmath>
#include <string>

#include "core/base/error.h"

namespace remesh {
namespace {

[[noreturn]] void invalid(const char* option, const std::string& what) {
  throw Error(Code::kInvalidOption, Stage::kQueued, std::string("option ") + option + " " + what).for_option(option);
}

}  // namespace

void check_options(const Options& options) {
  const auto positive = [](const std::optional<double>& value, const char* option) {
    if (value && !(*value > 0 && std::isfinite(*value))) invalid(option, "must be a number above 0");
  };
  if (options.min_angle_deg && !(*options.min_angle_deg >= 0 && *options.min_angle_deg <= Options::kMaxMinAngleDeg))
    invalid("min_angle_deg", "must be from 0 to 33");
  if (options.min_angle_deg && options.max_radius_edge_ratio)
    invalid("max_radius_edge_ratio", "excludes min_angle_deg: give one of them");
  if (options.max_edge_length && options.max_edge_fraction)
    invalid("max_edge_fraction", "excludes max_edge_length: give one of them");
  if (options.max_radius_edge_ratio && !(*options.max_radius_edge_ratio >= Options::kMinRadiusEdgeRatio))
    invalid("max_radius_edge_ratio", "must be a number of at least 0.918 (33 degrees)");
  positive(options.max_edge_length, "max_edge_length");
  positive(options.max_edge_fraction, "max_edge_fraction");
  positive(options.max_area, "max_area");
  positive(options.min_edge_length, "min_edge_length");
  if (options.min_edge_length && options.max_edge_length && *options.min_edge_length > *options.max_edge_length)
    invalid("min_edge_length", "must not be above max_edge_length");
  positive(options.plane_tolerance, "plane_tolerance");
  if (!(options.proximity >= 0 && std::isfinite(options.proximity))) invalid("proximity", "must not be negative");
  if (options.gradation && !(*options.gradation > 1 && std::isfinite(*options.gradation)))
    invalid("gradation", "must be a number above 1");
  if (!(options.normal_tolerance >= 0 && options.normal_tolerance <= Options::kMaxNormalTolerance))
    invalid("normal_tolerance", "must be from 0 to 0.5");
  if (!(options.weld_tolerance >= 0 && std::isfinite(options.weld_tolerance)))
    invalid("weld_tolerance", "must not be negative");
  if (options.reference_axis == ReferenceAxis::kGiven &&
      (!is_finite(options.reference_direction) || options.reference_direction == Vec3{}))
    invalid("reference_axis", "must be a direction of finite numbers, not all 0");
}

void check_options(const Options& options, double diagonal) {
  if (options.min_edge_length && options.max_edge_fraction &&
      *options.min_edge_length > *options.max_edge_fraction * diagonal)
    invalid("min_edge_length", "must not be above max_edge_fraction of the diagonal");
}

}  // namespace remesh
