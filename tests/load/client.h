/// A client that asks, measures, and can misbehave.
#pragma once

#include <atomic>
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

/// Sends the bytes, and takes what comes to the end of the connection.
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

/// How late a sleeping thread wakes up here and now: what other work on the machine adds to every measured time.
class Lateness {
 public:
  Lateness();
  ~Lateness();
  Lateness(const Lateness&) = delete;
  Lateness& operator=(const Lateness&) = delete;

  /// The worst of a hundred wakings so far.
  double ms() const { return times_.quantile(0.99); }

 private:
  Times times_;
  std::atomic<bool> goes_on_{true};
  std::thread thread_;
};

/// Prints the claim with its figures, and remembers whether all held.
class Verdict {
 public:
  void expect(bool holds, const std::string& claim);
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
