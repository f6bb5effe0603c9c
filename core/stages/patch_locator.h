/// Finds the input face under a place of a patch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/frame.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The faces of one patch in its plane, as triangles under a binary tree of boxes: node k has the children 2k + 1 and
/// 2k + 2.
class PatchLocator {
 public:
  /// Cost:   O(n log n).
  PatchLocator(const Surface& surface, std::span<const FaceId> faces, const Frame& frame, RunControl& control);

  struct Place {
    std::uint32_t face = 0;           ///< position in `faces`
    std::array<VertexId, 3> corners;  ///< of the triangle: the face itself, or a part of it
    std::array<Vec2, 3> uv;           ///< of these
  };
  /// The triangle nearest to p; of equally near ones that of the first face.
  /// Cost:   O(log n) where faces do not crowd.
  Place nearest(Vec2 p) const;

 private:
  struct Box2 {
    Vec2 min{HUGE_VAL, HUGE_VAL}, max{-HUGE_VAL, -HUGE_VAL};

    void add(Vec2 p);
    double distance(Vec2 p) const;
  };
  struct Item {
    Box2 box;
    Place place;
  };
  static constexpr std::size_t kLeafSize = 4;

  void add(const Place& place);
  /// The items under a node: its share of all, by its place in its level.
  std::pair<std::size_t, std::size_t> range(std::size_t node) const;
  void build();

  std::vector<Item> items_;
  std::vector<Box2> boxes_;
  std::size_t first_leaf_ = 0;
};

}  // namespace remesh
