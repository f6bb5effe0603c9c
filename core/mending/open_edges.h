/// The open edges of a surface, and which of them run beside each other as the two sides of a crack do.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/box_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A half-edge that lacks a partner. Lengths are in local units.
struct OpenEdge {
  std::uint32_t half_edge = 0;
  FaceId face;
  VertexId from, to;
  Vec3 inward;  ///< unit: across the edge in the plane of its face, into it
  double length = 0;
  double depth = 0;     ///< how far the face reaches from the edge; of a polygon, its least height
  double height = 0;    ///< the face's least height
  bool is_open = true;  ///< its edge has one face
};

/// How two open edges lie beside each other.
struct Fit {
  double width = std::numeric_limits<double>::infinity();  ///< the larger of both distances between their ends
  bool runs_alike = false;                                 ///< both run the same way, as if one face were turned over
};

/// Open edges, to be searched by their middles.
class OpenEdges {
 public:
  enum class Which {
    kOpen,       ///< edges with one face
    kUnbalanced  ///< also those with some more faces of which most run one way: each of these
  };

  /// Output: the open edges, by half-edge.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(b log b) in open edges, and the corners of their faces.
  OpenEdges(const Surface& surface, const Adjacency& edges, Which which, RunControl& control);

  std::size_t size() const { return edges_.size(); }
  const OpenEdge& operator[](std::size_t i) const { return edges_[i]; }
  Vec3 middle(std::size_t i) const;

  /// How two edges lie beside each other, if these are the two sides of a crack.
  /// Output: an infinite width if they are not: they are one edge, or edges of one triangle; or, told with `reach` as
  ///         the distance that does not count, their faces lie on each other, as two sheets do or a sheet and its back.
  Fit fit(std::size_t i, std::size_t j, double reach) const;

  /// Whether the faces at two edges lie on each other as far as can be told, with `reach` as the distance that does
  /// not count.
  bool do_lie_on_each_other(std::size_t i, std::size_t j, double reach) const;
  /// By how much a surface of the faces at two edges would bend there: 0 if it goes straight on.
  double turn(std::size_t i, std::size_t j) const;
  /// The angle between the faces at two edges that run in opposite directions, behind these: where the body is.
  double angle_behind(std::size_t i, std::size_t j) const;

  /// Calls visit(j) for the edges whose middles are nearer than `best` to that of i, itself included; visit may lower
  /// `best`. Returns how many were visited.
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
      if (++visits % kBetweenChecks == 0) control.check();
      visit(tree_.number(slot));
    });
    return visits;
  }

  /// Whether the first edge comes before the second one, by where they are, in whatever order they were read.
  bool is_before(std::size_t i, std::size_t j) const;

 private:
  /// The same box in full precision: tolerances are far less than single precision tells.
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

/// Counts looks at pairs of open edges. Ordinary boundaries have a few for each; where many lie along one line, all
/// pairs are too many.
class LooksAtEdges {
 public:
  explicit LooksAtEdges(std::size_t open_edges) : most_(kFew + kMaxPerEdge * open_edges) {}

  void add(std::size_t looks) { looks_.fetch_add(looks, std::memory_order_relaxed); }
  /// Whether there were too many: it does not depend on the order in which they were added.
  bool are_too_many() const { return looks_.load(std::memory_order_relaxed) > most_; }

 private:
  static constexpr std::size_t kFew = 4096, kMaxPerEdge = 64;

  std::size_t most_;
  std::atomic<std::size_t> looks_{0};
};

/// A length as messages have it, to two digits.
std::string few_digits(double length);

}  // namespace remesh
