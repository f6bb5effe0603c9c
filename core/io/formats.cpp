#include "core/io/formats.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "core/io/common/number_parsing.h"
#include "core/io/format_spec.h"

namespace remesh {

bool is_written(Format format) { return format == Format::kJson || format_spec(format).write != nullptr; }
std::string_view format_name(Format format) { return format_spec(format).name; }
std::string_view file_ending(Format format) { return format_spec(format).endings.front(); }
Storage storage_of(Format format) { return format_spec(format).storage; }
std::string_view media_type(Format format) { return format_spec(format).media_type; }

std::optional<Format> format_from_name(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](Format f) { return format_name(f) == name; });
  return found == kFormats.end() ? std::nullopt : std::optional(*found);
}

namespace {

/// The ending of a file's name in lower case, without the point and without `.gz` behind it; empty if there is none.
std::string ending_of(std::string_view file_name) {
  if (is_gzip_file_name(file_name)) file_name.remove_suffix(3);
  const std::size_t point = file_name.find_last_of("./\\");
  if (point == std::string_view::npos || file_name[point] != '.') return {};
  std::string ending(file_name.substr(point + 1));
  std::transform(ending.begin(), ending.end(), ending.begin(), to_lower);
  return ending;
}

template <class Predicate>
std::optional<Format> first_format(Predicate is_one) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), is_one);
  return found == kFormats.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

std::optional<Format> format_from_file_name(std::string_view file_name) {
  const std::string ending = ending_of(file_name);
  return first_format([&](Format format) {
    const auto& endings = format_spec(format).endings;
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
  });
}

std::optional<Format> written_format_from_file_name(std::string_view file_name) {
  const std::string ending = ending_of(file_name);
  return first_format([&](Format format) { return is_written(format) && file_ending(format) == ending; });
}

bool is_gzip_file_name(std::string_view file_name) {
  constexpr std::string_view kEnding = ".gz";
  return file_name.size() > kEnding.size() &&
         equals_ignoring_case(file_name.substr(file_name.size() - kEnding.size()), kEnding);
}

Format sniff_format(std::string_view content) {
  const Sniffed sniffed(content);
  // If the content looks equally like several formats, the one that comes first in kFormats is chosen.
  Format best = Format::kObj;
  Mark strongest = Mark::kNone;
  for (const Format format : kFormats) {
    const FormatSpec& spec = format_spec(format);
    const Mark mark = spec.mark == nullptr ? Mark::kNone : spec.mark(sniffed);
    if (mark <= strongest) continue;
    best = format;
    strongest = mark;
    if (mark == Mark::kCertain) break;
  }
  return best;
}

}  // namespace remesh
