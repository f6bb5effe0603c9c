#include "core/io/common/number_parsing.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace remesh {
namespace {

/// For a decimal number that no double represents, true if it is too small and not too large. Such numbers are
/// hundreds of powers of ten away from 1, so it is enough to know the power of the first significant digit to within
/// one.
bool is_underflow(std::string_view number) {
  const std::size_t exponent_mark = number.find_first_of("eE");
  const std::string_view mantissa = number.substr(0, exponent_mark);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t leading = mantissa.find_first_of("123456789");
  const std::int64_t power = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(leading);
  if (exponent_mark == std::string_view::npos) return power < 0;

  std::string_view digits = number.substr(exponent_mark + 1);
  if (digits.front() == '+') digits.remove_prefix(1);
  std::int64_t exponent = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  if (read.ec == std::errc::result_out_of_range) return digits.front() == '-';
  // Neither side can overflow, because |power| is less than the length of the text.
  return exponent < -power;
}

/// True for the text that older C libraries of Microsoft print after `1.` for values that are not finite.
bool is_nonfinite_suffix(std::string_view text) {
  return text.starts_with("#INF") || text.starts_with("#IND") || text.starts_with("#QNAN") || text.starts_with("#SNAN");
}

}  // namespace

std::string_view without_padding(std::string_view text) {
  constexpr std::string_view kPadding("\0\x1a", 2);
  return text.substr(0, text.find_last_not_of(kPadding) + 1);
}

std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto is_tail = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return is_tail(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const bool is_overlong = lead == 0xE0 && byte(1) < 0xA0;
    const bool is_surrogate = lead == 0xED && byte(1) >= 0xA0;
    return is_tail(1) && is_tail(2) && !is_overlong && !is_surrogate ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const bool is_overlong = lead == 0xF0 && byte(1) < 0x90;
    const bool is_too_large = lead == 0xF4 && byte(1) >= 0x90;
    return is_tail(1) && is_tail(2) && is_tail(3) && !is_overlong && !is_too_large ? 4 : 0;
  }
  return 0;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

Real parse_real(std::string_view token) {
  if (token.starts_with('+')) {
    token.remove_prefix(1);
    if (token.starts_with('-')) return {0, RealFault::kNotANumber};
  }
  const char* const end = token.data() + token.size();
  double value = 0;
  const auto [stop, status] = std::from_chars(token.data(), end, value);
  if (status == std::errc::invalid_argument) return {0, RealFault::kNotANumber};
  if (stop != end) {
    const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
    return {0, is_nonfinite_suffix(rest) ? RealFault::kNotFinite : RealFault::kNotANumber};
  }
  if (status == std::errc::result_out_of_range) {
    // In both cases from_chars does not change the value.
    if (!is_underflow(token)) return {0, RealFault::kNotFinite};
    return {token.front() == '-' ? -0.0 : 0.0, RealFault::kNone};
  }
  if (!std::isfinite(value)) return {0, RealFault::kNotFinite};
  return {value, RealFault::kNone};
}

void append_real(std::string& out, double value) {
  char digits[32];  // the longest text has 24 characters: -2.2250738585072014e-308
  const auto written = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, written.ptr);
}

void append_integer(std::string& out, std::uint64_t value) {
  char digits[20];
  const auto written = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, written.ptr);
}

}  // namespace remesh
