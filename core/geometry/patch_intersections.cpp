#include "core/geometry/patch_intersections.h"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 4096;

/// Patches of at most so many faces are looked at inside, and all their faces are taken: they are near their rim.
constexpr std::uint32_t kFewFaces = 16;

/// Heights are sums of three products: their rounding, of the largest coordinate.
constexpr double kHeightMargin = 0x1p-49;

/// Where a patch is: its box, and its heights along its normal.
struct Place {
  Box3 box;
  double low = HUGE_VAL, high = -HUGE_VAL;

  void add(const Box3& b, double from, double to) {
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = std::min(box.min[axis], b.min[axis]);
      box.max[axis] = std::max(box.max[axis], b.max[axis]);
    }
    low = std::min(low, from);
    high = std::max(high, to);
  }
};

class Cull {
 public:
  Cull(const PatchedFaces& surface, RunControl& control) : surface_(surface), control_(control) {
    double largest = 0;
    for (const Vec3& p : surface.positions)
      largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    // Without overflow for any magnitude, and exactly.
    int exponent = 0;
    std::frexp(largest, &exponent);
    scale_ = std::ldexp(1.0, -std::clamp(exponent, -1000, 1000));
    count_.assign(surface.normals.size(), 0);
    for (const PatchId p : surface.patch) ++count_[p.value];
  }

  /// Faces that may meet one of another patch, or of their own where that is looked at inside.
  std::vector<std::uint32_t> candidates() {
    find_places();
    std::vector<Vec3> corners;
    std::vector<Triangle> boxes;
    for (const Place& place : places_) {
      corners.push_back(place.box.min);
      corners.push_back(place.box.max);
      const std::size_t n = corners.size();
      boxes.push_back({VertexId(n - 2), VertexId(n - 1), VertexId(n - 1)});
    }
    const TriangleTree tree(corners, boxes, control_);
    const auto found = map_blocks<std::vector<std::uint32_t>>(
        surface_.faces.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
          std::vector<std::uint32_t> near;
          for (std::size_t f = begin; f < end; ++f)
            if (is_looked_at_inside(f) || is_near_another(f, tree)) near.push_back(static_cast<std::uint32_t>(f));
          return near;
        });
    std::vector<std::uint32_t> all;
    for (const auto& near : found) all.insert(all.end(), near.begin(), near.end());
    return all;
  }

  bool is_looked_at_inside(std::size_t f) const {
    const std::size_t p = surface_.patch[f].value;
    return count_[p] <= kFewFaces || surface_.simple[p] == 0;
  }

 private:
  Vec3 corner(std::size_t f, int i) const { return scale_ * surface_.positions[surface_.faces[f][i].value]; }

  Box3 box_of(std::size_t f) const {
    Box3 box{corner(f, 0), corner(f, 0)};
    for (int i = 1; i < 3; ++i) {
      const Vec3 p = corner(f, i);
      for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::min(box.min[axis], p[axis]);
        box.max[axis] = std::max(box.max[axis], p[axis]);
      }
    }
    return box;
  }

  std::pair<double, double> heights(std::size_t f, std::size_t patch) const {
    const Vec3& n = surface_.normals[patch];
    const double a = dot(n, corner(f, 0)), b = dot(n, corner(f, 1)), c = dot(n, corner(f, 2));
    return std::minmax({a, b, c});
  }

  void find_places() {
    places_.resize(surface_.normals.size());
    for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
      if (f % kBlock == 0) control_.check();
      const std::size_t p = surface_.patch[f].value;
      const auto [low, high] = heights(f, p);
      places_[p].add(box_of(f), low - kHeightMargin, high + kHeightMargin);
    }
    // A patch without faces is nowhere.
    for (Place& place : places_)
      if (place.box.is_empty()) place.box = {Vec3{2, 2, 2}, Vec3{2, 2, 2}};
  }

  bool is_near_another(std::size_t f, const TriangleTree& tree) const {
    bool is_near = false;
    tree.visit_meeting(box_of(f), 0, [&](std::size_t slot) {
      const std::size_t p = tree.face(slot).value;
      if (p == surface_.patch[f].value) return true;
      const auto [low, high] = heights(f, p);
      is_near = low <= places_[p].high + kHeightMargin && high >= places_[p].low - kHeightMargin;
      return !is_near;
    });
    return is_near;
  }

  const PatchedFaces& surface_;
  RunControl& control_;
  double scale_ = 1;
  std::vector<std::uint32_t> count_;  ///< faces of each patch
  std::vector<Place> places_;
};

}  // namespace

SelfIntersections patch_intersections(const PatchedFaces& surface, std::size_t max_pairs, RunControl& control) {
  Cull cull(surface, control);
  const std::vector<std::uint32_t> near = cull.candidates();
  std::vector<Triangle> faces;
  std::vector<std::uint32_t> pieces;
  faces.reserve(near.size());
  pieces.reserve(near.size());
  for (const std::uint32_t f : near) {
    faces.push_back(surface.faces[f]);
    pieces.push_back(cull.is_looked_at_inside(f) ? kNoPiece : surface.patch[f].value);
  }
  SelfIntersections found = self_intersections(surface.positions, faces, pieces, max_pairs, control);
  // The numbers ascend, so the pairs stay sorted.
  for (auto& [f, g] : found.pairs) {
    f = FaceId(near[f.value]);
    g = FaceId(near[g.value]);
  }
  return found;
}

}  // namespace remesh
