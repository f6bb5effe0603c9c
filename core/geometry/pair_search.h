/// Finds pairs of faces that meet, by their boxes, in parallel and in bounded memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/geometry/oriented_boxes.h"
#include "core/geometry/self_intersections.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {

using FacePairs = std::vector<std::pair<FaceId, FaceId>>;

/// Appends to `result` what body(begin, end, room) returns for blocks of 0 .. n-1, block after block, until there are
/// more than `max_pairs`. A body may stop as soon as it has more than `room` pairs.
/// Holds:   the result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
template <class Body>
void gather_pairs(std::size_t n, std::size_t block, std::size_t max_pairs, SelfIntersections& result,
                  RunControl& control, const Body& body) {
  // The number of blocks between two checks of the number of pairs. It is small, so that a surface that lies on itself
  // many times does not take quadratic time until it is noticed.
  constexpr std::size_t kBlocksInRound = 64;
  for (std::size_t begin = 0; begin < n && result.is_complete; begin += block * kBlocksInRound) {
    const std::size_t room = max_pairs - result.pairs.size();
    const auto found = map_blocks<FacePairs>(
        std::min(n - begin, block * kBlocksInRound), block, control,
        [&](std::size_t first, std::size_t last) { return body(begin + first, begin + last, room); });
    for (const FacePairs& pairs : found) result.pairs.insert(result.pairs.end(), pairs.begin(), pairs.end());
    result.is_complete = result.pairs.size() <= max_pairs;
  }
}

/// The triangles of a tree, and how to search them.
struct SearchedTriangles {
  const TriangleTree& tree;
  std::span<const Vec3> positions;
  std::span<const Triangle> faces;
  double margin = 0;  ///< the search widens boxes by this
  /// kByBoxes: some triangles only stand for their boxes. The faces that they represent may be anywhere in the box.
  enum { kByTriangles, kByBoxes } by = kByTriangles;
  /// Called with the slots whose boxes meet too many others. If it returns true, fewer nodes are of interest to some of
  /// these slots from then on.
  std::function<bool(std::span<const std::uint32_t> slots)> lose_interest = {};
};

/// Appends to `result` the pairs of a tree's slots whose triangles meet, within the margin, and for which is_pair(slot,
/// other) holds, until there are more than `max_pairs`. Of the pairs that are further apart, is_pair is called for
/// some.
/// Input:   face_of(slot) is the face that is reported for a slot. is_of_no_interest(slot, node) says that no slot of
///          the node makes a pair with this one.
/// Holds:   the earlier one of two slots finds the pair. The result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    for each slot, O(log n) and the number of slots whose boxes meet its own. If these are many more than the
///          pairs, as among needles askew to the axes, the number of slots whose OrientedBoxes meet its own.
template <class FaceOf, class IsOfNoInterest, class IsPair>
void find_pairs(const SearchedTriangles& triangles, const FaceOf& face_of, const IsOfNoInterest& is_of_no_interest,
                const IsPair& is_pair, std::size_t max_pairs, SelfIntersections& result, RunControl& control) {
  const TriangleTree& tree = triangles.tree;
  constexpr std::size_t kBlock = 256;
  constexpr std::uint32_t kTestsBetweenChecks = 4096;
  // If a slot needs more tests without success than `most_in_vain`, its pairs are dropped and it is searched again
  // later.
  std::vector<std::uint32_t> slots;
  std::vector<std::uint8_t> is_for_later(tree.size(), 0);
  std::optional<OrientedBoxes> oriented;
  std::size_t most_in_vain = 0;
  const auto search = [&](std::size_t slot, std::size_t room, std::uint32_t& tests, FacePairs& pairs) {
    control.check();  // a search of many nodes may find nothing, and would not check otherwise
    Box3 box = tree.box(slot);
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] -= triangles.margin;
      box.max[axis] += triangles.margin;
    }
    std::optional<OrientedBoxes::Query> query;
    if (oriented) query = oriented->query(triangles.faces[tree.face(slot).value]);
    const std::size_t before = pairs.size();
    std::size_t in_vain = 0;
    tree.visit_meeting(
        box, slot + 1,
        [&](std::size_t node) { return is_of_no_interest(slot, node) || (query && oriented->are_apart(*query, node)); },
        [&](std::size_t other) {
          if (++tests % kTestsBetweenChecks == 0) control.check();
          if (!is_pair(slot, other)) return ++in_vain <= most_in_vain;
          pairs.push_back(std::minmax(face_of(slot), face_of(other)));
          return pairs.size() <= room;
        });
    if (in_vain <= most_in_vain) return;
    pairs.resize(before);
    is_for_later[slot] = 1;
  };
  const auto search_all = [&](std::size_t n, std::size_t most, const auto& slot_at) {
    most_in_vain = most;
    gather_pairs(n, kBlock, max_pairs, result, control, [&](std::size_t begin, std::size_t end, std::size_t room) {
      FacePairs pairs;
      std::uint32_t tests = 0;
      for (std::size_t i = begin; i < end && pairs.size() <= room; ++i) search(slot_at(i), room, tests, pairs);
      return pairs;
    });
    slots = select_ids<std::uint32_t>(tree.size(), kItemsPerBlock, control,
                                      [&](std::size_t slot) { return is_for_later[slot] != 0; });
    std::fill(is_for_later.begin(), is_for_later.end(), std::uint8_t{0});
  };
  // Well-shaped faces have some twenty neighbours. A few slots may have more, as long as all of them together make only
  // a few times n tests.
  constexpr std::size_t kFewInVain = 64, kInVainPerSlot = 4;
  search_all(tree.size(), kFewInVain, [](std::size_t i) { return i; });
  const auto search_later = [&](std::size_t most) {
    const std::vector<std::uint32_t> later = std::move(slots);
    search_all(later.size(), most, [&](std::size_t i) { return later[i]; });
  };
  if (slots.empty() || !result.is_complete) return;
  const std::size_t share = kInVainPerSlot * tree.size() / slots.size();
  if (share > 4 * kFewInVain) search_later(share);
  if (slots.empty() || !result.is_complete) return;
  if (triangles.lose_interest && triangles.lose_interest(slots)) search_later(kFewInVain);
  if (slots.empty() || !result.is_complete) return;
  if (triangles.by == SearchedTriangles::kByTriangles)
    oriented.emplace(tree, triangles.positions, triangles.faces, triangles.margin, control);
  search_later(tree.size());
}

}  // namespace remesh
