#include "core/refinement/segments/segment_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/refinement/goals/face_budget.h"
#include "core/refinement/sizes/gap_search.h"
#include "tests/support/hostile_families.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

Goals fit_into_gaps() {
  Options options;
  options.proximity = 1;
  return goals_of(options, 1);
}

/// The segments of sheets that are stacked. Gaps ask for many cuts of each.
struct Stack {
  Stack()
      : chain(hostile::family("straight_stack").make(20)),
        goals(fit_into_gaps()),
        gaps(chain.surface, chain.adjacency, chain.patches, 1e-6, chain.control, &chain.triangulated),
        sizes(chain.surface, &gaps, {}, goals, 1e-6, chain.control),
        frozen(chain.meshes.size()),
        segments(chain.surface, chain.triangulated, frozen, sizes, goals, chain.control) {
    segments.plan_cuts(chain.triangulated, sizes, goals, chain.control);
  }

  SegmentCuts begun(std::uint64_t max_triangles, std::uint64_t max_made) const {
    SegmentCuts cuts(segments, chain.control);
    cuts.begin(sizes, max_triangles, max_made);
    return cuts;
  }
  std::uint64_t count_for_sides() const {
    const SegmentCuts all = begun(kNoFaceLimit, kNoFaceLimit);
    std::uint64_t count = 0;
    for (const SegmentSide& side : segments.all_sides()) count += all[side.segment].size();
    return count;
  }

  StageChain chain;
  Goals goals;
  GapSearch gaps;
  SizeField sizes;
  IdVector<PatchId, std::uint8_t> frozen;
  SegmentTable segments;
};

std::uint64_t stored(const SegmentCuts& cuts) {
  std::uint64_t count = 0;
  for (const std::vector<double>& of_segment : cuts.all()) count += of_segment.size();
  return count;
}

std::uint64_t told(const SegmentCuts& cuts) {
  std::uint64_t count = 0;
  for (const SegmentCuts::Message& message : cuts.messages()) count += message.count;
  return count;
}

TEST(segment_cuts, a_limit_that_is_not_reached_changes_nothing) {
  const Stack stack;
  const std::uint64_t count = stack.count_for_sides();
  ASSERT_GT(count, 1000u);
  const SegmentCuts all = stack.begun(kNoFaceLimit, kNoFaceLimit);
  EXPECT_EQ(stack.begun(count, kNoFaceLimit).all().items(), all.all().items());
  EXPECT_EQ(stack.begun(kNoFaceLimit, count).all().items(), all.all().items());
  EXPECT_EQ(told(all), count);
}

TEST(segment_cuts, each_segment_keeps_its_share_if_there_are_too_many) {
  const Stack stack;
  const std::uint64_t count = stack.count_for_sides();
  const SegmentCuts all = stack.begun(kNoFaceLimit, kNoFaceLimit);
  for (const std::uint64_t max : {count - 1, count / 3, count / 20, std::uint64_t{7}, std::uint64_t{0}}) {
    const SegmentCuts some = stack.begun(max, kNoFaceLimit);
    EXPECT_LE(told(some), max / 2);
    for (SegmentId s(0); s.value < stack.segments.size(); ++s.value) {
      const std::vector<double>& before = all[s];
      const std::vector<double>& left = some[s];
      EXPECT_TRUE(std::includes(before.begin(), before.end(), left.begin(), left.end()));
      const double share = static_cast<double>(max) / 2 / static_cast<double>(count);
      EXPECT_NEAR(static_cast<double>(left.size() + 1), share * static_cast<double>(before.size() + 1), 1.0001);
    }
  }
}

TEST(segment_cuts, an_attempt_that_cannot_succeed_stores_no_more_cuts_than_it_may_make) {
  const Stack stack;
  const std::uint64_t count = stack.count_for_sides();
  for (const std::uint64_t max : {count - 1, count / 3, std::uint64_t{7}}) {
    const SegmentCuts some = stack.begun(kNoFaceLimit, max);
    EXPECT_LE(stored(some), max);
    // The attempt ends because more are told than it may make. Of each segment, no more are told than that takes.
    EXPECT_GT(told(some), max);
    EXPECT_LE(told(some), count);
    for (const SegmentCuts::Message& message : some.messages()) EXPECT_LE(message.count, max + 1);
  }
}

}  // namespace
}  // namespace remesh
