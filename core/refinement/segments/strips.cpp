#include "core/refinement/segments/strips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// The angle that is aimed at is larger than the bound by this number of degrees.
constexpr double kRowAngleMargin = 0.02;
/// If there were more parts, their ends could not be told apart.
constexpr double kMaxParts = 0x1p40;
/// Limits for the two sides of a strip: the factor by which its width may change along it, and how far beyond the end
/// of one side the other may begin, in widths.
constexpr double kMaxWidening = 1.25;
constexpr double kMaxShear = 0.5;
/// Strips side by side are alike if the numbers of parts that their sides want differ by at most this factor. Sides
/// with three and four parts need no help: the ends of one side's parts are between those of the other anyway.
constexpr double kAlike = 1.05;
/// The height of a row is this multiple of the size. It is a little less than the height of equilateral triangles, so
/// that the slanting edges are not too long.
constexpr double kRow = 0.85;
/// A strip that is no wider than this multiple of the size is like a row of squares.
constexpr double kRim = 1.1;
/// A strip has no more rows across it than this. In wider ones the sides are far apart, and the area between them can
/// make up for a wrong end of a row.
constexpr double kMaxRows = 12;
/// A side has one size if the number of parts for its smallest size is at most that for its largest size times this
/// factor, plus one more.
constexpr double kEven = 1.02;

using SidePair = std::array<SegmentId, 2>;
using Pairs = std::vector<SidePair, DefaultInit<SidePair>>;

/// Returns whether two half-edges of a patch face each other all along.
bool do_face(const PatchMesh& patch, std::uint32_t h, std::uint32_t other) {
  const Triangulation2d& mesh = patch.mesh;
  const Vec2 a = patch.uv[mesh.from(h)], b = patch.uv[mesh.to(h)];
  const Vec2 c = patch.uv[mesh.from(other)], d = patch.uv[mesh.to(other)];
  const Vec2 along = (1 / norm(b - a)) * (b - a);
  // The half-edges run in opposite directions: c lies across from b, and d from a.
  const auto [least, most] = std::minmax({cross(along, c - a), cross(along, d - a)});
  if (!(least > 0) || most > kMaxWidening * least) return false;
  return std::fabs(dot(along, c - b)) <= kMaxShear * least && std::fabs(dot(along, d - a)) <= kMaxShear * least;
}

/// Returns the constrained half-edge that faces h over two triangles with a common diagonal, or kNone.
std::uint32_t facing(const PatchMesh& patch, std::uint32_t h) {
  const Triangulation2d& mesh = patch.mesh;
  for (const std::uint32_t diagonal : {Triangulation2d::next(h), Triangulation2d::previous(h)}) {
    if (mesh.is_constrained(diagonal)) continue;
    const std::uint32_t beyond = mesh.twin(diagonal);
    for (const std::uint32_t other : {Triangulation2d::next(beyond), Triangulation2d::previous(beyond)})
      if (mesh.is_constrained(other) && do_face(patch, h, other)) return other;
  }
  return Triangulation2d::kNoHalfEdge;
}

/// Returns the pairs of segments that want parts and face each other in a patch. Each pair occurs in both orders. They
/// are ascending.
Pairs facing_segments(const PatchMeshes& meshes, const SegmentTable& table, const std::vector<double>& wanted,
                      RunControl& control) {
  const auto blocks =
      map_blocks<std::vector<SidePair>>(meshes.size(), 256, control, [&](std::size_t p, std::size_t end) {
        std::vector<SidePair> pairs;
        std::vector<std::pair<std::uint32_t, SegmentId>> segment_of;  // segments of half-edges
        for (; p < end; ++p) {
          segment_of.clear();
          for (const std::uint32_t i : table.sides_of_patch(PatchId(p))) {
            const SegmentSide& side = table.all_sides()[i];
            if (wanted[side.segment.value] > 0) segment_of.emplace_back(side.half_edge, side.segment);
          }
          std::sort(segment_of.begin(), segment_of.end());
          for (const auto& [h, s] : segment_of) {
            const std::uint32_t other = facing(meshes[PatchId(p)], h);
            const auto there = std::lower_bound(segment_of.begin(), segment_of.end(), std::pair(other, SegmentId(0)));
            if (there == segment_of.end() || there->first != other || there->second == s) continue;
            pairs.push_back({s, there->second});
            pairs.push_back({there->second, s});
          }
        }
        return pairs;
      });
  Pairs pairs = sorted_by_key(
      concatenate<SidePair>(blocks, control), table.size(), [](const SidePair& pair) { return pair[0].value; },
      control);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Returns the smallest size that is read along a segment. The distance between the places that are read is half of the
/// size in the middle, or a 16th of the segment if that is more.
double smallest_size(const SegmentTable& table, SegmentId s, const SizeField& sizes) {
  if (sizes.is_uniform()) return sizes.largest();
  constexpr double kMaxSteps = 16;
  double least = sizes.at(table.position(s, 0.5));
  const auto steps = static_cast<int>(std::clamp(std::ceil(2 * table[s].length / least), 1.0, kMaxSteps));
  for (int i = 0; i <= steps; ++i) least = std::min(least, sizes.at(table.position(s, static_cast<double>(i) / steps)));
  return least;
}

/// Returns the largest size that is read along a segment, away from its ends.
double largest_size(const SegmentTable& table, SegmentId s, const SizeField& sizes) {
  double largest = 0;
  for (const double t : {0.25, 0.5, 0.75}) largest = std::max(largest, sizes.at(table.position(s, t)));
  return largest;
}

/// Returns whether sizes come from gaps behind walls. Without such gaps, hardly any facet has a size that is the same
/// everywhere on the facet but differs from the size of the whole surface.
bool is_behind_walls(const Goals& goals, const SizeField& sizes) { return goals.proximity > 0 && !sizes.is_uniform(); }

double parts_of_size(const BoundarySegment& segment, double size) {
  return std::ceil(segment.length / size * (1 - 1e-12));
}

/// Returns the number of parts that a segment wants as the side of a strip. Returns 0 if it is no such side, or has to
/// be cut more finely anyway.
double wanted_parts(const SegmentTable& table, SegmentId s, double feature, double tangent, const Goals& goals,
                    const SizeField& sizes) {
  const BoundarySegment& segment = table[s];
  if (segment.is_locked()) return 0;
  const double by_angle = std::ceil(segment.length * tangent / (2 * feature));
  const double size = smallest_size(table, s, sizes);
  const double by_size = parts_of_size(segment, size);
  const double parts = std::max(by_angle, by_size);
  const double most = goals.min_edge_length > 0 ? segment.length / segment.floor : kMaxParts;
  if (parts < 2 || 2 * parts > most) return 0;
  // If there are twice as many parts as angles need, angles do not depend on where the parts of the other side end. If
  // a strip is wider than the height of a row of triangles, it has points inside.
  if (by_size < 2 * by_angle || feature <= kRow * size) return parts;
  if (!is_behind_walls(goals, sizes) || feature > std::min(segment.length, kMaxRows * size)) return 0;
  return by_size <= kEven * parts_of_size(segment, largest_size(table, s, sizes)) + 1 ? parts : 0;
}

/// Returns whether there is an odd number of rows of triangles across a strip, between two of its sides. One of the
/// sides is in `parts` parts. Returns nothing if there are too many rows, or if the strip is wider than long.
std::optional<bool> is_odd_across(const SegmentTable& table, const SidePair& sides, double parts, const Goals& goals,
                                  const SizeField& sizes) {
  if (!is_behind_walls(goals, sizes)) return true;
  const Vec3 here = table.position(sides[0], 0.5);
  const Vec3 there = nearest_on_segment(here, table.position(sides[1], 0), table.position(sides[1], 1));
  const double width = norm(there - here);
  // A strip of this width is like a row of squares: it is about as wide as one edge along its side is long. The rim of
  // a wall is such a strip. It is refined best if the points on its two sides lie opposite each other, and if the
  // lattices on the two faces of the wall, beyond these sides, lie opposite each other as well. So the strip is treated
  // as if it had an even number of rows.
  const double size_of_side = sizes.at(here);
  if (width > kRow * size_of_side && width <= kRim * size_of_side) return false;
  // Rows are as high as the slanting edges allow.
  const double size = sizes.at(0.5 * (here + there)), half = table[sides[0]].length / parts / 2;
  const double rows = std::ceil(width / std::sqrt(std::max(size * size - half * half, size * size / 4)) * (1 - 1e-9));
  if (rows > kMaxRows || width > table[sides[0]].length) return std::nullopt;
  return std::fmod(rows, 2) == 1;
}

}  // namespace

std::vector<EvenParts> parts_along_strips(const PatchMeshes& meshes, const SegmentTable& table,
                                          std::span<const double> feature, const Goals& goals, const SizeField& sizes,
                                          RunControl& control) {
  std::vector<EvenParts> parts(table.size());
  if (goals.min_angle_deg == 0) return parts;
  const double angle = std::max(goals.min_angle_deg, least_strip_angle_deg(sizes)) + kRowAngleMargin;
  const double tangent = std::tan(angle * std::numbers::pi / 180);
  const auto wanted_by = [&](SegmentId s) { return wanted_parts(table, s, feature[s.value], tangent, goals, sizes); };
  std::vector<double> wanted(table.size());
  for_blocks(table.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      // Reading sizes that vary takes long. So all segments that may be cut are taken at first, and sizes are read when
      // it is known which segments face another.
      const double unknown = table[SegmentId(s)].is_locked() ? 0 : 1;
      wanted[s] = sizes.is_uniform() ? wanted_by(SegmentId(s)) : unknown;
    }
  });
  Pairs pairs = facing_segments(meshes, table, wanted, control);
  if (!sizes.is_uniform()) {
    constexpr std::size_t kPairs = 64;
    for_blocks(pairs.size(), kPairs, control, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i)
        if (i == 0 || pairs[i][0] != pairs[i - 1][0]) wanted[pairs[i][0].value] = wanted_by(pairs[i][0]);
    });
    std::erase_if(pairs,
                  [&](const SidePair& pair) { return wanted[pair[0].value] == 0 || wanted[pair[1].value] == 0; });
  }

  // Walks from side to side over all strips that are alike, beginning with the smallest id.
  std::vector<std::uint8_t> is_seen(table.size(), 0);
  std::vector<SegmentId> alike;
  for (const auto& [seed, unused] : pairs) {
    if (is_seen[seed.value] != 0) continue;
    is_seen[seed.value] = 1;
    alike.assign(1, seed);
    const double of_seed = wanted[seed.value];
    double most = of_seed;
    for (std::size_t k = 0; k < alike.size(); ++k) {
      const SegmentId s = alike[k];
      for (auto pair = std::lower_bound(pairs.begin(), pairs.end(), SidePair{s, SegmentId(0)});
           pair != pairs.end() && (*pair)[0] == s; ++pair) {
        const SegmentId next = (*pair)[1];
        const double of_next = wanted[next.value];
        if (is_seen[next.value] != 0 || std::fabs(of_next - of_seed) > (kAlike - 1) * of_seed) continue;
        const std::optional<bool> is_odd = is_odd_across(table, *pair, std::max(of_seed, of_next), goals, sizes);
        if (!is_odd) continue;
        is_seen[next.value] = 1;
        parts[next.value].is_shifted = parts[s.value].is_shifted != *is_odd;
        most = std::max(most, of_next);
        alike.push_back(next);
      }
    }
    if (alike.size() < 2) continue;
    for (const SegmentId s : alike) parts[s.value].count = most;
  }
  return parts;
}

}  // namespace remesh
