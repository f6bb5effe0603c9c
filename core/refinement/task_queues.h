/// What waits to be done, the most urgent first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace remesh {

/// Queues numbered by urgency: first comes what waits in the highest, and of those what came in first. Tasks that
/// follow each other are kept together in blocks, since a queue of single ones would lead all over the memory; and each
/// is told of some time before it comes, so that what it is about can be fetched meanwhile.
template <class Task>
class TaskQueues {
 public:
  /// Leaves nothing but the memory. From now on a block has so many tasks: of few tasks, most are alone in their
  /// queues.
  void clear(std::uint16_t block_size) {
    block_size_ = block_size;
    last_of_.clear();
    blocks_.clear();
    tasks_.clear();
    free_ = kNone;
    size_ = 0;
  }

  std::size_t size() const { return size_; }

  void push(std::size_t queue, const Task& task) {
    if (queue >= last_of_.size()) {
      if (queue >= last_of_.capacity()) last_of_.reserve(queue + kMoreQueues);
      last_of_.resize(queue + 1, kNone);
    }
    std::uint32_t& last = last_of_[queue];
    if (last == kNone || blocks_[last].end == block_size_) append_block(last);
    task_of(last, blocks_[last].end++) = task;
    ++size_;
  }

  /// Output: false if nothing waits. `announce(task)`: of what comes soon, or came long ago.
  template <class Announce>
  bool pop(Task& task, const Announce& announce) {
    while (!last_of_.empty() && last_of_.back() == kNone) last_of_.pop_back();
    if (last_of_.empty()) return false;
    std::uint32_t& last = last_of_.back();
    const std::uint32_t first = blocks_[last].next;
    Block& block = blocks_[first];
    if (first != last) {
      announce(task_of(block.next, block.begin));
      if (block.begin == 0) fetch(blocks_[block.next].next);
    }
    task = task_of(first, block.begin++);
    --size_;
    if (block.begin == block.end) {
      if (first == last)
        last = kNone;
      else
        blocks_[last].next = block.next;
      block.next = std::exchange(free_, first);
    }
    return true;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::size_t kMoreQueues = 32;  ///< the next tasks are a little more urgent, most often
  /// Some tasks of one queue, one after the other.
  struct Block {
    std::uint32_t next;        ///< in its queue; of the last one, the first
    std::uint16_t begin, end;  ///< of those that wait
  };

  Task& task_of(std::uint32_t block, std::uint32_t index) { return tasks_[std::size_t{block} * block_size_ + index]; }

  /// A new block takes the place of the last one, behind it.
  void append_block(std::uint32_t& last) {
    std::uint32_t at = free_;
    if (at == kNone) {
      at = static_cast<std::uint32_t>(blocks_.size());
      blocks_.emplace_back();
      tasks_.resize(tasks_.size() + block_size_);
    } else {
      free_ = blocks_[at].next;
    }
    blocks_[at] = {last == kNone ? at : std::exchange(blocks_[last].next, at), 0, 0};
    last = at;
  }

  void fetch(std::uint32_t block) {
    constexpr std::size_t kCacheLine = 64;
    const auto* const bytes = reinterpret_cast<const std::byte*>(&task_of(block, 0));
    for (std::size_t i = 0; i < block_size_ * sizeof(Task); i += kCacheLine) __builtin_prefetch(bytes + i);
    __builtin_prefetch(&blocks_[block]);
  }

  std::uint16_t block_size_ = 1;
  std::vector<std::uint32_t> last_of_;  ///< the last block of each queue, or kNone
  std::vector<Block> blocks_;
  std::vector<Task> tasks_;     ///< of all blocks
  std::uint32_t free_ = kNone;  ///< the first of the blocks that are free again, linked
  std::size_t size_ = 0;
};

}  // namespace remesh
