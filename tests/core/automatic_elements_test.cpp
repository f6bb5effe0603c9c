// Tests elements_per_circle=auto on models of which the number of facets per turn is known, and that larger tolerances
// and fewer elements never lead to more faces.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/io/obj/obj.h"
#include "core/remesh.h"
#include "tests/support/own_meshes.h"
#include "tests/support/primitives.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using testing::HasSubstr;

Options without_elements() {
  Options options;
  options.coarsens_fine_facets = false;
  return options;
}

std::vector<RecognisedSurface> curved_surfaces(const Report& report) {
  std::vector<RecognisedSurface> curved;
  for (const RecognisedSurface& s : report.surfaces.surfaces)
    if (s.shape.kind != SurfaceKind::kPlane && s.shape.kind != SurfaceKind::kFree) curved.push_back(s);
  return curved;
}

/// Returns the measures of all curved surfaces, from small to large.
std::vector<double> facets_per_turn(const PolygonMesh& mesh) {
  RunControl control;
  std::vector<double> found;
  for (const RecognisedSurface& s : curved_surfaces(analyze_surface(mesh, {}, {}, control)))
    found.push_back(s.facets_per_turn);
  std::sort(found.begin(), found.end());
  return found;
}

std::string obj_of(const Result& result) {
  RunControl control;
  return write_obj(result.mesh, {}, control);
}

PolygonMesh own_bracket() {
  std::ifstream file(test::own_meshes_folder() / "bracket.obj", std::ios::binary);
  RunControl control;
  return read_obj(std::string(std::istreambuf_iterator<char>(file), {}), {}, control).mesh;
}

/// Rounds coordinates to a number of significant digits of the largest one.
PolygonMesh rounded_to_digits(const PolygonMesh& mesh, int digits) {
  double largest = 0;
  for (const Vec3& p : mesh.positions) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return shapes::rounded(mesh, std::pow(10.0, std::floor(std::log10(largest)) + 1 - digits));
}

/// Makes two discs on one axis, with a gap between them. Their sides lie on one cylinder, with other numbers of facets.
PolygonMesh two_discs(int coarse, int fine) {
  PolygonMesh above = shapes::cylinder(fine, 10, 5);
  for (Vec3& p : above.positions) p.z += 10;
  return shapes::joined(shapes::cylinder(coarse, 10, 5), above);
}

TEST(automatic_elements, parts_of_one_cylinder_may_have_other_numbers_of_facets) {
  // Coarse facets explain a larger distance than fine ones do. No result is that far from the latter.
  for (const std::optional<double> elements : {std::optional<double>(), std::optional<double>(12)}) {
    Options options;
    options.elements_per_circle = elements;
    const Result result = remeshed(two_discs(24, 96), options);
    EXPECT_EQ(curved_surfaces(result.report).size(), 1u);
    for (const PatchSummary& patch : result.report.patches) EXPECT_EQ(patch.status, PatchStatus::kRemeshed);
    EXPECT_LE(result.mesh.faces.size(), 300u);  // 1,358 if the fine disc keeps its facets
  }
}

TEST(automatic_elements, facets_per_turn_are_those_of_the_direction_in_which_they_are_fewest) {
  struct Case {
    primitives::Model model;
    double expected;
  };
  const Case cases[] = {{primitives::cylinder(48, 10, 30), 48},
                        {primitives::cylinder(40, 10, 30, 3), 40},
                        {primitives::cone(44, 4, 7), 44},
                        // The normals of a flat cone turn by little, but its facets are those of a full turn.
                        {primitives::frustum(28, 10, 4, 1), 28},
                        {primitives::arc(64, 20, 3, 2), 64},
                        {primitives::torus(48, 48, 20, 5, 2), 20},
                        {primitives::torus(24, 24, 60, 5, 2), 24}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.model.name);
    for (const primitives::Model& model : {c.model, primitives::triangulated(c.model)}) {
      const std::vector<double> found = facets_per_turn(model.mesh);
      ASSERT_EQ(found.size(), 1u);
      EXPECT_NEAR(found[0], c.expected, 0.01 * c.expected);
    }
  }
  // A ball of longitudes and latitudes has 40 facets along a meridian, and 24 around its equator.
  const std::vector<double> along = facets_per_turn(primitives::globe(80, 20, 3).mesh);
  ASSERT_EQ(along.size(), 1u);
  EXPECT_NEAR(along[0], 40, 0.8);
}

TEST(automatic_elements, only_surfaces_with_more_than_32_facets_per_turn_are_remeshed_with_24_edges) {
  for (const int n : {16, 24, 32, 33, 48, 64}) {
    SCOPED_TRACE(n);
    const PolygonMesh mesh = primitives::cylinder(n, 10, 6).mesh;
    const Result result = remeshed(mesh, Options{});
    const std::vector<RecognisedSurface> curved = curved_surfaces(result.report);
    ASSERT_EQ(curved.size(), 1u);
    EXPECT_NEAR(curved[0].facets_per_turn, n, 1e-6 * n);
    EXPECT_EQ(curved[0].is_remeshed, n > 32);
    EXPECT_TRUE(result.report.verified.all_true());
    if (n <= 32) {
      EXPECT_EQ(curved[0].elements_per_circle, std::nullopt);
      EXPECT_EQ(curved[0].allowed, 0);
      EXPECT_LE(curved[0].bound, result.report.plane_tolerance);
      EXPECT_EQ(obj_of(result), obj_of(remeshed(mesh, without_elements())));
      continue;
    }
    EXPECT_EQ(curved[0].elements_per_circle, 24);
    Options options;
    options.elements_per_circle = 24;
    EXPECT_EQ(obj_of(result), obj_of(remeshed(mesh, options)));
    // The facets are off by r (1 - cos(pi / n)), and the new edges by as much with 24.
    const double r = curved[0].shape.radius, pi = std::numbers::pi;
    EXPECT_LE(curved[0].bound, 1.001 * r * (2 - std::cos(pi / 24) - std::cos(pi / n)));
    EXPECT_LT(result.mesh.faces.size(), remeshed(mesh, without_elements()).mesh.faces.size());
  }
}

/// Returns a mesh turned to several directions, each scaled and rounded to 4 to 7 digits.
std::vector<PolygonMesh> variants_of(const PolygonMesh& mesh) {
  std::vector<PolygonMesh> variants;
  for (const double degrees : {0.0, 12.3, 77.7}) {
    const PolygonMesh turned = shapes::rotated(mesh, {0.3, -0.5, 0.8}, degrees);
    variants.push_back(shapes::scaled(turned, 0.0371));
    for (const int digits : {4, 5, 6, 7}) variants.push_back(rounded_to_digits(turned, digits));
  }
  return variants;
}

TEST(automatic_elements, the_decision_is_the_same_if_a_part_is_turned_scaled_or_rounded) {
  for (const int n : {31, 32, 33, 34}) {
    for (const primitives::Model& model :
         {primitives::cylinder(n, 10, 6), primitives::cone(n, 10, 8), primitives::nut(6, n),
          primitives::tube(n, 10, 2, 8), primitives::frustum(n, 10, 4, 1)}) {
      SCOPED_TRACE(model.name);
      for (const PolygonMesh& variant : variants_of(model.mesh)) {
        RunControl control;
        std::size_t whole = 0;
        for (const RecognisedSurface& s : curved_surfaces(analyze_surface(variant, {}, {}, control))) {
          // Rounding may bend the planes at the ends into something that is nearly flat. It has no number.
          if (s.facets_per_turn == 0) continue;
          if (n <= 32) {
            EXPECT_LE(s.facets_per_turn, 32.5);
          }
          if (s.sweep_deg < 300) continue;
          ++whole;
          EXPECT_EQ(s.facets_per_turn > 32.5, n > 32) << "measured " << s.facets_per_turn;
          EXPECT_NEAR(s.facets_per_turn, n, 0.015 * n);
        }
        EXPECT_GE(whole, 1u);
      }
    }
  }
}

TEST(automatic_elements, facets_that_rounding_has_joined_to_planes_count_as_the_facets_they_were) {
  // The chord height of these facets is a quarter of a step of the last digit. Two of them are one plane by then.
  const PolygonMesh plate = primitives::nut(4, 64, 0.2).mesh;
  for (const PolygonMesh& variant : variants_of(plate)) {
    const std::vector<double> found = facets_per_turn(variant);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0], 64, 2);
  }
}

TEST(automatic_elements, it_does_not_act_where_something_else_says_how_curved_surfaces_are_divided) {
  const PolygonMesh mesh = primitives::nut(6, 48).mesh;
  const auto changed = [](const auto& change) {
    Options options;
    change(options);
    return options;
  };
  const Options all[] = {changed([](Options& o) { o.surface_tolerance = 0; }),
                         changed([](Options& o) { o.surface_tolerance = 1e-6; }),
                         changed([](Options& o) { o.surface_tolerance_fraction = 1e-7; }),
                         changed([](Options& o) { o.refine = false; }),
                         changed([](Options& o) { o.split_boundaries = false; }),
                         changed([](Options& o) { o.keep_boundary_vertices = true; }),
                         changed([](Options& o) { o.coarsens_fine_facets = false; }),
                         changed([](Options& o) { o.feature_angle_deg = 0; })};
  for (const Options& options : all) {
    const Report report = remeshed(mesh, options).report;
    for (const RecognisedSurface& s : report.surfaces.surfaces) {
      EXPECT_FALSE(s.is_remeshed);
      EXPECT_LE(s.bound, report.plane_tolerance);
    }
  }
}

TEST(automatic_elements, a_diagnostic_tells_what_was_done_and_how_to_avoid_it) {
  const auto told = [](const PolygonMesh& mesh, const Options& options) {
    std::string all;
    for (const Diagnostic& d : remeshed(mesh, options).report.diagnostics)
      if (d.code == DiagnosticCode::kCurvedSurface) all += d.message + "\n";
    return all;
  };
  // A prism with 48 sides on a circle of radius 10 has the volume n / 2 sin(2 pi / n) r^2 h, and so has one of 24.
  const PolygonMesh shaft = primitives::cylinder(48, 10, 2).mesh;
  const std::string message = told(shaft, {});
  EXPECT_THAT(message,
              HasSubstr("elements_per_circle=auto remeshed 1 cylinder, which has more than 32 facets per turn, "
                        "with 24 edges per turn"));
  EXPECT_THAT(message, HasSubstr("the volume was 626.5257 and is 621.1657"));
  EXPECT_THAT(message, HasSubstr("elements_per_circle=none or preset=exact keeps the facets"));
  EXPECT_THAT(message, HasSubstr("circle_fit=volume keeps the volume"));
  EXPECT_THAT(told(shaft, without_elements()), testing::Not(HasSubstr("auto")));
  EXPECT_THAT(told(primitives::cylinder(32, 10, 2).mesh, {}), testing::Not(HasSubstr("auto")));
  Options given;
  given.elements_per_circle = 24;
  EXPECT_EQ(told(shaft, given), "");
}

TEST(automatic_elements, a_boundary_beside_a_surface_that_keeps_its_facets_keeps_all_its_vertices) {
  // A torus of 96 facets around its axis has only 16 around its tube, and keeps them.
  const primitives::Model model = primitives::torus(96, 96, 16, 10, 2);
  const Result result = remeshed(model.mesh, Options{});
  for (const RecognisedSurface& s : curved_surfaces(result.report)) EXPECT_FALSE(s.is_remeshed);
  // A shaft of 64 facets ends in a frustum of 16.
  std::vector<Vec3> positions;
  const int fine = 64, coarse = 16;
  const auto at = [](int i, int n, double r, double z) {
    const double angle = 2 * std::numbers::pi * i / n;
    return Vec3{r * std::cos(angle), r * std::sin(angle), z};
  };
  for (int i = 0; i < fine; ++i) positions.push_back(at(i, fine, 10, 0));
  for (int i = 0; i < fine; ++i) positions.push_back(at(i, fine, 10, 5));
  for (int i = 0; i < coarse; ++i) positions.push_back(at(i, coarse, 6, 12));
  const auto vertex = [](int i) { return static_cast<std::uint32_t>(i); };
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < fine; ++i) {
    const int j = (i + 1) % fine;
    faces.push_back({vertex(i), vertex(j), vertex(fine + j), vertex(fine + i)});
  }
  std::vector<std::uint32_t> bottom, top;
  for (int i = fine - 1; i >= 0; --i) bottom.push_back(vertex(i));
  for (int i = 0; i < coarse; ++i) top.push_back(vertex(2 * fine + i));
  faces.push_back(bottom);
  faces.push_back(top);
  for (int i = 0; i < coarse; ++i) {
    const int j = (i + 1) % coarse, step = fine / coarse;
    for (int k = 0; k < step; ++k)
      faces.push_back({vertex(fine + i * step + k), vertex(fine + (i * step + k + 1) % fine), vertex(2 * fine + i)});
    faces.push_back({vertex(fine + (i + 1) * step % fine), vertex(2 * fine + j), vertex(2 * fine + i)});
  }
  const Result mixed = remeshed(shapes::from_lists(positions, faces), Options{});
  EXPECT_TRUE(mixed.report.verified.all_true());
  std::set<Vec3> places(mixed.mesh.positions.begin(), mixed.mesh.positions.end());
  for (int i = 0; i < fine; ++i) EXPECT_EQ(places.count(at(i, fine, 10, 5)), 1u) << i;
  std::size_t at_bottom = 0;
  for (int i = 0; i < fine; ++i) at_bottom += places.count(at(i, fine, 10, 0));
  EXPECT_LT(at_bottom, static_cast<std::size_t>(fine)) << "the other end of the shaft is remeshed";
}

/// Expects that a row of results does not rise by more than 2 %.
void expect_never_more(const PolygonMesh& mesh, const std::vector<Options>& row) {
  std::size_t fewest = remeshed(mesh, row.front()).mesh.faces.size();
  for (std::size_t i = 1; i < row.size(); ++i) {
    const std::size_t faces = remeshed(mesh, row[i]).mesh.faces.size();
    EXPECT_LE(static_cast<double>(faces), 1.02 * static_cast<double>(fewest))
        << "tolerance " << row[i].surface_tolerance_fraction.value_or(0) << ", elements "
        << row[i].elements_per_circle.value_or(0);
    fewest = std::min(fewest, faces);
  }
}

TEST(automatic_elements, a_larger_tolerance_or_fewer_elements_never_give_more_faces) {
  for (const primitives::Model& model :
       {primitives::cylinder(50, 1.5, 10), primitives::cylinder(36, 5, 30), primitives::nut(6, 36),
        primitives::frustum(48, 4, 1, 7), primitives::countersunk_plate(48)}) {
    SCOPED_TRACE(model.name);
    for (const bool refine : {false, true}) {
      Options options;
      options.refine = refine;
      std::vector<Options> tolerances, elements;
      for (int i = 0; i < 12; ++i) {
        tolerances.push_back(options);
        tolerances.back().surface_tolerance_fraction = std::pow(10.0, -5 + 4.0 * i / 11);
      }
      // Coarser rims of a plate's bore may have sharper corners beside them, so few elements are for round parts.
      for (const double n : {64, 50, 36, 24, 16, 12, 8, 4}) {
        if (n < 12 && model.name.starts_with("nut")) continue;
        elements.push_back(options);
        elements.back().elements_per_circle = n;
      }
      expect_never_more(model.mesh, tolerances);
      expect_never_more(model.mesh, elements);
    }
  }
}

TEST(automatic_elements, more_edges_than_facets_make_a_surface_finer) {
  const double height = 10;
  const PolygonMesh shaft = shapes::cylinder(24, 5, height);
  std::size_t fewer = 0;
  for (const double elements : {12.0, 24.0, 48.0, 96.0}) {
    Options options;
    options.elements_per_circle = elements;
    const Result result = remeshed(shaft, options);
    EXPECT_GE(result.mesh.faces.size(), fewer) << elements;
    fewer = result.mesh.faces.size();
    // Rounding, and where edges of different lengths meet, cost little: it is at least a prism of nearly as many sides.
    const double sides = 0.9 * elements;
    const double prism = sides / 2 * 25 * std::sin(2 * std::numbers::pi / sides) * height;
    EXPECT_GE(*result.report.output.volume, prism * (1 - 1e-9)) << elements;
  }
}

TEST(automatic_elements, facets_of_the_bracket_stay_where_they_are_coarser) {
  const PolygonMesh bracket = own_bracket();
  Options options;
  options.refine = false;
  const std::size_t facets = remeshed(bracket, options).mesh.faces.size();
  EXPECT_EQ(facets, 464u);
  for (const double tolerance : {0.03, 0.05, 0.07, 0.1, 0.3}) {
    options.surface_tolerance = tolerance;
    EXPECT_LE(remeshed(bracket, options).mesh.faces.size(), facets) << tolerance;
  }
}

TEST(elements_per_circle, corners_that_an_exporter_put_off_the_surface_cost_no_edges) {
  // The rim of 50 edges is divided into as many edges as are asked for, whether or not the corners are exact.
  for (const double off : {0.0, 2e-6, 1e-5}) {
    PolygonMesh mesh = shapes::cylinder(50, 1.5, 10);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      Vec3& p = mesh.positions[VertexId(v)];
      const double factor = 1 - off * static_cast<double>(v % 3) / 3;
      p.x *= factor;
      p.y *= factor;
    }
    Options options;
    options.elements_per_circle = 16;
    const Result result = remeshed(mesh, options);
    ASSERT_TRUE(result.report.verified.all_true());
    std::size_t at_rim = 0;
    for (const Vec3& p : result.mesh.positions) at_rim += std::fabs(p.z) < 1e-9 && std::hypot(p.x, p.y) > 1.49 ? 1 : 0;
    EXPECT_EQ(at_rim, 16u) << off;
  }
}

}  // namespace
}  // namespace remesh
