#include "core/io/format_spec.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/io/common/number_parsing.h"
#include "core/io/medit/medit.h"
#include "core/io/msh/msh.h"
#include "core/io/obj/obj.h"
#include "core/io/off/off.h"
#include "core/io/ply/ply.h"
#include "core/io/smesh/smesh.h"
#include "core/io/stl/stl.h"
#include "core/io/vtu/vtu.h"

namespace remesh {
namespace {

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

bool has_stl_keyword(std::string_view text) {
  for (const std::string_view keyword : {"facet", "endsolid"}) {
    const auto found = std::search(text.begin(), text.end(), keyword.begin(), keyword.end(),
                                   [](char c, char lower) { return to_lower(c) == lower; });
    if (found != text.end()) return true;
  }
  return false;
}

/// True if text is STL: one of its first lines begins with "solid", and after it there is a keyword of STL, since the
/// record of another format could be named "solid", too. Before it there may be lines of any kind.
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

Mark likely_if(bool is) { return is ? Mark::kLikely : Mark::kNone; }

/// The header of a binary STL may contain any text, even "solid", so its length is tested before all words.
Mark stl_mark(const Sniffed& s) {
  if (has_length_of_binary_stl(s.content)) return Mark::kCertain;
  return is_binary_stl(s.content) || is_text_stl(s.text) ? Mark::kPossible : Mark::kNone;
}

/// The names that are changed in formats whose names need not be quoted.
std::vector<RenamedLabel> renamed_in_text(const WriterInput& input, RunControl& control) {
  return Boundaries(input, control).renamed();
}

/// In the order of the enumeration Format.
const std::array<FormatSpec, kFormats.size()> kSpecs{{
    {"obj", "obj", "model/obj", Storage::kDouble, nullptr, read_obj,
     [](const WriterInput& in, RunControl& control) { return write_obj(in.mesh, in.comments, control); }},
    {"json", "json", "application/json", Storage::kDouble,
     [](const Sniffed& s) { return likely_if(s.first_word.starts_with('{') || s.first_word.starts_with('[')); }},
    {"stl", "stl", "model/stl", Storage::kFloat, stl_mark, read_stl,
     [](const WriterInput& in, RunControl& control) { return write_stl(in.mesh, in.comments, control); }},
    {"stl_ascii", "stl", "model/stl", Storage::kDouble, nullptr, nullptr, write_stl_ascii,
     [](const WriterInput& in, RunControl& control) {
       const auto boundaries = stl_boundaries(in, control);
       return boundaries ? boundaries->renamed() : std::vector<RenamedLabel>();
     }},
    // None of the media types that follow is registered.
    {"ply", "ply", "application/x-ply", Storage::kDouble,
     [](const Sniffed& s) { return likely_if(s.first_word == "ply"); }, read_ply,
     [](const WriterInput& in, RunControl& control) { return write_ply(in.mesh, in.comments, control); }},
    {"off", "off", "application/x-off", Storage::kDouble,
     [](const Sniffed& s) { return likely_if(off_kind(s.first_word).has_value()); }, read_off,
     [](const WriterInput& in, RunControl& control) { return write_off(in.mesh, in.comments, control); }},
    {"vtu", "vtu", "application/x-vtu", Storage::kDouble,
     [](const Sniffed& s) {
       return likely_if(s.first_word.starts_with('<') && s.text.find("<VTKFile") != std::string_view::npos);
     },
     nullptr, write_vtu},
    {"msh", "msh", "application/x-gmsh", Storage::kDouble,
     [](const Sniffed& s) { return likely_if(s.first_word == "$MeshFormat" || s.first_word == "$Comments"); }, read_msh,
     write_msh, [](const WriterInput& in, RunControl& control) { return msh_boundaries(in, control).renamed(); }},
    {"mesh", "mesh", "application/x-medit", Storage::kDouble,
     [](const Sniffed& s) { return likely_if(s.first_word == "MeshVersionFormatted"); }, read_medit, write_medit,
     renamed_in_text},
    {"smesh", "smesh", "application/x-tetgen", Storage::kDouble, nullptr, nullptr, write_smesh, renamed_in_text},
    {"ply_ascii", "ply", "application/x-ply", Storage::kDouble, nullptr, nullptr,
     [](const WriterInput& in, RunControl& control) { return write_ply_ascii(in.mesh, in.comments, control); }},
}};

}  // namespace

Sniffed::Sniffed(std::string_view whole)
    : content(whole),
      text(whole.starts_with("\xef\xbb\xbf") ? whole.substr(3) : whole),
      first_word(remesh::first_word(text)) {}

const FormatSpec& format_spec(Format format) { return kSpecs[static_cast<std::size_t>(format)]; }

}  // namespace remesh
