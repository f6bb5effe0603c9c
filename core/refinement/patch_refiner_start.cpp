/// This file has the members of PatchRefiner that begin the refinement of a patch. The patch begins as it was
/// triangulated, or it is triangulated anew with cuts for its sizes and with points inside.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include "core/base/stoppable.h"
#include "core/refinement/even_fill.h"
#include "core/refinement/patch_refiner.h"
#include "core/triangulation/patch_triangulation.h"

namespace remesh {
namespace {

std::pmr::vector<std::uint32_t> half_edges_of(const SegmentTable& segments, PatchId p,
                                              std::pmr::memory_resource* memory) {
  std::pmr::vector<std::uint32_t> half_edges(memory);
  half_edges.reserve(segments.sides_of_patch(p).size());
  for (const std::uint32_t i : segments.sides_of_patch(p)) half_edges.push_back(segments.all_sides()[i].half_edge);
  return half_edges;
}

/// A piece of the boundary lies between two vertices. The patch is on its left.
struct Piece {
  std::uint32_t from, to, side;
};

struct Triangulated {
  Triangulation2d mesh;
  std::vector<std::uint32_t> number;     ///< index in `points`, one per vertex of `mesh`
  std::vector<std::uint32_t> half_edge;  ///< one per side
};

/// Triangulates points between pieces. Returns nothing if rounding forbids it.
std::optional<Triangulated> triangulate(const std::vector<Vec2>& points, std::vector<Piece> pieces,
                                        std::size_t side_count, RunControl& control) {
  const auto n = static_cast<std::uint32_t>(points.size());
  Triangulated result;
  std::vector<std::uint32_t>& order = result.number;
  std::vector<std::uint32_t> rank(n);
  order.resize(n);
  std::iota(order.begin(), order.end(), 0u);
  sort_stoppable(order.begin(), order.end(), control, [&](auto a, auto b) { return points[a] < points[b]; });
  std::vector<Vec2> sorted(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    rank[order[k]] = k;
    sorted[k] = points[order[k]];
    if (k > 0 && sorted[k] == sorted[k - 1]) return std::nullopt;
  }
  std::vector<Segment> loop_edges;
  loop_edges.reserve(pieces.size());
  for (const Piece& piece : pieces) loop_edges.push_back({rank[piece.from], rank[piece.to]});
  PatchTriangulation made = triangulate_patch(sorted, loop_edges, control);
  if (made.outcome != Outcome::kDone) return std::nullopt;

  // The constrained half-edges of the sides are found again by their ends.
  sort_stoppable(pieces.begin(), pieces.end(), control,
                 [](const Piece& a, const Piece& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
  result.half_edge.assign(side_count, DelaunayMesh::kNone);
  StopCheck check(control);
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); ++h) {
    check();
    if (!made.mesh.is_constrained(h)) continue;
    const std::pair ends(order[made.mesh.from(h)], order[made.mesh.to(h)]);
    const auto piece = std::lower_bound(pieces.begin(), pieces.end(), ends,
                                        [](const Piece& p, const auto& e) { return std::pair(p.from, p.to) < e; });
    if (piece != pieces.end() && std::pair(piece->from, piece->to) == ends) result.half_edge[piece->side] = h;
  }
  if (std::find(result.half_edge.begin(), result.half_edge.end(), DelaunayMesh::kNone) != result.half_edge.end())
    return std::nullopt;
  result.mesh = std::move(made.mesh);
  return result;
}

std::vector<std::array<Vec2, 3>> triangles_of(const Triangulation2d& mesh, const std::vector<Vec2>& points,
                                              const std::vector<std::uint32_t>& number) {
  std::vector<std::array<Vec2, 3>> triangles;
  triangles.reserve(mesh.triangle_count());
  const auto point = [&](std::uint32_t h) { return points[number.empty() ? mesh.from(h) : number[mesh.from(h)]]; };
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    triangles.push_back({point(h), point(h + 1), point(h + 2)});
  return triangles;
}

}  // namespace

PatchRefiner::PatchRefiner(const PatchMesh& patch, const PatchChart& chart, PatchId id, const SegmentTable& segments,
                           const Criteria& criteria, const SegmentCuts::OfSegments& cuts, std::uint64_t quota,
                           Workplace& at, RunControl& control)
    : patch_(patch),
      chart_(chart),
      segments_(segments),
      criteria_(criteria),
      corner_count_(static_cast<std::uint32_t>(patch.vertices.size())),
      at_(&at),
      memory_(first_block(patch, segments.sides_of_patch(id).size())) {
  segment_.reserve(2 * std::size_t{corner_count_});
  segment_.resize(corner_count_);
  value_.reserve(2 * std::size_t{corner_count_});
  value_.assign(corner_count_, std::numeric_limits<double>::infinity());
  collect_corners(id);
  collect_sides(id);
  collect_held_sides(id, control);
  if (!start_evenly(id, cuts, quota, control)) {
    segment_.resize(corner_count_);
    value_.resize(corner_count_);
    sides_.clear();
    chains_.clear();
    collect_sides(id);
    StackMemory memory;
    mesh_ = DelaunayMesh(patch.mesh, patch.uv, half_edges_of(segments, id, &memory), at.mesh, {}, &memory_);
  }
  begin_turn(at);
  state_.reserve(2 * std::size_t{mesh_.triangle_slots()});
  state_.assign(mesh_.triangle_slots(), State::kUnknown);
  StopCheck check(control);
  for (std::uint32_t t = 0; t < mesh_.triangle_slots(); ++t) {
    check();
    classify(t);
  }
  for (std::size_t c = 0; c < chains_.size() && !impossible_.is_valid(); ++c)
    if (!cuts[chains_[c].segment].empty()) take_over(chains_[c].segment, cuts[chains_[c].segment]);
  first_refined_ = mesh_.vertex_slots();
}

std::size_t PatchRefiner::first_block(const PatchMesh& patch, std::size_t sides) {
  const std::size_t vertices = patch.vertices.size(), triangles = patch.mesh.triangle_count();
  constexpr std::size_t kVertex = sizeof(Vec2) + sizeof(std::uint32_t) + sizeof(SegmentId) + sizeof(double),
                        kTriangle = 6 * sizeof(std::uint32_t) + sizeof(State),
                        kSide = sizeof(Side) + sizeof(std::uint32_t) + sizeof(Cut);
  // Everything that grows counts twice, and everything that stays as it is counts once.
  const std::size_t bytes = 2 * (vertices * kVertex + triangles * kTriangle + sides * kSide) +
                            vertices * sizeof(std::uint32_t) + sides * (2 * sizeof(CornerSegment) + sizeof(Chain));
  // A patch that needs more has large arrays, and most of these get blocks of their own.
  constexpr std::size_t kLeast = 256, kMost = 4096;
  return std::clamp(bytes, kLeast, kMost);
}

void PatchRefiner::begin_turn(Workplace& at) {
  at_ = &at;
  mesh_.use(at.mesh);
  if (!is_done()) return;
  std::swap(waiting_, at.waiting);
  constexpr std::uint32_t kFewTriangles = 64;
  waiting_.clear(mesh_.triangle_slots() > kFewTriangles ? 8 : 1);
}

void PatchRefiner::end_turn() {
  if (is_done()) at_->waiting = std::exchange(waiting_, {});
}

/// Collects the segments that meet at each corner, and the corners' floors.
void PatchRefiner::collect_corners(PatchId id) {
  const auto for_each_end = [&](const auto& visit) {
    for (const std::uint32_t i : segments_.sides_of_patch(id)) {
      const SegmentSide& side = segments_.all_sides()[i];
      const std::uint32_t a = patch_.mesh.from(side.half_edge), b = patch_.mesh.to(side.half_edge);
      visit(a, b, side.segment);
      visit(b, a, side.segment);
    }
  };
  // The segments are counted for each corner first. Only few meet at one.
  corner_begin_.assign(corner_count_ + 1, 0);
  for_each_end([&](std::uint32_t corner, std::uint32_t, SegmentId s) {
    ++corner_begin_[corner + 1];
    value_[corner] = std::min(Floor(value_[corner]), floor_on(s)).packed();
  });
  std::partial_sum(corner_begin_.begin(), corner_begin_.end(), corner_begin_.begin());
  corner_segments_.resize(corner_begin_[corner_count_]);
  StackMemory memory;
  std::pmr::vector<std::uint32_t> at(corner_begin_.begin(), corner_begin_.end() - 1, &memory);
  for_each_end([&](std::uint32_t corner, std::uint32_t other, SegmentId s) {
    corner_segments_[at[corner]++] = {patch_.vertices[other], s};
  });
  for (std::uint32_t v = 0; v < corner_count_; ++v)
    std::sort(corner_segments_.begin() + corner_begin_[v], corner_segments_.begin() + corner_begin_[v + 1],
              [](const CornerSegment& a, const CornerSegment& b) {
                return std::tie(a.other, a.segment) < std::tie(b.other, b.segment);
              });
  // A vertex inside the patch has a floor that depends on the vertices next to it.
  std::pmr::vector<std::uint8_t> is_inside(corner_count_, 0, &memory);
  for (std::uint32_t v = 0; v < corner_count_; ++v) is_inside[v] = std::isinf(value_[v]);
  for (std::uint32_t h = 0; h < patch_.mesh.half_edge_count(); ++h)
    for (const std::uint32_t v : {patch_.mesh.from(h), patch_.mesh.to(h)})
      if (is_inside[v] != 0) {
        const double length = norm(patch_.uv[patch_.mesh.to(h)] - patch_.uv[patch_.mesh.from(h)]);
        const double nearest = std::min(Floor(value_[v]).length(), length * chart_.scale(patch_.uv[v]) * 0x1p-6);
        value_[v] = Floor::above(criteria_.min_edge_length, nearest).packed();
      }
}

/// The place of a side within its chain does not matter.
void PatchRefiner::add_to_chain(std::uint32_t side) {
  sides_[side].next = std::exchange(chains_[sides_[side].chain].first, side);
}

/// Collects the sides as they are in the patch's mesh: one for each segment, or two for a slit, which follow each
/// other.
void PatchRefiner::collect_sides(PatchId id) {
  sides_.reserve(2 * segments_.sides_of_patch(id).size());
  chains_.reserve(segments_.sides_of_patch(id).size());
  for (const std::uint32_t i : segments_.sides_of_patch(id)) {
    const SegmentSide& side = segments_.all_sides()[i];
    const auto index = static_cast<std::uint32_t>(sides_.size());
    const bool is_second = !chains_.empty() && chains_.back().segment == side.segment;
    if (is_second)
      sides_.back().partner = index;
    else
      chains_.push_back({side.segment, index});
    const bool is_forward = patch_.vertices[patch_.mesh.from(side.half_edge)] == segments_[side.segment].from;
    sides_.push_back(
        {0, 1, kNone, static_cast<std::uint32_t>(chains_.size() - 1), is_second ? index - 1 : kNone, is_forward});
  }
}

/// Collects the sides that are longer than sizes allow and that stay.
void PatchRefiner::collect_held_sides(PatchId id, RunControl& control) {
  if (!criteria_.has_sizes) return;
  std::vector<HeldSide> held;
  for (const std::uint32_t i : segments_.sides_of_patch(id)) {
    const SegmentSide& side = segments_.all_sides()[i];
    const BoundarySegment& segment = segments_[side.segment];
    if (!segment.is_locked()) continue;
    const Vec2 a = patch_.uv[patch_.mesh.from(side.half_edge)], b = patch_.uv[patch_.mesh.to(side.half_edge)];
    const Vec2 middle = 0.5 * (a + b);
    const double size =
        std::min(criteria_.sizes.at(chart_.to_space(middle)), criteria_.area_edge) / chart_.scale(middle);
    if (!(norm(b - a) > size * kSizeMargin)) continue;
    held.push_back({a, b, size});
    const State why = why_locked(segment.lock);
    held_as_ = held.size() == 1 ? why : stronger(held_as_, why);
  }
  if (!held.empty()) held_ = std::make_unique<const HeldSizes>(held, criteria_.min_angle_deg, control);
}

/// Triangulates the patch anew from its cut boundary and from lattices of points inside, if there are sizes. Returns
/// false if that would change nothing, or if rounding forbids it. Then vertices and sides may have been changed.
bool PatchRefiner::start_evenly(PatchId id, const SegmentCuts::OfSegments& cuts, std::uint64_t quota,
                                RunControl& control) {
  const SizeField& sizes = criteria_.sizes;
  if (sizes.is_uniform() && !std::isfinite(criteria_.even_size)) return false;

  // The vertices are the corners and then the cuts. The pieces run from one vertex to the next, side by side.
  std::vector<Vec2> points = patch_.uv;
  std::vector<Piece> pieces;
  const auto original = static_cast<std::uint32_t>(sides_.size());
  const auto own = segments_.sides_of_patch(id);
  // These are the first vertex on the segment of s, and the first of the sides that are added for s.
  std::uint32_t first_cut = 0, first_piece = 0;
  for (std::uint32_t s = 0; s < original; ++s) {
    const Side side = sides_[s];
    const std::vector<double>& at = cuts[segment_of(side)];
    const auto n = static_cast<std::uint32_t>(at.size());
    const bool is_second = side.partner != kNone && side.partner < s;
    if (!is_second) {
      first_cut = static_cast<std::uint32_t>(points.size());
      first_piece = static_cast<std::uint32_t>(sides_.size());
      for (const double t : at) {
        points.push_back(chart_.to_plane(segments_.position(segment_of(side), t)));
        segment_.push_back(segment_of(side));
        value_.push_back(t);
      }
    }
    const std::uint32_t h = segments_.all_sides()[own[s]].half_edge;
    const std::uint32_t begin = side.is_forward ? patch_.mesh.from(h) : patch_.mesh.to(h);
    const std::uint32_t end = side.is_forward ? patch_.mesh.to(h) : patch_.mesh.from(h);
    for (std::uint32_t k = 0; k <= n; ++k) {
      // This is the piece between the k-th vertex along the segment and the next one.
      const std::uint32_t index = k == 0 ? s : static_cast<std::uint32_t>(sides_.size());
      if (k > 0) {
        sides_.push_back(side);
        sides_[index].partner = kNone;
        if (is_second) {
          sides_[index].partner = first_piece + k - 1;
          sides_[first_piece + k - 1].partner = index;
        } else {
          add_to_chain(index);
        }
      }
      sides_[index].t0 = k == 0 ? 0 : at[k - 1];
      sides_[index].t1 = k == n ? 1 : at[k];
      const std::uint32_t a = k == 0 ? begin : first_cut + k - 1, b = k == n ? end : first_cut + k;
      pieces.push_back({side.is_forward ? a : b, side.is_forward ? b : a, index});
    }
  }
  const bool has_cuts = points.size() > corner_count_;
  std::optional<Triangulated> made;
  if (has_cuts) {
    made = triangulate(points, pieces, sides_.size(), control);
    if (!made) return false;
  }

  // Lattices do not know the shortest edge that is allowed. Their edges may be half as long as the size.
  PlaneSizes plane_sizes;
  if (held_) {
    plane_sizes = {[&](Vec2 p) { return size_at(p); },
                   [&](double length, Vec2 p, double radius) { return allows(length, p, radius); }, false,
                   SizeField::kNoise};
  } else if (sizes.is_uniform()) {
    const auto size_in_plane = [&](Vec2 p) { return criteria_.even_size / chart_.scale(p); };
    plane_sizes = {size_in_plane, [=](double length, Vec2 p, double) { return length <= size_in_plane(p); }};
  } else {
    plane_sizes = {
        [&](Vec2 p) { return std::min(sizes.at(chart_.to_space(p)), criteria_.even_size) / chart_.scale(p); },
        [&](double length, Vec2 p, double radius) {
          const double scale = chart_.scale(p);
          return length * scale <= criteria_.even_size &&
                 sizes.allows(length * scale, chart_.to_space(p), radius * scale);
        },
        false, SizeField::kNoise};
  }
  const std::vector<std::array<Vec2, 3>> triangles =
      made ? triangles_of(made->mesh, points, made->number) : triangles_of(patch_.mesh, patch_.uv, {});
  std::vector<Vec2> boundary = points;
  for (const Piece& piece : pieces) boundary.push_back(0.5 * (points[piece.from] + points[piece.to]));
  const std::size_t most = std::min<std::uint64_t>(quota / 3, std::uint64_t{1} << 27);
  // Points are rounded to the grid, and again in space.
  const double shortest = criteria_.min_edge_length / chart_.scale(patch_.uv.front()) * (1 + 1e-9) + 2 * chart_.grid();
  const std::size_t before = points.size();
  const auto is_too_fine = [&](double size) { return size / 2 < criteria_.min_edge_length; };
  std::vector<Vec2> fill;
  if (!plane_sizes.is_uniform || !is_too_fine(criteria_.even_size))
    fill = even_fill(triangles, boundary, before, plane_sizes, shortest, most, control);
  for (const Vec2 p : fill) {
    const double size = plane_sizes.at(p) * chart_.scale(p);
    if (is_too_fine(size)) continue;
    points.push_back(on_grid(p));
    segment_.emplace_back();
    value_.push_back(Floor::above(criteria_.min_edge_length, size * 0x1p-6).packed());
  }
  if (points.size() > before) {
    std::optional<Triangulated> filled = triangulate(points, pieces, sides_.size(), control);
    if (filled) {
      made = std::move(filled);
    } else {
      points.resize(before);
      segment_.resize(before);
      value_.resize(before);
    }
  }
  if (!made) return false;
  quota_ = quota - std::min<std::uint64_t>(quota, made->mesh.triangle_count());
  mesh_ = DelaunayMesh(made->mesh, points, made->half_edge, at_->mesh, made->number, &memory_);
  return true;
}

}  // namespace remesh
