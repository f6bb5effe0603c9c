#include "core/triangulation/delaunay_flips.h"

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

bool must_flip(std::span<const Vec2> points, const Triangulation2d& mesh, std::uint32_t h) {
  const std::uint32_t g = mesh.twin(h);
  if (g == Triangulation2d::kNoHalfEdge || mesh.is_constrained(h)) return false;
  return in_circle_perturbed(points[mesh.from(h)], points[mesh.to(h)], points[mesh.apex(h)], points[mesh.apex(g)]) > 0;
}

}  // namespace

void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, std::vector<std::uint32_t>& stack,
                    RunControl& control) {
  std::uint32_t steps = 0;
  while (!stack.empty()) {
    if (++steps % 4096 == 0) control.check_and_move();
    const std::uint32_t h = stack.back();
    stack.pop_back();
    if (!must_flip(points, mesh, h)) continue;
    const std::uint32_t g = mesh.twin(h);
    mesh.flip(h);
    // The four sides of the quadrilateral may have stopped being Delaunay. The flipped edge itself is Delaunay now.
    stack.insert(stack.end(), {Triangulation2d::next(g), Triangulation2d::previous(g), Triangulation2d::next(h),
                               Triangulation2d::previous(h)});
  }
}

void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, RunControl& control) {
  std::vector<std::uint32_t> stack;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    if (h % 4096 == 0) control.check_and_move();
    if (mesh.twin(h) == Triangulation2d::kNoHalfEdge || h > mesh.twin(h)) continue;
    stack.push_back(h);
    delaunay_flips(points, mesh, stack, control);
  }
}

}  // namespace remesh
