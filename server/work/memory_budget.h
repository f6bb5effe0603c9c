/// The memory that all requests together may take. Memory is reserved before it is used. So a request that does not fit
/// waits or is refused at its start, and the system does not kill the process while it computes other requests.
///
/// A request that finds no memory may stand in line. Small reservations may pass larger ones there, so that memory is
/// not idle. Once the first request in line has waited for `kPatience`, it goes before all newcomers, and memory that
/// becomes free is set aside for it. These rules prevent that all requests wait in vain:
/// - Newcomers pass if enough is left for the first in line besides their own memory.
/// - A request that holds memory already may reserve more, since the first in line can wait for it to end.
/// - Newcomers pass while the first in line could not begin in any case, because requests that held memory before its
///   turn take too much.
/// - The turn of the first in line is limited. Then newcomers pass for `kPause`, and its next turn is longer.
/// - If all requests that hold memory stand in line for more, the last of them is refused.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include "server/http/connection.h"
#include "server/http/http_message.h"

namespace remesh::server {

class MemoryBudget;

/// The part of the budget that one request has reserved. It is returned when this object ends. Only one thread may use
/// this object at a time.
class MemoryShare {
 public:
  /// Input: `per_byte` - the bytes that are reserved for each byte of a body.
  explicit MemoryShare(MemoryBudget& budget, std::uint64_t per_byte) : budget_(budget), per_byte_(per_byte) {}
  ~MemoryShare();
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

  /// Reserves the memory for a body of which `held` bytes are buffered, including the work on it. It also checks that a
  /// body of `expected` bytes would fit now, but does not reserve memory for it yet: a client that announces a large
  /// body and sends little must not shut out others. The work may take less than is estimated, so never more than the
  /// whole budget is reserved.
  /// Output: false if not enough memory is free now; the reservation then stays as it was.
  /// Errors: HttpError 413 `mesh_too_large` - the bytes of the body alone are more than the whole budget.
  bool try_hold_body(std::uint64_t held, std::uint64_t expected, Clock::time_point now = Clock::now());
  /// Does the same as `try_hold_body`.
  /// Errors: also HttpError 503 `out_of_memory` - not enough memory is free now.
  void hold_body(std::uint64_t held, std::uint64_t expected) {
    if (!try_hold_body(held, expected)) throw out_of_memory();
  }
  /// Reserves exactly this many bytes, but at most the whole budget.
  /// Output: as `try_hold_body`.
  bool try_hold(std::uint64_t bytes, Clock::time_point now = Clock::now());
  /// Reduces the reservation to the size of the answer, once the work is done.
  void hold_answer(std::uint64_t bytes);

  /// Gives this share a place in line, unless it has one: behind the shares that have waited longer. It leaves the line
  /// with its next successful reservation, and when this object ends.
  void stand_in_line(Clock::time_point since = Clock::now());
  /// Does the same as a newcomer.
  /// Output: false if the line has its max length already.
  bool try_stand_in_line(Clock::time_point now = Clock::now());
  void leave_line();
  /// True if this share is to be refused, because all shares that hold memory, including this one, stand in line for
  /// more.
  bool is_stuck() const;

  std::uint64_t bytes() const { return bytes_; }
  MemoryBudget& budget() const { return budget_; }
  /// See MemoryBudget::next_reservation.
  std::uint64_t next_reservation(std::uint64_t wanted) const;

 private:
  friend class MemoryBudget;

  void stand_in_line_locked(Clock::time_point since);
  /// Reserves `wanted` bytes if `needed` bytes, which include them, are free.
  bool try_reserve(std::uint64_t wanted, std::uint64_t needed, Clock::time_point now);

  MemoryBudget& budget_;
  const std::uint64_t per_byte_;
  // The budget's mutex guards these members. Only the thread that uses this share changes `bytes_`.
  std::uint64_t bytes_ = 0;
  std::uint64_t needed_ = 0;  ///< the bytes that it last asked for
  std::uint64_t number_ = 0;  ///< the number of shares that began to hold memory before this one
  std::optional<Clock::time_point> waits_since_;
};

class MemoryBudget {
 public:
  /// Bytes that are reserved for each byte of a body. Reading and remeshing was measured to take 11 times the bytes
  /// of the body (a flat square of 320,000 faces) to 57 times (a patch per face). The reservation is in between;
  /// `MemoryWatch` handles requests that take more.
  static constexpr std::uint64_t kWorkPerBodyByte = 16;
  /// For this long, the first in line lets others pass.
  static constexpr std::chrono::seconds kPatience{5};
  /// How long it then goes first at a time: the first time, and the max.
  static constexpr std::chrono::seconds kFirstTurn{20};
  static constexpr std::chrono::seconds kLongestTurn{160};
  /// How long newcomers may pass between its turns.
  static constexpr std::chrono::seconds kPause{5};

  /// Input: `patience` - see kPatience; tests use less. `max_waiting` - the number of requests that may stand in line.
  explicit MemoryBudget(std::uint64_t limit, std::chrono::milliseconds patience = kPatience,
                        std::size_t max_waiting = std::numeric_limits<std::size_t>::max())
      : limit_(limit), patience_(patience), max_waiting_(max_waiting) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::shared_ptr<MemoryShare> open_share(std::uint64_t per_byte = kWorkPerBodyByte) {
    return std::make_shared<MemoryShare>(*this, per_byte);
  }

  std::uint64_t limit() const { return limit_; }
  std::chrono::milliseconds patience() const { return patience_; }
  std::uint64_t reserved() const;
  /// The number of shares that have reserved memory.
  std::size_t holders() const;
  /// The number of shares that stand in line.
  std::size_t waiting() const;
  /// The largest reservation of a single piece of work that has not yet been seen to need more. It leaves some memory
  /// for small requests, for which the work would otherwise have to wait.
  std::uint64_t usual_limit() const { return limit_ / 8 * 7; }
  /// The memory to reserve for another attempt at work that was ended because of its memory.
  /// Input: `wanted` - the memory that it is expected to need; `reserved` - the memory that was reserved for it before.
  std::uint64_t next_reservation(std::uint64_t wanted, std::uint64_t reserved) const {
    return reserved < usual_limit() ? std::min(wanted, usual_limit()) : limit_;
  }
  /// The number of bytes that a newcomer could reserve now. While the first in line goes first, its room does not
  /// count.
  std::uint64_t available(Clock::time_point now = Clock::now());
  /// Tells the budget how much memory is really in use. If that is more than is reserved, it counts instead.
  /// It does not count while there is no reservation: otherwise an idle process could for ever refuse a request that
  /// fits into the budget.
  void record_used(std::uint64_t bytes) { used_ = bytes; }

  /// Tells the budget how many bytes of files in memory are also in use, because the jobs' folder is in memory.
  void record_stored(std::uint64_t bytes) { stored_ = bytes; }
  std::uint64_t stored() const { return stored_; }

  /// Makes all shares in line give up, because the daemon stops.
  void close() { is_closed_ = true; }
  bool is_closed() const { return is_closed_; }

 private:
  friend class MemoryShare;

  /// The state of the first in line, once its patience is over.
  struct Turn {
    const MemoryShare* first;
    std::uint64_t newcomers;                         ///< the `number_` of the first holder after the turn began
    std::uint64_t old_bytes;                         ///< the bytes that earlier holders have reserved
    std::chrono::seconds length;                     ///< how long newcomers may be held up
    Clock::time_point pause_end;                     ///< until this time, newcomers pass
    std::optional<Clock::time_point> held_up_since;  ///< the time since which newcomers are held up
  };

  /// The bytes that count as used by other shares.
  /// Input: `own` - the part of the reservations that belongs to the caller.
  std::uint64_t used_by_others_locked(std::uint64_t own) const;
  bool is_held_up_locked(const MemoryShare* newcomer, std::uint64_t needed, Clock::time_point now);
  void begin_turn_locked(std::chrono::seconds length, Clock::time_point pause_end);
  void resize_locked(MemoryShare& share, std::uint64_t bytes);
  void leave_line_locked(MemoryShare& share);

  const std::uint64_t limit_;
  const std::chrono::milliseconds patience_;
  const std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::uint64_t reserved_ = 0;
  std::size_t holders_ = 0;
  std::uint64_t next_number_ = 1;
  std::list<MemoryShare*> line_;  ///< the share that has waited longest is the first
  std::optional<Turn> turn_;
  std::atomic<std::uint64_t> used_{0};
  std::atomic<std::uint64_t> stored_{0};
  std::atomic<bool> is_closed_{false};
};

}  // namespace remesh::server
