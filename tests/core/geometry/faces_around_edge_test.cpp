#include "core/geometry/shells/faces_around_edge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "tests/support/random.h"

namespace remesh {
namespace {

using EdgePairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// A face at an angle in degrees around the edge along z. A forward one looks towards larger angles.
struct At {
  double degrees;
  bool is_forward;
};

EdgePairs pairs_of(const std::vector<At>& places, std::uint64_t seed = 0, bool is_reversed = false) {
  std::vector<FaceAtEdge> faces;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const double angle = places[i].degrees * std::numbers::pi / 180;
    // Right angles are exact, so that faces are in one plane.
    const Vec3 apex{std::round(1e6 * std::cos(angle)), std::round(1e6 * std::sin(angle)), 3};
    faces.push_back({apex, places[i].is_forward != is_reversed, 0, i});
  }
  std::mt19937_64 engine(seed);
  std::shuffle(faces.begin(), faces.end(), engine);
  const Vec3 low{0, 0, -1}, high{0, 0, 5};
  RunControl control;
  EdgePairs pairs;
  for (const auto& [begins, ends] :
       pair_faces_around_edge(is_reversed ? high : low, is_reversed ? low : high, faces, control))
    pairs.insert({std::min(begins, ends), std::max(begins, ends)});
  return pairs;
}

TEST(pair_faces_around_edge, faces_with_solid_between_them_are_a_pair) {
  // Solids in [10, 50], [100, 200] and [300, 5].
  const std::vector<At> places{{10, false}, {50, true}, {100, false}, {200, true}, {300, false}, {5, true}};
  const EdgePairs right{{0, 1}, {2, 3}, {4, 5}};
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    EXPECT_EQ(pairs_of(places, seed), right);
    EXPECT_EQ(pairs_of(places, seed, true), right) << "along the edge the other way";
  }
}

TEST(pair_faces_around_edge, back_to_back_walls_are_of_two_solids) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    EXPECT_EQ(pairs_of({{0, false}, {90, true}, {90, false}, {180, true}}, seed), (EdgePairs{{0, 1}, {2, 3}}));
}

TEST(pair_faces_around_edge, of_walls_that_look_the_same_way_each_has_its_own_layer) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    EXPECT_EQ(pairs_of({{0, false}, {0, false}, {90, true}, {90, true}}, seed), (EdgePairs{{0, 2}, {1, 3}}));
}

TEST(pair_faces_around_edge, where_one_face_is_too_many_the_nearest_close_and_one_is_left) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    EXPECT_EQ(pairs_of({{0, false}, {90, false}, {180, true}}, seed), (EdgePairs{{1, 2}}));
    EXPECT_EQ(pairs_of({{0, false}, {90, true}, {180, true}}, seed), (EdgePairs{{0, 1}}));
  }
}

TEST(pair_faces_around_edge, faces_on_a_line_are_left_out) {
  std::vector<FaceAtEdge> faces{{{0, 0, 9}, true, 0, 0}, {{1, 0, 0}, false, 0, 1}, {{0, 1, 0}, true, 0, 2}};
  RunControl control;
  const auto pairs = pair_faces_around_edge({0, 0, 0}, {0, 0, 5}, faces, control);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0], std::pair(1u, 2u));
}

TEST(pair_faces_around_edge, wedges_at_random_are_found_again) {
  const std::uint64_t seed = base_seed(36);
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random(seed + i);
    std::vector<double> cuts;
    const auto wedges = static_cast<std::size_t>(random.integer(1, 8));
    while (cuts.size() < 2 * wedges) cuts.push_back(360 * random.unit());
    std::sort(cuts.begin(), cuts.end());
    const auto first = static_cast<std::size_t>(random.below(2));  // one of them may be cut by the direction 0
    std::vector<At> places;
    EdgePairs right;
    for (std::size_t w = 0; w < wedges; ++w) {
      right.insert({static_cast<std::uint32_t>(places.size()), static_cast<std::uint32_t>(places.size() + 1)});
      places.push_back({cuts[2 * w + first], false});
      places.push_back({cuts[(2 * w + first + 1) % cuts.size()], true});
    }
    ASSERT_EQ(pairs_of(places, i), right) << i;
  }
}

}  // namespace
}  // namespace remesh
