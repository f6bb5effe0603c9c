#include "core/stages/region_merging.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/geometry/plane_fit.h"

namespace remesh {
namespace {

/// A region is tried with at most so many others that it does not fit.
constexpr std::uint8_t kMostFailures = 8;

constexpr std::size_t kBlock = 4096;

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
    // All faces of a region are on one step of the ladder.
    for_blocks(pieces_.size(), kBlock, control_, [&](std::size_t r, std::size_t end) {
      for (; r < end; ++r) pieces_[r] = {rule_.tolerance(seeds_[r]), heights_[r], 0, !rule_.is_single(seeds_[r])};
    });
    auto pairs = bordering_pieces();
    if (pairs.empty()) return;  // as on most surfaces
    contents_.resize(pieces_.size());
    for (FaceId f(0); f.value < surface_.face_count(); ++f.value) {
      if (f.value % kBlock == 0) control_.check();
      const RegionId r = regions_.of_face[f];
      if (r.value < first_region_ || rule_.is_single(f)) continue;
      Content& content = contents_[r.value - first_region_];
      content.faces.push_back(f);
      for (const VertexId v : surface_.face(f)) content.moments.add(surface_.local[v]);
    }
    // Each pass may make neighbours of regions that were not; few are needed.
    constexpr int kMostPasses = 8;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      bool is_changed = false;
      for (const auto& [a, b] : pairs) is_changed = try_merge(a, b) || is_changed;
      if (!is_changed || pass + 1 == kMostPasses) return;
      pairs = bordering_pieces();
    }
  }

 private:
  /// What is known of a region while regions are merged.
  struct Piece {
    double tolerance = 0;
    double height = 0;  ///< of its highest face: what its normal is worth
    std::uint8_t failures = 0;
    bool may_merge = false;
  };
  /// What a region consists of; one that has been taken in by another one is empty.
  struct Content {
    std::vector<FaceId> faces;
    PointMoments moments;
  };

  /// Pairs of new regions with an edge between them whose planes might be one, ascending: in the order of their seeds.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> bordering_pieces() {
    using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    const auto find = [&](std::size_t begin, std::size_t end) {
      Pairs found;
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency_.twin(h);
        if (twin == Adjacency::kNone || twin < h) continue;
        const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(twin);
        const RegionId r = regions_.of_face[f], q = regions_.of_face[g];
        if (r == q || std::min(r, q).value < first_region_ || !rule_.are_in_one_zone(f, g) || rule_.is_bend(h))
          continue;
        const std::uint32_t a = std::min(r, q).value - first_region_, b = std::max(r, q).value - first_region_;
        if (is_alike(a, b)) found.push_back({a, b});
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
  bool is_alike(std::uint32_t a, std::uint32_t b) const {
    if (!pieces_[a].may_merge || !pieces_[b].may_merge) return false;
    const double cosine =
        dot(regions_.planes[RegionId(first_region_ + a)].normal, regions_.planes[RegionId(first_region_ + b)].normal);
    const double height = std::min(pieces_[a].height, pieces_[b].height);
    const double sine = 2 * kThinFace * pieces_[a].tolerance / std::max(height, 1e-300);
    return cosine > 0 && 1 - cosine * cosine <= sine * sine;
  }

  bool try_merge(std::uint32_t a, std::uint32_t b) {
    if (!pieces_[a].may_merge || !pieces_[b].may_merge) return false;
    if (pieces_[a].failures >= kMostFailures || pieces_[b].failures >= kMostFailures) return false;
    PointMoments moments = contents_[a].moments;
    moments.merge(contents_[b].moments);
    const PlaneFit fit = fit_plane(moments);
    const double band = kBand * pieces_[a].tolerance;
    constexpr double kRounding = 1e-7;  // of moments, in local units
    if (fit.rms > band + kRounding) return false;
    Plane plane{moments.mean(), fit.normal};
    if (dot(plane.normal, regions_.planes[RegionId(first_region_ + a)].normal) < 0) plane.normal = -plane.normal;
    centre(plane, {&contents_[a].faces, &contents_[b].faces});
    double deviation = 0;
    for (const auto* faces : {&contents_[a].faces, &contents_[b].faces})
      for (const FaceId f : *faces)
        if (!rule_.fits(f, plane, band, deviation)) {
          ++pieces_[a].failures;
          ++pieces_[b].failures;
          return false;
        }
    regions_.planes[RegionId(first_region_ + a)] = plane;
    regions_.deviation[RegionId(first_region_ + a)] = deviation;
    for (const FaceId f : contents_[b].faces) regions_.of_face[f] = RegionId(first_region_ + a);
    // The smaller list is moved to the larger one.
    if (contents_[a].faces.size() < contents_[b].faces.size()) std::swap(contents_[a].faces, contents_[b].faces);
    contents_[a].faces.insert(contents_[a].faces.end(), contents_[b].faces.begin(), contents_[b].faces.end());
    contents_[a].moments = moments;
    pieces_[a].height = std::max(pieces_[a].height, pieces_[b].height);
    pieces_[b] = {};
    contents_[b] = {};
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

  const Surface& surface_;
  const Adjacency& adjacency_;
  const Coplanarity& rule_;
  const std::uint32_t first_region_;
  const std::span<const FaceId> seeds_;
  const std::span<const double> heights_;
  Regions& regions_;
  RunControl& control_;
  std::vector<Piece, LeftUnset<Piece>> pieces_;
  std::vector<Content> contents_;  ///< if any regions might be merged
};

}  // namespace

void merge_regions(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule,
                   std::uint32_t first_region, std::span<const FaceId> seeds, std::span<const double> heights,
                   Regions& regions, RunControl& control) {
  Merging(surface, adjacency, rule, first_region, seeds, heights, regions, control).run();
}

}  // namespace remesh
