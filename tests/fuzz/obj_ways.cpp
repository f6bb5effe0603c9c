// The two ways to read OBJ on any bytes: what the fast one reads, the other one reads alike.
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/io/obj/obj_readers.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/same_reading.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  constexpr ReadLimits kLimits{100'000, 100'000};
  RunControl control;
  const std::optional<ReadResult> plain = read_obj_fast_path(content, kLimits, control);
  if (!plain) return 0;
  try {
    fuzz::require(test::is_same_reading(*plain, read_obj_full_grammar(content, kLimits, control)),
                  "the readings differ");
  } catch (const Error&) {
    fuzz::found("only the fast way reads this");
  }
  return 0;
}
