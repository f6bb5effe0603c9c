#include "core/refinement/sizes/gap_search.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/geometry/planes/projection.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/geometry/triangles/triangle_intersection.h"
#include "core/mending/polygons/polygon_split.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/sizes/patch_contacts.h"
#include "core/refinement/sizes/patch_slabs.h"
#include "core/refinement/sizes/steepness.h"
#include "core/refinement/sizes/wedges.h"

namespace remesh {
namespace {

/// A patch that is joined to this one counts if the way over the surface is longer than this times the gap.
constexpr double kDetour = 3;

/// Boxes are enlarged by this much, in local units. It is more than the rounding error of any distance between two
/// points. So the search never passes over a triangle that is nearer than the best one so far, and the answer does not
/// depend on the order of the search.
constexpr double kGapRounding = 0x1p-48;

/// A relative slack for rounding in the test whether a patch is hidden.
constexpr double kHidden = 1 + 1e-6;

/// Some searches compare all patches at a vertex with each other. They leave out vertices where more patches than this
/// meet.
constexpr std::size_t kMaxPatchesAtCorner = 16;
/// The max number of a patch's corners from which the smallest gap is searched. They are evenly spread.
constexpr std::size_t kMaxCornersOfPatch = 64;

/// The properties that all triangles in a node of the tree have in common. A property that is not the same for all
/// triangles is invalid.
struct Common {
  PatchId patch;
  VertexId hub;                    ///< the hub of the patch; see hubs_
  std::array<PatchId, 2> largest;  ///< the patches with the longest borders among those that are joined to it
  Layer layer;                     ///< contains all of the node's triangles

  void join(const Common& other) {
    if (patch != other.patch) patch = PatchId();
    if (hub != other.hub) hub = VertexId();
    for (PatchId& p : largest)
      if (!other.is_joined_to(p)) p = PatchId();
  }
  bool is_joined_to(PatchId p) const { return p == largest[0] || p == largest[1]; }
};
using TriangleBoxes = BoxTree<Common>;

/// Holds the smallest square of a gap so far, in local units. Many threads may use it.
class SharedLeast {
 public:
  double get() const { return value_.load(std::memory_order_relaxed); }
  void lower(double to) {
    double now = get();
    while (to < now && !value_.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
    }
  }

 private:
  std::atomic<double> value_{HUGE_VAL};
};

/// Caches the answers of `are_joined` for the patches that were seen last, because the question takes long for two
/// patches with long borders.
class JoinedMemory {
 public:
  explicit JoinedMemory(const PatchContacts& contacts) : contacts_(contacts) {}

  bool operator()(PatchId p, PatchId q) {
    if (p == q) return true;
    if (q < p) std::swap(p, q);
    Answer& a = answers_[(p.value * 31u + q.value) % answers_.size()];
    if (a.p != p || a.q != q) a = {p, q, contacts_.are_joined(p, q)};
    return a.are_joined;
  }

 private:
  struct Answer {
    PatchId p, q;
    bool are_joined = false;
  };
  const PatchContacts& contacts_;
  std::array<Answer, 64> answers_;
};

/// A search counts one step for each box, and this many more for each triangle that is tested.
constexpr std::uint64_t kStepsOfTriangle = 8;
/// The number of pieces of a cell that can be tested in about the time of one step.
constexpr std::uint64_t kPiecesPerStep = 8;
/// A cell with more pieces than this is compared with boxes by its own bounding box.
constexpr std::size_t kFewPiecesOfCell = 8;

/// Counts the steps of a search. It is cheaper than a WorkBound that may be null.
class StepCounter {
 public:
  explicit StepCounter(WorkBound* work) : work_(work), left_(work != nullptr ? work->left() : WorkBound::kNone) {}
  ~StepCounter() {
    if (work_ != nullptr) work_->take(taken_);
  }
  StepCounter(const StepCounter&) = delete;
  StepCounter& operator=(const StepCounter&) = delete;

  /// Returns false if the bound is spent, so that the search ends.
  /// Errors: kCancelled, kTimeout - asked to stop.
  bool take(std::uint64_t steps) {
    taken_ += steps;
    if (work_ != nullptr && taken_ >= next_check_) {
      next_check_ = taken_ + kStepsPerCheck;
      work_->check();
    }
    return taken_ <= left_;
  }
  std::uint64_t taken() const { return taken_; }

 private:
  static constexpr std::uint64_t kStepsPerCheck = 1 << 12;

  WorkBound* work_;
  std::uint64_t left_, taken_ = 0, next_check_ = kStepsPerCheck;
};

/// The patches that a search finds: only those that the place faces, or also those beside it.
enum class What { kFaced, kAll };

/// Selects on which side of a patch a search looks.
enum class SideOfPlane { kBoth, kAbove, kBelow };

/// The squares of gaps that a search wants, in local units: only gaps below `below` count, and a gap that is at most
/// `enough` ends the search.
struct Wanted {
  double below, enough;
};

/// Returns the range of the products of the layer's direction with the corners of a triangle.
Products products(const Layer& layer, const Corners3& triangle) {
  const auto [least, most] =
      std::minmax({layer.product(triangle[0]), layer.product(triangle[1]), layer.product(triangle[2])});
  return {least, most};
}

/// Returns a range that contains the products of the layer's direction with all points of a box.
Products products(const Layer& layer, const FloatBox& box) {
  Products range{HUGE_VAL, -HUGE_VAL};
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) {
      return static_cast<double>((corner >> axis & 1) != 0 ? box.max[axis] : box.min[axis]);
    };
    const double product = layer.product({side(0), side(1), side(2)});
    range = {std::min(range.least, product), std::max(range.most, product)};
  }
  return range;
}

/// Knows which patches are hidden from one place, and from which distance on. The triangles of a hidden patch need not
/// be tested one by one.
class HiddenPatches {
 public:
  HiddenPatches(const PatchContacts& contacts, const PatchSlabs& slabs, const Vec3& place, PatchId patch)
      : contacts_(contacts), slabs_(slabs), place_(place), patch_(patch) {}

  /// Returns whether no part of p counts that is at that distance (given as a square) or farther away.
  bool operator()(PatchId p, double squared) {
    Known& known = known_[p.value % known_.size()];
    if (known.patch != p) known = {p, -1, !slabs_.is_curved(p) && is_hidden_in_plane(p) ? 0 : HUGE_VAL};
    if (squared >= known.hidden) return true;
    if (squared <= known.seen) return false;
    // If a vertex or edge that both patches share is within d of the place, the way over it to any place at the
    // distance d is at most 3 d long.
    const bool is_hidden = contacts_.are_joined_within(patch_, p, place_, kHidden * std::sqrt(squared));
    (is_hidden ? known.hidden : known.seen) = squared;
    return is_hidden;
  }

 private:
  struct Known {
    PatchId patch;
    double seen = -1;  ///< squares of distances
    double hidden = HUGE_VAL;
  };

  /// Take a point of the plane that is t away from the place's foot in the plane, where h is the place's height. The
  /// way through the air is d = (h^2 + t^2)^(1/2) long, and the way over the surface is at most t longer than the way
  /// to the foot. 3 d - t is nowhere less than 8^(1/2) h. So the whole plane is hidden if the way to the foot is no
  /// longer than that.
  bool is_hidden_in_plane(PatchId p) const {
    const Slab& slab = slabs_[p];
    const double height = slab.distance(place_);
    if (!(height > 0)) return false;
    const Vec3 foot = place_ - slab.plane.distance(place_) * slab.plane.normal;
    return contacts_.has_way(patch_, place_, p, foot, std::sqrt(kDetour * kDetour - 1) * height);
  }

  const PatchContacts& contacts_;
  const PatchSlabs& slabs_;
  const Vec3& place_;
  PatchId patch_;
  std::array<Known, 8> known_;
};

/// Returns a bound on the rounding error of a distance between two places, in model units. Places that refinement makes
/// are rounded as model coordinates, so the error grows with the distance of the surface from the origin.
double rounding_of(const Surface& surface) {
  const Vec3& c = surface.centre;
  return kGapRounding * (surface.unit + std::max({std::fabs(c.x), std::fabs(c.y), std::fabs(c.z)}));
}

bool is_curved(const TriangulatedPatches& triangulated, PatchId p) {
  return triangulated.charts.has_curved() && triangulated.charts[p].curved() != nullptr;
}

}  // namespace

/// This class is larger than the bound because all searches go through the same tree, and each of them leaves out boxes
/// for reasons of its own.
class GapSearch::Index {
 public:
  Index(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, double plane_tolerance,
        RunControl& control, const TriangulatedPatches* triangulated, const Rules& rules)
      : surface_(surface),
        contacts_(surface, adjacency, patches, control),
        touching_squared_(std::pow(std::max(plane_tolerance, rounding_of(surface)) / surface.unit, 2)),
        min_height_(rules.min_gap / surface.unit),
        crossing_(rules.crossing) {
    find_triangles(patches, triangulated, control);
    slabs_ = PatchSlabs(surface, patches, triangulated != nullptr ? &triangulated->charts : nullptr, triangles_,
                        triangle_begin_, control);
    wedges_ = Wedges(surface, adjacency, patches, slabs_, rules.feature_angle_deg, control);
    find_axes(adjacency, patches, triangulated, control);
    find_solids(adjacency, patches, control);
    find_boxes(control);
  }

  /// Input: `enough` is the `enough` of GapSearch::at, in model units. If narrow gaps do not count, the search
  ///        continues in any case, because whether a side has a gap at all depends on the nearest point.
  double distance(const Vec3& place, PatchId patch, double limit, What what, const Triangle* on, WorkBound* work,
                  double enough = 0) const {
    const double below = limit / surface_.unit, low = std::max(enough, 0.0) / surface_.unit;
    const Vec3 from = (1 / surface_.unit) * (place - surface_.centre);
    double found = HUGE_VAL;
    if (!(min_height_ > 0))
      found = squared_gap(from, patch, {below * below, low * low}, what, on, work).squared;
    else if (below > min_height_)
      for (const SideOfPlane side : {SideOfPlane::kAbove, SideOfPlane::kBelow}) {
        const Gap gap = squared_gap(from, patch, {std::min(found, below * below), 0}, what, on, work, side);
        if (gap.height >= min_height_) found = std::min(found, gap.squared);
      }
    return std::sqrt(found) * surface_.unit;
  }
  double beside(std::span<const Corners3> pieces, PatchId patch, double limit, WorkBound* work) const {
    const double below = limit / surface_.unit;
    return std::sqrt(squared_beside(pieces, patch, below * below, work)) * surface_.unit;
  }
  std::optional<double> smallest(std::uint64_t max_output_faces, RunControl& control) const;

  const Axes& axes_of(PatchId p) const { return axes_[p]; }
  bool is_curved(PatchId p) const { return slabs_.is_curved(p); }
  std::size_t patch_count() const { return triangle_begin_.size() - 1; }
  std::span<const Triangle> triangles_of(PatchId p) const {
    return std::span(triangles_)
        .subspan(triangle_begin_[p.value], triangle_begin_[p.value + 1] - triangle_begin_[p.value]);
  }

 private:
  void find_triangles(const PatchSet& patches, const TriangulatedPatches* triangulated, RunControl& control);
  void add_faces(std::span<const FaceId> faces, RunControl& control);
  void find_axes(const Adjacency& adjacency, const PatchSet& patches, const TriangulatedPatches* triangulated,
                 RunControl& control);
  void find_solids(const Adjacency& adjacency, const PatchSet& patches, RunControl& control);
  void find_boxes(RunControl& control);
  Layer layer_of(std::span<const std::uint32_t> triangles) const;
  /// The cost and the rest of a search from one block of items, patches or slots.
  struct Looked {
    std::uint64_t steps = 0;
    std::vector<std::uint32_t> cut_short;  ///< items whose search was cut short
  };
  /// The input of a search from a block of items. Each item may take `max_steps`.
  struct Block {
    std::span<const std::uint32_t> items;
    double known;  ///< the square of a known gap; only smaller gaps count
    std::uint64_t max_steps;
  };
  template <class Look>
  static bool look_from_all(std::size_t count, WorkBound& work, const SharedLeast& least, RunControl& control,
                            const Look& look);
  Looked look_at_corners(const Block& patches, SharedLeast& least, RunControl& control) const;
  Looked look_from(const Block& slots, SharedLeast& least, RunControl& control) const;
  /// The nearest point that counts: the square of its distance, and its height over the patch's plane. Both are
  /// infinity if there is none.
  struct Gap {
    double squared = HUGE_VAL, height = HUGE_VAL;
  };
  Gap squared_gap(const Vec3& p, PatchId patch, Wanted wanted, What what, const Triangle* on, WorkBound* work,
                  SideOfPlane side = SideOfPlane::kBoth) const;
  double squared_beside(std::span<const Corners3> pieces, PatchId patch, double below, WorkBound* work) const;

  /// Returns whether both patches bound one solid, and the way leaves one of them inwards and reaches the other from
  /// outside, or the other way round. Then the way meets the surface in between; between the two treads of a step, it
  /// meets the riser.
  /// Input: the normal where the way begins, and the place where it ends.
  bool is_blocked(const Vec3& way, PatchId from, const Vec3& normal, PatchId to, const Vec3& end) const {
    if (!bound_one_solid(from, to)) return false;
    return dot(way, normal) * dot(way, slabs_.normal(to, end)) > 0;
  }
  bool are_crossing(PatchId p, PatchId q) const {
    return std::binary_search(crossing_.begin(), crossing_.end(), std::pair(std::min(p, q), std::max(p, q)));
  }
  bool bound_one_solid(PatchId p, PatchId q) const { return solids_[p] != kOpen && solids_[p] == solids_[q]; }

  /// Returns the slab of the patch that a triangle belongs to. If the patch is curved, it is the triangle's own plane.
  Slab slab_of(std::size_t slot) const {
    const PatchId p = tree_[slot].tag.patch;
    if (!slabs_.is_curved(p)) return slabs_[p];
    const auto& [a, b, c] = corners(slot);
    return {{a, normalized(cross(b - a, c - a))}, kGapRounding};
  }

  /// Returns whether the way to all places in the box, over the vertex that its patches and this one share, is at most
  /// three times as long as the distance.
  bool is_hidden_by_hub(const TriangleBoxes::Entry& e, const Vec3& p, PatchId patch, double squared_distance) const {
    if (!e.tag.hub.is_valid() || e.tag.hub != hubs_[patch]) return false;
    const Vec3& hub = surface_.local[e.tag.hub];
    Vec3 farthest;
    for (int axis = 0; axis < 3; ++axis)
      farthest[axis] = std::max(std::fabs(e.box.min[axis] - hub[axis]), std::fabs(e.box.max[axis] - hub[axis]));
    return norm(p - hub) + norm(farthest) <= kDetour * std::sqrt(squared_distance);
  }

  const Triangle& triangle(std::size_t slot) const { return triangles_[tree_.number(slot)]; }
  Corners3 corners(std::size_t slot) const { return corners_of(triangle(slot)); }
  Corners3 corners_of(const Triangle& t) const {
    return {surface_.local[t[0]], surface_.local[t[1]], surface_.local[t[2]]};
  }

  const Surface& surface_;
  PatchContacts contacts_;
  double touching_squared_;  ///< local units
  double min_height_;        ///< gaps with a smaller height do not count; local units
  std::span<const std::pair<PatchId, PatchId>> crossing_;
  std::vector<Triangle> triangles_;            ///< triangles of patch after patch
  std::vector<std::uint32_t> triangle_begin_;  ///< index of each patch's first triangle
  PatchSlabs slabs_;
  Wedges wedges_;
  IdVector<PatchId, Axes> axes_;
  static constexpr std::uint32_t kOpen = 0xffffffffu;
  /// The closed, consistently wound component to which each patch belongs, or kOpen.
  IdVector<PatchId, std::uint32_t> solids_;
  IdVector<PatchId, VertexId> hubs_;  ///< the vertex of each patch where the most patches meet
  TriangleBoxes tree_;
};

void GapSearch::Index::find_triangles(const PatchSet& patches, const TriangulatedPatches* triangulated,
                                      RunControl& control) {
  triangle_begin_.reserve(patches.count() + 1);
  triangle_begin_.push_back(0);
  for (std::size_t p = 0; p < patches.count(); ++p) {
    if (p % 1024 == 0) control.check_and_move();
    const PatchMesh* patch = triangulated != nullptr ? &triangulated->meshes[PatchId(p)] : nullptr;
    // Before refinement, the triangles of a curved patch may lie far from its surface. Its facets do not.
    if (patch == nullptr || patch->mesh.triangle_count() == 0 || remesh::is_curved(*triangulated, PatchId(p))) {
      add_faces(patches.faces_of(PatchId(p)), control);
    } else {
      const auto& [vertices, mesh] = std::tie(patch->vertices, patch->mesh);
      for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
        triangles_.push_back({vertices[mesh.from(h)], vertices[mesh.from(h + 1)], vertices[mesh.from(h + 2)]});
    }
    triangle_begin_.push_back(static_cast<std::uint32_t>(triangles_.size()));
  }
}

void GapSearch::Index::add_faces(std::span<const FaceId> faces, RunControl& control) {
  for (const FaceId f : faces)
    visit_triangles(surface_, f, control, [&](const Triangle& t) { triangles_.push_back(t); });
}

void GapSearch::Index::find_axes(const Adjacency& adjacency, const PatchSet& patches,
                                 const TriangulatedPatches* triangulated, RunControl& control) {
  axes_.resize(patch_count());
  for_blocks(patch_count(), 1024, control, [&](std::size_t begin, std::size_t end) {
    std::vector<Edge3> border;
    for (std::size_t i = begin; i < end; ++i) {
      const PatchId p(i);
      if (triangulated != nullptr && triangulated->meshes[p].mesh.triangle_count() > 0) {
        axes_[p] = triangulated->charts[p].axes();
        continue;
      }
      const Vec3& normal = slabs_[p].plane.normal;
      if (normal == Vec3{}) continue;
      border.clear();
      for (const FaceId f : patches.faces_of(p))
        for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h)
          if (is_patch_boundary(adjacency, patches, h))
            border.push_back({surface_.local[adjacency.from(h)], surface_.local[adjacency.to(h)]});
      axes_[p] = axes_along(normal, border);
    }
  });
}

void GapSearch::Index::find_solids(const Adjacency& adjacency, const PatchSet& patches, RunControl& control) {
  UnionFind components(patches.count());
  std::vector<std::uint8_t> is_open(patches.count(), 0);
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    if (e % 65536 == 0) control.check_and_move();
    const auto around = adjacency.half_edges(EdgeId(e));
    const PatchId first = patches.of_face[adjacency.face_of(around[0])];
    for (const std::uint32_t h : around) components.join(first.value, patches.of_face[adjacency.face_of(h)].value);
    if (adjacency.twin(around[0]) == kNone) is_open[first.value] = 1;
  }
  for (std::uint32_t p = 0; p < patches.count(); ++p)
    if (is_open[p] != 0) is_open[components.find(p)] = 1;
  solids_.resize(patches.count());
  for (std::uint32_t p = 0; p < patches.count(); ++p) {
    const std::uint32_t root = components.find(p);
    solids_[PatchId(p)] = is_open[root] != 0 ? kOpen : root;
  }
}

void GapSearch::Index::find_boxes(RunControl& control) {
  TriangleBoxes::Entries entries(triangles_.size());
  hubs_.resize(patch_count());
  for_blocks(patch_count(), 1024, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      hubs_[PatchId(p)] = contacts_.busiest_vertex(PatchId(p));
      const Common common{PatchId(p), hubs_[PatchId(p)], contacts_.largest_neighbours(PatchId(p), kMaxPatchesAtCorner),
                          Layer()};
      for (std::uint32_t t = triangle_begin_[p]; t < triangle_begin_[p + 1]; ++t) {
        entries[t] = {FloatBox(), common};
        for (const VertexId v : triangles_[t])
          for (const double e : {-kGapRounding, kGapRounding}) entries[t].box.add(surface_.local[v] + Vec3{e, e, e});
      }
    }
  });
  tree_ = TriangleBoxes(entries, control);
  tree_.note([&](Common& common, std::span<const std::uint32_t> among) { common.layer = layer_of(among); }, control);
}

Layer GapSearch::Index::layer_of(std::span<const std::uint32_t> triangles) const {
  Vec3 sum;
  for (const std::uint32_t t : triangles) {
    const auto& [a, b, c] = corners_of(triangles_[t]);
    const Vec3 normal = cross(b - a, c - a);
    sum += (dot(sum, normal) < 0 ? -1.0 : 1.0) * normal;  // so that a thin wall is a layer, too
  }
  Layer layer(normalized(sum));
  for (const std::uint32_t t : triangles)
    for (const Vec3& p : corners_of(triangles_[t])) layer.add(p);
  return layer;
}

/// Returns the gap at p in local units, or none if its square is not among the wanted ones.
GapSearch::Index::Gap GapSearch::Index::squared_gap(const Vec3& p, PatchId patch, Wanted wanted, What what,
                                                    const Triangle* on, WorkBound* work, SideOfPlane side) const {
  const bool is_all = what == What::kAll;
  StepCounter steps(work);
  double best = wanted.below;
  Gap gap;
  const Slab slab = slabs_.at(patch, p);
  HiddenPatches is_hidden(contacts_, slabs_, p, patch);
  tree_.search(
      best,
      [&](const TriangleBoxes::Entry& e) {
        const PatchId other = e.tag.patch;
        if (!steps.take(1) || other == patch) return HUGE_VAL;
        double least = squared_distance(e.box, p);
        if (least >= best) return least;
        if (!is_all) {
          const double product = e.tag.layer.product(p);
          least = squared_steep_distance(slab, {product, product}, e.box, e.tag.layer, least);
          if (least >= best) return least;
        }
        if (is_hidden_by_hub(e, p, patch, least)) return HUGE_VAL;
        // The test whether a single triangle is hidden comes last, below, because cheaper tests exclude most triangles.
        if (!other.is_valid() || tree_.is_slot(e)) return least;
        least = std::max(least, std::pow(slabs_[other].distance(p), 2));
        steps.take(kStepsOfTriangle);
        return least < best && is_hidden(other, least) ? HUGE_VAL : least;
      },
      [&](std::size_t slot) {
        const PatchId other = tree_[slot].tag.patch;
        const Vec3 q = nearest_on_triangle(p, corners(slot));
        const double d = norm_squared(q - p), up = dot(q - p, slab.plane.normal);
        if ((side == SideOfPlane::kAbove && !(up > 0)) || (side == SideOfPlane::kBelow && !(up < 0))) return;
        if (d >= best || d <= touching_squared_ || !(is_all || slab.is_steep(q - p)) ||
            is_blocked(q - p, patch, slab.plane.normal, other, q) || is_hidden(other, d))
          return;
        if (contacts_.has_way(patch, p, other, q, kDetour * std::sqrt(d))) return;
        if (are_crossing(patch, other) || wedges_.is_across(patch, p, other, q, std::sqrt(d))) return;
        if (on != nullptr && do_intersect(*on, triangle(slot), surface_.local.items())) return;
        gap = {d, std::fabs(up)};
        best = d <= wanted.enough ? 0 : d;  // no distance is below 0, so the search ends
      });
  return gap;
}

/// Returns the square of the result of `beside` in local units, or infinity if it is not below `below`.
double GapSearch::Index::squared_beside(std::span<const Corners3> pieces, PatchId patch, double below,
                                        WorkBound* work) const {
  StepCounter steps(work);
  const PatchSlabs::OfPieces around = slabs_.around(patch, pieces);
  const auto& slab = around.slab;
  const double steep_squared = around.steep;
  const bool is_curved = slabs_.is_curved(patch);
  FloatBox box;
  for (const Corners3& piece : pieces)
    for (const Vec3& p : piece) box.add(p);
  // Returns a lower bound for the squared length of a steep way if no way at all has a smaller square than `squared`.
  // A curved patch has many normals, so no way is left out.
  const auto steep = [&](const TriangleBoxes::Entry& e, double squared) {
    if (is_curved) return squared;
    steps.take(pieces.size() / kPiecesPerStep);
    Products from{HUGE_VAL, -HUGE_VAL};
    for (const Corners3& piece : pieces) {
      const auto [least, most] = products(e.tag.layer, piece);
      from = {std::min(from.least, least), std::max(from.most, most)};
    }
    return squared_steep_distance(slab, from, e.box, e.tag.layer, squared);
  };
  // Returns a smaller bound, whose cost does not grow with the number of pieces.
  const auto roughly_steep = [&](const TriangleBoxes::Entry& e, double squared) {
    if (is_curved || pieces.size() <= kFewPiecesOfCell) return steep(e, squared);
    return squared_steep_distance(slab, products(e.tag.layer, box), e.box, e.tag.layer, squared);
  };
  JoinedMemory are_joined(contacts_);
  double best = below;
  tree_.search(
      best,
      [&](const TriangleBoxes::Entry& e) {
        const PatchId other = e.tag.patch;
        if (!steps.take(1) || other == patch) return HUGE_VAL;
        double least = squared_distance(e.box, box);
        if (least >= best) return least;
        least = roughly_steep(e, least);
        return least < best && other.is_valid() && are_joined(patch, other) ? HUGE_VAL : least;
      },
      [&](std::size_t slot) {
        steps.take(kStepsOfTriangle * pieces.size());
        const Corners3 there = corners(slot);
        double up = 0;
        for (const Vec3& p : there) up = std::max(up, std::fabs(slab.plane.distance(p)) + slab.half_thickness);
        if (!is_curved && up < min_height_) return;
        for (const Corners3& piece : pieces) {
          const Vec3 way = shortest_way(piece, there);
          const double d = norm_squared(way);
          // No other way between the two triangles has a larger height, and none is shorter. So no way is steep if `up`
          // is too low.
          if (d >= best || d <= touching_squared_ || up * up <= steep_squared * d) continue;
          const PatchId other = tree_[slot].tag.patch;
          if (are_crossing(patch, other)) return;
          // Where one of the patches is curved, other ways between the two may not be blocked.
          if (!is_curved && !slabs_.is_curved(other) && is_blocked(way, patch, slab.plane.normal, other, there[0]))
            continue;
          best = std::min(best, std::max(steep(tree_[slot], d), min_height_ * min_height_));
        }
      });
  return best < below ? best : HUGE_VAL;
}

std::optional<double> GapSearch::Index::smallest(std::uint64_t max_output_faces, RunControl& control) const {
  SharedLeast least;
  WorkBound work(kWorkOfSmallestGap.steps(tree_.size(), max_output_faces), &control);
  const auto at_corners = [&](const Block& patches) { return look_at_corners(patches, least, control); };
  const auto between = [&](const Block& slots) { return look_from(slots, least, control); };
  // The search from corners comes first, because it is cheap and its result makes the other search short.
  if (!look_from_all(patch_count(), work, least, control, at_corners) ||
      !look_from_all(tree_.size(), work, least, control, between))
    return std::nullopt;
  return least.get() < HUGE_VAL ? std::optional(std::sqrt(least.get()) * surface_.unit) : std::nullopt;
}

/// Searches from one item after the other. Results make the later searches short. The items are treated in batches that
/// grow. The items of a batch know the results of the batches before, and those of their own block. So the steps that a
/// batch takes do not depend on threads. An item that needs more than its share of the steps is searched once more at
/// the end, when other items have left some steps.
/// Output: false if the bound on the work was spent before all searches were complete.
template <class Look>
bool GapSearch::Index::look_from_all(std::size_t count, WorkBound& work, const SharedLeast& least, RunControl& control,
                                     const Look& look) {
  constexpr std::size_t kFirstBatch = 1024, kBlock = 256, kUneven = 4;
  constexpr std::uint64_t kMinSteps = 256;
  std::vector<std::uint32_t> items(count), later;
  std::iota(items.begin(), items.end(), 0u);
  for (int pass = 0; pass < 2; ++pass) {
    std::size_t size = kFirstBatch;
    for (std::size_t begin = 0; begin < items.size(); begin += std::exchange(size, 2 * size)) {
      if (work.is_spent()) return false;
      const std::size_t in_batch = std::min(size, items.size() - begin);
      const std::uint64_t max_steps = std::max(kMinSteps, work.left() / (items.size() - begin) * kUneven);
      const double known = least.get();
      const auto looked = map_blocks<Looked>(in_batch, kBlock, control, [&](std::size_t from, std::size_t to) {
        return look(Block{std::span(items).subspan(begin + from, to - from), known, max_steps});
      });
      for (const Looked& block : looked) {
        work.take(block.steps);
        later.insert(later.end(), block.cut_short.begin(), block.cut_short.end());
      }
    }
    items = std::exchange(later, {});
  }
  return items.empty();
}

/// Searches for gaps from the corners of the block's patches, and lowers `least` to the narrowest gap that is found.
/// Output: the steps that this took, and the patches for which they were too few.
GapSearch::Index::Looked GapSearch::Index::look_at_corners(const Block& patches, SharedLeast& least,
                                                           RunControl& control) const {
  double best = patches.known;
  Looked looked;
  for (const std::uint32_t p : patches.items) {
    WorkBound work(patches.max_steps, &control);
    const std::vector<VertexId> corners = contacts_.corners(PatchId(p), 3, kMaxPatchesAtCorner);
    const std::size_t step = 1 + corners.size() / kMaxCornersOfPatch;
    for (std::size_t i = 0; i < corners.size() && !work.is_spent(); i += step) {
      control.check();
      const Vec3& corner = surface_.local[corners[i]];
      best = std::min(best, squared_gap(corner, PatchId(p), {best, 0}, What::kFaced, nullptr, &work).squared);
    }
    looked.steps += work.taken();
    if (work.is_spent()) looked.cut_short.push_back(p);
  }
  least.lower(best);
  return looked;
}

/// Searches from the triangles in some slots, and lowers `least`.
GapSearch::Index::Looked GapSearch::Index::look_from(const Block& slots, SharedLeast& least,
                                                     RunControl& control) const {
  JoinedMemory are_joined(contacts_);
  double best = slots.known;
  Looked looked;
  for (const std::uint32_t slot : slots.items) {
    control.check();
    WorkBound work(slots.max_steps, &control);
    StepCounter steps(&work);
    const FloatBox& box = tree_[slot].box;
    const Common& mine = tree_[slot].tag;
    const Slab slab = slab_of(slot);
    const Corners3 here = corners(slot);
    tree_.search(
        best,
        [&](const TriangleBoxes::Entry& e) {
          if (!steps.take(1)) return HUGE_VAL;
          double least = squared_distance(e.box, box);
          if (least >= best) return least;
          least = squared_steep_distance(slab, products(e.tag.layer, here), e.box, e.tag.layer, least);
          if (least >= best) return least;
          const bool is_joined = (e.tag.hub.is_valid() && e.tag.hub == mine.hub) || e.tag.is_joined_to(mine.patch) ||
                                 (e.tag.patch.is_valid() && are_joined(mine.patch, e.tag.patch));
          return is_joined ? HUGE_VAL : least;
        },
        [&](std::size_t other) {
          steps.take(kStepsOfTriangle);
          const Vec3 way = shortest_way(here, corners(other));
          const double d = norm_squared(way);
          if (d >= best || d <= touching_squared_) return;
          if (bound_one_solid(mine.patch, tree_[other].tag.patch) &&
              dot(way, slab.plane.normal) * dot(way, slab_of(other).plane.normal) > 0)
            return;
          if (!slab.is_steep(way)) return;  // if the way is steep for the other patch, it is found from there
          if (!do_intersect(triangle(slot), triangle(other), surface_.local.items())) best = d;
        });
    looked.steps += steps.taken();
    if (steps.taken() > slots.max_steps) looked.cut_short.push_back(slot);
  }
  least.lower(best);
  return looked;
}

GapSearch::GapSearch(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                     double plane_tolerance, RunControl& control, const TriangulatedPatches* triangulated,
                     const Rules& rules)
    : index_(std::make_unique<Index>(surface, adjacency, patches, plane_tolerance, control, triangulated, rules)) {}
GapSearch::~GapSearch() = default;

double GapSearch::at(const Vec3& place, PatchId patch, double limit, const Triangle* on, WorkBound* work) const {
  return index_->distance(place, patch, limit, What::kFaced, on, work);
}
double GapSearch::at(const Vec3& place, PatchId patch, double limit, WorkBound* work, double enough) const {
  return index_->distance(place, patch, limit, What::kFaced, nullptr, work, enough);
}
double GapSearch::nearest(const Vec3& place, PatchId patch, double limit, const Triangle* on, WorkBound* work) const {
  return index_->distance(place, patch, limit, What::kAll, on, work);
}
double GapSearch::beside(std::span<const Corners3> pieces, PatchId patch, double limit, WorkBound* work) const {
  return index_->beside(pieces, patch, limit, work);
}
std::optional<double> GapSearch::smallest(RunControl& control, std::uint64_t max_output_faces) const {
  return index_->smallest(max_output_faces, control);
}
std::size_t GapSearch::patch_count() const { return index_->patch_count(); }
bool GapSearch::is_curved(PatchId patch) const { return index_->is_curved(patch); }
const Axes& GapSearch::axes_of(PatchId patch) const { return index_->axes_of(patch); }
std::span<const Triangle> GapSearch::triangles_of(PatchId patch) const { return index_->triangles_of(patch); }

}  // namespace remesh
