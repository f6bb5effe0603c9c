#include "core/refinement/sizes/size_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/refinement/prediction/prediction.h"
#include "tests/support/hostile_families.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
/// The tolerance for sizes: they are stored in single precision, and a little too large.
constexpr double kSingle = 1e-6;

Goals goals(double proximity, double gradation) {
  Goals g;
  g.max_edge_length = kUnlimited;
  g.max_area = kUnlimited;
  g.max_faces = 1u << 30;
  g.proximity = proximity;
  g.gradation = gradation;
  return g;
}

struct SizeScene {
  SizeScene(const PolygonMesh& mesh, const Goals& goals, double tolerance = 1e-12)
      : chain(mesh, tolerance),
        gaps(chain.surface, chain.adjacency, chain.patches, tolerance, chain.control),
        sizes(chain.surface, goals.proximity > 0 ? &gaps : nullptr, segments(chain), goals, tolerance, chain.control) {}

  /// Chords between the essential vertices of each loop.
  static std::vector<std::array<VertexId, 2>> segments(const StageChain& chain) {
    std::vector<std::array<VertexId, 2>> found;
    for (std::uint32_t l = 0; l + 1 < chain.loops.loop_begin.size(); ++l) {
      std::vector<VertexId> corners;
      for (const std::uint32_t h : chain.loops.loop(l))
        if (chain.essential[chain.adjacency.from(h)]) corners.push_back(chain.adjacency.from(h));
      for (std::size_t i = 0; i < corners.size(); ++i) found.push_back({corners[i], corners[(i + 1) % corners.size()]});
    }
    return found;
  }
  struct Place {
    Vec3 point;
    PatchId patch;
  };
  Place place(Random& random) const {
    const PatchId p(random.below(static_cast<int>(gaps.patch_count())));
    const auto triangles = gaps.triangles_of(p);
    const Triangle& t = triangles[random.below(static_cast<int>(triangles.size()))];
    const double u = random.unit(), v = random.unit() * (1 - u);
    const auto& at = chain.surface.positions;
    return {at[t[0]] + u * (at[t[1]] - at[t[0]]) + v * (at[t[2]] - at[t[0]]), p};
  }

  StageChain chain;
  GapSearch gaps;
  SizeField sizes;
};

PolygonMesh plates(double distance, int n = 3) {
  return shapes::joined(shapes::sheet(4, 4, n, n), shapes::moved(shapes::sheet(4, 4, 2, 2), {0, 0, distance}));
}
/// Makes a plate 1/16 thick from which a block rises, with a slot in it.
PolygonMesh thick_and_thin() {
  const std::vector<Vec2> outline = {{0, 0},        {4, 0},     {4, 0.0625}, {2, 0.0625}, {2, 1},      {1.5625, 1},
                                     {1.5625, 0.5}, {1.5, 0.5}, {1.5, 1},    {1, 1},      {1, 0.0625}, {0, 0.0625}};
  return shapes::rotated(shapes::prism(outline, 2), {1, 2, 3}, 35);
}

TEST(size_field, a_rescaled_field_has_the_sizes_of_the_other_goals) {
  const Goals of_field = goals(2, 1.5), others = goals(0.5, 1.25);
  const SizeScene scene(thick_and_thin(), of_field), other(thick_and_thin(), others);
  const SizeField rescaled = scene.sizes.rescaled(of_field.proximity, others, scene.chain.control);
  EXPECT_GT(rescaled.sample_count(), 0u);
  EXPECT_EQ(rescaled.slope(), other.sizes.slope());
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 point = scene.place(random).point;
    // Where gaps shrink, the cells of the two fields differ.
    EXPECT_LE(rescaled.at(point), 2 * other.sizes.at(point));
    EXPECT_GE(rescaled.at(point), 0.5 * other.sizes.at(point));
  }
}

TEST(size_field, without_proximity_and_gradation_it_is_the_same_everywhere) {
  EXPECT_EQ(SizeField().at({1, 2, 3}), kUnlimited);
  EXPECT_TRUE(SizeField(0.5).is_uniform());
  EXPECT_EQ(SizeField(0.5).at({1, 2, 3}), 0.5);
  EXPECT_TRUE(SizeField(0.5).allows(0.5, {1, 2, 3}));
  EXPECT_FALSE(SizeField(0.5).allows(0.51, {1, 2, 3}));
  Goals g = goals(0, 0);
  g.max_edge_length = 0.25;
  const SizeScene scene(shapes::box({1, 1, 1}), g);
  EXPECT_TRUE(scene.sizes.is_uniform());
  EXPECT_EQ(scene.sizes.at({0, 0, 0}), 0.25);
}

TEST(size_field, between_plates_it_is_the_gap_over_the_proximity_and_grows_away_from_them) {
  for (const double proximity : {0.5, 1.0, 3.0})
    for (const double gradation : {1.2, 1.5, 4.0}) {
      const SizeScene scene(plates(0.125, 7), goals(proximity, gradation));
      const double size = 0.125 / proximity;
      Random random(1);
      for (int i = 0; i < 100; ++i) EXPECT_NEAR(scene.sizes.at(scene.place(random).point), size, kSingle);
      EXPECT_NEAR(scene.sizes.at({2, -0.5, 0}), size + (gradation - 1) * 0.5, kSingle * gradation);
      EXPECT_NEAR(scene.sizes.at({2, 2, -3}), size + (gradation - 1) * 3, 3 * kSingle * gradation);
    }
}

TEST(size_field, it_is_larger_than_the_gap_by_more_than_its_noise_and_by_the_tolerance) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const double gap = 0.05 + 0.2 * random.unit(), tolerance = 1e-4 * gap;
    const double exact = SizeScene(plates(gap), goals(1, 1.5)).sizes.at({1, 2, 0});
    EXPECT_GT(exact * (1 - SizeField::kNoise), gap);
    EXPECT_LT(exact, gap * (1 + kSingle));
    EXPECT_NEAR(SizeScene(plates(gap), goals(2, 1.5), tolerance).sizes.at({1, 2, 0}), (gap + tolerance) / 2, kSingle);
  }
}

TEST(size_field, across_the_rim_of_a_wall_it_grows_from_both_sides_however_the_wall_stands) {
  const double thick = 0.25;
  for (const double degrees : {0.0, 10.0, 35.0, 60.0}) {
    const auto turned = [&](const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, degrees); };
    const SizeScene scene(turned(shapes::box({4, 4, thick})), goals(1, 1.5));
    for (const double part : {0.0, 0.2, 0.5, 0.7}) {
      PolygonMesh place = shapes::polygon({{2, 0}, {3, 0}, {3, 1}});
      place = turned(shapes::moved(place, {0, 0, part * thick}));
      const double way = std::min(part, 1 - part) * thick;
      EXPECT_NEAR(scene.sizes.at(place.positions[VertexId(0)]), thick + 0.5 * way, kSingle) << degrees << " " << part;
    }
  }
}

TEST(size_field, plates_that_overlap_in_a_corner_are_seen_there) {
  // The middle of neither faces the other one, and a wall farther off is faced by both.
  for (const double wall : {20.0, 5.0}) {
    const SizeScene scene(
        shapes::joined(shapes::joined(shapes::sheet(4, 4, 1, 1), shapes::moved(shapes::sheet(4, 4, 1, 1), {3, 3, 0.1})),
                       shapes::moved(shapes::sheet(20, 20, 1, 1), {-5, -5, -wall})),
        goals(1, 1.5));
    EXPECT_NEAR(scene.sizes.at({3.5, 3.5, 0}), 0.1, kSingle);
    EXPECT_NEAR(scene.sizes.at({3.5, 3.5, 0.1}), 0.1, kSingle);
    EXPECT_GT(scene.sizes.at({1, 1, 0}), 0.5);
  }
}

TEST(size_field, samples_are_as_many_as_faces_of_that_size_whatever_the_input_faces_are) {
  // 4 x 4 at a size of 1/4: two plates, 4^2 / (1/4)^2 = 256 squares each. Cells are halved, so there may be four in
  // one, and a few segments.
  for (const int n : {1, 5, 40}) {
    const SizeScene scene(plates(0.25, n), goals(1, 1.5));
    EXPECT_GE(scene.sizes.sample_count(), 2 * 256u) << n;
    EXPECT_LE(scene.sizes.sample_count(), 2 * 4 * 256 + 16u) << n;
  }
}

TEST(size_field, sizes_are_at_least_the_floor_and_at_most_the_largest_edge) {
  // A small plate close to a large one.
  const double diagonal = std::sqrt(32 + 1e-8);
  const PolygonMesh close =
      shapes::joined(shapes::sheet(4, 4, 3, 3), shapes::moved(shapes::sheet(0.0625, 0.0625, 1, 1), {1, 1, 1e-4}));
  EXPECT_NEAR(SizeScene(close, goals(1, 1.5)).sizes.at({1.03, 1.04, 0}), diagonal / 2048, kSingle * 1e-3);
  EXPECT_NEAR(SizeScene(close, goals(0.03125, 1.5)).sizes.at({1.03, 1.04, 0}), 3.2e-3, kSingle * 1e-2);
  EXPECT_NEAR(SizeScene(plates(1e-2), goals(1, 1.5), 0.003).sizes.at({1, 1, 0}), 0.03, kSingle);
  Goals g = goals(1, 1.5);
  g.min_edge_length = 0.5;
  EXPECT_NEAR(SizeScene(plates(0.1), g).sizes.at({1, 1, 0}), 0.5, kSingle);
  g.min_edge_length = 0;
  g.max_edge_length = 0.25;
  const SizeScene coarse(plates(1), g);
  EXPECT_EQ(coarse.sizes.at({1, 1, 0}), 0.25);
  EXPECT_TRUE(coarse.sizes.is_uniform());  // nothing finer to say
}

TEST(size_field, no_place_has_more_than_twice_what_its_gap_asks_for) {
  for (const PolygonMesh& mesh :
       {thick_and_thin(), shapes::cylinder(24, 1, 0.2),
        shapes::joined(shapes::sheet(4, 4, 9, 2),
                       shapes::rotated(shapes::moved(shapes::sheet(1, 1, 1, 1), {1, 1, 0.05}), {1, 0, 0}, 5))}) {
    const SizeScene scene(mesh, goals(1, 1.5));
    Random random(3);
    int finer = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto [point, patch] = scene.place(random);
      const double gap = scene.gaps.at(point, patch, kUnlimited);
      EXPECT_LE(scene.sizes.at(point), 2 * gap * (1 + kSingle));
      finer += scene.sizes.at(point) < 0.5 * gap;
    }
    EXPECT_LT(finer, 2000);  // it is not small everywhere
  }
}

TEST(size_field, it_is_what_the_gaps_ask_for_graded_and_not_much_less) {
  // Against the graded gaps of many places: at() is about the least of them.
  const SizeScene scene(thick_and_thin(), goals(1, 1.5));
  Random random(4);
  std::vector<std::pair<Vec3, double>> seen;
  for (int i = 0; i < 20000; ++i) {
    const auto [point, patch] = scene.place(random);
    const double gap = scene.gaps.at(point, patch, kUnlimited);
    if (gap < kUnlimited) seen.push_back({point, gap});
  }
  for (const auto& [v, w] : SizeScene::segments(scene.chain)) {
    const Vec3 &a = scene.chain.surface.positions[v], &b = scene.chain.surface.positions[w];
    for (int i = 0; i <= 64; ++i) seen.push_back({a + (i / 64.0) * (b - a), norm(b - a)});
  }
  for (int i = 0; i < 200; ++i) {
    const Vec3 point = scene.place(random).point;
    double graded = kUnlimited;
    for (const auto& [place, size] : seen) graded = std::min(graded, size + 0.5 * norm(place - point));
    EXPECT_LE(scene.sizes.at(point), 1.5 * graded);
    EXPECT_GE(scene.sizes.at(point), 0.6 * graded);
  }
}

TEST(size_field, samples_that_others_make_needless_are_left_out_and_it_stays_the_same) {
  // A gap that opens by 35 degrees: sizes that grow by a fifth of the way come from its narrow end alone.
  const PolygonMesh mesh =
      shapes::joined(shapes::sheet(4, 4, 1, 1),
                     shapes::moved(shapes::rotated(shapes::sheet(4, 4, 1, 1), {0, -1, 0}, 35), {0, 0, 0.0625}));
  const SizeScene slow(mesh, goals(1, 1.2)), fast(mesh, goals(1, 3));
  EXPECT_LT(slow.sizes.sample_count(), fast.sizes.sample_count() / 2);
  EXPECT_GT(slow.sizes.sample_count(), 64u);
  Random random(9);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 x = slow.place(random).point, y = slow.place(random).point;
    // Sizes that may grow faster are never smaller, and as far from there as they grow the slower one is no larger.
    EXPECT_LE(slow.sizes.at(x), fast.sizes.at(x) * (1 + kSingle));
    EXPECT_LE(slow.sizes.at(x), (fast.sizes.at(y) + 0.2 * norm(x - y)) * (1 + kSingle));
  }
}

TEST(size_field, it_grows_by_no_more_than_the_slope) {
  for (const double gradation : {1.1, 1.5, 3.0}) {
    const SizeScene scene(thick_and_thin(), goals(1, gradation));
    Random random(5);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 x = scene.place(random).point;
      const Vec3 y = i % 2 ? scene.place(random).point
                           : x + 0.01 * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      EXPECT_LE(std::abs(scene.sizes.at(x) - scene.sizes.at(y)), (gradation - 1) * norm(x - y) + 1e-12);
    }
  }
}

TEST(size_field, gradation_alone_grades_away_from_short_segments) {
  // A plate with a nick: two segments of 1/32 in a border of 4.
  const SizeScene scene(
      shapes::polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2.03125}, {0.03125, 2.03125}, {0.03125, 2}, {0, 2}}),
      goals(0, 1.25));
  EXPECT_NEAR(scene.sizes.at({0, 2, 0}), 0.03125, kSingle);
  EXPECT_NEAR(scene.sizes.at({1.03125, 2, 0}), 0.03125 + 0.25, kSingle);
  EXPECT_NEAR(scene.sizes.at({0, 1, 0}), 0.03125 + 0.25, kSingle);  // on a segment of length 2
  EXPECT_NEAR(scene.sizes.at({0, 3.03125, 7}), 0.03125 + 0.25 * std::hypot(1, 7), 10 * kSingle);
  // Far from everything else, the size is bounded by the lengths of the segments.
  const SizeScene square(shapes::polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}}), goals(0, 1.25));
  EXPECT_NEAR(square.sizes.at({1, 0, 0}), 4, 4 * kSingle);
  EXPECT_NEAR(square.sizes.at({2, 2, 0}), 4 + 0.25 * 2, 4 * kSingle);
}

TEST(size_field, however_a_surface_lies_sizes_grow_from_its_segments_alike) {
  const PolygonMesh nicked =
      shapes::polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2.03125}, {0.03125, 2.03125}, {0.03125, 2}, {0, 2}});
  const auto turned = [&](const Vec3& axis, double degrees) { return shapes::rotated(nicked, axis, degrees); };
  const SizeScene flat(nicked, goals(0, 1.25));
  for (const double degrees : {45.0, 90.0, 17.0}) {
    const Vec3 axis{1, 2, 3};
    const SizeScene askew(turned(axis, degrees), goals(0, 1.25));
    Random random(9);
    for (int i = 0; i < 500; ++i) {
      // The vertices' positions tell where a place has gone.
      const SizeScene::Place x = flat.place(random);
      const auto &from = flat.chain.surface.positions, &to = askew.chain.surface.positions;
      const VertexId o(0), u(1), v(2);
      const Vec3 a = from[u] - from[o], b = from[v] - from[u], c = to[u] - to[o], d = to[v] - to[u];
      const double s = dot(x.point - from[o], a) / dot(a, a), t = dot(x.point - from[o], b) / dot(b, b);
      EXPECT_NEAR(askew.sizes.at(to[o] + s * c + t * d), flat.sizes.at(x.point), 8 * kSingle);
    }
  }
}

TEST(size_field, however_a_part_lies_sizes_from_its_gaps_are_the_same) {
  // One gap of one width, which cells fill without a hole, and one that opens and ends, so where cells are cut shows.
  const PolygonMesh wall = shapes::box({3, 2.3, 0.13});
  const PolygonMesh wedge = shapes::joined(
      shapes::sheet(3, 2.3, 1, 1),
      shapes::moved(shapes::rotated(shapes::sheet(1.9, 1.7, 1, 1), {0.2, -1, 0}, 25), {0.4, 0.3, 0.0625}));
  for (const PolygonMesh& part : {wall, wedge}) {
    const SizeScene straight(part, goals(1, 1.5));
    for (const double degrees : {90.0, 17.0, 120.0}) {
      const Vec3 axis{1, 2, 3};
      const SizeScene askew(shapes::rotated(part, axis, degrees), goals(1, 1.5));
      EXPECT_EQ(straight.sizes.sample_count(), askew.sizes.sample_count());
      Random random(9);
      for (int i = 0; i < 1000; ++i) {
        const Vec3 x = straight.place(random).point;
        const PolygonMesh there =
            shapes::rotated(shapes::moved(shapes::polygon({{0, 0}, {1, 0}, {0, 1}}), x), axis, degrees);
        EXPECT_NEAR(askew.sizes.at(there.positions[VertexId(0)]), straight.sizes.at(x), 8 * kSingle);
      }
    }
  }
}

TEST(size_field, what_crosses_a_facet_has_no_gap_to_it_but_what_is_above_it_has) {
  // Two sheets that cross at 30 degrees, far from the middle of either; then a third one over the first.
  const PolygonMesh crossing =
      shapes::joined(shapes::sheet(4, 4, 1, 1),
                     shapes::moved(shapes::rotated(shapes::sheet(4, 4, 1, 1), {0.2, -1, 0}, 30), {0.1, 0.3, -0.4}));
  const SizeScene alone(crossing, goals(1, 1.5));
  Random random(9);
  double least = kUnlimited;
  for (int i = 0; i < 1000; ++i) least = std::min(least, alone.sizes.at(alone.place(random).point));
  // One triangle of each sheet ends before it reaches the other sheet, so a gap may remain, but no small one.
  EXPECT_GT(least, 0.1);
  const SizeScene covered(shapes::joined(crossing, shapes::moved(shapes::sheet(0.5, 0.5, 1, 1), {3.2, 0.4, 0.125})),
                          goals(1, 1.5));
  EXPECT_NEAR(covered.sizes.at({3.4, 0.6, 0}), 0.125, kSingle);
}

TEST(size_field, a_length_is_allowed_if_it_is_at_most_the_size) {
  const SizeScene scene(thick_and_thin(), goals(1, 1.5));
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = scene.place(random).point;
    const double size = scene.sizes.at(x);
    EXPECT_TRUE(scene.sizes.allows(size * random.uniform(0.3, 0.999999), x));
    EXPECT_FALSE(scene.sizes.allows(size * random.uniform(1.000001, 2), x));
  }
}

TEST(size_field, what_is_allowed_around_a_place_is_allowed_at_all_places_there) {
  const SizeScene scene(thick_and_thin(), goals(1, 1.5));
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = scene.place(random).point;
    const double radius = random.uniform(0, 0.5), size = scene.sizes.at(x);
    // By the slope alone, a size of at least this is allowed everywhere within the radius.
    EXPECT_TRUE(scene.sizes.allows(0.999999 * (size - 0.5 * radius), x, radius));
    const double length = random.uniform(0.5, 1) * size;
    if (!scene.sizes.allows(length, x, radius)) continue;
    for (int k = 0; k < 10; ++k) {
      const Vec3 way{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      EXPECT_GE(scene.sizes.at(x + (radius / std::sqrt(3.0)) * way), length * (1 - 1e-12));
    }
  }
}

TEST(size_field, no_answer_depends_on_what_was_asked_before) {
  const SizeScene many(thick_and_thin(), goals(1, 1.5)), few(plates(0.125), goals(1, 1.5));
  ASSERT_GT(many.sizes.sample_count(), few.sizes.sample_count());
  Random random(7);
  std::vector<Vec3> places(200);
  for (Vec3& p : places) p = many.place(random).point;
  std::vector<double> alone(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) alone[i] = many.sizes.at(places[i]);
  for (std::size_t i = places.size(); i-- > 0;) {
    const double size = few.sizes.at(places[i]);
    EXPECT_EQ(many.sizes.at(places[i]), alone[i]);
    EXPECT_FALSE(few.sizes.allows(1.001 * size, places[i]));
    EXPECT_TRUE(many.sizes.allows(0.999 * alone[i], places[i]));
    EXPECT_TRUE(few.sizes.allows(0.999 * size, places[i]));
    EXPECT_FALSE(many.sizes.allows(1.001 * alone[i], places[i]));
    EXPECT_EQ(few.sizes.at(places[i]), size);
  }
}

STAGE(size_field, test::kWorkers, test::kScale) {
  const SizeScene scene(trial.of(thick_and_thin()), goals(2, 1.3), 1e-12 * trial.scale);
  trial.same(scene.sizes.sample_count());
  Random random(8);
  for (int i = 0; i < 2000; ++i) trial.in_order(trial.length(scene.sizes.at(scene.place(random).point)));
}

STAGE(size_field_alone, test::kStop) {
  const StageChain chain(thick_and_thin());
  const GapSearch gaps(chain.surface, chain.adjacency, chain.patches, 1e-6, chain.control);
  SizeField(chain.surface, &gaps, {}, goals(1, 1.5), 1e-6, trial.control);
}

TEST(size_field, look_ups_cost_more_where_patches_that_span_the_part_lie_across_each_other) {
  EXPECT_EQ(SizeScene(plates(0.25), goals(1, 1.5)).sizes.look_up_cost(), 1);
  EXPECT_EQ(SizeScene(thick_and_thin(), goals(1, 1.5)).sizes.look_up_cost(), 1);
  EXPECT_EQ(rows_to_read(SizeScene(thick_and_thin(), goals(1, 1.5)).sizes), 6);
  const auto families = hostile::families();
  const auto soup =
      std::find_if(families.begin(), families.end(), [](const auto& f) { return f.name == "soup_in_a_cube"; });
  ASSERT_NE(soup, families.end());
  const StageChain chain(soup->make(1400), 1e-12);
  const GapSearch gaps(chain.surface, chain.adjacency, chain.patches, 1e-12, chain.control);
  // With so coarse a field, each patch is one sample.
  const SizeField sizes(chain.surface, &gaps, {}, goals(1, 1.5), 1e-12, chain.control, 0.5);
  EXPECT_GT(sizes.look_up_cost(), 2);
  EXPECT_LT(rows_to_read(sizes), 6);
  EXPECT_GE(rows_to_read(sizes), 2);
}

}  // namespace
}  // namespace remesh
