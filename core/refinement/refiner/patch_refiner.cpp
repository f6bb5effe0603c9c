#include "core/refinement/refiner/patch_refiner.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory_resource>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/patches/charts/curved_chart.h"
#include "core/refinement/refiner/patch_editor.h"
#include "core/refinement/refiner/patch_start.h"
#include "core/refinement/refiner/triangle_treatment.h"
#include "core/refinement/refiner/working_patch.h"
#include "core/refinement/segments/column_grid.h"

namespace remesh {
namespace {

/// A place for a point, and the distance of its column from the next one there. Both are in the plane of the chart.
struct ColumnPlace {
  Vec2 place;
  double spacing;
};

struct ColumnPlaces {
  Columns columns;
  std::vector<ColumnPlace> places;
};

/// Returns places for points of a curved patch, column after column.
/// Input:  a patch whose boundary is cut. `max_points` limits the result.
/// Output: places on the grid of the chart that may lie outside of the patch or near its boundary. None
///         if the surface has no axis or if there would be more than `max_points`.
/// Cost:   O(n) in the vertices of the patch and the points.
ColumnPlaces column_places(const WorkingPatch& patch, std::size_t max_points, RunControl& control) {
  ColumnPlaces result;
  const CurvedChart* const chart = patch.chart.curved();
  if (chart == nullptr) return result;
  StopCheck check(control);
  const auto position = [&](std::uint32_t v) { return patch.in_space[v].position; };
  std::vector<Vec3> vertices;
  for (std::uint32_t v = 0; v < patch.mesh.vertex_slots(); ++v) {
    check();
    if (patch.mesh.is_live_vertex(v)) vertices.push_back(position(v));
  }
  std::vector<std::array<Vec3, 2>> sides;
  for (std::uint32_t side = 0; side < patch.mesh.side_count(); ++side) {
    check();
    const std::uint32_t h = patch.mesh.half_edge_of_side(side);
    sides.push_back({position(patch.mesh.from(h)), position(patch.mesh.to(h))});
  }
  const ColumnGrid grid = column_grid(*chart, vertices, sides, control);
  if (!(grid.width > 0)) return result;
  result.columns = {grid.start, grid.width};
  if (!((grid.last - grid.first + 1) * (grid.rows / 2 + 1) <= static_cast<double>(max_points))) return result;
  for (double column = grid.first; column <= grid.last; ++column)
    for (double i = std::fmod(std::fabs(column), 2); i <= grid.rows; i += 2) {
      check();
      const Vec3 at = chart->map().point(SurfaceMap::Around{grid.start + column * grid.width, grid.low + i * grid.row});
      const Vec2 place = patch.chart.to_plane(at);
      result.places.push_back({place, grid.width * chart->map().radius(at) / patch.chart.scale(place)});
    }
  return result;
}

}  // namespace

PatchRefiner::PatchRefiner(const PatchToRefine& patch, const Criteria& criteria, const SegmentCuts::OfSegments& cuts,
                           std::uint64_t quota, RefinerScratch& scratch, RunControl& control)
    : original_(patch.mesh),
      memory_(first_block(patch.mesh, patch.segments.sides_of_patch(patch.id).size())),
      sizes_(patch, criteria, control),
      scratch_(&scratch),
      patch_(start_patch(patch, sizes_, cuts, quota, scratch.mesh, &memory_, control), patch, sizes_.chart(),
             &memory_) {
  begin_turn(scratch);
  PatchEditor editor(sizes_, patch_, scratch);
  editor.judge_all(control);
  const PatchBoundary& boundary = patch_.boundary;
  for (std::size_t c = 0; c < boundary.chain_count() && !patch_.impossible.is_valid(); ++c) {
    const SegmentId segment = boundary.segment_of_chain(c);
    if (!cuts[segment].empty()) editor.apply_cuts(segment, cuts[segment], control);
  }
  if (!criteria.has_sizes() && !patch.mesh.has_rulings) fill_columns(editor, quota, control);
  first_refined_ = patch_.mesh.vertex_slots();
}

/// Inserts the points of a curved patch's columns that are far enough from its boundary.
void PatchRefiner::fill_columns(PatchEditor& editor, std::uint64_t quota, RunControl& control) {
  if (patch_.mesh.triangle_count() == 0 || patch_.impossible.is_valid()) return;
  const ColumnPlaces filling =
      column_places(patch_, std::min<std::uint64_t>(quota / 2, std::uint64_t{1} << 27), control);
  patch_.columns = filling.columns;
  // Without a bound on angles, edges may run from one end of the patch to the other.
  if (sizes_.criteria().min_angle_deg == 0) return;
  std::uint32_t near = 0;
  for (const auto& [p, spacing] : filling.places) {
    control.check();
    while (!patch_.mesh.is_live(near)) near = (near + 1) % patch_.mesh.triangle_slots();
    const DelaunayMesh::Location at = patch_.mesh.locate(near, p);
    near = at.half_edge / 3;
    if (at.is_hidden) continue;
    const PointPlace place = patch_.look_at(p, near);
    if (!place.has_room() || is_near_boundary(place, spacing)) continue;
    const double floor = spacing * patch_.chart.scale(p) * 0x1p-6;
    editor.insert(place, MinSpacing::above(sizes_.criteria().min_edge_length, floor), Encroachment::kIgnore);
  }
}

/// Returns whether a place is so near to the boundary that a point there would make flat triangles.
bool PatchRefiner::is_near_boundary(const PointPlace& place, double spacing) const {
  constexpr double kFromVertices = 0.6, kFromEdges = 0.45;
  const Vec2 p = place.cavity.point;
  return std::any_of(place.cavity.rim.begin(), place.cavity.rim.end(), [&](const DelaunayMesh::RimEdge& e) {
    const Vec2 a = patch_.mesh.point(e.from), b = patch_.mesh.point(e.to);
    if (!patch_.is_free(e.from) && norm(a - p) < kFromVertices * spacing) return true;
    return DelaunayMesh::is_constrained(e) && std::fabs(cross(b - a, p - a)) < kFromEdges * spacing * norm(b - a);
  });
}

/// Returns a number of bytes that suffices for all data of most small patches.
std::size_t PatchRefiner::first_block(const PatchMesh& patch, std::size_t sides) {
  const std::size_t vertices = patch.vertices.size(), triangles = patch.mesh.triangle_count();
  constexpr std::size_t kVertex = sizeof(Vec2) + sizeof(std::uint32_t) + sizeof(VertexPlace),
                        kTriangle = 6 * sizeof(std::uint32_t) + sizeof(TriangleState),
                        kSide = sizeof(std::uint32_t) + sizeof(Cut);
  // All these arrays grow, so their sizes count twice.
  const std::size_t bytes =
      2 * (vertices * kVertex + triangles * kTriangle + sides * kSide) + PatchBoundary::usual_bytes(vertices, sides);
  // A patch that needs more memory has large arrays, and most of these get blocks of their own.
  constexpr std::size_t kMin = 256, kMax = 4096;
  return std::clamp(bytes, kMin, kMax);
}

void PatchRefiner::begin_turn(RefinerScratch& scratch) {
  scratch_ = &scratch;
  patch_.mesh.use(scratch.mesh);
  if (!is_done()) return;
  std::swap(patch_.waiting, scratch.waiting);
  constexpr std::uint32_t kFewTriangles = 64;
  patch_.waiting.clear(patch_.mesh.triangle_slots() > kFewTriangles ? 8 : 1);
}

void PatchRefiner::end_turn() {
  if (is_done()) scratch_->waiting = std::exchange(patch_.waiting, {});
}

bool PatchRefiner::has_work(const PatchMesh& patch, const PatchChart& chart, const Criteria& criteria) {
  if (!patch.reserved.empty() || chart.curved() != nullptr) return true;
  for (std::uint32_t t = 0; t < patch.mesh.triangle_count(); ++t) {
    const Vec2 p[3] = {patch.uv[patch.mesh.from(3 * t)], patch.uv[patch.mesh.from(3 * t + 1)],
                       patch.uv[patch.mesh.from(3 * t + 2)]};
    double longest_squared = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      longest_squared = std::max(longest_squared, dot(u, u));
      if (cross(u, v) < criteria.tangent * dot(u, v)) return true;
    }
    if (criteria.size_goal == SizeGoal::kVarying) return true;
    const double scale = chart.scale(p[0]);
    const double area = cross(p[1] - p[0], p[2] - p[0]) / 2;
    if (area * scale * scale > criteria.max_area) return true;
    if (std::sqrt(longest_squared) * scale > criteria.sizes.largest() * PatchSizes::kRoundingFactor) return true;
  }
  return false;
}

void PatchRefiner::apply_cuts(SegmentId segment, std::span<const double> cuts, const RunControl& control) {
  PatchEditor(sizes_, patch_, *scratch_).apply_cuts(segment, cuts, control);
}

bool PatchRefiner::split_edges(std::span<const std::uint32_t> half_edges, RunControl& control) {
  struct Edge {
    std::uint32_t half_edge, from, to;
  };
  const DelaunayMesh& mesh = patch_.mesh;
  StackMemory memory;
  std::pmr::vector<std::uint32_t> vertex(&memory), triangle(&memory);
  std::pmr::vector<Edge> edges(&memory);
  mesh.number(vertex, triangle);
  for (const std::uint32_t h : half_edges) {
    if (h / 3 >= triangle.size()) continue;
    const std::uint32_t here = 3 * triangle[h / 3] + h % 3;
    edges.push_back({here, mesh.from(here), mesh.to(here)});
  }
  PatchEditor editor(sizes_, patch_, *scratch_);
  bool is_any = false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i % 256 == 0) control.check_and_move();
    const auto& [h, from, to] = edges[i];
    if (!mesh.is_live(h / 3) || mesh.from(h) != from || mesh.to(h) != to || mesh.is_constrained(h)) continue;
    const Vec2 middle = sizes_.chart().on_grid(0.5 * (mesh.point(from) + mesh.point(to)));
    const MinSpacing spacing = std::min(patch_.spacing_of(from), patch_.spacing_of(to));
    is_any = editor.insert(middle, h / 3, spacing, Encroachment::kIgnore).is_done() || is_any;
  }
  return is_any;
}

void PatchRefiner::allow_above_bound(std::uint64_t steps) {
  is_turn_spent_ = false;
  allowed_above_bound_ = steps == 0 ? 0 : above_bound_ + steps;
}

void PatchRefiner::run(std::uint64_t quota, RefinementProgress& progress) {
  PatchEditor editor(sizes_, patch_, *scratch_);
  TriangleTreatment treatment(sizes_, patch_, editor);
  TriangleTask task;
  std::uint32_t told = triangle_count();
  std::uint64_t work = 0;
  const auto tell = [&] {
    const std::uint32_t now = triangle_count();
    progress.add(std::int64_t{now} - std::exchange(told, now));
  };
  const auto announce = [&](const TriangleTask& soon) {
    patch_.mesh.prefetch(soon.half_edge, {soon.a, soon.b, soon.c});
  };
  while (!is_turn_spent_ && editor.made() < quota && !patch_.impossible.is_valid() &&
         patch_.waiting.pop(task, announce)) {
    // Among many points on one circle, one step may visit as many triangles as there are points. So may a walk along a
    // needle.
    constexpr std::uint64_t kOften = 1024, kTrianglesOfStep = 8;
    const std::uint64_t visited = patch_.mesh.visited();
    treatment.treat(task);
    // A step may read the sizes at a hundred places.
    progress.check();
    work += 1 + (patch_.mesh.visited() - visited) / kTrianglesOfStep;
    if (work < kOften) continue;
    tell();
    take(std::exchange(work, 0));
  }
  take(work);
  tell();
}

/// Counts steps of the work. If there are too many, ends the turn or gives up.
void PatchRefiner::take(std::uint64_t steps) {
  work_.take(steps);
  const std::uint64_t bound = kWorkOfPatch.steps(0, triangle_count());
  above_bound_ = std::max(above_bound_, work_.taken() - std::min(work_.taken(), bound));
  if (work_.taken() <= bound || above_bound_ < allowed_above_bound_) return;
  if (allowed_above_bound_ == 0)
    give_up();
  else
    is_turn_spent_ = true;
}

/// Leaves all triangles in the queue as they are.
void PatchRefiner::give_up() {
  TriangleTask task;
  while (patch_.waiting.pop(task, [](const TriangleTask&) {})) {
    TriangleState& state = patch_.states[task.half_edge / 3];
    if (patch_.is_live(task) && state.is_waiting()) state = TriangleState(UnrefinedReason::kEffort);
  }
}

void PatchRefiner::thin_out(Thinning thinning, RunControl& control, RefinementProgress& progress) {
  if (!sizes_.criteria().is_thinned()) return;
  const std::int64_t before = triangle_count();
  PatchThinner(sizes_, patch_, *scratch_).thin_out(sizes_.do_vary() ? 0 : first_refined_, thinning, control);
  progress.add(std::int64_t{triangle_count()} - before);
}

PatchRefiner::Refined PatchRefiner::finish() const {
  Refined result;
  StackMemory memory;
  std::pmr::vector<std::uint32_t> vertex(&memory), triangle(&memory);
  result.patch.loops = original_.loops;
  result.patch.mesh = patch_.mesh.compact(vertex, triangle);
  result.patch.uv.reserve(vertex.size());
  result.patch.vertices.reserve(vertex.size());
  result.cuts.reserve(vertex.size());
  result.reason.reserve(triangle.size());
  for (const std::uint32_t v : vertex) {
    const VertexPlace& place = patch_.places[v];
    result.patch.uv.push_back(patch_.mesh.point(v));
    result.patch.vertices.push_back(place.is_original() ? original_.vertices[v] : VertexId());
    result.cuts.push_back(place.is_on_segment() ? Cut{place.segment(), place.parameter()} : Cut{SegmentId(), 0});
  }
  for (const std::uint32_t t : triangle) result.reason.push_back(reason_of(t));
  return result;
}

UnrefinedReason PatchRefiner::reason_of(std::uint32_t t) const {
  const TriangleState state = patch_.states[t];
  if (state.is_waiting()) return UnrefinedReason::kBudget;
  // A triangle that counts as good may be larger than the size that is asked for, because of a fixed side.
  if (state.is_good()) return sizes_.has_fixed_sides() ? sizes_.why_fixed() : UnrefinedReason::kSizeFloor;
  // A triangle at a sharp corner of the input may have a small angle, but must not be too large.
  const UnrefinedReason why = state.reason();
  const bool is_excused = why == UnrefinedReason::kInputAngle || why == UnrefinedReason::kAcrossInputAngle;
  if (!is_excused || !sizes_.has_fixed_sides()) return why;
  const TriangleJudge::Shape shape = TriangleJudge(sizes_, patch_).shape_of(t);
  const bool is_larger = sizes_.is_larger_than_asked(patch_.mesh.point(patch_.mesh.from(3 * t)), shape.measures);
  return is_larger ? sizes_.why_fixed() : why;
}

}  // namespace remesh
