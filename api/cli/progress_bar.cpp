#include "api/cli/progress_bar.h"

#include <unistd.h>

#include <chrono>
#include <iostream>
#include <string>

namespace remesh::cli {
namespace {

// "[############            ]  50 % triangulation"
std::string bar(const RunControl& control) {
  constexpr int kWidth = 24;
  const double fraction = control.fraction();
  const int filled = static_cast<int>(fraction * kWidth);
  const std::string percent = std::to_string(static_cast<int>(fraction * 100));
  return "[" + std::string(filled, '#') + std::string(kWidth - filled, ' ') + "] " +
         std::string(3 - percent.size(), ' ') + percent + " % " + std::string(stage_name(control.stage()));
}

}  // namespace

ProgressBar::ProgressBar(const RunControl& control) : control_(control) {
  if (::isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { show_until_done(); });
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
    std::cerr << kClearLine << bar(control_) << std::flush;
  }
  std::cerr << kClearLine << std::flush;
}

}  // namespace remesh::cli
