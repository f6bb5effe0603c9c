#include "core/geometry/patch_intersections.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/base/blocks.h"
#include "core/geometry/largest_coordinate.h"
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

/// So many faces of a patch are asked for at once, whether any is near another patch.
constexpr std::size_t kRun = 32;

/// Heights are sums of three products: their rounding, of the largest coordinate.
constexpr double kHeightMargin = 0x1p-49;

/// Where a patch is: its box, and its heights along its normal.
struct Place {
  Box3 box;
  double low = HUGE_VAL, high = -HUGE_VAL;
};

/// A place to which several threads add at once; what it comes to does not depend on their order.
class SharedPlace {
 public:
  SharedPlace() {
    for (auto& bound : bounds_) bound.store(-HUGE_VAL, std::memory_order_relaxed);
  }

  void add(const Place& place) {
    const auto& [min, max] = place.box;
    const std::array<double, 8> bounds = {-min.x, -min.y, -min.z, max.x, max.y, max.z, -place.low, place.high};
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      double known = bounds_[i].load(std::memory_order_relaxed);
      while (known < bounds[i] && !bounds_[i].compare_exchange_weak(known, bounds[i], std::memory_order_relaxed)) {
      }
    }
  }
  Place get() const {
    const auto bound = [&](std::size_t i) { return bounds_[i].load(std::memory_order_relaxed); };
    return {{{-bound(0), -bound(1), -bound(2)}, {bound(3), bound(4), bound(5)}}, -bound(6), bound(7)};
  }

 private:
  std::array<std::atomic<double>, 8> bounds_;  ///< upper ones, and lower ones with their signs changed
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
  Cull(const PatchedFaces& surface, RunControl& control)
      : surface_(surface), control_(control), count_(surface.normals.size()), places_(surface.normals.size()) {
    // Without overflow for any magnitude, and exactly.
    int exponent = 0;
    std::frexp(largest_coordinate(surface.positions, control), &exponent);
    scale_ = std::ldexp(1.0, -std::clamp(exponent, -1000, 1000));
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
    auto found = map_blocks<Near>(surface_.face_count(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      Near near;
      while (begin < end) {
        const std::size_t run_end = end_of_run(begin, std::min(end, begin + kRun));
        const bool is_few = has_few(surface_.patch[begin]);
        const std::vector<PatchId>& patches = is_few ? large : all;
        const TriangleTree& tree = is_few ? tree_of_large : tree_of_all;
        const bool is_inside = is_looked_at_inside(begin), is_near = is_near_others(begin, run_end, patches, tree);
        for (; begin < run_end; ++begin) {
          if (is_inside) near.faces.push_back(static_cast<std::uint32_t>(begin));
          if (is_near) look_at(begin, patches, tree, near);
        }
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

  bool has_few(PatchId p) const { return count_[p.value].load(std::memory_order_relaxed) <= kFewFaces; }
  Vec3 corner(std::size_t f, int i) const { return scale_ * surface_.positions[surface_.corners[3 * f + i].value]; }

  Box3 box_of(std::size_t f) const {
    Box3 box;
    for (int i = 0; i < 3; ++i) box.add(corner(f, i));
    return box;
  }

  /// Where the faces of one patch that begin there end, at most at `last`.
  std::size_t end_of_run(std::size_t begin, std::size_t last) const {
    std::size_t end = begin + 1;
    while (end < last && surface_.patch[end] == surface_.patch[begin]) ++end;
    return end;
  }

  /// May some of these faces of one patch be near another one? Asked for a run at once, most are not.
  bool is_near_others(std::size_t begin, std::size_t end, const std::vector<PatchId>& patches,
                      const TriangleTree& tree) const {
    Box3 box;
    if (end - begin == kRun)
      box = boxes_of_runs_[begin / kRun];
    else
      for (std::size_t f = begin; f < end; ++f) box.add(box_of(f));
    bool is_near = false;
    tree.visit_meeting(box, 0, [&](std::size_t slot) {
      is_near = patches[tree.face(slot).value] != surface_.patch[begin];
      return !is_near;
    });
    return is_near;
  }

  std::array<double, 3> heights(std::size_t f, std::size_t patch) const {
    const Vec3& n = surface_.normals[patch];
    return {dot(n, corner(f, 0)), dot(n, corner(f, 1)), dot(n, corner(f, 2))};
  }

  /// Also counts the faces of each patch.
  void find_places() {
    boxes_of_runs_.resize(surface_.face_count() / kRun + 1);
    for_blocks(surface_.face_count(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      while (begin < end) {
        const PatchId p = surface_.patch[begin];
        const std::size_t first = begin, run_end = end_of_run(begin, std::min(end, begin + kRun));
        count_[p.value].fetch_add(static_cast<std::uint32_t>(run_end - begin), std::memory_order_relaxed);
        const Vec3 normal = surface_.normals[p.value];
        Place place;
        for (; begin < run_end; ++begin)
          for (int i = 0; i < 3; ++i) {
            const Vec3 at = corner(begin, i);
            place.box.add(at);
            const double height = dot(normal, at);
            place.low = std::min(place.low, height);
            place.high = std::max(place.high, height);
          }
        if (run_end - first == kRun) boxes_of_runs_[first / kRun] = place.box;
        place.low -= kHeightMargin;
        place.high += kHeightMargin;
        places_[p.value].add(place);
      }
    });
  }

  /// A patch without faces is nowhere.
  Box3 box_of_patch(PatchId p) const {
    const Box3 box = places_[p.value].get().box;
    return box.is_empty() ? Box3{Vec3{2, 2, 2}, Vec3{2, 2, 2}} : box;
  }

  std::vector<Box3> boxes_of_patches(const std::vector<PatchId>& patches) const {
    std::vector<Box3> boxes;
    boxes.reserve(patches.size());
    for (const PatchId p : patches) boxes.push_back(box_of_patch(p));
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
    const Place place = places_[patch.value].get();
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
  std::vector<std::atomic<std::uint32_t>> count_;  ///< faces of each patch
  std::vector<SharedPlace> places_;
  std::vector<Box3> boxes_of_runs_;  ///< of those that are full: each begins among faces of its own
  Near near_;
};

/// What is left of a surface, with vertices of its own: where patches are large, they are few. They stand in the order
/// in which they were.
class Excerpt {
 public:
  Excerpt(const PatchedFaces& surface, const Cull& cull, RunControl& control) : surface_(surface) {
    if (cull.faces().empty() && cull.parts().empty()) return;
    std::vector<std::uint8_t> is_left(surface.positions.size(), 0);
    const auto mark = [&](std::size_t f) {
      for (const VertexId v : surface.face(f)) std::atomic_ref(is_left[v.value]).store(1, std::memory_order_relaxed);
    };
    for_blocks(cull.faces().size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) mark(cull.faces()[i]);
    });
    for (const Part& part : cull.parts()) mark(part.face);
    const auto left =
        select_ids<VertexId>(is_left.size(), kBlock, control, [&](std::size_t v) { return is_left[v] != 0; });
    number_.resize(is_left.size());
    positions_.resize(left.size());
    for_blocks(left.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        number_[left[i].value] = static_cast<std::uint32_t>(i);
        positions_[i] = surface.positions[left[i].value];
      }
    });
  }

  const std::vector<Vec3>& positions() const { return positions_; }
  /// A face of the surface that is left.
  Triangle face(std::size_t f) const {
    const auto [a, b, c] = surface_.face(f);
    return {VertexId(number_[a.value]), VertexId(number_[b.value]), VertexId(number_[c.value])};
  }

 private:
  const PatchedFaces& surface_;
  std::vector<std::uint32_t> number_;  ///< of the surface's vertices
  std::vector<Vec3> positions_;
};

}  // namespace

SelfIntersections patch_intersections(const PatchedFaces& surface, std::size_t max_pairs, RunControl& control) {
  Cull cull(surface, control);
  cull.run();
  const Excerpt excerpt(surface, cull, control);
  // Between small patches and inside patches: whole faces.
  std::vector<Triangle> faces(cull.faces().size());
  std::vector<std::uint32_t> pieces(cull.faces().size());
  for_blocks(faces.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t f = cull.faces()[i];
      faces[i] = excerpt.face(f);
      pieces[i] = cull.is_looked_at_inside(f) ? kNoPiece : surface.patch[f].value;
    }
  });
  SelfIntersections found = self_intersections(excerpt.positions(), faces, pieces, max_pairs, control);
  for (auto& [f, g] : found.pairs) {
    f = FaceId(cull.faces()[f.value]);
    g = FaceId(cull.faces()[g.value]);
  }
  // Where one of two patches is large: each face only where the other patch is.
  const std::vector<Part>& parts = cull.parts();
  const std::vector<Vec3> positions = scaled_for_predicates(excerpt.positions(), control);
  const TriangleTree tree = cull.tree_of(Cull::boxes_of(parts));
  const auto part = [&](std::size_t slot) -> const Part& { return parts[tree.face(slot).value]; };
  find_pairs(
      tree, 0, [&](std::size_t slot) { return FaceId(part(slot).face); },
      [](std::size_t, std::size_t) { return false; },
      [&](std::size_t slot, std::size_t other) {
        const Part &a = part(slot), &b = part(other);
        return a.of == b.near && a.near == b.of && do_intersect(excerpt.face(a.face), excerpt.face(b.face), positions);
      },
      max_pairs, found, control);
  std::sort(found.pairs.begin(), found.pairs.end());
  found.pairs.erase(std::unique(found.pairs.begin(), found.pairs.end()), found.pairs.end());
  if (found.pairs.size() > max_pairs) found.pairs.resize(max_pairs);
  return found;
}

}  // namespace remesh
