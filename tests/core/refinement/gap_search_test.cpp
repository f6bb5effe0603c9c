#include "core/refinement/sizes/gap_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "core/geometry/triangles/distances.h"
#include "tests/support/cgal_space.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-6;

struct Scene {
  explicit Scene(const PolygonMesh& mesh)
      : chain(mesh, kTolerance), gaps(chain.surface, chain.adjacency, chain.patches, kTolerance, chain.control) {}

  /// Returns the gap at a place on the patch that an input face belongs to.
  double at(std::size_t input_face, const Vec3& place, double limit = kFar) const {
    return gaps.at(place, chain.patch_of(input_face), limit);
  }
  std::optional<double> smallest() const { return gaps.smallest(chain.control); }

  StageChain chain;
  GapSearch gaps;
};

/// Follows the rule word for word. It looks at every triangle of every other patch, and at every vertex and edge that
/// two patches share.
class BruteForce {
 public:
  explicit BruteForce(const Scene& scene) : scene_(scene) {
    const StageChain& chain = scene.chain;
    vertices_.resize(scene.gaps.patch_count());
    edges_.resize(scene.gaps.patch_count());
    for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f) {
      const PatchId p = chain.patches.of_face[FaceId(f)];
      const auto loop = chain.surface.face(FaceId(f));
      for (std::size_t i = 0; i < loop.size(); ++i) {
        vertices_[p.value].insert(loop[i]);
        edges_[p.value].insert(std::minmax(loop[i], loop[(i + 1) % loop.size()]));
      }
    }
    find_solids();
    find_sides();
  }

  double at(const Vec3& place, PatchId p) const {
    double least = kFar;
    for (std::size_t q = 0; q < scene_.gaps.patch_count(); ++q) {
      if (PatchId(q) == p) continue;
      for (const Triangle& t : scene_.gaps.triangles_of(PatchId(q))) {
        if (std::sqrt(cgal_squared_distance(place, corners(t))) > least) continue;
        const Vec3 nearest = nearest_on(place, t);
        const double d = norm(nearest - place);
        if (is_steep(nearest - place, p) && !is_blocked(nearest - place, p, PatchId(q)) && d > kTolerance &&
            d < least && 3 * d < way(place, p, nearest, PatchId(q)) && !is_across_wedge(place, p, nearest, PatchId(q)))
          least = d;
      }
    }
    return least;
  }

  /// Over all pairs of patches that share no vertex and do not touch.
  double smallest_between_strangers() const {
    double least = kFar;
    for (std::uint32_t p = 0; p < scene_.gaps.patch_count(); ++p)
      for (std::uint32_t q = p + 1; q < scene_.gaps.patch_count(); ++q) {
        if (!shared(vertices_[p], vertices_[q]).empty()) continue;
        for (const Triangle& s : scene_.gaps.triangles_of(PatchId(p)))
          for (const Triangle& t : scene_.gaps.triangles_of(PatchId(q))) {
            const Vec3 way = shortest_way(corners(s), corners(t));
            if (norm(way) > kTolerance && !is_blocked(way, PatchId(p), PatchId(q)) &&
                (is_steep(way, PatchId(p)) || is_steep(way, PatchId(q))))
              least = std::min(least, norm(way));
          }
      }
    return least;
  }

 private:
  const Vec3& position(VertexId v) const { return scene_.chain.surface.positions[v]; }
  Corners3 corners(const Triangle& t) const { return {position(t[0]), position(t[1]), position(t[2])}; }
  /// At more than 51 degrees above the patch.
  bool is_steep(const Vec3& way, PatchId p) const {
    return std::fabs(dot(way, scene_.chain.patches.planes[p].normal)) > std::sqrt(0.604) * norm(way);
  }

  /// Finds the solids. Faces that share edges are one piece. It is a solid if each of its edges is used once in each
  /// direction.
  void find_solids() {
    const StageChain& chain = scene_.chain;
    std::map<std::pair<VertexId, VertexId>, std::vector<std::uint32_t>> runs;  // faces by directed edge
    std::vector<std::uint32_t> piece(chain.surface.face_count());
    for (std::uint32_t f = 0; f < piece.size(); ++f) {
      piece[f] = f;
      const auto loop = chain.surface.face(FaceId(f));
      for (std::size_t i = 0; i < loop.size(); ++i) runs[{loop[i], loop[(i + 1) % loop.size()]}].push_back(f);
    }
    std::set<std::uint32_t> open;
    for (bool is_new = true; is_new;) {
      is_new = false;
      for (const auto& [edge, faces] : runs) {
        const auto back = runs.find({edge.second, edge.first});
        if (faces.size() != 1 || back == runs.end() || back->second.size() != 1) open.insert(faces[0]);
        std::vector<std::uint32_t> all = faces;
        if (back != runs.end()) all.insert(all.end(), back->second.begin(), back->second.end());
        for (const std::uint32_t f : all)
          for (const std::uint32_t g : all)
            if (piece[f] < piece[g]) {
              piece[g] = piece[f];
              is_new = true;
            }
      }
    }
    std::set<std::uint32_t> open_pieces;
    for (const std::uint32_t f : open) open_pieces.insert(piece[f]);
    solid_.resize(scene_.gaps.patch_count());
    for (std::uint32_t f = 0; f < piece.size(); ++f)
      solid_[chain.patches.of_face[FaceId(f)].value] = open_pieces.count(piece[f]) ? -1 : static_cast<int>(piece[f]);
  }
  /// Returns whether the way leads inwards from p and comes to q from outside, or outwards from p and comes to q from
  /// inside, where both belong to one solid.
  bool is_blocked(const Vec3& way, PatchId p, PatchId q) const {
    if (solid_[p.value] < 0 || solid_[p.value] != solid_[q.value]) return false;
    const auto side = [&](PatchId of) { return dot(way, scene_.chain.patches.planes[of].normal); };
    return (side(p) > 0 && side(q) > 0) || (side(p) < 0 && side(q) < 0);
  }

  /// Returns the direction that leads from an edge into a face of a patch.
  Vec3 inwards(PatchId p, VertexId from, VertexId to) const {
    return normalized(cross(scene_.chain.patches.planes[p].normal, position(to) - position(from)));
  }
  /// Gives the patches that turn by less than 30 degrees over an edge the same side.
  void find_sides() {
    const StageChain& chain = scene_.chain;
    for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f) {
      const auto loop = chain.surface.face(FaceId(f));
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const VertexId v = loop[i], w = loop[(i + 1) % loop.size()];
        const PatchId p = chain.patches.of_face[FaceId(f)];
        into_[std::minmax(v, w)].push_back({p, inwards(p, v, w)});
      }
    }
    side_.resize(scene_.gaps.patch_count());
    for (std::size_t p = 0; p < side_.size(); ++p) side_[p] = p;
    for (bool is_new = true; is_new;) {
      is_new = false;
      for (const auto& [edge, around] : into_)
        for (const auto& [p, out] : around)
          for (const auto& [q, there] : around)
            if (p != q && dot(out, there) < -std::cos(std::numbers::pi / 6) && side_[p.value] < side_[q.value]) {
              side_[q.value] = side_[p.value];
              is_new = true;
            }
    }
  }
  /// Returns whether the way leads from one side of an edge with an angle below 60 degrees to the other, and is not
  /// much shorter than the way over the edge.
  bool is_across_wedge(const Vec3& from, PatchId p, const Vec3& to, PatchId q) const {
    for (const auto& [edge, around] : into_)
      for (const auto& [a, out] : around)
        for (const auto& [b, there] : around) {
          const double angle = std::acos(std::clamp(dot(out, there), -1.0, 1.0));
          const bool is_between = side_[a.value] == side_[p.value] && side_[b.value] == side_[q.value];
          if (a == b || !is_between || angle > std::numbers::pi / 3) continue;
          const auto over = [&, v = edge.first, w = edge.second](double s) {
            const Vec3 c = position(v) + s * (position(w) - position(v));
            return norm(c - from) + norm(c - to);
          };
          if (over(argmin(over)) < 2 / std::sin(angle / 2) * norm(to - from)) return true;
        }
    return false;
  }

  /// By halving: the distance is convex along every line.
  template <class Function>
  static double argmin(const Function& function) {
    double low = 0, high = 1;
    for (int i = 0; i < 80; ++i) {
      const double a = low + (high - low) / 3, b = high - (high - low) / 3;
      (function(a) < function(b) ? high : low) = function(a) < function(b) ? b : a;
    }
    return 0.5 * (low + high);
  }
  Vec3 nearest_on(const Vec3& place, const Triangle& t) const {
    const Vec3 &a = position(t[0]), &b = position(t[1]), &c = position(t[2]);
    const Vec3 normal = cross(b - a, c - a);
    const Vec3 foot = place - (dot(place - a, normal) / dot(normal, normal)) * normal;
    if (std::abs(std::sqrt(cgal_squared_distance(place, corners(t))) - norm(foot - place)) < 1e-12) return foot;
    Vec3 nearest = a;
    for (int i = 0; i < 3; ++i) {
      const Vec3 &from = position(t[i]), &to = position(t[(i + 1) % 3]);
      const auto on = [&](double s) { return from + s * (to - from); };
      const Vec3 q = on(argmin([&](double s) { return norm(on(s) - place); }));
      if (norm(q - place) < norm(nearest - place)) nearest = q;
    }
    return nearest;
  }

  template <class Set>
  static std::vector<typename Set::value_type> shared(const Set& a, const Set& b) {
    std::vector<typename Set::value_type> both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
  }
  double way(const Vec3& from, PatchId p, const Vec3& to, PatchId q) const {
    double least = kFar;
    for (const VertexId v : shared(vertices_[p.value], vertices_[q.value]))
      least = std::min(least, norm(position(v) - from) + norm(position(v) - to));
    for (const auto& [v, w] : shared(edges_[p.value], edges_[q.value])) {
      const auto over = [&, v = v, w = w](double s) {
        const Vec3 c = position(v) + s * (position(w) - position(v));
        return norm(c - from) + norm(c - to);
      };
      least = std::min(least, over(argmin(over)));
    }
    return least;
  }

  const Scene& scene_;
  std::vector<std::set<VertexId>> vertices_;
  std::vector<std::set<std::pair<VertexId, VertexId>>> edges_;
  std::map<std::pair<VertexId, VertexId>, std::vector<std::pair<PatchId, Vec3>>> into_;  ///< by edge
  std::vector<std::size_t> side_;                                                        ///< one per patch
  std::vector<int> solid_;  ///< one per patch; -1 if the patch belongs to no solid
};

PolygonMesh cube_in_cube() {
  return shapes::joined(shapes::box({1, 1, 1}, 2),
                        shapes::turned_over(shapes::moved(shapes::box({0.9, 0.9, 0.9}, 3), {0.05, 0.05, 0.05})));
}
/// Makes a prism over a triangle with this angle at the origin and two sides of length 1. Its caps are the faces 0 and
/// 1, and its sides the faces 2, 3 and 4, of which the first lies in y = 0.
PolygonMesh wedge(double degrees, double length) {
  const double a = degrees * std::numbers::pi / 180;
  return shapes::prism({{0, 0}, {1, 0}, {std::cos(a), std::sin(a)}}, length);
}
std::size_t face_through(const PolygonMesh& mesh, const std::vector<Vec3>& points) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto loop = mesh.face(FaceId(f));
    if (std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
          return std::any_of(loop.begin(), loop.end(), [&](VertexId v) { return norm(mesh.positions[v] - p) < 1e-12; });
        }))
      return f;
  }
  throw std::invalid_argument("no such face");
}
PolygonMesh random_boxes(int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  PolygonMesh mesh;
  for (int i = 0; i < 5; ++i) {
    const Vec3 size{random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
    const Vec3 place{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    PolygonMesh box = shapes::rotated(shapes::box(size, 1 + random.below(3)),
                                      {random.uniform(-1, 1), random.uniform(-1, 1), 1}, random.uniform(0, 360));
    mesh = i == 0 ? shapes::moved(box, place) : shapes::joined(mesh, shapes::moved(box, place));
  }
  return mesh;
}

TEST(gap_search, parallel_plates_see_each_other) {
  const Scene scene(shapes::joined(shapes::sheet(4, 4, 3, 3), shapes::moved(shapes::sheet(4, 4, 2, 2), {0, 0, 0.25})));
  EXPECT_DOUBLE_EQ(scene.at(0, {1.7, 2.1, 0}), 0.25);
  EXPECT_DOUBLE_EQ(scene.at(0, {0, 4, 0}), 0.25);
  EXPECT_EQ(scene.smallest(), 0.25);
}

TEST(gap_search, a_gap_that_is_not_below_the_limit_is_none) {
  const Scene scene(shapes::joined(shapes::sheet(4, 4, 1, 1), shapes::moved(shapes::sheet(4, 4, 1, 1), {0, 0, 0.25})));
  EXPECT_EQ(scene.at(0, {1, 1, 0}, 0.26), 0.25);
  EXPECT_EQ(scene.at(0, {1, 1, 0}, 0.25), kFar);
}

TEST(gap_search, the_wall_of_a_hollow_cube_is_its_gap) {
  const Scene scene(cube_in_cube());
  EXPECT_NEAR(*scene.smallest(), 0.05, 1e-12);
}

TEST(gap_search, a_cube_sees_its_other_side_and_no_neighbour) {
  const PolygonMesh mesh = shapes::quad_box({1, 1, 1});
  const Scene scene(mesh);
  const std::size_t bottom = face_through(mesh, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  for (const double x : {0.5, 0.1, 0.001}) EXPECT_DOUBLE_EQ(scene.at(bottom, {x, 0.5, 0}), 1);
  EXPECT_EQ(scene.smallest(), 1);
}

TEST(gap_search, a_single_sheet_and_a_tetrahedron_have_no_gap) {
  EXPECT_EQ(Scene(shapes::sheet(1, 1, 2, 2)).smallest(), std::nullopt);
  EXPECT_EQ(Scene(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}))
                .smallest(),
            std::nullopt);
}

TEST(gap_search, the_two_arms_of_an_L_do_not_see_each_other_and_a_U_does) {
  const PolygonMesh l = shapes::l_bracket(2);
  EXPECT_EQ(Scene(l).smallest(), 1);  // across the arms
  // A U with a slot 1/8 wide.
  const std::vector<Vec2> outline = {{0, 0}, {2, 0}, {2, 2}, {1.125, 2}, {1.125, 1}, {1, 1}, {1, 2}, {0, 2}};
  const PolygonMesh u = shapes::prism(outline, 1);
  const Scene scene(u);
  const std::size_t wall = face_through(u, {{1, 1, 0}, {1, 2, 0}, {1, 1, 1}, {1, 2, 1}});
  EXPECT_EQ(scene.smallest(), 0.125);
  EXPECT_DOUBLE_EQ(scene.at(wall, {1, 1.5, 0.5}), 0.125);
  EXPECT_DOUBLE_EQ(scene.at(wall, {1, 1.001, 0.001}), 0.125);
  const std::size_t floor = face_through(u, {{1, 1, 0}, {1.125, 1, 0}, {1, 1, 1}});
  EXPECT_DOUBLE_EQ(scene.at(floor, {1.0625, 1, 0.5}), 1);  // the bottom: not the walls, not a side that is nearer
}

TEST(gap_search, a_step_of_a_Z_is_the_gap_between_the_sheets_it_joins) {
  const Scene scene(shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0.1}, {1, 1, 0.1}, {0, 0, 0.1}, {0, 1, 0.1}},
      {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}}));
  EXPECT_DOUBLE_EQ(scene.at(0, {0.5, 0.5, 0}), 0.1);
  EXPECT_DOUBLE_EQ(scene.at(2, {0.99, 0.5, 0.1}), 0.1);
  EXPECT_EQ(scene.at(1, {1, 0.5, 0.05}), kFar);
  EXPECT_DOUBLE_EQ(*scene.smallest(), 0.1);
}

TEST(gap_search, the_treads_of_a_step_are_no_gap_and_a_thin_wall_is) {
  const std::vector<Vec2> outline = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 1.125}, {0, 1.125}};
  const PolygonMesh step = shapes::prism(outline, 1);
  const Scene scene(step);
  const std::size_t low = face_through(step, {{1, 1, 0}, {2, 1, 0}, {1, 1, 1}});
  const std::size_t high = face_through(step, {{1, 1.125, 0}, {0, 1.125, 0}, {1, 1.125, 1}});
  for (const double x : {1.5, 1.01}) EXPECT_DOUBLE_EQ(scene.at(low, {x, 1, 0.5}), 1);
  for (const double x : {0.5, 0.99}) EXPECT_DOUBLE_EQ(scene.at(high, {x, 1.125, 0.5}), 1.125);
  EXPECT_EQ(scene.smallest(), 1);
  // Turned inside out it is the same; without the riser there are two sheets.
  EXPECT_EQ(Scene(shapes::turned_over(step)).smallest(), 1);
  EXPECT_EQ(Scene(shapes::prism({{0, 0}, {2, 0}, {2, 0.125}, {0, 0.125}}, 1)).smallest(), 0.125);
}

TEST(gap_search, faces_that_meet_at_an_edge_are_no_gap_at_any_angle) {
  for (const double degrees : {0.005, 5.0, 30.0, 36.0, 39.0, 45.0, 60.0, 90.0}) {
    const PolygonMesh mesh = wedge(degrees, 3);
    const Scene scene(mesh);
    const std::size_t side = face_through(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 0, 3}});
    for (const double r : {0.9, 0.5, 0.001}) EXPECT_EQ(scene.at(side, {r, 0, 1.5}), kFar) << degrees;
    for (const double z : {0.001, 2.999}) EXPECT_EQ(scene.at(side, {0.5, 0, z}), kFar) << degrees;
  }
  for (const double degrees : {5.0, 30.0, 45.0, 90.0})
    EXPECT_NEAR(*Scene(wedge(degrees, 3)).smallest(), 3, 1e-12) << degrees;  // from cap to cap
}

/// Makes a prism over a tip at the origin, whose two sides are at heights y = +-height(x) over x = 0 .. 1, each in
/// `strips` strips. Its length is 2, along z.
template <class Height>
PolygonMesh tip_with_sides(int strips, const Height& height) {
  std::vector<Vec2> outline;
  for (int i = 0; i <= strips; ++i) outline.push_back({1.0 * i / strips, -height(1.0 * i / strips)});
  for (int i = strips; i >= 0; --i)
    if (const Vec2 p{1.0 * i / strips, height(1.0 * i / strips)}; i > 0 || p.y > 0) outline.push_back(p);
  return shapes::prism(outline, 2);
}

TEST(gap_search, the_sides_of_a_wedge_are_no_gap_however_they_are_divided) {
  // The sides of 20 degrees bend by up to 5 degrees from strip to strip, outwards, inwards, or not at all.
  for (const double bend : {0.0, 0.06, -0.06}) {
    const PolygonMesh mesh = tip_with_sides(6, [&](double x) { return 0.18 * x + bend * x * x; });
    const Scene scene(mesh);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto loop = mesh.face(FaceId(f));
      if (loop.size() != 4) continue;
      Vec3 middle;
      for (const VertexId v : loop) middle += 0.25 * mesh.positions[v];
      if (middle.x > 0.999) continue;  // the end opposite the tip
      EXPECT_EQ(scene.at(f, middle), kFar) << bend << " " << middle.x;
    }
  }
}

TEST(gap_search, the_sides_of_a_blade_with_a_blunt_edge_are_a_gap) {
  // The edge is 0.01 wide. Above x = 0.1 the sides are 0.01 + 0.02 and more apart.
  const PolygonMesh mesh = tip_with_sides(1, [](double x) { return 0.005 + 0.1 * x; });
  const Scene scene(mesh);
  const double cosine = 1 / std::hypot(1, 0.1);
  const std::size_t side = face_through(mesh, {{0, -0.005, 0}, {1, -0.105, 0}, {1, -0.105, 2}});
  for (const double x : {0.1, 0.5}) {
    // The way at right angles to the other side.
    const double gap = 2 * (0.005 + 0.1 * x) * cosine;
    EXPECT_NEAR(scene.at(side, {x, -0.005 - 0.1 * x, 1}), gap, 1e-9) << x;
  }
}

TEST(gap_search, a_thin_plate_that_ends_in_a_bevel_is_a_gap_away_from_the_bevel) {
  // A chisel: 10 long and 0.1 thick, the last 0.25 ground to 22 degrees, so that the bevel turns by less than 30.
  const PolygonMesh mesh = shapes::prism({{0, 0}, {10, 0}, {10, 0.1}, {0.25, 0.1}}, 2);
  const Scene scene(mesh);
  const std::size_t bottom = face_through(mesh, {{0, 0, 0}, {10, 0, 0}, {10, 0, 2}});
  EXPECT_EQ(scene.at(bottom, {0.2, 0, 1}), kFar);
  for (const double x : {2.0, 5.0, 9.0}) EXPECT_NEAR(scene.at(bottom, {x, 0, 1}), 0.1, 1e-12) << x;
}

TEST(gap_search, patches_that_cross_are_no_gap_for_each_other) {
  // Two sheets that cross at 30 degrees along x = 0. Without the pair, places beside the line would see each other.
  const PolygonMesh mesh =
      shapes::joined(shapes::moved(shapes::sheet(4, 4, 1, 1), {-2, 0, 0}),
                     shapes::rotated(shapes::moved(shapes::sheet(4, 4, 1, 1), {-2, 0, 0}), {0, 1, 0}, 30));
  const StageChain chain(mesh, kTolerance);
  const std::vector<std::pair<PatchId, PatchId>> crossing{{PatchId(0), PatchId(1)}};
  RunControl control;
  const GapSearch unknowing(chain.surface, chain.adjacency, chain.patches, kTolerance, control);
  const GapSearch knowing(chain.surface, chain.adjacency, chain.patches, kTolerance, control, nullptr,
                          GapSearch::Rules{0, 30, crossing});
  const Vec3 place{1, 2, 0};
  EXPECT_NEAR(unknowing.at(place, PatchId(0), kFar), 0.5, 1e-12);
  EXPECT_EQ(knowing.at(place, PatchId(0), kFar), kFar);
}

TEST(gap_search, a_slot_beside_a_shared_edge_is_seen_though_the_two_faces_are_joined) {
  // A floor and a wall that share the edge from x = 0 to 1; beyond, the wall's foot is 1/16 above the floor.
  const Scene scene(shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {9, 0, 0}, {9, 2, 0}, {0, 2, 0}, {1, 0, 0.0625}, {9, 0, 0.0625}, {9, 0, 2}, {0, 0, 2}},
      {{0, 1, 2, 3, 4}, {1, 0, 8, 7, 6, 5}}));
  EXPECT_DOUBLE_EQ(scene.at(0, {5, 0, 0}), 0.0625);
  EXPECT_EQ(scene.at(0, {0.5, 0.01, 0}), kFar);
  EXPECT_EQ(scene.at(0, {1.01, 0, 0}), kFar);  // the way round is short there
}

TEST(gap_search, a_concave_polygon_is_not_where_its_notch_is) {
  // A small sheet hovers over the slot of a U-shaped polygon.
  const PolygonMesh u = shapes::polygon({{0, 0}, {7, 0}, {7, 4}, {3.75, 4}, {3.75, 1}, {3.25, 1}, {3.25, 4}, {0, 4}});
  const Scene scene(shapes::joined(u, shapes::moved(shapes::sheet(0.2, 0.2, 1, 1), {3.4, 2.5, 2})));
  EXPECT_DOUBLE_EQ(scene.at(1, {3.5, 2.6, 2}), std::hypot(0.25, 2));
}

TEST(gap_search, what_touches_is_no_gap) {
  // A small cube stands on the side of a large one.
  const PolygonMesh mesh =
      shapes::joined(shapes::quad_box({1, 1, 1}), shapes::moved(shapes::quad_box({0.5, 0.5, 0.5}), {1, 0.25, 0.25}));
  const Scene scene(mesh);
  const std::size_t foot = face_through(mesh, {{1, 0.25, 0.25}, {1, 0.75, 0.25}, {1, 0.75, 0.75}});
  EXPECT_DOUBLE_EQ(scene.at(foot, {1, 0.5, 0.5}), 0.5);  // its own other side
  const std::size_t under = face_through(mesh, {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}});
  EXPECT_DOUBLE_EQ(scene.at(under, {1, 0.5, 0.5}), 0.5);  // the small one's far side
}

TEST(gap_search, facets_round_a_hole_see_the_opposite_ones_and_not_the_next_but_one) {
  constexpr int kSides = 3000;
  const Scene scene(shapes::cylinder(kSides, 1, 3));
  // The nearest facets that count are those that are seen at 51 degrees.
  const double at_51 = 2 * std::sqrt(0.604);
  const Vec3 on_facet{std::cos(std::numbers::pi / kSides) * std::cos(std::numbers::pi / kSides),
                      std::cos(std::numbers::pi / kSides) * std::sin(std::numbers::pi / kSides), 1.5};
  EXPECT_NEAR(scene.at(2, on_facet), at_51, 0.01);
  EXPECT_NEAR(*scene.smallest(), at_51, 0.01);
  // A cap has all facets for neighbours; it sees the other cap.
  for (std::size_t f = 0; f < 2; ++f) {
    const double z = scene.chain.surface.positions[scene.chain.surface.face(FaceId(f))[0]].z;
    EXPECT_DOUBLE_EQ(scene.at(f, {0.3, 0.2, z}), 3);
    EXPECT_DOUBLE_EQ(scene.at(f, {0.999, 0, z}), 3);
  }
}

TEST(gap_search, coarse_triangles_of_the_patches_and_the_input_faces_give_the_same) {
  for (const PolygonMesh& mesh : {cube_in_cube(), shapes::box({1, 2, 3}, 12)}) {
    const Scene scene(mesh);
    const StageChain& chain = scene.chain;
    const GapSearch coarse(chain.surface, chain.adjacency, chain.patches, kTolerance, chain.control,
                           &chain.triangulated);
    EXPECT_DOUBLE_EQ(*coarse.smallest(chain.control), *scene.smallest());
    for (std::uint32_t p = 0; p < coarse.patch_count(); ++p) {
      EXPECT_LT(coarse.triangles_of(PatchId(p)).size(), scene.gaps.triangles_of(PatchId(p)).size());
      for (const Triangle& t : scene.gaps.triangles_of(PatchId(p))) {
        const auto& at = chain.surface.positions;
        const Vec3 middle = (1.0 / 3) * (at[t[0]] + at[t[1]] + at[t[2]]);
        EXPECT_DOUBLE_EQ(coarse.at(middle, PatchId(p), kFar), scene.gaps.at(middle, PatchId(p), kFar));
      }
    }
  }
}

TEST(gap_search, agrees_with_the_rule_applied_to_every_triangle) {
  std::vector<PolygonMesh> meshes = {shapes::prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 1.125}, {0, 1.125}}, 1),
                                     cube_in_cube(),
                                     wedge(20, 0.7),
                                     shapes::l_bracket(2),
                                     shapes::cylinder(40, 1, 0.3),
                                     shapes::sphere(1),
                                     shapes::three_pages(2),
                                     shapes::ring(2)};
  for (const int seed : {1, 2, 3}) {
    meshes.push_back(random_boxes(seed));
    meshes.push_back(
        shapes::rotated(shapes::prism(polygons::star_with_holes(static_cast<std::uint64_t>(seed), 30, 0).outer, 0.4),
                        {1, 2, 3}, 40.0 * seed));
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Scene scene(meshes[m]);
    const BruteForce oracle(scene);
    Random random(m);
    int seen = 0;
    for (int i = 0; i < 60; ++i) {
      const PatchId p(random.below(static_cast<int>(scene.gaps.patch_count())));
      const auto triangles = scene.gaps.triangles_of(p);
      const Triangle& t = triangles[random.below(static_cast<int>(triangles.size()))];
      const double u = random.unit(), v = random.unit() * (1 - u);
      const auto& at = scene.chain.surface.positions;
      const Vec3 place = at[t[0]] + u * (at[t[1]] - at[t[0]]) + v * (at[t[2]] - at[t[0]]);
      const double expected = oracle.at(place, p);
      seen += expected < kFar;
      if (expected < kFar) {
        EXPECT_NEAR(scene.gaps.at(place, p, kFar), expected, 1e-9) << "mesh " << m;
      } else {
        EXPECT_EQ(scene.gaps.at(place, p, kFar), kFar) << "mesh " << m;
      }
    }
    const double strangers = oracle.smallest_between_strangers();
    const std::optional<double> smallest = scene.smallest();
    if (strangers < kFar) {
      ASSERT_TRUE(smallest.has_value());
      EXPECT_LE(*smallest, strangers + 1e-12) << "mesh " << m;
      double at_corners = kFar;
      for (std::uint32_t v = 0; v < scene.chain.surface.vertex_count(); ++v) {
        std::set<PatchId> around;
        for (std::uint32_t h = 0; h < scene.chain.surface.corners.size(); ++h)
          if (scene.chain.adjacency.from(h) == VertexId(v))
            around.insert(scene.chain.patches.of_face[scene.chain.adjacency.face_of(h)]);
        if (around.size() < 3) continue;
        for (const PatchId p : around)
          at_corners = std::min(at_corners, oracle.at(scene.chain.surface.positions[VertexId(v)], p));
      }
      EXPECT_NEAR(*smallest, std::min(strangers, at_corners), 1e-9) << "mesh " << m;
      EXPECT_GT(seen, 0) << "mesh " << m;
    }
  }
}

TEST(gap_search, nothing_is_nearer_to_a_place_of_a_piece_than_what_is_beside_it) {
  // Boxes: their own faces meet at right angles, so whatever is a gap is to what is not joined.
  for (int seed = 1; seed <= 4; ++seed) {
    const Scene scene(random_boxes(seed));
    const auto& local = scene.chain.surface.local;
    const double unit = scene.chain.surface.unit;
    Random random(seed);
    int found = 0, in_vain = 0;
    for (int i = 0; i < 300; ++i) {
      const PatchId p(random.below(static_cast<int>(scene.gaps.patch_count())));
      const auto triangles = scene.gaps.triangles_of(p);
      const Triangle& t = triangles[random.below(static_cast<int>(triangles.size()))];
      const auto place = [&] {
        const double u = random.unit(), v = random.unit() * (1 - u);
        return local[t[0]] + u * (local[t[1]] - local[t[0]]) + v * (local[t[2]] - local[t[0]]);
      };
      const std::vector<Corners3> pieces{{place(), place(), place()}};
      const Corners3& piece = pieces[0];
      const double beside = scene.gaps.beside(pieces, p, kFar);
      double least = kFar;
      for (int k = 0; k < 50; ++k) {
        const double u = random.unit(), v = random.unit() * (1 - u);
        const Vec3 x = piece[0] + u * (piece[1] - piece[0]) + v * (piece[2] - piece[0]);
        least = std::min(least, scene.gaps.at(scene.chain.surface.centre + unit * x, p, kFar));
      }
      EXPECT_LE(beside, least * (1 + 1e-9));
      EXPECT_EQ(scene.gaps.beside(pieces, p, 1.001 * beside), beside);
      EXPECT_EQ(scene.gaps.beside(pieces, p, 0.999 * beside), kFar);
      if (least < kFar) ++found;
      if (least < kFar && beside < 0.5 * least) ++in_vain;
    }
    EXPECT_GT(found, 50);
    EXPECT_LT(in_vain, found / 2);
  }
}

STAGE(gap_search, test::kWorkers, test::kScale, test::kStop) {
  const double tolerance = kTolerance * trial.scale;
  const StageChain chain(trial.of(shapes::joined(shapes::rotated(shapes::cylinder(300, 1, 1), {1, 2, 3}, 50),
                                                 shapes::moved(random_boxes(5), {5, 0, 0}))),
                         tolerance);
  const GapSearch gaps(chain.surface, chain.adjacency, chain.patches, tolerance, trial.control);
  trial.same(trial.length(*gaps.smallest(trial.control)));
  for (std::uint32_t v = 0; v < chain.surface.vertex_count(); ++v)
    trial.in_order(trial.length(gaps.at(chain.surface.positions[VertexId(v)], PatchId(v % gaps.patch_count()), kFar)));
}

STAGE(smallest_gap, test::kStop) { (void)Scene(cube_in_cube()).gaps.smallest(trial.control); }

}  // namespace
}  // namespace remesh
