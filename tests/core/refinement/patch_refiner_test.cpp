#include "core/refinement/refiner/patch_refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "tests/support/invariance.h"
#include "tests/support/patch_subject.h"
#include "tests/support/polygons.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The first patch of a surface, ready to be refined alone.
struct RefinerSubject : PatchSubject {
  using PatchSubject::PatchSubject;

  PatchRefiner refiner(std::uint64_t quota = kNoLimit) {
    return PatchRefiner(patch(), criteria, cuts, quota, scratch, chain.control);
  }
  PatchRefiner::Refined run() {
    PatchRefiner refiner = this->refiner();
    refiner.run(kNoLimit, progress);
    EXPECT_TRUE(refiner.is_done());
    EXPECT_FALSE(refiner.impossible().is_valid());
    return refiner.finish();
  }

  RefinerScratch scratch;
  RefinementProgress progress{chain.control, 1000};
};

struct Measures {
  double smallest_angle_deg = 180, longest = 0, area = 0;
};

Measures measure(const RefinerSubject& subject, const PatchMesh& patch) {
  Measures m;
  const double scale = subject.chart().scale({});
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
    const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
    m.smallest_angle_deg =
        std::min(m.smallest_angle_deg, std::atan2(cross(b - a, c - a), dot(b - a, c - a)) * 180 / std::numbers::pi);
    m.longest = std::max(m.longest, norm(b - a) * scale);
    m.area += cross(b - a, c - a) / 6 * scale * scale;
  }
  return m;
}

/// Expects a valid constrained Delaunay triangulation. Its new vertices on segments are where their cuts say. Neither
/// area nor a vertex of the patch has been lost.
void expect_sound(const RefinerSubject& subject, const PatchRefiner::Refined& refined) {
  const PatchMesh& patch = refined.patch;
  ASSERT_EQ(patch.uv.size(), patch.vertices.size());
  ASSERT_EQ(refined.cuts.size(), patch.vertices.size());
  ASSERT_EQ(refined.reason.size(), patch.mesh.triangle_count());
  expect_valid(patch.uv, patch.mesh);
  expect_locally_delaunay(patch.uv, patch.mesh);
  EXPECT_NEAR(measure(subject, patch).area / measure(subject, subject.chain.meshes[PatchId(0)]).area, 1, 1e-11);
  std::size_t corners = 0;
  const PatchChart chart = subject.chart();
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (patch.vertices[v].is_valid()) {
      ++corners;
      EXPECT_FALSE(refined.cuts[v].segment.is_valid());
    } else if (refined.cuts[v].segment.is_valid()) {
      const Vec3 p = subject.table.position(refined.cuts[v].segment, refined.cuts[v].t);
      EXPECT_LT(norm(p - chart.to_space(patch.uv[v])), 1e-11 * chart.scale(patch.uv[v]));
    }
  }
  EXPECT_EQ(corners, subject.chain.meshes[PatchId(0)].vertices.size());
}

TEST(patch_refiner, every_angle_meets_the_bound_where_the_input_has_no_smaller_one) {
  for (const double degrees : {10.0, 20.7, 25.0, 30.0, 33.0})
    for (const auto& polygon : {polygons::Polygon{{{0, 0}, {20, 0}, {20, 1}, {0, 1}}, {}}, polygons::l_shape(),
                                polygons::sieve(3), polygons::comb(4, 3), polygons::rectilinear_with_holes(5, 6)}) {
      RefinerSubject subject(solids::region(polygon), with_angle(degrees));
      const PatchRefiner::Refined refined = subject.run();
      expect_sound(subject, refined);
      EXPECT_GE(measure(subject, refined.patch).smallest_angle_deg, degrees);
    }
}

TEST(patch_refiner, at_a_small_input_angle_what_misses_the_bound_has_an_excuse) {
  for (const double tip : {1.0, 10.0, 24.0}) {
    const double angle = tip * std::numbers::pi / 180;
    RefinerSubject subject(shapes::polygon({{0, 0}, {7, 0}, {7 * std::cos(angle), 7 * std::sin(angle) + 0.5}}),
                           with_angle(30));
    const PatchRefiner::Refined refined = subject.run();
    expect_sound(subject, refined);
    std::map<UnrefinedReason, int> missed;
    const PatchMesh& patch = refined.patch;
    for (std::uint32_t t = 0; t < patch.mesh.triangle_count(); ++t)
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
        if (std::atan2(cross(b - a, c - a), dot(b - a, c - a)) < 30 * std::numbers::pi / 180)
          ++missed[refined.reason[t]];
      }
    EXPECT_EQ(missed[UnrefinedReason::kInputAngle], 1);
    missed.erase(UnrefinedReason::kInputAngle);
    missed.erase(UnrefinedReason::kAcrossInputAngle);
    EXPECT_TRUE(missed.empty());
  }
}

TEST(patch_refiner, no_edge_and_no_area_is_above_its_bound) {
  for (const double length : {0.5, 0.2, 0.07}) {
    Options options;
    options.max_edge_length = length;
    RefinerSubject subject(solids::region(polygons::l_shape()), options);
    const PatchRefiner::Refined refined = subject.run();
    expect_sound(subject, refined);
    EXPECT_LE(measure(subject, refined.patch).longest, length * (1 + 1e-9));
    EXPECT_GE(measure(subject, refined.patch).smallest_angle_deg, 25);
  }
  Options options;
  options.max_area = 0.01;
  RefinerSubject subject(solids::region(polygons::l_shape()), options);
  const PatchRefiner::Refined refined = subject.run();
  for (std::uint32_t h = 0; h < refined.patch.mesh.half_edge_count(); h += 3) {
    const PatchMesh& patch = refined.patch;
    const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
    const double scale = subject.chart().scale(a);
    EXPECT_LE(cross(b - a, c - a) / 2 * scale * scale, 0.01 * (1 + 1e-9));
  }
}

TEST(patch_refiner, has_work_is_false_only_where_nothing_would_change) {
  const auto has_work = [](const PolygonMesh& mesh, const Options& options) {
    const RefinerSubject subject(mesh, options);
    return PatchRefiner::has_work(subject.chain.meshes[PatchId(0)], subject.chart(), subject.criteria);
  };
  const PolygonMesh square = shapes::sheet(1, 1, 1, 1), strip = shapes::sheet(10, 1, 1, 1);
  EXPECT_FALSE(has_work(square, with_angle(30)));
  EXPECT_TRUE(has_work(strip, with_angle(30)));
  Options size;
  size.max_edge_length = 2;
  EXPECT_FALSE(has_work(square, size));
  size.max_edge_length = 1;
  EXPECT_TRUE(has_work(square, size)) << "the diagonal";
  Options area;
  area.max_area = 0.5;
  EXPECT_FALSE(has_work(square, area));
  area.max_area = 0.49;
  EXPECT_TRUE(has_work(square, area));
}

std::vector<Cut> own_cuts(PatchRefiner& refiner) {
  std::vector<Cut> cuts;
  refiner.take_own_cuts(cuts);
  return cuts;
}

TEST(patch_refiner, its_own_cuts_are_told_once_and_are_all_there_are) {
  RefinerSubject subject(shapes::sheet(40, 1, 1, 1), with_angle(30));
  PatchRefiner refiner = subject.refiner();
  refiner.run(kNoLimit, subject.progress);
  std::vector<Cut> own = own_cuts(refiner);
  EXPECT_TRUE(own_cuts(refiner).empty());
  std::sort(own.begin(), own.end());
  std::vector<Cut> in_result;
  for (const Cut& cut : refiner.finish().cuts)
    if (cut.segment.is_valid()) in_result.push_back(cut);
  std::sort(in_result.begin(), in_result.end());
  EXPECT_GT(own.size(), 10u);
  EXPECT_EQ(own, in_result);
}

TEST(patch_refiner, cuts_of_others_are_applied_each_once) {
  RefinerSubject subject(shapes::sheet(4, 1, 1, 1), with_angle(20));
  PatchRefiner refiner = subject.refiner();
  const std::vector<double> some{0.25, 0.5}, all{0.125, 0.25, 0.5, 0.75};
  for (const auto& cuts : {some, all, all}) refiner.apply_cuts(SegmentId(0), cuts, subject.chain.control);
  EXPECT_TRUE(own_cuts(refiner).empty()) << "what others cut is not told again";
  refiner.run(0, subject.progress);
  const PatchRefiner::Refined refined = refiner.finish();
  expect_sound(subject, refined);
  std::vector<double> found;
  for (const Cut& cut : refined.cuts)
    if (cut.segment == SegmentId(0)) found.push_back(cut.t);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, all);
}

TEST(patch_refiner, the_cuts_of_two_patches_are_of_one_tree) {
  // The cuts of two patches fit together: if either applies the cuts of the other, both end alike.
  RefinerSubject subject(shapes::box({10, 1, 0.3}), with_angle(30));
  std::vector<std::vector<Cut>> own;
  for (std::uint32_t p = 0; p < 6; ++p) {
    PatchRefiner refiner(subject.patch(PatchId(p)), subject.criteria, subject.cuts, kNoLimit, subject.scratch,
                         subject.chain.control);
    refiner.run(kNoLimit, subject.progress);
    own.push_back(own_cuts(refiner));
  }
  for (std::uint32_t s = 0; s < subject.table.size(); ++s) {
    std::vector<double> cuts;
    for (const auto& list : own)
      for (const Cut& cut : list)
        if (cut.segment == SegmentId(s)) cuts.push_back(cut.t);
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    // A tree: each piece's parent was cut at one place only, so pieces are halves of halves.
    double shortest = 1, last = 0;
    cuts.push_back(1);
    for (const double t : cuts) {
      shortest = std::min(shortest, t - last);
      last = t;
    }
    EXPECT_GE(shortest * subject.table[SegmentId(s)].length, subject.table[SegmentId(s)].floor);
  }
}

TEST(patch_refiner, it_stops_at_its_quota_and_goes_on_from_there) {
  RefinerSubject subject(shapes::sheet(100, 1, 1, 1), with_angle(30));
  PatchRefiner refiner = subject.refiner();
  const std::uint32_t before = refiner.triangle_count();
  refiner.run(50, subject.progress);
  EXPECT_FALSE(refiner.is_done());
  EXPECT_GT(refiner.triangle_count(), before);
  EXPECT_LE(refiner.triangle_count(), before + 50);
  const PatchRefiner::Refined half = refiner.finish();
  expect_sound(subject, half);
  EXPECT_NE(std::count(half.reason.begin(), half.reason.end(), UnrefinedReason::kBudget), 0);
  refiner.run(kNoLimit, subject.progress);
  EXPECT_TRUE(refiner.is_done());
  EXPECT_GE(measure(subject, refiner.finish().patch).smallest_angle_deg, 30);
}

TEST(patch_refiner, patches_take_turns_with_one_scratch_memory) {
  RefinerSubject alone(shapes::sheet(100, 1, 1, 1), with_angle(30)),
      subject(shapes::sheet(100, 1, 1, 1), with_angle(30));
  const PatchRefiner::Refined expected = alone.run();
  RefinerScratch another;
  std::vector<std::unique_ptr<PatchRefiner>> refiners;
  for (int i = 0; i < 2; ++i) {
    refiners.push_back(std::make_unique<PatchRefiner>(subject.patch(), subject.criteria, subject.cuts, kNoLimit,
                                                      subject.scratch, subject.chain.control));
    refiners[i]->end_turn();
    EXPECT_EQ(subject.scratch.waiting.size(), 0u) << "what waits stays with its patch";
  }
  // They are stopped again and again, and use one scratch memory at one time and another one at another time.
  for (int turn = 0; !refiners[0]->is_done() || !refiners[1]->is_done(); ++turn) {
    ASSERT_LT(turn, 1000);
    PatchRefiner& refiner = *refiners[static_cast<std::size_t>(turn) % 2];
    refiner.begin_turn(turn % 3 == 0 ? another : subject.scratch);
    refiner.run(7, subject.progress);
    refiner.end_turn();
  }
  for (const auto& refiner : refiners) {
    const PatchRefiner::Refined refined = refiner->finish();
    EXPECT_EQ(refined.patch.uv, expected.patch.uv);
    EXPECT_EQ(refined.cuts, expected.cuts);
  }
}

TEST(patch_refiner, boundaries_that_are_locked_get_no_vertex) {
  Options options = with_angle(30);
  options.split_boundaries = false;
  RefinerSubject subject(shapes::sheet(10, 1, 1, 1), options);
  const PatchRefiner::Refined refined = subject.run();
  expect_sound(subject, refined);
  for (const Cut& cut : refined.cuts) EXPECT_FALSE(cut.segment.is_valid());
  EXPECT_NE(std::count(refined.reason.begin(), refined.reason.end(), UnrefinedReason::kBoundaryLocked), 0);
}

TEST(patch_refiner, edges_inside_are_split_while_they_are_there) {
  RefinerSubject subject(shapes::sheet(1, 1, 1, 1), with_angle(0));
  PatchRefiner refiner = subject.refiner();
  const Triangulation2d& mesh = subject.chain.meshes[PatchId(0)].mesh;
  std::vector<std::uint32_t> both;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
    if (!mesh.is_constrained(h)) both.push_back(h);
  ASSERT_EQ(both.size(), 2u);  // the diagonal, from both sides
  EXPECT_TRUE(refiner.split_edges(both, subject.chain.control));
  EXPECT_EQ(refiner.triangle_count(), 4u);
  const PatchRefiner::Refined split = refiner.finish();
  EXPECT_EQ(split.patch.vertices.size(), 5u);
  // Edges on the boundary are no inner edges, so none of them is split.
  std::vector<std::uint32_t> rim;
  for (std::uint32_t h = 0; h < split.patch.mesh.half_edge_count(); ++h)
    if (split.patch.mesh.is_constrained(h)) rim.push_back(h);
  EXPECT_FALSE(refiner.split_edges(rim, subject.chain.control));
  EXPECT_EQ(refiner.triangle_count(), 4u);
}

double largest_area(const RefinerSubject& subject, const PatchMesh& patch) {
  const double scale = subject.chart().scale({});
  double largest = 0;
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
    const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
    largest = std::max(largest, cross(b - a, c - a) / 2 * scale * scale);
  }
  return largest;
}

double shortest_edge(const RefinerSubject& subject, const PatchMesh& patch) {
  const double scale = subject.chart().scale({});
  double least = HUGE_VAL;
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
    least = std::min(least, norm(patch.uv[patch.mesh.to(h)] - patch.uv[patch.mesh.from(h)]) * scale);
  return least;
}

/// Returns the least shape of all triangles. The shape is twice the area over the sum of the squared edges.
double least_shape(const PatchMesh& patch) {
  double least = HUGE_VAL;
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
    const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
    least = std::min(least, cross(b - a, c - a) / (dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c)));
  }
  return least;
}

TEST(patch_refiner, thinned_out_it_has_fewer_faces_within_the_same_bounds) {
  for (const double degrees : {0.0, 20.0, 30.0})
    for (const bool is_by_area : {false, true})
      for (const auto& polygon :
           {polygons::sieve(3), polygons::star_with_holes(3, 20, 3), polygons::grown(5, 40, 30)}) {
        Options options = with_angle(degrees);
        const auto [low, high] = std::minmax_element(polygon.outer.begin(), polygon.outer.end());
        const double length = (high->x - low->x) / 30;
        if (is_by_area)
          options.max_area = length * length / 3;
        else
          options.max_edge_length = length;
        RefinerSubject subject(solids::region(polygon), options);
        PatchRefiner refiner = subject.refiner();
        refiner.run(kNoLimit, subject.progress);
        ASSERT_TRUE(refiner.is_done());
        const PatchRefiner::Refined before = refiner.finish();
        refiner.thin_out(Thinning::kFull, subject.chain.control, subject.progress);
        EXPECT_TRUE(refiner.is_done());
        const PatchRefiner::Refined after = refiner.finish();
        expect_sound(subject, after);
        // The share is pinned from a run and may change with the algorithm.
        EXPECT_LT(after.patch.mesh.triangle_count(), 0.995 * before.patch.mesh.triangle_count())
            << degrees << " degrees, " << (is_by_area ? "by area" : "by length");
        EXPECT_LE(measure(subject, after.patch).longest, options.max_edge_length.value_or(HUGE_VAL) * (1 + 1e-9));
        EXPECT_LE(largest_area(subject, after.patch), options.max_area.value_or(HUGE_VAL) * (1 + 1e-9));
        EXPECT_GE(measure(subject, after.patch).smallest_angle_deg,
                  std::min(degrees, measure(subject, before.patch).smallest_angle_deg));
        EXPECT_GE(least_shape(after.patch), std::min(0.165, least_shape(before.patch)) * (1 - 1e-9));
        // Only points inside the patch are removed.
        const auto cuts_of = [](const PatchRefiner::Refined& refined) {
          return std::count_if(refined.cuts.begin(), refined.cuts.end(),
                               [](const Cut& cut) { return cut.segment.is_valid(); });
        };
        EXPECT_EQ(cuts_of(after), cuts_of(before));
      }
}

TEST(patch_refiner, thinned_out_no_edge_becomes_shorter_than_the_shortest_allowed) {
  int thinned = 0;
  for (const double length : {0.11, 0.083, 0.061, 0.047, 0.036})
    for (const double share : {0.4, 0.55, 0.7})
      for (const double degrees : {0.0, 20.0}) {
        Options options = with_angle(degrees);
        options.max_edge_length = length;
        options.min_edge_length = share * length;
        const polygons::Polygon polygon{{{0, 0}, {1, 0.1}, {1.2, 0.7}, {0.6, 1.1}, {0.1, 0.8}}, {}};
        RefinerSubject subject(solids::region(polygon), options);
        PatchRefiner refiner = subject.refiner();
        refiner.run(kNoLimit, subject.progress);
        const std::uint32_t faces = refiner.triangle_count();
        refiner.thin_out(Thinning::kFull, subject.chain.control, subject.progress);
        thinned += refiner.triangle_count() < faces ? 1 : 0;
        EXPECT_GE(shortest_edge(subject, refiner.finish().patch), *options.min_edge_length)
            << share << " of " << length << " at " << degrees;
      }
  EXPECT_GT(thinned, 10);
}

STAGE(thinning_out, test::kStop) {
  RefinerSubject subject(solids::region(polygons::star_with_holes(3, 20, 3)), with_length(0.02));
  PatchRefiner refiner = subject.refiner();
  refiner.run(kNoLimit, subject.progress);
  RefinementProgress progress(subject.chain.control, 1);
  refiner.thin_out(Thinning::kFull, trial.control, progress);
}

TEST(patch_refiner, without_sizes_nothing_is_thinned_out) {
  RefinerSubject subject(solids::region(polygons::sieve(3)), with_angle(30));
  PatchRefiner refiner = subject.refiner();
  refiner.run(kNoLimit, subject.progress);
  const std::uint32_t before = refiner.triangle_count();
  refiner.thin_out(Thinning::kFull, subject.chain.control, subject.progress);
  EXPECT_EQ(refiner.triangle_count(), before);
}

STAGE(patch_refiner, test::kStop) {
  RefinerSubject subject(shapes::sheet(1, 1, 1, 1), with_length(0.005));
  RefinementProgress progress(trial.control, 1);
  PatchRefiner(subject.patch(), subject.criteria, subject.cuts, kNoLimit, subject.scratch, trial.control)
      .run(kNoLimit, progress);
}

}  // namespace
}  // namespace remesh
