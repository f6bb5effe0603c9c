/// A piece of a face: a convex polygon that is cut by lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/vec.h"
#include "core/geometry/triangles/distances.h"

namespace remesh::verification {

/// A convex piece of a face. Its exact shape is a polygon in the face's plane, and each exact corner is within
/// `rounding()` of a stored one, in the same order around the polygon. Exact corners that follow each other may share a
/// stored corner, so that no two stored corners in a row are equal, and a piece may have two corners, or one.
struct FacePiece {
  static constexpr std::size_t kMaxCorners = 8;
  /// A bound on the rounding of the places of new corners, for each cut that a piece comes from. A new corner is
  /// p + t (q - p) with stored corners p and q and the stored number t, 0 <= t <= 1. As p and q are within some
  /// distance of their exact places, so is the exact p + t (q - p) of its exact place. With u = 2^-53, computing it
  /// errs in each coordinate by 2 u in q - p, by 2 u in the product, and by u in the sum. This is less than 9 u in
  /// space.
  static constexpr double kRoundingOfCut = 0x1p-49;

  std::array<Vec3, kMaxCorners> corners;
  std::uint32_t count = 0;
  std::uint32_t cuts = 0;    ///< the number of cuts one after the other that the piece comes from
  std::uint32_t target = 0;  ///< the face of the other surface from which the distance is measured

  double rounding() const { return cuts * kRoundingOfCut; }
  void add(const Vec3& p) {
    if (count == 0 || p != corners[count - 1]) corners[count++] = p;
  }
  /// Ends the outline, after the last corner was added.
  void close() {
    while (count > 1 && corners[count - 1] == corners[0]) --count;
  }
  std::uint32_t after(std::uint32_t i) const { return i + 1 == count ? 0 : i + 1; }
  std::uint32_t before(std::uint32_t i) const { return i == 0 ? count - 1 : i - 1; }
  Vec3 middle() const {
    Vec3 sum;
    for (std::uint32_t i = 0; i < count; ++i) sum += corners[i];
    return (1.0 / count) * sum;
  }
  std::uint32_t longest_side() const {
    std::uint32_t longest = 0;
    double squared = -1;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double d = norm_squared(corners[after(i)] - corners[i]);
      if (d > squared) {
        squared = d;
        longest = i;
      }
    }
    return longest;
  }
};

inline FacePiece whole_face(const Corners3& corners, std::uint32_t target) {
  FacePiece piece;
  for (const Vec3& p : corners) piece.add(p);
  piece.close();
  piece.target = target;
  return piece;
}

/// Cuts a piece by the straight line between two places on its outline.
/// Input:   the first place is on the side from corner i to the next one, at the share s of it, and the second one on
///          the side from corner j, at t. The shares are within [0, 1], and i < j. The piece has at least two corners,
///          and fewer than kMaxCorners if a new one is made.
/// Output:  the part from corner i + 1 to corner j, and the other one. Where a share is 0 or 1, the place is a corner,
///          and both parts have it.
/// Holds:   together the exact parts are the exact piece, since a line between two places on the outline of a convex
///          polygon cuts it into two convex polygons.
struct CutPiece {
  FacePiece inner, outer;
};
inline CutPiece cut_piece(const FacePiece& piece, std::uint32_t i, double s, std::uint32_t j, double t) {
  const auto place = [&](std::uint32_t side, double share) {
    const Vec3 &p = piece.corners[side], &q = piece.corners[piece.after(side)];
    return share <= 0 ? p : share >= 1 ? q : p + share * (q - p);
  };
  const Vec3 x = place(i, s), y = place(j, t);
  CutPiece parts;
  parts.inner.cuts = parts.outer.cuts = piece.cuts + 1;
  parts.inner.target = parts.outer.target = piece.target;
  if (s < 1) parts.inner.add(x);
  for (std::uint32_t k = i + 1; k <= j; ++k) parts.inner.add(piece.corners[k]);
  if (t > 0) parts.inner.add(y);
  if (t < 1) parts.outer.add(y);
  for (std::uint32_t k = j + 1; k < piece.count; ++k) parts.outer.add(piece.corners[k]);
  for (std::uint32_t k = 0; k <= i; ++k) parts.outer.add(piece.corners[k]);
  if (s > 0) parts.outer.add(x);
  parts.inner.close();
  parts.outer.close();
  return parts;
}

/// Cuts a piece in two at the middle of its longest side, or between two corners if it has as many as it may have.
inline CutPiece halve_piece(const FacePiece& piece) {
  const std::uint32_t n = piece.count;
  if (n == FacePiece::kMaxCorners) return cut_piece(piece, 0, 0, n / 2, 0);
  if (n == 2) return cut_piece(piece, 0, 0.5, 1, 0.5);
  const std::uint32_t side = piece.longest_side();
  const Vec3 middle = 0.5 * (piece.corners[side] + piece.corners[piece.after(side)]);
  std::uint32_t farthest = piece.after(piece.after(side));
  for (std::uint32_t k = 0; k < n; ++k)
    if (k != side && k != piece.after(side) &&
        norm_squared(piece.corners[k] - middle) > norm_squared(piece.corners[farthest] - middle))
      farthest = k;
  return side < farthest ? cut_piece(piece, side, 0.5, farthest, 0) : cut_piece(piece, farthest, 0, side, 0.5);
}

}  // namespace remesh::verification
