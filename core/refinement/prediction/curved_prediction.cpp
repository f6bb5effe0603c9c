#include "core/refinement/prediction/curved_prediction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/coarser_facets.h"
#include "core/patches/curved/curved_faces.h"
#include "core/patches/curved/curved_limits.h"
#include "core/refinement/goals/goals.h"

namespace remesh {
namespace {

constexpr double kPi = std::numbers::pi;

// See experiments.md, Prediction of curved patches, for the following numbers.

/// With a bound on angles, a planar patch beside curved ones has this many times as many faces.
constexpr double kFacesForAngleBeside = 3;
/// A boundary piece that is shorter than the edges inside of a curved patch adds this number of faces, over which edges
/// grow with the distance from the piece.
constexpr double kFacesBesidePiece = 7;
/// The growth of edges per distance from such a piece.
constexpr double kGrowthBeside = 0.33;
/// A boundary that is cut anew moves by at most this share of the width of a narrow planar patch beside it (ChainGaps).
constexpr double kMoveInWidth = 0.25;

/// Returns the angle between two unit vectors; 0 if one of them is null.
double angle_between(const Vec3& a, const Vec3& b) {
  if (a == Vec3{} || b == Vec3{}) return 0;
  return 2 * std::asin(std::min(1.0, 0.5 * norm(a - b)));
}

/// Returns the angle by which a boundary edge on a surface turns, as the cutting of curves counts it.
double turn_along(const AnalyticSurface& shape, const Vec3& a, const Vec3& b) {
  const double turn = angle_between(shape.normal(a), shape.normal(b));
  if (shape.kind != SurfaceKind::kCone && shape.kind != SurfaceKind::kTorus) return turn;
  const auto out = [&](const Vec3& p) {
    const Vec3 way = p - shape.origin, across = way - dot(way, shape.axis) * shape.axis;
    const double length = norm(across);
    return length > 0 ? (1 / length) * across : Vec3{};
  };
  return std::max(turn, angle_between(out(a), out(b)));
}

/// A part of the boundary of a curved patch between two corners.
struct Chain {
  double length = 0;
  double turn = 0;              ///< the largest turn of the surfaces beside it along the whole chain
  std::uint64_t edges = 0;      ///< edges of the input
  double present = 0;           ///< pieces that the present patches have
  std::vector<PatchId> beside;  ///< each patch once for each side that it has
  bool is_closed = false;
};

/// The measures of a patch after facets were joined.
struct PatchMeasure {
  double area = 0;
  double faces_at_one = 0;  ///< curved: faces inside if edges turn by one radian
  double perimeter = 0;
};

class CirclePrediction {
 public:
  CirclePrediction(const RecognisedFacets& in, const PresentPatches& present, const Options& options,
                   RunControl& control)
      : in_(in),
        present_(present),
        options_(options),
        goals_(goals_of(options, in.diagonal)),
        may_coarser_facets_stay_(curved_goals_of(options, in.diagonal).may_coarser_facets_stay),
        check_(control) {
    Options with_circles = options;
    with_circles.elements_per_circle = kPredictedElements.front();
    const std::vector<CurvedLimits> limits = curved_limits(
        in.surface, in.facets, in.surfaces, curved_goals_of(with_circles, in.diagonal), in.plane_tolerance, control);
    joined_ = join_curved_facets(in.surface, in.adjacency, in.facets, in.surfaces, options.feature_angle_deg, limits,
                                 {}, control);
  }

  std::map<int, std::uint64_t> run() {
    std::map<int, std::uint64_t> result;
    if (!joined_.has_any()) return result;
    measure_patches();
    find_chains();
    // If boundaries are cut finely for other reasons, more elements per circle hardly change the number of faces.
    double most = 0;
    for (const int elements : kPredictedElements) {
      most = std::max(most, std::min(std::ceil(faces_with(elements)), most_faces(elements)));
      result[elements] = static_cast<std::uint64_t>(most);
    }
    return result;
  }

 private:
  /// Returns the max number of faces: facets that are already fine enough stay if they lead to fewer faces.
  double most_faces(int elements) const {
    constexpr double kMany = 0x1p62;
    if (!may_coarser_facets_stay_ || present_.patches.count() != in_.facets.count()) return kMany;
    // Other options may need no floor, and then facets have more faces than predicted here.
    if (present_.min_edge_length > goals_.min_edge_length) return kMany;
    for (const CurvedPatch& patch : joined_.curved)
      if (in_.surfaces.surfaces[patch.surface].facets_per_turn < elements) return kMany;
    return std::min(kMany, std::accumulate(present_.faces.begin(), present_.faces.end(), 0.0));
  }

  void measure_patches() {
    measures_.resize(joined_.patches.count());
    for (std::size_t i = 0; i < measures_.size(); ++i) {
      const PatchId p(i);
      const CurvedPatch* curved = joined_.of(p);
      for (const FaceId f : joined_.patches.faces_of(p)) {
        check_();
        const auto corners = in_.surface.face(f);
        const Vec3& first = in_.surface.positions[corners[0]];
        Vec3 twice, sum;
        for (std::size_t k = 0; k < corners.size(); ++k) {
          const Vec3& a = in_.surface.positions[corners[k]];
          twice = twice + cross(a - first, in_.surface.positions[corners[(k + 1) % corners.size()]] - first);
          sum = sum + a;
        }
        const double area = 0.5 * norm(twice);
        measures_[p].area += area;
        if (curved == nullptr) continue;
        const Vec3 middle = (1.0 / static_cast<double>(corners.size())) * sum;
        measures_[p].faces_at_one += curved_faces_at_one(curved->map.shape(), middle, area, goals_.min_angle_deg > 0);
      }
    }
  }

  bool is_boundary(EdgeId e) const {
    return is_patch_boundary(in_.adjacency, joined_.patches, in_.adjacency.half_edges(e)[0]);
  }
  PatchId patch_of(std::uint32_t h) const { return joined_.patches.of_face[in_.adjacency.face_of(h)]; }

  /// Finds the chains beside curved patches. A chain ends where the number of boundary edges at a vertex is not two.
  void find_chains() {
    std::vector<EdgeId> edges;
    IdVector<VertexId, std::array<std::uint32_t, 2>> at(in_.surface.vertex_count(), {kNone, kNone});
    IdVector<VertexId, std::uint8_t> degree(in_.surface.vertex_count(), 0);
    for (std::size_t i = 0; i < in_.adjacency.edge_count(); ++i) {
      check_();
      const EdgeId e(i);
      if (!is_boundary(e)) continue;
      const std::uint32_t h = in_.adjacency.half_edges(e)[0];
      for (const VertexId v : {in_.adjacency.from(h), in_.adjacency.to(h)}) {
        if (degree[v] < 2) at[v][degree[v]] = static_cast<std::uint32_t>(edges.size());
        if (degree[v] < 3) ++degree[v];
      }
      edges.push_back(e);
    }
    UnionFind together(edges.size());
    for (std::size_t i = 0; i < in_.surface.vertex_count(); ++i) {
      check_();
      const VertexId v(i);
      if (degree[v] == 2) together.join(at[v][0], at[v][1]);
    }
    std::vector<std::uint32_t> chain_of(edges.size(), kNone);
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      check_();
      std::uint32_t& c = chain_of[together.find(i)];
      if (c == kNone) {
        c = static_cast<std::uint32_t>(chains_.size());
        chains_.emplace_back();
        chains_.back().is_closed = true;
        for (const std::uint32_t h : in_.adjacency.half_edges(edges[i])) chains_.back().beside.push_back(patch_of(h));
      }
      add_edge(edges[i], degree, chains_[c]);
    }
    std::erase_if(chains_, [&](const Chain& chain) {
      return std::none_of(chain.beside.begin(), chain.beside.end(),
                          [&](PatchId p) { return joined_.of(p) != nullptr; });
    });
    for (const Chain& chain : chains_)
      for (const PatchId p : chain.beside) measures_[p].perimeter += chain.length;
  }

  void add_edge(EdgeId e, const IdVector<VertexId, std::uint8_t>& degree, Chain& chain) const {
    const auto half_edges = in_.adjacency.half_edges(e);
    const VertexId from = in_.adjacency.from(half_edges[0]), to = in_.adjacency.to(half_edges[0]);
    const Vec3 &a = in_.surface.positions[from], &b = in_.surface.positions[to];
    chain.length += norm(b - a);
    ++chain.edges;
    if (degree[from] != 2 || degree[to] != 2) chain.is_closed = false;
    double turn = 0;
    for (const std::uint32_t h : half_edges)
      if (const CurvedPatch* curved = joined_.of(patch_of(h)))
        turn = std::max(turn, turn_along(curved->map.shape(), a, b));
    chain.turn += turn;
    // All half-edges in one direction along a chain give the same number of pieces.
    double pieces = 0;
    for (const std::uint32_t h : half_edges)
      if (present_.essential[in_.adjacency.from(h)])
        pieces += (1.0 + static_cast<double>(present_.cuts.between(h).size())) / static_cast<double>(half_edges.size());
    chain.present += pieces;
  }

  double longest_edge() const { return std::min(goals_.max_edge_length, equilateral_edge(goals_.max_area)); }

  /// Returns the approximate width of a patch. If only a part of its boundary is beside curved patches, the result is
  /// too large.
  double width(PatchId p) const { return 2 * measures_[p].area / measures_[p].perimeter; }

  /// Returns the number of pieces into which a chain is divided because of its turn.
  double pieces_by_turn(const Chain& chain, double max_turn) const {
    return std::max(std::ceil(chain.turn / max_turn * (1 - 1e-6)), chain.is_closed ? 3.0 : 1.0);
  }

  /// Returns the number of pieces into which a chain is cut so that it does not cross the other boundaries of planar
  /// patches.
  double pieces_by_room(const Chain& chain) const {
    double pieces = 1;
    for (const PatchId p : chain.beside) {
      if (joined_.of(p) != nullptr || !(chain.turn > 0) || !(measures_[p].area > 0)) continue;
      const double radius = chain.length / chain.turn;
      const double turn = 2 * std::acos(std::max(0.0, 1 - kMoveInWidth * width(p) / radius));
      if (turn > 0) pieces = std::max(pieces, std::ceil(chain.turn / turn));
    }
    return std::min(pieces, static_cast<double>(chain.edges));
  }

  double pieces_of(const Chain& chain, double max_turn) const {
    double pieces = std::max(pieces_by_turn(chain, max_turn), pieces_by_room(chain));
    if (options_.keep_boundary_vertices) pieces = std::max(pieces, static_cast<double>(chain.edges));
    if (!goals_.split_boundaries) return pieces;
    pieces = std::max(pieces, chain.length / longest_edge());
    // The angle bound cuts the boundary of narrow patches, planar ones as well.
    for (const PatchId p : chain.beside) {
      if (goals_.min_angle_deg == 0 || !(measures_[p].area > 0)) continue;
      pieces = std::max(pieces, chain.length / width(p) * std::tan(goals_.min_angle_deg * kPi / 180) / 2);
    }
    return pieces;
  }

  double faces_with(int elements) {
    const double max_turn = 2 * kPi / elements;
    IdVector<PatchId, double> pieces(joined_.patches.count(), 0), added(joined_.patches.count(), 0),
        beside(joined_.patches.count(), 0);
    for (const Chain& chain : chains_) {
      check_();
      const double now = pieces_of(chain, max_turn);
      // With more pieces for each edge inside, more faces lie between the pieces and the edge, if there is room.
      const double finer = goals_.min_angle_deg > 0 ? std::max(0.0, now - pieces_by_turn(chain, max_turn)) : 0;
      const double piece = chain.length / now;
      for (const PatchId p : chain.beside) {
        pieces[p] += now;
        added[p] += now - chain.present;
        const double grown = kGrowthBeside * width(p) / 2;
        if (measures_[p].area > 0) beside[p] += kFacesBesidePiece * finer * grown / (piece + grown);
      }
    }
    double faces = 0;
    for (std::size_t i = 0; i < joined_.patches.count(); ++i) {
      check_();
      const PatchId p(i);
      const double least = std::max(1.0, pieces[p] - 2);
      const double by_size = kFacesPerSize * measures_[p].area / equilateral_area(longest_edge());
      if (joined_.of(p) == nullptr) {
        const PatchId q = present_.patches.of_face[joined_.patches.faces_of(p)[0]];
        if (pieces[p] == 0) {
          faces += present_.faces[q.value];
          continue;
        }
        const double factor = goals_.min_angle_deg > 0 ? kFacesForAngleBeside : 1;
        faces += std::max({least, factor * (present_.triangles[q.value] + added[p]), by_size});
        continue;
      }
      faces += std::max({least, measures_[p].faces_at_one / (max_turn * max_turn) + beside[p], by_size});
    }
    return faces;
  }

  const RecognisedFacets& in_;
  const PresentPatches& present_;
  const Options& options_;
  const Goals goals_;
  const bool may_coarser_facets_stay_;
  StopCheck check_;
  CurvedPatches joined_;
  IdVector<PatchId, PatchMeasure> measures_;
  std::vector<Chain> chains_;
};

}  // namespace

double faces_by_turn(const PatchMesh& patch, const PatchChart& chart, bool by_angle, RunControl& control) {
  const CurvedChart* const curved = chart.curved();
  if (curved == nullptr) return 0;
  const AnalyticSurface& shape = curved->map().shape();
  const double radius = shape.kind == SurfaceKind::kTorus ? shape.minor_radius : shape.radius;
  double turn = curved->max_turn();
  if (shape.kind != SurfaceKind::kCone && radius > 0)
    turn = std::min(turn, 2 * std::acos(std::clamp(1 - curved->max_edge_height() / radius, -1.0, 1.0)));
  if (!(turn > 0)) return 0;
  // The scale of the chart and the curvature differ inside a triangle, so it is divided.
  constexpr int kRows = 4;
  double faces = 0;
  const Triangulation2d& mesh = patch.mesh;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
    control.check();
    const Vec2 a = patch.uv[mesh.from(h)], u = patch.uv[mesh.from(h + 1)] - a, v = patch.uv[mesh.from(h + 2)] - a;
    const double part = cross(u, v) / 2 / (kRows * kRows);
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; i + j < kRows; ++j)
        for (int up = 0; up < (i + j + 1 < kRows ? 2 : 1); ++up) {
          const Vec2 at = a + (i + (1.0 + up) / 3) / kRows * u + (j + (1.0 + up) / 3) / kRows * v;
          const double scale = chart.scale(at);
          faces += curved_faces_at_one(shape, chart.to_space(at), part * scale * scale, by_angle);
        }
  }
  return faces / (turn * turn);
}

std::map<int, std::uint64_t> predict_by_elements_per_circle(const RecognisedFacets& facets,
                                                            const PresentPatches& present, const Options& options,
                                                            RunControl& control) {
  if (facets.surfaces.of_patch.empty()) return {};
  return CirclePrediction(facets, present, options, control).run();
}

}  // namespace remesh
