// Decompression of any bytes, within its limits; and of what we compressed, which must come back.
#include "core/io/gzip.h"

#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  const DecompressionLimits limits{1 << 16, 100};
  RunControl control;
  try {
    fuzz::require(gunzip(content, limits, control).size() <= limits.max_bytes, "more bytes than allowed");
  } catch (const Error& error) {
    fuzz::check_error(error);
  }
  if (size <= limits.max_bytes) {
    fuzz::require(gunzip(gzip(content, control), limits, control) == content, "what was packed comes back changed");
  }
  return 0;
}
