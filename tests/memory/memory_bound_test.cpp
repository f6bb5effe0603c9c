#include "core/base/memory_bound.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/prefault_pages.h"
#include "core/base/run_control.h"

namespace remesh {
namespace {

/// A run on one face, whose stages may hold little.
struct SmallRun {
  SmallRun() {
    control.memory().set_input(1);
    control.enter(Stage::kWeld);
  }
  RunControl control;
};

template <class Work>
void expect_refused(const RunControl& control, const Work& work) {
  try {
    work();
    ADD_FAILURE() << "more memory than allowed was given";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kOutOfMemory);
    EXPECT_EQ(code_name(error.code), "out_of_memory");
    EXPECT_EQ(error.stage, Stage::kWeld);
    EXPECT_EQ(error.limit, control.memory().allowed());
  }
}

TEST(memory_bound, a_row_grows_with_both_numbers_of_faces) {
  constexpr StageMemory row{100, 10, 7};
  EXPECT_EQ(row.bytes(0, 0), 7u);
  EXPECT_EQ(row.bytes(3, 0), 307u);
  EXPECT_EQ(row.bytes(3, 2), 327u);
  EXPECT_EQ(row.bytes(3, MemoryBound::kNone), MemoryBound::kNone);
  EXPECT_EQ(row.bytes(MemoryBound::kNone, 0), MemoryBound::kNone);
}

TEST(memory_bound, every_stage_from_weld_to_quality_has_a_bound) {
  for (int s = 0; s < kStageCount; ++s) {
    const auto stage = static_cast<Stage>(s);
    RunControl control;
    control.memory().set_input(10);
    control.enter(stage);
    const bool has_bound = stage >= Stage::kWeld && stage <= Stage::kQuality;
    EXPECT_EQ(control.memory().allowed(), has_bound ? memory_of(stage).bytes(10, 0) : MemoryBound::kNone)
        << stage_name(stage);
    if (has_bound) {
      EXPECT_GT(memory_of(stage).per_input_face, 0u) << stage_name(stage);
    }
  }
}

TEST(memory_bound, without_an_input_there_is_no_bound) {
  RunControl control;
  control.enter(Stage::kWeld);
  EXPECT_EQ(control.memory().allowed(), MemoryBound::kNone);
  control.memory().ask_for<double>(std::size_t{1} << 50);
}

TEST(memory_bound, the_number_of_output_faces_counts_when_it_is_known) {
  SmallRun run;
  const std::uint64_t before = run.control.memory().allowed();
  run.control.memory().set_output(1'000'000);
  EXPECT_EQ(run.control.memory().allowed(), before + 1'000'000 * memory_of(Stage::kWeld).per_output_face);
  run.control.memory().set_output(MemoryBound::kNone);
  EXPECT_EQ(run.control.memory().allowed(), MemoryBound::kNone);
  run.control.memory().set_input(1);
  EXPECT_EQ(run.control.memory().allowed(), before);
}

TEST(memory_bound, what_is_allowed_is_given_and_one_item_more_is_refused) {
  SmallRun run;
  const std::size_t items = run.control.memory().allowed() / sizeof(double);
  run.control.memory().ask_for<double>(items);
  expect_refused(run.control, [&] { run.control.memory().ask_for<double>(items + 1); });
  // The number of bytes would not fit into 64 bits.
  expect_refused(run.control, [&] { run.control.memory().ask_for<double>(std::size_t{1} << 62); });
}

TEST(memory_bound, lists_ask_before_they_are_allocated) {
  SmallRun run;
  const std::size_t many = run.control.memory().allowed();
  std::vector<double> reserved;
  expect_refused(run.control, [&] { reserve_pages(reserved, many, run.control); });
  EXPECT_EQ(reserved.capacity(), 0u);
  expect_refused(run.control, [&] {
    select_ids<std::uint32_t>(many, kItemsPerBlock, run.control, [](std::size_t) { return true; });
  });
  const std::vector<std::vector<std::uint8_t>> blocks(4, std::vector<std::uint8_t>(many / 4));
  expect_refused(run.control, [&] { concatenate<double>(blocks, run.control); });
  EXPECT_EQ(concatenate<std::uint8_t>(blocks, run.control).size(), many / 4 * 4);
  expect_refused(run.control, [&] {
    group_by(
        many, 1, [](std::uint32_t) { return 0; }, run.control);
  });
  expect_refused(run.control, [&] {
    group_by(
        1, many, [](std::uint32_t) { return 0; }, run.control);
  });
}

}  // namespace
}  // namespace remesh
