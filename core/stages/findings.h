/// What is found in the input without changing it.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_intersections.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/report.h"
#include "core/stages/patches.h"

namespace remesh {

/// Reports, from a welded surface: non_manifold_edge and open_boundary (elements: the input faces at such edges), and
/// non_manifold_vertex (elements: vertices where faces meet that are not connected there over edges).
/// Input:   as pinched_vertices finds them.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
void find_defects(const Surface& welded, const Adjacency& edges, std::span<const VertexId> pinched,
                  std::vector<Diagnostic>& diagnostics, RunControl& control);

/// A surface's faces as triangles, polygons split by split_polygon, less their spikes. Looks into the surface: where
/// that has nothing but triangles, they are its own.
class Triangulated {
 public:
  /// The tolerance is in local units. A surface that has been mended has no spikes, and needs none.
  explicit Triangulated(const Surface& surface, RunControl& control, double tolerance = 0);

  /// Has the surface other polygons?
  bool are_split() const { return are_split_; }
  std::size_t size() const { return corners().size() / 3; }
  /// Three a triangle.
  std::span<const VertexId> corners() const { return are_split() ? std::span(corners_) : surface_->corners.items(); }
  Triangle triangle(std::size_t t) const { return {corners()[3 * t], corners()[3 * t + 1], corners()[3 * t + 2]}; }
  /// The face that a triangle is of; ascending.
  FaceId face(std::size_t t) const { return are_split() ? face_[t] : FaceId(t); }
  /// The first triangle of a face.
  std::size_t first_of(FaceId f) const;
  /// By how much the triangles' area is more than the faces'. A flat polygon that crosses itself has the area that its
  /// outline winds around, counted with its sign (Newell); the fan that stands for it covers more. One that is not flat
  /// has no other area than its triangles have. In local units.
  double excess_area() const { return excess_area_; }

 private:
  const Surface* surface_;
  bool are_split_;
  std::vector<VertexId> corners_;
  std::vector<FaceId> face_;
  double excess_area_ = 0;
};

/// Faces of a surface that intersect, in pairs.
struct FoundIntersections {
  std::vector<std::pair<FaceId, FaceId>> pairs;  ///< sorted, the smaller face first, each pair once
  bool is_complete = true;                       ///< false: there are more
};

/// At most so many pairs are looked for: beyond, the surface lies on itself all over.
inline constexpr std::size_t kMostIntersections = 100'000;

/// Finds the faces that intersect, but for those inside one large simple patch; a polygon and a face with an edge on
/// one of its diagonals are such, too. Reports self_intersection and overlapping_faces (coplanar within the tolerance,
/// model units): pairs; elements are input faces.
FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
