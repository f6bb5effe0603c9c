#include "core/stages/coplanar_regions.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/large_first.h"
#include "core/base/parallel.h"
#include "core/base/tolerance.h"
#include "core/base/union_find.h"
#include "core/geometry/plane_fit.h"

namespace remesh {
namespace {

/// Neighbours must be this many tolerances high to bear witness of noise.
constexpr double kWitness = 8;
/// Faces are held within this part of the tolerance on either side of the plane, so that input and output, both in that
/// band, are never further apart than the tolerance. While the plane is still being fitted all of it is allowed.
constexpr double kBand = 0.5;
/// A face is looked at by at most this many growths that end up without it; then only by those that have their plane.
constexpr std::uint8_t kMostTrials = 8;

/// What printing does to a coordinate, in its steps, and a little more for what the numbers went through before.
constexpr double kPrinted = 0.51;

constexpr std::size_t kBlock = 4096;

/// Neighbours whose normals have more than this cosine, as most have, are not apart: no need to look closer.
constexpr double kNearlyFlat = 0.9999;

/// A face from which a region is grown: the largest first; among equally large ones the one at the smallest place.
struct Seed {
  double area = -1;
  Vec3 place;
  FaceId face;
  bool is_before(const Seed& b) const {
    if (area != b.area) return area > b.area;
    return place != b.place ? place < b.place : face < b.face;
  }
};

/// Some faces in the order of seeds. Most faces get their region from another one, so that few are ever asked for: each
/// block of faces knows its first, and is looked through again when that one has been taken.
class Seeds {
 public:
  Seeds(const Surface& surface, const FaceGeometries& geometry, RunControl& control)
      : surface_(surface), geometry_(geometry), control_(control) {}

  /// Begins with other faces, which stay as long as they are asked for.
  void begin(std::span<const std::uint32_t> faces) {
    faces_ = faces;
    looks_left_ = kLooks * faces.size();
    first_of_block_.clear();
    is_sorted_ = false;
    sorted_.clear();
    next_ = 0;
  }

  /// The next one that is open still; invalid at the end. Faces that are not open stay so.
  template <class IsOpen>
  FaceId next(const IsOpen& is_open) {
    if (!is_sorted_ && looks_left_ > 0) return first(is_open);
    if (!is_sorted_) sort(is_open);
    while (next_ < sorted_.size() && !is_open(sorted_[next_])) ++next_;
    return next_ < sorted_.size() ? sorted_[next_++] : FaceId();
  }

  Seed placed(FaceId f) const { return {geometry_[f].area, face_centre(surface_, f), f}; }

 private:
  /// So often each face may be looked at before they are sorted.
  static constexpr std::size_t kLooks = 8;

  template <class IsOpen>
  Seed first_of(std::size_t begin, std::size_t end, const IsOpen& is_open) const {
    Seed best;
    for (std::size_t i = begin; i < end; ++i) {
      const FaceId f(faces_[i]);
      if (!is_open(f) || geometry_[f].area < best.area) continue;
      const Seed other = placed(f);
      if (!best.face.is_valid() || other.is_before(best)) best = other;
    }
    return best;
  }

  template <class IsOpen>
  FaceId first(const IsOpen& is_open) {
    const bool is_new = first_of_block_.empty();
    first_of_block_.resize((faces_.size() + kBlock - 1) / kBlock);
    stale_.clear();
    for (std::size_t block = 0; block < first_of_block_.size(); ++block)
      if (const FaceId f = first_of_block_[block].face; is_new || (f.is_valid() && !is_open(f)))
        stale_.push_back(block);
    looks_left_ -= std::min(looks_left_, first_of_block_.size() + kBlock * stale_.size());
    for_blocks(stale_.size(), 1, control_, [&](std::size_t i, std::size_t) {
      const std::size_t begin = kBlock * stale_[i];
      first_of_block_[stale_[i]] = first_of(begin, std::min(faces_.size(), begin + kBlock), is_open);
    });
    Seed best;
    for (const Seed& other : first_of_block_)
      if (other.face.is_valid() && (!best.face.is_valid() || other.is_before(best))) best = other;
    return best.face;
  }

  template <class IsOpen>
  void sort(const IsOpen& is_open) {
    is_sorted_ = true;
    const auto open = select_ids<std::uint32_t>(faces_.size(), kBlock, control_,
                                                [&](std::size_t i) { return is_open(FaceId(faces_[i])); });
    std::vector<Seed> all(open.size());
    sorted_.resize(open.size());
    const auto for_each = [&](const auto& visit) {
      for_blocks(all.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visit(i);
      });
    };
    for_each([&](std::size_t i) { all[i] = placed(FaceId(faces_[open[i]])); });
    sort_all(all.begin(), all.end(), [](const Seed& a, const Seed& b) { return a.is_before(b); });
    for_each([&](std::size_t i) { sorted_[i] = all[i].face; });
  }

  const Surface& surface_;
  const FaceGeometries& geometry_;
  RunControl& control_;
  std::span<const std::uint32_t> faces_;
  std::size_t looks_left_ = 0;
  std::vector<Seed> first_of_block_;  ///< no face: none of them is open
  std::vector<std::size_t> stale_;
  bool is_sorted_ = false;
  std::vector<FaceId> sorted_;
  std::size_t next_ = 0;
};

/// Faces accepted so far, for the plane through them: area-weighted, so that the normal depends on the rim alone.
struct Fit {
  Vec3 area_vector, moment;
  double area = 0;

  void add(const FaceGeometry& g, const Vec3& centre) {
    area_vector += g.area * g.normal;
    moment += g.area * centre;
    area += g.area;
  }
  void add(const Fit& other) {
    area_vector += other.area_vector;
    moment += other.moment;
    area += other.area;
  }
  Plane plane() const { return {(1 / area) * moment, normalized(area_vector)}; }
};

class Growth {
 public:
  Growth(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
         const CoplanarityRule& rule, Regions& regions, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        geometry_(geometry),
        rule_(rule),
        regions_(regions),
        control_(control),
        stamp_(surface.face_count()),
        trials_(surface.face_count(), 0) {
    // Corners lie within [-1, 1]; the floor is relative to the diagonal.
    const auto box_of = [&](std::size_t begin, std::size_t end) {
      Box3 box;
      for (std::size_t v = begin; v < end; ++v) box.add(surface.local[VertexId(v)]);
      return box;
    };
    Box3 box;
    for (const Box3& part : map_blocks<Box3>(surface.vertex_count(), kBlock, control, box_of)) box.add(part);
    floor_ = kToleranceFloor * box.diagonal();
    first_region_ = static_cast<std::uint32_t>(regions.planes.size());
    for (std::size_t rung = 0; rung < tolerance_at_.size(); ++rung)
      tolerance_at_[rung] = tolerance_at_rung(rule.plane_tolerance, static_cast<std::uint8_t>(rung), floor_);
    for_blocks(surface.face_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) stamp_[f] = regions.of_face[FaceId(f)].is_valid() ? kTaken : 0;
    });
  }

  void run() {
    find_joints();
    grow();
    merge();
  }

 private:
  struct NewRegion {
    bool is_thin;  ///< these after all others
    Seed seed;
    Plane plane;
    bool is_before(const NewRegion& b) const { return is_thin != b.is_thin ? b.is_thin : seed.is_before(b.seed); }
  };

  /// What one thread has while it grows regions.
  struct Walk {
    Seeds seeds;
    std::vector<std::uint32_t> found = {};  ///< faces, by the growth that is going on
    std::uint32_t now = 0;                  ///< its number
    std::vector<NewRegion> regions = {};
  };

  double tolerance(FaceId f) const { return tolerance_at_[(*rule_.rung)[f]]; }
  bool is_thin(FaceId f) const { return geometry_[f].height < kThinFace * tolerance(f); }

  bool are_in_one_zone(FaceId f, FaceId g) const { return rule_.zone->empty() || (*rule_.zone)[f] == (*rule_.zone)[g]; }

  /// Whether the two triangles at an edge bend by more than printing can do: then no four corners that are printed as
  /// theirs lie in one plane. (To first order the volume of the four changes by the faces' areas along each axis.)
  bool is_bend(std::uint32_t h) const {
    if (rule_.printed_steps == Vec3{}) return false;
    const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(adjacency_.twin(h));
    if (surface_.face(f).size() != 3 || surface_.face(g).size() != 3 || is_thin(f) || is_thin(g)) return false;
    if (1 - dot(geometry_[f].normal, geometry_[g].normal) <= rule_.normal_tolerance) return false;
    const VertexId from = adjacency_.from(h), to = adjacency_.to(h);
    const Vec3 a = surface_.local[from];
    const auto apex = [&](FaceId face) {
      const auto corners = surface_.face(face);
      const auto other = std::find_if(corners.begin(), corners.end(), [&](VertexId v) { return v != from && v != to; });
      return surface_.local[*other] - a;
    };
    const Vec3 b = surface_.local[to] - a, c = apex(f), d = apex(g);
    const Vec3& step = rule_.printed_steps;
    double explained = 0;
    for (const Vec3& n : {cross(b, c), cross(b, d), cross(c, d), cross(c - b, d - b)})
      explained += step.x * std::fabs(n.x) + step.y * std::fabs(n.y) + step.z * std::fabs(n.z);
    return std::fabs(dot(cross(b, c), d)) > kPrinted * explained;
  }

  /// The square of the sine of the angle that a face may have to its plane: what the distance explains; the floor is
  /// per component of the normal.
  double squared_sine(FaceId f, double tol) const {
    const double sine = std::max(rule_.normal_tolerance, kThinFace * tol / geometry_[f].height);
    return 3 * sine * sine;
  }

  /// Whether two neighbours look the same way, as most do: then they are neither apart nor is there a bend.
  bool are_flat(FaceId f, FaceId g) const {
    const double cosine = dot(geometry_[f].normal, geometry_[g].normal);
    return cosine > kNearlyFlat && 1 - cosine <= rule_.normal_tolerance;
  }

  /// Whether two neighbours turn so far against each other that no plane fits both.
  bool are_apart(FaceId f, FaceId g) const {
    const double cosine = dot(geometry_[f].normal, geometry_[g].normal);
    if (cosine > kNearlyFlat || is_thin(f) || is_thin(g)) return false;
    const double a = squared_sine(f, tolerance(f)), b = squared_sine(g, tolerance(g));
    // Less than the cosine of the two angles' sum, and a little for rounding.
    return a < 1 && b < 1 && cosine + 1e-12 < std::sqrt((1 - a) * (1 - b)) - std::sqrt(a * b);
  }

  bool fits(FaceId f, const Plane& plane, double tol) const {
    // The normal first: it is one test, where a large polygon with many neighbours has many corners.
    if (!is_thin(f)) {
      const double cosine = dot(geometry_[f].normal, plane.normal);
      if (!(cosine > 0 && 1 - cosine * cosine <= squared_sine(f, tol))) return false;
    }
    for (const VertexId v : surface_.face(f))
      if (std::fabs(plane.distance(surface_.local[v])) > tol) return false;
    return true;
  }

  /// Over which edges regions may grow at all.
  void find_joints() {
    static_assert(kBlock % kBits == 0, "no word belongs to two blocks");
    joints_.resize((surface_.corners.size() + kBits - 1) / kBits);
    for_blocks(surface_.corners.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency_.twin(h);
        if (twin == Adjacency::kNone || twin < h) continue;
        const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(twin);
        if (stamp_[f.value] != kTaken && stamp_[g.value] != kTaken && are_in_one_zone(f, g) &&
            (*rule_.rung)[g] == (*rule_.rung)[f] && (are_flat(f, g) || (!are_apart(f, g) && !is_bend(h))))
          joints_[h / kBits] |= std::uint64_t{1} << h % kBits;
      }
    });
  }

  /// Input:  of the edge's half-edges the smaller one.
  bool is_joint(std::uint32_t h) const { return (joints_[h / kBits] >> h % kBits & 1) != 0; }

  /// Gives each face without a region the number of its island for one: of those that hang together over joints.
  /// Output: how many islands there are.
  std::size_t number_islands() {
    const std::size_t n = surface_.face_count();
    UnionFind sets(n);
    for_blocks(surface_.corners.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        if (!is_joint(h)) continue;
        sets.join(adjacency_.face_of(h).value, adjacency_.face_of(adjacency_.twin(h)).value);
      }
    });
    for_blocks(n, kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) sets.flatten(static_cast<std::uint32_t>(f));
    });
    const auto roots = select_ids<std::uint32_t>(n, kBlock, control_, [&](std::size_t f) {
      return sets.root_of(static_cast<std::uint32_t>(f)) == f && stamp_[f] != kTaken;
    });
    // A root has its island's number for a stamp, until all know theirs; that stands where their region's will.
    for_blocks(roots.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) stamp_[roots[i]] = static_cast<std::uint32_t>(i);
    });
    for_blocks(n, kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (FaceId f(begin); f.value < end; ++f.value)
        if (const std::uint32_t number = stamp_[sets.root_of(f.value)]; number != kTaken)
          regions_.of_face[f] = RegionId(number);
    });
    for_blocks(roots.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) stamp_[roots[i]] = 0;
    });
    return roots.size();
  }

  /// The faces without a region, by islands. All other faces come last.
  Grouping find_islands() {
    const std::size_t count = number_islands();
    const auto key = [&](std::uint32_t f) { return stamp_[f] == kTaken ? count : regions_.of_face[FaceId(f)].value; };
    return group_by(surface_.face_count(), count + 1, key, control_);
  }

  /// Gives every face a region, island by island; then regions are numbered in the order of their seeds.
  void grow() {
    const Grouping islands = find_islands();
    const std::size_t count = islands.begin.size() - 2;
    const LargeFirst by_size = large_first(count, kBlock, [&](std::uint32_t i) { return islands[i].size(); });
    const auto grow_some = [&](std::size_t begin, std::size_t end) {
      Walk walk{Seeds(surface_, geometry_, control_)};
      for (std::size_t i = begin; i < end; ++i) grow_on(islands[by_size.order[i]], walk);
      return std::move(walk.regions);
    };
    std::vector<std::vector<NewRegion>> found(by_size.large);
    for_all(std::size_t{0}, by_size.large, [&](std::size_t i) { found[i] = grow_some(i, i + 1); });
    for (auto& of_block : map_blocks<std::vector<NewRegion>>(
             count - by_size.large, 256, control_,
             [&](std::size_t i, std::size_t end) { return grow_some(by_size.large + i, by_size.large + end); }))
      found.push_back(std::move(of_block));
    number_regions(found, std::span(islands.items).first(islands.begin[count]));
  }

  void number_regions(const std::vector<std::vector<NewRegion>>& found, std::span<const std::uint32_t> faces) {
    std::vector<NewRegion> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    sort_all(all.begin(), all.end(), [](const NewRegion& a, const NewRegion& b) { return a.is_before(b); });
    // All faces are taken: a seed may have its region's number for a stamp.
    regions_.planes.resize(first_region_ + all.size());
    seeds_.resize(all.size());
    for_blocks(all.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const RegionId r(first_region_ + i);
        seeds_[i] = all[i].seed.face;
        regions_.planes[r] = all[i].plane;
        stamp_[seeds_[i].value] = r.value;
      }
    });
    for_blocks(faces.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        RegionId& of_face = regions_.of_face[FaceId(faces[i])];
        of_face = RegionId(stamp_[of_face.value]);
      }
    });
  }

  void grow_on(std::span<const std::uint32_t> island, Walk& walk) {
    std::size_t left = island.size();
    // Thin faces seed only what no other face has taken.
    for (const bool thin : {false, true}) {
      const auto is_open = [&](FaceId f) { return stamp_[f.value] != kTaken && is_thin(f) == thin; };
      walk.seeds.begin(island);
      while (left > 0) {
        const FaceId seed = walk.seeds.next(is_open);
        if (!seed.is_valid()) break;
        std::optional<Plane> plane;
        if (left == island.size()) plane = plane_of_all(seed, island);
        std::span<const std::uint32_t> found = island;
        if (!plane) {
          plane = grow_from(seed, walk);
          found = walk.found;
        }
        walk.regions.push_back({thin, walk.seeds.placed(seed), *plane});
        take(found, seed);
        left -= found.size();
      }
    }
  }

  /// The plane of an island that fits one, as most do: growing could only come to the same.
  std::optional<Plane> plane_of_all(FaceId seed, std::span<const std::uint32_t> island) const {
    if ((*rule_.rung)[seed] == kSingleFace) return std::nullopt;
    const Fit fit = fit_of(seed, island);
    if (!(fit.area > 0)) return std::nullopt;
    const Plane plane = fit.plane();
    return do_all_fit(island, plane, kBand * tolerance(seed)) ? std::optional(plane) : std::nullopt;
  }

  template <class Accept>
  void for_each_open_neighbour(FaceId f, const Walk& walk, Accept accept) {
    for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
      const std::uint32_t twin = adjacency_.twin(h);
      if (twin == Adjacency::kNone || !is_joint(std::min(h, twin))) continue;
      const FaceId g = adjacency_.face_of(twin);
      if (stamp_[g.value] != kTaken && stamp_[g.value] != walk.now) accept(g);
    }
  }

  /// Finds the plane of the seed's region by growing while fitting, then the region by growing in that plane.
  Plane grow_from(FaceId seed, Walk& walk) {
    const Plane seed_plane = Plane{face_centre(surface_, seed), geometry_[seed].normal};
    if ((*rule_.rung)[seed] == kSingleFace) {
      walk.found.assign(1, seed.value);
      return seed_plane;
    }
    const double tol = tolerance(seed);
    Plane plane = grow_fitting(seed, seed_plane, tol, walk);
    const double band = kBand * tol;
    if (!do_all_fit(walk.found, plane, band)) {
      for (const std::uint32_t f : walk.found)
        if (trials_[f] < kMostTrials) ++trials_[f];
      if (!fits(seed, plane, band)) plane = seed_plane;
      grow_in_plane(seed, plane, band, walk);
    }
    return plane;
  }

  bool do_all_fit(std::span<const std::uint32_t> faces, const Plane& plane, double tol) const {
    std::atomic<bool> do_fit = true;
    const auto look = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && do_fit; ++i)
        if (!fits(FaceId(faces[i]), plane, tol)) do_fit = false;
    };
    for_blocks(faces.size(), kBlock, control_, look);
    return do_fit;
  }

  /// Makes `value` at least `least`, whoever else does.
  static void raise(double& value, double least) {
    const std::atomic_ref shared(value);
    double now = shared.load(std::memory_order_relaxed);
    while (now < least && !shared.compare_exchange_weak(now, least, std::memory_order_relaxed)) continue;
  }

  /// What is known of a region while regions are merged; a region that has been taken in by another one is empty.
  struct Piece {
    std::vector<FaceId> faces;  ///< filled in, as are the moments, if any regions might be merged
    PointMoments moments;
    double tolerance = 0;
    double height = 0;  ///< of its highest face: what its normal is worth
    std::uint8_t failures = 0;
    bool may_merge = false;
  };

  /// Joins neighbouring regions that have one plane after all. Growth begins with a plane as good as one face, and on a
  /// thin frame that plane is wrong at the far end by many times the rounding; all corners together know better.
  void merge() {
    if (first_region_ == regions_.planes.size()) return;
    std::vector<Piece> pieces(regions_.planes.size() - first_region_);
    const auto piece_of = [&](FaceId f) {
      const RegionId r = regions_.of_face[f];
      const bool may_merge = r.value >= first_region_ && (*rule_.rung)[f] != kSingleFace;
      return may_merge ? &pieces[r.value - first_region_] : nullptr;
    };
    for_blocks(surface_.face_count(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (FaceId f(begin); f.value < end; ++f.value)
        if (Piece* piece = piece_of(f)) raise(piece->height, geometry_[f].height);
    });
    // All faces of a region are on one step of the ladder.
    for (std::size_t r = 0; r < pieces.size(); ++r) {
      pieces[r].may_merge = (*rule_.rung)[seeds_[r]] != kSingleFace;
      pieces[r].tolerance = tolerance(seeds_[r]);
    }
    auto pairs = bordering_pieces(pieces);
    if (pairs.empty()) return;
    for (FaceId f(0); f.value < surface_.face_count(); ++f.value) {
      if (f.value % kBlock == 0) control_.check();
      Piece* piece = piece_of(f);
      if (piece == nullptr) continue;
      piece->faces.push_back(f);
      for (const VertexId v : surface_.face(f)) piece->moments.add(surface_.local[v]);
    }
    // Each pass may make neighbours of regions that were not; few are needed.
    constexpr int kMostPasses = 8;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      bool is_changed = false;
      for (const auto& [a, b] : pairs) is_changed = try_merge(pieces, a, b) || is_changed;
      if (!is_changed || pass + 1 == kMostPasses) return;
      pairs = bordering_pieces(pieces);
    }
  }

  /// Pairs of new regions with an edge between them whose planes might be one, ascending: in the order of their seeds.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> bordering_pieces(const std::vector<Piece>& pieces) {
    using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    const auto find = [&](std::size_t begin, std::size_t end) {
      Pairs found;
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency_.twin(h);
        if (twin == Adjacency::kNone || twin < h) continue;
        const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(twin);
        const RegionId r = regions_.of_face[f], q = regions_.of_face[g];
        if (r == q || std::min(r, q).value < first_region_ || !are_in_one_zone(f, g) || is_bend(h)) continue;
        const std::uint32_t a = std::min(r, q).value - first_region_, b = std::max(r, q).value - first_region_;
        if (is_alike(pieces, a, b)) found.push_back({a, b});
      }
      return found;
    };
    Pairs pairs;
    for (const Pairs& found : map_blocks<Pairs>(surface_.corners.size(), kBlock, control_, find))
      pairs.insert(pairs.end(), found.begin(), found.end());
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  /// Whether two regions' planes turn against each other by no more than what the tolerance explains.
  bool is_alike(const std::vector<Piece>& pieces, std::uint32_t a, std::uint32_t b) const {
    if (!pieces[a].may_merge || !pieces[b].may_merge) return false;
    const double cosine =
        dot(regions_.planes[RegionId(first_region_ + a)].normal, regions_.planes[RegionId(first_region_ + b)].normal);
    const double height = std::min(pieces[a].height, pieces[b].height);
    const double sine = 2 * kThinFace * pieces[a].tolerance / std::max(height, 1e-300);
    return cosine > 0 && 1 - cosine * cosine <= sine * sine;
  }

  bool try_merge(std::vector<Piece>& pieces, std::uint32_t a, std::uint32_t b) {
    if (!pieces[a].may_merge || !pieces[b].may_merge) return false;
    if (pieces[a].failures >= kMostTrials || pieces[b].failures >= kMostTrials) return false;
    PointMoments moments = pieces[a].moments;
    moments.merge(pieces[b].moments);
    const PlaneFit fit = fit_plane(moments);
    const double band = kBand * pieces[a].tolerance;
    constexpr double kRounding = 1e-7;  // of moments, in local units
    if (fit.rms > band + kRounding) return false;
    Plane plane{moments.mean(), fit.normal};
    if (dot(plane.normal, regions_.planes[RegionId(first_region_ + a)].normal) < 0) plane.normal = -plane.normal;
    centre(plane, {&pieces[a].faces, &pieces[b].faces});
    for (const auto* faces : {&pieces[a].faces, &pieces[b].faces})
      for (const FaceId f : *faces)
        if (!fits(f, plane, band)) {
          ++pieces[a].failures;
          ++pieces[b].failures;
          return false;
        }
    regions_.planes[RegionId(first_region_ + a)] = plane;
    for (const FaceId f : pieces[b].faces) regions_.of_face[f] = RegionId(first_region_ + a);
    // The smaller list is moved to the larger one.
    if (pieces[a].faces.size() < pieces[b].faces.size()) std::swap(pieces[a].faces, pieces[b].faces);
    pieces[a].faces.insert(pieces[a].faces.end(), pieces[b].faces.begin(), pieces[b].faces.end());
    pieces[a].moments = moments;
    pieces[a].height = std::max(pieces[a].height, pieces[b].height);
    pieces[b] = {};
    return true;
  }

  /// Shifts a plane along its normal to the middle of the corners.
  void centre(Plane& plane, std::initializer_list<const std::vector<FaceId>*> pieces) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto* faces : pieces)
      for (const FaceId f : *faces)
        for (const VertexId v : surface_.face(f)) {
          low = std::min(low, plane.distance(surface_.local[v]));
          high = std::max(high, plane.distance(surface_.local[v]));
        }
    plane.origin += (low + high) / 2 * plane.normal;
  }

  /// A layer is tested against one plane, and the plane is fitted anew when the region has doubled: so the order within
  /// a layer does not matter.
  Plane grow_fitting(FaceId seed, Plane plane, double tol, Walk& walk) {
    std::vector<std::uint32_t>& found = walk.found;
    begin_growth(seed, walk);
    Fit fit;
    std::size_t summed = 0, fitted = 1;
    const auto add_found = [&] {
      fit.add(fit_of(seed, std::span(found).subspan(summed)));
      summed = found.size();
    };
    for (std::size_t layer_begin = 0; layer_begin < found.size();) {
      const std::size_t layer_end = found.size();
      for (std::size_t i = layer_begin; i < layer_end; ++i) {
        if (i % 4096 == 0) control_.check();
        for_each_open_neighbour(FaceId(found[i]), walk, [&](FaceId g) {
          if (trials_[g.value] >= kMostTrials || !fits(g, plane, tol)) return;
          stamp_[g.value] = walk.now;
          found.push_back(g.value);
        });
      }
      layer_begin = layer_end;
      if (found.size() < 2 * fitted) continue;
      add_found();
      if (fit.area == 0) continue;
      plane = fit.plane();
      fitted = found.size();
    }
    add_found();
    return fit.area > 0 ? fit.plane() : plane;
  }

  /// Thin faces say nothing, but the seed has to.
  Fit fit_of(FaceId seed, std::span<const std::uint32_t> faces) const {
    const auto sum = [&](std::size_t begin, std::size_t end) {
      Fit part;
      for (std::size_t i = begin; i < end; ++i)
        if (const FaceId f(faces[i]); !is_thin(f) || f == seed) part.add(geometry_[f], face_centre(surface_, f));
      return part;
    };
    if (faces.size() <= kBlock) return sum(0, faces.size());
    Fit fit;
    for (const Fit& part : map_blocks<Fit>(faces.size(), kBlock, control_, sum)) fit.add(part);
    return fit;
  }

  void begin_growth(FaceId seed, Walk& walk) {
    ++walk.now;
    walk.found.assign(1, seed.value);
    stamp_[seed.value] = walk.now;
  }

  void grow_in_plane(FaceId seed, const Plane& plane, double tol, Walk& walk) {
    begin_growth(seed, walk);
    for (std::size_t i = 0; i < walk.found.size(); ++i) {
      if (i % 4096 == 0) control_.check();
      for_each_open_neighbour(FaceId(walk.found[i]), walk, [&](FaceId g) {
        if (!fits(g, plane, tol)) return;
        stamp_[g.value] = walk.now;
        walk.found.push_back(g.value);
      });
    }
  }

  /// The seed's number stands for the region's until all are known.
  void take(std::span<const std::uint32_t> faces, FaceId seed) {
    for_blocks(faces.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        regions_.of_face[FaceId(faces[i])] = RegionId(seed.value);
        stamp_[faces[i]] = kTaken;
      }
    });
    const std::size_t taken = faces_taken_ += faces.size();
    control_.progress(static_cast<double>(taken) / static_cast<double>(surface_.face_count()));
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const FaceGeometries& geometry_;
  const CoplanarityRule& rule_;
  Regions& regions_;
  RunControl& control_;
  double floor_ = 0;
  std::uint32_t first_region_ = 0;                      // older ones are not touched
  std::array<double, kSingleFace + 1> tolerance_at_{};  ///< each rung
  std::atomic<std::size_t> faces_taken_ = 0;
  /// Per face: the growth on its island that found it last, or that it has its region.
  std::vector<std::uint32_t, LeftUnset<std::uint32_t>> stamp_;
  static constexpr std::uint32_t kTaken = 0xffffffffu;
  std::vector<std::uint8_t> trials_;
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> joints_;  ///< a bit a half-edge; set for the smaller one of an edge
  std::vector<FaceId> seeds_;          ///< of the new regions
};

}  // namespace

double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor) {
  if (rung == 0) return tolerance;
  const double tighter = kLadderFactor * tolerance;
  return rung == 1 ? tighter : std::min(kLadderFactor * tighter, floor);
}

void coplanar_regions(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                      const CoplanarityRule& rule, Regions& regions, RunControl& control) {
  regions.of_face.resize(surface.face_count());
  regions.are_connected = regions.are_connected || regions.planes.empty();
  Growth(surface, adjacency, geometry, rule, regions, control).run();
}

bool is_noise_present(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry, double floor,
                      double tolerance) {
  const auto is_witness = [&](FaceId f) { return geometry[f].height >= kWitness * tolerance; };
  const auto bend = [&](FaceId of, FaceId against) {
    const Plane plane{face_centre(surface, against), geometry[against].normal};
    double most = 0;
    for (const VertexId v : surface.face(of)) {
      most = std::max(most, std::fabs(plane.distance(surface.local[v])));
      if (most > tolerance) break;  // a bend of another kind, however large
    }
    return most;
  };
  const auto is_noise = [&](double distance) { return distance > floor && distance <= tolerance; };
  const auto has_noise = [&](std::uint32_t i) {
    const FaceId f(i);
    if (!is_witness(f)) return false;
    if (surface.face(f).size() > 3 && is_noise(bend(f, f))) return true;
    for (std::uint32_t h = surface.face_begin[i]; h < surface.face_begin[i + 1]; ++h) {
      const std::uint32_t twin = adjacency.twin(h);
      if (twin == Adjacency::kNone || twin < h) continue;
      const FaceId g = adjacency.face_of(twin);
      if (is_witness(g) && dot(geometry[f].normal, geometry[g].normal) > 0 && is_noise(bend(g, f))) return true;
    }
    return false;
  };
  std::atomic<bool> is_found = false;
  for_all(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(surface.face_count()), kBlock),
          [&](const auto& range) {
            for (std::uint32_t i = range.begin(); i < range.end() && !is_found; ++i)
              if (has_noise(i)) is_found = true;
          });
  return is_found;
}

}  // namespace remesh
