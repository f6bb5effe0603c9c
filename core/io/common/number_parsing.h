/// Tokens and numbers in the text formats of meshes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace remesh {

/// True for the characters that separate tokens within a line: space, tab, vertical tab and form feed.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// True for the characters that occur in no text file, and for line ends: everything below the space that is no
/// blank, and DEL. Bytes from 0x80 on count as text in any encoding, because names and comments may have any.
constexpr bool is_control_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && !is_blank(c)) || byte == 0x7f;
}

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }
// These functions replace those of <cctype>, because formats must not depend on a locale.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// True if `text` is `lower_case` but for capital letters.
constexpr bool equals_ignoring_case(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](char c, char lower) { return to_lower(c) == lower; });
}

/// Returns `text` without the blanks at both ends.
std::string_view trim(std::string_view text);

/// Removes the first token from `rest` and returns it.
/// Output: empty at the end of the line.
inline std::string_view next_token(std::string_view& rest) {
  const char* at = rest.data();
  const char* const end = at + rest.size();
  while (at != end && is_blank(*at)) ++at;
  const char* const begin = at;
  while (at != end && !is_blank(*at)) ++at;
  rest = {at, static_cast<std::size_t>(end - at)};
  return {begin, static_cast<std::size_t>(at - begin)};
}

/// The length of the UTF-8 sequence at the beginning of `text`.
/// Output: 0 if there is no valid one.
std::size_t utf8_length(std::string_view text);

enum class RealFault {
  kNone,
  kNotANumber,
  kNotFinite,  ///< infinite, "not a number" by name, or beyond the largest double
};

struct Real {
  double value = 0;
  RealFault fault = RealFault::kNone;
};

/// Converts a decimal number to the nearest double, with ties to even.
/// Input: a whole token: digits with or without a point, a sign (`+` too) and an exponent. `inf` and `nan` in all
///        their spellings, including `1.#INF`, are recognised as not finite.
/// Holds: a number that is too small for a double becomes zero with its sign.
/// Cost:  O(length).
Real parse_real(std::string_view token);

/// Returns `text` without its padding: NUL bytes at its end, and Ctrl-Z, by which DOS marked the end of a text.
std::string_view without_padding(std::string_view text);

/// Appends the shortest text that reads back to the same double.
void append_real(std::string& out, double value);
/// Appends a decimal integer.
void append_integer(std::string& out, std::uint64_t value);

}  // namespace remesh
