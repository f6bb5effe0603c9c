/// What a client is told when its request fails, whatever was thrown.
#pragma once

#include <exception>
#include <string_view>

#include "server/http/http_message.h"

namespace remesh::server {

/// Output:  problem+json. Unknown exceptions are logged under the id and told as an opaque 500, lack of memory as 503;
///          a 503 or 429 says when to come again.
Response error_response(const std::exception_ptr& failure, std::string_view request_id);

}  // namespace remesh::server
