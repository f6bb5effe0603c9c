/// Limits of what one API key may ask for, so that the clients of one key cannot take the daemon from all others.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/http/address_counts.h"

namespace remesh::server {

struct KeyRules {
  std::uint64_t max_running = 0;  ///< requests with work that are served at once; 0: no limit
  std::uint64_t max_rate = 0;     ///< requests with work a minute; 0: no limit
};

class KeyLimits {
 public:
  using Clock = std::chrono::steady_clock;

  explicit KeyLimits(const KeyRules& rules) : rules_(rules), running_(rules.max_running) {}

  /// Counts a request with work, until the place ends.
  /// Output: nothing if there is no limit on requests at once.
  /// Errors: HttpError 429 - the owner of the key has reached a limit. `Retry-After` says when another request is
  ///         admitted.
  std::optional<AddressCounts::Place> enter(const std::string& owner, Clock::time_point now);

 private:
  /// A bucket of permissions for requests. It is full at first, and fills up again within a minute. A request takes
  /// one permission.
  struct Bucket {
    double permissions = 0;
    Clock::time_point filled;
  };
  void take_permission(const std::string& owner, Clock::time_point now);

  const KeyRules rules_;
  AddressCounts running_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace remesh::server
