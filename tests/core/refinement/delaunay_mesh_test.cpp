#include "core/triangulation/delaunay_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/triangulation/patch_triangulation.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

/// A mesh, and what its owner has to remember: which sides belong together, and which vertices are free.
class MeshSubject {
 public:
  /// `slits`: edges within the polygon, between its points and no loop's.
  explicit MeshSubject(const polygons::PatchInput& input, const std::vector<Segment>& slits = {}) {
    std::vector<Segment> edges = input.edges;
    for (const auto& [a, b] : slits) {
      edges.push_back({a, b});
      edges.push_back({b, a});
    }
    RunControl control;
    const PatchTriangulation made = triangulate_patch(input.points, edges, control);
    EXPECT_EQ(made.outcome, TriangulationOutcome::kDone);
    std::vector<std::uint32_t> sides;
    std::map<Segment, std::uint32_t> side_of;
    for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); ++h)
      if (made.mesh.is_constrained(h)) {
        side_of[{made.mesh.from(h), made.mesh.to(h)}] = static_cast<std::uint32_t>(sides.size());
        sides.push_back(h);
      }
    for (const auto& [ends, side] : side_of) {
      const auto other = side_of.find({ends[1], ends[0]});
      partner_[side] = other != side_of.end() ? std::optional(other->second) : std::nullopt;
    }
    mesh = DelaunayMesh(made.mesh, input.points, sides, scratch);
  }

  /// Returns whether there was a place for p.
  bool insert(Vec2 p) {
    const std::uint32_t start = live_triangle();
    const DelaunayMesh::Location at = mesh.locate(start, p);
    if (at.is_hidden) return false;
    const DelaunayMesh::Cavity cavity = mesh.find_cavity(p, at.half_edge / 3);
    if (!cavity.has_room) return false;
    const std::uint32_t v = mesh.fill_cavity(cavity);
    free_.insert(v);
    expect_changed_are_around(v);
    return true;
  }

  /// Both sides of a slit at once. The point is on the line to rounding only.
  bool cut(std::uint32_t side, double t) {
    const std::uint32_t h = mesh.half_edge_of_side(side);
    const Vec2 a = mesh.point(mesh.from(h)), b = mesh.point(mesh.to(h));
    const Vec2 p{std::ldexp(std::nearbyint(std::ldexp(a.x + t * (b.x - a.x), 40)), -40),
                 std::ldexp(std::nearbyint(std::ldexp(a.y + t * (b.y - a.y), 40)), -40)};
    const std::optional<std::uint32_t> partner = partner_[side];
    const std::uint32_t first = mesh.from(h);
    const std::uint32_t v = mesh.cut(side, p);
    if (v == kNone) return false;
    const std::uint32_t fresh = mesh.side_count() - 1;
    EXPECT_EQ(mesh.from(mesh.half_edge_of_side(side)), first) << "the side keeps its start";
    EXPECT_EQ(mesh.to(mesh.half_edge_of_side(side)), v);
    EXPECT_EQ(mesh.from(mesh.half_edge_of_side(fresh)), v);
    partner_[fresh] = std::nullopt;
    if (!partner) return true;
    EXPECT_EQ(mesh.cut(*partner, p, v), v);
    const std::uint32_t fresh_partner = mesh.side_count() - 1;
    partner_[side] = fresh_partner;
    partner_[fresh_partner] = side;
    partner_[fresh] = *partner;
    partner_[*partner] = fresh;
    return true;
  }

  /// Removes a free vertex, if there is one.
  void remove_any(Random& random) {
    if (free_.empty()) return;
    auto v = free_.begin();
    std::advance(v, random.below(static_cast<int>(free_.size())));
    mesh.remove(*v);
    EXPECT_FALSE(mesh.is_live_vertex(*v));
    free_.erase(v);
  }

  /// Expects the triangulation that is made anew from its points and sides.
  void expect_is_fresh() const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t v = 0; v < mesh.vertex_slots(); ++v)
      if (mesh.is_live_vertex(v)) order.push_back(v);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return mesh.point(a) < mesh.point(b); });
    std::vector<Vec2> points;
    std::map<std::uint32_t, std::uint32_t> rank;
    for (const std::uint32_t v : order) {
      rank[v] = static_cast<std::uint32_t>(points.size());
      points.push_back(mesh.point(v));
    }
    std::vector<Segment> edges;
    for (std::uint32_t s = 0; s < mesh.side_count(); ++s) {
      const std::uint32_t h = mesh.half_edge_of_side(s);
      ASSERT_TRUE(mesh.is_constrained(h));
      ASSERT_EQ(mesh.side(h), s);
      edges.push_back({rank.at(mesh.from(h)), rank.at(mesh.to(h))});
    }
    RunControl control;
    const PatchTriangulation fresh = triangulate_patch(points, edges, control);
    ASSERT_EQ(fresh.outcome, TriangulationOutcome::kDone);

    std::vector<Corners> ours;
    std::uint32_t live = 0;
    for (std::uint32_t t = 0; t < mesh.triangle_slots(); ++t) {
      if (!mesh.is_live(t)) continue;
      ++live;
      const std::uint32_t h = 3 * t;
      ours.push_back({rank.at(mesh.from(h)), rank.at(mesh.from(h + 1)), rank.at(mesh.from(h + 2))});
      for (std::uint32_t k = h; k < h + 3; ++k)
        if (!mesh.is_constrained(k)) {
          ASSERT_EQ(mesh.twin(mesh.twin(k)), k);
          ASSERT_EQ(mesh.from(mesh.twin(k)), mesh.to(k));
        }
    }
    EXPECT_EQ(live, mesh.triangle_count());
    ASSERT_EQ(canonical(std::move(ours)), triangles_of(fresh.mesh));
  }

  std::uint32_t live_triangle() const {
    std::uint32_t t = 0;
    while (!mesh.is_live(t)) ++t;
    return t;
  }

  DelaunayMesh::Scratch scratch;
  DelaunayMesh mesh{scratch};

 private:
  void expect_changed_are_around(std::uint32_t v) const {
    for (const std::uint32_t t : mesh.changed()) {
      ASSERT_TRUE(mesh.is_live(t));
      EXPECT_TRUE(mesh.from(3 * t) == v || mesh.from(3 * t + 1) == v || mesh.from(3 * t + 2) == v);
    }
  }

  std::map<std::uint32_t, std::optional<std::uint32_t>> partner_;
  std::set<std::uint32_t> free_;
};

struct Extent {
  Vec2 low, high;
};
Extent extent(const std::vector<Vec2>& points) {
  Extent e{points[0], points[0]};
  for (const Vec2 p : points) {
    e.low = {std::min(e.low.x, p.x), std::min(e.low.y, p.y)};
    e.high = {std::max(e.high.x, p.x), std::max(e.high.y, p.y)};
  }
  return e;
}

/// Inserts, cuts and removes at random. Again and again it compares the mesh with a fresh triangulation.
void change_at_random(MeshSubject& subject, const Extent& box, double grid, Random& random, int steps) {
  int inserted = 0, cuts = 0;
  for (int i = 0; i < steps; ++i) {
    const double dice = random.unit();
    if (dice < 0.55) {
      Vec2 p{random.uniform(box.low.x, box.high.x), random.uniform(box.low.y, box.high.y)};
      p = {std::nearbyint(p.x / grid) * grid, std::nearbyint(p.y / grid) * grid};
      inserted += subject.insert(p);
    } else if (dice < 0.8) {
      const auto side = static_cast<std::uint32_t>(random.below(static_cast<int>(subject.mesh.side_count())));
      cuts += subject.cut(side, random.chance(0.5) ? 0.5 : random.uniform(0.1, 0.9));
    } else {
      subject.remove_any(random);
    }
    if (i % 16 == 15) subject.expect_is_fresh();
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(inserted, 0);
  EXPECT_GT(cuts, 0);
}

TEST(delaunay_mesh, as_it_is_made_it_is_the_triangulation_that_it_was_given) {
  const MeshSubject subject(polygons::patch_input(polygons::star_with_holes(1, 40, 3)));
  subject.expect_is_fresh();
}

TEST(delaunay_mesh, after_any_changes_it_is_the_one_constrained_delaunay_triangulation) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const polygons::PatchInput input =
        polygons::patch_input(seed % 2 == 0 ? polygons::star_with_holes(seed, 30, 3) : polygons::grown(seed, 30, 16));
    MeshSubject subject(input);
    change_at_random(subject, extent(input.points), 0x1p-40, random, 300);
    if (HasFatalFailure()) return;
  }
}

TEST(delaunay_mesh, cocircular_points_and_points_on_edges_are_decided_as_in_a_fresh_one) {
  // A lattice: nearly every four points are on a circle, and many lie on edges and on vertices.
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const polygons::PatchInput input = polygons::patch_input(polygons::rectilinear_with_holes(seed, 8));
    MeshSubject subject(input);
    const Extent box = extent(input.points);
    change_at_random(subject, box, 0.25, random, 300);
    if (HasFatalFailure()) return;
  }
}

TEST(delaunay_mesh, slits_are_cut_on_both_sides_at_one_vertex) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    // A square with a slit that touches no side, and one that begins in a corner.
    polygons::PatchInput input = polygons::patch_input({{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {}});
    input.points = {{0, 0}, {0, 8}, {2, 2}, {3, 5}, {5, 5}, {6, 3}, {8, 0}, {8, 8}};
    input.edges = {{0, 6}, {6, 7}, {7, 1}, {1, 0}};
    MeshSubject subject(input, {{3, 4}, {2, 5}, {4, 7}});
    subject.expect_is_fresh();
    change_at_random(subject, {{0, 0}, {8, 8}}, seed % 3 == 0 ? 0.5 : 0x1p-40, random, 250);
    if (HasFatalFailure()) return;
  }
}

TEST(delaunay_mesh, a_vertex_that_goes_leaves_no_trace) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    MeshSubject subject(polygons::patch_input(polygons::l_shape()));
    const std::uint32_t before = subject.mesh.triangle_count();
    int inserted = 0;
    for (int i = 0; i < 100; ++i) inserted += subject.insert({random.below(17) / 8.0, random.below(17) / 8.0});
    EXPECT_EQ(subject.mesh.triangle_count(), before + 2 * static_cast<std::uint32_t>(inserted));
    for (int i = 0; i < inserted; ++i) subject.remove_any(random);
    EXPECT_EQ(subject.mesh.triangle_count(), before);
    subject.expect_is_fresh();
  }
}

TEST(delaunay_mesh, a_point_on_a_vertex_or_on_a_side_has_no_place) {
  MeshSubject subject(polygons::patch_input(polygons::l_shape()));
  const std::uint32_t before = subject.mesh.triangle_count();
  EXPECT_FALSE(subject.insert({1, 1}));
  EXPECT_FALSE(subject.insert({0.5, 0}));
  EXPECT_TRUE(subject.insert({0.5, 0.5}));
  EXPECT_FALSE(subject.insert({0.5, 0.5}));
  EXPECT_EQ(subject.mesh.triangle_count(), before + 2);
  subject.expect_is_fresh();
}

TEST(delaunay_mesh, a_cut_without_room_changes_nothing) {
  MeshSubject subject(polygons::patch_input(polygons::l_shape()));
  const std::uint32_t before = subject.mesh.triangle_count();
  EXPECT_FALSE(subject.cut(0, 0));
  EXPECT_FALSE(subject.cut(0, 1));
  EXPECT_EQ(subject.mesh.triangle_count(), before);
  subject.expect_is_fresh();
}

TEST(delaunay_mesh, a_walk_ends_at_the_point_or_at_the_side_that_hides_it) {
  const polygons::Polygon polygon = polygons::star_with_holes(5, 40, 4);
  const MeshSubject subject(polygons::patch_input(polygon));
  const DelaunayMesh& mesh = subject.mesh;
  Random random(3);
  int found = 0, hidden = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 p{random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto start = static_cast<std::uint32_t>(random.below(static_cast<int>(mesh.triangle_slots())));
    const DelaunayMesh::Location at = mesh.locate(start, p);
    const auto side_of = [&](std::uint32_t h) {
      const Vec2 a = mesh.point(mesh.from(h)), b = mesh.point(mesh.to(h));
      return cross(b - a, p - a);
    };
    if (at.is_hidden) {
      ++hidden;
      EXPECT_TRUE(mesh.is_constrained(at.half_edge));
      EXPECT_LT(side_of(at.half_edge), 0);
      // It really stands in the way: start and p are on different sides of it, and its ends of the way.
      const std::uint32_t t = 3 * start;
      const Vec2 from =
          (1.0 / 3) * (mesh.point(mesh.from(t)) + mesh.point(mesh.from(t + 1)) + mesh.point(mesh.from(t + 2)));
      const Vec2 a = mesh.point(mesh.from(at.half_edge)), b = mesh.point(mesh.to(at.half_edge));
      EXPECT_LE(cross(p - from, a - from), 1e-12);
      EXPECT_GE(cross(p - from, b - from), -1e-12);
    } else {
      ++found;
      for (std::uint32_t k = 0; k < 3; ++k) EXPECT_GE(side_of(3 * (at.half_edge / 3) + k), 0);
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(hidden, 100);
}

TEST(delaunay_mesh, a_constraint_that_is_no_side_gives_way) {
  // The long diagonal of a flat rhombus, held by a constraint that ends with the construction.
  const std::vector<Vec2> points{{-4, 0}, {0, -1}, {0, 1}, {4, 0}};
  const std::vector<Segment> edges{{0, 1}, {1, 3}, {3, 2}, {2, 0}, {0, 3}, {3, 0}};
  RunControl control;
  const PatchTriangulation made = triangulate_patch(points, edges, control);
  ASSERT_EQ(made.outcome, TriangulationOutcome::kDone);
  std::vector<std::uint32_t> rim;
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); ++h)
    if (made.mesh.twin(h) == Triangulation2d::kNoHalfEdge) rim.push_back(h);
  DelaunayMesh::Scratch scratch;
  const DelaunayMesh mesh(made.mesh, points, rim, scratch);
  std::set<Segment> inner;
  for (std::uint32_t h = 0; h < 6; ++h)
    if (!mesh.is_constrained(h)) inner.insert({std::min(mesh.from(h), mesh.to(h)), std::max(mesh.from(h), mesh.to(h))});
  EXPECT_EQ(inner, (std::set<Segment>{{1, 2}}));
}

TEST(delaunay_mesh, numbers_name_the_vertices_of_the_given_mesh) {
  const std::vector<Vec2> sorted{{0, 0}, {0, 1}, {1, 0}};
  RunControl control;
  const PatchTriangulation made = triangulate_patch(sorted, std::vector<Segment>{{0, 2}, {2, 1}, {1, 0}}, control);
  const std::vector<Vec2> points{{1, 0}, {0, 0}, {0, 1}};
  DelaunayMesh::Scratch scratch;
  const DelaunayMesh mesh(made.mesh, points, std::vector<std::uint32_t>{0, 1, 2}, scratch,
                          std::vector<std::uint32_t>{1, 2, 0});
  for (std::uint32_t h = 0; h < 3; ++h) EXPECT_EQ(mesh.point(mesh.from(h)), sorted[made.mesh.from(h)]);
}

TEST(delaunay_mesh, compacted_it_is_the_same_without_gaps) {
  Random random(9);
  const polygons::PatchInput input = polygons::patch_input(polygons::star_with_holes(2, 20, 2));
  MeshSubject subject(input);
  change_at_random(subject, extent(input.points), 0x1p-40, random, 200);
  std::pmr::vector<std::uint32_t> vertex, triangle;
  const Triangulation2d compact = subject.mesh.compact(vertex, triangle);
  ASSERT_EQ(compact.triangle_count(), subject.mesh.triangle_count());
  ASSERT_EQ(triangle.size(), compact.triangle_count());
  EXPECT_TRUE(std::is_sorted(vertex.begin(), vertex.end()));
  std::vector<Vec2> points;
  for (const std::uint32_t v : vertex) {
    ASSERT_TRUE(subject.mesh.is_live_vertex(v));
    points.push_back(subject.mesh.point(v));
  }
  expect_valid(points, compact);
  expect_locally_delaunay(points, compact);
  std::size_t constrained = 0;
  for (std::uint32_t h = 0; h < compact.half_edge_count(); ++h) {
    constrained += compact.is_constrained(h);
    EXPECT_EQ(vertex[compact.from(h)], subject.mesh.from(3 * triangle[h / 3] + h % 3));
  }
  EXPECT_EQ(constrained, subject.mesh.side_count());
}

}  // namespace
}  // namespace remesh
