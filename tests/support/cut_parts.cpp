#include "tests/support/cut_parts.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

#include "tests/support/curved_place.h"
#include "tests/support/stage_chain.h"

namespace remesh::cut_parts {
namespace {

AnalyticSurface shape_of(const test::PlainSurface& s) {
  AnalyticSurface shape;
  shape.kind = s.kind;
  shape.origin = s.point;
  shape.axis = normalized(s.axis);
  shape.radius = s.radius;
  shape.minor_radius = s.tube;
  shape.half_angle = s.half_deg * kPi / 180;
  return shape;
}
/// Returns the largest distance of points of one closed polyline from another, found by trying many.
double farthest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    for (int k = 0; k < 16; ++k) {
      const Vec3 p = from[i] + (k / 16.0) * (from[(i + 1) % from.size()] - from[i]);
      double nearest = HUGE_VAL;
      for (std::size_t j = 0; j < to.size(); ++j)
        nearest = std::min(nearest, to_segment(p, to[j], to[(j + 1) % to.size()]));
      largest = std::max(largest, nearest);
    }
  return largest;
}

}  // namespace

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp(dot(p - a, b - a) / norm_squared(b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}

Part part_of(const primitives::Model& model) {
  Part part{with_groups(model.mesh, model.surface_of.items()), {}};
  for (const test::PlainSurface& s : model.surfaces) part.shapes.push_back(shape_of(s));
  return part;
}

Part with_halves(Part part, std::uint32_t group, const std::function<bool(const Vec3&)>& is_second) {
  auto groups = part.mesh.labels.group.of_face.items();
  for (std::size_t f = 0; f < part.mesh.face_count(); ++f) {
    const auto face = part.mesh.face(FaceId(f));
    Vec3 sum;
    for (const VertexId v : face) sum += part.mesh.positions[v];
    if (groups[f] == group && is_second((1.0 / static_cast<double>(face.size())) * sum))
      groups[f] = static_cast<std::uint32_t>(part.shapes.size());
  }
  part.shapes.push_back(part.shapes[group]);
  part.mesh = with_groups(part.mesh, groups);
  return part;
}

Part scaled(Part part, double factor) {
  part.mesh = shapes::scaled(std::move(part.mesh), factor);
  for (AnalyticSurface& s : part.shapes) s = test::scaled(s, factor);
  return part;
}

Part turned(Part part, const Vec3& axis, double degrees, const Vec3& by) {
  part.mesh = shapes::moved(shapes::rotated(std::move(part.mesh), axis, degrees), by);
  const auto turned_vector = [&](const Vec3& p) {
    return shapes::rotated(shapes::from_lists({p, {}, {}}, {{0, 1, 2}}), axis, degrees).positions[VertexId(0)];
  };
  for (AnalyticSurface& s : part.shapes) {
    s.origin = turned_vector(s.origin) + by;
    s.axis = normalized(turned_vector(s.axis));
  }
  return part;
}

Part barrel(int n) { return part_of(primitives::cylinder(n, kRadius, kHeight)); }

Part cut_off(int n, double slope, double half_angle) {
  const AnalyticSurface cylinder{SurfaceKind::kCylinder, {}, {0, 0, 1}, 5, 0, 0};
  const AnalyticSurface cone{SurfaceKind::kCone, {0, 0, -5 / std::tan(half_angle)}, {0, 0, 1}, 0, 0, half_angle};
  std::vector<Vec3> places;
  for (int i = 0; i < n; ++i) {
    const double c = std::cos(2 * kPi * i / n), s = std::sin(2 * kPi * i / n), widening = std::tan(half_angle);
    const double z = (12 + slope * 5 * c) / (1 - slope * widening * c);
    places.push_back({5 * c, 5 * s, 0});
    places.push_back({(5 + z * widening) * c, (5 + z * widening) * s, z});
  }
  std::vector<std::vector<std::uint32_t>> faces(2);
  std::vector<std::uint32_t> groups{kBottom, kTop};
  for (int i = 0; i < n; ++i) {
    const auto at = [&](int k, int level) { return static_cast<std::uint32_t>(2 * (k % n) + level); };
    faces[0].push_back(at(n - i, 0));
    faces[1].push_back(at(i, 1));
    faces.push_back({at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)});
    groups.push_back(kSide);
  }
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  return {with_groups(shapes::from_lists(places, faces), groups), {half_angle > 0 ? cone : cylinder, plane, plane}};
}

Part segment_of_disc(int n, double degrees) {
  std::vector<Vec2> base;
  for (int i = 0; i <= n; ++i) {
    const double angle = degrees * kPi / 180 * i / n;
    base.push_back({4 * std::cos(angle), 4 * std::sin(angle)});
  }
  const PolygonMesh mesh = shapes::prism(base, 3);
  std::vector<std::uint32_t> groups;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    const Vec3 a = mesh.positions[face[0]];
    const bool is_cap = std::all_of(face.begin(), face.end(), [&](VertexId v) { return mesh.positions[v].z == a.z; });
    bool is_flat = true;
    const Vec3 start{base.front().x, base.front().y, 0}, end{base.back().x, base.back().y, 0};
    for (const VertexId v : face) {
      const Vec3 p{mesh.positions[v].x, mesh.positions[v].y, 0};
      is_flat = is_flat && (p == start || p == end);
    }
    groups.push_back(is_cap ? (a.z == 0 ? 1 : 2) : is_flat ? 3 : 0);
  }
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  return {with_groups(mesh, groups), {{SurfaceKind::kCylinder, {}, {0, 0, 1}, 4, 0, 0}, plane, plane, plane}};
}

Asked elements(int n, double radius, double own) {
  return {radius * (1 - std::cos(kPi / n)) + own, 2 * kPi / n, HUGE_VAL, HUGE_VAL, 0};
}

void expect_conforming(const CutPart& part) {
  std::map<std::pair<VertexId, VertexId>, int> edges;
  for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
    const std::vector<VertexId> loop = part.loop(l);
    EXPECT_GE(std::set<VertexId>(loop.begin(), loop.end()).size(), 3u) << l;
    for (std::size_t i = 0; i < loop.size(); ++i) ++edges[{loop[i], loop[(i + 1) % loop.size()]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1) << edge.first << " " << edge.second;
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1u) << edge.first << " " << edge.second;
  }
}

void expect_near(const CutPart& part, double tolerance) {
  for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
    const auto before = part.points_before(l), now = part.points(l);
    EXPECT_LE(farthest(before, now), tolerance * (1 + 1e-6)) << l;
    EXPECT_LE(farthest(now, before), tolerance * (1 + 1e-6)) << l;
  }
}

std::vector<double> lengths(const std::vector<Vec3>& points) {
  std::vector<double> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.push_back(norm(points[(i + 1) % points.size()] - points[i]));
  return result;
}
void expect_equal_edges(const std::vector<Vec3>& points, double length, double rounding) {
  for (const double l : lengths(points)) EXPECT_NEAR(l, length, rounding);
}

double chord(double radius, double pieces) { return 2 * radius * std::sin(kPi / pieces); }
double height(double radius, double pieces) { return radius * (1 - std::cos(kPi / pieces)); }

}  // namespace remesh::cut_parts
