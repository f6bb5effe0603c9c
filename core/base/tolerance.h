/// Every tolerance of the pipeline, with its purpose and what breaks when it changes.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Smallest plane tolerance, relative to the bounding box's diagonal. It leaves room for the rounding of full doubles.
/// If it were smaller, rotated planes would fall apart; if it were larger, facets of fine cylinders would merge.
inline constexpr double kToleranceFloor = 1e-9;

/// Plane tolerance in rounding steps. Rounding moves a coordinate by half a step; there are three coordinates in space,
/// which gives a factor of sqrt(3); and a plane through noisy points adds a factor of 3.
inline constexpr double kToleranceSteps = 2.6;

/// Corners of facets may be this many automatic plane tolerances away from the surface from which they were made. That
/// is about ten rounding steps: programs compute points of curves between two surfaces less exactly than they round.
inline constexpr double kRecognitionTolerance = 3.8;

/// Corners of facets may be this many printed steps away where the facets' chord height is much larger. Rounding moves
/// a point by at most 0.87 steps, and a surface that is fitted to such points is off by a part of that.
inline constexpr double kPrintedSteps = 1.2;

/// Largest plane tolerance, relative to the diagonal, that digits explain without proof when surfaces are recognised.
/// Six digits explain as much.
inline constexpr double kPossibleRounding = 2.6e-6;

/// Largest automatic plane tolerance, relative to the diagonal. If a model was rounded more coarsely, its details are
/// as small as the rounding, and only the user can distinguish them. The diagnostic `rounding_capped` reports this.
inline constexpr double kToleranceCeiling = 1e-4;

/// A step above this, relative to the diagonal, counts as noise only if faces are seen to bend by it as rounding bends
/// them (see `is_noise_present`). Coordinates that are all multiples of 0.01 may be exact.
inline constexpr double kToleranceUnquestioned = 1e-6;

/// A face thinner than this many plane tolerances has no meaningful normal, and may be turned over in its plane.
inline constexpr double kThinFace = 2;

/// Neighbours that turn against each other by no more than this never count as bent beyond the digits that they are
/// printed with, because many models were computed with fewer digits. It is 1 minus the cosine of the angle between
/// their normals, and stands for 1.4 milliradians. If it were smaller, planar sides of real models would fall apart; if
/// it were larger, more facets of fine cylinders would merge in pairs.
inline constexpr double kUnquestionedBend = 1e-6;

/// Each step of the ladder multiplies a patch's tolerance by this.
inline constexpr double kLadderFactor = 0.1;

/// The steps to which coordinates are rounded.
struct Rounding {
  Vec3 steps = {};           ///< the step of each coordinate where it is largest; 0 if the coordinate is 0 everywhere
  Vec3 likely_steps = {};    ///< `steps` if they are proven; otherwise the steps that few numbers make likely; at least
                             ///< `steps`
  Vec3 possible_steps = {};  ///< the largest steps that the digits allow, proven or not; at least `steps`
  /// True if `possible_steps` come from printing. Otherwise they come from floats or doubles, which arithmetic may have
  /// rounded many times.
  bool is_decimal = false;
  /// The steps that a limited number of significant digits would explain, even where too few numbers tell whether
  /// digits were limited at all; at least `possible_steps`.
  Vec3 doubtful_steps = {};

  /// One length for the three coordinates: the root of the mean of the squares of `steps`.
  double step() const;
  double likely_step() const;
  double possible_step() const;
  double doubtful_step() const;
};

/// Determines from the values the steps to which they were rounded. The answer is one of these:
/// - the largest power of ten, times a power of two, of which all values are multiples, if that leaves short numbers;
/// - if the number of significant digits is limited, for each coordinate the last place of its largest number that
///   shows more than half of them;
/// - if all values are floats that use their last places, even if these are printed in decimals, for each coordinate
///   the last place of its largest number as a float;
/// - otherwise the last place of the largest number as a double.
///
/// A decimal step needs evidence, because exact dimensions are short decimals too, and few numbers share a step by
/// chance. The evidence suffices if numbers with a finer step would give it with a probability of at most 2^-18 (see
/// kEvidence). 33 independent values that were rounded nearly always suffice. Without evidence, the coordinates count
/// as not rounded, and the answer is that for floats or doubles. Then `likely_steps` has the largest fractions of the
/// decimal steps that are too coarse with a probability of at most 2^-12 (see kLikely). For example, a box that was
/// turned and printed has 12 or 24 numbers, which make its whole step or half of it likely.
///
/// Values nearer to 0 than any tolerance count as 0.
/// Holds:  the result depends only on the set of each coordinate's values, not on their order or on repetitions. It
///         scales with the coordinates by powers of two. It is never above the step of which all coordinates are
///         multiples, or above their place.
/// Cost:   O(n), in parallel.
/// Source: rules.md, Rounding steps.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
Rounding rounding_of(std::span<const Vec3> positions, RunControl& control);

/// The plane tolerances that a rounding explains in a mesh with a given diagonal. Each takes the place of the one
/// before it if faces are seen to bend by it.
///
/// Digits alone do not prove noise. A plate that is crowned by 0.01 bends by one step of its coordinates, and the crown
/// is meant. So the size of the step decides:
/// - A bend below kToleranceUnquestioned of the diagonal is never meant if the digits explain it. A cube with a corner
///   at 1.000001 is a cube. This needs no evidence that the coordinates are rounded, only that the digits allow it.
/// - A larger bend needs evidence twice. Many numbers must show that the coordinates are rounded to the step at all.
///   Several faces that bend must show that the rounding is coarser than the model's own details.
struct AutomaticTolerance {
  double value = 0;        ///< the tolerance that applies without doubt
  double if_bent = 0;      ///< applies if a face bends by more than `value` and at most by this
  double if_noisy = 0;     ///< applies if faces bend as by noise (see `is_noise_present`)
  double explained = 0;    ///< the tolerance that follows from the possible step alone, however large
  bool is_capped = false;  ///< `explained` is above kToleranceCeiling
};
AutomaticTolerance automatic_tolerance(const Rounding& rounding, double diagonal);

}  // namespace remesh
