// Tests the small meshes of tests/data, which have each kind of part and of defect. Each result is measured here and
// compared with what geometry says of the mesh. So every kind is tested without the collection of real meshes, too.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/own_meshes.h"
#include "tests/support/refined_checks.h"
#include "tests/support/remeshed.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using test::OwnMesh;

PolygonMesh read(const std::string& name) {
  std::ifstream file(test::own_meshes_folder() / name, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  return read_mesh(sniff_format(content), content, ReadLimits{}, control).mesh;
}

struct Measures {
  double area = 0, volume = 0, rim = 0;
  std::int64_t euler = 0;
  int bodies = 0;
  int unbalanced = 0;  ///< edges with more faces on one way along them than on the other
};

/// Measures a mesh by definitions alone.
Measures measure(const TriangleMesh& mesh) {
  Measures measures;
  std::map<std::pair<VertexId, VertexId>, std::array<int, 2>> edges;  // faces on each of the two ways along an edge
  std::vector<std::uint32_t> body(mesh.positions.size());
  std::iota(body.begin(), body.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (body[v] != v) v = body[v] = body[body[v]];
    return v;
  };
  for (const Triangle& t : mesh.faces) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    measures.area += norm(cross(b - a, c - a)) / 2;
    measures.volume += dot(a, cross(b, c)) / 6;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId from = t[k], to = t[(k + 1) % 3];
      ++edges[std::minmax(from, to)][from < to ? 0 : 1];
      body[root(from.value)] = root(to.value);
    }
  }
  for (const auto& [ends, ways] : edges) {
    if (ways[0] + ways[1] == 1) measures.rim += norm(mesh.positions[ends.second] - mesh.positions[ends.first]);
    measures.unbalanced += ways[0] != ways[1];
  }
  // A vertex without a face would count as a body of its own.
  for (std::uint32_t v = 0; v < body.size(); ++v) measures.bodies += root(v) == v;
  measures.euler = static_cast<std::int64_t>(mesh.positions.size()) - static_cast<std::int64_t>(edges.size()) +
                   static_cast<std::int64_t>(mesh.faces.size());
  return measures;
}

bool is_told(const Report& report, const std::string& name) {
  return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                     [&](const Diagnostic& d) { return diagnostic_name(d.code) == name; });
}

void expect_shape(const OwnMesh& own, const Result& result) {
  const Measures measures = measure(result.mesh);
  const auto expect_near = [&](double value, double expected, const char* what) {
    EXPECT_NEAR(value, expected, own.precision * std::fabs(expected)) << what;
  };
  expect_near(measures.area, own.area, "area");
  expect_near(result.report.output.area, own.area, "reported area");
  if (own.volume) {
    expect_near(measures.volume, *own.volume, "volume");
    EXPECT_EQ(measures.unbalanced, 0);
  }
  if (result.report.output.volume) {
    ASSERT_TRUE(own.volume);
    expect_near(*result.report.output.volume, *own.volume, "reported volume");
  }
  expect_near(measures.rim, own.rim, "rim");
  EXPECT_EQ(measures.euler, own.euler);
  EXPECT_EQ(measures.bodies, own.bodies);
  EXPECT_EQ(result.report.patches.size(), own.patches);
}

struct Way {
  std::string name;
  bool is_refined;
  double proximity;

  friend std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }
};

class own_meshes : public testing::TestWithParam<Way> {};

TEST_P(own_meshes, they_become_what_geometry_says) {
  Options options;
  options.refine = GetParam().is_refined;
  options.proximity = GetParam().proximity;
  options.max_output_faces = 5'000;  // towards the sharp edge of the wedge gaps ask for ever smaller triangles
  int without_defect = 0;
  for (const OwnMesh& own : test::own_meshes()) {
    SCOPED_TRACE(own.file);
    const PolygonMesh mesh = read(own.file);
    const Result result = remeshed(mesh, options, {2});
    EXPECT_TRUE(result.report.verified.all_true());
    expect_shape(own, result);
    for (const std::string& name : own.told) EXPECT_TRUE(is_told(result.report, name)) << name;
    if (!options.refine) {
      EXPECT_EQ(result.mesh.faces.size(), own.triangles);
      EXPECT_EQ(listed(result.report), 0u);
    } else {
      const Bounds bounds = bounds_of(options);
      EXPECT_LE(faces_beyond(result.mesh, bounds, 1e-8).size(), listed(result.report));
      // No corner stands in the way of the bound, so each angle must reach it.
      if (own.sharpest_deg >= bounds.min_angle_deg) {
        EXPECT_EQ(faces_beyond(result.mesh, bounds, 1e-8).size(), 0u) << listed_in_words(result.report);
      }
      // An angle that the input has cannot be mended, and is listed.
      if (own.sharpest_deg < bounds.min_angle_deg) {
        EXPECT_GT(listed(result.report, UnrefinedReason::kInputAngle), 0u);
      }
    }
    if (!own.told.empty()) continue;
    ++without_defect;
    for (const Diagnostic& found : result.report.diagnostics) {
      EXPECT_TRUE(found.code == DiagnosticCode::kCurvedSurface || found.code == DiagnosticCode::kManyFaces)
          << found.message;
      EXPECT_TRUE(options.refine);
    }
    expect_promises(mesh, options, result, std::max(own.precision, 1e-9));
  }
  EXPECT_GE(without_defect, 10);
}

INSTANTIATE_TEST_SUITE_P(, own_meshes,
                         testing::Values(Way{"unrefined", false, 0}, Way{"by_defaults", true, 0},
                                         Way{"with_gaps", true, 1}),
                         [](const auto& info) { return info.param.name; });

TEST(own_labels, both_halves_of_a_box_keep_their_groups_and_materials) {
  for (const bool is_refined : {false, true}) {
    Options options;
    options.refine = is_refined;
    const TriangleMesh mesh = remeshed(read("labels.obj"), options, {2}).mesh;
    ASSERT_TRUE(mesh.labels.group.is_used() && mesh.labels.material.is_used());
    std::map<std::pair<std::string, std::string>, double> areas;
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
      const auto& [a, b, c] = mesh.faces[FaceId(f)];
      const LabelSet &group = mesh.labels.group, &material = mesh.labels.material;
      areas[{group.names[group.of_face[FaceId(f)]], material.names[material.of_face[FaceId(f)]]}] +=
          norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])) / 2;
    }
    // Each half has four long sides of 1 x 1 and one end.
    ASSERT_EQ(areas.size(), 2u);
    EXPECT_NEAR((areas[{"left", "red"}]), 5, 1e-12);
    EXPECT_NEAR((areas[{"right", "blue"}]), 5, 1e-12);
  }
}

TEST(own_inside_out, a_box_that_looks_inwards_is_turned_over_if_that_is_asked_for) {
  Options options = unrefined();
  options.repair.inside_out = true;
  EXPECT_NEAR(measure(remeshed(read("inside_out.stl"), options, {2}).mesh).volume, 6, 1e-12);
}

}  // namespace
}  // namespace remesh
