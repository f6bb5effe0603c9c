/// A client that asks, measures, and can misbehave.
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

/// What became of one request.
struct Outcome {
  int status = 0;  ///< 0: no answer
  double ms = 0;   ///< from the connection to the answer's end
  std::size_t bytes = 0;
};

/// Sends the bytes, and takes the answer.
Outcome perform(int port, const std::string& bytes, std::string* answer = nullptr);
/// Sends the bytes and leaves without a look at the answer.
void send_and_leave(int port, const std::string& bytes);

std::string get_text(const std::string& path);
std::string post_text(const std::string& target, const std::string& body);

/// A value of GET /metrics; 0 where the series is not there.
double metric(const std::string& metrics, const std::string& series);
std::string fetch(int port, const std::string& path);

/// Collects times from several threads.
class Times {
 public:
  void add(double ms);
  std::size_t count() const;
  /// The value that a part `share` of them does not pass; 0 of none.
  double quantile(double share) const;

 private:
  mutable std::mutex mutex_;
  std::vector<double> all_;
};

/// How much of the processors others take meanwhile: what is measured says little about the daemon when they take much.
class Neighbours {
 public:
  /// Others than this process and that one.
  explicit Neighbours(int daemon);

  /// Of all processors, since the start.
  double share() const;
  /// Of that, what the host takes of a machine that is its guest. It stands still for tens of milliseconds then.
  double stolen_share() const;
  /// Of so large a share of answers in time, what is left without those that the host held up.
  double without_stolen(double share) const { return std::max(0.0, share - stolen_share()); }
  /// Whether times can be judged.
  bool are_quiet() const { return share() < 0.15; }

 private:
  double busy_s() const;
  double share_of(double seconds) const;

  const int daemon_;
  const Clock::time_point start_;
  const double busy_at_start_s_, stolen_at_start_s_;
};

/// Prints the claims with their figures, and remembers whether all held.
class Verdict {
 public:
  void expect(bool holds, const std::string& claim);
  /// Of a claim about time: judged where the neighbours let it, else only told.
  void expect_in_time(bool holds, const std::string& claim, const Neighbours& neighbours);
  int exit_code() const { return holds_ ? 0 : 1; }

 private:
  bool holds_ = true;
};

std::string with_unit(double value, const char* unit);

/// `count` threads that do the same; returns when all have.
template <typename Task>
void in_parallel(std::size_t count, const Task& task) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) threads.emplace_back([&task, i] { task(i); });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace remesh::load
