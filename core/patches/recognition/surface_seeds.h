/// First guesses of surfaces from two facets that meet in an edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"

namespace remesh {

/// A set of kinds of surfaces.
class SurfaceKinds {
 public:
  static constexpr SurfaceKinds all() { return SurfaceKinds(0xff); }
  static constexpr SurfaceKinds none() { return SurfaceKinds(0); }
  bool has(SurfaceKind kind) const { return (bits_ >> static_cast<int>(kind) & 1) != 0; }
  bool is_empty() const { return bits_ == 0; }
  void add(SurfaceKind kind) { bits_ = static_cast<std::uint8_t>(bits_ | 1 << static_cast<int>(kind)); }

 private:
  explicit constexpr SurfaceKinds(std::uint8_t bits) : bits_(bits) {}

  std::uint8_t bits_;
};

/// A smooth edge between two facets, from which surfaces may grow.
struct SurfaceSeed {
  double length_squared;
  double tie;              ///< breaks ties between equally long edges: their middle's place along a fixed direction
  std::uint32_t side;      ///< the first side of the edge, see FacetGraph
  std::uint32_t end_side;  ///< the side that begins where the edge ends
  PatchId facet;
  SurfaceKinds kinds = SurfaceKinds::all();  ///< of the surfaces that may grow from the edge, as far as that is known
};

/// Makes the seed of an edge.
/// Input: a facet, its first side on the edge, and its first side behind the edge.
SurfaceSeed make_seed(const FacetGraph& graph, PatchId facet, std::uint32_t side, std::uint32_t end_side);

/// Returns whether a seed belongs to a sample that has about this part of all seeds, of all lengths and places. Whether
/// it does depends on the place of its edge alone.
bool is_in_sample(const SurfaceSeed& seed, double part);

/// Calls take(seed) for each smooth edge between a facet and a later one, if both may be curved.
template <class Take>
void for_each_seed(const FacetGraph& graph, PatchId p, const Take& take) {
  if (!graph.may_be_seed(p)) return;
  // The sides that a facet shares with one neighbour are one edge. Their numbers may wrap around at the end of the
  // loop.
  const std::uint32_t begin_side = graph.sides_begin(p), count = graph.sides_end(p) - begin_side;
  const auto side_at = [&](std::uint32_t k) { return begin_side + k % count; };
  std::uint32_t first = 0;
  while (first < count && graph.beyond(side_at(first)) == graph.beyond(side_at(first + count - 1))) ++first;
  for (std::uint32_t k = first; k < first + count;) {
    const PatchId q = graph.beyond(side_at(k));
    std::uint32_t next = k + 1;
    while (next < first + count && graph.beyond(side_at(next)) == q) ++next;
    if (q.is_valid() && p < q && graph.may_be_seed(q)) take(make_seed(graph, p, side_at(k), side_at(next)));
    k = next;
  }
}

/// Finds the smooth edges between facets that may be curved and are wanted, each once and in no particular order.
/// Input:  is_wanted(seed) may change the kinds of the seed.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
template <class IsWanted>
std::vector<SurfaceSeed> find_seeds(const FacetGraph& graph, RunControl& control, const IsWanted& is_wanted) {
  constexpr std::size_t kBlock = kItemsPerBlock / 8;
  const auto blocks =
      map_blocks<std::vector<SurfaceSeed>>(graph.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<SurfaceSeed> wanted;
        for (std::size_t i = begin; i < end; ++i)
          for_each_seed(graph, PatchId(i), [&](SurfaceSeed seed) {
            if (is_wanted(seed)) wanted.push_back(seed);
          });
        return wanted;
      });
  std::vector<SurfaceSeed> seeds;
  for (const std::vector<SurfaceSeed>& of_block : blocks) seeds.insert(seeds.end(), of_block.begin(), of_block.end());
  return seeds;
}

/// Gives seeds in order, the longest edge first, because the rounding of its ends matters less for a long edge. Seeds
/// are sorted only as far as they are asked for.
/// Holds: the order depends on geometry alone. The graph and the control outlive the queue.
class SeedQueue {
 public:
  SeedQueue(std::vector<SurfaceSeed> seeds, const FacetGraph& graph, const RunControl& control)
      : seeds_(std::move(seeds)), graph_(graph), control_(control) {}

  /// Returns the next seed, or null after the last one.
  /// Errors: kCancelled, kTimeout - asked to stop through the control.
  /// Cost:   O(n log n) for all of n seeds, O(n) for the first few.
  const SurfaceSeed* next() {
    if (next_ == sorted_ && sorted_ < seeds_.size()) sort_to(std::max(kFirst, kStep * sorted_));
    return next_ < sorted_ ? &seeds_[next_++] : nullptr;
  }
  /// Sorts all seeds and returns them.
  std::vector<SurfaceSeed> take_all() && {
    sort_to(seeds_.size());
    return std::move(seeds_);
  }

 private:
  /// The number of seeds that are sorted at first, and by how much that number grows.
  static constexpr std::size_t kFirst = 4096, kStep = 4;

  bool is_before(const SurfaceSeed& s, const SurfaceSeed& t) const;
  void sort_to(std::size_t end);

  std::vector<SurfaceSeed> seeds_;
  const FacetGraph& graph_;
  const RunControl& control_;
  std::size_t sorted_ = 0, next_ = 0;
};

/// Where the apexes of cones may be for which an edge is a ruling, as multiples of the way from its start to its end.
struct ConeApexes {
  std::array<double, 2> at{};
  std::size_t count = 0;
};

/// Guesses apexes of cones on two facets with a common edge from a to b: where the edge meets the next ruling of a
/// facet with four corners. Between two triangles, either end of the edge may be the apex.
/// Input: the corners of the two facets.
ConeApexes guess_apexes(std::span<const Vec3> first, std::span<const Vec3> second, const Vec3& a, const Vec3& b);

/// Guesses the surfaces of two facets.
class SeedGuesses {
 public:
  explicit SeedGuesses(const FacetGraph& graph) : graph_(graph) {}

  /// Returns the guesses of the seed's kinds, with fewer parameters first: spheres, cylinders and cones for which the
  /// edge is a ruling.
  const std::vector<AnalyticSurface>& of(const SurfaceSeed& seed);

 private:
  void guess_cylinder_along(const Vec3& a, const Vec3& b);
  void guess_cones(const Vec3& a, const Vec3& b);

  const FacetGraph& graph_;
  std::vector<Vec3> first_, second_, points_;  ///< the corners of the two facets, and all of them
  std::vector<AnalyticSurface> guesses_;
};

}  // namespace remesh
