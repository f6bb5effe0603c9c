/// A progress bar on standard error.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "api/overall_progress.h"
#include "core/base/run_control.h"

namespace remesh::cli {

/// Draws a bar: `[############            ]  50 % `
std::string progress_bar(double fraction);

/// Draws a bar for the whole of a run, followed by its current stage and, once it can be told, the time that is left.
std::string progress_line(api::OverallProgress& progress, const RunControl& control, double elapsed_s);

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
