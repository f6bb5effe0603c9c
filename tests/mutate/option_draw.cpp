#include "tests/mutate/option_draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "api/quoting.h"
#include "core/base/number_text.h"

namespace remesh::mutate {
namespace {

using api::OptionSpec;
using api::OptionType;

/// Draws a number: an end of the option's range, a value within it, one in proportion to the mesh, or an absurd one.
double draw_number(const OptionSpec& spec, Random& random, double diagonal) {
  const NumberRange& range = *number_range(spec.name);
  const double low = range.minimum;
  if (!range.above_minimum && random.chance(0.1)) return low;
  if (range.maximum) {
    if (random.chance(0.1)) return *range.maximum;
    if (random.chance(0.3)) return low + (*range.maximum - low) * std::pow(10.0, random.uniform(-8, 0));
    return random.uniform(low, *range.maximum);
  }
  if (random.chance(0.02)) return low + std::pow(10.0, random.uniform(-300, 300));
  const bool is_length = spec.name.find("length") != std::string_view::npos ||
                         spec.name.find("tolerance") != std::string_view::npos ||
                         spec.name.find("size") != std::string_view::npos;
  const bool is_tolerance = spec.name.find("tolerance") != std::string_view::npos;
  const bool is_fraction = spec.name.find("fraction") != std::string_view::npos;
  if (is_length) {
    const double unit = is_fraction ? 1 : diagonal;
    return low + unit * std::pow(10.0, is_tolerance ? random.uniform(-12, -1) : random.uniform(-3, 0.5));
  }
  if (spec.name.find("area") != std::string_view::npos)
    return low + diagonal * diagonal * std::pow(10.0, random.uniform(-5, 0));
  if (is_fraction) return low + std::pow(10.0, random.uniform(-2.5, 0.3));
  return low + (random.chance(0.5) ? random.uniform(0, 2) : std::pow(10.0, random.uniform(-3, 2)));
}

std::string draw_words(const OptionSpec& spec, Random& random) {
  const std::vector<std::string_view> words = api::option_words(spec);
  const bool is_change = random.chance(0.2);  // a change of the default
  const double part = random.unit();
  std::string text;
  for (const std::string_view word : words) {
    if (!random.chance(part)) continue;
    if (!text.empty()) text += ',';
    if (is_change) text += random.chance(0.7) ? '+' : '-';
    text += word;
  }
  return text.empty() ? "none" : text;
}

std::string draw_axis(Random& random) {
  switch (random.below(3)) {
    case 0: return "x";
    case 1: return "dominant_edge";
    default: break;
  }
  const auto number = [&] { return shortest_text(random.chance(0.3) ? 0.0 : random.uniform(-1, 1)); };
  return number() + "," + number() + "," + shortest_text(random.uniform(0.1, 1));
}

std::string draw_value(const OptionSpec& spec, Random& random, double diagonal) {
  if (!spec.unset.empty() && random.chance(0.05)) return std::string(spec.unset);
  if (!spec.example.empty() && random.chance(0.1)) return std::string(spec.example);
  switch (spec.type) {
    case OptionType::kBoolean: return random.chance(0.5) ? "true" : "false";
    case OptionType::kNumber:
      if (const auto words = api::option_words(spec); !words.empty() && random.chance(0.1))
        return std::string(words.front());
      return shortest_text(draw_number(spec, random, diagonal));
    case OptionType::kInteger:
      return std::to_string(
          static_cast<std::uint64_t>(number_range(spec.name)->minimum + std::pow(10.0, random.uniform(0, 5))));
    case OptionType::kWords: return draw_words(spec, random);
    case OptionType::kAxis: return draw_axis(random);
    case OptionType::kNames: return random.chance(0.5) ? "none" : "group,a,b";
    case OptionType::kChoice: {
      const std::vector<std::string_view> words = api::option_words(spec);
      return std::string(words[static_cast<std::size_t>(random.below(static_cast<int>(words.size())))]);
    }
  }
  return std::string(spec.example);
}

/// Returns whether holes are to be closed, without which their sizes are refused.
bool asks_for_holes(const OptionTexts& options) {
  return std::any_of(options.begin(), options.end(), [](const auto& given) {
    return given.first == "repair" && given.second.find("holes") != std::string::npos;
  });
}

}  // namespace

OptionTexts draw_options(Random& random, double diagonal) {
  constexpr std::array<double, 4> kParts{0, 0.08, 0.2, 0.5};
  const double part = kParts[static_cast<std::size_t>(random.below(static_cast<int>(kParts.size())))];
  OptionTexts options;
  for (const OptionSpec& spec : api::option_table()) {
    // The format is drawn nearly always, so that all formats are written.
    const double probability = spec.name == "format" ? 0.8 : part;
    const std::string value = draw_value(spec, random, diagonal);
    const bool is_excluded = std::any_of(options.begin(), options.end(), [&](const auto& given) {
      const OptionSpec* other = api::find_option(given.first);
      return given.first == spec.excludes || (other != nullptr && other->excludes == spec.name);
    });
    if (spec.name == "max_hole_edges" && !asks_for_holes(options) && random.chance(0.95)) continue;
    if (random.chance(probability) && !(is_excluded && random.chance(0.95))) options.emplace_back(spec.name, value);
  }
  return options;
}

std::string as_flags(const OptionTexts& options) {
  std::string text;
  for (const auto& [name, value] : options) {
    std::string flag = name;
    std::replace(flag.begin(), flag.end(), '_', '-');
    text += " --" + flag + "=" + value;
  }
  return text.empty() ? text : text.substr(1);
}

}  // namespace remesh::mutate
