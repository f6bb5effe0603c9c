#include "api/cli/progress_bar.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>
#include <utility>

namespace remesh::cli {

std::string progress_bar(double fraction) {
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(fraction * kWidth);
  const std::string percent = std::to_string(static_cast<int>(fraction * 100));
  return "[" + std::string(filled, '#') + std::string(kWidth - filled, ' ') + "] " +
         std::string(3 - percent.size(), ' ') + percent + " % ";
}

std::string progress_line(api::OverallProgress& progress, const RunControl& control, double elapsed_s) {
  const double overall = progress.look(control);
  const std::optional<double> left = api::seconds_left(overall, elapsed_s);
  return progress_bar(overall) + std::string(stage_name(control.stage())) +
         (left ? ", about " + std::to_string(std::llround(*left)) + " s left" : "");
}

ProgressBar::ProgressBar(std::function<std::string()> line, bool is_wanted) : line_(std::move(line)) {
  if (is_wanted && ::isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { show_until_done(); });
}

ProgressBar::~ProgressBar() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_done_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void ProgressBar::show_until_done() {
  constexpr auto kInterval = std::chrono::milliseconds(100);
  constexpr const char* kClearLine = "\r\033[K";
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kInterval, [this] { return is_done_; })) {
    std::cerr << kClearLine << line_() << std::flush;
  }
  std::cerr << kClearLine << std::flush;
}

}  // namespace remesh::cli
