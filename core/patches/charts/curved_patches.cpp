#include "core/patches/charts/curved_patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/patches/charts/sheet_geometry.h"

namespace remesh {
namespace {

/// Joins the facets of curved surfaces. All lengths are in model units.
class Joining {
 public:
  Joining(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
          const RecognisedSurfaces& recognised, double feature_angle_deg, std::span<const CurvedLimits> limits,
          const IdVector<FaceId, CurvedRung>& rungs, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        facets_(facets),
        recognised_(recognised),
        min_cosine_(std::cos(feature_angle_deg * std::numbers::pi / 180)),
        limits_(limits),
        rungs_(rungs),
        control_(control),
        check_(control),
        geometry_(surface, facets, control),
        sector_(facets.count(), 0),
        piece_(facets.count()) {}

  CurvedPatches run() {
    find_candidates();
    if (std::find(is_candidate_.begin(), is_candidate_.end(), 1) == is_candidate_.end()) return {};
    // First the sheets are made: all connected facets of a surface. A sheet without a map is divided into sectors.
    join_smooth(piece_);
    divide_sheets();
    UnionFind pieces(facets_.count());
    join_smooth(pieces);
    piece_ = std::move(pieces);
    return make_patches();
  }

 private:
  void find_candidates() {
    is_candidate_.assign(facets_.count(), 0);
    for (std::size_t i = 0; i < facets_.count(); ++i) {
      check_();
      const PatchId p(i);
      const SurfaceId s = recognised_.of_patch[p];
      const bool is_wanted = limits_[s.value].tolerance > 0 && SurfaceMap::can_map(recognised_.surfaces[s].shape);
      if (!is_wanted || rung_of(p) >= CurvedRung::kCoarser) continue;
      const AnalyticSurface& shape = recognised_.surfaces[s].shape;
      is_candidate_[p] = geometry_.goes_around(p, shape) || geometry_.ends_at_axis(p, shape) ? 0 : 1;
    }
  }

  /// Returns the highest rung of a facet's faces.
  CurvedRung rung_of(PatchId p) const {
    CurvedRung highest = CurvedRung::kJoined;
    if (rungs_.empty()) return highest;
    for (const FaceId f : facets_.faces_of(p)) highest = std::max(highest, rungs_[f]);
    return highest;
  }

  /// Joins neighbours over smooth edges if they are pieces of the same surface and lie in the same sector.
  void join_smooth(UnionFind& sets) {
    for (std::size_t e = 0; e < adjacency_.edge_count(); ++e) {
      check_();
      const auto around = adjacency_.half_edges(EdgeId(e));
      if (around.size() != 2 || adjacency_.twin(around[0]) != around[1]) continue;
      const FaceId f = adjacency_.face_of(around[0]), g = adjacency_.face_of(around[1]);
      const PatchId p = facets_.of_face[f], q = facets_.of_face[g];
      if (p == q || is_candidate_[p] == 0 || is_candidate_[q] == 0) continue;
      if (recognised_.of_patch[p] != recognised_.of_patch[q] || sector_[p] != sector_[q]) continue;
      if (surface_.label(f) != surface_.label(g)) continue;
      if (!(dot(facets_.planes[p].normal, facets_.planes[q].normal) >= min_cosine_)) continue;
      sets.join(p.value, q.value);
    }
  }

  const AnalyticSurface& shape_of(PatchId p) const { return recognised_.surfaces[recognised_.of_patch[p]].shape; }

  /// The facets of each set with two or more of them. The sets are in the order of their first facets.
  std::vector<PatchSheet> members(UnionFind& sets) {
    std::vector<PatchSheet> all;
    IdVector<PatchId, std::uint32_t> count(facets_.count(), 0), list(facets_.count(), kNone);
    for (std::uint32_t p = 0; p < facets_.count(); ++p) {
      check_();
      if (is_candidate_[PatchId(p)] != 0) ++count[PatchId(sets.find(p))];
    }
    for (std::uint32_t p = 0; p < facets_.count(); ++p) {
      check_();
      if (is_candidate_[PatchId(p)] == 0) continue;
      const PatchId root(sets.find(p));
      if (count[root] < 2) continue;
      if (list[root] == kNone) {
        list[root] = static_cast<std::uint32_t>(all.size());
        all.emplace_back();
      }
      all[list[root]].push_back(PatchId(p));
    }
    return all;
  }

  void divide_sheets() {
    for (const PatchSheet& sheet : members(piece_)) {
      const std::vector<std::uint8_t> sectors = geometry_.sectors(sheet, shape_of(sheet.front()));
      for (std::size_t i = 0; i < sheet.size(); ++i) sector_[sheet[i]] = sectors[i];
    }
  }

  CurvedPatches make_patches() {
    CurvedPatches result;
    // The first facet of a joined patch stands for it.
    IdVector<PatchId, PatchId> first(facets_.count());
    IdVector<PatchId, std::uint32_t> curved_of(facets_.count(), kNone);
    std::vector<CurvedPatch> curved;
    std::vector<Plane> planes;
    for (std::size_t p = 0; p < facets_.count(); ++p) first[PatchId(p)] = PatchId(p);
    for (const PatchSheet& piece : members(piece_)) {
      const SurfaceId s = recognised_.of_patch[piece.front()];
      const AnalyticSurface& shape = recognised_.surfaces[s].shape;
      const int side = geometry_.side_of(piece, shape);
      if (side == 0 || !geometry_.has_map(piece, shape)) continue;
      for (const PatchId p : piece) first[p] = piece.front();
      curved_of[piece.front()] = static_cast<std::uint32_t>(curved.size());
      const bool is_tight =
          std::any_of(piece.begin(), piece.end(), [&](PatchId p) { return rung_of(p) == CurvedRung::kTightened; });
      curved.push_back({s, SurfaceMap(shape, {geometry_.middle_of_piece(piece, shape), side < 0}),
                        is_tight ? limits_[s.value].tightened() : limits_[s.value], geometry_.area_of(piece)});
      planes.push_back(geometry_.mean_plane(piece));
    }
    if (curved.empty()) return result;
    // A patch is numbered by its first face, and so are facets.
    IdVector<PatchId, PatchId> number(facets_.count());
    PatchSet& set = result.patches;
    for (std::size_t i = 0; i < facets_.count(); ++i) {
      check_();
      const PatchId p(i);
      if (first[p] != p) {
        number[p] = number[first[p]];
        continue;
      }
      const std::uint32_t at = curved_of[p];
      number[p] = set.planes.push_back(at == kNone ? facets_.planes[p] : planes[at]);
      set.deviation.push_back(at == kNone ? facets_.deviation[p] : 0);
      result.surfaces.of_patch.push_back(recognised_.of_patch[p]);
      result.at.push_back(at == kNone ? kNone : static_cast<std::uint32_t>(result.curved.size()));
      if (at != kNone) result.curved.push_back(curved[at]);
    }
    result.surfaces.surfaces = recognised_.copy(control_).surfaces;
    for (RecognisedSurface& s : result.surfaces.surfaces) s.patches = 0;
    for (const SurfaceId s : result.surfaces.of_patch) ++result.surfaces.surfaces[s].patches;
    set.of_face.resize(surface_.face_count());
    for (std::size_t f = 0; f < surface_.face_count(); ++f) {
      check_();
      set.of_face[FaceId(f)] = number[facets_.of_face[FaceId(f)]];
    }
    auto groups = group_by<FaceId>(
        surface_.face_count(), set.count(), [&](std::uint32_t f) { return set.of_face[FaceId(f)].value; }, control_);
    set.face_begin = std::move(groups.begin);
    set.faces = std::move(groups.items);
    return result;
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& facets_;
  const RecognisedSurfaces& recognised_;
  const double min_cosine_;
  std::span<const CurvedLimits> limits_;
  const IdVector<FaceId, CurvedRung>& rungs_;
  RunControl& control_;
  StopCheck check_;
  SheetGeometry geometry_;
  IdVector<PatchId, std::uint8_t> is_candidate_;
  IdVector<PatchId, std::uint8_t> sector_;
  UnionFind piece_;
};

}  // namespace

CurvedLimits CurvedLimits::tightened() const {
  constexpr double kHeight = 0.6, kTurn = 0.75, kBoundary = 0.5;
  return {tolerance, kHeight * max_height, kTurn * max_turn, kBoundary * boundary_tolerance,
          kBoundary * boundary_sideways};
}

CurvedPatches join_curved_facets(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
                                 const RecognisedSurfaces& recognised, double feature_angle_deg,
                                 std::span<const CurvedLimits> limits, const IdVector<FaceId, CurvedRung>& rungs,
                                 RunControl& control) {
  return Joining(surface, adjacency, facets, recognised, feature_angle_deg, limits, rungs, control).run();
}

}  // namespace remesh
