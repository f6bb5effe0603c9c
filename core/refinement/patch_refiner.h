/// Refines one patch in its plane: angles and sizes, until nothing is left to do there.
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
#include "core/refinement/delaunay_mesh.h"
#include "core/refinement/floor.h"
#include "core/refinement/goals.h"
#include "core/refinement/held_sizes.h"
#include "core/refinement/refinement_progress.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"
#include "core/refinement/task_queues.h"
#include "core/refinement/unrefined_reason.h"
#include "core/refinement/workplace.h"

namespace remesh {

/// A place at which a segment is cut.
struct Cut {
  SegmentId segment;
  double t;

  friend bool operator<(const Cut& a, const Cut& b) {
    return a.segment != b.segment ? a.segment < b.segment : a.t < b.t;
  }
  friend bool operator==(const Cut&, const Cut&) = default;
};

/// The goals in the form that the inner loop tests.
struct Criteria {
  Criteria(const Goals& goals, const SizeField& sizes);

  double tangent;     ///< of the bound on angles (a little above the goal: it is measured in space in the end); 0: none
  double lens;        ///< squared cosine beyond which an apex over a piece encroaches on it
  double off_centre;  ///< height of an off-centre over the shortest edge, per its length
  bool has_sizes;     ///< or any triangle is small enough
  double max_area;    ///< model units
  double even_size;   ///< edge of the triangles that fill wide areas; infinity: none
  double area_edge;   ///< no triangle with edges of that length at most has more than the largest area
  double min_angle_deg;
  double min_edge_length;
  bool split_boundaries;
  const SizeField& sizes;
};

/// A patch while it is refined. It cuts its own segments at once, as the table says, and remembers these cuts; those
/// that other patches make it takes over between rounds.
/// Source:  L. P. Chew, Guaranteed-quality mesh generation for curved surfaces, 1993 (lens, deletion around a cut);
///          A. Üngör, Off-centers, 2004; G. Miller, S. Pav, N. Walkington, When and why Ruppert's algorithm works, 2003
///          (the exemption at input angles); S. Rebay, Efficient unstructured mesh generation by means of Delaunay
///          triangulation and Bowyer-Watson algorithm, 1993 (sizes).
class PatchRefiner {
 public:
  /// `cuts`: of every segment, ascending; those of the patch's segments are made. Where there are sizes, wide areas are
  /// filled evenly at once, with at most about `quota` triangles. Its first turn begins with that.
  PatchRefiner(const PatchMesh& patch, PatchId id, const SegmentTable& segments, const Criteria& criteria,
               const IdVector<SegmentId, std::vector<double>>& cuts, std::uint64_t quota, Workplace& at,
               RunControl& control);

  /// Whatever changes the patch is for its turns alone: each at a workplace that no other refiner has meanwhile.
  void begin_turn(Workplace& at);
  void end_turn();

  /// Would refinement change the patch at all? Cheap, before anything is built.
  static bool has_work(const PatchMesh& patch, const Criteria& criteria);

  /// Cuts the patch's sides along `segment` wherever they are not cut yet. `cuts` are all cuts of that segment,
  /// ascending.
  void take_over(SegmentId segment, std::span<const double> cuts);

  /// Puts a point into the middle of each of these edges inside the patch that is still there when its turn comes and
  /// has room for one.
  /// Input:  half-edges as in what `finish` would give now.
  /// Output: whether there was room for any.
  bool split_edges(std::span<const std::uint32_t> half_edges, RunControl& control);

  /// Works until nothing is left to do or `quota` more triangles (in all patches) would be made.
  void run(std::uint64_t quota, RefinementProgress& progress);

  /// Where there are sizes, for a patch that is done: takes points inside away that the bounds do not need in the end,
  /// one by one, or puts one in the place of two: around those that refinement put in, and around where it succeeds.
  /// Each step has fewer points, so it ends.
  /// Holds:  triangles are within the bounds as before, and none is flatter than two angles of 28 degrees make it,
  ///         or than the flattest there was. What misses a bound stays as it is.
  /// Source: H. Erten, A. Üngör, Quality triangulations with locally optimal Steiner points, 2009 (one point for two);
  ///         places for them as in M. Badoiu, K. Clarkson, Smaller core-sets for balls, 2003.
  void thin_out(RunControl& control, RefinementProgress& progress);

  /// A segment that had to be cut, and rounding left no room for it: the patch is of no use any more, and the segment
  /// must stay as it is, for all patches. Invalid: all is well.
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
    PatchMesh patch;        ///< new vertices have no id yet
    std::vector<Cut> cuts;  ///< one per vertex of the patch; segment invalid: inside the patch, or a corner
    std::vector<UnrefinedReason> reason;  ///< one per triangle: why it is as it is, should it miss a bound
  };
  Refined finish() const;

 private:
  static constexpr std::uint32_t kNone = DelaunayMesh::kNone;
  /// Edges may be longer than their size by rounding.
  static constexpr double kSizeMargin = 1 + 1e-10;

  enum class State : std::uint8_t { kUnknown, kGood, kInputAngle, kAcrossInputAngle, kSizeFloor, kMinEdge, kLocked };

  struct Side {
    double t0, t1;          ///< its piece
    std::uint32_t next;     ///< another piece of its chain, or kNone
    std::uint32_t chain;    ///< in `chains_`, which knows the segment
    std::uint32_t partner;  ///< the other side of a slit, or kNone
    bool is_forward;        ///< the half-edge runs from t0 to t1
  };
  /// The pieces of one segment, in no order; of a slit, those of its first side.
  struct Chain {
    SegmentId segment;
    std::uint32_t first;  ///< side; the others follow by Side::next
  };
  using Task = Workplace::Task;
  struct Shape {
    std::uint32_t shortest;  ///< half-edge
    double shortest_squared, longest_squared, twice_area;
    bool is_sharp;  ///< an angle below the bound
    bool is_too_large;
  };

  SegmentId segment_of(const Side& side) const { return chains_[side.chain].segment; }
  SegmentId segment_of_side(std::uint32_t side) const { return segment_of(sides_[side]); }
  /// Bytes that suffice, most often, for what is kept of a small patch.
  static std::size_t first_block(const PatchMesh& patch, std::size_t sides);
  void add_to_chain(std::uint32_t side);
  void collect_corners(PatchId id);
  void collect_sides(PatchId id);
  void collect_held_sides(PatchId id, RunControl& control);
  bool start_evenly(PatchId id, const IdVector<SegmentId, std::vector<double>>& cuts, std::uint64_t quota,
                    RunControl& control);
  /// The triangle from a point to an edge.
  struct Spanned {
    double squares, shortest_squared, longest_squared;  ///< of its edges: the sum, the least, the largest
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
  bool is_too_large_anywhere(double longest_squared, double twice_area) const;
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
  /// What a point would make of its cavity.
  struct Outcome {
    int more_bad;        ///< triangles that miss a bound, less those that did before
    double least_shape;  ///< of the new triangles: area over the sum of squared edges, the larger the better
  };
  Outcome outcome(Vec2 p, int most) const;
  bool is_encroaching(Vec2 p) const;
  Vec2 best_for_size(Vec2 p, std::uint32_t shortest);
  bool is_encroached(Vec2 p, Vec2 a, Vec2 b) const;
  /// Cuts a piece where the table says. Returns whether it did.
  bool cut_side(std::uint32_t side);
  bool cut_side_at(std::uint32_t side, double t);
  std::uint32_t cut_one(std::uint32_t side, double t, Vec2 p, std::uint32_t vertex);
  void clear_circle(std::uint32_t side);
  void set_vertex(std::uint32_t v, SegmentId segment, double value);
  enum class Attempt { kDone, kEncroached, kTooNear };
  /// A place for a point; its cavity has been found if the point sees it.
  struct Place {
    Vec2 p;
    DelaunayMesh::Location at;
    bool has_room;
  };
  Place look_at(Vec2 p, std::uint32_t triangle);
  /// What a new point may do: encroach on no piece; on such as can be cut; or on any, and be nearer to others than the
  /// floor, which only says how near others may come to it then.
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

  // Thinning out.
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

  Vec3 to_space(Vec2 uv) const;
  Vec2 on_grid(Vec2 uv) const;
  bool is_free(std::uint32_t v) const { return v >= corner_count_ && !segment_[v].is_valid(); }
  Floor floor_on(SegmentId s) const { return {segments_[s].floor, segments_[s].is_floor_asked}; }
  Floor floor_of(std::uint32_t v) const { return segment_[v].is_valid() ? floor_on(segment_[v]) : Floor(value_[v]); }
  std::uint64_t cost_of_cut(SegmentId s) const { return segments_.sides(s).size(); }

  const PatchMesh& patch_;
  const SegmentTable& segments_;
  const Criteria& criteria_;
  const std::uint32_t corner_count_;
  std::unique_ptr<const HeldSizes> held_;  ///< null: no side is longer than it may be, and stays
  State held_as_ = State::kLocked;         ///< why these sides stay; the strongest reason of them all
  Workplace* at_;                          ///< during a turn
  SmallBlocks memory_;
  DelaunayMesh mesh_{at_->mesh, &memory_};
  std::pmr::vector<SegmentId> segment_{&memory_};  ///< of each vertex that cuts one
  std::pmr::vector<double> value_{&memory_};       ///< of such a vertex its parameter, of others their Floor
  std::pmr::vector<Side> sides_{&memory_};         ///< numbered as in mesh_
  std::pmr::vector<State> state_{&memory_};        ///< of each triangle
  /// A segment at a corner: its other end, and which it is; sorted at each corner.
  struct CornerSegment {
    VertexId other;
    SegmentId segment;
  };
  std::pmr::vector<CornerSegment> corner_segments_{&memory_};
  std::pmr::vector<std::uint32_t> corner_begin_{
      &memory_};                              ///< segments of corner v: [corner_begin_[v], corner_begin_[v + 1])
  std::pmr::vector<Chain> chains_{&memory_};  ///< by segment

  /// The higher the queue, the shorter the shortest edge: eight an octave of its square. First in, first out: layer
  /// after layer, where all are alike.
  TaskQueues<Task> waiting_;
  std::uint64_t quota_ = 0;
  std::uint32_t first_refined_ = 0;  ///< so many vertices were there when it began
  std::pmr::vector<Cut> own_cuts_{&memory_};
  SegmentId impossible_;
};

}  // namespace remesh
