#include "core/patches/curved/coarser_facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "core/base/stoppable.h"
#include "core/patches/curved/curved_faces.h"
#include "core/patches/curved/curved_limits.h"

namespace remesh {
namespace {

/// With the default min angle of 25 degrees, a strip gets at least this many triangles for each square of its width. On
/// cylinders with 36 to 224 facets, refinement made 0.60 to 0.68.
constexpr double kTrianglesPerSquare = 0.55;
constexpr double kAngleOfCount = 25;

/// A face with more corners than this is flat, and its width is not measured.
constexpr std::size_t kMaxCornersMeasured = 16;

/// Returns the smallest width of a polygon, across one of its sides.
double width_of_polygon(std::span<const Vec3> corners) {
  double width = HUGE_VAL;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3& from = corners[i];
    const Vec3 along = normalized(corners[(i + 1) % corners.size()] - from);
    double farthest = 0;
    for (const Vec3& q : corners) farthest = std::max(farthest, norm(cross(q - from, along)));
    width = std::min(width, farthest);
  }
  return width;
}

/// Joined patches are not tried if their expected number of faces is more than this many times the estimate for their
/// facets.
constexpr double kCertainlyFiner = 3;

/// If facets stay, all patches are refined again. After the first time, the facets have to save more than this part of
/// all faces.
constexpr double kWorthAnAttempt = 0.01;

/// Returns whether a surface has at least as many facets per turn as edges are asked for. If not, it is to be made
/// finer.
bool are_facets_as_fine(const RecognisedSurface& surface, const CurvedGoals& goals) {
  // The turns of one circle's facets differ a little.
  constexpr double kAsFine = 1.02;
  const std::optional<double> elements = goals.elements_of(surface);
  return !elements || *elements <= kAsFine * surface.facets_per_turn;
}

/// Returns the max angle, in radians, by which an edge of a curved patch may turn at a place of the surface.
double largest_turn(const CurvedPatch& patch, const Vec3& at) {
  const AnalyticSurface& shape = patch.map.shape();
  const double radius = shape.kind == SurfaceKind::kTorus  ? shape.minor_radius
                        : shape.kind == SurfaceKind::kCone ? shape.distance_from_axis(at)
                                                           : shape.radius;
  const double of_depth = 2 * std::acos(std::max(-1.0, 1 - patch.limits.max_height / radius));
  return std::min(of_depth, patch.limits.max_turn);
}

}  // namespace

void CoarserFacets::count_facets(const Surface& surface, const Adjacency& adjacency, const Partition& facets,
                                 const CurvedPatches& joined, double min_angle_deg, RunControl& control) {
  constexpr double kRadians = std::numbers::pi / 180;
  const double per_square =
      kTrianglesPerSquare * std::tan(min_angle_deg * kRadians) / std::tan(kAngleOfCount * kRadians);
  costs_.assign(joined.patches.count(), {});
  StopCheck check(control);
  std::vector<Vec3> corners;
  for (PatchId f(0); f.value < facets.patches.count(); ++f.value) {
    const PatchId p = joined.patches.of_face[facets.patches.faces_of(f).front()];
    if (joined.of(p) == nullptr) continue;
    corners.clear();
    Vec3 middle;
    const BoundaryLoops& loops = facets.loops;
    const std::uint32_t first = loops.patch_begin[f.value], last = loops.patch_begin[f.value + 1];
    for (std::uint32_t l = first; l < last; ++l)
      for (const std::uint32_t h : loops.loop(l)) {
        check();
        if (!facets.essential[adjacency.from(h)]) continue;
        corners.push_back(surface.local[adjacency.from(h)]);
        middle = middle + surface.positions[adjacency.from(h)];
      }
    middle = (1 / static_cast<double>(corners.size())) * middle;
    const double turn = largest_turn(*joined.of(p), middle);
    costs_[p].joined += curved_faces_at_one(joined.of(p)->map.shape(), middle, facets.summaries.patches[f.value].area,
                                            min_angle_deg > 0) /
                        (turn * turn);
    const double triangles = static_cast<double>(corners.size()) + 2 * static_cast<double>(last - first) - 4;
    double& cost = costs_[p].facets;
    cost += std::max(triangles, 1.0);
    if (per_square == 0 || last - first != 1 || corners.size() > kMaxCornersMeasured) continue;
    const double width = width_of_polygon(corners);
    const double area = facets.summaries.patches[f.value].area / surface.unit / surface.unit;
    const double squares = width > 0 ? area / (width * width) : 0;
    // Wider facets already meet the bound on angles. A triangle has half of the area of its rectangle.
    if (squares * std::tan(min_angle_deg * kRadians) > (corners.size() == 3 ? 0.5 : 1.0))
      cost += per_square * std::max(0.0, squares - 1);
  }
}

void CoarserFacets::count_boundaries(const Adjacency& adjacency, const Partition& joined, const CurvedPatches& curved,
                                     const CurveCuts* cuts, RunControl& control) {
  const EssentialVertices& essential = cuts != nullptr ? cuts->essential : joined.essential;
  StopCheck check(control);
  for (PatchId p(0); p.value < joined.patches.count(); ++p.value) {
    if (curved.of(p) == nullptr) continue;
    std::uint64_t count = 0;
    for (std::uint32_t l = joined.loops.patch_begin[p.value]; l < joined.loops.patch_begin[p.value + 1]; ++l)
      for (const std::uint32_t h : joined.loops.loop(l)) {
        check();
        if (!essential[adjacency.from(h)]) continue;
        count += 1 + (cuts != nullptr ? cuts->between(h).size() : 0);
      }
    (cuts != nullptr ? costs_[p].boundary_after : costs_[p].boundary_before) = count;
  }
}

std::vector<SurfaceId> CoarserFacets::find_hopeless(const CurvedPatches& joined, const CurvedGoals& goals,
                                                    std::uint64_t in_proportion) const {
  std::vector<SurfaceId> found;
  // Without refinement, edges run along rulings, however long these are.
  if (!goals.is_refined) return found;
  IdVector<SurfaceId, double> of_facets(joined.surfaces.surfaces.size()), of_joined(joined.surfaces.surfaces.size());
  for (PatchId p(0); p.value < costs_.size(); ++p.value) {
    const CurvedPatch* patch = joined.of(p);
    if (patch == nullptr) continue;
    const RecognisedSurface& surface = joined.surfaces.surfaces[patch->surface];
    if (!are_facets_as_fine(surface, goals)) continue;
    of_facets[patch->surface] += costs_[p].facets;
    of_joined[patch->surface] += costs_[p].joined;
  }
  const bool are_compared = goals.may_coarser_facets_stay;
  std::vector<SurfaceId> left;
  for (SurfaceId s(0); s.value < of_joined.size(); ++s.value)
    (are_compared && of_joined[s] > kCertainlyFiner * of_facets[s] ? found : left).push_back(s);
  std::stable_sort(left.begin(), left.end(), [&](SurfaceId a, SurfaceId b) { return of_joined[a] < of_joined[b]; });
  double sum = 0;
  for (const SurfaceId s : left)
    if ((sum += of_joined[s]) > static_cast<double>(in_proportion)) found.push_back(s);
  return found;
}

CoarserFacets::Coarser CoarserFacets::find_coarser(const CurvedPatches& curved,
                                                   const std::vector<std::uint64_t>& triangles,
                                                   const IdVector<SurfaceId, std::optional<double>>& allowed,
                                                   const CurvedGoals& goals) const {
  Coarser found;
  if (!goals.may_coarser_facets_stay) return found;
  const auto was_left = [&](SurfaceId s) { return s.value < allowed.size() && allowed[s].has_value(); };
  struct Total {
    double facets = 0, joined = 0, boundary = 0;
  };
  IdVector<SurfaceId, Total> totals(curved.surfaces.surfaces.size());
  for (PatchId p(0); p.value < costs_.size(); ++p.value) {
    const CurvedPatch* patch = curved.of(p);
    if (patch == nullptr) continue;
    const Cost& cost = costs_[p];
    Total& total = totals[patch->surface];
    total.boundary += static_cast<double>(cost.boundary_before);
    total.facets += cost.facets + static_cast<double>(cost.boundary_before);
    total.joined += static_cast<double>(triangles[p.value] + cost.boundary_after);
  }
  for (PatchId p(0); p.value < costs_.size(); ++p.value) {
    const CurvedPatch* patch = curved.of(p);
    if (patch == nullptr || was_left(patch->surface)) continue;
    if (!are_facets_as_fine(curved.surfaces.surfaces[patch->surface], goals)) continue;
    const Total& total = totals[patch->surface];
    if (total.facets <= total.joined) found.patches.push_back(p);
  }
  const bool is_first = std::none_of(allowed.begin(), allowed.end(), [](const auto& n) { return n.has_value(); });
  if (goals.is_refined && !is_first) {
    double saved = 0;
    for (SurfaceId s(0); s.value < totals.size(); ++s.value)
      if (!was_left(s) && are_facets_as_fine(curved.surfaces.surfaces[s], goals))
        saved += std::max(0.0, totals[s].joined - totals[s].facets);
    const double all = std::accumulate(triangles.begin(), triangles.end(), 0.0,
                                       [](double sum, std::uint64_t n) { return sum + static_cast<double>(n); });
    if (saved < kWorthAnAttempt * all) return {};
  }
  IdVector<SurfaceId, std::uint8_t> is_found(totals.size(), 0);
  for (const PatchId p : found.patches) {
    const SurfaceId s = curved.of(p)->surface;
    if (std::exchange(is_found[s], 1) == 0) found.allowed.emplace_back(s, totals[s].joined - totals[s].boundary);
  }
  return found;
}

std::vector<SurfaceId> find_finer(const IdVector<PatchId, SurfaceId>& of_patch,
                                  const std::vector<std::uint64_t>& triangles, const std::vector<std::uint8_t>& is_left,
                                  const IdVector<SurfaceId, std::optional<double>>& allowed) {
  IdVector<SurfaceId, double> of_facets(allowed.size());
  for (PatchId p(0); p.value < of_patch.size(); ++p.value)
    if (is_left[p.value] != 0 && of_patch[p].value < of_facets.size())
      of_facets[of_patch[p]] += static_cast<double>(triangles[p.value]);
  std::vector<SurfaceId> found;
  for (SurfaceId s(0); s.value < allowed.size(); ++s.value)
    if (allowed[s] && of_facets[s] > *allowed[s]) found.push_back(s);
  return found;
}

}  // namespace remesh
