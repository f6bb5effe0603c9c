#include "core/geometry/self_intersections.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/geometry/predicates_3d.h"
#include "core/geometry/triangle_intersection.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {
namespace {

using Pairs = std::vector<std::pair<FaceId, FaceId>>;

/// Faces in a task, and tasks between two looks at how many pairs there are: few enough that a surface lying on itself
/// many times does not take quadratic time to say so.
constexpr std::size_t kBlock = 256;
constexpr std::size_t kBlocksInRound = 64;

/// Tests between two points of cancellation.
constexpr std::uint32_t kTestsBetweenChecks = 4096;

class Search {
 public:
  Search(std::span<const Vec3> positions, std::span<const Triangle> faces, const std::vector<std::uint8_t>* moved,
         RunControl& control)
      : positions_(scaled_for_predicates(positions)),
        faces_(faces),
        moved_(moved),
        control_(control),
        tree_(positions_, faces, control) {
    for (std::size_t slot = 0; slot < tree_.size(); ++slot)
      if (is_moved(slot)) to_test_.push_back(slot);
  }

  SelfIntersections run(std::size_t max_pairs) const {
    SelfIntersections result;
    for (std::size_t begin = 0; begin < to_test_.size() && result.is_complete; begin += kBlock * kBlocksInRound) {
      const std::size_t n = std::min(to_test_.size() - begin, kBlock * kBlocksInRound);
      const std::size_t room = max_pairs - result.pairs.size();
      const auto found = map_blocks<Pairs>(n, kBlock, control_, [&](std::size_t first, std::size_t last) {
        return pairs_of(begin + first, begin + last, room);
      });
      for (const Pairs& pairs : found) result.pairs.insert(result.pairs.end(), pairs.begin(), pairs.end());
      result.is_complete = result.pairs.size() <= max_pairs;
    }
    if (!result.is_complete) result.pairs.resize(max_pairs);
    std::sort(result.pairs.begin(), result.pairs.end());
    return result;
  }

 private:
  bool is_moved(std::size_t slot) const { return moved_ == nullptr || (*moved_)[tree_.face(slot).value] != 0; }

  /// Pairs of the faces to test from `begin` to `end`: all, or the first `room` and one more. Of two faces to test, the
  /// one in the earlier slot finds the pair.
  Pairs pairs_of(std::size_t begin, std::size_t end, std::size_t room) const {
    Pairs pairs;
    std::uint32_t tests = 0;
    for (std::size_t i = begin; i < end && pairs.size() <= room; ++i) {
      const std::size_t slot = to_test_[i];
      const FaceId f = tree_.face(slot);
      const std::size_t first = moved_ == nullptr ? slot + 1 : 0;
      tree_.visit_meeting(tree_.box(slot), first, [&](std::size_t other) {
        if (other <= slot && is_moved(other)) return true;
        if (++tests % kTestsBetweenChecks == 0) control_.check();
        const FaceId g = tree_.face(other);
        if (do_intersect(faces_[f.value], faces_[g.value], positions_)) pairs.push_back(std::minmax(f, g));
        return pairs.size() <= room;
      });
    }
    return pairs;
  }

  std::vector<Vec3> positions_;
  std::span<const Triangle> faces_;
  const std::vector<std::uint8_t>* moved_;
  RunControl& control_;
  TriangleTree tree_;
  std::vector<std::size_t> to_test_;  ///< slots, ascending
};

}  // namespace

SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     const std::vector<std::uint8_t>* moved, std::size_t max_pairs,
                                     RunControl& control) {
  return Search(positions, faces, moved, control).run(max_pairs);
}

}  // namespace remesh
