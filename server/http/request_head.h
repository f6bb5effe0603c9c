/// The head of an HTTP/1.x request, parsed strictly (RFC 9112): whatever two programs could read differently is
/// refused.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/http_message.h"

namespace remesh::server {

/// What a head may grow to.
struct HeadLimits {
  std::size_t max_bytes = 32 << 10;  ///< request line, fields and the empty line together
  std::size_t max_fields = 100;
};

/// Finds the end of a head in bytes as they arrive, and what is wrong with them as soon as it shows.
/// `checked` is how far earlier calls came; it moves on.
/// Output:  the head's length, its empty line included, or nothing while more is needed.
/// Errors:  400 - a line that does not end in CRLF, a control character; 414 or 431 - longer than the limits.
/// Cost:    O(new bytes).
std::optional<std::size_t> find_head_end(std::string_view bytes, std::size_t& checked, const HeadLimits& limits);

/// The method at the start of a head, also of one that has not come whole; empty before its blank has.
std::string_view method_of(std::string_view bytes);

/// Parses a whole head, the empty line included.
/// Output:  `head`, which was empty; where parsing fails, as far as it came: a refusal carries the request's id then.
/// Errors:  400 - not HTTP/1.0 or 1.1, folded or malformed fields, no or several Host or one that is no host, a bad
///          percent escape; 431 - too many fields.
void parse_head(std::string_view bytes, const HeadLimits& limits, RequestHead& head);

/// How a body is delimited (RFC 9112, section 6.3).
struct Framing {
  enum class Kind { kNone, kLength, kChunked } kind = Kind::kNone;
  std::uint64_t length = 0;  ///< of kLength
};

/// Errors:  400 - length repeated, malformed or beside a transfer coding, coding in HTTP/1.0; 411 - a POST, PUT or
///          PATCH without either; 501 - another coding than chunked.
Framing framing(const RequestHead& head);

/// Whether the client leaves the connection open for another request (RFC 9112, section 9.3): HTTP/1.1 unless it says
/// `close`, HTTP/1.0 if it says `keep-alive`.
bool wants_to_be_kept(const RequestHead& head);

/// Reads %xx escapes; a NUL among them is refused.
/// Errors:  400 - an incomplete escape.
std::string percent_decode(std::string_view text);

}  // namespace remesh::server
