/// Splits OBJ text into records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/io/common/number_parsing.h"
#include "core/io/common/text_lines.h"

namespace remesh {

/// True if the character may occur in a keyword after its first letter.
constexpr bool is_obj_keyword_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

/// Visits the records `keyword arguments` of an OBJ text once, in order.
/// Input:   a text that must outlive this object. Lines may end in LF, CRLF or CR. A `\` at the end of a line
///          continues it, except in a comment, which may end in a path. In records of numbers only, blanks may follow
///          the `\`. A UTF-8 byte-order mark and padding at the end are skipped.
/// Holds:   comments and blank lines are skipped; a keyword consists of letters, digits and `_`, and begins with a
///          letter.
/// Errors:  kInvalidMesh, with the line - UTF-16 or UTF-32; a control character outside comments; a line that begins
///          with anything else.
/// Cost:    O(text); each byte is read once. Joined lines are copied, all others are views into the text.
class ObjRecords {
 public:
  explicit ObjRecords(std::string_view text);

  /// Goes to the next record.
  /// Output: false at the end of the text.
  bool next();

  std::string_view keyword() const { return keyword_; }
  /// The text after the keyword without the line end. Continued lines are joined, and blanks are unchanged.
  std::string_view arguments() const { return arguments_; }
  /// The number of the line on which the record begins, from 1. Each continued line counts.
  std::uint64_t line() const { return line_; }
  /// The number of bytes visited so far.
  std::size_t offset() const { return lines_.offset(); }

 private:
  std::string_view take_logical_line();

  TextLines lines_;
  std::uint64_t line_ = 0;
  std::string joined_;
  std::string_view keyword_;
  std::string_view arguments_;
};

}  // namespace remesh
