/// Helpers for the text of header fields.
#pragma once

#include <string_view>
#include <vector>

namespace remesh::server {

/// Removes blanks and tabs, which HTTP permits around values, and line ends from both sides.
std::string_view trimmed(std::string_view text);

/// Splits a comma-separated list into trimmed elements. Empty elements are left out.
std::vector<std::string_view> list_elements(std::string_view text);

}  // namespace remesh::server
