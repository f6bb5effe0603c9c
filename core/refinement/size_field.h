/// The longest edge that is allowed at each place of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"
#include "core/refinement/box_tree.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goals.h"

namespace remesh {

/// The least, over samples, of the sample's size plus the slope times the distance from it. A sample is a box in space,
/// so sizes also grade from patch to patch.
/// Holds:  at(x) <= goals.max_edge_length; |at(x) - at(y)| <= slope |x - y|, where slope = gradation - 1 (two edges of
///         lengths h and gradation h that meet: their sizes are read one h apart); it reads the input, never the
///         growing mesh; scales with it by powers of two, exactly; the same for any number of threads.
/// Cost:   at() is O(log n) as long as sizes vary slowly; constant where there is no proximity and no gradation.
///         Memory: some 50 bytes a sample, at most kMostSamples and four a segment.
class SizeField {
 public:
  /// Where an answer came from: a place near the last one is answered faster with it, and not otherwise.
  struct Hint {
    std::uint32_t slot = 0;
  };

  /// The same size everywhere.
  explicit SizeField(double size = std::numeric_limits<double>::infinity()) : largest_(size) {}

  /// With goals.proximity > 0: size = max(gap / proximity, floor), floor = max(goals.min_edge_length, 2^-12 of the
  /// box's diagonal, 10 plane tolerances). Each patch is cut into cells until a cell reaches from its middle at most
  /// half the gap there; it is all given the size of its middle. So at() is never more than the size at a cell's
  /// middle, and at most twice that of any other place (if the gap shrinks as fast as one can come nearer); across a
  /// wall or a slot of one width it is exact. A joined patch (see GapSearch) that counts only in a small part of a cell
  /// may be missed. With goals.gradation > 0: a segment between essential vertices is as long as the edges on it can
  /// be, and so are samples of that size, though none under the floor. Input:  `gaps`: with proximity, null else;
  /// `segments` as pairs of essential vertices; the tolerance in model units.
  SizeField(const Surface& surface, const GapSearch* gaps, std::span<const std::array<VertexId, 2>> segments,
            const Goals& goals, double plane_tolerance, RunControl& control);

  /// More cells than this are not cut further.
  static constexpr std::size_t kMostSamples = std::size_t{1} << 22;

  /// Is it the same everywhere? Then `largest()` is all there is to know.
  bool is_uniform() const { return samples_.size() == 0; }
  double largest() const { return largest_; }
  std::size_t sample_count() const { return samples_.size(); }

  /// The size at a place, model units. May be called from any thread, each with its own hint.
  double at(const Vec3& place) const {
    Hint hint;
    return at(place, hint);
  }
  double at(const Vec3& place, Hint& hint) const;

 private:
  /// In local units, rounded down.
  struct Size {
    float value = HUGE_VALF;
    void join(Size other) { value = std::min(value, other.value); }
  };
  using Samples = BoxTree<Size>;
  class Sampler;

  double value(const Samples::Entry& sample, const Vec3& p) const;

  double largest_;
  double slope_ = 0;
  Vec3 centre_;  ///< local units as in Surface
  double unit_ = 1;
  Samples samples_;
};

}  // namespace remesh
