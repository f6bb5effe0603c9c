/// Triangles in space that may cross each other, and what each was made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {

/// A triangle of the original surface of which a triangle of a soup is a piece.
struct Cover {
  FaceId face;
  bool is_reversed = false;  ///< the piece faces the other way
  friend auto operator<=>(const Cover&, const Cover&) = default;
};

/// A rounding step of a soup's coordinates.
inline constexpr double kSoupRoundingStep = 0x1p-53;

/// Triangles with the original triangles that each covers. Where several original triangles lie on each other, one
/// triangle of the soup covers all of them.
/// Holds: no two triangles have the same corners after a cut. The first cover of a triangle faces the same way.
struct Soup {
  std::vector<Vec3> positions;  ///< the largest coordinate is about 1, and the smallest is 0 or in range of predicates
  std::vector<Triangle> faces;
  std::vector<std::uint32_t> cover_begin{0};
  std::vector<Cover> covers;  ///< those of face f are covers[cover_begin[f] .. cover_begin[f + 1])

  std::span<const Cover> covers_of(std::size_t f) const {
    return std::span(covers).subspan(cover_begin[f], cover_begin[f + 1] - cover_begin[f]);
  }
};

/// The edges of a soup.
class SoupEdges {
 public:
  SoupEdges(const Soup& soup, RunControl& control)
      : begins_(triangle_begins(soup.faces.size(), control)),
        adjacency_(soup.positions.size(), begins_, corners_of(soup.faces), control),
        of_half_edge_(3 * soup.faces.size()) {
    StopCheck check(control);
    for (EdgeId e(0); e.value < adjacency_.edge_count(); ++e.value, check())
      for (const std::uint32_t h : adjacency_.half_edges(e)) of_half_edge_[h] = e;
  }

  std::size_t count() const { return adjacency_.edge_count(); }
  /// The edge from corner k of a face to its next corner.
  EdgeId of(FaceId f, std::size_t k) const { return of_half_edge_[3 * f.value + k]; }
  /// The half-edges of an edge; half-edge 3 f + k begins at corner k of face f.
  std::span<const std::uint32_t> half_edges(EdgeId e) const { return adjacency_.half_edges(e); }
  /// The two ends, the smaller one first.
  std::pair<VertexId, VertexId> ends(EdgeId e) const {
    const std::uint32_t h = adjacency_.half_edges(e).front();
    return std::minmax({adjacency_.from(h), adjacency_.to(h)});
  }

 private:
  std::vector<std::uint32_t> begins_;
  Adjacency adjacency_;
  std::vector<EdgeId> of_half_edge_;
};

}  // namespace remesh
