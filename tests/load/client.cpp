#include "tests/load/client.h"

#include <algorithm>
#include <cstdio>

#include "tests/server/raw_client.h"

namespace remesh::load {

using server::RawClient;

Outcome perform(int port, const std::string& bytes, std::string* answer) {
  Outcome outcome;
  const Clock::time_point start = Clock::now();
  try {
    RawClient client(port);
    client.send(bytes);
    const std::string received = client.receive();
    outcome.status = server::Answer::parse(received).status;
    outcome.bytes = received.size();
    if (answer != nullptr) *answer = received;
  } catch (const std::exception&) {
    // refused: no answer
  }
  outcome.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return outcome;
}

void send_and_leave(int port, const std::string& bytes) {
  RawClient client(port);
  client.send(bytes);
}

std::string get_text(const std::string& path) { return "GET " + path + " HTTP/1.1\r\nHost: x\r\n\r\n"; }
std::string post_text(const std::string& target, const std::string& body) { return server::post_text(target, body); }

double metric(const std::string& metrics, const std::string& series) {
  const std::size_t at = metrics.find("\n" + series + " ");
  return at == std::string::npos ? 0 : std::stod(metrics.substr(at + series.size() + 2));
}

std::string fetch(int port, const std::string& path) { return server::get(port, path).body; }

void Times::add(double ms) {
  const std::lock_guard lock(mutex_);
  all_.push_back(ms);
}

std::size_t Times::count() const {
  const std::lock_guard lock(mutex_);
  return all_.size();
}

double Times::quantile(double share) const {
  const std::lock_guard lock(mutex_);
  if (all_.empty()) return 0;
  std::vector<double> sorted = all_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

Lateness::Lateness()
    : thread_([this] {
        constexpr std::chrono::milliseconds kNap{2};
        while (goes_on_) {
          const Clock::time_point due = Clock::now() + kNap;
          std::this_thread::sleep_until(due);
          times_.add(std::chrono::duration<double, std::milli>(Clock::now() - due).count());
        }
      }) {}

Lateness::~Lateness() {
  goes_on_ = false;
  thread_.join();
}

void Verdict::expect(bool holds, const std::string& claim) {
  std::printf("%s  %s\n", holds ? "holds " : "FAILED", claim.c_str());
  std::fflush(stdout);
  holds_ = holds_ && holds;
}

std::string with_unit(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f %s", value, unit);
  return text;
}

}  // namespace remesh::load
