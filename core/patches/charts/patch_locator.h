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
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patches/charts/patch_chart.h"

namespace remesh {

/// A patch with more input faces and places to look up than this is worth a task of its own.
inline constexpr std::size_t kLargePatch = 1000;
/// Block size for look-ups, which cost about a microsecond each.
inline constexpr std::size_t kLookUps = 4096;

/// The faces of one patch in its plane, as triangles in a tree of boxes.
class PatchLocator {
 public:
  /// Input:  the surface must outlive this object.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n log n), in parallel.
  PatchLocator(const Surface& surface, std::span<const FaceId> faces, const PatchChart& chart, RunControl& control);

  struct Place {
    std::uint32_t face = 0;  ///< position in `faces`
    Triangle corners;        ///< the corners of the triangle, which is the face itself or a part of it
    std::array<Vec2, 3> uv;  ///< the corners' plane coordinates
  };
  /// Finds the triangle nearest to p. Of several that are equally near, it is a triangle of the first face, and of this
  /// face's triangles the first.
  /// Cost:   O(log n), unless many faces crowd around p.
  Place nearest(Vec2 p) const;

 private:
  struct Part {
    std::uint32_t face;
    Triangle corners;
  };

  std::array<Vec2, 3> uv_of(const Part& part) const;

  const Surface& surface_;
  const PatchChart chart_;
  std::vector<Part, DefaultInit<Part>> parts_;  ///< one face after another
  BoxTree<NoTag> tree_;
};

}  // namespace remesh
