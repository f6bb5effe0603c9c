/// Reads text whose line ends count as blanks, token by token.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "core/io/common/mesh_builder.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"
#include "core/io/common/text_lines.h"

namespace remesh {

/// Visits the tokens of a text once, in order.
/// Input:   as for TextLines, and the character with which comments begin; 0: there are none. Comments end with their
///          line.
/// Errors:  kInvalidMesh, with the line - a control character outside of comments.
/// Cost:    O(text).
class TextTokens {
 public:
  explicit TextTokens(std::string_view text, char comment = 0) : lines_(text), comment_(comment) {}

  /// Takes the next token.
  /// Output: empty at the end of the text.
  std::string_view next() {
    for (;;) {
      const std::string_view token = next_token(rest_);
      if (!token.empty()) return token;
      if (!next_line()) return {};
    }
  }
  /// Takes the next number that is a whole one.
  /// Input:  `what` - its meaning, with an article, for the message.
  /// Errors: kInvalidMesh, with the line - the token is none, or the text ends.
  template <class Integer>
  Integer integer(const char* what) {
    const std::string_view token = next();
    Integer value = 0;
    const char* const begin = token.data() + (token.starts_with('+') ? 1 : 0);
    const char* const end = token.data() + token.size();
    const auto [stop, status] = std::from_chars(begin, end, value);
    if (status == std::errc() && stop == end && !token.empty()) return value;
    throw expected(what, token);
  }
  /// Takes the next number as a coordinate. Errors: as parse_coordinate; kInvalidMesh - the text ends.
  double coordinate() {
    const std::string_view token = next();
    if (token.empty()) throw expected("a coordinate", token);
    return parse_coordinate(token, place());
  }
  /// Takes the next three numbers as the coordinates of a point.
  Vec3 point() {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = coordinate();
    return p;
  }

  /// Goes to the next line, and leaves the rest of the current one out.
  /// Output: false at the end of the text.
  bool next_line();
  /// The part of the current line that was not taken yet.
  std::string_view rest_of_line() const { return rest_; }
  /// The comment in the current line, without the character with which it begins.
  std::string_view comment() const { return comment_text_; }
  Place place() const { return Place::line(lines_.number()); }
  std::size_t offset() const { return lines_.offset(); }

  /// Makes the error "a number of vertices was expected, found ...". Throw it.
  Error expected(const char* what, std::string_view found) const;

 private:
  TextLines lines_;
  std::string_view rest_;
  std::string_view comment_text_;
  char comment_;
};

}  // namespace remesh
