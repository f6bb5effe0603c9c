#include "api/surface_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "core/output/report/surface_words.h"

namespace remesh::api {
namespace {

using testing::ElementsAre;

/// A surface whose area is 10 and whose facets have the size of a unit cube.
RecognisedSurface surface_of(SurfaceKind kind, double radius = 0, double minor_radius = 0) {
  RecognisedSurface surface;
  surface.shape.kind = kind;
  surface.shape.radius = radius;
  surface.shape.minor_radius = minor_radius;
  surface.faces = 20;
  surface.area = 10;
  surface.sweep_deg = 360;
  surface.tolerance = 1e-6;
  surface.deviation = 5e-7;
  surface.extent = {{0, 0, 0}, {1, 1, 1}};
  return surface;
}

RecognisedSurface hole(double radius) {
  RecognisedSurface surface = surface_of(SurfaceKind::kCylinder, radius);
  surface.side = SurfaceSide::kConcave;
  return surface;
}

RecognisedSurface cone(double degrees) {
  RecognisedSurface surface = surface_of(SurfaceKind::kCone);
  surface.shape.half_angle = degrees * std::numbers::pi / 180;
  return surface;
}

RecognisedSurface free_region(FreeReason reason, SurfaceKind nearest, double deviation = 0) {
  RecognisedSurface region = surface_of(SurfaceKind::kFree);
  region.reason = reason;
  region.nearest_kind = nearest;
  region.nearest_deviation = deviation;
  return region;
}

std::vector<std::string> texts(const std::vector<RecognisedSurface>& surfaces) {
  RecognisedSurfaces recognised;
  for (const RecognisedSurface& surface : surfaces) recognised.surfaces.push_back(surface);
  std::vector<std::string> lines;
  for (const SurfaceGroup& group : list_surfaces(recognised)) lines.push_back(group.text);
  return lines;
}

TEST(surface_list, a_mesh_without_surfaces_has_an_empty_list) { EXPECT_TRUE(list_surfaces({}).empty()); }

TEST(surface_list, each_kind_has_a_line_and_the_largest_area_comes_first) {
  std::vector<RecognisedSurface> part(1252, surface_of(SurfaceKind::kPlane));
  for (int i = 0; i < 8; ++i) part.push_back(hole(2.5));
  for (int i = 0; i < 6; ++i) part.push_back(hole(3.175));
  part.insert(part.end(), 28, cone(45));
  part.push_back(surface_of(SurfaceKind::kTorus, 20, 3));
  part.insert(part.end(), 3, surface_of(SurfaceKind::kSphere, 4));
  EXPECT_THAT(texts(part), ElementsAre("1,252 planes", "28 cones of 45 degrees",
                                       "14 cylinders: 8 of r 2.5 (holes), 6 of r 3.175 (holes)", "3 spheres of r 4",
                                       "1 torus of R 20, r 3"));
}

TEST(surface_list, a_group_has_the_sums_of_its_surfaces) {
  RecognisedSurfaces recognised;
  for (int i = 0; i < 3; ++i) recognised.surfaces.push_back(hole(i + 1));
  const std::vector<SurfaceGroup> groups = list_surfaces(recognised);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].kind, SurfaceKind::kCylinder);
  EXPECT_EQ(groups[0].count, 3u);
  EXPECT_EQ(groups[0].faces, 60u);
  EXPECT_EQ(groups[0].area, 30);
}

TEST(surface_list, sizes_are_the_same_within_the_tolerances_of_both_and_no_further) {
  EXPECT_THAT(texts({hole(2), hole(2 + 1.9e-6)}), ElementsAre("2 cylinders of r 2 (holes)"));
  EXPECT_THAT(texts({hole(2), hole(2.0001)}), ElementsAre("2 cylinders: 1 of r 2 (hole), 1 of r 2.0001 (hole)"));
  // A chain of small steps is not one size.
  std::vector<RecognisedSurface> chain;
  for (int i = 0; i <= 10; ++i) chain.push_back(hole(2 + i * 1.5e-6));
  EXPECT_THAT(texts(chain)[0], testing::HasSubstr(": "));
  // Tori are sorted by two radii, and neighbours by the first may differ in the second.
  std::vector<RecognisedSurface> tori;
  for (int i = 0; i < 4; ++i) tori.push_back(surface_of(SurfaceKind::kTorus, 20 + i * 1e-7, 3 + i % 2));
  EXPECT_THAT(texts(tori), ElementsAre("4 tori: 2 of R 20, r 3, 2 of R 20, r 4"));
}

TEST(surface_list, a_size_has_the_digits_that_its_deviation_allows) {
  EXPECT_THAT(texts({hole(19.9999995)}), ElementsAre("1 cylinder of r 20 (hole)"));
  RecognisedSurface exact = hole(2.0 / 3);
  exact.deviation = 1e-15;
  EXPECT_THAT(texts({exact}), ElementsAre("1 cylinder of r 0.666667 (hole)"));
  RecognisedSurface coarse = hole(1234567);
  coarse.deviation = 1000;
  EXPECT_THAT(texts({coarse}), ElementsAre("1 cylinder of r 1235000 (hole)"));
  // A short arc says little about its radius.
  RecognisedSurface fillet = hole(5.000005);
  fillet.sweep_deg = 30;
  EXPECT_THAT(texts({fillet}), ElementsAre("1 cylinder of r 5 (concave)"));
}

TEST(surface_list, holes_are_told_from_shafts_and_fillets_from_rounded_edges) {
  RecognisedSurface shaft = surface_of(SurfaceKind::kCylinder, 2), pin = shaft, fillet = hole(1), edge = shaft;
  pin.side = SurfaceSide::kBoth;
  fillet.sweep_deg = edge.sweep_deg = 90;
  EXPECT_THAT(texts({hole(2), hole(2), shaft, pin, fillet}),
              ElementsAre("5 cylinders: 2 of r 2 (holes), 1 of r 1 (concave), 1 of r 2 (both sides), "
                          "1 of r 2 (shaft)"));
  EXPECT_THAT(texts({edge, edge}), ElementsAre("2 cylinders of r 2"));
  EXPECT_THAT(texts({edge, fillet}), ElementsAre("2 cylinders: 1 of r 2 (convex), 1 of r 1 (concave)"));
}

TEST(surface_list, many_sizes_are_cut_short) {
  std::vector<RecognisedSurface> part;
  for (int size = 0; size < 20; ++size)
    for (int i = size; i < 20; ++i) part.push_back(hole(size + 1));
  const std::string text = texts(part)[0];
  EXPECT_THAT(text, testing::StartsWith("210 cylinders: 20 of r 1 (holes), 19 of r 2 (holes), "));
  EXPECT_THAT(text, testing::EndsWith("13 of r 8 (holes), 78 of 12 other sizes"));
}

TEST(surface_list, a_free_region_says_what_comes_nearest) {
  EXPECT_THAT(texts({free_region(FreeReason::kNoKindFits, SurfaceKind::kTorus, 1.1234e-4)}),
              ElementsAre("1 free region of 20 facets: a torus comes nearest, 0.00011 away"));
  EXPECT_THAT(texts({free_region(FreeReason::kNoKindFits, SurfaceKind::kFree)}),
              ElementsAre("1 free region of 20 facets"));
  EXPECT_THAT(texts({free_region(FreeReason::kFewFacets, SurfaceKind::kCone)}),
              ElementsAre("1 free region of 20 facets: too few facets to recognise a surface"));
  EXPECT_THAT(texts({free_region(FreeReason::kUnevenFacets, SurfaceKind::kCylinder)}),
              ElementsAre("1 free region of 20 facets: a cylinder fits, but the facets are too uneven to be "
                          "meant as one"));
  EXPECT_THAT(texts({free_region(FreeReason::kNoKindFits, SurfaceKind::kTorus, 1),
                     free_region(FreeReason::kNoKindFits, SurfaceKind::kCone, 1),
                     free_region(FreeReason::kNoKindFits, SurfaceKind::kTorus, 1),
                     free_region(FreeReason::kNoKindFits, SurfaceKind::kFree)}),
              ElementsAre("4 free regions of 80 facets: a cone comes nearest to 1, a torus to 2"));
}

TEST(surface_list, a_surface_of_revolution_has_its_largest_radius) {
  RecognisedSurface vase = surface_of(SurfaceKind::kRevolution);
  vase.profile = {{1, 0}, {3, 1}, {2, 2}};
  EXPECT_THAT(texts({vase, vase}), ElementsAre("2 surfaces of revolution of r up to 3"));
}

TEST(surface_words, digits_are_grouped_by_threes) {
  EXPECT_EQ(grouped_digits(0), "0");
  EXPECT_EQ(grouped_digits(999), "999");
  EXPECT_EQ(grouped_digits(1000), "1,000");
  EXPECT_EQ(grouped_digits(1234567), "1,234,567");
}

}  // namespace
}  // namespace remesh::api
