/// The trace that a request belongs to (W3C Trace Context).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace remesh::server {

struct TraceContext {
  std::string trace_id;   ///< 32 hexadecimal digits
  std::string parent_id;  ///< 16 hexadecimal digits: the caller's span
};

/// Reads a `traceparent` field.
/// Output: nothing if the field is absent or does not follow the standard.
std::optional<TraceContext> parse_traceparent(std::string_view text);

}  // namespace remesh::server
