/// Finds the triangles that bound the union of solids.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/mesh/mesh.h"
#include "core/solids/arrangement.h"

namespace remesh {

/// Triangles that do not cross each other, and how much each changes the winding number.
struct WeighedFaces {
  std::span<const Vec3> positions;
  std::span<const Triangle> faces;
  /// By face: the winding number behind it minus that before it, where it faces. 0 for faces of open shells.
  std::span<const std::int32_t> weights;
};

/// The cells into which triangles divide space, and the winding number in each.
struct Cells {
  /// By side of a face: the cell there. Side 2 f is where face f faces, side 2 f + 1 is behind it.
  std::vector<std::uint32_t> of_side;
  std::vector<std::int32_t> winding;  ///< by cell
  /// The number of cells without the one outside of everything. Cells of nested shells count once.
  std::size_t count = 0;
  /// False if the winding numbers contradict each other, since faces with a weight are not closed or cross each other.
  /// Then they mean nothing.
  bool are_consistent = true;
};

/// Walks around the edges to find the cells, and across the faces to find their winding numbers. For
/// parts of the surface that share no edge with others, a ray from each part finds the cell that contains this part.
/// Holds:   exact for triangles that meet only in common vertices and edges. The coordinates are in the range of
///          orient3d. The result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    O(n log n), and for each part the triangles whose boxes its ray meets.
Cells find_cells(const WeighedFaces& faces, RunControl& control);

/// Returns the number of cells into which an arrangement divides space, without the one outside.
/// Errors: as find_cells.
/// Cost:   as find_cells.
std::size_t count_cells(const Arrangement& arranged, RunControl& control);

/// The faces of an arrangement that stay if only the boundary of a union does.
struct UnionFaces {
  std::vector<std::uint8_t> stays;           ///< by face of the arrangement
  std::vector<std::uint8_t> is_turned;       ///< by face: it has to face the other way, out of the union
  std::size_t dropped = 0;                   ///< the number of faces that do not stay
  std::vector<std::uint32_t> turned_shells;  ///< outermost closed shells of the input that faced inwards
  bool are_consistent = true;                ///< false: it is not clear what is inside, so all faces stay
  std::size_t cells = 0;                     ///< the number of cells of the arrangement (see Cells::count)
};

/// Finds the faces of an arrangement that have solid on exactly one side. A cell is solid if the closed shells of the
/// input wind around it once or more. A closed shell that faces inwards, and around which no others wind, counts as if
/// it faced outwards. Faces of open shells say nothing of what is solid. They stay, except in the solid.
/// Input:   the triangles of which the arrangement was made, and their shells.
/// Holds:   as find_cells. If nothing is solid, all faces stay.
/// Errors:  as find_cells.
/// Cost:    as find_cells.
UnionFaces find_union(const Arrangement& arranged, std::span<const Vec3> positions, std::span<const Triangle> faces,
                      const Shells& shells, RunControl& control);

/// Drops the faces that do not stay, and the vertices that no face has then, and turns faces over.
void keep_union(Arrangement& arranged, const UnionFaces& found, RunControl& control);

/// The winding number of weighed triangles at a point that is moved by an infinitesimal: against x first, and by less
/// along y and then z. Faces that `is_left_out` names do not count. It is meant for the smallest vertex of a part, in
/// the order of coordinates: that point is moved out of the part.
class RayWinding {
 public:
  RayWinding(const WeighedFaces& faces, RunControl& control);

  template <class IsLeftOut>
  std::int32_t at(const Vec3& p, const IsLeftOut& is_left_out) const {
    std::int32_t winding = 0;
    for (const std::uint32_t f : faces_beside(p))
      if (!is_left_out(f)) winding += crossing(f, p);
    return winding;
  }

 private:
  std::vector<std::uint32_t> faces_beside(const Vec3& p) const;
  std::int32_t crossing(std::uint32_t f, const Vec3& p) const;

  WeighedFaces faces_;
  TriangleTree tree_;
};

}  // namespace remesh
