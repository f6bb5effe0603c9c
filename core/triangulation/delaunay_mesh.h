/// A constrained Delaunay triangulation that can be changed: points are inserted and removed, and constrained edges are
/// cut.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// Half-edges are numbered as in Triangulation2d: h = 3t + k runs from corner k to corner k+1 of triangle t,
/// counter-clockwise. Every edge on the boundary of the triangulation is constrained. A constrained half-edge has a
/// side instead of a twin. A side is a number under which the owner of this mesh stores what belongs to the half-edge,
/// and the mesh finds the half-edge of a side again. The two half-edges of a slit have a side each.
/// Holds: After each operation this is the unique constrained Delaunay triangulation of its points. Cocircular points
///        are decided as in `in_circle_perturbed`. No triangle is degenerate or turned over.
/// This class is larger than the bound because all its operations change the same arrays of corners, twins and sides:
///        each operation must keep the promises under Holds, on which the other operations rely.
class DelaunayMesh {
 public:
  /// One edge of a cavity's rim, seen from inside. It belongs to a triangle that would be removed.
  struct RimEdge {
    std::uint32_t from, to;
    std::uint32_t outside;  ///< the entry of that half-edge in `twin_`: its twin, or the constraint bit and its side
  };
  /// The scratch memory of all operations. One object can serve many meshes, one after the other.
  struct Scratch {
    std::vector<std::uint32_t> cavity, stack, changed, ring;
    std::vector<RimEdge> front;  ///< edges that are on the rim or inside the cavity, which is not decided yet
    std::vector<RimEdge> rim;
    std::uint64_t visited = 0;  ///< triangles passed by walks and contained in cavities, since this object was made
  };

  /// `scratch` and `memory` must outlive the mesh.
  explicit DelaunayMesh(Scratch& scratch, std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  /// Input: `mesh` is a constrained Delaunay triangulation. `sides` lists the half-edges that are constrained here, and
  ///        their order numbers the sides. It must have all half-edges on the boundary, and both half-edges of each
  ///        inner constraint that stays one. `number[v]` is the index in `points` of vertex v of `mesh`. If `number` is
  ///        empty, this is v itself.
  DelaunayMesh(const Triangulation2d& mesh, std::span<const Vec2> points, std::span<const std::uint32_t> sides,
               Scratch& scratch, std::span<const std::uint32_t> number = {},
               std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  /// Makes the mesh work with this scratch memory from now on.
  void use(Scratch& scratch) { scratch_ = &scratch; }

  std::uint32_t triangle_slots() const { return static_cast<std::uint32_t>(corner_.size() / 3); }
  std::uint32_t triangle_count() const { return live_triangles_; }
  bool is_live(std::uint32_t t) const { return corner_[3 * t] != kNone; }
  std::uint32_t vertex_slots() const { return static_cast<std::uint32_t>(points_.size()); }
  bool is_live_vertex(std::uint32_t v) const { return edge_at_[v] != kNone; }
  Vec2 point(std::uint32_t v) const { return points_[v]; }
  /// Returns a half-edge that begins at vertex v, which must be live.
  std::uint32_t half_edge_at(std::uint32_t v) const { return edge_at_[v]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return corner_[h]; }
  std::uint32_t to(std::uint32_t h) const { return corner_[next(h)]; }
  std::uint32_t apex(std::uint32_t h) const { return corner_[previous(h)]; }
  bool is_constrained(std::uint32_t h) const { return (twin_[h] & kConstraint) != 0; }
  /// Prefetches the memory of a triangle that will be read soon. The triangle may have changed by then.
  void prefetch(std::uint32_t half_edge, const std::array<std::uint32_t, 3>& corners) const {
    __builtin_prefetch(&corner_[half_edge]);
    __builtin_prefetch(&twin_[half_edge]);
    for (const std::uint32_t v : corners) __builtin_prefetch(&points_[v]);
  }
  /// Returns the twin of a half-edge, which must not be constrained.
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  /// Returns the side of a half-edge, which must be constrained.
  std::uint32_t side(std::uint32_t h) const { return twin_[h] & ~kConstraint; }
  std::uint32_t half_edge_of_side(std::uint32_t side) const { return half_edge_of_side_[side]; }
  std::uint32_t side_count() const { return static_cast<std::uint32_t>(half_edge_of_side_.size()); }

  /// A location is the end of a straight walk from the middle of a triangle towards a point p.
  struct Location {
    /// This is a half-edge of the triangle that contains p. If p is hidden, it is the constrained half-edge that hides
    /// it.
    std::uint32_t half_edge;
    bool is_hidden;
  };
  Location locate(std::uint32_t triangle, Vec2 p) const;

  /// The triangles that would be removed if a point were inserted, and the edges around them. The spans are valid until
  /// the next operation.
  struct Cavity {
    Vec2 point;
    std::span<const std::uint32_t> triangles;
    std::span<const RimEdge> rim;  ///< in the order in which the point is joined to them
    /// True if the point can be joined to the whole rim. Otherwise it equals a vertex or lies on a constrained edge.
    bool has_room = false;
  };
  /// Finds the cavity of p. `triangle` is the one that contains p.
  Cavity find_cavity(Vec2 p, std::uint32_t triangle);
  /// Inserts the point of a cavity that has room for it. The cavity must be the one that was found last. Returns the
  /// new vertex.
  std::uint32_t fill_cavity(const Cavity& cavity);
  /// Returns the number of triangles that the walks of `locate` have passed and the cavities have contained. The
  /// difference of two such numbers measures the work between them.
  std::uint64_t visited() const { return scratch_->visited; }

  static bool is_constrained(const RimEdge& e) { return (e.outside & kConstraint) != 0; }
  static std::uint32_t side(const RimEdge& e) { return e.outside & ~kConstraint; }

  /// Cuts a constrained edge at p. `side` is a side of that edge, and p lies on the edge up to rounding. The half-edge
  /// of the side is divided: the part from its start to p keeps the number `side`, and the part from p to its end gets
  /// a new number, `side_count() - 1`.
  /// A slit has a side on each of its two half-edges, and each side is cut by a call of its own. In the second of these
  /// calls, `vertex` is the vertex that the first one made at p. In all other calls it is kNone.
  /// Returns: the vertex at p; kNone, with nothing changed, if rounding leaves no room for p.
  std::uint32_t cut(std::uint32_t side, Vec2 p, std::uint32_t vertex = kNone);

  /// Removes a vertex that has no constrained edge. The next new vertex gets its number.
  void remove(std::uint32_t v);

  /// Lists the triangles that the last operation made or changed. The list may name a triangle twice, and some of its
  /// triangles may have been removed again.
  std::span<const std::uint32_t> changed() const { return scratch_->changed; }

  /// Lists the numbers of the live vertices and of the live triangles, ascending. If no number is unused, these are 0,
  /// 1, 2 ...
  void number(std::pmr::vector<std::uint32_t>& vertex, std::pmr::vector<std::uint32_t>& triangle) const;
  /// Returns the triangulation without unused numbers. Also lists the vertices and triangles that it has, as `number`
  /// does.
  Triangulation2d compact(std::pmr::vector<std::uint32_t>& vertex, std::pmr::vector<std::uint32_t>& triangle) const;

 private:
  static constexpr std::uint32_t kConstraint = 0x80000000u;

  std::uint32_t new_vertex(Vec2 p);
  std::uint32_t new_triangle();
  void drop_triangle(std::uint32_t t);
  void set_triangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c);
  /// Sets what lies beyond half-edge h: a twin, or a side with its bit. The twin or side is made to refer to h.
  void attach(std::uint32_t h, std::uint32_t outside);
  void join(std::uint32_t g, std::uint32_t h) {
    twin_[g] = h;
    twin_[h] = g;
  }
  void collect_cavity(Vec2 p, std::uint32_t triangle, std::uint32_t left_out);
  /// Joins all edges of the rim, in their order, to v. Returns the outer half-edges at v of the first and of the last
  /// triangle.
  struct Fan {
    std::uint32_t first, last;
  };
  Fan make_fan(std::uint32_t v);
  void flip(std::uint32_t h);
  void restore_delaunay();

  Scratch* scratch_;
  std::pmr::vector<Vec2> points_;
  std::pmr::vector<std::uint32_t> edge_at_;  ///< a half-edge that begins at each vertex; kNone if it is not live
  std::pmr::vector<std::uint32_t> corner_;
  std::pmr::vector<std::uint32_t> twin_;  ///< a twin, or the constraint bit and a side
  std::pmr::vector<std::uint32_t> half_edge_of_side_;
  std::pmr::vector<std::uint32_t> free_vertices_, free_triangles_;
  std::uint32_t live_triangles_ = 0;
};

}  // namespace remesh
