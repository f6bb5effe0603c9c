#include "tests/support/hostile.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh::hostile {
namespace {

class ShapeBuilder {
 public:
  std::uint32_t vertex(const Vec3& p) {
    mesh_.positions.push_back(p);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t v : {a, b, c}) mesh_.corners.emplace_back(v);
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }
  void face(const std::vector<std::uint32_t>& corners) {
    for (const std::uint32_t v : corners) mesh_.corners.emplace_back(v);
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }
  PolygonMesh take() { return std::move(mesh_); }

 private:
  PolygonMesh mesh_;
};

Vec2 on_circle(std::size_t i, std::size_t count) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
  return {std::cos(angle), std::sin(angle)};
}

PolygonMesh fan(std::size_t count, double height) {
  ShapeBuilder out;
  const std::uint32_t tip = out.vertex({0, 0, height});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = on_circle(i, count);
    out.vertex({p.x, p.y, 0});
  }
  for (std::uint32_t i = 0; i < count; ++i) out.triangle(tip, 1 + i, 1 + (i + 1 == count ? 0 : i + 1));
  return out.take();
}

/// Makes a grid of (n + 1)^2 vertices with those heights.
/// Input: `take` - called with the corners of each triangle.
template <class Height, class Take>
void grid(std::size_t n, ShapeBuilder& out, const Height& height, const Take& take) {
  for (std::size_t j = 0; j <= n; ++j)
    for (std::size_t i = 0; i <= n; ++i) out.vertex({static_cast<double>(i), static_cast<double>(j), height()});
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i) {
      take(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      take(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
}

}  // namespace

PolygonMesh components(std::size_t count) {
  ShapeBuilder out;
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 corner{static_cast<double>(2 * (k % side)), static_cast<double>(2 * (k / side % side)),
                      static_cast<double>(2 * (k / side / side))};
    const std::uint32_t a = out.vertex(corner), b = out.vertex(corner + Vec3{1, 0, 0}),
                        c = out.vertex(corner + Vec3{0, 1, 0}), d = out.vertex(corner + Vec3{0, 0, 1});
    out.triangle(a, c, b);
    out.triangle(a, b, d);
    out.triangle(b, c, d);
    out.triangle(c, a, d);
  }
  return out.take();
}

PolygonMesh cone(std::size_t count) { return fan(count, 1); }
PolygonMesh disc(std::size_t count) { return fan(count, 0); }

PolygonMesh polygon(std::size_t count) {
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(on_circle(i, count));
  return shapes::polygon(points);
}

PolygonMesh soup(std::size_t count, unsigned seed) {
  ShapeBuilder out;
  Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t corner[3];
    for (std::uint32_t& v : corner) v = out.vertex({random.unit(), random.unit(), random.unit()});
    out.triangle(corner[0], corner[1], corner[2]);
  }
  return out.take();
}

PolygonMesh book(std::size_t count) {
  ShapeBuilder out;
  const std::uint32_t low = out.vertex({0, 0, 0}), high = out.vertex({0, 0, 1});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = on_circle(i, count);
    out.triangle(low, high, out.vertex({p.x, p.y, 0.5}));
  }
  return out.take();
}

PolygonMesh double_book(std::size_t count) {
  ShapeBuilder out;
  const std::uint32_t low = out.vertex({0, 0, 0}), high = out.vertex({0, 0, 1});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = on_circle(i, count);
    const std::uint32_t apex = out.vertex({p.x, p.y, 0.5});
    out.triangle(low, high, apex);
    out.triangle(high, low, apex);
  }
  return out.take();
}

PolygonMesh repeated(std::size_t count) {
  ShapeBuilder out;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) out.vertex(p);
  for (std::size_t i = 0; i < count; ++i) out.triangle(0, 1, 2);
  return out.take();
}

PolygonMesh torn_edge(std::size_t count) {
  ShapeBuilder out;
  const auto n = static_cast<double>(count);
  const std::uint32_t from = out.vertex({0, 0, 0}), to = out.vertex({n, 0, 0}), above = out.vertex({n / 2, n, 0}),
                      below = out.vertex({n / 2, -n, 0});
  out.triangle(from, to, above);
  std::uint32_t last = from;
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint32_t next = i == count ? to : out.vertex({static_cast<double>(i), 0, 0});
    out.triangle(next, last, below);
    last = next;
  }
  return out.take();
}

PolygonMesh flat_fan(std::size_t count) {
  ShapeBuilder out;
  const auto n = static_cast<double>(count + 1);
  const std::uint32_t from = out.vertex({0, 0, 0}), to = out.vertex({n, 0, 0}), above = out.vertex({n / 2, n, 0}),
                      below = out.vertex({n / 2, -n, 0});
  out.triangle(from, to, above);
  std::uint32_t last = from;
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint32_t next = out.vertex({static_cast<double>(i), 0, 0});
    out.triangle(last, next, to);  // on the common line
    out.triangle(next, last, below);
    last = next;
  }
  out.triangle(to, last, below);
  return out.take();
}

PolygonMesh crumpled(std::size_t n, unsigned seed) {
  ShapeBuilder out;
  Random random(seed);
  grid(
      n, out, [&] { return random.unit(); }, [&](auto a, auto b, auto c) { out.triangle(a, b, c); });
  return out.take();
}

PolygonMesh strip(std::size_t count) {
  ShapeBuilder out;
  for (std::size_t i = 0; i < count + 2; ++i)
    out.vertex({static_cast<double>(i / 2 * 1024), i % 2 == 0 ? 0.0 : 1.0, 0});
  for (std::uint32_t i = 0; i < count; ++i) i % 2 == 0 ? out.triangle(i, i + 2, i + 1) : out.triangle(i, i + 1, i + 2);
  return out.take();
}

PolygonMesh shuffled_winding(std::size_t n, unsigned seed) {
  ShapeBuilder out;
  Random random(seed);
  grid(
      n, out, [] { return 0.0; },
      [&](auto a, auto b, auto c) { random.chance(0.5) ? out.triangle(a, b, c) : out.triangle(a, c, b); });
  return out.take();
}

std::vector<Case> cases(std::size_t faces) {
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(faces) / 2));
  Options plain, refined, all, near, welded;
  plain.refine = false;
  all.refine = false;
  all.repair.inside_out = true;
  near.proximity = 1;
  welded.refine = false;
  welded.weld_tolerance = 1e-3;
  std::vector<Case> cases;
  cases.push_back({"components", components(faces / 4), all});
  cases.push_back({"components_welded", components(faces / 4), welded});
  cases.push_back({"components_refined", components(faces / 4), refined});
  cases.push_back({"cone", cone(faces), plain});
  cases.push_back({"cone_refined", cone(faces / 4), refined});
  cases.push_back({"cone_near", cone(faces / 16), near});
  cases.push_back({"disc", disc(faces), plain});
  cases.push_back({"disc_refined", disc(faces), refined});
  cases.push_back({"polygon", polygon(faces), plain});
  cases.push_back({"polygon_refined", polygon(faces), refined});
  cases.push_back({"soup", soup(faces / 10, 1), plain});
  cases.push_back({"soup_refined", soup(faces / 10, 2), refined});
  cases.push_back({"book", book(faces), all});
  cases.push_back({"double_book", double_book(faces / 2), plain});
  cases.push_back({"repeated", repeated(faces), plain});
  cases.push_back({"torn_edge", torn_edge(faces), plain});
  cases.push_back({"flat_fan", flat_fan(faces / 2), plain});
  cases.push_back({"crumpled", crumpled(side, 3), plain});
  cases.push_back({"crumpled_near", crumpled(side / 4, 4), near});
  cases.push_back({"strip", strip(faces), plain});
  cases.push_back({"strip_refined", strip(faces / 4), refined});
  cases.push_back({"shuffled_winding", shuffled_winding(side, 5), all});
  return cases;
}

}  // namespace remesh::hostile
