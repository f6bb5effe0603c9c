/// Holds a claimed surface against the true one, by what the claim tells of itself.
#pragma once

#include <cstddef>
#include <span>

#include "tests/support/plain_surfaces.h"

namespace remesh::recognition {

/// Returns how far corners may be from the surface by what the record tells.
double told_deviation(const RecognisedSurface& record);

/// The evidence of a true surface: what corners and facets there are to recognise it by.
struct Evidence {
  std::size_t facets = 0;
  std::size_t corners = 0;  ///< different ones
  double deviation = 0;     ///< how far corners are from the surface
  /// At least eight facets, twice as many corners as the kind has parameters, and a rise over the whole arc of at
  /// least 8 deviations.
  bool is_enough(const test::PlainSurface& truth, std::span<const Vec3> points) const;
};

/// Returns the smallest height that an arc of the surface rises over its chord. It is infinite for a plane.
double least_rise(const test::PlainSurface& surface, std::span<const Vec3> points);

/// True if the kind is right and each radius is within 1e-3 of its own length, or within `deviation` over the rise of
/// its arc if that is more. For a cone the difference of radii is that over the length of its rulings.
/// Input: `points` - corners of the faces that are claimed.
bool is_right_claim(const test::PlainSurface& claim, const test::PlainSurface& truth, std::span<const Vec3> points,
                    double deviation);

}  // namespace remesh::recognition
