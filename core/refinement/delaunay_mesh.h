/// A constrained Delaunay triangulation that changes: points come and go, constrained edges are cut.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/triangulation_2d.h"

namespace remesh {

/// Half-edges as in Triangulation2d: h = 3t + k from corner k to corner k+1 of triangle t, counter-clockwise. Every
/// edge of the rim is constrained. A constrained half-edge has a side instead of a twin: a number that its owner uses
/// for whatever belongs to it (both sides of a slit have their own), and that knows its half-edge again.
/// Holds:  after each operation the triangulation is the one constrained Delaunay triangulation of its points,
///         cocircular ones decided as in `in_circle_perturbed`; no triangle is degenerate or turned over.
class DelaunayMesh {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// One edge of a cavity's rim: an edge of a triangle that would go, seen from inside.
  struct RimEdge {
    std::uint32_t from, to;
    std::uint32_t outside;  ///< its twin word
  };
  /// What an operation writes down: one serves many meshes, one after the other.
  struct Scratch {
    std::vector<std::uint32_t> cavity, stack, changed, ring;
    std::vector<RimEdge> front;  ///< edges that may be the rim's, or lie inside
    std::vector<RimEdge> rim;
  };

  /// `scratch` and `memory` outlive the mesh.
  explicit DelaunayMesh(Scratch& scratch, std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  /// Input:  a constrained Delaunay triangulation of `points`; `sides` are its constrained half-edges: all on the rim,
  ///         and of inner constraints those that stay constraints (both half-edges). Their order numbers the sides.
  ///         `number` of a vertex of `mesh` is its index in `points`; empty: the same.
  DelaunayMesh(const Triangulation2d& mesh, std::span<const Vec2> points, std::span<const std::uint32_t> sides,
               Scratch& scratch, std::span<const std::uint32_t> number = {},
               std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  /// From now on, with this one.
  void use(Scratch& scratch) { scratch_ = &scratch; }

  std::uint32_t triangle_slots() const { return static_cast<std::uint32_t>(corner_.size() / 3); }
  std::uint32_t triangle_count() const { return live_triangles_; }
  bool is_live(std::uint32_t t) const { return corner_[3 * t] != kNone; }
  std::uint32_t vertex_slots() const { return static_cast<std::uint32_t>(points_.size()); }
  bool is_live_vertex(std::uint32_t v) const { return edge_at_[v] != kNone; }
  Vec2 point(std::uint32_t v) const { return points_[v]; }
  /// One that begins at this vertex, which is live.
  std::uint32_t half_edge_at(std::uint32_t v) const { return edge_at_[v]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return corner_[h]; }
  std::uint32_t to(std::uint32_t h) const { return corner_[next(h)]; }
  std::uint32_t apex(std::uint32_t h) const { return corner_[previous(h)]; }
  bool is_constrained(std::uint32_t h) const { return (twin_[h] & kConstraint) != 0; }
  /// Asks for the memory of a triangle that is to be looked at soon; it may have changed by then.
  void prefetch(std::uint32_t half_edge, const std::array<std::uint32_t, 3>& corners) const {
    __builtin_prefetch(&corner_[half_edge]);
    __builtin_prefetch(&twin_[half_edge]);
    for (const std::uint32_t v : corners) __builtin_prefetch(&points_[v]);
  }
  /// Of an edge that is not constrained.
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  /// Of a constrained half-edge.
  std::uint32_t side(std::uint32_t h) const { return twin_[h] & ~kConstraint; }
  std::uint32_t half_edge_of_side(std::uint32_t side) const { return half_edge_of_side_[side]; }
  std::uint32_t side_count() const { return static_cast<std::uint32_t>(half_edge_of_side_.size()); }

  /// Where a straight walk from the middle of a triangle towards p ends.
  struct Location {
    std::uint32_t half_edge;  ///< of the triangle that contains p; or the constrained one that hides p
    bool is_hidden;
  };
  Location locate(std::uint32_t triangle, Vec2 p) const;

  /// The triangles that would go if p, which lies in `triangle`, came. Output: false if p cannot be joined to the whole
  /// rim (it equals a vertex, or lies on a constrained edge). `rim()` is valid until the next operation.
  bool find_cavity(Vec2 p, std::uint32_t triangle);
  std::span<const RimEdge> rim() const { return scratch_->rim; }
  /// Its triangles.
  std::span<const std::uint32_t> cavity() const { return scratch_->cavity; }
  static bool is_constrained(const RimEdge& e) { return (e.outside & kConstraint) != 0; }
  static std::uint32_t side(const RimEdge& e) { return e.outside & ~kConstraint; }
  /// Puts p into the cavity that was found. Returns the new vertex.
  std::uint32_t fill_cavity(Vec2 p);

  /// Cuts the edge of a side at p, which lies on it to rounding. The side keeps the half from its half-edge's start to
  /// p; the new side, `side_count() - 1`, is the other one. `vertex`: kNone, or the vertex that p has already (from the
  /// other side of a slit). Returns the vertex; kNone, and nothing changed, if rounding leaves no room for p.
  std::uint32_t cut(std::uint32_t side, Vec2 p, std::uint32_t vertex = kNone);

  /// Takes away a vertex that no constrained edge has. Its number is the next that is used again.
  void remove(std::uint32_t v);

  /// The triangles that the last operation made or changed; some may be named twice, or be gone again.
  std::span<const std::uint32_t> changed() const { return scratch_->changed; }

  /// The numbers of the vertices and triangles that are there, ascending: without gaps they are 0, 1, 2 ...
  void number(std::pmr::vector<std::uint32_t>& vertex, std::pmr::vector<std::uint32_t>& triangle) const;
  /// The triangulation without its gaps, and which vertices and triangles it has.
  Triangulation2d compact(std::pmr::vector<std::uint32_t>& vertex, std::pmr::vector<std::uint32_t>& triangle) const;

 private:
  static constexpr std::uint32_t kConstraint = 0x80000000u;

  std::uint32_t new_vertex(Vec2 p);
  std::uint32_t new_triangle();
  void drop_triangle(std::uint32_t t);
  void set_triangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c);
  /// Gives h what lies beyond it: a twin, which is told, or a side, which is told.
  void attach(std::uint32_t h, std::uint32_t outside);
  void join(std::uint32_t g, std::uint32_t h) {
    twin_[g] = h;
    twin_[h] = g;
  }
  void collect_cavity(Vec2 p, std::uint32_t triangle, std::uint32_t left_out);
  /// Joins the rim, from edge to edge, to v; returns the first and last triangles' outer half-edges at v.
  struct Fan {
    std::uint32_t first, last;
  };
  Fan make_fan(std::uint32_t v);
  void flip(std::uint32_t h);
  void restore_delaunay();

  Scratch* scratch_;
  std::pmr::vector<Vec2> points_;
  std::pmr::vector<std::uint32_t> edge_at_;  ///< a half-edge from each vertex
  std::pmr::vector<std::uint32_t> corner_;
  std::pmr::vector<std::uint32_t> twin_;  ///< a twin, or the bit and a side
  std::pmr::vector<std::uint32_t> half_edge_of_side_;
  std::pmr::vector<std::uint32_t> free_vertices_, free_triangles_;
  std::uint32_t live_triangles_ = 0;
};

}  // namespace remesh
