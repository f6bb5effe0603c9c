#include "core/io/foreign_files.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace remesh {
namespace {

/// The first lines of files as their programs write them, and a word of the name that is told.
const std::vector<std::pair<std::string, std::string>>& samples() {
  static const std::string blanks(72, ' ');
  static const std::vector<std::pair<std::string, std::string>> all{
      {"ISO-10303-21;\nHEADER;\n", "STEP"},
      {blanks + "S      1\n1H,,1H;,4HPART" + blanks, "IGES"},
      {blanks + "S0000001\r\n", "IGES"},
      {"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n", "BREP"},
      {"CASCADE Topology V3, (c) Open Cascade\n", "BREP"},
      {"BLENDER-v279RENDH", "Blender"},
      {"Kaydara FBX Binary  ", "FBX"},
      {"; FBX 7.3.0 project file\n", "FBX"},
      {"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">", "COLLADA"},
      {"<?xml version=\"1.0\"?>\n<amf unit=\"millimeter\">", "AMF"},
      {"<?xml version=\"1.0\"?>\n<X3D>", "X3D"},
      {"<?xml version=\"1.0\"?>\n<part>", "XML"},
      {"#VRML V2.0 utf8\n", "VRML"},
      {"PXR-USDC", "USD"},
      {"#usda 1.0\n", "USD"},
      {"Ogawa\xff", "Alembic"},
      {"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "DXF"},
      {"999\nmade by hand\n0\nSECTION\n", "DXF"},
      {"AutoCAD Binary DXF\r\n", "DXF"},
      {"AC1032", "DWG"},
      {"**ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz**", "Parasolid"},
      {"V5_CFV2", "CATIA"},
      {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "SolidWorks"},
      {"3D Geometry File Format        7", "Rhino"},
      {"PK\x03\x04\x14......................Document.xml<?xml", "FreeCAD"},
      {"\xfd"
       "7zXZ",
       "xz"},
      {"\x28\xb5\x2f\xfd", "zstd"},
      {"BZh91AY", "bzip2"},
      {"7z\xbc\xaf\x27\x1c", "7z"},
      {"Rar!\x1a", "RAR"},
      {"\x89PNG\r\n", "picture"},
      {"%PDF-1.7\n", "PDF"},
      {"<!DOCTYPE html>\n<html>", "HTML"},
      {"<html>", "HTML"}};
  return all;
}

TEST(foreign_files, each_is_known_by_how_it_begins) {
  for (const auto& [content, name] : samples()) {
    const ForeignFile* found = foreign_file(content);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_NE(found->name.find(name), std::string_view::npos) << found->name << ", not " << name;
  }
}

TEST(foreign_files, every_row_says_what_to_do_next_and_is_reached_by_a_sample) {
  for (const ForeignFile& row : foreign_files()) {
    EXPECT_FALSE(row.name.empty());
    EXPECT_FALSE(row.next.empty()) << row.name;
    bool is_reached = false;
    for (const auto& sample : samples()) is_reached = is_reached || foreign_file(sample.first) == &row;
    EXPECT_TRUE(is_reached) << row.name << ", " << row.begin;
  }
}

TEST(foreign_files, what_is_one_of_ours_or_unknown_is_none_of_them) {
  // A binary STL of one triangle. Its header may be any text.
  const auto binary_stl = [](std::string header) {
    header.resize(80, '\0');
    return header + std::string("\x01\0\0\0", 4) + std::string(50, '\0');
  };
  for (const std::string& content :
       {std::string(), std::string("v 0 0 0\n"), std::string("# VTK\nv 0 0 0\n"), std::string("g pk\n"),
        std::string("<"), std::string("PK\x03\x04\x14"), std::string("glTF\x02"),
        std::string("# vtk DataFile Version 3.0\npart\nASCII\nDATASET POLYDATA\n"),
        std::string("<?xml version=\"1.0\"?>\n<VTKFile>"), std::string("0\n0\n"),
        std::string("# Blender v2.93\no Cube\n"), std::string(72, '#') + "S     12\nv 0 0 0\n",
        std::string(40, '#') + "\n" + std::string(31, '#') + "S      1\nv 0 0 0\n", binary_stl("PK\x03\x04"),
        binary_stl("<html")}) {
    EXPECT_EQ(foreign_file(content), nullptr) << content;
  }
}

}  // namespace
}  // namespace remesh
