/// Bounds the memory for the bytes of requests that all connections together have read ahead.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace remesh::server {

class ReadAhead {
 public:
  /// The limits for one connection and for all together, in bytes.
  static constexpr std::size_t kMaxOfOne = 16 << 20;
  static constexpr std::size_t kMaxOfAll = 64 << 20;

  /// The bytes that one connection has taken. They are given back when this object ends. Only one thread may use it at
  /// a time.
  class Share {
   public:
    /// Input: `all` - if it is null, nothing may be read ahead.
    explicit Share(ReadAhead* all) : all_(all) {}
    ~Share() { give_back(); }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    /// Takes this many bytes, or fewer if fewer are left.
    /// Output: the number taken.
    std::size_t take(std::size_t bytes) {
      if (all_ == nullptr) return 0;
      bytes = std::min(bytes, kMaxOfOne - held_);
      std::size_t held_by_all = all_->held_;
      std::size_t taken = 0;
      do {
        taken = std::min(bytes, kMaxOfAll - held_by_all);
      } while (taken > 0 && !all_->held_.compare_exchange_weak(held_by_all, held_by_all + taken));
      held_ += taken;
      return taken;
    }
    void give_back(std::size_t bytes) {
      if (bytes == 0) return;
      held_ -= bytes;
      all_->held_ -= bytes;
    }
    void give_back() { give_back(held_); }

   private:
    ReadAhead* const all_;
    std::size_t held_ = 0;
  };

 private:
  std::atomic<std::size_t> held_{0};
};

}  // namespace remesh::server
