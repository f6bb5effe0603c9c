/// The memory that all requests together may take: reserved before it is used, so that what does not fit is refused at
/// the door and not by the system's killer in the middle of other people's work.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "server/http/http_message.h"

namespace remesh::server {

class MemoryBudget;

/// What one request holds of the budget; gives it back at its end. For one thread at a time.
class MemoryShare {
 public:
  /// `per_byte`: what is reserved for each byte of a body.
  explicit MemoryShare(MemoryBudget& budget, std::uint64_t per_byte) : budget_(budget), per_byte_(per_byte) {}
  ~MemoryShare() { resize(0); }
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

  /// Reserves what a body of `held` bytes will take, the work on it included, if there is also room for one of
  /// `expected` bytes now. That much is not reserved yet: a client that announces a lot and sends little shuts out
  /// nobody.
  /// Errors: HttpError 413 `mesh_too_large` - more than the whole budget; 503 `out_of_memory` - more than is free now.
  void hold_body(std::uint64_t held, std::uint64_t expected);
  /// Once the work is done, its answer alone is held.
  void hold_answer(std::uint64_t bytes) { resize(bytes); }

  std::uint64_t bytes() const { return bytes_; }

 private:
  void resize(std::uint64_t bytes);
  /// `bytes` are reserved already.
  void note(std::uint64_t bytes);

  MemoryBudget& budget_;
  const std::uint64_t per_byte_;
  std::uint64_t bytes_ = 0;
};

class MemoryBudget {
 public:
  /// Measured: reading and remeshing takes 11 times (a flat square of 320,000 faces) to 57 times (a patch a face) the
  /// bytes of the body. What is reserved is in between; what takes more is up to `MemoryWatch`.
  static constexpr std::uint64_t kWorkPerBodyByte = 16;

  explicit MemoryBudget(std::uint64_t limit) : limit_(limit) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::shared_ptr<MemoryShare> open_share(std::uint64_t per_byte = kWorkPerBodyByte) {
    return std::make_shared<MemoryShare>(*this, per_byte);
  }

  std::uint64_t limit() const { return limit_; }
  std::uint64_t reserved() const { return reserved_; }
  /// How many shares hold some of it.
  std::size_t holders() const { return holders_; }
  /// What could be reserved now.
  std::uint64_t available() const;
  /// What the process really takes, from time to time: where that is more than is reserved, it counts. Not where nobody
  /// has reserved anything: what the process takes idle would shut out for ever what `never_fits` lets through.
  void note_resident(std::uint64_t bytes) { resident_ = bytes; }

 private:
  friend class MemoryShare;

  /// Of the `reserved` bytes `own` ones are those of whoever asks.
  std::uint64_t used_by_others(std::uint64_t reserved, std::uint64_t own) const;

  const std::uint64_t limit_;
  std::atomic<std::uint64_t> reserved_{0};
  std::atomic<std::uint64_t> resident_{0};
  std::atomic<std::size_t> holders_{0};
};

}  // namespace remesh::server
