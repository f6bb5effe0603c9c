/// How readers say what is wrong, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/error.h"

namespace remesh {

/// Where a reader is: a line of text, from 1, or a byte of binary data, from 0.
struct Place {
  enum class Kind { kLine, kByte } kind;
  std::uint64_t value;

  static Place line(std::uint64_t number) { return {Kind::kLine, number}; }
  static Place byte(std::uint64_t offset) { return {Kind::kByte, offset}; }
};

/// An error of reading, located. Throw it.
inline Error read_error(Place place, Code code, const std::string& message) {
  Error error(code, Stage::kRead, message);
  place.kind == Place::Kind::kLine ? error.at_line(place.value) : error.at_byte(place.value);
  return error;
}

/// "more vertices than the 10 allowed". Throw it.
inline Error too_large_error(Place place, std::string_view what, std::uint64_t limit) {
  return read_error(place, Code::kMeshTooLarge,
                    "more " + std::string(what) + " than the " + std::to_string(limit) + " allowed")
      .with_limit(limit);
}

/// Binary data that ends before what it announces. Throw it.
inline Error truncated_error(std::uint64_t end_of_data, const std::string& what) {
  return read_error(Place::byte(end_of_data), Code::kInvalidMesh, "the data ends early: " + what);
}

/// What a text cites in a message, short and on one line.
std::string cited(std::string_view text);

/// Takes note of bytes behind the last record of binary data: fewer than a record, or nothing but zeros, as padding.
/// Errors: kInvalidMesh, with the byte - more than that: then the counts of the file do not fit what is in it.
void note_trailing_bytes(std::string_view content, std::size_t end_of_records, std::size_t record_size,
                         std::vector<Diagnostic>& diagnostics);

/// Takes note of what pads a text (without_padding).
void note_padding(std::string_view text, std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
