#include "api/cli/progress_bar.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace remesh::cli {
namespace {

using std::chrono::milliseconds;
using testing::EndsWith;
using testing::StartsWith;

TEST(progress_bar, it_fills_from_the_left_and_never_changes_its_width) {
  EXPECT_EQ(progress_bar(0), "[                        ]   0 % ");
  EXPECT_EQ(progress_bar(0.5), "[############            ]  50 % ");
  EXPECT_EQ(progress_bar(0.999), "[####################### ]  99 % ");
  EXPECT_EQ(progress_bar(1), "[########################] 100 % ");
}

TEST(progress_bar, a_run_shows_its_stage_and_how_far_it_is) {
  RunControl control;
  control.enter(Stage::kRefinement);
  control.progress(0.25);
  // Refinement is the part from 0.15 to 0.45 of a usual run. When it has a quarter of its triangles, a sixteenth of its
  // time has passed.
  api::OverallProgress progress;
  EXPECT_EQ(progress_line(progress, control, 0.5), "[####                    ]  16 % refinement");
  EXPECT_EQ(progress_line(progress, control, 27), "[####                    ]  16 % refinement, about 133 s left");
}

/// Redirects standard error as long as it lives.
class StandardError {
 public:
  explicit StandardError(int fd) : kept_(::dup(STDERR_FILENO)) { ::dup2(fd, STDERR_FILENO); }
  ~StandardError() {
    ::dup2(kept_, STDERR_FILENO);
    ::close(kept_);
  }
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;

 private:
  const int kept_;
};

TEST(progress_bar, a_terminal_shows_the_newest_line_and_in_the_end_none) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal), 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  const int side = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY);
  ASSERT_GE(side, 0);
  std::atomic<int> asked{0};
  {
    const StandardError redirected(side);
    const ProgressBar bar([&] { return "line " + std::to_string(++asked); });
    for (int tries = 0; asked < 3 && tries < 6000; ++tries) std::this_thread::sleep_for(milliseconds(10));
  }
  ASSERT_GE(asked, 3);
  const int last = asked;
  ::close(side);
  std::string shown;
  char text[4096];
  for (ssize_t got; (got = ::read(terminal, text, sizeof text)) > 0;) shown.append(text, static_cast<std::size_t>(got));
  EXPECT_THAT(shown, StartsWith("\r\033[Kline 1\r\033[Kline 2\r\033[Kline 3"));
  EXPECT_THAT(shown, EndsWith("line " + std::to_string(last) + "\r\033[K"));
  std::this_thread::sleep_for(milliseconds(250));
  EXPECT_EQ(asked, last) << "it goes on after its end";
  ::close(terminal);
}

TEST(progress_bar, where_no_terminal_is_nothing_is_asked_or_shown) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::atomic<int> asked{0};
  {
    const StandardError redirected(ends[1]);
    const ProgressBar bar([&] {
      ++asked;
      return std::string("line");
    });
    std::this_thread::sleep_for(milliseconds(300));
  }
  ::close(ends[1]);
  char byte;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0);
  EXPECT_EQ(asked, 0);
  ::close(ends[0]);
}

}  // namespace
}  // namespace remesh::cli
