/// A strict parser for the head of an HTTP/1.x request (RFC 9112). It refuses everything that two programs could
/// interpret differently.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/http_message.h"

namespace remesh::server {

/// The size limits of a head.
struct HeadLimits {
  std::size_t max_bytes = 32 << 10;  ///< total of the request line, the fields and the empty line
  std::size_t max_fields = 100;
};

/// Searches for the end of a head in bytes that are still arriving. It refuses errors as soon as they show.
/// Input:   `checked` - the number of bytes that earlier calls have examined; it is updated.
/// Output:  the length of the head with its empty line, or nothing if more bytes are needed.
/// Errors:  HttpError 400 - a line that does not end in CRLF, a control character; 414 or 431 - longer than the
///          limits.
/// Cost:    O(new bytes).
std::optional<std::size_t> find_head_end(std::string_view bytes, std::size_t& checked, const HeadLimits& limits);

/// The method at the start of a head, which may be incomplete.
/// Output: empty until the blank after the method has arrived.
std::string_view method_of(std::string_view bytes);

/// Parses a whole head, including the empty line.
/// Output:  `head`, which must be empty before. If parsing fails, it is filled as far as parsing came, so that a
///          refusal can carry the request's id.
/// Errors:  HttpError 400 - no HTTP, folded or malformed fields, no Host field or several, an invalid
///          Host, another field twice that may be sent only once, a bad percent escape; 431 - too many fields; 505 -
///          neither HTTP/1.0 nor 1.1.
void parse_head(std::string_view bytes, const HeadLimits& limits, RequestHead& head);

/// How a body is delimited (RFC 9112, section 6.3).
struct Framing {
  enum class Kind { kNone, kLength, kChunked } kind = Kind::kNone;
  std::uint64_t length = 0;  ///< bytes, for kLength
};

/// Finds out how the body is delimited.
/// Errors:  HttpError 400 - a length that is repeated, malformed or beside a transfer coding, or a coding in
///          HTTP/1.0; 411 - a POST without a length or a coding; 501 - another coding than chunked.
Framing framing(const RequestHead& head);

/// True if the client permits the connection to stay open for another request (RFC 9112, section 9.3). HTTP/1.1 does so
/// unless it says `close`, HTTP/1.0 only if it says `keep-alive`.
bool wants_to_be_kept(const RequestHead& head);

/// Decodes %xx escapes.
/// Errors:  HttpError 400 - an incomplete escape, or an escaped NUL.
std::string percent_decode(std::string_view text);

}  // namespace remesh::server
