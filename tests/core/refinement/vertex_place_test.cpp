#include "core/refinement/segments/vertex_place.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/refinement/refiner/working_patch.h"

namespace remesh {
namespace {

TEST(vertex_place, it_gives_back_what_it_was_made_of) {
  const VertexPlace corner = VertexPlace::original({0.5, true}), inside = VertexPlace::free({0, false}),
                    cut = VertexPlace::on_segment(SegmentId(7), 0.25);
  EXPECT_TRUE(corner.is_original());
  EXPECT_FALSE(corner.is_free());
  EXPECT_EQ(corner.spacing().length, 0.5);
  EXPECT_TRUE(corner.spacing().is_asked);
  EXPECT_TRUE(inside.is_free());
  EXPECT_EQ(inside.spacing().length, 0);
  EXPECT_FALSE(inside.spacing().is_asked);
  EXPECT_TRUE(cut.is_on_segment());
  EXPECT_EQ(cut.segment(), SegmentId(7));
  EXPECT_EQ(cut.parameter(), 0.25);
}

TEST(min_spacing, what_features_ask_for_counts_unless_an_edge_must_be_longer) {
  EXPECT_EQ(MinSpacing::above(0, 0.5).length, 0.5);
  EXPECT_FALSE(MinSpacing::above(0, 0.5).is_asked);
  EXPECT_FALSE(MinSpacing::above(0, 0).is_asked) << "a shortest edge of 0 has no effect";
  EXPECT_EQ(MinSpacing::above(0.7, 0.5).length, 0.7);
  EXPECT_TRUE(MinSpacing::above(0.7, 0.5).is_asked);
  EXPECT_FALSE(std::min(MinSpacing{0.5, false}, MinSpacing{0.5, true}).is_asked) << "the first one of equal ones";
}

TEST(triangle_state, it_is_good_or_waits_or_has_a_reason) {
  EXPECT_TRUE(TriangleState::good().is_good());
  EXPECT_FALSE(TriangleState::good().is_waiting());
  EXPECT_TRUE(TriangleState::waiting().is_waiting());
  for (int i = 0; i < kUnrefinedReasonCount; ++i) {
    const auto why = static_cast<UnrefinedReason>(i);
    const TriangleState state(why);
    EXPECT_FALSE(state.is_good());
    EXPECT_FALSE(state.is_waiting());
    EXPECT_EQ(state.reason(), why);
  }
}

}  // namespace
}  // namespace remesh
