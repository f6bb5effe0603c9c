#include "server/http/content_coding.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>

#include "api/quoting.h"
#include "server/http/header_lists.h"

namespace remesh::server {
namespace {

constexpr int kFastest = 1;
constexpr int kGzipWindow = 15 + 16;  // the largest window, in gzip's format
constexpr int kMemory = 8;
constexpr std::size_t kStep = 1 << 20;
/// Smaller answers are not compressed, because they fit into a packet or two anyway.
constexpr std::size_t kMinCompressed = 1024;

class Deflater {
 public:
  Deflater() {
    if (deflateInit2(&stream_, kFastest, Z_DEFLATED, kGzipWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void add(std::string_view part, bool is_last, std::string& out) {
    // zlib does not write to this memory, but its interface is older than const.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(part.data()));
    stream_.avail_in = static_cast<uInt>(part.size());
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      deflate(&stream_, is_last ? Z_FINISH : Z_NO_FLUSH);
      out.append(buffer_.data(), buffer_.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

 private:
  z_stream stream_{};
  std::array<char, 32 << 10> buffer_;
};

/// True unless the weight of a list element, such as `gzip;q=0.5`, is 0.
bool is_wanted(std::string_view element) {
  const std::size_t semicolon = element.find(';');
  if (semicolon == std::string_view::npos) return true;
  const std::string weight = api::ascii_lower(trimmed(element.substr(semicolon + 1)));
  return weight.rfind("q=0", 0) != 0 || weight.find_first_of("123456789", 3) != std::string::npos;
}

}  // namespace

void check_content_coding(const RequestHead& head) {
  const std::string list = head.list("content-encoding");
  std::size_t count = 0;
  for (const std::string_view element : list_elements(list)) {
    const std::string coding = api::ascii_lower(element);
    if (coding == "identity") continue;
    const bool is_gzip = coding == "gzip" || coding == "x-gzip";
    if (is_gzip && ++count == 1) continue;
    throw HttpError(415, "unsupported_media_type",
                    is_gzip ? std::string("a body that is compressed twice is not supported")
                            : "the content coding \"" + coding.substr(0, 100) +
                                  "\" is not supported; the "
                                  "supported coding is gzip")
        .with_header("Accept-Encoding", "gzip");
  }
}

bool accepts_gzip(std::string_view accept_encoding) {
  bool by_any = false;
  for (const std::string_view element : list_elements(accept_encoding)) {
    const std::string coding = api::ascii_lower(trimmed(element.substr(0, element.find(';'))));
    if (coding == "gzip" || coding == "x-gzip") return is_wanted(element);
    if (coding == "*") by_any = is_wanted(element);
  }
  return by_any;
}

std::string gzip(std::string_view bytes, RunControl& control) {
  Deflater deflater;
  std::string out;
  do {
    control.check();
    const std::string_view part = bytes.substr(0, std::min(kStep, bytes.size()));
    bytes.remove_prefix(part.size());
    deflater.add(part, bytes.empty(), out);
  } while (!bytes.empty());
  return out;
}

void compress(api::Response& response, std::string_view accept_encoding, RunControl& control) {
  response.headers.emplace_back("Vary", "Accept-Encoding");
  if (response.body.size() < kMinCompressed || !accepts_gzip(accept_encoding)) return;
  response.body = gzip(response.body, control);
  response.headers.emplace_back("Content-Encoding", "gzip");
}

Response compressed(Response response, const RequestHead& request) {
  RunControl control;
  compress(response, request.list("accept-encoding"), control);
  return response;
}

}  // namespace remesh::server
