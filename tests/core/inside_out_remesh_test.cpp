// Tests shells that look the wrong way, from the input to the result. The analysis, the repair and the result must say
// the same about them.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

std::uint64_t shells_named(const Report& report) {
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kInsideOut) return d.count;
  return 0;
}
std::uint64_t obstacles(const Report& report) {
  std::uint64_t count = 0;
  for (const VolumeObstacle& o : report.volume_obstacles) {
    EXPECT_EQ(o.code, DiagnosticCode::kInsideOut);
    count += o.count;
  }
  return count;
}

/// Expects that both the analysis and the result report `wrong` shells that are inside out, as obstacles to a volume.
/// With the repair `inside_out` they are still told, but are no obstacles any more, and the result has this volume.
void expect_wrong(const PolygonMesh& mesh, std::uint64_t wrong, double volume, Options options = unrefined()) {
  RunControl control;
  const Report analysis = analyze_surface(mesh, options, {}, control);
  EXPECT_EQ(shells_named(analysis), wrong);
  EXPECT_EQ(obstacles(analysis), wrong);
  const Result as_it_is = remesh_surface(mesh, options, {}, control);
  EXPECT_EQ(shells_named(as_it_is.report), wrong);
  EXPECT_EQ(obstacles(as_it_is.report), wrong);
  const double before = *analysis.input.volume;
  EXPECT_NEAR(*as_it_is.report.output.volume, before, 1e-12 * std::fabs(before));

  options.repair.inside_out = true;
  const Report mended = analyze_surface(mesh, options, {}, control);
  EXPECT_EQ(shells_named(mended), wrong) << "what was turned is told";
  EXPECT_EQ(obstacles(mended), 0u);
  const Result result = remesh_surface(mesh, options, {}, control);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(shells_named(result.report), wrong);
  EXPECT_EQ(obstacles(result.report), 0u);
  EXPECT_NEAR(*result.report.output.volume, volume, 1e-12 * volume);
}

TEST(inside_out, hollow_bodies_of_a_report_get_their_right_volume) {
  const std::string name = "reports/outward-cavity.stl";
  if (!test::has_shared_mesh(name)) return;
  std::ifstream file(test::shared_meshes_folder() / name, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const PolygonMesh mesh = read_mesh(Format::kStl, content, {}, control).mesh;
  // Two cubes of 1000 with a cavity of 64 each; both cavities and one of the cubes look the wrong way.
  expect_wrong(mesh, 3, 1872);
}

PolygonMesh in_the_middle(double size, bool is_quads) {
  const Vec3 box{size, size, size};
  return shapes::moved(is_quads ? shapes::quad_box(box, 2) : shapes::box(box, 2), -0.5 * box);
}

TEST(inside_out, bodies_in_cavities_of_bodies_are_turned_by_their_depth) {
  for (const bool is_quads : {false, true}) {
    PolygonMesh mesh = in_the_middle(8, is_quads);
    for (const double size : {6.0, 4.0, 2.0}) mesh = shapes::joined(mesh, in_the_middle(size, is_quads));
    const double volume = 512 - 216 + 64 - 8;
    expect_wrong(mesh, 2, volume);
    expect_wrong(shapes::turned_over(mesh), 2, volume);
    expect_wrong(shapes::scaled(shapes::renumbered(mesh, 5), 0x1p20), 2, 0x1p60 * volume);
  }
}

/// Makes cladding with a cavity, and in it fuel that has a cavity as well. All shells look outwards. The second label
/// stands on the fuel.
PolygonMesh rod(LabelSet FaceLabels::*kind) {
  PolygonMesh mesh = in_the_middle(8, false);
  const std::size_t faces = mesh.face_count();
  for (const double size : {6.0, 4.0, 2.0}) mesh = shapes::joined(mesh, in_the_middle(size, false));
  LabelSet& set = mesh.labels.*kind;
  set.names = {"cladding", "fuel"};
  set.of_face.assign(2 * faces, 0);
  set.of_face.resize(4 * faces, 1);
  return mesh;
}

TEST(inside_out, labels_count_whether_they_bound_patches_or_not) {
  for (LabelSet FaceLabels::*kind : {&FaceLabels::object, &FaceLabels::group, &FaceLabels::material}) {
    for (const bool are_barriers : {true, false}) {
      Options options = unrefined();
      if (!are_barriers) options.barriers = {false, false, false};
      // Both cavities are wrong; the solids in each other are not.
      expect_wrong(rod(kind), 2, 512 - 216 + 64 - 8, options);
      PolygonMesh solids = shapes::joined(in_the_middle(8, false), in_the_middle(4, false));
      solids.labels.*kind = {{"cladding", "fuel"}, {}};
      (solids.labels.*kind).of_face.assign(48, 0);
      (solids.labels.*kind).of_face.resize(96, 1);
      expect_wrong(solids, 0, 512 + 64, options);
      // One face of the inner one belongs to the outer one's body. Its patch is larger without barriers.
      (solids.labels.*kind).of_face[FaceId(95)] = 0;
      expect_wrong(solids, 1, 512 - 64, options);
    }
  }
}

TEST(inside_out, each_solid_of_an_stl_text_and_each_group_of_an_obj_is_a_body_of_its_own) {
  const auto facets = [](const PolygonMesh& mesh) {
    std::string text;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const VertexId v : mesh.face(FaceId(f))) {
        const Vec3 p = mesh.positions[v];
        text += "vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
      }
      text += "endloop\nendfacet\n";
    }
    return text;
  };
  const std::string outer = facets(in_the_middle(4, false)), inner = facets(in_the_middle(2, false));
  RunControl control;
  const auto read = [&](const std::string& text) { return read_mesh(Format::kStl, text, {}, control).mesh; };
  expect_wrong(read("solid a\n" + outer + inner + "endsolid\n"), 1, 64 - 8);
  expect_wrong(read("solid a\n" + outer + "endsolid\nsolid b\n" + inner + "endsolid\n"), 0, 64 + 8);

  const std::string cubes =
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\nv 3 3 3\nv 0 3 3\n"
      "v 1 1 1\nv 2 1 1\nv 2 2 1\nv 1 2 1\nv 1 1 2\nv 2 1 2\nv 2 2 2\nv 1 2 2\n";
  const std::string first = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const std::string second = "f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
  const auto read_obj = [&](const std::string& text) {
    return read_mesh(Format::kObj, cubes + text, {}, control).mesh;
  };
  expect_wrong(read_obj("g a\n" + first + second), 1, 27 - 1);
  expect_wrong(read_obj("g a\n" + first + "g b\n" + second), 0, 27 + 1);
  expect_wrong(read_obj("usemtl a\n" + first + "usemtl b\n" + second), 0, 27 + 1);
}

}  // namespace
}  // namespace remesh
