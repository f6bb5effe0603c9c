#include "core/geometry/patch_intersections.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/blocks.h"
#include "core/geometry/pair_search.h"
#include "core/geometry/predicates_3d.h"
#include "core/geometry/triangle_intersection.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 4096;

/// Patches of at most so many faces are looked at inside, and held against each other as a whole: they are near their
/// rim.
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

/// What lies of a face where another patch is; lengths as in Cull.
struct Part {
  Box3 box;
  std::uint32_t face;
  PatchId of, near;
};

/// Sorts out what may intersect at all. Lengths are scaled to the largest coordinate.
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

  void run() {
    find_places();
    // Faces of small patches are held against each other anyway: they ask for large patches alone.
    std::vector<PatchId> all, large;
    for (std::uint32_t p = 0; p < places_.size(); ++p) {
      all.push_back(PatchId(p));
      if (!has_few(PatchId(p))) large.push_back(PatchId(p));
    }
    if (large.empty()) all.clear();
    const TriangleTree tree_of_all = tree_of(boxes_of_patches(all)), tree_of_large = tree_of(boxes_of_patches(large));
    auto found = map_blocks<Near>(surface_.faces.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      Near near;
      for (std::size_t f = begin; f < end; ++f) {
        if (is_looked_at_inside(f)) near.faces.push_back(static_cast<std::uint32_t>(f));
        if (has_few(surface_.patch[f]))
          look_at(f, large, tree_of_large, near);
        else
          look_at(f, all, tree_of_all, near);
      }
      return near;
    });
    for (Near& near : found) {
      near_.faces.insert(near_.faces.end(), near.faces.begin(), near.faces.end());
      near_.parts.insert(near_.parts.end(), near.parts.begin(), near.parts.end());
    }
  }

  /// Faces that are held against all others among them.
  const std::vector<std::uint32_t>& faces() const { return near_.faces; }
  /// The rest: parts of faces, each near another patch.
  const std::vector<Part>& parts() const { return near_.parts; }

  TriangleTree tree_of(const std::vector<Box3>& boxes) const {
    std::vector<Vec3> corners;
    std::vector<Triangle> triangles;
    for (const Box3& box : boxes) {
      corners.push_back(box.min);
      corners.push_back(box.max);
      const std::size_t n = corners.size();
      triangles.push_back({VertexId(n - 2), VertexId(n - 1), VertexId(n - 1)});
    }
    return TriangleTree(corners, triangles, control_);
  }
  static std::vector<Box3> boxes_of(const std::vector<Part>& parts) {
    std::vector<Box3> boxes;
    boxes.reserve(parts.size());
    for (const Part& part : parts) boxes.push_back(part.box);
    return boxes;
  }

  bool is_looked_at_inside(std::size_t f) const {
    const PatchId p = surface_.patch[f];
    return has_few(p) || surface_.simple[p.value] == 0;
  }

 private:
  struct Near {
    std::vector<std::uint32_t> faces;
    std::vector<Part> parts;
  };

  bool has_few(PatchId p) const { return count_[p.value] <= kFewFaces; }
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

  std::array<double, 3> heights(std::size_t f, std::size_t patch) const {
    const Vec3& n = surface_.normals[patch];
    return {dot(n, corner(f, 0)), dot(n, corner(f, 1)), dot(n, corner(f, 2))};
  }

  void find_places() {
    places_.resize(surface_.normals.size());
    for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
      if (f % kBlock == 0) control_.check();
      const std::size_t p = surface_.patch[f].value;
      const auto at = heights(f, p);
      places_[p].add(box_of(f), *std::min_element(at.begin(), at.end()) - kHeightMargin,
                     *std::max_element(at.begin(), at.end()) + kHeightMargin);
    }
    // A patch without faces is nowhere.
    for (Place& place : places_)
      if (place.box.is_empty()) place.box = {Vec3{2, 2, 2}, Vec3{2, 2, 2}};
  }

  std::vector<Box3> boxes_of_patches(const std::vector<PatchId>& patches) const {
    std::vector<Box3> boxes;
    boxes.reserve(patches.size());
    for (const PatchId p : patches) boxes.push_back(places_[p.value].box);
    return boxes;
  }

  /// Finds the parts of a face that are near patches; `tree` has the boxes of these.
  void look_at(std::size_t f, const std::vector<PatchId>& patches, const TriangleTree& tree, Near& near) const {
    const PatchId own = surface_.patch[f];
    tree.visit_meeting(box_of(f), 0, [&](std::size_t slot) {
      const PatchId p = patches[tree.face(slot).value];
      if (p == own) return true;
      const Box3 box = part_near(f, p);
      if (!box.is_empty()) near.parts.push_back({box, static_cast<std::uint32_t>(f), own, p});
      return true;
    });
  }

  /// The box of what lies of a face where a patch is, by height over that patch's plane; empty if nothing does, or if
  /// it is not where the patch's box is. Of a needle that only touches the patch with its short side, that is this side
  /// alone.
  Box3 part_near(std::size_t f, PatchId patch) const {
    const Place& place = places_[patch.value];
    const double low = place.low - kHeightMargin, high = place.high + kHeightMargin;
    const std::array<double, 3> height = heights(f, patch.value);
    Box3 box;
    for (int i = 0; i < 3; ++i) {
      if (height[i] >= low && height[i] <= high) box.add(corner(f, i));
      const int j = (i + 1) % 3;
      const double rise = height[j] - height[i];
      for (const double level : {low, high}) {
        if ((height[i] < level) == (height[j] < level)) continue;
        // Where the side crosses the level, as well as rounded heights tell.
        const double t = (level - height[i]) / rise, doubt = 2 * kHeightMargin / std::fabs(rise);
        for (const double s : {t - doubt, t + doubt})
          box.add(corner(f, i) + std::clamp(s, 0.0, 1.0) * (corner(f, j) - corner(f, i)));
      }
    }
    if (box.is_empty()) return box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] -= kHeightMargin;
      box.max[axis] += kHeightMargin;
    }
    return do_meet(box, place.box) ? box : Box3{};
  }

  const PatchedFaces& surface_;
  RunControl& control_;
  double scale_ = 1;
  std::vector<std::uint32_t> count_;  ///< faces of each patch
  std::vector<Place> places_;
  Near near_;
};

}  // namespace

SelfIntersections patch_intersections(const PatchedFaces& surface, std::size_t max_pairs, RunControl& control) {
  Cull cull(surface, control);
  cull.run();
  // Between small patches and inside patches: whole faces.
  std::vector<Triangle> faces;
  std::vector<std::uint32_t> pieces;
  for (const std::uint32_t f : cull.faces()) {
    faces.push_back(surface.faces[f]);
    pieces.push_back(cull.is_looked_at_inside(f) ? kNoPiece : surface.patch[f].value);
  }
  SelfIntersections found = self_intersections(surface.positions, faces, pieces, max_pairs, control);
  for (auto& [f, g] : found.pairs) {
    f = FaceId(cull.faces()[f.value]);
    g = FaceId(cull.faces()[g.value]);
  }
  // Where one of two patches is large: each face only where the other patch is.
  const std::vector<Part>& parts = cull.parts();
  const std::vector<Vec3> positions = scaled_for_predicates(surface.positions);
  const TriangleTree tree = cull.tree_of(Cull::boxes_of(parts));
  const auto part = [&](std::size_t slot) -> const Part& { return parts[tree.face(slot).value]; };
  find_pairs(
      tree, 0, [&](std::size_t slot) { return FaceId(part(slot).face); },
      [](std::size_t, std::size_t) { return false; },
      [&](std::size_t slot, std::size_t other) {
        const Part &a = part(slot), &b = part(other);
        return a.of == b.near && a.near == b.of &&
               do_intersect(surface.faces[a.face], surface.faces[b.face], positions);
      },
      max_pairs, found, control);
  std::sort(found.pairs.begin(), found.pairs.end());
  found.pairs.erase(std::unique(found.pairs.begin(), found.pairs.end()), found.pairs.end());
  if (found.pairs.size() > max_pairs) found.pairs.resize(max_pairs);
  return found;
}

}  // namespace remesh
