/// Small pieces of text for messages, headers and documents.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "core/io/text.h"

namespace remesh::api {

/// The shortest text that reads back to the same number.
inline std::string number_text(double value) {
  std::string text;
  append_real(text, value);
  return text;
}
inline std::string number_text(std::uint64_t value) {
  std::string text;
  append_integer(text, value);
  return text;
}

/// What a caller sent, short enough for a message.
inline std::string shortened(std::string_view text, std::size_t longest = 64) {
  return text.size() <= longest ? std::string(text) : std::string(text.substr(0, longest)) + "...";
}
/// With quotes around it. A NUL, at which what() of an exception would end, is shown as JSON escapes it.
inline std::string in_quotes(std::string_view text) {
  std::string quoted = '"' + shortened(text) + '"';
  for (std::size_t at = 0; (at = quoted.find('\0', at)) != std::string::npos;) quoted.replace(at, 1, "\\u0000");
  return quoted;
}

/// Lower case as ASCII, whatever the locale.
inline std::string ascii_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

/// Parts `text` at the first `separator`: what is before and after it; nothing after where there is none.
inline std::pair<std::string_view, std::string_view> cut(std::string_view text, char separator) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

}  // namespace remesh::api
