#include "core/io/format_spec.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/io/common/number_parsing.h"
#include "core/io/gltf/gltf.h"
#include "core/io/medit/medit.h"
#include "core/io/msh/msh.h"
#include "core/io/obj/obj.h"
#include "core/io/off/off.h"
#include "core/io/ply/ply.h"
#include "core/io/smesh/smesh.h"
#include "core/io/stl/stl.h"
#include "core/io/threemf/threemf.h"
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

/// glTF as JSON begins as JSON does, so it has the stronger mark.
Mark gltf_mark(const Sniffed& s) {
  const bool is_json = s.first_word.starts_with('{') && is_gltf_json(s.text);
  return s.content.starts_with("glTF") || is_json ? Mark::kCertain : Mark::kNone;
}

/// The names that are changed in formats whose names need not be quoted.
std::vector<RenamedLabel> renamed_in_text(const WriterInput& input, RunControl& control) {
  return Boundaries(input, control).renamed();
}

/// In the order of the enumeration Format.
const std::array<FormatSpec, kFormats.size()> kSpecs{{
    {.name = "obj",
     .ending = "obj",
     .media_type = "model/obj",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "objects, groups, materials",
     .programs = "Blender, FreeCAD, ParaView, OpenFOAM, CGAL, three.js",
     .next = "surfaceCheck part.obj",
     .read = read_obj,
     .write = [](const WriterInput& in, RunControl& control) { return write_obj(in.mesh, in.comments, control); }},
    {.name = "json",
     .ending = "json",
     .media_type = "application/json",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "with patches and report",
     .programs = "any program with a JSON parser",
     .next = "python3 -c 'import json; print(len(json.load(open(\"part.json\"))[\"mesh\"][\"faces\"]))'",
     .mark =
         [](const Sniffed& s) { return likely_if(s.first_word.starts_with('{') || s.first_word.starts_with('[')); }},
    {.name = "stl",
     .ending = "stl",
     .media_type = "model/stl",
     .storage = Storage::kFloat,
     .about = "binary, floats",
     .programs = "nearly all, but neither TetGen nor Netgen",
     .next = "admesh part.stl",
     .mark = stl_mark,
     .read = read_stl,
     .write = [](const WriterInput& in, RunControl& control) { return write_stl(in.mesh, in.comments, control); }},
    {.name = "stl_ascii",
     .ending = "stl",
     .media_type = "model/stl",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "text, a solid for each boundary",
     .programs = "OpenFOAM, Netgen, Gmsh, TetGen, ParaView, FreeCAD",
     .next = "surfaceCheck part.stl\nsnappyHexMesh",
     .write = write_stl_ascii,
     .renamed =
         [](const WriterInput& in, RunControl& control) {
           const auto boundaries = stl_boundaries(in, control);
           return boundaries ? boundaries->renamed() : std::vector<RenamedLabel>();
         }},
    // None of the media types that begin with application/x- is registered.
    {.name = "ply",
     .ending = "ply",
     .media_type = "application/x-ply",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "binary, doubles",
     .programs = "Blender, MeshLab, CGAL; meshio without labels",
     .next = "meshlab part.ply",
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "ply"); },
     .read = read_ply,
     .write = [](const WriterInput& in, RunControl& control) { return write_ply(in.mesh, in.comments, control); }},
    {.name = "off",
     .ending = "off",
     .media_type = "application/x-off",
     .storage = Storage::kDouble,
     .about = "text, no labels",
     .programs = "TetGen, CGAL, meshio, OpenSCAD, FreeCAD",
     .next = "tetgen -pq part.off",
     .mark = [](const Sniffed& s) { return likely_if(off_kind(s.first_word).has_value()); },
     .read = read_off,
     .write = [](const WriterInput& in, RunControl& control) { return write_off(in.mesh, in.comments, control); }},
    {.name = "vtu",
     .ending = "vtu",
     .media_type = "application/x-vtu",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "patch, surface, quality and labels as cell data",
     .programs = "ParaView, VTK, meshio, PyVista",
     .next = "paraview part.vtu",
     .mark =
         [](const Sniffed& s) {
           const bool is_xml = s.first_word.starts_with('<') && s.text.find("<VTKFile") != std::string_view::npos;
           return likely_if(is_xml || is_legacy_vtk(s.text));
         },
     .read = read_vtu,
     .write = write_vtu},
    {.name = "msh",
     .ending = "msh",
     .media_type = "application/x-gmsh",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "text, a physical group for each boundary",
     .programs = "Gmsh, meshio",
     .next = "(echo 'Merge \"part.msh\";'; grep ';$' part.msh) > part.geo\ngmsh -3 part.geo -o filled.msh",
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "$MeshFormat" || s.first_word == "$Comments"); },
     .read = read_msh,
     .write = write_msh,
     .renamed = [](const WriterInput& in, RunControl& control) { return msh_boundaries(in, control).renamed(); }},
    {.name = "mesh",
     .ending = "mesh",
     .media_type = "application/x-medit",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "Medit's text, a reference for each boundary",
     .programs = "TetGen, FreeFEM, Gmsh, meshio",
     .next = "tetgen -pq part.mesh",
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "MeshVersionFormatted"); },
     .read = read_medit,
     .write = write_medit,
     .renamed = renamed_in_text},
    {.name = "smesh",
     .ending = "smesh",
     .media_type = "application/x-tetgen",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "a marker for each boundary, a point in each hole and region",
     .programs = "TetGen",
     .next = "tetgen -pqA part.smesh",
     .write = write_smesh,
     .renamed = renamed_in_text},
    {.name = "ply_ascii",
     .ending = "ply",
     .media_type = "application/x-ply",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "text, doubles",
     .programs = "Gmsh, meshio with labels, Blender, MeshLab, CGAL",
     .next = "meshio info part.ply",
     .write = [](const WriterInput& in,
                 RunControl& control) { return write_ply_ascii(in.mesh, in.comments, control); }},
    {.name = "glb",
     .ending = "glb",
     .media_type = "model/gltf-binary",
     .storage = Storage::kFloat,
     .labels = LabelsHeld::kOne,
     .about = "glTF to look at: floats, a colour for each boundary",
     .programs = "three.js, Blender, browsers",
     .next = "npx gltf-validator part.glb",
     .mark = gltf_mark,
     .read = read_gltf,
     .write = write_glb},
    {.name = "3mf",
     .ending = "3mf",
     .media_type = "model/3mf",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "only read: components and transforms, base materials",
     .programs = "PrusaSlicer, OpenSCAD, FreeCAD",
     .mark = [](const Sniffed& s) { return s.content.starts_with("PK\x03\x04") ? Mark::kCertain : Mark::kNone; },
     .read = read_threemf},
}};

}  // namespace

Sniffed::Sniffed(std::string_view whole)
    : content(whole),
      text(whole.starts_with("\xef\xbb\xbf") ? whole.substr(3) : whole),
      first_word(remesh::first_word(text)) {}

const FormatSpec& format_spec(Format format) { return kSpecs[static_cast<std::size_t>(format)]; }

}  // namespace remesh
