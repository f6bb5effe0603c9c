/// Says where the triangles of a soup are to be cut.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/solids/soup.h"

namespace remesh {

/// Says what is cut where. Each fact stands in it once, for all triangles that it concerns, so that neighbours agree.
/// New points have been appended to the positions of the soup.
struct CutPlan {
  /// A piece of a curve or of an edge that lies in a face and becomes an edge there.
  struct Constraint {
    FaceId face;
    VertexId from, to;
    friend auto operator<=>(const Constraint&, const Constraint&) = default;
  };

  std::vector<VertexId> image;  ///< what each vertex becomes: itself, or another vertex that stays; empty: all stay
  std::vector<std::pair<EdgeId, VertexId>> on_edges;
  std::vector<std::pair<FaceId, VertexId>> in_faces;
  std::vector<Constraint> constraints;
  std::vector<std::pair<FaceId, FaceId>> in_one_plane;  ///< faces that lie on each other and get the same triangles
  bool are_all_apart = false;  ///< it is known that no two faces meet anywhere but in what they share

  bool is_empty() const {
    return image.empty() && on_edges.empty() && in_faces.empty() && constraints.empty() && in_one_plane.empty();
  }
  std::size_t size() const {
    return on_edges.size() + in_faces.size() + constraints.size() + in_one_plane.size() + (image.empty() ? 0 : 1);
  }
  VertexId image_of(VertexId v) const { return image.empty() ? v : image[v.value]; }
};

/// The polylines that the sides of triangles become by a plan.
class CutSides {
 public:
  /// Sorts the points on the edges of the plan, and drops repeated ones.
  /// Input:  the arguments must outlive this object.
  CutSides(const Soup& soup, const SoupEdges& edges, CutPlan& plan, RunControl& control);

  bool has_points(EdgeId e) const { return begin_[e.value] != begin_[e.value + 1]; }
  /// Appends the points from corner k of a face up to the next corner, without the latter. Points that are the same
  /// after one another are appended once.
  void append_side(FaceId f, std::size_t k, std::vector<VertexId>& points) const;
  /// Appends the three sides of a face: its outline.
  void append_outline(FaceId f, std::vector<VertexId>& points) const;

 private:
  const Soup& soup_;
  const SoupEdges& edges_;
  const CutPlan& plan_;
  std::vector<std::uint32_t> begin_;  ///< by edge: where its points begin in plan_.on_edges
};

}  // namespace remesh
