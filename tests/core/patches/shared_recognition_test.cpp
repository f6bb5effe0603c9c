// Tests recognition on real parts. Some are known from other sources; of noisy and free-form ones little may be
// claimed.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "core/base/tolerance.h"
#include "core/io/gzip.h"
#include "core/io/mesh_files.h"
#include "tests/support/claims.h"
#include "tests/support/own_meshes.h"
#include "tests/support/shared_meshes.h"

namespace remesh {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

PolygonMesh read(const std::filesystem::path& path) {
  RunControl control;
  std::string content = contents(path);
  if (is_gzip(content)) content = gunzip(content, DecompressionLimits{}, control);
  return read_mesh(sniff_format(content), content, ReadLimits{}, control).mesh;
}

/// A mesh, what is claimed of it, and the number of surfaces and the share of the area by kind.
struct Judged {
  PolygonMesh mesh;
  test::Claims claims;
  std::map<SurfaceKind, std::size_t> count;
  std::map<SurfaceKind, double> area;  ///< the part of the whole area, in percent

  std::size_t curved() const {
    std::size_t sum = 0;
    for (const auto& [kind, n] : count) sum += kind == SurfaceKind::kPlane || kind == SurfaceKind::kFree ? 0 : n;
    return sum;
  }
  double curved_area() const {
    double sum = 0;
    for (const auto& [kind, a] : area) sum += kind == SurfaceKind::kPlane || kind == SurfaceKind::kFree ? 0 : a;
    return sum;
  }
};

/// Recognises a mesh, and expects that no claim is refuted by a corner of a facet.
Judged judge(const std::filesystem::path& path) {
  RunControl control;
  Judged judged;
  judged.mesh = read(path);
  judged.claims = test::claims_of(judged.mesh, control);
  double whole = 0;
  for (std::uint32_t f = 0; f < judged.mesh.face_count(); ++f) {
    const double area = test::area_of(judged.mesh, FaceId(f));
    whole += area;
    judged.area[judged.claims.kind_of(FaceId(f))] += area;
  }
  for (auto& [kind, area] : judged.area) area *= 100 / whole;
  for (const RecognisedSurface& s : judged.claims.surfaces()) ++judged.count[s.shape.kind];
  const Report& report = judged.claims.report;
  const double step = std::max(
      {report.rounding_step, test::written_step(judged.mesh), kToleranceFloor * report.input.bounding_box.diagonal()});
  for (const test::ClaimFit& fit : test::fit_of_claims(judged.mesh, judged.claims, step)) {
    const RecognisedSurface& s = judged.claims.surfaces()[fit.surface];
    EXPECT_LE(fit.deviation, s.tolerance * (1 + 1e-6)) << kind_name(s.shape.kind) << " " << fit.surface;
    // Corners may be beside their surface by a third of the chord height that two facets imply.
    EXPECT_LE(s.tolerance, std::max(10 * step, 0.5 * s.input_chord_height))
        << kind_name(s.shape.kind) << " " << fit.surface;
  }
  return judged;
}

class shared_recognition : public testing::Test {
 protected:
  void SetUp() override { test::has_shared_mesh("curved-cad"); }
  static Judged judge_shared(const std::string& name) {
    SCOPED_TRACE(name);
    return judge(test::shared_meshes_folder() / name);
  }
};

TEST(own_recognition, the_bracket_has_ten_cylinders_and_nothing_else_that_is_curved) {
  const Judged bracket = judge(test::own_meshes_folder() / "bracket.obj");
  EXPECT_EQ(bracket.curved(), 10u);
  EXPECT_EQ(bracket.count.count(SurfaceKind::kCylinder) > 0 ? bracket.count.at(SurfaceKind::kCylinder) : 0, 10u);
  EXPECT_NEAR(bracket.curved_area(), 9.4, 0.1);
}

TEST_F(shared_recognition, a_torus_is_one) {
  const Judged torus = judge_shared("curved-cad/torus_default_resolution.stl");
  // Where the tube is highest and lowest, a ring of facets lies in one plane, and the torus touches its rims.
  EXPECT_EQ(torus.curved(), 1u);
  EXPECT_EQ(torus.count.count(SurfaceKind::kTorus), 1u);
  EXPECT_GT(torus.curved_area(), 99.99);
}

/// A part and its surfaces: their number and the share of the area in percent of each curved kind.
struct Expected {
  std::string name;
  std::map<SurfaceKind, std::pair<std::size_t, double>> kinds;
};

/// The round corners of `plate_holes` are tori with radii of 3/4 and 1/4 inch. A search that tries cones before tori
/// finds six cones in each of them.
const std::vector<Expected> kParts{
    {"curved-cad/round.stl", {{SurfaceKind::kCylinder, {2, 99.5}}}},
    {"curved-cad/fe_part1.stl", {{SurfaceKind::kCylinder, {1, 18.19}}}},
    {"curved-cad/sv_cylinder.stl", {{SurfaceKind::kCylinder, {1, 86.98}}}},
    {"planar-cad/plate_holes.STL",
     {{SurfaceKind::kCylinder, {14, 7.67}}, {SurfaceKind::kCone, {4, 0.43}}, {SurfaceKind::kTorus, {4, 1.07}}}},
    {"planar-cad/1002_tray_bottom.STL", {{SurfaceKind::kCylinder, {34, 0.54}}}},
    {"curved/shape.stl", {{SurfaceKind::kCylinder, {3, 69.95}}}},
    {"curved-cad/hx_tube.stl.gz", {{SurfaceKind::kCylinder, {3, 58.04}}}},
    {"planar-cad/part1.stl", {{SurfaceKind::kCylinder, {4, 16.59}}}},
};

TEST_F(shared_recognition, parts_have_the_surfaces_that_they_were_made_of) {
  for (const Expected& part : kParts) {
    if (!test::has_shared_mesh(part.name)) return;
    SCOPED_TRACE(part.name);
    Judged judged = judge_shared(part.name);
    std::size_t curved = 0;
    for (const auto& [kind, expected] : part.kinds) {
      SCOPED_TRACE(kind_name(kind));
      EXPECT_EQ(judged.count[kind], expected.first);
      EXPECT_NEAR(judged.area[kind], expected.second, 0.02 + 0.001 * expected.second);
      curved += expected.first;
    }
    EXPECT_EQ(judged.curved(), curved) << "there are surfaces of other kinds";
  }
}

TEST_F(shared_recognition, parts_of_several_kinds_are_claimed_without_a_claim_that_does_not_fit) {
  for (const char* name : {"curved-cad/singleOrifice.stl", "curved-cad/sh2.stl", "curved-cad/object.stl"}) {
    if (!test::has_shared_mesh(name)) return;
    SCOPED_TRACE(name);
    Judged judged = judge_shared(name);
    EXPECT_GT(judged.curved_area(), 30);
    EXPECT_LT(judged.area[SurfaceKind::kFree], 10);
  }
}

TEST_F(shared_recognition, of_noisy_and_free_form_meshes_only_what_fits_is_claimed) {
  for (const char* name : {"curved/spot.ply", "curved/casting.off", "curved/fandisk.obj", "broken/conrod.stl"}) {
    if (!test::has_shared_mesh(name)) return;
    const Judged judged = judge_shared(name);
    if (std::string(name).find("spot") != std::string::npos) {
      EXPECT_LE(judged.curved_area(), 1);
    }
  }
}

/// Returns the cylinders of a STEP file, in the file's unit.
std::vector<test::PlainSurface> step_cylinders(const std::filesystem::path& path) {
  const std::string text = contents(path);
  // Each entity is "#number = NAME ( arguments ) ;", and may go over several lines.
  std::map<int, std::pair<std::string, std::string>> entities;
  const std::regex entity(R"(#(\d+)\s*=\s*([A-Z_0-9]+)\s*\(([^;]*)\)\s*;)");
  for (std::sregex_iterator it(text.begin(), text.end(), entity), end; it != end; ++it)
    entities[std::stoi((*it)[1])] = {(*it)[2], (*it)[3]};
  const auto numbers = [](const std::string& arguments) {
    std::vector<double> found;
    const std::regex number(R"([-+]?\d+\.\d*(?:[eE][-+]?\d+)?)");
    for (std::sregex_iterator it(arguments.begin(), arguments.end(), number), end; it != end; ++it)
      found.push_back(std::stod(it->str()));
    return found;
  };
  const auto references = [](const std::string& arguments) {
    std::vector<int> found;
    const std::regex reference(R"(#(\d+))");
    for (std::sregex_iterator it(arguments.begin(), arguments.end(), reference), end; it != end; ++it)
      found.push_back(std::stoi((*it)[1]));
    return found;
  };
  const auto vector_of = [&](int id) {
    const std::vector<double> n = numbers(entities.at(id).second);
    return Vec3{n.at(0), n.at(1), n.at(2)};
  };
  std::vector<test::PlainSurface> cylinders;
  for (const auto& [id, e] : entities) {
    if (e.first != "CYLINDRICAL_SURFACE") continue;
    const std::vector<int> placement = references(entities.at(references(e.second).at(0)).second);
    cylinders.push_back({SurfaceKind::kCylinder,
                         vector_of(placement.at(0)),
                         vector_of(placement.at(1)),
                         numbers(e.second).at(0),
                         0,
                         0,
                         {}});
  }
  return cylinders;
}

TEST_F(shared_recognition, all_half_cylinders_of_a_part_are_those_of_its_step_file) {
  if (!test::has_shared_mesh("broken/featuretype.STL") || !test::has_shared_mesh("step/featuretype.STEP")) return;
  const std::vector<test::PlainSurface> cylinders =
      step_cylinders(test::shared_meshes_folder() / "step/featuretype.STEP");
  ASSERT_EQ(cylinders.size(), 46u);
  Judged part = judge_shared("broken/featuretype.STL");
  for (const SurfaceKind kind : {SurfaceKind::kTorus, SurfaceKind::kCone, SurfaceKind::kSphere})
    EXPECT_EQ(part.count[kind], 0u) << kind_name(kind);
  const double on = 6 * test::float_step(part.mesh);
  std::size_t faces = 0, missed = 0, wrong = 0;
  std::vector<std::size_t> found(cylinders.size());
  for (std::uint32_t f = 0; f < part.mesh.face_count(); ++f) {
    const std::vector<Vec3> corners = test::corners_of(part.mesh, FaceId(f));
    const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    const Vec3 middle = (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
    for (std::size_t c = 0; c < cylinders.size(); ++c) {
      const test::PlainSurface& cylinder = cylinders[c];
      // The facets turn by 15 degrees at most, so a plane of the part through the same points looks another way.
      const bool is_on =
          std::fabs(dot(normal, cylinder.normal(middle))) > std::cos(0.2) &&
          std::all_of(corners.begin(), corners.end(), [&](const Vec3& p) { return cylinder.distance(p) <= on; });
      if (!is_on) continue;
      ++faces;
      ++found[c];
      if (part.claims.kind_of(FaceId(f)) != SurfaceKind::kCylinder)
        ++missed;
      else if (std::fabs(part.claims.surfaces()[part.claims.surface_of(FaceId(f))].shape.radius - cylinder.radius) >
               1e-6)
        ++wrong;
      break;
    }
  }
  EXPECT_GT(faces, 1000u);
  EXPECT_EQ(missed, 0u) << "of " << faces;
  EXPECT_EQ(wrong, 0u) << "of " << faces;
}

}  // namespace
}  // namespace remesh
