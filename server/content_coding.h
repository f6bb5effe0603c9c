/// Answers, compressed where the client takes that.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"

namespace remesh::server {

/// Whether an `Accept-Encoding` field lets gzip in (RFC 9110, section 12.5.3).
bool accepts_gzip(std::string_view accept_encoding);

/// The bytes as gzip, fast rather than small.
/// Errors: remesh::Error - stopped through `control`; std::bad_alloc.
std::string gzip(std::string_view bytes, RunControl& control);

}  // namespace remesh::server
