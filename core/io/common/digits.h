/// Reads whole numbers of up to eight digits at once.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/io/common/number_parsing.h"

namespace remesh {

/// Reads the digits at the beginning of [at, end), at most eight.
/// Output: the number of digits read. `value` is 0 if there are none.
/// Source: Lemire, Langdale, "Number parsing at a gigabyte per second", 2021, section 3 (eight digits in one word).
inline int read_digits(const char* at, const char* end, std::int32_t& value) {
  constexpr std::uint64_t kZeros = 0x3030303030303030;
  constexpr std::uint64_t kHighBits = 0x8080808080808080;
  value = 0;
  if (std::endian::native != std::endian::little || end - at < 8) {
    int digits = 0;
    for (; digits < 8 && at != end && is_digit(*at); ++at, ++digits) value = 10 * value + (*at - '0');
    return digits;
  }
  // All eight bytes are put into one word, the first one lowest. Below, each byte that is no digit gets its high bit
  // set.
  std::uint64_t word = 0;
  std::memcpy(&word, at, sizeof word);
  word ^= kZeros;
  const std::uint64_t others = (word | (word + 0x7676767676767676)) & kHighBits;
  const int digits = std::countr_zero(others) / 8;
  if (digits == 0) return 0;
  // The shift puts zeros in front of the digits. Then pairs, fours and finally eight of them are combined at once.
  word <<= 64 - 8 * digits;
  word = (word * 10 + (word >> 8)) & 0x00ff00ff00ff00ff;
  word = (word * 100 + (word >> 16)) & 0x0000ffff0000ffff;
  word = word * 10000 + (word >> 32);
  value = static_cast<std::int32_t>(word & 0xffffffff);
  return digits;
}

}  // namespace remesh
