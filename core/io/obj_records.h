/// OBJ text as a sequence of records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/io/text.h"
#include "core/io/text_lines.h"

namespace remesh {

/// A keyword starts with a letter and goes on with these.
constexpr bool is_obj_keyword_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

/// Walks over OBJ text once, record by record: `keyword arguments`.
/// Input:   line ends LF, CRLF or CR; a `\` at the end of a line continues it (not a comment, which may end in a path),
///          and with blanks behind it where only numbers can stand; a UTF-8 byte-order mark is skipped, and padding at
///          the end. The text outlives the walk.
/// Holds:   comments and blank lines are skipped; a keyword is one of letters, digits and `_`, a letter first.
/// Errors:  kInvalidMesh, with the line - UTF-16 or UTF-32; a control character outside comments; a line that starts
///          otherwise.
/// Cost:    O(text), one look at each byte; joined lines are copied, all others are views into the text.
class ObjRecords {
 public:
  explicit ObjRecords(std::string_view text);

  /// Goes to the next record; false at the end of the text.
  bool next();

  std::string_view keyword() const { return keyword_; }
  /// What follows the keyword, joined if continued; without the line end, blanks as they stand.
  std::string_view arguments() const { return arguments_; }
  /// The line on which the record starts, from 1, continued lines counted one by one.
  std::uint64_t line() const { return line_; }
  /// Bytes walked over so far.
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
