/// How readers report an error and its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/error.h"

namespace remesh {

/// The position of a reader: a line of text, from 1, or a byte of binary data, from 0.
struct Place {
  enum class Kind { kLine, kByte } kind;
  std::uint64_t value;

  static Place line(std::uint64_t number) { return {Kind::kLine, number}; }
  static Place byte(std::uint64_t offset) { return {Kind::kByte, offset}; }
};

/// Makes an error of reading with its place. Throw it.
inline Error read_error(Place place, Code code, const std::string& message) {
  Error error(code, Stage::kRead, message);
  place.kind == Place::Kind::kLine ? error.at_line(place.value) : error.at_byte(place.value);
  return error;
}

/// Makes the error "more vertices than the 10 allowed". Throw it.
inline Error too_large_error(Place place, std::string_view what, std::uint64_t limit) {
  return read_error(place, Code::kMeshTooLarge,
                    "more " + std::string(what) + " than the " + std::to_string(limit) + " allowed")
      .with_limit(limit);
}

/// Makes the error for binary data that ends before everything that it announces. Throw it.
inline Error truncated_error(std::uint64_t end_of_data, const std::string& what) {
  return read_error(Place::byte(end_of_data), Code::kInvalidMesh, "the data ends early: " + what);
}

/// Shortens text and puts it in quotes on one line, so that it can be cited in a message.
std::string cited(std::string_view text);

/// Adds a diagnostic with the text `what: count` for things in a file that are not read, if there are any.
void record_dropped(const std::string& what, std::uint64_t count, std::vector<Diagnostic>& diagnostics);

/// Reports bytes after the last record of binary data. There may be fewer than a record has, or only zeros as
/// padding.
/// Errors: kInvalidMesh, with the byte - there is more, so the counts of the file do not fit its content.
void record_trailing_bytes(std::string_view content, std::size_t end_of_records, std::size_t record_size,
                           std::vector<Diagnostic>& diagnostics);

/// Reports the padding of a text (see without_padding).
void record_padding(std::string_view text, std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
