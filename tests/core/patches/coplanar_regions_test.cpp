#include "core/patches/planar/coplanar_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/tolerance.h"
#include "core/base/union_find.h"
#include "core/mending/weld/weld.h"
#include "core/patches/planar/coplanarity.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Expects what the header promises. All corners are within half the tolerance of their plane. No face is turned over.
/// Every region is in one piece. The deviation of a region is how far its corners are from its plane.
void expect_regions(const StageChain& chain) {
  UnionFind pieces(chain.surface.face_count());
  std::map<RegionId, double> farthest;
  for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f) {
    const RegionId region = chain.regions.of_face[FaceId(f)];
    ASSERT_TRUE(region.is_valid());
    const Plane& plane = chain.regions.planes[region];
    EXPECT_NEAR(norm(plane.normal), 1, 1e-12);
    for (const VertexId v : chain.surface.face(FaceId(f))) {
      const double distance = std::fabs(plane.distance(chain.surface.local[v]));
      EXPECT_LE(distance, chain.tolerance / 2 * (1 + 1e-9) + 1e-15) << FaceId(f);
      farthest[region] = std::max(farthest[region], distance);
    }
    if (chain.geometry[FaceId(f)].height > 2 * chain.tolerance) {
      EXPECT_GT(dot(plane.normal, chain.geometry[FaceId(f)].normal), 0) << FaceId(f);
    }
    for (std::uint32_t h = chain.surface.face_begin[f]; h < chain.surface.face_begin[f + 1]; ++h) {
      const std::uint32_t twin = chain.adjacency.twin(h);
      if (twin != kNone && chain.regions.of_face[chain.adjacency.face_of(twin)] == region)
        pieces.join(f, chain.adjacency.face_of(twin).value);
    }
  }
  for (const auto& [region, distance] : farthest) EXPECT_EQ(chain.regions.deviation[region], distance) << region;
  std::map<RegionId, std::uint32_t> piece_of;
  for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f) {
    const auto [it, is_new] = piece_of.try_emplace(chain.regions.of_face[FaceId(f)], pieces.find(f));
    EXPECT_EQ(it->second, pieces.find(f)) << "region in two pieces";
  }
}

/// Makes a strip of quads along x. Each is turned about y by this angle against the one before.
PolygonMesh bent_strip(int quads, double angle_deg) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  Vec3 at;
  for (int i = 0; i <= quads; ++i) {
    positions.push_back(at);
    positions.push_back(at + Vec3{0, 1, 0});
    const double angle = i * angle_deg * 3.14159265358979 / 180;
    at += Vec3{std::cos(angle), 0, std::sin(angle)};
    const auto k = static_cast<std::uint32_t>(2 * i);
    if (i < quads) faces.push_back({k, k + 2, k + 3, k + 1});
  }
  return shapes::from_lists(positions, faces);
}

TEST(coplanar_regions, a_cube_has_six) {
  const StageChain chain(shapes::box({1, 2, 3}, 4));
  EXPECT_EQ(chain.region_count(), 6u);
  expect_regions(chain);
}

TEST(coplanar_regions, a_box_turned_in_space_and_rounded_has_six) {
  for (int seed = 0; seed < 10; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const PolygonMesh mesh =
        shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 5), axis, random.uniform(0, 360)), 1e-6);
    const StageChain chain(mesh, kToleranceSteps * 1e-6);
    EXPECT_EQ(chain.region_count(), 6u) << seed;
    expect_regions(chain);
  }
}

TEST(coplanar_regions, a_coarse_cylinder_keeps_its_facets) {
  for (const int sides : {8, 14, 60, 200}) {
    const StageChain chain(shapes::cylinder(sides, 1, 2), 2.6e-6);
    EXPECT_EQ(chain.region_count(), static_cast<std::size_t>(sides) + 2) << sides;
    expect_regions(chain);
  }
}

TEST(coplanar_regions, a_gently_bent_strip_does_not_creep_into_one_plane) {
  // Neighbours differ by less than the tolerance explains, the ends by degrees.
  const StageChain chain(bent_strip(400, 0.01), 1e-3);
  EXPECT_GT(chain.region_count(), 5u);
  EXPECT_LT(chain.region_count(), 200u);
  expect_regions(chain);
}

TEST(coplanar_regions, sheets_that_look_opposite_ways_stay_two) {
  // One square, cut along one diagonal on its upper side and along the other one below.
  const StageChain chain(
      shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}}));
  EXPECT_EQ(chain.region_count(), 2u);
  expect_regions(chain);
}

TEST(coplanar_regions, a_fold_of_180_degrees_stays_two) {
  // Two triangles on the same side of their common edge, consistently wound.
  const StageChain chain(shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 2, 0}}, {{0, 1, 2}, {1, 0, 3}}));
  EXPECT_EQ(chain.region_count(), 2u);
}

TEST(coplanar_regions, parallel_planes_a_step_apart_stay_apart) {
  // Two squares at different heights, joined by a riser.
  const PolygonMesh stairs = shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0.01}, {1, 1, 0.01}, {2, 0, 0.01}, {2, 1, 0.01}},
      {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}});
  EXPECT_EQ(StageChain(stairs, 1e-4).region_count(), 3u);
}

TEST(coplanar_regions, coplanar_faces_across_an_edge_of_three_faces_stay_apart) {
  // A flat sheet of two squares with a fin on their common edge.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 0, 1}, {1, 1, 1}},
                         {{0, 1, 4, 3}, {1, 2, 5, 4}, {1, 4, 7, 6}});
  EXPECT_EQ(StageChain(mesh).region_count(), 3u);
}

TEST(coplanar_regions, a_needle_with_a_noisy_normal_belongs_to_its_plane) {
  // The middle triangle is 1e-6 high and its tip is 2e-7 off the plane: 11 degrees.
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {2, 1e-6, 2e-7}, {2, -3, 0}, {2, 3, 0}},
                                              {{0, 1, 2}, {1, 0, 3}, {0, 2, 4}, {2, 1, 4}});
  const StageChain chain(mesh, 1e-6);
  EXPECT_EQ(chain.region_count(), 1u);
  expect_regions(chain);
}

TEST(coplanar_regions, faces_of_different_zones_stay_apart) {
  const PolygonMesh mesh = with_groups(shapes::sheet(4, 1, 4, 1), {0, 0, 0, 0, 1, 1, 1, 1});
  EXPECT_EQ(StageChain(mesh).region_count(), 2u);
}

STAGE(coplanar_regions, test::kScale, test::kNumbering) {
  const PolygonMesh bracket = shapes::rounded(shapes::rotated(shapes::l_bracket(4), {1, 2, 3}, 40), 1e-4);
  for (const PolygonMesh& mesh :
       {bracket, shapes::box({1, 2, 3}, 3), shapes::noisy_sheet(6, 1), bent_strip(60, 0.05)}) {
    const StageChain chain(trial.of(mesh), 2.6e-4 * trial.scale);
    trial.same(chain.region_count());
    std::map<RegionId, std::multiset<Vec3>> corners;
    for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f)
      for (const VertexId v : chain.surface.face(FaceId(f)))
        corners[chain.regions.of_face[FaceId(f)]].insert(trial.length(chain.surface.positions[v]));
    // With other numbers, borders within the tolerance may lie elsewhere, but on the bracket they may not.
    const bool is_certain = mesh.positions == bracket.positions;
    for (const auto& [region, places] : corners) is_certain ? trial.piece(places) : trial.in_order(places);
  }
}

TEST(coplanar_regions, two_triangles_bend_where_their_digits_cannot_explain_it) {
  // A square of side 1 with one corner lifted; the nearest plane is a quarter of that from all four corners.
  const double step = 0.001;
  for (const auto& [lift, patches] : {std::pair(1.1, 1u), {1.9, 1u}, {2.2, 2u}, {2.5, 2u}}) {
    const StageChain chain(
        shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, lift * step}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}),
        kToleranceSteps * step);
    const double local = chain.tolerance / kToleranceSteps;
    const IdVector<FaceId, std::uint8_t> rung(chain.surface.face_count(), 0);
    const auto count = [&](const Vec3& printed_steps) {
      Regions regions;
      regions.of_face.resize(chain.surface.face_count());
      coplanar_regions(chain.surface, chain.adjacency, chain.geometry,
                       {chain.tolerance, 1e-6, &chain.surface.face_label, &rung, printed_steps}, regions,
                       chain.control);
      return regions.planes.size();
    };
    EXPECT_EQ(count({}), 1u) << lift;
    EXPECT_EQ(count({local, local, local}), patches) << lift;
    // It is lifted along z: what the others are printed to explains next to nothing.
    EXPECT_EQ(count({local / 100, local / 100, local}), patches) << lift;
    EXPECT_EQ(count({local, local, local / 100}), 2u) << lift;
  }
}

TEST(coplanar_regions, digits_are_not_asked_where_neighbours_turn_by_a_milliradian_or_as_allowed) {
  // As above, with a corner lifted by more than the digits explain. The triangles turn by the lift times sqrt(2).
  const auto count = [](double step, double normal_tolerance) {
    const StageChain chain(
        shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 2.5 * step}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}),
        kToleranceSteps * step);
    const double local = chain.tolerance / kToleranceSteps;
    const IdVector<FaceId, std::uint8_t> rung(chain.surface.face_count(), 0);
    Regions regions;
    coplanar_regions(chain.surface, chain.adjacency, chain.geometry,
                     {chain.tolerance, normal_tolerance, &chain.surface.face_label, &rung, Vec3{local, local, local}},
                     regions, chain.control);
    return regions.planes.size();
  };
  for (const double normal_tolerance : {0.0, 1e-9, 1e-6, 1e-4}) {
    EXPECT_EQ(count(3e-4, normal_tolerance), 1u) << normal_tolerance;
    EXPECT_EQ(count(5e-4, normal_tolerance), 2u) << normal_tolerance;
  }
  // The two normals differ by 0.0018. Allowed is sqrt(3) times the tolerance, not its root.
  EXPECT_EQ(count(5e-4, 0.9e-3), 2u);
  EXPECT_EQ(count(5e-4, 1.1e-3), 1u);
}

TEST(coplanar_regions, on_the_last_rung_every_face_is_alone) {
  // Quads, each with a corner a little off the plane of the others.
  PolygonMesh mesh = shapes::quad_box({1, 1, 1}, 3);
  for (std::size_t v = 0; v < mesh.vertex_count(); v += 2) mesh.positions[VertexId(v)].x += 1e-8;
  const StageChain chain(mesh);
  const IdVector<FaceId, std::uint8_t> rung(chain.surface.face_count(), kSingleFace);
  Regions regions;
  coplanar_regions(chain.surface, chain.adjacency, chain.geometry, {1e-6, 1e-6, &chain.surface.face_label, &rung},
                   regions, chain.control);
  std::set<RegionId> used(regions.of_face.begin(), regions.of_face.end());
  EXPECT_EQ(used.size(), chain.surface.face_count());
  double most = 0;
  for (std::uint32_t f = 0; f < chain.surface.face_count(); ++f) {
    const RegionId r = regions.of_face[FaceId(f)];
    double farthest = 0;
    for (const VertexId v : chain.surface.face(FaceId(f)))
      farthest = std::max(farthest, std::fabs(regions.planes[r].distance(chain.surface.local[v])));
    EXPECT_EQ(regions.deviation[r], farthest);
    most = std::max(most, farthest);
  }
  EXPECT_GT(most, 1e-10);
}

TEST(coplanar_regions, faces_that_have_a_region_keep_it) {
  const StageChain chain(shapes::sheet(4, 1, 4, 1));
  const IdVector<FaceId, std::uint8_t> rung(chain.surface.face_count(), 0);
  Regions regions;
  regions.of_face.resize(chain.surface.face_count());
  regions.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  regions.of_face[FaceId(6)] = RegionId(0);  // in a corner: the others hang together without it
  coplanar_regions(chain.surface, chain.adjacency, chain.geometry, {1e-6, 1e-6, &chain.surface.face_label, &rung},
                   regions, chain.control);
  EXPECT_EQ(std::count(regions.of_face.begin(), regions.of_face.end(), RegionId(0)), 1);
  EXPECT_EQ(regions.planes.size(), 2u);
}

TEST(tolerance_at_rung, it_falls_by_tenths_to_the_floor) {
  EXPECT_EQ(tolerance_at_rung(1e-4, 0, 1e-9), 1e-4);
  EXPECT_DOUBLE_EQ(tolerance_at_rung(1e-4, 1, 1e-9), 1e-5);
  EXPECT_DOUBLE_EQ(tolerance_at_rung(1e-4, 2, 1e-9), 1e-9);
  EXPECT_LT(tolerance_at_rung(1e-9, 2, 1e-9), tolerance_at_rung(1e-9, 1, 1e-9));
}

}  // namespace
}  // namespace remesh
