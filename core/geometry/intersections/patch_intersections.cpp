#include "core/geometry/intersections/patch_intersections.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <numeric>
#include <tuple>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/loop_progress.h"
#include "core/base/prefault_pages.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/intersections/pair_search.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/triangle_intersection.h"

namespace remesh {
namespace {

constexpr std::size_t kPatchBlock = 4096;

/// The number of tests between two checks for cancellation.
constexpr std::uint32_t kTestsBetweenChecks = 4096;

/// The number of faces of a patch that are tested together for being near another patch.
constexpr std::size_t kRun = 32;

/// If up to this many patches are near a run of faces, each face is tested against all of them. If there are more, they
/// are looked up in the tree for each face.
constexpr std::size_t kFewPatches = 16;

/// If sheets lie in one another, each face is near many patches. If faces have more parts than this on average, culling
/// by patches gains nothing, and the parts would take all memory.
constexpr std::size_t kMaxPartsPerFace = 4;
constexpr std::size_t kManyParts = 1 << 16;

/// Culling by patches gains nothing if it needs more than this many tests per face of whether the face is near a patch.
/// For example, if the facets of a cone stand on a fan of needles, all boxes meet all others in one point.
constexpr std::size_t kMaxLooksPerFace = 64;

/// The rounding error of heights, relative to the largest coordinate. Heights are sums of three products.
constexpr double kHeightMargin = 0x1p-49;

/// The extent of a patch: its box, and its heights along its normal.
struct Place {
  Box3 box;
  double low = HUGE_VAL, high = -HUGE_VAL;
};

/// A Place to which several threads may add at once. The result does not depend on their order.
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
  std::array<std::atomic<double>, 8> bounds_;  ///< the upper bounds, and the negated lower bounds
};

/// The part of a face that lies where another patch is. Lengths are as in Cull.
struct Part {
  Box3 box;
  std::uint32_t face;
  PatchId of, near;
};

/// Finds the faces and parts of faces that may intersect at all. Lengths are scaled to the largest coordinate.
class Cull {
 public:
  Cull(const PatchedFaces& surface, RunControl& control)
      : surface_(surface), control_(control), count_(surface.normals.size()) {
    // The scale is a power of two, so that scaling is exact. Nothing overflows, whatever the coordinates' magnitude.
    int exponent = 0;
    std::frexp(largest_coordinate(surface.positions, control), &exponent);
    scale_ = std::ldexp(1.0, -std::clamp(exponent, -1000, 1000));
  }

  void run() {
    count_faces();
    // All faces of small patches are tested against each other in any case, so here they are compared with large
    // patches only.
    std::vector<PatchId> all, large;
    StopCheck check(control_);
    for (std::uint32_t p = 0; p < count_.size(); ++p) {
      check();
      if (!has_few(PatchId(p))) large.push_back(PatchId(p));
    }
    if (large.empty()) return compare_all();
    for (std::uint32_t p = 0; p < count_.size(); ++p) all.push_back(PatchId(p));
    find_places();
    const TriangleTree tree_of_all = tree_of(boxes_of_patches(all)), tree_of_large = tree_of(boxes_of_patches(large));
    const std::size_t most_parts = kManyParts + kMaxPartsPerFace * surface_.face_count();
    const std::size_t most_looks = kManyParts + kMaxLooksPerFace * surface_.face_count();
    std::atomic<std::size_t> parts{0}, looks{0};
    const auto are_too_many = [&](std::size_t parts_so_far, std::size_t looks_so_far) {
      return parts_so_far > most_parts || looks_so_far > most_looks;
    };
    // Blocks begin where they do in find_places, because runs do.
    LoopProgress progress(control_, surface_.face_count());
    auto found =
        map_blocks<Near>(surface_.face_count(), kPatchBlock, control_, [&](std::size_t begin, std::size_t end) {
          Near near;
          const std::size_t first = begin;
          if (are_too_many(parts.load(std::memory_order_relaxed), looks.load(std::memory_order_relaxed))) return near;
          std::vector<PatchId> near_run;
          StopCheck check_looks(control_);
          while (begin < end && !are_too_many(near.parts.size(), near.looks)) {
            const std::size_t run_end = end_of_run(begin, std::min(end, begin + kRun));
            const bool is_few = has_few(surface_.patch[begin]);
            const std::vector<PatchId>& patches = is_few ? large : all;
            const TriangleTree& tree = is_few ? tree_of_large : tree_of_all;
            const bool is_inside = is_looked_at_inside(begin);
            near.looks += find_near(begin, run_end, patches, tree, near_run, check_looks);
            for (; begin < run_end && !are_too_many(near.parts.size(), near.looks); ++begin) {
              if (is_inside) near.faces.push_back(static_cast<std::uint32_t>(begin));
              if (near_run.size() > kFewPatches)
                look_at(begin, patches, tree, near, check_looks);
              else if (!near_run.empty())
                look_at(begin, near_run, near, check_looks);
            }
          }
          parts.fetch_add(near.parts.size(), std::memory_order_relaxed);
          looks.fetch_add(near.looks, std::memory_order_relaxed);
          progress.add(end - first);
          return near;
        });
    // The order in which blocks are counted does not decide whether the counts exceed the limits.
    if (are_too_many(parts.load(std::memory_order_relaxed), looks.load(std::memory_order_relaxed)))
      return compare_all();
    parts_.reserve(parts.load(std::memory_order_relaxed));
    for (Near& near : found) {
      faces_.insert(faces_.end(), near.faces.begin(), near.faces.end());
      for (const Part& part : near.parts) {
        check();
        parts_.push_back(part);
      }
      near = {};
    }
    std::vector<SharedPlace>().swap(places_);
    std::vector<Box3>().swap(boxes_of_runs_);
  }

  /// The whole faces, which are tested against all other whole faces.
  const std::vector<std::uint32_t>& faces() const { return faces_; }
  /// The parts of the other faces, which are near another patch.
  const std::vector<Part>& parts() const { return parts_; }

  TriangleTree tree_of(const std::vector<Box3>& boxes) const {
    std::vector<Vec3> corners;
    std::vector<Triangle> triangles;
    StopCheck check(control_);
    for (const Box3& box : boxes) {
      check();
      corners.push_back(box.min);
      corners.push_back(box.max);
      const std::size_t n = corners.size();
      triangles.push_back({VertexId(n - 2), VertexId(n - 1), VertexId(n - 1)});
    }
    return TriangleTree(corners, triangles, control_);
  }

  bool is_looked_at_inside(std::size_t f) const {
    const PatchId p = surface_.patch[f];
    return has_few(p) || surface_.simple[p.value] == 0;
  }

 private:
  struct Near {
    std::vector<std::uint32_t> faces;
    std::deque<Part> parts;  ///< a deque, because there may be millions, and none is moved when more are added
    std::size_t looks = 0;   ///< number of patches that were tested
  };

  /// All faces are tested against all others.
  void compare_all() {
    faces_.resize(surface_.face_count());
    std::iota(faces_.begin(), faces_.end(), 0u);
  }

  bool has_few(PatchId p) const { return count_[p.value].load(std::memory_order_relaxed) <= kFewFaces; }
  Vec3 corner(std::size_t f, int i) const { return scale_ * surface_.positions[surface_.corners[3 * f + i].value]; }

  Box3 box_of(std::size_t f) const {
    Box3 box;
    for (int i = 0; i < 3; ++i) box.add(corner(f, i));
    return box;
  }

  /// The end of the run of faces of one patch that begins at `begin`; at most `last`.
  std::size_t end_of_run(std::size_t begin, std::size_t last) const {
    std::size_t end = begin + 1;
    while (end < last && surface_.patch[end] == surface_.patch[begin]) ++end;
    return end;
  }

  /// Finds the other patches that may be near some of these faces, which belong to one patch. It tests a run of faces
  /// at once, because most runs have no other patches near them. If there are many such patches, not all are found.
  /// Returns the number of patches that were tested.
  std::size_t find_near(std::size_t begin, std::size_t end, const std::vector<PatchId>& patches,
                        const TriangleTree& tree, std::vector<PatchId>& near, StopCheck& check) const {
    near.clear();
    Box3 box;
    if (end - begin == kRun)
      box = boxes_of_runs_[begin / kRun];
    else
      for (std::size_t f = begin; f < end; ++f) box.add(box_of(f));
    std::size_t looks = 0;
    tree.visit_meeting(box, 0, [&](std::size_t slot) {
      check();
      const PatchId p = patches[tree.face(slot).value];
      if (p != surface_.patch[begin] && is_at_height(box, p)) near.push_back(p);
      ++looks;
      return near.size() <= kFewPatches;
    });
    return looks;
  }

  /// Returns whether a box reaches, by height over a patch's plane, the heights of the patch itself. The boxes of
  /// patches that are askew to the axes are wide, and this test excludes what lies beside the patch.
  bool is_at_height(const Box3& box, PatchId p) const {
    constexpr double kMargin = 4 * kHeightMargin;  // also covers the rounding of the middle and the extents
    const Place place = places_[p.value].get();
    const Vec3& n = surface_.normals[p.value];
    const Vec3 extent = 0.5 * (box.max - box.min);
    const double middle = dot(n, 0.5 * (box.min + box.max));
    const double reach = std::fabs(n.x) * extent.x + std::fabs(n.y) * extent.y + std::fabs(n.z) * extent.z + kMargin;
    return middle + reach >= place.low && middle - reach <= place.high;
  }

  std::array<double, 3> heights(std::size_t f, std::size_t patch) const {
    const Vec3& n = surface_.normals[patch];
    return {dot(n, corner(f, 0)), dot(n, corner(f, 1)), dot(n, corner(f, 2))};
  }

  void count_faces() {
    for_blocks(surface_.face_count(), kPatchBlock, control_, [&](std::size_t begin, std::size_t end) {
      while (begin < end) {
        const std::size_t run_end = end_of_run(begin, end);
        count_[surface_.patch[begin].value].fetch_add(static_cast<std::uint32_t>(run_end - begin),
                                                      std::memory_order_relaxed);
        begin = run_end;
      }
    });
  }

  void find_places() {
    places_ = std::vector<SharedPlace>(count_.size());
    boxes_of_runs_.resize(surface_.face_count() / kRun + 1);
    for_blocks(surface_.face_count(), kPatchBlock, control_, [&](std::size_t begin, std::size_t end) {
      while (begin < end) {
        const PatchId p = surface_.patch[begin];
        const std::size_t first = begin, run_end = end_of_run(begin, std::min(end, begin + kRun));
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

  /// A patch without faces gets a box that meets no face.
  Box3 box_of_patch(PatchId p) const {
    const Box3 box = places_[p.value].get().box;
    return box.is_empty() ? Box3{Vec3{2, 2, 2}, Vec3{2, 2, 2}} : box;
  }

  std::vector<Box3> boxes_of_patches(const std::vector<PatchId>& patches) const {
    std::vector<Box3> boxes;
    boxes.reserve(patches.size());
    StopCheck check(control_);
    for (const PatchId p : patches) {
      check();
      boxes.push_back(box_of_patch(p));
    }
    return boxes;
  }

  /// Finds the parts of a face that are near patches. `tree` has the boxes of these patches.
  void look_at(std::size_t f, const std::vector<PatchId>& patches, const TriangleTree& tree, Near& near,
               StopCheck& check) const {
    tree.visit_meeting(box_of(f), 0, [&](std::size_t slot) {
      check();
      const PatchId p = patches[tree.face(slot).value];
      if (p != surface_.patch[f]) add_part(f, p, near);
      ++near.looks;
      return true;
    });
  }
  /// Does the same, but tests a few given patches without a tree.
  void look_at(std::size_t f, const std::vector<PatchId>& patches, Near& near, StopCheck& check) const {
    const Box3 box = box_of(f);
    near.looks += patches.size();
    for (const PatchId p : patches) {
      check();
      if (do_meet(box, box_of_patch(p))) add_part(f, p, near);
    }
  }

  void add_part(std::size_t f, PatchId p, Near& near) const {
    const Box3 box = part_near(f, p);
    if (!box.is_empty()) near.parts.push_back({box, static_cast<std::uint32_t>(f), surface_.patch[f], p});
  }

  /// The box of the part of a face that lies where a patch is, by height over that patch's plane. It is empty if there
  /// is no such part, or if it does not meet the patch's box. If a needle only touches the patch with its short side,
  /// the part is that side alone.
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
        // The place where the side crosses the level, up to the rounding of heights.
        const double t = (level - height[i]) / rise, doubt = 2 * kHeightMargin / std::fabs(rise);
        for (const double s : {t - doubt, t + doubt})
          box.add(corner(f, i) + std::clamp(s, 0.0, 1.0) * (corner(f, j) - corner(f, i)));
      }
    }
    if (box.is_empty()) return box;
    // The margin covers rounding. The box of the part never leaves the box of the face, which is exact. Beside a
    // coordinate that is far too large, the margin may be larger than all other faces.
    const Box3 whole = box_of(f);
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = std::clamp(box.min[axis] - kHeightMargin, whole.min[axis], whole.max[axis]);
      box.max[axis] = std::clamp(box.max[axis] + kHeightMargin, whole.min[axis], whole.max[axis]);
    }
    return do_meet(box, place.box) ? box : Box3{};
  }

  const PatchedFaces& surface_;
  RunControl& control_;
  double scale_ = 1;
  std::vector<std::atomic<std::uint32_t>> count_;  ///< number of faces of each patch
  std::vector<SharedPlace> places_;
  std::vector<Box3> boxes_of_runs_;  ///< boxes of full runs; the index is the first face / kRun
  std::vector<std::uint32_t> faces_;
  std::vector<Part> parts_;
};

/// The faces that remain to be compared, with vertices of their own, because if patches are large, these vertices are
/// few. The vertices stay in their order.
class Excerpt {
 public:
  Excerpt(const PatchedFaces& surface, const Cull& cull, RunControl& control) : surface_(surface) {
    if (cull.faces().empty() && cull.parts().empty()) return;
    std::vector<std::uint8_t> is_left(surface.positions.size(), 0);
    const auto mark = [&](std::size_t f) {
      for (const VertexId v : surface.face(f)) std::atomic_ref(is_left[v.value]).store(1, std::memory_order_relaxed);
    };
    for_blocks(cull.faces().size(), kPatchBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) mark(cull.faces()[i]);
    });
    StopCheck check(control);
    for (const Part& part : cull.parts()) {
      check();
      mark(part.face);
    }
    const auto left =
        select_ids<VertexId>(is_left.size(), kPatchBlock, control, [&](std::size_t v) { return is_left[v] != 0; });
    reserve_pages(number_, is_left.size(), control);
    number_.resize(is_left.size());
    reserve_pages(positions_, left.size(), control);
    positions_.resize(left.size());
    for_blocks(left.size(), kPatchBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        number_[left[i].value] = static_cast<std::uint32_t>(i);
        positions_[i] = surface.positions[left[i].value];
      }
    });
  }

  const std::vector<Vec3>& positions() const { return positions_; }
  /// One of the faces of the excerpt, over the new vertices.
  Triangle face(std::size_t f) const {
    const auto [a, b, c] = surface_.face(f);
    return {VertexId(number_[a.value]), VertexId(number_[b.value]), VertexId(number_[c.value])};
  }

 private:
  const PatchedFaces& surface_;
  std::vector<std::uint32_t> number_;  ///< new number of each vertex of the surface
  std::vector<Vec3> positions_;
};

/// Finds pairs of faces of two patches, among the parts of either patch that lie where the other one is. If many
/// patches meet, as at the apex of a cone, all these parts lie in one place; therefore they are compared patch by
/// patch.
class Meetings {
 public:
  Meetings(const Cull& cull, const Excerpt& excerpt, RunControl& control)
      : cull_(cull),
        parts_(cull.parts()),
        excerpt_(excerpt),
        positions_(scaled_for_predicates(excerpt.positions(), control)),
        control_(control),
        order_(parts_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    sort_stoppable(order_.begin(), order_.end(), control, [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(patches_of(a), parts_[a].of, parts_[a].face) <
             std::tuple(patches_of(b), parts_[b].of, parts_[b].face);
    });
    begin_ = select_ids<std::uint32_t>(order_.size(), kPatchBlock, control, [&](std::size_t i) {
      return i == 0 || patches_of(order_[i]) != patches_of(order_[i - 1]);
    });
    begin_.push_back(static_cast<std::uint32_t>(order_.size()));
  }

  /// Adds the pairs, until the search is cut short. Returns the share of the parts that were treated.
  double find_pairs(PairSearch& found) const {
    constexpr std::size_t kMeetings = 64;
    const auto parts_in = [&](std::size_t meetings) { return static_cast<double>(begin_[meetings]); };
    const std::size_t done =
        gather_pairs(size(), kMeetings, found, [&](std::size_t m, FoundInTurn& in_turn, std::size_t room) {
          if (!is_large(meeting(m))) hold_against_each_other(meeting(m), found, room, in_turn);
        });
    if (!found.goes_on()) return parts_in(done) / parts_in(size());
    StopCheck check(control_);
    std::size_t m = 0;
    for (; m < size() && found.goes_on(); ++m) {
      check();
      if (is_large(meeting(m))) search(meeting(m), found);
    }
    return parts_in(m) / parts_in(size());
  }

 private:
  std::pair<PatchId, PatchId> patches_of(std::uint32_t part) const {
    return std::minmax({parts_[part].of, parts_[part].near});
  }
  std::size_t size() const { return begin_.size() - 1; }
  /// The parts of two patches near each other. The parts of the first patch come first.
  std::span<const std::uint32_t> meeting(std::size_t m) const {
    return std::span(order_).subspan(begin_[m], begin_[m + 1] - begin_[m]);
  }
  std::size_t first_of_other(std::span<const std::uint32_t> meeting) const {
    const PatchId one = parts_[meeting[0]].of;
    return static_cast<std::size_t>(
        std::partition_point(meeting.begin(), meeting.end(), [&](std::uint32_t i) { return parts_[i].of == one; }) -
        meeting.begin());
  }
  /// Returns whether both patches have many parts. For few parts, a tree costs more than it saves.
  bool is_large(std::span<const std::uint32_t> meeting) const {
    constexpr std::size_t kMaxTests = 1 << 14, kFewParts = 16;
    const std::size_t one = first_of_other(meeting), other = meeting.size() - one;
    return one > kFewParts && other > kFewParts && one * other > kMaxTests;
  }
  bool do_faces_intersect(std::uint32_t a, std::uint32_t b, const PairSearch& search) const {
    if (search.is_passed_over(FaceId(parts_[a].face), FaceId(parts_[b].face))) return false;
    return do_intersect(excerpt_.face(parts_[a].face), excerpt_.face(parts_[b].face), positions_);
  }

  void hold_against_each_other(std::span<const std::uint32_t> meeting, const PairSearch& search, std::size_t room,
                               FoundInTurn& found) const {
    const std::size_t other = first_of_other(meeting);
    std::uint32_t looks = 0;
    for (const std::uint32_t a : meeting.first(other))
      for (const std::uint32_t b : meeting.subspan(other)) {
        if (++looks % kTestsBetweenChecks == 0) control_.check_and_move();
        ++found.steps;
        if (!do_meet(parts_[a].box, parts_[b].box)) continue;
        found.steps += kStepsPerTest;
        if (!do_faces_intersect(a, b, search)) continue;
        found.pairs.push_back(std::minmax(FaceId(parts_[a].face), FaceId(parts_[b].face)));
        if (found.pairs.size() > room) return;
      }
  }

  /// Looks up the parts of one patch in a tree of those of the other, which has more.
  void search(std::span<const std::uint32_t> meeting, PairSearch& found) const {
    constexpr std::size_t kPartsPerTask = 256;
    const std::size_t other = first_of_other(meeting);
    std::span<const std::uint32_t> few = meeting.first(other), many = meeting.subspan(other);
    if (few.size() > many.size()) std::swap(few, many);
    std::vector<Box3> boxes;
    boxes.reserve(many.size());
    StopCheck check(control_);
    for (const std::uint32_t i : many) {
      check();
      boxes.push_back(parts_[i].box);
    }
    const TriangleTree tree = cull_.tree_of(boxes);
    if (do_many_boxes_meet(few, tree)) return search_by_shape(few, many, found);
    gather_pairs(few.size(), kPartsPerTask, found, [&](std::size_t i, FoundInTurn& in_turn, std::size_t room) {
      std::uint32_t looks = 0;
      const auto look = [&] {
        if (++looks % kTestsBetweenChecks == 0) control_.check_and_move();
        ++in_turn.steps;
      };
      tree.visit_meeting(
          parts_[few[i]].box, 0,
          [&](std::size_t) {
            look();
            return false;
          },
          [&](std::size_t slot) {
            look();
            in_turn.steps += kStepsPerTest;
            const std::uint32_t b = many[tree.face(slot).value];
            if (do_faces_intersect(few[i], b, found))
              in_turn.pairs.push_back(std::minmax(FaceId(parts_[few[i]].face), FaceId(parts_[b].face)));
            return in_turn.pairs.size() <= room;
          });
    });
  }

  /// Returns whether each part's box meets so many boxes of the tree that boxes hardly cull any pair. Only an evenly
  /// spread sample of the parts is tested.
  bool do_many_boxes_meet(std::span<const std::uint32_t> parts, const TriangleTree& tree) const {
    constexpr std::size_t kSamples = 64, kMany = 64;
    const std::size_t step = std::max<std::size_t>(1, parts.size() / kSamples);
    std::size_t samples = 0, meeting = 0;
    StopCheck check(control_);
    for (std::size_t i = 0; i < parts.size(); i += step, ++samples)
      tree.visit_meeting(parts_[parts[i]].box, 0, [&](std::size_t) {
        check();
        ++meeting;
        return true;
      });
    return meeting > kMany * samples;
  }

  /// Knows the nodes of a tree over the faces of two patches.
  class View {
   public:
    View(std::span<const std::uint32_t> side, const TriangleTree& tree, RunControl& control)
        : side_(side),
          of_node_(tree.joined<std::uint32_t>([&](std::size_t slot) { return side[tree.face(slot).value]; },
                                              [](std::uint32_t a, std::uint32_t b) { return a == b ? a : kNone; },
                                              control)) {}
    bool is_of_no_interest(FaceId f, std::size_t, std::size_t node) const { return of_node_[node] == side_[f.value]; }
    static bool lose_interest(std::span<const std::uint32_t>) { return false; }

   private:
    std::span<const std::uint32_t> side_;
    std::vector<std::uint32_t> of_node_;  ///< the side of all faces of a node, or kNone
  };

  /// Finds the pairs where boxes separate too few faces. For example, a fan of needles may end at a row of faces that
  /// stand on it, and the box of each needle contains half of the row.
  void search_by_shape(std::span<const std::uint32_t> few, std::span<const std::uint32_t> many,
                       PairSearch& found) const {
    std::vector<std::uint32_t> part, side;
    std::vector<Triangle> faces;
    StopCheck check(control_);
    for (const auto& parts : {few, many})
      for (const std::uint32_t i : parts) {
        check();
        side.push_back(part.size() < few.size() ? 0 : 1);
        part.push_back(i);
        faces.push_back(excerpt_.face(parts_[i].face));
      }
    remesh::find_pairs(
        {.positions = positions_, .faces = faces, .groups = side},
        [&](FaceId f) { return FaceId(parts_[part[f.value]].face); },
        [&](const TriangleTree& tree) { return View(side, tree, control_); },
        [&](FaceId f, FaceId g) {
          const std::uint32_t a = part[f.value], b = part[g.value];
          return side[f.value] != side[g.value] && do_meet(parts_[a].box, parts_[b].box) &&
                 do_faces_intersect(a, b, found);
        },
        found);
  }

  const Cull& cull_;
  const std::vector<Part>& parts_;
  const Excerpt& excerpt_;
  std::vector<Vec3> positions_;
  RunControl& control_;
  std::vector<std::uint32_t> order_;  ///< the parts, meeting after meeting
  std::vector<std::uint32_t> begin_;  ///< where each meeting begins in `order_`; one entry more than there are meetings
};

}  // namespace

SelfIntersections patch_intersections(const PatchedFaces& surface, const SearchLimits& limits, RunControl& control) {
  Cull cull(surface, control);
  cull.run();
  const Excerpt excerpt(surface, cull, control);
  // Between small patches, and inside patches, whole faces are compared.
  std::vector<Triangle> faces(cull.faces().size());
  std::vector<std::uint32_t> pieces(cull.faces().size());
  for_blocks(faces.size(), kPatchBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t f = cull.faces()[i];
      faces[i] = excerpt.face(f);
      pieces[i] = cull.is_looked_at_inside(f) ? kNoPiece : surface.patch[f].value;
    }
  });
  SearchLimits of_whole = limits;
  if (limits.is_expected)
    of_whole.is_expected = [&](FaceId f, FaceId g) {
      return limits.is_expected(FaceId(cull.faces()[f.value]), FaceId(cull.faces()[g.value]));
    };
  SelfIntersections of_faces = self_intersections(excerpt.positions(), faces, pieces, of_whole, control);
  StopCheck check(control);
  for (auto& [f, g] : of_faces.pairs) {
    check();
    f = FaceId(cull.faces()[f.value]);
    g = FaceId(cull.faces()[g.value]);
  }
  PairSearch search(limits, control, std::move(of_faces));
  SelfIntersections& found = search.result();
  // If one of two patches is large, each face is compared only in the place where the other patch is.
  if (!cull.parts().empty()) {
    const double searched = search.goes_on() ? Meetings(cull, excerpt, control).find_pairs(search) : 0;
    const auto whole = static_cast<double>(faces.size()), parts = static_cast<double>(cull.parts().size());
    found.searched = (found.searched * whole + searched * parts) / (whole + parts);
  }
  sort_unique(found.pairs, control);
  if (!found.is_complete) found.pairs.resize(std::min(found.pairs.size(), limits.max_pairs));
  return std::move(found);
}

}  // namespace remesh
