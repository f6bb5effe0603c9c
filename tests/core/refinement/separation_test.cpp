#include "core/refinement/adjustment/separation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "core/refinement/attempts/surface_refinement.h"
#include "core/remesh.h"
#include "tests/support/refined_checks.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Sheets of 3 x 3 that have been refined. All triangles have a reason that no move of a vertex gives them.
class RefinedSheets {
 public:
  explicit RefinedSheets(const PolygonMesh& sheets, double max_edge_length = 0.5) : chain_(sheets, 1e-9) {
    Options options;
    options.max_edge_length = max_edge_length;
    const Goals goals = goals_of(options, std::sqrt(18));
    RefinementChoices choices{MinEdgeSearch(goals)};
    choices.budget = first_budget(goals.max_faces);
    choices.is_thinning_quick = true;
    refinement_ = SurfaceRefinement(goals, {}, chain_.control)
                      .refine({chain_.surface, chain_.adjacency, chain_.patches, 1e-9}, choices, {},
                              IdVector<PatchId, std::uint8_t>(chain_.patches.count(), 0), chain_.triangulated)
                      .refinement;
    std::fill(refinement_.reason.begin(), refinement_.reason.end(), UnrefinedReason::kInputAngle);
  }

  std::vector<std::uint8_t> separate(TwinsOf of = TwinsOf::kPatches) {
    return separate_new_vertices(chain_.surface, chain_.triangulated, refinement_, of, chain_.control);
  }

  StageChain& chain() { return chain_; }
  Refinement& refinement() { return refinement_; }
  std::size_t first_inner() const { return chain_.surface.vertex_count() + refinement_.first_inner; }
  Vec3 place(VertexId v) const {
    const std::size_t of_surface = chain_.surface.vertex_count();
    return v.value < of_surface ? chain_.surface.positions[v] : refinement_.new_positions[v.value - of_surface];
  }
  std::vector<VertexId> corners() const {
    std::vector<VertexId> corners;
    for (const PatchMesh& patch : chain_.meshes)
      for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
        corners.push_back(patch.vertices[patch.mesh.from(h)]);
    return corners;
  }

 private:
  StageChain chain_;
  Refinement refinement_;
};

/// Squares in the same place with corners of their own, each in a group of its own, so that no two become one patch.
PolygonMesh sheets_in_one_another(int count) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::uint32_t> groups;
  for (std::uint32_t sheet = 0; sheet < static_cast<std::uint32_t>(count); ++sheet) {
    points.insert(points.end(), {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}});
    faces.push_back({4 * sheet, 4 * sheet + 1, 4 * sheet + 2, 4 * sheet + 3});
    if (sheet % 2 == 1) std::reverse(faces.back().begin(), faces.back().end());
    groups.push_back(sheet);
  }
  return with_groups(shapes::from_lists(points, faces), groups);
}

TEST(separate_new_vertices, sheets_that_lie_in_one_another_are_refined_and_share_no_new_vertex) {
  // Three squares, of which the first and the last look the same way.
  const std::vector<Vec3> square{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}};
  std::vector<Vec3> points;
  for (int sheet = 0; sheet < 3; ++sheet)
    for (const Vec3& p : square) points.push_back(p + Vec3{1e6, 2e6, 3e6});
  const PolygonMesh sheets = shapes::from_lists(points, {{0, 1, 2, 3}, {7, 6, 5, 4}, {8, 9, 10, 11}});
  Options options;
  options.max_edge_length = 0.25;
  options.repair.duplicates = false;
  RunControl control;
  const Result result = remesh_surface(sheets, options, {}, control);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.unrefined.empty()) << "nothing stands in the way";
  std::vector<Vec3> positions = result.mesh.positions.items();
  EXPECT_GT(positions.size(), 300u);
  std::sort(positions.begin(), positions.end());
  EXPECT_EQ(std::adjacent_find(positions.begin(), positions.end()), positions.end());
  for (const Vec3& p : positions) EXPECT_NEAR(p.z, 3e6, 1e-9);
}

TEST(separate_new_vertices, only_those_that_are_not_the_first_in_their_place_are_moved) {
  RefinedSheets sheets(sheets_in_one_another(3));
  ASSERT_EQ(sheets.chain().meshes.size(), 3u);
  std::map<Vec3, std::vector<VertexId>> by_place;
  std::vector<VertexId> used = sheets.corners();
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const VertexId v : used) by_place[sheets.place(v)].push_back(v);
  std::vector<std::uint8_t> expected(sheets.chain().surface.vertex_count() + sheets.refinement().new_positions.size());
  std::size_t moved = 0;
  for (const auto& [place, vertices] : by_place)
    for (std::size_t i = 1; i < vertices.size(); ++i)
      if (vertices[i].value >= sheets.first_inner()) {
        expected[vertices[i].value] = 1;
        ++moved;
      }
  ASSERT_GT(moved, 20u);
  const std::vector<Vec3> before = sheets.refinement().new_positions;
  EXPECT_EQ(sheets.separate(), expected);
  for (const VertexId v : used) {
    if (v.value < sheets.chain().surface.vertex_count()) continue;
    const Vec3 from = before[v.value - sheets.chain().surface.vertex_count()], to = sheets.place(v);
    EXPECT_EQ(from != to, expected[v.value] != 0);
    EXPECT_LE(norm(to - from), 1e-11);
  }
  EXPECT_TRUE(sheets.separate().empty()) << "all are apart";
}

TEST(separate_new_vertices, triangles_that_flips_change_lose_their_reasons_and_others_keep_them) {
  // One vertex in the middle is on the circles through the corners and the middles of sides. A move decides which
  // diagonals are Delaunay.
  RefinedSheets sheets(sheets_in_one_another(3), 2.2);
  const std::vector<VertexId> before = sheets.corners();
  ASSERT_FALSE(sheets.separate().empty());
  const std::vector<VertexId> after = sheets.corners();
  std::size_t changed = 0;
  for (std::size_t t = 0; 3 * t < after.size(); ++t) {
    const bool is_changed = !std::equal(after.begin() + static_cast<std::ptrdiff_t>(3 * t),
                                        after.begin() + static_cast<std::ptrdiff_t>(3 * t + 3),
                                        before.begin() + static_cast<std::ptrdiff_t>(3 * t));
    EXPECT_EQ(sheets.refinement().reason[t], is_changed ? UnrefinedReason::kEffort : UnrefinedReason::kInputAngle) << t;
    changed += is_changed ? 1 : 0;
  }
  EXPECT_GT(changed, 0u);
}

TEST(separate_new_vertices, a_vertex_that_no_patch_has_moves_another_only_if_it_counts) {
  // The middle vertex is inside a plane patch, so it is not part of the result. A new vertex may have its place.
  const PolygonMesh fan = shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {1, 1, 0}},
                                             {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  RefinedSheets sheet(fan);
  const VertexId middle = sheet.chain().at({1, 1, 0});
  const std::vector<VertexId> corners = sheet.corners();
  ASSERT_EQ(std::count(corners.begin(), corners.end(), middle), 0);
  std::vector<Vec3>& places = sheet.refinement().new_positions;
  ASSERT_GT(places.size(), sheet.refinement().first_inner);
  places[sheet.refinement().first_inner] = sheet.place(middle);
  const std::vector<Vec3> before = places;
  EXPECT_TRUE(sheet.separate().empty());
  EXPECT_EQ(places, before);
  EXPECT_FALSE(sheet.separate(TwinsOf::kSurface).empty());
  EXPECT_NE(places, before);
}

TEST(separate_new_vertices, sheets_in_one_another_that_the_budget_ends_are_listed_for_that_reason) {
  // Another sheet is so near that it asks for more faces than there may be.
  const PolygonMesh sheets =
      shapes::joined(sheets_in_one_another(3), shapes::moved(sheets_in_one_another(1), {0, 0, 0.02}));
  Options options;
  options.proximity = 0.2;
  options.max_output_faces = 3000;
  options.repair.duplicates = false;
  RunControl control;
  const Report report = remesh_surface(sheets, options, {}, control).report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_GT(listed(report, UnrefinedReason::kBudget), 300u);
  EXPECT_EQ(listed(report, UnrefinedReason::kEffort), 0u);
}

TEST(separate_new_vertices, a_vertex_in_the_place_of_one_that_another_sheet_has_lost_is_moved) {
  // The new vertices of a square tell where another sheet has to have a vertex inside.
  const PolygonMesh square = sheets_in_one_another(1);
  Options options;
  options.max_edge_length = 0.5;
  options.repair.duplicates = options.repair.winding = false;
  const std::vector<Vec3> places = remeshed(square, options).mesh.positions.items();
  const auto inside = std::find_if(places.begin(), places.end(),
                                   [](const Vec3& p) { return p.x > 0 && p.x < 3 && p.y > 0 && p.y < 3; });
  ASSERT_NE(inside, places.end());
  const PolygonMesh fan = shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, *inside},
                                             {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  const Result result = remeshed(with_groups(shapes::joined(square, fan), {0, 1, 1, 1, 1}), options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(listed(result.report), 0u) << "no sheet stays as it was";
  EXPECT_GT(result.mesh.faces.size(), 150u);
}

}  // namespace
}  // namespace remesh
