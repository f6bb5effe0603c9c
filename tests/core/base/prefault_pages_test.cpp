#include "core/base/prefault_pages.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace remesh {
namespace {

TEST(pages, those_within_the_memory_are_there_and_no_others) {
#ifndef MADV_POPULATE_WRITE
  GTEST_SKIP() << "the system does not know how";
#else
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  constexpr std::size_t kPages = 512, kTaken = 256;
  void* const mapped = ::mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(mapped, MAP_FAILED);
  (void)::madvise(mapped, kPages * page, MADV_NOHUGEPAGE);
  if (::madvise(mapped, page, MADV_POPULATE_WRITE) != 0) GTEST_SKIP() << "the kernel does not know how";
  // The range is from the middle of page 8 to the middle of page 264.
  prefault_pages(static_cast<std::byte*>(mapped) + 8 * page + page / 2, kTaken * page);
  std::vector<unsigned char> is_there(kPages);
  ASSERT_EQ(::mincore(mapped, kPages * page, is_there.data()), 0);
  for (std::size_t i = 1; i < kPages; ++i) EXPECT_EQ(is_there[i] & 1, i > 8 && i < 8 + kTaken ? 1 : 0) << i;
  ::munmap(mapped, kPages * page);
#endif
}

TEST(pages, what_is_written_stays) {
  std::vector<int> items(1'000'000, 7);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{100'000}, items.size()})
    prefault_pages(std::span(items).first(size));
  EXPECT_EQ(std::count(items.begin(), items.end(), 7), 1'000'000);
}

TEST(pages, reserved_memory_has_room_for_all_and_holds_none) {
  RunControl control;
  for (const std::size_t n : {std::size_t{0}, std::size_t{3}, std::size_t{1'000'000}}) {
    std::vector<double> items;
    reserve_pages(items, n, control);
    EXPECT_GE(items.capacity(), n);
    EXPECT_TRUE(items.empty());
    items.resize(n);
    EXPECT_EQ(std::count(items.begin(), items.end(), 0.0), static_cast<std::ptrdiff_t>(n));
  }
}

}  // namespace
}  // namespace remesh
