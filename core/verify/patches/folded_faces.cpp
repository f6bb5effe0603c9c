#include "core/verify/patches/folded_faces.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/triangles/distances.h"

namespace remesh::verification {
namespace {

using Boxes = BoxTree<NoTag>;

Corners3 corners_of(const NumberedClaim& numbered, std::uint32_t output_face) {
  const auto face = numbered.output.face(output_face);
  return {numbered.output_point(face[0]), numbered.output_point(face[1]), numbered.output_point(face[2])};
}

/// The distance of points from the output's triangles of one patch.
class OutputDistance {
 public:
  OutputDistance(const NumberedClaim& numbered, std::size_t patch, RunControl& control)
      : numbered_(numbered), faces_(numbered.output_by_patch[patch]), control_(control) {
    const auto entries = Boxes::make_entries(faces_.size(), control, [&](std::size_t i, Boxes::Entry& entry) {
      for (const Vec3& p : corners_of(numbered, faces_[i])) entry.box.add(p);
    });
    boxes_ = Boxes(entries, control);
  }

  double from(const Vec3& p) const {
    control_.check();
    double nearest = HUGE_VAL;
    boxes_.search(
        nearest, [&](const Boxes::Entry& e) { return squared_distance(e.box, p); },
        [&](std::size_t slot) {
          const Vec3 q = nearest_on_triangle(p, corners_of(numbered_, faces_[boxes_.number(slot)]));
          nearest = std::min(nearest, norm_squared(q - p));
        });
    return std::sqrt(nearest);
  }

 private:
  const NumberedClaim& numbered_;
  const std::span<const std::uint32_t> faces_;
  RunControl& control_;
  Boxes boxes_;
};

/// Returns the max number of times that a face is divided into four.
int max_depth(std::size_t folded) {
  constexpr std::size_t kFew = 64, kMany = 4096;
  return folded <= kFew ? 4 : folded <= kMany ? 2 : 1;
}

/// Returns the largest distance of places of a triangle, or `farthest` if no place is farther.
double farthest_place(const Corners3& triangle, const OutputDistance& distance, double known, int depth,
                      double farthest) {
  struct Piece {
    Corners3 corners;
    int depth;
  };
  /// Places that are farther by less than this factor are not searched.
  constexpr double kEnough = 1.25;
  std::vector<Piece> pieces{{triangle, depth}};
  while (!pieces.empty()) {
    const auto [corners, left] = pieces.back();
    pieces.pop_back();
    const auto& [a, b, c] = corners;
    const Vec3 centre = (1.0 / 3) * (a + b + c);
    const double here = distance.from(centre);
    farthest = std::max(farthest, here);
    const double radius = std::max({norm(a - centre), norm(b - centre), norm(c - centre)});
    if (left == 0 || here + radius <= kEnough * std::max(known, farthest)) continue;
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const Corners3& part : {Corners3{a, ab, ca}, Corners3{ab, b, bc}, Corners3{ca, bc, c}, Corners3{ab, bc, ca}})
      pieces.push_back({part, left - 1});
  }
  return farthest;
}

}  // namespace

double farthest_of_folded(const NumberedClaim& numbered, std::size_t patch, std::span<const std::uint32_t> folded,
                          double known, RunControl& control) {
  if (folded.empty()) return 0;
  std::vector<VertexId> gone;
  StopCheck check(control);
  for (const std::uint32_t f : folded)
    for (const VertexId v : numbered.input.face(f)) {
      check();
      if (numbered.is_in_output[v.value] == 0) gone.push_back(v);
    }
  sort_unique(gone, control);

  const OutputDistance distance(numbered, patch, control);
  double farthest = 0;
  for (const VertexId v : gone) farthest = std::max(farthest, distance.from(numbered.points[v.value]));
  const int depth = max_depth(folded.size());
  for (const std::uint32_t f : folded) {
    const auto face = numbered.input.face(f);
    const auto corner = [&](std::size_t k) { return numbered.points[face[k].value]; };
    // The triangles of the fan cover the polygon, even where it is not convex.
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      farthest = farthest_place({corner(0), corner(k), corner(k + 1)}, distance, known, depth, farthest);
  }
  return farthest;
}

}  // namespace remesh::verification
