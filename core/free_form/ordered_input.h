/// Numbers a surface by its places, so that what is made of it does not depend on its numbers.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/free_form.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A surface in another order, with the numbers that its parts had before.
struct OrderedInput {
  IdVector<VertexId, Vec3> positions;
  IdVector<FaceId, Triangle> faces;
  std::vector<std::uint32_t> twins;
  std::vector<FreeForm::Edge> edges;
  std::vector<float> shares;              ///< empty if all are 1
  std::vector<std::uint8_t> is_of_plane;  ///< per face; empty if there are none
  std::vector<std::uint8_t> is_held;      ///< per vertex; empty if any may go
  IdVector<VertexId, VertexId> vertex_before;
  IdVector<FaceId, FaceId> face_before;
};

/// Returns places in their order along a curve that fills space. For each `turn`, the curve has another direction, so
/// that parts of the order have other borders.
/// Input:   places within the unit cube around the origin, of which no two are equal if the order is to depend on the
///          places alone.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n), in parallel.
/// Source:  Morton, A computer oriented geodetic data base and a new technique in file sequencing, 1966.
std::vector<VertexId> order_along_curve(const IdVector<VertexId, Vec3>& places, std::vector<VertexId> vertices,
                                        int turn, RunControl& control);

/// Orders the vertices along that curve, and the faces by their vertices. Each face begins with its first vertex.
/// Errors: as above, and kOutOfMemory - see MemoryBound.
/// Cost:   as above.
OrderedInput in_order(const FreeForm& input, RunControl& control);

}  // namespace remesh
