#include "core/refinement/refiner/patch_editor.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {

void PatchEditor::judge_all(RunControl& control) {
  const std::uint32_t n = patch_.mesh.triangle_slots();
  patch_.states.reserve(2 * std::size_t{n});
  patch_.states.assign(n, TriangleState::waiting());
  StopCheck check(control);
  for (std::uint32_t t = 0; t < n; ++t) {
    check();
    judge_triangle(t);
  }
}

void PatchEditor::judge_triangle(std::uint32_t t) {
  const DelaunayMesh& mesh = patch_.mesh;
  if (!mesh.is_live(t)) return;
  const TriangleJudge::Shape shape = judge_.shape_of(t);
  TriangleState& state = patch_.states[t];
  if (!shape.is_sharp && !shape.is_too_large) {
    state = TriangleState::good();
    return;
  }
  const std::uint32_t h = shape.shortest;
  if (!shape.is_too_large)
    if (const auto why = judge_.excuse(h)) {
      state = TriangleState(*why);
      return;
    }
  state = TriangleState::waiting();
  patch_.wait({h, mesh.from(h), mesh.to(h), mesh.apex(h)}, shape.measures.shortest_squared);
}

void PatchEditor::judge_changed() {
  patch_.states.resize(patch_.mesh.triangle_slots(), TriangleState::waiting());
  // No new triangle counts as good before it has been judged, because the judgement of its neighbours relies on that.
  for (const std::uint32_t t : patch_.mesh.changed()) patch_.states[t] = TriangleState::waiting();
  for (const std::uint32_t t : patch_.mesh.changed()) judge_triangle(t);
}

Attempt PatchEditor::insert(const PointPlace& place, MinSpacing spacing, Encroachment encroachment) {
  std::vector<std::uint32_t>& encroached = scratch_.encroached;
  encroached.clear();
  if (place.is_hidden()) {
    encroached.push_back(place.hiding_side);
    return {Attempt::Result::kEncroached, encroached};
  }
  const Vec2 p = place.cavity.point;
  const double shortest = spacing.length / sizes_.chart().scale(p);
  bool is_near = false;
  for (const DelaunayMesh::RimEdge& e : place.cavity.rim) {
    const Vec2 a = patch_.mesh.point(e.from);
    is_near = is_near || dot(a - p, a - p) < shortest * shortest;
    if (DelaunayMesh::is_constrained(e) && sizes_.criteria().is_encroached(p, a, patch_.mesh.point(e.to)))
      encroached.push_back(DelaunayMesh::side(e));
  }
  if (encroachment != Encroachment::kIgnore) {
    // Over a piece that stays as long as it is, further points would only make flatter triangles.
    if (!encroached.empty() && (encroachment == Encroachment::kForbid || patch_.boundary.is_any_locked(encroached)))
      return {Attempt::Result::kEncroached, encroached};
    if (is_near) return {Attempt::Result::kTooNear, encroached};
  }
  if (!place.has_room()) return {Attempt::Result::kTooNear, encroached};
  patch_.set_place(patch_.mesh.fill_cavity(place.cavity), VertexPlace::free(spacing));
  made_ += 2;
  judge_changed();
  return {Attempt::Result::kDone, encroached};
}

/// Removes the free vertices inside the circle that has the piece as its diameter, one after the other.
void PatchEditor::clear_circle(std::uint32_t side) {
  DelaunayMesh& mesh = patch_.mesh;
  while (true) {
    const std::uint32_t h = mesh.half_edge_of_side(side);
    const std::uint32_t v = mesh.apex(h);
    if (!patch_.is_free(v)) return;
    const Vec2 p = mesh.point(v);
    if (!(dot(mesh.point(mesh.from(h)) - p, mesh.point(mesh.to(h)) - p) < 0)) return;
    mesh.remove(v);
    judge_changed();
  }
}

bool PatchEditor::cut_side(std::uint32_t side) {
  const std::optional<double> t = patch_.boundary.cut_of(side);
  if (!t || !cut_side_at(side, *t)) return false;
  const SegmentId segment = patch_.boundary.segment_of(side);
  patch_.own_cuts.push_back({segment, *t});
  made_ += patch_.boundary.cost_of_cut(segment);
  return true;
}

bool PatchEditor::cut_side_at(std::uint32_t side, double t) {
  PatchBoundary& boundary = patch_.boundary;
  const std::uint32_t partner = boundary.side(side).partner;
  const Vec2 p = sizes_.chart().to_plane(boundary.position(boundary.segment_of(side), t));
  const bool is_in_chain = boundary.is_in_chain(side);
  const std::uint32_t v = cut_one(side, t, p, kNone);
  if (v == kNone) return false;
  if (is_in_chain) boundary.add_to_chain(boundary.side_count() - 1);
  if (partner == kNone) return true;
  if (cut_one(partner, t, p, v) == kNone) return false;
  if (!is_in_chain) boundary.add_to_chain(boundary.side_count() - 1);
  boundary.pair_pieces(side, partner);
  return true;
}

/// Cuts one side, or the other side of a slit if `vertex` is the cut of the first one. Returns the vertex of the cut,
/// or kNone if rounding leaves no room for it.
std::uint32_t PatchEditor::cut_one(std::uint32_t side, double t, Vec2 p, std::uint32_t vertex) {
  const SegmentId segment = patch_.boundary.segment_of(side);
  clear_circle(side);
  const std::uint32_t v = patch_.mesh.cut(side, p, vertex);
  if (v == kNone) {
    patch_.impossible = segment;
    return v;
  }
  patch_.set_place(v, VertexPlace::on_segment(segment, t));
  patch_.boundary.split(side, t);
  judge_changed();
  return v;
}

void PatchEditor::apply_cuts(SegmentId segment, std::span<const double> cuts, const RunControl& control) {
  const PatchBoundary& boundary = patch_.boundary;
  boundary.list_pieces(segment, scratch_.pieces);
  // The cuts inside each piece are made by halves. The middle cut comes first, so that no vertex gets all of them as
  // neighbours.
  std::vector<RefinerScratch::Range>& ranges = scratch_.ranges;
  ranges.clear();
  for (const std::uint32_t piece : scratch_.pieces) {
    const auto first = std::upper_bound(cuts.begin(), cuts.end(), boundary.side(piece).t0);
    const auto last = std::lower_bound(first, cuts.end(), boundary.side(piece).t1);
    ranges.push_back(
        {piece, static_cast<std::size_t>(first - cuts.begin()), static_cast<std::size_t>(last - cuts.begin())});
  }
  while (!ranges.empty()) {
    control.check();
    const RefinerScratch::Range range = ranges.back();
    ranges.pop_back();
    if (range.first == range.last) continue;
    const std::size_t middle = range.first + (range.last - range.first) / 2;
    const std::uint32_t fresh = boundary.side_count();
    if (!cut_side_at(range.piece, cuts[middle])) return;
    const bool is_before = boundary.side(range.piece).t1 == cuts[middle];
    ranges.push_back({is_before ? range.piece : fresh, range.first, middle});
    ranges.push_back({is_before ? fresh : range.piece, middle + 1, range.last});
  }
}

}  // namespace remesh
