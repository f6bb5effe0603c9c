// Tests small files that were made after reports of faults. Each expected result is what geometry says, not what a
// program gave before.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

class report_files : public testing::Test {
 protected:
  void SetUp() override { test::has_shared_mesh("reports"); }

  static Report remeshed(const char* name, Format format, const Options& options = unrefined()) {
    std::ifstream file(folder() / name, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    RunControl control;
    return remesh_surface(read_mesh(format, text, {}, control).mesh, options, {}, control).report;
  }

  static std::uint64_t listed(const Report& report) {
    std::uint64_t count = 0;
    for (const Unrefined& left : report.unrefined) count += left.count;
    return count;
  }

 private:
  static std::filesystem::path folder() { return test::shared_meshes_folder() / "reports"; }
};

TEST_F(report_files, the_crown_of_a_plate_stays) {
  // A plate of 200 x 100 x 10 with a roof that is 0.01 high over its long middle line: 200 * 100 * 0.01 / 2 more.
  const Report report = remeshed("crowned-plate.obj", Format::kObj);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(report.patches.size(), 7u);
  EXPECT_NEAR(report.output.volume.value_or(0), 200 * 100 * 10 + 100, 1e-6);
}

TEST_F(report_files, the_bump_of_an_edge_stays) {
  const Report report = remeshed("bumped-edge.obj", Format::kObj);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(report.output.faces, 4u);
  EXPECT_LE(report.rounding_step, 0.005);
}

TEST_F(report_files, text_stl_with_words_apart_is_the_box_that_it_tells_of) {
  for (const char* name : {"end-loop.stl", "end-solid.stl"}) {
    SCOPED_TRACE(name);
    const Report report = remeshed(name, Format::kStl);
    EXPECT_TRUE(report.output.closed);
    EXPECT_EQ(report.output.faces, 12u);
    EXPECT_NEAR(report.output.volume.value_or(0), 6000, 1e-9);
  }
}

/// Counts the surfaces of a kind.
std::ptrdiff_t count_of(const Report& report, SurfaceKind kind) {
  return std::count_if(report.surfaces.surfaces.begin(), report.surfaces.surfaces.end(),
                       [&](const RecognisedSurface& s) { return s.shape.kind == kind; });
}

Options sixteen_elements() {
  Options options;
  options.elements_per_circle = 16;
  return options;
}

TEST_F(report_files, a_bore_with_three_decimals_is_a_cylinder) {
  const Report report = remeshed("bore-as-sphere.obj", Format::kObj, sixteen_elements());
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(count_of(report, SurfaceKind::kPlane), 6);
  EXPECT_EQ(count_of(report, SurfaceKind::kCylinder), 1);
  EXPECT_EQ(report.surfaces.surfaces.size(), 7u);
  // A plate of 30 x 30 x 6 without a prism of 16 sides in a circle of radius 5: 16 / 2 * 25 * sin(22.5 degrees) * 6.
  EXPECT_NEAR(report.output.volume.value_or(0), 5400 - 459.22, 1);
  EXPECT_LE(report.distance_bound->output_to_input, 0.2);
}

TEST_F(report_files, round_corners_with_six_digits_far_from_the_origin_are_cylinders) {
  const Report report = remeshed("rounded-plate-6-digits.obj", Format::kObj);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(count_of(report, SurfaceKind::kPlane), 6);
  EXPECT_EQ(count_of(report, SurfaceKind::kCylinder), 4);
  EXPECT_EQ(report.surfaces.surfaces.size(), 10u);
}

TEST_F(report_files, the_rings_of_a_hose_are_no_spheres) {
  const Report report = remeshed("hose.obj", Format::kObj, sixteen_elements());
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(count_of(report, SurfaceKind::kSphere), 0);
  EXPECT_NEAR(report.output.volume.value_or(0), 582.785, 0.001);
}

TEST_F(report_files, a_torus_that_crosses_its_axis_is_remeshed) {
  // A shaft of radius 10 with an end that is rounded by 6. The middle of the tube is only 4 away from the axis.
  const Report report = remeshed("round-end.stl", Format::kStl, sixteen_elements());
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_EQ(count_of(report, SurfaceKind::kTorus), 1);
  for (const RecognisedSurface& s : report.surfaces.surfaces) {
    if (s.shape.kind == SurfaceKind::kTorus) {
      EXPECT_GT(s.bound, 0);
    }
  }
  EXPECT_LE(report.output.faces, 400u);
}

TEST_F(report_files, thin_sheets_and_wedges_list_what_gaps_ask_for_in_vain) {
  // The gaps ask for more triangles than the budget allows. Thus nearly all triangles are too large, and all of those
  // must be listed.
  for (const char* name : {"sheet-metal.stl", "tetgen-knife.obj"}) {
    SCOPED_TRACE(name);
    Options options;
    options.proximity = 1;
    options.max_output_faces = 5'000;
    const Report report = remeshed(name, std::string(name).ends_with(".stl") ? Format::kStl : Format::kObj, options);
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_GT(2 * listed(report), report.output.faces);
  }
}

}  // namespace
}  // namespace remesh
