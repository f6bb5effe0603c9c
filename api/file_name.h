/// The names of files in the headers of requests and answers.
#pragma once

#include <string>
#include <string_view>

#include "core/io/formats.h"

namespace remesh::api {

/// Makes the value of the Content-Disposition of a result.
/// Input:  `upload` - the name of the file that was uploaded, which is not trusted; it may be empty.
/// Output: the name without folders, hidden by no dot, not long, and with the ending of the format. ASCII characters
///         other than letters, digits and `._-` become `_`. A name beyond ASCII comes in `filename*`, too (RFC 6266).
std::string content_disposition(std::string_view upload, Format format);

/// True if a text that was sent in place of a mesh is only the name of a mesh file, such as `parts/wheel.stl`.
bool is_file_name(std::string_view text);

/// Decodes the value of a parameter such as `filename*` (RFC 8187): `UTF-8''r%C3%A4der.obj`.
/// Output: empty if it is malformed or in another charset.
std::string decode_extended_value(std::string_view value);

}  // namespace remesh::api
