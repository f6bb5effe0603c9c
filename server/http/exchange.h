/// One request and its answer, and what is logged and counted about them afterwards.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/operations.h"
#include "server/http/address_counts.h"
#include "server/http/connection.h"
#include "server/http/gate.h"
#include "server/http/http_message.h"
#include "server/observe/log.h"
#include "server/observe/metrics.h"

namespace remesh::server {

/// Increments a counter for the duration of a scope.
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
  explicit Exchange(Connection& on) : connection(on), client(on.peer_address()) {}

  Connection& connection;
  std::string client;  ///< the address of the client; that of the connection unless a trusted proxy names another
  std::optional<AddressCounts::Place> place;  ///< the place of a client behind a trusted proxy
  const Clock::time_point start = Clock::now();
  Request request;
  Framing framing;                ///< how the body is delimited
  std::string large_body;         ///< the body of the answer if it is sent by `send_large`
  std::exception_ptr refusal;     ///< the reason why the request must not reach a route
  std::optional<Counted> active;  ///< counts this request from its admission on
  bool is_read = false;           ///< the head and the whole body were read
  bool is_streamed = false;       ///< the answer ends when its connection closes
  bool takes_ranges = false;      ///< the client could have asked for a part of the answer
  bool is_kept = false;           ///< the connection stays open for another request

  // These members describe the answer.
  std::string_view route = "none";  ///< the path of the route, with `{id}` for the variable part
  int status = 0;                   ///< 0 until there is an answer
  std::string problem_code;         ///< empty unless the answer is an error
  std::string job;                  ///< see Response::job
  bool is_told = false;             ///< see Response::is_told
  std::optional<api::WorkDone> done;
};

/// Appends the sizes and times of the work to the fields of a log line.
void add_work(const api::WorkDone& done, std::vector<log::Field>& fields);

enum class Outcome { kAnswered, kClientGone };

/// Writes the line of the access log and counts the exchange, which must be over.
/// Holds:  the log never contains a body, a key or a query.
void account_for(const Exchange& exchange, Outcome outcome, Metrics* metrics);

}  // namespace remesh::server
