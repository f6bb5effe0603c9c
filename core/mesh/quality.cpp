#include "core/mesh/quality.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

constexpr std::size_t kQualityBlock = 4096;
constexpr double kDegrees = 180 / 3.14159265358979323846;

/// Limits of the bins of the radius-edge ratio, which is at least 1/sqrt(3), the ratio of the equilateral triangle.
/// 0.7071, 1 and 1.4142 are the ratios for 45, 30 and 20.7 degrees (1 / (2 sin angle)). 1.1831 is that for 25 degrees,
/// the default of refinement.
constexpr std::array<double, 14> kRadiusEdgeBins = {0.57,   0.6,    0.65, 0.7071, 0.8, 0.9,  1.0,
                                                    1.1831, 1.4142, 2.0,  3.0,    5.0, 10.0, 100.0};
constexpr int kAngleBins = 18;
constexpr double kBinDegrees = 180.0 / kAngleBins;

/// Multiplies coordinates by a power of two before anything else, so that neither squares nor products of three lengths
/// overflow, and denormal extents are not lost. The scaling is exact, and it is undone exactly at the end.
class Scale {
 public:
  Scale(std::span<const Vec3> positions, RunControl& control) {
    const double m = largest_coordinate(positions, control);
    if (m > 0) exponent_ = std::clamp(std::ilogb(m) + 1, -1000, 1000);
    factor_ = std::ldexp(1.0, -exponent_);
  }

  Vec3 operator()(const Vec3& p) const { return factor_ * p; }
  /// Converts a measure that is a product of `dimension` lengths back to model units. A value beyond the largest double
  /// becomes the largest double.
  double undo(double measure, int dimension) const {
    return std::clamp(std::ldexp(measure, dimension * exponent_), -DBL_MAX, DBL_MAX);
  }

 private:
  int exponent_ = 0;
  double factor_ = 1;
};

/// The smallest, the largest and the sum of the values that were added.
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

struct FaceMeasures {
  /// The lengths below are multiplied by 2^grown, and products of two lengths by 2^(2 grown). The area is not.
  int grown = 0;
  double twice_area = 0;
  Vec3 normal;                            ///< its length is `twice_area`
  std::array<double, 3> along{0, 0, 0};   ///< for each corner, the cosine of its angle times the lengths of the two
                                          ///< sides there
  std::array<double, 3> length{0, 0, 0};  ///< for each corner, the length of the opposite side
  std::array<double, 3> cosine{0, 0, 0};  ///< for each corner, the cosine of its angle; meaningless if there is no area
  double shortest = 0;                    ///< the shortest of the lengths
  double area = 0;
  double radius_edge_ratio = HUGE_VAL;  ///< infinite for zero area
  double aspect_ratio = HUGE_VAL;       ///< infinite for zero area

  /// The angle in degrees. The sine of each angle is `twice_area` over the product of the two sides at its corner.
  double angle(std::size_t corner) const { return std::atan2(twice_area, along[corner]) * kDegrees; }
};

/// Measures a triangle, given the side opposite each corner. The function has no branches, spells out all three sides,
/// and is always inlined. Therefore the compiler can measure several triangles at once (`Lanes`).
[[gnu::always_inline]] inline FaceMeasures measure_sides(const Vec3& opposite_a, const Vec3& opposite_b,
                                                         const Vec3& opposite_c) {
  FaceMeasures out;
  const double a = std::sqrt(norm_squared(opposite_a)), b = std::sqrt(norm_squared(opposite_b)),
               c = std::sqrt(norm_squared(opposite_c));
  // The cross product of the two shorter sides suffers least from cancellation.
  const bool is_a_longest = (a >= b) & (a >= c), is_b_longest = b >= c;
  const auto choose = [&](double if_a, double if_b, double if_c) {
    const double other = is_b_longest ? if_b : if_c;
    return is_a_longest ? if_a : other;
  };
  const Vec3 u{choose(opposite_b.x, opposite_c.x, opposite_a.x), choose(opposite_b.y, opposite_c.y, opposite_a.y),
               choose(opposite_b.z, opposite_c.z, opposite_a.z)};
  const Vec3 v{choose(opposite_c.x, opposite_a.x, opposite_b.x), choose(opposite_c.y, opposite_a.y, opposite_b.y),
               choose(opposite_c.z, opposite_a.z, opposite_b.z)};
  out.normal = cross(u, v);
  out.twice_area = std::sqrt(norm_squared(out.normal));
  out.along = {-dot(opposite_b, opposite_c), -dot(opposite_c, opposite_a), -dot(opposite_a, opposite_b)};
  out.length = {a, b, c};
  const double unit = 1 / (a * b * c);
  out.cosine = {out.along[0] * a * unit, out.along[1] * b * unit, out.along[2] * c * unit};
  const double less = a < b ? a : b, more = a < b ? b : a;
  const double inner = more < c ? more : c, longest = more < c ? c : more, middle = less < inner ? inner : less;
  out.shortest = less < c ? less : c;
  out.area = out.twice_area / 2;
  // R = abc / (4 area), so R over the shortest side is the product of the two other sides over 4 times the area.
  const double radius_edge_ratio = middle * longest / (2 * out.twice_area);
  const double aspect_ratio = longest * (a + b + c) / (2 * std::sqrt(3.0) * out.twice_area);
  const bool has_ratio = (out.twice_area > 0) & (out.shortest > 0);
  out.radius_edge_ratio = has_ratio ? radius_edge_ratio : HUGE_VAL;
  out.aspect_ratio = out.twice_area > 0 ? aspect_ratio : HUGE_VAL;
  return out;
}

/// Measures a triangle that is tiny beside the whole mesh. It is scaled to a size of about 1, because its squares would
/// underflow otherwise.
[[gnu::noinline]] FaceMeasures measure_tiny(const Vec3& a, const Vec3& b, const Vec3& c) {
  double largest = 0;
  for (const Vec3& s : {c - b, a - c, b - a})
    largest = std::max({largest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
  if (largest == 0) return {};
  const int grow = std::clamp(-std::ilogb(largest), 0, 1000);
  const double factor = std::ldexp(1.0, grow);
  FaceMeasures out = measure_sides(factor * (c - b), factor * (a - c), factor * (b - a));
  out.grown = grow;
  out.area = std::ldexp(out.area, -2 * grow);
  return out;
}

/// Returns whether a triangle is so small that the squares of its squared sides have lost digits. `a` and `b` are the
/// lengths of two of its sides.
bool are_tiny(double a, double b) { return !(std::max(a, b) > 0x1p-248); }

FaceMeasures measure(const Vec3& a, const Vec3& b, const Vec3& c) {
  const FaceMeasures m = measure_sides(c - b, a - c, b - a);
  return are_tiny(m.length[0], m.length[1]) ? measure_tiny(a, b, c) : m;
}

/// A batch of triangles, stored row by row, so that the compiler can measure as many at once as fit into a register.
class Lanes {
 public:
  static constexpr std::size_t kCount = 16;

  void put(std::size_t lane, const Vec3& a, const Vec3& b, const Vec3& c) {
    a_.put(lane, a);
    b_.put(lane, b);
    c_.put(lane, c);
  }

  /// Measures the first `count` triangles.
  void measure(std::size_t count, const Vec3& centre) {
    measure_all(centre);
    for (std::size_t i = 0; i < count; ++i) {
      grown_[i] = 0;
      if (!are_tiny(length_[0][i], length_[1][i])) continue;
      const FaceMeasures m = measure_tiny(a_[i], b_[i], c_[i]);
      set(i, m);
      grown_[i] = m.grown;
      volume_[i] = std::ldexp(dot(a_[i] - centre, m.normal) / 6, -2 * m.grown);
    }
  }

  /// The measures of a triangle, without its normal.
  [[gnu::always_inline]] FaceMeasures operator[](std::size_t i) const {
    FaceMeasures m;
    m.grown = grown_[i];
    m.twice_area = twice_area_[i];
    m.along = {along_[0][i], along_[1][i], along_[2][i]};
    m.length = {length_[0][i], length_[1][i], length_[2][i]};
    m.cosine = {cosine_[0][i], cosine_[1][i], cosine_[2][i]};
    m.shortest = shortest_[i];
    m.area = area_[i];
    m.radius_edge_ratio = radius_edge_ratio_[i];
    m.aspect_ratio = aspect_ratio_[i];
    return m;
  }
  /// The signed volume of the tetrahedron between the triangle and the centre.
  double volume(std::size_t i) const { return volume_[i]; }

 private:
  using Row = double[kCount];  // GCC 12 does not vectorise the same loop over std::array
  struct Points {
    Row x{}, y{}, z{};
    void put(std::size_t i, const Vec3& p) {
      x[i] = p.x;
      y[i] = p.y;
      z[i] = p.z;
    }
    Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  };

  /// This is not inlined, because GCC does not vectorise the loop otherwise.
  [[gnu::noinline]] void measure_all(const Vec3& centre) {
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vec3 a = a_[i], b = b_[i], c = c_[i];
      const FaceMeasures m = measure_sides(c - b, a - c, b - a);
      set(i, m);
      volume_[i] = dot(a - centre, m.normal) / 6;
    }
  }
  [[gnu::always_inline]] void set(std::size_t i, const FaceMeasures& m) {
    for (std::size_t k = 0; k < 3; ++k) {
      // cppcheck-suppress arrayIndexOutOfBounds ; takes three rows of many for many rows of three
      along_[k][i] = m.along[k];
      length_[k][i] = m.length[k];
      cosine_[k][i] = m.cosine[k];
    }
    twice_area_[i] = m.twice_area;
    shortest_[i] = m.shortest;
    radius_edge_ratio_[i] = m.radius_edge_ratio;
    aspect_ratio_[i] = m.aspect_ratio;
    area_[i] = m.area;
  }

  Points a_, b_, c_;
  Row along_[3]{}, length_[3]{}, cosine_[3]{};
  Row twice_area_{}, shortest_{}, radius_edge_ratio_{}, aspect_ratio_{}, area_{}, volume_{};
  int grown_[kCount]{};
};

using AngleCounts = std::array<std::uint64_t, kAngleBins>;

std::size_t bin_of_angle(double degrees) {
  return std::min(static_cast<std::size_t>(degrees / kBinDegrees), std::size_t{kAngleBins - 1});
}

/// Finds the bins of angles by their cosines. An arc tangent for each angle would cost as much as all other measures
/// together.
class BinsByCosine {
 public:
  BinsByCosine() {
    for (int i = 0; i < kCells; ++i) {
      // The rounded cosine may be wrong by some 1e-15, and so may an angle from atan2. Angles this near to the limit of
      // a bin are decided by atan2.
      constexpr double kMargin = 1e-12;
      const auto bin = [](double cosine) { return bin_of_angle(std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees); };
      const std::size_t low = bin(cosine_of(i) - kMargin), high = bin(cosine_of(i + 1) + kMargin);
      bin_[i] = low == high ? static_cast<std::int8_t>(low) : kUnsure;
    }
  }

  /// Output: the bin, or -1 if only the angle itself can decide.
  int operator()(double cosine) const {
    return bin_[std::clamp(static_cast<int>((cosine + 1) * kHalf), 0, kCells - 1)];
  }

 private:
  static constexpr int kHalf = 1 << 10, kCells = 2 * kHalf;
  static constexpr std::int8_t kUnsure = -1;
  static double cosine_of(int cell) { return static_cast<double>(cell) / kHalf - 1; }

  std::array<std::int8_t, kCells> bin_;
};

/// Collects the smallest and the largest of many angles, and the number of angles in each bin.
class Angles {
 public:
  void add(const FaceMeasures& m, const BinsByCosine& bin_of) {
    // If squares of lengths have lost digits, so have the cosines. If there is no area, the angles are 0 or 180
    // degrees.
    if (!(m.twice_area > 0x1p-400) || m.shortest < 0x1p-300) {
      for (std::size_t i = 0; i < 3; ++i) add(m.angle(i));
      return;
    }
    count(m, 0, bin_of);
    count(m, 1, bin_of);
    count(m, 2, bin_of);
    // The three values of `along` are the cosines times the lengths of the two sides at the corner, and `twice_area` is
    // the sine times the same lengths. So the largest one belongs to the smallest angle.
    const double least = std::min(std::min(m.along[0], m.along[1]), m.along[2]);
    const double most = std::max(std::max(m.along[0], m.along[1]), m.along[2]);
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

  /// The smallest and the largest angle. Both are 0 if nothing was added, like all other measures.
  double min() const { return is_empty() ? 0 : std::min(min_, smallest_.degrees()); }
  double max() const { return is_empty() ? 0 : std::max(max_, largest_.degrees()); }
  const AngleCounts& counts() const { return counts_; }

 private:
  /// The bin that begins at 90 degrees.
  static constexpr auto kRightAngle = static_cast<std::size_t>(90 / kBinDegrees);

  /// An angle, given by its cosine and its sine times a common factor.
  struct Direction {
    double cosine, sine;

    /// Compares angles by their cotangents. The cotangents of needles' angles differ even if their cosines are equal.
    bool is_before(const Direction& other) const { return cosine * other.sine > other.cosine * sine; }
    double degrees() const { return std::atan2(sine, cosine) * kDegrees; }
  };

  [[gnu::always_inline]] void count(const FaceMeasures& m, std::size_t corner, const BinsByCosine& bin_of) {
    const double cosine = m.cosine[corner];
    // Right angles are frequent, and without this test each would cost an arc tangent.
    if (std::fabs(cosine) < 1e-12) {
      ++counts_[m.along[corner] > 0 ? kRightAngle - 1 : kRightAngle];
      return;
    }
    const int bin = bin_of(cosine);
    ++counts_[bin >= 0 ? static_cast<std::size_t>(bin) : bin_of_angle(m.angle(corner))];
  }
  void add(double degrees) {
    min_ = std::min(min_, degrees);
    max_ = std::max(max_, degrees);
    ++counts_[bin_of_angle(degrees)];
  }
  bool is_empty() const { return min_ > max_ && largest_.sine == 0; }

  double min_ = HUGE_VAL, max_ = -HUGE_VAL;  ///< in degrees, of the angles that were computed with atan2
  Direction smallest_{-1, 0};                ///< the smallest of the other angles; 180 degrees if there are none
  Direction largest_{1, 0};                  ///< the largest of the other angles; 0 if there are none
  AngleCounts counts_{};
};

/// The measures of one block of triangles.
struct QualityBlock {
  Angles angles;
  Summary radius_edge, aspect, area, edge_length;
  double volume = 0;  ///< volume of the tetrahedra between the triangles and a common point
  std::array<std::uint64_t, kRadiusEdgeBins.size() - 1> radius_edge_counts{};

  void add(const QualityBlock& other) {
    angles.add(other.angles);
    radius_edge.add(other.radius_edge);
    aspect.add(other.aspect);
    area.add(other.area);
    edge_length.add(other.edge_length);
    volume += other.volume;
    for (std::size_t i = 0; i < radius_edge_counts.size(); ++i) radius_edge_counts[i] += other.radius_edge_counts[i];
  }
};

/// Finds the bin of a ratio without branches, because these would be predicted wrongly half of the time.
std::size_t bin_of_ratio(double ratio) {
  std::size_t bin = 0;
  for (std::size_t i = 1; i + 1 < kRadiusEdgeBins.size(); ++i) bin += ratio >= kRadiusEdgeBins[i];
  return bin;
}

/// Measures triangles, and their edges. An edge is measured at the first of its two triangles. Edges without twins are
/// left out.
QualityBlock measure_block(const Scale& scale, std::span<const Vec3> positions, const Adjacency& adjacency,
                           const Vec3& centre, std::size_t begin, std::size_t end) {
  static const BinsByCosine bin_of;
  QualityBlock block;
  Lanes lanes;
  for (; begin < end; begin += Lanes::kCount) {
    const std::size_t count = std::min(Lanes::kCount, end - begin);
    const auto corner = [&](std::size_t h) {
      return scale(positions[adjacency.from(static_cast<std::uint32_t>(h)).value]);
    };
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t h = 3 * (begin + i);
      lanes.put(i, corner(h), corner(h + 1), corner(h + 2));
    }
    lanes.measure(count, centre);
    for (std::size_t i = 0; i < count; ++i) {
      const auto h = static_cast<std::uint32_t>(3 * (begin + i));
      const FaceMeasures m = lanes[i];
      block.angles.add(m, bin_of);
      block.area.add(m.area);
      block.volume += lanes.volume(i);
      const auto add_edge = [&](std::uint32_t k, double length) {
        const std::uint32_t twin = adjacency.twin(h + k);
        if (twin == kNone || twin < h + k) return;
        // If a side is tiny beside the others, its square has lost digits.
        const bool is_exact = m.grown == 0 && length > 0x1p-450;
        block.edge_length.add(is_exact ? length : norm(corner(h + k) - corner(h + (k + 1) % 3)));
      };
      add_edge(0, m.length[2]);
      add_edge(1, m.length[0]);
      add_edge(2, m.length[1]);
      if (std::isfinite(m.radius_edge_ratio)) {
        block.radius_edge.add(m.radius_edge_ratio);
        ++block.radius_edge_counts[bin_of_ratio(m.radius_edge_ratio)];
      }
      if (std::isfinite(m.aspect_ratio)) block.aspect.add(m.aspect_ratio);
    }
  }
  return block;
}

template <class Block>
Block combined(const std::vector<Block>& blocks) {
  Block total;
  for (const Block& block : blocks) total.add(block);
  return total;
}

/// Measures all triangles of a mesh, and all its edges.
/// Input:  `centre`: the apex of the tetrahedra that add up to the volume, in the scale's units.
QualityBlock measure_triangles(const Scale& scale, std::span<const Vec3> positions, const Adjacency& adjacency,
                               std::size_t count, const Vec3& centre, RunControl& control) {
  QualityBlock total =
      combined(map_blocks<QualityBlock>(count, kQualityBlock, control, [&](std::size_t begin, std::size_t end) {
        return measure_block(scale, positions, adjacency, centre, begin, end);
      }));
  const auto odd = adjacency.odd_edges();
  total.edge_length.add(
      combined(map_blocks<Summary>(odd.size(), kQualityBlock, control, [&](std::size_t begin, std::size_t end) {
        Summary block;
        for (const EdgeId e : odd.subspan(begin, end - begin)) {
          const std::uint32_t h = adjacency.half_edges(e)[0];
          const VertexId from = adjacency.from(h), to = adjacency.to(h);
          if (from != to) block.add(norm(scale(positions[from.value]) - scale(positions[to.value])));
        }
        return block;
      })));
  return total;
}

Quality quality_of(const QualityBlock& total, const Scale& scale) {
  Quality quality;
  quality.min_angle_deg = total.angles.min();
  quality.max_angle_deg = total.angles.max();
  quality.radius_edge_ratio = total.radius_edge.range();
  quality.aspect_ratio = total.aspect.range();
  quality.area = undo(scale, total.area.range(), 2);
  quality.edge_length = undo(scale, total.edge_length.range(), 1);
  for (int i = 0; i <= kAngleBins; ++i) quality.angle_histogram_deg.edges.push_back(kBinDegrees * i);
  const AngleCounts& angle_counts = total.angles.counts();
  quality.angle_histogram_deg.counts.assign(angle_counts.begin(), angle_counts.end());
  quality.radius_edge_histogram.edges.assign(kRadiusEdgeBins.begin(), kRadiusEdgeBins.end());
  quality.radius_edge_histogram.counts.assign(total.radius_edge_counts.begin(), total.radius_edge_counts.end());
  return quality;
}

/// The measures of the vertices that faces use.
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
  for_blocks(face_begin.size() - 1, kQualityBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) {
        is_used[corners[h].value].store(1, std::memory_order_relaxed);
        if (h > face_begin[f]) components.join(corners[h - 1].value, corners[h].value);
      }
  });
  return combined(
      map_blocks<VertexBlock>(positions.size(), kQualityBlock, control, [&](std::size_t begin, std::size_t end) {
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

/// The counts of the edges.
struct EdgeCounts {
  std::uint64_t edges = 0, boundary = 0, non_manifold = 0;
  std::uint64_t inconsistent = 0;  ///< edges without two half-edges in opposite directions
};

EdgeCounts count_edges(const Adjacency& adjacency, RunControl& control) {
  StopCheck check(control);
  EdgeCounts counts;
  counts.edges = adjacency.edge_count();
  for (const EdgeId e : adjacency.odd_edges()) {
    check();
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

}  // namespace

IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control) {
  const Scale scale(mesh.positions.items(), control);
  IdVector<FaceId, FaceQuality> quality(mesh.faces.size());
  for_blocks(mesh.faces.size(), kQualityBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value) {
      const auto [a, b, c] = mesh.faces[f];
      const FaceMeasures m = measure(scale(mesh.positions[a]), scale(mesh.positions[b]), scale(mesh.positions[c]));
      const auto finite = [](double ratio) { return std::isfinite(ratio) ? ratio : 0; };
      const auto smallest =
          static_cast<std::size_t>(std::max_element(m.along.begin(), m.along.end()) - m.along.begin());
      quality[f] = {m.angle(smallest), finite(m.radius_edge_ratio), finite(m.aspect_ratio)};
    }
  });
  return quality;
}

MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency,
                               std::span<const VertexId> triangles, RunControl& control) {
  const Scale scale(positions, control);
  MeshStatistics out;
  out.faces = face_begin.size() - 1;
  const VertexBlock used = measure_vertices(positions, face_begin, corners, control);
  out.vertices = used.vertices;
  out.components = used.components;
  out.bounding_box = used.box;

  const EdgeCounts edges = count_edges(adjacency, control);
  out.boundary_edges = edges.boundary;
  out.non_manifold_edges = edges.non_manifold;
  out.closed = out.faces > 0 && edges.boundary == 0 && edges.non_manifold == 0;
  out.euler = static_cast<std::int64_t>(out.vertices) - static_cast<std::int64_t>(edges.edges) +
              static_cast<std::int64_t>(out.faces);

  // The volume is measured from the middle of the box, because far from the origin rounding errors would exceed it.
  Vec3 centre;
  if (!out.bounding_box.is_empty()) centre = 0.5 * (scale(out.bounding_box.min) + scale(out.bounding_box.max));
  const std::size_t count = triangles.size() / 3;
  std::optional<Adjacency> of_triangles;
  if (!adjacency.are_triangles())
    of_triangles.emplace(positions.size(), triangle_begins(count, control), triangles, control);
  const QualityBlock total =
      measure_triangles(scale, positions, of_triangles ? *of_triangles : adjacency, count, centre, control);
  out.quality = quality_of(total, scale);
  out.area = scale.undo(total.area.sum, 2);
  if (out.closed && edges.inconsistent == 0) out.volume = scale.undo(total.volume, 3);
  return out;
}

MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control) {
  const std::vector<std::uint32_t> face_begin = triangle_begins(mesh.faces.size(), control);
  const std::span<const VertexId> corners = corners_of(mesh.faces.items());
  const Adjacency adjacency(mesh.positions.size(), face_begin, corners, control);
  return measure_surface(mesh.positions.items(), face_begin, corners, adjacency, corners, control);
}

}  // namespace remesh
