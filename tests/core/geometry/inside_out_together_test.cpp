// Tests shells that look the wrong way in bodies whose surfaces are closed only together, or not at all.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "core/geometry/shells/inside_out.h"
#include "core/mesh/adjacency.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// Returns the numbers of the objects of which faces are said to look the wrong way.
std::set<std::uint32_t> wrong_objects(const PolygonMesh& mesh, const std::vector<std::uint32_t>& label_of_object) {
  RunControl control;
  const Adjacency edges(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  BodyLabels labels;
  if (!label_of_object.empty()) {
    for (std::uint32_t n = 0; n <= *std::max_element(label_of_object.begin(), label_of_object.end()); ++n) {
      labels.labels.push_back(n);
      labels.begin.push_back(n + 1);
    }
    for (const std::uint32_t object : mesh.labels.object.of_face) labels.set_of.push_back(label_of_object[object]);
  }
  const InsideOut found = find_inside_out(mesh.positions.items(), mesh.corners, edges, labels, control);
  std::set<std::uint32_t> wrong;
  for (std::uint32_t f = 0; f < found.is_inside_out.size(); ++f)
    if (found.is_inside_out[f]) wrong.insert(mesh.labels.object.of_face[FaceId(f)]);
  return wrong;
}

/// A mesh put together of objects.
class Builder {
 public:
  std::uint32_t add_object() { return objects_++; }
  void add(std::uint32_t object, const PolygonMesh& part) {
    mesh_ = mesh_.face_count() == 0 ? part : shapes::joined(mesh_, part);
    for (std::size_t f = 0; f < part.face_count(); ++f) of_face_.push_back(object);
  }
  /// Adds a square of two triangles across an axis. It looks along the axis or against it.
  void add_square(std::uint32_t object, const Vec3& corner, int axis, bool looks_along) {
    Vec3 u, v;
    u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
    const PolygonMesh square =
        shapes::from_lists({corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}});
    add(object, looks_along ? square : shapes::turned_over(square));
  }
  PolygonMesh mesh() const {
    PolygonMesh mesh = mesh_;
    mesh.labels.object.names.resize(objects_);
    for (const std::uint32_t object : of_face_) mesh.labels.object.of_face.push_back(object);
    return shapes::welded(mesh);
  }

 private:
  PolygonMesh mesh_;
  std::vector<std::uint32_t> of_face_;
  std::uint32_t objects_ = 0;
};

/// A small shell in the middle of a unit cell.
void add_shell(Builder& builder, std::uint32_t object, const std::array<int, 3>& cell, bool is_out) {
  const PolygonMesh cube =
      shapes::moved(shapes::box({0.25, 0.25, 0.25}), {cell[0] + 0.375, cell[1] + 0.375, cell[2] + 0.375});
  builder.add(object, is_out ? cube : shapes::turned_over(cube));
}

/// Cells of a grid. Each cell belongs to one of some bodies or to none, and may contain a small shell. Where two bodies
/// meet, each has a wall of its own. Object 0 is the walls of all bodies.
class Cells {
 public:
  explicit Cells(std::uint64_t seed) : random_(seed) {
    for (auto& plane : body_)
      for (auto& row : plane)
        for (int& body : row) body = random_.integer(-1, 2);
    builder.add_object();
    for (int x = -1; x < kSize; ++x)
      for (int y = -1; y < kSize; ++y)
        for (int z = -1; z < kSize; ++z) {
          for (int axis = 0; axis < 3; ++axis) add_walls({x, y, z}, axis);
          if (!random_.chance(0.7)) continue;
          const std::uint32_t object = builder.add_object();
          const bool is_out = random_.chance(0.5);
          add_shell(builder, object, {x, y, z}, is_out);
          if (is_out == (body({x, y, z}) >= 0)) wrong.insert(object);
        }
  }

  Builder builder;
  std::set<std::uint32_t> wrong;  ///< the objects that look the wrong way

 private:
  static constexpr int kSize = 3;
  using Place = std::array<int, 3>;

  int body(const Place& p) const {
    if (std::any_of(p.begin(), p.end(), [](int i) { return i < 0 || i >= kSize; })) return -1;
    return body_[static_cast<std::size_t>(p[0])][static_cast<std::size_t>(p[1])][static_cast<std::size_t>(p[2])];
  }
  /// Adds the walls between a cell and the next one along an axis.
  void add_walls(const Place& at, int axis) {
    Place next = at;
    Vec3 corner{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
    ++next[static_cast<std::size_t>(axis)];
    corner[axis] += 1;
    const int before = body(at), behind = body(next);
    if (before == behind) return;
    if (before >= 0) builder.add_square(0, corner, axis, true);
    if (behind >= 0) builder.add_square(0, corner, axis, false);
  }

  Random random_;
  std::array<std::array<std::array<int, kSize>, kSize>, kSize> body_{};
};

PolygonMesh placed_anyhow(const PolygonMesh& mesh, unsigned i) {
  const double scale = i % 3 == 0 ? 1 : 3e-5;
  return shapes::scaled(shapes::moved(shapes::rotated(shapes::renumbered(mesh, i), {1, 2, 3}, 7.0 * (i % 5)),
                                      {i % 4 == 0 ? 0.0 : 5, 0, 0}),
                        scale);
}

TEST(find_inside_out, in_bodies_with_a_wall_each_between_them_cavities_are_judged_as_in_single_ones) {
  const std::uint64_t seed = base_seed(3602);
  for (unsigned i = 0; i < 60; ++i) {
    const Cells cells(seed + i);
    EXPECT_EQ(wrong_objects(placed_anyhow(cells.builder.mesh(), i), {}), cells.wrong) << i;
  }
}

TEST(find_inside_out, in_chambers_with_one_wall_between_them_nothing_right_is_called_wrong) {
  const std::uint64_t seed = base_seed(3603);
  std::size_t wrong_in_all = 0, named_in_all = 0;
  for (unsigned i = 0; i < 60; ++i) {
    Random random(seed + i);
    // A row of chambers, or two by two. Each wall belongs to the one or the other.
    const std::array<int, 3> size = i % 2 == 0 ? std::array{random.integer(2, 6), 1, 1} : std::array{2, 2, 1};
    Builder builder;
    std::set<std::uint32_t> wrong;
    builder.add_object();
    for (int x = 0; x <= size[0]; ++x)
      for (int y = 0; y <= size[1]; ++y)
        for (int z = 0; z <= size[2]; ++z) {
          const std::array<int, 3> cell{x, y, z};
          const auto is_in = [&](std::size_t axis) { return cell[axis] < size[axis]; };
          for (std::size_t axis = 0; axis < 3; ++axis)
            if (is_in((axis + 1) % 3) && is_in((axis + 2) % 3)) {
              const bool looks_along = !is_in(axis) || (cell[axis] > 0 && random.chance(0.5));
              builder.add_square(0, {1.0 * x, 1.0 * y, 1.0 * z}, static_cast<int>(axis), looks_along);
            }
          // The shell is in a chamber, or outside of all bodies.
          const std::uint32_t object = builder.add_object();
          const bool is_out = random.chance(0.5), is_in_chamber = is_in(0) && is_in(1) && is_in(2);
          add_shell(builder, object, is_in_chamber ? cell : std::array{x + 5, y, z}, is_out);
          if (is_out == is_in_chamber) wrong.insert(object);
        }
    const std::set<std::uint32_t> named = wrong_objects(placed_anyhow(builder.mesh(), i), {});
    EXPECT_TRUE(std::includes(wrong.begin(), wrong.end(), named.begin(), named.end())) << i;
    wrong_in_all += wrong.size();
    named_in_all += named.size();
  }
  EXPECT_GT(2 * named_in_all, wrong_in_all) << "not all is in doubt";
}

/// Makes a cube about the origin.
PolygonMesh cube(double size, bool is_out = true) {
  const PolygonMesh mesh = shapes::moved(shapes::box({size, size, size}, 2), {-size / 2, -size / 2, -size / 2});
  return is_out ? mesh : shapes::turned_over(mesh);
}

TEST(find_inside_out, in_a_body_with_faces_missing_a_shell_is_not_judged_but_outside_of_it_is) {
  for (const std::size_t missing : {1u, 4u, 8u}) {
    PolygonMesh open = cube(4);
    open.corners.resize(open.corners.size() - 3 * missing);
    open.face_begin.resize(open.face_begin.size() - missing);
    Builder builder;
    const std::uint32_t outer = builder.add_object(), cavity = builder.add_object(), body = builder.add_object(),
                        beside = builder.add_object(), hollow = builder.add_object(), hole = builder.add_object();
    builder.add(outer, open);
    builder.add(cavity, shapes::moved(cube(1, false), {-1, 0, 0}));
    builder.add(body, shapes::moved(cube(0.5), {1, 1, 1}));
    builder.add(beside, shapes::moved(cube(1, false), {9, 0, 0}));
    builder.add(hollow, shapes::moved(cube(1), {1, -1, -1}));
    builder.add(hole, shapes::moved(cube(0.5), {1, -1, -1}));
    for (unsigned i = 0; i < 6; ++i)
      EXPECT_EQ(wrong_objects(placed_anyhow(builder.mesh(), i), {}), (std::set{beside, hole})) << missing;
  }
}

TEST(find_inside_out, a_body_that_is_there_twice_is_the_same_body_once_more) {
  // The second one has the other diagonals.
  const PolygonMesh once = shapes::fan_triangulated(shapes::quad_box({4, 4, 4}));
  const PolygonMesh again = shapes::fan_triangulated(shapes::renumbered(shapes::quad_box({4, 4, 4}), 1));
  Builder builder;
  const std::uint32_t outer = builder.add_object(), right = builder.add_object(), wrong = builder.add_object();
  builder.add(outer, once);
  builder.add(outer, again);
  builder.add(right, shapes::moved(cube(1, false), {1, 1, 1}));
  builder.add(wrong, shapes::moved(cube(1), {3, 3, 3}));
  for (unsigned i = 0; i < 10; ++i)
    EXPECT_EQ(wrong_objects(placed_anyhow(builder.mesh(), i), {}), std::set{wrong}) << i;
}

}  // namespace
}  // namespace remesh
