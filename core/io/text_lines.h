/// Text as a sequence of lines, for all readers of text formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace remesh {

/// The byte-order mark of UTF-8.
inline constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

/// `text` without what pads it: NUL bytes at its end, and Ctrl-Z, with which DOS ended texts.
std::string_view without_padding(std::string_view text);

/// Walks over text once, line by line.
/// Input:   line ends LF, CRLF or CR, mixed or not; a UTF-8 byte-order mark is skipped, and padding. The text outlives
///          the walk.
/// Errors:  kInvalidMesh - the text begins with the byte-order mark of another encoding, which the message names.
/// Cost:    O(text), one look at each byte; lines are views into the text.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// Goes to the next line; false at the end of the text.
  bool next();

  /// Without its line end.
  std::string_view line() const { return line_; }
  /// The number of the line, from 1.
  std::uint64_t number() const { return number_; }
  /// Bytes walked over so far, the line's end included.
  std::size_t offset() const { return offset_; }
  /// The first character of the line that no text holds.
  std::optional<unsigned char> control_character() const { return control_character_; }
  /// Refuses a line with such a character.
  /// Errors: kInvalidMesh, with the line.
  void check_is_text() const;

 private:
  std::string_view text_;
  std::string_view line_;
  std::size_t offset_ = 0;
  std::uint64_t number_ = 0;
  std::optional<unsigned char> control_character_;
};

/// The name of the encoding that a byte-order mark tells, where it is not UTF-8; else nothing.
std::optional<std::string_view> wide_encoding(std::string_view text);

}  // namespace remesh
