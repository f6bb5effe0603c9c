#include "core/quality.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/mesh/adjacency.h"

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

/// Coordinates are multiplied by this power of two before anything else, so that neither the squares nor the products
/// of three lengths overflow, and denormal extents are not lost. Exact, and undone exactly at the end.
class Scale {
 public:
  Scale(std::span<const Vec3> positions, RunControl& control) {
    const auto largest = map_blocks<double>(positions.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      double m = 0;
      for (std::size_t i = begin; i < end; ++i)
        m = std::max({m, std::fabs(positions[i].x), std::fabs(positions[i].y), std::fabs(positions[i].z)});
      return m;
    });
    const double m = largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
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
  double angle[3];  ///< radians
  double area;
  double radius_edge_ratio;  ///< infinite for zero area
  double aspect_ratio;       ///< infinite for zero area
};

TriangleMeasures measure(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 side[3] = {c - b, a - c, b - a};  // side[i] is opposite corner i
  double largest = 0;
  for (const Vec3& s : side) largest = std::max({largest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
  TriangleMeasures out{{0, 0, 0}, 0, HUGE_VAL, HUGE_VAL};
  if (largest == 0) return out;
  // A triangle that is tiny beside the whole is brought to size 1, or its squares would underflow.
  const int exponent = std::ilogb(largest);
  const int grow = exponent < -250 ? std::min(-exponent, 1000) : 0;
  if (grow > 0)
    for (Vec3& s : side) s = std::ldexp(1.0, grow) * s;
  double length[3];
  for (int i = 0; i < 3; ++i) length[i] = std::sqrt(norm_squared(side[i]));
  const int longest = static_cast<int>(std::max_element(length, length + 3) - length);
  const int u = (longest + 1) % 3, v = (longest + 2) % 3;
  // The cross product of the two shorter sides suffers least from cancellation.
  const double twice_area = std::sqrt(norm_squared(cross(side[u], side[v])));
  for (int i = 0; i < 3; ++i) out.angle[i] = std::atan2(twice_area, -dot(side[(i + 1) % 3], side[(i + 2) % 3]));
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

/// What one block of triangles contributes.
struct QualityBlock {
  Summary angle, radius_edge, aspect, area;
  std::array<std::uint64_t, kAngleBins> angle_counts{};
  std::array<std::uint64_t, kRadiusEdgeBins.size() - 1> radius_edge_counts{};

  void add(const QualityBlock& other) {
    angle.add(other.angle);
    radius_edge.add(other.radius_edge);
    aspect.add(other.aspect);
    area.add(other.area);
    for (std::size_t i = 0; i < angle_counts.size(); ++i) angle_counts[i] += other.angle_counts[i];
    for (std::size_t i = 0; i < radius_edge_counts.size(); ++i) radius_edge_counts[i] += other.radius_edge_counts[i];
  }
};

QualityBlock measure_block(const Scale& scale, std::span<const Vec3> positions, std::span<const Triangle> faces) {
  QualityBlock block;
  for (const Triangle& t : faces) {
    const auto m = measure(scale(positions[t[0].value]), scale(positions[t[1].value]), scale(positions[t[2].value]));
    for (const double angle : m.angle) {
      const double degrees = angle * kDegrees;
      block.angle.add(degrees);
      ++block.angle_counts[std::min(static_cast<std::size_t>(degrees / 10), block.angle_counts.size() - 1)];
    }
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

Quality measure_quality(std::span<const Vec3> positions, std::span<const Triangle> faces, const Scale& scale,
                        const Adjacency& adjacency, RunControl& control) {
  const QualityBlock total =
      combined(map_blocks<QualityBlock>(faces.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
        return measure_block(scale, positions, faces.subspan(begin, end - begin));
      }));
  Quality quality;
  quality.min_angle_deg = total.angle.range().min;
  quality.max_angle_deg = total.angle.range().max;
  quality.radius_edge_ratio = total.radius_edge.range();
  quality.aspect_ratio = total.aspect.range();
  quality.area = undo(scale, total.area.range(), 2);
  quality.edge_length = undo(scale, measure_edges(scale, positions, adjacency, control).range(), 1);
  for (int i = 0; i <= kAngleBins; ++i) quality.angle_histogram_deg.edges.push_back(10.0 * i);
  quality.angle_histogram_deg.counts.assign(total.angle_counts.begin(), total.angle_counts.end());
  quality.radius_edge_histogram.edges.assign(kRadiusEdgeBins.begin(), kRadiusEdgeBins.end());
  quality.radius_edge_histogram.counts.assign(total.radius_edge_counts.begin(), total.radius_edge_counts.end());
  return quality;
}

/// Triangles as polygons, the form that Adjacency and measure_surface read.
struct TrianglesAsPolygons {
  explicit TrianglesAsPolygons(std::span<const Triangle> faces) : face_begin(faces.size() + 1) {
    for (std::size_t f = 0; f < face_begin.size(); ++f) face_begin[f] = static_cast<std::uint32_t>(3 * f);
    corners.reserve(3 * faces.size());
    for (const Triangle& face : faces) corners.insert(corners.end(), face.begin(), face.end());
  }
  std::vector<std::uint32_t> face_begin;
  std::vector<VertexId> corners;
};

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

MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Scale& scale, const Adjacency& adjacency,
                               RunControl& control) {
  MeshStatistics out;
  out.faces = face_begin.size() - 1;

  std::vector<bool> is_used(positions.size(), false);
  UnionFind components(positions.size());
  for (std::size_t f = 0; f < out.faces; ++f) {
    if (f % kBlock == 0) control.check();
    for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) {
      const VertexId v = corners[h];
      if (!is_used[v.value]) {
        is_used[v.value] = true;
        ++out.vertices;
        ++out.components;
        out.bounding_box.add(positions[v.value]);
      }
      if (h > face_begin[f] && components.join(corners[face_begin[f]].value, v.value)) --out.components;
    }
  }

  std::uint64_t edges = 0;
  bool is_closed = out.faces > 0, is_consistent = true;
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    if (e % kBlock == 0) control.check();
    const auto around = adjacency.half_edges(EdgeId(e));
    if (adjacency.from(around[0]) == adjacency.to(around[0])) continue;  // a repeated corner is no edge
    ++edges;
    if (around.size() == 1) ++out.boundary_edges;
    if (around.size() > 2) ++out.non_manifold_edges;
    is_closed = is_closed && around.size() == 2;
    is_consistent = is_consistent && adjacency.twin(around[0]) != Adjacency::kNone;
  }
  out.closed = is_closed;
  out.euler =
      static_cast<std::int64_t>(out.vertices) - static_cast<std::int64_t>(edges) + static_cast<std::int64_t>(out.faces);

  // Volume is measured from the middle of the box: far from the origin it would drown in rounding.
  Vec3 centre;
  if (!out.bounding_box.is_empty()) centre = 0.5 * (scale(out.bounding_box.min) + scale(out.bounding_box.max));
  const AreaBlock sums = measure_areas(scale, positions, face_begin, corners, centre, control);
  out.area = scale.undo(sums.area, 2);
  if (is_closed && is_consistent) out.volume = scale.undo(sums.volume, 3);
  return out;
}

}  // namespace

Quality measure_quality(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control) {
  const TrianglesAsPolygons polygons(faces);
  const Adjacency adjacency(positions.size(), polygons.face_begin, polygons.corners);
  return measure_quality(positions, faces, adjacency, control);
}

Quality measure_quality(std::span<const Vec3> positions, std::span<const Triangle> faces, const Adjacency& adjacency,
                        RunControl& control) {
  return measure_quality(positions, faces, Scale(positions, control), adjacency, control);
}

IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control) {
  const Scale scale(mesh.positions.items(), control);
  IdVector<FaceId, FaceQuality> quality(mesh.faces.size());
  for_blocks(mesh.faces.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value) {
      const auto [a, b, c] = mesh.faces[f];
      const TriangleMeasures m = measure(scale(mesh.positions[a]), scale(mesh.positions[b]), scale(mesh.positions[c]));
      const auto finite = [](double ratio) { return std::isfinite(ratio) ? ratio : 0; };
      quality[f] = {*std::min_element(m.angle, m.angle + 3) * kDegrees, finite(m.radius_edge_ratio),
                    finite(m.aspect_ratio)};
    }
  });
  return quality;
}

MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency, RunControl& control) {
  return measure_surface(positions, face_begin, corners, Scale(positions, control), adjacency, control);
}

MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control) {
  const std::span<const Vec3> positions = mesh.positions.items();
  const std::span<const Triangle> faces = mesh.faces.items();
  const TrianglesAsPolygons polygons(faces);
  const Adjacency adjacency(positions.size(), polygons.face_begin, polygons.corners);
  const Scale scale(positions, control);
  MeshStatistics out = measure_surface(positions, polygons.face_begin, polygons.corners, scale, adjacency, control);
  out.quality = measure_quality(positions, faces, scale, adjacency, control);
  return out;
}

}  // namespace remesh
