#include "core/io/foreign_files.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/io/common/number_parsing.h"
#include "core/io/formats.h"
#include "core/io/stl/stl.h"

namespace remesh {
namespace {

constexpr std::string_view kByBlender = "open it in Blender, and export it as OBJ, STL or PLY";
constexpr std::string_view kByItsProgram = "export it as STL from the program that made it, or as STEP for Gmsh";

/// True if the first line is the start of an IGES file: 72 columns of text, then the section S and the number 1.
bool is_iges(std::string_view text) {
  constexpr std::size_t kText = 72, kLine = 80;
  if (text.size() < kLine || text[kText] != 'S') return false;
  if (text.substr(0, kText).find_first_of("\r\n") != std::string_view::npos) return false;
  std::string_view number = text.substr(kText + 1, kLine - kText - 1);
  number.remove_prefix(std::min(number.find_first_not_of(" 0"), number.size()));
  return number == "1";
}

/// Takes the next line from a text, without blanks around it.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
}

/// True if the first record that is no comment begins a section of a DXF file.
bool is_dxf(std::string_view text) {
  constexpr std::string_view kComment = "999";
  std::string_view code = take_line(text);
  for (int comments = 0; code == kComment && comments < 100; ++comments) {
    take_line(text);
    code = take_line(text);
  }
  return code == "0" && take_line(text) == "SECTION";
}

constexpr std::array<ForeignFile, 32> kForeignFiles{{
    {"iso-10303-21", "", "STEP, which has surfaces and no triangles",
     "make triangles with Gmsh: gmsh part.step -2 -clcurv 40 -o part.stl"},
    {"", "", "IGES, which has surfaces and no triangles",
     "make triangles with Gmsh: gmsh part.iges -2 -clcurv 40 -o part.stl", is_iges},
    {"dbrep_drawableshape", "", "BREP of Open CASCADE, which has surfaces and no triangles",
     "make triangles with Gmsh: gmsh part.brep -2 -clcurv 40 -o part.stl"},
    {"cascade topology", "", "BREP of Open CASCADE, which has surfaces and no triangles",
     "make triangles with Gmsh: gmsh part.brep -2 -clcurv 40 -o part.stl"},
    {"blender", "", "a scene of Blender",
     "export it as OBJ: blender -b scene.blend --python-expr "
     "\"import bpy; bpy.ops.wm.obj_export(filepath='scene.obj')\""},
    {"kaydara fbx binary", "", "FBX", kByBlender},
    {"; fbx", "", "FBX", kByBlender},
    {"<?xml", "<COLLADA", "COLLADA", kByBlender},
    {"<?xml", "<amf", "AMF", "convert it to STL or 3MF with the slicer that made it"},
    {"<?xml", "<X3D", "X3D", kByBlender},
    {"#vrml", "", "VRML", kByBlender},
    {"pxr-usdc", "", "USD", kByBlender},
    {"#usda", "", "USD", kByBlender},
    {"ogawa", "", "Alembic", kByBlender},
    {"", "", "DXF", "export the solid as STL from the CAD program", is_dxf},
    {"autocad binary dxf", "", "DXF", "export the solid as STL from the CAD program"},
    {"ac10", "", "DWG of AutoCAD", "export the solid as STL (STLOUT)"},
    {"**abcdefghijklmnopqrstuvwxyz", "", "a part of Parasolid", kByItsProgram},
    {"v5_cfv2", "", "a part of CATIA", kByItsProgram},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "", "a compound file, as the parts of SolidWorks and Inventor are",
     kByItsProgram},
    {"3d geometry file format", "", "OpenNURBS, as Rhino writes it", "mesh it in Rhino (_Mesh), and export it as STL"},
    {"pk\x03\x04", "Document.xml", "a document of FreeCAD", "export it from FreeCAD: File, Export, as STL or STEP"},
    {"\xfd"
     "7zxz",
     "", "packed by xz", "unpack it first: unxz part.stl.xz"},
    {"\x28\xb5\x2f\xfd", "", "packed by zstd, as Blender's scenes are",
     "unpack it first: zstd -d part.stl.zst; or export the scene as OBJ"},
    {"bzh", "", "packed by bzip2", "unpack it first: bunzip2 part.stl.bz2"},
    {"7z\xbc\xaf", "", "a 7z archive", "unpack it first: 7z x part.7z"},
    {"rar!", "", "a RAR archive", "unpack it first: unrar x part.rar"},
    {"\x89png", "", "a picture", "export the part itself as STL"},
    {"%pdf-", "", "PDF", "export the part itself as STL"},
    {"<!doctype html", "", "an HTML page", "the address gives a page and not the file; download the file itself"},
    {"<html", "", "an HTML page", "the address gives a page and not the file; download the file itself"},
    {"<?xml", "", "XML that is no VTK file", "export the part as STL, OBJ or PLY"},
}};

bool begins_as(std::string_view text, const ForeignFile& file) {
  constexpr std::size_t kHead = 4096;
  if (file.is_it != nullptr) return file.is_it(text);
  return equals_ignoring_case(text.substr(0, file.begin.size()), file.begin) &&
         text.substr(0, kHead).find(file.within) != std::string_view::npos;
}

}  // namespace

std::span<const ForeignFile> foreign_files() { return kForeignFiles; }

const ForeignFile* foreign_file(std::string_view content) {
  if (has_length_of_binary_stl(content)) return nullptr;
  const std::string_view text = content.starts_with("\xef\xbb\xbf") ? content.substr(3) : content;
  // A document of FreeCAD is a ZIP archive, as 3MF is.
  const Format likeliest = sniff_format(content);
  if (likeliest != Format::kObj && likeliest != Format::kThreemf) return nullptr;
  const auto* file = std::find_if(kForeignFiles.begin(), kForeignFiles.end(),
                                  [&](const ForeignFile& f) { return begins_as(text, f); });
  return file == kForeignFiles.end() ? nullptr : file;
}

}  // namespace remesh
