/// The triangles of a surface while details are removed from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/base/work_bound.h"
#include "core/mending/details/detail_map.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A triangle of the surface as it is now.
struct PresentTriangle {
  std::uint32_t index;
  std::array<std::uint32_t, 3> corners;  ///< nodes

  bool has(std::uint32_t node) const { return corners[0] == node || corners[1] == node || corners[2] == node; }
  /// Returns the position of a node among the corners. The triangle must have the node.
  int at(std::uint32_t node) const { return corners[0] == node ? 0 : corners[1] == node ? 1 : 2; }
};

/// Triangles whose corners are joined, and whose edges are cut. A node is a vertex of the surface as it is now. It
/// stands for all points (DetailMap) that have been joined to it. Triangles that have lost their area because two of
/// their corners are one node are kept as pieces of the map, but are no longer present.
class DetailComplex {
 public:
  /// Makes one node for each position, with the same number.
  DetailComplex(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control);

  const Vec3& place(std::uint32_t node) const { return place_[node]; }
  std::size_t point_count() const { return place_.size(); }
  std::size_t triangle_count() const { return points_.size(); }
  FaceId face_of(std::uint32_t triangle) const { return of_[triangle]; }
  /// Returns the node to which a point belongs.
  std::uint32_t node_of(std::uint32_t point) const;
  /// Returns whether a triangle has not been cut and has three different nodes, which it writes to `present`.
  bool find_present(std::uint32_t triangle, PresentTriangle& present) const;
  /// Collects the triangles that are present at a node. Counts the triangles as work.
  void collect(std::uint32_t node, std::vector<PresentTriangle>& triangles, WorkBound& work) const;

  /// Returns the max distance of the points of a node from a place.
  double reach(std::uint32_t node, const Vec3& place) const { return farthest(box_[node], place); }
  /// Returns the max distance of the points on an edge, at this share of the way, from a place.
  double reach_on_edge(std::uint32_t from, std::uint32_t to, double at, const Vec3& place) const;
  Vec3 place_on_edge(std::uint32_t from, std::uint32_t to, double at) const {
    return place_[from] + at * (place_[to] - place_[from]);
  }

  /// Joins the node `from` to the node `to`, which keeps its place.
  void join(std::uint32_t from, std::uint32_t to);
  /// Cuts an edge, and all triangles at it, and returns the new node on it.
  std::uint32_t cut(std::uint32_t from, std::uint32_t to, double at, WorkBound& work);

  /// Moves the pieces and cuts out of this object. The images of points are nodes.
  DetailMap take_map();

 private:
  static double farthest(const Box3& box, const Vec3& place);
  Box3 box_on_edge(std::uint32_t from, std::uint32_t to, double at) const;
  std::uint32_t add_point(const Vec3& place, const Box3& box);
  std::uint32_t add_triangle(const std::array<std::uint32_t, 3>& points, FaceId of);

  // By point.
  mutable std::vector<std::uint32_t> parent_;  ///< the tree of joined points; the root is the node
  std::vector<Vec3> place_;
  std::vector<Box3> box_;                    ///< of the original places of the node's points
  std::vector<std::uint32_t> first_, last_;  ///< the list of corners at a node; kNone if there are none
  std::vector<DetailMap::Cut> cuts_;
  // By triangle.
  std::vector<std::array<std::uint32_t, 3>> points_;
  std::vector<FaceId> of_;
  std::vector<std::uint8_t> is_cut_;
  std::vector<std::uint32_t> next_;  ///< three per triangle: the next corner at the same node
};

}  // namespace remesh
