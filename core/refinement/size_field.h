/// The longest edge that is allowed at each place of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/box_tree.h"
#include "core/mesh/surface.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goals.h"

namespace remesh {

/// The least, over samples, of the sample's size plus the slope times the distance from it, or a little less. A sample
/// is a segment, or a box along the axes of its patch: in space, so sizes also grade from patch to patch, and turn with
/// the part.
/// Holds:  at(x) <= goals.max_edge_length; |at(x) - at(y)| <= slope |x - y|, where slope = gradation - 1 (two edges of
///         lengths h and gradation h that meet: their sizes are read one h apart); it reads the input, never the
///         growing mesh; scales with it by powers of two, exactly; the same for any number of threads.
/// Cost:   at() is O(log n) as long as sizes vary slowly; constant where there is no proximity and no gradation.
///         Memory: some 70 bytes a sample, at most kMaxSamples and two a segment; those that another one undercuts
///         everywhere are left out, which takes as long as an at() for each.
class SizeField {
 public:
  /// The same size everywhere.
  explicit SizeField(double size = std::numeric_limits<double>::infinity()) : largest_(size) {}

  /// With goals.proximity > 0: size = max((gap (1 + 2 kNoise) + plane_tolerance) / proximity, floor): what is ten gaps
  /// long is cut into ten pieces, whatever the last digits of the input say; floor = max(goals.min_edge_length,
  /// 2^-11 of the box's diagonal, 10 plane tolerances). Each patch is cut into cells until a cell reaches from its
  /// middle at most half the gap there; all of it is given the size of its middle. So at() is at most twice what any
  /// place asks for (where the gap shrinks as fast as one can come nearer); across a wall or a slot of one width it is
  /// exact. Cells of which only a part may face something are cut until they reach no farther than to that; of what is
  /// joined to their patch, only cells larger than some 2^-6 of the diagonal are.
  ///
  /// Else, with goals.gradation > 0: an edge on a segment between essential vertices is as long as the segment at most,
  /// so that is the size there (and 2 kNoise more, or rounding would cut it), though none under the floor.
  ///
  /// Input:  `gaps`: with proximity, null else; `segments` as pairs of essential vertices, of no matter then; the
  ///         tolerance in model units.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  SizeField(const Surface& surface, const GapSearch* gaps, std::span<const std::array<VertexId, 2>> segments,
            const Goals& goals, double plane_tolerance, RunControl& control);

  /// What short segments alone ask for, with no floor under it.
  /// Input:  as above, with goals.gradation > 0.
  static SizeField without_floor(const Surface& surface, std::span<const std::array<VertexId, 2>> segments,
                                 const Goals& goals, RunControl& control);

  /// Cells are not cut further where there would be more than these, and more than four a patch.
  static constexpr std::size_t kMaxSamples = std::size_t{1} << 19;

  /// Sizes are kept in single precision, so those of one gap differ in their last digits: by less than this part.
  static constexpr double kNoise = 0x1p-21;

  /// Is it the same everywhere? Then `largest()` is all there is to know.
  bool is_uniform() const { return samples_.size() == 0; }
  double largest() const { return largest_; }
  std::size_t sample_count() const { return samples_.size(); }
  /// No size is below this for the sake of a gap or a short edge; model units.
  double floor() const { return floor_; }
  /// Is the floor as high as it is for min_edge_length alone?
  bool is_floor_asked() const { return is_floor_asked_; }

  /// The size at a place, model units. May be called from any thread.
  double at(const Vec3& place) const;
  /// Is length <= at(place)? Several times faster, the clearer the answer the more. With a radius: is it so for all
  /// places that near? Then it may also say no where the answer is yes.
  bool allows(double length, const Vec3& place, double radius = 0) const;

 private:
  /// In local units, rounded down.
  struct Size {
    float value = HUGE_VALF;
    void join(Size other) { value = std::min(value, other.value); }
  };
  using Samples = BoxTree<Size>;
  using Segment = std::array<Vec3, 2>;
  /// What is in a box along the axes of a patch: a box along those of space is mostly air where it is askew.
  struct Cell {
    PatchId patch;
    FloatBox box;
  };
  struct Sample {
    Samples::Entry entry;
    Cell cell;
    Segment segment{};  ///< in a field of segments, instead
  };
  class Sampler;

  double size_from(const Samples::Entry& node, const Vec3& p, double radius = 0) const;
  double size_from(std::size_t slot, const Vec3& p, double radius = 0) const;
  void set_samples(std::span<const Sample> samples, RunControl& control);
  double distance(std::size_t slot, const Vec3& p) const;
  double farthest(std::size_t slot, std::size_t from) const;
  bool is_dominated(std::size_t slot) const;
  void drop_dominated(RunControl& control);
  Vec3 local(const Vec3& place) const { return (1 / unit_) * (place - centre_); }

  double largest_;
  double floor_ = 0;
  bool is_floor_asked_ = false;
  double slope_ = 0;
  Vec3 centre_;  ///< local units as in Surface
  double unit_ = 1;
  bool is_of_segments_ = false;
  Samples samples_;
  IdVector<PatchId, Axes> axes_;
  std::vector<Cell> cells_;        ///< by slot, in a field of gaps
  std::vector<Segment> segments_;  ///< by slot, in a field of segments
};

}  // namespace remesh
