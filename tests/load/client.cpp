#include "tests/load/client.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/server/raw_client.h"

namespace remesh::load {

using server::RawClient;

Outcome perform(int port, const std::string& bytes, std::string* answer) {
  Outcome outcome;
  const Clock::time_point start = Clock::now();
  try {
    RawClient client(port);
    client.send(bytes);
    const std::string received = client.receive_answer();
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

std::string get_text(const std::string& path) { return "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n"; }
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

namespace {

/// Seconds that were spent, summed over all processors.
struct Spent {
  double busy;    ///< on any work, stolen time included
  double stolen;  ///< the part of `busy` that the host took from this machine, which is its guest
};

Spent machine_spent() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft = 0, stolen = 0;
  file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft >> stolen;
  const auto ticks = static_cast<double>(::sysconf(_SC_CLK_TCK));
  return {(user + nice + system + interrupts + soft + stolen) / ticks, stolen / ticks};
}

/// Returns the seconds of processor time that a process has taken.
double process_busy_s(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  text.erase(0, text.rfind(')') + 1);  // the name may hold anything
  std::istringstream fields(text);
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

Neighbours::Neighbours(int daemon)
    : daemon_(daemon), start_(Clock::now()), busy_at_start_s_(busy_s()), stolen_at_start_s_(machine_spent().stolen) {}

double Neighbours::busy_s() const {
  return machine_spent().busy - process_busy_s(daemon_) - process_busy_s(static_cast<int>(::getpid()));
}

double Neighbours::share_of(double seconds) const {
  const double since = std::chrono::duration<double>(Clock::now() - start_).count();
  return seconds / since / std::thread::hardware_concurrency();
}
double Neighbours::share() const { return share_of(busy_s() - busy_at_start_s_); }
double Neighbours::stolen_share() const { return share_of(machine_spent().stolen - stolen_at_start_s_); }

void Verdict::expect_in_time(bool holds, const std::string& claim, const Neighbours& neighbours) {
  if (holds || (judges_times_ && neighbours.are_quiet())) return expect(holds, claim);
  std::printf("told    %s (others take %.0f %% of the machine, its host %.1f %%)\n", claim.c_str(),
              100 * neighbours.share(), 100 * neighbours.stolen_share());
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
