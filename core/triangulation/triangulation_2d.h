/// A triangulation of points in the plane, stored in a flat array: three half-edges per triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/triangulation/inline_vector.h"
#include "core/triangulation/rare.h"

namespace remesh {

/// Half-edge h = 3t + k runs from corner k to corner k+1 of triangle t. Corners are counter-clockwise, and are indices
/// of the points that were triangulated. The twin of a half-edge runs the other way in the neighbouring triangle; it is
/// kNoHalfEdge on the hull. A constraint is a bit stored with the twin, and is equal on both sides.
class Triangulation2d {
 public:
  static constexpr std::uint32_t kNoHalfEdge = 0x7fffffffu;

  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(half_edges_.size() / 3); }
  std::uint32_t half_edge_count() const { return static_cast<std::uint32_t>(half_edges_.size()); }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

  std::uint32_t from(std::uint32_t h) const { return half_edges_[h].corner; }
  std::uint32_t to(std::uint32_t h) const { return half_edges_[next(h)].corner; }
  /// The corner of h's triangle that is not on h.
  std::uint32_t apex(std::uint32_t h) const { return half_edges_[previous(h)].corner; }
  std::uint32_t twin(std::uint32_t h) const { return half_edges_[h].twin & kNoHalfEdge; }
  bool is_constrained(std::uint32_t h) const { return (half_edges_[h].twin & kConstraint) != 0; }

  /// Appends a triangle without neighbours, and returns its first half-edge (from a to b).
  std::uint32_t add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::uint32_t h = half_edge_count();
    half_edges_.append({{a}, {b}, {c}});
    return h;
  }
  /// Replaces the corners of triangle h/3 so that half-edge h runs from a to b. The caller has to set the twins.
  void set_triangle(std::uint32_t h, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    half_edges_[h].corner = a;
    half_edges_[next(h)].corner = b;
    half_edges_[previous(h)].corner = c;
  }
  /// Makes two half-edges twins. Either may be kNoHalfEdge. Clears their constraint bits.
  void join(std::uint32_t g, std::uint32_t h) {
    if (g != kNoHalfEdge) half_edges_[g].twin = h;
    if (h != kNoHalfEdge) half_edges_[h].twin = g;
  }
  /// Makes two half-edges twins, and sets their constraint bits if `constrained` is true.
  void join(std::uint32_t g, std::uint32_t h, bool constrained) {
    join(g, h);
    if (constrained) constrain(g != kNoHalfEdge ? g : h);
  }
  /// Constrains the edge of h, on both sides.
  void constrain(std::uint32_t h) {
    half_edges_[h].twin |= kConstraint;
    if (twin(h) != kNoHalfEdge) half_edges_[twin(h)].twin |= kConstraint;
  }

  /// Replaces edge (a, b) by (c, d), where c and d are the apexes of h and of its twin. h must have a twin, and the two
  /// triangles must form a strictly convex quadrilateral; this is not checked. Afterwards h runs from d to c within the
  /// same two triangles: triangle h/3 is (d, c, a), and the other one (c, d, b).
  void flip(std::uint32_t h);

  /// Builds the index behind edge_at(). From then on flip() updates it. `points` is the number of points.
  void index_points(std::size_t points);
  void drop_index() { edge_at_.reset(); }
  /// Enters the corners of triangle h/3 into the index, after set_triangle().
  void index_triangle(std::uint32_t h) {
    for (const std::uint32_t g : {h, next(h), previous(h)}) (*edge_at_)[half_edges_[g].corner] = g;
  }
  /// A half-edge that leaves point p, or kNoHalfEdge if no triangle has p. Requires index_points().
  std::uint32_t edge_at(std::uint32_t p) const { return (*edge_at_)[p]; }

  /// Removes the triangles whose entry in `keep` is 0; the other triangles stay in order. A twin that is removed
  /// becomes kNoHalfEdge. Drops the index.
  void compact(const std::vector<std::uint8_t>& keep);

  void reserve(std::size_t triangles) { half_edges_.reserve(3 * triangles); }
  void resize(std::size_t triangles) { half_edges_.resize(3 * triangles); }

 private:
  static constexpr std::uint32_t kConstraint = 0x80000000u;

  struct HalfEdge {
    std::uint32_t corner = 0;
    std::uint32_t twin = kNoHalfEdge;  ///< with the bit of the constraint
  };

  InlineVector<HalfEdge, 3> half_edges_;
  Rare<std::vector<std::uint32_t>> edge_at_;  ///< by point
};

inline constexpr std::uint32_t kNoHalfEdge = Triangulation2d::kNoHalfEdge;

}  // namespace remesh
