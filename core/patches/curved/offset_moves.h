/// Computes where vertices of curved patches move if the surfaces are moved outwards.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// The way of a vertex per offset of a surface (see offset_surface).
struct OffsetMove {
  SurfaceId surface;
  Vec3 way;
};

/// The surfaces, planes and lines on which a vertex stays while it is moved.
struct OffsetSite {
  std::vector<SurfaceId> surfaces;  ///< the curved surfaces there; each is named once
  std::vector<Vec3> planes;         ///< unit normals of the planar patches there
  std::vector<Vec3> lines;          ///< unit directions of the edges there that have only planar patches beside them
};

/// Appends the moves of a vertex. It stays in the planes and on the lines, and moves away from each surface by that
/// surface's offset, as nearly as possible. If a plane touches a surface there, the vertex does not move with that
/// surface.
/// Input:  `at` is the place of the vertex.
/// Holds:  a vertex of one surface alone moves along its normal, by the offset times its lever. No way is much longer
///         than that product.
void add_offset_moves(const Vec3& at, const OffsetSite& site, const RecognisedSurfaces& surfaces,
                      std::vector<OffsetMove>& moves);

/// The moves of several vertices.
class OffsetMoves {
 public:
  /// Appends a vertex. Vertices are added in ascending order.
  void add(VertexId v, const Vec3& at, const OffsetSite& site, const RecognisedSurfaces& surfaces) {
    vertices_.push_back(v);
    places_.push_back(at);
    add_offset_moves(at, site, surfaces, moves_);
    begin_.push_back(moves_.size());
  }

  /// Appends a vertex whose moves are known.
  void add(VertexId v, const Vec3& at, std::span<const OffsetMove> moves) {
    vertices_.push_back(v);
    places_.push_back(at);
    moves_.insert(moves_.end(), moves.begin(), moves.end());
    begin_.push_back(moves_.size());
  }

  std::size_t size() const { return vertices_.size(); }
  VertexId vertex(std::size_t i) const { return vertices_[i]; }
  std::span<const OffsetMove> moves(std::size_t i) const {
    return std::span(moves_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }
  /// Returns the place of a vertex before it is moved.
  const Vec3& place(std::size_t i) const { return places_[i]; }
  /// Returns the index of a vertex, or size() if it was not added.
  std::size_t find(VertexId v) const;

 private:
  std::vector<VertexId> vertices_;
  std::vector<Vec3> places_;
  std::vector<std::size_t> begin_{0};
  std::vector<OffsetMove> moves_;
};

/// Returns the sum of moves by these offsets.
inline Vec3 moved_by(std::span<const OffsetMove> moves, const IdVector<SurfaceId, double>& offsets) {
  Vec3 sum;
  for (const OffsetMove& move : moves) sum += offsets[move.surface] * move.way;
  return sum;
}

}  // namespace remesh
