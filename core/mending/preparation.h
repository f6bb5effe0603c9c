/// From the mesh as read to a surface of which every face has a plane, and the tolerance that its coordinates ask for.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/mesh.h"
#include "core/mesh/statistics.h"
#include "core/mesh/surface.h"

namespace remesh {

/// What the stages after it work on.
class Prepared {
 public:
  Surface surface;
  std::vector<FaceId> without_area;  ///< that were left so
  Vec3 printed_steps = {};           ///< model units, per axis; of decimals that explain the tolerance; 0: none do

  /// Of the surface; made when they are asked for and not there.
  const Adjacency& adjacency(RunControl& control);
  const FaceGeometries& geometry(RunControl& control);
  const std::vector<VertexId>& pinched(RunControl& control);  ///< see pinched_vertices
  /// The surface has changed, or nobody is likely to ask for them again: together they are as large as the surface.
  void release() {
    order_ = {};
    adjacency_.reset();
    pinched_.reset();
    release_geometry();
  }
  void release_geometry() { geometry_ = {}; }
  /// The same, but the order of the half-edges stays, which is what the check would have to make anew.
  void release_all_but_order() {
    auto order = adjacency_ ? std::move(*adjacency_).take_order() : std::move(order_);
    release();
    order_ = std::move(order);
  }
  /// The surface's half-edges by (smaller, larger vertex, half-edge), once all else has been released.
  std::span<const std::uint32_t> order() const { return order_; }

 private:
  std::unique_ptr<Adjacency> adjacency_;
  std::vector<std::uint32_t, LeftUnset<std::uint32_t>> order_;
  FaceGeometries geometry_;
  std::optional<std::vector<VertexId>> pinched_;
};

/// What is told of the input.
struct InputSummary {
  MeshStatistics statistics;   ///< of the mesh as read, its vertices welded
  double plane_tolerance = 0;  ///< as used, model units
  bool plane_tolerance_is_automatic = true;
  double rounding_step = 0;             ///< see Report
  std::vector<Diagnostic> diagnostics;  ///< the reader's come first
};

/// Mendings that an earlier attempt found to stand in the way.
struct MendingLimits {
  std::vector<std::uint8_t> as_it_is;  ///< per input face, or empty: see mend_faces
  bool is_joining_allowed = true;      ///< false: no T-junction is split and no seam closed, whatever options ask for
};

/// Welds, measures, chooses the plane tolerance and mends, in this order.
/// Output:  the surface; and the summary, which has the reader's diagnostics when it comes.
/// Errors:  kEmptyMesh - no face, or none with an area; kInvalidMesh - see weld and mend_faces; kCancelled, kTimeout -
///          through `control`.
/// Cost:    O(n log n).
Prepared prepare(const PolygonMesh& input, const Options& options, const MendingLimits& limits, InputSummary& summary,
                 Stopwatch& watch, RunControl& control);

}  // namespace remesh
