#include "core/mending/polygons/covered_polygons.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/mesh/mesh.h"

namespace remesh {
namespace {

class Covering {
 public:
  Covering(const Surface& surface, const Adjacency& edges, double tolerance, RunControl& control)
      : surface_(surface), edges_(edges), tolerance_(tolerance), control_(control) {}

  /// Output: the new faces; none if no polygon is covered.
  FaceList run() {
    const std::vector<FaceId> suspects = find_suspects();
    FaceList faces;
    if (suspects.empty()) return faces;
    list_triangles(suspects);
    if (triangles_.empty()) return faces;
    std::vector<std::pair<FaceId, std::vector<Triangle>>> cuts;
    for (const FaceId f : suspects)
      if (std::vector<Triangle> pieces = cut(f); !pieces.empty()) cuts.push_back({f, std::move(pieces)});
    if (cuts.empty()) return faces;
    StopCheck check(control_);
    auto next = cuts.begin();
    for (std::uint32_t i = 0; i < surface_.face_count(); ++i) {
      check();
      const FaceId f(i);
      if (next == cuts.end() || next->first != f) {
        faces.add_face(surface_.face(f), surface_.face_source[f], surface_.label(f));
        continue;
      }
      for (const Triangle& piece : next->second) faces.add_face(piece, surface_.face_source[f], surface_.label(f));
      ++next;
    }
    return faces;
  }

 private:
  /// The polygons that share two edges in a row with a triangle, or have an edge with three faces. Each triangulation
  /// of a polygon has a triangle with two of the polygon's edges.
  std::vector<FaceId> find_suspects() const {
    return select_ids<FaceId>(surface_.face_count(), kItemsPerBlock, control_, [&](std::size_t f) {
      if (surface_.face(FaceId(f)).size() < 4) return false;
      for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h) {
        const std::uint32_t twin = edges_.twin(h);
        if (twin == kNone ? edges_.half_edges(edges_.edge_of(h)).size() > 1 : is_ear(h, twin)) return true;
      }
      return false;
    });
  }

  /// Returns whether the face over an edge is a triangle that has the next edge of this face, too.
  bool is_ear(std::uint32_t h, std::uint32_t twin) const {
    const FaceId other = edges_.face_of(twin);
    return surface_.face(other).size() == 3 && edges_.to(edges_.next(h)) == edges_.to(edges_.next(twin));
  }

  /// Begins with the smallest corner and keeps the orientation.
  static Triangle key(VertexId a, VertexId b, VertexId c) {
    if (b < a && b < c) return {b, c, a};
    if (c < a && c < b) return {c, a, b};
    return {a, b, c};
  }

  /// Lists the triangles whose corners are all corners of suspects.
  void list_triangles(const std::vector<FaceId>& suspects) {
    StopCheck check(control_);
    std::vector<std::uint8_t> is_corner(surface_.vertex_count(), 0);
    for (const FaceId f : suspects)
      for (const VertexId v : surface_.face(f)) {
        check();
        is_corner[v.value] = 1;
      }
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      check();
      const auto loop = surface_.face(FaceId(f));
      if (loop.size() == 3 &&
          std::all_of(loop.begin(), loop.end(), [&](VertexId v) { return is_corner[v.value] != 0; }))
        triangles_.push_back(key(loop[0], loop[1], loop[2]));
    }
    sort_stoppable(triangles_.begin(), triangles_.end(), control_);
  }

  bool is_triangle(VertexId a, VertexId b, VertexId c) const {
    return std::binary_search(triangles_.begin(), triangles_.end(), key(a, b, c));
  }

  Vec3 place(VertexId v) const { return surface_.local[v]; }

  /// Cuts off triangles of the surface one after the other.
  /// Output: the pieces; none if the polygon is not covered.
  std::vector<Triangle> cut(FaceId f) const {
    const auto loop = surface_.face(f);
    const auto n = static_cast<std::uint32_t>(loop.size());
    std::vector<VertexId> corners(loop.begin(), loop.end());
    sort_stoppable(corners.begin(), corners.end(), control_);
    if (std::adjacent_find(corners.begin(), corners.end()) != corners.end()) return {};
    Vec3 normal;
    for (std::uint32_t i = 1; i + 1 < n; ++i)
      normal += cross(place(loop[i]) - place(loop[0]), place(loop[i + 1]) - place(loop[0]));
    const double length = norm(normal);
    if (!(length > 0)) return {};
    const bool is_plane = std::all_of(loop.begin(), loop.end(), [&](VertexId v) {
      return std::fabs(dot(normal, place(v) - place(loop[0]))) <= tolerance_ * length;
    });
    std::vector<std::uint32_t> next(n), before(n), queue(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      next[i] = (i + 1) % n;
      before[i] = (i + n - 1) % n;
      queue[i] = i;
    }
    // Where several triangulations lie over the polygon, the order of corners in the file must not decide.
    sort_stoppable(queue.begin(), queue.end(), control_, [&](std::uint32_t i, std::uint32_t j) {
      return surface_.positions[loop[j]] < surface_.positions[loop[i]];
    });
    StopCheck check(control_);
    std::vector<std::uint8_t> is_gone(n, 0);
    std::vector<Triangle> pieces;
    while (!queue.empty()) {
      check();
      const std::uint32_t i = queue.back();
      queue.pop_back();
      if (is_gone[i] != 0) continue;
      const VertexId a = loop[before[i]], b = loop[i], c = loop[next[i]];
      if (!(dot(normal, cross(place(b) - place(a), place(c) - place(b))) > 0)) continue;
      if (!is_triangle(a, b, c) && !(is_plane && is_triangle(a, c, b))) continue;
      pieces.push_back({a, b, c});
      if (pieces.size() + 2 == n) return pieces;
      is_gone[i] = 1;
      next[before[i]] = next[i];
      before[next[i]] = before[i];
      queue.insert(queue.end(), {next[i], before[i]});
    }
    return {};
  }

  const Surface& surface_;
  const Adjacency& edges_;
  double tolerance_;
  RunControl& control_;
  std::vector<Triangle> triangles_;  ///< as keys, in order
};

}  // namespace

bool cut_covered_polygons(Surface& surface, const Adjacency& edges, double tolerance, RunControl& control) {
  if (edges.are_triangles()) return false;
  FaceList faces = Covering(surface, edges, tolerance, control).run();
  if (faces.face_count() == 0) return false;
  surface.take_faces(std::move(faces));
  return true;
}

}  // namespace remesh
