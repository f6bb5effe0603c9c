#include "core/io/mesh_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/base/rounded_to_float.h"
#include "core/remesh.h"
#include "tests/support/reading.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using Corners = std::array<Vec3, 3>;

/// Returns the triangles of a result by their positions alone, sorted. Each begins at its least corner.
std::vector<Corners> geometry(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const Triangle& face : mesh.faces) {
    Corners& corners = triangles.emplace_back();
    for (int i = 0; i < 3; ++i) corners[i] = mesh.positions[face[i]];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

PolygonMesh through(Format format, const TriangleMesh& mesh) {
  RunControl control;
  const IdVector<FaceId, PatchId> patches(mesh.faces.size(), PatchId(0));
  const std::string file = write_mesh(format, {mesh, patches, {"a comment"}}, control);
  EXPECT_EQ(sniff_format(file), format);
  return read_mesh(format, file, {}, control).mesh;
}

TEST(mesh_files, the_same_mesh_in_any_format_gives_the_same_surface) {
  Options refined;
  refined.max_edge_length = 0.7;
  for (const PolygonMesh& shape : {shapes::l_bracket(2), shapes::plate_with_round_hole(8), shapes::sphere(1)}) {
    // Coordinates as STL has them, so that all formats can hold the same.
    TriangleMesh mesh = shapes::as_triangles(shape);
    for (Vec3& p : mesh.positions) p = rounded_to_float(p);
    for (const Options& options : {unrefined(), refined}) {
      const auto expected = geometry(remeshed(through(Format::kObj, mesh), options).mesh);
      for (const Format format :
           {Format::kStl, Format::kPly, Format::kOff, Format::kVtu, Format::kMsh, Format::kMesh, Format::kGlb}) {
        EXPECT_EQ(geometry(remeshed(through(format, mesh), options).mesh), expected) << format_name(format);
      }
    }
  }
}

TEST(mesh_files, what_is_not_read_or_written_here_is_an_error) {
  RunControl control;
  for (const Format format : {Format::kJson, Format::kSmesh}) {
    EXPECT_THROW(read_mesh(format, "", {}, control), Error) << format_name(format);
  }
  EXPECT_THROW(write_mesh(Format::kJson, {{}, {}, {}}, control), Error);
}

/// Returns two triangles on two patches.
std::pair<TriangleMesh, IdVector<FaceId, PatchId>> folded() {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 0.1}}) mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  mesh.faces.push_back({VertexId(0), VertexId(3), VertexId(1)});
  IdVector<FaceId, PatchId> patches;
  patches.push_back(PatchId(0));
  patches.push_back(PatchId(1));
  return {mesh, patches};
}

TEST(msh_writer, patches_are_physical_groups_unless_there_are_labels) {
  auto [mesh, patches] = folded();
  RunControl control;
  EXPECT_EQ(write_mesh(Format::kMsh, {mesh, patches, {"$End\nline"}}, control),
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\n# $End\n# line\n$EndComments\n"
            "$PhysicalNames\n2\n2 1 \"patch_0\"\n2 2 \"patch_1\"\n$EndPhysicalNames\n"
            "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 0.1\n$EndNodes\n"
            "$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 2 2 1 4 2\n$EndElements\n");
  mesh.labels.material.names = {"st\"eel\n$End"};
  mesh.labels.material.of_face.items() = {0, 0};
  const std::string labelled = write_mesh(Format::kMsh, {mesh, patches, {}}, control);
  EXPECT_NE(labelled.find("$PhysicalNames\n1\n2 1 \"st_eel__End\"\n$EndPhysicalNames\n"), std::string::npos);
  const std::string exact = write_mesh(Format::kMsh, {mesh, patches, {}, {}, {.names = NameRule::kExact}}, control);
  EXPECT_NE(exact.find("$PhysicalNames\n1\n2 1 \"st'eel $End\"\n$EndPhysicalNames\n"), std::string::npos);
  EXPECT_NE(labelled.find("\n2 2 2 1 2 1 4 2\n"), std::string::npos) << "group 1, patch 2";
}

TEST(msh_writer, surfaces_are_element_data_and_leave_the_groups_alone) {
  const auto [mesh, patches] = folded();
  RunControl control;
  const std::string plain = write_mesh(Format::kMsh, {mesh, patches, {}}, control);
  const std::vector<SurfaceId> surfaces{SurfaceId(3), SurfaceId(0)};
  EXPECT_EQ(write_mesh(Format::kMsh, {mesh, patches, {}, surfaces}, control),
            plain + "$ElementData\n1\n\"surface\"\n1\n0\n3\n0\n1\n2\n1 3\n2 0\n$EndElementData\n");
}

TEST(vtu_writer, surfaces_are_cell_data) {
  const auto [mesh, patches] = folded();
  RunControl control;
  EXPECT_EQ(write_mesh(Format::kVtu, {mesh, patches, {}}, control).find("surface"), std::string::npos);
  const std::vector<SurfaceId> surfaces{SurfaceId(1), SurfaceId(0)};
  const std::string file = write_mesh(Format::kVtu, {mesh, patches, {}, surfaces}, control);
  // Int32 1 and 0 behind their length of 8 bytes.
  EXPECT_NE(file.find("Name=\"surface\" format=\"binary\">\nCAAAAAAAAAABAAAAAAAAAA==\n"), std::string::npos) << file;
}

TEST(vtu_writer, no_name_and_no_comment_can_leave_its_comment) {
  auto [mesh, patches] = folded();
  mesh.labels.group.names = {"a --> <b>", "caf\xe9", "caf\xc3\xa9"};
  mesh.labels.group.of_face.items() = {0, 1};
  RunControl control;
  const std::string file = write_mesh(Format::kVtu, {mesh, patches, {"--", "one\ntwo"}}, control);
  EXPECT_NE(file.find("<!-- -? -->\n<!-- one -->\n<!-- two -->\n<!-- group 0: a -?> <b> -->\n<!-- group 1: caf? -->\n"
                      "<!-- group 2: caf\xc3\xa9 -->\n<VTKFile "),
            std::string::npos)
      << file.substr(0, 400);
  // Int32 0 and 1 behind their length of 8 bytes.
  EXPECT_NE(file.find("Name=\"patch\" format=\"binary\">\nCAAAAAAAAAAAAAAAAQAAAA==\n"), std::string::npos);
}

TEST(writers, all_stop_when_they_are_told_to) {
  const auto [mesh, patches] = folded();
  for (const Format format : kFormats) {
    if (format == Format::kJson || !is_written(format)) continue;
    RunControl control;
    control.cancel();
    EXPECT_THROW(write_mesh(format, {mesh, patches, {}}, control), Error) << format_name(format);
  }
}

}  // namespace
}  // namespace remesh
