#include "server/http/gate.h"

#include <algorithm>
#include <array>

#include "api/quoting.h"
#include "server/http/chunked_decoder.h"

namespace remesh::server {
namespace {

/// The number of bytes of a body that are read at once. The system writes large pieces to a file faster than small
/// ones: with 64 KiB, an upload of 39 MB takes 50 % longer.
constexpr std::size_t kReadSize = 256 << 10;
/// The first reservation for a body of unknown length.
constexpr std::size_t kReserveStep = 1 << 20;

/// Receives the bytes of a head.
/// Output: empty if the client left or sent nothing in time.
/// Input: `method` - set as soon as it is known, because a refusal has no body if the method is HEAD (RFC 9110,
///        section 9.3.2).
std::string receive_head(Connection& connection, const GateLimits& limits, std::string& method) {
  const Clock::time_point deadline = Clock::now() + limits.head_timeout;
  std::array<char, 8 << 10> buffer;
  std::string bytes;
  std::size_t checked = 0;
  for (;;) {
    std::size_t got = 0;
    try {
      got = connection.read_some(buffer.data(), buffer.size(), deadline);
    } catch (const ReadTimeout&) {
      if (bytes.empty()) return {};
      throw HttpError(408, "request_timeout", "the request head took too long");
    }
    if (got == 0) {
      if (bytes.empty()) return {};
      throw HttpError(400, "malformed_request", "the request head ends early");
    }
    bytes.append(buffer.data(), got);
    if (method.empty()) method = method_of(bytes);
    if (const auto end = find_head_end(bytes, checked, limits.head)) {
      connection.put_back(std::string_view(bytes).substr(*end));
      bytes.resize(*end);
      return bytes;
    }
  }
}

/// Reads a body that is delimited by a length or by chunks.
class BodyReader {
 public:
  BodyReader(Connection& connection, const GateLimits& limits, const Reserve& reserve)
      : connection_(connection), reserve_(reserve), pace_{limits.head_timeout, limits.min_body_rate} {}

  void read_length(std::uint64_t length, Body& body) {
    while (body.size() < length) {
      reserve_next(body.size(), length);
      const std::size_t want = static_cast<std::size_t>(std::min<std::uint64_t>(kReadSize, length - body.size()));
      body.append({buffer_.data(), read(want, body.size())});
    }
  }

  void read_chunked(std::uint64_t max_body, Body& body) {
    ChunkedDecoder decoder(max_body);
    std::string piece;
    while (!decoder.is_done()) {
      reserve_next(body.size(), max_body);
      const std::size_t got = read(kReadSize, body.size());
      piece.clear();
      const std::string_view bytes(buffer_.data(), got);
      connection_.put_back(bytes.substr(decoder.decode(bytes, piece)));
      body.append(piece);
    }
  }

 private:
  /// Reserves memory for the next reads in few, growing steps, so that a slow client never reserves much more than it
  /// uses.
  void reserve_next(std::size_t received, std::uint64_t most) {
    if (received + kReadSize <= reserved_ || reserved_ == most) return;
    reserved_ = std::min<std::uint64_t>(received + std::max(kReserveStep, received / 4), most);
    const Clock::time_point asked = Clock::now();
    reserve_(reserved_, reserved_);
    start_ += Clock::now() - asked;  // the client has its full time, however long the daemon waits for memory
  }

  std::size_t read(std::size_t want, std::uint64_t received) {
    std::size_t got = 0;
    try {
      got = connection_.read_some(buffer_.data(), want, pace_.deadline(start_, received));
    } catch (const ReadTimeout&) {
      throw HttpError(408, "request_timeout", "the body arrives too slowly").with_limit(pace_.min_rate);
    }
    if (got == 0) throw HttpError(400, "malformed_request", "the body ends early");
    return got;
  }

  Connection& connection_;
  const Reserve& reserve_;
  std::uint64_t reserved_ = 0;
  Pace pace_;
  Clock::time_point start_ = Clock::now();
  std::array<char, kReadSize> buffer_;
};

bool is_continue_expected(const RequestHead& head) {
  return head.minor_version >= 1 && api::ascii_lower(head.header("expect")) == "100-continue";
}

}  // namespace

std::optional<Framing> read_head(Connection& connection, const GateLimits& limits, RequestHead& head) {
  head = {};
  const std::string bytes = receive_head(connection, limits, head.method);
  if (bytes.empty()) return std::nullopt;
  parse_head(bytes, limits.head, head);
  return framing(head);
}

Body read_body(Connection& connection, const GateLimits& limits, const RequestHead& head, const Framing& framing,
               std::uint64_t max_body, const Reserve& reserve) {
  const auto [kind, length] = framing;
  if (kind == Framing::Kind::kNone || (kind == Framing::Kind::kLength && length == 0)) return {};
  if (kind == Framing::Kind::kLength && length > max_body) {
    throw body_too_large(max_body);
  }
  // Asks for room for the whole body before the client sends it.
  if (kind == Framing::Kind::kLength) reserve(0, length);

  if (!connection.has_unread_input() && is_continue_expected(head)) {
    connection.write_all("HTTP/1.1 100 Continue\r\n\r\n", {limits.head_timeout, limits.min_body_rate});
  }
  BodyReader reader(connection, limits, reserve);
  Body body;
  if (kind == Framing::Kind::kLength) {
    reader.read_length(length, body);
  } else {
    reader.read_chunked(max_body, body);
  }
  reserve(body.size(), body.size());  // at the end, the reservation becomes exact
  body.seal();
  return body;
}

}  // namespace remesh::server
