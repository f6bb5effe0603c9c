#include "core/geometry/intersections/self_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/triangles/triangle_intersection.h"
#include "core/io/obj/obj.h"
#include "core/verify/model/fixed_width_integers.h"
#include "tests/support/cgal_space.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/time_limit.h"

namespace remesh {
namespace {

namespace fs = std::filesystem;

using Pairs = std::vector<std::pair<FaceId, FaceId>>;

constexpr std::size_t kNoLimit = std::size_t{1} << 32;

SelfIntersections find(const TriangleMesh& mesh, const std::vector<std::uint32_t>& pieces = {},
                       std::size_t max_pairs = kNoLimit) {
  RunControl control;
  return self_intersections(mesh.positions.items(), mesh.faces.items(), pieces, max_pairs, control);
}

/// Makes random triangles over the points of a grid of n^3. Now and then a corner is repeated.
TriangleMesh soup(std::uint64_t seed, int n, int faces) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < n * n * n; ++i) mesh.positions.push_back({1.0 * (i % n), 1.0 * (i / n % n), 1.0 * (i / n / n)});
  for (int i = 0; i < faces; ++i) {
    const VertexId a(random.below(n * n * n)), b(random.below(n * n * n));
    mesh.faces.push_back({a, b, VertexId(random.below(n * n * n))});
  }
  return mesh;
}

/// Makes small triangles at whole places of [0, n)^3. They are many faces that meet few others.
TriangleMesh crumbs(std::uint64_t seed, int n, int faces) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < faces; ++i) {
    const Vec3 at{1.0 * random.below(n), 1.0 * random.below(n), 1.0 * random.below(n)};
    Triangle face;
    for (VertexId& v : face) v = mesh.positions.push_back(at + Vec3{random.unit(), random.unit(), random.unit()});
    mesh.faces.push_back(face);
  }
  return mesh;
}

TEST(self_intersections, all_pairs_of_a_soup_are_those_of_the_oracle) {
  for (int seed = 0; seed < 3; ++seed) {
    const TriangleMesh mesh = soup(seed, 5, 120);
    const CgalIntersection oracle(mesh.positions.items());
    Pairs expected;
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
      for (std::uint32_t g = f + 1; g < mesh.faces.size(); ++g)
        if (oracle(mesh.faces[FaceId(f)], mesh.faces[FaceId(g)])) expected.emplace_back(FaceId(f), FaceId(g));
    ASSERT_GT(expected.size(), 500);
    const SelfIntersections found = find(mesh);
    EXPECT_EQ(found.pairs, expected);
    EXPECT_TRUE(found.is_complete);
  }
}

TEST(self_intersections, faces_of_one_piece_are_not_compared) {
  const TriangleMesh mesh = crumbs(1, 10, 5000);
  const Pairs all = find(mesh).pairs;
  ASSERT_GT(all.size(), 100);
  for (const int count : {1, 2, 100}) {
    Random random(2);
    std::vector<std::uint32_t> pieces(mesh.faces.size());
    for (std::uint32_t& piece : pieces) {
      piece = static_cast<std::uint32_t>(random.below(count));
      if (random.chance(0.2)) piece = kNoPiece;
    }
    Pairs expected;
    std::copy_if(all.begin(), all.end(), std::back_inserter(expected), [&](const auto& pair) {
      const std::uint32_t p = pieces[pair.first.value], q = pieces[pair.second.value];
      return p != q || p == kNoPiece;
    });
    EXPECT_LT(expected.size(), all.size());
    EXPECT_EQ(find(mesh, pieces).pairs, expected);
  }
}

/// Makes a fan of n needles around the origin. Its spokes have length one and go up and down in turn. Every `odd`th
/// needle reaches over the next two and crosses one of them.
TriangleMesh fan(int n, int odd) {
  TriangleMesh mesh;
  mesh.positions.push_back({});
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n, height = 0.1 * (i % 2);
    mesh.positions.push_back({std::cos(angle), std::sin(angle), height});
  }
  for (int i = 0; i < n; ++i) {
    const int reach = i % odd == 0 ? 3 : 1;
    mesh.faces.push_back({VertexId(0), VertexId(1 + i), VertexId(1 + (i + reach) % n)});
  }
  return mesh;
}

TEST(self_intersections, around_a_vertex_of_very_many_faces_the_pairs_are_those_of_the_oracle) {
  const TriangleMesh mesh = fan(200, 7);
  const CgalIntersection oracle(mesh.positions.items());
  Pairs expected;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::uint32_t g = f + 1; g < mesh.faces.size(); ++g)
      if (oracle(mesh.faces[FaceId(f)], mesh.faces[FaceId(g)])) expected.emplace_back(FaceId(f), FaceId(g));
  ASSERT_GT(expected.size(), 20);
  EXPECT_EQ(find(mesh).pairs, expected);
}

TEST(self_intersections, several_vertices_of_very_many_faces_count_each_pair_once) {
  // All faces have one of three corners, many have two of them.
  Random random(3);
  TriangleMesh mesh;
  for (int i = 0; i < 200; ++i) mesh.positions.push_back({random.unit(), random.unit(), random.unit()});
  constexpr int kFaces = 300;  // the oracle takes all pairs
  for (int i = 0; i < kFaces; ++i)
    mesh.faces.push_back(
        {VertexId(i % 3), VertexId(random.below(2) ? 3 + i % 197 : (i + 1) % 3), VertexId(3 + (7 * i + 1) % 197)});
  const CgalIntersection oracle(mesh.positions.items());
  Pairs expected;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::uint32_t g = f + 1; g < mesh.faces.size(); ++g)
      if (oracle(mesh.faces[FaceId(f)], mesh.faces[FaceId(g)])) expected.emplace_back(FaceId(f), FaceId(g));
  EXPECT_EQ(find(mesh).pairs, expected);
}

Pairs all_pairs(const TriangleMesh& mesh) {
  const std::vector<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
  Pairs pairs;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::uint32_t g = f + 1; g < mesh.faces.size(); ++g)
      if (do_intersect(mesh.faces[FaceId(f)], mesh.faces[FaceId(g)], positions))
        pairs.emplace_back(FaceId(f), FaceId(g));
  return pairs;
}

Vec3 on_circle(double turns, double z) { return {std::cos(2 * M_PI * turns), std::sin(2 * M_PI * turns), z}; }

/// Makes needles whose boxes all meet, because they lie side by side and askew to the axes.
TriangleMesh needles(int n) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    const double t = 1.0 * i / n;
    const auto a = mesh.positions.push_back({t, -t, 0}), b = mesh.positions.push_back({1 + t, 1 - t, 1});
    mesh.faces.push_back({a, b, mesh.positions.push_back({1 + t + 0.1 / n, 1 - t, 1})});
  }
  return mesh;
}

/// Makes two cones of n needles each on one circle.
TriangleMesh double_cone(int n) {
  TriangleMesh mesh;
  const auto top = mesh.positions.push_back({0, 0, 1}), bottom = mesh.positions.push_back({0, 0, -1});
  for (int i = 0; i < n; ++i) mesh.positions.push_back(on_circle(1.0 * i / n, 0));
  for (int i = 0; i < n; ++i) {
    const VertexId a(2 + i), b(2 + (i + 1) % n);
    mesh.faces.push_back({top, a, b});
    mesh.faces.push_back({bottom, b, a});
  }
  return mesh;
}

/// Makes the surface that a straight line sweeps between two circles that are turned against each other. All needles
/// cross over near the waist.
TriangleMesh waisted_tube(int n) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) mesh.positions.push_back(on_circle(1.0 * i / n, -1));
  for (int i = 0; i < n; ++i) mesh.positions.push_back(on_circle(1.0 * i / n + 0.4, 1));
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.faces.push_back({VertexId(i), VertexId(next), VertexId(n + i)});
    mesh.faces.push_back({VertexId(next), VertexId(n + next), VertexId(n + i)});
  }
  return mesh;
}

/// Makes a book of n pages around the edge from the origin to (0, 0, 1). A page is one triangle, or two if
/// it is a square.
TriangleMesh book(int n, bool are_squares) {
  TriangleMesh mesh;
  const auto from = mesh.positions.push_back({0, 0, 0}), to = mesh.positions.push_back({0, 0, 1});
  for (int i = 0; i < n; ++i) {
    const auto a = mesh.positions.push_back(on_circle(1.0 * i / n, are_squares ? 0 : 0.5));
    if (!are_squares) {
      mesh.faces.push_back({from, to, a});
      continue;
    }
    // The squares are cut by turns along one diagonal and the other, so that triangles with one end of the edge lie
    // side by side with others.
    const auto b = mesh.positions.push_back(on_circle(1.0 * i / n, 1));
    mesh.faces.push_back({from, a, i % 2 ? b : to});
    mesh.faces.push_back({i % 2 ? from : a, b, to});
  }
  return mesh;
}

/// Makes n closed wedges around the edge from the origin to (0, 0, 1).
TriangleMesh wedges(int n) {
  TriangleMesh mesh = book(2 * n, true);
  for (int i = 0; i < n; ++i) {
    const VertexId a(2 + 4 * i), b(3 + 4 * i), c(4 + 4 * i), d(5 + 4 * i);
    for (const Triangle& face : {Triangle{VertexId(0), c, a}, {VertexId(1), b, d}, {a, c, d}, {a, d, b}})
      mesh.faces.push_back(face);
  }
  return mesh;
}

/// Makes pages in n half-planes, two in each. All are on two sides of one triangle.
TriangleMesh two_books_of_double_pages(int n) {
  TriangleMesh mesh;
  const auto a = mesh.positions.push_back({0, 0, 0}), b = mesh.positions.push_back({0, 0, 8}),
             c = mesh.positions.push_back({64, 0, 8});
  for (int i = 0; i < n; ++i) {
    // Whole numbers: half-planes are the same exactly.
    const double x = 1 + i, y = n - i;
    for (const double far : {1, 2}) {
      mesh.faces.push_back({a, b, mesh.positions.push_back({-far * x, far * y, 4})});
      mesh.faces.push_back({b, mesh.positions.push_back({32, -far * x, 8 + far * y}), c});
    }
  }
  return mesh;
}

/// Returns the mesh turned at random. Some of its corners are moved, and some large triangles lie across it.
TriangleMesh disturbed(const TriangleMesh& mesh, std::uint64_t seed) {
  Random random(seed);
  TriangleMesh result = mesh;
  PolygonMesh points;
  points.positions = mesh.positions;
  result.positions = shapes::rotated(points, {random.unit(), 1, random.unit()}, 360 * random.unit()).positions;
  for (Vec3& p : result.positions)
    if (random.chance(0.02)) p += 0.05 * Vec3{random.unit(), random.unit(), random.unit()};
  for (int i = 0; i < 20; ++i) {
    Triangle face;
    for (VertexId& v : face)
      v = result.positions.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    result.faces.push_back(face);
  }
  return result;
}

TEST(self_intersections, among_needles_whose_boxes_all_meet_the_pairs_are_those_of_all_faces) {
  for (int seed = 0; seed < 4; ++seed)
    for (const TriangleMesh& shape :
         {needles(300), double_cone(150), waisted_tube(150), book(300, false), book(150, true), wedges(50)}) {
      const TriangleMesh mesh = disturbed(shape, seed);
      const Pairs expected = all_pairs(mesh);
      EXPECT_GT(expected.size(), 20u);
      EXPECT_EQ(find(mesh).pairs, expected);
      const SelfIntersections some = find(mesh, {}, expected.size() - 1);
      EXPECT_FALSE(some.is_complete);
      EXPECT_EQ(some.pairs.size(), expected.size() - 1);
    }
}

TEST(self_intersections, needles_whose_boxes_all_meet_do_not_take_quadratic_time) {
  constexpr int kFew = 250, kTimes = 16;  // 256 times as many pairs of boxes
  for (const auto& shape : {needles, double_cone, waisted_tube}) {
    const auto time_of = [&](int n) {
      const test::Seconds start = test::processor_time();
      EXPECT_TRUE(find(shape(n)).pairs.empty());
      return test::processor_time() - start;
    };
    const test::Seconds few = time_of(kFew), many = time_of(kTimes * kFew);
    test::expect_sooner_than(kTimes * kTimes / 2 * few, many);
  }
}

TEST(self_intersections, a_fan_of_a_hundred_thousand_needles_does_not_take_quadratic_time) {
  EXPECT_EQ(find(fan(100'000, 1'000'000)).pairs.size(), 1u);  // 5e9 pairs share the vertex; one needle is too wide
}

/// Makes faces at some edges between the points of a grid. A face has both ends of an edge, one end or none. If there
/// are many faces, some lie in one half-plane, or on the line.
TriangleMesh library(std::uint64_t seed, int edges, int faces) {
  Random random(seed);
  TriangleMesh mesh;
  constexpr int kSide = 5, kPoints = kSide * kSide * kSide;
  for (int i = 0; i < kPoints; ++i)
    mesh.positions.push_back({1.0 * (i % kSide), 1.0 * (i / kSide % kSide), 1.0 * (i / kSide / kSide)});
  const auto point = [&] { return VertexId(random.below(kPoints)); };
  std::vector<std::pair<VertexId, VertexId>> spines;
  for (int i = 0; i < edges; ++i) spines.push_back({i == 0 || random.chance(0.5) ? point() : spines[0].first, point()});
  for (int i = 0; i < faces; ++i) {
    const auto [a, b] = spines[random.below(edges)];
    Triangle face{a, b, point()};
    if (random.chance(0.4)) face[random.below(2)] = point();
    std::rotate(face.begin(), face.begin() + random.below(3), face.end());
    mesh.faces.push_back(face);
  }
  return mesh;
}

TEST(self_intersections, around_edges_of_very_many_faces_the_pairs_are_those_of_all_faces) {
  for (int seed = 0; seed < 12; ++seed) {
    const TriangleMesh mesh = library(seed, 1 + seed % 4, unless_sanitized(700, 300));
    const Pairs all = all_pairs(mesh);
    EXPECT_GT(all.size(), 1000u);
    EXPECT_EQ(find(mesh).pairs, all) << seed;
    Random random(seed);
    std::vector<std::uint32_t> pieces;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      pieces.push_back(random.chance(0.2) ? kNoPiece : static_cast<std::uint32_t>(random.below(5)));
    Pairs expected;
    std::copy_if(all.begin(), all.end(), std::back_inserter(expected), [&](const auto& pair) {
      const std::uint32_t p = pieces[pair.first.value];
      return p != pieces[pair.second.value] || p == kNoPiece;
    });
    EXPECT_EQ(find(mesh, pieces).pairs, expected) << seed;
  }
}

TEST(self_intersections, in_each_half_plane_around_an_edge_the_pages_lie_on_each_other) {
  const Pairs pairs = find(two_books_of_double_pages(500)).pairs;
  EXPECT_EQ(pairs, all_pairs(two_books_of_double_pages(500)));
  EXPECT_GE(pairs.size(), 1000u);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{10}, std::size_t{999}}) {
    const SelfIntersections some = find(two_books_of_double_pages(500), {}, limit);
    EXPECT_FALSE(some.is_complete);
    EXPECT_EQ(some.pairs.size(), limit);
    EXPECT_TRUE(std::includes(pairs.begin(), pairs.end(), some.pairs.begin(), some.pairs.end()));
  }
}

TEST(self_intersections, very_many_faces_around_an_edge_do_not_take_quadratic_time) {
  constexpr int kMany = 50'000;  // 1e9 pairs and more
  EXPECT_TRUE(find(book(kMany, false)).pairs.empty());
  EXPECT_TRUE(find(book(kMany, true)).pairs.empty());
  EXPECT_TRUE(find(wedges(kMany / 4)).pairs.empty());
  TriangleMesh askew = book(kMany, false);
  Random random(7);
  for (std::size_t v = 2; v < askew.positions.size(); ++v)
    askew.positions[VertexId(v)] = random.uniform(0.3, 2) * askew.positions[VertexId(v)] + Vec3{0, 0, random.unit()};
  EXPECT_TRUE(find(askew).pairs.empty());
}

TEST(self_intersections, past_the_limit_just_so_many_pairs_are_given) {
  const TriangleMesh mesh = crumbs(3, 20, 50000);
  const Pairs all = find(mesh).pairs;
  ASSERT_GT(all.size(), 10000);
  EXPECT_TRUE(find(mesh, {}, all.size()).is_complete);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, std::size_t{100}, all.size() / 2, all.size() - 1}) {
    const SelfIntersections some = find(mesh, {}, limit);
    EXPECT_FALSE(some.is_complete);
    EXPECT_EQ(some.pairs.size(), limit);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.pairs.begin(), some.pairs.end()));
  }
}

STAGE(self_intersections, test::kWorkers, test::kStop) {
  for (const TriangleMesh& mesh : {crumbs(4, 20, 50'000), two_books_of_double_pages(5000), disturbed(wedges(500), 1)})
    for (const std::size_t limit : {kNoLimit, std::size_t{1000}, std::size_t{100}}) {
      const Pairs pairs =
          self_intersections(mesh.positions.items(), mesh.faces.items(), {}, limit, trial.control).pairs;
      EXPECT_GE(pairs.size(), 100u);
      trial.in_order(pairs);
    }
}

TEST(self_intersections, many_copies_of_one_face_do_not_take_quadratic_time_once_past_the_limit) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) mesh.positions.push_back(p);
  mesh.faces.assign(300'000, {VertexId(0), VertexId(1), VertexId(2)});  // 4.5e10 pairs
  const SelfIntersections found = find(mesh, {}, 1000);
  EXPECT_FALSE(found.is_complete);
  EXPECT_EQ(found.pairs.size(), 1000);
}

TEST(self_intersections, coordinates_of_any_magnitude_give_the_same_pairs) {
  const TriangleMesh mesh = soup(5, 5, 200);
  const Pairs expected = find(mesh).pairs;
  // The factors reach from the smallest double to near the largest; 2^126 takes the coordinate 4 to 3.4e38.
  for (const double factor : {0x1p-1074, 0x1p-1000, 0x1p126, 0x1p1021}) {
    TriangleMesh scaled = mesh;
    for (Vec3& p : scaled.positions) p = factor * p;
    EXPECT_EQ(find(scaled).pairs, expected) << factor;
  }
}

TEST(self_intersections, clean_surfaces_have_none) {
  for (const PolygonMesh& mesh : {shapes::sphere(4), shapes::rotated(shapes::sheet(3, 2, 30, 20), {1, 2, 3}, 40),
                                  shapes::box({1, 2, 3}, 7), shapes::three_pages(5), shapes::blocks({"##.", ".##"}, 3),
                                  shapes::rotated(shapes::noisy_sheet(20, 1), {3, 1, 2}, 70)})
    EXPECT_EQ(find(shapes::triangles(shapes::fan_triangulated(mesh))).pairs.size(), 0);
}

TEST(self_intersections, a_surface_without_faces_has_none) { EXPECT_TRUE(find(TriangleMesh()).pairs.empty()); }

TEST(self_intersections, both_sheets_of_a_doubled_surface_are_found) {
  // Every face lies on its copy, and no face meets another one but in what they share.
  const TriangleMesh mesh = shapes::triangles(shapes::double_sheet(8));
  EXPECT_EQ(find(mesh).pairs.size(), mesh.faces.size() / 2);
}

/// Pairs of faces that have area: facts.tsv leaves those without it out of this column.
std::size_t proper_pairs(const TriangleMesh& mesh) {
  const auto has_area = [&](FaceId f) {
    const auto& [a, b, c] = mesh.faces[f];
    return !verification::is_collinear(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
  };
  const Pairs pairs = find(mesh).pairs;
  return static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(), [&](const auto& pair) { return has_area(pair.first) && has_area(pair.second); }));
}

TEST(self_intersections, counts_of_real_meshes_are_those_computed_by_other_means) {
  const fs::path meshes = test::shared_meshes_folder();
  if (!test::has_shared_mesh("facts.tsv")) return;
  int compared = 0, intersecting = 0;
  for (const test::MeshFacts& facts : test::shared_meshes_facts()) {
    const auto fact = [&](const char* column) { return facts.at(column); };
    const fs::path file = meshes / fact("file");
    if (file.extension() != ".obj" || fact("sides") != "3" || fact("intersecting_pairs").empty()) continue;
    SCOPED_TRACE(file);
    if (!test::has_shared_mesh(fact("file"))) continue;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    RunControl control;
    PolygonMesh mesh;
    try {
      mesh = read_obj(text.str(), {}, control).mesh;
    } catch (const Error&) {
      continue;  // what cannot be read, and why, is the reader's matter
    }
    const auto expected = static_cast<std::size_t>(std::stoul(fact("intersecting_pairs")));
    EXPECT_EQ(proper_pairs(shapes::triangles(shapes::welded(mesh))), expected);
    ++compared;
    intersecting += expected > 0;
  }
  EXPECT_GE(compared, 30);
  EXPECT_GE(intersecting, 6);
}

}  // namespace
}  // namespace remesh
