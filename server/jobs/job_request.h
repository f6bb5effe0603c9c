/// What stands beside the body of a job, as text to keep.
#pragma once

#include <string>
#include <string_view>

#include "api/service.h"

namespace remesh::server::jobs {

/// All of a request but its body, as JSON; the same request gives the same text.
std::string pack_request(const api::Request& request);
/// The request again, without its body. Errors: std::runtime_error - the text is no such JSON.
api::Request unpack_request(std::string_view text);

}  // namespace remesh::server::jobs
