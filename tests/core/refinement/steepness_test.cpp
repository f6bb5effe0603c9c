#include "core/refinement/sizes/steepness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/geometry/triangles/distances.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

Vec3 random_place(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Returns three random corners about a place.
Corners3 random_triangle(Random& random, const Vec3& at, double size) {
  return {at + random_place(random, size), at + random_place(random, size), at + random_place(random, size)};
}

Vec3 normal_of(const Corners3& t) { return normalized(cross(t[1] - t[0], t[2] - t[0])); }

Slab slab_of(const Corners3& t) {
  Slab slab;
  slab.plane.normal = normal_of(t);
  slab.plane.origin = t[0];
  slab.half_thickness = 0x1p-48;
  return slab;
}

Vec3 random_place_on(Random& random, const Corners3& t) {
  const double u = random.unit(), v = random.unit() * (1 - u);
  return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
}

TEST(steepness, a_layer_holds_what_was_added_and_is_no_thicker) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    Layer layer(normalized(random_place(random, 1)));
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = random_place(random, 1);
      layer.add(p);
      least = std::min(least, layer.product(p));
      most = std::max(most, layer.product(p));
    }
    EXPECT_LT(layer.least, least);
    EXPECT_GT(layer.most, most);
    EXPECT_NEAR(layer.least, least, 3e-7);
    EXPECT_NEAR(layer.most, most, 3e-7);
  }
}

TEST(steepness, no_steep_way_is_shorter_than_what_is_told_of_all) {
  Random random(2);
  int steep = 0, longer = 0;
  for (int i = 0; i < 3000; ++i) {
    // Small and large, near and far, one or a few in a layer of any direction.
    const double size = std::pow(2, -random.below(8));
    const Corners3 from = random_triangle(random, random_place(random, 0.3), 0.1 * size);
    const Slab slab = slab_of(from);
    const Vec3 there = random_place(random, 0.3);
    const Corners3 to = random_triangle(random, there, 0.1 * size);
    FloatBox box;
    for (const Vec3& p : to) box.add(p);
    Layer layer(i % 3 == 0 ? normalized(random_place(random, 1)) : i % 3 == 1 ? normal_of(to) : Vec3{});
    for (const Vec3& p : to) layer.add(p);
    Products products{HUGE_VAL, -HUGE_VAL};
    for (const Vec3& p : from) {
      products.least = std::min(products.least, layer.product(p));
      products.most = std::max(products.most, layer.product(p));
    }
    const double told = squared_steep_distance(slab, products, box, layer, 0);
    for (int k = 0; k < 30; ++k) {
      const Vec3 way = random_place_on(random, to) - random_place_on(random, from);
      if (!slab.is_steep(way)) continue;
      ++steep;
      longer += told > 0.5 * norm_squared(way);
      EXPECT_LE(told, norm_squared(way)) << i;
    }
  }
  EXPECT_GT(steep, 10000);
  EXPECT_GT(longer, 1000);
}

/// On a sphere, the facets that a facet faces first lie on a whole circle, all at about the same distance. Without
/// layers, nothing is known about them before the search comes to single triangles, and about 30 n^(1/2) boxes are
/// looked at for each place.
TEST(steepness, on_a_sphere_few_boxes_are_looked_at) {
  struct Tag {
    Layer layer;
    void join(const Tag&) {}
  };
  std::vector<double> boxes;
  for (const int levels : {4, 5, 6}) {
    const PolygonMesh sphere = shapes::sphere(levels);
    std::vector<Corners3> triangles;
    std::vector<BoxTree<Tag>::Entry> entries;
    for (std::size_t f = 0; f < sphere.face_count(); ++f) {
      const auto face = sphere.face(FaceId(f));
      triangles.push_back({sphere.positions[face[0]], sphere.positions[face[1]], sphere.positions[face[2]]});
      entries.emplace_back();
      for (const Vec3& p : triangles.back()) entries.back().box.add(p);
    }
    RunControl control;
    BoxTree<Tag> tree(entries, control);
    tree.note(
        [&](Tag& tag, std::span<const std::uint32_t> among) {
          Vec3 sum;
          for (const std::uint32_t t : among) sum += normal_of(triangles[t]);
          tag.layer = Layer(normalized(sum));
          for (const std::uint32_t t : among)
            for (const Vec3& p : triangles[t]) tag.layer.add(p);
        },
        control);
    std::size_t looked_at = 0;
    double smallest = HUGE_VAL;
    for (const Corners3& from : triangles) {
      const Slab slab = slab_of(from);
      for (const Vec3& p : from)
        tree.search(
            smallest,
            [&](const BoxTree<Tag>::Entry& e) {
              ++looked_at;
              const double product = e.tag.layer.product(p), least = squared_distance(e.box, p);
              return least >= smallest ? least
                                       : squared_steep_distance(slab, {product, product}, e.box, e.tag.layer, least);
            },
            [&](std::size_t slot) {
              const Vec3 way = nearest_on_triangle(p, triangles[tree.number(slot)]) - p;
              if (slab.is_steep(way)) smallest = std::min(smallest, norm_squared(way));
            });
    }
    EXPECT_NEAR(std::sqrt(smallest), 2 * std::sqrt(kSteep), 2.0 / (1 << levels));
    boxes.push_back(static_cast<double>(looked_at) / static_cast<double>(3 * triangles.size()));
  }
  EXPECT_LT(boxes.back(), 2 * boxes.front()) << "with sixteen times the faces";
}

}  // namespace
}  // namespace remesh
