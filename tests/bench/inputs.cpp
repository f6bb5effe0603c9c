#include "tests/bench/inputs.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/triangulation/patch_triangulation.h"
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

}  // namespace remesh::bench
