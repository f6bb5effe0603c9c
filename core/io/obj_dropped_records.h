/// What the readers of OBJ take note of and drop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"

namespace remesh {

/// Corners of one face. tinyobjloader parses a face whole: this bounds the memory and the time until the next look at
/// the control (some 50 MB and 0.1 s).
inline constexpr std::uint64_t kMaxObjFaceCorners = 4'000'000;

/// Counts, by keyword, the records that do not describe the surface.
class DroppedRecords {
 public:
  /// Kinds of records counted apart; a text could make up one on each line.
  static constexpr std::size_t kMaxKinds = 64;
  static constexpr std::string_view kOther = "other";  ///< the last of too many keywords, and too long ones

  void count(std::string_view keyword, std::uint64_t records = 1);
  /// Those counted, in the order in which they came first.
  const std::vector<std::pair<std::string, std::uint64_t>>& kinds() const { return kinds_; }
  void report(std::vector<Diagnostic>& diagnostics) const;

 private:
  std::size_t find(std::string_view keyword);

  std::vector<std::pair<std::string, std::uint64_t>> kinds_;
  std::size_t last_ = 0;
};

/// All that a text has besides its surface.
struct ObjFindings {
  DroppedRecords dropped;
  Diagnostic extra_values, missing_z;  ///< of vertices

  std::vector<Diagnostic> diagnostics() &&;
};

}  // namespace remesh
