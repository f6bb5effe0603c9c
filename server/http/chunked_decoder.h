/// A strict decoder of the chunked transfer coding (RFC 9112, section 7.1), which decodes bytes as they arrive and
/// limits their number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace remesh::server {

class ChunkedDecoder {
 public:
  explicit ChunkedDecoder(std::uint64_t max_body) : max_body_(max_body) {}

  /// Decodes the bytes that have arrived and appends the data to `body`. Bytes after the end of the body are not
  /// touched.
  /// Output:  the number of bytes that belonged to this body.
  /// Errors:  HttpError 400 - a malformed chunk or trailer; 413 - the body is larger than the limit, which is thrown
  ///          as soon as a chunk's size shows it.
  std::size_t decode(std::string_view bytes, std::string& body);

  bool is_done() const { return state_ == State::kDone; }

 private:
  enum class State { kSize, kExtension, kSizeEnd, kData, kDataEnd, kDataLineFeed, kTrailer, kTrailerLineFeed, kDone };

  void take(char c);
  void end_size_line();

  std::uint64_t max_body_;
  std::uint64_t decoded_ = 0;  ///< body bytes announced by the chunks so far
  std::uint64_t left_ = 0;     ///< bytes of the current chunk that are missing; while its size is read, the size so far
  std::size_t digits_ = 0;
  std::size_t overhead_ = 0;  ///< bytes of the current chunk's extension, or of all trailers
  std::size_t trailer_line_ = 0;
  State state_ = State::kSize;
};

}  // namespace remesh::server
