/// Points that refinement put in and does not need in the end: taken away, or two of them replaced by one.

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/predicates.h"
#include "core/refinement/patch_refiner.h"
#include "core/stages/projection.h"

namespace remesh {
namespace {

/// Points whose edges all are longer than this share of what is allowed stay: there is no room for fewer.
constexpr double kLongEnough = 0.82;
/// Area over the sum of squared edges, twice, of a triangle with two angles of 32 degrees: for fewer points none gets
/// flatter than this, nor than the flattest there was.
constexpr double kFlattest = 0.185;
/// A point with more edges, between small things far from it, stays. With angles of 15 degrees there are no more.
constexpr std::size_t kMostEdges = 24;
/// Places that are tried for one point instead of two.
constexpr int kPlaces = 6;

double squared_length(Vec2 a) { return dot(a, a); }

}  // namespace

double PatchRefiner::size_at(Vec2 p) const {
  const SizeField& sizes = criteria_.sizes;
  const double size = sizes.is_uniform() ? sizes.largest() : sizes.at(to_space(p));
  return std::min(size, criteria_.even_size) / patch_.frame.scale;
}

/// The vertices around v, counter-clockwise; false if they are too many, or a triangle there is not as it should be.
bool PatchRefiner::find_ring(std::uint32_t v, std::vector<std::uint32_t>& ring) const {
  ring.clear();
  const std::uint32_t first = mesh_.half_edge_at(v);
  std::uint32_t h = first;
  do {
    if (state_[h / 3] != State::kGood || ring.size() == kMostEdges) return false;
    ring.push_back(mesh_.to(h));
    h = mesh_.twin(DelaunayMesh::previous(h));
  } while (h != first);
  return true;
}

/// Of the triangles between p and a ring the least area over the sum of squared edges, twice; 0 if one misses the bound
/// on angles or is turned over.
double PatchRefiner::least_shape(Vec2 p, std::span<const std::uint32_t> ring) const {
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = mesh_.point(ring[i]), b = mesh_.point(ring[i + 1 < ring.size() ? i + 1 : 0]);
    const double squared[3] = {squared_length(b - a), squared_length(a - p), squared_length(b - p)};
    const double sum = squared[0] + squared[1] + squared[2], twice_area = cross(a - p, b - p);
    if (!(twice_area > 0) || is_sharp(sum, std::min({squared[0], squared[1], squared[2]}), twice_area)) return 0;
    least = std::min(least, twice_area / sum);
  }
  return least;
}

void PatchRefiner::note_remade() {
  state_.resize(mesh_.triangle_slots(), State::kGood);
  for (const std::uint32_t t : mesh_.changed()) {
    if (mesh_.is_live(t)) state_[t] = State::kGood;
    at_->remade.push_back(t);
  }
}

void PatchRefiner::take(std::uint32_t v) {
  at_->taken.push_back({v, mesh_.point(v), value_[v]});
  mesh_.remove(v);
  note_remade();
}

/// Puts all back that was taken: the triangulation of these points is one and the same, and they get their numbers
/// again.
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

/// Are all triangles that were remade since the first was taken within the bounds, and none flatter than that?
bool PatchRefiner::are_remade_well(double flattest) const {
  const double least = criteria_.min_edge_length / patch_.frame.scale;
  return std::all_of(at_->remade.begin(), at_->remade.end(), [&](std::uint32_t t) {
    if (!mesh_.is_live(t)) return true;
    const Shape shape = shape_of(t);
    return !shape.is_sharp && !shape.is_too_large && shape.twice_area >= flattest * shape.squares &&
           shape.shortest_squared >= least * least;
  });
}

/// Takes v away, if what is around it does without.
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

/// A place from which all of a ring is within reach, and no triangle is flatter than that.
std::optional<Vec2> PatchRefiner::place_within(std::span<const std::uint32_t> ring, double floor,
                                               double flattest) const {
  Vec2 p{};
  for (const std::uint32_t u : ring) p = p + mesh_.point(u);
  p = (1 / static_cast<double>(ring.size())) * p;
  const double most = size_at(p);
  // Towards the middle of the smallest circle around the ring.
  for (int i = 1; i <= kPlaces; ++i) {
    Vec2 farthest = p;
    double nearest_squared = HUGE_VAL;
    for (const std::uint32_t u : ring) {
      const Vec2 q = mesh_.point(u);
      nearest_squared = std::min(nearest_squared, squared_length(q - p));
      if (squared_length(q - p) > squared_length(farthest - p)) farthest = q;
    }
    if (squared_length(farthest - p) <= most * most && nearest_squared >= floor * floor &&
        least_shape(p, ring) >= flattest)
      return on_grid(p);
    p = p + (1.0 / (i + 3)) * (farthest - p);
  }
  return std::nullopt;
}

/// Puts one point in the place of v and its neighbour w, if there is one that does for both. `at_->hole`: the ring
/// around them. Output: the vertex, or kNone.
std::uint32_t PatchRefiner::merge(std::uint32_t v, std::uint32_t w, double flattest) {
  const double value = std::min(value_[v], value_[w]);
  const std::optional<Vec2> p = place_within(at_->hole, value / patch_.frame.scale, flattest);
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
    set_vertex(merged, SegmentId(), value);
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
  std::vector<std::uint32_t>&waiting = at_->to_thin, &ring = at_->ring, &other = at_->other_ring, &hole = at_->hole;
  StackMemory memory;
  std::pmr::vector<std::uint8_t> is_waiting(mesh_.vertex_slots(), 0, &memory);
  const auto wait = [&](std::uint32_t v) {
    if (!is_free(v) || std::exchange(is_waiting[v], 1) != 0) return;
    waiting.push_back(v);
  };
  waiting.clear();
  for (std::uint32_t v = mesh_.vertex_slots(); v-- > first_refined_;)
    if (mesh_.is_live_vertex(v)) wait(v);
  for (std::uint32_t steps = 1; !waiting.empty(); ++steps) {
    if (steps % 256 == 0) control.check();
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    is_waiting[v] = 0;
    if (!mesh_.is_live_vertex(v) || !find_ring(v, ring)) continue;
    const Vec2 p = mesh_.point(v);
    const double enough = kLongEnough * size_at(p);
    const auto is_short = [&](std::uint32_t u) { return squared_length(mesh_.point(u) - p) <= enough * enough; };
    if (std::none_of(ring.begin(), ring.end(), is_short)) continue;
    const double flattest = std::min(kFlattest, least_shape(p, ring));
    if (leave_out(v, flattest)) {
      for (const std::uint32_t u : ring) wait(u);
      continue;
    }
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::uint32_t w = ring[k];
      if (!is_free(w) || !is_short(w) || !find_ring(w, other)) continue;
      // Around v from behind w to before it, then on around w.
      hole.clear();
      const auto add = [&](const std::vector<std::uint32_t>& around, std::size_t from) {
        for (std::size_t i = 1; i + 1 < around.size(); ++i) hole.push_back(around[(from + i) % around.size()]);
      };
      add(ring, k);
      add(other, static_cast<std::size_t>(std::find(other.begin(), other.end(), v) - other.begin()));
      const std::uint32_t merged = merge(v, w, std::min(flattest, least_shape(mesh_.point(w), other)));
      if (merged == kNone) continue;
      for (const std::uint32_t u : hole) wait(u);
      wait(merged);
      break;
    }
  }
  progress.add(std::int64_t{triangle_count()} - before);
}

}  // namespace remesh
