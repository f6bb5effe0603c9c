/// Converts the part of a request besides its body to text that can be stored with a job, and back.
#pragma once

#include <string>
#include <string_view>

#include "api/operations.h"

namespace remesh::server::jobs {

/// Writes all data of a request except its body as JSON. Equal requests give equal text.
std::string pack_request(const api::Request& request);
/// Restores the request, without its body.
/// Errors: std::runtime_error - the text does not come from pack_request.
api::Request unpack_request(std::string_view text);

/// A digest that is equal for two requests exactly if they ask for the same. It covers the bytes of the body. For a
/// form it covers the parts instead, because clients choose a new random boundary between them each time.
/// Errors: remesh::Error kMalformedMultipart - the body is not a valid form.
std::string request_digest(const api::Request& request);

}  // namespace remesh::server::jobs
