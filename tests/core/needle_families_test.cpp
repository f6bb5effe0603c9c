// Tests that surfaces of needles, slits, flaps and steps get faces in proportion to their own number, with defaults and
// where details are removed.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// Makes `count` members of a family, each with details of this height, while its length is 1.
struct Family {
  std::string name;
  std::function<PolygonMesh(int count, double height)> make;
};

PolygonMesh needles_alone(int count, double height) {
  PolygonMesh mesh;
  for (int i = 0; i < count; ++i)
    mesh = shapes::joined(
        mesh,
        shapes::from_lists({{0, 2.0 * i, 0}, {1, 2.0 * i, 0}, {0.25, 2.0 * i + height, 0.5 * height}}, {{0, 1, 2}}));
  return mesh;
}

/// A fan of needles about one vertex, each of which bends against the next.
PolygonMesh fan(int count, double height) {
  std::vector<Vec3> positions{{0, 0, 0}};
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= count; ++i) {
    positions.push_back({std::cos(i * height), std::sin(i * height), i % 2 == 0 ? 0 : 0.5 * height});
    const auto at = static_cast<std::uint32_t>(i);
    if (i > 0) faces.push_back({0, at, at + 1});
  }
  return shapes::from_lists(positions, faces);
}

/// A strip of needles across its width, folded like an accordion.
PolygonMesh strip(int count, double height) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= count; ++i) {
    const double x = i * height, z = i % 2 == 0 ? 0 : 0.5 * height;
    positions.push_back({x, 0, z});
    positions.push_back({x, 1, z});
    const auto at = static_cast<std::uint32_t>(2 * i);
    if (i > 0) faces.insert(faces.end(), {{at - 2, at, at + 1}, {at - 2, at + 1, at - 1}});
  }
  return shapes::from_lists(positions, faces);
}

/// Cubes, each with a needle along one edge.
PolygonMesh cubes_with_needles(int count, double height) {
  PolygonMesh mesh;
  for (int i = 0; i < count; ++i)
    mesh = shapes::joined(mesh, shapes::moved(shapes::cube_with_needle(height), {2.0 * i, 0, 0}));
  return mesh;
}

/// A plate that is divided by slits without a width, always two of them next to each other.
PolygonMesh slits(int count, double height) {
  PolygonMesh mesh;
  for (int i = 0; i < count; ++i) {
    const double y = i;
    // The wide piece and the narrow one share no vertex, except at their left ends.
    mesh = shapes::joined(
        mesh,
        shapes::from_lists({{0, y, 0}, {1, y, 0}, {1, y + 1 - height, 0}, {0, y + 1 - height, 0}}, {{0, 1, 2, 3}}));
    mesh = shapes::joined(
        mesh, shapes::from_lists({{0, y + 1 - height, 0}, {1, y + 1 - height, 1e-3}, {1, y + 1, 1e-3}, {0, y + 1, 0}},
                                 {{0, 1, 2}, {0, 2, 3}}));
  }
  return mesh;
}

/// Sheets with a flap that stands on them.
PolygonMesh flaps(int count, double height) {
  PolygonMesh mesh;
  for (int i = 0; i < count; ++i)
    mesh = shapes::joined(mesh, shapes::moved(shapes::sheet_with_flap(height, false), {0, 2.0 * i, 0}));
  return mesh;
}

/// A solid staircase with low steps.
PolygonMesh steps(int count, double height) {
  std::vector<Vec2> outline{{0, 0}, {static_cast<double>(count), 0}};
  for (int i = count; i-- > 0;) {
    outline.push_back({i + 1.0, 1 - (i + 1) * height});
    outline.push_back({i + 0.0, 1 - (i + 1) * height});
  }
  outline.push_back({0, 1});
  return shapes::prism(outline, 1);
}

const std::vector<Family>& families() {
  static const std::vector<Family> all{{"needles alone", needles_alone},
                                       {"fan", fan},
                                       {"strip", strip},
                                       {"cubes", cubes_with_needles},
                                       {"slits", slits},
                                       {"flaps", flaps},
                                       {"steps", steps}};
  return all;
}

std::uint64_t triangles_of(const PolygonMesh& mesh) { return mesh.corners.size() - 2 * mesh.face_count(); }

TEST(needle_families, defaults_stay_in_proportion_and_grow_with_the_input) {
  for (const Family& family : families())
    for (const double height : {1e-3, 1e-4, 1e-6, 1e-9}) {
      std::vector<std::uint64_t> faces;
      for (const int count : {8, 16, 32}) {
        const PolygonMesh mesh = family.make(count, height);
        const Result result = refined(mesh);
        EXPECT_TRUE(result.report.verified.all_true()) << family.name << " " << height;
        EXPECT_LE(result.mesh.faces.size(), 20 * triangles_of(mesh) + 1000) << family.name << " " << height;
        EXPECT_EQ(listed(result.report), faces_beyond(result.mesh, bounds_of({})).size()) << family.name << height;
        faces.push_back(result.mesh.faces.size());
      }
      // In proportion with what is always allowed: a family of 8 may use all of the 1,000.
      EXPECT_LE(faces[2], 2.5 * static_cast<double>(faces[1]) + 1000) << family.name << " " << height;
    }
}

TEST(needle_families, without_details_few_faces_are_left) {
  for (const Family& family : families())
    for (const double height : {1e-3, 1e-4, 1e-6, 1e-9}) {
      const PolygonMesh mesh = family.make(16, height);
      Options options;
      options.defeature_size = 3 * height;
      const Result result = refined(mesh, options);
      EXPECT_TRUE(result.report.verified.all_true()) << family.name << " " << height;
      EXPECT_LE(result.mesh.faces.size(), 5 * triangles_of(mesh) + 1000) << family.name << " " << height;
      ASSERT_TRUE(result.report.distance_bound);
      EXPECT_LE(result.report.distance_bound->output_to_input,
                std::max(3 * height, 2 * result.report.plane_tolerance) * (1 + 1e-9))
          << family.name << " " << height;
    }
}

}  // namespace
}  // namespace remesh
