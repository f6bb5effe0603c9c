/// Answers, compressed where the client takes that.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// Whether an `Accept-Encoding` field lets gzip in (RFC 9110, section 12.5.3).
bool accepts_gzip(std::string_view accept_encoding);

/// The bytes as gzip, fast rather than small.
/// Errors: remesh::Error - stopped through `control`; std::bad_alloc.
std::string gzip(std::string_view bytes, RunControl& control);

/// Compresses the body of an answer, unless that is small, where `accept_encoding` lets gzip in; says by Vary that it
/// depends on that.
/// Errors: as gzip.
void compress(api::Response& response, std::string_view accept_encoding, RunControl& control);

/// The same of an answer that no worker wrote, since it is short or only read: it is compressed at once.
Response compressed(Response response, const RequestHead& request);

}  // namespace remesh::server
