#include "core/patches/planar/coplanar_regions.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/large_first.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/patches/planar/coplanarity.h"
#include "core/patches/planar/region_merging.h"
#include "core/patches/planar/region_planes.h"

namespace remesh {
namespace {

/// A face from which a region grows. The largest face comes first; among equally large ones, the one at the smallest
/// place.
struct Seed {
  double area = -1;
  Vec3 place;
  FaceId face;
  bool is_before(const Seed& b) const {
    if (area != b.area) return area > b.area;
    return place != b.place ? place < b.place : face < b.face;
  }
};

/// Gives some faces in the order of seeds. Where regions are large, most faces get their region from another face, so
/// that only a few are ever needed as seeds. Therefore each block of faces stores its first seed, and is searched again
/// when that seed has been taken. Where regions turn out to be small, the faces are sorted.
class Seeds {
 public:
  Seeds(const Surface& surface, const FaceGeometries& geometry, RunControl& control)
      : surface_(surface), geometry_(geometry), control_(control) {}

  /// Starts again with these faces. The span must exist as long as `next` is called.
  void begin(std::span<const std::uint32_t> faces) {
    faces_ = faces;
    looks_ = 0;
    first_of_block_.clear();
    is_sorted_ = false;
    sorted_.clear();
    next_ = 0;
  }

  /// The next face that is still free; invalid at the end. A face that is not free must never become free again.
  /// Input: `taken` - the number of faces that have been taken since `begin`.
  template <class IsFree>
  FaceId next(std::size_t taken, const IsFree& is_free) {
    if (!is_sorted_ && looks_ <= faces_.size() + kLooks * taken) return first(is_free);
    if (!is_sorted_) sort(is_free);
    while (next_ < sorted_.size() && !is_free(sorted_[next_])) ++next_;
    fetch_ahead();
    return next_ < sorted_.size() ? sorted_[next_++] : FaceId();
  }

  Seed placed(FaceId f) const { return {geometry_[f].area, face_centre(surface_, f), f}; }

 private:
  /// Before the faces are sorted, all may be looked at once, and so many for each face that has been taken.
  static constexpr std::size_t kLooks = 8;
  static constexpr std::size_t kFacesPerBlock = 4096;

  template <class IsFree>
  Seed first_of(std::size_t begin, std::size_t end, const IsFree& is_free) const {
    Seed best;
    for (std::size_t i = begin; i < end; ++i) {
      const FaceId f(faces_[i]);
      if (!is_free(f) || geometry_[f].area < best.area) continue;
      const Seed other = placed(f);
      if (!best.face.is_valid() || other.is_before(best)) best = other;
    }
    return best;
  }

  template <class IsFree>
  FaceId first(const IsFree& is_free) {
    const bool is_new = first_of_block_.empty();
    first_of_block_.resize((faces_.size() + kFacesPerBlock - 1) / kFacesPerBlock);
    stale_.clear();
    for (std::size_t block = 0; block < first_of_block_.size(); ++block)
      if (const FaceId f = first_of_block_[block].face; is_new || (f.is_valid() && !is_free(f)))
        stale_.push_back(block);
    looks_ += first_of_block_.size() + std::min(faces_.size(), kFacesPerBlock * stale_.size());
    for_blocks(stale_.size(), 1, control_, [&](std::size_t i, std::size_t) {
      const std::size_t begin = kFacesPerBlock * stale_[i];
      first_of_block_[stale_[i]] = first_of(begin, std::min(faces_.size(), begin + kFacesPerBlock), is_free);
    });
    Seed best;
    for (const Seed& other : first_of_block_)
      if (other.face.is_valid() && (!best.face.is_valid() || other.is_before(best))) best = other;
    return best.face;
  }

  /// Fetches what the growths from later seeds read first, in three steps, since each step reads what the step before
  /// has fetched. Large meshes do not fit into the cache, and seeds that follow each other lie anywhere in memory.
  void fetch_ahead() const {
    constexpr std::size_t kStep = 8;
    if (next_ + 3 * kStep >= sorted_.size()) return;
    const FaceId last = sorted_[next_ + 3 * kStep];
    __builtin_prefetch(&geometry_[last]);
    __builtin_prefetch(&surface_.face_begin[last.value]);
    __builtin_prefetch(surface_.face(sorted_[next_ + 2 * kStep]).data());
    for (const VertexId v : surface_.face(sorted_[next_ + kStep])) __builtin_prefetch(&surface_.local[v]);
  }

  template <class IsFree>
  void sort(const IsFree& is_free) {
    is_sorted_ = true;
    const auto free = select_ids<std::uint32_t>(faces_.size(), kFacesPerBlock, control_,
                                                [&](std::size_t i) { return is_free(FaceId(faces_[i])); });
    std::vector<Seed> all(free.size());
    sorted_.resize(free.size());
    const auto for_each = [&](const auto& visit) {
      for_blocks(all.size(), kFacesPerBlock, control_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visit(i);
      });
    };
    for_each([&](std::size_t i) { all[i] = placed(FaceId(faces_[free[i]])); });
    sort_stoppable(all.begin(), all.end(), control_, [](const Seed& a, const Seed& b) { return a.is_before(b); });
    for_each([&](std::size_t i) { sorted_[i] = all[i].face; });
  }

  const Surface& surface_;
  const FaceGeometries& geometry_;
  RunControl& control_;
  std::span<const std::uint32_t> faces_;
  std::size_t looks_ = 0;
  std::vector<Seed> first_of_block_;  ///< invalid if no face of the block is free
  std::vector<std::size_t> stale_;
  bool is_sorted_ = false;
  std::vector<FaceId> sorted_;
  std::size_t next_ = 0;
};

/// After this many growths have found a face without taking it, only growths that already have their final plane may
/// take it.
constexpr std::uint8_t kMaxTrials = 8;

constexpr std::size_t kBlock = 4096;

/// The joints: edges over which regions may grow.
class Joints {
 public:
  /// Finds the joints between free faces.
  template <class IsFree>
  void find(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule, const IsFree& is_free,
            RunControl& control) {
    static_assert(kBlock % kBits == 0, "no word belongs to two blocks");
    bits_.resize((surface.corners.size() + kBits - 1) / kBits);
    for_blocks(surface.corners.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency.twin(h);
        if (twin == kNone || twin < h) continue;
        const FaceId f = adjacency.face_of(h), g = adjacency.face_of(twin);
        if (is_free(f) && is_free(g) && rule.may_be_joined(h, f, g)) bits_[h / kBits] |= std::uint64_t{1} << h % kBits;
      }
    });
  }

  /// Input:  the smaller half-edge of an edge.
  bool has(std::uint32_t h) const { return (bits_[h / kBits] >> h % kBits & 1) != 0; }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> bits_;  ///< one bit per half-edge, set for the smaller half-edge of a joint
};

/// Grows the regions. Islands, which are faces that are connected over joints, are independent of each other.
class Growth {
 public:
  Growth(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
         const CoplanarityRule& rule, Regions& regions, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        geometry_(geometry),
        rule_(surface, adjacency, geometry, rule, control),
        planes_(surface, geometry, rule_, control),
        regions_(regions),
        control_(control),
        stamp_(surface.face_count()),
        trials_(surface.face_count(), 0) {
    first_region_ = static_cast<std::uint32_t>(regions.planes.size());
    for_blocks(surface.face_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) stamp_[f] = regions.of_face[FaceId(f)].is_valid() ? kTaken : 0;
    });
  }

  void run() {
    joints_.find(
        surface_, adjacency_, rule_, [&](FaceId f) { return stamp_[f.value] != kTaken; }, control_);
    grow();
    merge_regions(surface_, adjacency_, rule_, first_region_, seeds_, heights_, regions_, control_);
  }

 private:
  struct NewRegion {
    bool is_thin;  ///< thin regions come after all thick ones
    Seed seed;
    Plane plane;
    Extent extent;
    bool is_before(const NewRegion& b) const { return is_thin != b.is_thin ? b.is_thin : seed.is_before(b.seed); }
  };

  /// The state of one thread while it grows regions.
  struct Walk {
    Seeds seeds;
    std::vector<std::uint32_t> found = {};  ///< faces of the current growth
    std::uint32_t now = 0;                  ///< number of the current growth
    std::vector<NewRegion> regions = {};
  };

  /// Writes the number of its island to each face without a region, in place of the region. An island consists of faces
  /// that are connected over joints.
  /// Output: the number of islands.
  std::size_t number_islands() {
    const std::size_t n = surface_.face_count();
    UnionFind sets(n);
    for_blocks(surface_.corners.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        if (!joints_.has(h)) continue;
        sets.join(adjacency_.face_of(h).value, adjacency_.face_of(adjacency_.twin(h)).value);
      }
    });
    for_blocks(n, kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) sets.flatten(static_cast<std::uint32_t>(f));
    });
    const auto roots = select_ids<std::uint32_t>(n, kBlock, control_, [&](std::size_t f) {
      return sets.root_of(static_cast<std::uint32_t>(f)) == f && stamp_[f] != kTaken;
    });
    // The stamp of a root is its island's number, until all faces have that number in place of their region's.
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

  /// Groups the faces without a region by their islands (see number_islands). The last group has all faces that have a
  /// region.
  Grouping find_islands() {
    const std::size_t count = number_islands();
    const auto key = [&](std::uint32_t f) { return stamp_[f] == kTaken ? count : regions_.of_face[FaceId(f)].value; };
    return group_by(surface_.face_count(), count + 1, key, control_);
  }

  /// Gives every face a region, island by island. Then numbers the regions in the order of their seeds.
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
    for_all(0, by_size.large, [&](std::size_t i) { found[i] = grow_some(i, i + 1); });
    for (auto& of_block : map_blocks<std::vector<NewRegion>>(
             count - by_size.large, 256, control_,
             [&](std::size_t i, std::size_t end) { return grow_some(by_size.large + i, by_size.large + end); }))
      found.push_back(std::move(of_block));
    number_regions(found, std::span(islands.items).first(islands.begin[count]));
  }

  void number_regions(const std::vector<std::vector<NewRegion>>& found, std::span<const std::uint32_t> faces) {
    // Copies of the values that comparisons read most often, close together in memory.
    struct Place {
      bool is_thin;
      double area;
      const NewRegion* region;
    };
    auto all = concatenate<Place>(found, control_, [](const NewRegion& region) {
      return Place{region.is_thin, region.seed.area, &region};
    });
    sort_stoppable(all.begin(), all.end(), control_, [](const Place& a, const Place& b) {
      if (a.is_thin == b.is_thin && a.area != b.area) return a.area > b.area;
      return a.region->is_before(*b.region);
    });
    // All faces are taken, so the stamp of a seed is free for its region's number.
    // The vectors are resized through `items`, so that all threads fill them and no single thread clears them first.
    regions_.planes.items().resize(first_region_ + all.size());
    regions_.deviation.items().resize(first_region_ + all.size());
    seeds_.resize(all.size());
    heights_.resize(all.size());
    for_blocks(all.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const RegionId r(first_region_ + i);
        const NewRegion& region = *all[i].region;
        seeds_[i] = region.seed.face;
        heights_[i] = region.extent.height;
        regions_.planes[r] = region.plane;
        regions_.deviation[r] = region.extent.deviation;
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
    // Thin faces become seeds only where no other face has taken them.
    for (const bool thin : {false, true}) {
      const auto is_free = [&](FaceId f) { return stamp_[f.value] != kTaken && rule_.is_thin(f) == thin; };
      walk.seeds.begin(island);
      const std::size_t left_before = left;
      while (left > 0) {
        const FaceId seed = walk.seeds.next(left_before - left, is_free);
        if (!seed.is_valid()) break;
        std::optional<FittedPlane> region;
        if (left == island.size()) region = planes_.of_all(seed, island);
        std::span<const std::uint32_t> found = island;
        if (!region) {
          region = grow_from(seed, walk);
          found = walk.found;
        }
        walk.regions.push_back({thin, walk.seeds.placed(seed), region->plane, region->extent});
        take(found, seed);
        left -= found.size();
      }
    }
  }

  template <class Accept>
  void for_each_free_neighbour(FaceId f, const Walk& walk, Accept accept) {
    for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
      const std::uint32_t twin = adjacency_.twin(h);
      if (twin == kNone || !joints_.has(std::min(h, twin))) continue;
      const FaceId g = adjacency_.face_of(twin);
      if (stamp_[g.value] != kTaken && stamp_[g.value] != walk.now) accept(g);
    }
  }

  /// Finds the plane of the seed's region by growing while fitting. Then finds the region by growing in that plane.
  FittedPlane grow_from(FaceId seed, Walk& walk) {
    const Plane seed_plane = Plane{face_centre(surface_, seed), geometry_[seed].normal};
    if (rule_.is_single(seed)) {
      walk.found.assign(1, seed.value);
      return {seed_plane, planes_.extent_of(walk.found, seed_plane)};
    }
    const double tol = rule_.tolerance(seed);
    Plane plane = grow_fitting(seed, seed_plane, tol, walk);
    const double half_slab = kHalfSlab * tol;
    if (const auto extent = planes_.extent_if_all_fit(walk.found, plane, half_slab)) return {plane, *extent};
    for (const std::uint32_t f : walk.found)
      if (trials_[f] < kMaxTrials) ++trials_[f];
    if (!rule_.fits(seed, plane, half_slab)) plane = seed_plane;
    grow_in_plane(seed, plane, half_slab, walk);
    return {plane, planes_.extent_of(walk.found, plane)};
  }

  /// Grows a region while fitting its plane. A whole layer is tested against one plane, and the plane is fitted again
  /// only when the region has doubled. So the order within a layer does not matter.
  Plane grow_fitting(FaceId seed, Plane plane, double tol, Walk& walk) {
    std::vector<std::uint32_t>& found = walk.found;
    begin_growth(seed, walk);
    PlaneSums fit;
    std::size_t summed = 0, fitted = 1;
    const auto add_found = [&] {
      fit.add(planes_.sum_of(seed, std::span(found).subspan(summed)));
      summed = found.size();
    };
    for (std::size_t layer_begin = 0; layer_begin < found.size();) {
      const std::size_t layer_end = found.size();
      for (std::size_t i = layer_begin; i < layer_end; ++i) {
        if (i % 4096 == 0) control_.check_and_move();
        for_each_free_neighbour(FaceId(found[i]), walk, [&](FaceId g) {
          if (trials_[g.value] >= kMaxTrials || !rule_.fits(g, plane, tol)) return;
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

  void begin_growth(FaceId seed, Walk& walk) {
    ++walk.now;
    walk.found.assign(1, seed.value);
    stamp_[seed.value] = walk.now;
  }

  void grow_in_plane(FaceId seed, const Plane& plane, double tol, Walk& walk) {
    begin_growth(seed, walk);
    for (std::size_t i = 0; i < walk.found.size(); ++i) {
      if (i % 4096 == 0) control_.check_and_move();
      for_each_free_neighbour(FaceId(walk.found[i]), walk, [&](FaceId g) {
        if (!rule_.fits(g, plane, tol)) return;
        stamp_[g.value] = walk.now;
        walk.found.push_back(g.value);
      });
    }
  }

  /// Marks faces as taken. Until all regions are known, the seed's number stands for the region's number.
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
  const Coplanarity rule_;
  const RegionPlanes planes_;
  Regions& regions_;
  RunControl& control_;
  std::uint32_t first_region_ = 0;  // older regions are not changed
  std::atomic<std::size_t> faces_taken_ = 0;
  /// Per face: the last growth on its island that found it, or kTaken if it has a region.
  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> stamp_;
  static constexpr std::uint32_t kTaken = 0xffffffffu;
  std::vector<std::uint8_t> trials_;
  Joints joints_;
  // The following are about the new regions.
  std::vector<FaceId> seeds_;
  std::vector<double> heights_;  ///< by region: the height of its highest face
};

}  // namespace

void coplanar_regions(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                      const CoplanarityRule& rule, Regions& regions, RunControl& control) {
  if (const std::size_t n = surface.face_count(); regions.of_face.size() != n) {
    regions.of_face = FilledIdVector<FaceId, RegionId>::of_size(n);
    for_blocks(n, kBlock, control, [&](std::size_t begin, std::size_t end) {
      std::fill_n(&regions.of_face[FaceId(begin)], end - begin, RegionId());
    });
  }
  regions.are_connected = regions.are_connected || regions.planes.empty();
  Growth(surface, adjacency, geometry, rule, regions, control).run();
}

}  // namespace remesh
