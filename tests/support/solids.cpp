#include "tests/support/solids.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/triangulation/patch_triangulation.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh::solids {
namespace {

using Faces = std::vector<std::vector<std::uint32_t>>;

/// A convex polygon that faces outward.
using Facet = std::vector<Vec3>;

/// Returns the parts of the facets behind a plane, and the facet that closes the cut.
std::vector<Facet> cut_by(const std::vector<Facet>& facets, const Vec3& normal, double offset) {
  std::vector<Facet> kept;
  std::set<Vec3> rim;
  const auto height = [&](const Vec3& p) { return dot(normal, p) - offset; };
  // The point is the same for both facets of an edge, which run through it in opposite directions.
  const auto crossing = [&](Vec3 a, Vec3 b) {
    if (b < a) std::swap(a, b);
    return a + (height(a) / (height(a) - height(b))) * (b - a);
  };
  for (const Facet& facet : facets) {
    Facet rest;
    for (std::size_t i = 0; i < facet.size(); ++i) {
      const Vec3 &p = facet[i], &q = facet[(i + 1) % facet.size()];
      if (height(p) < 0) rest.push_back(p);
      if ((height(p) < 0) != (height(q) < 0)) rim.insert(rest.emplace_back(crossing(p, q)));
    }
    if (rest.size() >= 3) kept.push_back(rest);
  }
  if (rim.size() < 3) return kept;
  Vec3 centre;
  for (const Vec3& p : rim) centre += (1.0 / static_cast<double>(rim.size())) * p;
  const Vec3 x = normalized(*rim.begin() - centre), y = cross(normal, x);
  Facet lid(rim.begin(), rim.end());
  std::sort(lid.begin(), lid.end(), [&](const Vec3& a, const Vec3& b) {
    return std::atan2(dot(a - centre, y), dot(a - centre, x)) < std::atan2(dot(b - centre, y), dot(b - centre, x));
  });
  kept.push_back(lid);
  return kept;
}

PolygonMesh from_facets(const std::vector<Facet>& facets) {
  std::map<Vec3, std::uint32_t> index;
  std::vector<Vec3> positions;
  Faces faces;
  for (const Facet& facet : facets) {
    faces.emplace_back();
    for (const Vec3& p : facet) {
      const auto [at, is_new] = index.try_emplace(p, static_cast<std::uint32_t>(positions.size()));
      if (is_new) positions.push_back(p);
      faces.back().push_back(at->second);
    }
  }
  return shapes::from_lists(positions, faces);
}

}  // namespace

PolygonMesh region(const polygons::Polygon& polygon) {
  const polygons::PatchInput input = polygons::patch_input(polygon);
  RunControl control;
  const PatchTriangulation made = triangulate_patch(input.points, input.edges, control);
  std::vector<Vec3> positions;
  for (const Vec2 p : input.points) positions.push_back({p.x, p.y, 0});
  Faces faces;
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); h += 3)
    faces.push_back({made.mesh.from(h), made.mesh.from(h + 1), made.mesh.from(h + 2)});
  return shapes::from_lists(positions, faces);
}

PolygonMesh extrusion(const polygons::Polygon& polygon, double height) {
  const PolygonMesh cap = region(polygon);
  const auto n = static_cast<std::uint32_t>(cap.vertex_count());
  std::vector<Vec3> positions(cap.positions.begin(), cap.positions.end());
  for (const Vec3& p : cap.positions) positions.push_back({p.x, p.y, height});
  Faces faces;
  for (std::uint32_t f = 0; f < cap.face_count(); ++f) {
    const auto t = cap.face(FaceId(f));
    faces.push_back({t[2].value, t[1].value, t[0].value});
    faces.push_back({t[0].value + n, t[1].value + n, t[2].value + n});
  }
  for (const auto& [a, b] : polygons::patch_input(polygon).edges) faces.push_back({a, b, b + n, a + n});
  return shapes::from_lists(positions, faces);
}

PolygonMesh cut_cube(std::uint64_t seed, int planes) {
  Random random(seed);
  std::vector<Facet> facets;
  const PolygonMesh cube = shapes::moved(shapes::quad_box({2, 2, 2}), {-1, -1, -1});
  for (std::uint32_t f = 0; f < cube.face_count(); ++f) {
    facets.emplace_back();
    for (const VertexId v : cube.face(FaceId(f))) facets.back().push_back(cube.positions[v]);
  }
  for (int i = 0; i < planes; ++i) {
    Vec3 direction;
    do direction = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    while (norm(direction) < 0.1);
    const double offset = random.uniform(0.5, 1.2);
    facets = cut_by(facets, normalized(direction), offset);
  }
  return from_facets(facets);
}

PolygonMesh placed(const PolygonMesh& mesh, const polygons::Placement& place) {
  PolygonMesh out = mesh;
  const Vec3 up = (1 / norm(place.x_axis)) * cross(place.x_axis, place.y_axis);
  for (Vec3& p : out.positions) p = place({p.x, p.y}) + p.z * up;
  return out;
}

PolygonMesh needle_fan(int n, double degrees) { return needle_fan(std::vector<double>(n, degrees)); }

PolygonMesh needle_fan(const std::vector<double>& degrees) {
  std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0.01}};
  Faces faces;
  double turn = 0;
  for (const double angle : degrees) {
    turn += angle;
    const double radians = turn * std::numbers::pi / 180;
    const auto k = static_cast<std::uint32_t>(positions.size());
    positions.push_back({std::cos(radians), std::sin(radians), k % 2 == 0 ? -0.01 : 0.01});
    faces.push_back({0, k - 1, k});
  }
  return shapes::from_lists(positions, faces);
}

PolygonMesh cone(int sides, double height) {
  std::vector<Vec3> positions{{0, 0, height}};
  Faces faces(1);
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t k = 0; k < n; ++k) {
    const double turn = 2 * std::numbers::pi * k / sides;
    positions.push_back({std::cos(turn), std::sin(turn), 0});
    faces.push_back({0, k + 1, (k + 1) % n + 1});
    faces[0].push_back(n - k);
  }
  return shapes::from_lists(positions, faces);
}

PolygonMesh nested_squares(int n, double gap) {
  std::vector<Vec3> positions;
  Faces faces;
  for (int i = 0; i < 2 * n; ++i) {
    const double r = 1 - i * gap;
    for (const auto& [x, y] : {std::pair(-r, -r), std::pair(r, -r), std::pair(r, r), std::pair(-r, r)})
      positions.push_back({x, y, 0});
    const auto k = static_cast<std::uint32_t>(4 * i);
    // Every second square has a face towards the next one.
    if (i % 2 == 0)
      for (std::uint32_t j = 0; j < 4; ++j) {
        const std::uint32_t l = (j + 1) % 4;
        faces.push_back({k + j, k + l, k + 4 + l, k + 4 + j});
      }
  }
  return shapes::from_lists(positions, faces);
}

PolygonMesh tube(double width, double height, double thickness) {
  const double a = thickness, b = width - thickness;
  polygons::Polygon ring{{{0, 0}, {width, 0}, {width, width}, {0, width}}, {{{a, a}, {a, b}, {b, b}, {b, a}}}};
  return extrusion(ring, height);
}

PolygonMesh stacked_boxes(int count, double length) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int level = 0; level <= count; ++level)
    for (const Vec2 p : {Vec2{0, 0}, {length, 0}, {length, 1}, {0, 1}}) points.push_back({p.x, p.y, 1.0 * level});
  for (std::uint32_t box = 0; box < static_cast<std::uint32_t>(count); ++box) {
    const std::uint32_t low = 4 * box, high = low + 4;
    faces.push_back({low + 3, low + 2, low + 1, low});
    faces.push_back({high, high + 1, high + 2, high + 3});
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t j = (i + 1) % 4;
      faces.push_back({low + i, low + j, high + j, high + i});
    }
  }
  return shapes::from_lists(points, faces);
}

}  // namespace remesh::solids
