// Tests coordinates that are absurd but finite, and sizes that are absurd for the coordinates. The program must soon
// give either a verified answer or an error of the input.

#include "core/base/coordinate_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/errors.h"
#include "tests/support/random.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/time_limit.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

PolygonMesh report_mesh(const std::string& name) {
  std::ifstream file(test::shared_meshes_folder() / "reports" / name, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  return read_mesh(sniff_format(content), content, ReadLimits{}, control).mesh;
}

/// Returns the error that a run ends with, if any. If there is none, the result must be verified.
std::optional<Error> error_of_run(const PolygonMesh& mesh, const Options& options) {
  RunControl control;
  std::optional<Error> ended;
  // It takes some milliseconds.
  test::expect_within(test::Seconds(10), [&] {
    try {
      const Result result = remesh_surface(mesh, options, {}, control);
      EXPECT_TRUE(result.report.verified.all_true());
    } catch (const Error& error) {
      ended = error;
    }
  });
  return ended;
}

/// Expects either a verified result, or an error that blames the range of the coordinates and names a vertex or a face.
/// The error that the mesh is empty is allowed as well, because a mesh has no area if rounding has left it no width.
void expect_remeshed_or_refused(const PolygonMesh& mesh, const Options& options, const std::string& what) {
  const auto error = error_of_run(mesh, options);
  if (!error || error->code == Code::kEmptyMesh) return;
  EXPECT_EQ(error->code, Code::kCoordinateRange) << what << ": " << error->what();
  EXPECT_TRUE(error->element.has_value()) << what;
}

Options usual() { return {}; }

TEST(coordinate_range, files_of_absurd_coordinates_are_refused_at_once) {
  for (const std::string name :
       {"huge-coordinates.obj", "mixed-scales.obj", "one-needle.obj", "flt-max.obj", "hang-area.obj", "e200.obj"}) {
    if (!test::has_shared_mesh("reports/" + name)) return;
    for (Options options : {usual(), unrefined()}) {
      options.max_area = options.refine ? std::optional(0.5) : std::nullopt;
      const auto error = error_of_run(report_mesh(name), options);
      ASSERT_TRUE(error.has_value()) << name;
      EXPECT_EQ(error->code, Code::kCoordinateRange) << name << ": " << error->what();
      EXPECT_TRUE(error->element.has_value()) << name;
    }
  }
}

TEST(coordinate_range, absurd_sizes_of_narrow_parts_are_refused_at_once) {
  if (!test::has_shared_mesh("reports/hang-strip.obj") || !test::has_shared_mesh("reports/thin-plate.obj")) return;
  Options strip;
  strip.max_area = 0.5;
  strip.max_output_faces = 50'000'000;
  const auto of_strip = error_of_run(report_mesh("hang-strip.obj"), strip);
  ASSERT_TRUE(of_strip.has_value());
  EXPECT_EQ(of_strip->code, Code::kOutputTooLarge);
  Options plate;
  plate.max_area = 1e-16;
  plate.max_output_faces = 20'000;
  const auto of_plate = error_of_run(report_mesh("thin-plate.obj"), plate);
  ASSERT_TRUE(of_plate.has_value());
  EXPECT_EQ(of_plate->code, Code::kOutputTooLarge);
}

TEST(coordinate_range, one_vertex_far_off_leaves_an_answer_or_is_named) {
  for (const double distance : {1e6, 1e12, 1e15, 1e17, 1e20, 1e30, 1e38, 1e80, 1e150, 1e200, 1e300})
    for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{1, 1, 0}, Vec3{0.3, 0.5, 0.8}})
      for (const Options& options : {usual(), unrefined()}) {
        PolygonMesh mesh = shapes::box({1, 2, 3}, 2);
        mesh.positions[VertexId(7)] = distance * way;
        expect_remeshed_or_refused(mesh, options, "a vertex at " + std::to_string(std::log10(distance)));
      }
}

TEST(coordinate_range, parts_of_very_different_sizes_leave_an_answer_or_are_named) {
  for (const double size : {1e-6, 1e-12, 1e-16, 1e-20, 1e-38, 1e-100, 1e-160, 1e-300})
    for (const Options& options : {usual(), unrefined()}) {
      const PolygonMesh large = shapes::box({1, 1, 1});
      for (const Vec3& place : {Vec3{0, 0, 0}, Vec3{0.5, 0.5, 0.5}, Vec3{2, 3, 4}}) {
        const PolygonMesh small = shapes::moved(shapes::scaled(shapes::box({1, 1, 1}), size), place);
        expect_remeshed_or_refused(shapes::joined(large, small), options,
                                   "a box of " + std::to_string(std::log10(size)));
      }
    }
}

TEST(coordinate_range, needles_and_sheets_of_any_width_leave_an_answer_or_are_named) {
  Random random(3);
  for (const double width : {1e-3, 1e-9, 1e-15, 1e-17, 1e-25, 1e-40, 1e-150, 1e-290})
    for (const double angle : {0.0, 33.0})
      for (const Options& options : {usual(), unrefined()}) {
        const std::string what = "a width of " + std::to_string(std::log10(width));
        const Vec3 axis{random.unit(), random.unit(), random.unit()};
        const PolygonMesh needle = shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0.25, width, 0}}, {{0, 1, 2}});
        expect_remeshed_or_refused(shapes::rotated(needle, axis, angle), options, what + ", a needle");
        const PolygonMesh strip = shapes::sheet(1, width, 3, 2);
        expect_remeshed_or_refused(shapes::rotated(strip, axis, angle), options, what + ", a strip");
        const PolygonMesh plate = shapes::box({1, 1, width}, 2);
        expect_remeshed_or_refused(shapes::rotated(plate, axis, angle), options, what + ", a plate");
        const PolygonMesh rod = shapes::box({1, width, width}, 2);
        expect_remeshed_or_refused(shapes::rotated(rod, axis, angle), options, what + ", a rod");
      }
}

TEST(coordinate_range, random_scales_of_single_numbers_leave_an_answer_or_are_named) {
  Random random(base_seed(5));
  for (int i = 0; i < unless_sanitized(150, 20); ++i) {
    PolygonMesh mesh = random.chance(0.5) ? shapes::box({1, 2, 3}, 2) : shapes::cylinder(9, 1, 2);
    const int changes = random.integer(1, 4);
    for (int k = 0; k < changes; ++k) {
      Vec3& p = mesh.positions[VertexId(static_cast<std::size_t>(random.below(static_cast<int>(mesh.vertex_count()))))];
      p[random.below(3)] *= std::pow(10.0, random.uniform(-300, 300));
    }
    expect_remeshed_or_refused(mesh, random.chance(0.5) ? usual() : unrefined(), "number " + std::to_string(i));
  }
}

TEST(coordinate_range, what_is_refused_is_refused_at_any_scale) {
  PolygonMesh mesh = shapes::box({1, 1, 1});
  for (Vec3& p : mesh.positions) p.y *= 1e35;
  for (const double scale : {0x1p-500, 1.0, 0x1p600}) {
    const auto error = error_of_run(shapes::scaled(mesh, scale), unrefined());
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->code, Code::kCoordinateRange);
  }
  // Just within the limit, it is not.
  for (Vec3& p : mesh.positions) p.y *= 0x1p99 / 1e35;
  EXPECT_FALSE(error_of_run(mesh, unrefined()).has_value());
}

TEST(coordinate_range, the_error_names_the_vertex_that_lies_far_off) {
  PolygonMesh mesh = shapes::sheet(4, 4, 4, 4);
  mesh.positions[VertexId(12)].x = 1e60;
  const auto error = error_of_run(mesh, unrefined());
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->element, 12u);
  EXPECT_NE(std::string(error->what()).find("1e+60"), std::string::npos) << error->what();
}

}  // namespace
}  // namespace remesh
