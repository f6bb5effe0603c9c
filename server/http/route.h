/// The routes of the daemon: which handler serves which method and path.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/http/connection.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// The arguments of a handler.
struct Call {
  Request& request;
  Connection& connection;
  std::string parameter;  ///< the path segment that matched {id}
};
using Handler = std::function<Response(const Call&)>;

/// Who may use a route.
enum class Access {
  kGuarded,   ///< clients with an API key, if the daemon has keys
  kPageFile,  ///< everyone: a file of the web page
  kProbe,     ///< everyone: a question whether the daemon works
};

/// The terms under which a request with a body is accepted.
struct Admission {
  std::uint64_t max_body = 0;                     ///< bytes
  std::shared_ptr<MemoryShare> memory = nullptr;  ///< the reservation for the body; null if it is not counted
};

struct Route {
  std::string method;  ///< a route for GET also answers HEAD
  std::string path;    ///< a segment "{id}" matches any one segment
  Handler handle;
  /// Called before the body is read; throws HttpError to refuse the request. A route without it accepts no body.
  std::function<Admission(const RequestHead&)> admit = nullptr;
  Access access = Access::kGuarded;
  bool takes_token = false;  ///< a request without a key may have a token for its path (ApiKeys::token)
};

}  // namespace remesh::server
