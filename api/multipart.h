/// Parses multipart/form-data as browsers and `curl -F` send it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace remesh::api {

/// One part of a form. The content is a view into the body.
struct FormPart {
  std::string name;
  std::string file_name;     ///< empty if the part has none; not trusted
  bool is_file = false;      ///< it has a file name, even an empty one
  std::string content_type;  ///< as sent; empty if there is none
  std::string_view content;
};

/// Splits a body into its parts.
/// Input:  the whole body, and its Content-Type with the `boundary`.
/// Holds:  no byte of a part's content is changed or copied.
/// Errors: kMalformedMultipart - a missing or bad boundary, a part without a name, an encoding, more than 64 parts, a
///         missing end, or anything else that RFC 7578 does not permit.
/// Cost:   O(body).
std::vector<FormPart> parse_multipart(std::string_view body, std::string_view content_type);

/// Returns a parameter of a header's value, without quotes: `x` for `boundary` in `multipart/form-data;
/// boundary="x"`.
/// Input:  `name` - in lower case.
/// Output: nothing if the parameter is absent.
std::optional<std::string> header_parameter(std::string_view value, std::string_view name);

}  // namespace remesh::api
