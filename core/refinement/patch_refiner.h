/// Refines one patch in its plane for angles and sizes, until nothing is left to do there.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/small_blocks.h"
#include "core/geometry/patch_mesh.h"
#include "core/patches/patch_chart.h"
#include "core/refinement/delaunay_mesh.h"
#include "core/refinement/floor.h"
#include "core/refinement/goals.h"
#include "core/refinement/held_sizes.h"
#include "core/refinement/refinement_progress.h"
#include "core/refinement/segment_cuts.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"
#include "core/refinement/task_queues.h"
#include "core/refinement/unrefined_reason.h"
#include "core/refinement/workplace.h"

namespace remesh {

/// Holds the goals in the form that the inner loop tests.
struct Criteria {
  Criteria(const Goals& goals, const SizeField& sizes);

  /// This is the tangent of the bound on angles; 0 if there is none. The bound is a little above the goal, because
  /// angles are measured in space in the end.
  double tangent;
  /// An apex over a piece encroaches on it if the squared cosine of the (obtuse) angle there is larger than this.
  double lens;
  /// This is the height of an off-centre over the shortest edge, per length of that edge.
  double off_centre;
  bool has_sizes;    ///< false: any triangle is small enough
  double max_area;   ///< model units
  double even_size;  ///< edge of the triangles that fill wide areas; infinity: there are none
  double area_edge;  ///< no triangle with edges up to this length is larger than max_area
  double min_angle_deg;
  double min_edge_length;
  bool split_boundaries;
  const SizeField& sizes;
};

/// A patch while it is refined. It cuts its own segments at once, as the table says, and remembers these cuts. Between
/// rounds it takes over the cuts that other patches made.
/// Source: L. P. Chew, Guaranteed-quality mesh generation for curved surfaces, 1993 (lens, deletion around a cut); A.
///         Üngör, Off-centers, 2004; G. Miller, S. Pav, N. Walkington, When and why Ruppert's algorithm works, 2003
///         (the exemption at input angles); S. Rebay, Efficient unstructured mesh generation by means of Delaunay
///         triangulation and Bowyer-Watson algorithm, 1993 (sizes).
class PatchRefiner {
 public:
  /// `cuts` has the cuts of every segment, ascending. Those of the patch's segments are made at once. Where there are
  /// sizes, wide areas are filled evenly with at most about `quota` triangles. The constructor also begins the first
  /// turn, at `at`.
  PatchRefiner(const PatchMesh& patch, const PatchChart& chart, PatchId id, const SegmentTable& segments,
               const Criteria& criteria, const SegmentCuts::OfSegments& cuts, std::uint64_t quota, Workplace& at,
               RunControl& control);

  /// The patch may only be changed between these two calls, in its turn. No other refiner may use the workplace during
  /// the turn.
  void begin_turn(Workplace& at);
  void end_turn();

  /// Returns whether refinement would change the patch at all. This is cheap and needs no refiner.
  static bool has_work(const PatchMesh& patch, const PatchChart& chart, const Criteria& criteria);

  /// Cuts the patch's sides along `segment` wherever they are not cut yet. `cuts` are all cuts of that segment,
  /// ascending.
  void take_over(SegmentId segment, std::span<const double> cuts);

  /// Puts a point into the middle of each of these edges inside the patch. An edge is left out if it is gone when its
  /// turn comes, or if there is no room for a point.
  /// Input:  Half-edges of the mesh that `finish` would return now.
  /// Output: True if a point was put into any of them.
  bool split_edges(std::span<const std::uint32_t> half_edges, RunControl& control);

  /// Works until nothing is left to do, or until `quota` more triangles (in all patches) would be made.
  void run(std::uint64_t quota, RefinementProgress& progress);

  /// Where there are sizes, removes points from a patch that is done: points inside that the bounds do not need in the
  /// end are removed one by one, or one point takes the place of two. It looks at the points that refinement put in or,
  /// where sizes vary, at all points inside. It goes on around every place where it succeeds. Each step leaves fewer
  /// points, so it ends.
  /// Holds:  Triangles are within the bounds as before. No new triangle is flatter than one with two angles of 28
  ///         degrees, or than the flattest that was there before. Triangles that miss a bound stay as they are.
  /// Source: H. Erten, A. Üngör, Quality triangulations with locally optimal Steiner points, 2009 (one point for two);
  ///         M. Badoiu, K. Clarkson, Smaller core-sets for balls, 2003 (places for these points).
  void thin_out(RunControl& control, RefinementProgress& progress);

  /// Returns a segment that had to be cut where rounding left no room for the cut. Then the patch can no longer be
  /// used, and the segment must stay as it is for all patches. The result is invalid if all is well.
  SegmentId impossible() const { return impossible_; }
  bool is_done() const { return waiting_.size() == 0; }
  std::size_t waiting() const { return waiting_.size(); }
  std::uint32_t triangle_count() const { return mesh_.triangle_count(); }
  /// Appends the cuts made here since the last call.
  void take_own_cuts(std::vector<Cut>& cuts) {
    cuts.insert(cuts.end(), own_cuts_.begin(), own_cuts_.end());
    own_cuts_.clear();
  }

  struct Refined {
    PatchMesh patch;  ///< new vertices have no id yet
    /// There is one entry per vertex of the patch. Its segment is invalid for a corner and for a vertex inside the
    /// patch.
    std::vector<Cut> cuts;
    /// There is one entry per triangle: the reason why it is as it is, in case it misses a bound.
    std::vector<UnrefinedReason> reason;
  };
  Refined finish() const;

 private:
  static constexpr std::uint32_t kNone = DelaunayMesh::kNone;
  /// Edges may be longer than their size by this factor, because of rounding.
  static constexpr double kSizeMargin = 1 + 1e-10;

  enum class State : std::uint8_t { kUnknown, kGood, kInputAngle, kAcrossInputAngle, kSizeFloor, kMinEdge, kLocked };

  struct Side {
    double t0, t1;          ///< the piece [t0, t1] of the segment
    std::uint32_t next;     ///< another piece of the same chain, or kNone
    std::uint32_t chain;    ///< index in `chains_`, which knows the segment
    std::uint32_t partner;  ///< the other side of a slit, or kNone
    bool is_forward;        ///< the half-edge runs from t0 to t1
  };
  /// A chain has the pieces of one segment, in no order. For a slit, these are the pieces of its first side.
  struct Chain {
    SegmentId segment;
    std::uint32_t first;  ///< a side; the others follow by Side::next
  };
  using Task = Workplace::Task;
  struct Shape {
    std::uint32_t shortest;  ///< half-edge
    double shortest_squared, longest_squared, twice_area;
    bool is_sharp;  ///< it has an angle below the bound
    bool is_too_large;
  };

  SegmentId segment_of(const Side& side) const { return chains_[side.chain].segment; }
  SegmentId segment_of_side(std::uint32_t side) const { return segment_of(sides_[side]); }
  /// Returns a number of bytes that most often is enough for everything that is stored for a small patch.
  static std::size_t first_block(const PatchMesh& patch, std::size_t sides);
  void add_to_chain(std::uint32_t side);
  void collect_corners(PatchId id);
  void collect_sides(PatchId id);
  void collect_held_sides(PatchId id, RunControl& control);
  bool start_evenly(PatchId id, const SegmentCuts::OfSegments& cuts, std::uint64_t quota, RunControl& control);
  /// Has the measures of the triangle between a point and an edge.
  struct Spanned {
    double squares, shortest_squared, longest_squared;  ///< sum, minimum and maximum over its edges
    double twice_area;
  };
  static Spanned spanned(Vec2 p, Vec2 a, Vec2 b) {
    const Vec2 base = b - a, u = a - p, v = b - p;
    const double squared[3] = {dot(base, base), dot(u, u), dot(v, v)};
    const auto [shortest, longest] = std::minmax({squared[0], squared[1], squared[2]});
    return {squared[0] + squared[1] + squared[2], shortest, longest, cross(u, v)};
  }
  Shape shape_of(std::uint32_t t) const;
  bool is_sharp(double squares, double shortest_squared, double twice_area) const;
  bool is_too_large_anywhere(Vec2 at, double longest_squared, double twice_area) const;
  bool is_larger_than_asked(std::uint32_t t) const;
  bool is_too_large(Vec2 a, Vec2 b, Vec2 c, double longest_squared, double twice_area) const;
  bool is_too_long(Vec2 a, Vec2 b) const;
  bool do_sizes_vary() const { return held_ != nullptr || !criteria_.sizes.is_uniform(); }
  double size_at(Vec2 p) const;
  bool allows(double length, Vec2 p, double radius = 0) const;
  State excuse(std::uint32_t shortest) const;
  static UnrefinedReason reason_of(State state);
  void classify(std::uint32_t t);
  void classify_changed();
  bool is_at_input_angle(std::uint32_t h) const;
  bool is_across_input_angle(std::uint32_t a, std::uint32_t b) const;
  void push(const Task& task, double shortest_squared);

  void treat(const Task& task);
  Vec2 steiner_point(const Shape& shape) const;
  int count_good(Vec2 p, int least) const;
  Vec2 lowered(Vec2 p, std::uint32_t shortest) const;
  /// Describes the effect that a point would have on its cavity.
  struct Outcome {
    /// This is the number of new triangles that miss a bound, minus the number of old ones that did.
    int more_bad;
    /// This is the minimum, over the new triangles, of twice the area over the sum of squared edges. The larger it is,
    /// the better.
    double least_shape;
  };
  Outcome outcome(Vec2 p, int most) const;
  bool is_encroaching(Vec2 p) const;
  Vec2 best_for_size(Vec2 p, std::uint32_t shortest);
  bool is_encroached(Vec2 p, Vec2 a, Vec2 b) const;
  /// Cuts a piece where the table says. Returns whether the piece was cut.
  bool cut_side(std::uint32_t side);
  bool cut_side_at(std::uint32_t side, double t);
  std::uint32_t cut_one(std::uint32_t side, double t, Vec2 p, std::uint32_t vertex);
  void clear_circle(std::uint32_t side);
  void set_vertex(std::uint32_t v, SegmentId segment, double value);
  enum class Attempt { kDone, kEncroached, kTooNear };
  /// This is a place for a point. Unless the place is hidden, its cavity has been found.
  struct Place {
    Vec2 p;
    DelaunayMesh::Location at;
    bool has_room;
  };
  Place look_at(Vec2 p, std::uint32_t triangle);
  /// Says what a new point may do. With kBeClear it must not encroach on any piece. With kEncroach it may encroach on
  /// pieces that can be cut. With kBeAnywhere it may encroach on any piece and be nearer to other points than its
  /// floor; then the floor only says how near others may come to it.
  enum class May { kBeClear, kEncroach, kBeAnywhere };
  Attempt insert(const Place& place, Floor floor, May may);
  Attempt insert(Vec2 p, std::uint32_t triangle, Floor floor, May may);
  std::uint32_t longest_edge(std::uint32_t t) const;
  bool split_too_large(std::uint32_t t, Floor floor);
  bool is_too_long_side(std::uint32_t h) const;
  bool cut_too_long_side(std::uint32_t t);
  std::optional<State> held_large(std::uint32_t t) const;
  bool is_live(const Task& task) const;
  bool is_any_locked(std::span<const std::uint32_t> sides) const;
  static State why_near(Floor floor) { return floor.is_asked() ? State::kMinEdge : State::kSizeFloor; }
  static State why_locked(Lock lock);
  static State stronger(State a, State b);
  State why_uncut(std::span<const std::uint32_t> sides, State otherwise) const;

  // These members serve thinning out.
  struct Fan {
    double least_shape, twice_area;
    bool is_any_sharp;
  };
  bool is_allowed(double length, Vec2 p) const;
  bool find_ring(std::uint32_t v, std::vector<std::uint32_t>& ring) const;
  Fan fan_of(Vec2 p, std::span<const std::uint32_t> ring) const;
  void note_remade();
  void take(std::uint32_t v);
  void put_back();
  bool is_inside(std::uint32_t t, Vec2 p) const;
  bool are_remade_well(double flattest) const;
  bool leave_out(std::uint32_t v, double flattest);
  std::optional<Vec2> place_within(std::span<const std::uint32_t> ring, Floor floor, double flattest) const;
  bool find_hole(std::uint32_t v, std::size_t k);
  std::uint32_t merge(std::uint32_t v, std::uint32_t w, double flattest);

  Vec2 on_grid(Vec2 uv) const { return chart_.on_grid(uv); }
  bool is_free(std::uint32_t v) const { return v >= corner_count_ && !segment_[v].is_valid(); }
  Floor floor_on(SegmentId s) const { return {segments_[s].floor, segments_[s].is_floor_asked}; }
  Floor floor_of(std::uint32_t v) const { return segment_[v].is_valid() ? floor_on(segment_[v]) : Floor(value_[v]); }
  std::uint64_t cost_of_cut(SegmentId s) const { return segments_.sides(s).size(); }

  const PatchMesh& patch_;
  const PatchChart chart_;
  const SegmentTable& segments_;
  const Criteria& criteria_;
  const std::uint32_t corner_count_;
  std::unique_ptr<const HeldSizes> held_;  ///< sides that are longer than they may be and stay; null: none
  State held_as_ = State::kLocked;         ///< why these sides stay; the strongest of their reasons
  Workplace* at_;                          ///< only during a turn
  SmallBlocks memory_;
  DelaunayMesh mesh_{at_->mesh, &memory_};
  std::pmr::vector<SegmentId> segment_{&memory_};  ///< the segment that a vertex lies on; else invalid
  std::pmr::vector<double> value_{&memory_};       ///< the parameter on that segment, or else a Floor
  std::pmr::vector<Side> sides_{&memory_};         ///< numbered as the sides of mesh_
  std::pmr::vector<State> state_{&memory_};        ///< one per triangle
  /// A segment at a corner, and the corner at its other end. They are sorted at each corner.
  struct CornerSegment {
    VertexId other;
    SegmentId segment;
  };
  std::pmr::vector<CornerSegment> corner_segments_{&memory_};
  std::pmr::vector<std::uint32_t> corner_begin_{
      &memory_};                              ///< corner v has the segments [corner_begin_[v], corner_begin_[v + 1])
  std::pmr::vector<Chain> chains_{&memory_};  ///< ordered by segment

  /// The shorter a triangle's shortest edge is, the higher is its queue. There are eight queues for each octave of the
  /// squared length. Within a queue, the first in is the first out; so where all triangles are alike, they are treated
  /// layer after layer.
  TaskQueues<Task> waiting_;
  std::uint64_t quota_ = 0;
  std::uint32_t first_refined_ = 0;  ///< the number of vertices when refinement began
  std::pmr::vector<Cut> own_cuts_{&memory_};
  SegmentId impossible_;
};

}  // namespace remesh
