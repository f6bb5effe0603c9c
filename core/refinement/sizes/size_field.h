/// Gives the longest edge that is allowed at each place of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/sizes/gap_search.h"

namespace remesh {

/// The size at a place is the minimum, over all samples, of the sample's size plus the slope times the distance from
/// the sample. It may be a little less than that. A sample is a segment, or a box along the axes of its patch. Samples
/// lie in space and not in the plane of a patch. So sizes also change gradually from patch to patch, and samples turn
/// with the model.
/// Holds: at(x) <= goals.max_edge_length. |at(x) - at(y)| <= slope |x - y|, where slope = gradation - 1. (If an edge of
///        length h meets one of length gradation * h, their sizes are read at places that are h apart.) The field is
///        computed from the input and never from the growing mesh. It scales with the input by powers of two, exactly.
///        It is the same for any number of threads.
/// Cost:  at() takes O(log n) as long as sizes vary slowly, and constant time without proximity and gradation.
///        The memory is some 70 bytes a sample, for at most kMaxSamples samples and two a segment. Samples that another
///        one undercuts everywhere are left out, which takes as long as one at() for each.
class SizeField {
 public:
  /// Makes a field with the same size everywhere.
  explicit SizeField(double size = std::numeric_limits<double>::infinity()) : largest_(size) {}

  /// If goals.proximity > 0, the size is max((gap (1 + 2 kNoise) + plane_tolerance) / proximity, floor). So an edge
  /// that is ten gaps long is cut into ten pieces, whatever the last digits of the input say. The floor is
  /// max(goals.min_edge_length, 2^-11 of the box's diagonal, 10 plane tolerances). Each patch is cut into cells until
  /// every cell reaches from its middle at most half the gap there. The whole cell is given the size of its middle. So
  /// at() is at most twice the size that any place requires, even where the gap shrinks as fast as possible. Across a
  /// wall or a slot of one width it is exact. If only a part of a cell may face another patch, the cell is cut until it
  /// reaches no farther than that patch. If that patch is joined to the cell's patch, the cell is only cut while it is
  /// larger than some 2^-6 of the diagonal.
  ///
  /// Otherwise, if goals.gradation > 0, the sizes come from segments. An edge on a segment between essential vertices
  /// is at most as long as the segment, so the segment's length is the size there. The size is larger than that by the
  /// factor 1 + 2 kNoise, because rounding would otherwise cut the segment. It is not below the floor.
  ///
  /// Input:  `gaps` is null without proximity. `segments` are pairs of essential vertices; they have no effect with
  ///         proximity. The tolerance is in model units. `coarsest` is 0, or a size in model units: gaps that require
  ///         smaller sizes get this size, although it is above the floor. `earlier_steps` are the steps that searches
  ///         for gaps have taken in this run before.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  SizeField(const Surface& surface, const GapSearch* gaps, std::span<const std::array<VertexId, 2>> segments,
            const Goals& goals, double plane_tolerance, RunControl& control, double coarsest = 0,
            std::uint64_t earlier_steps = 0);

  /// Makes the field of the sizes that short segments alone require, without a floor.
  /// Input: The same as for the constructor, with goals.gradation > 0.
  static SizeField without_floor(const Surface& surface, std::span<const std::array<VertexId, 2>> segments,
                                 const Goals& goals, RunControl& control);

  /// Returns, for predictions, about the field that other goals would give. Gaps are taken from this field, and gaps
  /// that required more than the max size of this field have no effect.
  /// Input: a field of gaps, its goals.proximity, and goals with proximity.
  SizeField rescaled(double proximity, const Goals& goals, RunControl& control) const;

  /// Returns this field with a higher floor and a lower max size: sizes below goals.min_edge_length are raised to it,
  /// and none is above goals.max_edge_length.
  /// Holds: this field's own floor stays if it is higher, and so does its max size if it is lower.
  SizeField within(const Goals& goals, RunControl& control) const;

  /// Cells are not cut further if there would be more samples than allowed faces, and more than four for each patch.
  /// This number of samples never exceeds kMaxSamples, and kFewSamples are always allowed.
  static constexpr std::size_t kMaxSamples = std::size_t{1} << 19;
  static constexpr std::size_t kFewSamples = std::size_t{1} << 15;

  /// Sizes are stored in single precision, so sizes of the same gap differ in their last digits. They differ by less
  /// than this fraction.
  static constexpr double kNoise = 0x1p-21;

  /// Returns whether the size is the same everywhere. If so, it is `largest()`.
  bool is_uniform() const { return samples_.size() == 0; }
  double largest() const { return largest_; }
  std::size_t sample_count() const { return samples_.size(); }
  /// Returns the steps that the search for gaps has taken, as kWorkOfSizes counts them.
  std::uint64_t search_steps() const { return search_steps_; }
  /// Returns whether the search for gaps had to end early, so that cells are larger than the gaps require.
  bool is_search_cut_short() const { return is_search_cut_short_; }
  /// Returns the floor: gaps and short edges do not make sizes smaller than this. It is in model units.
  double floor() const { return floor_; }
  /// Returns whether the floor would be lower without the option min_edge_length.
  bool is_min_edge_user_limit() const { return is_min_edge_user_limit_; }

  /// Returns the size at a place in model units. It may be called from any thread.
  double at(const Vec3& place) const;
  /// Returns the max growth of the size per distance.
  double slope() const { return slope_; }
  /// Returns how long a look-up takes, compared with one in usual fields of gaps. It is 1 if that is about as long.
  /// If patches that span the part cross each other everywhere, it takes many times as long. It is counted in boxes at
  /// some places, and is the same on every machine. Optional look-ups have to be made at fewer places then.
  double look_up_cost() const { return look_up_cost_; }
  /// The size at one place. It allows exactly the lengths that `allows` allows there.
  struct Limit {
    double largest;  ///< model units
    double size;     ///< local units
    double unit;     ///< length of a local unit in model units
    bool allows(double length) const { return length <= largest && length / unit <= size; }
  };
  Limit limit_at(const Vec3& place) const;
  /// Returns whether length <= at(place). This is several times faster than at(), above all if the answer is clear.
  /// With a radius, returns whether this is so for all places within the radius. In that case it may return false
  /// although it is so.
  bool allows(double length, const Vec3& place, double radius = 0) const;

 private:
  /// A size in local units, rounded down.
  struct Size {
    float value = HUGE_VALF;
    void join(Size other) { value = std::min(value, other.value); }
  };
  using Samples = BoxTree<Size>;
  using Segment = std::array<Vec3, 2>;
  /// A cell is the part of a patch in a box along the patch's axes. A box along the axes of space would be mostly empty
  /// if the patch is askew to them.
  struct Cell {
    PatchId patch;
    FloatBox box;
  };
  struct Sample {
    Samples::Entry entry;
    Cell cell;
    Segment segment{};  ///< used instead of `cell` in a field of segments
  };
  class Sampler;

  double size_from(const Samples::Entry& node, const Vec3& p, double radius = 0) const;
  double size_from(std::size_t slot, const Vec3& p, double radius = 0) const;
  void set_samples(std::span<const Sample> samples, RunControl& control);
  double distance(std::size_t slot, const Vec3& p) const;
  double farthest(std::size_t slot, std::size_t from) const;
  bool is_dominated(std::size_t slot) const;
  void drop_dominated(RunControl& control);
  void measure_look_ups(RunControl& control);
  double local_at(const Vec3& place) const;
  Vec3 local(const Vec3& place) const { return (1 / unit_) * (place - centre_); }

  double largest_;
  double floor_ = 0;
  bool is_min_edge_user_limit_ = false;
  double slope_ = 0;
  Vec3 centre_;  ///< the middle of local units, as in Surface
  double unit_ = 1;
  bool is_of_segments_ = false;
  std::uint64_t search_steps_ = 0;
  bool is_search_cut_short_ = false;
  double look_up_cost_ = 1;
  Samples samples_;
  IdVector<PatchId, Axes> axes_;
  std::vector<Cell> cells_;        ///< one per slot; empty in a field of segments
  std::vector<Segment> segments_;  ///< one per slot; empty in a field of gaps
};

}  // namespace remesh
