/// The requests that compute or wait to: found by their id, watched and cancelled by other requests.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "server/http/connection.h"

namespace remesh::server {

/// One request from its entry to its answer.
struct RunningRequest {
  explicit RunningRequest(std::string request_id, std::string its_owner = {})
      : id(std::move(request_id)), owner(std::move(its_owner)) {}

  /// Asks it to stop and wakes whoever waits for it.
  void cancel() {
    control.cancel();
    changed.set();
  }
  /// Ends it for the memory that it takes; `was_alone`: nobody else can be blamed.
  void evict(bool was_alone) {
    eviction = was_alone ? Eviction::kAlone : Eviction::kAmongOthers;
    cancel();
  }
  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  const std::string id;
  const std::string owner;  ///< of whose key; empty where there are no keys
  const Clock::time_point start = Clock::now();
  RunControl control;
  Event changed;  ///< the work has ended, or was cancelled
  std::atomic<bool> is_computing{false};
  std::atomic<bool> has_ended{false};

  enum class Eviction { kNone, kAmongOthers, kAlone };
  std::atomic<Eviction> eviction{Eviction::kNone};
  std::uint64_t growth = 0;  ///< of the process's memory, its share in it: see MemoryWatch, which alone uses it
};

/// `{"id": ..., "stage": ..., "fraction": ..., "elapsed_s": ...}`
std::string progress_json(const RunningRequest& request);

class RequestRegistry {
 public:
  /// Takes it out of the registry when its scope ends.
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

  /// Enters a request under that id, or under a new one when the id is running already.
  Entry add(const std::string& id, const std::string& owner = {});
  /// Output: nothing, too, where it is somebody else's, so that ids cannot be tried.
  std::shared_ptr<RunningRequest> find(const std::string& id, const std::string& owner = {}) const;
  std::vector<std::shared_ptr<RunningRequest>> computing() const;
  void cancel_all();

 private:
  void remove(RunningRequest& request);

  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<RunningRequest>, std::less<>> running_;
};

/// True for what a client may choose: 16 to 64 URL-safe characters.
bool is_request_id(std::string_view text);
/// 32 hexadecimal digits; never the same twice.
std::string new_request_id();

}  // namespace remesh::server
