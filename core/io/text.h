/// Tokens and numbers, as the text formats of meshes write them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace remesh {

/// Space, tab, vertical tab and form feed: what parts tokens within a line.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// What no text file holds, but for its line ends: everything below the space that is no blank, and DEL.
/// Bytes from 0x80 are text, whatever the encoding: names and comments may be in any.
constexpr bool is_control_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && !is_blank(c)) || byte == 0x7f;
}

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }
// Not <cctype>: formats do not depend on a locale.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// `text` without the blanks at both ends.
std::string_view trim(std::string_view text);

/// Cuts the first token off `rest` and returns it; empty at the end of the line.
inline std::string_view next_token(std::string_view& rest) {
  const char* at = rest.data();
  const char* const end = at + rest.size();
  while (at != end && is_blank(*at)) ++at;
  const char* const begin = at;
  while (at != end && !is_blank(*at)) ++at;
  rest = {at, static_cast<std::size_t>(end - at)};
  return {begin, static_cast<std::size_t>(at - begin)};
}

/// The length of the UTF-8 sequence that `text` begins with; 0 if it begins with none.
std::size_t utf8_length(std::string_view text);

enum class RealFault {
  kNone,
  kNotANumber,
  kNotFinite,  ///< infinite, "not a number" by name, or past the largest double
};

struct Real {
  double value = 0;
  RealFault fault = RealFault::kNone;
};

/// The double nearest to a decimal number, ties to even.
/// Input: a whole token: digits with or without a point, sign (`+` too) and exponent; `inf` and `nan` in any of their
///        spellings, `1.#INF` among them, are known and not finite.
/// Holds: what is below the smallest double is zero, with its sign.
/// Cost:  O(length).
Real parse_real(std::string_view token);

/// Appends the shortest text that reads back to the same double.
void append_real(std::string& out, double value);
/// Appends a decimal integer.
void append_integer(std::string& out, std::uint64_t value);

}  // namespace remesh
