/// Compresses answers for clients that accept gzip.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// Checks the coding of a body before it is read.
/// Errors: HttpError 415 - a coding that is not gzip. The answer names the accepted coding in `Accept-Encoding` (RFC
///         9110, section 15.5.16).
void check_content_coding(const RequestHead& head);

/// True if an `Accept-Encoding` field accepts gzip (RFC 9110, section 12.5.3).
bool accepts_gzip(std::string_view accept_encoding);

/// Compresses bytes in gzip's format with zlib's fastest level.
/// Errors: remesh::Error - stopped through `control`; std::bad_alloc.
std::string gzip(std::string_view bytes, RunControl& control);

/// Compresses the body of an answer if `accept_encoding` accepts gzip and the body is not small. In any case it adds
/// the Vary field, because the answer depends on that field.
/// Errors: as gzip.
void compress(api::Response& response, std::string_view accept_encoding, RunControl& control);

/// Does the same for an answer that no worker made, because it is short or only read from memory. This compression
/// cannot be cancelled.
Response compressed(Response response, const RequestHead& request);

}  // namespace remesh::server
