#include "core/geometry/shells/inside_out.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/shells/shell_nesting.h"
#include "core/geometry/shells/winding_number.h"
#include "core/geometry/trees/box_tree.h"

namespace remesh {
namespace {

/// The way in which a shell looks: outwards, or inwards as a cavity does.
enum class Side : std::int8_t { kOut, kIn };

/// The labels of each shell, ascending.
class LabelsOfShells {
 public:
  LabelsOfShells(const Shells& shells, const BodyLabels& labels, RunControl& control) : labels_(labels) {
    if (labels.are_alike()) return;
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    // Neighbours in the file belong together in most cases, so most blocks have few pairs.
    for (const std::vector<Pair>&of_block : map_blocks<std::vector<Pair>>(
             shells.of_face.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
               std::vector<Pair> sets;
               for (std::size_t f = begin; f < end; ++f) {
                 const Pair pair{shells.of_face[f], labels.set_of[f]};
                 if (sets.empty() || sets.back() != pair) sets.push_back(pair);
               }
               sort_out(sets);
               std::vector<Pair> pairs;
               for (const auto& [shell, set] : sets)
                 for (std::uint32_t i = labels.begin[set]; i < labels.begin[set + 1]; ++i)
                   pairs.push_back({shell, labels.labels[i]});
               return pairs;
             }))
      pairs_.insert(pairs_.end(), of_block.begin(), of_block.end());
    sort_unique(pairs_, control);
  }

  /// Returns whether two shells have a label in common. Cost: O(k log n), where one of them has k labels.
  bool do_share(std::uint32_t a, std::uint32_t b) const {
    if (labels_.are_alike()) return true;
    auto few = of(a), many = of(b);
    if (few.size() > many.size()) std::swap(few, many);
    const auto is_before = [](const auto& p, const auto& q) { return p.second < q.second; };
    return std::any_of(few.begin(), few.end(),
                       [&](const auto& pair) { return std::binary_search(many.begin(), many.end(), pair, is_before); });
  }

 private:
  template <class Pairs>
  static void sort_out(Pairs& pairs) {
    sort_unique(pairs);
  }

  std::span<const std::pair<std::uint32_t, std::uint32_t>> of(std::uint32_t shell) const {
    const auto [begin, end] = std::equal_range(pairs_.begin(), pairs_.end(), std::pair(shell, 0u),
                                               [](const auto& p, const auto& q) { return p.first < q.first; });
    return {begin, end};
  }

  const BodyLabels& labels_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

/// The shells that are not closed. What they enclose is unknown; only how far they wind around a place can be computed.
class OpenPieces {
 public:
  OpenPieces(std::span<const Vec3> positions, std::span<const VertexId> corners, const Shells& shells,
             RunControl& control)
      : positions_(positions), corners_(corners), shells_(shells), control_(control) {}

  /// Returns whether the open pieces wind around a closed shell by another number than around the shell in which it
  /// lies.
  bool are_between(std::uint32_t shell, std::optional<std::uint32_t> outer) {
    if (ends_.empty()) prepare();
    if (!number_ || !contains(number_->box(), shells_.all[shell].box)) return false;
    // From the middle of a box, each of its sides covers about a sixth of all directions. This threshold is above
    // rounding and below one side.
    constexpr double kClearly = 0.1;
    return std::fabs(around(shell) - (outer ? around(*outer) : 0)) > kClearly;
  }

 private:
  Triangle triangle(std::size_t f) const { return {corners_[3 * f], corners_[3 * f + 1], corners_[3 * f + 2]}; }

  void prepare() {
    ends_.resize(shells_.all.size());
    StopCheck check(control_);
    for (std::size_t f = 0; f < shells_.of_face.size(); ++f) {
      check();
      const std::uint32_t shell = shells_.of_face[f];
      if (!shells_.all[shell].is_closed) triangles_.push_back(triangle(f));
      auto& [first, last] = ends_[shell];
      const bool is_new = shells_.all[shell].first.value == f;
      for (const VertexId v : triangle(f)) {
        const Vec3& p = positions_[v.value];
        first = is_new && v == corners_[3 * f] ? p : std::min(first, p);
        last = is_new && v == corners_[3 * f] ? p : std::max(last, p);
      }
    }
    if (!triangles_.empty()) number_.emplace(positions_, triangles_, control_);
  }

  double around(std::uint32_t shell) const {
    control_.check();
    const auto& [first, last] = ends_[shell];
    return 0.5 * number_->at(first) + 0.5 * number_->at(last);
  }

  std::span<const Vec3> positions_;
  std::span<const VertexId> corners_;
  const Shells& shells_;
  RunControl& control_;
  std::vector<std::pair<Vec3, Vec3>> ends_;  ///< the lexicographically first and last vertex of each shell
  std::vector<Triangle> triangles_;
  std::optional<WindingNumber> number_;
};

class Judging {
 public:
  Judging(const Shells& shells, const ShellNesting& nesting, OpenPieces& open, const BodyLabels& labels,
          RunControl& control)
      : shells_(shells), nesting_(nesting), open_(open), labels_(shells, labels, control), control_(control) {}

  /// Output: for each shell, whether it has the wrong orientation.
  std::vector<std::uint8_t> run() {
    is_wrong_.assign(shells_.all.size(), 0);
    const auto& nests = nesting_.nests();
    std::vector<std::uint32_t> innermost(nests.size());
    for (std::size_t n = 0; n < nests.size(); ++n) {
      if (n % kItemsPerBlock == 0) control_.check_and_move();
      const std::uint32_t around = nests[n].around == kNone ? kNone : innermost[nests[n].around];
      std::uint32_t outer = around;
      for (const std::uint32_t shell : from_outside(nests[n].shells, outer)) {
        if (outer != around && is_copy(shell, outer)) continue;
        is_wrong_[shell] = right_side(shell, outer) != side(shell) && !is_in_doubt(shell, outer);
        outer = shell;
      }
      innermost[n] = outer;
    }
    return std::move(is_wrong_);
  }

 private:
  Side side(std::uint32_t shell) const { return shells_.all[shell].volume > 0 ? Side::kOut : Side::kIn; }

  /// The way in which a shell should look. The next shell outside of it must have been judged.
  Side right_side(std::uint32_t shell, std::uint32_t outer) const {
    if (shells_.all[shell].has_open_neighbours) return side(shell);
    if (outer == kNone) return Side::kOut;
    const bool is_outer_wrong = is_wrong_[outer] != 0;
    const bool is_in_solid = (side(outer) == Side::kOut) != is_outer_wrong;
    if (!is_in_solid) return Side::kOut;
    if (labels_.do_share(shell, outer)) {
      const bool is_said_wrong = side(shell) == Side::kOut;
      return is_said_wrong && nesting_.is_place_in_doubt(shell) ? Side::kOut : Side::kIn;
    }
    return side(shell) == Side::kIn && is_outer_wrong ? Side::kOut : side(shell);
  }

  /// Returns whether an open piece may lie between the two shells.
  bool is_in_doubt(std::uint32_t shell, std::uint32_t outer) {
    return open_.are_between(shell, outer == kNone ? std::nullopt : std::optional(outer));
  }

  /// Returns whether a shell is merely a copy of another one, which is in the same place and has the right orientation.
  bool is_copy(std::uint32_t shell, std::uint32_t other) const {
    return !is_wrong_[other] && side(shell) == side(other) && labels_.do_share(shell, other);
  }

  /// Puts shells in one place into their order from outside in. Shells of the body around them come first, and among
  /// these the ones with the right orientation.
  std::vector<std::uint32_t> from_outside(std::vector<std::uint32_t> shells, std::uint32_t outer) const {
    if (shells.size() == 1) return shells;
    using Key = std::tuple<bool, bool, std::uint32_t>;
    std::vector<Key> keys;
    for (const std::uint32_t shell : shells) {
      const bool is_of_body = outer != kNone && labels_.do_share(shell, outer);
      keys.push_back({!is_of_body, right_side(shell, outer) != side(shell), shell});
    }
    std::sort(keys.begin(), keys.end());
    std::transform(keys.begin(), keys.end(), shells.begin(), [](const Key& key) { return std::get<2>(key); });
    return shells;
  }

  const Shells& shells_;
  const ShellNesting& nesting_;
  OpenPieces& open_;
  LabelsOfShells labels_;
  RunControl& control_;
  std::vector<std::uint8_t> is_wrong_;
};

}  // namespace

InsideOut find_inside_out(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                          const BodyLabels& labels, RunControl& control) {
  InsideOut result;
  if (corners.empty()) return result;
  const Shells shells = find_shells(positions, corners, edges, labels, control);
  const ShellNesting nesting(positions, corners, shells, control);
  OpenPieces open(positions, corners, shells, control);
  const std::vector<std::uint8_t> is_wrong = Judging(shells, nesting, open, labels, control).run();
  for (std::size_t s = 0; s < is_wrong.size(); ++s)
    if (is_wrong[s]) result.first_faces.push_back(shells.all[s].first);
  if (result.first_faces.empty()) return result;
  result.is_inside_out.resize(shells.of_face.size());
  for_blocks(shells.of_face.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) result.is_inside_out[f] = is_wrong[shells.of_face[f]];
  });
  return result;
}

}  // namespace remesh
