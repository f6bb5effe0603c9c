/// Makes a surface whose faces all have planes from the mesh as read, and chooses the plane tolerance.
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

/// The surface on which the later stages work, and what they need to know of it. What is derived from the surface is
/// computed at the first call, and cannot outlive a change of the surface.
class Prepared {
 public:
  std::vector<FaceId> without_area;  ///< faces without area that were not dropped
  /// The steps of decimals that explain the tolerance, per axis and in model units; 0 if none do.
  Vec3 printed_steps = {};
  /// The distance from their surface that the rounding of the coordinates explains for corners of facets, in model
  /// units: the automatic plane tolerance, or the larger distance that the digits allow without proof. It does not
  /// depend on the options.
  double rounding_tolerance = 0;
  /// The step to which the coordinates may have been rounded, proven or not, in model units.
  double printed_step = 0;

  const Surface& surface() const { return surface_; }
  /// Calls `change` with the surface, which it may change.
  /// Input:  `change` returns whether it has changed the surface.
  /// Output: the same.
  template <class Change>
  bool change(const Change& change) {
    const bool is_changed = change(surface_);
    if (is_changed) derived_ = {};
    return is_changed;
  }

  const Adjacency& adjacency(RunControl& control);
  const FaceGeometries& geometry(RunControl& control);
  const std::vector<VertexId>& pinched(RunControl& control);  ///< see pinched_vertices
  // These free memory where the data is unlikely to be needed again: together the data is as large as the surface.
  void free_derived() { derived_ = {}; }
  void free_geometry() { derived_.geometry = {}; }
  void free_adjacency() { derived_.adjacency.reset(); }
  /// Frees the data except the order of the half-edges, which the check would have to compute again.
  void free_all_but_order() {
    Derived left;
    left.order = derived_.adjacency ? std::move(*derived_.adjacency).take_order() : std::move(derived_.order);
    derived_ = std::move(left);
  }
  /// The surface's half-edges by (smaller vertex, larger vertex, half-edge). Available after free_all_but_order().
  std::span<const std::uint32_t> order() const { return derived_.order; }

 private:
  struct Derived {
    std::unique_ptr<Adjacency> adjacency;
    std::vector<std::uint32_t, DefaultInit<std::uint32_t>> order;
    FaceGeometries geometry;
    std::optional<std::vector<VertexId>> pinched;
  };

  Surface surface_;
  Derived derived_;
};

/// The part of the report that is about the input.
struct InputSummary {
  MeshStatistics statistics;   ///< those of the mesh as read, after welding its vertices
  double plane_tolerance = 0;  ///< the tolerance that is used, in model units
  bool plane_tolerance_is_automatic = true;
  double rounding_step = 0;             ///< see Report
  std::vector<Diagnostic> diagnostics;  ///< those of the reader come first
};

/// Mendings that must not be done, because an earlier attempt found that they cause failures.
struct MendingLimits {
  std::vector<std::uint8_t> keep_verbatim;  ///< one per input face, or empty; see mend_faces
  /// If false, no T-junction is split, no seam or hole is closed, and no polygon or wall is divided anew, whatever the
  /// options say.
  bool is_joining_allowed = true;
  bool operator==(const MendingLimits&) const = default;
};

/// Welds the mesh, measures it, chooses the plane tolerance, and mends the surface, in this order.
/// Input:   `summary` has the reader's diagnostics.
/// Output:  the surface, and the rest of `summary`.
/// Errors:  kEmptyMesh - no face, or none with an area; kInvalidMesh - see weld and mend_faces; kCancelled, kTimeout -
///          through `control`.
/// Cost:    O(n log n).
Prepared prepare(const PolygonMesh& input, const Options& options, const MendingLimits& limits, InputSummary& summary,
                 Stopwatch& watch, RunControl& control);

}  // namespace remesh
