// Tests the arrangement of triangles and the union of solids on boxes whose cells, volumes, areas and Euler numbers
// were counted on a grid, and on convex solids in general position, whose common volume is computed by clipping one of
// them at the planes of the other.

#include "core/solids/arrangement.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/triangle_corners.h"
#include "core/solids/solid_union.h"
#include "tests/support/cgal_space.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

struct Box {
  Vec3 from, to;
};

/// Boxes with what is known of them.
struct BoxRow {
  std::string name;
  std::vector<Box> boxes;
  double volume, area;        ///< those of the union
  int euler;                  ///< of the union's boundary: vertices - edges + faces
  std::vector<double> cells;  ///< the volumes of the cells, ascending
};

constexpr Vec3 kOrigin{0, 0, 0}, kOne{1, 1, 1};

std::vector<Box> row_of_cubes(int count) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back({{double(i), 0, 0}, {i + 1.0, 1, 1}});
  return boxes;
}

std::vector<Box> sponge() {
  std::vector<Box> boxes;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        if ((x == 1) + (y == 1) + (z == 1) < 2)
          boxes.push_back({{double(x), double(y), double(z)}, {x + 1.0, y + 1.0, z + 1.0}});
  return boxes;
}

std::vector<BoxRow> box_rows() {
  const Box unit{kOrigin, kOne};
  return {
      {"corner in corner", {unit, {{.5, .5, .5}, {1.5, 1.5, 1.5}}}, 1.875, 10.5, 2, {.125, .875, .875}},
      {"bar through", {unit, {{.25, .25, -.5}, {.75, .75, 1.5}}}, 1.25, 8, 2, {.125, .125, .25, .75}},
      {"small face in large", {unit, {{.25, .25, 1}, {.75, .75, 1.5}}}, 1.125, 7, 2, {.125, 1}},
      {"equal faces", {unit, {{1, 0, 0}, {2, 1, 1}}}, 2, 10, 2, {1, 1}},
      {"coplanar overlaps", {unit, {{.5, 0, .5}, {1.5, 1, 1.5}}}, 1.75, 9.5, 2, {.25, .75, .75}},
      {"edge on edge", {unit, {{1, 1, 0}, {2, 2, 1}}}, 2, 12, 3, {1, 1}},
      {"half of an edge", {unit, {{1, 1, .5}, {2, 2, 1.5}}}, 2, 12, 3, {1, 1}},
      {"corner on corner", {unit, {{1, 1, 1}, {2, 2, 2}}}, 2, 12, 3, {1, 1}},
      {"one in the other", {unit, {{.25, .25, .25}, {.75, .75, .75}}}, 1, 6, 2, {.125, .875}},
      {"twice the same", {unit, unit}, 1, 6, 2, {1}},
      {"three bars",
       {{{0, 1, 1}, {3, 2, 2}}, {{1, 0, 1}, {2, 3, 2}}, {{1, 1, 0}, {2, 2, 3}}},
       7,
       30,
       2,
       std::vector<double>(7, 1)},
      {"bricks",
       {{{0, 0, 0}, {2, 1, 1}},
        {{2, 0, 0}, {4, 1, 1}},
        {{4, 0, 0}, {6, 1, 1}},
        {{1, 0, 1}, {3, 1, 2}},
        {{3, 0, 1}, {5, 1, 2}}},
       10,
       36,
       2,
       std::vector<double>(5, 2)},
      {"plates", {{{0, 0, 0}, {4, 4, 1}}, {{1, 1, 1}, {5, 5, 2}}, {{2, 0, 2}, {6, 4, 3}}}, 48, 108, 2, {16, 16, 16}},
      {"sponge", sponge(), 20, 72, -8, std::vector<double>(20, 1)},
      {"row of cubes", row_of_cubes(40), 40, 162, 2, std::vector<double>(40, 1)},
  };
}

/// Triangles over welded vertices.
struct Triangles {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;

  void add(const PolygonMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& p : mesh.positions) positions.push_back(p);
    for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
      const auto corners = mesh.face(f);
      faces.push_back(
          {VertexId(corners[0].value + first), VertexId(corners[1].value + first), VertexId(corners[2].value + first)});
    }
  }
  void weld() {
    std::map<Vec3, VertexId> known;
    std::vector<VertexId> number;
    std::vector<Vec3> kept;
    for (const Vec3& p : positions) {
      const auto [at, is_new] = known.insert({p, VertexId(kept.size())});
      if (is_new) kept.push_back(p);
      number.push_back(at->second);
    }
    for (Triangle& t : faces)
      for (VertexId& v : t) v = number[v.value];
    positions = kept;
  }
  double tolerance() const {
    Box3 box;
    for (const Vec3& p : positions) box.add(p);
    return 1e-9 * box.diagonal();
  }
};

/// Each part is turned by itself, by arithmetic that depends on its place, so that what touched is off by rounding.
Triangles boxes_as_triangles(const std::vector<Box>& boxes, const Vec3& axis, double angle_deg) {
  Triangles all;
  for (const Box& box : boxes) {
    PolygonMesh mesh = shapes::moved(shapes::box(box.to - box.from), box.from);
    all.add(angle_deg == 0 ? mesh : shapes::rotated(mesh, axis, angle_deg));
  }
  all.weld();
  return all;
}

double volume_under(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)) / 6; }

/// Measures of triangles.
struct Measures {
  double volume = 0, area = 0;
  int euler = 0;
};
Measures measures_of(const Arrangement& arranged) {
  Measures found;
  std::set<std::pair<VertexId, VertexId>> edges;
  std::set<VertexId> vertices;
  for (const Triangle& t : arranged.faces) {
    const Vec3 &a = arranged.positions[t[0].value], &b = arranged.positions[t[1].value],
               &c = arranged.positions[t[2].value];
    found.volume += volume_under(a, b, c);
    found.area += norm(cross(b - a, c - a)) / 2;
    for (std::size_t k = 0; k < 3; ++k) {
      edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
      vertices.insert(t[k]);
    }
  }
  found.euler =
      static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(arranged.faces.size());
  return found;
}

Shells shells_of(const Triangles& input, RunControl& control) {
  const auto begins = triangle_begins(input.faces.size(), control);
  const Adjacency edges(input.positions.size(), begins, corners_of(input.faces), control);
  return find_shells(input.positions, corners_of(input.faces), edges, {}, control);
}

/// The volumes of the cells, ascending, without the one outside. For parts that touch each other.
std::vector<double> volumes_of_cells(const Arrangement& arranged, RunControl& control) {
  const std::vector<std::int32_t> weights(arranged.faces.size(), 0);
  const Cells cells = find_cells({arranged.positions, arranged.faces, weights}, control);
  std::vector<double> volumes(cells.winding.size(), 0);
  for (std::size_t f = 0; f < arranged.faces.size(); ++f) {
    const Triangle& t = arranged.faces[f];
    const double under =
        volume_under(arranged.positions[t[0].value], arranged.positions[t[1].value], arranged.positions[t[2].value]);
    volumes[cells.of_side[2 * f]] -= under;
    volumes[cells.of_side[2 * f + 1]] += under;
  }
  std::erase_if(volumes, [](double v) { return v <= 0; });
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

void expect_no_intersection(const Arrangement& arranged, RunControl& control) {
  EXPECT_FALSE(arranged.is_given_up);
  EXPECT_TRUE(arranged.left.empty());
  const SelfIntersections found =
      self_intersections(arranged.positions, arranged.faces, {}, SearchLimits(1000), control);
  EXPECT_EQ(found.pairs.size(), 0u);
}

/// Returns the triangles as sets of places.
std::set<std::array<Vec3, 3>> places_of(const Arrangement& arranged) {
  std::set<std::array<Vec3, 3>> all;
  for (const Triangle& t : arranged.faces) {
    std::array<Vec3, 3> places;
    for (std::size_t k = 0; k < 3; ++k) places[k] = arranged.positions[t[k].value];
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    all.insert(places);
  }
  return all;
}

TEST(arrangement, boxes_have_the_cells_and_the_union_that_a_grid_counts) {
  RunControl control;
  for (const BoxRow& row : box_rows())
    for (const double angle : {0.0, 17.0, 101.0, 222.5}) {
      SCOPED_TRACE(row.name + ", turned by " + std::to_string(angle));
      const Triangles input = boxes_as_triangles(row.boxes, {1, 2, 5}, angle);
      Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
      expect_no_intersection(arranged, control);
      EXPECT_LE(arranged.moved, input.tolerance());
      const std::vector<double> cells = volumes_of_cells(arranged, control);
      if (row.name != "one in the other") {
        ASSERT_EQ(cells.size(), row.cells.size());
        for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_NEAR(cells[i], row.cells[i], 1e-12);
      }

      const Triangles& solids = input;
      const UnionFaces found =
          find_union(arranged, solids.positions, solids.faces, shells_of(solids, control), control);
      EXPECT_TRUE(found.are_consistent);
      EXPECT_EQ(count_cells(arranged, control), row.cells.size());
      keep_union(arranged, found, control);
      const Measures measures = measures_of(arranged);
      EXPECT_NEAR(measures.volume, row.volume, 1e-12 * row.volume);
      EXPECT_NEAR(measures.area, row.area, 1e-12 * row.area);
      EXPECT_EQ(measures.euler, row.euler);
    }
}

TEST(arrangement, no_two_triangles_meet_by_cgal) {
  RunControl control;
  for (const BoxRow& row : box_rows()) {
    if (row.boxes.size() > 5) continue;
    const Triangles input = boxes_as_triangles(row.boxes, {3, 1, 2}, 61);
    const Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
    const CgalIntersection do_meet(arranged.positions);
    int met = 0;
    for (std::size_t f = 0; f < arranged.faces.size(); ++f)
      for (std::size_t g = f + 1; g < arranged.faces.size(); ++g) met += do_meet(arranged.faces[f], arranged.faces[g]);
    EXPECT_EQ(met, 0) << row.name;
  }
}

TEST(arrangement, a_cavity_stays_and_a_body_that_faces_inwards_is_turned) {
  RunControl control;
  const auto union_of = [&](const PolygonMesh& outer, const PolygonMesh& inner, std::size_t turned) {
    Triangles input;
    input.add(outer);
    input.add(inner);
    Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
    EXPECT_FALSE(arranged.is_changed);
    const UnionFaces found = find_union(arranged, input.positions, input.faces, shells_of(input, control), control);
    EXPECT_EQ(found.turned_shells.size(), turned);
    keep_union(arranged, found, control);
    return measures_of(arranged);
  };
  const PolygonMesh outer = shapes::box(kOne), inner = shapes::moved(shapes::box({.5, .5, .5}), {.25, .25, .25}),
                    beside = shapes::moved(outer, {2, 0, 0});
  EXPECT_NEAR(union_of(outer, shapes::turned_over(inner), 0).volume, 0.875, 1e-15);
  EXPECT_NEAR(union_of(outer, shapes::turned_over(inner), 0).area, 7.5, 1e-15);
  EXPECT_NEAR(union_of(outer, inner, 0).volume, 1, 1e-15);
  EXPECT_NEAR(union_of(outer, shapes::turned_over(beside), 1).volume, 2, 1e-15);
  EXPECT_NEAR(union_of(shapes::turned_over(outer), shapes::turned_over(beside), 2).volume, 2, 1e-15);
}

TEST(arrangement, a_tube_that_crosses_itself_becomes_its_outer_skin) {
  RunControl control;
  // A closed frame of section 1 x 1 along (0,0) (6,0) (6,4) (3,4) (3,-3) (0,-3), with mitred corners.
  const std::vector<Vec2> middle{{0, 0}, {6, 0}, {6, 4}, {3, 4}, {3, -3}, {0, -3}};
  PolygonMesh tube;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<Vec3> positions;
  const std::size_t n = middle.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 before = middle[i] - middle[(i + n - 1) % n], after = middle[(i + 1) % n] - middle[i];
    const auto left_of = [](Vec2 way) {
      const double length = std::hypot(way.x, way.y);
      return Vec2{-way.y / length, way.x / length};
    };
    const Vec2 side = 0.5 * (left_of(before) + left_of(after));  // the corners are right angles
    for (const double z : {0.0, 1.0})
      for (const double sign : {-1.0, 1.0}) {
        const Vec2 p = middle[i] + sign * side;
        positions.push_back({p.x, p.y, z});
      }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 4 * i, b = 4 * ((i + 1) % static_cast<std::uint32_t>(n));
    const std::array<std::uint32_t, 4> ring{0, 1, 3, 2};  // right below, left below, left above, right above
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t p = ring[k], q = ring[(k + 1) % 4];
      faces.push_back({a + p, b + p, b + q});
      faces.push_back({a + p, b + q, a + q});
    }
  }
  Triangles input;
  input.add(shapes::from_lists(positions, faces));
  double volume = 0;
  for (const Triangle& t : input.faces)
    volume += volume_under(input.positions[t[0].value], input.positions[t[1].value], input.positions[t[2].value]);
  if (volume < 0)
    for (Triangle& t : input.faces) std::swap(t[1], t[2]);
  EXPECT_NEAR(std::fabs(volume), 26, 1e-12);
  Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
  expect_no_intersection(arranged, control);
  const UnionFaces found = find_union(arranged, input.positions, input.faces, shells_of(input, control), control);
  keep_union(arranged, found, control);
  const Measures measures = measures_of(arranged);
  EXPECT_NEAR(measures.volume, 25, 1e-12);
  EXPECT_NEAR(measures.area, 98, 1e-12);
  EXPECT_EQ(measures.euler, -2);
}

TEST(arrangement, a_sheet_divides_a_cube_and_goes_with_the_union_inside) {
  RunControl control;
  Triangles input;
  input.add(shapes::box(kOne));
  input.add(shapes::moved(shapes::sheet(3, 3, 1, 1), {-1.1, -.9, .5}));
  Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
  expect_no_intersection(arranged, control);
  const std::vector<double> cells = volumes_of_cells(arranged, control);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_NEAR(cells[0], .5, 1e-12);
  EXPECT_NEAR(cells[1], .5, 1e-12);
  const UnionFaces found = find_union(arranged, input.positions, input.faces, shells_of(input, control), control);
  keep_union(arranged, found, control);
  // The cube has a ring of new edges, and the sheet around it a hole.
  EXPECT_NEAR(measures_of(arranged).area, 6 + 9 - 1, 1e-12);
}

TEST(arrangement, nothing_changes_where_nothing_meets) {
  RunControl control;
  Triangles input;
  input.add(shapes::sphere(3));
  input.add(shapes::moved(shapes::sphere(2), {2.5, 0, 0}));
  const Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
  EXPECT_FALSE(arranged.is_changed);
  EXPECT_EQ(arranged.moved, 0);
  EXPECT_EQ(arranged.faces.size(), input.faces.size());
}

TEST(arrangement, two_triangles_stay_only_if_they_are_apart_by_cgal) {
  RunControl control;
  Random random(6306);
  int stayed = 0, changed = 0;
  for (int i = 0; i < 6000; ++i) {
    // Small integers make triangles that touch, lie in one plane or have corners on one line.
    const bool is_on_grid = i % 2 == 0;
    const auto coordinate = [&] { return is_on_grid ? random.integer(0, 3) + 0.0 : random.uniform(0, 1); };
    const std::uint32_t shared = static_cast<std::uint32_t>(i / 2 % 3);
    Triangles input;
    for (std::uint32_t v = 0; v < 6 - shared; ++v)
      input.positions.push_back({coordinate(), coordinate(), coordinate()});
    input.faces = {{VertexId(0), VertexId(1), VertexId(2)},
                   {VertexId(shared > 0 ? 0 : 3), VertexId(shared > 1 ? 1 : 4 - shared), VertexId(5 - shared)}};
    const CgalIntersection test(input.positions);
    const std::set<Vec3> different(input.positions.begin(), input.positions.end());
    if (different.size() < input.positions.size() || !test.has_area(input.faces[0]) || !test.has_area(input.faces[1]))
      continue;
    const bool do_meet = test(input.faces[0], input.faces[1]);
    const Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
    EXPECT_EQ(arranged.is_changed, do_meet) << "case " << i;
    ++(arranged.is_changed ? changed : stayed);
  }
  EXPECT_GT(stayed, 1000);
  EXPECT_GT(changed, 1000);
}

/// A convex solid, as polygons.
using Faces3 = std::vector<std::vector<Vec3>>;

/// Cuts a convex solid at a plane, and keeps the part where the distance is not positive.
Faces3 clipped(const Faces3& solid, const Vec3& normal, double offset) {
  Faces3 left;
  std::vector<Vec3> rim;
  for (const std::vector<Vec3>& face : solid) {
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 &p = face[i], &q = face[(i + 1) % face.size()];
      const double at_p = dot(normal, p) - offset, at_q = dot(normal, q) - offset;
      if (at_p <= 0) kept.push_back(p);
      if ((at_p <= 0) != (at_q <= 0)) {
        const Vec3 cut = p + (at_p / (at_p - at_q)) * (q - p);
        kept.push_back(cut);
        rim.push_back(cut);
      }
    }
    if (kept.size() > 2) left.push_back(kept);
  }
  if (rim.size() < 3) return left;
  // The cut is a convex polygon around the middle of its corners.
  Vec3 middle{};
  for (const Vec3& p : rim) middle += (1.0 / static_cast<double>(rim.size())) * p;
  const Vec3 x = (1 / norm(rim[0] - middle)) * (rim[0] - middle), y = cross(normal, x);
  std::sort(rim.begin(), rim.end(), [&](const Vec3& p, const Vec3& q) {
    return std::atan2(dot(p - middle, y), dot(p - middle, x)) < std::atan2(dot(q - middle, y), dot(q - middle, x));
  });
  left.push_back(rim);
  return left;
}

double volume_of(const Faces3& solid) {
  double volume = 0;
  for (const std::vector<Vec3>& face : solid)
    for (std::size_t i = 1; i + 1 < face.size(); ++i) volume += volume_under(face[0], face[i], face[i + 1]);
  return volume;
}

TEST(arrangement, unions_of_convex_solids_have_the_volume_that_clipping_gives) {
  RunControl control;
  Random random(base_seed(20261));
  const auto vector = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  const auto solid = [&] {
    const int kind = random.below(3);
    PolygonMesh mesh = kind == 0   ? shapes::box({random.uniform(.5, 2), random.uniform(.5, 2), random.uniform(.5, 2)})
                       : kind == 1 ? shapes::sphere(random.below(2))
                                   : shapes::fan_triangulated(shapes::cylinder(5, 1, 2));
    return shapes::moved(shapes::rotated(mesh, vector(), random.uniform(0, 360)), vector());
  };
  for (int run = 0; run < 150; ++run) {
    SCOPED_TRACE(run);
    const PolygonMesh a = solid(), b = solid();
    Faces3 common, of_b;
    for (FaceId f(0); f.value < a.face_count(); ++f.value) {
      common.emplace_back();
      for (const VertexId v : a.face(f)) common.back().push_back(a.positions[v]);
    }
    for (FaceId f(0); f.value < b.face_count(); ++f.value) {
      of_b.emplace_back();
      for (const VertexId v : b.face(f)) of_b.back().push_back(b.positions[v]);
    }
    const double sum = volume_of(common) + volume_of(of_b);
    std::vector<std::pair<Vec3, double>> planes;
    for (const std::vector<Vec3>& face : of_b) {
      const Vec3 normal = cross(face[1] - face[0], face[2] - face[0]);
      const Vec3 unit = (1 / norm(normal)) * normal;
      const double offset = dot(unit, face[0]);
      // Triangles of one plane would cut twice, at random.
      if (std::none_of(planes.begin(), planes.end(), [&](const auto& plane) {
            return norm(plane.first - unit) < 1e-9 && std::fabs(plane.second - offset) < 1e-9;
          })) {
        planes.push_back({unit, offset});
        common = clipped(common, unit, offset);
      }
    }
    Triangles input;
    input.add(a);
    input.add(b);
    Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
    expect_no_intersection(arranged, control);
    EXPECT_EQ(arranged.rounds, 0u);
    const UnionFaces found = find_union(arranged, input.positions, input.faces, shells_of(input, control), control);
    EXPECT_TRUE(found.are_consistent);
    keep_union(arranged, found, control);
    EXPECT_NEAR(measures_of(arranged).volume, sum - volume_of(common), 1e-9);
  }
}

TEST(arrangement, the_triangles_do_not_depend_on_the_order_of_the_input_or_on_the_workers) {
  RunControl control;
  Random random(base_seed(7));
  Triangles input = boxes_as_triangles(box_rows()[10].boxes, {1, 1, 3}, 40);
  input.add(shapes::moved(shapes::sphere(3), {1.4, 1.3, 1.2}));
  input.weld();
  const Arrangement first = arrange(input.positions, input.faces, input.tolerance(), control);
  expect_no_intersection(first, control);
  Triangles shuffled;
  std::vector<std::uint32_t> order(input.positions.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  shuffled.positions.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.positions[order[i]] = input.positions[i];
  for (const Triangle& t : input.faces)
    shuffled.faces.insert(shuffled.faces.begin(),
                          {VertexId(order[t[1].value]), VertexId(order[t[2].value]), VertexId(order[t[0].value])});
  EXPECT_EQ(places_of(arrange(shuffled.positions, shuffled.faces, input.tolerance(), control)), places_of(first));
  for (const int workers : {1, 8}) {
    tbb::task_arena arena(workers);
    const Arrangement again =
        arena.execute([&] { return arrange(input.positions, input.faces, input.tolerance(), control); });
    EXPECT_EQ(again.faces, first.faces);
    EXPECT_EQ(again.positions, first.positions);
    EXPECT_EQ(again.covers, first.covers);
  }
}

TEST(arrangement, parts_that_are_off_by_a_fifth_of_the_tolerance_are_joined_as_if_they_touched) {
  RunControl control;
  Random random(base_seed(99));
  for (const BoxRow& row : box_rows()) {
    if (row.boxes.size() > 5 || row.name == "one in the other" || row.name == "twice the same") continue;
    SCOPED_TRACE(row.name);
    const Triangles exact = boxes_as_triangles(row.boxes, {1, 2, 3}, 33);
    const std::size_t faces = arrange(exact.positions, exact.faces, exact.tolerance(), control).faces.size();
    for (int run = 0; run < 10; ++run) {
      Triangles input;
      for (const Box& box : row.boxes) {
        PolygonMesh mesh = shapes::rotated(shapes::moved(shapes::box(box.to - box.from), box.from), {1, 2, 3}, 33);
        const double jitter = exact.tolerance() / 5 / std::sqrt(3);
        input.add(shapes::moved(mesh, {random.uniform(-jitter, jitter) / 2, random.uniform(-jitter, jitter) / 2,
                                       random.uniform(-jitter, jitter) / 2}));
      }
      const Arrangement arranged = arrange(input.positions, input.faces, input.tolerance(), control);
      expect_no_intersection(arranged, control);
      EXPECT_EQ(arranged.faces.size(), faces);
    }
  }
}

// The points of a curve are rounded, so three of them are the corners of a flat triangle. Of these cubes, none of whose
// faces are joined, some would have such a triangle that passes the middle one of its corners with its long side.
TEST(arrangement, rounded_points_of_a_curve_leave_no_triangles_that_cross) {
  RunControl control;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto direction = [&] {
      const Vec3 v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      return (1 / norm(v)) * v;
    };
    const Vec3 axis = direction();
    const double angle = random.uniform(0, 360), tolerance = 1e-9 * 3 * std::sqrt(3);
    Triangles input;
    for (int i = 0; i < 27; ++i) {
      const PolygonMesh cube = shapes::moved(shapes::box({1, 1, 1}), {i % 3 + 0., i / 3 % 3 + 0., i / 9 + 0.});
      input.add(shapes::moved(shapes::rotated(cube, axis, angle), tolerance * direction()));
    }
    const Arrangement arranged = arrange(input.positions, input.faces, tolerance, control, 0x1p-16);
    expect_no_intersection(arranged, control);
    EXPECT_GT(arranged.curves, 100u);
  }
}

TEST(arrangement, what_went_wrong_says_with_which_share_of_the_distance_to_go_on) {
  using Fault = ArrangementFault;
  const std::optional<double> nothing, half = 0.5, sixteenth = 0x1p-4, smallest = 0x1p-16;
  const struct {
    double share;
    Fault fault;
    std::optional<double> next;
  } rows[] = {{1, Fault::kNone, nothing},        {1, Fault::kMovesTooFar, half},
              {1, Fault::kFails, sixteenth},     {1, Fault::kTooMuch, smallest},
              {0.5, Fault::kNone, nothing},      {0.5, Fault::kMovesTooFar, sixteenth},
              {0.5, Fault::kFails, sixteenth},   {0.5, Fault::kTooMuch, smallest},
              {0x1p-4, Fault::kNone, nothing},   {0x1p-4, Fault::kMovesTooFar, nothing},
              {0x1p-4, Fault::kFails, smallest}, {0x1p-4, Fault::kTooMuch, smallest},
              {0x1p-16, Fault::kNone, nothing},  {0x1p-16, Fault::kMovesTooFar, nothing},
              {0x1p-16, Fault::kFails, nothing}, {0x1p-16, Fault::kTooMuch, nothing}};
  for (const auto& row : rows)
    EXPECT_EQ(next_share(row.share, row.fault), row.next) << row.share << ' ' << static_cast<int>(row.fault);
}

TEST(arrangement, it_stops_when_it_is_cancelled) {
  Triangles input;
  input.add(shapes::sphere(4));
  input.add(shapes::moved(shapes::sphere(4), {.5, .4, .3}));
  RunControl control;
  control.cancel();
  EXPECT_THROW(arrange(input.positions, input.faces, input.tolerance(), control), Error);
}

}  // namespace
}  // namespace remesh
