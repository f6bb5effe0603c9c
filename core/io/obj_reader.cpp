#include <optional>
#include <utility>

#include "core/io/obj.h"
#include "core/io/obj_readers.h"

namespace remesh {

ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  if (std::optional<ReadResult> plain = read_plain_obj(text, limits, control)) return std::move(*plain);
  return read_any_obj(text, limits, control);
}

}  // namespace remesh
