// A form from any bytes; the first line is its Content-Type. Parts lie in the body, in order, and do not overlap.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "api/multipart.h"
#include "api/request_code.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos) return 0;
  const std::string_view body = bytes.substr(line + 1);
  try {
    const char* end = body.data();
    for (const api::FormPart& part : api::parse_multipart(body, bytes.substr(0, line))) {
      fuzz::require(!part.name.empty(), "a part without a name");
      fuzz::require(part.content.data() >= end, "parts overlap");
      end = part.content.data() + part.content.size();
      fuzz::require(end <= body.data() + body.size(), "a part reaches beyond the body");
    }
  } catch (const Error& error) {
    fuzz::require(error.code == api::RequestCode::kMalformedMultipart, error.what());
  }
  return 0;
}
