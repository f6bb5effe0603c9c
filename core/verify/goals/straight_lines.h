/// Finds where the straight lines of a patch's boundary meet. Certificates for small input angles are based on this.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The output's bounding edges, joined to maximal straight lines. A line is a chain between vertices that stay, but a
/// vertex that lies on the line of its two edges does not end it. A new vertex on the boundary of a curved patch does
/// end it if it lies off that line. Such a vertex need not stay; a new vertex may happen to have the coordinates of a
/// dropped one.
class StraightLines {
 public:
  StraightLines(const NumberedClaim& numbered, const BoundaryGraph& seams, RunControl& control);

  /// Calls visit(one end, the other end, the uses of its edges) for each line.
  template <class Visit>
  void for_each_line(const Visit& visit) const {
    for (const Line& line : lines_) visit(line.low, line.high, line.uses);
  }

  /// Calls is_wanted(corner) for the corners in which a line of the patch through a and another line through b end,
  /// until it returns true.
  /// Output: true if is_wanted returned true for a corner.
  /// Cost:   O(min(lines at a, lines at b) log n). Summed over the edges of a triangulated patch this is O(n log n),
  ///         because each edge can be assigned to one of its ends such that no vertex gets more than three edges,
  ///         whatever its degree.
  template <class IsWanted>
  bool any_meeting(VertexId a, VertexId b, PatchId patch, const IsWanted& is_wanted) const {
    std::array<Reach, 2> of_a, of_b;
    std::span<const Reach> few = reaches(a, patch, of_a), many = reaches(b, patch, of_b);
    if (few.size() > many.size()) std::swap(few, many);
    for (const Reach& reach : few)
      for (const Reach& other : towards(many, reach.end))
        if (other.line != reach.line && is_wanted(reach.end)) return true;
    return false;
  }

 private:
  /// States that `line` leads from a vertex to `end`.
  struct Reach {
    VertexId from;
    PatchId patch;
    VertexId end;
    std::uint32_t line = 0;
    friend constexpr auto operator<=>(const Reach&, const Reach&) = default;
  };

  /// The lines through a vertex, sorted by their ends. `inner` is used as storage if the vertex is inside a line.
  std::span<const Reach> reaches(VertexId v, PatchId patch, std::array<Reach, 2>& inner) const;
  static std::span<const Reach> towards(std::span<const Reach> reaches, VertexId end);

  struct Line {
    VertexId low, high;
    std::span<const Use> uses;
  };

  std::vector<Line> lines_;
  std::vector<std::uint32_t> line_of_;  ///< the line that each vertex is inside of, or kNone
  std::vector<Reach> reaches_;          ///< the entries of the lines' ends, sorted
};

}  // namespace remesh::verification
