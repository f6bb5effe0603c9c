#include "core/patches/meshing/patch_meshing.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "core/base/large_first.h"
#include "core/base/parallel.h"
#include "core/base/prefault_pages.h"
#include "core/base/ranked_ids.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/planes/projection.h"
#include "core/patch_types/patch_reason.h"
#include "core/patches/charts/rulings.h"
#include "core/triangulation/patch_triangulation.h"

namespace remesh {
namespace {

PatchReason reason_for(TriangulationOutcome outcome) {
  switch (outcome) {
    case TriangulationOutcome::kDone: return PatchReason::kNone;
    case TriangulationOutcome::kCrossingConstraints: return PatchReason::kSelfIntersectingLoop;
    case TriangulationOutcome::kInconsistentLoops: return PatchReason::kOverlappingFaces;
    case TriangulationOutcome::kDegenerate: return PatchReason::kNotPlanar;
  }
  return PatchReason::kNotPlanar;
}

/// The boundaries of patches, as far as vertices stay on them.
struct Outlines {
  const BoundaryLoops& loops;
  const EssentialVertices& essential;
  const CurveCuts* cuts;  ///< null if no patch is curved
};

/// Meshes one patch after the other, and reuses its scratch memory.
class Mesher {
 public:
  Mesher(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, const Outlines& outlines,
         PatchCharts& charts, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        patches_(patches),
        outlines_(outlines),
        charts_(charts),
        control_(control) {}

  PatchMesh run(PatchId p) {
    PatchMesh result;
    result.loops = outlines_.loops.patch_begin[p.value + 1] - outlines_.loops.patch_begin[p.value];
    if (outlines_.cuts == nullptr && is_triangle(p) && has_plain_loop(p)) {
      if (!project_triangle(p, result)) lay_out_triangle(p, result);
      return result;
    }
    collect_vertices(p);
    collect_sides(p);
    TriangulationOutcome outcome = TriangulationOutcome::kDegenerate;
    if (vertices_.size() >= 3) {
      outcome = attempt(p, kPatchGrid, result);
      if (outcome != TriangulationOutcome::kDone) outcome = attempt(p, kFineGrid, result);
    }
    if (outcome != TriangulationOutcome::kDone && is_triangle(p) && sides_.size() == 3) {
      lay_out_triangle(p, result);
      outcome = TriangulationOutcome::kDone;
    }
    result.reason = reason_for(outcome);
    return result;
  }

 private:
  using Side = std::array<VertexId, 2>;
  /// The place of one of the vertices in the plane.
  struct Flat {
    Vec2 uv;
    std::uint32_t index;
  };

  /// Collects the essential corners of the patch's faces: the corners on its loops, and the corners where another part
  /// of the surface touches its inside.
  void collect_vertices(PatchId p) {
    corners_.clear();
    StopCheck check(control_);
    const auto add = [&](VertexId v) {
      check();
      if (outlines_.essential[v]) corners_.push_back(v);
    };
    if (outlines_.essential.are_on_loops) {
      for (std::uint32_t l = outlines_.loops.patch_begin[p.value]; l < outlines_.loops.patch_begin[p.value + 1]; ++l)
        for (const std::uint32_t h : outlines_.loops.loop(l)) add(adjacency_.from(h));
      add_cuts(p, check);
    } else {
      for (const FaceId f : patches_.faces_of(p))
        for (const VertexId v : surface_.face(f)) add(v);
      add_cuts(p, check);
    }
    vertices_.assign(corners_, control_);
  }

  /// Adds the vertices between which the patch's boundary was cut anew.
  void add_cuts(PatchId p, StopCheck& check) {
    if (outlines_.cuts == nullptr) return;
    for (std::uint32_t l = outlines_.loops.patch_begin[p.value]; l < outlines_.loops.patch_begin[p.value + 1]; ++l)
      for (const std::uint32_t h : outlines_.loops.loop(l)) {
        check();
        if (!outlines_.essential[adjacency_.from(h)]) continue;
        for (const VertexId v : outlines_.cuts->between(h)) corners_.push_back(v);
      }
  }

  /// Collects the loops without the vertices that are not essential, and with the vertices of new cuts.
  void collect_sides(PatchId p) {
    sides_.clear();
    StopCheck check(control_);
    for (std::uint32_t l = outlines_.loops.patch_begin[p.value]; l < outlines_.loops.patch_begin[p.value + 1]; ++l) {
      VertexId first, last;
      for (const std::uint32_t h : outlines_.loops.loop(l)) {
        check();
        const VertexId v = adjacency_.from(h);
        if (!outlines_.essential[v]) continue;
        if (last.is_valid())
          sides_.push_back({last, v});
        else
          first = v;
        last = v;
        if (outlines_.cuts == nullptr) continue;
        for (const VertexId cut : outlines_.cuts->between(h)) {
          sides_.push_back({last, cut});
          last = cut;
        }
      }
      if (last.is_valid()) sides_.push_back({last, first});
    }
  }

  TriangulationOutcome attempt(PatchId p, double grid, PatchMesh& result) {
    points_.clear();
    for (const VertexId v : vertices_.ids()) points_.push_back(surface_.positions[v]);
    edges_.clear();
    for (const auto& [a, b] : sides_) edges_.push_back({surface_.positions[a], surface_.positions[b]});
    const PatchChart chart = charts_.project(p, points_, edges_, grid);

    const std::size_t n = vertices_.size();
    order_.resize(n);
    StopCheck check(control_);
    for (std::uint32_t i = 0; i < n; ++i) {
      check();
      order_[i] = {chart.to_plane(points_[i]), i};
    }
    sort_stoppable(order_.begin(), order_.end(), control_, [](const Flat& a, const Flat& b) { return a.uv < b.uv; });
    rank_.resize(n);
    result.vertices.resize(n);
    result.uv.resize(n);
    for (std::uint32_t k = 0; k < n; ++k) {
      check();
      const auto& [uv, i] = order_[k];
      if (k > 0 && uv == order_[k - 1].uv) return TriangulationOutcome::kCrossingConstraints;
      rank_[i] = k;
      result.vertices[k] = vertices_[i];
      result.uv[k] = uv;
    }
    segments_.clear();
    for (const auto& [a, b] : sides_) {
      check();
      segments_.push_back({rank_of(a), rank_of(b)});
    }
    PatchTriangulation triangulation;
    result.has_rulings = chart.curved() != nullptr && triangulate_strips(*chart.curved(), result, triangulation);
    if (!result.has_rulings) triangulation = triangulate_patch(result.uv, segments_, control_);
    result.mesh = std::move(triangulation.mesh);
    if (triangulation.outcome == TriangulationOutcome::kDone && result.mesh.triangle_count() == 0)
      return TriangulationOutcome::kInconsistentLoops;
    return triangulation.outcome;
  }

  /// Triangulates a curved patch whose rulings divide it into strips, in which no edge turns too far.
  /// Output: whether the rulings divide the patch.
  bool triangulate_strips(const CurvedChart& chart, const PatchMesh& patch, PatchTriangulation& triangulation) {
    StopCheck check(control_);
    positions_.clear();
    for (const VertexId v : patch.vertices) {
      check();
      positions_.push_back(surface_.positions[v]);
    }
    const std::vector<Segment> rulings = find_rulings(chart, {positions_, patch.uv, segments_}, control_);
    if (rulings.empty()) return false;
    std::vector<Segment> edges = segments_;
    for (const auto& [a, b] : rulings) {
      check();
      edges.push_back({a, b});
      edges.push_back({b, a});
    }
    triangulation = triangulate_patch(patch.uv, edges, control_);
    if (triangulation.outcome != TriangulationOutcome::kDone) return false;
    const Triangulation2d& mesh = triangulation.mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      check();
      if (mesh.is_constrained(h) || mesh.twin(h) < h) continue;
      if (chart.is_bent(chart.space_point(positions_[mesh.from(h)]), chart.space_point(positions_[mesh.to(h)])))
        return false;
    }
    return true;
  }

  /// The number of a vertex in the order of plane coordinates.
  std::uint32_t rank_of(VertexId v) const { return rank_[vertices_.rank(v)]; }

  bool is_triangle(PatchId p) const {
    return patches_.faces_of(p).size() == 1 && surface_.face(patches_.faces_of(p)[0]).size() == 3;
  }

  /// Returns whether a triangle has one loop, through all of its corners.
  bool has_plain_loop(PatchId p) const {
    const std::uint32_t loop = outlines_.loops.patch_begin[p.value];
    if (outlines_.loops.patch_begin[p.value + 1] != loop + 1) return false;
    const auto sides = outlines_.loops.loop(loop);
    return sides.size() == 3 && std::all_of(sides.begin(), sides.end(),
                                            [&](std::uint32_t h) { return outlines_.essential[adjacency_.from(h)]; });
  }

  /// Does what attempt() does for a triangle. There may be a million of them.
  /// Output: false if rounding turns the triangle over in its plane.
  bool project_triangle(PatchId p, PatchMesh& result) const {
    const auto sides = outlines_.loops.loop(outlines_.loops.patch_begin[p.value]);
    for (const double grid : {kPatchGrid, kFineGrid}) {
      const PatchChart chart = charts_.project(p, {}, {}, grid);
      std::array<Flat, 3> corners;
      for (std::uint32_t k = 0; k < 3; ++k)
        corners[k] = {chart.to_plane(surface_.positions[adjacency_.from(sides[k])]), k};
      if (orient2d(corners[0].uv, corners[1].uv, corners[2].uv) <= 0) continue;
      std::sort(corners.begin(), corners.end(), [](const Flat& a, const Flat& b) { return a.uv < b.uv; });
      std::array<std::uint32_t, 3> rank{};
      result.uv.reserve(3);
      result.vertices.reserve(3);
      for (std::uint32_t k = 0; k < 3; ++k) {
        rank[corners[k].index] = k;
        result.uv.push_back(corners[k].uv);
        result.vertices.push_back(adjacency_.from(sides[corners[k].index]));
      }
      result.mesh.reserve(1);
      const std::uint32_t h = result.mesh.add_triangle(rank[0], rank[1], rank[2]);
      for (std::uint32_t k = 0; k < 3; ++k) result.mesh.constrain(h + k);
      return true;
    }
    return false;
  }

  /// Lays a triangle into the plane along its longest side. Its height there is never 0, however thin it is, so the
  /// rounding of the projection cannot turn it over.
  void lay_out_triangle(PatchId p, PatchMesh& result) const {
    const std::array<VertexId, 3> corner = charts_.corners_from_longest(p);
    const PatchChart chart = charts_.lay_out(p);
    const Vec2 b = chart.to_plane(surface_.positions[corner[1]]), c = chart.to_plane(surface_.positions[corner[2]]);
    // In a needle, the third corner may come to lie before the first one or behind the second, because rounding decides
    // which of several nearly equal sides is the longest.
    const Vec2 uv_b{std::min(b.x, 1.0), 0};
    const Vec2 uv_c{std::clamp(c.x, -1.0, 1.0), std::max(c.y, chart.grid())};

    std::array<std::pair<Vec2, VertexId>, 3> points{{{{0, 0}, corner[0]}, {uv_b, corner[1]}, {uv_c, corner[2]}}};
    std::sort(points.begin(), points.end());
    result.vertices.clear();
    result.uv.clear();
    for (const auto& [uv, v] : points) {
      result.uv.push_back(uv);
      result.vertices.push_back(v);
    }
    const auto index = [&](VertexId v) {
      return static_cast<std::uint32_t>(std::find(result.vertices.begin(), result.vertices.end(), v) -
                                        result.vertices.begin());
    };
    result.mesh = {};
    const std::uint32_t h = result.mesh.add_triangle(index(corner[0]), index(corner[1]), index(corner[2]));
    for (std::uint32_t k = 0; k < 3; ++k) result.mesh.constrain(h + k);
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& patches_;
  const Outlines outlines_;
  PatchCharts& charts_;
  RunControl& control_;
  std::vector<VertexId> corners_;
  RankedIds<VertexId> vertices_;
  std::vector<Side> sides_;
  std::vector<Vec3> points_, positions_;
  std::vector<Edge3> edges_;
  std::vector<Flat> order_;
  std::vector<std::uint32_t> rank_;
  std::vector<Segment> segments_;
};

}  // namespace

TriangulatedPatches mesh_patches(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                                 const BoundaryLoops& loops, const EssentialVertices& essential,
                                 const ProjectionRule& rule, RunControl& control, const CurvedBoundaries* curves) {
  const std::size_t n = patches.count();
  TriangulatedPatches result;
  result.charts = PatchCharts(surface, patches, curves != nullptr ? &curves->patches : nullptr, rule, control);
  FreedInParallel<PatchMesh> all;
  std::vector<PatchMesh>& meshes = all.items;
  reserve_pages(meshes, n, control);
  meshes.resize(n);
  // Small patches are meshed in groups.
  const LargeFirst by_size = large_first(
      n, 1000, [&](std::uint32_t p) -> std::size_t { return patches.face_begin[p + 1] - patches.face_begin[p]; });
  std::atomic<std::size_t> done{0};
  const auto run = [&](std::size_t begin, std::size_t end) {
    control.check();
    Mesher mesher(surface, adjacency, patches, {loops, essential, curves != nullptr ? &curves->cuts : nullptr},
                  result.charts, control);
    for (std::size_t i = begin; i < end; ++i) meshes[by_size.order[i]] = mesher.run(PatchId(by_size.order[i]));
    control.progress(static_cast<double>(done += end - begin) / static_cast<double>(n));
  };
  for_all(0, by_size.large, [&](std::size_t i) { run(i, i + 1); });
  for_ranges(by_size.large, n, 256, run);
  result.meshes.items() = std::move(meshes);
  return result;
}

}  // namespace remesh
