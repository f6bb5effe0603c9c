/// Finds pairs of faces that meet, by their boxes, in parallel and in bounded memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/search_limits.h"
#include "core/geometry/trees/oriented_boxes.h"
#include "core/geometry/trees/triangle_tree.h"

namespace remesh {

using FacePairs = std::vector<std::pair<FaceId, FaceId>>;

/// The time of one test of two faces, in visits of a node of a tree.
inline constexpr std::uint64_t kStepsPerTest = 8;
/// The time of one test of a box along the triangles of a node, in visits of a node.
inline constexpr std::uint64_t kStepsPerOrientedBox = 4;

/// The pairs that a search has found so far, and its limits.
class PairSearch {
 public:
  PairSearch(const SearchLimits& limits, RunControl& control, SelfIntersections found = {})
      : limits_(limits), control_(control), result_(std::move(found)), progress_before_(control.told_fraction()) {
    limits_.max_unexpected = std::min(limits_.max_unexpected, limits_.max_pairs);
    if (!limits_.is_expected || !result_.is_complete) return;
    unexpected_ =
        static_cast<std::size_t>(std::count_if(result_.pairs.begin(), result_.pairs.end(), [&](const auto& pair) {
          return !limits_.is_expected(pair.first, pair.second);
        }));
    if (!result_.are_all_listed) move_expected_to_end();
  }

  const SearchLimits& limits() const { return limits_; }
  RunControl& control() const { return control_; }
  SelfIntersections& result() { return result_; }
  bool goes_on() const { return result_.is_complete; }

  /// Returns how many more pairs may be found.
  std::size_t room() const {
    return result_.are_all_listed ? limits_.max_pairs - result_.pairs.size() : limits_.max_unexpected - unexpected_;
  }
  /// Returns whether a pair is neither listed nor tested. This changes only between rounds.
  bool is_passed_over(FaceId f, FaceId g) const {
    return !result_.are_all_listed && limits_.is_expected && limits_.is_expected(f, g);
  }

  /// Appends the result of one part of the search.
  void add(const FacePairs& pairs, std::uint64_t steps) {
    result_.steps += steps;
    for (const auto& pair : pairs) {
      const bool is_expected = limits_.is_expected && limits_.is_expected(pair.first, pair.second);
      if (is_expected && !result_.are_all_listed) continue;
      result_.pairs.push_back(pair);
      if (limits_.is_expected && !is_expected) ++unexpected_;
      if (result_.are_all_listed && result_.pairs.size() > limits_.max_pairs) end_list();
      if (unexpected_ > limits_.max_unexpected) result_.are_all_listed = result_.is_complete = false;
      if (!result_.is_complete) return;
    }
  }
  /// Adds steps to the progress within the stage. The number of steps is unknown, so progress takes ever smaller steps
  /// towards 1, but never stops. Several threads may call this at once.
  void report_progress(std::uint64_t steps) {
    constexpr double kHalfTheWay = 1 << 26;
    const std::lock_guard lock(told_mutex_);
    // A loop between two searches, such as one that builds a tree, has set the progress. The search continues from
    // there.
    if (const double now = control_.told_fraction(); now > told_fraction_) {
      progress_before_ = now;
      told_ = 0;
    }
    told_ += static_cast<double>(steps);
    control_.progress(progress_before_ + (1 - progress_before_) * told_ / (told_ + kHalfTheWay));
    told_fraction_ = control_.told_fraction();
  }
  /// Ends the search if it has taken more steps than it may.
  void end_if_long() {
    const std::uint64_t max =
        unexpected_ == 0 ? limits_.max_steps : std::min(limits_.max_steps, limits_.max_steps_with_unexpected);
    if (result_.steps > max) result_.are_all_listed = result_.is_complete = false;
  }

 private:
  /// From now on, lists only pairs that are not expected.
  void end_list() {
    result_.are_all_listed = false;
    if (!limits_.is_expected) {
      result_.is_complete = false;
      return;
    }
    move_expected_to_end();
    result_.pairs.resize(std::max(limits_.max_pairs, unexpected_));
  }
  void move_expected_to_end() {
    std::stable_partition(result_.pairs.begin(), result_.pairs.end(),
                          [&](const auto& pair) { return !limits_.is_expected(pair.first, pair.second); });
  }

  SearchLimits limits_;
  RunControl& control_;
  SelfIntersections result_;
  std::mutex told_mutex_;
  double progress_before_;
  double told_ = 0;             ///< the steps that progress has counted since `progress_before_`
  double told_fraction_ = -1;   ///< the progress that was told last
  std::size_t unexpected_ = 0;  ///< the number of unexpected pairs; 0 without `is_expected`
};

/// The pairs of some items that were treated one after the other.
struct FoundInTurn {
  FacePairs pairs;
  std::uint64_t steps = 0;
  std::size_t next = 0;  ///< the first item that was not treated
};

/// Calls item(i, found) for i from 0 to n - 1, which adds to found.pairs and found.steps, and appends the pairs to the
/// result. An item may stop as soon as there are more than `room` pairs, which is the third argument.
/// Output:  the number of items that were treated. It is less than n if the search was cut short, because there are
///          more than max_pairs or because it took more than max_steps.
/// Holds:   the result is the same for any number of threads. To this end, work is done in rounds, and limits are
///          checked between rounds. In a round, a block of items has a bounded turn. The rest of the block comes first
///          in the next round.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
template <class Item>
std::size_t gather_pairs(std::size_t n, std::size_t block, PairSearch& search, const Item& item) {
  // The largest number of blocks in a round. It is small, so that a surface that lies on itself many times does not
  // take quadratic time until it is noticed. For the same reason the first rounds have fewer blocks.
  constexpr std::size_t kMaxBlocks = 64;
  // The steps after which a block waits for its next turn. A round takes less than a second.
  constexpr std::uint64_t kStepsInTurn = 1 << 19, kStepsBetweenTold = 1 << 15;
  struct Range {
    std::size_t begin, end;
  };
  std::vector<Range> left, round;
  std::size_t begin = 0, done = 0;
  for (std::size_t blocks = 1; search.goes_on(); blocks = std::min(2 * blocks, kMaxBlocks)) {
    round = std::move(left);
    left.clear();
    for (; round.size() < blocks && begin < n; begin = round.back().end)
      round.push_back({begin, std::min(n, begin + block)});
    if (round.empty()) break;
    const std::size_t room = search.room();
    const auto found = map_blocks<FoundInTurn>(round.size(), 1, search.control(), [&](std::size_t r, std::size_t) {
      FoundInTurn in_turn;
      std::uint64_t told = 0;
      for (std::size_t i = round[r].begin; i < round[r].end && in_turn.steps <= kStepsInTurn; in_turn.next = ++i) {
        in_turn.next = i;
        item(i, in_turn, room);
        if (in_turn.steps >= told + kStepsBetweenTold) {
          search.report_progress(in_turn.steps - told);
          told = in_turn.steps;
        }
        if (in_turn.pairs.size() > room) return in_turn;  // not all pairs of the item were found
      }
      return in_turn;
    });
    for (std::size_t r = 0; r < round.size() && search.goes_on(); ++r) {
      const FoundInTurn& in_turn = found[r];
      search.add(in_turn.pairs, in_turn.steps);
      done += in_turn.next - round[r].begin;
      if (in_turn.next < round[r].end) left.push_back({in_turn.next, round[r].end});
    }
    if (!left.empty() || begin < n) search.end_if_long();
  }
  return done;
}

/// The triangles of a search, and how to search them.
struct SearchedTriangles {
  std::span<const Vec3> positions;
  std::span<const Triangle> faces;
  std::span<const std::uint32_t> groups = {};  ///< as for a TriangleTree
  double margin = 0;                           ///< the search widens boxes by this
  /// kByBoxes: some triangles only stand for their boxes. The faces that they represent may be anywhere in the box.
  enum { kByTriangles, kByBoxes } by = kByTriangles;
};

/// Knows which pairs of slots were found by an earlier search that used another tree.
class EarlierSearch {
 public:
  /// Input:   is_left(slot) says whether a slot of the earlier tree is searched again. For all other slots, the earlier
  ///          search has found the pairs with the slots that come after them in its tree.
  template <class IsLeft>
  EarlierSearch(const TriangleTree& earlier, const TriangleTree& tree, const IsLeft& is_left, RunControl& control)
      : slot_before_(tree.size()), is_left_(tree.size()) {
    StopCheck check(control);
    std::vector<std::uint32_t> slot_of_face(tree.size());
    for (std::uint32_t slot = 0; slot < tree.size(); ++slot) {
      check();
      slot_of_face[earlier.face(slot).value] = slot;
    }
    for (std::uint32_t slot = 0; slot < tree.size(); ++slot) {
      check();
      slot_before_[slot] = slot_of_face[tree.face(slot).value];
      is_left_[slot] = is_left(slot_before_[slot]) ? 1 : 0;
    }
    last_finished_ =
        tree.joined<std::uint32_t>([&](std::size_t slot) { return is_left_[slot] != 0 ? 0u : slot_before_[slot]; },
                                   [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); }, control);
  }

  bool is_left(std::size_t slot) const { return is_left_[slot] != 0; }
  /// Returns whether a slot that is searched again has to look for pairs with another slot.
  bool is_new(std::size_t slot, std::size_t other) const {
    return is_left(other) ? slot < other : slot_before_[slot] < slot_before_[other];
  }
  /// If this is true, is_new is false for all slots of a node that ends at `end`.
  bool is_none_new(std::size_t slot, std::size_t node, std::size_t end) const {
    return end <= slot + 1 && last_finished_[node] <= slot_before_[slot];
  }

 private:
  std::vector<std::uint32_t> slot_before_;    ///< by slot: that of the same face in the earlier tree
  std::vector<std::uint8_t> is_left_;         ///< by slot: whether it is searched again
  std::vector<std::uint32_t> last_finished_;  ///< by node: the last earlier slot that is not searched again, or 0
};

/// Returns the groups without those that have only a few faces, as for a TriangleTree. A node of a large group makes no
/// pair with the faces of that group. A few needles in a group make a node that meets many others.
/// Input:   groups are numbered from 0.
inline std::vector<std::uint32_t> large_groups(std::span<const std::uint32_t> groups, RunControl& control) {
  constexpr std::uint32_t kFewFaces = 64;
  std::vector<std::uint32_t> counts, large(groups.begin(), groups.end());
  StopCheck check(control);
  for (const std::uint32_t group : groups) {
    check();
    if (group == TriangleTree::kNoGroup) continue;
    if (group >= counts.size()) counts.resize(std::max<std::size_t>(std::size_t{group} + 1, 2 * counts.size()));
    ++counts[group];
  }
  for (std::uint32_t& group : large)
    if (group != TriangleTree::kNoGroup && counts[group] < kFewFaces) group = TriangleTree::kNoGroup;
  return large;
}

/// Appends to the result the pairs of faces whose triangles meet, within the margin, and for which is_pair(face, other)
/// holds, until the search is cut short. Of the pairs that are further apart, is_pair is called for some.
/// Input:   faces are numbered as in `triangles`. reported(face) is the face that is reported for one.
///          view_of(tree) returns an object that knows the nodes of a tree, of which there may be two:
///          - is_of_no_interest(face, slot, node) says that no face of the node makes a pair with this one.
///          - lose_interest(slots) is called with the slots whose boxes meet too many others. If it returns true, fewer
///            nodes are of interest to some of these slots from then on.
/// Output:  the number of faces whose pairs have all been found.
/// Holds:   one of two faces finds the pair. The result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    for each face, O(log n) and the number of faces whose boxes meet its own. If these are many more than the
///          pairs, as among needles askew to the axes, the number of faces whose OrientedBoxes meet its own, in a tree
///          that is split by shape.
template <class Reported, class ViewOf, class IsPair>
std::size_t find_pairs(const SearchedTriangles& triangles, const Reported& reported, const ViewOf& view_of,
                       const IsPair& is_pair, PairSearch& pair_search) {
  RunControl& control = pair_search.control();
  const std::size_t n = triangles.faces.size();
  constexpr std::size_t kBlock = 256;
  constexpr std::uint64_t kStepsBetweenChecks = 1 << 15;
  // If a slot needs more tests without success than `most_in_vain`, its pairs are dropped and the slot is searched
  // again later. A slot that has found at least a quarter as many pairs is not dropped, because a second search would
  // gain nothing.
  constexpr std::size_t kMaxInVainPerPair = 4;
  std::vector<std::uint32_t> slots;
  std::vector<std::uint8_t> is_for_later(n, 0);
  std::size_t most_in_vain = 0, done = 0;
  // Searches for the pairs of a slot. visit(box, step, take) calls take(other) for the other slots whose boxes meet
  // `box`, until `take` returns false, and step(number) for what else it looks at.
  const auto search = [&](const TriangleTree& tree, std::size_t slot, FoundInTurn& found, std::size_t room,
                          const auto& visit) {
    control.check();  // a search of many nodes may find nothing, and would not check otherwise
    Box3 box = tree.box(slot);
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] -= triangles.margin;
      box.max[axis] += triangles.margin;
    }
    const FaceId face = tree.face(slot);
    const std::size_t before = found.pairs.size();
    std::size_t in_vain = 0;
    const auto allowed = [&] { return std::max(most_in_vain, kMaxInVainPerPair * (found.pairs.size() - before)); };
    std::uint64_t steps = 0, next_check = kStepsBetweenChecks;
    const auto step = [&](std::uint64_t more) {
      steps += more;
      if (steps < next_check) return;
      next_check = steps + kStepsBetweenChecks;
      pair_search.report_progress(kStepsBetweenChecks);
    };
    visit(box, step, [&](std::size_t other) {
      step(kStepsPerTest);
      if (!is_pair(face, tree.face(other))) return ++in_vain <= allowed();
      found.pairs.push_back(std::minmax(reported(face), reported(tree.face(other))));
      return found.pairs.size() <= room;
    });
    found.steps += steps;
    if (in_vain <= allowed()) return;
    found.pairs.resize(before);
    is_for_later[slot] = 1;
  };
  const TriangleTree tree(triangles.positions, triangles.faces, control, triangles.groups);
  auto view = view_of(tree);
  const auto search_slot = [&](std::size_t slot, FoundInTurn& found, std::size_t room) {
    search(tree, slot, found, room, [&](const Box3& box, const auto& step, const auto& take) {
      const auto is_of_no_interest = [&](std::size_t node) {
        step(1);
        return view.is_of_no_interest(tree.face(slot), slot, node);
      };
      tree.visit_meeting(box, slot + 1, is_of_no_interest, take);
    });
  };
  // The faces of a leaf have nearly the same neighbours. So the leaves near a leaf are found for all of its faces at
  // once, unless there are many, most of which may be of no interest.
  const auto search_leaf = [&](std::size_t leaf, FoundInTurn& found, std::size_t room) {
    constexpr std::size_t kMaxNear = 64;
    std::array<std::size_t, kMaxNear> near;
    std::size_t count = 0;
    Box3 of_leaf = tree.box_of_node(tree.node_of_leaf(leaf));
    for (int axis = 0; axis < 3; ++axis) {
      of_leaf.min[axis] -= triangles.margin;
      of_leaf.max[axis] += triangles.margin;
    }
    bool are_all_found = true;
    tree.visit_meeting_leaves(of_leaf, leaf, [&](std::size_t other) {
      are_all_found = count < kMaxNear;
      if (are_all_found) near[count++] = other;
      return are_all_found;
    });
    const auto [begin, end] = tree.slots_of_leaf(leaf);
    for (std::size_t slot = begin; slot < end && found.pairs.size() <= room; ++slot) {
      if (!are_all_found) {
        search_slot(slot, found, room);
        continue;
      }
      search(tree, slot, found, room, [&](const Box3& box, const auto& step, const auto& take) {
        for (std::size_t i = 0; i < count; ++i) {
          const std::size_t node = tree.node_of_leaf(near[i]);
          step(1);
          if (!do_meet(tree.box_of_node(node), box) || view.is_of_no_interest(tree.face(slot), slot, node)) continue;
          const auto [first, last] = tree.slots_of_leaf(near[i]);
          for (std::size_t other = std::max(first, slot + 1); other < last; ++other)
            if (do_meet(tree.box(other), box) && !take(other)) return;
        }
      });
    }
  };
  // Returns whether some slots are left for later, which are then in `slots`.
  const auto are_some_left = [&] {
    slots = select_ids<std::uint32_t>(n, kItemsPerBlock, control,
                                      [&](std::size_t slot) { return is_for_later[slot] != 0; });
    done -= slots.size();
    std::fill(is_for_later.begin(), is_for_later.end(), std::uint8_t{0});
    return !slots.empty() && pair_search.goes_on();
  };
  // Well-shaped faces have some twenty neighbours. A few slots may have more, as long as all of them together make only
  // a few times n tests.
  constexpr std::size_t kFewInVain = 64, kInVainPerSlot = 4;
  most_in_vain = kFewInVain;
  const std::size_t done_leaves = gather_pairs(tree.leaf_count(), kBlock / 4, pair_search, search_leaf);
  done = n * done_leaves / tree.leaf_count();
  if (!are_some_left()) return done;
  const auto search_later = [&](std::size_t most) {
    const std::vector<std::uint32_t> later = std::move(slots);
    most_in_vain = most;
    done += gather_pairs(later.size(), kBlock, pair_search, [&](std::size_t i, FoundInTurn& found, std::size_t room) {
      search_slot(later[i], found, room);
    });
    return are_some_left();
  };
  const std::size_t share = kInVainPerSlot * n / slots.size();
  if (share > 4 * kFewInVain && !search_later(share)) return done;
  const bool is_interest_lost = view.lose_interest(slots);
  if (is_interest_lost && !search_later(kFewInVain)) return done;
  // To hold a few slots against all others takes less time than to build the second tree.
  constexpr std::size_t kFewSlots = 32, kFewTests = std::size_t{1} << 24;
  const bool are_few = slots.size() <= kFewSlots && slots.size() * n <= kFewTests;
  if (triangles.by == SearchedTriangles::kByBoxes || are_few) {
    search_later(n);
    return done;
  }

  const std::vector<std::uint32_t> groups = large_groups(triangles.groups, control);
  const TriangleTree by_shape(triangles.positions, triangles.faces, control, groups, TriangleTree::kByShape);
  const EarlierSearch earlier(
      tree, by_shape, [&](std::size_t slot) { return std::binary_search(slots.begin(), slots.end(), slot); }, control);
  slots =
      select_ids<std::uint32_t>(n, kItemsPerBlock, control, [&](std::size_t slot) { return earlier.is_left(slot); });
  auto view_by_shape = view_of(by_shape);
  if (is_interest_lost) view_by_shape.lose_interest(slots);
  const OrientedBoxes oriented(by_shape, triangles.positions, triangles.faces, triangles.margin, control);
  most_in_vain = n;
  done += gather_pairs(slots.size(), kBlock, pair_search, [&](std::size_t i, FoundInTurn& found, std::size_t room) {
    const std::size_t slot = slots[i];
    const FaceId face = by_shape.face(slot);
    const OrientedBoxes::Query query = oriented.query(triangles.faces[face.value]);
    search(by_shape, slot, found, room, [&](const Box3& box, const auto& step, const auto& take) {
      const auto is_of_no_interest = [&](std::size_t node) {
        step(1);
        if (earlier.is_none_new(slot, node, by_shape.slots(node).second) ||
            view_by_shape.is_of_no_interest(face, slot, node))
          return true;
        step(kStepsPerOrientedBox - 1);
        return oriented.are_apart(query, node);
      };
      by_shape.visit_meeting(box, 0, is_of_no_interest, [&](std::size_t other) {
        if (earlier.is_new(slot, other)) return take(other);
        step(1);
        return true;
      });
    });
  });
  return done;
}

}  // namespace remesh
