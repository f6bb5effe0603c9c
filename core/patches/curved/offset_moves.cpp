#include "core/patches/curved/offset_moves.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/surfaces/surface_offset.h"

namespace remesh {
namespace {

/// Planes whose unit normals differ by no more than this are the same up to rounding.
constexpr double kSamePlane = 1e-7;
/// Lines whose unit directions differ by no more than this are the same. The directions of short edges are not known
/// more exactly, and vertices move by less than the length of edges.
constexpr double kSameLine = 1e-4;

/// A surface does not move a vertex if the plane there leaves no more than this sine of the angle between plane and
/// surface: about 3 degrees.
constexpr double kMinFreeSine = 0.05;

/// Two surfaces that meet at a small angle, and move by different offsets, would move a vertex far along them. The
/// length of the vertex's way has this weight against the vertex's distances from the moved surfaces.
constexpr double kWeightOfLength = 0.05;

/// The directions in which a vertex may move: all, those in a plane, those along a line, or none.
struct Freedom {
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  std::size_t count = 3;

  Vec3 part(const Vec3& v) const {
    Vec3 sum;
    for (std::size_t i = 0; i < count; ++i) sum += dot(v, directions[i]) * directions[i];
    return sum;
  }
  void keep_to_line(const Vec3& line) {
    if (count == 1) {
      if (norm(cross(directions[0], line)) > kSameLine) count = 0;
    } else if (count > 1) {
      directions[0] = line;
      count = 1;
    }
  }
  void keep_to_plane(const Vec3& normal) {
    const Vec3 out = part(normal);
    if (!(norm(out) > (count == 1 ? kSameLine : kSamePlane))) return;
    const Vec3 unit = normalized(out);
    if (count == 1) {
      count = 0;
    } else if (count == 2) {
      const Vec3 axis = cross(directions[0], directions[1]);
      directions[0] = normalized(cross(axis, unit));
      count = 1;
    } else if (count == 3) {
      directions[0] = unit_across(unit);
      directions[1] = cross(unit, directions[0]);
      count = 2;
    }
  }
};

/// Solves a symmetric system of three equations with a positive determinant by Cramer's rule.
Vec3 solved(const std::array<Vec3, 3>& rows, const Vec3& right) {
  const Vec3 a = cross(rows[1], rows[2]), b = cross(rows[2], rows[0]), c = cross(rows[0], rows[1]);
  return (1 / dot(rows[0], a)) * (right.x * a + right.y * b + right.z * c);
}

}  // namespace

void add_offset_moves(const Vec3& at, const OffsetSite& site, const RecognisedSurfaces& surfaces,
                      std::vector<OffsetMove>& moves) {
  Freedom freedom;
  for (const Vec3& line : site.lines) freedom.keep_to_line(line);
  for (const Vec3& normal : site.planes) freedom.keep_to_plane(normal);
  const std::size_t first = moves.size();
  for (const SurfaceId s : site.surfaces) {
    const AnalyticSurface& shape = surfaces.surfaces[s].shape;
    const Vec3 free_part = freedom.part(shape.normal(at));
    if (norm(free_part) > kMinFreeSine && offset_lever(shape, at) > 0) moves.push_back({s, free_part});
  }
  // The way x makes the sum of the squares of (u x - offset), over the free parts u of the normals, plus the weighted
  // square of its length, as small as possible.
  std::array<Vec3, 3> rows{Vec3{kWeightOfLength, 0, 0}, Vec3{0, kWeightOfLength, 0}, Vec3{0, 0, kWeightOfLength}};
  for (std::size_t i = first; i < moves.size(); ++i) {
    const Vec3& u = moves[i].way;
    for (int k = 0; k < 3; ++k) rows[static_cast<std::size_t>(k)] += u[k] * u;
  }
  for (std::size_t i = first; i < moves.size(); ++i) {
    const double lever = offset_lever(surfaces.surfaces[moves[i].surface].shape, at);
    // The factor makes the way exact if there is one surface alone. All free parts stay in the free directions.
    moves[i].way = freedom.part((1 + kWeightOfLength) * lever * solved(rows, moves[i].way));
  }
}

std::size_t OffsetMoves::find(VertexId v) const {
  const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), v);
  return found != vertices_.end() && *found == v ? static_cast<std::size_t>(found - vertices_.begin()) : size();
}

}  // namespace remesh
