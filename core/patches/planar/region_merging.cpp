#include "core/patches/planar/region_merging.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/planes/plane_fit.h"

namespace remesh {
namespace {

/// Until a region has doubled, all its faces are tested against new planes at most this often when much smaller regions
/// are to be joined to it.
constexpr std::uint8_t kMaxWalks = 8;
/// A region this many times as large as another one is much larger.
constexpr std::size_t kMuchLargerRegion = 4;
/// The number of faces that are stored for each region because they did not fit a plane. If another plane is no better,
/// these faces soon show it.
constexpr std::size_t kMaxWitnesses = 8;

constexpr std::size_t kMergeBlock = 4096;

class Merging {
 public:
  Merging(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule, std::uint32_t first_region,
          std::span<const FaceId> seeds, std::span<const double> heights, Regions& regions, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        rule_(rule),
        first_region_(first_region),
        seeds_(seeds),
        heights_(heights),
        regions_(regions),
        control_(control) {}

  void run() {
    if (first_region_ == regions_.planes.size()) return;
    pieces_.resize(regions_.planes.size() - first_region_);
    // All faces of a region are on the same rung of the ladder.
    for_blocks(pieces_.size(), kMergeBlock, control_, [&](std::size_t r, std::size_t end) {
      for (; r < end; ++r) pieces_[r] = {rule_.tolerance(seeds_[r]), heights_[r], kNone, !rule_.is_single(seeds_[r])};
    });
    Pairs pairs = bordering_pieces();
    if (pairs.empty()) return;  // on most surfaces
    joined_ = UnionFind(pieces_.size());
    // Each pass may make regions neighbours that were not neighbours before. Few passes are needed.
    constexpr int kMaxPasses = 8;
    for (int pass = 0; pass < kMaxPasses; ++pass) {
      gather(pairs);
      if (!merge(pairs, pass) || pass + 1 == kMaxPasses) break;
      pairs = bordering_pieces();
    }
    for_blocks(pieces_.size(), kMergeBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto r = static_cast<std::uint32_t>(begin); r < end; ++r)
        if (pieces_[r].content != kNone && joined_.find(r) == r && content_of(r).merged_in >= 0) finish(r);
    });
  }

 private:
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  /// The state of a region while regions are merged.
  struct Piece {
    double tolerance = 0;
    double height = 0;  ///< height of its highest face; tells how accurate its normal is
    std::uint32_t content = kNone;
    bool may_merge = false;
  };
  /// The position of some faces relative to a plane.
  struct Lie {
    double low = HUGE_VAL, high = -HUGE_VAL;  ///< the range of all corners' distances along the normal
    double normal_to_spare = HUGE_VAL;        ///< the normal may move at least this far
  };
  /// The content of a region that has neighbours with similar planes.
  struct Content {
    std::vector<FaceId> faces;
    PointMoments moments;
    Box3 box;
    Lie lie;  ///< position relative to its plane, as an upper bound
    std::vector<FaceId> witnesses;
    std::size_t counted_from = 0;  ///< number of faces when `walks` was last reset
    std::uint8_t walks = 0;
    std::int8_t merged_in = -1;  ///< the last pass that added to it
  };

  /// Pairs of new regions that share an edge and whose planes might be one. The pairs are ascending, so they are in the
  /// order of their seeds.
  Pairs bordering_pieces() {
    const auto find = [&](std::size_t begin, std::size_t end) {
      Pairs found;
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency_.twin(h);
        if (twin == kNone || twin < h) continue;
        const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(twin);
        const RegionId r = regions_.of_face[f], q = regions_.of_face[g];
        if (r == q || std::min(r, q).value < first_region_ || !rule_.are_in_one_zone(f, g) || rule_.is_bend(h))
          continue;
        auto [a, b] = std::minmax({r.value - first_region_, q.value - first_region_});
        if (!contents_.empty()) std::tie(a, b) = std::minmax({joined_.find(a), joined_.find(b)});
        if (a != b && is_alike(a, b)) found.push_back({a, b});
      }
      return found;
    };
    Pairs pairs;
    for (const Pairs& found : map_blocks<Pairs>(surface_.corners.size(), kMergeBlock, control_, find))
      pairs.insert(pairs.end(), found.begin(), found.end());
    sort_unique(pairs, control_);
    return pairs;
  }

  /// Returns whether the planes of two regions turn against each other by no more than the tolerance explains.
  bool is_alike(std::uint32_t a, std::uint32_t b) const {
    if (!pieces_[a].may_merge || !pieces_[b].may_merge) return false;
    const double cosine = dot(plane_of(a).normal, plane_of(b).normal);
    const double height = std::min(pieces_[a].height, pieces_[b].height);
    const double sine = 2 * kThinFace * pieces_[a].tolerance / std::max(height, 1e-300);
    return cosine > 0 && 1 - cosine * cosine <= sine * sine;
  }

  /// Collects the content of regions that are in a pair for the first time.
  void gather(const Pairs& pairs) {
    const auto first = static_cast<std::uint32_t>(contents_.size());
    for (const auto& [a, b] : pairs) {
      for (const std::uint32_t r : {a, b}) {
        if (pieces_[r].content != kNone) continue;
        pieces_[r].content = static_cast<std::uint32_t>(contents_.size());
        contents_.emplace_back();
      }
    }
    if (contents_.size() == first) return;
    const auto is_new = [&](std::size_t f) {
      const RegionId r = regions_.of_face[FaceId(f)];
      if (r.value < first_region_) return false;
      const std::uint32_t content = pieces_[r.value - first_region_].content;
      return content != kNone && content >= first;
    };
    StopCheck check(control_);
    for (const FaceId f : select_ids<FaceId>(surface_.face_count(), kMergeBlock, control_, is_new)) {
      check();
      const RegionId r = regions_.of_face[f];
      const Piece& piece = pieces_[r.value - first_region_];
      Content& content = contents_[piece.content];
      content.faces.push_back(f);
      for (const VertexId v : surface_.face(f)) {
        content.moments.add(surface_.local[v]);
        content.box.add(surface_.local[v]);
      }
      if (!add(f, regions_.planes[r], kHalfSlab * piece.tolerance, content.lie))
        content.lie = {-HUGE_VAL, HUGE_VAL, -HUGE_VAL};  // a region of a single face may not fit its own plane
      content.counted_from = content.faces.size();
    }
  }

  /// Groups of pairs that are connected through regions. The pairs of a group are tried in their order. Two groups have
  /// no region in common, so groups are independent of each other.
  struct Groups {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> items;  ///< the group and the number of each pair, ascending
    std::vector<std::size_t> begin;  ///< where each group's items begin; one entry more than there are groups
  };

  Groups group(const Pairs& pairs) {
    UnionFind sets(pieces_.size());
    for_blocks(pairs.size(), kMergeBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) sets.join(pairs[i].first, pairs[i].second);
    });
    Groups groups;
    groups.items.resize(pairs.size());
    for_blocks(pairs.size(), kMergeBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) groups.items[i] = {sets.find(pairs[i].first), static_cast<std::uint32_t>(i)};
    });
    sort_stoppable(groups.items.begin(), groups.items.end(), control_);
    groups.begin = select_ids<std::size_t>(pairs.size(), kMergeBlock, control_, [&](std::size_t i) {
      return i == 0 || groups.items[i].first != groups.items[i - 1].first;
    });
    groups.begin.push_back(pairs.size());
    return groups;
  }

  /// Output: whether any regions were merged.
  bool merge(const Pairs& pairs, int pass) {
    constexpr std::size_t kGroupsPerTask = 64;
    const Groups groups = group(pairs);
    std::atomic<bool> is_changed = false;
    for_blocks(groups.begin.size() - 1, kGroupsPerTask, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = groups.begin[begin]; i < groups.begin[end]; ++i) {
        control_.check();
        const auto& pair = pairs[groups.items[i].second];
        const auto [a, b] = std::minmax({joined_.find(pair.first), joined_.find(pair.second)});
        // A pair of regions that have not changed since they were tried needs no new try.
        if (a == b || (pass > 0 && std::max(content_of(a).merged_in, content_of(b).merged_in) < pass - 1)) continue;
        if (!try_merge(a, b)) continue;
        content_of(a).merged_in = static_cast<std::int8_t>(pass);
        is_changed = true;
      }
    });
    return is_changed;
  }

  bool try_merge(std::uint32_t a, std::uint32_t b) {
    const bool is_first_larger = content_of(a).faces.size() >= content_of(b).faces.size();
    Content& large = content_of(is_first_larger ? a : b);
    Content& small = content_of(is_first_larger ? b : a);
    const Plane& old = plane_of(is_first_larger ? a : b);
    const double half_slab = kHalfSlab * pieces_[a].tolerance;
    PointMoments moments = large.moments;
    moments.merge(small.moments);
    Plane plane = old;
    Lie lie;
    if (!do_fit(large, small, old, plane, half_slab, lie)) {
      const PlaneFit fit = fit_plane(moments);
      if (fit.rms > half_slab + kFitRounding) return false;
      plane = {moments.mean(), dot(fit.normal, old.normal) < 0 ? -fit.normal : fit.normal};
      if (!do_fit(large, small, old, plane, half_slab, lie)) return false;
    }
    const double middle = (lie.low + lie.high) / 2;
    plane.origin += middle * plane.normal;
    large.lie = {lie.low - middle, lie.high - middle, lie.normal_to_spare};
    large.faces.insert(large.faces.end(), small.faces.begin(), small.faces.end());
    large.moments = moments;
    large.box.add(small.box);
    if (large.faces.size() >= 2 * large.counted_from) {
      large.counted_from = large.faces.size();
      large.walks = 0;
    }
    small = {};
    plane_of(a) = plane;
    pieces_[a].height = std::max(pieces_[a].height, pieces_[b].height);
    if (!is_first_larger) std::swap(pieces_[a].content, pieces_[b].content);
    joined_.join(a, b);
    return true;
  }

  /// Returns whether two regions fit a plane that may be shifted along its normal, and their position relative to it.
  /// Input:  `old` is the larger region's plane so far.
  bool do_fit(Content& large, const Content& small, const Plane& old, const Plane& plane, double half_slab,
              Lie& lie) const {
    lie = {};
    if (!add_all(large.witnesses, plane, half_slab, lie) || !add_all(small.faces, plane, half_slab, lie)) return false;
    Lie most = lie_after_turn(large, old, plane);
    most = {std::min(most.low, lie.low), std::max(most.high, lie.high),
            std::min(most.normal_to_spare, lie.normal_to_spare)};
    if (most.high - most.low <= 2 * half_slab && most.normal_to_spare >= 0) {
      lie = most;
      return true;
    }
    if (large.faces.size() <= kMuchLargerRegion * small.faces.size())
      return add_all(large.faces, plane, half_slab, lie);
    if (large.walks == kMaxWalks) return false;
    ++large.walks;
    if (add_all(large.faces, plane, half_slab, lie)) return true;
    remember_farthest(large, plane, half_slab);
    return false;
  }

  /// Adds the position of a face relative to a plane. Output: whether the face's normal agrees with the plane's, and
  /// all faces so far can be within one slab.
  bool add(FaceId f, const Plane& plane, double half_slab, Lie& lie) const {
    if (!rule_.has_normal(f, plane.normal, half_slab)) return false;
    lie.normal_to_spare = std::min(lie.normal_to_spare, rule_.normal_to_spare(f, plane.normal, half_slab));
    for (const VertexId v : surface_.face(f)) {
      const double distance = plane.distance(surface_.local[v]);
      lie.low = std::min(lie.low, distance);
      lie.high = std::max(lie.high, distance);
    }
    return lie.high - lie.low <= 2 * half_slab;
  }

  bool add_all(const std::vector<FaceId>& faces, const Plane& plane, double half_slab, Lie& lie) const {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (i % kMergeBlock == kMergeBlock - 1) control_.check_and_move();
      if (!add(faces[i], plane, half_slab, lie)) return false;
    }
    return true;
  }

  /// Remembers, as witnesses, the faces that are farthest below and above the plane and the one that turns most. Among
  /// equals, the face at the smallest place counts.
  void remember_farthest(Content& content, const Plane& plane, double half_slab) const {
    std::array<std::pair<double, FaceId>, 3> farthest;
    farthest.fill({-HUGE_VAL, FaceId()});
    for (std::size_t i = 0; i < content.faces.size(); ++i) {
      if (i % kMergeBlock == kMergeBlock - 1) control_.check_and_move();
      const FaceId f = content.faces[i];
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const VertexId v : surface_.face(f)) {
        low = std::min(low, plane.distance(surface_.local[v]));
        high = std::max(high, plane.distance(surface_.local[v]));
      }
      const std::array<double, 3> out{-low, high, -rule_.normal_to_spare(f, plane.normal, half_slab)};
      for (std::size_t k = 0; k < out.size(); ++k) {
        auto& [most, witness] = farthest[k];
        if (out[k] > most ||
            (out[k] == most && witness.is_valid() && face_centre(surface_, f) < face_centre(surface_, witness)))
          farthest[k] = {out[k], f};
      }
    }
    std::vector<FaceId>& witnesses = content.witnesses;
    for (const auto& [most, f] : farthest) {
      if (!f.is_valid() || std::find(witnesses.begin(), witnesses.end(), f) != witnesses.end()) continue;
      if (witnesses.size() == kMaxWitnesses) witnesses.erase(witnesses.begin());
      witnesses.push_back(f);
    }
  }

  /// A bound on the position of a region relative to a new plane. It is computed from the region's box and its position
  /// relative to the old plane.
  static Lie lie_after_turn(const Content& content, const Plane& old, const Plane& plane) {
    constexpr double kRounding = 1e-15;  // error of distances, in local units
    const Vec3 turn = plane.normal - old.normal;
    const Vec3 centre = 0.5 * (content.box.min + content.box.max), half = 0.5 * (content.box.max - content.box.min);
    const double shift = plane.distance(centre) - old.distance(centre);
    const double more =
        std::fabs(turn.x) * half.x + std::fabs(turn.y) * half.y + std::fabs(turn.z) * half.z + kRounding;
    return {content.lie.low + shift - more, content.lie.high + shift + more, content.lie.normal_to_spare - norm(turn)};
  }

  /// Completes a merged region: gives it the plane through all its corners if its faces fit it, and sets its faces and
  /// its deviation.
  void finish(std::uint32_t r) {
    const Content& content = content_of(r);
    const double half_slab = kHalfSlab * pieces_[r].tolerance;
    Plane plane{content.moments.mean(), fit_plane(content.moments).normal};
    if (dot(plane.normal, plane_of(r).normal) < 0) plane.normal = -plane.normal;
    Lie lie;
    if (add_all(content.faces, plane, half_slab, lie)) {
      plane.origin += (lie.low + lie.high) / 2 * plane.normal;
      plane_of(r) = plane;
    }
    double deviation = 0;
    for (std::size_t i = 0; i < content.faces.size(); ++i) {
      if (i % kMergeBlock == kMergeBlock - 1) control_.check_and_move();
      regions_.of_face[content.faces[i]] = RegionId(first_region_ + r);
      deviation = std::max(deviation, rule_.distance(content.faces[i], plane_of(r)));
    }
    regions_.deviation[RegionId(first_region_ + r)] = deviation;
  }

  Plane& plane_of(std::uint32_t r) { return regions_.planes[RegionId(first_region_ + r)]; }
  const Plane& plane_of(std::uint32_t r) const { return regions_.planes[RegionId(first_region_ + r)]; }
  Content& content_of(std::uint32_t r) { return contents_[pieces_[r].content]; }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const Coplanarity& rule_;
  const std::uint32_t first_region_;
  const std::span<const FaceId> seeds_;
  const std::span<const double> heights_;
  Regions& regions_;
  RunControl& control_;
  std::vector<Piece, DefaultInit<Piece>> pieces_;
  std::vector<Content> contents_;
  UnionFind joined_;
};

}  // namespace

void merge_regions(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule,
                   std::uint32_t first_region, std::span<const FaceId> seeds, std::span<const double> heights,
                   Regions& regions, RunControl& control) {
  Merging(surface, adjacency, rule, first_region, seeds, heights, regions, control).run();
}

}  // namespace remesh
