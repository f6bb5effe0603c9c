// Tries each stage of the table (tests/support/invariance.h) with each transform that must not change its results.

#include "tests/support/invariance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/errors.h"

namespace remesh::test {
namespace {

constexpr const char* name_of(Transform transform) {
  switch (transform) {
    case Transform::kWorkers: return "workers";
    case Transform::kScale: return "scale";
    case Transform::kExtremeScale: return "extreme_scale";
    case Transform::kNumbering: return "numbering";
    case Transform::kStop: return "stop";
  }
  return "";
}

void run(const TestedStage& stage, Trial& trial) {
  const tbb::global_control eight(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena(trial.workers).execute([&] { stage.run(trial); });
}

/// The difference of a trial from the first one.
struct Change {
  int workers = 1;
  int exponent = 0;
  unsigned seed = 0;
};

std::vector<Change> changes(Transform transform) {
  switch (transform) {
    case Transform::kWorkers: return {{2}, {8}, {2}};
    case Transform::kScale: return {{1, -40}, {1, -1}, {1, 20}};
    case Transform::kExtremeScale: return {{1, -300}, {1, 300}};
    case Transform::kNumbering: return {{1, 0, 1}, {1, 0, 2}, {1, 0, 3}, {1, 0, 4}};
    case Transform::kStop: return {};
  }
  return {};
}

/// The number of a stage in the table, and a transform.
class invariance : public testing::TestWithParam<std::pair<std::size_t, Transform>> {};

TEST_P(invariance, holds) {
  const TestedStage& stage = stages()[GetParam().first];
  const Transform transform = GetParam().second;
  Trial first;
  if (transform == Transform::kStop) {
    first.control.cancel();
    EXPECT_EQ(error_of([&] { run(stage, first); }).code, Code::kCancelled);
    return;
  }
  run(stage, first);
  ASSERT_GT(first.told(transform).size(), 10u) << "the stage tells nothing";
  for (const Change& change : changes(transform)) {
    Trial other;
    other.workers = change.workers;
    other.scale = std::ldexp(1.0, change.exponent);
    other.seed = change.seed;
    run(stage, other);
    // The texts are too long to be printed.
    EXPECT_TRUE(other.told(transform) == first.told(transform))
        << other.workers << " workers, times " << other.scale << ", order " << other.seed;
  }
}

std::vector<std::pair<std::size_t, Transform>> all() {
  std::vector<std::pair<std::size_t, Transform>> pairs;
  for (std::size_t i = 0; i < stages().size(); ++i)
    for (const Transform transform : stages()[i].transforms) pairs.emplace_back(i, transform);
  return pairs;
}

INSTANTIATE_TEST_SUITE_P(, invariance, testing::ValuesIn(all()), [](const auto& info) {
  return stages()[info.param.first].name + "_" + name_of(info.param.second);
});

}  // namespace
}  // namespace remesh::test
