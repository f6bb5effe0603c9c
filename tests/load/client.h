/// A client that sends requests, measures the answers, and can misbehave.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace remesh::load {

using Clock = std::chrono::steady_clock;

/// The outcome of one request.
struct Outcome {
  int status = 0;  ///< 0 if there was no answer
  double ms = 0;   ///< from the connection to the answer's end
  std::size_t bytes = 0;
};

/// Sends the bytes and waits for the answer.
Outcome perform(int port, const std::string& bytes, std::string* answer = nullptr);
/// Sends the bytes and closes the connection without reading the answer.
void send_and_leave(int port, const std::string& bytes);

std::string get_text(const std::string& path);
std::string post_text(const std::string& target, const std::string& body);

/// Returns the value of a series in the text of GET /metrics, or 0 if it is not there.
double metric(const std::string& metrics, const std::string& series);
std::string fetch(int port, const std::string& path);

/// Collects times from several threads.
class Times {
 public:
  void add(double ms);
  std::size_t count() const;
  /// Returns the time that a part `share` of all times does not exceed, or 0 if there are no times.
  double quantile(double share) const;

 private:
  mutable std::mutex mutex_;
  std::vector<double> all_;
};

/// Measures how much of the processors other processes take meanwhile. If they take much, a measured time says little
/// about the daemon.
class Neighbours {
 public:
  /// Starts to measure. Neither this process nor the daemon, whose process id is given, counts as another.
  explicit Neighbours(int daemon);

  /// Returns the share of all processors that others have taken since the start.
  double share() const;
  /// Returns the part of share() that the host took from this machine, if it is a guest. While the host takes a
  /// processor, it stands still for tens of milliseconds.
  double stolen_share() const;
  /// Lowers the share of answers that must be in time by the share of time that the host took.
  double without_stolen(double share) const { return std::max(0.0, share - stolen_share()); }
  /// Returns whether the machine is quiet enough for times to be judged.
  bool are_quiet() const { return share() < 0.15; }

 private:
  double busy_s() const;
  double share_of(double seconds) const;

  const int daemon_;
  const Clock::time_point start_;
  const double busy_at_start_s_, stolen_at_start_s_;
};

/// Prints each claim with its figures, and remembers whether all of them held.
class Verdict {
 public:
  /// Input: `judges_times` - whether claims about time are judged, or only printed.
  explicit Verdict(bool judges_times) : judges_times_(judges_times) {}

  void expect(bool holds, const std::string& claim);
  /// Judges a claim about time, if this verdict judges any. If it does not hold while the neighbours take much of the
  /// machine, it is printed only.
  void expect_in_time(bool holds, const std::string& claim, const Neighbours& neighbours);
  int exit_code() const { return holds_ ? 0 : 1; }

 private:
  bool judges_times_;
  bool holds_ = true;
};

std::string with_unit(double value, const char* unit);

/// Runs `task` in `count` threads, each with its number. Returns when all have ended.
template <typename Task>
void in_parallel(std::size_t count, const Task& task) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back([&task, i] { task(i); });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace remesh::load
