/// Chunked transfer coding (RFC 9112, section 7.1), decoded as bytes arrive, strictly and with a cap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace remesh::server {

class ChunkedDecoder {
 public:
  explicit ChunkedDecoder(std::uint64_t max_body) : max_body_(max_body) {}

  /// Decodes what arrived and appends it to `body`; after the end, bytes are left alone.
  /// Output:  how many of the bytes belonged to this body.
  /// Errors:  HttpError 400 - a malformed chunk or trailer; 413 - the body passes the cap, as soon as a chunk's size
  ///          says so.
  std::size_t decode(std::string_view bytes, std::string& body);

  bool is_done() const { return state_ == State::kDone; }

 private:
  enum class State { kSize, kExtension, kSizeEnd, kData, kDataEnd, kDataLineFeed, kTrailer, kTrailerLineFeed, kDone };

  void take(char c);
  void end_size_line();

  std::uint64_t max_body_;
  std::uint64_t decoded_ = 0;  ///< body bytes announced by the chunks so far
  std::uint64_t left_ = 0;     ///< of the chunk at hand: its size while that is read, then what is missing
  std::size_t digits_ = 0;
  std::size_t overhead_ = 0;  ///< bytes of this extension or of all trailers
  std::size_t trailer_line_ = 0;
  State state_ = State::kSize;
};

}  // namespace remesh::server
