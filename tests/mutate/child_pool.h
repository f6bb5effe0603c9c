/// Runs pieces of work in child processes, whose memory and lifetime are bounded.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace remesh::mutate {

/// The end of a child.
struct ChildEnd {
  std::uint64_t number = 0;    ///< the number of its work
  std::string message;         ///< everything that it sent
  std::string standard_error;  ///< the last part of it
  int signal = 0;              ///< the signal that ended it; 0 if none did
  bool was_killed = false;     ///< it was ended because it lived too long
  double max_mb = 0;           ///< largest memory that it had in use at one time
};

/// A function that sends text to the parent.
using Send = std::function<void(const std::string&)>;

class ChildPool {
 public:
  /// Input: `max_mb` - the address space that a child may use, 0 for no bound; `max_life_s` - the longest life of a
  ///        child.
  ChildPool(std::size_t max_children, std::size_t max_mb, double max_life_s);
  ~ChildPool();
  ChildPool(const ChildPool&) = delete;
  ChildPool& operator=(const ChildPool&) = delete;

  bool is_full() const { return children_.size() >= max_children_; }
  bool is_empty() const { return children_.empty(); }
  /// Starts a child by fork. The process must not have any other thread.
  void start(std::uint64_t number, const std::function<void(const Send&)>& work);
  /// Waits until a child has ended.
  ChildEnd wait();

 private:
  struct Child {
    std::uint64_t number;
    pid_t pid;
    int pipe, error_file;
    std::chrono::steady_clock::time_point start;
    std::string message;
    bool was_killed = false;
  };
  ChildEnd end_of(Child& child);

  std::size_t max_children_, max_mb_;
  double max_life_s_;
  std::vector<Child> children_;
};

}  // namespace remesh::mutate
