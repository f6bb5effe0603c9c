/// Divides chains that are known to run along a curve with a formula.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/geometry/surfaces/section_curve.h"

namespace remesh {

/// A surface beside a chain, and the max distance of the middles of new pieces from it, in model units.
struct DepthLimit {
  const AnalyticSurface* surface = nullptr;
  double max_depth = 0;
};

/// The max distance of a chain's new pieces from the input, and the max turn of a piece.
struct ChainLimits {
  double tolerance = 0;  ///< in model units
  double max_turn = 0;   ///< in radians
  std::vector<DepthLimit> depths = {};
  double min_pieces = 1;  ///< there are at least this many pieces, or as many as in the input if that is less
};

/// The tolerance at the nodes of a chain and in the middles of its pieces. It is smaller where another boundary is
/// near.
struct ChainRoom {
  std::vector<double> at_node;    ///< one per node; those of the ends have no meaning
  std::vector<double> in_middle;  ///< one per piece of the input
  bool is_limited = false;        ///< some values are less than the limit that was asked for
};

/// Returns the limit of turns to be used. If `max_turn` forbids hardly any turn, the limit is a sixth of a circle, so
/// that shapes do not vanish in a large tolerance.
double turn_limit(double max_turn);

/// A chain along a section curve. The angles of its nodes about the curve's axis tell where they are on it.
class SectionChain {
 public:
  /// Returns the chain, or nothing if its points do not run along the curve in one direction or run more than once
  /// around it.
  /// Input: the points of the nodes; the last one equals the first one if the chain is closed. They outlive the result.
  static std::optional<SectionChain> along(const SectionCurve& curve, std::span<const Vec3> points);

  /// Returns the largest angle by which a piece of the input turns.
  double largest_turn() const;
  /// Returns the place of the curve at a part of the way, between 0 and 1.
  Vec3 place(double part) const { return curve_.point(sign_ * total_ * part); }
  /// Returns the place of the curve in the middle of a piece of the input.
  Vec3 middle(std::size_t piece) const { return place((angles_[piece] + angles_[piece + 1]) / (2 * total_)); }

  /// The outcome of a division: everything stays, or there are new points or fewer nodes between the ends.
  struct Division {
    bool is_changed = false;
    bool is_limited = false;  ///< there are more pieces than without `room` and without `min_pieces`
    std::vector<std::uint32_t> kept;
    std::vector<Vec3> points;
  };
  /// Divides the chain into equal pieces.
  /// Input:  `room(limit)` returns the room along the chain, cut off at `limit`. It is called only if the chain would
  ///         change. Nodes within the fit tolerance of a new point take its place, if all new points have one.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  Division divide(const ChainLimits& limits, double fit_tolerance, const std::function<ChainRoom(double)>& room,
                  const RunControl& control) const;

 private:
  explicit SectionChain(const SectionCurve& curve, std::span<const Vec3> points) : curve_(curve), points_(points) {}

  struct Misfit {
    double by_length = 0;       ///< max ratio of a distance to its limit, of distances that shrink with the pieces
    double largest = 0;         ///< largest of all distances
    bool is_off_input = false;  ///< some new point is too far from the input, whatever the number of pieces
  };

  std::size_t piece_count() const { return points_.size() - 1; }
  bool is_closed() const { return points_.front() == points_.back(); }
  std::vector<Vec3> divided(std::size_t pieces) const;
  Misfit misfit(std::span<const Vec3> division, const ChainLimits& limits, const ChainRoom* room,
                const RunControl& control) const;
  double largest_height() const;
  bool are_pieces_even(std::span<const Vec3> division, double fit_tolerance) const;
  void take(std::span<const Vec3> division, double fit_tolerance, Division& result) const;
  std::vector<std::uint32_t> nodes_at(std::span<const Vec3> division, double fit_tolerance) const;

  SectionCurve curve_;
  std::span<const Vec3> points_;
  std::vector<double> angles_;  ///< one angle per point, from 0 to `total_`
  double sign_ = 1;             ///< the direction of the chain about the axis
  double total_ = 0;
};

}  // namespace remesh
