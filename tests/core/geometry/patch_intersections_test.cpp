#include "core/geometry/intersections/patch_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/triangle_corners.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// A surface with a patch for each normal that its faces have, to three digits.
struct Patched {
  explicit Patched(const PolygonMesh& mesh) : triangles(shapes::triangles(mesh)) {
    std::map<std::array<int, 4>, PatchId> numbers;
    for (const auto& [a, b, c] : triangles.faces) {
      const Vec3 p = triangles.positions[a];
      const Vec3 n = normalized(cross(triangles.positions[b] - p, triangles.positions[c] - p));
      const auto digits = [](double x) { return static_cast<int>(std::lround(1000 * x)); };
      const auto [found, is_new] =
          numbers.try_emplace({digits(n.x), digits(n.y), digits(n.z), digits(dot(n, p))}, PatchId(normals.size()));
      if (is_new) normals.push_back(n);
      patch.push_back(found->second);
    }
    simple.assign(normals.size(), 1);
  }

  SelfIntersections find(std::size_t max_pairs = 1'000'000) const {
    RunControl control;
    return patch_intersections(
        {triangles.positions.items(), corners_of(triangles.faces.items()), patch, normals, simple}, max_pairs, control);
  }
  SelfIntersections find_all() const {
    RunControl control;
    return self_intersections(triangles.positions.items(), triangles.faces.items(), {}, 1'000'000, control);
  }

  TriangleMesh triangles;
  std::vector<PatchId> patch;
  std::vector<Vec3> normals;
  std::vector<std::uint8_t> simple;
};

TEST(patch_intersections, of_simple_patches_all_pairs_are_found) {
  int with_pairs = 0;
  for (int seed = 0; seed < 40; ++seed) {
    Random random(seed);
    PolygonMesh mesh = shapes::box({1, 1, 1}, 6);
    for (int i = 0; i < 3; ++i) {
      const Vec3 at{2 * random.unit() - 1, 2 * random.unit() - 1, 2 * random.unit() - 1};
      PolygonMesh more = shapes::box({0.5 + random.unit(), 0.7, 0.9}, 5);
      if (seed % 2) more = shapes::rotated(more, {random.unit(), 1, random.unit()}, 360 * random.unit());
      mesh = shapes::joined(mesh, shapes::moved(more, at));
    }
    const Patched patched(seed % 3 ? mesh : shapes::scaled(mesh, 1e100));
    const SelfIntersections expected = patched.find_all();
    with_pairs += !expected.pairs.empty();
    EXPECT_EQ(patched.find().pairs, expected.pairs) << seed;
  }
  EXPECT_GT(with_pairs, 30);
}

TEST(patch_intersections, touching_from_one_patch_to_another_counts) {
  // A box that stands on the other one, corners inside faces.
  const Patched patched(
      shapes::joined(shapes::box({4, 4, 1}, 9), shapes::moved(shapes::box({1, 1, 1}, 4), {1.3, 1.3, 1})));
  const SelfIntersections expected = patched.find_all();
  ASSERT_GT(expected.pairs.size(), 10u);
  EXPECT_EQ(patched.find().pairs, expected.pairs);
}

TEST(patch_intersections, beside_a_coordinate_that_is_far_too_large_faces_are_still_told_apart) {
  // Two sheets of 8,192 faces that cross, and a needle of length 2^80. Relative to it, both sheets are one point.
  const PolygonMesh sheet = shapes::sheet(2, 2, 64, 64);
  PolygonMesh mesh = shapes::joined(shapes::rotated(sheet, {0, 1, 0}, 45),
                                    shapes::moved(shapes::rotated(sheet, {0, 1, 0}, 40), {0.01, 0.013, -0.05}));
  const std::size_t faces = shapes::triangles(mesh).faces.size();
  mesh = shapes::joined(mesh, shapes::polygon({{5, 5}, {0x1p80, 5}, {5, 6}}));
  const Patched patched(mesh);
  RunControl control;
  SearchLimits limits(1'000'000);
  limits.max_steps = 400 * faces;  // to test all pairs takes many times as many
  const SelfIntersections found =
      patch_intersections({patched.triangles.positions.items(), corners_of(patched.triangles.faces.items()),
                           patched.patch, patched.normals, patched.simple},
                          limits, control);
  EXPECT_TRUE(found.is_complete);
  EXPECT_GT(found.pairs.size(), 30u);
  EXPECT_EQ(found.pairs, patched.find_all().pairs);
}

TEST(patch_intersections, sheets_that_lie_in_one_another_are_compared_as_a_whole) {
  // Each face is near all other sheets: too many parts to keep.
  Random random(17);
  PolygonMesh mesh;
  for (int i = 0; i < 60; ++i) {
    const PolygonMesh sheet = shapes::moved(shapes::sheet(1, 1, 4, 4), {0.3 * random.unit(), 0.3 * random.unit(), 0});
    mesh = i == 0 ? sheet : shapes::joined(mesh, sheet);
  }
  Patched patched(mesh);
  // A patch each, not one for all.
  for (std::size_t f = 0; f < patched.patch.size(); ++f) patched.patch[f] = PatchId(f / 32);
  patched.normals.assign(60, {0, 0, 1});
  patched.simple.assign(60, 1);
  const SelfIntersections expected = patched.find_all();
  ASSERT_GT(expected.pairs.size(), 100'000u);
  ASSERT_TRUE(expected.is_complete);
  EXPECT_EQ(patched.find().pairs, expected.pairs);
  EXPECT_EQ(patched.find(1000).pairs.size(), 1000u);
}

/// Makes sheets through one line, like the pages of a book that go on behind its back.
PolygonMesh crossing_sheets(int count, int cells) {
  PolygonMesh mesh;
  for (int i = 0; i < count; ++i) {
    const PolygonMesh sheet = shapes::rotated(shapes::moved(shapes::sheet(2, 2, cells, cells), {-1, -1, 0}), {1, 0, 0},
                                              180.0 * (i + 0.3) / count);
    mesh = i == 0 ? sheet : shapes::joined(mesh, sheet);
  }
  return mesh;
}

TEST(patch_intersections, many_patches_may_meet_in_one_place) {
  for (const auto& [count, cells] : {std::pair(2, 90), std::pair(12, 7), std::pair(5, 31)}) {
    const Patched patched(crossing_sheets(count, cells));
    ASSERT_EQ(patched.normals.size(), static_cast<std::size_t>(count));
    const SelfIntersections expected = patched.find_all();
    ASSERT_GT(expected.pairs.size(), static_cast<std::size_t>(count * cells));
    EXPECT_EQ(patched.find().pairs, expected.pairs) << count << " sheets";
  }
}

/// Makes a cone whose base is a fan. Each of its n facets is one patch, and the n needles of the base are one more.
/// `lift` raises the base.
Patched cone_on_a_fan(int n, double lift) {
  std::vector<Vec3> points{{0, 0, 1}, {0, 0, lift}};
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < n; ++i) points.push_back({std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0});
  for (int i = 0; i < n; ++i) points.push_back(points[2 + i] + Vec3{0, 0, lift});
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
    const std::uint32_t next = (i + 1) % n, base = lift == 0 ? 2 : 2 + n;
    faces.push_back({0, 2 + i, 2 + next});
    faces.push_back({1, base + next, base + i});
  }
  Patched patched(shapes::from_lists(points, faces));
  patched.normals.assign(n + 1, {0, 0, -1});
  for (int i = 0; i < n; ++i) {
    const Vec3 middle = points[2 + i] + points[2 + (i + 1) % n];
    patched.patch[2 * i] = PatchId(1 + i);
    patched.patch[2 * i + 1] = PatchId(0);
    patched.normals[1 + i] = normalized(normalized(middle) + Vec3{0, 0, std::cos(M_PI / n)});
  }
  patched.simple.assign(n + 1, 1);
  return patched;
}

TEST(patch_intersections, a_cone_on_a_fan_of_needles_gives_the_pairs_of_all_faces) {
  EXPECT_TRUE(cone_on_a_fan(3000, 0).find().pairs.empty());
  const Patched crossing = cone_on_a_fan(3000, 0.1);
  const SelfIntersections expected = crossing.find_all();
  EXPECT_GT(expected.pairs.size(), 1000u);
  EXPECT_EQ(crossing.find().pairs, expected.pairs);
}

TEST(patch_intersections, a_cone_on_a_fan_of_needles_does_not_take_quadratic_time) {
  EXPECT_TRUE(cone_on_a_fan(50'000, 0).find().pairs.empty());
}

TEST(patch_intersections, a_fan_of_needles_may_cross_a_large_patch_or_a_few_faces) {
  // Needles from a far place to a line, as across a cap that a long wall goes through.
  for (const int cells : {1, 100}) {
    Patched patched(
        shapes::joined(shapes::sheet(4, 4, cells, cells),
                       shapes::moved(shapes::rotated(shapes::sheet(4, 2, 3000, 1), {1, 0, 0}, 50), {0.1, 1.7, -0.7})));
    ASSERT_EQ(patched.normals.size(), 2u);
    const SelfIntersections expected = patched.find_all();
    EXPECT_GT(expected.pairs.size(), 1000u);
    EXPECT_EQ(patched.find().pairs, expected.pairs) << cells;
  }
}

/// A fan of n needles in the plane y = 0, and a row of n triangles that stand on them near their short sides. Fan and
/// row are a patch each. The box of a needle contains about half of the row. Along x, everything is `stretch` times as
/// large.
Patched fan_below_a_row(std::uint32_t n, double stretch) {
  PolygonMesh mesh;
  const auto add = [&](Vec3 p) {
    p.x *= stretch;
    mesh.positions.push_back(p);
    return VertexId(mesh.positions.size() - 1);
  };
  const auto add_face = [&](VertexId a, VertexId b, VertexId c) {
    mesh.corners.insert(mesh.corners.end(), {a, b, c});
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  };
  const auto end_of = [&](double i) { return Vec3{0.25 + i / n / 8, 0, 0.75 - i / n / 16}; };
  const Vec3 apex{0.875, 0, 0.125};
  const VertexId hub = add(apex);
  for (std::uint32_t i = 0; i < n; ++i) add_face(add(end_of(i)), add(end_of(i + 0.9)), hub);
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 foot = end_of(i + 0.4) + (0.02 / n) * (apex - end_of(i + 0.4));
    add_face(add(foot), add(foot + Vec3{0.25 / n, 0.5, 0.125}), add(foot + Vec3{-0.25 / n, 0.5, 0.125}));
  }
  Patched patched(mesh);
  patched.normals = {{0, 1, 0}, normalized(Vec3{0, 0.25, -1})};
  patched.simple = {1, 1};
  for (std::uint32_t i = 0; i < 2 * n; ++i) patched.patch[i] = PatchId(i < n ? 0u : 1u);
  return patched;
}

TEST(patch_intersections, a_fan_below_a_row_of_faces_gives_the_pairs_of_all_faces) {
  constexpr std::uint32_t kNeedles = 300;
  for (const double stretch : {1.0, 0x1p27}) {
    const Patched patched = fan_below_a_row(kNeedles, stretch);
    std::vector<std::pair<FaceId, FaceId>> expected;
    for (const auto& [f, g] : patched.find_all().pairs)
      if (f.value < kNeedles && g.value >= kNeedles) expected.push_back({f, g});
    EXPECT_EQ(expected.size(), kNeedles) << stretch;
    EXPECT_EQ(patched.find().pairs, expected) << stretch;
  }
}

TEST(patch_intersections, a_fan_below_a_row_of_faces_does_not_take_quadratic_time) {
  for (const double stretch : {1.0, 0x1p27}) {
    const auto steps = [&](std::uint32_t n) { return static_cast<double>(fan_below_a_row(n, stretch).find().steps); };
    EXPECT_LT(steps(8000), 8 * steps(2000)) << stretch;
  }
}

TEST(patch_intersections, more_than_are_wanted_are_not_all_told) {
  for (const auto& [count, cells] : {std::pair(2, 90), std::pair(12, 7)}) {
    const Patched patched(crossing_sheets(count, cells));
    const std::size_t all = patched.find().pairs.size();
    EXPECT_TRUE(patched.find(all).is_complete);
    for (const std::size_t most : {std::size_t{0}, std::size_t{10}, all - 1}) {
      const SelfIntersections some = patched.find(most);
      EXPECT_FALSE(some.is_complete);
      EXPECT_LE(some.pairs.size(), most);
    }
  }
}

TEST(patch_intersections, inside_a_large_patch_faces_are_looked_at_only_if_it_is_not_simple) {
  PolygonMesh mesh = shapes::joined(shapes::sheet(4, 4, 8, 8), shapes::moved(shapes::sheet(4, 4, 8, 8), {1.1, 1.3, 0}));
  Patched patched(mesh);
  ASSERT_EQ(patched.normals.size(), 1u);
  EXPECT_TRUE(patched.find().pairs.empty());
  patched.simple[0] = 0;
  EXPECT_EQ(patched.find().pairs, patched.find_all().pairs);
  EXPECT_FALSE(patched.find().pairs.empty());
}

}  // namespace
}  // namespace remesh
