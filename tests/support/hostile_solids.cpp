#include "tests/support/hostile_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/primitives.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh::hostile {
namespace {

/// Puts parts into one mesh, without looking for common vertices.
class Parts {
 public:
  void add(const PolygonMesh& part, const Vec3& by = {}) {
    const auto first = static_cast<std::uint32_t>(all_.positions.size());
    for (const Vec3& p : part.positions) all_.positions.push_back(p + by);
    for (FaceId f(0); f.value < part.face_count(); ++f.value) {
      for (const VertexId v : part.face(f)) all_.corners.emplace_back(v.value + first);
      all_.face_begin.push_back(static_cast<std::uint32_t>(all_.corners.size()));
    }
  }
  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& p : {a, b, c}) {
      all_.corners.emplace_back(static_cast<std::uint32_t>(all_.positions.size()));
      all_.positions.push_back(p);
    }
    all_.face_begin.push_back(static_cast<std::uint32_t>(all_.corners.size()));
  }
  PolygonMesh take() { return std::move(all_); }

 private:
  PolygonMesh all_;
};

Vec3 random_point(Random& random) {
  const double x = random.unit(), y = random.unit();
  return {x, y, random.unit()};
}

std::size_t at_least_one(std::size_t size, std::size_t faces_each) {
  return std::max<std::size_t>(1, size / faces_each);
}

PolygonMesh soup_of_triangles(std::size_t size, double reach) {
  Parts out;
  Random random(11);
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3 at = random_point(random);
    const auto corner = [&] { return at + reach * (random_point(random) - Vec3{0.5, 0.5, 0.5}); };
    const Vec3 a = corner(), b = corner();
    out.add_triangle(a, b, corner());
  }
  return out.take();
}
PolygonMesh soup_of_small_triangles(std::size_t size) {
  return soup_of_triangles(size, 2 / std::cbrt(static_cast<double>(size)));
}
PolygonMesh soup_of_large_triangles(std::size_t size) { return soup_of_triangles(size, 1); }

PolygonMesh stacked_boxes(std::size_t size) {
  Parts out;
  Random random(12);
  const std::size_t count = at_least_one(size, 12);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.unit(), y = random.unit(), width = random.uniform(1, 2);
    out.add(shapes::box({width, random.uniform(1, 2), 1}), {x, y, static_cast<double>(i)});
  }
  return out.take();
}

PolygonMesh squares_in_a_plane(std::size_t size) {
  Parts out;
  Random random(13);
  const std::size_t count = at_least_one(size, 2);
  const double side = 2 / std::sqrt(static_cast<double>(count));
  const PolygonMesh square = shapes::fan_triangulated(shapes::polygon({{0, 0}, {side, 0}, {side, side}, {0, side}}));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.unit();
    out.add(square, {x, random.unit(), 0});
  }
  return out.take();
}

/// A comb of teeth that are `width` wide, `height` long along y, and 2 apart along x. It is one deep, and of triangles.
PolygonMesh comb_of(std::size_t teeth, double width, double height) {
  // The outline of the spine below, and then four points for each tooth, from the last tooth on.
  const double length = 2 * static_cast<double>(teeth);
  std::vector<Vec2> outline{{0, -1}, {length, -1}, {length, 0}};
  for (std::size_t t = teeth; t-- > 0;) {
    const auto x = static_cast<double>(2 * t);
    for (const Vec2 p : {Vec2{x + width, 0}, Vec2{x + width, height}, Vec2{x, height}, Vec2{x, 0}})
      outline.push_back(p);
  }
  const auto n = static_cast<std::uint32_t>(outline.size());
  std::vector<Vec3> positions;
  for (const double z : {0.0, 1.0})
    for (const Vec2& p : outline) positions.push_back({p.x, p.y, z});
  std::vector<std::vector<std::uint32_t>> faces;
  const auto add_to_caps = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    faces.push_back({a, c, b});
    faces.push_back({n + a, n + b, n + c});
  };
  add_to_caps(0, 1, 2);
  for (std::uint32_t i = 2; i + 4 < n; i += 4) {
    add_to_caps(0, i, i + 1);
    add_to_caps(0, i + 1, i + 4);
    add_to_caps(i + 1, i + 2, i + 3);
    add_to_caps(i + 1, i + 3, i + 4);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    faces.push_back({i, next, n + next});
    faces.push_back({i, n + next, n + i});
  }
  return shapes::from_lists(positions, faces);
}
constexpr std::size_t kFacesOfTooth = 16;

PolygonMesh combs_in_each_other(std::size_t size) {
  Parts out;
  const std::size_t teeth = at_least_one(size, 2 * kFacesOfTooth);
  const PolygonMesh one = comb_of(teeth, 1.25, 10);
  out.add(one);
  const double length = 2 * static_cast<double>(teeth);
  out.add(shapes::rotated(one, {0, 0, 1}, 180), {length - 0.0625, 15, 0.25});
  return out.take();
}

PolygonMesh combs_across_each_other(std::size_t size) {
  Parts out;
  const std::size_t teeth = at_least_one(size, 2 * kFacesOfTooth);
  const PolygonMesh one = comb_of(teeth, 1, 2 * static_cast<double>(teeth) + 1);
  out.add(one);
  out.add(shapes::rotated(one, {1, 1, 0}, 180), {-0.5, -0.5, 0.75});
  return out.take();
}

PolygonMesh needles_through_a_plate(std::size_t size) {
  Parts out;
  Random random(14);
  out.add(shapes::box({1, 1, 0.125}));
  const std::size_t count = at_least_one(size, 4);
  const double width = 0.25 / std::sqrt(static_cast<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.unit(), y = random.unit();
    const Vec3 at{x, y, -1}, tip = at + Vec3{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 2};
    const std::vector<Vec3> corners{at, at + Vec3{width, 0, 0}, at + Vec3{0, width, 0}, tip};
    out.add(shapes::from_lists(corners, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}));
  }
  return out.take();
}

/// A cone whose rim goes up and down, closed by a cone below.
PolygonMesh fan(std::size_t facets, const Vec3& top, double turn, Random& random) {
  std::vector<Vec3> positions{top, {0, 0, -2}};
  std::vector<std::vector<std::uint32_t>> faces;
  const auto n = static_cast<std::uint32_t>(facets);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + turn) / n;
    positions.push_back({std::cos(angle), std::sin(angle), random.uniform(-0.5, 0.5)});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % n;
    faces.push_back({0, a, b});
    faces.push_back({1, b, a});
  }
  return shapes::from_lists(positions, faces);
}

PolygonMesh fan_in_a_fan(std::size_t size) {
  Parts out;
  Random random(15);
  const std::size_t facets = std::max<std::size_t>(3, size / 4);
  out.add(fan(facets, {0, 0, 1}, 0, random));
  out.add(fan(facets, {0, 0, 1}, 0.4, random));
  return out.take();
}

PolygonMesh sheets_through_a_line(std::size_t size) { return family("planks").make(size); }

PolygonMesh spheres(std::size_t size) {
  Parts out;
  Random random(10);
  const PolygonMesh sphere = primitives::icosphere(3, 1).mesh;
  const std::size_t count = at_least_one(size, sphere.face_count());
  const double side = 10 * std::cbrt(static_cast<double>(count) / 200);
  for (std::size_t i = 0; i < count; ++i) out.add(sphere, side * random_point(random));
  return out.take();
}

PolygonMesh row_of_cubes(std::size_t size) {
  Parts out;
  const PolygonMesh cube = shapes::box({1, 1, 1});
  for (std::size_t i = 0; i < at_least_one(size, 12); ++i) out.add(cube, {static_cast<double>(i), 0, 0});
  return out.take();
}

PolygonMesh bolts_in_a_plate(std::size_t size) {
  Parts out;
  const PolygonMesh bolt = shapes::fan_triangulated(shapes::cylinder(6, 0.5, 1));
  const std::size_t count = at_least_one(size, bolt.face_count());
  const auto row = static_cast<std::size_t>(std::ceil(std::sqrt(2 * static_cast<double>(count))));
  const std::size_t rows = (count + row - 1) / row;
  out.add(shapes::box({2 * static_cast<double>(row), 2 * static_cast<double>(rows), 1}));
  for (std::size_t i = 0; i < count; ++i)
    out.add(bolt, {1 + 2 * static_cast<double>(i % row), 1 + 2 * static_cast<double>(i / row), 0.5});
  return out.take();
}

constexpr std::array kMeeting{
    Family{"sheets_through_a_line", Answer::kQuadratic, sheets_through_a_line},
    Family{"fan_in_a_fan", Answer::kInProportion, fan_in_a_fan},
    Family{"stacked_boxes", Answer::kInProportion, stacked_boxes},
    Family{"squares_in_a_plane", Answer::kInProportion, squares_in_a_plane},
    Family{"soup_of_small_triangles", Answer::kInProportion, soup_of_small_triangles},
    Family{"soup_of_large_triangles", Answer::kQuadratic, soup_of_large_triangles},
    Family{"combs_in_each_other", Answer::kInProportion, combs_in_each_other},
    Family{"combs_across", Answer::kQuadratic, combs_across_each_other},
    Family{"needles_through_a_plate", Answer::kInProportion, needles_through_a_plate},
    Family{"spheres", Answer::kInProportion, spheres},
    Family{"row_of_cubes", Answer::kInProportion, row_of_cubes},
    Family{"bolts_in_a_plate", Answer::kInProportion, bolts_in_a_plate},
};

}  // namespace

std::span<const Family> meeting_families() { return kMeeting; }

}  // namespace remesh::hostile
