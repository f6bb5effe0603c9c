/// Turns any exception into the answer that the client gets.
#pragma once

#include <exception>
#include <string_view>

#include "server/http/http_message.h"

namespace remesh::server {

/// Makes the answer to a request that failed.
/// Output:  problem+json. Unknown exceptions are logged under the request's id and answered by an opaque 500; lack of
///          memory is answered by 503. A 503 or 429 has a Retry-After.
Response error_response(const std::exception_ptr& failure, std::string_view request_id);

}  // namespace remesh::server
