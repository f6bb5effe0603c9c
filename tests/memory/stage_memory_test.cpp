/// Tests that no stage holds more memory than its row of the table of bounds, on small and larger surfaces of all
/// kinds.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/memory/counted_memory.h"
#include "tests/support/hostile_families.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

struct Made {
  std::string name;
  PolygonMesh mesh;
};

/// Returns the default options for a surface of this many faces. The limit is so low that the bounds are near.
Options plain(std::size_t faces) {
  Options options;
  options.max_output_faces = 4 * faces + 1000;
  return options;
}

Options close_ups() {
  Options options;
  options.proximity = 1;
  options.min_angle_deg = 20;
  options.max_output_faces = 20'000;
  return options;
}

Options round_ups() {
  Options options;
  options.elements_per_circle = 16;
  options.max_output_faces = 100'000;
  return options;
}

/// Boxes around boxes, so that each is inside all larger ones.
PolygonMesh nested_boxes(int count) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  const PolygonMesh box = shapes::quad_box({1, 1, 1});
  for (int i = 1; i <= count; ++i) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& p : box.positions) positions.push_back(static_cast<double>(i) * (p - Vec3{0.5, 0.5, 0.5}));
    for (FaceId f(0); f.value < box.face_count(); ++f.value) {
      faces.emplace_back();
      for (const VertexId v : box.face(f)) faces.back().push_back(first + v.value);
    }
  }
  return shapes::from_lists(positions, faces);
}

std::vector<Made> hostile_surfaces(std::size_t size) {
  std::vector<Made> made;
  for (const hostile::Family& family : hostile::families())
    made.push_back({std::string(family.name) + " of " + std::to_string(size), family.make(size)});
  return made;
}

std::vector<Made> usual_surfaces(int n) {
  const std::string of_size = " of " + std::to_string(n);
  return {{"box" + of_size, shapes::box({1, 2, 3}, n)},
          {"sheet" + of_size, shapes::sheet(2, 1, 4 * n, 4 * n)},
          {"noisy sheet" + of_size, shapes::noisy_sheet(2 * n, 7)},
          {"cylinder" + of_size, shapes::cylinder(20 * n, 1, 2)},
          {"plate with a round hole" + of_size, shapes::plate_with_round_hole(20 * n)},
          {"nested boxes" + of_size, nested_boxes(8 * n)},
          {"slotted plate" + of_size, shapes::slotted_plate(n)}};
}

/// Runs the pipeline on surfaces, and holds the memory of each stage against its bound.
class stage_memory : public ::testing::Test {
 protected:
  void expect_within_bounds(const std::vector<Made>& surfaces, const Options& options, int workers = 1) {
    for (const Made& made : surfaces) {
      RunControl control;
      const memory::CountedMemory counted(control);
      try {
        remesh_surface(made.mesh, options, {.workers = workers}, control);
      } catch (const Error& error) {
        // The result may be too large. What was held before counts.
        EXPECT_EQ(error.code, Code::kOutputTooLarge) << made.name << ": " << error.what();
      }
      const memory::StagePeaks peaks = counted.peaks();
      for (std::size_t s = 0; s < peaks.size(); ++s) {
        const auto stage = static_cast<Stage>(s);
        EXPECT_LE(peaks[s].held, peaks[s].allowed) << made.name << " in " << stage_name(stage);
        if (peaks[s].share() > largest_[s]) {
          largest_[s] = peaks[s].share();
          where_[s] = made.name;
        }
      }
    }
  }

  void TearDown() override {
    for (std::size_t s = 0; s < largest_.size(); ++s)
      if (largest_[s] > 0)
        std::printf("  %-20s %3.0f %% of its bound, by %s\n", std::string(stage_name(static_cast<Stage>(s))).c_str(),
                    100 * largest_[s], where_[s].c_str());
  }

  std::array<double, kStageCount> largest_{};
  std::array<std::string, kStageCount> where_;
};

TEST_F(stage_memory, usual_surfaces_keep_to_the_bounds) {
  for (const int n : {1, 4, unless_sanitized(16, 6)})
    for (const Options& options : {Options{}, close_ups(), round_ups()})
      expect_within_bounds(usual_surfaces(n), options);
}

TEST_F(stage_memory, hostile_surfaces_keep_to_the_bounds) {
  for (const std::size_t size : {std::size_t{30}, std::size_t{300}, unless_sanitized<std::size_t>(5000, 600)})
    expect_within_bounds(hostile_surfaces(size), plain(size));
  if (kIsSanitized) return;
  // The bounds are not so wide that nothing could ever pass them.
  for (const Stage stage : {Stage::kWeld, Stage::kSurfaces, Stage::kTriangulation, Stage::kRefinement, Stage::kVerify})
    EXPECT_GT(largest_[static_cast<std::size_t>(stage)], 0.2) << stage_name(stage);
}

TEST_F(stage_memory, hostile_surfaces_keep_to_the_bounds_with_gaps_and_circles) {
  for (const Options& options : {close_ups(), round_ups()}) expect_within_bounds(hostile_surfaces(30), options);
}

TEST_F(stage_memory, cuts_beyond_the_faces_allowed_are_not_stored) {
  // The gaps between these sheets ask for some 2,000 cuts of each of their segments.
  expect_within_bounds({{"stack", hostile::family("straight_stack").make(unless_sanitized<std::size_t>(1200, 600))}},
                       close_ups());
}

TEST_F(stage_memory, the_removal_of_details_keeps_to_the_bound_of_mending) {
  for (const int n : {4, unless_sanitized(24, 8)}) {
    // Each face of the sphere is about as large as a detail, and so is each cube.
    const int levels = n > 4 ? 5 : 3;
    PolygonMesh cubes = shapes::box({1, 1, 1});
    for (int i = 0; i < n * n; ++i)
      cubes = shapes::joined(cubes, shapes::moved(shapes::scaled(shapes::box({1, 1, 1}), 0.1 / n),
                                                  {(i % n + 0.5) / n, (i / n + 0.5) / n, 1 + 0.1 / n}));
    for (const double size : {0.7, 0.9, 1.2}) {
      Options options;
      options.defeature_size = size * std::numbers::pi / (2 << levels);
      expect_within_bounds({{"sphere of " + std::to_string(levels) + " levels", shapes::sphere(levels)}}, options);
      options.defeature_size = size * 0.2 / n;
      expect_within_bounds({{std::to_string(n * n) + " cubes on a cube", cubes}}, options);
    }
  }
}

TEST_F(stage_memory, several_threads_hold_no_more) {
  expect_within_bounds(hostile_surfaces(unless_sanitized<std::size_t>(1000, 200)), plain(1000), 2);
}

}  // namespace
}  // namespace remesh
