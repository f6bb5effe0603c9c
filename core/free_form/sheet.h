/// A triangulated surface whose vertices can be moved, joined and given other neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The triangles of a surface as flat arrays. A chain edge is an edge that must stay near an edge of the input: a
/// feature, a border of labels, or an edge that has not exactly two faces. Both sides of a chain edge know its number.
/// The corners at a vertex (3 * face + corner) form a list. Changes touch only the vertices and faces around a
/// place, so threads may change distant places at the same time.
struct Sheet {
  enum class Kind : std::uint8_t {
    kFree,   ///< may move anywhere
    kChain,  ///< has exactly two chain edges, and may be joined with the vertex at the end of one of them
    kFixed   ///< stays
  };

  IdVector<VertexId, Vec3> positions;
  IdVector<FaceId, Triangle> faces;  ///< the first corner of a removed face is invalid
  /// Per face: the face of the input that it once was. No chain lies between the two.
  IdVector<FaceId, FaceId> origin;
  IdVector<FaceId, std::uint8_t> is_of_plane;  ///< see FreeForm
  IdVector<VertexId, Kind> kind;
  std::vector<std::uint32_t> chain;         ///< per half-edge: the number of the chain edge, or kNone
  std::vector<std::uint8_t> is_at_plane;    ///< per chain edge: whether it is the border of a plane
  IdVector<VertexId, std::uint32_t> first;  ///< the first corner in the list at a vertex; kNone if it is removed
  std::vector<std::uint32_t> next;          ///< per corner: the next one at the same vertex, or kNone

  static FaceId face_of(std::uint32_t corner) { return FaceId(corner / 3); }
  static std::uint32_t after(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  static std::uint32_t before(std::uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

  VertexId vertex(std::uint32_t corner) const { return faces[face_of(corner)][corner % 3]; }
  bool is_alive(VertexId v) const { return first[v] != kNone; }
  bool is_alive(FaceId f) const { return faces[f][0].is_valid(); }
  /// Returns whether the edge from a corner to the next one is the border of a plane.
  bool is_border_of_plane(std::uint32_t corner) const {
    return chain[corner] != kNone && is_at_plane[chain[corner]] != 0;
  }
  Corners3 corners_of(FaceId f) const {
    const Triangle& t = faces[f];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
  const Vec3& place(std::uint32_t corner) const { return positions[vertex(corner)]; }

  /// Calls visit(corner) for the corners at a vertex.
  template <class Visit>
  void for_star(VertexId v, const Visit& visit) const {
    for (std::uint32_t c = first[v]; c != kNone; c = next[c]) visit(c);
  }
  /// Makes the lists of corners. The faces are there.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  void link(RunControl& control);

  /// Joins `from` with `to`, which does not move. Faces with both vertices disappear.
  /// Input: an edge, of which joining does not change the topology; see can_join.
  void join(VertexId from, VertexId to);
  /// Gives the two faces at an edge their other diagonal.
  /// Input: one corner at the edge in each face, from which the edge starts.
  void flip(std::uint32_t one, std::uint32_t other);

  /// Splits an edge at a place, and each face at the edge with it. The new vertex and the new faces get the next
  /// numbers. The half of a chain edge at w gets the number `far_chain`. The caller adds the vertex's kind.
  /// Input: an edge.
  void split(VertexId v, VertexId w, const Vec3& place, std::uint32_t far_chain);

  /// Returns whether the surface stays what it is when the ends of an edge become one vertex: around the edge are only
  /// its own faces, and no two chain edges become one.
  /// Source: Dey, Edelsbrunner, Guha, Nekhayev, Topology preserving edge contraction, 1999.
  bool can_join(VertexId from, VertexId to) const;
  /// Returns whether a vertex has few faces. Operators leave others alone, so that each change takes bounded time.
  bool has_small_star(VertexId v) const {
    constexpr int kMaxFaces = 64;
    int count = 0;
    for (std::uint32_t c = first[v]; c != kNone; c = next[c])
      if (++count > kMaxFaces) return false;
    return true;
  }
  /// Returns whether there is an edge between two vertices.
  bool are_joined(VertexId a, VertexId b) const;
  /// Returns the corner at `from` of a face that has the edge in this direction, or kNone.
  std::uint32_t corner_at_edge(VertexId from, VertexId to) const;
  /// Returns a corner of each face at an edge: the one from which the edge starts in the face.
  std::vector<std::uint32_t> corners_at_edge(VertexId v, VertexId w) const;

 private:
  void unlink(std::uint32_t corner);
  void push(VertexId v, std::uint32_t corner);
  void set_chain(VertexId a, VertexId b, std::uint32_t number);
};

}  // namespace remesh
