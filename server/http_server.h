/// The listener: accepts connections, one thread each, reads requests from each through the gate, one after another,
/// and answers them. A connection is kept until its client says otherwise or it is not certain where the next
/// request begins.
///
/// cpp-httplib binds and accepts, routes, and writes the answers. It is not let near a byte that a client sends: its
/// 0.11.4 has no overall deadlines, no bound on chunked bodies or lines, and can be misled about where a request ends.
/// So the gate reads the head, and httplib is given one that we wrote: method and path, spelled one way. The
/// true request waits beside it; its body is read once a route has taken it. What the gate refuses goes the same way
/// and fails before routing, so that there is one way out for all.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/http/api_keys.h"
#include "server/http/cors.h"
#include "server/http/gate.h"
#include "server/http/route.h"
#include "server/http/units.h"
#include "server/observe/metrics.h"

namespace remesh::server {

struct HttpSettings {
  GateLimits gate;
  std::size_t max_connections = 512;
  std::size_t max_connections_per_address = 64;
  /// How long a connection is kept for its next request; 0: not at all. Those that wait do not count among the
  /// connections above: there may be a quarter as many, then the one that has waited longest goes.
  std::chrono::milliseconds idle_timeout{3'000};
  const ApiKeys* keys = nullptr;  ///< what to ask for; none: nothing
  Cors cors;
  Metrics* metrics = nullptr;  ///< where to count; none: nowhere
};

class HttpServer {
 public:
  /// Beside the routes themselves, each path answers OPTIONS, and other methods with 405; both say what is allowed.
  HttpServer(const std::vector<Route>& routes, const HttpSettings& settings);
  /// Stops.
  ~HttpServer();

  /// Takes the address; a port of 0 becomes a free one. Errors: std::runtime_error - it is taken, or not ours.
  void bind(const Address& address);
  int port() const;
  /// Accepts connections in a thread of its own.
  void start();
  /// Goes on, but keeps no connection any more.
  void begin_drain();
  /// Closes the listener and all connections, and waits for their threads.
  void stop();

  /// Requests whose head was admitted and whose answer is not sent yet.
  std::size_t active_requests() const;
  /// Those that wait for their next request included.
  std::size_t open_connections() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

/// Asks a server by GET. Output: the status, or 0 if there is no answer within two seconds.
int probe(const Address& address, const std::string& path);

}  // namespace remesh::server
