/// Small questions about the text of header fields.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace remesh::server {

std::string lower_case(std::string_view text);

/// Without blanks and tabs (and the ends of lines) on both sides.
std::string_view trimmed(std::string_view text);

/// The elements of a comma-separated list, trimmed; empty ones are left out.
std::vector<std::string_view> list_elements(std::string_view text);

}  // namespace remesh::server
