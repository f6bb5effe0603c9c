// Tests recognition on models whose surfaces are known: all of them must be found, and nothing else.

#include "core/patches/recognition/surface_recognition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "tests/support/claims.h"
#include "tests/support/invariance.h"
#include "tests/support/model_claims.h"
#include "tests/support/plain_surfaces.h"
#include "tests/support/primitives.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using primitives::Model;
using test::Claims;

/// Rounding has to be this much smaller than the facets are high over their surface.
constexpr double kMinChordSteps = 10;

Claims claims_of(const PolygonMesh& mesh, int workers = 1, const Options& options = {}) {
  RunControl control;
  return test::claims_of(mesh, control, workers, options);
}

std::size_t curved_faces(const PolygonMesh& mesh, const Claims& claims) {
  std::size_t count = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) count += claims.is_curved(FaceId(f)) ? 1 : 0;
  return count;
}

std::size_t curved_surfaces(const Claims& claims) {
  return static_cast<std::size_t>(
      std::count_if(claims.surfaces().begin(), claims.surfaces().end(), [](const RecognisedSurface& s) {
        return s.shape.kind != SurfaceKind::kPlane && s.shape.kind != SurfaceKind::kFree;
      }));
}

void expect_explained(const Model& model, double step) {
  SCOPED_TRACE(model.name);
  const Claims claims = claims_of(model.mesh);
  for (const std::string& fault : test::faults_of(model, claims, step)) ADD_FAILURE() << fault;
}

/// Expects that a variant of every model is explained, if its rounding leaves the facets as they are.
void expect_all_explained(const primitives::Variant& variant) {
  int tested = 0;
  for (const Model& model : primitives::explained()) {
    double step = 0;
    const Model moved = primitives::varied(model, variant, &step);
    if (primitives::lowest_chord_height(model) < kMinChordSteps * step) continue;
    // With wide tolerances, some bands of a surface of revolution are nearly pieces of tori. They break its chain.
    const bool is_coarse =
        variant.storage == primitives::Storage::kSixDigits || variant.storage == primitives::Storage::kNoisyDoubles;
    if (is_coarse && model.name.starts_with("vase")) continue;
    // Noise above the plane tolerance cuts a flat ring into long pieces, which may as well be planes.
    if (variant.storage == primitives::Storage::kNoisyDoubles && model.name.starts_with("torus with flat")) continue;
    // Noise above the plane tolerance bends subdivided facets, so vertices in their middles become corners of facets.
    if (variant.storage == primitives::Storage::kNoisyDoubles && model.name.find("subdivided") != std::string::npos)
      continue;
    expect_explained(moved, step);
    ++tested;
  }
  EXPECT_GT(tested, 40);
}

class surface_recognition_of_models : public testing::TestWithParam<primitives::Variant> {};

TEST_P(surface_recognition_of_models, every_face_has_its_surface) { expect_all_explained(GetParam()); }

INSTANTIATE_TEST_SUITE_P(variants, surface_recognition_of_models, testing::ValuesIn(primitives::variants()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return c == ' ' || c == ','; }, '_');
                           return name;
                         });

TEST(surface_recognition, what_only_looks_curved_stays_planes) {
  for (const Model& model : primitives::declined())
    for (const primitives::Variant& variant : primitives::variants()) {
      double step = 0;
      const Model moved = primitives::varied(model, variant, &step);
      SCOPED_TRACE(moved.name);
      EXPECT_EQ(curved_faces(moved.mesh, claims_of(moved.mesh)), 0u);
    }
}

TEST(surface_recognition, a_thread_has_at_most_ten_cylinders_and_cones) {
  const Claims claims = claims_of(primitives::thread(48, 8).mesh);
  EXPECT_GE(curved_surfaces(claims), 2u);
  EXPECT_LE(curved_surfaces(claims), 10u);
}

TEST(surface_recognition, equal_surfaces_of_two_bodies_are_one_record) {
  for (const Model& model : {primitives::plates_with_a_common_bore(36), primitives::pin_in_its_bore(36)}) {
    SCOPED_TRACE(model.name);
    const Claims claims = claims_of(model.mesh);
    std::size_t bores = 0;
    for (const RecognisedSurface& s : claims.surfaces())
      if (s.shape.kind == SurfaceKind::kCylinder && std::fabs(s.shape.radius - 2) < 1e-9) ++bores;
    EXPECT_EQ(bores, 1u);
  }
}

TEST(surface_recognition, two_halves_with_different_labels_are_one_cylinder) {
  Model model = primitives::cylinder(24, 8, 20);
  model.mesh.labels.group.names = {"a", "b"};
  for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) model.mesh.labels.group.of_face.push_back(f < 12 ? 0 : 1);
  expect_explained(model, 1e-11);
}

TEST(surface_recognition, only_edges_below_the_feature_angle_are_smooth) {
  Options options;
  for (const auto& [angle, is_found] : {std::pair{0.0, false}, {14.0, false}, {16.0, true}, {60.0, true}}) {
    options.feature_angle_deg = angle;
    const Model model = primitives::cylinder(24, 8, 20);
    EXPECT_EQ(curved_faces(model.mesh, claims_of(model.mesh, 1, options)), is_found ? 24u : 0u) << angle;
  }
  // The edges of twelve facets turn by the default angle itself, so a larger one is needed.
  options.feature_angle_deg = 31;
  const Model twelve = primitives::cylinder(12, 8, 20);
  EXPECT_EQ(curved_faces(twelve.mesh, claims_of(twelve.mesh, 1, options)), 12u);
  options.feature_angle_deg = 29;
  EXPECT_EQ(curved_faces(twelve.mesh, claims_of(twelve.mesh, 1, options)), 0u);
}

TEST(surface_recognition, vertices_that_have_to_stay_do_not_hide_a_surface) {
  Options options;
  options.keep_boundary_vertices = true;
  const Model model = primitives::subdivided(primitives::cylinder(24, 8, 20));
  for (const std::string& fault : test::faults_of(model, claims_of(model.mesh, 1, options), 1e-11))
    ADD_FAILURE() << fault;
}

// The following tests expect the same surfaces for any order of faces, any number of workers and any scale.

/// Returns the models for which the bits are compared: each kind, and a part with several of them.
std::vector<Model> models_of_each_kind() {
  std::vector<Model> models{primitives::cylinder(37, 8, 20),
                            primitives::cone(24, 5, 9),
                            primitives::icosphere(2, 7),
                            primitives::torus(24, 24, 16, 8, 3),
                            primitives::vase(40, 24),
                            primitives::rounded_box({5, 3, 2}, 1.5, 4),
                            primitives::countersunk_plate(24),
                            primitives::thread(48, 4),
                            primitives::pin_in_its_bore(36),
                            primitives::tee(48),
                            primitives::planks("planks", {28, 9, 9, 26, 9, 9})};
  const std::size_t exact = models.size();
  for (std::size_t i = 0; i < exact; ++i)
    models.push_back(
        primitives::varied(models[i], {"floats, rotated", primitives::Storage::kFloats, true, false}, nullptr));
  return models;
}

/// Returns the bits of all parameters of a surface. Lengths are divided by `scale`, which is a power of two.
std::vector<std::uint64_t> bits_of(const RecognisedSurface& s, double scale = 1) {
  std::vector<double> numbers{static_cast<double>(s.shape.kind),
                              s.shape.half_angle,
                              s.sweep_deg,
                              s.input_turn_deg,
                              static_cast<double>(s.side),
                              static_cast<double>(s.reason),
                              static_cast<double>(s.faces)};
  for (const double length :
       {s.shape.origin.x, s.shape.origin.y, s.shape.origin.z, s.shape.radius, s.shape.minor_radius,
        s.input_chord_height, s.tolerance, s.deviation, s.extent.min.x, s.extent.max.z})
    numbers.push_back(length / scale);
  for (int axis = 0; axis < 3; ++axis) numbers.push_back(s.shape.axis[axis]);
  for (const Vec2 p : s.profile) {
    numbers.push_back(p.x / scale);
    numbers.push_back(p.y / scale);
  }
  std::vector<std::uint64_t> bits;
  // Adding 0 makes both zeros one.
  for (const double n : numbers) bits.push_back(std::bit_cast<std::uint64_t>(n + 0.0));
  return bits;
}

STAGE(surface_recognition, test::kWorkers, test::kScale, test::kNumbering) {
  std::vector<Model> models = models_of_each_kind();
  models.push_back(primitives::icosphere(4, 7));
  models.push_back(primitives::cylinder(5000, 7, 10, 3));
  for (const Model& model : models) {
    const PolygonMesh mesh = trial.of(model.mesh);
    const Claims claims = claims_of(mesh, trial.workers);
    for (const RecognisedSurface& s : claims.surfaces()) {
      trial.same(kind_name(s.shape.kind));
      // Planes are those of the patches, whose last bits depend on the order of the faces.
      if (s.shape.kind != SurfaceKind::kPlane) trial.same(bits_of(s, trial.scale));
      if (s.shape.kind == SurfaceKind::kPlane) trial.in_order(s.shape.axis);
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      trial.face(test::corners_of(mesh, FaceId(f)), std::to_string(claims.surface_of(FaceId(f)).value));
  }
}

TEST(surface_recognition, an_analysis_tells_the_same_surfaces_as_a_run) {
  for (const Model& model : models_of_each_kind()) {
    SCOPED_TRACE(model.name);
    RunControl control;
    const Claims claims = claims_of(model.mesh);
    const Report report = analyze_surface(model.mesh, {}, {}, control);
    ASSERT_EQ(claims.surfaces().size(), report.surfaces.surfaces.size());
    for (std::uint32_t s = 0; s < claims.surfaces().size(); ++s)
      EXPECT_EQ(bits_of(claims.surfaces()[SurfaceId(s)]), bits_of(report.surfaces.surfaces[SurfaceId(s)]));
  }
}

/// Rounds all coordinates of a mesh to multiples of a step.
PolygonMesh rounded_to(PolygonMesh mesh, double step) {
  for (Vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::nearbyint(p[axis] / step) * step;
  return mesh;
}

TEST(surface_recognition, bores_with_few_decimals_are_cylinders) {
  Random random(20261128);
  int found = 0, drawn = 0;
  while (drawn < 60) {
    const int n = random.integer(13, 52);
    const double radius = random.uniform(2, 10), wall = radius * random.uniform(0.1, 0.5);
    const Model model = primitives::tube(n, radius, wall, radius * random.uniform(0.3, 3));
    const double diagonal = 2 * std::numbers::sqrt2 * radius;
    // The chord height is at least four steps. The step is a power of ten, as for decimals.
    const double step = std::pow(10, std::floor(std::log10(2e-5 * diagonal)));
    if ((radius - wall) * (1 - std::cos(std::numbers::pi / n)) < 4 * step) continue;
    ++drawn;
    const Claims claims = claims_of(rounded_to(model.mesh, step));
    const auto is_right = [&](const RecognisedSurface& s) {
      return s.shape.kind == SurfaceKind::kCylinder && (std::fabs(s.shape.radius - radius) < 1e-3 * radius ||
                                                        std::fabs(s.shape.radius - radius + wall) < 1e-3 * radius);
    };
    if (curved_surfaces(claims) == 2 &&
        std::count_if(claims.surfaces().begin(), claims.surfaces().end(), is_right) == 2)
      ++found;
  }
  EXPECT_GE(found, 59);
}

TEST(surface_recognition, corners_beside_their_cylinder_are_found_with_their_distance) {
  // Some programs put corners off the surface, here by up to a tenth of the chord height.
  Random random(7);
  for (const int n : {24, 36, 48}) {
    Model model = primitives::cylinder(n, 10, 12);
    const double height = 10 * (1 - std::cos(std::numbers::pi / n));
    double off = 0;
    for (Vec3& p : model.mesh.positions) {
      const double by = random.uniform(-0.1, 0.1) * height;
      off = std::max(off, std::fabs(by));
      p.x *= 1 + by / 10;
      p.y *= 1 + by / 10;
    }
    const Claims claims = claims_of(model.mesh);
    ASSERT_EQ(curved_surfaces(claims), 1u) << n;
    for (const RecognisedSurface& s : claims.surfaces()) {
      if (s.shape.kind != SurfaceKind::kCylinder) continue;
      EXPECT_NEAR(s.shape.radius, 10, off) << n;
      EXPECT_LE(s.deviation, 2 * off) << n;
      EXPECT_GE(s.deviation, 0.2 * off) << n;
      EXPECT_LE(s.deviation, s.tolerance) << n;
    }
  }
}

TEST(surface_recognition, nearly_round_tubes_are_no_cylinders) {
  // An ellipse with axes of 1.02 : 1 and a boss that tapers by half a degree.
  Model ellipse = primitives::cylinder(32, 10, 12), boss = primitives::frustum(32, 10, 10 - 12 * std::tan(0.00873), 12);
  for (Vec3& p : ellipse.mesh.positions) p.x *= 1.02;
  for (const Model* model : {&ellipse, &boss}) {
    const Claims claims = claims_of(model->mesh);
    for (const RecognisedSurface& s : claims.surfaces()) EXPECT_NE(s.shape.kind, SurfaceKind::kCylinder) << model->name;
  }
}

/// Makes a closed tube of this radius along a curve, from rings about points of it.
/// Input: `at` - the i-th point; `along` - the direction of the curve there. Both are in the plane of x and y.
template <class At, class Along>
PolygonMesh tube_along(int rings, int around, double radius, const At& at, const Along& along) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < rings; ++i) {
    const Vec3 direction = along(i), across = {-direction.y, direction.x, 0};
    for (int j = 0; j < around; ++j) {
      const double a = 2 * std::numbers::pi * j / around;
      positions.push_back(at(i) + (radius * std::cos(a)) * across + Vec3{0, 0, radius * std::sin(a)});
    }
  }
  const auto n = static_cast<std::uint32_t>(around), last = static_cast<std::uint32_t>(rings - 1) * n;
  std::vector<std::uint32_t> first_cap, last_cap;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t a = j; a < last; a += n) {
      const std::uint32_t b = a - j + (j + 1) % n;
      faces.push_back({a, a + n, b + n});
      faces.push_back({a, b + n, b});
    }
    first_cap.push_back(j);
    last_cap.push_back(last + n - 1 - j);
  }
  faces.push_back(first_cap);
  faces.push_back(last_cap);
  return shapes::from_lists(positions, faces);
}

/// A tube along one period of a sine. No two of its rings lie on a surface of a kind.
struct Hose {
  int rings, around;
  double radius, length, wave;

  double angle(double i) const { return 2 * std::numbers::pi * i / (rings - 1); }
  Vec3 at(double i) const { return {length * i / (rings - 1), wave * std::sin(angle(i)), 0}; }
  Vec3 along(double i) const { return normalized({1, 2 * std::numbers::pi * wave / length * std::cos(angle(i)), 0}); }
  /// Returns a point of the tube.
  Vec3 point(double i, double j) const {
    const Vec3 direction = along(i), across = {-direction.y, direction.x, 0};
    const double a = 2 * std::numbers::pi * j / around;
    return at(i) + (radius * std::cos(a)) * across + Vec3{0, 0, radius * std::sin(a)};
  }
  PolygonMesh mesh() const {
    return tube_along(
        rings, around, radius, [&](int i) { return at(i); }, [&](int i) { return along(i); });
  }
};

TEST(surface_recognition, the_ring_of_a_bore_is_no_barrel_and_no_ring_of_a_hose_is_a_ball) {
  EXPECT_EQ(curved_surfaces(claims_of(Hose{23, 16, 2, 10 * std::numbers::pi, 6}.mesh())), 0u);
}

TEST(surface_recognition, no_row_of_a_hose_is_claimed_as_what_it_is_not_however_it_is_rounded) {
  // Two rings lie on a cylinder up to rounding, and three on a torus. In its middle, the hose is farther from these.
  for (const double step : {0.0, 1e-6, 1e-5, 1e-4, 1e-3})
    for (const int rings : {12, 20, 40}) {
      const Hose hose{rings, 24, 1, 20, 1.5};
      const Claims claims = claims_of(step > 0 ? rounded_to(hose.mesh(), step) : hose.mesh());
      IdVector<SurfaceId, double> farthest(claims.surfaces().size(), 0);
      for (int j = 0; j < hose.around; ++j)
        for (int i = 0; i + 1 < rings; ++i)
          for (const int half : {0, 1}) {
            const FaceId f(static_cast<std::size_t>(2 * (j * (rings - 1) + i) + half));
            if (!claims.is_curved(f)) continue;
            const SurfaceId s = claims.surface_of(f);
            farthest[s] =
                std::max(farthest[s], test::plain(claims.surfaces()[s]).distance(hose.point(i + 0.5, j + 0.5)));
          }
      for (std::uint32_t s = 0; s < claims.surfaces().size(); ++s)
        EXPECT_LE(farthest[SurfaceId(s)], claims.surfaces()[SurfaceId(s)].deviation + 3 * step + 1e-9)
            << rings << " " << step;
    }
}

TEST(surface_recognition, a_pipe_with_bends_of_two_rows_keeps_its_cylinders_and_tori) {
  // Straight for 12, to the left by 30 degrees about a point 5 away, straight for 12, and to the right again.
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<double> angles{0};
  const auto go_straight = [&] {
    points.push_back(points.back() + 12.0 * Vec3{std::cos(angles.back()), std::sin(angles.back()), 0});
    angles.push_back(angles.back());
  };
  const auto bend = [&](double by) {
    for (int row = 0; row < 2; ++row) {
      const double from = angles.back(), to = from + by / 2, side = by > 0 ? 5 : -5;
      points.push_back(points.back() + side * Vec3{std::sin(to) - std::sin(from), std::cos(from) - std::cos(to), 0});
      angles.push_back(to);
    }
  };
  go_straight();
  bend(std::numbers::pi / 6);
  go_straight();
  bend(-std::numbers::pi / 6);
  go_straight();
  const PolygonMesh mesh = tube_along(
      static_cast<int>(points.size()), 24, 1, [&](int i) { return points[static_cast<std::size_t>(i)]; },
      [&](int i) {
        const double a = angles[static_cast<std::size_t>(i)];
        return Vec3{std::cos(a), std::sin(a), 0};
      });
  for (const double step : {0.0, 1e-4}) {
    const Claims claims = claims_of(step > 0 ? rounded_to(mesh, step) : mesh);
    std::size_t cylinders = 0, tori = 0;
    for (const RecognisedSurface& s : claims.surfaces()) {
      cylinders += s.shape.kind == SurfaceKind::kCylinder ? 1 : 0;
      tori += s.shape.kind == SurfaceKind::kTorus && std::fabs(s.shape.radius - 5) < 0.01 ? 1 : 0;
    }
    EXPECT_EQ(cylinders, 3u) << step;
    EXPECT_EQ(tori, 2u) << step;
  }
}

TEST(surface_recognition, a_single_ring_is_a_cone_and_no_ball_and_the_disc_that_closes_it_is_plane) {
  // A shoulder, a fillet of two coarse rows, and a pin that is closed by a coarse round end.
  constexpr int kAround = 14;
  const std::vector<Vec2> profile{{7, 3},
                                  {5.15, 3 + 1.85 * std::tan(std::numbers::pi / 8)},
                                  {4.4, 5.577},
                                  {4.4, 9},
                                  {3.4, 9 + std::tan(std::numbers::pi / 8)}};
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::uint32_t> disc, base;
  for (const Vec2 p : profile)
    for (int k = 0; k < kAround; ++k) {
      const double a = 2 * std::numbers::pi * k / kAround;
      positions.push_back({p.x * std::cos(a), p.x * std::sin(a), p.y});
    }
  const auto rows = static_cast<std::uint32_t>(profile.size() - 1);
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t a = row * kAround + k, b = row * kAround + (k + 1) % kAround;
      faces.push_back({a, b, b + kAround, a + kAround});
    }
  for (std::uint32_t k = 0; k < kAround; ++k) {
    disc.push_back(rows * kAround + k);
    base.push_back(kAround - 1 - k);
  }
  faces.push_back(disc);
  faces.push_back(base);
  for (const int feature_angle : {30, 60}) {
    Options options;
    options.feature_angle_deg = feature_angle;
    const PolygonMesh mesh = shapes::from_lists(positions, faces);
    const Claims claims = claims_of(mesh, 1, options);
    for (const RecognisedSurface& s : claims.surfaces()) EXPECT_NE(s.shape.kind, SurfaceKind::kSphere);
    EXPECT_EQ(claims.kind_of(FaceId(0)), SurfaceKind::kCone);
    EXPECT_EQ(claims.kind_of(FaceId(mesh.face_count() - 2)), SurfaceKind::kPlane) << feature_angle;
  }
}

TEST(surface_recognition, a_few_corners_that_are_less_exact_do_not_divide_a_torus_into_cones) {
  // A barrel of five rows. Programs compute points where surfaces meet less exactly than the others.
  constexpr int kAround = 32, kRows = 5;
  constexpr double kMiddle = -20, kTube = 30;
  const auto barrel = [&](double off) {
    std::vector<Vec3> positions;
    std::vector<std::vector<std::uint32_t>> faces;
    for (int i = 0; i <= kRows; ++i)
      for (int k = 0; k < kAround; ++k) {
        // Every eleventh corner of the first circle is off.
        const double tube = kTube + (i == 0 && k % 11 == 0 ? off : 0);
        const double t = 0.05 + 0.1 * i, rho = kMiddle + tube * std::cos(t), a = 2 * std::numbers::pi * k / kAround;
        positions.push_back({rho * std::cos(a), rho * std::sin(a), tube * std::sin(t)});
      }
    std::vector<std::uint32_t> low, high;
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t next = (k + 1) % kAround;
      for (std::uint32_t i = 0; i < kRows * kAround; i += kAround)
        faces.push_back({i + k, i + next, i + next + kAround, i + k + kAround});
      low.push_back(kAround - 1 - k);
      high.push_back(kRows * kAround + k);
    }
    faces.push_back(low);
    faces.push_back(high);
    PolygonMesh mesh = shapes::from_lists(positions, faces);
    for (Vec3& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
    return mesh;
  };
  double tolerance = 0;
  const Claims exact = claims_of(barrel(0));
  for (const RecognisedSurface& s : exact.surfaces())
    if (s.shape.kind == SurfaceKind::kTorus) tolerance = s.tolerance;
  ASSERT_GT(tolerance, 0);
  for (const double part : {0.0, 0.5, 0.7}) {
    const Claims claims = claims_of(barrel(part * tolerance));
    for (std::uint32_t f = 0; f < kRows * kAround; ++f)
      EXPECT_EQ(claims.kind_of(FaceId(f)), SurfaceKind::kTorus) << part;
  }
}

TEST(surface_recognition, an_ogive_is_remeshed_as_a_torus_whose_middle_lies_beyond_the_axis) {
  constexpr int kAround = 32, kRings = 10;
  constexpr double kMiddle = -30, kTube = 40;
  const double end = std::acos(-kMiddle / kTube);
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kAround; ++k) {
      const double t = end * i / kRings, rho = kMiddle + kTube * std::cos(t), a = 2 * std::numbers::pi * k / kAround;
      positions.push_back({rho * std::cos(a), rho * std::sin(a), kTube * std::sin(t)});
    }
  positions.push_back({0, 0, kTube * std::sin(end)});
  std::vector<std::uint32_t> base;
  for (std::uint32_t k = 0; k < kAround; ++k) {
    const std::uint32_t next = (k + 1) % kAround, top = (kRings - 1) * kAround;
    for (std::uint32_t i = 0; i + kAround <= top; i += kAround)
      faces.push_back({i + k, i + next, i + next + kAround, i + k + kAround});
    faces.push_back({top + k, top + next, kRings * kAround});
    base.push_back(kAround - 1 - k);
  }
  faces.push_back(base);
  Options options;
  options.elements_per_circle = 16;
  RunControl control;
  const Report report = remesh_surface(shapes::from_lists(positions, faces), options, {}, control).report;
  EXPECT_TRUE(report.verified.all_true());
  int tori = 0;
  for (const RecognisedSurface& s : report.surfaces.surfaces) {
    if (s.shape.kind != SurfaceKind::kTorus) continue;
    ++tori;
    EXPECT_NEAR(s.shape.radius, kMiddle, 1e-6);
    EXPECT_NEAR(s.shape.minor_radius, kTube, 1e-6);
    // The result is no longer the facets, and no farther from them than they and 16 elements explain.
    EXPECT_GT(s.bound, 1e-3);
    EXPECT_LE(s.bound, s.input_chord_height + 10 * (1 - std::cos(std::numbers::pi / 16)));
  }
  EXPECT_EQ(tori, 1);
}

}  // namespace
}  // namespace remesh
