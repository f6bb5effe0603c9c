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

  static Report analyzed(const char* name, Format format, const Options& options) {
    std::ifstream file(folder() / name, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    RunControl control;
    return analyze_surface(read_mesh(format, text, {}, control).mesh, options, {}, control);
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

TEST_F(report_files, facets_that_meet_at_an_edge_are_no_gap) {
  for (const double proximity : {0.25, 1.0}) {
    Options options;
    options.proximity = proximity;
    const Report report = remeshed("wedge.stl", Format::kStl, options);
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_LE(report.output.faces, 50u);
  }
}

TEST_F(report_files, needles_beside_a_bore_do_not_make_a_result_out_of_proportion) {
  const std::uint64_t triangles = 160;
  Options options;
  options.elements_per_circle = 16;
  EXPECT_LE(remeshed("needle-with-bore.stl", Format::kStl, options).output.faces, 20 * triangles + 1'000);
  options.proximity = 0.25;
  const Report report = remeshed("needle-with-bore.stl", Format::kStl, options);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_LE(report.output.faces, 1'000u);
  EXPECT_GT(report.min_edge_length, 0);
}

TEST_F(report_files, a_pin_that_crosses_its_bore_asks_for_few_faces) {
  Options options;
  options.proximity = 0.25;
  for (const bool has_circles : {false, true}) {
    if (has_circles) options.elements_per_circle = 16;
    const Report report = remeshed("pin-in-bore.obj", Format::kObj, options);
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_LE(report.output.faces, 1'000u);
  }
}

TEST_F(report_files, a_thin_pipe_is_predicted_as_it_comes_out) {
  Options options;
  options.elements_per_circle = 16;
  const Report made = remeshed("thin-pipe.stl", Format::kStl, options);
  const auto is_near = [&](std::uint64_t predicted) {
    return predicted <= 2 * made.output.faces && made.output.faces <= 2 * predicted;
  };
  EXPECT_TRUE(is_near(made.predicted_faces)) << made.predicted_faces << " " << made.output.faces;
  // The rims keep their 48 pieces, and the walls are too thin for fewer. So all numbers give about the same.
  const Report report = analyzed("thin-pipe.stl", Format::kStl, {});
  ASSERT_EQ(report.predicted_faces_by_elements_per_circle.size(), 5u);
  for (const auto& [elements, predicted] : report.predicted_faces_by_elements_per_circle)
    EXPECT_TRUE(is_near(predicted)) << elements << ": " << predicted << " " << made.output.faces;
}

}  // namespace
}  // namespace remesh
