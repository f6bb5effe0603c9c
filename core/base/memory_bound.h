/// Bounds on the memory of stages. They are counted in bytes for each face, so they are the same on every machine.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/error.h"

namespace remesh {

/// This is a row of the table of bounds: a number of bytes for each face of the input and for each face that the output
/// may have, and some bytes that are always allowed.
struct StageMemory {
  std::uint64_t per_input_face, per_output_face, always;

  constexpr std::uint64_t bytes(std::uint64_t input, std::uint64_t output) const {
    // From this number of faces on, there is no limit. Below it, the products that follow do not overflow.
    constexpr std::uint64_t kMany = std::uint64_t{1} << 36;
    if (input >= kMany || output >= kMany) return std::numeric_limits<std::uint64_t>::max();
    return always + input * per_input_face + output * per_output_face;
  }
};

/// Returns the row of a stage. The row covers all memory that a run holds in that stage, including data of earlier
/// stages, but not the input itself. Good surfaces take about half as much or less.
/// Holds: a test counts the allocations on many surfaces, and no stage holds more.
StageMemory memory_of(Stage stage);

/// The bytes that a run may hold in its present stage. Before code allocates a list whose length depends on the
/// geometry and not only on the number of faces, it asks this class. The answer depends on the numbers of faces alone,
/// so it is the same for any number of threads.
///
/// The thread that calls the stages changes these numbers. Any thread may ask.
class MemoryBound {
 public:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  /// Sets the number of faces of the input. Until then there is no bound. Polygons count as triangles, and vertices
  /// that have no face count as well. There is no output yet.
  void set_input(std::uint64_t faces);
  /// Sets the number of faces that the output may have, as far as that is known. It may be kNone.
  void set_output(std::uint64_t faces);
  /// Enters a stage.
  void enter(Stage stage);

  /// Returns the bytes that all of a run may take in this stage, or kNone.
  std::uint64_t allowed() const { return allowed_.load(std::memory_order_relaxed); }

  /// Asks whether `count` items of type T may be allocated at once.
  /// Errors: kOutOfMemory - the items alone would take more than the whole run may take in this stage.
  template <class T>
  void ask_for(std::size_t count) const {
    if (count > allowed() / sizeof(T)) refuse(static_cast<double>(count) * static_cast<double>(sizeof(T)));
  }

 private:
  [[noreturn]] void refuse(double bytes) const;
  void update();

  std::uint64_t input_ = kNone, output_ = 0;
  std::atomic<Stage> stage_{Stage::kQueued};
  std::atomic<std::uint64_t> allowed_{kNone};
};

}  // namespace remesh
