// Tests circle_fit=volume on models whose volumes and areas are known.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/refinement/goals/unrefined_reason.h"
#include "core/remesh.h"
#include "tests/support/invariance.h"
#include "tests/support/primitives.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

constexpr std::array<double, 4> kElements{8, 12, 16, 36};

Options fitted(double elements, bool is_refined) {
  Options options;
  options.elements_per_circle = elements;
  options.refine = is_refined;
  options.circle_fit = CircleFit::kVolume;
  return options;
}

struct Solid {
  PolygonMesh mesh;
  std::string name;
  double volume;
};

/// A bent pipe: a rod, a quarter of a ring, and a rod. Rings of `n` points are the ends of facets; the bend has `k` of
/// them.
PolygonMesh elbow(int n, int k, double radius, double bend, double rod) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto add_ring = [&](const Vec3& centre, double angle) {
    const Vec3 outwards{-std::cos(angle), 0, std::sin(angle)};
    for (int i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      points.push_back(centre + radius * (std::cos(a) * outwards + std::sin(a) * Vec3{0, -1, 0}));
    }
  };
  add_ring({0, 0, -rod}, 0);
  for (int j = 0; j <= k; ++j) {
    const double angle = std::numbers::pi / 2 * j / k;
    add_ring({bend - bend * std::cos(angle), 0, bend * std::sin(angle)}, angle);
  }
  add_ring({bend + rod, 0, bend}, std::numbers::pi / 2);
  const auto at = [n](int ring, int i) { return static_cast<std::uint32_t>(ring * n + (i + n) % n); };
  for (int ring = 0; ring + 1 < k + 3; ++ring)
    for (int i = 0; i < n; ++i) faces.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)});
  std::vector<std::uint32_t> first, last;
  for (int i = 0; i < n; ++i) {
    first.push_back(at(0, n - 1 - i));
    last.push_back(at(k + 2, i));
  }
  faces.push_back(first);
  faces.push_back(last);
  return shapes::from_lists(points, faces);
}

double frustum_volume(double a, double b, double height) {
  return std::numbers::pi * height / 3 * (a * a + a * b + b * b);
}

std::vector<Solid> solids() {
  std::vector<Solid> all;
  const auto add = [&](const primitives::Model& model, double volume) {
    all.push_back({model.mesh, model.name, volume});
  };
  add(primitives::cylinder(72, 10, 30), std::numbers::pi * 100 * 30);
  add(primitives::cylinder(24, 5, 40, 3), std::numbers::pi * 25 * 40);
  add(primitives::cone(48, 4, 7), frustum_volume(4, 0, 7));
  add(primitives::frustum(48, 4, 1, 7), frustum_volume(4, 1, 7));
  add(primitives::globe(36, 18, 3), 4 * std::numbers::pi / 3 * 27);
  add(primitives::icosphere(3, 3), 4 * std::numbers::pi / 3 * 27);
  add(primitives::torus(48, 48, 24, 5, 2), 2 * std::numbers::pi * 5 * std::numbers::pi * 4);
  add(primitives::countersunk_plate(48), 288 - std::numbers::pi * 1.25 * 1.25 * 0.75 - frustum_volume(1.25, 2.5, 1.25));
  add(primitives::tube(48, 5, 1, 8), std::numbers::pi * (25 - 16) * 8);
  add(primitives::nut(6, 36), (1.5 * std::sqrt(3.0) * 25 - std::numbers::pi * 9) * 3);
  const double missing = std::numbers::pi * 80 / 180;
  add(primitives::d_shaft(36, 8), (std::numbers::pi * 16 - 8 * (missing - std::sin(missing))) * 7);
  add(primitives::rounded_box({4, 3, 2}, 1, 6),
      8 * 24 + 2 * (8 * 6 + 8 * 4 + 6 * 4) + std::numbers::pi * (8 + 6 + 4) + 4 * std::numbers::pi / 3);
  all.push_back({elbow(48, 18, 2, 5, 6), "elbow", std::numbers::pi * 4 * (2 * 6 + 5 * std::numbers::pi / 2)});
  return all;
}

TEST(volume_fit, solids_have_the_volume_of_the_surfaces_that_bound_them) {
  for (const Solid& solid : solids())
    for (const double elements : kElements)
      for (const bool is_refined : {false, true}) {
        SCOPED_TRACE(solid.name + " with " + std::to_string(static_cast<int>(elements)) +
                     (is_refined ? " refined" : " coarse"));
        const Result result = remeshed(solid.mesh, fitted(elements, is_refined), {1, true});
        EXPECT_TRUE(result.report.verified.all_true());
        ASSERT_TRUE(result.report.output.volume.has_value());
        EXPECT_NEAR(*result.report.output.volume, solid.volume, 1e-6 * solid.volume);
        std::size_t outside = 0;
        for (const RecognisedSurface& s : result.report.surfaces.surfaces) {
          if (s.shape.kind == SurfaceKind::kPlane) {
            EXPECT_FALSE(s.outside.has_value());
          }
          outside += s.outside.has_value() ? 1 : 0;
        }
        EXPECT_GT(outside, 0U);
      }
}

TEST(volume_fit, inscribed_vertices_leave_volume_out) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    Options options = fitted(12, true);
    options.circle_fit = CircleFit::kInscribed;
    const Result result = remeshed(solid.mesh, options, {1, true});
    EXPECT_GT(std::fabs(*result.report.output.volume / solid.volume - 1), 1e-3);
  }
}

/// Returns the coordinates and the triangles of a result as text.
std::string bytes(const TriangleMesh& mesh) {
  std::ostringstream out;
  out.precision(17);
  for (const Vec3& p : mesh.positions) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const Triangle& t : mesh.faces) out << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  return out.str();
}

TEST(volume_fit, an_open_surface_keeps_its_area) {
  const primitives::Model pipe = primitives::arc(48, 20, 3, 2);
  const double area = 3 * 2 * 2 * std::numbers::pi * 20 / 48;
  for (const double elements : kElements)
    for (const bool is_refined : {false, true}) {
      const Result result = remeshed(pipe.mesh, fitted(elements, is_refined), {1, true});
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_NEAR(result.report.output.area, area, 1e-9 * area) << elements;
      Options inscribed = fitted(elements, is_refined);
      inscribed.circle_fit = CircleFit::kInscribed;
      EXPECT_LT(remeshed(pipe.mesh, inscribed, {1, true}).report.output.area, area * (1 - 5e-4)) << elements;
    }
}

TEST(volume_fit, a_cylinder_gets_the_radius_of_a_polygon_with_the_same_area) {
  for (const double elements : kElements) {
    const Result result = remeshed(primitives::cylinder(72, 10, 30).mesh, fitted(elements, false), {1, true});
    const double turn = 2 * std::numbers::pi / elements, radius = 10 * std::sqrt(turn / std::sin(turn));
    // The rims have as many vertices as the circle has pieces, at equal distances.
    EXPECT_EQ(result.mesh.positions.size(), 2 * static_cast<std::size_t>(elements));
    for (const Vec3& p : result.mesh.positions) {
      EXPECT_NEAR(std::hypot(p.x, p.y), radius, 1e-9);
      EXPECT_TRUE(std::fabs(p.z) < 1e-12 || std::fabs(p.z - 30) < 1e-12) << "the caps stay planes";
    }
    for (const RecognisedSurface& s : result.report.surfaces.surfaces)
      if (s.shape.kind == SurfaceKind::kCylinder) {
        EXPECT_NEAR(s.outside.value_or(0), radius - 10, 1e-9);
      }
  }
}

TEST(volume_fit, what_is_proven_stays_within_the_tolerance) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    const Result result = remeshed(solid.mesh, fitted(12, true), {1, true});
    double allowed = 0;
    for (const RecognisedSurface& s : result.report.surfaces.surfaces) allowed = std::max(allowed, s.allowed);
    ASSERT_TRUE(result.report.distance_bound.has_value());
    EXPECT_LE(result.report.distance_bound->output_to_input, allowed + result.report.plane_tolerance);
    EXPECT_LE(result.report.distance_bound->input_to_output, allowed + result.report.plane_tolerance);
    EXPECT_EQ(result.report.output.closed, result.report.input.closed);
    EXPECT_EQ(result.report.output.euler, result.report.input.euler);
    // No angle is below the bound but those that are listed.
    for (const Unrefined& listed : result.report.unrefined)
      EXPECT_TRUE(listed.reason == UnrefinedReason::kInputAngle || listed.reason == UnrefinedReason::kAcrossInputAngle)
          << unrefined_name(listed.reason) << " " << listed.count;
  }
}

TEST(volume_fit, vertices_that_must_stay_leave_the_surfaces_inscribed) {
  const PolygonMesh mesh = primitives::cylinder(72, 10, 30).mesh;
  const auto expect_inscribed = [&](Options options) {
    const Result outside = remeshed(mesh, options, {1, true});
    for (const RecognisedSurface& s : outside.report.surfaces.surfaces) EXPECT_FALSE(s.outside.has_value());
    options.circle_fit = CircleFit::kInscribed;
    EXPECT_TRUE(bytes(outside.mesh) == bytes(remeshed(mesh, options, {1, true}).mesh));
  };
  Options options = fitted(12, true);
  options.split_boundaries = false;
  expect_inscribed(options);
  options = fitted(12, true);
  options.keep_boundary_vertices = true;
  expect_inscribed(options);
  // Without a number of elements or a tolerance, nothing is curved.
  options = fitted(12, true);
  options.elements_per_circle.reset();
  options.coarsens_fine_facets = false;
  expect_inscribed(options);
}

STAGE(volume_fit, test::kWorkers, test::kScale) {
  for (const primitives::Model& model : {primitives::countersunk_plate(48), primitives::globe(36, 18, 3)})
    trial.mesh(remeshed(trial.of(model.mesh), fitted(16, true), {trial.workers, true}).mesh);
}

}  // namespace
}  // namespace remesh
