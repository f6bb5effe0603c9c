// A chunked body on any bytes, whole and in pieces: the same either way, and never more than the limit.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/chunked_decoder.h"
#include "server/http/http_message.h"
#include "tests/fuzz/fuzz.h"

namespace remesh::fuzz {
namespace {

constexpr std::uint64_t kMaxBody = 600;

struct Decoded {
  int status = 200;
  bool is_done = false;
  std::size_t used = 0;
  std::string body;

  bool operator==(const Decoded& other) const {
    return status == other.status && is_done == other.is_done && used == other.used && body == other.body;
  }
};

Decoded decode(std::string_view bytes, std::size_t step) {
  Decoded decoded;
  server::ChunkedDecoder decoder(kMaxBody);
  try {
    while (decoded.used < bytes.size() && !decoder.is_done())
      decoded.used += decoder.decode(bytes.substr(decoded.used, step), decoded.body);
  } catch (const server::HttpError& error) {
    decoded.status = error.problem.status;
    decoded.used = 0;  // how far it came depends on the steps
  }
  decoded.is_done = decoder.is_done();
  return decoded;
}

}  // namespace
}  // namespace remesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const fuzz::Decoded whole = fuzz::decode(bytes, std::max<std::size_t>(1, size));
  fuzz::require(whole == fuzz::decode(bytes, 1), "a body depends on how it arrives");
  fuzz::require(whole.body.size() <= fuzz::kMaxBody, "a body is longer than it may be");
  fuzz::require(whole.status == 200 || whole.status == 400 || whole.status == 413, "a status that a body has not");
  return 0;
}
