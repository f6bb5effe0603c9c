#include "core/output/run/free_tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/symmetric_eigen.h"
#include "core/base/union_find.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/prediction/curved_prediction.h"

namespace remesh {
namespace {

/// A triangle of a coarser surface has this many times the area of a rectangle whose sides are the radius and the
/// tolerance. The square of an edge has 16 times that area if its ends are the tolerance on one side of the arc and its
/// middle is as far on the other. Predictions with 4 are within a factor of 1.6 on balls, terrain and scans.
constexpr double kAreaPerRadiusAndTolerance = 4;

Vec3 area_of(const FreePart& part, FaceId f) {
  const auto [a, b, c] = part.corners(f);
  return cross(b - a, c - a);
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

/// How far the free faces probably are from what they stand for.
struct OwnDistance {
  double chord = 0;  ///< the height of an arc over most of the edges
  double noise = 0;  ///< twice the noise of the vertices
};

OwnDistance own_distance(const FreePart& part, RunControl& control) {
  constexpr double kShareOfEdges = 0.9;
  // The share of values that borders and features leave alone, and the value of a normal distribution below which it
  // lies. Second differences of independent noise are larger than the noise by the last number, on vertices with six
  // neighbours.
  constexpr double kInside = 0.4, kNormalAtInside = 0.524, kGainOfDifferences = 1.359;
  struct Chord {
    double height, length;
  };
  std::vector<Chord> chords;
  double total = 0;
  IdVector<VertexId, Vec3> sum(part.positions.size()), normal(part.positions.size());
  IdVector<VertexId, double> count(part.positions.size(), 0), height(part.positions.size(), 0);
  IdVector<VertexId, double> heights(part.positions.size(), 0);
  IdVector<VertexId, std::uint8_t> is_border(part.positions.size(), 0);
  StopCheck check(control);
  for (FaceId f(0); f.value < part.faces.size(); ++f.value) {
    check();
    const Triangle& t = part.faces[f];
    const Vec3 own = area_of(part, f);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId v = t[k], w = t[(k + 1) % 3];
      const std::uint32_t h = 3 * f.value + k, twin = part.twins[h];
      normal[v] += own;
      sum[v] += part.positions[w];
      count[v] += 1;
      if (twin == kNone || part.edges[h] != FreeForm::Edge::kSmooth) is_border[v] = is_border[w] = 1;
      if (twin == kNone || twin < h || part.edges[h] != FreeForm::Edge::kSmooth || !part.is_free(f)) continue;
      const Vec3 other = area_of(part, FaceId(twin / 3));
      const double length = norm(part.positions[w] - part.positions[v]);
      chords.push_back({length * angle_between(own, other) / 8, length});
      total += length;
    }
  }
  std::sort(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.height < b.height; });
  double chord = 0, passed = 0;
  for (std::size_t i = 0; i < chords.size() && passed < kShareOfEdges * total; ++i) {
    chord = chords[i].height;
    passed += chords[i].length;
  }
  // The height of a vertex over its neighbours, and that over those of the neighbours: a curved surface has little of
  // the latter, and noise has much.
  for (VertexId v(0); v.value < sum.size(); ++v.value)
    height[v] = dot(part.positions[v] - (1 / count[v]) * sum[v], normalized(normal[v]));
  for (FaceId f(0); f.value < part.faces.size(); ++f.value)
    for (std::size_t k = 0; k < 3; ++k) heights[part.faces[f][k]] += height[part.faces[f][(k + 1) % 3]];
  std::vector<double> differences;
  for (VertexId v(0); v.value < sum.size(); ++v.value)
    if (is_border[v] == 0) differences.push_back(std::fabs(height[v] - heights[v] / count[v]));
  double noise = 0;
  if (!differences.empty()) {
    const auto at =
        differences.begin() + static_cast<std::ptrdiff_t>(kInside * static_cast<double>(differences.size()));
    std::nth_element(differences.begin(), at, differences.end());
    noise = *at / (kNormalAtInside * kGainOfDifferences);
  }
  return {chord, 2 * noise};
}

/// The curvature at the vertices of a part: the larger one of the surface's largest curvature, and of that of the edges
/// that stay.
class Curvatures {
 public:
  Curvatures(const FreePart& part, RunControl& control) : part_(part), check_(control) {
    control.memory().ask_for<Turns>(2 * part.positions.size());
    of_vertex_.assign(part.positions.size(), 0);
    add_surface();
    add_chains();
  }
  /// Returns the largest curvature at the corners of a face.
  double of_face(FaceId f) const {
    const Triangle& t = part_.faces[f];
    return std::max({of_vertex_[t[0]], of_vertex_[t[1]], of_vertex_[t[2]]});
  }

 private:
  /// Turns across edges times their lengths, by the edges' directions, and the area in which these edges are.
  struct Turns {
    Matrix<3> sum{};
    double area = 0;
    void add(double turn, const Vec3& edge) {
      const double length = norm(edge);
      for (int i = 0; i < 3 && length > 0; ++i)
        for (int j = 0; j < 3; ++j) sum[i][j] += turn * edge[i] * edge[j] / length;
    }
    void add(const Turns& other) {
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) sum[i][j] += other.sum[i][j];
      area += other.area;
    }
  };

  bool is_smooth(std::uint32_t h) const { return part_.twins[h] != kNone && part_.edges[h] == FreeForm::Edge::kSmooth; }

  void add_surface() {
    const std::size_t n = part_.positions.size();
    IdVector<VertexId, Turns> near(n), around(n);
    for (FaceId f(0); f.value < part_.faces.size(); ++f.value) {
      check_();
      if (!part_.is_free(f)) continue;
      const Vec3 own = area_of(part_, f);
      const Triangle& t = part_.faces[f];
      for (std::uint32_t k = 0; k < 3; ++k) {
        near[t[k]].area += norm(own) / 6;
        const std::uint32_t h = 3 * f.value + k;
        if (!is_smooth(h) || part_.twins[h] < h) continue;
        const Vec3 edge = part_.positions[t[(k + 1) % 3]] - part_.positions[t[k]];
        const Vec3 other = area_of(part_, FaceId(part_.twins[h] / 3));
        const double turn = std::copysign(angle_between(own, other), dot(cross(own, other), edge));
        // Half of the edge belongs to each of its ends.
        near[t[k]].add(turn / 2, edge);
        near[t[(k + 1) % 3]].add(turn / 2, edge);
      }
    }
    // Noise of the vertices is less in the mean over the neighbours.
    around = near;
    for (FaceId f(0); f.value < part_.faces.size(); ++f.value) {
      check_();
      if (!part_.is_free(f)) continue;
      const Triangle& t = part_.faces[f];
      for (std::size_t k = 0; k < 3; ++k) around[t[k]].add(near[t[(k + 1) % 3]]);
    }
    for (VertexId v(0); v.value < n; ++v.value) {
      check_();
      if (!(around[v].area > 0)) continue;
      const auto values = symmetric_eigen(around[v].sum).values;
      of_vertex_[v] = std::max(std::fabs(values[0]), std::fabs(values[2])) / around[v].area;
    }
  }

  void add_chains() {
    struct Ends {
      std::array<VertexId, 2> at;
      int count = 0;
    };
    IdVector<VertexId, Ends> ends(part_.positions.size());
    const auto add = [&](VertexId v, VertexId w) {
      Ends& known = ends[v];
      if (known.count > 0 && (known.at[0] == w || known.at[1] == w)) return;  // an edge with several faces
      if (known.count < 2) known.at[static_cast<std::size_t>(known.count)] = w;
      ++known.count;
    };
    for (std::uint32_t h = 0; h < part_.twins.size(); ++h) {
      check_();
      const FaceId f(h / 3);
      const std::uint32_t twin = part_.twins[h];
      const bool is_at_free = part_.is_free(f) || (twin != kNone && part_.is_free(FaceId(twin / 3)));
      if (is_smooth(h) || !is_at_free || (twin != kNone && twin < h)) continue;
      const VertexId v = part_.faces[f][h % 3], w = part_.faces[f][(h + 1 - (h % 3 == 2 ? 3 : 0)) % 3];
      add(v, w);
      add(w, v);
    }
    // The turn is measured over two edges on each side, since borders along the edges of triangles go to and fro.
    const auto beyond = [&](VertexId v, std::size_t k) {
      const VertexId w = ends[v].at[k];
      if (ends[w].count != 2) return part_.positions[w];
      return part_.positions[ends[w].at[ends[w].at[0] == v ? 1 : 0]];
    };
    for (VertexId v(0); v.value < ends.size(); ++v.value) {
      check_();
      if (ends[v].count != 2) continue;
      const Vec3 in = part_.positions[v] - beyond(v, 0), out = beyond(v, 1) - part_.positions[v];
      of_vertex_[v] = std::max(of_vertex_[v], 2 * angle_between(in, out) / (norm(in) + norm(out)));
    }
  }

  const FreePart& part_;
  StopCheck check_;
  IdVector<VertexId, double> of_vertex_;
};

/// Half of the diagonal of the free region to which each face belongs: no larger circle is to be seen on the region.
std::vector<double> half_diagonals(const FreePart& part, RunControl& control) {
  const std::size_t n = part.faces.size();
  UnionFind region(n);
  std::vector<Box3> box(n);
  StopCheck check(control);
  for (FaceId f(0); f.value < n; ++f.value)
    for (std::uint32_t h = 3 * f.value; h < 3 * f.value + 3; ++h) {
      check();
      const std::uint32_t twin = part.twins[h];
      if (twin != kNone && part.is_free(f) && part.is_free(FaceId(twin / 3))) region.join(f.value, twin / 3);
    }
  for (FaceId f(0); f.value < n; ++f.value)
    for (const Vec3& p : part.corners(f)) box[region.find(f.value)].add(p);
  std::vector<double> half;
  for (std::uint32_t f = 0; f < n; ++f) half.push_back(box[region.find(f)].diagonal() / 2);
  return half;
}

/// Rounds to a few digits, so that the last ones, which depend on the numbering, do not count.
double with_few_digits(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, 12)), exponent - 12);
}

/// How far coarser faces may be from each free face, if an arc has so many edges per full turn.
class TolerancesByTurn {
 public:
  TolerancesByTurn(const FreePart& part, const OwnDistance& own, double most, RunControl& control)
      : part_(part),
        own_(own),
        most_(most),
        curvatures_(part, control),
        largest_radius_(half_diagonals(part, control)) {}

  double radius(FaceId f) const { return std::min(1 / curvatures_.of_face(f), largest_radius_[f.value]); }
  double of_face(FaceId f, double elements_per_circle, const std::optional<double>& largest) const {
    const auto [a, b, c] = part_.corners(f);
    const double longest_squared = std::max({norm_squared(b - a), norm_squared(c - b), norm_squared(a - c)});
    const double own_chord = longest_squared * curvatures_.of_face(f) / 8;
    const double own = std::min(std::max(std::min(own_.chord, own_chord), own_.noise), most_);
    const double by_turn = with_few_digits(own + (1 - std::cos(M_PI / elements_per_circle)) * radius(f));
    return std::min(by_turn, largest.value_or(by_turn));
  }

 private:
  const FreePart& part_;
  OwnDistance own_;
  double most_;
  Curvatures curvatures_;
  std::vector<double> largest_radius_;
};

/// Returns the largest distance that counts as one of the faces from what they stand for.
double most_own_distance(const FreePart& part) {
  constexpr double kLargest = 1e-3;
  Box3 box;
  for (const Vec3& p : part.positions) box.add(p);
  return kLargest * box.diagonal();
}

}  // namespace

FreeTolerance tolerance_of(const FreePart& part, const FreeGoals& goals, RunControl& control) {
  constexpr float kMinShareOfFace = 1e-3F;
  if (goals.tolerance && !goals.elements_per_circle) return {*goals.tolerance, {}};
  const double most = most_own_distance(part);
  const OwnDistance own = own_distance(part, control);
  if (!goals.elements_per_circle) return {with_few_digits(std::min(std::max(own.chord, own.noise), most)), {}};
  const TolerancesByTurn by_turn(part, own, most, control);
  std::vector<double> tolerances(part.faces.size(), 0);
  FreeTolerance result;
  for (FaceId f(0); f.value < part.faces.size(); ++f.value) {
    if (!part.is_free(f)) continue;
    tolerances[f.value] = by_turn.of_face(f, *goals.elements_per_circle, goals.tolerance);
    result.largest = std::max(result.largest, tolerances[f.value]);
  }
  for (FaceId f(0); f.value < part.faces.size(); ++f.value) {
    const double share = part.is_free(f) ? tolerances[f.value] / result.largest : 1;
    result.shares.push_back(std::max(static_cast<float>(share), kMinShareOfFace));
  }
  return result;
}

std::vector<double> predicted_free_faces(const FreePart& part, const FreeGoals& goals, std::span<const int> elements,
                                         double longest_edge, RunControl& control) {
  const TolerancesByTurn by_turn(part, own_distance(part, control), most_own_distance(part), control);
  std::vector<double> predicted(elements.size(), 0);
  double whole_area = 0;
  StopCheck check(control);
  for (FaceId f(0); f.value < part.faces.size(); ++f.value) {
    check();
    const double area = norm(area_of(part, f)) / 2, radius = by_turn.radius(f);
    if (!part.is_free(f) || !(area > 0)) continue;
    whole_area += area;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const double tolerance = by_turn.of_face(f, elements[i], goals.tolerance);
      predicted[i] += area / (kAreaPerRadiusAndTolerance * radius * tolerance);
    }
  }
  const double by_size = kFacesPerSize * whole_area / equilateral_area(longest_edge);
  const auto most = static_cast<double>(part.free_faces);
  // The comparison is false for a sum that is no number.
  for (double& faces : predicted) faces = std::max(faces < most ? faces : most, by_size);
  return predicted;
}

}  // namespace remesh
