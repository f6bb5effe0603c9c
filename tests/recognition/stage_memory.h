/// Measures how much memory a stage of a run takes. The program's operators new and delete count.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"

namespace remesh::recognition {

/// Counts while it lives, as long as the run is in a given stage. Only one may live at a time.
class StageMemory {
 public:
  StageMemory(const RunControl& control, Stage stage);
  ~StageMemory();
  StageMemory(const StageMemory&) = delete;
  StageMemory& operator=(const StageMemory&) = delete;

  /// Returns the largest number of bytes that were allocated at once in the stage, beyond those at its beginning.
  std::int64_t most_bytes() const;
};

}  // namespace remesh::recognition
