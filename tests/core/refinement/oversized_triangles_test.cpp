#include "core/refinement/rounds/oversized_triangles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/refinement/goals/unrefined.h"
#include "tests/support/hostile_families.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kPlaneTolerance = 1e-9;

Goals goals_with(double proximity, double min_edge_length) {
  Goals goals;
  goals.max_edge_length = std::numeric_limits<double>::infinity();
  goals.max_area = std::numeric_limits<double>::infinity();
  goals.max_faces = 1u << 20;
  goals.proximity = proximity;
  goals.gradation = 1.5;
  goals.min_edge_length = min_edge_length;
  return goals;
}

/// A surface that nobody has refined, and what its triangles miss.
class MissScene {
 public:
  MissScene(const PolygonMesh& mesh, const Goals& goals)
      : chain_(mesh, kPlaneTolerance),
        goals_(goals),
        gaps_(chain_.surface, chain_.adjacency, chain_.patches, kPlaneTolerance, chain_.control, &chain_.triangulated),
        sizes_(chain_.surface, &gaps_, {}, goals, kPlaneTolerance, chain_.control) {}

  /// All triangles have a reason at first that any miss replaces.
  Refinement note(int threads) {
    Refinement refinement;
    refinement.reason.assign(chain_.triangulated.triangle_count(), UnrefinedReason::kInputAngle);
    const IdVector<PatchId, std::uint8_t> is_frozen(chain_.meshes.size(), 0);
    tbb::task_arena(threads).execute([&] {
      record_oversized_triangles(chain_.surface, chain_.meshes, is_frozen,
                                 {goals_, kPlaneTolerance, sizes_, &gaps_, nullptr}, refinement, chain_.control);
    });
    refinement.misses_sizes.resize(refinement.reason.size());
    return refinement;
  }

  struct Miss {
    bool is_below_floor = false, is_above_floor = false;  ///< what places of the triangle ask for
    bool is_any() const { return is_below_floor || is_above_floor; }
  };
  /// Looks for the smallest gap at each place of each triangle, with no bound. A gap that is as large as an edge times
  /// the proximity matters to nobody.
  std::vector<Miss> all_misses() const {
    std::vector<Miss> all;
    for (std::uint32_t p = 0; p < chain_.meshes.size(); ++p)
      for (std::uint32_t t = 0; t < chain_.meshes[PatchId(p)].mesh.triangle_count(); ++t)
        all.push_back(miss(PatchId(p), t));
    return all;
  }

 private:
  Miss miss(PatchId p, std::uint32_t t) const {
    const PatchMesh& patch = chain_.meshes[p];
    const auto corner = [&](std::uint32_t k) {
      return chain_.surface.positions[patch.vertices[patch.mesh.from(3 * t + k % 3)]];
    };
    std::array<Vec3, 4> places;
    for (std::uint32_t k = 0; k < 3; ++k) {
      places[k] = 0.5 * (corner(k) + corner(k + 1));
      places[3] += (1.0 / 3) * corner(k);
    }
    double longest = 0;
    for (std::uint32_t k = 0; k < 3; ++k) longest = std::max(longest, norm(corner(k + 1) - corner(k)));
    Miss miss;
    for (const Vec3& place : places) {
      const double size = (gaps_.at(place, p, longest * goals_.proximity) + kPlaneTolerance) / goals_.proximity;
      bool is_missed = false;
      for (std::uint32_t k = 0; k < 3; ++k)
        is_missed = is_missed || norm(corner(k + 1) - corner(k)) >
                                     Goals::kSizeSlack * (size + goals_.size_slope() * norm(places[k] - place));
      if (is_missed) (size > sizes_.floor() ? miss.is_above_floor : miss.is_below_floor) = true;
    }
    return miss;
  }

  StageChain chain_;
  Goals goals_;
  GapSearch gaps_;
  SizeField sizes_;
};

PolygonMesh small_triangles(int triangles, double size) {
  Random random(20);
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto point = [&] {
    const double x = random.unit(), y = random.unit();
    return Vec3{x, y, random.unit()};
  };
  for (int i = 0; i < triangles; ++i) {
    const Vec3 middle = point();
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int k = 0; k < 3; ++k) positions.push_back(middle + size * point());
    faces.push_back({first, first + 1, first + 2});
  }
  return shapes::from_lists(positions, faces);
}

TEST(oversized_triangles, are_those_of_searches_for_the_smallest_gaps) {
  // Most gaps are far below the first floor, and some are below the second. The third is the one of all surfaces.
  int below = 0, above = 0, none = 0;
  for (const double min_edge_length : {0.5, 0.04, 0.0}) {
    MissScene scene(small_triangles(400, 0.3), goals_with(0.5, min_edge_length));
    const std::vector<MissScene::Miss> all = scene.all_misses();
    const Refinement noted = scene.note(1);
    ASSERT_EQ(noted.misses_sizes.size(), all.size());
    for (std::size_t t = 0; t < all.size(); ++t) {
      ASSERT_EQ(noted.misses_sizes[t] != 0, all[t].is_any()) << min_edge_length << ' ' << t;
      if (!all[t].is_any()) {
        ++none;
      } else if (!all[t].is_above_floor) {
        const bool is_asked = min_edge_length > 0;
        EXPECT_EQ(noted.reason[t], is_asked ? UnrefinedReason::kMinEdgeLength : UnrefinedReason::kSizeFloor) << t;
        ++below;
      } else if (!all[t].is_below_floor) {
        EXPECT_EQ(noted.reason[t], UnrefinedReason::kEffort) << t;
        ++above;
      }
    }
  }
  EXPECT_GT(below, 50);
  EXPECT_GT(above, 50);
  EXPECT_GT(none, 50);
}

TEST(oversized_triangles, what_was_not_looked_at_behind_the_bound_misses_its_sizes) {
  // Nearly every search goes through all of these needles, and hardly one finds a gap.
  MissScene scene(hostile::family("polygon_in_space").make(5000), goals_with(1e-4, 0));
  const std::vector<MissScene::Miss> all = scene.all_misses();
  const Refinement noted = scene.note(1);
  ASSERT_EQ(noted.misses_sizes.size(), all.size());
  int unknown = 0, known = 0;
  for (std::size_t t = 0; t < all.size(); ++t) {
    EXPECT_TRUE(noted.misses_sizes[t] != 0 || !all[t].is_any()) << t;
    known += noted.misses_sizes[t] == 0 ? 1 : 0;
    if (noted.misses_sizes[t] == 0 || all[t].is_any()) continue;
    EXPECT_EQ(noted.misses_sizes[t], kMayMissSizes) << t;
    EXPECT_EQ(noted.reason[t], UnrefinedReason::kEffort) << t;
    ++unknown;
  }
  EXPECT_GT(unknown, 100);
  EXPECT_GT(known, 20);

  const tbb::global_control eight(tbb::global_control::max_allowed_parallelism, 8);
  const Refinement others = scene.note(8);
  EXPECT_EQ(others.misses_sizes, noted.misses_sizes);
  EXPECT_EQ(others.reason, noted.reason);
}

}  // namespace
}  // namespace remesh
