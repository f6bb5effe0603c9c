/// Pairs of faces whose boxes meet, in parallel and in bounded memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/geometry/self_intersections.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {

using FacePairs = std::vector<std::pair<FaceId, FaceId>>;

/// Adds to `result` what body(begin, end, room) gives for blocks of 0 .. n-1, block after block, until there are more
/// than `max_pairs`. A body may stop as soon as it has more than `room`.
/// Holds:   the same result for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
template <class Body>
void gather_pairs(std::size_t n, std::size_t block, std::size_t max_pairs, SelfIntersections& result,
                  RunControl& control, const Body& body) {
  // Tasks between two looks at how many pairs there are: few enough that a surface lying on itself many times does not
  // take quadratic time to say so.
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

/// Adds to `result` the pairs of a tree's slots whose boxes, made wider by `margin`, meet and for which
/// is_pair(slot, other) holds, until there are more than `max_pairs`.
/// Input:   face_of(slot): what is written down; is_of_no_interest(slot, node): no slot of the node makes a pair.
/// Holds:   of two slots the earlier one finds the pair; the same result for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
template <class FaceOf, class IsOfNoInterest, class IsPair>
void find_pairs(const TriangleTree& tree, double margin, const FaceOf& face_of, const IsOfNoInterest& is_of_no_interest,
                const IsPair& is_pair, std::size_t max_pairs, SelfIntersections& result, RunControl& control) {
  using Pairs = std::vector<std::pair<FaceId, FaceId>>;
  // Slots in a task, and tasks between two looks at how many pairs there are: few enough that a surface lying on itself
  // many times does not take quadratic time to say so.
  constexpr std::size_t kBlock = 256;
  constexpr std::size_t kBlocksInRound = 64;
  constexpr std::uint32_t kTestsBetweenChecks = 4096;
  for (std::size_t begin = 0; begin < tree.size() && result.is_complete; begin += kBlock * kBlocksInRound) {
    const std::size_t n = std::min(tree.size() - begin, kBlock * kBlocksInRound);
    const std::size_t room = max_pairs - result.pairs.size();
    const auto found = map_blocks<Pairs>(n, kBlock, control, [&](std::size_t first, std::size_t last) {
      Pairs pairs;
      std::uint32_t tests = 0;
      for (std::size_t slot = begin + first; slot < begin + last && pairs.size() <= room; ++slot) {
        Box3 box = tree.box(slot);
        for (int axis = 0; axis < 3; ++axis) {
          box.min[axis] -= margin;
          box.max[axis] += margin;
        }
        tree.visit_meeting(
            box, slot + 1, [&](std::size_t node) { return is_of_no_interest(slot, node); },
            [&](std::size_t other) {
              if (++tests % kTestsBetweenChecks == 0) control.check();
              if (is_pair(slot, other)) pairs.push_back(std::minmax(face_of(slot), face_of(other)));
              return pairs.size() <= room;
            });
      }
      return pairs;
    });
    for (const Pairs& pairs : found) result.pairs.insert(result.pairs.end(), pairs.begin(), pairs.end());
    result.is_complete = result.pairs.size() <= max_pairs;
  }
}

}  // namespace remesh
