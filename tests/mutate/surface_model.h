/// A surface of polygons in the form that the judge uses: vertices are identified by their coordinates, in a box of
/// size 1.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "tests/support/random.h"
#include "tests/support/written_mesh.h"

namespace remesh::mutate {

using test::WrittenMesh;

/// Converts model units to those of the judge: x -> (x - centre) 2^-exponent.
struct Scale {
  Vec3 centre;
  int exponent = 0;

  Vec3 apply(const Vec3& p) const;
  double length(double l) const;
};

/// Returns the scale in which the used vertices of a mesh have coordinates up to about 1.
Scale scale_of(const PolygonMesh& mesh);

/// The number of times that faces use an edge from its smaller vertex and towards it.
struct EdgeUse {
  int forward = 0, backward = 0;
};

class SurfaceModel {
 public:
  /// Input: `flatness` - a polygon has a plane if its corners are no further from it than this, scaled.
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
  /// True if every edge has one face on each side, which use it in opposite directions.
  bool is_closed_manifold() const;
  /// True if every edge is used equally often in both directions.
  bool is_balanced() const;
  std::int64_t euler() const;
  /// Returns the number of triangles and polygons whose corners are all exactly on one line.
  std::size_t faces_without_area() const;
  double area() const;
  double volume() const;
  /// By how much the volume may be wrong: among vertices that are very far apart, its terms cancel each other.
  double rounding_of_volume() const;
  double length_of_edges() const;

  /// How far the corners of a face are from its own plane. For a face whose outline crosses itself it is the face's
  /// extent.
  double thickness(std::size_t f) const { return thickness_[f]; }
  /// Twice the area divided by the longest extent. It is small for needles, and for faces without area.
  double height(std::size_t f) const;
  /// True if the outline turns back over itself at a corner. Such a spike has no area and is dropped.
  bool has_spike(std::size_t f, double reach) const;
  /// Returns a point of a face. For a plane face, the point is within it.
  Vec3 sample(std::size_t f, Random& random) const;
  /// Returns the distance from a point to the nearest face. For a face without a plane, its box is used.
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
  std::vector<Vec3> normals_;  ///< the faces' normals; each is as long as twice the area of its face
  std::vector<double> thickness_;
  std::vector<Box3> boxes_;
  Edges edges_;
};

}  // namespace remesh::mutate
