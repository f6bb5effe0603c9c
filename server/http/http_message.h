/// Requests and answers as the daemon's own plain structs; no HTTP library is seen beyond `http_server`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "api/service.h"
#include "server/http/body.h"

namespace remesh::server {

class MemoryShare;

using api::Fields;

/// What stands before a body.
struct RequestHead {
  std::string method;  ///< as sent: "POST"
  std::string path;    ///< percent-decoded, starts with "/"
  Fields query;        ///< in the order sent, percent-decoded; '+' stays a plus, so that 1e+5 is a number
  Fields headers;      ///< names in lower case, values without surrounding blanks
  int minor_version = 1;

  /// The first header of that (lower case) name, or empty.
  std::string_view header(std::string_view name) const;
};

/// Where a request's time went, in milliseconds, as far as it came.
struct Timing {
  std::optional<double> body;   ///< receiving it
  std::optional<double> queue;  ///< waiting for a worker
  std::optional<double> work;
};

struct Request : RequestHead {
  std::string id;     ///< the X-Request-Id of the answer: what the client sent if that is usable, else given
  std::string owner;  ///< whose key it shows (ApiKeys::owner); empty where there are no keys
  Body body;          ///< out of its chunks
  Timing timing;
  std::shared_ptr<MemoryShare> memory;  ///< what it holds, until its answer is sent; may be none
};

/// `next_piece`, if set, stands for the body: it is called for one piece after another, may take its time, and ends the
/// answer with an empty one. The closing of the connection ends such a body for the client.
struct Response : api::Response {
  std::function<std::string()> next_piece;
  std::string problem_code;  ///< of an error
  std::string job;           ///< the id of the one that the request has made
  bool is_told = false;      ///< the error is a job's, which was asked for: this request itself did well
};

/// JSON that is true now: nobody may keep it.
inline Response json_response(std::string text) {
  Response response;
  response.content_type = "application/json";
  response.body = std::move(text);
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

/// Ends a request with an error that HTTP itself knows (not found, overloaded, ...), as remesh::Error does for the
/// rest.
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

/// The answer to a request that would need more than there can ever be. Throw it.
HttpError never_fits(std::uint64_t limit);
/// The answer to a request that finds no memory now. Throw it.
HttpError out_of_memory();

}  // namespace remesh::server
