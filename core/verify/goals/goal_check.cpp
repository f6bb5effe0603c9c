#include "core/verify/goals/goal_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/blocks.h"
#include "core/verify/goals/straight_lines.h"

namespace remesh::verification {
namespace {

/// A value that differs from a bound by less than this share of it may count as on either side.
constexpr double kGoalMargin = 1e-9;

Standing at_most(double value, double bound) {
  if (value > bound * (1 + kGoalMargin)) return Standing::kMisses;
  return value < bound * (1 - kGoalMargin) ? Standing::kMeets : Standing::kOnTheEdge;
}
Standing at_least(double value, double bound) {
  if (bound == 0) return Standing::kMeets;
  if (value < bound * (1 - kGoalMargin)) return Standing::kMisses;
  return value > bound * (1 + kGoalMargin) ? Standing::kMeets : Standing::kOnTheEdge;
}

/// The lengths, angles and area of a triangle. Side i is opposite to corner i, and angle i is at it.
class Triangle3 {
 public:
  std::array<double, 3> side{};
  double area = 0;

  Triangle3(const Vec3& a, const Vec3& b, const Vec3& c) : along_{c - b, a - c, b - a} {
    const double unit =
        std::max({largest_coordinate(along_[0]), largest_coordinate(along_[1]), largest_coordinate(along_[2])});
    if (unit == 0) return;
    for (Vec3& v : along_) v = (1 / unit) * v;
    for (int i = 0; i < 3; ++i) side[i] = std::sqrt(norm_squared(along_[i])) * unit;
    // The two shorter sides are used because they have the smaller rounding.
    const auto longest = std::max_element(side.begin(), side.end()) - side.begin();
    twice_area_ = std::sqrt(norm_squared(cross(along_[(longest + 1) % 3], along_[(longest + 2) % 3])));
    area = twice_area_ * unit * unit / 2;
  }

  /// Output: 0 if a side has no length.
  double angle(int i) const { return std::atan2(twice_area_, 0 - dot(along_[(i + 1) % 3], along_[(i + 2) % 3])); }
  double longest_side() const { return *std::max_element(side.begin(), side.end()); }
  double shortest_side() const { return *std::min_element(side.begin(), side.end()); }
  double least_angle() const {
    return angle(static_cast<int>(std::min_element(side.begin(), side.end()) - side.begin()));
  }

 private:
  std::array<Vec3, 3> along_;  ///< the sides, in units of the largest coordinate
  double twice_area_ = 0;
};

class GoalCheck {
 public:
  GoalCheck(const RefinementClaim& refinement, const NumberedClaim& numbered, const EdgeTable& edges,
            const BoundaryGraph& seams, const VaryingSizes* sizes, FoundFaults& faults, RunControl& control)
      : claim_(refinement),
        numbered_(numbered),
        edges_(edges),
        seams_(seams),
        sizes_(sizes),
        faults_(faults),
        control_(control),
        min_angle_(refinement.goals.min_angle_deg * std::numbers::pi / 180),
        // The area is multiplied by the scale twice, because the square of the scale may overflow or underflow.
        max_area_(refinement.goals.max_area * numbered.scale * numbered.scale),
        max_length_(refinement.goals.max_edge_length * numbered.scale),
        min_length_(refinement.goals.min_edge_length * numbered.scale) {}

  void run() {
    if (numbered_.output.count() > claim_.goals.max_faces) faults_.add(PatchId(), Fault::kTooManyFaces);
    if (!claim_.goals.split_boundaries) check_locked_boundary();
    const bool is_any_across = std::find(claim_.reasons.begin(), claim_.reasons.end(),
                                         UnrefinedReason::kAcrossInputAngle) != claim_.reasons.end();
    if (is_any_across || min_length_ > 0) lines_.emplace(numbered_, seams_, control_);
    find_patches_beside_frozen();
    check_faces();
    if (min_length_ > 0) check_new_edges();
  }

 private:
  using Found = std::vector<FoundFault>;

  void check_locked_boundary() {
    for (const Edge& edge : seams_.edges())
      for (const VertexId v : {edge.low, edge.high})
        if (numbered_.is_new(v))
          for (const Use& use : edge.uses) faults_.add(use.patch(), Fault::kLockedBoundary, v.value);
  }

  void check_faces() {
    // If sizes vary from place to place, a gap is looked for at each face, which takes microseconds. Then each task
    // gets fewer faces.
    const std::size_t block = sizes_ != nullptr ? 512 : kItemsPerBlock;
    const auto blocks =
        map_blocks<Found>(numbered_.output.count(), block, control_, [&](std::size_t begin, std::size_t end) {
          Found found;
          auto listed = std::lower_bound(claim_.unrefined.begin(), claim_.unrefined.end(), FaceId(begin));
          for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
            const bool is_listed = listed != claim_.unrefined.end() && *listed == FaceId(f);
            const Triangle3 face = measure(f);
            const Standing size = size_of(face);
            const Standing standing = std::max(size, angle_of(face.least_angle()));
            const auto report = [&](Fault fault) { found.push_back({numbered_.output.patch[f], fault, f}); };
            if (!is_listed) {
              if (standing == Standing::kMisses || is_too_large_here(f)) report(Fault::kUnlisted);
              continue;
            }
            const UnrefinedReason reason = claim_.reasons[listed++ - claim_.unrefined.begin()];
            if (standing == Standing::kMeets && !is_unknown(reason) && !may_be_too_large_here(f))
              report(Fault::kListedInVain);
            else if (!is_reason(reason, f, face, size != Standing::kMisses))
              report(Fault::kCertificate);
          }
          return found;
        });
    for (const Found& found : blocks) faults_.add(found);
  }

  bool is_too_large_here(std::uint32_t f) const { return sizes_ != nullptr && sizes_->is_missed_clearly(f); }
  bool may_be_too_large_here(std::uint32_t f) const { return sizes_ != nullptr && sizes_->may_be_missed(f); }

  /// Returns whether it may be unknown if a face is too large for a gap. The refiner's search for gaps has a bound on
  /// its work, and once the bound is reached every face is listed.
  bool is_unknown(UnrefinedReason reason) const {
    return reason == UnrefinedReason::kEffort && claim_.goals.proximity > 0;
  }

  /// Finds the patches for which it may be claimed that their boundary, or a part of it, was left unchanged because
  /// of a frozen patch.
  void find_patches_beside_frozen() {
    if (claim_.frozen.empty()) return;
    is_beside_frozen_.assign(claim_.frozen.begin(), claim_.frozen.end());
    const auto is_frozen = [&](const Use& use) { return claim_.frozen[use.patch().value] != 0; };
    for (const Edge& edge : seams_.edges())
      if (std::any_of(edge.uses.begin(), edge.uses.end(), is_frozen))
        for (const Use& use : edge.uses) is_beside_frozen_[use.patch().value] = 1;
  }
  bool is_any_boundary_locked(PatchId p) const {
    return !claim_.goals.split_boundaries || (!is_beside_frozen_.empty() && is_beside_frozen_[p.value] != 0);
  }

  Triangle3 measure(std::uint32_t f) const {
    const auto corner = numbered_.output.face(f);
    return {numbered_.output_point(corner[0]), numbered_.output_point(corner[1]), numbered_.output_point(corner[2])};
  }

  Standing size_of(const Triangle3& face) const {
    return std::max(at_most(face.longest_side(), max_length_), at_most(face.area, max_area_));
  }
  Standing angle_of(double angle) const { return at_least(angle, min_angle_); }

  /// Input: `is_small_enough` - the face is not larger than the bounds on sizes.
  bool is_reason(UnrefinedReason reason, std::uint32_t f, const Triangle3& face, bool is_small_enough) const {
    switch (reason) {
      // Input angles explain small angles, not large sizes.
      case UnrefinedReason::kInputAngle: return is_small_enough && is_at_input_angle(f, face) && !is_too_large_here(f);
      case UnrefinedReason::kAcrossInputAngle:
        return is_small_enough && is_across_input_angle(f, face) && !is_too_large_here(f);
      case UnrefinedReason::kMinEdgeLength: return min_length_ > 0;
      case UnrefinedReason::kBudget: return claim_.goals.max_faces < std::numeric_limits<std::uint64_t>::max();
      case UnrefinedReason::kBoundaryLocked: return is_any_boundary_locked(numbered_.output.patch[f]);
      case UnrefinedReason::kSizeFloor:
      case UnrefinedReason::kEffort: return true;
      // Nothing has been rounded for an output format yet. check_rounded tests faces that are listed for this
      // reason.
      case UnrefinedReason::kOutputRounding: return false;
      // The report gives this reason to input angles of surfaces that were made coarser.
      case UnrefinedReason::kSurfaceTolerance: return false;
    }
    return false;
  }

  /// True if the only angle below the bound is at a vertex of the input, between two edges of the patch's boundary.
  bool is_at_input_angle(std::uint32_t f, const Triangle3& face) const {
    const auto corner = numbered_.output.face(f);
    for (int i = 0; i < 3; ++i) {
      if (angle_of(face.angle(i)) == Standing::kMeets) continue;
      const VertexId at = corner[i], left = corner[(i + 1) % 3], right = corner[(i + 2) % 3];
      if (at.value < numbered_.surface_vertex_count && is_bounding(at, left) && is_bounding(at, right) &&
          angle_of(face.angle((i + 1) % 3)) != Standing::kMisses &&
          angle_of(face.angle((i + 2) % 3)) != Standing::kMisses)
        return true;
    }
    return false;
  }

  bool is_bounding(VertexId a, VertexId b) const { return !edges_.is_interior(a, b); }

  /// True if the ends of the shortest side are on two lines that meet, equally far from their common point, and nearer
  /// to each other than to that point.
  bool is_across_input_angle(std::uint32_t f, const Triangle3& face) const {
    const auto corner = numbered_.output.face(f);
    const double shortest = face.shortest_side();
    for (int i = 0; i < 3; ++i) {
      if (face.side[i] > shortest * (1 + kGoalMargin)) continue;
      const VertexId a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
      const Vec3 pa = numbered_.output_point(a), pb = numbered_.output_point(b);
      const bool is_found = lines_->any_meeting(a, b, numbered_.output.patch[f], [&](VertexId at) {
        const Vec3 p = numbered_.output_point(at);
        const double to_a = norm(pa - p), to_b = norm(pb - p);
        const double noise = NumberedClaim::rounding(std::max(largest_coordinate(pa), largest_coordinate(pb)));
        return std::fabs(to_a - to_b) <= kGoalMargin * to_a + noise && face.side[i] <= (1 + kGoalMargin) * to_a;
      });
      if (is_found) return true;
    }
    return false;
  }

  /// Checks that edges with a new end are as long as they must be. Exceptions are edges inside a patch between two
  /// lines that meet at less than 60 degrees: the angle makes these edges short.
  void check_new_edges() {
    const auto blocks =
        map_blocks<Found>(edges_.vertex_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
          Found found;
          edges_.for_each_edge(begin, end, [&](const Edge& edge) {
            if (!numbered_.is_new(edge.low) && !numbered_.is_new(edge.high)) return;
            const Vec3 a = numbered_.output_point(edge.low), b = numbered_.output_point(edge.high);
            const double noise = NumberedClaim::rounding(std::max(largest_coordinate(a), largest_coordinate(b)));
            if (!(norm(b - a) < min_length_ * (1 - kGoalMargin) - noise)) return;
            if (edge.is_interior() && is_in_input_angle(edge)) return;
            for (const Use& use : edge.uses) found.push_back({use.patch(), Fault::kShortEdge, edge.low.value});
          });
          return found;
        });
    for (const Found& found : blocks) faults_.add(found);
  }

  bool is_in_input_angle(const Edge& edge) const {
    return lines_->any_meeting(edge.low, edge.high, edge.uses[0].patch(), [&](VertexId at) {
      const Vec3 to_low = numbered_.output_point(edge.low) - numbered_.output_point(at);
      const Vec3 to_high = numbered_.output_point(edge.high) - numbered_.output_point(at);
      return 2 * dot(to_low, to_high) > norm(to_low) * norm(to_high) * (1 - kGoalMargin);
    });
  }

  const RefinementClaim& claim_;
  const NumberedClaim& numbered_;
  const EdgeTable& edges_;
  const BoundaryGraph& seams_;
  const VaryingSizes* sizes_;  ///< null: no bound varies from place to place
  FoundFaults& faults_;
  RunControl& control_;
  // These are in the numbered claim's scale; the angle is in radians.
  const double min_angle_, max_area_, max_length_, min_length_;
  std::optional<StraightLines> lines_;  ///< set if one of the tests needs it
  std::vector<std::uint8_t> is_beside_frozen_;
};

}  // namespace

void check_goals(const RefinementClaim& refinement, const NumberedClaim& numbered, const EdgeTable& edges,
                 const BoundaryGraph& seams, const VaryingSizes* sizes, FoundFaults& faults, RunControl& control) {
  GoalCheck(refinement, numbered, edges, seams, sizes, faults, control).run();
}

Standing standing_of(const Goals& goals, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Triangle3 face(a, b, c);
  return std::max({at_most(face.longest_side(), goals.max_edge_length), at_most(face.area, goals.max_area),
                   at_least(face.least_angle(), goals.min_angle_deg * std::numbers::pi / 180)});
}

}  // namespace remesh::verification
