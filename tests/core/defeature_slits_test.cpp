// Tests that slits narrower than defeature_size are closed, and that other gaps and notches stay as they are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/distances.h"
#include "core/geometry/self_intersections.h"
#include "core/remesh.h"
#include "tests/support/hausdorff.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Shape = std::function<double(double)>;

/// A gap in a plate of 1 by 1: between two curves over x, from one x to another.
struct Gap {
  double begin, end;
  Shape low, high;
  /// The two curves need not have the same corners.
  std::vector<double> low_corners, high_corners;
};

/// The part of a plate between two curves with these corners. Its faces are triangles.
void add_band(std::vector<Vec3>& positions, std::vector<std::vector<std::uint32_t>>& faces, std::vector<Vec2> low,
              std::vector<Vec2> high, const std::function<double(Vec2)>& height) {
  const auto add = [&](Vec2 p) {
    positions.push_back({p.x, p.y, height(p)});
    return static_cast<std::uint32_t>(positions.size() - 1);
  };
  std::size_t i = 0, j = 0;
  std::uint32_t a = add(low[0]), b = low[0] == high[0] ? a : add(high[0]);
  while (i + 1 < low.size() || j + 1 < high.size()) {
    const bool is_low = j + 1 == high.size() || (i + 1 < low.size() && low[i + 1].x <= high[j + 1].x);
    const std::uint32_t next = add(is_low ? low[++i] : high[++j]);
    if (a != b) faces.push_back({a, next, b});
    (is_low ? a : b) = next;
  }
}

/// Makes the plate with a gap. Equal places are welded when it is read.
PolygonMesh plate_with(
    const Gap& gap, const std::function<double(Vec2)>& height = [](Vec2) { return 0.0; }) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto points = [](std::vector<double> corners, const Shape& curve) {
    std::vector<Vec2> result;
    for (const double x : corners) result.push_back({x, curve(x)});
    return result;
  };
  const auto level = [](double y) { return [y](double) { return y; }; };
  const auto band = [&](const std::vector<Vec2>& low, const std::vector<Vec2>& high) {
    add_band(positions, faces, low, high, height);
  };
  const double left_low = gap.low(gap.begin), left_high = gap.high(gap.begin);
  const double right_low = gap.low(gap.end), right_high = gap.high(gap.end);
  const std::vector<double> left{0, gap.begin}, right{gap.end, 1};
  band(points(left, level(0)), points(left, level(left_low)));
  if (left_low < left_high) band(points(left, level(left_low)), points(left, level(left_high)));
  band(points(left, level(left_high)), points(left, level(1)));
  band(points(gap.low_corners, level(0)), points(gap.low_corners, gap.low));
  band(points(gap.high_corners, gap.high), points(gap.high_corners, level(1)));
  if (gap.end < 1) {
    band(points(right, level(0)), points(right, level(right_low)));
    if (right_low < right_high) band(points(right, level(right_low)), points(right, level(right_high)));
    band(points(right, level(right_high)), points(right, level(1)));
  }
  return shapes::from_lists(positions, faces);
}

std::vector<double> even(double begin, double end, int parts) {
  std::vector<double> x;
  for (int i = 0; i <= parts; ++i) x.push_back(i == parts ? end : begin + (end - begin) * i / parts);
  return x;
}

/// Counts the loops of edges that only one face has. Vertices are told apart by place.
int count_rims(const TriangleMesh& mesh) {
  std::map<std::pair<Vec3, Vec3>, int> uses;
  for (const Triangle& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  std::map<Vec3, std::vector<Vec3>> next;
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    next[edge.first].push_back(edge.second);
    next[edge.second].push_back(edge.first);
  }
  int rims = 0;
  while (!next.empty()) {
    ++rims;
    std::vector<Vec3> reached{next.begin()->first};
    while (!reached.empty()) {
      const auto at = next.find(reached.back());
      reached.pop_back();
      if (at == next.end()) continue;
      reached.insert(reached.end(), at->second.begin(), at->second.end());
      next.erase(at);
    }
  }
  return rims;
}

std::vector<Corners3> corners_of(const TriangleMesh& mesh) {
  std::vector<Corners3> corners;
  for (const Triangle& t : mesh.faces)
    corners.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  return corners;
}

const Diagnostic* removal(const Report& report) {
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kRemovedDetail) return &d;
  return nullptr;
}

Result without_details(const PolygonMesh& mesh, double size) {
  Options options;
  options.defeature_size = size;
  return refined(mesh, options);
}

void expect_sound(const PolygonMesh& mesh, double size, const Result& result, const std::string& what) {
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true()) << what;
  ASSERT_TRUE(report.distance_bound) << what;
  const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
  EXPECT_LE(bound, size * (1 + 1e-9)) << what;
  // For shorter distances, the search takes minutes.
  if (size >= 1e-2) {
    EXPECT_LE(test::hausdorff(corners_of(shapes::triangles(mesh)), corners_of(result.mesh), size / 5),
              bound * (1 + 1e-9) + 1e-14)
        << what;
  }
  RunControl control;
  EXPECT_TRUE(
      self_intersections(result.mesh.positions.items(), result.mesh.faces.items(), {}, SearchLimits(1000), control)
          .pairs.empty())
      << what;
}

void expect_closed(const PolygonMesh& mesh, double width, double length, const std::string& what) {
  const double size = 2 * width;
  const Result kept = without_details(mesh, 0);
  const Result gone = without_details(mesh, size);
  expect_sound(mesh, size, gone, what);
  EXPECT_EQ(count_rims(gone.mesh), 1) << what;
  const Diagnostic* const told = removal(gone.report);
  ASSERT_NE(told, nullptr) << what;
  EXPECT_NE(told->message.find(" slit"), std::string::npos) << what << ": " << told->message;
  EXPECT_FALSE(told->elements.empty()) << what;
  // The sides of the gap meet between them.
  EXPECT_GE(gone.report.output.area, kept.report.output.area - size * length) << what;
  EXPECT_LE(gone.report.output.area, kept.report.output.area + size * length) << what;
  EXPECT_GT(shortest_edge(gone.mesh), size / 3) << what;
}

TEST(defeature_slits, a_slit_with_square_ends_is_closed) {
  for (const double width : {1e-2, 1e-3}) {
    for (const int low : {1, 3, 16})
      for (const int high : {1, 5}) {
        const Gap gap{0.3,
                      0.7,
                      [](double) { return 0.5; },
                      [=](double) { return 0.5 + width; },
                      even(0.3, 0.7, low),
                      even(0.3, 0.7, high)};
        expect_closed(plate_with(gap), width, 0.4, "square ends, " + std::to_string(low) + ", " + std::to_string(high));
      }
  }
}

/// A gap with a tip at both ends, along a wave.
Gap lens(double width, int low, int high) {
  const auto wave = [](double x) { return 0.5 + 0.03 * std::sin(8 * x); };
  const auto bulge = [=](double x) { return width * std::max(0.0, std::sin((x - 0.2) / 0.6 * std::numbers::pi)); };
  return {0.2,
          0.8,
          [=](double x) { return wave(x) - bulge(x) / 2; },
          [=](double x) { return wave(x) + bulge(x) / 2; },
          even(0.2, 0.8, low),
          even(0.2, 0.8, high)};
}

TEST(defeature_slits, a_lens_along_a_wave_is_closed) {
  struct Case {
    double width;
    int low, high;
  };
  for (const Case& c : {Case{1e-2, 12, 12}, {1e-2, 12, 24}, {1e-3, 24, 24}, {1e-3, 96, 48}, {1e-3, 32, 96}})
    expect_closed(plate_with(lens(c.width, c.low, c.high)), c.width, 0.8,
                  "lens of " + std::to_string(c.low) + " and " + std::to_string(c.high));
}

TEST(defeature_slits, a_slit_over_a_crease_is_closed) {
  // The plate is folded along the line where x is 0.5.
  const auto roof = [](Vec2 p) { return -0.4 * std::fabs(p.x - 0.5); };
  const double width = 2e-3;
  const Gap gap{
      0.3, 0.7, [](double) { return 0.5; }, [=](double) { return 0.5 + width; }, even(0.3, 0.7, 2), even(0.3, 0.7, 4)};
  PolygonMesh mesh = plate_with(gap, roof);
  const Result gone = without_details(mesh, 2 * width);
  EXPECT_TRUE(gone.report.verified.all_true());
  EXPECT_EQ(count_rims(gone.mesh), 1);
}

TEST(defeature_slits, a_slit_from_the_rim_is_closed) {
  for (const double width : {1e-2, 1e-3})
    for (const int parts : {1, 7}) {
      const Gap gap{0.4,
                    1,
                    [](double) { return 0.5; },
                    [=](double) { return 0.5 + width; },
                    even(0.4, 1, parts),
                    even(0.4, 1, 3)};
      const PolygonMesh mesh = plate_with(gap);
      const Result kept = without_details(mesh, 0), gone = without_details(mesh, 2 * width);
      expect_sound(mesh, 2 * width, gone, "from the rim");
      EXPECT_EQ(count_rims(gone.mesh), 1);
      // Along both sides of the slit, edges are open.
      EXPECT_NEAR(kept.report.output.area + 0.6 * width, 1, 1e-9);
      EXPECT_NEAR(gone.report.output.area, 1, 2 * width);
      EXPECT_GT(shortest_edge(gone.mesh), 2 * width / 3);
      double in_slit = 0;
      for (const Vec3& p : gone.mesh.positions)
        if (std::fabs(p.y - 0.5) <= 2 * width && p.x < 0.99) in_slit += 1;
      EXPECT_LT(in_slit, 8) << "nothing is left of the slit but a few of its corners";
    }
}

TEST(defeature_slits, wide_gaps_and_notches_stay) {
  const double size = 5e-3;
  const Gap wide{0.3,
                 0.7,
                 [](double) { return 0.5; },
                 [=](double) { return 0.5 + 2 * size; },
                 even(0.3, 0.7, 4),
                 even(0.3, 0.7, 4)};
  // It is narrow at first.
  const Gap wedge{0.2,
                  1,
                  [](double) { return 0.5; },
                  [](double x) { return 0.5 + 0.1 * (x - 0.2); },
                  even(0.2, 1, 40),
                  even(0.2, 1, 40)};
  // Both ends are narrow, and the middle is wide.
  const Gap eye = lens(3 * size, 24, 24);
  for (const auto& [gap, rims] : {std::pair{wide, 2}, {wedge, 1}, {eye, 2}}) {
    const PolygonMesh mesh = plate_with(gap);
    const Result result = without_details(mesh, size);
    expect_sound(mesh, size, result, std::to_string(rims));
    EXPECT_EQ(count_rims(result.mesh), rims);
    const Diagnostic* const told = removal(result.report);
    EXPECT_TRUE(told == nullptr || told->message.find(" slit") == std::string::npos);
    EXPECT_NEAR(result.report.output.area, without_details(mesh, 0).report.output.area, 1e-3 * size);
  }
}

TEST(defeature_slits, defaults_close_none) {
  const PolygonMesh mesh = plate_with(lens(1e-6, 24, 24));
  const Result result = refined(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(count_rims(result.mesh), 2);
}

TEST(defeature_slits, the_order_of_faces_and_vertices_changes_nothing) {
  const PolygonMesh mesh = plate_with(lens(5e-3, 24, 48));
  const auto places = [](const Result& result) {
    std::vector<std::array<Vec3, 3>> faces;
    for (const Triangle& t : result.mesh.faces) {
      faces.push_back({result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]});
      std::rotate(faces.back().begin(), std::min_element(faces.back().begin(), faces.back().end()), faces.back().end());
    }
    std::sort(faces.begin(), faces.end());
    return faces;
  };
  const auto first = places(without_details(mesh, 0.01));
  for (const unsigned seed : {1u, 2u, 3u})
    EXPECT_EQ(places(without_details(shapes::renumbered(mesh, seed), 0.01)), first);
}

}  // namespace
}  // namespace remesh
