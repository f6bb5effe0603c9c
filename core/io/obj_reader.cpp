#include <optional>
#include <utility>

#include "core/io/obj.h"
#include "core/io/obj_readers.h"
#include "core/io/read_errors.h"

namespace remesh {

ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  std::optional<ReadResult> plain = read_obj_fast_path(text, limits, control);
  ReadResult result = plain ? std::move(*plain) : read_obj_full_grammar(text, limits, control);
  note_padding(text, result.diagnostics);
  return result;
}

}  // namespace remesh
