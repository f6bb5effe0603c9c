#include "core/io/formats.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/options.h"
#include "core/io/off.h"
#include "core/io/stl.h"
#include "core/io/text.h"

namespace remesh {
namespace {

// A locale must not change the meaning of a file ending.
char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_space(char c) { return is_blank(c) || c == '\n' || c == '\r'; }

/// Returns the first token that is neither blank nor in a comment line.
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

bool equals_ignoring_case(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](char c, char lower) { return to_lower(c) == lower; });
}

/// The beginning, in lower case, of files that are often mistaken for meshes in our formats.
struct Mark {
  std::string_view begin;
  std::string_view name;
};
constexpr std::array<Mark, 13> kForeignMarks{{
    {"pk\x03\x04", "a ZIP archive, as 3MF is"},
    {"gltf", "binary glTF"},
    {"iso-10303-21", "STEP"},
    {"# vtk datafile", "legacy VTK"},
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
    {"<?xml", "XML that is not VTU"},
}};

bool has_stl_keyword(std::string_view text) {
  for (const std::string_view keyword : {"facet", "endsolid"}) {
    const auto found = std::search(text.begin(), text.end(), keyword.begin(), keyword.end(),
                                   [](char c, char lower) { return to_lower(c) == lower; });
    if (found != text.end()) return true;
  }
  return false;
}

/// True if text is STL: one of its first lines begins with "solid", and a keyword of STL follows later, because a
/// record of another format could be named "solid" too. Any lines may come before it.
bool is_text_stl(std::string_view text) {
  constexpr std::size_t kHead = 4096;
  for (std::size_t begin = 0; begin < std::min(text.size(), kHead);) {
    std::string_view line = text.substr(begin);
    line = line.substr(0, line.find_first_of("\r\n"));
    begin += line.size() + 1;
    const auto word = std::find_if_not(line.begin(), line.end(), is_blank);
    line.remove_prefix(static_cast<std::size_t>(word - line.begin()));
    line = line.substr(0, static_cast<std::size_t>(std::find_if(line.begin(), line.end(), is_blank) - line.begin()));
    if (equals_ignoring_case(line, "solid")) return has_stl_keyword(text.substr(std::min(begin, text.size())));
  }
  return false;
}

}  // namespace

std::string_view format_name(Format format) {
  switch (format) {
    case Format::kObj: return "obj";
    case Format::kJson: return "json";
    case Format::kStl: return "stl";
    case Format::kStlAscii: return "stl_ascii";
    case Format::kPly: return "ply";
    case Format::kOff: return "off";
    case Format::kVtu: return "vtu";
    case Format::kMsh: return "msh";
  }
  return "";
}

std::string_view file_ending(Format format) { return format_name(format == Format::kStlAscii ? Format::kStl : format); }

Storage storage_of(Format format) { return format == Format::kStl ? Storage::kFloat : Storage::kDouble; }

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

std::string_view media_type(Format format) {
  switch (format) {
    case Format::kObj: return "model/obj";
    case Format::kJson: return "application/json";
    case Format::kStl:
    case Format::kStlAscii: return "model/stl";
    // None of these media types is registered.
    case Format::kPly: return "application/x-ply";
    case Format::kOff: return "application/x-off";
    case Format::kVtu: return "application/x-vtu";
    case Format::kMsh: return "application/x-gmsh";
  }
  return "application/octet-stream";
}

Format sniff_format(std::string_view content) {
  // The length is checked before all marks, because the header of a binary STL may contain anything, even "solid".
  if (has_length_of_binary_stl(content)) return Format::kStl;
  const std::string_view text = content.starts_with("\xef\xbb\xbf") ? content.substr(3) : content;
  const std::string_view word = first_word(text);
  if (word == "ply") return Format::kPly;
  if (off_kind(word)) return Format::kOff;
  if (word.starts_with('{') || word.starts_with('[')) return Format::kJson;
  if (word == "$MeshFormat") return Format::kMsh;
  if (word.starts_with('<') && text.find("<VTKFile") != std::string_view::npos) return Format::kVtu;
  if (is_binary_stl(content)) return Format::kStl;
  if (is_text_stl(text)) return Format::kStl;
  return Format::kObj;
}

std::optional<std::string_view> foreign_format(std::string_view content) {
  if (has_length_of_binary_stl(content)) return std::nullopt;
  const std::string_view text = content.starts_with("\xef\xbb\xbf") ? content.substr(3) : content;
  if (sniff_format(content) == Format::kVtu) return std::nullopt;
  const auto mark = std::find_if(kForeignMarks.begin(), kForeignMarks.end(), [&](const Mark& m) {
    return equals_ignoring_case(text.substr(0, m.begin.size()), m.begin);
  });
  return mark == kForeignMarks.end() ? std::nullopt : std::optional(mark->name);
}

}  // namespace remesh
