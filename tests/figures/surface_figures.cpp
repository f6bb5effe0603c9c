#include "tests/figures/surface_figures.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/output/report/surface_words.h"
#include "core/remesh.h"
#include "tests/figures/curved_parts.h"
#include "tests/figures/render.h"
#include "tests/figures/style.h"
#include "tests/figures/svg.h"

namespace remesh::figures {
namespace {

/// Returns the colour of a kind. Neighbours of one kind get different shades.
Colour colour_of(const RecognisedSurface& surface, std::size_t number) {
  const auto base = [&]() -> Colour {
    switch (surface.shape.kind) {
      case SurfaceKind::kPlane: return {0.83, 0.85, 0.87};
      case SurfaceKind::kCylinder: return {0.36, 0.60, 0.85};
      case SurfaceKind::kCone: return {0.95, 0.66, 0.30};
      case SurfaceKind::kSphere: return {0.46, 0.72, 0.42};
      case SurfaceKind::kTorus: return {0.70, 0.50, 0.80};
      case SurfaceKind::kRevolution: return {0.25, 0.70, 0.70};
      case SurfaceKind::kFree: return {0.94, 0.80, 0.78};
    }
    return {};
  };
  const bool is_plain = surface.shape.kind == SurfaceKind::kPlane || surface.shape.kind == SurfaceKind::kFree;
  return mix(base(), {1, 1, 1}, is_plain ? 0 : 0.2 * static_cast<double>(number % 3));
}

/// A part with the surfaces of its facets. The facets are the patches of a run in which they stay.
class SurfacePicture {
 public:
  SurfacePicture(const PolygonMesh& mesh, RunControl& control) {
    Options options;
    options.refine = false;
    options.surface_tolerance = 0;
    Result result = remesh_surface(mesh, options, RunSettings{}, control);
    surfaces_ = std::move(result.report.surfaces);
    shape_.positions = result.mesh.positions.items();
    for (const auto& [a, b, c] : result.mesh.faces) shape_.faces.push_back({a.value, b.value, c.value});
    for (const PatchId p : result.face_patch) shape_.patch.push_back(p.value);
    for (const SurfaceId s : surfaces_.of_patch) shape_.surface.push_back(s.value);
    std::array<std::size_t, 7> numbers{};
    for (const RecognisedSurface& s : surfaces_.surfaces)
      shape_.colour.push_back(colour_of(s, numbers[static_cast<std::size_t>(s.shape.kind)]++));
  }

  void draw_into(Panel& panel) const { draw(shape_, Paint::kSurfaces, 0.6, panel); }

  /// Returns how many surfaces of a kind there are, and of how many facets they are made.
  std::string counted(SurfaceKind kind) const {
    std::size_t surfaces = 0, facets = 0;
    for (const RecognisedSurface& s : surfaces_.surfaces)
      if (s.shape.kind == kind) {
        ++surfaces;
        facets += s.patches;
      }
    const std::string text = count_text(surfaces, kind);
    return kind == SurfaceKind::kPlane ? text : text + " of " + count(facets) + " facets";
  }

  /// Writes the name and the sizes of the surface that is nearest to a point beside the part, with a line to the point.
  /// Input: how far the words are from the point, in the picture.
  void label(const Vec3& point, Vec2 away, Panel& panel) const {
    const Vec2 at = in_picture(point), words = at + away;
    const double length = norm(away);
    panel.line(at, at + ((length - 3.2) / length) * away, kInk, 0.8);
    panel.dot(at, 1.8, kInk);
    panel.label(words, text_of(surfaces_.surfaces[nearest(point)]), kInk);
  }

 private:
  SurfaceId nearest(const Vec3& point) const {
    double least = HUGE_VAL;
    SurfaceId best;
    for (std::size_t f = 0; f < shape_.faces.size(); ++f) {
      const auto [a, b, c] = shape_.faces[f];
      const Vec3 middle = (1.0 / 3) * (shape_.positions[a] + shape_.positions[b] + shape_.positions[c]);
      const double distance = norm(middle - point);
      if (distance >= least) continue;
      least = distance;
      best = SurfaceId(shape_.surface[shape_.patch[f]]);
    }
    return best;
  }

  static std::string text_of(const RecognisedSurface& surface) {
    const AnalyticSurface& s = surface.shape;
    const auto rounded = [](double x) { return number(std::round(100 * x) / 100); };
    switch (s.kind) {
      case SurfaceKind::kCylinder:
      case SurfaceKind::kSphere: return std::string(kind_name(s.kind)) + " r " + rounded(s.radius);
      case SurfaceKind::kCone: return "cone " + rounded(s.half_angle * 180 / std::numbers::pi) + "°";
      case SurfaceKind::kTorus: return "torus R " + rounded(s.radius) + ", r " + rounded(s.minor_radius);
      case SurfaceKind::kPlane:
      case SurfaceKind::kRevolution:
      case SurfaceKind::kFree: break;
    }
    return std::string(kind_name(s.kind));
  }

  Shape shape_;
  RecognisedSurfaces surfaces_;
};

}  // namespace

std::string recognised_surfaces(const PolygonMesh& bracket, RunControl& control) {
  const SurfacePicture of_bracket(bracket, control);
  Panel first("The bracket",
              of_bracket.counted(SurfaceKind::kPlane) + ", " + of_bracket.counted(SurfaceKind::kCylinder));
  of_bracket.draw_into(first);
  const SurfacePicture turned(make_turned_part(), control);
  Panel second("A turned part", "each facet has the colour of its surface");
  turned.draw_into(second);
  // The angles of points around the axis are from the lower right, over the side that is seen, to the top.
  turned.label(turned_point(2.5, 15.5, -20), {2, -22}, second);
  turned.label(turned_point(22, 18, 95), {-10, 16}, second);
  turned.label(turned_point(43.5, 20, -15), {4, -38}, second);
  turned.label(turned_point(46.5, 32, 80), {-24, 18}, second);
  turned.label(turned_point(53, 33, 85), {15, 16}, second);
  turned.label(turned_point(80, 14, -10), {8, -22}, second);
  turned.label(turned_point(118, 14, 85), {-2, 14}, second);
  return to_svg({first, second}, 480, 420);
}

std::string declined_surfaces(RunControl& control) {
  const SurfacePicture shaft(make_flattened_shaft(), control), nut(make_nut(), control),
      ellipsoid(make_ellipsoid(), control);
  std::vector<Panel> panels;
  panels.emplace_back("A shaft with a flat", shaft.counted(SurfaceKind::kCylinder) + ", the flat is a plane");
  shaft.draw_into(panels.back());
  panels.emplace_back("A nut", nut.counted(SurfaceKind::kPlane) + ", " + nut.counted(SurfaceKind::kCylinder));
  nut.draw_into(panels.back());
  panels.emplace_back("An ellipsoid", ellipsoid.counted(SurfaceKind::kFree));
  ellipsoid.draw_into(panels.back());
  return to_svg(panels, 330, 280);
}

}  // namespace remesh::figures
