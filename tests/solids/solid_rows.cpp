#include "tests/solids/solid_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "tests/support/shapes.h"

namespace remesh {
namespace {

PolygonMesh box(const Vec3& from, const Vec3& to) { return shapes::moved(shapes::box(to - from), from); }

std::vector<double> equal_cells(std::size_t count, double volume) { return std::vector<double>(count, volume); }

SolidRow bricks_of_sponge(int number, int levels, int euler, double volume, double area) {
  SolidRow row{number, "Menger sponge of " + std::to_string(levels) + " levels", {}, volume, area, euler};
  const int side = levels == 1 ? 3 : 9;
  const auto is_hole = [](int x, int y, int z) { return (x % 3 == 1) + (y % 3 == 1) + (z % 3 == 1) > 1; };
  // The numbers of its planes are rounded once, so that cubes which touch share them.
  const auto at = [&](int i) { return static_cast<double>(i) / side; };
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        if (!is_hole(x, y, z) && !is_hole(x / 3, y / 3, z / 3))
          row.parts.push_back(box({at(x), at(y), at(z)}, {at(x + 1), at(y + 1), at(z + 1)}));
  row.cells = equal_cells(row.parts.size(), 1.0 / (side * side * side));
  row.is_large = levels > 1;
  return row;
}

/// A closed tube of section 1 x 1 along a polygon whose corners are right angles. It crosses itself.
PolygonMesh crossing_tube() {
  const std::vector<Vec2> middle{{0, 0}, {6, 0}, {6, 4}, {3, 4}, {3, -3}, {0, -3}};
  const std::size_t n = middle.size();
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto left_of = [](const Vec2& way) {
    const double length = std::hypot(way.x, way.y);
    return Vec2{-way.y / length, way.x / length};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 side = 0.5 * (left_of(middle[i] - middle[(i + n - 1) % n]) + left_of(middle[(i + 1) % n] - middle[i]));
    for (const double z : {0.0, 1.0})
      for (const double sign : {-1.0, 1.0}) {
        const Vec2 p = middle[i] + sign * side;
        positions.push_back({p.x, p.y, z});
      }
  }
  // The corners of a section, around the way: right below, left below, left above, right above.
  constexpr std::array<std::uint32_t, 4> kRing{0, 1, 3, 2};
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t a = 4 * i, b = 4 * ((i + 1) % static_cast<std::uint32_t>(n));
      const std::uint32_t p = kRing[k], q = kRing[(k + 1) % 4];
      faces.push_back({a + p, b + p, b + q});
      faces.push_back({a + p, b + q, a + q});
    }
  PolygonMesh tube = shapes::from_lists(positions, faces);
  return shapes::turned_over(tube);
}

/// A prism over an L of three unit squares, 2 high. All of the L is seen from its first corner.
PolygonMesh letter(const Vec3& at) {
  const std::vector<Vec2> rim{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto n = static_cast<std::uint32_t>(rim.size());
  std::vector<Vec3> positions;
  for (const double z : {0.0, 2.0})
    for (const Vec2& p : rim) positions.push_back({p.x, p.y, z});
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    faces.push_back({0, i + 1, i});
    faces.push_back({n, n + i, n + i + 1});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    faces.push_back({i, next, n + next});
    faces.push_back({i, n + next, n + i});
  }
  return shapes::moved(shapes::from_lists(positions, faces), at);
}

}  // namespace

std::vector<SolidRow> solid_rows() {
  const PolygonMesh unit = box({0, 0, 0}, {1, 1, 1});
  const PolygonMesh small = box({.25, .25, .25}, {.75, .75, .75});
  std::vector<SolidRow> rows{
      {1, "corner in corner", {unit, box({.5, .5, .5}, {1.5, 1.5, 1.5})}, 1.875, 10.5, 2, 1, 0, 0, {.125, .875, .875}},
      {2, "bar through", {unit, box({.25, .25, -.5}, {.75, .75, 1.5})}, 1.25, 8, 2, 1, 0, 0, {.125, .125, .25, .75}},
      {3, "small face in large", {unit, box({.25, .25, 1}, {.75, .75, 1.5})}, 1.125, 7, 2, 1, 0, 0, {.125, 1}},
      {4, "equal faces", {unit, box({1, 0, 0}, {2, 1, 1})}, 2, 10, 2, 1, 0, 12, {1, 1}},
      {5, "coplanar overlaps", {unit, box({.5, 0, .5}, {1.5, 1, 1.5})}, 1.75, 9.5, 2, 1, 0, 0, {.25, .75, .75}},
      {6, "edge on edge", {unit, box({1, 1, 0}, {2, 2, 1})}, 2, 12, 3, 2, 1, 0, {1, 1}},
      {7, "half of an edge", {unit, box({1, 1, .5}, {2, 2, 1.5})}, 2, 12, 3, 2, 1, 0, {1, 1}},
      {8, "corner on corner", {unit, box({1, 1, 1}, {2, 2, 2})}, 2, 12, 3, 2, 0, 0, {1, 1}},
  };
  const PolygonMesh tetrahedron =
      shapes::from_lists({{.5, .5, 1}, {0, 0, 2}, {1, 0, 2}, {.5, 1, 2}}, {{1, 2, 3}, {0, 2, 1}, {0, 3, 2}, {0, 1, 3}});
  rows.push_back({9,
                  "corner in face",
                  {unit, tetrahedron},
                  7.0 / 6,
                  6.5 + std::sqrt(1.25) / 2 + std::sqrt(1.3125),
                  3,
                  2,
                  0,
                  0,
                  {1.0 / 6, 1}});
  rows.push_back({10, "one in the other", {unit, small}, 1, 6, 2, 1, 0, 0, {.125, 1}});
  rows.push_back({11, "cavity", {unit, shapes::turned_over(small)}, .875, 7.5, 4, 2, 0, 0, {.125, 1}});
  rows.push_back({12, "twice the same", {unit, unit}, 1, 6, 2, 1, 0, 12, {1}});
  rows.push_back({13,
                  "three bars",
                  {box({0, 1, 1}, {3, 2, 2}), box({1, 0, 1}, {2, 3, 2}), box({1, 1, 0}, {2, 2, 3})},
                  7,
                  30,
                  2,
                  1,
                  0,
                  0,
                  equal_cells(7, 1)});
  rows.push_back({14,
                  "bricks",
                  {box({0, 0, 0}, {2, 1, 1}), box({2, 0, 0}, {4, 1, 1}), box({4, 0, 0}, {6, 1, 1}),
                   box({1, 0, 1}, {3, 1, 2}), box({3, 0, 1}, {5, 1, 2})},
                  10,
                  36,
                  2,
                  1,
                  0,
                  0,
                  equal_cells(5, 2)});
  rows.push_back({15,
                  "plates",
                  {box({0, 0, 0}, {4, 4, 1}), box({1, 1, 1}, {5, 5, 2}), box({2, 0, 2}, {6, 4, 3})},
                  48,
                  108,
                  2,
                  1,
                  0,
                  0,
                  equal_cells(3, 16)});
  rows.push_back(bricks_of_sponge(16, 1, -8, 20.0 / 27, 8));
  rows.push_back(bricks_of_sponge(16, 2, -160, 400.0 / 729, 1056.0 / 81));
  SolidRow cubes{17, "row of cubes", {}, 10000, 40002, 2, 1, 0, 12, equal_cells(10000, 1), true};
  for (int i = 0; i < 10000; ++i) cubes.parts.push_back(box({double(i), 0, 0}, {i + 1.0, 1, 1}));
  rows.push_back(std::move(cubes));
  rows.push_back({18, "tube that crosses itself", {crossing_tube()}, 25, 98, -2, 1, 0, 0, {1, 11, 13}});
  SolidRow letters{19, "letters in a plate", {box({0, 0, 0}, {100, 20, 2})}, 4150, 4880, 2};
  letters.cells = equal_cells(100, 3);
  letters.cells.push_back(3850);
  for (int i = 0; i < 50; ++i) letters.parts.push_back(letter({1 + 3.75 * (i % 25), 2.0 + 9 * (i / 25), 1}));
  rows.push_back(std::move(letters));
  const double hexagon = 3 * std::numbers::sqrt3 / 8;  // its area, at sides of a half
  SolidRow bolts{20, "bolts in a plate", {box({0, 0, 0}, {200, 100, 1})}, 20000 + 5000 * hexagon / 2, 40600 + 7500, 2};
  bolts.is_large = true;
  bolts.cells = equal_cells(10000, hexagon / 2);
  bolts.cells.push_back(20000 - 5000 * hexagon / 2);
  const PolygonMesh bolt = shapes::fan_triangulated(shapes::cylinder(6, .5, 1));
  for (int i = 0; i < 5000; ++i)
    bolts.parts.push_back(shapes::moved(bolt, {1 + 2.0 * (i % 100), 1 + 2.0 * (i / 100), .5}));
  rows.push_back(std::move(bolts));
  return rows;
}

PolygonMesh divided(const PolygonMesh& mesh, int n) {
  PolygonMesh fine;
  // Points are found by their coordinates. Those on a common side are computed in the same way from both faces.
  std::map<Vec3, VertexId> known;
  const auto vertex = [&](const Vec3& p) {
    const auto [at, is_new] = known.insert({p, VertexId(fine.positions.size())});
    if (is_new) fine.positions.push_back(p);
    return at->second;
  };
  std::vector<std::vector<std::uint32_t>> faces;
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
    const auto corners = mesh.face(f);
    // The weights of sorted corners, so that both faces at a side round alike.
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return mesh.positions[corners[i]] < mesh.positions[corners[j]]; });
    const auto at = [&](int i, int j) {
      const std::array<int, 3> weights{n - i - j, i, j};
      Vec3 p{};
      for (const std::size_t k : order)
        if (weights[k] == n) return vertex(mesh.positions[corners[k]]).value;
      for (const std::size_t k : order)
        if (weights[k] > 0) p += (static_cast<double>(weights[k]) / n) * mesh.positions[corners[k]];
      return vertex(p).value;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return shapes::from_lists({fine.positions.begin(), fine.positions.end()}, faces);
}

PolygonMesh as_one(const std::vector<PolygonMesh>& parts) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (const PolygonMesh& part : parts) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& p : part.positions) positions.push_back(p);
    for (FaceId f(0); f.value < part.face_count(); ++f.value) {
      faces.emplace_back();
      for (const VertexId v : part.face(f)) faces.back().push_back(v.value + first);
    }
  }
  return shapes::from_lists(positions, faces);
}

}  // namespace remesh
