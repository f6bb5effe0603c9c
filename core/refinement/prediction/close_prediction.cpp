#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/blocks.h"
#include "core/patches/curved/curved_faces.h"
#include "core/refinement/prediction/edge_sizes.h"
#include "core/refinement/prediction/prediction.h"
#include "core/refinement/prediction/sampled_edges.h"
#include "core/refinement/sizes/fixed_side_sizes.h"

namespace remesh {
namespace {

/// No patch's share is larger than this, so it is always a number that can be computed with.
constexpr double kMaxShare = 0x1p62;

/// Predicts the faces of a patch whose boundary may be cut for angles, from the lengths of edges that are expected.
class PatchWithCuts {
 public:
  PatchWithCuts(const TriangulatedPatches& triangulated, PatchId p, const EdgeSizes& lengths, const Goals& goals,
                const SizeField& sizes)
      : id_(p),
        patch_(triangulated.meshes[p]),
        chart_(triangulated.charts[p]),
        lengths_(lengths),
        edges_(lengths.edges()),
        goals_(goals),
        sizes_(sizes),
        max_rows_(rows_to_read(sizes)) {}

  double run(RunControl& control) {
    find_fixed_sides(control);
    double faces = 0;
    for (std::uint32_t h = 0; h < patch_.mesh.half_edge_count(); h += 3) {
      control.check();
      faces += faces_of(h);
    }
    return chart_.curved() != nullptr ? std::max(faces, faces_by_turn(control)) : faces;
  }

 private:
  /// Returns the number of faces that fill a curved patch if edges turn as far as they may.
  double faces_by_turn(RunControl& control) const {
    const CurvedChart& curved = *chart_.curved();
    const AnalyticSurface& shape = curved.map().shape();
    const double radius = shape.kind == SurfaceKind::kTorus ? shape.minor_radius : shape.radius;
    double turn = curved.max_turn();
    if (shape.kind != SurfaceKind::kCone && radius > 0)
      turn = std::min(turn, 2 * std::acos(std::clamp(1 - curved.max_edge_height() / radius, -1.0, 1.0)));
    if (!(turn > 0)) return 0;
    constexpr int kRows = 4;
    double faces = 0;
    const Triangulation2d& mesh = patch_.mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      control.check();
      const Vec2 p[3] = {patch_.uv[mesh.from(h)], patch_.uv[mesh.from(h + 1)], patch_.uv[mesh.from(h + 2)]};
      const double part = cross(p[1] - p[0], p[2] - p[0]) / 2 / (kRows * kRows);
      for_parts(p, kRows, [&](Vec2 at) {
        const double scale = chart_.scale(at);
        faces += curved_faces_at_one(shape, chart_.to_space(at), part * scale * scale, goals_.min_angle_deg > 0);
      });
    }
    return faces / (turn * turn);
  }

  /// Calls visit(middle) for the small triangles into which a triangle is divided.
  template <class Visit>
  static void for_parts(const Vec2 (&p)[3], int rows, const Visit& visit) {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; i + j < rows; ++j)
        for (int up = 0; up < (i + j + 1 < rows ? 2 : 1); ++up) {
          const double u = (i + (1.0 + up) / 3) / rows, v = (j + (1.0 + up) / 3) / rows;
          visit(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]));
        }
  }

  /// Finds the sides that are longer than allowed and stay, because there is no room for a cut. Triangles beside them
  /// stay large.
  void find_fixed_sides(RunControl& control) {
    if (sizes_.is_uniform() && !std::isfinite(sizes_.largest()) && !std::isfinite(goals_.max_area)) return;
    std::vector<FixedSide> fixed;
    const Triangulation2d& mesh = patch_.mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      if (!mesh.is_constrained(h) || !lengths_.has_no_room(edges_.edge_at({id_, h}))) continue;
      const Vec2 a = patch_.uv[mesh.from(h)], b = patch_.uv[mesh.to(h)], middle = 0.5 * (a + b);
      const double size = EdgeSizes::asked_for(goals_, sizes_, chart_, middle) / chart_.scale(middle);
      if (norm(b - a) > size) fixed.push_back({a, b, size});
    }
    if (!fixed.empty()) fixed_ = std::make_unique<const FixedSideSizes>(fixed, goals_.min_angle_deg, control);
  }

  /// Returns the edge length that is asked for at a place, or the larger one that fixed sides make necessary there.
  double asked_at(Vec2 place) const {
    const double asked = EdgeSizes::asked_for(goals_, sizes_, chart_, place);
    return fixed_ != nullptr ? std::max(asked, fixed_->at(place) * chart_.scale(place)) : asked;
  }

  /// Returns the faces in the triangle of half-edge h. Each piece of its sides has one face. If there is room inside,
  /// the expected lengths give a number of faces for the area. If both numbers are about equal, points inside and cuts
  /// disturb each other, and a larger min angle makes this worse.
  double faces_of(std::uint32_t h) const {
    const std::uint32_t edge[3] = {edges_.edge_at({id_, h}), edges_.edge_at({id_, h + 1}),
                                   edges_.edge_at({id_, h + 2})};
    double at_sides = 1, perimeter = 0, room = HUGE_VAL;
    for (const std::uint32_t e : edge) {
      perimeter += edges_[e].length;
      at_sides += lengths_.pieces(e) - 1;
      if (lengths_.has_no_room(e)) room = std::min(room, 1 / lengths_.floor(e));
    }
    const Triangulation2d& mesh = patch_.mesh;
    const Vec2 p[3] = {patch_.uv[mesh.from(h)], patch_.uv[mesh.from(h + 1)], patch_.uv[mesh.from(h + 2)]};
    const double scale = edges_.scale({id_, h});
    const double twice = cross(p[1] - p[0], p[2] - p[0]) * scale * scale, depth = twice / perimeter;
    if (!(twice > 0) || depth * room < 1) return at_sides;
    double inside = 0;
    const double asked = asked_at((1.0 / 3) * (p[0] + p[1] + p[2]));
    for (const std::uint32_t e : edge) inside += faces_along(e, depth, asked);
    if (!sizes_.is_uniform()) inside = std::max(inside, faces_for_size(p, edge, twice / 2, asked));
    if (at_sides == 1 && inside < kFewInside && may_stay(h)) return 1;
    return std::max(at_sides, inside) + (kDisturbed - lengths_.slack()) * std::min(at_sides - 1, inside);
  }

  /// Returns the number of faces between a side of a triangle and the middle of its inscribed circle.
  double faces_along(std::uint32_t edge, double depth, double asked) const {
    const SampledEdge& e = edges_[edge];
    double sum = 0;
    for (std::uint32_t n = e.first_sample; n + 1 < e.first_sample + e.sample_count; ++n) {
      const double part = (edges_.place(n + 1) - edges_.place(n)) * e.length;
      sum += part * faces_above(std::min(asked, std::sqrt(lengths_.at(n) * lengths_.at(n + 1))), depth, asked);
    }
    return sum / equilateral_area(1);
  }

  /// Returns the integral of the width over the squared length of edges, from a side to the depth r. The width falls
  /// from 1 to 0, and the length grows from `length` to `asked` at most.
  double faces_above(double length, double r, double asked) const {
    const double growth = lengths_.growth();
    const double grown = asked > length ? std::min(r, (asked - length) / growth) : 0;
    double sum = 0;
    if (grown > 0) {
      const double last = length + growth * grown, of_r = growth * r;
      sum += ((1 + length / of_r) * (1 / length - 1 / last) - std::log(last / length) / of_r) / growth;
    }
    if (grown < r) sum += (r - grown) * (r - grown) / (2 * r * asked * asked);
    return sum;
  }

  /// Returns the number of faces that a triangle needs for sizes alone. The size is read in the middles of the small
  /// triangles into which it is divided. Their number follows from the size in its middle, `asked`: more of them could
  /// not have different sizes.
  double faces_for_size(const Vec2 (&p)[3], const std::uint32_t (&edge)[3], double area, double asked) const {
    const double longest = std::max({edges_[edge[0]].length, edges_[edge[1]].length, edges_[edge[2]].length});
    const int parts = static_cast<int>(std::clamp(std::ceil(longest / asked), 1.0, max_rows_));
    const auto faces_at = [&](double size) {
      return std::isfinite(size) ? area / (parts * parts) / equilateral_area(size) : 0;
    };
    if (parts == 1) return faces_at(asked);
    double faces = 0;
    for_parts(p, parts, [&](Vec2 at) { faces += faces_at(asked_at(at)); });
    return faces;
  }

  /// Returns whether all angles of a triangle below the bound are angles of the input.
  bool may_stay(std::uint32_t h) const {
    if (lengths_.is_excused(edges_.triangle_of({id_, h}))) return true;
    const Triangulation2d& mesh = patch_.mesh;
    for (std::uint32_t k = h; k < h + 3; ++k) {
      const Vec2 corner = patch_.uv[mesh.from(k)];
      const Vec2 u = patch_.uv[mesh.to(k)] - corner, v = patch_.uv[mesh.apex(k)] - corner;
      if (cross(u, v) < lengths_.tangent() * dot(u, v)) return false;
    }
    return true;
  }

  /// A triangle that may stay is expected to stay if at most this number of faces fits into it. See experiments.md,
  /// Prediction, for these two numbers.
  static constexpr double kFewInside = 1.6;
  static constexpr double kDisturbed = 1.1;

  const PatchId id_;
  const PatchMesh& patch_;
  const PatchChart chart_;
  const EdgeSizes& lengths_;
  const SampledEdges& edges_;
  const Goals& goals_;
  const SizeField& sizes_;
  std::unique_ptr<const FixedSideSizes> fixed_;  ///< null if no fixed side is too long
  const double max_rows_;  ///< the max number of rows into which a triangle is divided to read sizes in it
};

}  // namespace

Prediction predict_closely(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
                           RunControl& control) {
  if (!(goals.min_angle_deg > 0 && goals.split_boundaries)) return predict_roughly(triangulated, goals, sizes, control);
  constexpr std::size_t kPatches = 64;
  const SampledEdges edges(triangulated, !sizes.is_uniform(), control);
  const EdgeSizes lengths(edges, triangulated, goals, sizes, control);
  const auto of_blocks =
      map_blocks<Prediction>(triangulated.size(), kPatches, control, [&](std::size_t p, std::size_t end) {
        Prediction block;
        for (; p < end; ++p) {
          const double faces = PatchWithCuts(triangulated, PatchId(p), lengths, goals, sizes).run(control);
          block.expected += faces;
          block.of_patch.push_back(static_cast<float>(std::min(faces, kMaxShare)));
        }
        return block;
      });
  Prediction total;
  total.of_patch.reserve(triangulated.size());
  for (const Prediction& block : of_blocks) {
    total.expected += block.expected;
    total.of_patch.insert(total.of_patch.end(), block.of_patch.begin(), block.of_patch.end());
  }
  return total;
}

}  // namespace remesh
