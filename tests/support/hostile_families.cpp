#include "tests/support/hostile_families.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh::hostile {
namespace {

class FamilyBuilder {
 public:
  std::uint32_t vertex(const Vec3& p) {
    mesh_.positions.push_back(p);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  void face(std::initializer_list<std::uint32_t> corners) {
    for (const std::uint32_t v : corners) mesh_.corners.emplace_back(v);
    end_face();
  }
  /// Adds a face whose corners are all vertices from `first` on.
  void face_from(std::uint32_t first) {
    for (std::uint32_t v = first; v < mesh_.positions.size(); ++v) mesh_.corners.emplace_back(v);
    end_face();
  }
  PolygonMesh take() { return std::move(mesh_); }

 private:
  void end_face() { mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size())); }

  PolygonMesh mesh_;
};

/// Makes triangles with vertices of their own.
template <class Corner>
PolygonMesh triangles(std::size_t count, const Corner& corner) {
  FamilyBuilder out;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t a = out.vertex(corner()), b = out.vertex(corner()), c = out.vertex(corner());
    out.face({a, b, c});
  }
  return out.take();
}

template <class Corner>
PolygonMesh polygon(std::size_t corners, const Corner& corner) {
  FamilyBuilder out;
  for (std::size_t i = 0; i < corners; ++i) out.vertex(corner());
  out.face_from(0);
  return out.take();
}

PolygonMesh soup_in_a_cube(std::size_t size) {
  Random random(1);
  return triangles(size, [&] {
    const double x = random.unit(), y = random.unit();
    return Vec3{x, y, random.unit()};
  });
}
PolygonMesh soup_in_a_plane(std::size_t size) {
  Random random(2);
  return triangles(size, [&] {
    const double x = random.unit();
    return Vec3{x, random.unit(), 0};
  });
}
/// The grid has about as many places as there are triangles.
PolygonMesh soup_on_a_grid(std::size_t size) {
  Random random(3);
  const int side = std::max(4, static_cast<int>(std::cbrt(static_cast<double>(size))));
  return triangles(size, [&] {
    const int x = random.below(side), y = random.below(side);
    return Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(random.below(side))};
  });
}
PolygonMesh polygon_in_a_plane(std::size_t size) {
  Random random(4);
  return polygon(size, [&] {
    const double x = random.unit();
    return Vec3{x, random.unit(), 0};
  });
}
PolygonMesh polygon_in_space(std::size_t size) {
  Random random(5);
  return polygon(size, [&] {
    const double x = random.unit(), y = random.unit();
    return Vec3{x, y, random.unit()};
  });
}

/// Adds a rectangle with this middle, from -u - v to u + v around it.
void add_rectangle(FamilyBuilder& out, const Vec3& middle, const Vec3& u, const Vec3& v) {
  const std::uint32_t a = out.vertex(middle - u - v), b = out.vertex(middle + u - v), c = out.vertex(middle + u + v),
                      d = out.vertex(middle - u + v);
  out.face({a, b, c, d});
}

double share(std::size_t i, std::size_t n) { return static_cast<double>(i) / static_cast<double>(n); }

PolygonMesh planks(std::size_t size) {
  FamilyBuilder out;
  Random random(6);
  for (std::size_t i = 0; i < size; ++i) {
    const double angle = std::numbers::pi * share(i, size), reach = random.uniform(1, 2);
    add_rectangle(out, {}, reach * Vec3{std::cos(angle), std::sin(angle), 0}, {0, 0, random.uniform(1, 2)});
  }
  return out.take();
}

/// Directions at right angles, none of them along an axis. Each is three long.
constexpr std::array kAskew{Vec3{2, 1, 2}, Vec3{1, 2, -2}, Vec3{-2, 2, 1}};

/// The sheets lie one above the other along the third direction. The directions are pairwise at right angles.
PolygonMesh stack(std::size_t size, const std::array<Vec3, 3>& directions) {
  FamilyBuilder out;
  for (std::size_t i = 0; i < size; ++i)
    add_rectangle(out, share(i, size) * directions[2], directions[0], directions[1]);
  return out.take();
}
PolygonMesh straight_stack(std::size_t size) { return stack(size, {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}); }
PolygonMesh askew_stack(std::size_t size) { return stack(size, kAskew); }

/// Returns the outline of a comb with teeth that are one wide, one apart, and ten long.
std::vector<Vec2> comb_outline(std::size_t corners) {
  const std::size_t teeth = std::max<std::size_t>(1, corners / 4);
  const auto length = static_cast<double>(2 * teeth);
  constexpr double kTooth = 10;
  std::vector<Vec2> outline{{0, -1}, {length, -1}};
  for (std::size_t t = teeth; t-- > 0;) {
    const auto x = static_cast<double>(2 * t);
    outline.push_back({x + 2, 0});
    outline.push_back({x + 1.5, kTooth});
    outline.push_back({x + 0.5, kTooth});
  }
  outline.push_back({0, 0});
  return outline;
}
PolygonMesh comb(std::size_t size) {
  FamilyBuilder out;
  for (const Vec2 p : comb_outline(size)) out.vertex({p.x, p.y, 0});
  out.face_from(0);
  return out.take();
}
PolygonMesh comb_prism(std::size_t size) {
  FamilyBuilder out;
  const std::vector<Vec2> outline = comb_outline(size);
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const Vec2 p : outline) out.vertex({p.x, p.y, 1});
  out.face_from(0);
  for (std::uint32_t i = n; i-- > 0;) out.vertex({outline[i].x, outline[i].y, 0});
  out.face_from(n);
  const auto low = [&](std::uint32_t i) { return 2 * n - 1 - i; };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = i + 1 == n ? 0 : i + 1;
    out.face({i, low(i), low(next), next});
  }
  return out.take();
}

/// The needles are so narrow that hardly any two of them meet.
PolygonMesh spanning_needles(std::size_t size) {
  FamilyBuilder out;
  Random random(7);
  const double width = 1 / (static_cast<double>(size) * static_cast<double>(size));
  for (std::size_t i = 0; i < size; ++i) {
    const double y = random.unit(), z = random.unit(), y_end = random.unit(), z_end = random.unit();
    const std::uint32_t a = out.vertex({0, y, z}), b = out.vertex({0, y + width, z}), c = out.vertex({1, y_end, z_end});
    out.face({a, b, c});
  }
  return out.take();
}
PolygonMesh parallel_needles(std::size_t size) {
  FamilyBuilder out;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(size))));
  const double apart = 1 / static_cast<double>(side);
  const auto [along, u, v] = kAskew;
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3 from = static_cast<double>(i % side) * apart * u + static_cast<double>(i / side) * apart * v;
    const std::uint32_t a = out.vertex(from), b = out.vertex(from + (0.5 * apart) * u), c = out.vertex(from + along);
    out.face({a, b, c});
  }
  return out.take();
}

Vec2 at_angle(std::size_t i, std::size_t count) {
  const double angle = 2 * std::numbers::pi * share(i, count);
  return {std::cos(angle), std::sin(angle)};
}
/// Neighbours share a side, and the rim goes up and down, so that each face has a plane of its own.
PolygonMesh fan_around_a_vertex(std::size_t size) {
  FamilyBuilder out;
  Random random(8);
  const std::uint32_t middle = out.vertex({0, 0, 1});
  for (std::size_t i = 0; i < size; ++i) {
    const Vec2 p = at_angle(i, size);
    out.vertex({p.x, p.y, random.unit()});
  }
  const auto n = static_cast<std::uint32_t>(size);
  for (std::uint32_t i = 0; i < n; ++i) out.face({middle, 1 + i, 1 + (i + 1 == n ? 0 : i + 1)});
  return out.take();
}
/// As a file with nine digits has it: some neighbours are in one plane, and become patches of a few needles.
PolygonMesh round_cone(std::size_t size) {
  FamilyBuilder out;
  const std::uint32_t middle = out.vertex({0, 0, 1});
  const auto rounded = [](double x) { return std::nearbyint(x * 0x1p30) / 0x1p30; };
  for (std::size_t i = 0; i < size; ++i) {
    const Vec2 p = at_angle(i, size);
    out.vertex({rounded(p.x), rounded(p.y), 0});
  }
  const auto n = static_cast<std::uint32_t>(size);
  for (std::uint32_t i = 0; i < n; ++i) out.face({middle, 1 + i, 1 + (i + 1 == n ? 0 : i + 1)});
  return out.take();
}
PolygonMesh fan_around_an_edge(std::size_t size) {
  FamilyBuilder out;
  Random random(9);
  const std::uint32_t low = out.vertex({0, 0, 0}), high = out.vertex({0, 0, 1});
  for (std::size_t i = 0; i < size; ++i) {
    const Vec2 p = at_angle(i, size);
    const std::uint32_t apex = out.vertex({p.x, p.y, random.uniform(-1, 2)});
    out.face({low, high, apex});
  }
  return out.take();
}

constexpr std::array kFamilies{
    Family{"soup_in_a_cube", Answer::kQuadratic, soup_in_a_cube},
    Family{"soup_in_a_plane", Answer::kQuadratic, soup_in_a_plane},
    Family{"soup_on_a_grid", Answer::kQuadratic, soup_on_a_grid},
    Family{"polygon_in_a_plane", Answer::kQuadratic, polygon_in_a_plane},
    Family{"polygon_in_space", Answer::kQuadratic, polygon_in_space},
    Family{"planks", Answer::kQuadratic, planks},
    Family{"straight_stack", Answer::kInProportion, straight_stack},
    Family{"askew_stack", Answer::kInProportion, askew_stack},
    Family{"comb", Answer::kInProportion, comb},
    Family{"comb_prism", Answer::kInProportion, comb_prism},
    Family{"spanning_needles", Answer::kInProportion, spanning_needles},
    Family{"parallel_needles", Answer::kInProportion, parallel_needles},
    Family{"fan_around_a_vertex", Answer::kInProportion, fan_around_a_vertex},
    Family{"round_cone", Answer::kInProportion, round_cone},
    Family{"fan_around_an_edge", Answer::kInProportion, fan_around_an_edge},
};

}  // namespace

std::span<const Family> families() { return kFamilies; }

const Family& family(std::string_view name) {
  for (const Family& one : kFamilies)
    if (one.name == name) return one;
  throw std::out_of_range("there is no family " + std::string(name));
}

}  // namespace remesh::hostile
