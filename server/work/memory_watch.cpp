#include "server/work/memory_watch.h"

#include <malloc.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "api/machine_limits.h"
#include "server/http/memory_files.h"
#include "server/observe/heap_tops.h"
#include "server/observe/log.h"

namespace remesh::server {
namespace {

/// How long the memory of an ended request may take to be freed before the next request is ended.
constexpr std::chrono::milliseconds kPatience{500};
/// Free memory that the allocator may retain.
constexpr std::uint64_t kSlack = 64 << 20;
/// While no request is computing, less free memory may be retained, but the check is made less often.
constexpr std::uint64_t kSmallSlack = 8 << 20;
constexpr std::chrono::seconds kBetweenSmallTrims{5};
/// Code, stacks and the system's data for the process are resident, too, but do not belong to the allocator.
constexpr std::uint64_t kBesides = 32 << 20;
/// Measuring walks through all free blocks, so it is not done at every check.
constexpr std::chrono::milliseconds kBetweenMeasurements{100};
/// Returning memory blocks all threads that allocate.
constexpr std::chrono::milliseconds kBetweenTrims{250};

/// Cancelled work takes about this long to stop. Meanwhile it takes memory as fast as before.
constexpr std::chrono::milliseconds kTimeToStop{100};
/// Memory that is freed and taken again within this time does not count as growth.
constexpr std::chrono::seconds kRemembered{1};
/// Threads check every second whether they are asked to return free memory.
constexpr std::chrono::milliseconds kTimeToReturn{1100};
constexpr std::chrono::seconds kBetweenAsks{2};

/// Beyond this share of the budget, the growth of work matters. Work that needs less is never ended because of its
/// growth.
constexpr std::uint64_t nearly_all(std::uint64_t limit) { return limit / 8 * 7; }

/// The share of the budget beyond which free memory is returned although requests are computing.
constexpr std::uint64_t high_share(std::uint64_t limit) { return limit / 10 * 8; }

/// The bytes that are allocated now, in all arenas and in blocks of their own.
std::uint64_t allocated_memory() {
  const struct mallinfo2 state = ::mallinfo2();
  return state.uordblks + state.hblkhd;
}

/// Returns the request to end: the one with the largest growth. Of requests with about the same growth, it is the one
/// that began last, because it loses the smallest part of its work.
std::shared_ptr<RunningRequest> to_end(const std::vector<std::shared_ptr<RunningRequest>>& computing) {
  std::uint64_t largest = 0;
  for (const auto& request : computing) largest = std::max(largest, request->growth.load());
  const std::uint64_t about_as_much = largest - largest / 8;
  std::shared_ptr<RunningRequest> last;
  for (const auto& request : computing) {
    if (request->growth >= about_as_much && (!last || request->start > last->start)) last = request;
  }
  return last;
}

}  // namespace

MemoryWatch::MemoryWatch(MemoryBudget& budget, RequestRegistry& registry, std::chrono::milliseconds period)
    : budget_(budget), registry_(registry), looks_(period, [this] { measure_and_look(); }) {}

void MemoryWatch::measure_and_look() {
  std::uint64_t resident = api::resident_memory();
  std::uint64_t used = used_of(resident);
  const bool is_idle = registry_.computing().empty();
  const Clock::time_point now = Clock::now();
  bool has_much_free = is_idle ? resident > resident_after_trim_ + kSlack : resident > used + kSlack;
  if (is_idle && now >= next_small_trim_) {
    // `resident_after_trim_` may be too high, because less memory may be in use now than after the last trim.
    has_much_free = has_much_free || resident > allocated_memory() + kBesides + kSmallSlack;
    next_small_trim_ = now + kBetweenSmallTrims;
  }
  // No request is ended because of memory that may be free.
  const bool may_be_free = used <= budget_.limit() && resident > budget_.limit();
  const bool is_due = has_much_free && (is_idle || resident > high_share(budget_.limit())) && now >= next_trim_;
  if (is_due || may_be_free) {
    ::malloc_trim(0);
    next_trim_ = now + kBetweenTrims;
    resident = api::resident_memory();
    // The rest of the free memory may be at the ends of the other threads' heaps.
    if (resident > allocated_memory() + kBesides + kSmallSlack && now >= asked_ + kBetweenAsks) {
      HeapTops::ask();
      asked_ = now;
    }
    if (is_idle) resident_after_trim_ = resident;  // while a request computes, this value means nothing for later
    next_measurement_ = {};
    used = used_of(resident);
  }
  // Free memory that cannot be returned, because small blocks in use lie between the free ones, counts as in use. But
  // threads that were asked to return their free memory have some time for this. Work may grow before it stops, so at
  // most half of the memory that the process may take beyond its budget counts as still to be returned.
  const auto taken = [&] {
    const bool may_come_back = now < asked_ + kTimeToReturn && resident <= budget_.limit() / 20 * 21;
    return resident > budget_.limit() && !may_come_back ? resident : used;
  };
  std::uint64_t growth = expected_growth(taken(), now);
  if (growth > 0 && taken() <= budget_.limit()) {
    // No request is ended because of memory that was in use some time ago.
    next_measurement_ = {};
    used = used_of(resident);
    lately_.back().used = taken();
    if (taken() <= nearly_all(budget_.limit())) growth = 0;
  }
  // Files in memory count, too. Their memory cannot be freed here.
  const std::uint64_t all = taken() + memory_file_bytes() + budget_.stored();
  look(all, all + growth);
}

std::uint64_t MemoryWatch::expected_growth(std::uint64_t used, Clock::time_point now) {
  while (!lately_.empty() && lately_.front().time < now - kRemembered) lately_.pop_front();
  std::uint64_t highest = 0;
  Clock::time_point last{};
  for (const Look& look : lately_) {
    if (look.time > now - kTimeToStop) break;
    highest = std::max(highest, look.used);
    last = look.time;
  }
  lately_.push_back({now, used});
  if (last == Clock::time_point{} || used <= nearly_all(budget_.limit()) || used <= highest) return 0;
  const std::chrono::duration<double> time = now - last, stop = kTimeToStop;
  return static_cast<std::uint64_t>(static_cast<double>(used - highest) * (stop / time));
}

std::uint64_t MemoryWatch::used_of(std::uint64_t resident) {
  if (resident < budget_.limit() / 4) return resident;
  if (Clock::now() >= next_measurement_) {
    const std::uint64_t allocated = allocated_memory() + kBesides;
    free_ = resident - std::min(resident, allocated);
    next_measurement_ = Clock::now() + kBetweenMeasurements;
  }
  return resident - std::min(resident, free_);
}

void MemoryWatch::look(std::uint64_t used, std::uint64_t soon) {
  budget_.record_used(used);
  const std::vector<std::shared_ptr<RunningRequest>> computing = registry_.computing();
  if (used > last_used_ && !computing.empty()) {
    // It is unknown which request has grown. But a request that is always present when memory grows soon stands out.
    const std::uint64_t share = (used - last_used_) / computing.size();
    for (const auto& request : computing) request->growth += share;
  }
  last_used_ = used;
  if (computing.empty() || soon <= budget_.limit() || Clock::now() <= patience_until_) return;
  const auto largest = to_end(computing);
  if (largest->eviction != RunningRequest::Eviction::kNone) return;  // it has not stopped yet
  // If the only reason is fast growth, the request to end must be the growing one.
  if (used <= budget_.limit() && largest->growth < soon - used) return;
  log::write(log::Level::kWarning, "over the memory budget, ending the largest request",
             {{"id", largest->id},
              {"used", static_cast<std::int64_t>(used)},
              {"expected", static_cast<std::int64_t>(soon)},
              {"budget", static_cast<std::int64_t>(budget_.limit())}});
  // Other holders of memory may be waiting, sending or buffered. Without them there may be room for this request. Files
  // that others have in memory may be gone by then, too.
  const std::uint64_t files = memory_file_bytes() + budget_.stored();
  const bool is_alone = computing.size() == 1 && budget_.holders() <= 1;
  largest->evict(/*was_alone=*/is_alone && soon > budget_.limit() + files);
  patience_until_ = Clock::now() + kPatience;
}

}  // namespace remesh::server
