#include "tests/figures/render.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

namespace remesh::figures {
namespace {

const Vec3 kTowardsViewer = normalized({1.0, -0.72, 0.62});
const Vec3 kRight = normalized(cross({0, 0, 1}, kTowardsViewer));
const Vec3 kUp = cross(kTowardsViewer, kRight);
const Vec3 kLight = normalized({0.75, -0.2, 1.3});

const Colour kMetal{0.62, 0.72, 0.82};
const Colour kDark{0.10, 0.15, 0.22};
const Colour kWhite{1, 1, 1};

/// A face that looks at the viewer, in picture coordinates.
struct Facet {
  std::size_t face;
  std::uint32_t patch;
  std::array<Vec2, 3> corners;  // counter-clockwise
  Vec2 low, high;               // their box
  Vec3 plane;                   // depth = plane.x * u + plane.y * v + plane.z, larger is nearer

  double depth(Vec2 p) const { return plane.x * p.x + plane.y * p.y + plane.z; }
};

Facet make_facet(const Shape& shape, std::size_t face, const Vec3& normal) {
  Facet facet{face, shape.patch[face], {}, {HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 p = in_picture(shape.positions[shape.faces[face][k]]);
    facet.corners[k] = p;
    facet.low = {std::min(facet.low.x, p.x), std::min(facet.low.y, p.y)};
    facet.high = {std::max(facet.high.x, p.x), std::max(facet.high.y, p.y)};
  }
  const double towards = dot(normal, kTowardsViewer);
  const double offset = dot(normal, shape.positions[shape.faces[face][0]]);
  facet.plane = {-dot(normal, kRight) / towards, -dot(normal, kUp) / towards, offset / towards};
  return facet;
}

/// Returns the area that two facets share in the picture, as a convex polygon.
std::vector<Vec2> overlap(const Facet& a, const Facet& b) {
  std::vector<Vec2> polygon(a.corners.begin(), a.corners.end());
  for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k) {
    const Vec2 from = b.corners[k], along = b.corners[(k + 1) % 3] - from;
    std::vector<Vec2> inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
      const double at_p = cross(along, p - from), at_q = cross(along, q - from);
      if (at_p >= 0) inside.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) inside.push_back(p + (at_p / (at_p - at_q)) * (q - p));
    }
    polygon = std::move(inside);
  }
  return polygon;
}

double area(const std::vector<Vec2>& polygon) {
  double doubled = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    doubled += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return doubled / 2;
}

/// Returns how much nearer `a` is than `b` in the middle of the area that they share, or 0 if they share none.
double nearer_by(const Facet& a, const Facet& b) {
  const std::vector<Vec2> shared = overlap(a, b);
  const double box = (a.high.x - a.low.x) * (a.high.y - a.low.y);
  if (area(shared) <= 1e-6 * box) return 0;
  const Vec2 middle = (1 / static_cast<double>(shared.size())) * std::accumulate(shared.begin(), shared.end(), Vec2{});
  return a.depth(middle) - b.depth(middle);
}

/// Returns the order in which to paint, in runs that each belong to one patch. A facet comes before those that cover
/// it.
std::vector<std::vector<std::size_t>> paint_order(const std::vector<Facet>& facets) {
  std::vector<std::vector<std::size_t>> covered_by(facets.size());
  std::vector<std::size_t> waits_for(facets.size(), 0);
  std::vector<std::size_t> by_x(facets.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::stable_sort(by_x.begin(), by_x.end(),
                   [&](std::size_t a, std::size_t b) { return facets[a].low.x < facets[b].low.x; });
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const Facet& a = facets[by_x[i]];
    for (std::size_t j = i + 1; j < by_x.size() && facets[by_x[j]].low.x < a.high.x; ++j) {
      const Facet& b = facets[by_x[j]];
      if (a.patch == b.patch || b.low.y >= a.high.y || a.low.y >= b.high.y) continue;
      const double nearer = nearer_by(a, b);
      if (nearer == 0) continue;
      const auto [below, above] = nearer > 0 ? std::pair(by_x[j], by_x[i]) : std::pair(by_x[i], by_x[j]);
      covered_by[below].push_back(above);
      ++waits_for[above];
    }
  }
  std::map<std::uint32_t, std::vector<std::size_t>> ready;  // by patch; those that cover nobody who is to be painted
  for (std::size_t i = 0; i < facets.size(); ++i)
    if (waits_for[i] == 0) ready[facets[i].patch].push_back(i);
  std::vector<std::vector<std::size_t>> runs;
  while (!ready.empty()) {
    // The longest run is taken next, so that there are few runs.
    const auto longest = std::max_element(
        ready.begin(), ready.end(), [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    const std::uint32_t patch = longest->first;
    std::vector<std::size_t>& run = runs.emplace_back(std::move(longest->second));
    ready.erase(longest);
    for (std::size_t next = 0; next < run.size(); ++next)
      for (const std::size_t above : covered_by[run[next]])
        if (--waits_for[above] == 0) (facets[above].patch == patch ? run : ready[facets[above].patch]).push_back(above);
  }
  for (std::size_t i = 0; i < facets.size(); ++i)  // facets that cover each other in a ring: drawn last, as they come
    if (waits_for[i] != 0) runs.push_back({i});
  return runs;
}

Colour shade(const Colour& base, const Vec3& normal) {
  const double light = 1.5 * (dot(normal, kLight) - 0.45);
  return light < 0 ? mix(base, kDark, -0.45 * light) : mix(base, kWhite, light);
}

/// Returns the colour for the longest edge of a face, in steps. Short edges get warm colours.
Colour colour_of_size(const Shape& shape, std::size_t face) {
  constexpr double kSmall = 1, kLarge = 32;  // millimetres of the part that is shown
  constexpr int kSteps = 24;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest,
                       norm(shape.positions[shape.faces[face][(k + 1) % 3]] - shape.positions[shape.faces[face][k]]));
  const double at = std::clamp(std::log(longest / kSmall) / std::log(kLarge / kSmall), 0.0, 1.0);
  const double step = 3 * std::round(kSteps * at) / kSteps;
  const std::array<Colour, 4> scale{{{0.93, 0.49, 0.30}, {0.98, 0.83, 0.53}, {0.66, 0.83, 0.80}, {0.36, 0.58, 0.77}}};
  const auto low = static_cast<std::size_t>(std::min(2.0, step));
  return mix(scale[low], scale[low + 1], step - static_cast<double>(low));
}

}  // namespace

Shape shape_of(const Result& result) {
  Shape shape;
  shape.positions = result.mesh.positions.items();
  for (const auto& [a, b, c] : result.mesh.faces) shape.faces.push_back({a.value, b.value, c.value});
  for (const PatchId p : result.face_patch) shape.patch.push_back(p.value);
  return shape;
}

Vec2 in_picture(const Vec3& p) { return {dot(p, kRight), dot(p, kUp)}; }

bool looks_at_viewer(const Vec3& normal) { return dot(normal, kTowardsViewer) > 1e-3; }

void draw(const Shape& shape, Paint paint, double mesh_line_width, Panel& panel) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> patch_at;  // by directed edge
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) patch_at[{shape.faces[f][k], shape.faces[f][(k + 1) % 3]}] = shape.patch[f];

  std::vector<Vec3> patch_normals;  // so that needles, whose own normals are noise, do not show
  if (paint == Paint::kSurfaces) {
    patch_normals.resize(shape.surface.size());
    for (std::size_t f = 0; f < shape.faces.size(); ++f) {
      const auto [a, b, c] = shape.faces[f];
      patch_normals[shape.patch[f]] +=
          cross(shape.positions[b] - shape.positions[a], shape.positions[c] - shape.positions[a]);
    }
  }

  std::vector<Facet> facets;
  std::vector<Vec3> normals;
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    const auto [a, b, c] = shape.faces[f];
    const Vec3 normal =
        normalized(cross(shape.positions[b] - shape.positions[a], shape.positions[c] - shape.positions[a]));
    if (!looks_at_viewer(normal)) continue;
    facets.push_back(make_facet(shape, f, normal));
    normals.push_back(paint == Paint::kSurfaces ? normalized(patch_normals[shape.patch[f]]) : normal);
  }

  const auto colour = [&](std::size_t i) {
    const auto tinted = [&](const Colour& base) { return mix(base, shade(base, normals[i]), 0.5); };
    switch (paint) {
      case Paint::kPatches: return tinted(colour_of(facets[i].patch));
      case Paint::kSizes: return tinted(colour_of_size(shape, facets[i].face));
      case Paint::kSurfaces: return tinted(shape.colour[shape.surface[facets[i].patch]]);
      case Paint::kLight: break;
    }
    return shade(kMetal, normals[i]);
  };
  for (const std::vector<std::size_t>& run : paint_order(facets)) {
    // In one plane nobody covers anybody: like colours can stand together.
    std::map<std::string, std::vector<std::size_t>> by_colour;
    for (const std::size_t i : run) by_colour[hex(colour(i))].push_back(i);
    for (const auto& [name, alike] : by_colour) {
      const Colour fill = colour(alike.front());
      for (const std::size_t i : alike)
        panel.polygon({facets[i].corners.begin(), facets[i].corners.end()}, fill,
                      paint == Paint::kSurfaces ? fill : mix(fill, kDark, 0.62), mesh_line_width);
    }
    for (const std::size_t i : run) {
      const auto& face = shape.faces[facets[i].face];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto beside = patch_at.find({face[(k + 1) % 3], face[k]});
        if (beside != patch_at.end() && beside->second == facets[i].patch) continue;
        const bool is_weak = paint == Paint::kSurfaces && beside != patch_at.end() &&
                             shape.surface[beside->second] == shape.surface[facets[i].patch];
        panel.line(facets[i].corners[k], facets[i].corners[(k + 1) % 3], is_weak ? mix(colour(i), kDark, 0.5) : kDark,
                   is_weak ? 0.4 : 1.1);
      }
    }
  }
}

}  // namespace remesh::figures
