/// A progress bar on standard error.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/run_control.h"

namespace remesh::cli {

/// Draws a bar: `[############            ]  50 % `
std::string progress_bar(double fraction);

/// Draws a bar for a run, followed by its current stage.
std::string progress_line(const RunControl& control);

/// Shows a line repeatedly during its lifetime, if standard error is a terminal. Otherwise it does nothing.
class ProgressBar {
 public:
  /// Input: `line` - makes the line; it is called on a thread of the bar's own.
  ///        `is_wanted` - false: nothing is shown.
  explicit ProgressBar(std::function<std::string()> line, bool is_wanted = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  void show_until_done();

  const std::function<std::string()> line_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_done_ = false;
  std::thread thread_;
};

}  // namespace remesh::cli
