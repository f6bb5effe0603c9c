#include "core/quality.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/geometry/largest_coordinate.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr double kDegrees = 180 / 3.14159265358979323846;

/// Bins of the radius-edge ratio: from the equilateral triangle's 1/sqrt(3) upwards. 0.7071, 1 and 1.4142 are the
/// bounds that 45, 30 and 20.7 degrees give (1 / (2 sin angle)); 1.1831 is that of 25 degrees, the default of
/// refinement.
constexpr std::array<double, 14> kRadiusEdgeBins = {0.57,   0.6,    0.65, 0.7071, 0.8, 0.9,  1.0,
                                                    1.1831, 1.4142, 2.0,  3.0,    5.0, 10.0, 100.0};
constexpr int kAngleBins = 18;
constexpr double kBinDegrees = 180.0 / kAngleBins;

/// Coordinates are multiplied by this power of two before anything else, so that neither the squares nor the products
/// of three lengths overflow, and denormal extents are not lost. Exact, and undone exactly at the end.
class Scale {
 public:
  Scale(std::span<const Vec3> positions, RunControl& control) {
    const double m = largest_coordinate(positions, control);
    if (m > 0) exponent_ = std::clamp(std::ilogb(m) + 1, -1000, 1000);
    factor_ = std::ldexp(1.0, -exponent_);
  }

  Vec3 operator()(const Vec3& p) const { return factor_ * p; }
  /// A measure of `dimension` lengths in model units again; what no double can hold becomes the largest one.
  double undo(double measure, int dimension) const {
    return std::clamp(std::ldexp(measure, dimension * exponent_), -DBL_MAX, DBL_MAX);
  }

 private:
  int exponent_ = 0;
  double factor_ = 1;
};

/// Smallest, largest and sum of what was added.
struct Summary {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
  std::uint64_t count = 0;

  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
    sum += value;
    ++count;
  }
  void add(const Summary& other) {
    min = std::min(min, other.min);
    max = std::max(max, other.max);
    sum += other.sum;
    count += other.count;
  }
  Range range() const { return count == 0 ? Range{} : Range{min, sum / static_cast<double>(count), max}; }
};

Range undo(const Scale& scale, const Range& range, int dimension) {
  return {scale.undo(range.min, dimension), scale.undo(range.mean, dimension), scale.undo(range.max, dimension)};
}

struct TriangleMeasures {
  double twice_area = 0;         ///< this and the next two are in one unit, some power of two
  double along[3] = {0, 0, 0};   ///< of each corner's angle: its cosine times the two sides there; its sine: twice_area
  double length[3] = {0, 0, 0};  ///< of the side opposite each corner
  double area = 0;
  double radius_edge_ratio = HUGE_VAL;  ///< infinite for zero area
  double aspect_ratio = HUGE_VAL;       ///< infinite for zero area

  /// In degrees.
  double angle(int corner) const { return std::atan2(twice_area, along[corner]) * kDegrees; }
};

TriangleMeasures measure(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 side[3] = {c - b, a - c, b - a};  // side[i] is opposite corner i
  double largest = 0;
  for (const Vec3& s : side) largest = std::max({largest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
  TriangleMeasures out;
  if (largest == 0) return out;
  // A triangle that is tiny beside the whole is brought to size 1, or its squares would underflow.
  const int grow = largest < 0x1p-250 ? std::min(-std::ilogb(largest), 1000) : 0;
  if (grow > 0)
    for (Vec3& s : side) s = std::ldexp(1.0, grow) * s;
  double* const length = out.length;
  for (int i = 0; i < 3; ++i) length[i] = std::sqrt(norm_squared(side[i]));
  const int longest = static_cast<int>(std::max_element(length, length + 3) - length);
  const int u = (longest + 1) % 3, v = (longest + 2) % 3;
  // The cross product of the two shorter sides suffers least from cancellation.
  const double twice_area = std::sqrt(norm_squared(cross(side[u], side[v])));
  out.twice_area = twice_area;
  for (int i = 0; i < 3; ++i) out.along[i] = -dot(side[(i + 1) % 3], side[(i + 2) % 3]);
  out.area = grow > 0 ? std::ldexp(twice_area / 2, -2 * grow) : twice_area / 2;
  if (twice_area > 0) {
    // R = abc / (4 area): over the shortest side, the product of the two others is left.
    const double shortest = std::min(length[u], length[v]);
    const double middle = std::max(length[u], length[v]);
    const double ratio = middle * length[longest] / (2 * twice_area);
    if (shortest > 0) out.radius_edge_ratio = ratio;
    out.aspect_ratio = length[longest] * (length[0] + length[1] + length[2]) / (2 * std::sqrt(3.0) * twice_area);
  }
  return out;
}

using AngleCounts = std::array<std::uint64_t, kAngleBins>;

std::size_t bin_of_angle(double degrees) {
  return std::min(static_cast<std::size_t>(degrees / kBinDegrees), std::size_t{kAngleBins - 1});
}

/// Bins of angles by their cosines: an arc tangent for each angle would cost as much as all other measures together.
class BinsByCosine {
 public:
  BinsByCosine() {
    for (int i = 0; i < kCells; ++i) {
      // The rounded cosine may be off, by some 1e-15, and so may an angle from atan2: such are told apart by that one.
      constexpr double kMargin = 1e-12;
      const auto bin = [](double cosine) { return bin_of_angle(std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees); };
      const std::size_t low = bin(cosine_of(i) - kMargin), high = bin(cosine_of(i + 1) + kMargin);
      bin_[i] = low == high ? static_cast<std::int8_t>(low) : kUnsure;
    }
  }

  /// Output: -1 where it takes the angle itself to tell.
  int operator()(double cosine) const {
    return bin_[std::clamp(static_cast<int>((cosine + 1) * kHalf), 0, kCells - 1)];
  }

 private:
  static constexpr int kHalf = 1 << 10, kCells = 2 * kHalf;
  static constexpr std::int8_t kUnsure = -1;
  static double cosine_of(int cell) { return static_cast<double>(cell) / kHalf - 1; }

  std::array<std::int8_t, kCells> bin_;
};

/// The smallest and the largest of many angles, and how many there are in each bin.
class Angles {
 public:
  void add(const TriangleMeasures& m) {
    // Where squares of lengths have lost digits, cosines have, too; where there is no area, the angles are 0 or 180.
    const double shortest = std::min({m.length[0], m.length[1], m.length[2]});
    if (!(m.twice_area > 0x1p-400) || shortest < 0x1p-300) {
      for (int i = 0; i < 3; ++i) add(m.angle(i));
      return;
    }
    static const BinsByCosine bin_of;
    const double unit = 1 / (m.length[0] * m.length[1] * m.length[2]);
    for (int i = 0; i < 3; ++i) {
      // Of right angles there are many, and they would be told by the arc tangent each.
      const double cosine = m.along[i] * m.length[i] * unit;
      const int bin = m.along[i] == 0 ? kRightAngle : bin_of(cosine);
      ++counts_[bin >= 0 ? static_cast<std::size_t>(bin) : bin_of_angle(m.angle(i))];
    }
    // All three have the same sine: the largest cosine is the smallest angle's.
    const auto [least, most] = std::minmax({m.along[0], m.along[1], m.along[2]});
    if (const Direction d{most, m.twice_area}; d.is_before(smallest_)) smallest_ = d;
    if (const Direction d{least, m.twice_area}; largest_.is_before(d)) largest_ = d;
  }
  void add(const Angles& other) {
    min_ = std::min(min_, other.min_);
    max_ = std::max(max_, other.max_);
    if (other.smallest_.is_before(smallest_)) smallest_ = other.smallest_;
    if (largest_.is_before(other.largest_)) largest_ = other.largest_;
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  }

  /// 0 where nothing was added, as all others.
  double min() const { return is_empty() ? 0 : std::min(min_, smallest_.degrees()); }
  double max() const { return is_empty() ? 0 : std::max(max_, largest_.degrees()); }
  const AngleCounts& counts() const { return counts_; }

 private:
  static constexpr int kRightAngle = static_cast<int>(90 / kBinDegrees);

  /// An angle by its cosine and sine, in some unit.
  struct Direction {
    double cosine, sine;

    /// By their cotangents: those of needles differ where their cosines are the same.
    bool is_before(const Direction& other) const { return cosine * other.sine > other.cosine * sine; }
    double degrees() const { return std::atan2(sine, cosine) * kDegrees; }
  };

  void add(double degrees) {
    min_ = std::min(min_, degrees);
    max_ = std::max(max_, degrees);
    ++counts_[bin_of_angle(degrees)];
  }
  bool is_empty() const { return min_ > max_ && largest_.sine == 0; }

  double min_ = HUGE_VAL, max_ = -HUGE_VAL;  ///< degrees, of the angles that were computed
  Direction smallest_{-1, 0};                ///< of the others; 180 degrees where there are none
  Direction largest_{1, 0};                  ///< of the others; 0 where there are none
  AngleCounts counts_{};
};

/// What one block of triangles contributes.
struct QualityBlock {
  Angles angles;
  Summary radius_edge, aspect, area;
  std::array<std::uint64_t, kRadiusEdgeBins.size() - 1> radius_edge_counts{};

  void add(const QualityBlock& other) {
    angles.add(other.angles);
    radius_edge.add(other.radius_edge);
    aspect.add(other.aspect);
    area.add(other.area);
    for (std::size_t i = 0; i < radius_edge_counts.size(); ++i) radius_edge_counts[i] += other.radius_edge_counts[i];
  }
};

/// `corners`: three a triangle.
QualityBlock measure_block(const Scale& scale, std::span<const Vec3> positions, std::span<const VertexId> corners) {
  QualityBlock block;
  for (std::size_t h = 0; h < corners.size(); h += 3) {
    const auto corner = [&](std::size_t i) { return scale(positions[corners[h + i].value]); };
    const TriangleMeasures m = measure(corner(0), corner(1), corner(2));
    block.angles.add(m);
    block.area.add(m.area);
    if (std::isfinite(m.radius_edge_ratio)) {
      block.radius_edge.add(m.radius_edge_ratio);
      const auto bin = std::upper_bound(kRadiusEdgeBins.begin() + 1, kRadiusEdgeBins.end() - 1, m.radius_edge_ratio);
      ++block.radius_edge_counts[bin - kRadiusEdgeBins.begin() - 1];
    }
    if (std::isfinite(m.aspect_ratio)) block.aspect.add(m.aspect_ratio);
  }
  return block;
}

template <class Block>
Block combined(const std::vector<Block>& blocks) {
  Block total;
  for (const Block& block : blocks) total.add(block);
  return total;
}

Summary measure_edges(const Scale& scale, std::span<const Vec3> positions, const Adjacency& adjacency,
                      RunControl& control) {
  return combined(map_blocks<Summary>(adjacency.edge_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    Summary block;
    for (std::size_t e = begin; e < end; ++e) {
      const std::uint32_t h = adjacency.half_edges(EdgeId(e))[0];
      const VertexId from = adjacency.from(h), to = adjacency.to(h);
      if (from == to) continue;
      block.add(norm(scale(positions[from.value]) - scale(positions[to.value])));
    }
    return block;
  }));
}

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexId> corners, const Scale& scale,
                        const Adjacency& adjacency, RunControl& control) {
  const QualityBlock total =
      combined(map_blocks<QualityBlock>(corners.size() / 3, kBlock, control, [&](std::size_t begin, std::size_t end) {
        return measure_block(scale, positions, corners.subspan(3 * begin, 3 * (end - begin)));
      }));
  Quality quality;
  quality.min_angle_deg = total.angles.min();
  quality.max_angle_deg = total.angles.max();
  quality.radius_edge_ratio = total.radius_edge.range();
  quality.aspect_ratio = total.aspect.range();
  quality.area = undo(scale, total.area.range(), 2);
  quality.edge_length = undo(scale, measure_edges(scale, positions, adjacency, control).range(), 1);
  for (int i = 0; i <= kAngleBins; ++i) quality.angle_histogram_deg.edges.push_back(kBinDegrees * i);
  const AngleCounts& angle_counts = total.angles.counts();
  quality.angle_histogram_deg.counts.assign(angle_counts.begin(), angle_counts.end());
  quality.radius_edge_histogram.edges.assign(kRadiusEdgeBins.begin(), kRadiusEdgeBins.end());
  quality.radius_edge_histogram.counts.assign(total.radius_edge_counts.begin(), total.radius_edge_counts.end());
  return quality;
}

/// Area and the sum for the volume of one block of faces.
struct AreaBlock {
  double area = 0;
  double volume = 0;
  void add(const AreaBlock& other) {
    area += other.area;
    volume += other.volume;
  }
};

AreaBlock measure_areas(const Scale& scale, std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                        std::span<const VertexId> corners, const Vec3& centre, RunControl& control) {
  const std::size_t face_count = face_begin.size() - 1;
  return combined(map_blocks<AreaBlock>(face_count, kBlock, control, [&](std::size_t begin, std::size_t end) {
    AreaBlock block;
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = corners.subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
      const Vec3 first = scale(positions[face[0].value]);
      Vec3 twice_area;  // Newell's vector, as a fan of signed triangles
      for (std::size_t i = 1; i + 1 < face.size(); ++i)
        twice_area += cross(scale(positions[face[i].value]) - first, scale(positions[face[i + 1].value]) - first);
      block.area += norm(twice_area) / 2;
      block.volume += dot(first - centre, twice_area) / 6;
    }
    return block;
  }));
}

/// What the vertices that faces use come to.
struct VertexBlock {
  std::uint64_t vertices = 0, components = 0;
  Box3 box;
  void add(const VertexBlock& other) {
    vertices += other.vertices;
    components += other.components;
    box.add(other.box);
  }
};

VertexBlock measure_vertices(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                             std::span<const VertexId> corners, RunControl& control) {
  std::vector<std::atomic<std::uint8_t>> is_used(positions.size());
  UnionFind components(positions.size());
  for_blocks(face_begin.size() - 1, kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) {
        is_used[corners[h].value].store(1, std::memory_order_relaxed);
        if (h > face_begin[f]) components.join(corners[h - 1].value, corners[h].value);
      }
  });
  return combined(map_blocks<VertexBlock>(positions.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    VertexBlock block;
    for (std::size_t v = begin; v < end; ++v) {
      if (is_used[v].load(std::memory_order_relaxed) == 0) continue;
      ++block.vertices;
      block.components += components.find(static_cast<std::uint32_t>(v)) == v;
      block.box.add(positions[v]);
    }
    return block;
  }));
}

/// What the edges come to.
struct EdgeCounts {
  std::uint64_t edges = 0, boundary = 0, non_manifold = 0;
  std::uint64_t inconsistent = 0;  ///< without two half-edges in opposite directions
};

EdgeCounts count_edges(const Adjacency& adjacency) {
  EdgeCounts counts;
  counts.edges = adjacency.edge_count();
  for (const EdgeId e : adjacency.odd_edges()) {
    const auto around = adjacency.half_edges(e);
    if (adjacency.from(around[0]) == adjacency.to(around[0])) {  // a repeated corner is no edge
      --counts.edges;
      continue;
    }
    counts.boundary += around.size() == 1;
    counts.non_manifold += around.size() > 2;
    ++counts.inconsistent;
  }
  return counts;
}

MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Scale& scale, const Adjacency& adjacency,
                               RunControl& control) {
  MeshStatistics out;
  out.faces = face_begin.size() - 1;
  const VertexBlock used = measure_vertices(positions, face_begin, corners, control);
  out.vertices = used.vertices;
  out.components = used.components;
  out.bounding_box = used.box;

  const EdgeCounts edges = count_edges(adjacency);
  out.boundary_edges = edges.boundary;
  out.non_manifold_edges = edges.non_manifold;
  out.closed = out.faces > 0 && edges.boundary == 0 && edges.non_manifold == 0;
  out.euler = static_cast<std::int64_t>(out.vertices) - static_cast<std::int64_t>(edges.edges) +
              static_cast<std::int64_t>(out.faces);

  // Volume is measured from the middle of the box: far from the origin it would drown in rounding.
  Vec3 centre;
  if (!out.bounding_box.is_empty()) centre = 0.5 * (scale(out.bounding_box.min) + scale(out.bounding_box.max));
  const AreaBlock sums = measure_areas(scale, positions, face_begin, corners, centre, control);
  out.area = scale.undo(sums.area, 2);
  if (out.closed && edges.inconsistent == 0) out.volume = scale.undo(sums.volume, 3);
  return out;
}

}  // namespace

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexId> corners, RunControl& control) {
  const std::vector<std::uint32_t> face_begin = triangle_begins(corners.size() / 3, control);
  const Adjacency adjacency(positions.size(), face_begin, corners);
  return measure_quality(positions, corners, adjacency, control);
}

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& adjacency,
                        RunControl& control) {
  return measure_quality(positions, corners, Scale(positions, control), adjacency, control);
}

IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control) {
  const Scale scale(mesh.positions.items(), control);
  IdVector<FaceId, FaceQuality> quality(mesh.faces.size());
  for_blocks(mesh.faces.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value) {
      const auto [a, b, c] = mesh.faces[f];
      const TriangleMeasures m = measure(scale(mesh.positions[a]), scale(mesh.positions[b]), scale(mesh.positions[c]));
      const auto finite = [](double ratio) { return std::isfinite(ratio) ? ratio : 0; };
      const auto smallest = static_cast<int>(std::max_element(m.along, m.along + 3) - m.along);
      quality[f] = {m.angle(smallest), finite(m.radius_edge_ratio), finite(m.aspect_ratio)};
    }
  });
  return quality;
}

MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency, RunControl& control) {
  return measure_surface(positions, face_begin, corners, Scale(positions, control), adjacency, control);
}

MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control) {
  const std::vector<std::uint32_t> face_begin = triangle_begins(mesh.faces.size(), control);
  const Adjacency adjacency(mesh.positions.size(), face_begin, corners_of(mesh.faces.items()));
  return measure_surface(mesh, face_begin, adjacency, control);
}

MeshStatistics measure_surface(const TriangleMesh& mesh, std::span<const std::uint32_t> face_begin,
                               const Adjacency& adjacency, RunControl& control) {
  const std::span<const Vec3> positions = mesh.positions.items();
  const std::span<const VertexId> corners = corners_of(mesh.faces.items());
  const Scale scale(positions, control);
  MeshStatistics out = measure_surface(positions, face_begin, corners, scale, adjacency, control);
  out.quality = measure_quality(positions, corners, scale, adjacency, control);
  return out;
}

}  // namespace remesh
