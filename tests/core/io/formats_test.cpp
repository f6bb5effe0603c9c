#include "core/io/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/io/format_spec.h"

namespace remesh {
namespace {

/// Makes a binary STL of `triangles` flat records. Its header begins with `header`.
std::string binary_stl(std::string header, unsigned char triangles) {
  header.resize(80, '\0');
  header += std::string{static_cast<char>(triangles), '\0', '\0', '\0'};
  return header + std::string(50u * triangles, '\0');
}

TEST(formats, every_format_is_found_by_its_name_and_has_its_own_media_type) {
  std::set<std::string_view> media_types;
  for (const Format format : kFormats) {
    EXPECT_EQ(format_from_name(format_name(format)), format);
    // The two kinds of STL have one type and one ending, and so have those of PLY.
    const Format first = format == Format::kStlAscii   ? Format::kStl
                         : format == Format::kPlyAscii ? Format::kPly
                                                       : format;
    EXPECT_EQ(media_types.insert(media_type(format)).second, format == first) << media_type(format);
    EXPECT_EQ(format_from_file_name("part." + std::string(file_ending(format))), first);
  }
  EXPECT_EQ(media_type(Format::kObj), "model/obj");
  EXPECT_EQ(media_type(Format::kJson), "application/json");
  EXPECT_EQ(media_type(Format::kStl), "model/stl");
}

TEST(formats, every_format_has_a_row_of_its_own) {
  std::set<std::string_view> names;
  for (const Format format : kFormats) {
    const FormatSpec& spec = format_spec(format);
    EXPECT_FALSE(spec.name.empty());
    EXPECT_FALSE(spec.endings.empty()) << spec.name;
    EXPECT_FALSE(spec.media_type.empty()) << spec.name;
    const bool is_read = spec.read != nullptr || format == Format::kJson;
    EXPECT_EQ(spec.reads.empty(), !is_read) << spec.name;
    EXPECT_EQ(spec.about.empty(), !is_written(format)) << spec.name;
    EXPECT_EQ(spec.programs.empty(), !is_written(format)) << spec.name;
    for (const ReadingProgram& program : spec.programs) {
      EXPECT_FALSE(program.takes.empty()) << program.program;
      EXPECT_LE(std::count(program.next.begin(), program.next.end(), '\n'), 2) << program.next;
      const std::string file = "part." + std::string(file_ending(format));
      EXPECT_TRUE(program.next.empty() || program.next.find(file) != std::string_view::npos) << program.next;
    }
    // Only formats with one label for each face change names, and glTF is not for mesh programs.
    EXPECT_EQ(spec.renamed != nullptr, is_written(format) && spec.labels == LabelsHeld::kOne && format != Format::kGlb)
        << spec.name;
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_EQ(format_from_name(spec.name), format);
    // JSON is read and written above the core, and some formats are only read.
    const bool is_only_read = format == Format::kThreemf || format == Format::kInp || format == Format::kBdf;
    EXPECT_EQ(spec.write == nullptr, format == Format::kJson || is_only_read) << spec.name;
  }
}

TEST(formats, what_is_read_is_told_by_its_content) {
  // OBJ has no mark: it is what looks like nothing else.
  for (const Format format : kFormats) {
    const FormatSpec& spec = format_spec(format);
    EXPECT_EQ(spec.mark == nullptr && spec.read != nullptr, format == Format::kObj) << spec.name;
  }
}

TEST(formats, a_name_is_known_only_as_it_stands_in_the_contract) {
  EXPECT_EQ(format_from_name("obj"), Format::kObj);
  for (const char* name : {"", "OBJ", "obj ", ".obj", "step"}) EXPECT_EQ(format_from_name(name), std::nullopt) << name;
}

TEST(formats, the_ending_of_a_file_name_tells_the_format) {
  EXPECT_EQ(format_from_file_name("part.obj"), Format::kObj);
  EXPECT_EQ(format_from_file_name("/a.b/c.d/Part.v2.STL"), Format::kStl);
  EXPECT_EQ(format_from_file_name("C:\\meshes\\part.Ply"), Format::kPly);
  EXPECT_EQ(format_from_file_name(".json"), Format::kJson);
  EXPECT_EQ(format_from_file_name("part.obj.gz"), Format::kObj);
  EXPECT_EQ(format_from_file_name("PART.STL.GZ"), Format::kStl);
  for (const char* name :
       {"", "obj", ".gz", "part.gz", "part", "part.", "dir.obj/part", "dir.obj\\part", "part.objx"}) {
    EXPECT_EQ(format_from_file_name(name), std::nullopt) << name;
  }
}

TEST(formats, a_format_may_be_read_from_files_of_several_endings_and_is_written_with_one) {
  for (const Format format : kFormats) {
    for (const std::string_view ending : format_spec(format).endings) {
      const std::string name = "part." + std::string(ending);
      const Format read = *format_from_file_name(name);
      EXPECT_EQ(format_spec(read).endings.data(), format_spec(format).endings.data()) << name;
      const bool is_first = is_written(format) && ending == file_ending(format);
      EXPECT_EQ(written_format_from_file_name(name), is_first ? std::optional(read) : std::nullopt) << name;
    }
  }
  EXPECT_EQ(format_from_file_name("Part.VTP.gz"), Format::kVtu);
  EXPECT_EQ(format_from_file_name("part.vtk"), Format::kVtu);
  EXPECT_EQ(format_from_file_name("part.gltf"), Format::kGlb);
  EXPECT_EQ(written_format_from_file_name("part.ply.gz"), Format::kPly);
  EXPECT_EQ(written_format_from_file_name("part.3mf"), std::nullopt);
}

TEST(formats, json_is_known_by_its_first_character) {
  EXPECT_EQ(sniff_format("{\"mesh\": {}}"), Format::kJson);
  EXPECT_EQ(sniff_format(" \r\n\t[1]"), Format::kJson);
  EXPECT_EQ(sniff_format("\xef\xbb\xbf{}"), Format::kJson);
}

TEST(formats, text_stl_has_solid_first_and_a_facet_later) {
  EXPECT_EQ(sniff_format("solid part\n facet normal 0 0 1\n"), Format::kStl);
  EXPECT_EQ(sniff_format("solid\nfacet normal 0 0 1\n"), Format::kStl);
  EXPECT_EQ(sniff_format("# exported\nSolid\nFacet Normal 0 0 1\n"), Format::kStl);
  for (const char* head : {"; written by a program\n", "Written by a Program\n\n", "!\r\n// head\r\n  "})
    EXPECT_EQ(sniff_format(std::string(head) + "solid part\n facet normal 0 0 1\n"), Format::kStl) << head;
  EXPECT_EQ(sniff_format("solid ground\nv 0 0 0\n"), Format::kObj);
  EXPECT_EQ(sniff_format("v 0 0 0\n# solid\nfacet\n"), Format::kObj);
  EXPECT_EQ(sniff_format("solids\nfacet normal\n"), Format::kObj);
}

TEST(formats, binary_stl_is_known_by_its_length_whatever_its_header_says) {
  EXPECT_EQ(sniff_format(binary_stl("", 2)), Format::kStl);
  EXPECT_EQ(sniff_format(binary_stl("", 0)), Format::kStl);
  EXPECT_EQ(sniff_format(binary_stl("solid facets", 3)), Format::kStl);
  EXPECT_EQ(sniff_format(binary_stl("{ply OFF", 3)), Format::kStl);
}

TEST(formats, binary_stl_of_another_length_is_known_by_its_zeros) {
  EXPECT_EQ(sniff_format(binary_stl("", 2) + "x"), Format::kStl);
  EXPECT_EQ(sniff_format(binary_stl("solid facets", 3).substr(0, 200)), Format::kStl);
  EXPECT_EQ(sniff_format(std::string_view("\xfe\xff\0v", 4)), Format::kObj) << "UTF-16, as the reader will say";
}

TEST(formats, ply_and_off_are_known_by_their_first_word) {
  EXPECT_EQ(sniff_format("ply\r\nformat ascii 1.0\n"), Format::kPly);
  for (const char* mark : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "4OFF", "nOFF", "STCN4nOFF"}) {
    EXPECT_EQ(sniff_format(std::string(mark) + "\n8 6 0\n"), Format::kOff) << mark;
    EXPECT_EQ(sniff_format("# made by hand\n\n# again\r\n" + std::string(mark) + " 8 6 0\n"), Format::kOff) << mark;
  }
  for (const char* word : {"off", "OFFSET", "XOFF", "plywood"}) EXPECT_EQ(sniff_format(word), Format::kObj) << word;
}

TEST(formats, other_formats_are_known_by_words_or_marks_of_their_own) {
  EXPECT_EQ(sniff_format("# vtk DataFile Version 3.0\npart\nASCII\nDATASET POLYDATA\n"), Format::kVtu);
  EXPECT_EQ(sniff_format("MeshVersionFormatted 2\nDimension 3\n"), Format::kMesh);
  EXPECT_EQ(sniff_format("glTF\x02"), Format::kGlb);
  EXPECT_EQ(sniff_format("PK\x03\x04\x14"), Format::kThreemf);
  EXPECT_EQ(sniff_format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">\n"), Format::kVtu);
  EXPECT_EQ(sniff_format("<VTKFile>"), Format::kVtu);
  EXPECT_EQ(sniff_format("$MeshFormat\n2.2 0 8\n"), Format::kMsh);
  EXPECT_EQ(sniff_format("** made by hand\n*HEADING\nx\n*Node\n1, 0, 0, 0\n"), Format::kInp);
  EXPECT_EQ(sniff_format("**ABCDEFGHIJKLMNOPQRSTUVWXYZ"), Format::kObj) << "a part of Parasolid";
  EXPECT_EQ(sniff_format("$ made by hand\nSOL 101\nCEND\nBEGIN BULK\n"), Format::kBdf);
  EXPECT_EQ(sniff_format("GRID,1,,0.,0.,0.\n"), Format::kBdf);
  EXPECT_EQ(sniff_format("v 0 0 0\ng GRID\ng grid 1 2 3\n"), Format::kObj);
  EXPECT_EQ(sniff_format("<html>"), Format::kObj);
  EXPECT_EQ(sniff_format("v 0 0 0 # <VTKFile $MeshFormat\n"), Format::kObj);
}

TEST(formats, everything_else_is_taken_for_obj) {
  for (const char* text : {"", "# a comment only", "v 0 0 0\n", "o OFF\n", "mtllib ply\n", "\xff\xfe", "  \n"}) {
    EXPECT_EQ(sniff_format(text), Format::kObj) << text;
  }
}

}  // namespace
}  // namespace remesh
