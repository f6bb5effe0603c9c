#include "server/http/chunked_decoder.h"

#include <algorithm>

#include "server/http/hex.h"
#include "server/http/http_message.h"

namespace remesh::server {
namespace {

constexpr std::size_t kMaxSizeDigits = 16;
constexpr std::size_t kMaxExtension = 256;
constexpr std::size_t kMaxTrailers = 8 << 10;

[[noreturn]] void malformed(const std::string& detail) { throw HttpError(400, "malformed_request", detail); }

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }

}  // namespace

std::size_t ChunkedDecoder::decode(std::string_view bytes, std::string& body) {
  std::size_t used = 0;
  while (used < bytes.size() && state_ != State::kDone) {
    if (state_ != State::kData) {
      take(bytes[used++]);
      continue;
    }
    const std::size_t part = static_cast<std::size_t>(std::min<std::uint64_t>(left_, bytes.size() - used));
    body.append(bytes.substr(used, part));
    used += part;
    left_ -= part;
    if (left_ == 0) state_ = State::kDataEnd;
  }
  return used;
}

void ChunkedDecoder::take(char c) {
  switch (state_) {
    case State::kSize:
      if (const int digit = hex_digit(c); digit >= 0) {
        if (++digits_ > kMaxSizeDigits) malformed("a chunk size of too many digits");
        left_ = left_ * 16 + static_cast<std::uint64_t>(digit);
        return;
      }
      if (digits_ == 0) malformed("a chunk without a size");
      if (c == ';') {
        overhead_ = 0;
        state_ = State::kExtension;
      } else if (c == '\r') {
        state_ = State::kSizeEnd;
      } else {
        malformed("a chunk size that is not a hexadecimal number");
      }
      return;
    case State::kExtension:
      if (c == '\r') {
        state_ = State::kSizeEnd;
      } else if (is_control(c) || ++overhead_ > kMaxExtension) {
        malformed("a malformed or overlong chunk extension");
      }
      return;
    case State::kSizeEnd:
      if (c != '\n') malformed("a chunk size line that does not end in CRLF");
      end_size_line();
      return;
    case State::kDataEnd:
      if (c != '\r') malformed("a chunk longer than its size");
      state_ = State::kDataLineFeed;
      return;
    case State::kDataLineFeed:
      if (c != '\n') malformed("a chunk that does not end in CRLF");
      state_ = State::kSize;
      return;
    case State::kTrailer:
      if (++overhead_ > kMaxTrailers) malformed("overlong trailers");
      if (c == '\r') {
        state_ = State::kTrailerLineFeed;
      } else if (is_control(c)) {
        malformed("a control character in a trailer");
      } else {
        ++trailer_line_;
      }
      return;
    case State::kTrailerLineFeed:
      if (c != '\n') malformed("a trailer line that does not end in CRLF");
      state_ = trailer_line_ == 0 ? State::kDone : State::kTrailer;
      trailer_line_ = 0;
      return;
    case State::kData:
    case State::kDone: return;
  }
}

void ChunkedDecoder::end_size_line() {
  digits_ = 0;
  if (left_ == 0) {
    overhead_ = 0;
    state_ = State::kTrailer;
    return;
  }
  if (left_ > max_body_ - decoded_) {
    throw body_too_large(max_body_);
  }
  decoded_ += left_;
  state_ = State::kData;
}

}  // namespace remesh::server
