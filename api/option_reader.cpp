#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "api/option_values.h"
#include "api/options.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/refinement/goals/goals.h"
#include "core/remesh.h"

namespace remesh::api {
namespace {

/// The value that a preset has for an option, as text.
struct PresetValue {
  Preset preset;
  std::string_view option;
  std::string_view text;
};
// See core/experiments.md, Preset for volume meshing. The bound on angles is the default, 25 degrees.
constexpr std::array<PresetValue, 5> kPresetValues{{
    {Preset::kVolume, "proximity", "0.25"},
    {Preset::kVolume, "elements_per_circle", "16"},
    {Preset::kExact, "feature_angle_deg", "0"},
    {Preset::kExact, "split_boundaries", "false"},
    {Preset::kExact, "defeature_size", "0"},
}};

bool is_set(const OptionSpec& spec, const RequestOptions& options) {
  return !std::holds_alternative<std::monostate>(option_value(spec, options));
}

/// Names that other programs have for options of ours.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kOtherNames{{{"hmax", "max_edge_length"},
                                                                                     {"hsiz", "max_edge_length"},
                                                                                     {"clmax", "max_edge_length"},
                                                                                     {"lcmax", "max_edge_length"},
                                                                                     {"size", "max_edge_length"},
                                                                                     {"hmin", "min_edge_length"},
                                                                                     {"clmin", "min_edge_length"},
                                                                                     {"hgrad", "gradation"},
                                                                                     {"hausd", "surface_tolerance"},
                                                                                     {"clcurv", "elements_per_circle"},
                                                                                     {"output", "format"},
                                                                                     {"type", "format"}}};

/// Writes a name in lower case and without separators, so that maxEdgeLength is max_edge_length.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : ascii_lower(name))
    if (c != '_' && c != '-' && c != ' ' && c != '.') plain += c;
  return plain;
}

// Computes the Levenshtein distance row by row.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({replaced, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row.back();
}

}  // namespace

const OptionSpec& nearest_option(std::string_view name) {
  constexpr std::size_t kLongestCompared = 64;  // the caller chooses the length of the name
  const std::string_view start = name.substr(0, kLongestCompared);
  const std::string plain = plain_name(start);
  const auto* other =
      std::find_if(kOtherNames.begin(), kOtherNames.end(), [&](const auto& n) { return n.first == plain; });
  if (other != kOtherNames.end()) return *find_option(other->second);
  // A part of a name is nearer to it than another name of the same length: max_edge stands for max_edge_length.
  constexpr std::size_t kShortestPart = 4, kPerEdit = 4;
  const auto distance = [&](const OptionSpec& spec) {
    const std::string full = plain_name(spec.name);
    const auto& [part, whole] =
        std::minmax(plain, full, [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (part.size() >= kShortestPart && whole.find(part) != std::string::npos) return whole.size() - part.size();
    return kPerEdit * edit_distance(plain, full);
  };
  return *std::min_element(option_table().begin(), option_table().end(),
                           [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
}

RequestOptions with_defaults(RequestOptions options) {
  Options& core = options.core;
  core.coarsens_fine_facets = are_fine_facets_coarsened(core);
  if (!core.refine) return options;
  const Goals goals = goals_of(core, /*diagonal=*/1);
  if (!core.max_radius_edge_ratio) core.min_angle_deg = goals.min_angle_deg;
  if (goals.gradation > 0) core.gradation = goals.gradation;
  return options;
}

void OptionReader::add(std::string_view name, std::string_view text, ValueKind kind) {
  const OptionSpec* spec = find_option(name);
  if (spec == nullptr) {
    const std::string_view nearest = nearest_option(name).name;
    throw Error(as_code(RequestCode::kUnknownOption), Stage::kRead,
                "there is no option " + in_quotes(name) + "; the nearest is \"" + std::string(nearest) + "\"")
        .for_option(shortened(name));
  }
  if (is_given(name)) throw invalid_option(*spec, "is given twice");
  if (kind == ValueKind::kUntyped && text.empty())
    throw invalid_option(*spec, "is empty: give it a value, or leave it out");
  set_option(*spec, text, kind, options_);
  given_.push_back(spec->name);
  if (std::holds_alternative<PresetField>(spec->field)) apply_preset();
  const OptionSpec* other = find_option(spec->excludes);
  if (other != nullptr && is_set(*spec, options_) && is_set(*other, options_)) {
    throw invalid_option(*spec, "and " + std::string(other->name) + " exclude each other");
  }
}

void OptionReader::apply_preset() {
  for (const PresetValue& value : kPresetValues) {
    if (value.preset == options_.preset && !is_given(value.option))
      set_option(*find_option(value.option), value.text, ValueKind::kUntyped, options_);
  }
}

void OptionReader::check() const { check_options(options_.core); }

bool OptionReader::is_given(std::string_view name) const {
  return std::find(given_.begin(), given_.end(), name) != given_.end();
}

}  // namespace remesh::api
