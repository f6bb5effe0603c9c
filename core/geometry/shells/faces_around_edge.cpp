#include "core/geometry/shells/faces_around_edge.h"

#include <algorithm>
#include <tuple>

#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"

namespace remesh {
namespace {

Vec2 without(const Vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

/// The side of the line from a to b on which p lies, as seen along an axis.
int side_along(const Vec3& a, const Vec3& b, const Vec3& p, int axis) {
  return orient2d(without(a, axis), without(b, axis), without(p, axis));
}

/// An axis along which one sees that the three points are not on one line; -1 if there is none.
int axis_that_tells(const Vec3& a, const Vec3& b, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis)
    if (side_along(a, b, p, axis) != 0) return axis;
  return -1;
}

/// Orders faces by their angle around the edge. The order begins at the first face and turns the way in which the
/// normals of forward faces point.
class AngularOrder {
 public:
  AngularOrder(const Vec3& a, const Vec3& b, const Vec3& first)
      : a_(a), b_(b), first_(first), axis_(axis_that_tells(a, b, first)) {}

  bool operator()(const FaceAtEdge& f, const FaceAtEdge& g) const {
    const int of_f = quarter(f.apex), of_g = quarter(g.apex);
    if (of_f != of_g) return of_f < of_g;
    // Within a half turn, the plane of one face decides.
    if (const int turn = of_f % 2 == 0 ? 0 : orient3d(a_, b_, f.apex, g.apex); turn != 0) return turn > 0;
    if (f.is_forward != g.is_forward) return f.is_forward;
    const auto key = [](const FaceAtEdge& face) { return std::tie(face.layer, face.tag); };
    return f.is_forward ? key(f) < key(g) : key(g) < key(f);
  }

 private:
  /// The part of the turn in which p lies: 0 in the direction of the first face, 1 in the half turn behind it, 2
  /// opposite to it, 3 in the other half turn.
  int quarter(const Vec3& p) const {
    const int turn = orient3d(a_, b_, first_, p);
    if (turn != 0) return turn > 0 ? 1 : 3;
    return side_along(a_, b_, p, axis_) == side_along(a_, b_, first_, axis_) ? 0 : 2;
  }

  Vec3 a_, b_, first_;
  int axis_;
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_faces_around_edge(const Vec3& a, const Vec3& b,
                                                                            std::vector<FaceAtEdge>& faces,
                                                                            const RunControl& control) {
  std::erase_if(faces, [&](const FaceAtEdge& f) { return axis_that_tells(a, b, f.apex) < 0; });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  if (faces.size() < 2) return pairs;
  sort_stoppable(faces.begin(), faces.end(), control, AngularOrder(a, b, faces[0].apex));
  // After one turn, faces that still wait for a partner are paired with the faces that came before any face waited.
  std::vector<std::uint32_t> waiting, left;
  for (const FaceAtEdge& f : faces) {
    if (!f.is_forward) {
      waiting.push_back(f.tag);
    } else if (waiting.empty()) {
      left.push_back(f.tag);
    } else {
      pairs.push_back({waiting.back(), f.tag});
      waiting.pop_back();
    }
  }
  for (std::size_t i = 0; i < left.size() && !waiting.empty(); ++i, waiting.pop_back())
    pairs.push_back({waiting.back(), left[i]});
  return pairs;
}

}  // namespace remesh
