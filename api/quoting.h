/// Small functions on text for messages, headers and documents.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "core/io/common/number_parsing.h"

namespace remesh::api {

/// Shortens text that a caller sent, so that it fits into a message.
inline std::string shortened(std::string_view text, std::size_t longest = 64) {
  return text.size() <= longest ? std::string(text) : std::string(text.substr(0, longest)) + "...";
}
/// Shortens text and puts it in quotes. A NUL is shown as in JSON, because what() of an exception would end there.
inline std::string in_quotes(std::string_view text) {
  std::string quoted = '"' + shortened(text) + '"';
  for (std::size_t at = 0; (at = quoted.find('\0', at)) != std::string::npos;) quoted.replace(at, 1, "\\u0000");
  return quoted;
}

/// Converts ASCII letters to lower case, independently of the locale.
inline std::string ascii_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = to_lower(c);
  return lower;
}

/// Replaces all characters but letters, digits and the given signs by % and two hexadecimal digits for each byte.
inline std::string percent_encoded(std::string_view text, std::string_view signs) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = is_letter(c) || is_digit(c) || signs.find(c) != std::string_view::npos;
    is_plain ? encoded.append(1, c) : encoded.append({'%', kDigits[byte / 16], kDigits[byte % 16]});
  }
  return encoded;
}

/// Splits `text` at the first `separator` into the parts before and after it. Without a separator the second part is
/// empty.
inline std::pair<std::string_view, std::string_view> cut(std::string_view text, char separator) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

}  // namespace remesh::api
