/// Decodes base64.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/io/common/number_parsing.h"

namespace remesh {

/// The values of the digits of base64; -1: no digit.
inline constexpr std::array<std::int8_t, 256> kBase64Values = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::int8_t>(i);
  return values;
}();

/// Decodes base64 up to a number of bytes, or to the end. Behind padding, the next group of four begins a new text: VTK
/// packs the header of an array by itself.
inline std::string from_base64(std::string_view text, std::uint64_t max_bytes) {
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(max_bytes, text.size() / 4 * 3 + 3)));
  std::uint32_t bits = 0;
  int digits = 0, padding = 0;
  const auto value_of = [](char c) { return std::int32_t{kBase64Values[static_cast<unsigned char>(c)]}; };
  for (std::size_t at = 0; at < text.size() && bytes.size() < max_bytes; ++at) {
    // Most of the text is groups of four digits.
    for (; digits == 0 && at + 4 <= text.size() && bytes.size() < max_bytes; at += 4) {
      const char* const group = text.data() + at;
      const std::int32_t all =
          value_of(group[0]) << 18 | value_of(group[1]) << 12 | value_of(group[2]) << 6 | value_of(group[3]);
      if (all < 0) break;
      const std::array<char, 3> three{static_cast<char>(all >> 16), static_cast<char>(all >> 8 & 255),
                                      static_cast<char>(all & 255)};
      bytes.append(three.data(), three.size());
    }
    if (at >= text.size() || bytes.size() >= max_bytes) break;
    const char c = text[at];
    const std::int8_t value = kBase64Values[static_cast<unsigned char>(c)];
    if (value < 0 && c != '=') {
      if (is_blank(c) || is_line_end(c)) continue;
      break;
    }
    bits = bits << 6 | static_cast<std::uint32_t>(std::max<std::int8_t>(value, 0));
    padding += c == '=' ? 1 : 0;
    if (++digits < 4) continue;
    for (int i = 0; i < 3 - std::min(padding, 2); ++i) bytes += static_cast<char>(bits >> (16 - 8 * i) & 255);
    bits = 0;
    digits = padding = 0;
  }
  if (bytes.size() > max_bytes) bytes.resize(static_cast<std::size_t>(max_bytes));
  return bytes;
}

}  // namespace remesh
