#include "tests/bench/inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/triangulation/patch_triangulation.h"
#include "tests/support/primitives.h"
#include "tests/support/random.h"

namespace remesh::bench {

polygons::Polygon plate(int holes_a_side, int corners) {
  polygons::Polygon plate;
  plate.outer = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  const double cell_x = 4.0 / holes_a_side, cell_y = 3.0 / holes_a_side;
  const auto on_grid = [](double x) { return std::nearbyint(x * 0x1p40) * 0x1p-40; };
  for (int i = 0; i < holes_a_side; ++i)
    for (int j = 0; j < holes_a_side; ++j) {
      const Vec2 centre{(i + 0.5) * cell_x, (j + 0.5) * cell_y};
      // Radii differ; every third hole is a slot.
      const double radius = cell_y * (0.1 + 0.03 * ((7 * i + 3 * j) % 8));
      const double stretch = (i + j) % 3 == 0 ? cell_x * 0.15 : 0;
      polygons::Loop hole;
      for (int k = 0; k < corners; ++k) {
        const double angle = -2 * std::numbers::pi * (k + 0.5) / corners;
        const double x = radius * std::cos(angle);
        hole.push_back(
            {on_grid(centre.x + x + (x > 0 ? stretch : -stretch)), on_grid(centre.y + radius * std::sin(angle))});
      }
      plate.holes.push_back(std::move(hole));
    }
  return plate;
}

polygons::Polygon smooth_star(int corners, int holes_a_side) {
  const auto on_grid = [](Vec2 p) {
    return Vec2{std::nearbyint(p.x * 0x1p40) * 0x1p-40, std::nearbyint(p.y * 0x1p40) * 0x1p-40};
  };
  Random random(7);
  polygons::Polygon star;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const double radius = 0.8 + 0.15 * std::cos(7 * angle) + random.uniform(0, 1.5) / corners;
    star.outer.push_back(on_grid({radius * std::cos(angle), radius * std::sin(angle)}));
  }
  const double cell = 0.8 / holes_a_side;
  for (int i = 0; i < holes_a_side; ++i)
    for (int j = 0; j < holes_a_side; ++j) {
      const Vec2 centre{-0.4 + (i + 0.5) * cell, -0.4 + (j + 0.5) * cell};
      const double turn = random.uniform(0, 1), radius = cell * random.uniform(0.1, 0.4);
      polygons::Loop hole;
      for (int k = 0; k < 4; ++k) {
        const double angle = turn - std::numbers::pi / 2 * k;
        hole.push_back(on_grid(centre + radius * Vec2{std::cos(angle), std::sin(angle)}));
      }
      star.holes.push_back(std::move(hole));
    }
  return star;
}

PolygonMesh mesh_of(const polygons::PatchInput& input) {
  RunControl control;
  const PatchTriangulation made = triangulate_patch(input.points, input.edges, control);
  PolygonMesh mesh;
  for (const Vec2 p : input.points) mesh.positions.push_back({p.x, p.y, 0});
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); h += 3) {
    for (std::uint32_t k = 0; k < 3; ++k) mesh.corners.push_back(VertexId(made.mesh.from(h + k)));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

PolygonMesh facets(int nx, int ny, double width) {
  Random random(11);
  const auto zigzag = [&](int n, double length) {
    std::vector<double> heights;
    for (int i = 0; i <= n; ++i) heights.push_back(length * (i % 2 == 0 ? 0.25 : 0) + random.integer(1, 200) * 0x1p-11);
    return heights;
  };
  const std::vector<double> of_column = zigzag(nx, width), of_row = zigzag(ny, 1);
  PolygonMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.positions.push_back({i * width, 1.0 * j, of_column[i] + of_row[j]});
  const auto vertex = [&](int i, int j) { return VertexId(static_cast<std::uint32_t>(j * (nx + 1) + i)); };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      for (const auto& [b, c] :
           {std::pair(vertex(i + 1, j), vertex(i + 1, j + 1)), std::pair(vertex(i + 1, j + 1), vertex(i, j + 1))}) {
        for (const VertexId v : {vertex(i, j), b, c}) mesh.corners.push_back(v);
        mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
      }
  return mesh;
}

namespace {

Vec3 as_floats(const Vec3& p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

void add_triangle(PolygonMesh& mesh, VertexId a, VertexId b, VertexId c) {
  for (const VertexId v : {a, b, c}) mesh.corners.push_back(v);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
}

/// Adds two triangles for each square of a grid, whose corners `vertex` gives by their column and row.
template <class Vertex>
void add_grid(PolygonMesh& mesh, int columns, int rows, const Vertex& vertex) {
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      add_triangle(mesh, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      add_triangle(mesh, vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
}

/// Gives equal keys the same vertex.
template <class Key>
class SharedVertices {
 public:
  explicit SharedVertices(PolygonMesh& mesh) : mesh_(mesh) {}
  template <class MakePosition>
  VertexId at(const Key& key, const MakePosition& make_position) {
    const auto [entry, is_new] = vertices_.try_emplace(key, VertexId(mesh_.positions.size()));
    if (is_new) mesh_.positions.push_back(as_floats(make_position()));
    return entry->second;
  }

 private:
  PolygonMesh& mesh_;
  std::map<Key, VertexId> vertices_;
};

}  // namespace

PolygonMesh bumpy_ball(int cuts) {
  const PolygonMesh corners = primitives::icosphere(0, 1).mesh;
  PolygonMesh mesh;
  const auto bump = [](const Vec3& at) {
    const Vec3 p = normalized(at);
    const double r = 10 + 0.5 * std::sin(5 * p.x + 1) * std::sin(4 * p.y + 2) * std::sin(6 * p.z + 0.5) +
                     0.2 * std::sin(9 * p.x) * std::cos(8 * p.y + 3 * p.z);
    return r * p;
  };
  // A vertex is known by the corners between which it lies, and how near it is to each.
  using Weight = std::pair<std::uint32_t, int>;
  SharedVertices<std::array<Weight, 3>> vertices(mesh);
  for (FaceId f(0); f.value < corners.face_count(); ++f.value) {
    const auto face = corners.face(f);
    const auto vertex = [&](int i, int j) {
      std::array<Weight, 3> key{{{face[0].value, i}, {face[1].value, j}, {face[2].value, cuts - i - j}}};
      for (Weight& weight : key)
        if (weight.second == 0) weight = {};
      std::sort(key.begin(), key.end());
      return vertices.at(key, [&] {
        return bump(i * corners.positions[face[0]] + j * corners.positions[face[1]] +
                    (cuts - i - j) * corners.positions[face[2]]);
      });
    };
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; i + j < cuts; ++j) {
        add_triangle(mesh, vertex(i + 1, j), vertex(i, j + 1), vertex(i, j));
        if (i + j + 1 < cuts) add_triangle(mesh, vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      }
  }
  return mesh;
}

PolygonMesh terrain(int n) {
  Random random(5);
  // Hills of half the width each time are half as high.
  std::vector<std::array<double, 5>> hills;
  for (double width = n; width >= 4; width /= 2)
    for (int k = 0; k < 3; ++k) {
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      hills.push_back({std::cos(angle) / width, std::sin(angle) / width, random.uniform(0, 1), 0.15 * width, width});
    }
  PolygonMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      double height = 0;
      for (const auto& [x, y, phase, size, width] : hills)
        height += size * std::sin(2 * std::numbers::pi * (x * i + y * j + phase));
      mesh.positions.push_back(as_floats({1.0 * i, 1.0 * j, height}));
    }
  add_grid(mesh, n, n, [&](int i, int j) { return VertexId(j * (n + 1) + i); });
  return mesh;
}

PolygonMesh knot_tube(int around) {
  constexpr double kTurns = 2, kCrossings = 3, kRadius = 0.4;
  const int along = 25 * around;
  const auto centre = [](double t) {
    const double out = 3 + std::cos(kCrossings * t);
    return Vec3{out * std::cos(kTurns * t), out * std::sin(kTurns * t), std::sin(kCrossings * t)};
  };
  PolygonMesh mesh;
  for (int j = 0; j < along; ++j) {
    const double t = 2 * std::numbers::pi * j / along, step = 1e-4;
    const Vec3 before = centre(t - step), at = centre(t), after = centre(t + step);
    const Vec3 tangent = normalized(after - before);
    const Vec3 across = normalized(cross(tangent, after - at - (at - before)));
    const Vec3 other = cross(tangent, across);
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.positions.push_back(as_floats(at + kRadius * (std::cos(angle) * across + std::sin(angle) * other)));
    }
  }
  add_grid(mesh, around, along, [&](int i, int j) { return VertexId((j % along) * around + i % around); });
  return mesh;
}

PolygonMesh enneper_patch(int n) {
  constexpr double kHalfWidth = 1.1;
  PolygonMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double u = kHalfWidth * (2.0 * i / n - 1), v = kHalfWidth * (2.0 * j / n - 1);
      mesh.positions.push_back(
          as_floats({u - u * u * u / 3 + u * v * v, v - v * v * v / 3 + v * u * u, u * u - v * v}));
    }
  add_grid(mesh, n, n, [&](int i, int j) { return VertexId(j * (n + 1) + i); });
  return mesh;
}

PolygonMesh isosurface(int n) {
  const auto place = [n](int i, int j, int k) { return (2.0 / n) * Vec3{1.0 * i, 1.0 * j, 1.0 * k} - Vec3{1, 1, 1}; };
  const auto value = [](const Vec3& p) {
    return norm_squared(p) - 0.6 + 0.12 * std::sin(7 * p.x) * std::sin(6 * p.y + 1) * std::sin(5 * p.z + 2);
  };
  PolygonMesh mesh;
  using Node = std::array<int, 3>;
  SharedVertices<std::pair<Node, Node>> vertices(mesh);
  const auto crossing = [&](const Node& a, const Node& b) {
    return vertices.at(std::minmax(a, b), [&] {
      const auto& [low, high] = std::minmax(a, b);
      const Vec3 p = place(low[0], low[1], low[2]), q = place(high[0], high[1], high[2]);
      const double t = value(p) / (value(p) - value(q));
      return p + t * (q - p);
    });
  };
  const auto cut_tetrahedron = [&](const std::array<Node, 4>& nodes) {
    std::vector<Node> inside, outside;
    for (const Node& node : nodes) (value(place(node[0], node[1], node[2])) < 0 ? inside : outside).push_back(node);
    std::vector<VertexId> cut;
    if (inside.size() == 2)
      cut = {crossing(inside[0], outside[0]), crossing(inside[0], outside[1]), crossing(inside[1], outside[1]),
             crossing(inside[1], outside[0])};
    else if (inside.size() == 1)
      for (const Node& node : outside) cut.push_back(crossing(inside[0], node));
    else if (outside.size() == 1)
      for (const Node& node : inside) cut.push_back(crossing(node, outside[0]));
    if (cut.empty()) return;
    // The normal points outwards.
    const Vec3 out = place(outside[0][0], outside[0][1], outside[0][2]) - mesh.positions[cut[0]];
    const Vec3 in = place(inside[0][0], inside[0][1], inside[0][2]) - mesh.positions[cut[0]];
    const Vec3 normal =
        cross(mesh.positions[cut[1]] - mesh.positions[cut[0]], mesh.positions[cut[2]] - mesh.positions[cut[0]]);
    if (dot(normal, out - in) < 0) std::reverse(cut.begin(), cut.end());
    for (std::size_t i = 2; i < cut.size(); ++i) add_triangle(mesh, cut[0], cut[i - 1], cut[i]);
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        // The six orders of the axes are the six ways from one corner of the cell to the opposite one.
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<Node, 4> nodes{{{i, j, k}, {i, j, k}, {i, j, k}, {i + 1, j + 1, k + 1}}};
          ++nodes[1][axes[0]];
          ++nodes[2][axes[0]];
          ++nodes[2][axes[1]];
          cut_tetrahedron(nodes);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  return mesh;
}

}  // namespace remesh::bench
