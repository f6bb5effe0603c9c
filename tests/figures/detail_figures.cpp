#include "tests/figures/detail_figures.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "tests/figures/render.h"
#include "tests/figures/style.h"
#include "tests/figures/svg.h"

namespace remesh::figures {
namespace {

constexpr double kDepth = 40, kDetail = 1;

/// A block in millimetres with a low step, a narrow chamfer and a needle along one of its edges.
PolygonMesh make_block() {
  const std::vector<Vec2> outline{
      {0, 0}, {60, 0}, {60, 29}, {59.3, 30}, {35, 30}, {35, 30 + 0.8 * kDetail}, {0, 30 + 0.8 * kDetail}};
  const std::size_t n = outline.size();
  PolygonMesh mesh;
  for (const double y : {0.0, kDepth})
    for (const Vec2& p : outline) mesh.positions.push_back({p.x, y, p.y});
  const auto add = [&](const std::vector<std::size_t>& face) {
    for (const std::size_t v : face) mesh.corners.push_back(VertexId(v));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  };
  // The needle's corner is a little below the middle of the front's lower edge of the step.
  const std::size_t needle = mesh.positions.push_back({47, -0.3 * kDetail, 30 - 0.6 * kDetail}).value;
  add({0, 1, 2, needle});
  add({2, 3, needle});
  add({3, 4, needle});
  add({0, needle, 4, 5, 6});
  std::vector<std::size_t> back;
  for (std::size_t i = n; i-- > 0;) back.push_back(n + i);
  add(back);
  for (std::size_t i = 0; i < n; ++i) add({(i + 1) % n, i, n + i, n + (i + 1) % n});
  return mesh;
}

}  // namespace

std::string details(RunControl& control) {
  const PolygonMesh mesh = make_block();
  std::vector<Panel> panels;
  for (const double size : {0.0, 2 * kDetail}) {
    Options options;
    options.defeature_size = size;
    const Result result = remesh_surface(mesh, options, RunSettings{}, control);
    const double bound = std::ceil(100 * result.report.distance_bound->output_to_input) / 100;
    panels.emplace_back("defeature_size " + number(size),
                        count(result.mesh.faces.size()) + " triangles, distance at most " + number(bound) + " mm");
    draw(shape_of(result), Paint::kLight, 0.5, panels.back());
  }
  return to_svg(panels, 460, 330);
}

}  // namespace remesh::figures
