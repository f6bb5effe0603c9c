#include "tests/mutate/byte_mutations.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

namespace remesh::mutate {
namespace {

std::size_t below(std::size_t n, Random& random) { return n == 0 ? 0 : static_cast<std::size_t>(random.bits() % n); }

std::string text_of(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

/// A piece of the bytes: [begin, begin + length).
struct Piece {
  std::size_t begin = 0;
  std::size_t length = 0;
};

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.' || c == 'e' || c == 'E'; }

/// Returns the first number at or after a random place.
std::optional<Piece> random_number(const std::string& bytes, Random& random) {
  std::size_t at = below(bytes.size(), random);
  const auto has_digit = [&](std::size_t i) { return bytes[i] >= '0' && bytes[i] <= '9'; };
  while (at < bytes.size() && !has_digit(at)) ++at;
  if (at == bytes.size()) return std::nullopt;
  std::size_t begin = at, end = at;
  while (begin > 0 && is_of_number(bytes[begin - 1])) --begin;
  while (end < bytes.size() && is_of_number(bytes[end])) ++end;
  return Piece{begin, end - begin};
}

/// Returns a random line with its end.
Piece random_line(const std::string& bytes, Random& random) {
  const std::size_t at = below(bytes.size(), random);
  const std::size_t before = at == 0 ? std::string::npos : bytes.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t end = std::min(bytes.find('\n', begin), bytes.size() - 1) + 1;
  return {begin, end - begin};
}

void flip_bits(std::string& bytes, Random& random) {
  const int flips = 1 << random.below(4);
  for (int i = 0; i < flips; ++i) {
    char& byte = bytes[below(bytes.size(), random)];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1u << random.below(8)));
  }
}

void change_byte(std::string& bytes, Random& random) {
  bytes[below(bytes.size(), random)] = static_cast<char>(random.below(256));
}

void insert_bytes(std::string& bytes, Random& random) {
  const std::string some(static_cast<std::size_t>(random.integer(1, 5)), static_cast<char>(random.below(256)));
  bytes.insert(below(bytes.size(), random), some);
}

void remove_bytes(std::string& bytes, Random& random) {
  const int count = is_text(bytes) ? random.integer(1, 3) : random.integer(1, 50);
  bytes.erase(below(bytes.size(), random), static_cast<std::size_t>(count));
}

void truncate(std::string& bytes, Random& random) { bytes.resize(below(bytes.size(), random)); }

void repeat_piece(std::string& bytes, Random& random) {
  const std::size_t begin = below(bytes.size(), random);
  bytes.insert(below(bytes.size(), random), bytes.substr(begin, below(200, random)));
}

void replace_number(std::string& bytes, Random& random) {
  if (const auto piece = random_number(bytes, random)) bytes.replace(piece->begin, piece->length, odd_number(random));
}

void copy_number(std::string& bytes, Random& random) {
  const auto from = random_number(bytes, random), to = random_number(bytes, random);
  if (from && to) bytes.replace(to->begin, to->length, bytes.substr(from->begin, from->length));
}

void change_last_digits(std::string& bytes, Random& random) {
  const auto piece = random_number(bytes, random);
  if (!piece) return;
  const std::size_t count = std::min<std::size_t>(piece->length, static_cast<std::size_t>(random.integer(1, 3)));
  for (std::size_t i = 0; i < count; ++i) {
    char& c = bytes[piece->begin + piece->length - 1 - i];
    if (c >= '0' && c <= '9') c = static_cast<char>('0' + random.below(10));
  }
}

void scale_number(std::string& bytes, Random& random) {
  const auto piece = random_number(bytes, random);
  if (!piece) return;
  double value = 0;
  const char* begin = bytes.data() + piece->begin;
  if (std::from_chars(begin, begin + piece->length, value).ec != std::errc()) return;
  value *= std::pow(10.0, random.integer(-12, 12)) * (random.chance(0.2) ? -1 : 1);
  bytes.replace(piece->begin, piece->length, text_of(value));
}

void change_index(std::string& bytes, Random& random) {
  const auto piece = random_number(bytes, random);
  if (!piece) return;
  long value = 0;
  const char* begin = bytes.data() + piece->begin;
  if (std::from_chars(begin, begin + piece->length, value).ec != std::errc()) return;
  bytes.replace(piece->begin, piece->length, std::to_string(value % 1'000'000 + random.integer(-3, 3)));
}

void drop_line(std::string& bytes, Random& random) {
  const Piece line = random_line(bytes, random);
  bytes.erase(line.begin, line.length);
}

void double_line(std::string& bytes, Random& random) {
  const Piece line = random_line(bytes, random);
  bytes.insert(line.begin, bytes.substr(line.begin, line.length));
}

void swap_lines(std::string& bytes, Random& random) {
  Piece a = random_line(bytes, random), b = random_line(bytes, random);
  if (a.begin > b.begin) std::swap(a, b);
  if (a.begin == b.begin) return;
  const std::string first = bytes.substr(a.begin, a.length), second = bytes.substr(b.begin, b.length);
  bytes.replace(b.begin, b.length, first);
  bytes.replace(a.begin, a.length, second);
}

void overwrite_float(std::string& bytes, Random& random) {
  // Binary STL has its numbers at 84 + 50 i + 4 j, where j = 0 to 2 are the normal.
  if (bytes.size() < 84 + 50) return;
  const std::size_t at = 84 + 50 * below((bytes.size() - 84) / 50, random) + 12 + 4 * below(9, random);
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  switch (random.below(7)) {
    case 0: value = 0; break;
    case 1: value = -value; break;
    case 2: value *= static_cast<float>(std::pow(10.0, random.integer(-10, 10))); break;
    case 3: value = std::nextafter(value, random.chance(0.5) ? 1e30f : -1e30f); break;
    case 4: value = std::numeric_limits<float>::quiet_NaN(); break;
    case 5:
      value = random.chance(0.5) ? std::numeric_limits<float>::max() : std::numeric_limits<float>::denorm_min();
      break;
    default: {
      const std::size_t from = 84 + 50 * below((bytes.size() - 84) / 50, random) + 12 + 4 * below(9, random);
      std::memcpy(&value, bytes.data() + from, sizeof value);
    }
  }
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void overwrite_word(std::string& bytes, Random& random) {
  constexpr std::array<std::uint32_t, 6> kWords{0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7f800000};
  if (bytes.size() < 8) return;
  const std::size_t at = below(bytes.size() / 4 - 1, random) * 4;
  std::memcpy(bytes.data() + at, &kWords[below(kWords.size(), random)], 4);
}

using Change = void (*)(std::string&, Random&);
struct NamedChange {
  std::string_view words;
  Change change;
};

// Some changes are listed more than once, so that they are made more often.
constexpr std::array<NamedChange, 17> kOfText{{{"bits flipped", flip_bits},
                                               {"byte changed", change_byte},
                                               {"bytes inserted", insert_bytes},
                                               {"bytes removed", remove_bytes},
                                               {"piece repeated", repeat_piece},
                                               {"truncated", truncate},
                                               {"number replaced", replace_number},
                                               {"number replaced", replace_number},
                                               {"number copied", copy_number},
                                               {"number copied", copy_number},
                                               {"last digits changed", change_last_digits},
                                               {"last digits changed", change_last_digits},
                                               {"number scaled", scale_number},
                                               {"index changed", change_index},
                                               {"line dropped", drop_line},
                                               {"line doubled", double_line},
                                               {"lines swapped", swap_lines}}};
constexpr std::array<NamedChange, 9> kOfBinary{{{"bits flipped", flip_bits},
                                                {"byte changed", change_byte},
                                                {"bytes removed", remove_bytes},
                                                {"piece repeated", repeat_piece},
                                                {"truncated", truncate},
                                                {"word overwritten", overwrite_word},
                                                {"float overwritten", overwrite_float},
                                                {"float overwritten", overwrite_float},
                                                {"float overwritten", overwrite_float}}};

}  // namespace

bool is_text(const std::string& bytes) {
  const std::string_view start = std::string_view(bytes).substr(0, 2000);
  return start.find('\0') == std::string_view::npos;
}

std::string odd_number(Random& random) {
  constexpr std::array<std::string_view, 22> kNumbers{
      "0",      "-0",   "0.0",  "1",   "-1",  "1e300", "-1e300", "1e150",      "1e-300",     "5e-324", "1e-30",
      "3.4e38", "1e39", "1e22", "nan", "inf", "1e400", "1e9",    "2147483648", "4294967296", "1e-9",   "0.1"};
  if (random.chance(0.6)) return std::string(kNumbers[below(kNumbers.size(), random)]);
  if (random.chance(0.5)) return (random.chance(0.5) ? "1e" : "-1e") + std::to_string(random.integer(-30, 30));
  return text_of(random.uniform(-1, 1) * std::pow(10.0, random.integer(-6, 6)));
}

std::string mutate_bytes(std::string& bytes, Random& random) {
  if (bytes.empty()) return "nothing";
  const NamedChange& change =
      is_text(bytes) ? kOfText[below(kOfText.size(), random)] : kOfBinary[below(kOfBinary.size(), random)];
  change.change(bytes, random);
  return std::string(change.words);
}

}  // namespace remesh::mutate
