/// Validators and ranges for answers whose bytes do not change (RFC 9110, sections 13 and 14): a client that has a
/// result need not fetch it again, and a client that has a part of it can fetch the rest.
#pragma once

#include "server/http/http_message.h"

namespace remesh::server {

/// True if an `If-None-Match` or `If-Match` list names the tag, by weak comparison.
bool names_tag(std::string_view list, std::string_view tag);

/// Adds `ETag` and `Accept-Ranges` to a complete answer with a `Repr-Digest`, and reduces it to the range for which the
/// request asks.
/// Output: 200, 304 if the client has these bytes, or 206 with one range of them. A request for several ranges gets the
///         complete answer.
/// Errors: HttpError 416 - the range is beyond the end.
Response with_ranges(Response answer, const RequestHead& request);

}  // namespace remesh::server
