#include "core/patches/curved/volume_offsets.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/surfaces/surface_integral.h"
#include "core/geometry/surfaces/surface_offset.h"
#include "core/patches/chains/boundary_chains.h"
#include "core/patches/charts/boundary_curve.h"

namespace remesh {
namespace {

/// A piece of a loop between two vertices that stay or are new. The patch is on its left.
struct LoopPiece {
  VertexId from, to;
  std::uint32_t half_edge;  ///< the input's half-edge along the piece, or the one where the piece's chain begins
};

/// Calls take(piece) for all pieces of a loop, in order.
template <class Take>
void for_each_piece(const CutPatches& cut, std::span<const std::uint32_t> loop, const Take& take) {
  VertexId first, last;
  std::uint32_t last_edge = kNone;
  for (const std::uint32_t h : loop) {
    const VertexId v = cut.adjacency.from(h);
    if (!cut.cuts.essential[v]) continue;
    if (last.is_valid())
      take(LoopPiece{last, v, last_edge});
    else
      first = v;
    last = v;
    last_edge = h;
    for (const VertexId at : cut.cuts.between(h)) {
      take(LoopPiece{last, at, h});
      last = at;
    }
  }
  if (last.is_valid()) take(LoopPiece{last, first, last_edge});
}

Vec3 place_of(const CutPatches& cut, VertexId v) {
  const std::size_t count = cut.surface.vertex_count();
  return v.value < count ? cut.surface.positions[v] : cut.cuts.positions[v.value - count];
}

/// Collects the surfaces, planes and lines on which vertices on boundaries of curved patches must stay.
class SiteFinder {
 public:
  SiteFinder(const CutPatches& cut, const CurvedPatches& curved, RunControl& control)
      : cut_(cut), curved_(curved), check_(control), control_(control) {}

  OffsetMoves run() {
    find_vertices();
    find_patches();
    find_lines();
    sort_unique(patches_, control_);
    sort_stoppable(lines_.begin(), lines_.end(), control_);
    OffsetMoves moves;
    std::size_t p = 0, l = 0;
    for (std::size_t v = 0; v < is_site_.size(); ++v) {
      check_();
      if (is_site_[v] == 0) continue;
      const VertexId vertex(v);
      OffsetSite site;
      for (; p < patches_.size() && patches_[p].first == vertex; ++p) add_patch(patches_[p].second, site);
      const Vec3 at = place_of(cut_, vertex);
      for (; l < lines_.size() && lines_[l].first == vertex; ++l)
        site.lines.push_back(normalized(place_of(cut_, lines_[l].second) - at));
      sort_unique(site.surfaces);
      if (v < cut_.surface.vertex_count() && cut_.forced[vertex] != 0) site.surfaces.clear();
      moves.add(vertex, at, site, curved_.surfaces);
    }
    return moves;
  }

 private:
  template <class Take>
  void for_each_loop(bool are_curved, const Take& take) {
    for (std::size_t p = 0; p < cut_.patches.count(); ++p) {
      if ((curved_.of(PatchId(p)) != nullptr) != are_curved) continue;
      for (std::uint32_t l = cut_.loops.patch_begin[p]; l < cut_.loops.patch_begin[p + 1]; ++l) {
        check_();
        take(cut_.loops.loop(l));
      }
    }
  }

  void find_vertices() {
    is_site_.assign(cut_.surface.vertex_count() + cut_.cuts.positions.size(), 0);
    for_each_loop(true, [&](std::span<const std::uint32_t> loop) {
      for_each_piece(cut_, loop, [&](const LoopPiece& piece) {
        check_();
        is_site_[piece.from.value] = 1;
        if (piece.from.value < cut_.surface.vertex_count()) return;
        for (const std::uint32_t h : half_edges_along(cut_.adjacency, piece.half_edge))
          patches_.push_back({piece.from, cut_.patches.of_face[cut_.adjacency.face_of(h)]});
      });
    });
  }

  void find_patches() {
    for (std::size_t f = 0; f < cut_.surface.face_count(); ++f)
      for (const VertexId v : cut_.surface.face(FaceId(f))) {
        check_();
        if (is_site_[v.value] != 0) patches_.push_back({v, cut_.patches.of_face[FaceId(f)]});
      }
  }

  /// Finds the edges that have only planar patches beside them.
  void find_lines() {
    for_each_loop(false, [&](std::span<const std::uint32_t> loop) {
      for_each_piece(cut_, loop, [&](const LoopPiece& piece) {
        check_();
        if (is_site_[piece.from.value] == 0 && is_site_[piece.to.value] == 0) return;
        for (const std::uint32_t h : half_edges_along(cut_.adjacency, piece.half_edge))
          if (curved_.of(cut_.patches.of_face[cut_.adjacency.face_of(h)]) != nullptr) return;
        lines_.push_back({piece.from, piece.to});
        lines_.push_back({piece.to, piece.from});
      });
    });
  }

  void add_patch(PatchId p, OffsetSite& site) const {
    if (curved_.of(p) != nullptr)
      site.surfaces.push_back(curved_.of(p)->surface);
    else
      site.planes.push_back(cut_.patches.planes[p].normal);
  }

  const CutPatches& cut_;
  const CurvedPatches& curved_;
  StopCheck check_;
  RunControl& control_;
  std::vector<std::uint8_t> is_site_;                  ///< one per vertex
  std::vector<std::pair<VertexId, PatchId>> patches_;  ///< patches at vertices
  std::vector<std::pair<VertexId, VertexId>> lines_;   ///< from vertices to the other ends of edges
};

/// The true curve of a piece of a boundary.
class TrueCurve {
 public:
  TrueCurve(const CutPatches& cut, const CurvedPatches& curved, PatchId p, const LoopPiece& piece)
      : from_(place_of(cut, piece.from)), to_(place_of(cut, piece.to)) {
    const SurfaceId own = curved.of(p)->surface;
    const AnalyticSurface& shape = curved.surfaces.surfaces[own].shape;
    std::optional<AnalyticSurface> other;
    bool is_other_first = false;
    const std::vector<std::uint32_t> along = half_edges_along(cut.adjacency, piece.half_edge);
    is_open_ = along.size() == 1;
    for (const std::uint32_t h : along) {
      const PatchId q = cut.patches.of_face[cut.adjacency.face_of(h)];
      const CurvedPatch* const patch = curved.of(q);
      if (patch != nullptr && patch->surface == own) continue;
      if (patch != nullptr) {
        other = curved.surfaces.surfaces[patch->surface].shape;
        is_other_first = patch->surface < own;
      } else {
        const Plane& plane = cut.patches.planes[q];
        other = {SurfaceKind::kPlane, cut.surface.centre + cut.surface.unit * plane.origin, plane.normal};
      }
      break;
    }
    // Both patches beside a curve get the same trace.
    trace_ =
        is_other_first ? CurveTrace::choose(from_, to_, *other, shape) : CurveTrace::choose(from_, to_, shape, other);
  }

  bool is_open() const { return is_open_; }
  SurfaceIntegral::Curve points() const {
    SurfaceIntegral::Curve points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = SurfaceIntegral::places()[i];
      const Vec3 on_line = t <= 0.5 ? from_ + t * (to_ - from_) : to_ + (1 - t) * (from_ - to_);
      points[i] = trace_ && t > 0 && t < 1 ? trace_->place(on_line, from_, to_) : on_line;
    }
    return points;
  }

 private:
  Vec3 from_, to_;
  std::optional<CurveTrace> trace_;
  bool is_open_ = false;
};

/// Returns a point in the middle of a map. For a cone, only its direction from the axis counts.
/// Input: `unit` is any length that is scaled with the surface.
Vec3 middle_of(const SurfaceMap& map, double unit) {
  if (map.shape().kind != SurfaceKind::kCone) return map.point(Vec2{});
  return map.shape().origin + unit * map.axes().x;
}

/// Returns the same map of a piece of the surface moved outwards.
SurfaceMap offset_map(const SurfaceMap& map, double offset, double unit) {
  return {offset_surface(map.shape(), offset), {middle_of(map, unit), map.side() < 0}};
}

}  // namespace

bool VolumeOffsets::move_outside(const CutPatches& cut, const OffsetChoices& choices, CurvedPatches& curved,
                                 Surface& with_cuts, RunControl& control) {
  set_goals(cut, choices, curved, control);
  set_scales(curved);
  moves_ = SiteFinder(cut, curved, control).run();
  find_anchored(cut, curved, control);
  offsets_.assign(goals_.size(), 0);
  for (SurfaceId s(0); s.value < offsets_.size(); ++s.value) {
    const bool is_known = s.value < choices.known.size() && choices.known[s] && goals_[s].is_wanted;
    offsets_[s] = is_known ? *choices.known[s] : is_anchored(s) ? 0 : scales_[s];
  }
  StopCheck check(control);
  with_cuts.positions.change([&](std::vector<Vec3>& positions) {
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      check();
      const Vec3 way = moved_by(moves_.moves(i), offsets_);
      if (way == Vec3{}) continue;
      const VertexId v = moves_.vertex(i);
      positions[v.value] += way;
      with_cuts.local[v] = with_cuts.to_local(positions[v.value]);
    }
  });
  IdVector<SurfaceId, double> levers(offsets_.size(), 0);
  for (std::size_t i = 0; i < moves_.size(); ++i)
    for (const OffsetMove& move : moves_.moves(i))
      levers[move.surface] =
          std::max(levers[move.surface], offset_lever(curved.surfaces.surfaces[move.surface].shape, moves_.place(i)));
  for (CurvedPatch& patch : curved.curved) {
    const double offset = offsets_[patch.surface];
    if (offset == 0) continue;
    patch.map = offset_map(patch.map, offset, cut.surface.unit);
    // Vertices that could not be moved are at this distance from the moved surface.
    patch.limits.max_height += std::fabs(offset) * levers[patch.surface];
  }
  return std::any_of(goals_.begin(), goals_.end(), [](const OffsetGoal& goal) { return goal.is_wanted; });
}

void VolumeOffsets::set_goals(const CutPatches& cut, const OffsetChoices& choices, const CurvedPatches& curved,
                              RunControl& control) {
  goals_.assign(curved.surfaces.surfaces.size(), {});
  IdVector<SurfaceId, double> volumes(goals_.size(), 0), areas(goals_.size(), 0);
  StopCheck check(control);
  for (std::size_t i = 0; i < cut.patches.count(); ++i) {
    check();
    const PatchId p(i);
    const CurvedPatch* const patch = curved.of(p);
    if (patch == nullptr || choices.is_left(patch->surface)) continue;
    OffsetGoal& goal = goals_[patch->surface];
    const AnalyticSurface& shape = curved.surfaces.surfaces[patch->surface].shape;
    // All patches of a cylinder are measured from the same point of its axis.
    const bool has_centre = goal.is_wanted && shape.kind == SurfaceKind::kCylinder;
    SurfaceIntegral integral(shape, has_centre ? goal.centre : middle_of(patch->map, cut.surface.unit),
                             cut.surface.unit);
    for (std::uint32_t l = cut.loops.patch_begin[i]; l < cut.loops.patch_begin[i + 1]; ++l)
      for_each_piece(cut, cut.loops.loop(l), [&](const LoopPiece& piece) {
        check();
        const TrueCurve curve(cut, curved, p, piece);
        goal.is_area = goal.is_area || curve.is_open();
        integral.add(curve.points());
      });
    if (!goal.is_wanted) goal.centre = integral.centre();
    goal.is_wanted = true;
    volumes[patch->surface] += integral.volume();
    areas[patch->surface] += std::fabs(integral.area());
  }
  for (SurfaceId s(0); s.value < goals_.size(); ++s.value) goals_[s].target = goals_[s].is_area ? areas[s] : volumes[s];
}

/// Finds the surfaces with vertices on their boundaries that move less than half as far as the surface does.
void VolumeOffsets::find_anchored(const CutPatches& cut, const CurvedPatches& curved, RunControl& control) {
  is_anchored_.assign(goals_.size(), 0);
  StopCheck check(control);
  for (PatchId p(0); p.value < cut.patches.count(); ++p.value) {
    if (curved.of(p) == nullptr) continue;
    const CurvedPatch& patch = *curved.of(p);
    const AnalyticSurface& shape = curved.surfaces.surfaces[patch.surface].shape;
    for (std::uint32_t l = cut.loops.patch_begin[p.value]; l < cut.loops.patch_begin[p.value + 1]; ++l)
      for_each_piece(cut, cut.loops.loop(l), [&](const LoopPiece& piece) {
        check();
        const std::size_t i = moves_.find(piece.from);
        double far = 0;
        for (const OffsetMove& move : moves_.moves(i))
          if (move.surface == patch.surface) far = norm(move.way);
        if (far < 0.5 * offset_lever(shape, moves_.place(i))) is_anchored_[patch.surface] = 1;
      });
  }
}

/// Estimates offsets from how far edges may turn. A regular polygon of the same area as a circle has a radius that is
/// larger by the root of x / sin x, if x is the angle of a piece; one of the same length by x / 2 / sin(x / 2).
void VolumeOffsets::set_scales(const CurvedPatches& curved) {
  scales_.assign(goals_.size(), 0);
  for (const CurvedPatch& patch : curved.curved) {
    const OffsetGoal& goal = goals_[patch.surface];
    if (!goal.is_wanted) continue;
    const AnalyticSurface& shape = curved.surfaces.surfaces[patch.surface].shape;
    const double radius = shape.kind == SurfaceKind::kTorus ? shape.minor_radius : shape.radius;
    double turn = patch.limits.max_turn;
    if (radius > 0 && patch.limits.max_height < radius)
      turn = std::min(turn, 2 * std::acos(1 - patch.limits.max_height / radius));
    const double growth = goal.is_area ? turn / 2 / std::sin(turn / 2) - 1 : std::sqrt(turn / std::sin(turn)) - 1;
    scales_[patch.surface] = shape.kind == SurfaceKind::kCone
                                 ? std::atan((1 + growth) * std::tan(shape.half_angle)) - shape.half_angle
                                 : growth * radius;
  }
}

std::vector<SurfaceId> VolumeOffsets::moved_at(SurfaceId surface) const {
  if (goals_[surface].is_wanted) return {surface};
  std::vector<SurfaceId> found;
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const std::span<const OffsetMove> moves = moves_.moves(i);
    if (std::none_of(moves.begin(), moves.end(), [&](const OffsetMove& move) { return move.surface == surface; }))
      continue;
    for (const OffsetMove& move : moves)
      if (goals_[move.surface].is_wanted) found.push_back(move.surface);
  }
  sort_unique(found);
  return found;
}

}  // namespace remesh
