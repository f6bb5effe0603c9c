/// multipart/form-data, as browsers and `curl -F` send it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace remesh::api {

/// One part; the views are into the body.
struct FormPart {
  std::string name;
  std::string file_name;     ///< empty if it has none; not trusted
  std::string content_type;  ///< as sent; empty if none
  std::string_view content;
};

/// Takes a body apart.
/// Input:  the whole body and its Content-Type with the `boundary`.
/// Holds:  no byte of a part's content is changed or copied.
/// Errors: kMalformedMultipart - no or a bad boundary, a part without a name, an encoding, more than 8 parts, the end
///         missing, or anything else that RFC 7578 does not allow.
/// Cost:   O(body).
std::vector<FormPart> parse_multipart(std::string_view body, std::string_view content_type);

/// A parameter of a header's value (`boundary` in `multipart/form-data; boundary="x"`), unquoted; nothing if absent.
/// The name in lower case.
std::optional<std::string> header_parameter(std::string_view value, std::string_view name);

}  // namespace remesh::api
