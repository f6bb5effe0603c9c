#include "core/refinement/adjustment/volume_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/surfaces/surface_offset.h"
#include "core/triangulation/delaunay_flips.h"

namespace remesh {
namespace {

/// Newton's method ends when the volume of a surface misses its goal by at most this part of the sum over its
/// triangles.
constexpr double kExact = 0x1p-46;
/// After the last step, the volume may miss its goal by at most this part.
constexpr double kMet = 0x1p-36;
/// Neighbours share vertices, so that they need some more steps than a single surface. Neighbours that share so many
/// vertices that these steps are too few are joined.
constexpr int kMaxSteps = 30;

/// A surface is not fitted if its movable vertices change the volume by less than this part of the change by all its
/// vertices: they would have to move too far.
constexpr double kMinFreedom = 0.1;

/// Triangles keep their shapes if offsets change by no more than this part. If only vertices inside of a surface move,
/// they move along normals, which changes angles less.
constexpr double kNear = 0.03, kNearInside = 0.1;

/// Boundaries stay if the vertices inside cause at least this part of the change by all vertices.
constexpr double kInnerShare = 0.4;

/// The moves of all vertices that curved patches use.
struct FitMoves {
  OffsetMoves moves;
  std::vector<std::uint8_t> is_inner;  ///< one per vertex with moves: it is inside a patch
};

FitMoves find_moves(const FitInput& input, const PatchMeshes& meshes, const std::vector<Vec3>& new_positions,
                    RunControl& control) {
  const std::size_t known = input.surface.vertex_count();
  StopCheck check(control);
  std::vector<std::uint8_t> is_curved(known + new_positions.size(), 0);
  std::vector<std::pair<VertexId, PatchId>> patches;
  for (const bool is_first_pass : {true, false})
    for (PatchId p(0); p.value < meshes.size(); ++p.value) {
      if (is_first_pass && input.curved.of(p) == nullptr) continue;
      for (const VertexId v : meshes[p].vertices) {
        check();
        if (is_first_pass)
          is_curved[v.value] = 1;
        else if (v.value >= known && is_curved[v.value] != 0)
          patches.push_back({v, p});
      }
    }
  sort_stoppable(patches.begin(), patches.end(), control);
  FitMoves found;
  std::size_t next = 0;
  for (std::size_t i = 0; i < is_curved.size(); ++i) {
    check();
    if (is_curved[i] == 0) continue;
    const VertexId v(i);
    if (i < known) {
      const OffsetMoves& of_boundaries = input.fit.moves();
      const std::size_t at = of_boundaries.find(v);
      found.moves.add(v, input.surface.positions[v],
                      at < of_boundaries.size() ? of_boundaries.moves(at) : std::span<const OffsetMove>());
      found.is_inner.push_back(0);
      continue;
    }
    OffsetSite site;
    const std::size_t first = next;
    for (; next < patches.size() && patches[next].first == v; ++next) {
      const PatchId p = patches[next].second;
      if (const CurvedPatch* patch = input.curved.of(p))
        site.surfaces.push_back(patch->surface);
      else
        site.planes.push_back(input.patches.planes[p].normal);
    }
    sort_unique(site.surfaces);
    found.moves.add(v, new_positions[i - known], site, input.curved.surfaces);
    found.is_inner.push_back(next - first == 1 ? 1 : 0);
  }
  return found;
}

/// A triangle of a surface, or of a ribbon between its chords and its boundary as it is.
struct FitTriangle {
  std::array<std::uint32_t, 3> corners;  ///< indices of points
  bool is_ribbon = false;
};

/// The triangles of one surface.
struct FitSurface {
  SurfaceId surface;
  Vec3 centre;  ///< in local units
  std::vector<FitTriangle> triangles;
};

/// The sums over the triangles of a group of surfaces. The offsets of a group change by their scales times one factor.
struct FitSum {
  double missing = 0, magnitude = 0;
  double slope = 0;          ///< change of the enclosed volume or area per change of the factor
  double largest_slope = 0;  ///< the same if all vertices moved along normals

  void add(const FitSum& other) {
    missing += other.missing;
    magnitude += other.magnitude;
    slope += other.slope;
    largest_slope += other.largest_slope;
  }
};

class Fitter {
 public:
  Fitter(const FitInput& input, const TriangulatedPatches& triangulated, const std::vector<Vec3>& new_positions,
         RunControl& control)
      : input_(input),
        triangulated_(triangulated),
        found_(find_moves(input, triangulated.meshes, new_positions, control)),
        moves_(found_.moves),
        check_(control),
        control_(control) {
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      check_();
      start_.push_back(local(moves_.place(i)));
    }
    collect_triangles();
    if (input.is_refined) keep_boundaries();
  }

  FittedVolumes run() {
    FittedVolumes result;
    find_neighbours();
    largest_moves_ = largest_levers();
    allowed_.assign(largest_moves_.size(), HUGE_VAL);
    for (const CurvedPatch& patch : input_.curved.curved)
      allowed_[patch.surface] = std::min(allowed_[patch.surface], patch.limits.tolerance);
    UnionFind groups(surfaces_.size());
    std::vector<std::uint8_t> is_met;
    do {
      solve(groups, result.offsets);
      is_met = find_met_goals(groups, result.offsets);
    } while (join_with_neighbours(is_met, groups));
    const IdVector<SurfaceId, double>& estimates = input_.fit.offsets();
    result.outside = largest_moves_;
    result.better = result.offsets;
    for (SurfaceId s(0); s.value < result.outside.size(); ++s.value) result.outside[s] *= result.offsets[s];
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      const SurfaceId s = surfaces_[i].surface;
      const double offset = result.offsets[s], change = std::fabs(offset - estimates[s]);
      if (is_met[groups.find(i)] == 0) result.impossible.push_back(s);
      const bool keeps_boundary = !keeps_boundary_.empty() && keeps_boundary_[s] != 0;
      // Without goals, and inside of an anchored surface, vertices may move farther.
      if (input_.fit.is_anchored(s) && (keeps_boundary || !input_.is_refined)) {
        result.better[s] = estimates[s];
        continue;
      }
      const double near = keeps_boundary ? kNearInside : kNear;
      if (!(change <= near * std::max(std::fabs(offset), std::fabs(estimates[s])))) result.is_near = false;
    }
    result.moves = std::move(moves_);
    return result;
  }

 private:
  const OffsetGoal& goal(const FitSurface& of) const { return input_.fit.goals()[of.surface]; }
  Vec3 local(const Vec3& p) const { return (1 / input_.surface.unit) * (p - input_.surface.centre); }
  const AnalyticSurface& shape(SurfaceId s) const { return input_.curved.surfaces.surfaces[s].shape; }

  /// Returns the max distance by which an offset of 1 moves the vertices of each surface.
  IdVector<SurfaceId, double> largest_levers() const {
    IdVector<SurfaceId, double> levers(input_.fit.goals().size(), 0);
    for (std::size_t i = 0; i < moves_.size(); ++i)
      for (const OffsetMove& move : moves_.moves(i))
        levers[move.surface] = std::max(levers[move.surface], offset_lever(shape(move.surface), moves_.place(i)));
    return levers;
  }

  /// Drops the moves of vertices on the boundaries of surfaces that have enough vertices inside. Then planes beside
  /// them keep their triangles.
  void keep_boundaries() {
    UnionFind alone(surfaces_.size());
    add_up(alone, input_.fit.offsets());
    const std::vector<FitSum> of_all = sums_;
    const auto without = [&](const auto& is_dropped) {
      OffsetMoves kept;
      std::vector<OffsetMove> moves;
      for (std::size_t i = 0; i < found_.moves.size(); ++i) {
        check_();
        moves.clear();
        for (const OffsetMove& move : found_.moves.moves(i))
          if (found_.is_inner[i] != 0 || !is_dropped(move.surface)) moves.push_back(move);
        kept.add(found_.moves.vertex(i), found_.moves.place(i), moves);
      }
      return kept;
    };
    moves_ = without([](SurfaceId) { return true; });
    add_up(alone, input_.fit.offsets());
    keeps_boundary_.assign(input_.fit.goals().size(), 0);
    for (std::size_t i = 0; i < surfaces_.size(); ++i)
      if (std::fabs(sums_[i].slope) >= kInnerShare * std::fabs(of_all[i].slope))
        keeps_boundary_[surfaces_[i].surface] = 1;
    moves_ = without([&](SurfaceId s) { return keeps_boundary_[s] != 0; });
  }

  /// Finds the pairs of surfaces that share vertices which may move.
  void find_neighbours() {
    IdVector<SurfaceId, std::uint32_t> at(input_.fit.goals().size(), kNone);
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) at[surfaces_[i].surface] = i;
    for (std::size_t v = 0; v < moves_.size(); ++v)
      for (const OffsetMove& one : moves_.moves(v))
        for (const OffsetMove& other : moves_.moves(v)) {
          check_();
          const std::uint32_t i = at[one.surface], j = at[other.surface];
          // Volumes cannot be added to areas.
          if (i < j && j != kNone && goal(surfaces_[i]).is_area == goal(surfaces_[j]).is_area)
            neighbours_.push_back({i, j});
        }
    sort_unique(neighbours_, control_);
  }

  /// Adds to the offsets of each group their scales times one factor, so that the group as a whole meets its goals.
  void solve(UnionFind& groups, IdVector<SurfaceId, double>& offsets) {
    offsets = input_.fit.offsets();
    for (int step = 0; step < kMaxSteps; ++step) {
      control_.check();
      add_up(groups, offsets);
      bool is_exact = true;
      for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
        const FitSum& sum = sums_[groups.find(i)];
        if (!(std::fabs(sum.missing) > kExact * sum.magnitude)) continue;
        if (!(std::fabs(sum.slope) > kMinFreedom * sum.largest_slope)) continue;
        is_exact = false;
        offsets[surfaces_[i].surface] += sum.missing / sum.slope * input_.fit.scales()[surfaces_[i].surface];
      }
      if (is_exact) return;
    }
    add_up(groups, offsets);
  }

  /// Adds up the volume or area that the triangles of each group enclose.
  void add_up(UnionFind& groups, const IdVector<SurfaceId, double>& offsets) {
    place_points(offsets);
    group_of_.assign(input_.fit.goals().size(), kNone);
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) group_of_[surfaces_[i].surface] = groups.find(i);
    std::vector<FitSum> of_surface(surfaces_.size());
    for_blocks(surfaces_.size(), 1, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) add_surface(surfaces_[i], of_surface[i]);
    });
    sums_.assign(surfaces_.size(), {});
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) sums_[groups.find(i)].add(of_surface[i]);
  }

  /// Returns for each group, under its representative, whether its goal is met within the tolerances.
  std::vector<std::uint8_t> find_met_goals(UnionFind& groups, const IdVector<SurfaceId, double>& offsets) {
    std::vector<std::uint8_t> is_met(surfaces_.size(), 1);
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      const SurfaceId s = surfaces_[i].surface;
      const FitSum& sum = sums_[groups.find(i)];
      const bool is_reached = std::fabs(sum.missing) <= kMet * sum.magnitude;
      if (!is_reached || !(std::fabs(offsets[s]) * largest_moves_[s] <= allowed_[s])) is_met[groups.find(i)] = 0;
    }
    return is_met;
  }

  /// Joins groups that have missed their goals with their neighbours. Returns whether there were any such groups.
  bool join_with_neighbours(const std::vector<std::uint8_t>& is_met, UnionFind& groups) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const auto& [i, j] : neighbours_)
      if (is_met[groups.find(i)] == 0 || is_met[groups.find(j)] == 0) pairs.push_back({i, j});
    bool is_any = false;
    for (const auto& [i, j] : pairs) is_any = groups.join(i, j) || is_any;
    return is_any;
  }

  void collect_triangles() {
    IdVector<SurfaceId, std::uint32_t> at(input_.fit.goals().size(), kNone);
    for (std::size_t p = 0; p < triangulated_.meshes.size(); ++p) {
      const CurvedPatch* const patch = input_.curved.of(PatchId(p));
      if (patch == nullptr || !input_.fit.goals()[patch->surface].is_wanted) continue;
      std::uint32_t& index = at[patch->surface];
      if (index == kNone) {
        index = static_cast<std::uint32_t>(surfaces_.size());
        surfaces_.push_back({patch->surface, local(input_.fit.goals()[patch->surface].centre), {}});
      }
      add_patch(triangulated_.meshes[PatchId(p)], surfaces_[index].triangles);
    }
  }

  std::uint32_t index_of(VertexId v) const { return static_cast<std::uint32_t>(moves_.find(v)); }

  void add_patch(const PatchMesh& patch, std::vector<FitTriangle>& triangles) {
    std::vector<std::uint32_t> index;
    for (const VertexId v : patch.vertices) {
      check_();
      index.push_back(index_of(v));
    }
    const Triangulation2d& mesh = patch.mesh;
    struct Side {
      std::uint32_t from, to;
    };
    std::vector<Side> sides;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      check_();
      if (h % 3 == 0) triangles.push_back({{index[mesh.from(h)], index[mesh.to(h)], index[mesh.apex(h)]}, false});
      if (mesh.twin(h) == Triangulation2d::kNoHalfEdge) sides.push_back({mesh.from(h), mesh.to(h)});
    }
    sort_stoppable(sides.begin(), sides.end(), control_,
                   [](const Side& a, const Side& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); });
    // Between two vertices that were known before refinement, a boundary runs through vertices that have one side each.
    const auto is_known = [&](std::uint32_t v) { return patch.vertices[v].value < input_.surface.vertex_count(); };
    std::vector<std::uint32_t> run;
    for (const Side& first : sides) {
      if (!is_known(first.from)) continue;
      run = {index[first.from], index[first.to]};
      for (std::uint32_t v = first.to; !is_known(v);) {
        check_();
        const auto next = std::lower_bound(sides.begin(), sides.end(), v,
                                           [](const Side& side, std::uint32_t from) { return side.from < from; });
        if (next == sides.end() || next->from != v) break;
        v = next->to;
        run.push_back(index[v]);
      }
      add_ribbon(run, triangles);
    }
  }

  /// Adds the ribbon between a part of the boundary and the chord between its ends on the true surfaces.
  void add_ribbon(const std::vector<std::uint32_t>& run, std::vector<FitTriangle>& triangles) {
    const std::uint32_t from = true_place(run.front()), to = true_place(run.back());
    const std::uint32_t middle = add_fixed(0.5 * (start_[from] + start_[to]));
    triangles.push_back({{middle, run.front(), from}, true});
    for (std::size_t i = 0; i + 1 < run.size(); ++i) triangles.push_back({{middle, run[i + 1], run[i]}, true});
    triangles.push_back({{middle, to, run.back()}, true});
  }

  std::uint32_t add_fixed(const Vec3& at) {
    start_.push_back(at);
    return static_cast<std::uint32_t>(start_.size() - 1);
  }
  /// Adds the place of a vertex on the true surfaces.
  std::uint32_t true_place(std::uint32_t index) {
    const OffsetMoves& known = input_.fit.moves();
    const std::size_t at = known.find(moves_.vertex(index));
    return at < known.size() ? add_fixed(local(known.place(at))) : index;
  }

  void place_points(const IdVector<SurfaceId, double>& offsets) {
    points_ = start_;
    IdVector<SurfaceId, double> change = offsets;
    for (SurfaceId s(0); s.value < change.size(); ++s.value) change[s] -= input_.fit.offsets()[s];
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      check_();
      points_[i] += (1 / input_.surface.unit) * moved_by(moves_.moves(i), change);
    }
  }

  /// Returns the way of a point per factor of a group, in local units.
  Vec3 way(std::uint32_t point, std::uint32_t group) const {
    Vec3 sum;
    if (point >= moves_.size()) return sum;
    for (const OffsetMove& move : moves_.moves(point))
      if (group_of_[move.surface] == group) sum += input_.fit.scales()[move.surface] * move.way;
    return (1 / input_.surface.unit) * sum;
  }

  void add_surface(const FitSurface& of, FitSum& sum) const {
    StopCheck check(control_);
    const bool is_area = goal(of).is_area;
    const std::uint32_t group = group_of_[of.surface];
    const double scale = input_.fit.scales()[of.surface] / input_.surface.unit;
    sum.missing += goal(of).target;
    for (const FitTriangle& t : of.triangles) {
      check();
      if (is_area && t.is_ribbon) continue;
      std::array<Vec3, 3> p, w;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = points_[t.corners[k]] - of.centre;
        w[k] = way(t.corners[k], group);
      }
      const Vec3 twice_area = cross(p[1] - p[0], p[2] - p[0]);
      if (is_area) {
        const Vec3 change = cross(w[1] - w[0], p[2] - p[0]) + cross(p[1] - p[0], w[2] - w[0]);
        const double area = norm(twice_area) / 2;
        sum.missing -= area;
        sum.magnitude += area;
        sum.slope += dot(change, normalized(twice_area)) / 2;
        continue;
      }
      const double volume = dot(p[0], twice_area) / 6;
      sum.missing -= volume;
      sum.magnitude += std::fabs(volume);
      sum.slope += (dot(w[0], cross(p[1], p[2])) + dot(w[1], cross(p[2], p[0])) + dot(w[2], cross(p[0], p[1]))) / 6;
      if (t.is_ribbon) continue;
      const Vec3 middle = input_.surface.centre + input_.surface.unit * (of.centre + (1.0 / 3) * (p[0] + p[1] + p[2]));
      sum.largest_slope += norm(twice_area) / 2 * scale * offset_lever(shape(of.surface), middle);
    }
  }

  const FitInput& input_;
  const TriangulatedPatches& triangulated_;
  FitMoves found_;
  OffsetMoves moves_;  ///< the moves of `found_` that are used
  StopCheck check_;
  RunControl& control_;
  std::vector<FitSurface> surfaces_;
  IdVector<SurfaceId, std::uint8_t> keeps_boundary_;                 ///< empty if all boundaries may move
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours_;  ///< indices of `surfaces_`, the smaller one first
  IdVector<SurfaceId, double> largest_moves_;                        ///< max distance that vertices move, per offset
  IdVector<SurfaceId, double> allowed_;                              ///< the tolerances of the surfaces
  IdVector<SurfaceId, std::uint32_t> group_of_;
  std::vector<FitSum> sums_;  ///< one per group, under its representative
  std::vector<Vec3> start_;   ///< vertices at the estimated offsets, and fixed points behind them, in local units
  std::vector<Vec3> points_;  ///< the same at other offsets
};

}  // namespace

FittedVolumes fit_volumes(const FitInput& input, const TriangulatedPatches& triangulated,
                          const std::vector<Vec3>& new_positions, RunControl& control) {
  return Fitter(input, triangulated, new_positions, control).run();
}

FittedVertices move_to_fit(const FitInput& input, const FittedVolumes& fitted, TriangulatedPatches& triangulated,
                           std::vector<Vec3>& new_positions, RunControl& control) {
  StopCheck check(control);
  IdVector<SurfaceId, double> change = fitted.offsets;
  for (SurfaceId s(0); s.value < change.size(); ++s.value) change[s] -= input.fit.offsets()[s];
  const std::size_t known = input.surface.vertex_count();
  FittedVertices result;
  result.is_moved.assign(known + new_positions.size(), 0);
  for (std::size_t i = 0; i < fitted.moves.size(); ++i) {
    check();
    const Vec3 way = moved_by(fitted.moves.moves(i), change);
    if (way == Vec3{}) continue;
    const VertexId v = fitted.moves.vertex(i);
    result.is_moved[v.value] = 1;
    if (v.value < known)
      result.places.push_back({v, fitted.moves.place(i) + way});
    else
      new_positions[v.value - known] += way;
  }
  const auto place_of = [&](VertexId v) {
    if (v.value >= known) return new_positions[v.value - known];
    return std::lower_bound(result.places.begin(), result.places.end(), v,
                            [](const auto& place, VertexId id) { return place.first < id; })
        ->second;
  };
  for (PatchId p(0); p.value < triangulated.size(); ++p.value) {
    if (input.curved.of(p) != nullptr) continue;
    PatchMesh& patch = triangulated.meshes[p];
    bool is_any = false;
    for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
      check();
      if (result.is_moved[patch.vertices[i].value] == 0) continue;
      patch.uv[i] = triangulated.charts[p].to_plane(place_of(patch.vertices[i]));
      is_any = true;
    }
    if (is_any) delaunay_flips(patch.uv, patch.mesh, control);
  }
  return result;
}

}  // namespace remesh
