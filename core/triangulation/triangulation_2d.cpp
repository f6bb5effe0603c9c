#include "core/triangulation/triangulation_2d.h"

#include "core/base/ids.h"

namespace remesh {

void Triangulation2d::flip(std::uint32_t h) {
  // h: a->b with apex c; g: b->a with apex d.
  const std::uint32_t g = twin(h);
  const std::uint32_t h_next = next(h), h_prev = previous(h), g_next = next(g), g_prev = previous(g);
  const std::uint32_t a = from(h), b = from(g), c = apex(h), d = apex(g);
  const std::uint32_t bc = twin(h_next), ca = twin(h_prev), ad = twin(g_next), db = twin(g_prev);
  const bool bc_bound = is_constrained(h_next), ca_bound = is_constrained(h_prev);
  const bool ad_bound = is_constrained(g_next), db_bound = is_constrained(g_prev);

  set_triangle(h, d, c, a);
  set_triangle(g, c, d, b);
  join(h, g);
  join(h_next, ca, ca_bound);
  join(h_prev, ad, ad_bound);
  join(g_next, db, db_bound);
  join(g_prev, bc, bc_bound);
  if (edge_at_) {
    std::vector<std::uint32_t>& edge_at = *edge_at_;
    edge_at[d] = h;
    edge_at[c] = g;
    edge_at[a] = h_prev;
    edge_at[b] = g_prev;
  }
}

void Triangulation2d::index_points(std::size_t points) {
  std::vector<std::uint32_t>& edge_at = edge_at_.get();
  edge_at.assign(points, kNoHalfEdge);
  for (std::uint32_t h = 0; h < half_edge_count(); ++h) edge_at[from(h)] = h;
}

void Triangulation2d::compact(const std::vector<std::uint8_t>& keep) {
  edge_at_.reset();
  const std::uint32_t n = triangle_count();
  std::vector<std::uint32_t> new_triangle(n, kNone);
  std::uint32_t left = 0;
  for (std::uint32_t t = 0; t < n; ++t)
    if (keep[t]) new_triangle[t] = left++;
  for (std::uint32_t t = 0; t < n; ++t) {
    if (!keep[t]) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t old_twin = twin(3 * t + k);
      const std::uint32_t bit = half_edges_[3 * t + k].twin & kConstraint;
      const bool lives = old_twin != kNoHalfEdge && keep[old_twin / 3];
      half_edges_[3 * new_triangle[t] + k] = {
          from(3 * t + k), (lives ? 3 * new_triangle[old_twin / 3] + old_twin % 3 : kNoHalfEdge) | bit};
    }
  }
  resize(left);
}

}  // namespace remesh
