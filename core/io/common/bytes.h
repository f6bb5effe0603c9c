/// Reads and writes numbers in binary data. Data and machine may each have either byte order.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/io/common/read_errors.h"

namespace remesh {

enum class ByteOrder { kLittle, kBig };
inline constexpr ByteOrder kNativeOrder =
    std::endian::native == std::endian::little ? ByteOrder::kLittle : ByteOrder::kBig;

namespace detail {
template <std::size_t Size>
using UnsignedOfSize = std::conditional_t<
    Size == 1, std::uint8_t,
    std::conditional_t<Size == 2, std::uint16_t, std::conditional_t<Size == 4, std::uint32_t, std::uint64_t>>>;
}  // namespace detail

/// Reads a number of type T from the first bytes at `data`.
template <class T>
T load(const char* data, ByteOrder order) {
  using Bits = detail::UnsignedOfSize<sizeof(T)>;
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t shift = 8 * (order == ByteOrder::kLittle ? i : sizeof(T) - 1 - i);
    bits = static_cast<Bits>(bits | static_cast<Bits>(static_cast<Bits>(static_cast<unsigned char>(data[i])) << shift));
  }
  return std::bit_cast<T>(bits);
}

/// Reads so many numbers of type T, which stand one behind the other from `data` on, and gives each to `use` with its
/// place.
template <class T, class Use>
void load_all(const char* data, ByteOrder order, std::size_t count, const Use& use) {
  // Each loop has its order fixed, so that the compiler can read many numbers at once.
  if (order == ByteOrder::kLittle) {
    for (std::size_t i = 0; i < count; ++i) use(i, load<T>(data + i * sizeof(T), ByteOrder::kLittle));
  } else {
    for (std::size_t i = 0; i < count; ++i) use(i, load<T>(data + i * sizeof(T), ByteOrder::kBig));
  }
}

/// Appends a number, least significant byte first.
template <class T>
void append_little_endian(std::string& out, T value) {
  const auto bits = std::bit_cast<detail::UnsignedOfSize<sizeof(T)>>(value);
  char bytes[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<char>(bits >> (8 * i) & 0xff);
  out.append(bytes, sizeof(T));
}

/// Reads binary data sequentially.
class ByteReader {
 public:
  ByteReader(std::string_view content, std::size_t offset, ByteOrder order)
      : content_(content), offset_(offset), order_(order) {}

  /// Reads the next number.
  /// Errors: kInvalidMesh, with the byte - the data ends too early.
  template <class T>
  T take() {
    if (left() < sizeof(T)) throw truncated();
    const T value = load<T>(content_.data() + offset_, order_);
    offset_ += sizeof(T);
    return value;
  }
  /// Skips bytes.
  /// Errors: as take.
  void skip(std::uint64_t bytes) {
    if (left() < bytes) throw truncated();
    offset_ += static_cast<std::size_t>(bytes);
  }

  std::size_t offset() const { return offset_; }
  std::size_t left() const { return content_.size() - offset_; }
  Place place() const { return Place::byte(offset_); }

 private:
  Error truncated() const {
    return truncated_error(content_.size(), "inside the record from byte " + std::to_string(offset_));
  }

  std::string_view content_;
  std::size_t offset_;
  ByteOrder order_;
};

}  // namespace remesh
