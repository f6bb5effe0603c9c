#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/core/verify/curved_example.h"

namespace remesh {
namespace {

const CurvedPlace kShaft{SurfaceKind::kCylinder, 1};
const AnalyticSurface kPlane{SurfaceKind::kPlane, {}, {0, 0, 1}, 0, 0, 0};

/// The point number k of n on a circle. The same fraction of the circle gives the same bits.
Vec3 on_circle(int k, int n, double z) { return kShaft.point(2 * kPi * (static_cast<double>(k % n) / n), z); }

/// Adds the part of a barrel between two points of a circle of n points, in `rows` rows from z = 0 to 2.
void add_barrel(PatchedMesh& mesh, PatchId patch, int from, int to, int n, int rows) {
  for (int k = from; k < to; ++k)
    for (int r = 0; r < rows; ++r) {
      const double low = 2.0 * r / rows, high = 2.0 * (r + 1) / rows;
      mesh.add(patch, on_circle(k, n, low), on_circle(k + 1, n, low), on_circle(k + 1, n, high));
      mesh.add(patch, on_circle(k, n, low), on_circle(k + 1, n, high), on_circle(k, n, high));
    }
}

/// Adds the bottom and the top over the points `from` to `to` of a circle of n points.
void add_caps(PatchedMesh& mesh, int from, int to, int n) {
  std::vector<Vec3> top, bottom;
  for (int k = from; k <= to; ++k) {
    if (k == from + n) continue;  // the first one again
    top.push_back(on_circle(k, n, 2));
    bottom.push_back(on_circle(k, n, 0));
  }
  std::reverse(bottom.begin(), bottom.end());
  mesh.add_fan(PatchId(0), bottom);
  mesh.add_fan(PatchId(1), top);
}

/// Makes a closed shaft: two caps and two halves of a barrel. n is even.
PatchedMesh shaft(int n, int rows) {
  PatchedMesh mesh;
  add_caps(mesh, 0, n, n);
  add_barrel(mesh, PatchId(2), 0, n / 2, n, rows);
  add_barrel(mesh, PatchId(3), n / 2, n, n, rows);
  return mesh;
}
Example remeshed_shaft(int before, int after) {
  return curved_example(shaft(before, 3), shaft(after, 2), {kPlane, kPlane, kShaft.shape(), kShaft.shape()}, 0.3);
}

/// Makes a shaft whose barrel is one patch.
PatchedMesh whole_shaft(int n, int rows) {
  PatchedMesh mesh;
  add_caps(mesh, 0, n, n);
  add_barrel(mesh, PatchId(2), 0, n, n, rows);
  return mesh;
}
Example remeshed_whole_shaft(int before, int after) {
  return curved_example(whole_shaft(before, 3), whole_shaft(after, 2), {kPlane, kPlane, kShaft.shape()}, 0.3);
}

double chord_height(int n) { return 1 - std::cos(kPi / n); }

TEST(verify, a_shaft_with_another_number_of_sides_is_verified_with_the_height_of_its_chords) {
  for (const auto& [before, after] : {std::pair(16, 8), std::pair(8, 16), std::pair(24, 10), std::pair(36, 12)}) {
    const Example e = remeshed_shaft(before, after);
    ASSERT_TRUE(is_verified(e)) << before << " " << after;
    const Verdict v = e.verify();
    const double height = chord_height(std::min(before, after));
    ASSERT_EQ(v.patch_bounds.size(), 4u);
    for (std::uint32_t p = 0; p < 4; ++p) {
      EXPECT_LE(v.patch_bounds[p], height * (1 + 5e-4)) << before << " " << after << " " << p;
      EXPECT_GE(v.patch_bounds[p], true_distance(e, PatchId(p), 0.02 * height) * (1 - 1e-9))
          << before << " " << after << " " << p;
    }
    // In the first two, vertices of the finer circle are opposite the middles of the coarser one's chords.
    if (before == 8 || after == 8) {
      EXPECT_NEAR(v.patch_bounds[0], height, 1e-12);
    }
    EXPECT_EQ(v.distance_bound.output_to_input, *std::max_element(v.patch_bounds.begin(), v.patch_bounds.end()));
  }
}

/// Makes a frustum between the heights 1 and 3 over the apex of its cone: two caps and two halves of its side.
PatchedMesh frustum(const CurvedPlace& cone, int n, int rows) {
  PatchedMesh mesh;
  const auto at = [&](int k, double v) { return cone.point(2 * kPi * (static_cast<double>(k % n) / n), v); };
  std::vector<Vec3> top, bottom;
  for (int k = 0; k < n; ++k) {
    top.push_back(at(k, 3));
    bottom.push_back(at(k, 1));
  }
  std::reverse(bottom.begin(), bottom.end());
  mesh.add_fan(PatchId(0), bottom);
  mesh.add_fan(PatchId(1), top);
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < rows; ++r) {
      const PatchId patch(k < n / 2 ? 2 : 3);
      const double low = 1 + 2.0 * r / rows, high = 1 + 2.0 * (r + 1) / rows;
      mesh.add(patch, at(k, low), at(k + 1, low), at(k + 1, high));
      mesh.add(patch, at(k, low), at(k + 1, high), at(k, high));
    }
  return mesh;
}

TEST(verify, the_rims_of_a_cone_move_into_it_and_along_it_by_the_height_of_their_chords_in_all) {
  for (const double degrees : {10.0, 30.0, 45.0, 70.0})
    for (const auto& [before, after] : {std::pair(16, 8), std::pair(72, 8), std::pair(8, 24), std::pair(36, 12)}) {
      SCOPED_TRACE(testing::Message() << degrees << " degrees, from " << before << " to " << after);
      const CurvedPlace cone{SurfaceKind::kCone, 0, 0, degrees * kPi / 180};
      const double height = 3 * std::tan(cone.half_angle) * chord_height(std::min(before, after));
      const Example e = curved_example(frustum(cone, before, 3), frustum(cone, after, 2),
                                       {kPlane, kPlane, cone.shape(), cone.shape()}, height * (1 + 2e-3));
      ASSERT_TRUE(is_verified(e)) << all_words(e.verify());
      for (const std::uint32_t p : {2u, 3u}) {
        EXPECT_LE(e.verify().patch_bounds[p], height * (1 + 2e-3));
        EXPECT_GE(e.verify().patch_bounds[p], true_distance(e, PatchId(p), 0.02 * height) * (1 - 1e-9));
      }
      if (before != 16) continue;
      // Each second vertex of the input is opposite the middle of a new chord.
      Example strict = e;
      for (auto& surface : strict.curved) surface.tolerance = 0.97 * height;
      EXPECT_FALSE(is_verified(strict));
    }
}

TEST(verify, the_change_of_a_shafts_volume_is_within_its_bound) {
  for (const auto& [before, after] : {std::pair(24, 8), std::pair(8, 24), std::pair(36, 6)}) {
    const auto volume = [](int n) { return n * std::sin(2 * kPi / n); };
    const Verdict v = remeshed_shaft(before, after).verify();
    EXPECT_GE(v.volume_bound, std::fabs(volume(before) - volume(after)));
    EXPECT_LE(v.volume_bound, 10 * std::fabs(volume(before) - volume(after)));
  }
}

TEST(verify, a_circle_of_which_one_vertex_stays_is_followed_in_the_direction_of_its_patches) {
  for (const auto& [before, after] : {std::pair(9, 7), std::pair(7, 16), std::pair(25, 8)}) {
    const Example e = remeshed_whole_shaft(before, after);
    ASSERT_TRUE(is_verified(e)) << before << " " << after;
    EXPECT_LE(e.verify().patch_bounds[0], chord_height(std::min(before, after)) * (1 + 1e-9));
    Example inside_out = e;
    for (Triangle& face : inside_out.faces) std::swap(face[1], face[2]);
    const Verdict v = inside_out.verify();
    EXPECT_FALSE(v.surface);
    EXPECT_NE(all_words(v).find("too far"), std::string::npos) << all_words(v);
  }
}

TEST(verify, a_circle_that_was_turned_round_is_followed_too) {
  // The numbers of vertices decide in which direction a circle is walked. Here they are all mixed.
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto mixed = [&](const PatchedMesh& mesh) {
      PatchedMesh out;
      std::vector<std::size_t> order(mesh.faces.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::shuffle(order.begin(), order.end(), std::mt19937(seed));
      for (const std::size_t f : order) {
        const auto at = [&](std::size_t k) { return mesh.positions[mesh.faces[f][k].value]; };
        out.add(mesh.patches[f], at(1), at(2), at(0));
      }
      return out;
    };
    EXPECT_TRUE(is_verified(
        curved_example(mixed(whole_shaft(9, 3)), mixed(whole_shaft(7, 2)), {kPlane, kPlane, kShaft.shape()}, 0.3)))
        << seed;
    EXPECT_TRUE(is_verified(
        curved_example(mixed(shaft(10, 3)), mixed(shaft(8, 2)), {kPlane, kPlane, kShaft.shape(), kShaft.shape()}, 0.3)))
        << seed;
  }
}

/// Makes a half shaft: its barrel, its flat side, and two caps. Each cap has an arc and a line with the same ends.
PatchedMesh half_shaft(int n, int rows) {
  PatchedMesh mesh;
  add_caps(mesh, 0, n / 2, n);
  add_barrel(mesh, PatchId(2), 0, n / 2, n, rows);
  for (int r = 0; r < rows; ++r) {
    const auto left = [&](int i) { return on_circle(n / 2, n, 2.0 * i / rows); };
    const auto right = [&](int i) { return on_circle(0, n, 2.0 * i / rows); };
    mesh.add(PatchId(3), left(r), right(r + 1), right(r));
    mesh.add(PatchId(3), left(r), left(r + 1), right(r + 1));
  }
  return mesh;
}

TEST(verify, an_arc_and_a_line_between_the_same_ends_are_told_apart) {
  const std::vector<AnalyticSurface> surfaces{kPlane, kPlane, kShaft.shape(), kPlane};
  Example e = curved_example(half_shaft(24, 3), half_shaft(8, 2), surfaces, 0.3);
  ASSERT_TRUE(is_verified(e));
  EXPECT_NEAR(e.verify().patch_bounds[3], 0, 1e-12);
  // The arc is not allowed to become the line.
  EXPECT_FALSE(curved_example(half_shaft(24, 3), half_shaft(2, 2), surfaces, 2).verify().surface);
}

TEST(verify, halves_that_change_places_are_found) {
  Example e = remeshed_shaft(24, 8);
  for (PatchId& p : e.face_patch)
    if (p.value >= 2) p = PatchId(5 - static_cast<int>(p.value));
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, PatchId(2)) && blames(v, PatchId(3)));
}

TEST(verify, surfaces_that_change_places_are_found) {
  // Two shafts of different radii, beside each other.
  PatchedMesh before, after;
  const CurvedPlace thick{SurfaceKind::kCylinder, 2, 0, 0, {5, 0, 0}};
  before.add_grid(PatchId(0), kShaft, {0, 0}, {2, 1}, 12, 2);
  after.add_grid(PatchId(0), kShaft, {0, 0}, {2, 1}, 6, 2);
  before.add_grid(PatchId(1), thick, {0, 0}, {2, 1}, 12, 2);
  after.add_grid(PatchId(1), thick, {0, 0}, {2, 1}, 6, 2);
  Example e = curved_example(before, after, {kShaft.shape(), thick.shape()}, 0.3);
  ASSERT_TRUE(is_verified(e));
  std::swap(e.curved_of_patch[0], e.curved_of_patch[1]);
  EXPECT_EQ(e.verify().failed_patches.size(), 2u);
}

/// Moves a new vertex of a shaft's upper rim, at an eighth of the circle.
Example with_moved_rim(double outwards, double upwards) {
  Example e = remeshed_shaft(12, 8);
  const Vec3 from = on_circle(1, 8, 2);
  move_vertex(e, from, from + outwards * Vec3{from.x, from.y, 0} + upwards * Vec3{0, 0, 1});
  e.make_delaunay();
  return e;
}

TEST(verify, a_plane_beside_a_curved_patch_keeps_its_plane) {
  EXPECT_TRUE(is_verified(with_moved_rim(0.05, 0)));
  const Verdict v = with_moved_rim(0, 0.05).verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, PatchId(1)));
  EXPECT_FALSE(blames(v, PatchId(0)));
}

TEST(verify, a_rim_must_stay_within_the_tolerance) {
  Example e = with_moved_rim(0.2, 0);
  EXPECT_TRUE(is_verified(e));
  for (CurvedClaim& claim : e.curved) claim.tolerance = 0.19;
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches, (std::vector<PatchId>{PatchId(1), PatchId(2)}));
}

TEST(verify, a_rim_that_is_cut_on_one_side_only_is_found) {
  Example e = remeshed_shaft(12, 8);
  const Vec3 a = on_circle(1, 8, 2), b = on_circle(2, 8, 2);
  split_edge(e, a, b, 0.5 * (a + b), PatchId(2));
  EXPECT_FALSE(e.verify().conforming);
}

TEST(verify, an_arc_whose_patches_are_the_same_both_ways_is_found_by_its_direction) {
  // A hemisphere on a disc. Of the rim, two vertices stay, so both arcs have the same ends and the same patches.
  const CurvedPlace ball{SurfaceKind::kSphere, 1};
  const auto dome = [&](int n) {
    PatchedMesh mesh;
    std::vector<Vec3> disc;
    for (int k = n; k > 0; --k) disc.push_back(on_circle(k, n, 0));
    mesh.add_fan(PatchId(0), disc);
    const auto at = [&](int k, int row) {
      if (row == 0) return on_circle(k, n, 0);
      return row == 3 ? Vec3{0, 0, 1} : ball.point(2 * kPi * (static_cast<double>(k % n) / n), row * kPi / 6);
    };
    for (int k = 0; k < n; ++k)
      for (int row = 0; row < 3; ++row) {
        mesh.add(PatchId(1), at(k, row), at(k + 1, row), at(k + 1, row + 1));
        mesh.add(PatchId(1), at(k, row), at(k + 1, row + 1), at(k, row + 1));
      }
    return mesh;
  };
  const Example e = curved_example(dome(14), dome(10), {kPlane, ball.shape()}, 0.3);
  ASSERT_TRUE(is_verified(e));
  EXPECT_LE(e.verify().patch_bounds[0], chord_height(10) * (1 + 1e-9));
}

TEST(verify, gores_that_meet_in_two_poles_are_verified) {
  const CurvedPlace ball{SurfaceKind::kSphere, 1};
  const int gores = 6;
  const auto globe = [&](int rows, int columns) {
    PatchedMesh mesh;
    const auto at = [&](int column, int row) {
      if (row == 0 || row == rows) return Vec3{0, 0, row == 0 ? -1.0 : 1.0};
      const int n = gores * columns;
      return ball.point(2 * kPi * (static_cast<double>(column % n) / n), -kPi / 2 + kPi * row / rows);
    };
    for (int c = 0; c < gores * columns; ++c)
      for (int r = 0; r < rows; ++r) {
        const PatchId patch(static_cast<std::size_t>(c / columns));
        mesh.add(patch, at(c, r), at(c + 1, r), at(c + 1, r + 1));
        mesh.add(patch, at(c, r), at(c + 1, r + 1), at(c, r + 1));
      }
    return mesh;
  };
  const std::vector<AnalyticSurface> surfaces(gores, ball.shape());
  const Example e = curved_example(globe(9, 2), globe(7, 1), surfaces, 0.4);
  ASSERT_TRUE(is_verified(e));
  // A gore is rotated onto the next one.
  Example wrong = e;
  for (PatchId& p : wrong.face_patch) p = PatchId((p.value + 1) % gores);
  EXPECT_EQ(wrong.verify().failed_patches.size(), static_cast<std::size_t>(gores));
}

TEST(verify, certificates_across_angles_need_lines_that_are_straight_although_a_curve_was_cut_anew) {
  // A plate between a line and an arc that begins at the same vertex; a wall stands on the arc.
  const CurvedPlace wall{SurfaceKind::kCylinder, 1, 0, 0, {0, 1, 0}};
  const auto on_arc = [&](double angle, double z = 0) { return Vec3{std::sin(angle), 1 - std::cos(angle), z}; };
  const auto on_line = [&](double length) { return length * normalized(Vec3{1, -0.3, 0}); };
  const auto plate = [&](const std::vector<double>& angles) {
    PatchedMesh mesh;
    Vec3 left{}, right{};
    for (const double angle : angles) {
      const Vec3 arc = on_arc(angle), line = on_line(norm(arc));
      mesh.add(PatchId(0), left, right, arc);
      mesh.add(PatchId(0), right, line, arc);
      left = arc;
      right = line;
    }
    double before = 0;
    for (const double angle : angles) {
      mesh.add(PatchId(1), on_arc(before), on_arc(angle), on_arc(angle, 1));
      mesh.add(PatchId(1), on_arc(before), on_arc(angle, 1), on_arc(before, 1));
      before = angle;
    }
    return mesh;
  };
  Example e = curved_example(plate({0.1, 0.2, 0.3, 0.6}), plate({0.15, 0.4, 0.6}), {kPlane, wall.shape()}, 0.1);
  e.goals = angle_goal(60);
  for (std::size_t f = 0; f < e.faces.size(); ++f) list(e, f, UnrefinedReason::kEffort);
  ASSERT_TRUE(is_verified(e));
  // Certifies the faces of which the shortest edge runs across the angle at an angle of the arc.
  const auto may_be_across = [&](double angle) {
    Example claim = e;
    const Vec3 left = on_arc(angle), right = on_line(norm(left));
    int certified = 0;
    for (std::size_t f = 0; f < claim.faces.size(); ++f) {
      const Triangle& face = claim.faces[f];
      double shortest = HUGE_VAL;
      for (int i = 0; i < 3; ++i)
        shortest = std::min(shortest, norm(claim.positions[face[i].value] - claim.positions[face[(i + 1) % 3].value]));
      const bool is_there = std::count(face.begin(), face.end(), claim.vertex_at(left)) +
                                std::count(face.begin(), face.end(), claim.vertex_at(right)) ==
                            2;
      if (!is_there || shortest < norm(left - right)) continue;
      claim.reasons[f] = UnrefinedReason::kAcrossInputAngle;
      ++certified;
    }
    EXPECT_GT(certified, 0) << angle;
    return claim.verify().quality.value();
  };
  // The first edge of the arc is a line from the corner. The second one begins at a bend.
  EXPECT_TRUE(may_be_across(0.15));
  EXPECT_FALSE(may_be_across(0.4));
}

}  // namespace
}  // namespace remesh
