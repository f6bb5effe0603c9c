// A reader on any bytes: it gives a mesh that keeps its promises, or an error of the contract that says where.
// FUZZ_FORMAT names the format.
#include <cstddef>
#include <cstdint>

#include "core/io/mesh_files.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  RunControl control;
  try {
    (void)sniff_format(content);
    const ReadResult result = read_mesh(Format::FUZZ_FORMAT, content, {100'000, 100'000}, control);
    fuzz::check_mesh(result.mesh);
  } catch (const Error& error) {
    fuzz::check_error(error);
  }
  return 0;
}
