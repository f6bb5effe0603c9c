#include <optional>
#include <utility>

#include "core/io/common/read_errors.h"
#include "core/io/obj/obj.h"
#include "core/io/obj/obj_readers.h"

namespace remesh {

ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  std::optional<ReadResult> plain = read_obj_fast_path(text, limits, control);
  ReadResult result = plain ? std::move(*plain) : read_obj_full_grammar(text, limits, control);
  record_padding(text, result.diagnostics);
  return result;
}

}  // namespace remesh
