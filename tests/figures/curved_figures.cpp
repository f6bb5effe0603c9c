#include "tests/figures/curved_figures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/number_text.h"
#include "core/remesh.h"
#include "tests/figures/curved_parts.h"
#include "tests/figures/render.h"
#include "tests/figures/style.h"
#include "tests/figures/svg.h"

namespace remesh::figures {
namespace {

/// A section through a cylinder, with a chain of facets of the input and a coarser one of the result.
class Section {
 public:
  static constexpr double kRadius = 100, kFrom = 22.5, kTo = 157.5;
  static constexpr int kInput = 9, kOutput = 3;

  static Vec2 on_circle(double radius, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }
  static Vec2 corner(int k, int pieces) { return on_circle(kRadius, kFrom + (kTo - kFrom) * k / pieces); }
  static double chord_height(int pieces) {
    return kRadius * (1 - std::cos((kTo - kFrom) / pieces / 2 * std::numbers::pi / 180));
  }
  /// Returns the distance from the axis of the point of a chain that is on the normal at an angle.
  static double height_at(double degrees, int pieces) {
    const double piece = (kTo - kFrom) / pieces;
    const double middle = kFrom + (std::floor((degrees - kFrom) / piece) + 0.5) * piece;
    return (kRadius - chord_height(pieces)) / std::cos((degrees - middle) * std::numbers::pi / 180);
  }

  static void draw_arc(double radius, const Colour& colour, double width, Panel& panel) {
    constexpr int kParts = 90;
    for (int k = 0; k < kParts; ++k)
      panel.line(on_circle(radius, kFrom + (kTo - kFrom) * k / kParts),
                 on_circle(radius, kFrom + (kTo - kFrom) * (k + 1) / kParts), colour, width);
  }
  static void draw_shell(double inner, double outer, Panel& panel) {
    constexpr int kParts = 90;
    std::vector<Vec2> shell;
    for (int k = 0; k <= kParts; ++k) shell.push_back(on_circle(outer, kFrom + (kTo - kFrom) * k / kParts));
    for (int k = kParts; k >= 0; --k) shell.push_back(on_circle(inner, kFrom + (kTo - kFrom) * k / kParts));
    panel.polygon(shell, kPaper, kFaint, 0.6);
  }
  static void draw_chain(int pieces, const Colour& colour, Panel& panel) {
    for (int k = 0; k < pieces; ++k) panel.line(corner(k, pieces), corner(k + 1, pieces), colour, 1.8);
    for (int k = 0; k <= pieces; ++k) panel.dot(corner(k, pieces), 2.4, colour);
  }
};

}  // namespace

std::string elements_per_circle(RunControl& control) {
  constexpr int kSides = 72;
  const PolygonMesh mesh = make_flange(kSides);
  std::vector<Panel> panels;
  for (const int elements : {8, 16, 32}) {
    Options options;
    options.refine = false;
    options.elements_per_circle = elements;
    const Result result = remesh_surface(mesh, options, RunSettings{}, control);
    panels.emplace_back("elements_per_circle " + count(static_cast<std::size_t>(elements)),
                        count(result.mesh.faces.size()) + " triangles, distance at most " +
                            number(std::ceil(100 * result.report.distance_bound->output_to_input) / 100) + " mm");
    draw(shape_of(result), Paint::kLight, 0.5, panels.back());
  }
  return to_svg(panels, 330, 250);
}

std::string coarser_surfaces(RunControl& control) {
  const PolygonMesh mesh = make_stone();
  std::vector<Panel> panels;
  const auto add = [&](const std::string& title, const Options& options) {
    const Result result = remesh_surface(mesh, options, RunSettings{}, control);
    const double apart =
        std::max(result.report.distance_bound->output_to_input, result.report.distance_bound->input_to_output);
    const double angle = std::floor(10 * result.report.output.quality.min_angle_deg) / 10;
    panels.emplace_back(title, count(result.mesh.faces.size()) + " triangles, " + number_text(apart, 2) +
                                   " apart, angles from " + number(angle) + "°");
    draw(shape_of(result), Paint::kLight, 0.4, panels.back());
  };
  Options options;
  options.surface_tolerance = 0;
  add("As scanned", options);
  for (const double tolerance : {0.05, 0.2, 0.6}) {
    options.surface_tolerance = tolerance;
    add("surface_tolerance " + number(tolerance), options);
  }
  return to_svg(panels, 400, 290);
}

std::string proven_distance() {
  const double input = Section::chord_height(Section::kInput), output = Section::chord_height(Section::kOutput);
  const double radius = Section::kRadius;
  Panel shell("Shell", "no point of a facet is deeper than its chord height");
  Section::draw_shell(radius - output, radius, shell);
  Section::draw_arc(radius, kFaint, 1.2, shell);
  Section::draw_chain(Section::kInput, kOuter, shell);
  Section::draw_chain(Section::kOutput, kHole, shell);
  shell.label(Section::on_circle(radius + 14, 42), "surface", mix(kInk, kFaint, 0.4));
  shell.label(Section::on_circle(radius + 8, 90), "chord height of the input " + number(std::round(100 * input) / 100),
              kOuter);
  shell.line(Section::on_circle(radius - output, 90), Section::on_circle(radius, 90), kInk, 1);
  shell.label(Section::on_circle(radius - output - 8, 90),
              "chord height of the result " + number(std::round(100 * output) / 100), kHole);

  Panel pairs("Facing and covering", "each normal meets both chains once");
  Section::draw_shell(radius - output, radius, pairs);
  Section::draw_chain(Section::kInput, kOuter, pairs);
  Section::draw_chain(Section::kOutput, kHole, pairs);
  for (double degrees = Section::kFrom + 4.5; degrees < Section::kTo; degrees += 9) {
    pairs.line(Section::on_circle(radius - output - 6, degrees), Section::on_circle(radius + 6, degrees), kFaint, 0.8);
    const Vec2 of_input = Section::on_circle(Section::height_at(degrees, Section::kInput), degrees);
    const Vec2 of_output = Section::on_circle(Section::height_at(degrees, Section::kOutput), degrees);
    pairs.line(of_input, of_output, kInk, 1.6);
  }
  pairs.label(Section::on_circle(radius + 12, 90), "normals of the surface", mix(kInk, kFaint, 0.4));
  return to_svg({shell, pairs}, 480, 260);
}

}  // namespace remesh::figures
