#include "core/refinement/refiner/triangle_treatment.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace remesh {
namespace {

bool is_finite(Vec2 p) { return std::isfinite(p.x) && std::isfinite(p.y); }

}  // namespace

void TriangleTreatment::treat(const TriangleTask& task) {
  if (!patch_.is_live(task)) return;
  const std::uint32_t t = task.half_edge / 3;
  // The task may now name another triangle, whose vertices got the same numbers. That triangle may be good or have an
  // excuse.
  if (!patch_.states[t].is_waiting()) return;
  const TriangleJudge::Shape shape = judge_.shape_of(t);
  const MinSpacing spacing = std::min(patch_.spacing_of(task.a), patch_.spacing_of(task.b));
  // A triangle in the queue that is not too large has no excuse.
  if (shape.is_sharp && (!shape.is_too_large || !judge_.excuse(shape.shortest)))
    treat_angle(task, shape, spacing);
  else
    treat_size(t, shape, spacing);
}

/// Treats a triangle that has a small angle without an excuse. It may also be too large.
void TriangleTreatment::treat_angle(const TriangleTask& task, const TriangleJudge::Shape& shape, MinSpacing spacing) {
  const std::uint32_t t = task.half_edge / 3;
  Attempt attempt;
  if (const Vec2 p = places_.off_centre(shape); is_finite(p)) {
    if (insert_in_column(p, t, shape, spacing)) return;
    PointPlace place = patch_.look_at(p, t);
    if (place.has_room() && sizes_.criteria().are_lower_places_tried) {
      const Vec2 lower = places_.lowered(place.cavity, shape.shortest);
      if (lower != p) place = patch_.look_at(lower, t);
    }
    attempt = editor_.insert(place, spacing, Encroachment::kForbid);
  }
  if (attempt.is_done()) return;
  MinSpacing in_the_way = spacing;
  if (attempt.result == Attempt::Result::kEncroached) {
    if (cut_any(attempt.encroached)) {
      // The cut may have left the triangle as it was.
      if (!patch_.impossible.is_valid() && patch_.is_live(task)) patch_.wait(task, shape.measures.shortest_squared);
      return;
    }
    if (patch_.impossible.is_valid()) return;
    in_the_way = patch_.boundary.spacing_of(attempt.encroached.front());
  }
  const UnrefinedReason why = patch_.boundary.why_uncut(attempt.encroached, why_near(in_the_way));
  // An edge that is too long and cannot be cut keeps its triangle too large, whatever point is inserted.
  if (shape.is_too_large && !judge_.why_it_stays_large(t) && split_too_large(t, spacing)) return;
  patch_.states[t] = TriangleState(why);
}

/// Treats a triangle that is only too large, or whose small angle has an excuse. The inserted point never cuts a side
/// that is short enough.
void TriangleTreatment::treat_size(std::uint32_t t, const TriangleJudge::Shape& shape, MinSpacing spacing) {
  assert(shape.is_too_large);
  if (const auto hopeless = judge_.why_it_stays_large(t)) {
    patch_.states[t] = TriangleState(*hopeless);
    return;
  }
  // The cut of the side also divides the triangle.
  if (cut_too_long_side(t) || patch_.impossible.is_valid()) return;
  const Vec2 p = places_.off_centre(shape);
  const Vec2 best = places_.best_for_size(p, shape.shortest);
  if (best != p && editor_.insert(best, t, spacing, Encroachment::kForbid).is_done()) return;
  Attempt attempt;
  if (is_finite(p)) attempt = editor_.insert(p, t, spacing, Encroachment::kForbid);
  if (attempt.is_done()) return;
  const UnrefinedReason why = patch_.boundary.why_uncut(attempt.encroached, why_near(spacing));
  if (split_too_large(t, spacing)) return;
  patch_.states[t] = TriangleState(why);
}

/// Inserts a point on the column next to a place, if this removes the triangle and makes no edge that is shorter than
/// those of the triangle. Returns whether it did.
bool TriangleTreatment::insert_in_column(Vec2 p, std::uint32_t t, const TriangleJudge::Shape& shape,
                                         MinSpacing spacing) {
  if (!(patch_.columns.width > 0)) return false;
  const PointPlace place = patch_.look_at(patch_.in_column(p), t);
  if (place.is_hidden() || !place.has_room()) return false;
  const auto& removed = place.cavity.triangles;
  if (std::find(removed.begin(), removed.end(), t) == removed.end()) return false;
  const auto makes_short_edge = [&](const DelaunayMesh::RimEdge& e) {
    const Vec2 way = patch_.mesh.point(e.from) - place.cavity.point;
    return dot(way, way) < shape.measures.shortest_squared;
  };
  if (std::any_of(place.cavity.rim.begin(), place.cavity.rim.end(), makes_short_edge)) return false;
  return editor_.insert(place, spacing, Encroachment::kForbid).is_done();
}

/// Cuts sides until rounding leaves no room for a cut. Returns whether any of them was cut.
bool TriangleTreatment::cut_any(std::span<const std::uint32_t> sides) {
  bool is_any = false;
  for (const std::uint32_t side : sides) {
    is_any = editor_.cut_side(side) || is_any;
    if (patch_.impossible.is_valid()) break;
  }
  return is_any;
}

/// Cuts a side of the triangle that is too long, if there is one that can be cut. Returns whether it did.
bool TriangleTreatment::cut_too_long_side(std::uint32_t t) {
  if (sizes_.criteria().are_long_sides_cut_first) return false;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (judge_.is_too_long_side(h) && editor_.cut_side(patch_.mesh.side(h))) return true;
  return false;
}

/// Splits a triangle that is too large wherever there is room: at its circumcentre or, as a last resort, in the middle
/// of its longest edge, or at its centroid if that edge is constrained. Returns whether it was split.
bool TriangleTreatment::split_too_large(std::uint32_t t, MinSpacing spacing) {
  const DelaunayMesh& mesh = patch_.mesh;
  const PatchChart& chart = sizes_.chart();
  const std::uint32_t longest = judge_.longest_edge(t);
  const Vec2 a = mesh.point(mesh.from(longest)), b = mesh.point(mesh.to(longest)), c = mesh.point(mesh.apex(longest));
  const Vec2 base = b - a, side = c - a;
  const double along = dot(side, side - base) / (2 * cross(base, side));
  const Vec2 circumcentre = a + 0.5 * base + along * Vec2{-base.y, base.x};
  if (std::isfinite(along) && editor_.insert(chart.on_grid(circumcentre), t, spacing, Encroachment::kForbid).is_done())
    return true;
  const Vec2 last_resort = mesh.is_constrained(longest) ? (1.0 / 3) * (a + b + c) : a + 0.5 * base;
  return editor_.insert(chart.on_grid(last_resort), t, spacing, Encroachment::kAllow).is_done();
}

}  // namespace remesh
