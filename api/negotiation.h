/// Which format a body is in, and which one the answer takes.
#pragma once

#include <optional>
#include <string_view>

#include "core/io/formats.h"

namespace remesh::api {

/// All are written; VTU and MSH are not read, and text STL is read as kStl.
bool can_read(Format format);

/// A Content-Type without its parameters, in lower case.
std::string media_type_of(std::string_view content_type);

/// The format that a Content-Type names; nothing where it names none of ours (then the content tells).
std::optional<Format> format_of_content_type(std::string_view content_type);

/// The format of a body: by `named` if there is one, else by what the content looks like.
/// Errors: kUnsupportedMediaType - a format that is not read, or content that is known to be none of ours.
Format choose_input_format(std::optional<Format> named, std::string_view content);

/// The format of the answer: by the option, else by Accept (RFC 9110; `*/*` counts as absent), else as the input.
/// Errors: kNotAcceptable - nothing that Accept names is written.
Format choose_output_format(std::optional<Format> option, std::string_view accept, Format input);

}  // namespace remesh::api
