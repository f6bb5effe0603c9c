/// Closed solids of triangles, drawn at random, of which every face knows the surface that it was made from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/primitives.h"

namespace remesh::recognition {

/// A solid as a program would export it: turned, moved, its coordinates rounded.
struct DrawnSolid {
  std::string part;      ///< what is drawn, such as "dome"
  std::string rounding;  ///< how its coordinates are written, such as "4 decimals"
  primitives::Model model;
  /// By surface of the model, what it is of the part, such as "bore" or "ellipse". It is "plane" for planes.
  std::vector<std::string> names;
  /// By surface, another one that may be claimed as well, or one of kind kFree: rows that turn by more than the feature
  /// angle are cones, but all of them together may lie on the sphere or the torus from which they were made.
  std::vector<test::PlainSurface> also;
  /// By surface, the greatest distance of its facets from it, if corners were on it. It is 0 for planes.
  std::vector<double> chord;
  /// By face, points of the true surface above or below the face. It is empty for faces of planes.
  IdVector<FaceId, std::vector<Vec3>> true_points;
  double step = 0;  ///< the step to which coordinates are rounded
  double off = 0;   ///< how far corners were put off the surface before they were rounded
};

/// Draws a solid with curved surfaces of many kinds, and with surfaces that are nearly one.
/// Input: the same seed and number give the same solid.
DrawnSolid drawn_solid(std::uint64_t seed, std::uint64_t number);

/// Draws a part with one cylinder: a bore, a rounded corner or a fillet. Coordinates are rounded to steps of 1e-6 to
/// 4e-5 of the diagonal, which moves them by up to 2e-5 of the diagonal. The chord height is at least 4 steps, and the
/// arc has at least 6 facets.
DrawnSolid drawn_bore(std::uint64_t seed, std::uint64_t number);

/// Writes the solid as PATH.obj, and what is true of it as PATH.truth.tsv: one row for each face.
void write_solid(const DrawnSolid& solid, const std::string& path);

}  // namespace remesh::recognition
