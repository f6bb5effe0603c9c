#include "tests/support/polygons.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/exact/predicates.h"

namespace remesh::polygons {
namespace {

constexpr double kPi = 3.14159265358979323846;

double rounded(double value, double step) { return std::nearbyint(value / step) * step; }
Vec2 rounded(Vec2 p, double step) { return {rounded(p.x, step), rounded(p.y, step)}; }

/// Makes a counter-clockwise star. Its corners are in equal sectors, with radii between these two.
Loop star(Random& random, Vec2 centre, int corners, double min_radius, double max_radius) {
  Loop loop;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * kPi * (i + random.uniform(0.1, 0.9)) / corners;
    const double radius = random.uniform(min_radius, max_radius);
    loop.push_back(rounded(centre + radius * Vec2{std::cos(angle), std::sin(angle)}, 0x1p-20));
  }
  return loop;
}

Loop square(Vec2 low, double side) {
  return {low, {low.x + side, low.y}, {low.x + side, low.y + side}, {low.x, low.y + side}};
}

Loop reversed(Loop loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}

bool is_on_segment(Vec2 p, Vec2 a, Vec2 b) {
  return orient2d(a, b, p) == 0 && std::min(a, b) <= p && p <= std::max(a, b);
}

/// True if closed segments have a common point.
bool touch(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (is_on_segment(a, c, d) || is_on_segment(b, c, d) || is_on_segment(c, a, b) || is_on_segment(d, a, b)) return true;
  return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
}

/// True if the loop stays simple when p is inserted between corners i and i+1.
bool can_insert(const Loop& loop, std::size_t i, Vec2 p) {
  const std::size_t n = loop.size();
  const Vec2 a = loop[i], b = loop[(i + 1) % n];
  if (p == a || p == b || is_on_segment(b, a, p) || is_on_segment(a, p, b)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == i) continue;
    const Vec2 c = loop[k], d = loop[(k + 1) % n];
    // An edge that shares a corner with a new edge may touch it there and nowhere else.
    if (d == a ? is_on_segment(c, a, p) || is_on_segment(p, c, a) : touch(a, p, c, d)) return false;
    if (c == b ? is_on_segment(d, p, b) || is_on_segment(p, b, d) : touch(p, b, c, d)) return false;
  }
  return true;
}

}  // namespace

Polygon star_with_holes(std::uint64_t seed, int corners, int cells) {
  Random random(seed);
  Polygon polygon;
  constexpr double kMinRadius = 0.6;
  polygon.outer = star(random, {}, corners, kMinRadius, 1);
  // This square lies within the circle that every outer edge stays outside of, because two corners are at most 1.8
  // sectors apart.
  const double half_side = kMinRadius * std::cos(1.8 * kPi / corners) / std::sqrt(2.0);
  const double cell = 2 * half_side / std::max(cells, 1);
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      if (!random.chance(0.7)) continue;
      const Vec2 centre{-half_side + (i + 0.5) * cell, -half_side + (j + 0.5) * cell};
      polygon.holes.push_back(reversed(star(random, centre, random.integer(4, 9), 0.15 * cell, 0.495 * cell)));
    }
  return polygon;
}

Polygon grown(std::uint64_t seed, int corners, int size) {
  Random random(seed);
  const auto any_point = [&] {
    const int x = random.integer(0, size), y = random.integer(0, size);
    return Vec2{static_cast<double>(x), static_cast<double>(y)};
  };
  Loop loop;
  do {
    loop = {any_point(), any_point(), any_point()};
  } while (orient2d(loop[0], loop[1], loop[2]) == 0);
  for (int attempt = 0; attempt < 50 * corners && loop.size() < static_cast<std::size_t>(corners); ++attempt) {
    const std::size_t i = static_cast<std::size_t>(random.below(static_cast<int>(loop.size())));
    const Vec2 p = any_point();
    if (can_insert(loop, i, p)) loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(i) + 1, p);
  }
  if (area(loop) < 0) loop = reversed(loop);
  return {loop, {}};
}

Polygon rectilinear_with_holes(std::uint64_t seed, int columns) {
  Random random(seed);
  Polygon polygon;
  Loop below, above;  // both from left to right
  for (int i = 0; i < columns; ++i) {
    const double x = i, bottom = -random.integer(1, 4), top = random.integer(1, 4);
    below.insert(below.end(), {{x, bottom}, {x + 1, bottom}});
    above.insert(above.end(), {{x, top}, {x + 1, top}});
    if (random.chance(0.5)) polygon.holes.push_back(reversed(square({x + 0.25, -0.25}, 0.5)));
  }
  polygon.outer = below;
  polygon.outer.insert(polygon.outer.end(), above.rbegin(), above.rend());
  // Columns of equal height share their corner.
  polygon.outer.erase(std::unique(polygon.outer.begin(), polygon.outer.end()), polygon.outer.end());
  return polygon;
}

Polygon comb(int teeth, int height) {
  Loop loop{{0, 0}, {2.0 * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double x = 2 * i, top = 1 + height;
    loop.insert(loop.end(), {{x + 1, top}, {x, top}});
    if (i > 0) loop.insert(loop.end(), {{x, 1}, {x - 1, 1}});
  }
  return {loop, {}};
}

Polygon spiral(int turns) {
  // The band's middle line has lengths 2, 2, 4, 4, 6, 6, .... The band's two sides are half a unit away from it.
  const Vec2 directions[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  Loop left, right;
  Vec2 middle{0, 0};
  const auto add_sides = [&](Vec2 forward) {
    left.push_back(middle + Vec2{0.5 * -forward.y, 0.5 * forward.x});
    right.push_back(middle + Vec2{0.5 * forward.y, 0.5 * -forward.x});
  };
  add_sides(directions[0]);
  for (int i = 0; i < turns; ++i) {
    const Vec2 forward = directions[i % 4];
    middle = middle + 2.0 * (i / 2 + 1) * forward;
    if (i + 1 == turns) {
      add_sides(forward);
    } else {  // a corner: both sides turn at once, on the diagonal
      const Vec2 both = forward - directions[(i + 1) % 4];
      right.push_back(middle + 0.5 * both);
      left.push_back(middle - 0.5 * both);
    }
  }
  Loop loop = right;
  loop.insert(loop.end(), left.rbegin(), left.rend());
  return {loop, {}};
}

Polygon l_shape() { return {{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {}}; }

Polygon sieve(int n) {
  Polygon polygon;
  polygon.outer = square({0, 0}, 1);
  const double cell = rounded(1.0 / n, 0x1p-18) - 0x1p-18;  // a multiple of 2^-18 that leaves room for n of them
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      polygon.holes.push_back(reversed(square({(i + 0.25) * cell, (j + 0.25) * cell}, 0.5 * cell)));
  return polygon;
}

double area(const Loop& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) twice += cross(loop[i], loop[(i + 1) % loop.size()]);
  return twice / 2;
}

double area(const Polygon& polygon) {
  double sum = area(polygon.outer);
  for (const Loop& hole : polygon.holes) sum += area(hole);
  return sum;
}

PatchInput patch_input(const Polygon& polygon) {
  PatchInput input;
  input.points = polygon.outer;
  for (const Loop& hole : polygon.holes) input.points.insert(input.points.end(), hole.begin(), hole.end());
  input.points = sorted_unique(std::move(input.points));
  const auto index = [&](Vec2 p) {
    const auto found = std::lower_bound(input.points.begin(), input.points.end(), p);
    return static_cast<std::uint32_t>(found - input.points.begin());
  };
  const auto add_edges = [&](const Loop& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      input.edges.push_back({index(loop[i]), index(loop[(i + 1) % loop.size()])});
  };
  add_edges(polygon.outer);
  for (const Loop& hole : polygon.holes) add_edges(hole);
  return input;
}

std::vector<Vec2> scattered(std::uint64_t seed, int n) {
  Random random(seed);
  std::vector<Vec2> points(static_cast<std::size_t>(n));
  for (Vec2& p : points) {
    p.x = rounded(random.uniform(-1, 1), 0x1p-40);
    p.y = rounded(random.uniform(-1, 1), 0x1p-40);
  }
  return sorted_unique(std::move(points));
}

std::vector<Vec2> grid(int nx, int ny, double probability, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec2> points;
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      if (random.chance(probability)) points.push_back({static_cast<double>(x), static_cast<double>(y)});
  return points;
}

std::vector<Vec2> turned_grid(int nx, int ny, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), scale = 1.0 / (nx + ny);
  std::vector<Vec2> points = grid(nx, ny);
  for (Vec2& p : points) p = rounded(scale * Vec2{c * p.x - s * p.y, s * p.x + c * p.y}, 0x1p-40);
  return sorted_unique(std::move(points));
}

std::vector<Vec2> cocircular() {
  constexpr std::int64_t kRadius = 5 * 13 * 17 * 29;  // all primes are sums of two squares, which gives many points
  std::vector<Vec2> points;
  for (std::int64_t x = -kRadius; x <= kRadius; ++x) {
    const std::int64_t y_squared = kRadius * kRadius - x * x;
    const double y = std::nearbyint(std::sqrt(static_cast<double>(y_squared)));
    if (static_cast<std::int64_t>(y) * static_cast<std::int64_t>(y) != y_squared) continue;
    points.push_back({static_cast<double>(x), y});
    points.push_back({static_cast<double>(x), -y});
  }
  return sorted_unique(std::move(points));
}

std::vector<Vec2> nearly_cocircular(int n) {
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n;
    points.push_back(rounded(Vec2{std::cos(angle), std::sin(angle)}, 0x1p-40));
  }
  return sorted_unique(std::move(points));
}

std::vector<Vec2> parabola(int n) {
  std::vector<Vec2> points;
  for (int i = -n; i <= n; ++i) points.push_back({static_cast<double>(i), static_cast<double>(i) * i});
  return points;
}

std::vector<Vec2> on_lines(std::uint64_t seed, int lines, int n, int dx, int dy) {
  Random random(seed);
  std::vector<Vec2> points;
  for (int line = 0; line < lines; ++line) {
    const Vec2 start{static_cast<double>(random.integer(-50, 50)), static_cast<double>(random.integer(-50, 50))};
    for (int i = 0; i < n; ++i)
      points.push_back(start + static_cast<double>(random.integer(-2 * n, 2 * n)) *
                                   Vec2{static_cast<double>(dx), static_cast<double>(dy)});
  }
  return sorted_unique(std::move(points));
}

std::vector<Vec2> clusters(std::uint64_t seed, int count, int n) {
  Random random(seed);
  std::vector<Vec2> points;
  for (int cluster = 0; cluster < count; ++cluster) {
    const double x = rounded(random.uniform(-1, 1), 0x1p-40), y = rounded(random.uniform(-1, 1), 0x1p-40);
    for (int i = 0; i < n; ++i) {
      const double dx = random.uniform(0, 0x1p-20), dy = random.uniform(0, 0x1p-20);
      points.push_back(rounded({x + dx, y + dy}, 0x1p-40));
    }
  }
  return sorted_unique(std::move(points));
}

std::vector<Vec2> sorted_unique(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Placement random_placement(std::uint64_t seed, double scale) {
  Random random(seed);
  // A uniformly random unit quaternion, drawn by rejection from the ball, gives a uniformly random rotation.
  double w = 0, x = 0, y = 0, z = 0, n = 0;
  do {
    w = random.uniform(-1, 1);
    x = random.uniform(-1, 1);
    y = random.uniform(-1, 1);
    z = random.uniform(-1, 1);
    n = w * w + x * x + y * y + z * z;
  } while (n > 1 || n < 0.01);
  Placement placement;
  placement.x_axis = scale / n * Vec3{w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)};
  placement.y_axis = scale / n * Vec3{2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)};
  for (int axis = 0; axis < 3; ++axis) placement.origin[axis] = scale * random.uniform(-2, 2);
  return placement;
}

}  // namespace remesh::polygons
