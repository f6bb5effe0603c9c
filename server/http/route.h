/// What the daemon serves: which handler stands behind which method and path.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/http/connection.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// What a handler gets.
struct Call {
  Request& request;
  Connection& connection;
  std::string parameter;  ///< what stood for {id} in the path
};
using Handler = std::function<Response(const Call&)>;

/// On what terms a request with a body is let in.
struct Admission {
  std::uint64_t max_body = 0;                     ///< bytes
  std::shared_ptr<MemoryShare> memory = nullptr;  ///< what it reserves; none: not counted
};

struct Route {
  std::string method;  ///< GET answers HEAD too
  std::string path;    ///< a segment "{id}" stands for any one segment
  Handler handle;
  /// Before the body is read; throws HttpError to refuse it. Without it, a body is refused.
  std::function<Admission(const RequestHead&)> admit = nullptr;
  bool is_open = false;  ///< to clients without an API key, too
};

}  // namespace remesh::server
