/// Stores tasks and returns the most urgent one first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/ids.h"

namespace remesh {

/// The queues are numbered by urgency. The next task is from the highest queue that has any; within a queue, the first
/// in is the first out. Tasks that follow each other are stored together in blocks, because following a list of single
/// tasks would jump all over the memory. Each task is announced some time before it comes, so that its data can be
/// fetched meanwhile. Blocks are stored in chunks that never move: copying millions of tasks into larger memory would
/// take some tenths of a second, and could not be cancelled.
template <class Task>
class TaskQueues {
 public:
  /// Removes everything but keeps the memory. From now on a block has `block_size` tasks. If there are few tasks, most
  /// are alone in their queues, and small blocks are better.
  void clear(std::uint16_t block_size) {
    block_size_ = block_size;
    if (block_size > block_size_of_chunks_) {
      chunks_.clear();
      block_size_of_chunks_ = block_size;
    }
    last_of_.clear();
    blocks_.clear();
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

  /// Returns false if no task waits. Calls announce(task), usually with a task that will come soon; it may also be a
  /// task that was returned long ago.
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
  static constexpr std::size_t kMoreQueues = 32;  ///< most often, the next tasks are only a little more urgent
  /// A block has some tasks of one queue, in their order.
  struct Block {
    /// The next block in its queue. For the last block, this is the first one.
    std::uint32_t next;
    std::uint16_t begin, end;  ///< the tasks that wait
  };

  /// Chunk i has 2^i blocks: those whose number plus one has i + 1 binary digits.
  static int chunk_of(std::uint32_t block) { return std::bit_width(block + 1) - 1; }
  Task& task_of(std::uint32_t block, std::uint32_t index) {
    const int chunk = chunk_of(block);
    const std::size_t in_chunk = block + 1 - (std::uint32_t{1} << chunk);
    return chunks_[chunk][in_chunk * block_size_ + index];
  }

  /// Appends a new block to a queue, behind `last`. `last` then names the new block.
  void append_block(std::uint32_t& last) {
    std::uint32_t at = free_;
    if (at == kNone) {
      at = static_cast<std::uint32_t>(blocks_.size());
      blocks_.emplace_back();
      if (const auto chunk = static_cast<std::size_t>(chunk_of(at)); chunk == chunks_.size())
        chunks_.push_back(std::make_unique_for_overwrite<Task[]>((std::size_t{1} << chunk) * block_size_of_chunks_));
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
  std::uint16_t block_size_of_chunks_ = 1;  ///< the chunks have room for blocks of this size
  std::vector<std::uint32_t> last_of_;      ///< the last block of each queue, or kNone
  std::vector<Block> blocks_;
  std::vector<std::unique_ptr<Task[]>> chunks_;  ///< the tasks of all blocks
  std::uint32_t free_ = kNone;                   ///< the first unused block; they are linked by `next`
  std::size_t size_ = 0;
};

}  // namespace remesh
