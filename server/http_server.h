/// The HTTP server. It accepts connections, one thread for each, reads requests through the gate one after another,
/// and answers them. A connection stays open until the client asks to close it, or until it is uncertain where the next
/// request begins.
///
/// cpp-httplib binds and accepts, routes, and writes the answers. It never sees a byte that a client sends: its
/// version 0.11.4 has no overall deadlines and no bound on chunked bodies or lines, and it can be misled about where
/// a request ends. So the gate reads the head, and httplib gets a head that this daemon wrote, with the method and the
/// normalised path. The real request is kept beside it, and its body is read once a route has accepted it. A request
/// that the gate refuses also passes through httplib and fails before routing, so that all answers are written by the
/// same code.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/http/api_keys.h"
#include "server/http/client_address.h"
#include "server/http/connection_limits.h"
#include "server/http/cors.h"
#include "server/http/key_limits.h"
#include "server/http/public_url.h"
#include "server/http/route.h"
#include "server/http/site_rules.h"
#include "server/http/spool.h"
#include "server/http/units.h"
#include "server/observe/metrics.h"
#include "server/work/memory_wait.h"

namespace remesh::server {

struct HttpSettings {
  ConnectionLimits connections;
  const ApiKeys* keys = nullptr;  ///< the keys that clients must show; null if none are required
  KeyRules key_rules;
  Cors cors;
  TrustedProxies proxies;
  PublicUrl public_url;
  std::optional<SiteRules> sites;  ///< nothing if API keys keep the pages of other sites out
  MemoryPatience memory_patience;
  Spool* spool = nullptr;      ///< takes large answers from slow readers; null if all answers stay in memory
  Metrics* metrics = nullptr;  ///< the metrics that count requests; null if they are not counted
};

class HttpServer {
 public:
  /// Every path also answers OPTIONS, and answers 405 to methods without a route. Both answers list the allowed
  /// methods.
  HttpServer(const std::vector<Route>& routes, const HttpSettings& settings);
  /// Calls `stop`.
  ~HttpServer();

  /// Binds the address; a port of 0 chooses a free one.
  /// Errors: std::runtime_error - the address is in use or cannot be bound.
  void bind(const Address& address);
  int port() const;
  /// Starts a thread that accepts connections.
  void start();
  /// Continues to serve, but keeps no connection open after its answer.
  void begin_drain();
  /// Closes the listener and all connections, and waits for their threads.
  void stop();

  /// The number of requests whose head was admitted and whose answer has not been sent yet.
  std::size_t active_requests() const;
  /// The number of open connections, including idle ones.
  std::size_t open_connections() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

/// Sends a GET request to a server.
/// Output: the status, or 0 if there is no answer within two seconds.
int probe(const Address& address, const std::string& path);

}  // namespace remesh::server
