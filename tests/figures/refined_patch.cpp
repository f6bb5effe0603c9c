#include "tests/figures/refined_patch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/pinched_vertices.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/refiner/patch_refiner.h"
#include "core/refinement/rounds/rounds.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/size_field.h"
#include "core/remesh.h"
#include "tests/figures/style.h"
#include "tests/figures/svg.h"

namespace remesh::figures {
namespace {

const Colour kBad{0.97, 0.80, 0.78};
const Colour kNeighbour{0.13, 0.53, 0.33};
constexpr double kLargestEdge = 6;

/// Returns whether the triangle has an angle below the angle with this tangent.
bool is_bad(Vec2 a, Vec2 b, Vec2 c, double tangent) {
  const auto is_sharp = [&](Vec2 at, Vec2 p, Vec2 q) { return cross(p - at, q - at) < tangent * dot(p - at, q - at); };
  return is_sharp(a, b, c) || is_sharp(b, c, a) || is_sharp(c, a, b);
}

class Figure {
 public:
  Figure(const Part& part, PatchId patch, RunControl& control) : part_(part), patch_(patch), control_(control) {
    const BoundaryLoops loops = boundary_loops(part.surface, part.adjacency, part.patches, control);
    const auto essential = essential_vertices(
        part.surface, part.adjacency, loops, IdVector<VertexId, std::uint8_t>(part.surface.vertex_count(), 0),
        pinched_vertices(part.surface, part.adjacency, control), part.tolerance, control);
    triangulated_ = mesh_patches(part.surface, part.adjacency, part.patches, loops, essential, {}, control);
    frozen_ = IdVector<PatchId, std::uint8_t>(triangulated_.size(), 0);
  }

  std::string draw() {
    const Goals goals = goals_of(Options{}, 0);
    tangent_ = std::tan(goals.min_angle_deg * std::numbers::pi / 180);
    const PatchMesh start = triangulated_.meshes[patch_];
    Panel before("before", count(start.mesh.triangle_count()) + " triangles; red: an angle below 25 degrees");
    draw_triangles(start, before);
    draw_points(start, start, start, before);

    const PatchMesh alone = refine_alone(goals);
    Panel first("round 1", "the patch alone: it also cuts its own boundary (orange)");
    draw_triangles(alone, first);
    draw_points(alone, start, alone, first);

    std::uint32_t rounds = 0;
    const PatchMesh refined = refine_all(goals, rounds);
    Panel last("round " + std::to_string(rounds),
               count(refined.mesh.triangle_count()) + " triangles, with the cuts that neighbours made (green)");
    draw_triangles(refined, last);
    draw_points(refined, start, alone, last);

    Options options;
    options.max_edge_length = kLargestEdge;
    const PatchMesh even = refine_all(goals_of(options, 0), rounds);
    Panel sizes("max_edge_length 6", "equal pieces on the boundary, a lattice inside");
    draw_triangles(even, sizes);
    return to_svg({before, first, last, sizes}, 420, 330);
  }

 private:
  SegmentTable segments_of(const SizeField& sizes, const Goals& goals) {
    SegmentTable segments(part_.surface, triangulated_, frozen_, sizes, goals, control_);
    segments.plan_cuts(triangulated_, sizes, goals, control_);
    return segments;
  }

  /// Refines the patch by itself, as in the first round, when no neighbour has made cuts yet.
  PatchMesh refine_alone(const Goals& goals) {
    const SizeField sizes(goals.max_edge_length);
    const SegmentTable segments = segments_of(sizes, goals);
    const IdVector<SegmentId, std::vector<double>> no_cuts(segments.size());
    constexpr std::uint64_t kNoQuota = std::numeric_limits<std::uint64_t>::max();
    const Criteria criteria(goals, sizes);
    RefinerScratch scratch;
    PatchRefiner refiner({triangulated_.meshes[patch_], triangulated_.charts[patch_], patch_, segments}, criteria,
                         no_cuts, kNoQuota, scratch, control_);
    RefinementProgress progress(control_, 0);
    refiner.run(kNoQuota, progress);
    return refiner.finish().patch;
  }

  PatchMesh refine_all(const Goals& goals, std::uint32_t& rounds) {
    PatchMeshes before = triangulated_.meshes;
    const SizeField sizes(goals.max_edge_length);
    const Prediction prediction = predict_faces(triangulated_, goals, sizes, control_);
    const RefinementInput input{part_.surface, frozen_,    goals,
                                sizes,         prediction, std::numeric_limits<std::uint64_t>::max()};
    rounds = refine(input, segments_of(sizes, goals), triangulated_, control_)->rounds;
    PatchMesh refined = std::move(triangulated_.meshes[patch_]);
    triangulated_.meshes = std::move(before);
    return refined;
  }

  void draw_triangles(const PatchMesh& patch, Panel& panel) const {
    const Triangulation2d& mesh = patch.mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      const Vec2 a = patch.uv[mesh.from(h)], b = patch.uv[mesh.to(h)], c = patch.uv[mesh.apex(h)];
      panel.polygon({a, b, c}, is_bad(a, b, c, tangent_) ? kBad : kPaper, mix(kInk, kFaint, 0.4), 0.6);
    }
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
      if (mesh.is_constrained(h)) panel.line(patch.uv[mesh.from(h)], patch.uv[mesh.to(h)], kOuter, 1.6);
  }

  /// Draws the vertices on the boundary in three styles: corners, cuts that `alone` has as well, and all other cuts.
  void draw_points(const PatchMesh& patch, const PatchMesh& start, const PatchMesh& alone, Panel& panel) const {
    std::vector<std::uint8_t> is_on_boundary(patch.uv.size(), 0);
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      if (patch.mesh.is_constrained(h)) is_on_boundary[patch.mesh.from(h)] = 1;
    const auto has = [](const PatchMesh& in, Vec2 p) {
      return std::find(in.uv.begin(), in.uv.end(), p) != in.uv.end();
    };
    for (std::size_t v = 0; v < patch.uv.size(); ++v) {
      if (is_on_boundary[v] == 0) continue;
      const Vec2 p = patch.uv[v];
      if (has(start, p))
        panel.dot(p, 2, kInk);
      else
        panel.dot(p, 2.6, has(alone, p) ? kHole : kNeighbour);
    }
  }

  const Part& part_;
  PatchId patch_;
  RunControl& control_;
  TriangulatedPatches triangulated_;  // all patches before refinement
  IdVector<PatchId, std::uint8_t> frozen_;
  double tangent_ = 0;  // of the bound on angles
};

}  // namespace

std::string refinement_of_patch(const Part& part, PatchId patch, RunControl& control) {
  return Figure(part, patch, control).draw();
}

std::string sharp_corner(RunControl& control) {
  constexpr double kDegrees = 5, kLength = 100, kBound = 25;
  const double angle = kDegrees * std::numbers::pi / 180, tangent = std::tan(kBound * std::numbers::pi / 180);
  PolygonMesh needle;
  needle.positions.push_back({0, 0, 0});
  needle.positions.push_back({kLength, 0, 0});
  needle.positions.push_back({kLength * std::cos(angle), kLength * std::sin(angle), 0});
  needle.face_begin = {0, 3};
  needle.corners = {VertexId(0), VertexId(1), VertexId(2)};
  const auto drawn = [&](double bound, const std::string& title, const std::string& caption) {
    Options options;
    options.max_edge_length = kLargestEdge;
    options.min_angle_deg = bound;
    const Result result = remesh_surface(needle, options, RunSettings{}, control);
    Panel panel(title, count(result.mesh.faces.size()) + " triangles" + caption);
    for (const auto& corners : result.mesh.faces) {
      std::vector<Vec2> at(corners.size());
      std::transform(corners.begin(), corners.end(), at.begin(), [&](VertexId v) {
        return Vec2{result.mesh.positions[v].x, result.mesh.positions[v].y};
      });
      panel.polygon(at, is_bad(at[0], at[1], at[2], tangent) ? kBad : kPaper, mix(kInk, kFaint, 0.4), 0.6);
    }
    return panel;
  };
  return to_svg({drawn(0, "max_edge_length 6", "; red: an angle below 25 degrees"),
                 drawn(kBound, "max_edge_length 6, min_angle_deg 25", ", in one row from the corner on")},
                620, 100);
}

}  // namespace remesh::figures
