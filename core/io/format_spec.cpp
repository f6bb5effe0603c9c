#include "core/io/format_spec.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/io/common/number_parsing.h"
#include "core/io/fe/fe.h"
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
    // A line may be as long as the file.
    std::string_view line = text.substr(begin, kHead);
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

// The endings of the formats. The first one is that of a file that is written.
constexpr std::string_view kObjEndings[] = {"obj"}, kJsonEndings[] = {"json"}, kStlEndings[] = {"stl"},
                           kPlyEndings[] = {"ply"}, kOffEndings[] = {"off"}, kVtuEndings[] = {"vtu", "vtp", "vtk"},
                           kMshEndings[] = {"msh"}, kMeshEndings[] = {"mesh"}, kSmeshEndings[] = {"smesh"},
                           kGlbEndings[] = {"glb", "gltf"}, kThreemfEndings[] = {"3mf"}, kInpEndings[] = {"inp"},
                           kBdfEndings[] = {"bdf", "nas"};

// The programs that were seen to read what is written, and the lines with which they go on. Tests run those lines whose
// programs are installed.
constexpr ReadingProgram kObjPrograms[] = {
    {"OpenFOAM", "groups as patches, by the first words of their names", "surfaceCheck part.obj"},
    {"Blender", "objects, materials, and groups if asked",
     "blender --python-expr \"import bpy; bpy.ops.wm.obj_import(filepath='part.obj', import_vertex_groups=True)\""},
    {"FreeCAD", "groups of which the names are ASCII without blanks", "freecad part.obj"},
    {"meshio", "triangles", "python3 -c \"import meshio; print(meshio.read('part.obj'))\""},
    {"VTK", "triangles; groups as numbers",
     "python3 -c \"import vtk; r = vtk.vtkOBJReader(); r.SetFileName('part.obj'); r.Update(); print(r.GetOutput())\""},
    {"three.js", "groups, or else objects"}};
constexpr ReadingProgram kJsonPrograms[] = {
    {"Python", "all of it",
     "python3 -c \"import json; print(len(json.load(open('part.json'))['mesh']['faces']), 'triangles')\""}};
constexpr ReadingProgram kStlPrograms[] = {
    {"admesh", "triangles", "admesh part.stl"},
    {"Gmsh", "triangles, as one surface", "gmsh -save part.stl -o part.msh"},
    {"meshio", "triangles", "python3 -c \"import meshio; print(meshio.read('part.stl'))\""},
    {"OpenFOAM", "triangles, as one patch", "surfaceCheck part.stl"},
    {"PrusaSlicer", "triangles", "prusa-slicer --info part.stl"}};
constexpr ReadingProgram kStlAsciiPrograms[] = {
    {"OpenFOAM", "a patch for each boundary, by name; coordinates as floats", "surfaceCheck part.stl"},
    {"Gmsh", "a surface for each boundary", "gmsh -save part.stl -o part.msh"},
    {"TetGen", "triangles; all markers are 1", "tetgen -pq part.stl"},
    {"Netgen", "triangles of a closed surface", "netgen -geofile=part.stl -meshfile=part.vol -batchmode"},
    {"ParaView", "solids as numbers", "paraview part.stl"}};
constexpr ReadingProgram kPlyPrograms[] = {
    {"VTK", "triangles; coordinates as floats",
     "python3 -c \"import vtk; r = vtk.vtkPLYReader(); r.SetFileName('part.ply'); r.Update(); print(r.GetOutput())\""},
    {"Blender", "triangles", "blender --python-expr \"import bpy; bpy.ops.import_mesh.ply(filepath='part.ply')\""},
    {"MeshLab", "triangles", "meshlab part.ply"},
    {"CGAL", "triangles; doubles"}};
constexpr ReadingProgram kOffPrograms[] = {
    {"TetGen", "triangles; all markers are 1", "tetgen -pq part.off"},
    {"meshio", "triangles", "python3 -c \"import meshio; print(meshio.read('part.off'))\""},
    {"OpenSCAD", "a closed solid", "echo 'import(\"part.off\");' > part.scad\nopenscad part.scad -o part.3mf"},
    {"CGAL", "triangles; doubles"}};
constexpr ReadingProgram kVtuPrograms[] = {
    {"ParaView", "all cell data; names of the boundaries", "paraview part.vtu"},
    {"VTK", "all cell data; names of the boundaries",
     "python3 -c \"import vtk; r = vtk.vtkXMLUnstructuredGridReader(); r.SetFileName('part.vtu'); r.Update(); "
     "print(r.GetOutput())\""},
    {"meshio", "all cell data, without names", "python3 -c \"import meshio; print(meshio.read('part.vtu'))\""}};
constexpr ReadingProgram kMshPrograms[] = {
    {"Gmsh", "physical groups by name; a physical volume if the surface is closed",
     "(echo 'Merge \"part.msh\";'; grep ';$' part.msh) > part.geo\ngmsh -3 part.geo -o filled.msh"},
    {"meshio", "physical groups by name", "python3 -c \"import meshio; print(meshio.read('part.msh'))\""}};
constexpr ReadingProgram kMeshPrograms[] = {
    {"TetGen", "references as markers", "tetgen -pq part.mesh"},
    {"FreeFEM", "references as labels",
     "echo 'load \"msh3\" meshS Th = readmeshS(\"part.mesh\"); cout << Th.nt << endl;' > part.edp\n"
     "FreeFem++ -nw part.edp"},
    {"Gmsh", "references as surfaces", "gmsh -save part.mesh -o part.msh"},
    {"meshio", "references", "python3 -c \"import meshio; print(meshio.read('part.mesh'))\""}};
constexpr ReadingProgram kSmeshPrograms[] = {{"TetGen", "markers, holes and regions", "tetgen -pqA part.smesh"}};
constexpr ReadingProgram kPlyAsciiPrograms[] = {
    {"Gmsh", "triangles", "gmsh -save part.ply -o part.msh"},
    {"meshio", "labels as numbers", "python3 -c \"import meshio; print(meshio.read('part.ply'))\""},
    {"MeshLab", "triangles", "meshlab part.ply"}};
constexpr ReadingProgram kGlbPrograms[] = {
    {"three.js", "a material for each boundary, by name with `_` for blanks"},
    {"Blender", "a material for each boundary, by name",
     "blender --python-expr \"import numpy, bpy; numpy.bool = bool; bpy.ops.import_scene.gltf(filepath='part.glb')\""},
    {"VTK", "triangles"}};

/// In the order of the enumeration Format.
const std::array<FormatSpec, kFormats.size()> kSpecs{{
    {.name = "obj",
     .endings = kObjEndings,
     .media_type = "model/obj",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .reads = "the grammar as found in the wild: negative indices, continued lines, lines and points, colours, weights",
     .about = "objects, groups, materials, `mtllib`",
     .programs = kObjPrograms,
     .read = read_obj,
     .write = [](const WriterInput& in, RunControl& control) { return write_obj(in.mesh, in.comments, control); }},
    {.name = "json",
     .endings = kJsonEndings,
     .media_type = "application/json",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .reads = "vertices, faces of any number of corners, `face_groups` or `labels`; indices from 0",
     .about = "the mesh by patches, with the report",
     .programs = kJsonPrograms,
     .mark =
         [](const Sniffed& s) { return likely_if(s.first_word.starts_with('{') || s.first_word.starts_with('[')); }},
    {.name = "stl",
     .endings = kStlEndings,
     .media_type = "model/stl",
     .storage = Storage::kFloat,
     .reads = "text and binary; each solid of a text is an object",
     .about = "binary",
     .programs = kStlPrograms,
     .mark = stl_mark,
     .read = read_stl,
     .write = [](const WriterInput& in, RunControl& control) { return write_stl(in.mesh, in.comments, control); }},
    {.name = "stl_ascii",
     .endings = kStlEndings,
     .media_type = "model/stl",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "text, a solid for each boundary",
     .programs = kStlAsciiPrograms,
     .write = write_stl_ascii,
     .renamed =
         [](const WriterInput& in, RunControl& control) {
           const auto boundaries = stl_boundaries(in, control);
           return boundaries ? boundaries->renamed() : std::vector<RenamedLabel>();
         }},
    // None of the media types that begin with application/x- is registered.
    {.name = "ply",
     .endings = kPlyEndings,
     .media_type = "application/x-ply",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .reads = "text and binary, both byte orders, any number types, polygons",
     .about = "binary; labels as numbers of the faces, with their names in comments",
     .programs = kPlyPrograms,
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "ply"); },
     .read = read_ply,
     .write = [](const WriterInput& in, RunControl& control) { return write_ply(in.mesh, in.comments, control); }},
    {.name = "off",
     .endings = kOffEndings,
     .media_type = "application/x-off",
     .storage = Storage::kDouble,
     .reads = "OFF, COFF, NOFF, STOFF, nOFF of 3 dimensions, binary",
     .about = "text; comments at the end",
     .programs = kOffPrograms,
     .mark = [](const Sniffed& s) { return likely_if(off_kind(s.first_word).has_value()); },
     .read = read_off,
     .write = [](const WriterInput& in, RunControl& control) { return write_off(in.mesh, in.comments, control); }},
    {.name = "vtu",
     .endings = kVtuEndings,
     .media_type = "application/x-vtu",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .reads =
         "VTU and VTP (text, base64, appended, zlib) and legacy VTK: faces; cell data `group` and the like are labels",
     .about = "VTK XML: patch, surface, quality and labels of each face as cell data",
     .programs = kVtuPrograms,
     .mark =
         [](const Sniffed& s) {
           const bool is_xml = s.first_word.starts_with('<') && s.text.find("<VTKFile") != std::string_view::npos;
           return likely_if(is_xml || is_legacy_vtk(s.text));
         },
     .read = read_vtu,
     .write = write_vtu},
    {.name = "msh",
     .endings = kMshEndings,
     .media_type = "application/x-gmsh",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .reads = "2.2 and 4.1, text and binary: triangles and quadrilaterals; physical groups are groups",
     .about = "text, 2.2 or 4.1: a physical group for each boundary; the surface of each face as a view",
     .programs = kMshPrograms,
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "$MeshFormat" || s.first_word == "$Comments"); },
     .read = read_msh,
     .write = write_msh,
     .renamed = [](const WriterInput& in, RunControl& control) { return msh_boundaries(in, control).renamed(); },
     .filling = msh_filling},
    {.name = "mesh",
     .endings = kMeshEndings,
     .media_type = "application/x-medit",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .reads = "text of any version: triangles and quadrilaterals; references are groups",
     .about = "Medit's text, version 2: a reference for each boundary, with names in comments",
     .programs = kMeshPrograms,
     .mark = [](const Sniffed& s) { return likely_if(s.first_word == "MeshVersionFormatted"); },
     .read = read_medit,
     .write = write_medit,
     .renamed = renamed_in_text},
    {.name = "smesh",
     .endings = kSmeshEndings,
     .media_type = "application/x-tetgen",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .about = "a facet marker for each boundary, with names in comments; a point in each hole and region",
     .programs = kSmeshPrograms,
     .write = write_smesh,
     .renamed = renamed_in_text},
    {.name = "ply_ascii",
     .endings = kPlyEndings,
     .media_type = "application/x-ply",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .about = "text; labels as in `ply`",
     .programs = kPlyAsciiPrograms,
     .write = [](const WriterInput& in,
                 RunControl& control) { return write_ply_ascii(in.mesh, in.comments, control); }},
    {.name = "glb",
     .endings = kGlbEndings,
     .media_type = "model/gltf-binary",
     .storage = Storage::kFloat,
     .labels = LabelsHeld::kOne,
     .reads = "`.glb`, and `.gltf` with embedded buffers: triangles, transforms applied; names of meshes and materials",
     .about = "glTF to look at: a colour for each boundary",
     .programs = kGlbPrograms,
     .mark = gltf_mark,
     .read = read_gltf,
     .write = write_glb},
    {.name = "3mf",
     .endings = kThreemfEndings,
     .media_type = "model/3mf",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kAll,
     .reads = "components and transforms; names of objects and of base materials",
     .mark = [](const Sniffed& s) { return s.content.starts_with("PK\x03\x04") ? Mark::kCertain : Mark::kNone; },
     .read = read_threemf},
    {.name = "inp",
     .endings = kInpEndings,
     .media_type = "application/x-abaqus",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .reads = "input files of Abaqus and CalculiX: triangles and quadrilaterals of shells; sets of elements are groups",
     .mark = [](const Sniffed& s) { return likely_if(s.first_word.starts_with('*') && is_abaqus(s.text)); },
     .read = read_abaqus},
    {.name = "bdf",
     .endings = kBdfEndings,
     .media_type = "application/x-nastran",
     .storage = Storage::kDouble,
     .labels = LabelsHeld::kOne,
     .reads = "bulk data of Nastran: triangles and quadrilaterals of shells; properties are groups",
     .mark = [](const Sniffed& s) { return is_nastran(s.text) ? Mark::kPossible : Mark::kNone; },
     .read = read_nastran},
}};

}  // namespace

Sniffed::Sniffed(std::string_view whole)
    : content(whole),
      text(whole.starts_with("\xef\xbb\xbf") ? whole.substr(3) : whole),
      first_word(remesh::first_word(text)) {}

const FormatSpec& format_spec(Format format) { return kSpecs[static_cast<std::size_t>(format)]; }

}  // namespace remesh
