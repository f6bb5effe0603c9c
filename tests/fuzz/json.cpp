// The JSON reader on any bytes, with options in it.
#include <cstddef>
#include <cstdint>

#include "api/json_reader.h"
#include "api/request_code.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/same_reading.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  RunControl control;
  api::OptionReader options;
  try {
    const std::string_view content(reinterpret_cast<const char*>(data), size);
    const ReadResult result = api::read_json(content, {100'000, 100'000}, control, options);
    fuzz::check_mesh(result.mesh);
    api::OptionReader same_options;
    fuzz::require(
        test::is_same_reading(result, api::read_json_by_events(content, {100'000, 100'000}, control, same_options)),
        "the readings differ");
  } catch (const Error& error) {
    const bool is_of_request = error.code == api::RequestCode::kMalformedJson ||
                               error.code == api::RequestCode::kUnknownOption || error.code == Code::kInvalidOption;
    if (!is_of_request) fuzz::check_error(error);
  }
  return 0;
}
