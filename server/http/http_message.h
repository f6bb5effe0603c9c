/// Requests and answers as plain structs of the daemon. Only `http_server` sees an HTTP library.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "api/operations.h"
#include "server/http/body.h"
#include "server/http/connection.h"

namespace remesh::server {

class MemoryShare;

using api::Fields;

/// The part of a request before its body.
struct RequestHead {
  std::string method;            ///< as the client sent it: "POST"
  std::string path;              ///< percent-decoded, starts with "/"
  Fields query;                  ///< in the order sent, percent-decoded; '+' stays a plus, so that 1e+5 is a number
  std::string target_authority;  ///< the host and port in an absolute target; empty for other targets
  Fields headers;                ///< names in lower case, values without surrounding blanks
  int minor_version = 1;

  /// The value of the first header of that name, or empty.
  /// Input: `name` - in lower case.
  std::string_view header(std::string_view name) const;
  /// The values of all headers of that name, joined by commas as one list (RFC 9110, section 5.3).
  std::string list(std::string_view name) const;
  bool has(std::string_view name) const;
  /// The host and port that the request is meant for: those of an absolute target, else the Host field (RFC 9112,
  /// section 3.2.2).
  std::string_view authority() const;
};

/// The time that the steps of a request took, in milliseconds. Steps that were not reached have no value.
struct Timing {
  std::optional<double> body;   ///< receiving the body
  std::optional<double> queue;  ///< waiting for a worker
  std::optional<double> work;
};

struct Request : RequestHead {
  std::string id;      ///< the X-Request-Id of the answer: the client's own if it is usable, else a new one
  std::string prefix;  ///< the path that a proxy puts before the paths of this daemon, such as `/mesh`; often empty
  std::string owner;   ///< identifies the API key (ApiKeys::owner); empty if the server has no keys
  std::string key;     ///< the name of the API key (ApiKeys::name_of); empty if the request has none
  Body body;           ///< without the chunked coding
  Timing timing;
  Clock::duration waited{0};            ///< the time that the request has waited for memory
  std::shared_ptr<MemoryShare> memory;  ///< the reservation that lasts until the answer is sent; may be null
};

/// An answer. If `next_piece` is set, it replaces the body: it is called for one piece after another, may wait, and
/// returns an empty piece at the end. Such a body has no length, so the client sees its end when the connection closes.
struct Response : api::Response {
  std::function<std::string()> next_piece;
  /// For HEAD: the size that the body would have. The body is then left out.
  std::optional<std::uint64_t> size_for_head = std::nullopt;
  std::string problem_code;  ///< empty unless the answer is an error
  std::string job;           ///< the id of the job that this request has submitted
  bool is_told = false;      ///< the error is the outcome of a job that the client asked about; this request succeeded
};

/// Makes an answer of JSON that is valid only now, so caches must not store it.
inline Response json_response(std::string text) {
  Response response;
  response.content_type = "application/json";
  response.body = std::move(text);
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

/// The header fields of a stream of events. Proxies such as nginx would hold back its events without the second one.
inline Fields event_stream_headers() { return {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}}; }

/// An error that belongs to HTTP (not found, overloaded, ...). All other errors of a request are remesh::Error.
class HttpError : public std::runtime_error {
 public:
  HttpError(int status, const std::string& code, const std::string& detail) : std::runtime_error(detail) {
    problem.status = status;
    problem.code = code;
    problem.detail = detail;
  }
  HttpError& with_limit(std::uint64_t limit) {
    problem.limit = limit;
    return *this;
  }
  HttpError& with_header(std::string name, std::string value) {
    headers.emplace_back(std::move(name), std::move(value));
    return *this;
  }

  api::Problem problem;
  Fields headers;
};

/// The error to throw for a body of more than `limit` bytes.
HttpError body_too_large(std::uint64_t limit);
/// The error to throw for a request that needs more memory than the whole budget.
HttpError never_fits(std::uint64_t limit);
/// The error to throw for a request for which there is no memory at the moment.
HttpError out_of_memory();
/// The error to throw for a request that arrives, or is stopped, while the daemon is stopping.
HttpError draining();

}  // namespace remesh::server
