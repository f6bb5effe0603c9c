// Tests that the search for a floor finds the lowest one that serves, by the numbers of faces alone.

#include "core/refinement/attempts/min_edge_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace remesh {
namespace {

constexpr std::uint64_t kAllowed = 8600;

Goals goals_with(std::uint64_t allowed) {
  Goals goals{};
  goals.faces_without_min_edge = allowed;
  goals.lowest_min_edge = 0x1p-20;
  return goals;
}

struct Found {
  double floor;
  std::uint64_t faces;
  int attempts;
};

/// Does what refinement does: an attempt with one floor after the other.
template <class FacesOf>
Found search(MinEdgeSearch min_edge, std::uint64_t allowed, const FacesOf& faces_of) {
  for (int attempts = 1;; ++attempts) {
    const std::uint64_t faces = faces_of(min_edge.min_edge_length());
    if (faces > allowed) {
      if (!min_edge.may_go_on()) return {min_edge.min_edge_length(), faces, attempts};
      min_edge.record_too_many();
    } else if (!min_edge.record_fit(faces)) {
      return {min_edge.min_edge_length(), faces, attempts};
    }
  }
}

TEST(min_edge_search, looks_for_none_if_there_are_few_faces) {
  const Found found = search(MinEdgeSearch(goals_with(kAllowed)), kAllowed, [](double) { return kAllowed; });
  EXPECT_EQ(found.floor, 0);
  EXPECT_EQ(found.attempts, 1);
}

TEST(min_edge_search, uses_half_of_the_faces_where_they_shrink_steadily) {
  // Twice the floor leaves an eighth of the faces, so only one in three steps of the doubling ends above a half.
  for (double faces_at_1 = 1e-9; faces_at_1 < 1e-6; faces_at_1 *= 1.3) {
    const auto faces_of = [&](double floor) {
      return static_cast<std::uint64_t>(std::min(1e9, faces_at_1 / std::pow(floor, 3)));
    };
    const Found found = search(MinEdgeSearch(goals_with(kAllowed)), kAllowed, faces_of);
    EXPECT_LE(found.faces, kAllowed) << faces_at_1;
    EXPECT_GE(found.faces, kAllowed / 2) << faces_at_1;
    EXPECT_GT(faces_of(found.floor / 1.3), kAllowed) << faces_at_1;
  }
}

TEST(min_edge_search, ends_beside_a_jump) {
  for (const double jump : {0.001, 0.0013, 0.0015, 0.0019}) {
    const Found found = search(MinEdgeSearch(goals_with(kAllowed)), kAllowed,
                               [&](double floor) { return std::uint64_t{floor < jump ? 36'000u : 638u}; });
    EXPECT_EQ(found.faces, 638u) << jump;
    EXPECT_GE(found.floor, jump);
    EXPECT_LT(found.floor, 1.05 * jump);
    // 2^-20 is doubled at most eleven times, and there are no floor, four means, and the last one that fits once more.
    EXPECT_LE(found.attempts, 1 + 1 + 11 + 4 + 1) << jump;
  }
}

TEST(min_edge_search, knows_that_its_answer_fits) {
  const auto faces_of = [](double floor) { return std::uint64_t{floor < 0.0013 ? 36'000u : 638u}; };
  MinEdgeSearch min_edge(goals_with(kAllowed));
  bool is_any_known = false;
  for (bool is_another_tried = true; is_another_tried;) {
    const std::uint64_t faces = faces_of(min_edge.min_edge_length());
    EXPECT_EQ(min_edge.is_known_to_fit(), is_any_known);
    if (faces > kAllowed) {
      min_edge.record_too_many();
    } else {
      is_another_tried = min_edge.record_fit(faces);
      is_any_known = true;
    }
  }
  EXPECT_TRUE(min_edge.is_known_to_fit());
}

TEST(min_edge_search, keeps_the_highest_floor_if_none_serves) {
  const Found found = search(MinEdgeSearch(goals_with(kAllowed)), kAllowed, [](double) { return kAllowed + 1; });
  EXPECT_EQ(found.floor, 0x1p-4);
  EXPECT_EQ(found.attempts, 18);
}

TEST(min_edge_search, takes_larger_steps_where_attempts_are_long) {
  const std::uint64_t many = 1 << 20;
  const Found found = search(MinEdgeSearch(goals_with(many)), many,
                             [&](double floor) { return std::uint64_t{floor < 0x1p-12 ? 2 * many : many}; });
  EXPECT_EQ(found.floor, 0x1p-12);
  EXPECT_EQ(found.attempts, 6);
}

TEST(min_edge_search, passes_over_lengths_below_half_of_the_shortest_edge) {
  // No edge that is made is shorter than a 2^12th, so lower floors make the same result.
  const auto faces_of = [](double floor) { return std::uint64_t{floor <= 0x1p-12 ? 3 * kAllowed : kAllowed}; };
  MinEdgeSearch min_edge(goals_with(kAllowed));
  int attempts = 1;
  for (; faces_of(min_edge.min_edge_length()) > kAllowed; ++attempts) min_edge.record_too_many(0x1p-12);
  const Found all = search(MinEdgeSearch(goals_with(kAllowed)), kAllowed, faces_of);
  EXPECT_EQ(min_edge.min_edge_length(), all.floor);
  EXPECT_EQ(attempts, 5);  // without a floor, with the lowest one, a 2^13th, a 2^12th and a 2^11th
  EXPECT_GT(all.attempts, 8);
  // It also ends if edges are longer than any floor.
  min_edge.record_too_many(10);
  EXPECT_FALSE(min_edge.may_go_on());
}

TEST(min_edge_search, does_not_look_again_below_a_floor_that_was_found_before) {
  MinEdgeSearch before(goals_with(kAllowed));
  for (int i = 0; i < 10; ++i) before.record_too_many();
  const Found found = search(before.again(), kAllowed, [](double) { return 10u; });
  EXPECT_EQ(found.floor, before.min_edge_length());
  EXPECT_EQ(found.attempts, 1);
}

}  // namespace
}  // namespace remesh
