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
  /// How long an idle connection stays open for its next request; 0 means that it is closed at once. Idle connections
  /// do not count among the connections above. There may be about a quarter as many; beyond that, the one that has
  /// waited longest is closed.
  std::chrono::milliseconds idle_timeout{3'000};
};

}  // namespace remesh::server
