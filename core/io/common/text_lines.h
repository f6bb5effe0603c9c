/// Splits text into lines, for all readers of text formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace remesh {

/// The byte-order mark of UTF-8.
inline constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

/// Visits the lines of a text once, in order.
/// Input:   a text that must outlive this object. Its lines may end in LF, CRLF or CR, even mixed. A UTF-8 byte-order
///          mark and padding are skipped.
/// Errors:  kInvalidMesh - the text begins with the byte-order mark of another encoding, which the message names.
/// Cost:    O(text); each byte is read once, and lines are views into the text.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// Goes to the next line.
  /// Output: false at the end of the text.
  bool next();

  /// The current line without its line end.
  std::string_view line() const { return line_; }
  /// The number of the current line, from 1.
  std::uint64_t number() const { return number_; }
  /// The number of bytes visited so far, including the line's end.
  std::size_t offset() const { return offset_; }
  /// The first character of the line that may not occur in text.
  std::optional<unsigned char> control_character() const { return control_character_; }
  /// Refuses a line that contains such a character.
  /// Errors: kInvalidMesh, with the line.
  void check_is_text() const;

 private:
  std::string_view text_;
  std::string_view line_;
  std::size_t offset_ = 0;
  std::uint64_t number_ = 0;
  std::optional<unsigned char> control_character_;
};

/// The name of the encoding of which the text has a byte-order mark.
/// Output: nothing if there is no mark, or if it is that of UTF-8.
std::optional<std::string_view> wide_encoding(std::string_view text);

}  // namespace remesh
