#include "tests/support/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh::primitives {
namespace {

using test::PlainSurface;

constexpr double kPi = std::numbers::pi;
constexpr Vec3 kUp{0, 0, 1};

/// The direction of `i` of `n` parts of a turn. It is exact on the axes.
Vec2 direction(int i, int n) {
  i = ((i % n) + n) % n;
  if (4 * i % n == 0)
    return std::array<Vec2, 4>{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}}[static_cast<std::size_t>(4 * i / n)];
  return {std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n)};
}

PlainSurface plane(const Vec3& point, const Vec3& normal) { return {SurfaceKind::kPlane, point, normal, 0, 0, 0, {}}; }
PlainSurface free_form() { return {}; }
PlainSurface cylinder_along(const Vec3& point, const Vec3& axis, double radius) {
  return {SurfaceKind::kCylinder, point, axis, radius, 0, 0, {}};
}
PlainSurface sphere_around(const Vec3& centre, double radius) {
  return {SurfaceKind::kSphere, centre, {}, radius, 0, 0, {}};
}

/// Returns the cone, cylinder or plane around z on which a line of the profile lies.
PlainSurface turned(Vec2 a, Vec2 b) {
  if (a.x == b.x) return cylinder_along({}, kUp, a.x);
  if (a.y == b.y) return plane({0, 0, a.y}, {0, 0, a.x > b.x ? 1.0 : -1.0});
  const double apex = a.y - a.x * (b.y - a.y) / (b.x - a.x);
  const double towards = std::max(a.x, b.x) == a.x ? a.y - apex : b.y - apex;
  const double half = std::atan(std::fabs((b.x - a.x) / (b.y - a.y))) * 180 / kPi;
  return {SurfaceKind::kCone, {0, 0, apex}, {0, 0, towards > 0 ? 1.0 : -1.0}, 0, 0, half, {}};
}

/// Collects the faces of a model.
class Sculptor {
 public:
  std::uint32_t surface(const PlainSurface& s) {
    model_.surfaces.push_back(s);
    return static_cast<std::uint32_t>(model_.surfaces.size() - 1);
  }
  /// Adds a face. Equal neighbours among the corners become one, and a face of fewer than three corners is left out.
  void face(const std::vector<Vec3>& points, std::uint32_t surface) {
    std::vector<Vec3> corners;
    for (const Vec3& p : points)
      if (corners.empty() || corners.back() != p) corners.push_back(p);
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    if (corners.size() < 3) return;
    for (const Vec3& p : corners) model_.mesh.corners.push_back(vertex(p));
    model_.mesh.face_begin.push_back(static_cast<std::uint32_t>(model_.mesh.corners.size()));
    model_.surface_of.push_back(surface);
  }
  void two_triangles(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint32_t surface) {
    face({a, b, c}, surface);
    face({a, c, d}, surface);
  }
  Model take(std::string name) {
    model_.name = std::move(name);
    return std::move(model_);
  }

 private:
  VertexId vertex(const Vec3& p) {
    const auto [it, is_new] = ids_.try_emplace(p, model_.mesh.positions.size());
    if (is_new) model_.mesh.positions.push_back(p);
    return it->second;
  }

  Model model_;
  std::map<Vec3, VertexId> ids_;
};

/// Points around z. `at(i)` with `i` from 0 to `count` gives them; a closed ring begins again.
using Ring = std::function<Vec3(int)>;

Ring circle(int n, double radius, double height, double turn_parts = 0) {
  return [=](int i) {
    if (radius == 0) return Vec3{0, 0, height};
    const Vec2 d = turn_parts == 0 ? direction(i, n)
                                   : Vec2{std::cos(2 * kPi * (i % n + turn_parts) / n),
                                          std::sin(2 * kPi * (i % n + turn_parts) / n)};
    return Vec3{radius * d.x, radius * d.y, height};
  };
}

/// Adds the quads between two rings. The second one is above the first one, seen from outside.
void add_strip(Sculptor& sculptor, int count, const Ring& low, const Ring& high,
               const std::function<std::uint32_t(int)>& surface) {
  for (int i = 0; i < count; ++i) sculptor.face({low(i), low(i + 1), high(i + 1), high(i)}, surface(i));
}

void add_disc(Sculptor& sculptor, int n, const Ring& ring, std::uint32_t surface, bool is_upward) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(ring(is_upward ? i : n - i));
  sculptor.face(points, surface);
}

/// Turns a profile around z. The body lies to the left of the profile, which is drawn in (distance from the axis,
/// height). Each piece has a surface of its own kind; pieces on one plane, cylinder or cone are the caller's matter.
void add_revolved(Sculptor& sculptor, int n, int count, const std::vector<Vec2>& profile,
                  const std::vector<std::uint32_t>& surfaces, double turn_parts = 0) {
  for (std::size_t k = 0; k + 1 < profile.size(); ++k)
    add_strip(sculptor, count, circle(n, profile[k].x, profile[k].y, turn_parts),
              circle(n, profile[k + 1].x, profile[k + 1].y, turn_parts), [&](int) { return surfaces[k]; });
}

/// Turns a closed profile of lines around z.
void add_turned_part(Sculptor& sculptor, int n, std::vector<Vec2> profile, double turn_parts = 0) {
  profile.push_back(profile.front());
  std::vector<std::uint32_t> surfaces;
  for (std::size_t k = 0; k + 1 < profile.size(); ++k)
    surfaces.push_back(sculptor.surface(turned(profile[k], profile[k + 1])));
  add_revolved(sculptor, n, n, profile, surfaces, turn_parts);
}

/// Adds a prism over a counter-clockwise outline. Side `i` begins at corner `i`.
void add_prism(Sculptor& sculptor, const std::vector<Vec2>& outline, double height,
               const std::function<std::uint32_t(int)>& side) {
  const int n = static_cast<int>(outline.size());
  const auto ring = [&](double z) {
    return [&outline, n, z](int i) {
      const Vec2 p = outline[static_cast<std::size_t>(i % n)];
      return Vec3{p.x, p.y, z};
    };
  };
  add_strip(sculptor, n, ring(0), ring(height), side);
  add_disc(sculptor, n, ring(height), sculptor.surface(plane({0, 0, height}, kUp)), true);
  add_disc(sculptor, n, ring(0), sculptor.surface(plane({}, -kUp)), false);
}

/// A side of a prism as a plane of its own.
std::uint32_t side_plane(Sculptor& sculptor, Vec2 a, Vec2 b) {
  return sculptor.surface(plane({a.x, a.y, 0}, normalized(Vec3{b.y - a.y, a.x - b.x, 0})));
}

std::string label(const char* what, std::initializer_list<int> numbers) {
  std::string text = what;
  for (const int n : numbers) text += " " + std::to_string(n);
  return text;
}

}  // namespace

Model cylinder(int n, double radius, double height, int rows) {
  Sculptor sculptor;
  const std::uint32_t side = sculptor.surface(cylinder_along({}, kUp, radius));
  std::vector<Vec2> profile;
  for (int k = 0; k <= rows; ++k) profile.push_back({radius, height * k / rows});
  add_revolved(sculptor, n, n, profile, std::vector<std::uint32_t>(static_cast<std::size_t>(rows), side));
  add_disc(sculptor, n, circle(n, radius, height), sculptor.surface(plane({0, 0, height}, kUp)), true);
  add_disc(sculptor, n, circle(n, radius, 0), sculptor.surface(plane({}, -kUp)), false);
  return sculptor.take(label("cylinder", {n, rows}));
}

Model arc(int n, int count, double radius, double height) {
  Sculptor sculptor;
  add_revolved(sculptor, n, count, {{radius, 0}, {radius, height}},
               {sculptor.surface(cylinder_along({}, kUp, radius))});
  return sculptor.take(label("arc", {n, count}));
}

Model frustum(int n, double lower_radius, double upper_radius, double height) {
  Sculptor sculptor;
  const std::vector<Vec2> profile{{lower_radius, 0}, {upper_radius, height}};
  add_revolved(sculptor, n, n, profile, {sculptor.surface(turned(profile[0], profile[1]))});
  add_disc(sculptor, n, circle(n, upper_radius, height), sculptor.surface(plane({0, 0, height}, kUp)), true);
  add_disc(sculptor, n, circle(n, lower_radius, 0), sculptor.surface(plane({}, -kUp)), false);
  return sculptor.take(label("frustum", {n}));
}

Model cone(int n, double radius, double height) {
  Sculptor sculptor;
  const std::vector<Vec2> profile{{radius, 0}, {0, height}};
  add_revolved(sculptor, n, n, profile, {sculptor.surface(turned(profile[0], profile[1]))});
  add_disc(sculptor, n, circle(n, radius, 0), sculptor.surface(plane({}, -kUp)), false);
  return sculptor.take(label("cone", {n}));
}

Model globe(int longitudes, int latitudes, double radius) {
  Sculptor sculptor;
  const std::uint32_t surface = sculptor.surface(sphere_around({}, radius));
  std::vector<Vec2> profile;
  for (int k = 0; k <= latitudes; ++k) {
    const Vec2 d = direction(k - latitudes / 2, 2 * latitudes);
    profile.push_back({k == 0 || k == latitudes ? 0 : radius * d.x, radius * d.y});
  }
  add_revolved(sculptor, longitudes, longitudes, profile,
               std::vector<std::uint32_t>(static_cast<std::size_t>(latitudes), surface));
  return sculptor.take(label("globe", {longitudes, latitudes}));
}

Model icosphere(int levels, double radius) {
  const double phi = std::numbers::phi;
  std::vector<Vec3> corners;
  for (const double one : {-1.0, 1.0})
    for (const double other : {-phi, phi}) {
      corners.push_back({0, one, other});
      corners.push_back({one, other, 0});
      corners.push_back({other, 0, one});
    }
  std::vector<std::array<Vec3, 3>> faces;
  for (std::size_t a = 0; a < 12; ++a)
    for (std::size_t b = a + 1; b < 12; ++b)
      for (std::size_t c = b + 1; c < 12; ++c) {
        const auto is_edge = [&](std::size_t i, std::size_t j) { return norm(corners[i] - corners[j]) < 2.1; };
        if (!is_edge(a, b) || !is_edge(b, c) || !is_edge(a, c)) continue;
        const bool is_outward = dot(cross(corners[b] - corners[a], corners[c] - corners[a]), corners[a]) > 0;
        faces.push_back({corners[a], corners[is_outward ? b : c], corners[is_outward ? c : b]});
      }
  const auto onto = [&](const Vec3& p) { return radius * normalized(p); };
  for (auto& f : faces)
    for (Vec3& p : f) p = onto(p);
  for (int level = 0; level < levels; ++level) {
    std::vector<std::array<Vec3, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const Vec3 ab = onto(a + b), bc = onto(b + c), ca = onto(c + a);
      for (const auto& f : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) finer.push_back(f);
    }
    faces = std::move(finer);
  }
  Sculptor sculptor;
  const std::uint32_t surface = sculptor.surface(sphere_around({}, radius));
  for (const auto& [a, b, c] : faces) sculptor.face({a, b, c}, surface);
  return sculptor.take(label("icosphere", {levels}));
}

Model torus(int n, int count, int m, double radius, double tube) {
  Sculptor sculptor;
  const std::uint32_t surface = sculptor.surface({SurfaceKind::kTorus, {}, kUp, radius, tube, 0, {}});
  std::vector<Vec2> profile;
  for (int k = 0; k <= m; ++k) profile.push_back(Vec2{radius, 0} + tube * direction(k, m));
  add_revolved(sculptor, n, count, profile, std::vector<std::uint32_t>(static_cast<std::size_t>(m), surface));
  return sculptor.take(label("torus", {n, count, m}));
}

Model torus_with_flat_rings(int n, int m, double radius, double tube) {
  Sculptor sculptor;
  const std::uint32_t surface = sculptor.surface({SurfaceKind::kTorus, {}, kUp, radius, tube, 0, {}});
  // The profile is mirrored, so that both ends of a flat piece have the same height to the bit.
  const auto at = [&](int k) {
    k %= m;
    const bool is_lower = k >= m / 2;
    if (is_lower) k = m - 1 - k;
    const bool is_inner = k >= m / 4;
    if (is_inner) k = m / 2 - 1 - k;
    const double angle = kPi * (2 * k + 1) / m;
    return Vec2{radius + (is_inner ? -tube : tube) * std::cos(angle), (is_lower ? -tube : tube) * std::sin(angle)};
  };
  std::vector<Vec2> profile;
  for (int k = 0; k <= m; ++k) profile.push_back(at(k));
  add_revolved(sculptor, n, n, profile, std::vector<std::uint32_t>(static_cast<std::size_t>(m), surface));
  return sculptor.take(label("torus with flat rings", {n, m}));
}

Model rounded_box(const Vec3& half, double radius, int k) {
  Sculptor sculptor;
  // A globe is cut along the three planes between its octants, and the eight pieces are moved apart.
  const int around = 4 * (k + 1);
  const int layers = 2 * (k + 1);
  const auto at = [&](int i, int j) {
    const int quadrant = i % around / (k + 1);
    const Vec2 flat = direction(i % around % (k + 1) + quadrant * k, 4 * k);
    const bool is_upper = j > k;
    const Vec2 steep = direction((is_upper ? j - k - 1 : j - k), 4 * k);
    const double across = std::fabs(steep.x) < 1e-15 ? 0 : radius * steep.x;
    const double sx = quadrant == 0 || quadrant == 3 ? 1 : -1;
    const double sy = quadrant < 2 ? 1 : -1;
    return Vec3{sx * half.x + across * flat.x, sy * half.y + across * flat.y,
                (is_upper ? half.z : -half.z) + radius * steep.y};
  };
  std::map<std::array<int, 3>, std::uint32_t> surfaces;
  // The key tells on which side of the middle a piece lies, for each axis; 0: it spans the middle.
  const auto surface_of = [&](int i, int j) {
    const int quadrant = i / (k + 1);
    const bool spans = i % (k + 1) == k;
    std::array<int, 3> key{quadrant == 0 || quadrant == 3 ? 1 : -1, quadrant < 2 ? 1 : -1, j < k ? -1 : j > k ? 1 : 0};
    if (spans) key[quadrant % 2 == 0 ? 0 : 1] = 0;
    const auto found = surfaces.find(key);
    if (found != surfaces.end()) return found->second;
    const Vec3 centre{key[0] * half.x, key[1] * half.y, key[2] * half.z};
    const int zeros = (key[0] == 0) + (key[1] == 0) + (key[2] == 0);
    const Vec3 outwards{static_cast<double>(key[0]), static_cast<double>(key[1]), static_cast<double>(key[2])};
    const PlainSurface s =
        zeros == 0 ? sphere_around(centre, radius)
        : zeros == 1
            ? cylinder_along(centre, {key[0] == 0 ? 1.0 : 0, key[1] == 0 ? 1.0 : 0, key[2] == 0 ? 1.0 : 0}, radius)
            : plane(centre + radius * outwards, outwards);
    return surfaces[key] = sculptor.surface(s);
  };
  for (int j = 0; j + 1 < layers; ++j)
    for (int i = 0; i < around; ++i)
      sculptor.face({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, surface_of(i, j));
  for (const bool is_upper : {false, true}) {
    std::vector<Vec3> corners;
    for (int q = 0; q < 4; ++q) corners.push_back(at((is_upper ? q : 3 - q) * (k + 1), is_upper ? layers - 1 : 0));
    const double side = is_upper ? 1 : -1;
    sculptor.face(corners, sculptor.surface(plane({0, 0, side * (half.z + radius)}, {0, 0, side})));
  }
  return sculptor.take(label("rounded box", {k}));
}

Model countersunk_plate(int n) {
  Sculptor sculptor;
  const double side = 6, thickness = 2, bore = 1.25, sink = 2.5, depth = 1.25;
  const auto square = [&](double z) {
    return [n, side, z](int i) {
      const Vec2 d = direction(i, n);
      const double largest = std::max(std::fabs(d.x), std::fabs(d.y));
      // The corners are exact, so that each side of the plate is straight.
      const auto to_border = [&](double c) {
        return std::fabs(c) > largest - 1e-12 ? std::copysign(side, c) : side * c / largest;
      };
      return Vec3{to_border(d.x), to_border(d.y), z};
    };
  };
  std::array<std::uint32_t, 4> sides{};
  for (int q = 0; q < 4; ++q) {
    const Vec2 d = direction(q, 4);
    sides[static_cast<std::size_t>(q)] = sculptor.surface(plane({side * d.x, side * d.y, 0}, {d.x, d.y, 0}));
  }
  const auto one = [](std::uint32_t s) { return [s](int) { return s; }; };
  add_strip(sculptor, n, square(0), square(thickness),
            [&](int i) { return sides[static_cast<std::size_t>((8 * i + n) / (2 * n) % 4)]; });
  add_strip(sculptor, n, square(thickness), circle(n, sink, thickness),
            one(sculptor.surface(plane({0, 0, thickness}, kUp))));
  const Vec2 rim{sink, thickness}, neck{bore, thickness - depth};
  add_strip(sculptor, n, circle(n, rim.x, rim.y), circle(n, neck.x, neck.y), one(sculptor.surface(turned(rim, neck))));
  add_strip(sculptor, n, circle(n, neck.x, neck.y), circle(n, bore, 0),
            one(sculptor.surface(cylinder_along({}, kUp, bore))));
  add_strip(sculptor, n, circle(n, bore, 0), square(0), one(sculptor.surface(plane({}, -kUp))));
  return sculptor.take(label("countersunk plate", {n}));
}

Model tube(int n, double radius, double wall, double height) {
  Sculptor sculptor;
  add_turned_part(sculptor, n, {{radius, 0}, {radius, height}, {radius - wall, height}, {radius - wall, 0}});
  return sculptor.take(label("tube", {n}));
}

Model plates_with_a_common_bore(int n) {
  Sculptor sculptor;
  const std::uint32_t bore = sculptor.surface(cylinder_along({}, kUp, 2));
  for (const double z : {0.0, 4.0}) {
    const double rim = z == 0 ? 6 : 5;
    const std::vector<Vec2> profile{{rim, z}, {rim, z + 1}, {2, z + 1}, {2, z}, {rim, z}};
    add_revolved(sculptor, n, n, profile,
                 {sculptor.surface(turned(profile[0], profile[1])), sculptor.surface(turned(profile[1], profile[2])),
                  bore, sculptor.surface(turned(profile[3], profile[4]))});
  }
  return sculptor.take(label("two plates with a common bore", {n}));
}

Model pin_in_its_bore(int n) {
  Sculptor sculptor;
  const std::uint32_t both = sculptor.surface(cylinder_along({}, kUp, 2));
  const std::vector<Vec2> plate{{6, 0}, {6, 1}, {2, 1}, {2, 0}, {6, 0}};
  add_revolved(sculptor, n, n, plate,
               {sculptor.surface(turned(plate[0], plate[1])), sculptor.surface(turned(plate[1], plate[2])), both,
                sculptor.surface(turned(plate[3], plate[4]))});
  add_revolved(sculptor, n, n, {{2, -1}, {2, 2}}, {both}, 0.5);
  add_disc(sculptor, n, circle(n, 2, 2, 0.5), sculptor.surface(plane({0, 0, 2}, kUp)), true);
  add_disc(sculptor, n, circle(n, 2, -1, 0.5), sculptor.surface(plane({0, 0, -1}, -kUp)), false);
  return sculptor.take(label("pin in its bore", {n}));
}

Model tee(int n) {
  Sculptor sculptor;
  const double radius = 4, branch = 2, length = 6, top = 7;
  const std::uint32_t main_pipe = sculptor.surface(cylinder_along({}, {1, 0, 0}, radius));
  const std::uint32_t side_pipe = sculptor.surface(cylinder_along({}, kUp, branch));
  // The corners of the cut lie on both cylinders. Each of them is the end of a ruling of either.
  const auto cut = [&](int i) {
    const Vec2 d = direction(i, n);
    const double y = branch * d.y;
    return Vec3{branch * d.x, y, std::sqrt(radius * radius - y * y)};
  };
  add_strip(sculptor, n, cut, circle(n, branch, top), [&](int) { return side_pipe; });
  const auto rim = [&](int i, double side) { return Vec3{side * length, cut(i).y, cut(i).z}; };
  for (int i = 0; i < n; ++i) {
    const double side = 4 * i < n || 4 * i >= 3 * n ? 1 : -1;
    sculptor.face({cut(i), rim(i, side), rim(i + 1, side), cut(i + 1)}, main_pipe);
  }
  // The other facets reach from rim to rim. The first and the last of them pass the cut, which touches their sides.
  const int left = n / 4, right = 3 * n / 4;
  const int steps = 5 * n / 3;
  const double reach = 2 * kPi - 2 * std::asin(branch / radius);
  const auto around = [&](int k, double side) {
    if (k == 0) return rim(left, side);
    if (k == steps) return rim(right, side);
    const double angle = std::asin(branch / radius) + reach * k / steps;
    return Vec3{side * length, radius * std::sin(angle), radius * std::cos(angle)};
  };
  for (int k = 0; k < steps; ++k) {
    std::vector<Vec3> corners{around(k, -1)};
    if (k == 0) corners.push_back(cut(left));
    for (const Vec3& p : {around(k, 1), around(k + 1, 1)}) corners.push_back(p);
    if (k + 1 == steps) corners.push_back(cut(right));
    corners.push_back(around(k + 1, -1));
    sculptor.face(corners, main_pipe);
  }
  return sculptor.take(label("tee", {n}));
}

Model vase(int n, int m) {
  Sculptor sculptor;
  const auto profile_at = [](double t) { return Vec2{3 + 0.7 * std::sin(5 * t) + 0.5 * t * t, 6 * t}; };
  PlainSurface s{SurfaceKind::kRevolution, {}, kUp, 0, 0, 0, {}};
  // The truth is finer than the facets, and contains their corners.
  constexpr int kFiner = 64;
  for (int k = 0; k <= kFiner * m; ++k) s.profile.push_back(profile_at(static_cast<double>(k) / (kFiner * m)));
  const std::uint32_t surface = sculptor.surface(s);
  std::vector<Vec2> profile;
  for (int k = 0; k <= m; ++k) profile.push_back(profile_at(static_cast<double>(k) / m));
  add_revolved(sculptor, n, n, profile, std::vector<std::uint32_t>(static_cast<std::size_t>(m), surface));
  return sculptor.take(label("vase", {n, m}));
}

Model thread(int n, int turns) {
  Sculptor sculptor;
  const std::uint32_t root = sculptor.surface(cylinder_along({}, kUp, 4));
  const std::uint32_t crest = sculptor.surface(cylinder_along({}, kUp, 5));
  const std::uint32_t flank = sculptor.surface(free_form());
  // The profile of one turn: the distance from the axis, and the height in parts of a turn. Each part is 1/8.
  constexpr std::array<std::pair<double, int>, 5> kProfile{{{4, 0}, {4, 2}, {5, 4}, {5, 6}, {4, 8}}};
  const std::array<std::uint32_t, 4> surfaces{root, flank, crest, flank};
  const auto at = [&](int i, std::size_t k) {
    const Vec2 d = direction(i, n);
    const auto [radius, part] = kProfile[k];
    return Vec3{radius * d.x, radius * d.y, 2.0 * (8 * i + part * n) / (8 * n)};
  };
  for (int i = 0; i < turns * n; ++i)
    for (std::size_t k = 0; k < 4; ++k)
      sculptor.two_triangles(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1), surfaces[k]);
  return sculptor.take(label("thread", {n, turns}));
}

Model bar_with_round_corner(int k) {
  Sculptor sculptor;
  const double side = 6, radius = 2;
  std::vector<Vec2> outline{{0, 0}, {side, 0}};
  for (int i = 0; i <= k; ++i) outline.push_back(Vec2{side - radius, side - radius} + radius * direction(i, 4 * k));
  outline.push_back({0, side});
  const std::uint32_t round = sculptor.surface(cylinder_along({side - radius, side - radius, 0}, kUp, radius));
  const int n = static_cast<int>(outline.size());
  add_prism(sculptor, outline, 5, [&](int i) {
    return i >= 2 && i < 2 + k ? round
                               : side_plane(sculptor, outline[static_cast<std::size_t>(i)],
                                            outline[static_cast<std::size_t>((i + 1) % n)]);
  });
  return sculptor.take(label("bar with a round corner", {k}));
}

Model d_shaft(int n, int missing) {
  Sculptor sculptor;
  std::vector<Vec2> outline;
  for (int i = missing; i <= n; ++i) outline.push_back(4 * direction(i, n));
  const std::uint32_t round = sculptor.surface(cylinder_along({}, kUp, 4));
  const int sides = static_cast<int>(outline.size());
  add_prism(sculptor, outline, 7,
            [&](int i) { return i + 1 < sides ? round : side_plane(sculptor, outline.back(), outline.front()); });
  return sculptor.take(label("shaft with a flat", {n, missing}));
}

Model nut(int sides, int n, double bore) {
  Sculptor sculptor;
  std::vector<Vec2> outline;
  for (int i = 0; i < sides; ++i) outline.push_back(5 * direction(i, sides));
  const auto side = [&](int i) {
    return side_plane(sculptor, outline[static_cast<std::size_t>(i)],
                      outline[static_cast<std::size_t>((i + 1) % sides)]);
  };
  if (n == 0) {
    add_prism(sculptor, outline, 3, side);
    return sculptor.take(label("prism", {sides}));
  }
  // Each side of the outline has as many points as its part of the bore, or one more if these are not whole numbers.
  const auto first_of = [&](int q) { return (q * n + sides - 1) / sides; };
  const auto side_of = [&](int i) { return i % n * sides / n; };
  const auto rim = [&](double z) {
    return [&, z](int i) {
      const int q = side_of(i), first = first_of(q);
      const double t = static_cast<double>(i % n - first) / (first_of(q + 1) - first);
      const Vec2 p =
          (1 - t) * outline[static_cast<std::size_t>(q)] + t * outline[static_cast<std::size_t>((q + 1) % sides)];
      return Vec3{p.x, p.y, z};
    };
  };
  std::vector<std::uint32_t> planes;
  for (int q = 0; q < sides; ++q) planes.push_back(side(q));
  const auto one = [](std::uint32_t s) { return [s](int) { return s; }; };
  add_strip(sculptor, n, rim(0), rim(3), [&](int i) { return planes[static_cast<std::size_t>(side_of(i))]; });
  add_strip(sculptor, n, rim(3), circle(n, bore, 3), one(sculptor.surface(plane({0, 0, 3}, kUp))));
  add_strip(sculptor, n, circle(n, bore, 3), circle(n, bore, 0), one(sculptor.surface(cylinder_along({}, kUp, bore))));
  add_strip(sculptor, n, circle(n, bore, 0), rim(0), one(sculptor.surface(plane({}, -kUp))));
  return sculptor.take(label("nut", {sides, n}));
}

Model planks(const std::string& name, const std::vector<double>& degrees) {
  Sculptor sculptor;
  std::vector<Vec2> outline;
  double angle = 0;
  for (std::size_t i = 0; angle < 360 - 1e-9; ++i) {
    outline.push_back({4 * std::cos(angle * kPi / 180), 4 * std::sin(angle * kPi / 180)});
    angle += degrees[i % degrees.size()];
  }
  add_prism(sculptor, outline, 6, [&](int i) {
    return side_plane(sculptor, outline[static_cast<std::size_t>(i)],
                      outline[static_cast<std::size_t>(i + 1) % outline.size()]);
  });
  return sculptor.take(name);
}

Model bar_with_three_planks() {
  Sculptor sculptor;
  std::vector<Vec2> outline{{0, 0}, {8, 0}};
  // The planks look into the directions of 22.5, 45 and 67.5 degrees, so each edge turns by 22.5.
  outline.push_back({8, 4});
  for (const double degrees : {112.5, 135.0, 157.5})
    outline.push_back(outline.back() + 2 * Vec2{std::cos(degrees * kPi / 180), std::sin(degrees * kPi / 180)});
  outline.push_back({0, outline.back().y});
  add_prism(sculptor, outline, 5, [&](int i) {
    return side_plane(sculptor, outline[static_cast<std::size_t>(i)],
                      outline[static_cast<std::size_t>(i + 1) % outline.size()]);
  });
  return sculptor.take("bar with three planks");
}

}  // namespace remesh::primitives
