#include "core/io/formats.h"

#include <algorithm>
#include <cstddef>

#include "core/io/text.h"

namespace remesh {
namespace {

// A locale must not change what a file ending means.
char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_space(char c) { return is_blank(c) || c == '\n' || c == '\r'; }

/// A header of 80 bytes, a count, 50 bytes a triangle. Text of the very length that four of its own bytes ask for does
/// not happen: they would count at least 150 million triangles.
bool is_binary_stl(std::string_view content) {
  constexpr std::size_t kHeader = 80;
  if (content.size() < kHeader + 4) return false;
  std::uint64_t count = 0;
  for (std::size_t i = 4; i-- > 0;) count = count << 8 | static_cast<unsigned char>(content[kHeader + i]);
  return content.size() == kHeader + 4 + 50 * count;
}

/// The first token that is neither blank nor in a comment line.
std::string_view first_word(std::string_view text) {
  for (;;) {
    const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
    text.remove_prefix(static_cast<std::size_t>(begin - text.begin()));
    if (!text.starts_with('#')) break;
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
  }
  const auto end = std::find_if(text.begin(), text.end(), is_space);
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

/// `OFF` with the prefixes that name what its vertices carry: texture coordinates, colours, normals, a fourth or
/// n-th coordinate.
bool is_off_mark(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"}) {
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  }
  return word == "OFF";
}

}  // namespace

std::string_view format_name(Format format) {
  switch (format) {
    case Format::kObj: return "obj";
    case Format::kJson: return "json";
    case Format::kStl: return "stl";
    case Format::kPly: return "ply";
    case Format::kOff: return "off";
    case Format::kVtu: return "vtu";
    case Format::kMsh: return "msh";
  }
  return "";
}

std::optional<Format> format_from_name(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](Format f) { return format_name(f) == name; });
  return found == kFormats.end() ? std::nullopt : std::optional(*found);
}

std::optional<Format> format_from_file_name(std::string_view file_name) {
  const std::size_t point = file_name.find_last_of("./\\");
  if (point == std::string_view::npos || file_name[point] != '.') return std::nullopt;
  std::string ending(file_name.substr(point + 1));
  std::transform(ending.begin(), ending.end(), ending.begin(), to_lower);
  return format_from_name(ending);
}

std::string_view media_type(Format format) {
  switch (format) {
    case Format::kObj: return "model/obj";
    case Format::kJson: return "application/json";
    case Format::kStl: return "model/stl";
    // None of these is registered.
    case Format::kPly: return "application/x-ply";
    case Format::kOff: return "application/x-off";
    case Format::kVtu: return "application/x-vtu";
    case Format::kMsh: return "application/x-gmsh";
  }
  return "application/octet-stream";
}

Format sniff_format(std::string_view content) {
  // Before all marks: a binary STL's header may say anything, "solid" too.
  if (is_binary_stl(content)) return Format::kStl;
  if (content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);
  const std::string_view word = first_word(content);
  if (word.starts_with('{') || word.starts_with('[')) return Format::kJson;
  if (word == "solid" && content.find("facet") != std::string_view::npos) return Format::kStl;
  if (word == "ply") return Format::kPly;
  if (is_off_mark(word)) return Format::kOff;
  return Format::kObj;
}

}  // namespace remesh
