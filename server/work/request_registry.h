/// The requests that compute or wait for the pool. Other requests find them by their id in order to watch or cancel
/// them.
#pragma once

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/overall_progress.h"
#include "core/base/run_control.h"
#include "server/http/connection.h"

namespace remesh::server {

/// One request from its arrival in the registry to its answer.
struct RunningRequest {
  explicit RunningRequest(std::string request_id, std::string its_owner = {})
      : id(std::move(request_id)), owner(std::move(its_owner)) {}

  /// Asks the request to stop, and wakes the thread that waits for it.
  void cancel() {
    was_cancelled = true;
    stop_work();
  }
  /// Ends the request because of its memory.
  /// Input: `was_alone` - no other request can have taken the memory.
  void evict(bool was_alone) {
    Eviction none = Eviction::kNone;  // the first call counts, because others may have ended since then
    eviction.compare_exchange_strong(none, was_alone ? Eviction::kAlone : Eviction::kAmongOthers);
    stop_work();
  }
  void stop_work() {
    control.cancel();
    changed.set();
  }
  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  const std::string id;
  const std::string owner;  ///< identifies the API key; empty if the server has no keys
  const Clock::time_point start = Clock::now();
  RunControl control;
  api::OverallProgress overall;            ///< of the run, for all who ask
  Event changed;                           ///< set when the work has ended or was cancelled
  std::atomic<bool> was_cancelled{false};  ///< cancelled by a client or the daemon, not because of its memory
  std::atomic<bool> is_computing{false};
  std::atomic<bool> has_ended{false};

  enum class Eviction { kNone, kAmongOthers, kAlone };
  std::atomic<Eviction> eviction{Eviction::kNone};
  /// This request's estimated share in the growth of the process's memory; only MemoryWatch changes it.
  std::atomic<std::uint64_t> growth{0};

  /// The memory to reserve for another attempt at work that was ended because of its memory.
  /// Input: `reserved` - the memory that was reserved for it.
  std::uint64_t next_estimate(std::uint64_t reserved) const {
    // The work was still growing when it was ended, so each attempt must reserve more.
    return std::max(growth + growth / 4, reserved + reserved / 2);
  }
};

/// Formats the progress of a request: `{"id": ..., "stage": ..., "fraction": ..., "elapsed_s": ..., "left_s": ...}`.
/// The fraction is that of the whole run.
std::string progress_json(RunningRequest& request);

class RequestRegistry {
 public:
  /// A registered request. It leaves the registry when this object's scope ends.
  class Entry {
   public:
    Entry(RequestRegistry& registry, std::shared_ptr<RunningRequest> request)
        : registry_(registry), request_(std::move(request)) {}
    ~Entry() { registry_.remove(*request_); }
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

    const std::shared_ptr<RunningRequest>& get() const { return request_; }
    RunningRequest* operator->() const { return request_.get(); }

   private:
    RequestRegistry& registry_;
    std::shared_ptr<RunningRequest> request_;
  };

  /// Registers a request under that id, or under a new one if the same owner has a running request with that id. Ids of
  /// other owners make no difference, so that they cannot be probed.
  Entry add(const std::string& id, const std::string& owner = {});
  /// Output: nothing if there is no such request, or if it belongs to another owner, so that ids cannot be probed.
  std::shared_ptr<RunningRequest> find(const std::string& id, const std::string& owner = {}) const;
  std::vector<std::shared_ptr<RunningRequest>> computing() const;
  void cancel_all();

 private:
  void remove(RunningRequest& request);

  mutable std::mutex mutex_;
  /// The requests by their owner and id. The keys are views of the requests' own strings, so that a request can be
  /// removed even when memory has run out.
  using Key = std::pair<std::string_view, std::string_view>;
  std::map<Key, std::shared_ptr<RunningRequest>> running_;
};

/// True if a client may choose this text as an id: 16 to 64 URL-safe characters.
bool is_request_id(std::string_view text);
/// Makes a random id of 32 hexadecimal digits.
std::string new_request_id();

}  // namespace remesh::server
