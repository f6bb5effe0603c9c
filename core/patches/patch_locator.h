/// Finds the input face under a place of a patch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/frame.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Input faces and places to look up that are worth a task of their own.
inline constexpr std::size_t kLargePatch = 1000;
/// A size of blocks of look-ups, each of a microsecond.
inline constexpr std::size_t kLookUps = 4096;

/// The faces of one patch in its plane, as triangles under a tree of boxes.
class PatchLocator {
 public:
  /// Input:  surface and frame, which outlive this.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n log n), in parallel.
  PatchLocator(const Surface& surface, std::span<const FaceId> faces, const Frame& frame, RunControl& control);

  struct Place {
    std::uint32_t face = 0;  ///< position in `faces`
    Triangle corners;        ///< of the triangle: the face itself, or a part of it
    std::array<Vec2, 3> uv;  ///< of these
  };
  /// The triangle nearest to p; of equally near ones that of the first face, and of its triangles the first.
  /// Cost:   O(log n) where faces do not crowd.
  Place nearest(Vec2 p) const;

 private:
  struct Part {
    std::uint32_t face;
    Triangle corners;
  };

  std::array<Vec2, 3> uv_of(const Part& part) const;

  const Surface& surface_;
  const Frame& frame_;
  std::vector<Part, LeftUnset<Part>> parts_;  ///< face after face
  BoxTree<NoTag> tree_;
};

}  // namespace remesh
