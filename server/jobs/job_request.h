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

/// What makes a request the same as another, whole: the digest of its bytes, but of a form that of its parts, since
/// clients draw the boundary between them anew each time.
/// Errors: remesh::Error kMalformedMultipart - a form that is none.
std::string request_digest(const api::Request& request);

}  // namespace remesh::server::jobs
