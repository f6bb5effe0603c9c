/// Decides which format a body has, and which format the answer gets.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/options.h"
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

/// The format of an answer.
struct OutputFormat {
  Format format = Format::kObj;
  /// The format was asked for by its name or its media type, and not only as one of several. No other format is
  /// acceptable.
  bool is_by_name = false;
};

/// Chooses the format of the answer: by the option, else by Accept (RFC 9110), else the input's format. The
/// input's format also wins where `*/*` has the largest weight in Accept, or a weight equal to the largest.
/// Errors: kNotAcceptable - no format that Accept names can be written.
OutputFormat choose_output_format(std::optional<Format> option, std::string_view accept, Format input);

/// Returns the treatment of coordinates that the format cannot hold: if the format has a form as text and was not asked
/// for by name, they are written as text.
OutputRounding rounding_for(const OutputFormat& wanted);

/// Returns the form of a format as text, which holds all digits; the format itself if it has none.
Format text_form(Format format);

/// Returns the value of Content-Type for a file. STL as text has the media type of STL, and a charset says that it is
/// text.
std::string content_type(Format format);

}  // namespace remesh::api
