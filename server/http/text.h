/// Small questions about the text of header fields.
#pragma once

#include <string_view>
#include <vector>

namespace remesh::server {

/// Without blanks and tabs on both sides, which HTTP lets stand around values, and without the ends of lines.
std::string_view trimmed(std::string_view text);

/// The elements of a comma-separated list, trimmed; empty ones are left out.
std::vector<std::string_view> list_elements(std::string_view text);

}  // namespace remesh::server
