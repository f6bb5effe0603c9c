/// Puts drawn solids together from rings of vertices and the strips and caps between them.
#pragma once

#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/recognition/drawn_solid.h"
#include "tests/support/random.h"

namespace remesh::recognition {

/// Facets that turn by more than the default feature angle are no pieces of one surface. This is a little less.
constexpr double kFeatureTurn = 29.9 * std::numbers::pi / 180;
/// The name of a surface whose facets turn by more. Nobody expects that one to be found.
std::string coarse_name(const std::string& name);

using VertexRing = std::vector<std::uint32_t>;

/// A piece of a profile, which is drawn in (distance from the axis, height). Outside lies to the right of the way along
/// the profile.
struct ProfilePiece {
  std::function<Vec2(double)> at;  ///< from 0 to 1
  int rows = 1;
  test::PlainSurface surface;  ///< around the axis z
  test::PlainSurface also;     ///< see DrawnSolid
  std::string name;
  double chord = 0;     ///< the height of the chords along the profile
  double row_turn = 0;  ///< the angle by which one row turns to the next, in radians
};

/// Returns a piece of a plane, a cylinder or a cone.
ProfilePiece line_piece(Vec2 from, Vec2 to, const std::string& name, int rows = 1);
/// Returns a piece of a sphere or a torus. Angles are in radians, from the direction away from the axis.
ProfilePiece arc_piece(Vec2 centre, double radius, double from, double to, int rows, const std::string& name);

/// A section that is turned around the axis: it gives the direction of each angle, of a length of about 1.
using Section = std::function<Vec2(double)>;

class DrawnBody {
 public:
  DrawnBody(Random& random, bool is_sloppy) : random_(random), is_sloppy_(is_sloppy) {}

  std::uint32_t surface(const test::PlainSurface& s, const std::string& name, double chord = 0,
                        const test::PlainSurface& also = {});
  std::uint32_t vertex(const Vec3& p);
  const Vec3& position(std::uint32_t v) const { return positions_[v]; }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t surface,
                const std::vector<Vec3>& true_points = {});

  /// Turns a profile around the direction z through `centre`, with `n` facets a turn, into rings and strips. Pieces of
  /// planes that reach the axis become discs. Without a section it is a circle.
  /// Input:  `is_closed` - the profile ends where it begins, like that of a ring.
  /// Output: the first and the last ring.
  std::pair<VertexRing, VertexRing> turn(int n, const std::vector<ProfilePiece>& drawn, Vec2 centre = {},
                                         const Section& section = {}, bool is_closed = false);
  /// Adds a surface by its points: ring k of `count` rings has the points at (i, k) for i from 0 to n - 1.
  /// Output: the first and the last ring. They are the same one if `is_closed`.
  std::pair<VertexRing, VertexRing> sweep(int n, int count, const std::function<Vec3(double, double)>& at,
                                          std::uint32_t surface, bool is_closed = false);
  /// Adds a plane across z between rings that are counter-clockwise from above, by a Delaunay triangulation.
  void plane(const VertexRing& outer, const std::vector<VertexRing>& holes, bool is_upward);
  /// Adds a flat convex cap as a fan or a zigzag. The ring is counter-clockwise from outside.
  void cap(const VertexRing& ring);

  /// Puts the solid somewhere, and rounds it by `round`.
  DrawnSolid take(const std::string& part, const std::function<Vec3(const Vec3&)>& turned, const Vec3& by,
                  const std::function<double(double)>& round);

 private:
  Random& random_;
  bool is_sloppy_;
  std::vector<Vec3> positions_;
  std::vector<std::array<std::uint32_t, 3>> faces_;
  DrawnSolid solid_;
};

}  // namespace remesh::recognition
