/// Decides which format a body has, and which format the answer gets.
#pragma once

#include <optional>
#include <string_view>

#include "core/io/formats.h"

namespace remesh::api {

/// True if the format can be read. All formats are written, but VTU and MSH are not read, and text STL is read as
/// kStl.
bool can_read(Format format);

/// Returns a Content-Type without its parameters, in lower case.
std::string media_type_of(std::string_view content_type);

/// The format that a Content-Type names.
/// Output: nothing if it names none of ours; the content then decides.
std::optional<Format> format_of_content_type(std::string_view content_type);

/// Chooses the format of a body: `named` if that is set, else the format that the content looks like.
/// Errors: kUnsupportedMediaType - a format that cannot be read, or content that is known to be in another format.
Format choose_input_format(std::optional<Format> named, std::string_view content);

/// Chooses the format of the answer: by the option, else by Accept (RFC 9110), else the input's format. The
/// input's format also wins where `*/*` has the largest weight in Accept, or a weight equal to the largest.
/// Errors: kNotAcceptable - no format that Accept names can be written.
Format choose_output_format(std::optional<Format> option, std::string_view accept, Format input);

}  // namespace remesh::api
