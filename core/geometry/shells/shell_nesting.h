/// Finds which closed shells lie in which.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The closed shells that enclose a volume, from outside in.
/// This class is larger than the bound because all its steps read and correct one forest of nests. Three steps need the
/// same tree and the same boxes: to find the nests in boxes, to look for the nearest shell, and to correct links. (The
/// bound is on the size of classes, see tests/tools/check.py.)
/// Input:   three corners per face; coordinates within [-2^250, 2^250]. The arguments must outlive this object.
/// Holds:   the result is right if shells do not cross each other, whether they touch or not. Which of two shells is
///          nearer to a third one is decided up to rounding. The result is the same for any number of threads and any
///          order of the faces.
/// Cost:    O(n) for n faces if no shell's box lies in the box of another shell. Otherwise a tree of the faces takes
///          O(n log n). Each shell whose box lies in another one's box then takes time in proportion to the number of
///          faces on the way from it to the nearest shell that does not lie in it. If that nearest shell crosses a
///          third one, the faces on the way to the nearest larger shell may be added. To find out whether a shell
///          crosses others takes a bounded number of looks for each face.
class ShellNesting {
 public:
  /// The shells in one place. There is one in nearly all cases, and several if shells coincide.
  struct Nest {
    std::vector<std::uint32_t> shells;
    std::uint32_t around = kNone;  ///< the next nest outside
  };

  ShellNesting(std::span<const Vec3> positions, std::span<const VertexId> corners, const Shells& shells,
               RunControl& control);

  /// All nests. A nest comes after those that it lies in.
  const std::vector<Nest>& nests() const { return nests_; }
  /// Returns whether a shell crosses the one around it, or crosses another shell whose box contains half of this
  /// shell's box or more. Then it cannot be decided in which shell it lies. Touching does not count as crossing, and
  /// coinciding shells do not cross. If that would take too long to find out, the place is in doubt.
  bool is_place_in_doubt(std::uint32_t shell) const;

 private:
  /// This tells where a shell lies, by its position relative to a second shell. The second shell is the nearest one
  /// from which the place of the first shell follows.
  struct Link {
    std::uint32_t nest = kNone;  ///< the nest of the second shell; kNone if there is no such shell
    /// True if the first shell lies in the second one. False if both lie in the same third shell, or in none.
    bool is_within = false;
  };
  struct Samples;
  /// The shells whose faces count when a link is looked for: all shells that may tell the place of a shell, or only
  /// those that may contain it.
  enum class Tellers : std::uint8_t { kAll, kLarger };

  void group_by_place();
  std::vector<std::uint32_t> nests_in_boxes() const;
  void make_tree();
  Samples samples_of(std::uint32_t shell) const;
  bool may_contain(std::uint32_t outer, std::uint32_t inner) const;
  bool may_tell(std::uint32_t other, std::uint32_t nest) const;
  void follow(const std::vector<std::uint32_t>& inner, const std::vector<Link>& links);
  std::uint32_t around(const Link& link, std::uint32_t nest) const;
  void correct(const std::vector<std::uint32_t>& inner, std::vector<Link>& links) const;
  Link link_of(std::uint32_t nest, Tellers tellers) const;
  double touch_of(std::uint32_t nest) const;
  bool is_touching(const Vec3& p, double reach, std::uint32_t nest) const;
  Link nearest(const Vec3& p, double tie, std::uint32_t nest, Tellers tellers) const;
  std::vector<std::uint32_t> crossed_by(std::uint32_t nest) const;

  Triangle triangle(std::uint32_t f) const { return {corners_[3 * f], corners_[3 * f + 1], corners_[3 * f + 2]}; }
  Corners3 corners3(std::uint32_t f) const {
    return {positions_[corners_[3 * f].value], positions_[corners_[3 * f + 1].value],
            positions_[corners_[3 * f + 2].value]};
  }
  const Shell& shell_of(std::uint32_t nest) const { return shells_.all[nests_[nest].shells[0]]; }

  std::span<const Vec3> positions_;
  std::span<const VertexId> corners_;
  const Shells& shells_;
  RunControl& control_;
  std::vector<Nest> nests_;
  std::vector<Box3> boxes_;             ///< by nest
  std::vector<std::uint32_t> nest_of_;  ///< by shell; kNone for shells that are in no nest
  std::optional<Grouping> faces_;       ///< by shell
  /// A face in the tree, and its nest. The tree has the faces of the first shell of each nest.
  struct FaceOfTree {
    std::uint32_t face, nest;
  };
  std::vector<FaceOfTree> faces_of_tree_;
  std::optional<TriangleTree> tree_;
  double end_ = 0;  ///< the smallest x of all shells
};

}  // namespace remesh
