#include "core/free_form/coarsen.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/quality.h"
#include "tests/support/free_shapes.h"
#include "tests/support/hausdorff.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

using test::hausdorff_one_way;

/// A surface of triangles within the unit cube around the origin, with its edges.
struct Given {
  IdVector<VertexId, Vec3> positions;
  IdVector<FaceId, Triangle> faces;
  std::vector<std::uint32_t> twins;
  std::vector<FreeForm::Edge> edges;

  FreeForm form() const { return {positions, faces, twins, edges, {}}; }
};

/// Edges that turn by more than the angle are features.
Given given(const PolygonMesh& mesh, double feature_angle_deg = 180) {
  const TriangleMesh triangles = shapes::as_triangles(mesh);
  Given made{triangles.positions, triangles.faces, {}, {}};
  RunControl control;
  const Adjacency adjacency(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  const auto normal = [&](std::uint32_t half_edge) {
    const Triangle& t = made.faces[FaceId(half_edge / 3)];
    return normalized(cross(made.positions[t[1]] - made.positions[t[0]], made.positions[t[2]] - made.positions[t[0]]));
  };
  for (std::uint32_t h = 0; h < mesh.corners.size(); ++h) {
    const std::uint32_t twin = adjacency.twin(h);
    made.twins.push_back(twin);
    const bool is_sharp =
        twin != kNone && dot(normal(h), normal(twin)) < std::cos(feature_angle_deg * std::numbers::pi / 180);
    made.edges.push_back(is_sharp ? FreeForm::Edge::kFeature : FreeForm::Edge::kSmooth);
  }
  return made;
}

Coarsened run(const Given& input, double tolerance, double min_angle_deg = 25, int workers = 1) {
  RunControl control;
  Coarsened made;
  tbb::task_arena(workers).execute([&] {
    made = CoarseSheet(input.form(), {tolerance, min_angle_deg}, control).take_result();
  });
  return made;
}

TriangleMesh mesh_of(const Coarsened& made) { return {made.positions, made.faces, {}}; }

template <class Surface>
std::vector<Corners3> corners_of(const Surface& surface) {
  std::vector<Corners3> corners;
  for (const Triangle& t : surface.faces)
    corners.push_back({surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]});
  return corners;
}

MeshStatistics statistics(const Coarsened& made) {
  RunControl control;
  return measure_surface(mesh_of(made), control);
}

double min_angle(const Coarsened& made) {
  RunControl control;
  double least = 180;
  for (const FaceQuality& face : face_quality(mesh_of(made), control)) least = std::min(least, face.min_angle_deg);
  return least;
}

/// The bumpy ball is convex enough for a bound: an inscribed triangle of side h on a sphere of radius r has depth
/// h^2 / (6 r), and with half of that on each side of the surface, h^2 = 12 r * tolerance.
TEST(coarsen, a_smooth_closed_surface_gets_fewer_good_faces_within_the_tolerance) {
  const Given ball = given(bumpy_ball(4));
  const double tolerance = 0.01;
  const Coarsened made = run(ball, tolerance);
  const double side = std::sqrt(12 * 0.8 * tolerance);
  const double area_of_ball = 4 * std::numbers::pi * 0.8 * 0.8, area_of_face = std::sqrt(3.0) / 4 * side * side;
  EXPECT_LT(static_cast<double>(made.faces.size()), 2.5 * area_of_ball / area_of_face);
  EXPECT_GE(min_angle(made), 25);
  const MeshStatistics now = statistics(made);
  EXPECT_EQ(now.euler, 2);
  EXPECT_TRUE(now.closed);
  EXPECT_EQ(now.components, 1U);
  // Samples steer, so the distance may be larger than the tolerance by some percent.
  const double accuracy = 0.02 * tolerance;
  EXPECT_LT(hausdorff_one_way(corners_of(ball), corners_of(made), accuracy), 1.1 * tolerance);
  EXPECT_LT(hausdorff_one_way(corners_of(made), corners_of(ball), accuracy), 1.1 * tolerance);
}

TEST(coarsen, a_larger_tolerance_gives_fewer_faces) {
  const Given ball = given(bumpy_ball(4));
  std::size_t before = ball.faces.size() + 1;
  for (const double tolerance : {0.0005, 0.002, 0.008, 0.03}) {
    const std::size_t faces = run(ball, tolerance).faces.size();
    EXPECT_LT(faces, before);
    before = faces;
  }
}

/// The outline consists of four hilly sides and four corners.
TEST(coarsen, an_open_outline_stays_within_the_tolerance_and_keeps_its_corners) {
  const Given square = given(hills(24));
  const double tolerance = 0.003;
  const Coarsened made = run(square, tolerance);
  EXPECT_LT(made.faces.size(), square.faces.size() / 2);
  const MeshStatistics now = statistics(made);
  EXPECT_EQ(now.euler, 1);
  EXPECT_EQ(now.components, 1U);
  // All vertices of the outline are vertices of the input, at the same places.
  std::map<std::pair<VertexId, VertexId>, int> edges;
  for (const Triangle& t : made.faces)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  double length = 0;
  for (const auto& [edge, count] : edges) {
    if (count != 1) continue;
    const Vec3 &p = made.positions[edge.first], &q = made.positions[edge.second];
    length += std::hypot(p.x - q.x, p.y - q.y);
    for (const VertexId v : {edge.first, edge.second}) {
      ASSERT_TRUE(made.source[v].is_valid());
      EXPECT_EQ(made.positions[v], square.positions[made.source[v]]);
    }
  }
  // Seen from above, the outline is the square, whose sides are straight. So no corner was cut.
  EXPECT_NEAR(length, 4 * 1.6, tolerance);
  const double accuracy = 0.02 * tolerance;
  EXPECT_LT(hausdorff_one_way(corners_of(square), corners_of(made), accuracy), 1.1 * tolerance);
  EXPECT_LT(hausdorff_one_way(corners_of(made), corners_of(square), accuracy), 1.1 * tolerance);
}

TEST(coarsen, features_stay_where_they_are) {
  const Given box = given(shapes::box({1, 1, 1}, 12), 30);
  const Coarsened made = run(box, 0.05);
  // Each side of a cube needs two triangles.
  EXPECT_GE(made.faces.size(), 12U);
  EXPECT_LT(made.faces.size(), 120U);
  EXPECT_NEAR(*statistics(made).volume, 1, 1e-12);
}

TEST(coarsen, a_short_feature_with_a_loose_end_does_not_stay) {
  const PolygonMesh flat = shapes::sheet(1.6, 1.6, 24, 24);
  Given square = given(flat);
  // Three edges in a row are a short feature in the middle of the square.
  std::vector<std::uint32_t> row;
  for (std::uint32_t h = 0; h < square.twins.size(); ++h) {
    const Triangle& t = square.faces[FaceId(h / 3)];
    const Vec3 &p = square.positions[t[h % 3]], &q = square.positions[t[(h % 3 + 1) % 3]];
    if (std::abs(p.y - 0.8) < 1e-9 && std::abs(q.y - 0.8) < 1e-9 && p.x > 0.75 && p.x < q.x && row.size() < 3)
      row.push_back(h);
  }
  ASSERT_EQ(row.size(), 3U);
  const std::size_t without = run(square, 0.01).faces.size();
  for (const std::uint32_t h : row) square.edges[h] = square.edges[square.twins[h]] = FreeForm::Edge::kBorder;
  const Coarsened with_border = run(square, 0.01);
  EXPECT_EQ(with_border.dropped_features, 0U);
  EXPECT_GT(with_border.faces.size(), without);
  for (const std::uint32_t h : row) square.edges[h] = square.edges[square.twins[h]] = FreeForm::Edge::kFeature;
  const Coarsened made = run(square, 0.01);
  EXPECT_EQ(made.dropped_features, 3U);
  EXPECT_EQ(made.faces.size(), without);
}

/// A sheet that turns by an angle at each of the last lines, which are `apart`.
Given bent_sheet(int lines, double angle_deg, double apart) {
  const int rows = 24, columns = 8;
  PolygonMesh mesh = shapes::sheet(2 * columns + lines - 1, rows, 2 * columns + lines - 1, rows);
  std::vector<Vec3> profile{{-0.6, 0, 0}};
  for (int c = 1; c <= 2 * columns + lines - 1; ++c) {
    const int turns = std::clamp(c - columns, 0, lines);
    const double angle = turns * angle_deg * std::numbers::pi / 180;
    const double width = turns > 0 && turns < lines ? apart : 0.05;
    profile.push_back(profile.back() + width * Vec3{std::cos(angle), 0, std::sin(angle)});
  }
  for (Vec3& p : mesh.positions) {
    const Vec3& at = profile[static_cast<std::size_t>(std::lround(p.x))];
    p = {at.x, 0.05 * p.y - 0.6, at.z};
  }
  return given(mesh, 30);
}

TEST(coarsen, facets_of_a_rounded_edge_are_no_features_if_they_are_narrow) {
  const double tolerance = 0.005;
  const std::uint64_t rows = 24;
  const Given narrow = bent_sheet(3, 35, 2 * tolerance), wide = bent_sheet(3, 35, 12 * tolerance);
  const Coarsened one = run(narrow, tolerance), other = run(wide, tolerance);
  EXPECT_EQ(one.dropped_features, 3 * rows);
  EXPECT_EQ(other.dropped_features, 0U);
  EXPECT_LT(hausdorff_one_way(corners_of(one), corners_of(narrow), 0.02 * tolerance), 1.1 * tolerance);
  EXPECT_LT(hausdorff_one_way(corners_of(narrow), corners_of(one), 0.02 * tolerance), 1.1 * tolerance);
  // Edges that turn by more are no rounded edge, nor is one that is alone.
  EXPECT_EQ(run(bent_sheet(2, 65, 2 * tolerance), tolerance).dropped_features, 0U);
  EXPECT_EQ(run(bent_sheet(1, 35, 2 * tolerance), tolerance).dropped_features, 0U);
  // The rim at its ends is near, but runs across.
  EXPECT_EQ(run(bent_sheet(1, 35, 2 * tolerance), 4 * tolerance).dropped_features, 0U);
  // Where a share of the tolerance counts, it counts for the width as well.
  const std::vector<float> shares(narrow.faces.size(), 0.25F);
  RunControl control;
  const FreeForm form{narrow.positions, narrow.faces, narrow.twins, narrow.edges, shares};
  EXPECT_EQ(CoarseSheet(form, {tolerance, 25}, control).result().dropped_features, 0U);
}

TEST(coarsen, vertices_with_other_than_one_fan_of_faces_stay) {
  const Given pages = given(shapes::three_pages(6));
  const Coarsened made = run(pages, 0.05);
  std::set<Vec3> places(made.positions.begin(), made.positions.end());
  std::map<std::pair<VertexId, VertexId>, int> edges;
  for (const Triangle& t : pages.faces)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  int found = 0;
  for (const auto& [edge, count] : edges) {
    if (count != 3) continue;
    ++found;
    EXPECT_TRUE(places.contains(pages.positions[edge.first]));
    EXPECT_TRUE(places.contains(pages.positions[edge.second]));
  }
  EXPECT_GT(found, 0);
}

TEST(coarsen, a_share_of_the_tolerance_counts_where_it_is_given) {
  const Given ball = given(bumpy_ball(4));
  const double tolerance = 0.01;
  std::vector<float> shares;
  for (const Triangle& t : ball.faces) shares.push_back(ball.positions[t[0]].z > 0.2 ? 0.1F : 1.0F);
  FreeForm form = ball.form();
  form.shares = shares;
  RunControl control;
  const Coarsened made = CoarseSheet(form, {tolerance, 25}, control).take_result();
  std::vector<Corners3> fine;
  for (FaceId f(0); f.value < ball.faces.size(); ++f.value)
    // Samples of edges count for one of the faces there, so the rim of the fine part is left out.
    if (ball.positions[ball.faces[f][0]].z > 0.4) fine.push_back(corners_of(ball)[f.value]);
  EXPECT_LT(hausdorff_one_way(fine, corners_of(made), 0.01 * tolerance), 0.13 * tolerance);
  EXPECT_LT(made.faces.size(), run(ball, 0.1 * tolerance).faces.size());
}

/// Two triangles overlap by the width of a needle between them that is turned over. Flips must not make more of that.
TEST(coarsen, a_needle_that_is_turned_over_folds_no_other_triangle) {
  const Given folded = given(shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 0}, {0.5, 0.8, 0}, {0.8, -0.35, 0}, {0.3, -0.35, 0}, {0.5, -1, 0}},
      {{0, 1, 3}, {1, 0, 2}, {1, 2, 4}, {2, 5, 4}, {2, 0, 5}, {5, 6, 4}, {0, 6, 5}, {4, 6, 1}}));
  const auto overturned = [](const std::vector<Corners3>& triangles) {
    double area = 0;
    for (const Corners3& t : triangles) area += std::max(0.0, -cross(t[1] - t[0], t[2] - t[0]).z);
    return area;
  };
  ASSERT_GT(overturned(corners_of(folded)), 0);
  const std::vector<std::uint8_t> is_held(folded.positions.size(), 1);
  FreeForm form = folded.form();
  form.is_held = is_held;
  RunControl control;
  const Coarsened made = CoarseSheet(form, {0.01, 25}, control).take_result();
  EXPECT_LE(overturned(corners_of(made)), overturned(corners_of(folded)));
}

TEST(coarsen, refining_brings_the_surface_nearer_and_keeps_topology_and_outline) {
  RunControl control;
  for (const Given& input : {given(bumpy_ball(4)), given(hills(24))}) {
    CoarseSheet sheet(input.form(), {0.02, 25}, control);
    const MeshStatistics before = statistics(sheet.result());
    const auto distance = [&] { return test::hausdorff(corners_of(input), corners_of(sheet.result()), 1e-4); };
    const double far = distance();
    // Two rounds make edges half as long, and half an edge has a quarter of the height. There are corners of the
    // input's facets between, so half of the height is asked for.
    for (int round = 0; round < 4; ++round) {
      CoarseningFaults faults;
      for (FaceId f(0); f.value < sheet.result().faces.size(); ++f.value) faults.far_faces.push_back(f);
      const std::size_t faces = sheet.result().faces.size();
      EXPECT_TRUE(sheet.refine(faults, true, control));
      EXPECT_GT(sheet.result().faces.size(), faces + faces / 4);
    }
    EXPECT_LT(distance(), far / 2);
    const MeshStatistics now = statistics(sheet.result());
    EXPECT_EQ(now.euler, before.euler);
    EXPECT_EQ(now.closed, before.closed);
    EXPECT_EQ(now.components, before.components);
    // New vertices of the outline are vertices of the input.
    const Coarsened& made = sheet.result();
    std::map<std::pair<VertexId, VertexId>, int> edges;
    for (const Triangle& t : made.faces)
      for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    const std::set<Vec3> places(input.positions.items().begin(), input.positions.items().end());
    for (const auto& [edge, count] : edges) {
      EXPECT_LE(count, 2);
      if (count == 2) continue;
      EXPECT_TRUE(places.contains(made.positions[edge.first]));
      EXPECT_TRUE(places.contains(made.positions[edge.second]));
    }
  }
}

/// The middle of an edge would not be in a plane beside it, also where two free faces are between.
TEST(coarsen, refining_splits_no_edge_of_the_input_at_a_plane) {
  RunControl control;
  const Given pages = given(shapes::three_pages(6));
  std::vector<std::uint8_t> is_of_plane;
  for (const Triangle& t : pages.faces)
    is_of_plane.push_back(pages.positions[t[0]].y == 0 && pages.positions[t[1]].y == 0 && pages.positions[t[2]].y == 0);
  FreeForm form = pages.form();
  form.is_of_plane = is_of_plane;
  CoarseSheet sheet(form, {0.05, 25}, control);
  const auto spine = [&] {
    std::set<Vec3> places;
    for (const Triangle& t : sheet.result().faces)
      for (const VertexId v : t) {
        const Vec3& p = sheet.result().positions[v];
        if (p.x == 0 && p.y == 0) places.insert(p);
      }
    return places;
  };
  const std::set<Vec3> before = spine();
  EXPECT_EQ(before.size(), 7U);
  for (int round = 0; round < 3; ++round) {
    CoarseningFaults faults;
    for (FaceId f(0); f.value < sheet.result().faces.size(); ++f.value)
      if (is_of_plane[sheet.result().origin[f].value] == 0) faults.far_faces.push_back(f);
    EXPECT_TRUE(sheet.refine(faults, true, control));
  }
  EXPECT_EQ(spine(), before);
}

TEST(coarsen, each_face_knows_the_face_of_the_input_nearest_to_its_centroid) {
  const Given ball = given(bumpy_ball(3));
  const Coarsened made = run(ball, 0.02);
  const std::vector<Corners3> input = corners_of(ball);
  for (FaceId f(0); f.value < made.faces.size(); ++f.value) {
    const Corners3 t = corners_of(made)[f.value];
    const Vec3 centre = (1.0 / 3) * (t[0] + t[1] + t[2]);
    const auto distance = [&](const Corners3& c) { return norm(nearest_on_triangle(centre, c) - centre); };
    double least = HUGE_VAL;
    for (const Corners3& c : input) least = std::min(least, distance(c));
    EXPECT_NEAR(distance(input[made.nearest[f].value]), least, 1e-12);
  }
  // The centroid of each face of the input is a sample, so some face answers for it.
  ASSERT_EQ(made.answers.size(), input.size());
  for (FaceId f(0); f.value < input.size(); ++f.value) {
    EXPECT_LT(made.answers[f], FaceId(made.faces.size()));
  }
}

TEST(coarsen, the_result_does_not_depend_on_workers_scale_or_numbering) {
  // This is enough for two parts.
  const PolygonMesh large_square = hills(90);
  const Coarsened made = run(given(large_square), 0.01);
  for (const int workers : {2, 8}) {
    const Coarsened again = run(given(large_square), 0.01, 25, workers);
    EXPECT_EQ(again.positions, made.positions);
    EXPECT_EQ(again.faces, made.faces);
    EXPECT_EQ(again.nearest, made.nearest);
  }
  const Coarsened small = run(given(shapes::scaled(bumpy_ball(4), 0.25)), 0.002 * 0.25);
  const Coarsened large = run(given(bumpy_ball(4)), 0.002);
  EXPECT_EQ(small.faces, large.faces);
  for (VertexId v(0); v.value < small.positions.size(); ++v.value)
    EXPECT_EQ(4.0 * small.positions[v], large.positions[v]);
  const Coarsened renumbered = run(given(shapes::renumbered(bumpy_ball(4), 5)), 0.002);
  EXPECT_EQ(renumbered.positions, large.positions);
  EXPECT_EQ(renumbered.faces, large.faces);
}

TEST(coarsen, it_stops_soon) {
  const Given ball = given(bumpy_ball(6));
  const auto seconds = test::time_to_stop(test::Seconds(0.1), [&](RunControl& control) {
    CoarseSheet(ball.form(), {0.001, 25}, control);
  });
  if (seconds) {
    EXPECT_LT(seconds->count(), 0.1);
  }
}

}  // namespace
}  // namespace remesh
