#include "core/io/common/enclosed_volumes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/shells/shell_nesting.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

/// A line through a point along an axis.
class AxialLine {
 public:
  AxialLine(const Vec3& point, int axis) : point_(point), axis_(axis) {}

  /// The coordinate on the axis at which the line meets a triangle.
  /// Output: infinity if it passes the triangle, or runs within its plane.
  double meets(const Vec3& a, const Vec3& b, const Vec3& c) const {
    const Vec2 p = flat(point_), q = flat(a), r = flat(b), s = flat(c);
    const int at_a = orient2d(r, s, p), at_b = orient2d(s, q, p), at_c = orient2d(q, r, p);
    const bool is_within = (at_a >= 0 && at_b >= 0 && at_c >= 0) || (at_a <= 0 && at_b <= 0 && at_c <= 0);
    const double area = cross2(r - q, s - q);
    if (!is_within || area == 0) return HUGE_VAL;
    return (cross2(r - p, s - p) * a[axis_] + cross2(s - p, q - p) * b[axis_] + cross2(q - p, r - p) * c[axis_]) / area;
  }

 private:
  Vec2 flat(const Vec3& v) const { return {v[(axis_ + 1) % 3], v[(axis_ + 2) % 3]}; }
  static double cross2(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

  Vec3 point_;
  int axis_;
};

/// The largest face of each shell.
/// Input: positions whose products do not overflow.
std::vector<FaceId> largest_faces(const TriangleMesh& mesh, std::span<const Vec3> scaled, const Shells& shells,
                                  RunControl& control) {
  std::vector<FaceId> largest(shells.all.size());
  std::vector<double> area(shells.all.size(), -1);
  StopCheck check(control);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    check();
    const auto& [a, b, c] = mesh.faces[FaceId(f)];
    const Vec3& p = scaled[a.value];
    const double own = norm(cross(scaled[b.value] - p, scaled[c.value] - p));
    const std::uint32_t shell = shells.of_face[f];
    if (!(own > area[shell])) continue;
    area[shell] = own;
    largest[shell] = FaceId(f);
  }
  return largest;
}

/// By axis, what a coordinate has to be multiplied by to undo the scaling of scaled_for_predicates, a power of two.
Vec3 unit_of_scaled(std::span<const Vec3> positions, std::span<const Vec3> scaled, RunControl& control) {
  Vec3 unit{1, 1, 1}, largest;
  StopCheck check(control);
  for (std::size_t v = 0; v < scaled.size(); ++v) {
    check();
    for (int axis = 0; axis < 3; ++axis)
      if (std::fabs(scaled[v][axis]) > largest[axis]) {
        largest[axis] = std::fabs(scaled[v][axis]);
        unit[axis] = positions[v][axis] / scaled[v][axis];
      }
  }
  return unit;
}

}  // namespace

EnclosedVolumes enclosed_volumes(const TriangleMesh& mesh, RunControl& control) {
  EnclosedVolumes volumes;
  const std::span<const Triangle> faces = mesh.faces.items();
  const std::span<const VertexId> corners = corners_of(faces);
  const std::vector<Vec3> scaled = scaled_for_predicates(mesh.positions.items(), control);
  const Adjacency edges(scaled.size(), triangle_begins(faces.size(), control), corners, control);
  volumes.shells = find_shells(scaled, corners, edges, {}, control);
  const Shells& shells = volumes.shells;
  const ShellNesting nesting(scaled, corners, shells, control);
  const std::vector<ShellNesting::Nest>& nests = nesting.nests();
  std::vector<std::uint32_t> volume_of_nest(nests.size(), kNone);
  volumes.is_complete = nests.size() == shells.all.size();
  StopCheck check(control);
  for (std::size_t n = 0; n < nests.size(); ++n) {
    check();
    const ShellNesting::Nest& nest = nests[n];
    const std::uint32_t shell = nest.shells.front();
    const std::uint32_t around = nest.around == kNone ? kNone : volume_of_nest[nest.around];
    const bool is_certain = nest.shells.size() == 1 && !shells.all[shell].has_open_neighbours &&
                            (nest.around == kNone || around != kNone) && !nesting.is_place_in_doubt(shell);
    volumes.is_complete = volumes.is_complete && is_certain;
    if (!is_certain) continue;
    if (around != kNone) volumes.all[around].shells_within.push_back(shell);
    volume_of_nest[n] = static_cast<std::uint32_t>(volumes.all.size());
    volumes.all.push_back({shell, shells.all[shell].volume > 0 || around == kNone, {}});
  }
  return volumes;
}

std::vector<Vec3> points_inside(const TriangleMesh& mesh, const EnclosedVolumes& volumes, RunControl& control) {
  std::vector<Vec3> points;
  if (volumes.all.empty()) return points;
  const std::vector<Vec3> scaled = scaled_for_predicates(mesh.positions.items(), control);
  const Vec3 unit = unit_of_scaled(mesh.positions.items(), scaled, control);
  const TriangleTree tree(scaled, mesh.faces.items(), control);
  const std::vector<FaceId> largest = largest_faces(mesh, scaled, volumes.shells, control);
  StopCheck check(control);
  for (const EnclosedVolume& volume : volumes.all) {
    const FaceId start = largest[volume.shell];
    const auto corner = [&](FaceId f, int i) { return mesh.positions[mesh.faces[f][i]]; };
    const auto scaled_corner = [&](FaceId f, int i) { return scaled[mesh.faces[f][i].value]; };
    const auto middle = [&](const auto& at) {
      return (1.0 / 3) * at(start, 0) + (1.0 / 3) * at(start, 1) + (1.0 / 3) * at(start, 2);
    };
    // The axis on which the face looks most, and the side of the face on which the volume is.
    const Vec3 normal = normalized(
        cross(scaled_corner(start, 1) - scaled_corner(start, 0), scaled_corner(start, 2) - scaled_corner(start, 0)));
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::fabs(normal[i]) > std::fabs(normal[axis])) axis = i;
    const bool is_upwards = (normal[axis] > 0) == (volumes.shells.all[volume.shell].volume < 0);
    const double side = is_upwards ? 1 : -1;

    const Vec3 from = middle(scaled_corner);
    Box3 line{from, from};
    (is_upwards ? line.max : line.min)[axis] = side * HUGE_VAL;
    const AxialLine scaled_line(from, axis);
    double nearest = HUGE_VAL;
    tree.visit_meeting(line, 0, [&](std::size_t slot) {
      check();
      const FaceId f = tree.face(slot);
      const double at = scaled_line.meets(scaled_corner(f, 0), scaled_corner(f, 1), scaled_corner(f, 2));
      const double distance = side * (at - from[axis]);
      if (f != start && distance > 0) nearest = std::min(nearest, distance);
      return true;
    });
    Vec3 point = middle(corner);
    if (std::isfinite(nearest)) point[axis] += side * unit[axis] * (0.5 * nearest);
    points.push_back(point);
  }
  return points;
}

}  // namespace remesh
