#include "core/refinement/refiner/patch_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/small_blocks.h"
#include "core/base/stoppable.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/refiner/lattice_fill.h"
#include "core/triangulation/patch_triangulation.h"

namespace remesh {
namespace {

/// A piece of the boundary lies between two vertices. The patch is on its left.
struct Piece {
  std::uint32_t from, to, side;
};

struct Triangulated {
  Triangulation2d mesh;
  std::vector<std::uint32_t> number;     ///< index in `points`, one per vertex of `mesh`
  std::vector<std::uint32_t> half_edge;  ///< one per side
};

/// Triangulates points between pieces. Returns nothing if rounding prevents it.
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
  if (made.outcome != TriangulationOutcome::kDone) return std::nullopt;

  // The constrained half-edges of the sides are found again by their ends.
  sort_stoppable(pieces.begin(), pieces.end(), control,
                 [](const Piece& a, const Piece& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
  result.half_edge.assign(side_count, kNone);
  StopCheck check(control);
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); ++h) {
    check();
    if (!made.mesh.is_constrained(h)) continue;
    const std::pair ends(order[made.mesh.from(h)], order[made.mesh.to(h)]);
    const auto piece = std::lower_bound(pieces.begin(), pieces.end(), ends,
                                        [](const Piece& p, const auto& e) { return std::pair(p.from, p.to) < e; });
    if (piece != pieces.end() && std::pair(piece->from, piece->to) == ends) result.half_edge[piece->side] = h;
  }
  if (std::find(result.half_edge.begin(), result.half_edge.end(), kNone) != result.half_edge.end()) return std::nullopt;
  result.mesh = std::move(made.mesh);
  return result;
}

std::vector<std::array<Vec2, 3>> triangles_of(const Triangulation2d& mesh, std::span<const Vec2> points,
                                              const std::vector<std::uint32_t>& number) {
  std::vector<std::array<Vec2, 3>> triangles;
  triangles.reserve(mesh.triangle_count());
  const auto point = [&](std::uint32_t h) { return points[number.empty() ? mesh.from(h) : number[mesh.from(h)]]; };
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    triangles.push_back({point(h), point(h + 1), point(h + 2)});
  return triangles;
}

/// Makes the start of one patch. The object keeps no results.
class Starter {
 public:
  Starter(const PatchToRefine& patch, const PatchSizes& sizes, DelaunayMesh::Scratch& scratch,
          std::pmr::memory_resource* memory, RunControl& control)
      : patch_(patch),
        sizes_(sizes),
        chart_(sizes.chart()),
        min_edge_length_(sizes.criteria().min_edge_length),
        scratch_(scratch),
        memory_(memory),
        control_(control) {}

  /// Begins with the patch as it was triangulated before refinement.
  PatchStart as_triangulated() const { return with_first_mesh(original_places(), PatchBoundary(patch_, memory_)); }

  /// Begins with all cuts made and with lattices of points inside, if rounding allows both.
  PatchStart evenly(const SegmentCuts::OfSegments& cuts, std::uint64_t quota) const {
    const InlineVector<Vec2, 3>& uv = patch_.mesh.uv;
    Outline outline{{uv.begin(), uv.end()}, {}, original_places(), PatchBoundary(patch_, memory_)};
    cut(outline, cuts);
    std::vector<Vec2>& points = outline.points;
    std::optional<Triangulated> made;
    if (points.size() > uv.size()) {
      made = triangulate(points, outline.pieces, outline.boundary.side_count(), control_);
      if (!made) return as_triangulated();
    }
    const Fill fill = fill_of(outline, made, quota);
    if (!fill.points.empty()) {
      std::vector<Vec2> all = points;
      all.insert(all.end(), fill.points.begin(), fill.points.end());
      std::optional<Triangulated> filled = triangulate(all, outline.pieces, outline.boundary.side_count(), control_);
      if (filled) {
        made = std::move(filled);
        points = std::move(all);
        outline.places.insert(outline.places.end(), fill.places.begin(), fill.places.end());
      }
    }
    if (!made) return with_first_mesh(std::move(outline.places), std::move(outline.boundary));
    return {DelaunayMesh(made->mesh, points, made->half_edge, scratch_, made->number, memory_),
            std::move(outline.places), std::move(outline.boundary)};
  }

 private:
  using Places = std::pmr::vector<VertexPlace>;

  /// The vertices are those of the patch, then the cuts. The pieces run from one vertex to the next, side by side.
  struct Outline {
    std::vector<Vec2> points;
    std::vector<Piece> pieces;
    Places places;  ///< one per point
    PatchBoundary boundary;
  };
  /// Points inside, with their places.
  struct Fill {
    std::vector<Vec2> points;
    std::vector<VertexPlace> places;
  };

  /// Returns the start with the mesh of the patch's first triangulation.
  PatchStart with_first_mesh(Places places, PatchBoundary boundary) const {
    StackMemory memory;
    std::pmr::vector<std::uint32_t> half_edges(&memory);
    const auto own = patch_.segments.sides_of_patch(patch_.id);
    half_edges.reserve(own.size());
    for (const std::uint32_t i : own) half_edges.push_back(patch_.segments.all_sides()[i].half_edge);
    return {DelaunayMesh(patch_.mesh.mesh, patch_.mesh.uv, half_edges, scratch_, {}, memory_), std::move(places),
            std::move(boundary)};
  }

  /// Returns the places of the vertices that the patch has. A vertex on the boundary has the smallest floor of its
  /// segments. A vertex inside has a floor that depends on the vertices next to it.
  Places original_places() const {
    const PatchMesh& patch = patch_.mesh;
    const Triangulation2d& mesh = patch.mesh;
    const std::size_t n = patch.vertices.size();
    StackMemory memory;
    std::pmr::vector<MinSpacing> spacing(n, {std::numeric_limits<double>::infinity()}, &memory);
    for (const std::uint32_t i : patch_.segments.sides_of_patch(patch_.id)) {
      const SegmentSide& side = patch_.segments.all_sides()[i];
      const BoundarySegment& segment = patch_.segments[side.segment];
      for (const std::uint32_t v : {mesh.from(side.half_edge), mesh.to(side.half_edge)})
        spacing[v] = std::min(spacing[v], {segment.floor, segment.is_min_edge_user_limit});
    }
    std::pmr::vector<std::uint8_t> is_inside(n, 0, &memory);
    for (std::size_t v = 0; v < n; ++v) is_inside[v] = std::isinf(spacing[v].length);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
      for (const std::uint32_t v : {mesh.from(h), mesh.to(h)})
        if (is_inside[v] != 0) {
          const double length = norm(patch.uv[mesh.to(h)] - patch.uv[mesh.from(h)]);
          const double nearest = std::min(spacing[v].length, length * chart_.scale(patch.uv[v]) * kFloorShare);
          spacing[v] = MinSpacing::above(min_edge_length_, nearest);
        }
    Places places(memory_);
    places.reserve(2 * n);
    for (const MinSpacing& s : spacing) places.push_back(VertexPlace::original(s));
    return places;
  }

  /// Makes all cuts of the outline.
  void cut(Outline& outline, const SegmentCuts::OfSegments& cuts) const {
    const Triangulation2d& mesh = patch_.mesh.mesh;
    const auto own = patch_.segments.sides_of_patch(patch_.id);
    PatchBoundary& boundary = outline.boundary;
    std::uint32_t first_cut = 0;  // the first vertex on the segment
    for (std::uint32_t s = 0; s < own.size(); ++s) {
      const PatchBoundary::Side side = boundary.side(s);
      const SegmentId segment = boundary.segment_of(s);
      const std::vector<double>& at = cuts[segment];
      const bool is_second = side.partner != kNone && side.partner < s;
      if (!is_second) {
        first_cut = static_cast<std::uint32_t>(outline.points.size());
        for (const double t : at) {
          outline.points.push_back(chart_.to_plane(boundary.position(segment, t)));
          outline.places.push_back(VertexPlace::on_segment(segment, t));
        }
      }
      const std::uint32_t first_new = boundary.divide(s, at);
      const std::uint32_t h = patch_.segments.all_sides()[own[s]].half_edge;
      const std::uint32_t begin = side.is_forward ? mesh.from(h) : mesh.to(h);
      const std::uint32_t end = side.is_forward ? mesh.to(h) : mesh.from(h);
      const auto n = static_cast<std::uint32_t>(at.size());
      for (std::uint32_t k = 0; k <= n; ++k) {
        const std::uint32_t a = k == 0 ? begin : first_cut + k - 1, b = k == n ? end : first_cut + k;
        const std::uint32_t number = k == 0 ? s : first_new + k - 1;
        outline.pieces.push_back({side.is_forward ? a : b, side.is_forward ? b : a, number});
      }
    }
  }

  /// Returns the points of lattices inside the patch.
  /// Input: `made` is the triangulation of the outline. It is empty if the outline has no cuts.
  Fill fill_of(const Outline& outline, const std::optional<Triangulated>& made, std::uint64_t quota) const {
    const std::vector<Vec2>& points = outline.points;
    const PlaneSizes sizes = sizes_.of_lattices();
    const auto is_too_fine = [&](double size) { return size / 2 < min_edge_length_; };
    if (sizes.is_uniform && is_too_fine(sizes_.criteria().even_size)) return {};
    const std::size_t max_points = std::min<std::uint64_t>(quota / 3, std::uint64_t{1} << 27);
    if (max_points < kMinPoints) return {};
    const std::vector<std::array<Vec2, 3>> triangles =
        made ? triangles_of(made->mesh, points, made->number) : triangles_of(patch_.mesh.mesh, patch_.mesh.uv, {});
    std::vector<Vec2> boundary = points;
    for (const Piece& piece : outline.pieces) boundary.push_back(0.5 * (points[piece.from] + points[piece.to]));
    // Points are rounded to the grid, and once more in space.
    const double shortest = min_edge_length_ / chart_.scale(patch_.mesh.uv.front()) * (1 + 1e-9) + 2 * chart_.grid();
    Fill fill;
    for (const Vec2 p : lattice_fill(triangles, boundary, points.size(), sizes, shortest, max_points, control_)) {
      const double size = sizes.at(p) * chart_.scale(p);
      if (is_too_fine(size)) continue;
      fill.points.push_back(chart_.on_grid(p));
      fill.places.push_back(VertexPlace::free(MinSpacing::above(min_edge_length_, size * kFloorShare)));
    }
    return fill;
  }

  /// For fewer points than this, a lattice is not worth reading the sizes of all triangles.
  static constexpr std::size_t kMinPoints = 16;

  const PatchToRefine& patch_;
  const PatchSizes& sizes_;
  const PatchChart& chart_;
  double min_edge_length_;
  DelaunayMesh::Scratch& scratch_;
  std::pmr::memory_resource* memory_;
  RunControl& control_;
};

}  // namespace

PatchStart start_patch(const PatchToRefine& patch, const PatchSizes& sizes, const SegmentCuts::OfSegments& cuts,
                       std::uint64_t quota, DelaunayMesh::Scratch& scratch, std::pmr::memory_resource* memory,
                       RunControl& control) {
  const Starter starter(patch, sizes, scratch, memory, control);
  return sizes.criteria().has_sizes() ? starter.evenly(cuts, quota) : starter.as_triangulated();
}

}  // namespace remesh
