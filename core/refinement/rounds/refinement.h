/// The result of a refinement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/patch_backup.h"

namespace remesh {

/// This is the result of a refinement.
struct Refinement {
  std::vector<Vec3> new_positions;  ///< positions of the vertices from surface.vertex_count() on
  std::size_t first_inner = 0;      ///< new vertices from here on are inside patches
  /// There is one entry per triangle, patch after patch: the reason why it misses a goal. For triangles that meet the
  /// goals it may have any value.
  std::vector<UnrefinedReason> reason;
  /// There is one entry per triangle, which is not 0 if the triangle is larger than gaps or short edges ask for, or may
  /// be (oversized_triangles.h). It is empty if all are 0.
  std::vector<std::uint8_t> misses_sizes;
  std::uint32_t rounds = 0;
  PatchBackup before;  ///< the patches that have changed, as they were before
};

}  // namespace remesh
