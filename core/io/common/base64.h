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

/// The values of the digits of a group of four, by their places; above 24 bits: no digit.
inline constexpr std::array<std::array<std::uint32_t, 256>, 4> kBase64Groups = [] {
  std::array<std::array<std::uint32_t, 256>, 4> groups{};
  for (std::size_t i = 0; i < groups.size(); ++i)
    for (std::size_t c = 0; c < 256; ++c)
      groups[i][c] = kBase64Values[c] < 0 ? 1u << 31 : static_cast<std::uint32_t>(kBase64Values[c]) << (18 - 6 * i);
  return groups;
}();

/// Decodes base64 up to a number of bytes, or to the end. After padding, the next four characters begin a new base64
/// text, because VTK encodes the header of an array separately from its values.
inline std::string from_base64(std::string_view text, std::uint64_t max_bytes) {
  // A group has three bytes, so the last one may have two more than are wanted.
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(max_bytes, text.size() / 4 * 3)) + 3, '\0');
  char* const out = bytes.data();
  std::size_t count = 0;
  std::uint32_t bits = 0;
  int digits = 0, padding = 0;
  for (std::size_t at = 0; at < text.size() && count < max_bytes; ++at) {
    // Most of the text is groups of four digits.
    for (; digits == 0 && at + 4 <= text.size() && count < max_bytes; at += 4, count += 3) {
      std::uint32_t all = 0;
      for (std::size_t i = 0; i < 4; ++i) all |= kBase64Groups[i][static_cast<unsigned char>(text[at + i])];
      if (all > 0xffffff) break;
      out[count] = static_cast<char>(all >> 16);
      out[count + 1] = static_cast<char>(all >> 8 & 255);
      out[count + 2] = static_cast<char>(all & 255);
    }
    if (at >= text.size() || count >= max_bytes) break;
    const char c = text[at];
    const std::int8_t value = kBase64Values[static_cast<unsigned char>(c)];
    if (value < 0 && c != '=') {
      if (is_blank(c) || is_line_end(c)) continue;
      break;
    }
    bits = bits << 6 | static_cast<std::uint32_t>(std::max<std::int8_t>(value, 0));
    padding += c == '=' ? 1 : 0;
    if (++digits < 4) continue;
    for (int i = 0; i < 3 - std::min(padding, 2); ++i) out[count++] = static_cast<char>(bits >> (16 - 8 * i) & 255);
    bits = 0;
    digits = padding = 0;
  }
  bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(count, max_bytes)));
  return bytes;
}

}  // namespace remesh
