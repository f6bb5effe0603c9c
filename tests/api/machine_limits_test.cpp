#include "api/machine_limits.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <new>
#include <vector>

#include "tests/support/sanitizer.h"

namespace remesh::api {
namespace {

constexpr std::uint64_t kMebibyte = 1 << 20;

/// Runs in a process of its own, because a limit stays once it is set.
[[noreturn]] void take_memory_within(std::uint64_t limit, std::uint64_t bytes) {
  if (!limit_own_memory(limit)) {
    std::cerr << "not limited\n";
    std::exit(0);
  }
  try {
    const std::vector<char> memory(bytes, 1);
    std::cerr << "taken: " << static_cast<int>(memory.back()) << "\n";
  } catch (const std::bad_alloc&) {
    std::cerr << "refused\n";
  }
  std::exit(0);
}

TEST(machine_limits, memory_beyond_the_own_limit_is_refused) {
  // Sanitizers have more than that reserved already.
  EXPECT_EXIT(take_memory_within(512 * kMebibyte, 64 * kMebibyte), testing::ExitedWithCode(0),
              kIsSanitized ? "not limited" : "taken");
  EXPECT_EXIT(take_memory_within(512 * kMebibyte, 1024 * kMebibyte), testing::ExitedWithCode(0),
              kIsSanitized ? "not limited" : "refused");
}

TEST(machine_limits, a_limit_below_what_is_in_use_is_no_limit) {
  EXPECT_EXIT(take_memory_within(1, kMebibyte), testing::ExitedWithCode(0), "not limited");
}

TEST(machine_limits, what_is_in_use_is_no_more_than_may_be_used) {
  EXPECT_GT(resident_memory(), kMebibyte);
  EXPECT_GE(usable_memory(), resident_memory());
}

}  // namespace
}  // namespace remesh::api
