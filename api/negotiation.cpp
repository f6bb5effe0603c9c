#include "api/negotiation.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "api/quoting.h"
#include "core/base/error.h"
#include "core/io/foreign_files.h"
#include "core/io/format_spec.h"

namespace remesh::api {
namespace {

struct MediaRange {
  std::string range;  ///< `model/obj`, `model/*`, `*/*`
  double weight = 1;  ///< the parameter q
};

/// Returns the parameter q, the weight of a format. A malformed q counts as 1, because the client still wants the
/// format.
double weight_of(std::string_view parameters) {
  while (!parameters.empty()) {
    const auto [parameter, rest] = cut(parameters, ';');
    const auto [name, value] = cut(parameter, '=');
    if (ascii_lower(trim(name)) == "q") {
      const Real weight = parse_real(trim(value));
      return weight.fault == RealFault::kNone ? std::clamp(weight.value, 0.0, 1.0) : 1;
    }
    parameters = rest;
  }
  return 1;
}

std::vector<MediaRange> parse_accept(std::string_view accept) {
  std::vector<MediaRange> ranges;
  while (!accept.empty()) {
    const auto [item, rest] = cut(accept, ',');
    const auto [range, parameters] = cut(item, ';');
    if (!trim(range).empty()) ranges.push_back({ascii_lower(trim(range)), weight_of(parameters)});
    accept = rest;
  }
  return ranges;
}

const MediaRange* find_range(const std::vector<MediaRange>& ranges, std::string_view name) {
  const auto range = std::find_if(ranges.begin(), ranges.end(), [&](const MediaRange& r) { return r.range == name; });
  return range == ranges.end() ? nullptr : &*range;
}

/// The weight that Accept gives to a format by its name or its type, without `*/*`.
/// Output: nothing if neither occurs.
std::optional<double> weight_for(const std::vector<MediaRange>& ranges, Format format) {
  const std::string_view type = media_type(format);
  const MediaRange* range = find_range(ranges, type);
  if (range == nullptr) range = find_range(ranges, std::string(cut(type, '/').first) + "/*");
  return range == nullptr ? std::nullopt : std::optional(range->weight);
}

/// Lists the names of the formats for which `is_one` is true.
template <class Predicate>
std::string names_of_formats(Predicate is_one) {
  std::string names;
  for (const Format format : kFormats) {
    if (is_one(format)) names.append(names.empty() ? "" : ", ").append(format_name(format));
  }
  return names;
}

}  // namespace

bool can_read(Format format) { return format == Format::kJson || format_spec(format).read != nullptr; }

std::string media_type_of(std::string_view content_type) { return ascii_lower(trim(cut(content_type, ';').first)); }

std::optional<Format> format_of_content_type(std::string_view content_type) {
  const std::string type = media_type_of(content_type);
  const auto* format = std::find_if(kFormats.begin(), kFormats.end(), [&](Format f) { return media_type(f) == type; });
  return format == kFormats.end() ? std::nullopt : std::optional(*format);
}

Format choose_input_format(std::optional<Format> named, std::string_view content) {
  if (const ForeignFile* foreign = named ? nullptr : foreign_file(content)) {
    throw Error(Code::kUnsupportedMediaType, Stage::kRead,
                "the content looks like " + std::string(foreign->name) + "; " + std::string(foreign->next) +
                    "; the formats that can be read are " + names_of_formats(can_read) + ", also compressed by gzip");
  }
  const Format format = named ? *named : sniff_format(content);
  if (can_read(format)) return format;
  throw Error(Code::kUnsupportedMediaType, Stage::kRead,
              "the format " + std::string(format_name(format)) + " can be written, but not read");
}

OutputFormat choose_output_format(std::optional<Format> option, std::string_view accept, Format input) {
  if (option) return {*option, true};
  const std::vector<MediaRange> ranges = parse_accept(accept);
  const MediaRange* anything = find_range(ranges, "*/*");
  const double weight_of_others = ranges.empty() ? 1 : anything == nullptr ? 0 : anything->weight;

  // Formats are ranked by weight. With equal weights, the input's format comes first, even if only "*/*" permits it and
  // another format is named: many clients name one format before "*/*" without a preference for it. Of the other
  // formats, a named one ranks before one that only "*/*" permits. A weight of 0 is never chosen.
  using Rank = std::tuple<double, bool, bool>;
  std::optional<Format> best;
  Rank best_rank{0, true, true};
  for (const Format format : kFormats) {
    if (!is_written(format)) continue;
    const std::optional<double> weight = weight_for(ranges, format);
    const Rank rank{weight.value_or(weight_of_others), format == input, weight.has_value()};
    if (rank <= best_rank) continue;
    best = format;
    best_rank = rank;
  }
  if (best) {
    const MediaRange* const named = find_range(ranges, media_type(*best));
    return {*best, named != nullptr && named->weight > weight_of_others};
  }
  throw Error(Code::kNotAcceptable, Stage::kRead,
              "none of the formats that Accept asks for (" + shortened(accept, 200) +
                  ") can be written; the formats that can be written are: " + names_of_formats(is_written));
}

OutputRounding rounding_for(const OutputFormat& wanted) {
  return wanted.is_by_name || text_form(wanted.format) == wanted.format ? OutputRounding::kRequired
                                                                        : OutputRounding::kIfHeld;
}

Format text_form(Format format) { return format == Format::kStl ? Format::kStlAscii : format; }

std::string content_type(Format format) {
  return std::string(media_type(format)) + (format == Format::kStlAscii ? "; charset=utf-8" : "");
}

}  // namespace remesh::api
