/// Child processes, each with one piece of work, its memory bounded and its life as well.
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

/// What became of a child.
struct ChildEnd {
  std::uint64_t number = 0;    ///< of its work
  std::string message;         ///< all that it sent
  std::string standard_error;  ///< the end of it
  int signal = 0;              ///< which ended it; 0: none
  bool was_killed = false;     ///< for it lived too long
  double max_mb = 0;           ///< of memory that it held at one time
};

/// Sends text to the parent.
using Send = std::function<void(const std::string&)>;

class ChildPool {
 public:
  /// Input: `max_mb` of addresses a child may take, 0: no bound; the longest life of a child.
  ChildPool(std::size_t max_children, std::size_t max_mb, double max_life_s);
  ~ChildPool();
  ChildPool(const ChildPool&) = delete;
  ChildPool& operator=(const ChildPool&) = delete;

  bool is_full() const { return children_.size() >= max_children_; }
  bool is_empty() const { return children_.empty(); }
  /// Forks: the process may have no thread but this one.
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
