/// Exact geometric predicates in the plane: a cheap filter first, then expansion arithmetic.
/// The coordinates' magnitudes must be 0 or within [2^-120, 2^120] (patch frames guarantee it), so that no product
/// under- or overflows.
/// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// Sign of the signed area of abc: > 0 counter-clockwise, < 0 clockwise, 0 exactly collinear.
int orient2d(Vec2 a, Vec2 b, Vec2 c);

/// Sign for counter-clockwise abc: > 0 if d is inside their circle, < 0 outside, 0 exactly cocircular.
/// It turns with the orientation of abc.
int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// in_circle with ties broken: never 0 for four distinct points of which a, b, c are counter-clockwise.
/// Of four cocircular points the lexicographically smallest is moved inwards by an infinitesimal, so that the
/// Delaunay diagonal is the one at that point: one answer for any order of input, and no cycling of flips.
int in_circle_perturbed(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

}  // namespace remesh
