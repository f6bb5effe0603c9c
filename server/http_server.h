/// The listener: accepts connections, one thread each, and takes each through gate, router and answer. Every answer
/// closes its connection.
///
/// cpp-httplib binds and accepts; it is not let near a byte that a client sends. Its 0.11.4 has no overall deadlines,
/// no bound on chunked bodies or lines, and can be misled about where a request ends, so the gate reads requests
/// instead. As errors found there must be answered without it too, answers are written here as well: one way out for
/// all of them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "server/gate.h"
#include "server/router.h"
#include "server/units.h"

namespace remesh::server {

class HttpServer {
 public:
  /// `router` must outlive the server.
  HttpServer(const Router& router, const GateLimits& limits, std::size_t max_connections);
  /// Stops.
  ~HttpServer();

  /// Takes the address; a port of 0 becomes a free one. Errors: std::runtime_error - it is taken, or not ours.
  void bind(const Address& address);
  int port() const;
  /// Accepts connections in a thread of its own.
  void start();
  /// Closes the listener and all connections, and waits for their threads.
  void stop();

  /// Requests whose head was admitted and whose answer is not sent yet.
  std::size_t active_requests() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

/// Asks a server by GET. Output: the status, or 0 if there is no answer within two seconds.
int probe(const Address& address, const std::string& path);

}  // namespace remesh::server
