#include "api/json_arrays.h"

#include <fast_float/fast_float.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <system_error>

#include "core/io/common/digits.h"
#include "core/io/common/number_parsing.h"

namespace remesh::api {
namespace {

class Scanner {
 public:
  Scanner(std::string_view text, std::size_t begin, RunControl& control)
      : begin_(text.data()), at_(begin_ + begin), end_(begin_ + text.size()), control_(control) {}

  /// Reads elements by `read_element` up to the closing bracket.
  /// Output: the position of that bracket.
  template <class ReadElement>
  std::size_t read_array(const ReadElement& read_element) {
    if (peek() != ']') {
      for (std::uint32_t count = 0;; ++count) {
        if (count % 4096 == 0)
          control_.progress(static_cast<double>(at_ - begin_) / static_cast<double>(end_ - begin_));
        read_element();
        if (peek() == ']') break;
        take(',');
      }
    }
    return static_cast<std::size_t>(at_ - begin_);
  }

  /// Skips blanks and returns the next character.
  char peek() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
    if (at_ == end_) throw NotPlain();
    return *at_;
  }

  void take(char c) {
    if (peek() != c) throw NotPlain();
    ++at_;
  }

  /// Reads a JSON number: its only sign is -, it has no leading zeros, and there are digits on both sides of its
  /// point.
  double take_number() {
    peek();
    const char* digits = at_ + (*at_ == '-');
    if (digits == end_ || !is_digit(*digits)) throw NotPlain();
    const char* point = digits + 1;
    while (point != end_ && is_digit(*point)) ++point;
    if (*digits == '0' && point != digits + 1) throw NotPlain();
    if (point != end_ && *point == '.' && (point + 1 == end_ || !is_digit(point[1]))) throw NotPlain();

    double value = 0;
    // This works like std::from_chars, but faster. A number that is too large gives an infinity, and one that is too
    // small gives 0.
    const auto [stop, status] = fast_float::from_chars(at_, end_, value);
    if (status != std::errc{} || !std::isfinite(value)) throw NotPlain();
    at_ = stop;
    return stop == point ? value + 0.0 : value;
  }

  std::uint32_t take_index() {
    peek();
    std::int32_t value = 0;
    const int digits = read_digits(at_, end_, value);
    if (digits == 0 || (digits > 1 && *at_ == '0')) throw NotPlain();
    at_ += digits;
    return static_cast<std::uint32_t>(value);
  }

 private:
  const char* const begin_;
  const char* at_;
  const char* const end_;
  RunControl& control_;
};

}  // namespace

std::size_t read_plain_vertices(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                                PolygonMesh* mesh) {
  Scanner scanner(text, begin, control);
  std::uint64_t vertices = 0;
  return scanner.read_array([&] {
    if (vertices++ >= limits.max_vertices) throw NotPlain();
    Vec3 position;
    scanner.take('[');
    position.x = scanner.take_number();
    scanner.take(',');
    position.y = scanner.take_number();
    scanner.take(',');
    position.z = scanner.take_number();
    scanner.take(']');
    if (mesh != nullptr) mesh->positions.push_back(position);
  });
}

std::size_t read_plain_faces(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                             PolygonMesh* mesh) {
  Scanner scanner(text, begin, control);
  std::uint64_t faces = 0;
  std::uint64_t corners = 0;
  return scanner.read_array([&] {
    if (faces++ >= limits.max_faces) throw NotPlain();
    const std::uint64_t first = corners;
    scanner.take('[');
    for (;;) {
      if (corners++ >= PolygonMesh::kMaxCorners) throw NotPlain();
      const std::uint32_t index = scanner.take_index();
      if (mesh != nullptr) mesh->corners.emplace_back(index);
      if (scanner.peek() == ']') break;
      scanner.take(',');
    }
    scanner.take(']');
    if (corners - first < 3) throw NotPlain();
    if (mesh != nullptr) mesh->face_begin.push_back(static_cast<std::uint32_t>(corners));
  });
}

}  // namespace remesh::api
