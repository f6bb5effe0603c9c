/// One request on its way to its answer, and what is told of it afterwards.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/service.h"
#include "server/http/connection.h"
#include "server/http/gate.h"
#include "server/http/http_message.h"
#include "server/observe/log.h"
#include "server/observe/metrics.h"

namespace remesh::server {

/// Counts up for the time of a scope.
class Counted {
 public:
  explicit Counted(std::atomic<std::size_t>& counter) : counter_(counter) { ++counter_; }
  ~Counted() { --counter_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::atomic<std::size_t>& counter_;
};

struct Exchange {
  explicit Exchange(Connection& client) : connection(client) {}

  Connection& connection;
  const Clock::time_point start = Clock::now();
  Request request;
  Framing framing;                ///< of the body, before that is read
  std::exception_ptr refusal;     ///< why it must not reach a route
  std::optional<Counted> active;  ///< from its admission on
  bool is_read = false;           ///< head and body, all of it
  bool is_streamed = false;       ///< an answer that ends with its connection
  bool is_kept = false;           ///< the connection, for another request

  // What is known of the answer.
  std::string_view route = "none";  ///< the path of the route, with names for what varies
  int status = 0;                   ///< 0 while there is none
  std::string problem_code;         ///< of an error
  std::string job;                  ///< see Response
  bool is_told = false;             ///< see Response
  std::optional<api::WorkDone> done;
};

/// What work came to, as fields of a line of the log.
void add_work(const api::WorkDone& done, std::vector<log::Field>& fields);

enum class Outcome { kAnswered, kClientGone };

/// Writes the line of the access log, and counts: an exchange is over.
/// Holds:  never a body, a key or a query in the log.
void account_for(const Exchange& exchange, Outcome outcome, Metrics* metrics);

}  // namespace remesh::server
