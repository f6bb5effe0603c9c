/// Validators and ranges for answers whose bytes do not change (RFC 9110, sections 13 and 14): a client that has a
/// result need not fetch it again, and a client that has a part of it can fetch the rest.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "server/http/http_message.h"

namespace remesh::server {

/// True if an `If-None-Match` list names the tag, by weak comparison.
bool names_tag(std::string_view list, std::string_view tag);

/// Adds `ETag` and `Accept-Ranges` to a complete answer with a `Repr-Digest`, and reduces it to the range for which the
/// request asks.
/// Output: 200, 304 if the client has these bytes, or 206 with one range of them. A request for several ranges gets the
///         complete answer.
/// Errors: HttpError 412 - `If-Match` names other bytes; 416 - the range is beyond the end.
Response with_ranges(Response answer, const RequestHead& request);

/// Does the same with a body that is elsewhere. Only the bytes that are sent are read: none of them for HEAD and for
/// 304.
/// Input: `read` - returns the bytes from a place to another one.
Response with_ranges(Response head, const RequestHead& request, std::uint64_t size,
                     const std::function<std::string(std::uint64_t, std::uint64_t)>& read);

}  // namespace remesh::server
