#include "core/verify/boundary/chain_coupling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/verify/boundary/curved_chain.h"

namespace remesh::verification {
namespace {

using Polyline = std::vector<Vec3>;

/// Follows two polylines without a normal.
/// Output: the largest distance at a stop.
double gap(const Polyline& x, const Polyline& y) {
  double largest = 0;
  Vec3 at_x = x.front(), at_y = y.front();
  const RunControl control;
  StopCheck check(control);
  couple(
      x, y, [](const Vec3&) { return Vec3{}; },
      [&](const Vec3& x0, const Vec3& y0, const Vec3& x1, const Vec3& y1) {
        EXPECT_EQ(x0, at_x);
        EXPECT_EQ(y0, at_y);
        at_x = x1;
        at_y = y1;
        largest = std::max(largest, norm(x1 - y1));
      },
      check);
  EXPECT_EQ(at_x, x.back());
  EXPECT_EQ(at_y, y.back());
  return largest;
}

/// The discrete Frechet distance of both lines, cut into small pieces. It is larger than the true one by no more than
/// the length of a piece.
/// Source: Eiter, Mannila, Computing discrete Frechet distance, 1994.
double frechet(const Polyline& x, const Polyline& y, double piece) {
  const auto cut = [&](const Polyline& line) {
    Polyline fine{line.front()};
    for (std::size_t i = 1; i < line.size(); ++i) {
      const int parts = static_cast<int>(std::ceil(norm(line[i] - line[i - 1]) / piece)) + 1;
      for (int k = 1; k <= parts; ++k)
        fine.push_back(line[i - 1] + (static_cast<double>(k) / parts) * (line[i] - line[i - 1]));
    }
    return fine;
  };
  const Polyline a = cut(x), b = cut(y);
  std::vector<double> row(b.size(), HUGE_VAL);
  for (std::size_t i = 0; i < a.size(); ++i) {
    double before = HUGE_VAL;  // the value of the row above, one to the left
    for (std::size_t j = 0; j < b.size(); ++j) {
      double reached = std::min({row[j], before, j > 0 ? row[j - 1] : HUGE_VAL});
      if (i == 0 && j == 0) reached = 0;
      before = row[j];
      row[j] = std::max(reached, norm(a[i] - b[j]));
    }
  }
  return row.back();
}

Polyline arc(int pieces, double from, double to, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-noise, noise);
  Polyline line;
  for (int k = 0; k <= pieces; ++k) {
    const bool is_end = k == 0 || k == pieces;
    const double angle = from + (k + (is_end ? 0 : 0.3 * any(random) / (noise + 1e-300))) / pieces * (to - from);
    line.push_back({std::cos(angle) + (is_end ? 0 : any(random)), std::sin(angle), is_end ? 0 : any(random)});
  }
  return line;
}

TEST(chain_coupling, its_bound_is_never_below_the_frechet_distance_and_near_it_on_arcs) {
  std::vector<double> ratios;
  for (unsigned seed = 1; seed <= 30; ++seed)
    for (const double noise : {1e-6, 0.01, 0.05}) {
      const int few = 3 + static_cast<int>(seed % 5), many = 4 + static_cast<int>(seed % 11);
      const Polyline x = arc(few, 0.3, 3, noise, seed), y = arc(many, 0.3, 3, noise, seed + 100);
      const double bound = gap(x, y), truth = frechet(x, y, 0.002);
      EXPECT_GE(bound, truth - 0.003);
      EXPECT_LE(bound, 3 * truth + 0.01) << seed << " " << noise;
      ratios.push_back(bound / truth);
    }
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.1);
}

TEST(chain_coupling, equal_lines_are_at_no_distance_however_they_are_cut) {
  const Polyline bent{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}};
  const Polyline cut{{0, 0, 0}, {0.25, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 0.5, 0}, {1, 1, 0}, {1.75, 1, 0}, {2, 1, 0}};
  EXPECT_EQ(gap(bent, cut), 0);
  EXPECT_EQ(gap(cut, bent), 0);
}

TEST(chain_coupling, the_other_way_round_a_loop_is_far) {
  Polyline circle = arc(12, 0, 6.283185307179586, 0, 1), other = arc(9, 0, 6.283185307179586, 0, 2);
  EXPECT_LT(gap(circle, other), 0.07);
  std::reverse(other.begin(), other.end());
  EXPECT_GT(gap(circle, other), 1);
}

TEST(chain_coupling, going_back_counts) {
  EXPECT_GE(gap({{0, 0, 0}, {10, 0, 0}}, {{0, 0, 0}, {6, 0, 0}, {3, 0, 0}, {10, 0, 0}}), 1.5);
}

TEST(chain_coupling, along_a_normal_points_are_opposite_whatever_their_distance) {
  // Seen from the axis, a vertex and the point of the chord beside it are in the same direction.
  const Polyline fine = arc(16, 0, 1.2, 0, 1), chord{fine.front(), fine.back()};
  const RunControl control;
  StopCheck check(control);
  int stops = 0;
  couple(
      fine, chord,
      [](const Vec3& p) {
        return normalized(Vec3{p.x, p.y, 0});
      },
      [&](const Vec3&, const Vec3&, const Vec3& x, const Vec3& y) {
        EXPECT_NEAR(norm(cross(x, y)), 0, 1e-12);
        ++stops;
      },
      check);
  EXPECT_EQ(stops, 16);
}

/// Returns the exact area of a triangle that is much smaller than its coordinates, up to the rounding of long doubles.
long double exact_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  using Real = long double;
  const Real x = Real(b.x) - a.x, y = Real(b.y) - a.y, z = Real(b.z) - a.z;
  const Real u = Real(c.x) - a.x, v = Real(c.y) - a.y, w = Real(c.z) - a.z;
  const Real i = y * w - z * v, j = z * u - x * w, k = x * v - y * u;
  return std::sqrt(i * i + j * j + k * k) / 2;
}

TEST(chain_gap, a_place_on_a_straight_edge_is_rounded_and_its_sliver_holds_that) {
  verification::NumberedClaim numbered;
  numbered.is_kept = {0};
  RunControl control;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> far(0.5, 0.9), near(-1e-3, 1e-3), part(0.1, 0.9);
  const std::vector<verification::Use> uses{{VertexId(1), PatchId(0), 0, true}};
  std::size_t rounded = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a{far(random), far(random), far(random)}, beside{near(random), near(random), near(random)};
    const Vec3 b = i % 2 == 0 ? a + beside : beside - a;  // a short edge, or a long one past the origin
    const Vec3 p = a + part(random) * (b - a);
    const long double exact = exact_area(a, p, b);
    const double sliver = measure_gap(numbered, Polyline{a, b}, Polyline{a, p, b}, uses, control).sliver;
    EXPECT_GE(sliver, exact);
    EXPECT_LE(sliver, 1e-14 * norm(b - a));
    rounded += exact > 0 ? 1 : 0;
  }
  EXPECT_GT(rounded, 500u);
}

}  // namespace
}  // namespace remesh::verification
