/// A progress bar on standard error.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/base/run_control.h"

namespace remesh::cli {

/// Shows stage and fraction of a run for as long as it lives, if standard error is a terminal; else does nothing.
class ProgressBar {
 public:
  explicit ProgressBar(const RunControl& control);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  void show_until_done();

  const RunControl& control_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_done_ = false;
  std::thread thread_;
};

}  // namespace remesh::cli
