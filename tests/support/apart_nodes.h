/// Tests the promise of a tree's node bounds: no face meets anything in a node that is said to be apart from the
/// face.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <span>

#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/triangle_intersection.h"

namespace remesh {

struct NodeCounts {
  std::size_t met = 0, apart = 0;
};

/// Tests the promise for one face and all nodes by brute force.
/// Output: how many nodes the face meets, and how many are apart from it.
template <class IsApart>
NodeCounts expect_no_met_node_is_apart(const TriangleTree& tree, std::span<const Vec3> positions,
                                       std::span<const Triangle> faces, const Triangle& face, const IsApart& is_apart) {
  NodeCounts counts;
  for (std::size_t node = 0; node < tree.node_count(); ++node) {
    const auto [first, last] = tree.slots(node);
    bool is_met = false;
    for (std::size_t slot = first; slot < last && !is_met; ++slot)
      is_met = do_intersect(face, faces[tree.face(slot).value], positions);
    const bool are_apart = is_apart(node);
    EXPECT_FALSE(is_met && are_apart);
    counts.met += is_met;
    counts.apart += are_apart;
  }
  return counts;
}

}  // namespace remesh
