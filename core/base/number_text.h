/// Numbers in messages for people.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace remesh {

/// Returns a number with at most so many significant digits. It does not depend on the locale.
inline std::string number_text(double value, int digits = 6) {
  std::array<char, 32> text{};
  char* const end = text.data() + text.size();
  return {text.data(), std::to_chars(text.data(), end, value, std::chars_format::general, digits).ptr};
}

/// Returns the shortest text that reads back to the same number. It does not depend on the locale.
inline std::string shortest_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace remesh
