#include "core/geometry/surfaces/surface_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/curved_place.h"

namespace remesh {
namespace {

using test::CurvedPlace;

/// A surface, and the parameters of the middle of a piece and of places around it.
struct Case {
  std::string name;
  CurvedPlace place;
  Vec2 middle;
  std::vector<Vec2> around;
};

/// Returns pieces of all kinds, in places that are not special. They reach far from the middle.
std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, const CurvedPlace& place, Vec2 middle, Vec2 reach) {
    Case c{name, place.turned({1, 2, 3}, 40, {0.3, -2, 1}), middle, {}};
    for (const double u : {-1.0, -0.6, -0.05, 0.0, 0.3, 0.9})
      for (const double v : {-1.0, -0.4, 0.02, 0.5, 0.95})
        c.around.push_back({middle.x + u * reach.x, middle.y + v * reach.y});
    all.push_back(c);
  };
  add("cylinder", {SurfaceKind::kCylinder, 2}, {1, 0.5}, {2.6, 4});
  add("cylinder over the angle pi", {SurfaceKind::kCylinder, 0.25}, {3, -7}, {2.6, 1});
  add("blunt cone", {SurfaceKind::kCone, 0, 0, 1.2}, {-2, 3}, {2.6, 2.5});
  add("sharp cone", {SurfaceKind::kCone, 0, 0, 0.2}, {0.5, 3}, {2.6, 2.5});
  add("equator of a sphere", {SurfaceKind::kSphere, 3}, {0.7, 0}, {2.2, 1.2});
  add("pole of a sphere", {SurfaceKind::kSphere, 0.5}, {2, 1.5}, {2.5, 2.2});
  add("outer torus", {SurfaceKind::kTorus, 5, 2}, {-1, 0}, {2.6, 2.6});
  add("inner torus", {SurfaceKind::kTorus, 5, 4}, {2, 3}, {2.6, 2.6});
  add("top of a torus", {SurfaceKind::kTorus, 2, 0.1}, {3, 1.5}, {2.6, 2.6});
  return all;
}

Vec3 at(const Case& c, Vec2 q, double off = 0) { return c.place.point(q.x, q.y, off); }
SurfaceMap map_of(const Case& c, bool is_concave) { return {c.place.shape(), {at(c, c.middle), is_concave}}; }

/// Lengths on these surfaces are about as large as this.
double size_of(const Case& c) { return std::max({c.place.radius, c.place.minor_radius, 1.0}); }

template <class Test>
void for_each_place(const Test& test) {
  for (const Case& c : cases())
    for (const bool is_concave : {false, true}) {
      SCOPED_TRACE(c.name + (is_concave ? ", concave" : ", convex"));
      const SurfaceMap map = map_of(c, is_concave);
      for (const Vec2 q : c.around) {
        SCOPED_TRACE(testing::Message() << "at " << q.x << " " << q.y);
        test(c, map, is_concave, q);
      }
    }
}

TEST(surface_map, there_are_maps_of_surfaces_that_do_not_touch_themselves) {
  for (const Case& c : cases()) EXPECT_TRUE(SurfaceMap::can_map(c.place.shape())) << c.name;
  const auto can_map = [](const CurvedPlace& place) { return SurfaceMap::can_map(place.shape()); };
  // A tube that reaches over the axis ends there. One that lies beyond the axis is none.
  EXPECT_TRUE(can_map({SurfaceKind::kTorus, 1, 2}));
  EXPECT_TRUE(can_map({SurfaceKind::kTorus, -1, 2}));
  EXPECT_FALSE(can_map({SurfaceKind::kTorus, -2, 1}));
  EXPECT_FALSE(can_map({SurfaceKind::kTorus, 1, 0}));
  EXPECT_FALSE(can_map({SurfaceKind::kPlane}));
  EXPECT_FALSE(can_map({SurfaceKind::kRevolution}));
  EXPECT_FALSE(can_map({SurfaceKind::kFree}));
  EXPECT_FALSE(can_map({SurfaceKind::kCylinder, 0}));
  EXPECT_FALSE(can_map({SurfaceKind::kCone, 0, 0, std::numbers::pi / 2}));
  EXPECT_FALSE(can_map({SurfaceKind::kCone, 0, 0, 0}));
}

TEST(surface_map, points_of_the_surface_come_back) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    const Vec3 p = at(c, q);
    EXPECT_LT(norm(map.point(map.flat(p)) - p), 1e-13 * size_of(c));
  });
}

TEST(surface_map, places_of_the_plane_come_back) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    const Vec2 place = map.flat(at(c, q)) + Vec2{0.01, -0.02};
    EXPECT_LT(norm(map.flat(map.point(place)) - place), 1e-12 * size_of(c));
    EXPECT_LT(std::fabs(c.place.shape().distance(map.point(place))), 1e-13 * size_of(c));
  });
}

TEST(surface_map, a_point_beside_the_surface_has_the_place_of_its_foot) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    for (const double off : {-0.02, 0.02})
      EXPECT_LT(norm(map.flat(at(c, q, off)) - map.flat(at(c, q))), 1e-12 * size_of(c)) << off;
  });
}

TEST(surface_map, angles_stay_and_lengths_grow_by_the_stretch) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    const Vec2 place = map.flat(at(c, q));
    const double h = 1e-5;
    const Vec3 right = (1 / (2 * h)) * (map.point(place + Vec2{h, 0}) - map.point(place - Vec2{h, 0}));
    const Vec3 up = (1 / (2 * h)) * (map.point(place + Vec2{0, h}) - map.point(place - Vec2{0, h}));
    const double stretch = map.stretch(place);
    EXPECT_NEAR(norm(right), stretch, 1e-7 * stretch);
    EXPECT_NEAR(norm(up), stretch, 1e-7 * stretch);
    EXPECT_NEAR(dot(right, up), 0, 1e-7 * stretch * stretch);
  });
}

TEST(surface_map, what_is_counter_clockwise_in_the_plane_is_so_from_the_facets_outside) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool is_concave, Vec2 q) {
    const Vec2 place = map.flat(at(c, q));
    const double h = 1e-4;
    const Vec3 right = map.point(place + Vec2{h, 0}) - map.point(place);
    const Vec3 up = map.point(place + Vec2{0, h}) - map.point(place);
    const Vec3 seen = normalized(cross(right, up));
    // The outside of a shaft is away from its axis, that of a hole is towards it.
    const Vec3 outwards = normalized(at(c, q, 0.01) - at(c, q));
    EXPECT_GT(dot(seen, outwards) * (is_concave ? -1 : 1), 0.999);
    EXPECT_LT(norm(map.normal(place) - (is_concave ? -1.0 : 1.0) * outwards), 1e-9);
    EXPECT_EQ(map.side(), is_concave ? -1 : 1);
  });
}

TEST(surface_map, the_map_is_true_to_scale_in_the_middle) {
  for (const Case& c : cases()) {
    const SurfaceMap map = map_of(c, false);
    EXPECT_NEAR(map.stretch(map.flat(at(c, c.middle))), 1, 1e-12) << c.name;
  }
}

TEST(surface_map, a_cylinder_and_a_cone_are_unrolled) {
  // The way along a ruling, and around a circle, which a cone bends to an arc around its apex.
  for (const Case& c : cases()) {
    if (c.place.kind != SurfaceKind::kCylinder && c.place.kind != SurfaceKind::kCone) continue;
    SCOPED_TRACE(c.name);
    const SurfaceMap map = map_of(c, false);
    const Vec2 q = c.middle;
    const auto length = [&](Vec2 a, Vec2 b) { return norm(map.flat(at(c, a)) - map.flat(at(c, b))); };
    const double along = norm(at(c, q) - at(c, {q.x, q.y + 0.4}));
    EXPECT_NEAR(length(q, {q.x, q.y + 0.4}), along, 1e-12);
    if (c.place.kind == SurfaceKind::kCylinder) {
      EXPECT_NEAR(length({q.x - 1, q.y}, {q.x + 1.5, q.y}), 2.5 * c.place.radius, 1e-12);
    } else {
      const double slant = q.y / std::cos(c.place.half_angle), turn = 2.5 * std::sin(c.place.half_angle);
      EXPECT_NEAR(length({q.x - 1, q.y}, {q.x + 1.5, q.y}), 2 * slant * std::sin(turn / 2), 1e-12);
    }
  }
}

TEST(surface_map, the_coordinates_around_the_axis_are_the_angle_and_an_equally_long_way) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    if (!map.has_axis()) {
      EXPECT_EQ(c.place.kind, SurfaceKind::kSphere);
      return;
    }
    const Vec3 p = at(c, q);
    const SurfaceMap::Around place = map.around(p);
    EXPECT_NEAR(place.angle, q.x - c.middle.x, 1e-12);
    EXPECT_LT(norm(map.point(place) - p), 1e-12 * size_of(c));
    const double rho = map.radius(p);
    const Vec3 way = p - c.place.origin;
    EXPECT_NEAR(rho, norm(way - dot(way, c.place.z) * c.place.z), 1e-12 * size_of(c));
    const double h = 1e-5;
    const auto step = [&](double angle, double ahead) {
      const auto shifted = [&](double k) {
        return map.point(SurfaceMap::Around{place.angle + k * angle, place.way + k * ahead});
      };
      return norm(shifted(1) - shifted(-1)) / (2 * h);
    };
    EXPECT_NEAR(step(h, 0), rho, 1e-7 * size_of(c));
    EXPECT_NEAR(step(0, h), rho, 1e-7 * size_of(c));
  });
}

TEST(surface_map, the_middle_of_a_piece_is_where_the_angles_are_0) {
  for (const Case& c : cases()) {
    const SurfaceMap map = map_of(c, false);
    if (!map.has_axis()) continue;
    EXPECT_NEAR(map.around(at(c, c.middle)).angle, 0, 1e-12) << c.name;
    if (c.place.kind == SurfaceKind::kTorus) {
      EXPECT_NEAR(map.around(at(c, c.middle)).way, 0, 1e-12) << c.name;
    }
    // The last axis is the surface's own one, or leads to the middle.
    EXPECT_NEAR(norm(map.axes().z - c.place.z), 0, 1e-12) << c.name;
  }
}

TEST(surface_map, the_apex_of_a_cone_has_a_place) {
  for (const Case& c : cases()) {
    if (c.place.kind != SurfaceKind::kCone) continue;
    const SurfaceMap map = map_of(c, false);
    EXPECT_LT(norm(map.flat(c.place.origin)), 1e-15) << c.name;
    EXPECT_LT(norm(map.point(Vec2{0, 0}) - c.place.origin), 1e-15) << c.name;
  }
}

bool is_ruled(const Case& c) { return c.place.kind == SurfaceKind::kCylinder || c.place.kind == SurfaceKind::kCone; }

TEST(surface_map, places_of_a_squeezed_map_come_back_and_turn_as_before) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    const SurfaceMap squeezed = map.squeezed();
    const Vec3 p = at(c, q);
    EXPECT_LE(norm(squeezed.point(squeezed.flat(p)) - p), 1e-10 * size_of(c));
    constexpr double kStep = 1e-4;
    const Vec3 u = at(c, {q.x + kStep, q.y}), v = at(c, {q.x, q.y + kStep});
    const auto turn = [&](const SurfaceMap& m) { return cross(m.flat(u) - m.flat(p), m.flat(v) - m.flat(p)); };
    EXPECT_GT(turn(squeezed) * turn(map), 0);
  });
}

TEST(surface_map, a_squeezed_map_shortens_rulings_alone) {
  for_each_place([](const Case& c, const SurfaceMap& map, bool, Vec2 q) {
    const SurfaceMap squeezed = map.squeezed();
    const Vec2 here = squeezed.flat(at(c, q));
    if (!is_ruled(c)) {
      EXPECT_EQ(here, map.flat(at(c, q)));
      return;
    }
    // A ruling stays straight, and places on it are in the same proportions as in space.
    const Vec3 near = at(c, {q.x, 0.9 * q.y}), far = at(c, {q.x, 0.7 * q.y});
    const Vec2 to_near = squeezed.flat(near) - here, to_far = squeezed.flat(far) - here;
    EXPECT_NEAR(norm(to_far) / norm(to_near), 3, 1e-6);
    EXPECT_LE(std::fabs(cross(to_near, to_far)), 1e-9 * norm(to_near));
    EXPECT_LT(norm(to_far), 0.01 * norm(far - at(c, q)));
    // Around the axis, lengths are those of the surface but for the stretch.
    constexpr double kStep = 1e-6;
    const Vec3 beside = at(c, {q.x + kStep, q.y});
    EXPECT_NEAR(norm(squeezed.flat(beside) - here) * squeezed.stretch(here) / norm(beside - at(c, q)), 1, 1e-4);
  });
}

}  // namespace
}  // namespace remesh
