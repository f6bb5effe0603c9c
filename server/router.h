/// From method and path to a handler.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/connection.h"
#include "server/http_message.h"

namespace remesh::server {

/// What a handler gets.
struct Call {
  Request& request;
  Connection& connection;
  std::string parameter;  ///< what stood for {id} in the path
};
using Handler = std::function<Response(const Call&)>;

struct Route {
  std::string method;  ///< GET answers HEAD too
  std::string path;    ///< a segment "{id}" stands for any one segment
  Handler handle;
  /// Before the body is read: the bytes it may have. Throws HttpError to refuse it. Without it, a body is refused.
  std::function<std::uint64_t()> admit = nullptr;
};

class Router {
 public:
  explicit Router(std::vector<Route> routes) : routes_(std::move(routes)) {}

  /// How long this request's body may be. Errors: HttpError 404, 405, and what the route's `admit` throws.
  std::uint64_t admit(const RequestHead& head) const;
  /// Errors: HttpError 404, 405, and what the handler throws.
  Response answer(Request& request, Connection& connection) const;

 private:
  struct Match {
    const Route* route;  ///< null for OPTIONS
    std::string parameter;
    std::string allow;
  };
  Match find(const RequestHead& head) const;

  std::vector<Route> routes_;
};

}  // namespace remesh::server
