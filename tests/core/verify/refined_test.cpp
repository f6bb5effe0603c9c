#include "tests/core/verify/refined.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

namespace remesh {
namespace {

PolygonMesh turned(const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, 40); }

bool mentions(const Verdict& v, const char* words) { return all_words(v).find(words) != std::string::npos; }

TEST(verify_refined, correct_claims_are_verified) {
  const std::pair<const char*, Example> all[] = {
      {"square", square_with_new_middle()},
      {"cube", refined_cube(2)},
      {"cube in thirds", refined_cube(3)},
      {"cube where some vertices are dropped ones", refined(shapes::box({1, 1, 1}, 2), shapes::box({1, 1, 1}, 4))},
      {"turned cube", refined(turned(shapes::box({1, 1, 1})), turned(shapes::box({1, 1, 1}, 5)))},
      {"ring", refined(shapes::ring(1), shapes::ring(4))},
      {"slotted plate", refined(shapes::slotted_plate(1), shapes::slotted_plate(2))},
      {"three pages", refined_pages(3)},
      {"plate with fin", plate_with_fin()},
      {"cubes that share an edge", refined(shapes::blocks({".#", "#."}), shapes::blocks({".#", "#."}, 3))},
      {"wedge", wedge(20, 1, 0)},
      {"nothing new", refined(cube())},
  };
  for (const auto& [name, e] : all) {
    EXPECT_TRUE(is_verified(e)) << name;
    EXPECT_EQ(e.verify().quality, true) << name;
  }
}

TEST(verify_refined, without_refinement_there_is_no_verdict_on_quality) {
  EXPECT_FALSE(cube().verify().quality.has_value());
}

TEST(verify_refined, new_vertices_need_a_claim_of_refinement) {
  for (Example e : {square_with_new_middle(), refined_cube(2), plate_with_fin()}) {
    e.goals.reset();
    EXPECT_FALSE(e.verify().surface);
  }
}

TEST(verify_refined, any_scale_and_place_gives_the_same_verdict) {
  for (const double scale : {1e-300, 1e-12, 1e6, 1e300}) {
    EXPECT_TRUE(is_verified(scaled(refined_cube(3), scale))) << scale;
    Example spoiled = refined_cube(3);
    move_vertex(spoiled, {1, 1, 1 / 3.0}, {1, 1 - 1e-12, 1 / 3.0});
    spoiled.make_delaunay();
    EXPECT_FALSE(scaled(spoiled, scale).verify().surface) << scale;
  }
  for (const double distance : {1e3, 1e6}) {
    const auto moved = [&](const PolygonMesh& mesh) { return shapes::moved(turned(mesh), {distance, distance, 0}); };
    // Its own rounding makes the input's planes what they are.
    Example e = refined(moved(shapes::box({1, 1, 1})), moved(shapes::box({1, 1, 1})));
    e.plane_tolerance = 1e-15 * distance;
    for (int side = 0; side < 3; ++side) {
      const auto at = [&](double t) {
        Vec3 p{0, 0, 0};
        p[side] = t;
        return moved(shapes::from_lists({p, {9, 9, 9}, {9, 9, 8}}, {{0, 1, 2}})).positions[VertexId(0)];
      };
      const Vec3 from = at(0), to = at(1);
      split_edge(e, from, to, from + 0.3 * (to - from));
    }
    EXPECT_TRUE(is_verified(e)) << distance;
  }
}

// New vertices on an edge.

TEST(verify_refined, a_new_vertex_off_its_edge_is_found) {
  for (const Vec3& off : {Vec3{0, 1e-14, 0}, Vec3{0, -1e-9, 0}, Vec3{0, 0, 1e-12}, Vec3{0, 0, -1e-6}}) {
    Example e = refined_cube(2);
    move_vertex(e, {0.5, 0, 0}, Vec3{0.5, 0, 0} + off);
    const Verdict v = e.verify();
    EXPECT_FALSE(v.surface);
    EXPECT_TRUE(mentions(v, "off their edge")) << all_words(v);
    EXPECT_EQ(v.failed_patches.size(), 2u);
  }
}

TEST(verify_refined, new_vertices_out_of_order_are_found) {
  Example e = refined_cube(4);
  std::swap(e.positions[e.vertex_at({0.25, 0, 0}).value], e.positions[e.vertex_at({0.5, 0, 0}).value]);
  e.project();
  EXPECT_TRUE(mentions(e.verify(), "out of order"));
  // Beyond the end.
  e = refined_cube(2);
  move_vertex(e, {0.5, 0, 0}, {1.5, 0, 0});
  EXPECT_TRUE(mentions(e.verify(), "out of order"));
}

TEST(verify_refined, an_edge_cut_on_one_side_only_is_found) {
  Example e = refined(shapes::box({1, 1, 1}), shapes::box({1, 1, 1}));
  ASSERT_TRUE(is_verified(e));
  const PatchId bottom = e.face_patch[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = e.positions[e.faces[0][i].value], b = e.positions[e.faces[0][(i + 1) % 3].value];
    Example cut = e;
    split_edge(cut, a, b, 0.5 * (a + b), bottom);
    const Verdict v = cut.verify();
    const bool is_diagonal = std::fabs(norm(b - a) - 1) > 0.1;
    EXPECT_EQ(v.conforming, is_diagonal) << all_words(v);
    EXPECT_EQ(v.failed_patches.size(), is_diagonal ? 0u : 2u);
  }
}

TEST(verify_refined, an_edge_cut_at_two_places_is_found) {
  // Each side has its own new vertex, next to the other's.
  Example e = refined(shapes::box({1, 1, 1}), shapes::box({1, 1, 1}));
  const VertexId corner = e.vertex_at({0, 0, 0}), next = e.vertex_at({1, 0, 0});
  std::vector<PatchId> sides;
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (std::count(e.faces[f].begin(), e.faces[f].end(), corner) &&
        std::count(e.faces[f].begin(), e.faces[f].end(), next))
      sides.push_back(e.face_patch[f]);
  ASSERT_EQ(sides.size(), 2u);
  split_edge(e, {0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, sides[0]);
  split_edge(e, {0, 0, 0}, {1, 0, 0}, {0.5 + 1e-15, 0, 0}, sides[1]);
  EXPECT_FALSE(e.verify().conforming);
  EXPECT_EQ(e.verify().failed_patches.size(), 2u);
}

TEST(verify_refined, one_of_three_sheets_not_cut_is_found) {
  Example e = refined(shapes::three_pages(1), shapes::three_pages(1));
  const VertexId low = e.vertex_at(e.positions[0]);
  // The common edge is the one with three faces.
  Vec3 a, b;
  for (const Triangle& face : e.faces)
    for (int i = 0; i < 3; ++i) {
      const auto has = [&](VertexId v) {
        return [v](const Triangle& t) { return std::find(t.begin(), t.end(), v) != t.end(); };
      };
      const VertexId from = face[i], to = face[(i + 1) % 3];
      if (std::count_if(e.faces.begin(), e.faces.end(),
                        [&](const Triangle& t) { return has(from)(t) && has(to)(t); }) == 3) {
        a = e.positions[from.value];
        b = e.positions[to.value];
      }
    }
  ASSERT_NE(a, b) << low;
  Example all = e;
  split_edge(all, a, b, 0.5 * (a + b));
  EXPECT_TRUE(is_verified(all));
  Example two = e;
  split_edge(two, a, b, 0.5 * (a + b), PatchId(0));
  split_edge(two, a, b, 0.5 * (a + b), PatchId(2));
  EXPECT_FALSE(two.verify().conforming);
  EXPECT_EQ(two.verify().failed_patches.size(), 3u);
}

TEST(verify_refined, an_edge_with_one_patch_on_both_sides_is_cut_on_both) {
  Example e = plate_with_fin();
  ASSERT_TRUE(is_verified(e));
  // The plate's upper half does without the cut.
  const VertexId cut = e.vertex_at({2, 2, 0}), a = e.vertex_at({1, 2, 0}), b = e.vertex_at({3, 2, 0});
  const PatchId plate = e.face_patch[0];
  std::size_t removed = 0;
  Vec3 apex;
  for (std::size_t f = e.faces.size(); f-- > 0;) {
    if (e.face_patch[f] != plate || std::count(e.faces[f].begin(), e.faces[f].end(), cut) == 0) continue;
    for (const VertexId v : e.faces[f])
      if (e.positions[v.value].y > 2) apex = e.positions[v.value];
  }
  ASSERT_GT(apex.y, 2);
  for (std::size_t f = e.faces.size(); f-- > 0;) {
    const auto has = [&](VertexId v) { return std::count(e.faces[f].begin(), e.faces[f].end(), v) > 0; };
    if (e.face_patch[f] == plate && has(cut) && has(e.vertex_at(apex))) {
      e.remove_face(f);
      ++removed;
    }
  }
  ASSERT_GE(removed, 1u);
  e.add_face(plate, e.positions[b.value], apex, e.positions[a.value]);
  EXPECT_FALSE(e.verify().conforming);
}

TEST(verify_refined, two_chains_that_became_one_line_are_found) {
  // A slit-like hole, one side of it bent within tolerance: without its bend, and with a new vertex on the other side,
  // it is closed, but for a T-junction.
  const PolygonMesh input =
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 2, 0}, {3, 2, 0}, {2, 2.0001, 0}},
                         {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 3, 6}, {2, 6, 5}, {3, 4, 6}, {3, 0, 4}});
  Example e = refined(input, input);
  e.plane_tolerance = 1e-3;
  ASSERT_TRUE(is_verified(e));
  const PatchId patch(0);
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{4, 4, 0}, d{0, 4, 0}, left{1, 2, 0}, right{3, 2, 0}, middle{2, 2, 0};
  for (const bool is_below : {true, false}) {
    e.remove_patch(patch);
    e.add_face(patch, d, a, left);
    e.add_face(patch, b, c, right);
    if (is_below) {
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, right), std::pair(left, a)})
        e.add_face(patch, from, to, middle);
      e.add_face(patch, d, left, right);
      e.add_face(patch, c, d, right);
    } else {
      for (const auto& [from, to] : {std::pair(c, d), std::pair(d, left), std::pair(right, c)})
        e.add_face(patch, from, to, middle);
      e.add_face(patch, a, right, left);
      e.add_face(patch, a, b, right);
    }
    e.make_delaunay();
    const Verdict v = e.verify();
    EXPECT_FALSE(v.conforming);
    EXPECT_TRUE(mentions(v, "not those that the input has")) << all_words(v);
  }
}

TEST(verify_refined, a_boundary_pulled_into_the_patch_is_found) {
  // A border of new vertices only, around a hole that the input has not.
  Example e = refined(shapes::sheet(4, 4, 1, 1), shapes::flat({"####", "#.##", "####", "####"}));
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_FALSE(v.surface);
}

// New vertices inside a patch.

TEST(verify_refined, a_new_vertex_off_the_plane_is_found) {
  for (const double lift : {1e-6, -1e-6}) {
    Example e = square_with_new_middle();
    move_vertex(e, {1, 1, 0}, {1, 1, lift});
    const Verdict v = e.verify();
    EXPECT_FALSE(v.surface);
    EXPECT_TRUE(v.conforming && v.delaunay);
    EXPECT_TRUE(mentions(v, "further apart"));
    e.plane_tolerance = 1.1e-6;
    EXPECT_TRUE(is_verified(e));
    EXPECT_NEAR(e.verify().deviation, 1e-6, 1e-12);
  }
}

TEST(verify_refined, where_heights_prove_nothing_new_vertices_are_measured) {
  for (const double lift : {0.0, 0.4e-3, -0.4e-3, 0.6e-3, -0.6e-3}) {
    // The new vertex is on the low end of the slope, so that heights over the plane say nothing.
    Example e = refined(slope(0));
    split_face(e, 0, {0.3, 0.2, 0.5e-3 * 0.3 + lift});
    EXPECT_EQ(e.verify().surface, std::fabs(lift) < 0.5e-3) << lift << all_words(e.verify());
    EXPECT_TRUE(e.verify().conforming);
    if (e.verify().surface) {
      EXPECT_NEAR(e.verify().deviation, std::fabs(lift), 1e-12);
    }
  }
}

TEST(verify_refined, a_new_vertex_within_tolerance_of_all_its_input_need_not_be_measured) {
  // A quad, which is no triangle to measure against; thicker than the tolerance, but not than twice that.
  PolygonMesh input =
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}},
                         {{0, 1, 5, 4}, {1, 6, 5}, {1, 2, 6}, {2, 3, 6}, {3, 5, 6}, {3, 4, 5}, {3, 0, 4}});
  Example e = refined(example(input, shapes::sheet(4, 4, 1, 1)));
  e.move([](Vec3& p) {
    if (p == Vec3{1, 1, 0}) p.z = 0.8e-3;
    if (p == Vec3{3, 3, 0}) p.z = -0.8e-3;
  });
  e.plane_tolerance = 1e-3;
  ASSERT_TRUE(is_verified(e));
  Example level = e;
  split_face(level, 0, {2.5, 1, 0});
  EXPECT_TRUE(is_verified(level));
  for (const double lift : {0.3e-3, -0.3e-3}) {
    Example lifted = e;
    split_face(lifted, 0, {2.5, 1, lift});
    EXPECT_FALSE(lifted.verify().surface);
  }
}

TEST(verify_refined, a_new_vertex_moved_in_its_plane_must_be_where_its_coordinates_say) {
  Example e = square_with_new_middle();
  e.positions[e.vertex_at({1, 1, 0}).value] = {1 + 1e-9, 1, 0};
  EXPECT_FALSE(e.verify().delaunay);
}

TEST(verify_refined, a_new_vertex_made_in_the_plane_may_be_rounded_in_space) {
  // Grid points, taken to space by the frame and rounded there, far from the origin.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.01, 0.98);
  for (const double grid : {0x1p-40, 0x1p-100})
    for (const double distance : {0.0, 1e3}) {
      const auto moved = [&](const PolygonMesh& mesh) { return shapes::moved(turned(mesh), {distance, 0, distance}); };
      Example e = refined(moved(shapes::sheet(1, 1, 1, 1)), moved(shapes::sheet(1, 1, 1, 1)));
      e.plane_tolerance = 1e-9;
      Frame& frame = e.frames[PatchId(0)];
      frame.grid = grid;
      e.project();
      for (int i = 0; i < 20; ++i) {
        const std::size_t f = static_cast<std::size_t>(i) % e.faces.size();
        const double s = unit(random), t = (1 - s) * unit(random);
        const auto* uv = &e.corner_uv[3 * f];
        Vec2 at = s * uv[0] + t * uv[1] + (1 - s - t) * uv[2];
        at = {std::nearbyint(at.x / 0x1p-40) * 0x1p-40, std::nearbyint(at.y / 0x1p-40) * 0x1p-40};
        split_face(e, f, frame.origin + frame.scale * (at.x * frame.x_axis + at.y * frame.y_axis));
        for (std::size_t g = 0; g < e.faces.size(); ++g)
          for (int k = 0; k < 3; ++k)
            if (norm(e.corner_uv[3 * g + k] - at) < 1e-9) e.corner_uv[3 * g + k] = at;
        // The exact plane coordinates, not those of the rounded point.
        const Verdict v = e.verify();
        EXPECT_TRUE(v.surface && v.conforming) << all_words(v);
        EXPECT_FALSE(mentions(v, "plane coordinates")) << all_words(v);
      }
    }
}

TEST(verify_refined, a_vertex_inside_two_patches_is_found) {
  // Two squares over the same ground, one above the other; both use one new vertex.
  PolygonMesh two = shapes::joined(shapes::sheet(2, 2, 1, 1), shapes::moved(shapes::sheet(2, 2, 1, 1), {0, 0, 1e-3}));
  Example e = refined(two, two);
  e.plane_tolerance = 1e-2;
  split_face(e, 0, {1.2, 0.4, 0});
  ASSERT_TRUE(is_verified(e));
  const std::size_t above = e.face_patch[0] == e.face_patch[2] ? 3 : 2;
  Example shared = e;
  split_face(shared, above, {1.2, 0.4, 0});
  const Verdict v = shared.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(mentions(v, "neither on one edge")) << all_words(v);
}

TEST(verify_refined, a_vertex_of_an_edge_inside_another_patch_is_found) {
  // A square that hangs over another one's side; its inner vertex is the side's.
  PolygonMesh two = shapes::joined(shapes::sheet(2, 2, 1, 1), shapes::moved(shapes::sheet(2, 2, 1, 1), {1, 0.5, 1e-3}));
  Example e = refined(two, two);
  e.plane_tolerance = 1e-2;
  split_edge(e, {2, 0, 0}, {2, 2, 0}, {2, 1, 0});
  ASSERT_TRUE(is_verified(e));
  for (std::size_t f = 0; f < e.faces.size(); ++f) {
    Box3 box;
    for (const VertexId v : e.faces[f]) box.add(e.positions[v.value]);
    if (box.min.z == 0 || box.min.x > 2 || box.max.x < 2 || box.min.y > 1 || box.max.y < 1) continue;
    Example shared = e;
    split_face(shared, f, {2, 1, 0});
    EXPECT_FALSE(shared.verify().conforming);
    EXPECT_FALSE(shared.verify().all_true());
  }
}

TEST(verify_refined, new_vertices_at_one_place_are_a_crack) {
  Example e = refined_cube(2);
  const VertexId middle = e.vertex_at({0.5, 0, 0});
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (std::count(e.faces[f].begin(), e.faces[f].end(), middle) > 0) {
      Example cracked = e;
      cracked.positions.push_back({0.5, 0, 0});
      std::replace(cracked.faces[f].begin(), cracked.faces[f].end(), middle, VertexId(cracked.positions.size() - 1));
      EXPECT_FALSE(cracked.verify().conforming);
      EXPECT_FALSE(cracked.verify().surface);
    }
}

TEST(verify_refined, new_vertices_of_two_sheets_at_one_place_are_found) {
  // Whoever reads the result by positions would join the sheets there.
  Example e = refined(split_in_three(shapes::double_sheet(1)), shapes::double_sheet(1));
  e.allow_intersections();
  ASSERT_TRUE(is_verified(e));
  const std::size_t other = e.face_patch[0] == e.face_patch[1] ? 2 : 1;
  const Vec3 place = 0.25 * e.positions[0] + 0.5 * e.positions[1] + 0.25 * e.positions[2];
  split_face(e, 0, place);
  ASSERT_TRUE(is_verified(e));
  const VertexId first = e.vertex_at(place);
  e.positions[first.value] = place + Vec3{0.01, 0.01, 0};
  split_face(e, other, place);
  e.positions[first.value] = place;
  e.project();
  EXPECT_TRUE(mentions(e.verify(), "has the same place as another vertex"));
}

TEST(verify_refined, a_new_vertex_that_is_not_finite_or_not_used_is_found) {
  Example e = square_with_new_middle();
  e.positions[4].z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(e.verify().surface);
  e = square_with_new_middle();
  e.positions.push_back({0.5, 0.5, 0});
  EXPECT_FALSE(e.verify().surface);
}

// Anything else.

TEST(verify_refined, no_single_change_goes_unseen) {
  for (const Example& correct : {square_with_new_middle(), refined_cube(2), refined_pages(2), plate_with_fin()}) {
    ASSERT_TRUE(is_verified(correct));
    for (std::size_t f = 0; f < correct.faces.size(); ++f) {
      for (int corner = 0; corner < 3; ++corner)
        for (std::size_t v = 0; v < correct.positions.size(); ++v) {
          if (correct.faces[f][corner] == VertexId(v)) continue;
          Example e = correct;
          e.faces[f][corner] = VertexId(v);
          e.project();
          EXPECT_FALSE(e.verify().all_true()) << "face " << f << " corner " << corner << " vertex " << v;
        }
      Example e = correct;
      e.remove_face(f);
      EXPECT_FALSE(e.verify().all_true()) << "face " << f;
    }
    for (std::size_t v = 0; v < correct.positions.size(); ++v) {
      // Anywhere within the plane, small moves of inner vertices are no fault; off it they are.
      Example e = correct;
      e.positions[v] += Vec3{3e-7, 2e-7, 1e-7};
      e.project();
      EXPECT_FALSE(e.verify().all_true()) << "vertex " << v;
    }
    for (std::size_t a = 0; a < correct.positions.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        Example e = correct;
        std::swap(e.positions[a], e.positions[b]);
        e.project();
        EXPECT_FALSE(e.verify().all_true()) << "vertices " << a << " and " << b;
      }
  }
}

}  // namespace
}  // namespace remesh
