#include "core/io/formats.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/io/common/number_parsing.h"
#include "core/io/format_spec.h"
#include "core/io/stl/stl.h"

namespace remesh {
namespace {

/// The first bytes, in lower case, of files that users often take for meshes.
struct ForeignMark {
  std::string_view begin;
  std::string_view name;
};
constexpr std::array<ForeignMark, 10> kForeignMarks{{
    {"iso-10303-21", "STEP"},
    {"kaydara fbx binary", "FBX"},
    {"\xfd"
     "7zxz",
     "packed by xz"},
    {"\x28\xb5\x2f\xfd", "packed by zstd"},
    {"bzh", "packed by bzip2"},
    {"7z\xbc\xaf", "a 7z archive"},
    {"%pdf-", "PDF"},
    {"<!doctype html", "an HTML page"},
    {"<html", "an HTML page"},
    {"<?xml", "XML that is no VTK file"},
}};

}  // namespace

bool is_written(Format format) { return format == Format::kJson || format_spec(format).write != nullptr; }
std::string_view format_name(Format format) { return format_spec(format).name; }
std::string_view file_ending(Format format) { return format_spec(format).ending; }
Storage storage_of(Format format) { return format_spec(format).storage; }
std::string_view media_type(Format format) { return format_spec(format).media_type; }

std::optional<Format> format_from_name(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](Format f) { return format_name(f) == name; });
  return found == kFormats.end() ? std::nullopt : std::optional(*found);
}

std::optional<Format> format_from_file_name(std::string_view file_name) {
  if (is_gzip_file_name(file_name)) file_name.remove_suffix(3);
  const std::size_t point = file_name.find_last_of("./\\");
  if (point == std::string_view::npos || file_name[point] != '.') return std::nullopt;
  std::string ending(file_name.substr(point + 1));
  std::transform(ending.begin(), ending.end(), ending.begin(), to_lower);
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](Format f) { return file_ending(f) == ending; });
  return found == kFormats.end() ? std::nullopt : std::optional(*found);
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

std::optional<std::string_view> foreign_format(std::string_view content) {
  if (has_length_of_binary_stl(content)) return std::nullopt;
  const std::string_view text = content.starts_with("\xef\xbb\xbf") ? content.substr(3) : content;
  if (sniff_format(content) == Format::kVtu) return std::nullopt;
  const auto mark = std::find_if(kForeignMarks.begin(), kForeignMarks.end(), [&](const ForeignMark& m) {
    return equals_ignoring_case(text.substr(0, m.begin.size()), m.begin);
  });
  return mark == kForeignMarks.end() ? std::nullopt : std::optional(mark->name);
}

}  // namespace remesh
