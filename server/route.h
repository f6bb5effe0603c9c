/// What the daemon serves: which handler stands behind which method and path.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

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

}  // namespace remesh::server
