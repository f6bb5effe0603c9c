#include "server/http/key_limits.h"

#include <algorithm>
#include <cmath>

#include "server/http/http_message.h"

namespace remesh::server {
namespace {

constexpr double kMinute = 60;

}  // namespace

std::optional<AddressCounts::Place> KeyLimits::enter(const std::string& owner, Clock::time_point now) {
  std::optional<AddressCounts::Place> place;
  if (rules_.max_running > 0) {
    place = running_.enter(owner);
    if (!place) {
      throw HttpError(429, "rate_limited", "this API key has as many requests at once as one key may have")
          .with_limit(rules_.max_running);
    }
  }
  // A request that finds no place takes no permission.
  if (rules_.max_rate > 0) take_permission(owner, now);
  return place;
}

void KeyLimits::take_permission(const std::string& owner, Clock::time_point now) {
  const auto full = static_cast<double>(rules_.max_rate);
  const std::lock_guard lock(mutex_);
  Bucket& bucket = buckets_.try_emplace(owner, Bucket{full, now}).first->second;
  const double seconds = std::chrono::duration<double>(now - bucket.filled).count();
  bucket = {std::min(full, bucket.permissions + seconds * full / kMinute), now};
  if (bucket.permissions >= 1) {
    bucket.permissions -= 1;
    return;
  }
  const double wait = std::ceil((1 - bucket.permissions) * kMinute / full);
  throw HttpError(429, "rate_limited", "this API key has sent as many requests in a minute as one key may send")
      .with_limit(rules_.max_rate)
      .with_header("Retry-After", std::to_string(static_cast<int>(std::max(1.0, wait))));
}

}  // namespace remesh::server
