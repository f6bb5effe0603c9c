/// Closes narrow notches: narrow gaps between two chains of open edges.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/base/work_bound.h"
#include "core/mending/details/detail_complex.h"
#include "core/mending/details/detail_shapes.h"
#include "core/mending/details/rules.h"

namespace remesh {

/// A narrow notch that begins at a tip: the node where its two sides meet. It ends at another tip, or at a mouth, where
/// the open edges of the rim leave it to both sides.
struct NarrowNotch {
  /// The next nodes on the two sides beyond the closed part. Either one of them is joined to the other, or the nearer
  /// one to a point on the edge to the other one. The second happens if the other one is too far away, or if the node
  /// after the nearer one is nearer to the other one.
  struct Step {
    enum class Joins : std::uint8_t { kNodes, kFirstToEdge, kSecondToEdge };

    std::uint32_t first, second;
    Joins joins;
  };

  double width = 0;  ///< the largest distance between nodes that are joined
  std::vector<Step> steps;
};

/// Finds narrow notches of a surface while details are removed from it, and closes them.
class NarrowNotches {
 public:
  /// Input: `is_fixed` as in the rules, by node, or shorter. All arguments must outlive this object.
  NarrowNotches(DetailComplex& complex, const DetailRules& rules, const std::vector<std::uint8_t>& is_fixed,
                WorkBound& work)
      : complex_(complex), rules_(rules), is_fixed_(is_fixed), work_(work) {}

  /// Finds the narrow notch that begins at a node. All of it must be narrower than a detail, so a notch that becomes
  /// wider and wider stays. No point of its sides may move too far. The surface must lie around the tip, so the space
  /// beside the tip of a spike is no narrow notch either.
  /// Errors: kCancelled, kTimeout - asked to stop through the control of the bound on work.
  /// Cost:   O(k) for k triangles at the nodes of its sides.
  std::optional<NarrowNotch> find(std::uint32_t tip) const;

  /// Closes a narrow notch from its tip on, as far as no face turns too far and no point moves too far, and no nodes
  /// but those of the narrow notch become one.
  /// Input: the result of `find`, if nothing has changed since.
  /// Output: the nodes to which others were joined, one for each step that was taken.
  std::vector<std::uint32_t> close(std::uint32_t tip, const NarrowNotch& notch);

 private:
  struct Around {
    std::vector<PresentTriangle> faces;
    std::vector<Spoke> spokes;
  };
  /// One side of a narrow notch ahead of the part that was walked along.
  struct Side {
    std::uint32_t previous, node;
    Vec3 begin;     ///< where the part ahead begins, on the edge between the two nodes
    double at = 0;  ///< how far along this edge that is, from 0 to 1
  };
  struct Foot {
    double at;  ///< above 0 and below 1
    double distance;
  };

  Around around(std::uint32_t node) const;
  double angle_around(std::uint32_t node, const Around& around) const;
  static std::optional<std::array<std::uint32_t, 2>> open_neighbours(const Around& around);
  bool walk_on(Side& side) const;
  bool is_next(Side side, std::uint32_t node) const;
  bool is_next_nearer(Side side, std::uint32_t other) const;
  std::optional<NarrowNotch::Step::Joins> step_over(Side& a, Side& b, double& width) const;
  std::optional<Foot> foot_on(const Vec3& from, std::uint32_t to, std::uint32_t node) const;
  std::optional<double> look_at_join(std::uint32_t from, std::uint32_t to) const;
  std::optional<std::uint32_t> join_nodes(std::uint32_t first, std::uint32_t second);
  bool join_to_edge(std::uint32_t tip, std::uint32_t node, std::uint32_t ahead);
  static bool keeps_links(std::uint32_t from, std::uint32_t to, const Around& at_from, const Around& at_to);
  bool is_fixed(std::uint32_t node) const { return node < is_fixed_.size() && is_fixed_[node] != 0; }
  double max_width() const;

  DetailComplex& complex_;
  const DetailRules& rules_;
  const std::vector<std::uint8_t>& is_fixed_;
  WorkBound& work_;
};

}  // namespace remesh
