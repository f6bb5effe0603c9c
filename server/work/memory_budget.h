/// The memory that all requests together may take. Memory is reserved before it is used, so that a request that does
/// not fit is refused at its start, and the system does not kill the process in the middle of other people's work.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "server/http/http_message.h"

namespace remesh::server {

class MemoryBudget;

/// The share of the budget that one request has reserved. It is returned when this object ends. Only one thread may
/// use it at a time.
class MemoryShare {
 public:
  /// Input: `per_byte` - the bytes that are reserved for each byte of a body.
  explicit MemoryShare(MemoryBudget& budget, std::uint64_t per_byte) : budget_(budget), per_byte_(per_byte) {}
  ~MemoryShare() { resize(0); }
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

  /// Reserves the memory for a body of which `held` bytes are buffered, including the work on it. It also checks that
  /// a body of `expected` bytes would fit now, but does not reserve that yet: a client that announces much and sends
  /// little must not shut out others. The work may take less than is estimated, so never more than the whole budget is
  /// reserved.
  /// Errors: HttpError 413 `mesh_too_large` - the bytes of the body alone are more than the whole budget; 503
  ///         `out_of_memory` - more than is free now.
  void hold_body(std::uint64_t held, std::uint64_t expected);
  /// Reserves exactly so many bytes, but not more than the whole budget.
  /// Output: false if they are not free now; the reservation then stays as it was.
  bool try_hold(std::uint64_t bytes);
  /// Reduces the reservation to the size of the answer, once the work is done.
  void hold_answer(std::uint64_t bytes) { resize(bytes); }

  std::uint64_t bytes() const { return bytes_; }
  /// See MemoryBudget::next_reservation.
  std::uint64_t next_reservation(std::uint64_t wanted) const;

 private:
  /// Reserves `wanted` bytes if `needed` bytes, of which they are a part, are free.
  bool try_reserve(std::uint64_t wanted, std::uint64_t needed);
  void resize(std::uint64_t bytes);
  /// Stores the new size. The budget's sum must include it already.
  void note(std::uint64_t bytes);

  MemoryBudget& budget_;
  const std::uint64_t per_byte_;
  std::uint64_t bytes_ = 0;
};

class MemoryBudget {
 public:
  /// Bytes that are reserved for each byte of a body. Reading and remeshing was measured to take 11 times the bytes
  /// of the body (a flat square of 320,000 faces) to 57 times (a patch per face). The reservation is in between;
  /// `MemoryWatch` handles requests that take more.
  static constexpr std::uint64_t kWorkPerBodyByte = 16;

  explicit MemoryBudget(std::uint64_t limit) : limit_(limit) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::shared_ptr<MemoryShare> open_share(std::uint64_t per_byte = kWorkPerBodyByte) {
    return std::make_shared<MemoryShare>(*this, per_byte);
  }

  std::uint64_t limit() const { return limit_; }
  std::uint64_t reserved() const { return reserved_; }
  /// The number of shares that have reserved memory.
  std::size_t holders() const { return holders_; }
  /// The largest reservation of a single piece of work that has not shown yet that it needs more. It leaves some for
  /// small requests, which would keep it waiting otherwise.
  std::uint64_t usual_limit() const { return limit_ / 8 * 7; }
  /// The memory to reserve before work is tried again that was ended because of its memory.
  /// Input: `wanted` - what it is expected to need; `reserved` - what was reserved for it before.
  std::uint64_t next_reservation(std::uint64_t wanted, std::uint64_t reserved) const {
    return reserved < usual_limit() ? std::min(wanted, usual_limit()) : limit_;
  }
  /// The number of bytes that could be reserved now.
  std::uint64_t available() const;
  /// Tells the budget how much memory is really in use. If that is more than is reserved, it counts instead.
  /// It does not count while nobody has reserved anything: otherwise an idle process could refuse for ever a request
  /// that `never_fits` lets through.
  void note_used(std::uint64_t bytes) { used_ = bytes; }

 private:
  friend class MemoryShare;

  /// The bytes that count as used by others.
  /// Input: `own` - the part of `reserved` that belongs to the caller.
  std::uint64_t used_by_others(std::uint64_t reserved, std::uint64_t own) const;

  const std::uint64_t limit_;
  std::atomic<std::uint64_t> reserved_{0};
  std::atomic<std::uint64_t> used_{0};
  std::atomic<std::size_t> holders_{0};
};

}  // namespace remesh::server
