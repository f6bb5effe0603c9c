/// This file has the members of PatchRefiner that thin a patch out. Points inside that are not needed in the end are
/// removed, or one point takes the place of two.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/predicates.h"
#include "core/refinement/patch_refiner.h"

namespace remesh {
namespace {

// The following values were chosen among many that give nearly the same number of faces: shares from 0.8 to 0.9, shapes
// from 0.15 to 0.185 and 4 to 12 places differ by no more than half a per cent. With these values, TetGen's worst
// dihedral angles came out well on three parts. (Two of some thirty settings did so, and seven of thirty another time.)
// Next time it may be other values.

/// A point stays if all its edges are longer than this share of what is allowed, because then there is no room for
/// fewer points.
constexpr double kLongEnough = 0.86;
/// A triangle with two angles of 28 degrees has this value of twice the area over the sum of squared edges. If points
/// are removed, no triangle gets flatter than this, or than the flattest that was there before.
constexpr double kFlattest = 0.165;
/// A point with more edges stays. It lies between small things that are far from it. With angles of 15 degrees, no
/// point has more edges.
constexpr std::size_t kMaxEdges = 24;
/// Leaving out a point is tried if this share of the average edge afterwards is allowed. Sizes change across a few
/// triangles, so the average may seem a little too large.
constexpr double kAlmost = 0.8;
/// This is the number of places that are tried for one point in the place of two.
constexpr int kPlaces = 7;

double squared_length(Vec2 a) { return dot(a, a); }

}  // namespace

/// Returns whether an edge at that place may have that length, in the plane.
bool PatchRefiner::is_allowed(double length, Vec2 p) const {
  if (held_) return allows(length, p);
  const double in_space = length * chart_.scale(p);
  return in_space <= criteria_.even_size &&
         (criteria_.sizes.is_uniform() || criteria_.sizes.allows(in_space, chart_.to_space(p)));
}

/// Finds the vertices around v, counter-clockwise. Returns false if there are too many, or if a triangle there is not
/// good.
bool PatchRefiner::find_ring(std::uint32_t v, std::vector<std::uint32_t>& ring) const {
  ring.clear();
  const std::uint32_t first = mesh_.half_edge_at(v);
  std::uint32_t h = first;
  do {
    if (state_[h / 3] != State::kGood || ring.size() == kMaxEdges) return false;
    ring.push_back(mesh_.to(h));
    h = mesh_.twin(DelaunayMesh::previous(h));
  } while (h != first);
  return true;
}

/// Measures the triangles between p and a ring. `least_shape` is the minimum of twice the area over the sum of squared
/// edges. It is negative if a triangle is turned over.
PatchRefiner::Fan PatchRefiner::fan_of(Vec2 p, std::span<const std::uint32_t> ring) const {
  Fan fan{HUGE_VAL, 0, false};
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Spanned s = spanned(p, mesh_.point(ring[i]), mesh_.point(ring[i + 1 < ring.size() ? i + 1 : 0]));
    fan.least_shape = std::min(fan.least_shape, s.twice_area / s.squares);
    fan.twice_area += s.twice_area;
    fan.is_any_sharp = fan.is_any_sharp || is_sharp(s.squares, s.shortest_squared, s.twice_area);
  }
  return fan;
}

void PatchRefiner::note_remade() {
  state_.resize(mesh_.triangle_slots(), State::kGood);
  for (const std::uint32_t t : mesh_.changed()) {
    if (mesh_.is_live(t)) state_[t] = State::kGood;
    at_->remade.push_back(t);
  }
}

void PatchRefiner::take(std::uint32_t v) {
  at_->taken.push_back({mesh_.point(v), value_[v]});
  mesh_.remove(v);
  note_remade();
}

/// Puts back everything that was taken, the last point first. So points get their old numbers again. The triangulation
/// of these points is unique, so it is the same as before.
void PatchRefiner::put_back() {
  for (; !at_->taken.empty(); at_->taken.pop_back()) {
    const Workplace::Taken& taken = at_->taken.back();
    for (const std::uint32_t t : at_->remade) {
      if (!mesh_.is_live(t) || !is_inside(t, taken.p) || !mesh_.find_cavity(taken.p, t)) continue;
      const std::uint32_t v = mesh_.fill_cavity(taken.p);
      note_remade();
      set_vertex(v, SegmentId(), taken.value);
      break;
    }
  }
}

bool PatchRefiner::is_inside(std::uint32_t t, Vec2 p) const {
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (orient2d(mesh_.point(mesh_.from(h)), mesh_.point(mesh_.to(h)), p) < 0) return false;
  return true;
}

/// Returns whether all triangles that were remade since the first point was taken are within the bounds, and none is
/// flatter than `flattest`.
bool PatchRefiner::are_remade_well(double flattest) const {
  return std::all_of(at_->remade.begin(), at_->remade.end(), [&](std::uint32_t t) {
    if (!mesh_.is_live(t)) return true;
    const Vec2 a = mesh_.point(mesh_.from(3 * t)), b = mesh_.point(mesh_.from(3 * t + 1)),
               c = mesh_.point(mesh_.from(3 * t + 2));
    const Spanned s = spanned(c, a, b);
    const double shortest = criteria_.min_edge_length / chart_.scale(a);
    return s.twice_area >= flattest * s.squares && s.shortest_squared >= shortest * shortest &&
           !is_sharp(s.squares, s.shortest_squared, s.twice_area) &&
           !is_too_large(a, b, c, s.longest_squared, s.twice_area);
  });
}

/// Removes v if the triangles around it are good without it. Returns whether it did.
bool PatchRefiner::leave_out(std::uint32_t v, double flattest) {
  at_->remade.clear();
  take(v);
  if (are_remade_well(flattest)) {
    at_->taken.clear();
    return true;
  }
  put_back();
  return false;
}

/// Returns a place from which all of a ring is within reach, and with which no triangle is flatter than `flattest`.
std::optional<Vec2> PatchRefiner::place_within(std::span<const std::uint32_t> ring, Floor floor,
                                               double flattest) const {
  Vec2 p{};
  for (const std::uint32_t u : ring) p = p + mesh_.point(u);
  p = (1 / static_cast<double>(ring.size())) * p;
  const double least = floor.length() / chart_.scale(p);
  // The places move towards the middle of the smallest circle around the ring.
  for (int i = 1; i <= kPlaces; ++i) {
    Vec2 farthest = p;
    double nearest_squared = HUGE_VAL;
    for (const std::uint32_t u : ring) {
      const Vec2 q = mesh_.point(u);
      nearest_squared = std::min(nearest_squared, squared_length(q - p));
      if (squared_length(q - p) > squared_length(farthest - p)) farthest = q;
    }
    if (nearest_squared >= least * least) {
      const Fan fan = fan_of(p, ring);
      const auto is_within_reach = [&](Vec2 q) { return is_allowed(norm(q - p), 0.5 * (p + q)); };
      // The farthest vertex is tested first, because most places fail by it.
      if (fan.least_shape >= flattest && !fan.is_any_sharp && is_within_reach(farthest) &&
          std::all_of(ring.begin(), ring.end(), [&](std::uint32_t u) { return is_within_reach(mesh_.point(u)); }))
        return on_grid(p);
    }
    p = p + (1.0 / (i + 3)) * (farthest - p);
  }
  return std::nullopt;
}

/// Finds the ring around both v and w, where w is the k-th vertex of v's ring. Returns false if not all triangles
/// around w are good.
bool PatchRefiner::find_hole(std::uint32_t v, std::size_t k) {
  const std::vector<std::uint32_t>&ring = at_->ring, &other = at_->other_ring;
  if (!find_ring(ring[k], at_->other_ring)) return false;
  at_->hole.clear();
  const auto add = [&](const std::vector<std::uint32_t>& around, std::size_t from) {
    for (std::size_t i = 1; i + 1 < around.size(); ++i) at_->hole.push_back(around[(from + i) % around.size()]);
  };
  // The ring runs around v from behind w to before w, and then on around w.
  add(ring, k);
  add(other, static_cast<std::size_t>(std::find(other.begin(), other.end(), v) - other.begin()));
  return true;
}

/// Puts one point in the place of v and its neighbour w, if there is a place that serves both. `at_->hole` is the ring
/// around them.
/// Output: The new vertex, or kNone.
std::uint32_t PatchRefiner::merge(std::uint32_t v, std::uint32_t w, double flattest) {
  const Floor floor = std::min(Floor(value_[v]), Floor(value_[w]));
  const std::optional<Vec2> p = place_within(at_->hole, floor, flattest);
  if (!p) return kNone;
  at_->remade.clear();
  take(v);
  take(w);
  for (std::size_t i = 0; i < at_->remade.size(); ++i) {
    const std::uint32_t t = at_->remade[i];
    if (!mesh_.is_live(t) || !is_inside(t, *p)) continue;
    const auto is_good = [&](std::uint32_t u) { return state_[u] == State::kGood; };
    if (!mesh_.find_cavity(*p, t) || !std::all_of(mesh_.cavity().begin(), mesh_.cavity().end(), is_good)) break;
    const std::uint32_t merged = mesh_.fill_cavity(*p);
    note_remade();
    set_vertex(merged, SegmentId(), floor.packed());
    if (are_remade_well(flattest)) {
      at_->taken.clear();
      return merged;
    }
    mesh_.remove(merged);
    note_remade();
    break;
  }
  put_back();
  return kNone;
}

void PatchRefiner::thin_out(RunControl& control, RefinementProgress& progress) {
  if (!criteria_.has_sizes) return;
  const std::int64_t before = triangle_count();
  std::vector<std::uint32_t>&waiting = at_->to_thin, &ring = at_->ring;
  StackMemory memory;
  std::pmr::vector<std::uint8_t> is_waiting(mesh_.vertex_slots(), 0, &memory);
  const auto wait = [&](std::uint32_t v) {
    if (!is_free(v) || std::exchange(is_waiting[v], 1) != 0) return;
    waiting.push_back(v);
  };
  waiting.clear();
  const std::uint32_t first = do_sizes_vary() ? 0 : first_refined_;
  for (std::uint32_t v = mesh_.vertex_slots(); v-- > first;)
    if (mesh_.is_live_vertex(v)) wait(v);
  for (std::uint32_t steps = 1; !waiting.empty(); ++steps) {
    if (steps % 256 == 0) control.check();
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    is_waiting[v] = 0;
    if (!mesh_.is_live_vertex(v) || !find_ring(v, ring)) continue;
    const Vec2 p = mesh_.point(v);
    const auto is_short = [&](std::uint32_t u) { return is_allowed(norm(mesh_.point(u) - p) / kLongEnough, p); };
    const std::uint32_t nearest = *std::min_element(ring.begin(), ring.end(), [&](std::uint32_t a, std::uint32_t b) {
      return squared_length(mesh_.point(a) - p) < squared_length(mesh_.point(b) - p);
    });
    if (!is_short(nearest)) continue;
    const Fan fan = fan_of(p, ring);
    const double flattest = std::min(kFlattest, fan.least_shape);
    // Without v, there are two triangles less for the same area.
    const double side = std::sqrt(fan.twice_area / (static_cast<double>(ring.size()) - 2) * (2 / std::numbers::sqrt3));
    if (is_allowed(kAlmost * side, p) && leave_out(v, flattest)) {
      for (const std::uint32_t u : ring) wait(u);
      continue;
    }
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::uint32_t w = ring[k];
      // If w still waits, this pair is tried when it is its turn.
      if (!is_free(w) || is_waiting[w] != 0 || !is_short(w) || !find_hole(v, k)) continue;
      const double least = fan_of(mesh_.point(w), at_->other_ring).least_shape;
      const std::uint32_t merged = merge(v, w, std::min(flattest, least));
      if (merged == kNone) continue;
      for (const std::uint32_t u : at_->hole) wait(u);
      wait(merged);
      break;
    }
  }
  progress.add(std::int64_t{triangle_count()} - before);
}

}  // namespace remesh
