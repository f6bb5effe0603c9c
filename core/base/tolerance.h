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

/// Largest automatic plane tolerance, of the diagonal. A model that was rounded more coarsely has details of the same
/// size as the rounding, and only its owner knows which are which: `rounding_capped` tells of it.
inline constexpr double kToleranceCeiling = 1e-4;

/// Above this, of the diagonal, a step counts as noise only if faces are seen to bend by it as rounding bends them (see
/// `is_noise_present`). Coordinates that are all multiples of 0.01 may be exact.
inline constexpr double kToleranceUnquestioned = 1e-6;

/// A face thinner than this many plane tolerances has no normal worth asking, and may be turned over in its plane.
inline constexpr double kThinFace = 2;

/// Neighbours that turn by no more against each other (1 less their normals' cosine: 1.4 milliradians) are never said
/// to bend beyond the digits they are printed with: many parts were computed with fewer. Smaller, and planar sides of
/// real parts fall apart; larger, and more facets of fine cylinders merge in pairs.
inline constexpr double kUnquestionedBend = 1e-6;

/// A step of the ladder tightens a patch's tolerance by this.
inline constexpr double kLadderFactor = 0.1;

/// The steps to which coordinates are rounded.
struct Rounding {
  Vec3 steps = {};           ///< of each coordinate where it is largest; 0: it is 0 everywhere
  Vec3 likely_steps = {};    ///< the same if they are proven; else what few numbers make likely; at least `steps`
  Vec3 possible_steps = {};  ///< the largest that the digits allow, proven or not; never less than `steps`
  bool is_decimal = false;   ///< `possible_steps` come from printing; else from floats or doubles, which arithmetic may
                             ///< have rounded many times

  /// One for the three coordinates: the root of the mean of the squares of `steps`.
  double step() const;
  double likely_step() const;
  double possible_step() const;
};

/// Reads from the values what they were rounded to: the largest power of ten (times a power of two) of which all are
/// multiples, if that leaves short numbers; where they are limited in significant digits, the last place of each
/// coordinate's largest number that shows more than half of them; the last place of its largest number as a float if
/// all are floats that use their last places, be they printed in decimals; else the last place of the largest number as
/// a double.
///
/// A decimal step needs evidence: exact dimensions are short decimals too, and few numbers share a step by chance. The
/// evidence is enough if numbers with a finer step would give it with a probability of at most 2^-18 (see kEvidence);
/// 33 independent values that were rounded nearly always do so. Without it the coordinates count as not rounded, which
/// is the answer for floats or doubles. Then `likely_steps` has the largest parts of the decimal steps that are too
/// coarse with a probability of at most 2^-12 (see kLikely): a box that was turned and printed has 12 or 24 numbers,
/// and they make all or a half of its step likely.
///
/// What is nearer to 0 than any tolerance counts as 0.
/// Holds:  depends only on the set of each coordinate's values, be they repeated or in another order. Scales with the
///         coordinates by powers of two. Never above the step of which all coordinates are multiples, or their place.
/// Cost:   O(n), in parallel.
/// Source: rules.md, Rounding steps.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
Rounding rounding_of(std::span<const Vec3> positions, RunControl& control);

/// The plane tolerances that a rounding explains in a mesh of that diagonal. Each takes the place of the one before if
/// faces are seen to bend by it.
///
/// Digits alone do not prove noise. A plate that is crowned by 0.01 bends by one step of its coordinates, and the crown
/// is meant. So it depends on the size of the step:
/// - What is smaller than kToleranceUnquestioned of the diagonal is never meant where the digits explain it. A cube
///   with a corner at 1.000001 is a cube. This needs no evidence that the coordinates are rounded, only that they allow
///   it.
/// - What is larger needs evidence twice: of many numbers, that the coordinates are rounded to the step at all; and of
///   several faces that bend, that they are rounded further than the model's own details are large.
struct AutomaticTolerance {
  double value = 0;        ///< without doubt
  double if_bent = 0;      ///< if a face bends by more than `value` and at most by this
  double if_noisy = 0;     ///< if faces bend as by noise (see `is_noise_present`)
  double explained = 0;    ///< by the possible step alone, however large
  bool is_capped = false;  ///< `explained` is above kToleranceCeiling
};
AutomaticTolerance automatic_tolerance(const Rounding& rounding, double diagonal);

}  // namespace remesh
