#include "core/refinement/prediction/prediction.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/refinement/segments/strips.h"
#include "core/refinement/sizes/fixed_side_sizes.h"

namespace remesh {
namespace {

/// A piece of a boundary edge that another patch needs costs this number of faces. They fill the area from the edge to
/// where faces may be large again.
constexpr double kFacesPerPiece = 2.5;
/// No patch is predicted to have more faces than this, so that sums stay finite, however sharp the patch's angles or
/// small its sizes are.
constexpr double kMaxOfPatch = 0x1p62;
/// If a patch needs fewer pieces of an edge than this, the patches beside the edge do not take them into account.
constexpr double kFewPieces = 3;

/// The number of pieces that a patch needs of an edge between two vertices.
struct EdgePieces {
  VertexId from, to;  ///< the smaller id first
  double pieces;

  friend bool operator<(const EdgePieces& a, const EdgePieces& b) {
    return std::tie(a.from, a.to, a.pieces) < std::tie(b.from, b.to, b.pieces);
  }
};

/// Returns the number of pieces, each at most `most` long, that a boundary edge needs. An edge of ten lengths needs
/// ten, whatever its last digits are.
double count_pieces(double length, double most) { return std::max(1.0, std::ceil(length / most * (1 - 1e-12))); }

/// Returns the area of the largest triangle that sizes allow.
double largest_area(const Goals& goals, const SizeField& sizes) {
  return std::min(goals.max_area, equilateral_area(sizes.largest()));
}

double tangent_of_degrees(double degrees) { return std::tan(degrees * std::numbers::pi / 180); }

/// The goals, and the values that follow from them for all patches.
struct Asked {
  Asked(const Goals& its_goals, const SizeField& its_sizes)
      : goals(its_goals),
        sizes(its_sizes),
        tangent(tangent_of_degrees(goals.min_angle_deg)),
        strip_tangent(goals.min_angle_deg > 0 && goals.split_boundaries
                          ? tangent_of_degrees(std::max(goals.min_angle_deg, least_strip_angle_deg(sizes)))
                          : 0),
        rows(rows_to_read(sizes)) {}

  const Goals& goals;
  const SizeField& sizes;
  double tangent;        ///< tangent of the bound on angles
  double strip_tangent;  ///< tangent of the angle along strips; 0: boundaries are not cut for angles
  int rows;              ///< a triangle is divided into this number of rows to read sizes
};

class PatchPrediction {
 public:
  PatchPrediction(const PatchMesh& patch, const PatchChart& chart, const Asked& asked)
      : patch_(patch), chart_(chart), asked_(asked), goals_(asked.goals), sizes_(asked.sizes) {}

  /// Returns the number of faces for the pieces of boundary edges. Each edge has as many pieces as the patch that needs
  /// the largest number.
  double faces_for_pieces(const std::vector<EdgePieces>& needed) const {
    double faces = 0;
    for (std::uint32_t h = 0; h < patch_.mesh.half_edge_count(); ++h) {
      if (!patch_.mesh.is_constrained(h)) continue;
      const auto [from, to] = ends(h);
      const auto most = std::lower_bound(needed.begin(), needed.end(), EdgePieces{from, to, 0});
      if (most == needed.end() || most->from != from || most->to != to) continue;
      const double own = pieces_for_angle(h);
      faces += own + kFacesPerPiece * (most->pieces - own);
    }
    return faces;
  }

  /// Predicts the faces of the patch. Appends the boundary edges of which the patch needs many pieces to `many_pieces`.
  Prediction run(std::vector<EdgePieces>& many_pieces, RunControl& control) const {
    const Triangulation2d& mesh = patch_.mesh;
    const std::unique_ptr<const FixedSideSizes> fixed = fixed_side_sizes(control);
    double pieces = 0, area = 0, by_angle = 0, by_size = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      control.check();
      const Vec2 p[3] = {patch_.uv[mesh.from(h)], patch_.uv[mesh.from(h + 1)], patch_.uv[mesh.from(h + 2)]};
      const double scale = chart_.scale(p[0]);
      double length[3];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec2 side = p[(k + 1) % 3] - p[k];
        length[k] = std::sqrt(dot(side, side)) * scale;
        if (mesh.is_constrained(h + k) && goals_.split_boundaries) pieces += count_pieces(length[k], sizes_.largest());
      }
      const double triangle = cross(p[1] - p[0], p[2] - p[0]) / 2 * scale * scale;
      area += triangle;
      bool is_filled = false;
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (asked_.strip_tangent == 0 || !mesh.is_constrained(h + k)) continue;
        const double needed = pieces_for_angle(h + k);
        if (needed < kFewPieces) continue;
        const auto [from, to] = ends(h + k);
        many_pieces.push_back({from, to, needed});
        is_filled = is_filled || length[k] > std::min({length[0], length[1], length[2]});
      }
      by_angle += is_filled ? 1 : faces_for_angle(length, triangle);
      by_size += faces_for_size(p, triangle, std::max({length[0], length[1], length[2]}), fixed.get());
    }
    Prediction result;
    result.expected = std::max({static_cast<double>(mesh.triangle_count()), pieces - 2,
                                fixed ? 0 : area / largest_area(goals_, sizes_), by_angle, by_size});
    return result;
  }

 private:
  std::pair<VertexId, VertexId> ends(std::uint32_t h) const {
    return std::minmax({patch_.vertices[patch_.mesh.from(h)], patch_.vertices[patch_.mesh.to(h)]});
  }

  /// Returns the number of pieces of a boundary edge that the bound on angles needs where the patch is narrow beside
  /// the edge. Each piece is as long as twice the width over the tangent of the angle. The width is that of the
  /// triangle at the edge and, beyond the triangle's other sides, that of the triangles there. Towards an edge that
  /// meets this one, no pieces are needed, because there the angle of the input counts.
  double pieces_for_angle(std::uint32_t h) const {
    const Triangulation2d& mesh = patch_.mesh;
    const Vec2 a = patch_.uv[mesh.from(h)], b = patch_.uv[mesh.to(h)], c = patch_.uv[mesh.apex(h)];
    const double length = norm(b - a);
    const Vec2 along = (1 / length) * (b - a);
    const double place = std::clamp(dot(along, c - a), 0.0, length), width = cross(along, c - a);
    double pieces = 0;
    for (const bool is_start : {true, false}) {
      const std::uint32_t side = is_start ? Triangulation2d::previous(h) : Triangulation2d::next(h);
      const double part = is_start ? place : length - place;
      if (mesh.is_constrained(side) || !(part > 0) || !(width > 0)) continue;
      const double beyond = std::max(width, cross(along, patch_.uv[mesh.apex(mesh.twin(side))] - a));
      const double growth = beyond / width - 1;
      // This is the mean of one over a width that grows evenly.
      pieces += part / width * (growth > 1e-3 ? std::log1p(growth) / growth : 1);
    }
    const double most = length * chart_.scale(a) / goals_.min_edge_length;
    return std::max(1.0, std::min(pieces * asked_.strip_tangent / 2, most));
  }

  /// Returns the number of faces that fill a triangle with a small angle. They grow from its short edge. The faces that
  /// grow from pieces of its long edge are counted with the pieces.
  double faces_for_angle(const double (&length)[3], double area) const {
    if (!(area > 0) || goals_.min_angle_deg == 0) return 1;
    const double longest = std::max({length[0], length[1], length[2]});
    // The sharpness compares the tangent with the smallest angle's height over its reach.
    const double sharpness = asked_.tangent / (2 * area / (longest * longest));
    return sharpness <= 1 ? 1 : 1 + 2 * std::log2(sharpness);
  }

  double longest_edge() const { return std::min(sizes_.largest(), equilateral_edge(goals_.max_area)); }
  double size_at(Vec2 p) const {
    return sizes_.is_uniform() ? longest_edge() : std::min(longest_edge(), sizes_.at(chart_.to_space(p)));
  }

  /// Returns null if no side is fixed, or if every fixed side is short enough.
  std::unique_ptr<const FixedSideSizes> fixed_side_sizes(RunControl& control) const {
    if (goals_.split_boundaries || (sizes_.is_uniform() && !std::isfinite(longest_edge()))) return nullptr;
    const Triangulation2d& mesh = patch_.mesh;
    std::vector<FixedSide> sides;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      if (!mesh.is_constrained(h)) continue;
      const Vec2 a = patch_.uv[mesh.from(h)], b = patch_.uv[mesh.to(h)];
      const Vec2 middle = 0.5 * (a + b);
      const double size = size_at(middle) / chart_.scale(middle);
      if (norm(b - a) > size) sides.push_back({a, b, size});
    }
    if (sides.empty()) return nullptr;
    return std::make_unique<const FixedSideSizes>(sides, goals_.min_angle_deg, control);
  }

  double faces_for_size(const Vec2 (&p)[3], double area, double longest, const FixedSideSizes* fixed) const {
    const double edge = longest_edge();
    if (sizes_.is_uniform() && fixed == nullptr)
      return std::isfinite(edge) ? kFacesPerIdeal * area / equilateral_area(edge) : 0;
    const auto faces_at = [&](Vec2 at, double part) {
      double size = size_at(at);
      if (fixed != nullptr) size = std::max(size, fixed->at(at) * chart_.scale(at));
      return std::isfinite(size) ? kFacesPerIdeal * part / equilateral_area(size) : 0;
    };
    const int rows = asked_.rows;
    if (fixed == nullptr) {
      const Vec2 middle = (1.0 / 3) * (p[0] + p[1] + p[2]);
      const double size = size_at(middle);
      if (longest < size * kSmall) return faces_at(middle, area);
      if (2 * area / longest < size) return faces_in_strips(p, area, rows, faces_at);
    }
    // The size is read in the middles of small triangles into which the triangle is divided.
    const double part = area / (rows * rows);
    double faces = 0;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; i + j < rows; ++j)
        for (int up = 0; up < (i + j + 1 < rows ? 2 : 1); ++up) {
          const double u = (i + (1.0 + up) / 3) / rows, v = (j + (1.0 + up) / 3) / rows;
          faces += faces_at(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]), part);
        }
    return faces;
  }

  /// The triangle has no room for two edges across its longest side. So it is cut into strips across this side, and the
  /// size is read in the middles of the strips.
  template <class FacesAt>
  static double faces_in_strips(const Vec2 (&p)[3], double area, int strips, const FacesAt& faces_at) {
    int k = 0;  // the longest side begins at this corner
    for (int i = 1; i < 3; ++i)
      if (norm(p[(i + 1) % 3] - p[i]) > norm(p[(k + 1) % 3] - p[k])) k = i;
    const Vec2 from = p[k], along = p[(k + 1) % 3] - from, apex = p[(k + 2) % 3] - from;
    const double place = std::clamp(dot(apex, along) / dot(along, along), 0.0, 1.0);  // of the apex along the side
    const Vec2 up = apex - place * along;
    // The part of the area before a place t along the side, and the part of the height there.
    const auto area_before = [&](double t) { return t <= place ? t * t / place : 1 - (1 - t) * (1 - t) / (1 - place); };
    const auto height = [&](double t) { return t <= place ? t / place : (1 - t) / (1 - place); };
    double faces = 0, before = 0;
    for (int i = 0; i < strips; ++i) {
      const double middle = (i + 0.5) / strips;
      const double next = i + 1 == strips ? 1 : area_before((i + 1.0) / strips);
      faces += faces_at(from + middle * along + (height(middle) / 2) * up, area * (next - before));
      before = next;
    }
    return faces;
  }

  /// The size does not differ much within a triangle whose longest side is this part of it.
  static constexpr double kSmall = 0.5;

  const PatchMesh& patch_;
  const PatchChart chart_;
  const Asked& asked_;
  const Goals& goals_;
  const SizeField& sizes_;
};

/// A floor that the user asks for does not matter if the size is at least this many times as long. A floor because of
/// rounding does not matter for the area inside, beside pieces that are at least kSizesOverRounding times as long. For
/// the pieces themselves it never matters.
constexpr double kSizesOverFloor = 64;
constexpr double kSizesOverRounding = 8;
/// Points must not come nearer to each other than the floor. So a triangle may be too small to be split by a point
/// inside. Such a triangle has at most this many times the area of an equilateral triangle whose edges are as long as
/// the floor. In a larger triangle, a point in the middle is further than the floor from the corners, and far enough
/// from pieces of segments that cannot be cut.
constexpr double kLeftBesideFloor = 16;
/// A patch where a floor matters, or with segments that stay, counts as filled only if it would have more faces than
/// this. Up to this number, refinement makes the faces as well as possible, and they do no harm.
constexpr double kManyFaces = 0x1p20;
/// A patch is refused if it would need this many times the allowed faces, but rounding leaves no room for them.
constexpr double kFarFromAsked = 0x1p20;
/// Sizes are read at a few places only. The sum that follows from them is taken to be right within this factor.
constexpr double kDoubtOfSamples = 16;

/// Computes a lower bound on the faces of one patch.
class LeastFaces {
 public:
  LeastFaces(const SegmentTable& segments, const Goals& goals, const SizeField& sizes, RunControl& control)
      : segments_(segments),
        goals_(goals),
        control_(control),
        longest_(sizes.largest()),
        largest_area_(largest_area(goals, sizes)),
        // This is the edge of the largest triangle, if all its edges are equally long.
        edge_(equilateral_edge(largest_area_)) {}

  double of(const PatchMesh& patch, const PatchChart& chart, PatchId p) const {
    // Edges up to this length may stay, even if sizes ask for shorter ones.
    double may_stay = is_floor_a_matter(goals_.min_edge_length, kSizesOverFloor) ? goals_.min_edge_length : 0;
    double pieces = 0;
    bool is_any_locked = false, is_any_fixed = false, is_min_edge_user_limit = may_stay > 0;
    for (const std::uint32_t i : segments_.sides_of_patch(p)) {
      control_.check();
      const BoundarySegment& s = segments_[segments_.all_sides()[i].segment];
      pieces += least_pieces(s);
      is_any_locked = is_any_locked || s.is_locked();
      is_any_fixed = is_any_fixed || is_fixed(s);
      if (s.is_floor_raised &&
          is_floor_a_matter(s.floor, s.is_min_edge_user_limit ? kSizesOverFloor : kSizesOverRounding))
        may_stay = std::max(may_stay, s.floor);
      is_min_edge_user_limit = is_min_edge_user_limit || s.is_min_edge_user_limit;
    }
    double largest = largest_area_;
    if (may_stay > 0) largest = kLeftBesideFloor * std::max(largest, equilateral_area(may_stay));
    const auto triangles = static_cast<double>(patch.mesh.triangle_count());
    double filled = area_of(patch, chart) / largest;
    if (is_any_locked || may_stay > 0) {
      if (!(filled > kManyFaces))
        filled = 0;
      else if (is_any_fixed)
        filled = away_from_fixed(patch, chart, p, largest);
      // Rounding leaves room only for a result that is so far from the goals that it would be useless.
      if (!is_any_fixed && !is_min_edge_user_limit)
        filled = std::max(filled, area_of(patch, chart) / largest_area_ / kFarFromAsked);
    }
    return std::max({triangles, pieces - 2, filled});
  }

 private:
  double least_pieces(const BoundarySegment& s) const {
    if (s.is_locked()) return 1;
    const double pieces = count_pieces(s.length, longest_);
    if (s.is_min_edge_user_limit) return s.floor * kSizesOverFloor <= longest_ ? pieces : 1;
    // Refinement finds out by itself where rounding leaves no room for a cut. But it cannot make more than kMaxFaces
    // cuts to find this out, so then all pieces count.
    return s.floor <= longest_ || pieces > static_cast<double>(kMaxFaces) ? pieces : 1;
  }

  /// Points must not come nearer to each other than `floor`. Returns whether triangles may therefore stay larger than
  /// the sizes: the wanted edge is shorter than `sizes_over_floor` times the floor.
  bool is_floor_a_matter(double floor, double sizes_over_floor) const { return !(floor * sizes_over_floor <= edge_); }

  /// Returns whether a segment stays because an option or a frozen patch requires it. A segment that only rounding
  /// leaves no room to cut does not count as fixed, so sizes that ask for too many faces are refused there, too: a
  /// result would miss them everywhere.
  static bool is_fixed(const BoundarySegment& s) { return s.lock == Lock::kFixed || s.lock == Lock::kAsked; }

  /// Returns the number of faces that the area away from fixed sides needs. Beside these sides, triangles are as large
  /// as FixedSideSizes allows.
  double away_from_fixed(const PatchMesh& patch, const PatchChart& chart, PatchId p, double largest) const {
    const Triangulation2d& mesh = patch.mesh;
    const double longest = equilateral_edge(largest);
    std::vector<FixedSide> fixed;
    for (const std::uint32_t i : segments_.sides_of_patch(p)) {
      const SegmentSide& side = segments_.all_sides()[i];
      if (!is_fixed(segments_[side.segment])) continue;
      const Vec2 a = patch.uv[mesh.from(side.half_edge)], b = patch.uv[mesh.to(side.half_edge)];
      const double edge = longest / chart.scale(0.5 * (a + b));
      if (norm(b - a) > edge) fixed.push_back({a, b, edge});
    }
    if (fixed.empty()) return area_of(patch, chart) / largest;
    const FixedSideSizes sizes(fixed, goals_.min_angle_deg, control_);
    double faces = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      const Vec2 a = patch.uv[mesh.from(h)], b = patch.uv[mesh.from(h + 1)], c = patch.uv[mesh.from(h + 2)];
      const double part = cross(b - a, c - a) / 2 / (kSamples * kSamples);
      // The middles of all small triangles that have the same orientation as the large one.
      for (int i = 0; i < kSamples; ++i)
        for (int j = 0; i + j < kSamples; ++j) {
          control_.check();
          const Vec2 at = a + ((i + 1.0 / 3) / kSamples) * (b - a) + ((j + 1.0 / 3) / kSamples) * (c - a);
          faces += part / equilateral_area(std::max(longest / chart.scale(at), sizes.at(at)));
        }
    }
    return faces / kDoubtOfSamples;
  }

  static double area_of(const PatchMesh& patch, const PatchChart& chart) {
    const Triangulation2d& mesh = patch.mesh;
    double twice = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      const Vec2 a = patch.uv[mesh.from(h)];
      const double scale = chart.scale(a);
      twice += cross(patch.uv[mesh.from(h + 1)] - a, patch.uv[mesh.from(h + 2)] - a) * scale * scale;
    }
    // The scale of a curved patch differs inside a triangle, by a factor of 2 at most, and flat faces are smaller.
    constexpr double kCertainOfCurved = 0.25;
    return (chart.curved() != nullptr ? kCertainOfCurved : 1) * twice / 2;
  }

  static constexpr int kSamples = 6;

  const SegmentTable& segments_;
  const Goals& goals_;
  RunControl& control_;
  double longest_, largest_area_, edge_;
};

/// Returns the number of all cuts for sizes that are made in segments before it shows whether rounding leaves room for
/// them.
double pieces_to_be_made(const SegmentTable& segments, const SizeField& sizes, RunControl& control) {
  double pieces = 0;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    check();
    const BoundarySegment& s = segments[SegmentId(i)];
    const bool is_cut = !s.is_locked() && !(s.is_min_edge_user_limit && s.floor > sizes.largest());
    if (is_cut) pieces += count_pieces(s.length, sizes.largest()) - 1;
  }
  return pieces;
}

}  // namespace

int rows_to_read(const SizeField& sizes) {
  constexpr double kRows = 6, kMinRows = 2;
  return static_cast<int>(std::max(kMinRows, std::floor(kRows / std::sqrt(sizes.look_up_cost()))));
}

double least_faces(const TriangulatedPatches& triangulated, const IdVector<PatchId, std::uint8_t>& is_frozen,
                   const SegmentTable& segments, const Goals& goals, const SizeField& sizes, RunControl& control) {
  const PatchMeshes& meshes = triangulated.meshes;
  // A list of more pieces than this would not fit into memory.
  const double pieces = pieces_to_be_made(segments, sizes, control);
  if (pieces > static_cast<double>(kMaxFaces)) return pieces;
  const LeastFaces least(segments, goals, sizes, control);
  double sum = 0;
  for (const double block : map_blocks<double>(meshes.size(), 64, control, [&](std::size_t p, std::size_t end) {
         double faces = 0;
         for (; p < end; ++p) {
           control.check();
           faces += is_frozen[PatchId(p)] == 0
                        ? least.of(meshes[PatchId(p)], triangulated.charts[PatchId(p)], PatchId(p))
                        : static_cast<double>(meshes[PatchId(p)].mesh.triangle_count());
         }
         return faces;
       }))
    sum += block;
  return sum;
}

Prediction predict_faces(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
                         RunControl& control) {
  struct Block {
    Prediction sum;
    std::vector<EdgePieces> pieces;
  };
  constexpr std::size_t kPatches = 64;
  const PatchMeshes& meshes = triangulated.meshes;
  const Asked asked(goals, sizes);
  auto blocks = map_blocks<Block>(meshes.size(), kPatches, control, [&](std::size_t begin, std::size_t end) {
    Block block;
    for (std::size_t p = begin; p < end; ++p) {
      const Prediction one =
          PatchPrediction(meshes[PatchId(p)], triangulated.charts[PatchId(p)], asked).run(block.pieces, control);
      block.sum.expected += one.expected;
      block.sum.of_patch.push_back(static_cast<float>(std::min(one.expected, kMaxOfPatch)));
    }
    return block;
  });
  Prediction total;
  total.of_patch.reserve(meshes.size());
  std::vector<EdgePieces> needed;
  for (const Block& block : blocks) {
    total.expected += block.sum.expected;
    total.of_patch.insert(total.of_patch.end(), block.sum.of_patch.begin(), block.sum.of_patch.end());
    needed.insert(needed.end(), block.pieces.begin(), block.pieces.end());
  }
  if (needed.empty()) return total;
  // For each edge, only the largest number of pieces is used.
  sort_stoppable(needed.begin(), needed.end(), control);
  std::size_t left = 0;
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const bool is_last =
        i + 1 == needed.size() || needed[i + 1].from != needed[i].from || needed[i + 1].to != needed[i].to;
    if (is_last) needed[left++] = needed[i];
  }
  needed.resize(left);
  const auto faces = map_blocks<double>(meshes.size(), kPatches, control, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t p = begin; p < end; ++p) {
      control.check();
      sum += PatchPrediction(meshes[PatchId(p)], triangulated.charts[PatchId(p)], asked).faces_for_pieces(needed);
    }
    return sum;
  });
  for (const double block : faces) total.expected += block;
  return total;
}

}  // namespace remesh
