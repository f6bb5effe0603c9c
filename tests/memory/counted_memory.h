/// Counts the memory that a run holds, stage by stage. The operators new and delete of this program count.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/error.h"
#include "core/base/run_control.h"

namespace remesh::memory {

/// The bytes of a stage at the moment at which it was nearest to its bound, or farthest beyond it.
struct StagePeak {
  std::uint64_t held = 0;
  std::uint64_t allowed = 0;

  double share() const { return allowed == 0 ? 0 : static_cast<double>(held) / static_cast<double>(allowed); }
};
using StagePeaks = std::array<StagePeak, kStageCount>;

/// Counts while it lives. What was allocated before does not count, and must not be freed meanwhile. Only one may live
/// at a time.
class CountedMemory {
 public:
  explicit CountedMemory(const RunControl& control);
  ~CountedMemory();
  CountedMemory(const CountedMemory&) = delete;
  CountedMemory& operator=(const CountedMemory&) = delete;

  /// Returns the peaks of all stages so far. Stages without a bound have none.
  StagePeaks peaks() const;
};

}  // namespace remesh::memory
