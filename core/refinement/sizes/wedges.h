/// Tells which ways lead across a wedge: from one side of a sharp edge to its other side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/refinement/sizes/patch_slabs.h"

namespace remesh {

/// Stores the edges at which two patches meet at less than 60 degrees, and the two **sides** of each. A side consists
/// of all patches that are connected with the patch at the edge over edges that turn by less than `feature_angle_deg`.
/// So the number of patches into which a face of the part is divided does not matter.
///
/// A way from one side to the other leads across the wedge if the way over the edge is at most 2 / sin(angle / 2) times
/// as long as the straight one. In a wedge between two planes, the largest ratio is half of that, for two places that
/// are equally far from the edge and opposite each other. The factor of two is for places beyond the end of an edge
/// that ends askew, and for sides that bend. A thin wall that becomes sharp only far away, as at a chisel, is no wedge
/// there.
/// Source: rules.md, Gaps.
class Wedges {
 public:
  Wedges() = default;
  /// Input: `slabs` gives the directions of the patches. `surface` must outlive this object.
  /// Cost:  O(n log n) in the number of edges.
  Wedges(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, const PatchSlabs& slabs,
         double feature_angle_deg, RunControl& control);

  /// Returns whether the straight way between places of two patches, which is `distance` long, leads across a wedge.
  /// All values are in local units.
  /// Cost: Constant if the two sides share no sharp edge; otherwise O(log n), and the number of sharp edges about as
  ///       near as the places.
  bool is_across(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double distance) const;

 private:
  struct Edge {
    std::array<std::uint32_t, 2> sides;  ///< the smaller one first
    VertexId a, b;
    float factor;  ///< the largest ratio of the way over the edge to the straight way
  };
  struct Factor {
    float most = 0;
    void join(Factor other) { most = std::max(most, other.most); }
  };
  /// The edges between two sides. If there are many, they have a tree.
  struct Group {
    std::uint32_t begin, end;
    float most;
    std::uint32_t tree;
  };
  static constexpr std::uint32_t kNoTree = 0xffffffffu, kManyEdges = 16;

  bool is_across(const Edge& edge, const Vec3& from, const Vec3& to, double distance) const;
  void group_edges(RunControl& control);

  const Surface* surface_ = nullptr;
  IdVector<PatchId, std::uint32_t> side_of_;
  std::vector<Edge> edges_;    ///< by their sides
  std::vector<Group> groups_;  ///< as edges
  std::vector<BoxTree<Factor>> trees_;
};

}  // namespace remesh
