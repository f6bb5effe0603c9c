#include "tests/support/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "tests/support/claims.h"

namespace remesh::primitives {
namespace {

Vec3 area_vector(const std::vector<Vec3>& corners) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += 0.5 * cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

std::vector<Model> all_models() {
  std::vector<Model> models = explained();
  for (Model& model : declined()) models.push_back(std::move(model));
  return models;
}

bool is_subdivided(const Model& model) { return model.name.find("subdivided") != std::string::npos; }

TEST(primitives, all_corners_lie_on_the_surface_that_their_face_was_made_from) {
  for (const Model& model : explained()) {
    if (is_subdivided(model)) continue;
    SCOPED_TRACE(model.name);
    ASSERT_EQ(model.surface_of.size(), model.mesh.face_count());
    double farthest = 0;
    for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
      const test::PlainSurface& surface = model.surfaces[model.surface_of[FaceId(f)]];
      if (surface.kind == SurfaceKind::kFree) continue;
      for (const Vec3& p : test::corners_of(model.mesh, FaceId(f))) farthest = std::max(farthest, surface.distance(p));
    }
    EXPECT_LT(farthest, 1e-14 * 64);
  }
}

TEST(primitives, facets_look_the_way_of_their_surface_and_turn_by_less_than_thirty_degrees) {
  for (const Model& model : explained()) {
    SCOPED_TRACE(model.name);
    std::map<std::pair<VertexId, VertexId>, std::uint32_t> face_at;
    double widest = 0;
    double tilt = 0;
    for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
      const auto corners = model.mesh.face(FaceId(f));
      for (std::size_t i = 0; i < corners.size(); ++i)
        EXPECT_TRUE(face_at.try_emplace({corners[i], corners[(i + 1) % corners.size()]}, f).second)
            << "two faces run along one edge the same way";
    }
    const auto normal = [&](std::uint32_t f) {
      return normalized(area_vector(test::corners_of(model.mesh, FaceId(f))));
    };
    for (const auto& [edge, f] : face_at) {
      const auto twin = face_at.find({edge.second, edge.first});
      const std::uint32_t s = model.surface_of[FaceId(f)];
      const SurfaceKind kind = model.surfaces[s].kind;
      if (kind == SurfaceKind::kPlane || kind == SurfaceKind::kFree) continue;
      const std::vector<Vec3> corners = test::corners_of(model.mesh, FaceId(f));
      Vec3 middle;
      for (const Vec3& c : corners) middle += (1.0 / static_cast<double>(corners.size())) * c;
      tilt = std::max(tilt, std::acos(std::min(1.0, std::fabs(dot(normal(f), model.surfaces[s].normal(middle))))));
      if (twin == face_at.end() || model.surface_of[FaceId(twin->second)] != s) continue;
      widest = std::max(widest, std::acos(std::clamp(dot(normal(f), normal(twin->second)), -1.0, 1.0)));
    }
    EXPECT_LT(widest * 180 / std::numbers::pi, 29.9);
    EXPECT_LT(tilt * 180 / std::numbers::pi, 15);
  }
}

TEST(primitives, closed_models_are_not_inside_out) {
  for (const Model& model : all_models()) {
    SCOPED_TRACE(model.name);
    std::set<std::pair<VertexId, VertexId>> edges;
    double volume = 0;
    for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
      const auto corners = model.mesh.face(FaceId(f));
      for (std::size_t i = 0; i < corners.size(); ++i) edges.insert({corners[i], corners[(i + 1) % corners.size()]});
      volume += dot(model.mesh.positions[corners[0]], area_vector(test::corners_of(model.mesh, FaceId(f)))) / 3;
    }
    const bool is_closed = std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
      return edges.count({e.second, e.first}) > 0;
    });
    const auto is_open_by_name = [&] {
      for (const char* name : {"arc", "torus 48 12", "tee", "vase", "thread"})
        if (model.name.starts_with(name)) return true;
      return false;
    };
    EXPECT_EQ(is_closed, !is_open_by_name());
    if (is_closed) {
      EXPECT_GT(volume, 1);
    }
  }
}

TEST(primitives, a_variant_stays_on_its_surface_within_a_step) {
  for (const Model& model : explained()) {
    if (is_subdivided(model)) continue;
    for (const Variant& variant : variants()) {
      double step = 0;
      const Model moved = varied(model, variant, &step);
      SCOPED_TRACE(moved.name);
      double farthest = 0;
      for (std::uint32_t f = 0; f < moved.mesh.face_count(); ++f) {
        const test::PlainSurface& surface = moved.surfaces[moved.surface_of[FaceId(f)]];
        if (surface.kind == SurfaceKind::kFree) continue;
        for (const Vec3& p : test::corners_of(moved.mesh, FaceId(f)))
          farthest = std::max(farthest, surface.distance(p));
      }
      EXPECT_LT(farthest, step);
    }
  }
}

TEST(plain_surfaces, the_nearest_point_lies_on_the_surface_along_its_normal) {
  const test::PlainSurface cone{SurfaceKind::kCone, {1, 2, 3}, {0, 1, 1}, 0, 0, 35, {}};
  const test::PlainSurface torus{SurfaceKind::kTorus, {1, 2, 3}, {1, 0, 2}, 4, 1.5, 0, {}};
  const test::PlainSurface sphere{SurfaceKind::kSphere, {1, 2, 3}, {}, 4, 0, 0, {}};
  const test::PlainSurface cylinder{SurfaceKind::kCylinder, {1, 2, 3}, {3, 1, 2}, 4, 0, 0, {}};
  const Vec3 away{2, 7, 9};
  for (const test::PlainSurface& s : {cone, torus, sphere, cylinder}) {
    const Vec3 at = s.nearest(away);
    EXPECT_LT(s.distance(at), 1e-14);
    EXPECT_NEAR(std::fabs(dot(normalized(away - at), s.normal(away))), 1, 1e-12);
  }
  EXPECT_NEAR(cone.distance(cone.point - Vec3{0, 3, 3}), std::sqrt(18.0), 1e-14) << "beyond the apex";
  EXPECT_NEAR(torus.distance(torus.point), 2.5, 1e-14);
  EXPECT_NEAR(sphere.distance(sphere.point), 4, 1e-14);
}

}  // namespace
}  // namespace remesh::primitives
