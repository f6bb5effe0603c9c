/// Runs the real binary in a process of its own.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace remesh::server {

/// A `remeshd` that listens on a free port. It is killed at the end of the test if it still runs.
class DaemonProcess {
 public:
  explicit DaemonProcess(std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {REMESHD_PATH, "--bind", "127.0.0.1:0", "--log-format", "json"});
    std::vector<char*> arguments;
    for (std::string& flag : flags) arguments.push_back(flag.data());
    arguments.push_back(nullptr);
    std::array<int, 2> pipe_ends{};
    if (::pipe(pipe_ends.data()) != 0) throw std::runtime_error("pipe");
    child_ = ::fork();
    if (child_ == 0) {
      ::setenv("REMESHD_STORE", "none", 0);  // the tests of jobs name one; the others share none
      ::dup2(pipe_ends[1], STDERR_FILENO);
      ::close(pipe_ends[0]);
      ::close(pipe_ends[1]);
      ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(pipe_ends[1]);
    log_ = ::fdopen(pipe_ends[0], "r");
    const std::string line = read_line(log_);
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object() || event.value("event", "") != "listening") throw std::runtime_error("no start: " + line);
    port_ = port_of(event.value("address", ""));
    ops_port_ = port_of(event.value("ops_address", ""));
    reader_ = std::thread([this] {
      for (std::string next = read_line(log_); !next.empty(); next = read_line(log_)) {
        const std::lock_guard lock(mutex_);
        lines_ += next;
      }
    });
  }
  ~DaemonProcess() {
    if (child_ > 0) ::kill(child_, SIGKILL);
    if (child_ > 0) ::waitpid(child_, nullptr, 0);
    if (reader_.joinable()) reader_.join();
    std::fclose(log_);
  }
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  int port() const { return port_; }
  int ops_port() const { return ops_port_; }
  pid_t pid() const { return child_; }

  /// Returns the value of a line of /proc/PID/status in bytes: "VmRSS" is the memory in use now, and "VmHWM" the peak
  /// since `forget_peak`.
  std::uint64_t memory(const std::string& what) const {
    std::ifstream status("/proc/" + std::to_string(child_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind(what + ":", 0) == 0) return std::stoull(line.substr(what.size() + 1)) * 1024;
    }
    return 0;
  }
  /// Returns the time that all threads of the daemon have spent on processors. Other programs do not lengthen it.
  std::chrono::duration<double> processor_time() const {
    if (child_ < 0) return spent_in_all_;
    clockid_t clock{};
    timespec spent{};
    if (::clock_getcpuclockid(child_, &clock) != 0 || ::clock_gettime(clock, &spent) != 0)
      throw std::runtime_error("no clock of the daemon");
    return std::chrono::seconds(spent.tv_sec) + std::chrono::nanoseconds(spent.tv_nsec);
  }
  void forget_peak() const { std::ofstream("/proc/" + std::to_string(child_) + "/clear_refs") << 5; }
  std::size_t descriptors() const {
    const std::filesystem::directory_iterator folder("/proc/" + std::to_string(child_) + "/fd");
    return static_cast<std::size_t>(std::distance(begin(folder), end(folder)));
  }
  void send_signal(int number) const { ::kill(child_, number); }
  /// Waits for the end. Returns the exit code, or the negated number of the signal that ended it.
  int wait() {
    int status = 0;
    rusage spent{};
    ::wait4(child_, &status, 0, &spent);
    child_ = -1;
    for (const timeval& part : {spent.ru_utime, spent.ru_stime})
      spent_in_all_ += std::chrono::seconds(part.tv_sec) + std::chrono::microseconds(part.tv_usec);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// Returns what the daemon has logged since its start. The log is complete once the daemon has ended.
  std::string log() {
    if (child_ < 0 && reader_.joinable()) reader_.join();
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  static int port_of(const std::string& address) {
    return address.empty() ? 0 : std::stoi(address.substr(address.rfind(':') + 1));
  }
  static std::string read_line(std::FILE* log) {
    std::array<char, 4096> buffer{};
    return std::fgets(buffer.data(), buffer.size(), log) == nullptr ? "" : buffer.data();
  }

  pid_t child_ = -1;
  std::chrono::duration<double> spent_in_all_{};
  std::FILE* log_ = nullptr;
  std::thread reader_;
  std::mutex mutex_;
  std::string lines_;
  int port_ = 0;
  int ops_port_ = 0;
};

}  // namespace remesh::server
