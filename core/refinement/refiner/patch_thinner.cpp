#include "core/refinement/refiner/patch_thinner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/small_blocks.h"
#include "core/geometry/exact/predicates.h"
#include "core/refinement/refiner/triangle_judge.h"

namespace remesh {
namespace {

// The following values were chosen by experiment; values near them give nearly the same number of faces. See
// experiments.md, Thinning.

/// A point stays if all its edges are longer than this share of the allowed length, because then fewer points would
/// make edges too long.
constexpr double kLongEnough = 0.86;
/// A triangle with two angles of 28 degrees has this shape. Removing points makes no triangle flatter than this, or
/// than the flattest one before.
constexpr double kFlattest = 0.165;
/// A point with more edges stays. It lies between small features that are far from it. With angles of at least 15
/// degrees, no point has more edges.
constexpr std::size_t kMaxEdges = 24;
/// Leaving out a point is tried if this share of the average edge afterwards is allowed. Sizes change across a few
/// triangles, so the average may seem a little too large.
constexpr double kAlmost = 0.8;
/// The number of places that are tried for one point that replaces two.
constexpr int kPlaces = 7;

double squared_length(Vec2 a) { return dot(a, a); }

}  // namespace

/// Finds the vertices around v, counter-clockwise. Returns false if there are too many, or if a triangle there is not
/// good.
bool PatchThinner::find_ring(std::uint32_t v, std::vector<std::uint32_t>& ring) const {
  ring.clear();
  const std::uint32_t first = mesh_.half_edge_at(v);
  std::uint32_t h = first;
  do {
    if (!patch_.states[h / 3].is_good() || ring.size() == kMaxEdges) return false;
    ring.push_back(mesh_.to(h));
    h = mesh_.twin(DelaunayMesh::previous(h));
  } while (h != first);
  return true;
}

/// Finds the ring around both v and w, where w is the k-th vertex of v's ring. Returns false if not all triangles
/// around w are good.
bool PatchThinner::find_hole(std::uint32_t v, std::size_t k) {
  const std::vector<std::uint32_t>&ring = scratch_.ring, &other = scratch_.other_ring;
  if (!find_ring(ring[k], scratch_.other_ring)) return false;
  scratch_.hole.clear();
  const auto add = [&](const std::vector<std::uint32_t>& around, std::size_t from) {
    for (std::size_t i = 1; i + 1 < around.size(); ++i) scratch_.hole.push_back(around[(from + i) % around.size()]);
  };
  // The ring runs around v from the vertex after w to the vertex before w, and then on around w.
  add(ring, k);
  add(other, static_cast<std::size_t>(std::find(other.begin(), other.end(), v) - other.begin()));
  return true;
}

PatchThinner::Fan PatchThinner::fan_of(Vec2 p, std::span<const std::uint32_t> ring) const {
  Fan fan{HUGE_VAL, 0, false};
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const TriangleMeasures m =
        measure_spanned(p, mesh_.point(ring[i]), mesh_.point(ring[i + 1 < ring.size() ? i + 1 : 0]));
    fan.worst_shape = std::min(fan.worst_shape, m.shape());
    fan.twice_area += m.twice_area;
    fan.is_any_sharp = fan.is_any_sharp || criteria_.is_sharp(m);
  }
  return fan;
}

/// Returns whether no triangle between a point and a ring is sharp or has a shape below `worst_shape`.
bool PatchThinner::is_fan_good(Vec2 p, std::span<const std::uint32_t> ring, double worst_shape) const {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const TriangleMeasures m =
        measure_spanned(p, mesh_.point(ring[i]), mesh_.point(ring[i + 1 < ring.size() ? i + 1 : 0]));
    if (m.shape() < worst_shape || criteria_.is_sharp(m)) return false;
  }
  return true;
}

void PatchThinner::record_remade() {
  patch_.states.resize(mesh_.triangle_slots(), TriangleState::good());
  for (const std::uint32_t t : mesh_.changed()) {
    if (mesh_.is_live(t)) patch_.states[t] = TriangleState::good();
    scratch_.remade.push_back(t);
  }
}

void PatchThinner::take(std::uint32_t v) {
  scratch_.taken.push_back({mesh_.point(v), patch_.places[v].spacing()});
  mesh_.remove(v);
  record_remade();
}

/// Puts back all removed points, the last one first. So points get their old numbers again. The triangulation of these
/// points is unique, so it is the same as before.
void PatchThinner::put_back() {
  for (; !scratch_.taken.empty(); scratch_.taken.pop_back()) {
    const RefinerScratch::Taken& taken = scratch_.taken.back();
    for (const std::uint32_t t : scratch_.remade) {
      if (!mesh_.is_live(t) || !is_inside(t, taken.p)) continue;
      const DelaunayMesh::Cavity cavity = mesh_.find_cavity(taken.p, t);
      if (!cavity.has_room) continue;
      const std::uint32_t v = mesh_.fill_cavity(cavity);
      record_remade();
      patch_.set_place(v, VertexPlace::free(taken.spacing));
      break;
    }
  }
}

bool PatchThinner::is_inside(std::uint32_t t, Vec2 p) const {
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (orient2d(mesh_.point(mesh_.from(h)), mesh_.point(mesh_.to(h)), p) < 0) return false;
  return true;
}

/// Returns whether all triangles that were remade since the first point was removed are within the bounds, and none has
/// a worse shape.
bool PatchThinner::are_remade_well(double worst_shape) const {
  return std::all_of(scratch_.remade.begin(), scratch_.remade.end(), [&](std::uint32_t t) {
    if (!mesh_.is_live(t)) return true;
    const Vec2 a = mesh_.point(mesh_.from(3 * t)), b = mesh_.point(mesh_.from(3 * t + 1)),
               c = mesh_.point(mesh_.from(3 * t + 2));
    const TriangleMeasures m = measure_spanned(c, a, b);
    const double shortest = criteria_.min_edge_length / sizes_.chart().scale(a);
    return m.twice_area >= worst_shape * m.squares && m.shortest_squared >= shortest * shortest &&
           !criteria_.is_sharp(m) && !sizes_.is_too_large(a, b, c, m) &&
           (patch_.in_space.empty() || is_good_in_space(t));
  });
}

/// Returns whether a triangle of a curved patch meets the bound on angles in space, and none of its edges inside the
/// patch is bent (CurvedChart::is_bent). Where shapes are free, it must not be too deep either (CurvedChart::is_deep).
bool PatchThinner::is_good_in_space(std::uint32_t t) const {
  if (TriangleJudge(sizes_, patch_).shape_of(t).is_sharp) return false;
  const CurvedChart& curved = *sizes_.chart().curved();
  const auto position = [&](std::uint32_t h) { return patch_.in_space[mesh_.from(h)].position; };
  if (are_shapes_free() && curved.is_deep(position(3 * t), position(3 * t + 1), position(3 * t + 2))) return false;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (!mesh_.is_constrained(h) && curved.is_bent(patch_.in_space[mesh_.from(h)], patch_.in_space[mesh_.to(h)]))
      return false;
  return true;
}

/// Removes v if the triangles around it are good without it. Returns whether it did.
bool PatchThinner::leave_out(std::uint32_t v, double worst_shape) {
  scratch_.remade.clear();
  take(v);
  if (are_remade_well(worst_shape)) {
    scratch_.taken.clear();
    return true;
  }
  put_back();
  return false;
}

/// Returns a place from which all of a ring is within reach, and with which no triangle has a worse shape.
/// Input: `limit` is the limit at a point within the ring.
std::optional<Vec2> PatchThinner::place_within(std::span<const std::uint32_t> ring, MinSpacing spacing,
                                               double worst_shape, const Limit& limit) const {
  Vec2 p{};
  for (const std::uint32_t u : ring) p = p + mesh_.point(u);
  p = (1 / static_cast<double>(ring.size())) * p;
  const double shortest = spacing.length / sizes_.chart().scale(p);
  // The places move towards the middle of the smallest circle around the ring.
  for (int i = 1; i <= kPlaces; ++i) {
    Vec2 farthest = p;
    double nearest_squared = HUGE_VAL;
    for (const std::uint32_t u : ring) {
      const Vec2 q = mesh_.point(u);
      nearest_squared = std::min(nearest_squared, squared_length(q - p));
      if (squared_length(q - p) > squared_length(farthest - p)) farthest = q;
    }
    // The size at one place answers most questions about places near it. The others need searches.
    const auto is_within_reach = [&](Vec2 q) {
      const double length = norm(q - p);
      const Vec2 middle = 0.5 * (p + q);
      const auto [everywhere, nowhere] = limit.around(norm(middle - limit.place()));
      return length <= everywhere || (length <= nowhere && sizes_.allows_when_thinned(length, middle));
    };
    const bool is_clearly_too_far =
        norm(farthest - p) > limit.around(norm(0.5 * (p + farthest) - limit.place())).nowhere;
    if (nearest_squared >= shortest * shortest && !is_clearly_too_far) {
      // The farthest vertex is tested first, because it rules out most places.
      if (is_fan_good(p, ring, worst_shape) && is_within_reach(farthest) &&
          std::all_of(ring.begin(), ring.end(), [&](std::uint32_t u) { return is_within_reach(mesh_.point(u)); }))
        return sizes_.chart().on_grid(p);
    }
    p = p + (1.0 / (i + 3)) * (farthest - p);
  }
  return std::nullopt;
}

/// Returns whether no place within the hole is near enough to all of its vertices, judged by the size at one point
/// inside. The test is cheap, and true of nearly all holes.
bool PatchThinner::is_out_of_reach(const Limit& limit) const {
  Vec2 low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  double farthest_squared = 0;
  for (const std::uint32_t u : scratch_.hole) {
    const Vec2 q = mesh_.point(u);
    low = {std::min(low.x, q.x), std::min(low.y, q.y)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y)};
    farthest_squared = std::max(farthest_squared, squared_length(q - limit.place()));
  }
  // From any place, some vertex is at least half the box's side away, and the middle of the edge to it is inside the
  // hole's hull.
  return std::max(high.x - low.x, high.y - low.y) / 2 > limit.around(std::sqrt(farthest_squared)).nowhere;
}

/// Replaces v and its neighbour w by one point, if there is a suitable place. The scratch memory has the ring around
/// them (find_hole). Returns the new vertex, or kNone.
std::uint32_t PatchThinner::merge(std::uint32_t v, std::uint32_t w, double worst_shape, const Limit& limit) {
  const MinSpacing spacing = std::min(patch_.places[v].spacing(), patch_.places[w].spacing());
  const std::optional<Vec2> p = place_within(scratch_.hole, spacing, worst_shape, limit);
  if (!p) return kNone;
  scratch_.remade.clear();
  take(v);
  take(w);
  const std::uint32_t merged = put_in(*p, spacing, worst_shape);
  if (merged == kNone)
    put_back();
  else
    scratch_.taken.clear();
  return merged;
}

/// Inserts a point in the place of removed ones, if it removes only good triangles and makes only good ones. Returns
/// the new vertex, or kNone.
std::uint32_t PatchThinner::put_in(Vec2 p, MinSpacing spacing, double worst_shape) {
  const auto found = std::find_if(scratch_.remade.begin(), scratch_.remade.end(),
                                  [&](std::uint32_t t) { return mesh_.is_live(t) && is_inside(t, p); });
  if (found == scratch_.remade.end()) return kNone;
  const DelaunayMesh::Cavity cavity = mesh_.find_cavity(p, *found);
  const auto is_good = [&](std::uint32_t t) { return patch_.states[t].is_good(); };
  if (!cavity.has_room || !std::all_of(cavity.triangles.begin(), cavity.triangles.end(), is_good)) return kNone;
  const std::uint32_t v = mesh_.fill_cavity(cavity);
  record_remade();
  patch_.set_place(v, VertexPlace::free(spacing));
  if (are_remade_well(worst_shape)) return v;
  mesh_.remove(v);
  record_remade();
  return kNone;
}

/// Lists the candidates for thinning out from `first` on: points around which, or around a neighbour of which, a
/// triangle has changed since the last thinning out.
void PatchThinner::list_unsettled(std::uint32_t first, std::pmr::vector<std::uint8_t>& is_waiting) {
  enum : std::uint8_t { kChanged = 1, kBeside = 2 };
  StackMemory memory;
  std::pmr::vector<std::uint8_t> what(mesh_.vertex_slots(), 0, &memory);
  const auto each_triangle = [&](const auto& visit) {
    for (std::uint32_t t = 0; t < mesh_.triangle_slots(); ++t)
      if (mesh_.is_live(t)) visit(t, {mesh_.from(3 * t), mesh_.from(3 * t + 1), mesh_.from(3 * t + 2)});
  };
  using Corners = std::array<std::uint32_t, 3>;
  each_triangle([&](std::uint32_t t, const Corners& corners) {
    if (patch_.states[t].is_settled()) return;
    for (const std::uint32_t v : corners) what[v] = kChanged;
  });
  each_triangle([&](std::uint32_t, const Corners& corners) {
    if (std::none_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return what[v] == kChanged; })) return;
    for (const std::uint32_t v : corners)
      if (what[v] == 0) what[v] = kBeside;
  });
  scratch_.to_thin.clear();
  for (std::uint32_t v = mesh_.vertex_slots(); v-- > first;) {
    if (!mesh_.is_live_vertex(v) || what[v] == 0 || !patch_.is_free(v)) continue;
    is_waiting[v] = 1;
    scratch_.to_thin.push_back(v);
  }
}

void PatchThinner::settle() {
  for (TriangleState& state : patch_.states)
    if (state.is_good()) state = TriangleState::settled();
}

void PatchThinner::thin_out(std::uint32_t first, Thinning thinning, RunControl& control) {
  std::vector<std::uint32_t>&waiting = scratch_.to_thin, &ring = scratch_.ring;
  StackMemory memory;
  std::pmr::vector<std::uint8_t> is_waiting(mesh_.vertex_slots(), 0, &memory);
  const auto wait = [&](std::uint32_t v) {
    if (!patch_.is_free(v) || std::exchange(is_waiting[v], 1) != 0) return;
    waiting.push_back(v);
  };
  list_unsettled(first, is_waiting);
  while (!waiting.empty()) {
    control.check();
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    is_waiting[v] = 0;
    if (!mesh_.is_live_vertex(v) || !find_ring(v, ring)) continue;
    const Vec2 p = mesh_.point(v);
    const std::uint32_t nearest = *std::min_element(ring.begin(), ring.end(), [&](std::uint32_t a, std::uint32_t b) {
      return squared_length(mesh_.point(a) - p) < squared_length(mesh_.point(b) - p);
    });
    if (!sizes_.allows_when_thinned(norm(mesh_.point(nearest) - p) / kLongEnough, p)) continue;
    const Limit limit = sizes_.limit_when_thinned(p);
    const Fan fan = fan_of(p, ring);
    const double worst_shape = are_shapes_free() ? 0 : std::min(kFlattest, fan.worst_shape);
    // Without v, there are two triangles fewer for the same area.
    const double side = std::sqrt(fan.twice_area / (static_cast<double>(ring.size()) - 2) * (2 / std::numbers::sqrt3));
    if (limit.allows(kAlmost * side) && leave_out(v, worst_shape)) {
      for (const std::uint32_t u : ring) wait(u);
      continue;
    }
    if (thinning == Thinning::kQuick) continue;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::uint32_t w = ring[k];
      // If w is still in the queue, this pair is tried when it is w's turn.
      if (!patch_.is_free(w) || is_waiting[w] != 0) continue;
      if (!limit.allows(norm(mesh_.point(w) - p) / kLongEnough) || !find_hole(v, k)) continue;
      if (is_out_of_reach(limit)) continue;
      const double of_other = fan_of(mesh_.point(w), scratch_.other_ring).worst_shape;
      const std::uint32_t merged = merge(v, w, std::min(worst_shape, of_other), limit);
      if (merged == kNone) continue;
      for (const std::uint32_t u : scratch_.hole) wait(u);
      wait(merged);
      break;
    }
  }
  settle();
}

}  // namespace remesh
