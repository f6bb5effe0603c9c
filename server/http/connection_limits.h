/// The limits on the connections of a listener.
#pragma once

#include <chrono>
#include <cstddef>

#include "server/http/gate.h"

namespace remesh::server {

struct ConnectionLimits {
  GateLimits gate;
  std::size_t max_connections = 512;
  std::size_t max_connections_per_address = 64;
  /// How long an idle connection stays open for its next request; 0 means that it is closed at once. If a new
  /// connection finds no free place among `max_connections`, the one that has been idle longest is closed. Idle
  /// connections do not count for their address.
  std::chrono::milliseconds idle_timeout{150'000};
};

/// The idle timeout that is reported to clients. It is shorter than the one in force, so that a client that uses a
/// connection at the last moment still finds it open.
inline std::chrono::milliseconds told_idle_timeout(const ConnectionLimits& limits) {
  return limits.idle_timeout * 4 / 5;
}

}  // namespace remesh::server
