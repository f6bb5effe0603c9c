#include "core/refinement/patch_refiner.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/predicates.h"

namespace remesh {
namespace {

/// Refinement aims at angles that are larger than the bound by this number of degrees, because angles are measured in
/// space in the end, on rounded coordinates.
constexpr double kAngleMargin = 0.01;
/// An off-centre lies at kOffCentre times the height at which the new triangle just meets the bound. Including that
/// one, kHeights heights are tried, in steps of kHeightStep of it. Measured on stars and plates, this saves 6 to 30 %
/// of the faces compared with the best single height, 0.85. Where sizes vary, only that single height is used: more
/// angles near the bound would be worse for the tetrahedra behind thin walls.
constexpr double kOffCentre = 0.97;
constexpr double kOnlyOffCentre = 0.85;
constexpr int kHeights = 5;
constexpr double kHeightStep = 1.0 / 8;
/// Edges that are to fill an area are aimed at this share of the longest edge that is allowed.
constexpr double kTargetShare = 0.85;
/// Two distances along segments belong to the same shell if they differ by no more than this fraction.
constexpr double kSameShell = 1e-9;

double squared_length(Vec2 a) { return dot(a, a); }

}  // namespace

Criteria::Criteria(const Goals& goals, const SizeField& field)
    : has_sizes(!field.is_uniform() || std::isfinite(field.largest()) || std::isfinite(goals.max_area)),
      max_area(goals.max_area),
      min_angle_deg(goals.min_angle_deg),
      min_edge_length(goals.min_edge_length),
      split_boundaries(goals.split_boundaries),
      sizes(field) {
  // The filling uses a little less, since not all triangles are equilateral.
  area_edge = equilateral_edge(goals.max_area);
  even_size = std::min(field.largest(), 0.95 * area_edge);
  const double bound = goals.min_angle_deg > 0 ? (goals.min_angle_deg + kAngleMargin) * std::numbers::pi / 180 : 0;
  // Without a bound on angles, sizes alone must still not make slivers.
  constexpr double kUsualBound = 20 * std::numbers::pi / 180;
  const double shape = bound > 0 ? bound : kUsualBound;
  tangent = std::tan(bound);
  lens = std::cos(2 * shape) * std::cos(2 * shape);
  off_centre = (field.is_uniform() ? kOffCentre : kOnlyOffCentre) / (2 * std::tan(shape / 2));
}

bool PatchRefiner::has_work(const PatchMesh& patch, const PatchChart& chart, const Criteria& criteria) {
  if (!patch.held.empty()) return true;
  for (std::uint32_t t = 0; t < patch.mesh.triangle_count(); ++t) {
    const Vec2 p[3] = {patch.uv[patch.mesh.from(3 * t)], patch.uv[patch.mesh.from(3 * t + 1)],
                       patch.uv[patch.mesh.from(3 * t + 2)]};
    double longest_squared = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      longest_squared = std::max(longest_squared, squared_length(u));
      if (cross(u, v) < criteria.tangent * dot(u, v)) return true;
    }
    const double scale = chart.scale(p[0]);
    const double area = cross(p[1] - p[0], p[2] - p[0]) / 2;
    if (area * scale * scale > criteria.max_area) return true;
    if (!criteria.sizes.is_uniform()) return true;
    if (std::sqrt(longest_squared) * scale > criteria.sizes.largest() * kSizeMargin) return true;
  }
  return false;
}

// The following functions decide what is wrong with a triangle.

PatchRefiner::Shape PatchRefiner::shape_of(std::uint32_t t) const {
  const std::uint32_t h = 3 * t;
  const Vec2 a = mesh_.point(mesh_.from(h)), b = mesh_.point(mesh_.from(h + 1)), c = mesh_.point(mesh_.from(h + 2));
  const double squared[3] = {squared_length(b - a), squared_length(c - b), squared_length(a - c)};
  Shape shape;
  std::uint32_t k = squared[1] < squared[0] ? 1 : 0;
  if (squared[2] < squared[k]) k = 2;
  shape.shortest = h + k;
  shape.shortest_squared = squared[k];
  shape.longest_squared = std::max({squared[0], squared[1], squared[2]});
  shape.twice_area = cross(b - a, c - a);
  shape.is_sharp = is_sharp(squared[0] + squared[1] + squared[2], squared[k], shape.twice_area);
  // An edge of a good triangle is no longer than it may be, so it need not be measured again.
  const auto is_long = [&](std::uint32_t edge) {
    if (!mesh_.is_constrained(edge) && state_[mesh_.twin(edge) / 3] == State::kGood) return false;
    return is_too_long(mesh_.point(mesh_.from(edge)), mesh_.point(mesh_.to(edge)));
  };
  shape.is_too_large = is_too_large_anywhere(a, shape.longest_squared, shape.twice_area) ||
                       (do_sizes_vary() && (is_long(h) || is_long(h + 1) || is_long(h + 2)));
  return shape;
}

/// Returns whether a triangle has an angle below the bound. It is given by the sum of its squared edges, the square of
/// its shortest edge, and twice its area.
bool PatchRefiner::is_sharp(double squares, double shortest_squared, double twice_area) const {
  // The smallest angle is opposite the shortest edge. The product of the other two edges is 2 |u| |v| cos.
  return twice_area < criteria_.tangent * (squares - 2 * shortest_squared) / 2;
}

/// Returns whether a triangle, of which `at` is a corner, is larger than any may be.
bool PatchRefiner::is_too_large_anywhere(Vec2 at, double longest_squared, double twice_area) const {
  if (!criteria_.has_sizes || held_) return false;
  const double scale = chart_.scale(at);
  if (twice_area / 2 * scale * scale > criteria_.max_area) return true;
  return std::sqrt(longest_squared) * scale > criteria_.sizes.largest() * kSizeMargin;
}

/// Returns whether a triangle is larger than is asked for anywhere, even if the reason is a side that stays.
bool PatchRefiner::is_larger_than_asked(std::uint32_t t) const {
  const Shape shape = shape_of(t);
  const double scale = chart_.scale(mesh_.point(mesh_.from(3 * t)));
  return shape.twice_area / 2 * scale * scale > criteria_.max_area ||
         std::sqrt(shape.longest_squared) * scale > criteria_.sizes.largest();
}

bool PatchRefiner::is_too_large(Vec2 a, Vec2 b, Vec2 c, double longest_squared, double twice_area) const {
  if (is_too_large_anywhere(a, longest_squared, twice_area)) return true;
  if (!do_sizes_vary()) return false;
  return is_too_long(a, b) || is_too_long(b, c) || is_too_long(c, a);
}

/// An edge is compared with the size in its middle, as the pieces of segments are.
bool PatchRefiner::is_too_long(Vec2 a, Vec2 b) const { return !allows(norm(b - a) / kSizeMargin, 0.5 * (a + b)); }

/// Returns the longest edge that is allowed at a place. Both are in the plane.
double PatchRefiner::size_at(Vec2 p) const {
  const double size = criteria_.sizes.at(chart_.to_space(p)), scale = chart_.scale(p);
  return held_ ? std::max(std::min(size, criteria_.area_edge) / scale, held_->at(p)) : size / scale;
}

/// Returns whether an edge of that length is short enough wherever it lies within that radius of the place. All values
/// are in the plane.
bool PatchRefiner::allows(double length, Vec2 p, double radius) const {
  const double scale = chart_.scale(p);
  const bool is_small = !held_ || length * scale <= criteria_.area_edge;
  return (is_small && criteria_.sizes.allows(length * scale, chart_.to_space(p), radius * scale)) ||
         (held_ && held_->allow(length, p, radius));
}

bool PatchRefiner::is_at_input_angle(std::uint32_t shortest) const {
  const std::uint32_t left = DelaunayMesh::next(shortest), right = DelaunayMesh::previous(shortest);
  if (!mesh_.is_constrained(left) || !mesh_.is_constrained(right)) return false;
  if (mesh_.apex(shortest) >= corner_count_) return false;
  // The two other angles must meet the bound.
  for (const std::uint32_t h : {shortest, left}) {
    const Vec2 at = mesh_.point(mesh_.from(h));
    const Vec2 u = mesh_.point(mesh_.to(h)) - at, v = mesh_.point(mesh_.apex(h)) - at;
    if (cross(u, v) < criteria_.tangent * dot(u, v)) return false;
  }
  return true;
}

bool PatchRefiner::is_across_input_angle(std::uint32_t a, std::uint32_t b) const {
  if (is_free(a) || is_free(b)) return false;
  const auto is_same_shell = [&](double from_a, double from_b) {
    if (!(std::fabs(from_a - from_b) <= kSameShell * from_a)) return false;
    return norm(mesh_.point(a) - mesh_.point(b)) * chart_.scale(mesh_.point(a)) < from_a * (1 - kSameShell);
  };
  const auto segments_at = [&](std::uint32_t corner) {
    return std::pair(corner_segments_.begin() + corner_begin_[corner],
                     corner_segments_.begin() + corner_begin_[corner + 1]);
  };
  // Returns the distance from a vertex on a segment to one end of the segment.
  const auto distance_to = [&](std::uint32_t v, int end) {
    const double t = value_[v];
    return (end == 0 ? t : 1 - t) * segments_[segment_[v]].length;
  };
  const bool a_is_cut = a >= corner_count_, b_is_cut = b >= corner_count_;
  if (a_is_cut && b_is_cut) {
    if (segment_[a] == segment_[b]) return false;
    const BoundarySegment &s = segments_[segment_[a]], &u = segments_[segment_[b]];
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        if ((i == 0 ? s.from : s.to) == (j == 0 ? u.from : u.to) && is_same_shell(distance_to(a, i), distance_to(b, j)))
          return true;
    return false;
  }
  if (a_is_cut != b_is_cut) {
    const std::uint32_t cut = a_is_cut ? a : b, corner = a_is_cut ? b : a;
    const BoundarySegment& s = segments_[segment_[cut]];
    const auto [first, last] = segments_at(corner);
    for (int i = 0; i < 2; ++i) {
      const VertexId end = i == 0 ? s.from : s.to;
      const auto found =
          std::lower_bound(first, last, end, [](const CornerSegment& c, VertexId v) { return c.other < v; });
      if (found != last && found->other == end && found->segment != segment_[cut] &&
          is_same_shell(distance_to(cut, i), segments_[found->segment].length))
        return true;
    }
    return false;
  }
  // Both are corners. Look for a third corner to which both have segments.
  auto [first_a, last_a] = segments_at(a);
  auto [first_b, last_b] = segments_at(b);
  if (last_a - first_a > last_b - first_b) {
    std::swap(first_a, first_b);
    std::swap(last_a, last_b);
  }
  for (auto s = first_a; s != last_a; ++s) {
    const auto found =
        std::lower_bound(first_b, last_b, s->other, [](const CornerSegment& c, VertexId v) { return c.other < v; });
    if (found != last_b && found->other == s->other &&
        is_same_shell(segments_[s->segment].length, segments_[found->segment].length))
      return true;
  }
  return false;
}

/// Returns the reason why a triangle with that shortest edge may have a small angle, or kUnknown.
PatchRefiner::State PatchRefiner::excuse(std::uint32_t shortest) const {
  if (is_at_input_angle(shortest)) return State::kInputAngle;
  if (is_across_input_angle(mesh_.from(shortest), mesh_.to(shortest))) return State::kAcrossInputAngle;
  return State::kUnknown;
}

void PatchRefiner::classify(std::uint32_t t) {
  if (!mesh_.is_live(t)) return;
  const Shape shape = shape_of(t);
  if (!shape.is_sharp && !shape.is_too_large) {
    state_[t] = State::kGood;
    return;
  }
  const std::uint32_t h = shape.shortest;
  if (!shape.is_too_large) {
    state_[t] = excuse(h);
    if (state_[t] != State::kUnknown) return;
  }
  state_[t] = State::kUnknown;
  push({h, mesh_.from(h), mesh_.to(h), mesh_.apex(h)}, shape.shortest_squared);
}

void PatchRefiner::classify_changed() {
  state_.resize(mesh_.triangle_slots(), State::kUnknown);
  // No new triangle counts as good before it was looked at, because the triangles beside it rely on that.
  for (const std::uint32_t t : mesh_.changed()) state_[t] = State::kUnknown;
  for (const std::uint32_t t : mesh_.changed()) classify(t);
}

void PatchRefiner::push(const Task& task, double shortest_squared) {
  // The bits are the exponent and three bits of the mantissa, as the number stores them. Squared lengths within the
  // frame are at most 8.
  const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(shortest_squared) >> 49);
  constexpr std::int64_t kLargest = (1023 + 4) << 3;
  const auto queue = static_cast<std::size_t>(std::max<std::int64_t>(0, kLargest - bits));
  waiting_.push(queue, task);
}

// The following functions decide where points go, and what they meet there.

Vec2 PatchRefiner::steiner_point(const Shape& shape) const {
  const std::uint32_t h = shape.shortest;
  const Vec2 a = mesh_.point(mesh_.from(h)), b = mesh_.point(mesh_.to(h)), c = mesh_.point(mesh_.apex(h));
  const Vec2 base = b - a, side = c - a;
  const double length = std::sqrt(shape.shortest_squared);
  // This is the height of the circumcentre over the middle of the shortest edge.
  double height = dot(side, side - base) / (2 * shape.twice_area) * length;
  const double limit = criteria_.off_centre * length;
  height = std::min(height, limit);
  const Vec2 middle = a + 0.5 * base;
  const Vec2 across{-base.y / length, base.x / length};
  double size = std::min(criteria_.sizes.largest(), 1.5 * std::sqrt(criteria_.max_area)) / chart_.scale(a);
  if (held_)
    size = size_at(middle + height * across);
  else if (!criteria_.sizes.is_uniform())
    size = std::min(size, size_at(middle + height * across));
  const double wanted = kTargetShare * size;
  if (std::isfinite(wanted)) {
    const double fitting = wanted * wanted - shape.shortest_squared / 4;
    height = std::min(height, std::sqrt(std::max(fitting, 0.5 * shape.shortest_squared)));
  }
  return on_grid(middle + height * across);
}

bool PatchRefiner::is_encroached(Vec2 p, Vec2 a, Vec2 b) const {
  const Vec2 u = a - p, v = b - p;
  const double product = dot(u, v);
  return product < 0 && product * product > criteria_.lens * squared_length(u) * squared_length(v);
}

/// Returns how many triangles between p and the edges of the cavity that was found meet the bound. If there are not
/// more than `least`, it may return any number that is not more than `least`.
int PatchRefiner::count_good(Vec2 p, int least) const {
  int possible = static_cast<int>(mesh_.rim().size());
  for (const DelaunayMesh::RimEdge& e : mesh_.rim()) {
    const Spanned s = spanned(p, mesh_.point(e.from), mesh_.point(e.to));
    if (is_sharp(s.squares, s.shortest_squared, s.twice_area) && --possible <= least) break;
  }
  return possible;
}

/// Returns the best of several places from p down towards the shortest edge. A lower place may serve the edge's
/// neighbours too: along a straight chain of equal edges, one point serves three of them. The first place is taken with
/// which the most edges of p's cavity make good triangles.
Vec2 PatchRefiner::lowered(Vec2 p, std::uint32_t shortest) const {
  const Vec2 middle = 0.5 * (mesh_.point(mesh_.from(shortest)) + mesh_.point(mesh_.to(shortest)));
  Vec2 best = p;
  int most = count_good(p, 0);
  for (int i = 1; i < kHeights && most < static_cast<int>(mesh_.rim().size()); ++i) {
    const Vec2 place = p - (i * kHeightStep) * (p - middle);
    const int count = count_good(place, most);
    if (count <= most) continue;
    most = count;
    best = place;
  }
  return on_grid(best);
}

/// Returns the effect that p would have on the cavity that was found. If it would make more than `most` additional bad
/// triangles, the result only tells that they are more.
PatchRefiner::Outcome PatchRefiner::outcome(Vec2 p, int most) const {
  const std::span<const DelaunayMesh::RimEdge> rim = mesh_.rim();
  const auto is_bad = [&](std::uint32_t t) { return state_[t] != State::kGood; };
  const auto bad_before = std::count_if(mesh_.cavity().begin(), mesh_.cavity().end(), is_bad);
  Outcome found{-static_cast<int>(bad_before), HUGE_VAL};
  // A spoke is an edge from p to a vertex of the rim. Both triangles at a spoke need to know whether it is too long, so
  // this is looked up once.
  std::optional<bool> first, here, next;
  const auto is_long_spoke = [&](std::uint32_t v, std::optional<bool>& known) {
    if (!known) known = is_too_long(p, mesh_.point(v));
    return *known;
  };
  const auto is_long_edge = [&](const DelaunayMesh::RimEdge& e) {
    if (!DelaunayMesh::is_constrained(e) && !is_bad(e.outside / 3)) return false;
    return is_too_long(mesh_.point(e.from), mesh_.point(e.to));
  };
  for (std::size_t i = 0; i < rim.size() && found.more_bad <= most; ++i) {
    const DelaunayMesh::RimEdge& e = rim[i];
    const Spanned s = spanned(p, mesh_.point(e.from), mesh_.point(e.to));
    next = i + 1 < rim.size() ? std::nullopt : first;
    found.more_bad +=
        is_sharp(s.squares, s.shortest_squared, s.twice_area) ||
        is_too_large_anywhere(p, s.longest_squared, s.twice_area) ||
        (do_sizes_vary() && (is_long_spoke(e.from, here) || is_long_spoke(e.to, next) || is_long_edge(e)));
    found.least_shape = std::min(found.least_shape, s.twice_area / s.squares);
    if (i == 0) first = here;
    here = next;
  }
  return found;
}

bool PatchRefiner::is_encroaching(Vec2 p) const {
  return std::any_of(mesh_.rim().begin(), mesh_.rim().end(), [&](const DelaunayMesh::RimEdge& e) {
    return DelaunayMesh::is_constrained(e) && is_encroached(p, mesh_.point(e.from), mesh_.point(e.to));
  });
}

/// Returns the place, among some about p and about the triangle, that leaves the fewest bad triangles. Among equals it
/// is the one with the best shaped triangles. This matters beside a lattice whose edges are as long as they may be: a
/// point at the wrong place would make other edges too long, and so on across the whole lattice.
Vec2 PatchRefiner::best_for_size(Vec2 p, std::uint32_t shortest) {
  const Vec2 a = mesh_.point(mesh_.from(shortest)), b = mesh_.point(mesh_.to(shortest)),
             c = mesh_.point(mesh_.apex(shortest));
  const Vec2 middle = 0.5 * (a + b), up = p - middle, base = b - a, side = c - a;
  const double along = dot(side, side - base) / (2 * cross(base, side));
  const Vec2 circumcentre = middle + along * Vec2{-base.y, base.x};
  const std::array places{p,
                          middle + 1.15 * up,
                          middle + 0.75 * up,
                          p - 0.25 * base,
                          p + 0.25 * base,
                          middle + 0.8 * up - 0.25 * base,
                          middle + 0.8 * up + 0.25 * base,
                          circumcentre,
                          (1.0 / 3) * (a + b + c),
                          0.5 * (b + c),
                          0.5 * (a + c)};
  Vec2 best = p;
  Outcome least{std::numeric_limits<int>::max(), 0};
  for (const Vec2 at : places) {
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    const Place place = look_at(on_grid(at), shortest / 3);
    if (!place.has_room || is_encroaching(place.p)) continue;
    const Outcome next = outcome(place.p, least.more_bad);
    if (next.more_bad > least.more_bad || (next.more_bad == least.more_bad && !(next.least_shape > least.least_shape)))
      continue;
    least = next;
    best = place.p;
  }
  return best;
}

PatchRefiner::Place PatchRefiner::look_at(Vec2 p, std::uint32_t triangle) {
  const DelaunayMesh::Location at = mesh_.locate(triangle, p);
  return {p, at, !at.is_hidden && mesh_.find_cavity(p, at.half_edge / 3)};
}

PatchRefiner::Attempt PatchRefiner::insert(Vec2 p, std::uint32_t triangle, Floor floor, May may) {
  return insert(look_at(p, triangle), floor, may);
}

PatchRefiner::Attempt PatchRefiner::insert(const Place& place, Floor floor, May may) {
  at_->encroached.clear();
  if (place.at.is_hidden) {
    at_->encroached.push_back(mesh_.side(place.at.half_edge));
    return Attempt::kEncroached;
  }
  const Vec2 p = place.p;
  const double least = floor.length() / chart_.scale(p);
  bool is_near = false;
  for (const DelaunayMesh::RimEdge& e : mesh_.rim()) {
    const Vec2 a = mesh_.point(e.from);
    is_near = is_near || squared_length(a - p) < least * least;
    if (DelaunayMesh::is_constrained(e) && is_encroached(p, a, mesh_.point(e.to)))
      at_->encroached.push_back(DelaunayMesh::side(e));
  }
  if (may != May::kBeAnywhere) {
    // Over a piece that stays as long as it is, triangles would only get flatter.
    if (!at_->encroached.empty() && (may == May::kBeClear || is_any_locked(at_->encroached)))
      return Attempt::kEncroached;
    if (is_near) return Attempt::kTooNear;
  }
  if (!place.has_room) return Attempt::kTooNear;
  set_vertex(mesh_.fill_cavity(p), SegmentId(), floor.packed());
  quota_ -= std::min<std::uint64_t>(quota_, 2);
  classify_changed();
  return Attempt::kDone;
}

void PatchRefiner::set_vertex(std::uint32_t v, SegmentId segment, double value) {
  if (v == segment_.size()) {
    segment_.emplace_back();
    value_.push_back(0);
  }
  segment_[v] = segment;
  value_[v] = value;
}

bool PatchRefiner::split_edges(std::span<const std::uint32_t> half_edges, RunControl& control) {
  struct Edge {
    std::uint32_t half_edge, from, to;
  };
  StackMemory memory;
  std::pmr::vector<std::uint32_t> vertex(&memory), triangle(&memory);
  std::pmr::vector<Edge> edges(&memory);
  mesh_.number(vertex, triangle);
  for (const std::uint32_t h : half_edges) {
    if (h / 3 >= triangle.size()) continue;
    const std::uint32_t here = 3 * triangle[h / 3] + h % 3;
    edges.push_back({here, mesh_.from(here), mesh_.to(here)});
  }
  bool is_any = false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i % 256 == 0) control.check();
    const auto& [h, from, to] = edges[i];
    if (!mesh_.is_live(h / 3) || mesh_.from(h) != from || mesh_.to(h) != to || mesh_.is_constrained(h)) continue;
    const Vec2 middle = on_grid(0.5 * (mesh_.point(from) + mesh_.point(to)));
    const Floor floor = std::min(floor_of(from), floor_of(to));
    is_any = insert(middle, h / 3, floor, May::kBeAnywhere) == Attempt::kDone || is_any;
  }
  return is_any;
}

std::uint32_t PatchRefiner::longest_edge(std::uint32_t t) const {
  const auto squared = [&](std::uint32_t h) {
    return squared_length(mesh_.point(mesh_.to(h)) - mesh_.point(mesh_.from(h)));
  };
  std::uint32_t longest = 3 * t;
  for (const std::uint32_t h : {3 * t + 1, 3 * t + 2})
    if (squared(h) > squared(longest)) longest = h;
  return longest;
}

/// Splits a triangle that is too large wherever there is room: at its circumcentre or, as a last resort, in the middle
/// of its longest edge, or at its centroid if that edge is constrained. Returns whether it was split.
bool PatchRefiner::split_too_large(std::uint32_t t, Floor floor) {
  const std::uint32_t longest = longest_edge(t);
  const Vec2 a = mesh_.point(mesh_.from(longest)), b = mesh_.point(mesh_.to(longest)),
             c = mesh_.point(mesh_.apex(longest));
  const Vec2 base = b - a, side = c - a;
  const double along = dot(side, side - base) / (2 * cross(base, side));
  const Vec2 circumcentre = a + 0.5 * base + along * Vec2{-base.y, base.x};
  if (std::isfinite(along) && insert(on_grid(circumcentre), t, floor, May::kBeClear) == Attempt::kDone) return true;
  if (mesh_.is_constrained(longest))
    return insert(on_grid((1.0 / 3) * (a + b + c)), t, floor, May::kEncroach) == Attempt::kDone;
  return insert(on_grid(a + 0.5 * base), t, floor, May::kEncroach) == Attempt::kDone;
}

bool PatchRefiner::is_too_long_side(std::uint32_t h) const {
  return mesh_.is_constrained(h) && is_too_long(mesh_.point(mesh_.from(h)), mesh_.point(mesh_.to(h)));
}

/// Cuts a side of the triangle that is too long, if there is one that can be cut. Returns whether it did.
bool PatchRefiner::cut_too_long_side(std::uint32_t t) {
  if (criteria_.sizes.is_uniform()) return false;  // if sizes are uniform, all such sides are cut from the start
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (is_too_long_side(h) && cut_side(mesh_.side(h))) return true;
  return false;
}

/// Returns the reason why a triangle stays too large, if that is because of sides that cannot be cut. Either its
/// longest edge is such a side, or all of its edges that are too long are such sides.
std::optional<PatchRefiner::State> PatchRefiner::held_large(std::uint32_t t) const {
  // Returns the reason why a side cannot be cut, or nothing if it can be.
  const auto held_by = [&](std::uint32_t h) -> std::optional<State> {
    const Side& side = sides_[mesh_.side(h)];
    if (segments_.cut(segment_of(side), side.t0, side.t1)) return std::nullopt;
    return why_uncut(std::array{mesh_.side(h)}, why_near(floor_on(segment_of(side))));
  };
  const std::uint32_t longest = longest_edge(t);
  if (mesh_.is_constrained(longest) && (is_too_long_side(longest) || (!held_ && std::isfinite(criteria_.max_area))))
    return held_by(longest);
  std::optional<State> why;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    if (!is_too_long(mesh_.point(mesh_.from(h)), mesh_.point(mesh_.to(h)))) continue;
    const std::optional<State> here = mesh_.is_constrained(h) ? held_by(h) : std::nullopt;
    if (!here) return std::nullopt;
    why = why ? stronger(*why, *here) : *here;
  }
  return why;
}

/// Returns whether the triangle is still the one that was put into the queue.
bool PatchRefiner::is_live(const Task& task) const {
  const std::uint32_t h = task.half_edge;
  return mesh_.from(h) == task.a && mesh_.to(h) == task.b && mesh_.apex(h) == task.c;
}

void PatchRefiner::treat(const Task& task) {
  if (!is_live(task)) return;
  const std::uint32_t t = task.half_edge / 3;
  // The task may now name another triangle, of vertices that got the same numbers. That one may be good or have an
  // excuse.
  if (state_[t] != State::kUnknown) return;
  const Shape shape = shape_of(t);
  // A triangle that waits and is not too large has no excuse.
  const bool is_for_angle = shape.is_sharp && (!shape.is_too_large || excuse(shape.shortest) == State::kUnknown);
  const Floor floor = std::min(floor_of(task.a), floor_of(task.b));
  // An edge that is too long and cannot be cut keeps its triangle too large, whatever is put inside.
  const std::optional<State> hopeless = shape.is_too_large ? held_large(t) : std::nullopt;
  if (hopeless && !is_for_angle) {
    state_[t] = *hopeless;
    return;
  }
  // The cut of the side also divides the triangle.
  if (shape.is_too_large && !is_for_angle && (cut_too_long_side(t) || impossible_.is_valid())) return;
  const Vec2 p = steiner_point(shape);
  if (shape.is_too_large && !is_for_angle) {
    const Vec2 best = best_for_size(p, shape.shortest);
    if (best != p && insert(best, t, floor, May::kBeClear) == Attempt::kDone) return;
  }
  at_->encroached.clear();
  Attempt attempt = Attempt::kTooNear;
  if (std::isfinite(p.x) && std::isfinite(p.y)) {
    Place place = look_at(p, t);
    if (is_for_angle && place.has_room && criteria_.sizes.is_uniform()) {
      const Vec2 lower = lowered(p, shape.shortest);
      if (lower != p) place = look_at(lower, t);
    }
    attempt = insert(place, floor, May::kBeClear);
  }
  if (attempt == Attempt::kDone) return;
  State why = why_uncut(at_->encroached, why_near(floor));
  if (attempt == Attempt::kEncroached && is_for_angle) {
    bool is_cut = false;
    at_->to_cut.assign(at_->encroached.begin(), at_->encroached.end());
    for (const std::uint32_t side : at_->to_cut) {
      is_cut = cut_side(side) || is_cut;
      if (impossible_.is_valid()) return;
    }
    if (is_cut) {
      // The cut may have left the triangle as it was.
      if (is_live(task)) push(task, shape.shortest_squared);
      return;
    }
    why = why_uncut(at_->to_cut, why_near(floor_on(segment_of_side(at_->to_cut[0]))));
  }
  if (shape.is_too_large && !hopeless && split_too_large(t, floor)) return;
  state_[t] = why;
}

void PatchRefiner::run(std::uint64_t quota, RefinementProgress& progress) {
  quota_ = quota;
  Task task;
  std::uint32_t told = triangle_count();
  std::size_t work = 0;
  const auto tell = [&] {
    const std::uint32_t now = triangle_count();
    progress.add(std::int64_t{now} - std::exchange(told, now));
  };
  const auto announce = [&](const Task& soon) { mesh_.prefetch(soon.half_edge, {soon.a, soon.b, soon.c}); };
  while (quota_ > 0 && !impossible_.is_valid() && waiting_.pop(task, announce)) {
    // Among many points on one circle, one step may go through as many triangles as there are points.
    constexpr std::size_t kOften = 1024, kTrianglesOfStep = 8;
    if (work >= kOften) {
      tell();
      work = 0;
    }
    treat(task);
    work += 1 + mesh_.cavity().size() / kTrianglesOfStep;
  }
  tell();
}

PatchRefiner::Refined PatchRefiner::finish() const {
  Refined result;
  StackMemory memory;
  std::pmr::vector<std::uint32_t> vertex(&memory), triangle(&memory);
  result.patch.loops = patch_.loops;
  result.patch.mesh = mesh_.compact(vertex, triangle);
  result.patch.uv.reserve(vertex.size());
  result.patch.vertices.reserve(vertex.size());
  result.cuts.reserve(vertex.size());
  result.reason.reserve(triangle.size());
  for (const std::uint32_t v : vertex) {
    result.patch.uv.push_back(mesh_.point(v));
    result.patch.vertices.push_back(v < corner_count_ ? patch_.vertices[v] : VertexId());
    result.cuts.push_back(segment_[v].is_valid() ? Cut{segment_[v], value_[v]} : Cut{SegmentId(), 0});
  }
  // A triangle that counts as good may be larger than asked for, because of a side that stays.
  const State of_good = held_ ? held_as_ : State::kSizeFloor;
  for (const std::uint32_t t : triangle) {
    const State state = state_[t];
    // Input angles excuse small angles, but not sizes.
    const bool is_excused = state == State::kInputAngle || state == State::kAcrossInputAngle;
    const bool is_held_large = held_ && is_excused && is_larger_than_asked(t);
    result.reason.push_back(reason_of(state == State::kGood ? of_good : is_held_large ? held_as_ : state));
  }
  return result;
}

UnrefinedReason PatchRefiner::reason_of(State state) {
  switch (state) {
    case State::kInputAngle: return UnrefinedReason::kInputAngle;
    case State::kAcrossInputAngle: return UnrefinedReason::kAcrossInputAngle;
    case State::kMinEdge: return UnrefinedReason::kMinEdgeLength;
    case State::kLocked: return UnrefinedReason::kBoundaryLocked;
    case State::kUnknown: return UnrefinedReason::kBudget;
    case State::kGood:
    case State::kSizeFloor: break;
  }
  return UnrefinedReason::kSizeFloor;
}

}  // namespace remesh
