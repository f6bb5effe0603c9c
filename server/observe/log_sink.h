/// The destination of the log's lines: standard error, which may be a pipe without a reader.
#pragma once

#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string_view>

namespace remesh::server::log {

/// Writes to a descriptor as long as it accepts bytes. While it accepts none, the log's thread waits here, and the
/// queue in front of it drops its oldest lines.
class LogSink : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit LogSink(int descriptor) : descriptor_(descriptor) {}

  /// From that time on, drops lines that cannot be written at once, because the process ends.
  void end_at(std::chrono::steady_clock::time_point time) { end_ = time; }
  /// The number of lines that were dropped here.
  std::uint64_t dropped() const { return dropped_; }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

 private:
  /// Output: false if the line could not be written to its end.
  bool write_all(std::string_view line);

  const int descriptor_;
  std::atomic<std::chrono::steady_clock::time_point> end_{std::chrono::steady_clock::time_point::max()};
  std::atomic<std::uint64_t> dropped_{0};
  bool is_cut_ = false;  ///< the last line was written in part
};

}  // namespace remesh::server::log
