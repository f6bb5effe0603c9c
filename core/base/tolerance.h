/// Every tolerance of the pipeline, with its purpose and what breaks when it changes.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Least plane tolerance, of the bounding box's diagonal: room for the rounding of full doubles. Smaller, and rotated
/// planes fall apart; larger, and facets of fine cylinders merge.
inline constexpr double kToleranceFloor = 1e-9;

/// Plane tolerance in rounding steps: half a step a coordinate, sqrt(3) in space, 3 for what a plane through noisy
/// points adds.
inline constexpr double kToleranceSteps = 2.6;

/// Largest automatic plane tolerance, of the diagonal. Coordinates that are all whole numbers have a step of 1, but are
/// rarely rounded to it: a cube of corners 0 and 1 must not become flat.
inline constexpr double kToleranceCeiling = 1e-4;

/// Above this, of the diagonal, a step counts as noise only if faces are seen to bend by it (see `is_noise_present`).
inline constexpr double kToleranceUnquestioned = 1e-6;

/// A face thinner than this many plane tolerances has no normal worth asking, and may be turned over in its plane.
inline constexpr double kThinFace = 2;

/// Neighbours that turn by no more against each other (1 less their normals' cosine: 1.4 milliradians) are never said
/// to bend beyond the digits they are printed with: many parts were computed with fewer. Smaller, and planar sides of
/// real parts fall apart; larger, and more facets of fine cylinders merge in pairs.
inline constexpr double kUnquestionedBend = 1e-6;

/// A step of the ladder tightens a patch's tolerance by this.
inline constexpr double kLadderFactor = 0.1;

/// What coordinates are rounded to.
struct Rounding {
  Vec3 steps = {};          ///< of each coordinate where it is largest; 0: it is 0 everywhere
  bool is_decimal = false;  ///< by printing; else as floats or doubles, which arithmetic may have rounded many times

  /// Of the three together: the root of the mean of their squares.
  double step() const;
};

/// Read from the values: the largest power of ten (times a power of two) of which all are multiples, if that leaves
/// short numbers; where they are limited in significant digits, the last place of each coordinate's largest number that
/// shows them; that of its largest as a float if all are floats, be they printed in decimals; else as a double. What is
/// nearer to 0 than any tolerance counts as 0.
/// Holds:  scales with the coordinates by powers of two.
/// Source: REFINEMENT, rule 12, carried from decimals to decimals times powers of two, so that scaling by two keeps it.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
Rounding rounding_of(std::span<const Vec3> positions, RunControl& control);

/// The plane tolerance that a step explains in a mesh of that diagonal.
struct AutomaticTolerance {
  double value = 0;     ///< without doubt
  double if_noisy = 0;  ///< where faces are seen to bend by it; never less than `value`
};
AutomaticTolerance automatic_tolerance(double step, double diagonal);

}  // namespace remesh
