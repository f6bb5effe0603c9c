#include "core/output/report/warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "core/output/report/surface_words.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Gives each patch a surface of its kind. `kinds` has one entry per surface, and `of_patch` one per patch.
RecognisedSurfaces recognised(std::initializer_list<SurfaceKind> kinds, const std::vector<std::size_t>& of_patch) {
  RecognisedSurfaces made;
  for (const SurfaceKind kind : kinds) {
    RecognisedSurface surface;
    surface.shape.kind = kind;
    made.surfaces.push_back(surface);
  }
  for (const std::size_t surface : of_patch) made.of_patch.push_back(SurfaceId(surface));
  return made;
}

/// A box of 12 triangles, two in each of its 6 patches.
class a_box : public testing::Test {
 protected:
  std::vector<Diagnostic> warned(const RecognisedSurfaces& surfaces, double faces_of_patch = 10,
                                 RefinedFaces::Are are = RefinedFaces::Are::kCounted) const {
    std::vector<Diagnostic> diagnostics;
    const RefinedFaces refined{[&](PatchId) { return faces_of_patch; }, are};
    warn_of_curved_surfaces(chain_.surface, chain_.patches, surfaces, refined, diagnostics);
    return diagnostics;
  }

  const StageChain chain_{shapes::box({1, 1, 1})};
};

TEST_F(a_box, of_planes_alone_is_not_warned_of) {
  EXPECT_THAT(warned(recognised({SurfaceKind::kPlane}, {0, 0, 0, 0, 0, 0})), IsEmpty());
}

TEST_F(a_box, whose_facets_are_pairs_of_triangles_of_a_cylinder_is_warned_of) {
  const auto found = warned(recognised({SurfaceKind::kPlane, SurfaceKind::kCylinder}, {0, 1, 1, 1, 1, 0}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, DiagnosticCode::kCurvedSurface);
  EXPECT_EQ(found[0].count, 8u);
  std::vector<std::uint64_t> expected;
  for (std::size_t f = 0; f < 12; ++f) {
    const PatchId p = chain_.patch_of(f);
    if (p != PatchId(0) && p != PatchId(5)) expected.push_back(f);
  }
  EXPECT_EQ(found[0].elements, expected);
  EXPECT_EQ(found[0].message,
            "found 1 cylinder, made of 4 facets; each stays flat as a patch of its own, and refinement made 40 faces "
            "of them; another surface_tolerance (above 0), elements_per_circle or feature_angle_deg may let curved "
            "surfaces be remeshed as a whole");
}

TEST_F(a_box, is_told_with_all_its_kinds_and_what_is_predicted_is_rounded) {
  const auto found = warned(recognised({SurfaceKind::kPlane, SurfaceKind::kCylinder, SurfaceKind::kCylinder,
                                        SurfaceKind::kTorus, SurfaceKind::kFree},
                                       {0, 1, 2, 3, 4, 4}),
                            1234.5, RefinedFaces::Are::kPredicted);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].count, 10u);
  EXPECT_EQ(found[0].message,
            "found 2 cylinders, 1 torus and 1 free region, made of 5 facets; each stays flat as a patch of its own, "
            "and refinement makes about 6,200 faces of them; another surface_tolerance (above 0), elements_per_circle "
            "or feature_angle_deg may let curved surfaces be remeshed as a whole; another feature_angle_deg may let a "
            "free region be recognised as a cylinder, cone, sphere or torus");
}

TEST_F(a_box, with_a_small_free_region_is_a_polyhedron) {
  EXPECT_THAT(warned(recognised({SurfaceKind::kPlane, SurfaceKind::kFree}, {0, 0, 0, 0, 1, 1})), IsEmpty());
}

TEST(warn_of_curved_surfaces, a_large_free_region_is_warned_of_and_the_first_hundred_faces_are_listed) {
  const StageChain chain(shapes::sphere(2));
  RecognisedSurfaces surfaces = recognised({SurfaceKind::kFree}, {});
  surfaces.of_patch.resize(chain.patches.count(), SurfaceId(0));
  std::vector<Diagnostic> diagnostics;
  warn_of_curved_surfaces(chain.surface, chain.patches, surfaces, {[](PatchId) { return 1.0; }}, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].count, chain.surface.face_count());
  ASSERT_EQ(diagnostics[0].elements.size(), Diagnostic::kMaxElements);
  EXPECT_EQ(diagnostics[0].elements.back(), Diagnostic::kMaxElements - 1);
  EXPECT_THAT(diagnostics[0].message, HasSubstr("feature_angle_deg may let a free region be recognised"));
  EXPECT_THAT(diagnostics[0].message, Not(HasSubstr("may let curved surfaces")));
  EXPECT_THAT(diagnostics[0].message, Not(HasSubstr("coarser")));
  EXPECT_THAT(diagnostics[0].remedies, IsEmpty());
}

TEST(warn_of_curved_surfaces, a_free_region_that_may_become_coarser_is_told_with_the_option_and_what_it_makes) {
  const StageChain chain(shapes::sphere(2));
  RecognisedSurfaces surfaces = recognised({SurfaceKind::kFree}, {});
  surfaces.of_patch.resize(chain.patches.count(), SurfaceId(0));
  const auto warned = [&](const FreeAdvice& free) {
    std::vector<Diagnostic> diagnostics;
    warn_of_curved_surfaces(chain.surface, chain.patches, surfaces, {[](PatchId) { return 1.0; }}, diagnostics, nullptr,
                            free);
    return diagnostics;
  };
  const auto found = warned({true, true, 1694.2});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].message,
              HasSubstr("; surface_tolerance (above 0) or elements_per_circle makes free regions coarser, within a "
                        "proven distance of the input (elements_per_circle=16 makes about 1,700 faces of them); "));
  ASSERT_EQ(found[0].remedies.size(), 1u);
  EXPECT_EQ(found[0].remedies[0].options, "elements_per_circle=16");
  EXPECT_THAT(warned({true, true, std::nullopt})[0].message, HasSubstr("within a proven distance of the input; "));
  EXPECT_THAT(warned({false, true, 1694.2}), IsEmpty());
}

TEST(warn_of_curves, a_surface_whose_facets_are_patches_of_their_own_is_warned_of) {
  std::vector<Diagnostic> diagnostics;
  const StageChain flat(shapes::quad_box({1, 1, 1}, 4)), round(shapes::sphere(2));
  warn_of_curves(flat.surface, flat.patches, diagnostics);
  EXPECT_THAT(diagnostics, IsEmpty());
  warn_of_curves(round.surface, round.patches, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].count, round.surface.face_count());
  EXPECT_THAT(diagnostics[0].message, HasSubstr("a feature_angle_deg above 0"));
}

TEST(surface_words, a_kind_is_named_by_its_number) {
  const auto text = [](std::uint64_t count, SurfaceKind kind) { return count_text(count, kind); };
  EXPECT_EQ(text(1, SurfaceKind::kTorus), "1 torus");
  EXPECT_EQ(text(2, SurfaceKind::kTorus), "2 tori");
  EXPECT_EQ(text(1252, SurfaceKind::kPlane), "1,252 planes");
  EXPECT_EQ(text(0, SurfaceKind::kFree), "0 free regions");
}

}  // namespace
}  // namespace remesh
