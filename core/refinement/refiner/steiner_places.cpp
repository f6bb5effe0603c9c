#include "core/refinement/refiner/steiner_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace remesh {
namespace {

/// The number of heights that are tried, including the off-centre, in steps of kHeightStep of its height.
constexpr int kHeights = 5;
constexpr double kHeightStep = 1.0 / 8;
/// Edges that are to fill an area are aimed at this share of the longest edge that is allowed.
constexpr double kTargetShare = 0.85;

}  // namespace

Vec2 SteinerPlaces::off_centre(const TriangleJudge::Shape& shape) const {
  const std::uint32_t h = shape.shortest;
  const Vec2 a = mesh_.point(mesh_.from(h)), b = mesh_.point(mesh_.to(h)), c = mesh_.point(mesh_.apex(h));
  const Vec2 base = b - a, side = c - a;
  const double length = std::sqrt(shape.measures.shortest_squared);
  // The height of the circumcentre over the middle of the shortest edge.
  double height = dot(side, side - base) / (2 * shape.measures.twice_area) * length;
  const double limit = criteria_.off_centre * length;
  height = std::min(height, limit);
  const Vec2 middle = a + 0.5 * base;
  const Vec2 across{-base.y / length, base.x / length};
  const double wanted = kTargetShare * sizes_.for_new_triangle(a, middle + height * across);
  if (std::isfinite(wanted)) {
    const double fitting = wanted * wanted - shape.measures.shortest_squared / 4;
    height = std::min(height, std::sqrt(std::max(fitting, 0.5 * shape.measures.shortest_squared)));
  }
  return sizes_.chart().on_grid(middle + height * across);
}

/// Returns how many of the triangles between p and a rim's edges meet the bound on angles. If these are not more than
/// `count_to_beat`, the result is some number that is not more than it either.
int SteinerPlaces::count_good(std::span<const DelaunayMesh::RimEdge> rim, Vec2 p, int count_to_beat) const {
  int possible = static_cast<int>(rim.size());
  for (const DelaunayMesh::RimEdge& e : rim) {
    const TriangleMeasures m = measure_spanned(p, mesh_.point(e.from), mesh_.point(e.to));
    if (criteria_.is_sharp(m) && --possible <= count_to_beat) break;
  }
  return possible;
}

Vec2 SteinerPlaces::lowered(const DelaunayMesh::Cavity& of_off_centre, std::uint32_t shortest) const {
  const Vec2 p = of_off_centre.point;
  const std::span<const DelaunayMesh::RimEdge> rim = of_off_centre.rim;
  const Vec2 middle = 0.5 * (mesh_.point(mesh_.from(shortest)) + mesh_.point(mesh_.to(shortest)));
  Vec2 best = p;
  int best_count = count_good(rim, p, 0);
  for (int i = 1; i < kHeights && best_count < static_cast<int>(rim.size()); ++i) {
    const Vec2 place = p - (i * kHeightStep) * (p - middle);
    const int count = count_good(rim, place, best_count);
    if (count <= best_count) continue;
    best_count = count;
    best = place;
  }
  return sizes_.chart().on_grid(best);
}

/// Returns the effect that a point would have on its cavity. If it would make more than `max_more_bad` additional bad
/// triangles, the result only tells that they are more.
SteinerPlaces::InsertionOutcome SteinerPlaces::outcome(const DelaunayMesh::Cavity& cavity, int max_more_bad) const {
  const std::span<const DelaunayMesh::RimEdge> rim = cavity.rim;
  const Vec2 p = cavity.point;
  const auto is_bad = [&](std::uint32_t t) { return !patch_.states[t].is_good(); };
  const auto bad_before = std::count_if(cavity.triangles.begin(), cavity.triangles.end(), is_bad);
  InsertionOutcome found{-static_cast<int>(bad_before), HUGE_VAL};
  // A spoke is an edge from p to a vertex of the rim. Both triangles at a spoke need to know whether it is too long, so
  // the test is made once.
  std::optional<bool> first, here, next;
  const auto is_long_spoke = [&](std::uint32_t v, std::optional<bool>& known) {
    if (!known) known = sizes_.is_too_long(p, mesh_.point(v));
    return *known;
  };
  const auto is_long_edge = [&](const DelaunayMesh::RimEdge& e) {
    if (!DelaunayMesh::is_constrained(e) && !is_bad(e.outside / 3)) return false;
    return sizes_.is_too_long(mesh_.point(e.from), mesh_.point(e.to));
  };
  const CurvedChart* const curved = sizes_.chart().curved();
  const SpacePoint in_space = curved != nullptr ? curved->space_point(sizes_.chart().to_space(p)) : SpacePoint{};
  const auto is_bent_spoke = [&](std::uint32_t v) {
    return curved != nullptr && curved->is_bent(in_space, patch_.in_space[v]);
  };
  for (std::size_t i = 0; i < rim.size() && found.more_bad <= max_more_bad; ++i) {
    const DelaunayMesh::RimEdge& e = rim[i];
    const TriangleMeasures m = measure_spanned(p, mesh_.point(e.from), mesh_.point(e.to));
    next = i + 1 < rim.size() ? std::nullopt : first;
    found.more_bad +=
        criteria_.is_sharp(m) || sizes_.is_too_large_anywhere(p, m) || is_bent_spoke(e.from) || is_bent_spoke(e.to) ||
        (sizes_.do_vary() && (is_long_spoke(e.from, here) || is_long_spoke(e.to, next) || is_long_edge(e)));
    found.worst_shape = std::min(found.worst_shape, m.shape());
    if (i == 0) first = here;
    here = next;
  }
  return found;
}

bool SteinerPlaces::is_encroaching(const DelaunayMesh::Cavity& cavity) const {
  return std::any_of(cavity.rim.begin(), cavity.rim.end(), [&](const DelaunayMesh::RimEdge& e) {
    return DelaunayMesh::is_constrained(e) &&
           criteria_.is_encroached(cavity.point, mesh_.point(e.from), mesh_.point(e.to));
  });
}

Vec2 SteinerPlaces::best_for_size(Vec2 off_centre, std::uint32_t shortest) {
  const Vec2 a = mesh_.point(mesh_.from(shortest)), b = mesh_.point(mesh_.to(shortest)),
             c = mesh_.point(mesh_.apex(shortest));
  const Vec2 middle = 0.5 * (a + b), up = off_centre - middle, base = b - a, side = c - a;
  const double along = dot(side, side - base) / (2 * cross(base, side));
  const Vec2 circumcentre = middle + along * Vec2{-base.y, base.x};
  const std::array places{off_centre,
                          middle + 1.15 * up,
                          middle + 0.75 * up,
                          off_centre - 0.25 * base,
                          off_centre + 0.25 * base,
                          middle + 0.8 * up - 0.25 * base,
                          middle + 0.8 * up + 0.25 * base,
                          circumcentre,
                          (1.0 / 3) * (a + b + c),
                          0.5 * (b + c),
                          0.5 * (a + c)};
  Vec2 best = off_centre;
  InsertionOutcome best_outcome{std::numeric_limits<int>::max(), 0};
  for (Vec2 at : places) {
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    at = patch_.in_column(at);
    const PointPlace place = patch_.look_at(sizes_.chart().on_grid(at), shortest / 3);
    if (!place.has_room() || is_encroaching(place.cavity)) continue;
    const InsertionOutcome next = outcome(place.cavity, best_outcome.more_bad);
    if (next.more_bad > best_outcome.more_bad ||
        (next.more_bad == best_outcome.more_bad && !(next.worst_shape > best_outcome.worst_shape)))
      continue;
    best_outcome = next;
    best = place.cavity.point;
  }
  return best;
}

}  // namespace remesh
