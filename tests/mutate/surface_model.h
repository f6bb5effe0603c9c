/// A surface of polygons as the judge sees it: vertices by their coordinates, in a box of size 1.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "tests/mutate/written_mesh.h"
#include "tests/support/random.h"

namespace remesh::mutate {

/// From model units to those of the judge: x -> (x - centre) 2^-exponent.
struct Scale {
  Vec3 centre;
  int exponent = 0;

  Vec3 apply(const Vec3& p) const;
  double length(double l) const;
};

/// The scale in which the used vertices of a mesh have coordinates up to about 1.
Scale scale_of(const PolygonMesh& mesh);

/// How often an edge is run along from its smaller vertex and to it.
struct EdgeUse {
  int forward = 0, backward = 0;
};

class SurfaceModel {
 public:
  /// Input: a polygon has a plane if its corners are no further from it than `flatness`, scaled.
  SurfaceModel(const PolygonMesh& mesh, const Scale& scale, double flatness);
  SurfaceModel(const WrittenMesh& mesh, const Scale& scale);

  std::size_t face_count() const { return faces_.size(); }
  const std::vector<std::uint32_t>& face(std::size_t f) const { return faces_[f]; }
  const std::vector<Vec3>& positions() const { return positions_; }  ///< scaled
  const std::vector<Vec3>& originals() const { return originals_; }  ///< not scaled
  bool is_of_triangles() const;
  Box3 box() const;

  using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse>;
  const Edges& edges() const { return edges_; }
  /// Every edge has one face on each side, which run along it in opposite directions.
  bool is_closed_manifold() const;
  /// Every edge is run along as often in one direction as in the other.
  bool is_balanced() const;
  std::int64_t euler() const;
  /// Triangles, or polygons, whose corners are all exactly on one line.
  std::size_t faces_without_area() const;
  double area() const;
  double volume() const;
  double length_of_edges() const;

  /// How far the corners of a face are from its own plane; the extent of one whose outline crosses itself.
  double thickness(std::size_t f) const { return thickness_[f]; }
  /// Twice the area over the longest extent: small for needles and for nothing.
  double height(std::size_t f) const;
  /// Whether the outline turns back over itself at a corner: that spike has no area, and is dropped.
  bool has_spike(std::size_t f, double reach) const;
  /// A point of a face; a plane one's is within it.
  Vec3 sample(std::size_t f, Random& random) const;
  /// The distance from a point to the nearest face, or to the box of one without a plane.
  double distance(const Vec3& p) const;

 private:
  void add_face(std::vector<std::uint32_t> face);
  bool crosses_itself(const std::vector<std::uint32_t>& face, const Vec3& normal) const;
  void finish();
  bool is_over(std::size_t f, const Vec3& p) const;
  double distance(std::size_t f, const Vec3& p) const;

  double flatness_ = 0;
  std::vector<Vec3> originals_, positions_;
  std::vector<std::vector<std::uint32_t>> faces_;
  std::vector<Vec3> normals_;  ///< of faces; twice their area long
  std::vector<double> thickness_;
  std::vector<Box3> boxes_;
  Edges edges_;
};

}  // namespace remesh::mutate
