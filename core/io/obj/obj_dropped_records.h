/// Counts the data in an OBJ text that its readers do not use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"

namespace remesh {

/// Largest number of corners of a face. tinyobjloader parses a face as a whole, so this bounds the memory (about 50
/// MB) and the time until the next check for cancellation (about 0.1 s).
inline constexpr std::uint64_t kMaxObjFaceCorners = 4'000'000;

/// Counts the records that do not describe the surface, by their keyword.
class DroppedRecords {
 public:
  /// Largest number of kinds of records that are counted separately. Without it, a text could invent a kind on each
  /// line.
  static constexpr std::size_t kMaxKinds = 64;
  /// Stands for further keywords, and for keywords that are too long.
  static constexpr std::string_view kOther = "other";

  void count(std::string_view keyword, std::uint64_t records = 1);
  /// The kinds and their counts, in the order of first appearance.
  const std::vector<std::pair<std::string, std::uint64_t>>& kinds() const { return kinds_; }
  void report(std::vector<Diagnostic>& diagnostics) const;

 private:
  std::size_t find(std::string_view keyword);

  std::vector<std::pair<std::string, std::uint64_t>> kinds_;
  std::size_t last_ = 0;
};

/// Everything that a text contains besides its surface.
struct ObjExtras {
  DroppedRecords dropped;
  Diagnostic extra_values, missing_z;  ///< values of vertices

  std::vector<Diagnostic> diagnostics() &&;
};

}  // namespace remesh
