/// The open edges of a surface, and a test whether two of them run beside each other like the two sides of a crack.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A half-edge that lacks a partner. Lengths are in local units.
struct OpenEdge {
  std::uint32_t half_edge = 0;
  FaceId face;
  VertexId from, to;
  Vec3 inward;  ///< unit vector across the edge, in the plane of its face and into the face
  double length = 0;
  double depth = 0;     ///< how far the face reaches from the edge; for a polygon, its smallest height
  double height = 0;    ///< the face's smallest height
  bool is_open = true;  ///< the edge has only one face
};

/// The position of two open edges relative to each other.
struct Fit {
  double width = std::numeric_limits<double>::infinity();  ///< the larger of both distances between their ends
  bool runs_alike = false;                                 ///< both run the same way, as if one face were turned over
};

/// The open edges of a surface, in a tree that finds them by their middles.
class OpenEdges {
 public:
  enum class Which {
    kOpen,  ///< edges with one face
    /// Edges with one face, and edges with more faces of which more run one way than the other. Of the latter edges,
    /// all half-edges that run the more frequent way are included.
    kUnbalanced
  };

  /// Output: the open edges, ordered by half-edge.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(b log b) for b open edges, and the corners of their faces.
  OpenEdges(const Surface& surface, const Adjacency& edges, Which which, RunControl& control);

  std::size_t size() const { return edges_.size(); }
  const OpenEdge& operator[](std::size_t i) const { return edges_[i]; }
  Vec3 middle(std::size_t i) const;

  /// Measures how two edges lie relative to each other.
  /// Output: the width is infinite if the edges cannot be two sides of a crack. This is so if they are the same edge or
  ///         edges of one triangle, or if their faces lie on each other, like two sheets or a sheet and its back.
  ///         Distances up to `reach` do not count for this.
  Fit fit(std::size_t i, std::size_t j, double reach) const;

  /// Returns whether the faces at two edges seem to lie on each other. Distances up to `reach` do not count.
  bool do_lie_on_each_other(std::size_t i, std::size_t j, double reach) const;
  /// The angle by which a surface of the faces at two edges would bend there; 0 if it continues straight.
  double turn(std::size_t i, std::size_t j) const;
  /// The angle between the faces at two edges that run in opposite directions, measured behind the faces, through the
  /// body.
  double angle_behind(std::size_t i, std::size_t j) const;

  /// Calls visit(j) for the edges whose middles are nearer than `best` to the middle of edge i, including i itself.
  /// `visit` may lower `best`. Returns how many edges were visited.
  template <class Visit>
  std::size_t search(std::size_t i, const double& best, RunControl& control, const Visit& visit) const {
    constexpr std::size_t kBetweenChecks = 4096;
    const Vec3 at = middle(i);
    std::size_t visits = 0;
    const auto bound = [&](const Tree::Entry& entry) {
      const Box3& box = entry.tag.box;
      return norm(
          {excess(box.min.x, box.max.x, at.x), excess(box.min.y, box.max.y, at.y), excess(box.min.z, box.max.z, at.z)});
    };
    tree_.search(best, bound, [&](std::size_t slot) {
      if (++visits % kBetweenChecks == 0) control.check_and_move();
      visit(tree_.number(slot));
    });
    return visits;
  }

  /// Returns whether the first edge comes before the second one. This depends on where they are, not on the order in
  /// which they were read.
  bool is_before(std::size_t i, std::size_t j) const;

 private:
  /// The box in full precision, because tolerances are far smaller than single precision can resolve.
  struct ExactBox {
    Box3 box;
    void join(const ExactBox& other) { box.add(other.box); }
  };
  using Tree = BoxTree<ExactBox>;

  void measure(OpenEdge& edge, const Vec3& twice_area, double extent) const;

  const Surface& surface_;
  std::vector<OpenEdge> edges_;
  Tree tree_;
};

/// Counts the tests of pairs of open edges. On ordinary boundaries there are a few for each edge. If many edges lie
/// along one line, there are too many pairs to test them all.
class LooksAtEdges {
 public:
  explicit LooksAtEdges(std::size_t open_edges) : most_(kFew + kMaxPerEdge * open_edges) {}

  void add(std::size_t looks) { looks_.fetch_add(looks, std::memory_order_relaxed); }
  /// Returns whether there were too many tests. This does not depend on the order in which they were added.
  bool are_too_many() const { return looks_.load(std::memory_order_relaxed) > most_; }

 private:
  static constexpr std::size_t kFew = 4096, kMaxPerEdge = 16;

  std::size_t most_;
  std::atomic<std::size_t> looks_{0};
};

}  // namespace remesh
