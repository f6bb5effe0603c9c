// Compares rounded coordinates with the verified ones. Covers each test of the check, and all of them against a
// brute-force oracle.
#include "core/verify/rounded_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/rounded_to_float.h"
#include "core/remesh.h"
#include "tests/support/cgal_space.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

/// A verified mesh and what is claimed of it once it is stored.
struct Stored {
  Result result;
  std::vector<Vec3> points;
  Vec3 origin;
  Storage storage = Storage::kDouble;
  double allowed = 1e3;
  std::optional<UnrefinedFaces> unrefined;  ///< empty if the listed faces are those of the result

  explicit Stored(const PolygonMesh& mesh, const Options& options = remesh::unrefined()) {
    RunControl control;
    result = remesh_surface(mesh, options, {}, control);
    points = result.mesh.positions.items();
  }

  RoundedVerdict check() const {
    const UnrefinedFaces& now = unrefined ? *unrefined : result.rounding_input.unrefined;
    const RefinementClaim refined{result.rounding_input.goals, now.faces, now.reasons};
    RoundedClaim claim;
    claim.positions = result.mesh.positions.items();
    claim.stored = points;
    claim.origin = origin;
    claim.storage = storage;
    claim.faces = result.mesh.faces.items();
    claim.face_patch = result.face_patch.items();
    claim.normals = result.rounding_input.normals.items();
    claim.allowed_move = allowed;
    claim.intersections = &result.rounding_input.intersections;
    claim.refinement = result.rounding_input.is_refined ? &refined : nullptr;
    claim.unrefined_before = result.rounding_input.unrefined.faces;
    claim.reasons_before = result.rounding_input.unrefined.reasons;
    claim.misses_sizes_before = result.rounding_input.unrefined.misses_sizes;
    RunControl control;
    return check_rounded(claim, control);
  }
  /// Returns the vertex at a place.
  std::size_t at(const Vec3& place) const {
    const auto& all = result.mesh.positions.items();
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), place) - all.begin());
  }
  Vec3& point(const Vec3& place) { return points.at(at(place)); }
};

Options with_edges(double longest) {
  Options options;
  options.max_edge_length = longest;
  return options;
}

TEST(rounded_check, the_same_points_pass_and_small_moves_are_measured) {
  Stored box(shapes::box({3, 2, 1}, 2));
  EXPECT_FALSE(box.check().fault);
  EXPECT_EQ(box.check().largest_move, 0);
  EXPECT_FALSE(box.check().has_intersections);
  box.point({3, 2, 1}) += {0, 0, 0.25};
  const RoundedVerdict verdict = box.check();
  EXPECT_FALSE(verdict.fault);
  EXPECT_DOUBLE_EQ(verdict.largest_move, 0.25);
  EXPECT_TRUE(verdict.has_intersections);
  // The corner is one of three of the six patches.
  EXPECT_EQ(std::count(verdict.patch_moves.begin(), verdict.patch_moves.end(), 0.25), 3);
  EXPECT_EQ(std::count(verdict.patch_moves.begin(), verdict.patch_moves.end(), 0.0), 3);
  // Pulling the corner up adds a tetrahedron or two over the top's triangles there: up to 0.25 * 6 / 3.
  EXPECT_GE(verdict.volume_bound, 0.25);
  box.allowed = 0.2;
  EXPECT_EQ(box.check().fault, RoundedFault::kMoved);
  EXPECT_EQ(box.check().count, 1u);
}

TEST(rounded_check, a_move_is_what_a_reader_sees_who_adds_the_origin) {
  Stored box(shapes::moved(shapes::box({3, 2, 1}), {1e6, 0, 0}));
  box.origin = {1e6, 0, 0};
  for (Vec3& p : box.points) p = p - box.origin;
  EXPECT_FALSE(box.check().fault);
  EXPECT_EQ(box.check().largest_move, 0);
  box.origin.x += 0.5;
  EXPECT_DOUBLE_EQ(box.check().largest_move, 0.5);
}

TEST(rounded_check, numbers_are_those_of_the_storage_and_finite) {
  Stored box(shapes::box({3, 2, 0.1}));
  EXPECT_FALSE(box.check().fault);
  box.storage = Storage::kFloat;
  EXPECT_EQ(box.check().fault, RoundedFault::kNotStorable);
  EXPECT_EQ(box.check().count, 4u);
  for (Vec3& p : box.points) p.z = rounded_to_float(p.z);
  EXPECT_FALSE(box.check().fault);
  box.points[0].x = std::numeric_limits<double>::infinity();
  EXPECT_EQ(box.check().fault, RoundedFault::kBeyondRange);
  box.points.pop_back();
  EXPECT_EQ(box.check().fault, RoundedFault::kMalformed);
}

TEST(rounded_check, vertices_in_one_place_are_counted) {
  Stored box(shapes::box({3, 2, 1}));
  box.point({3, 2, 1}) = {0, 0, 0};
  const RoundedVerdict verdict = box.check();
  EXPECT_EQ(verdict.fault, RoundedFault::kMerged);
  EXPECT_EQ(verdict.count, 1u);
}

TEST(rounded_check, triangles_that_are_flat_or_turned_over_are_counted) {
  // The middle of a fan is pulled onto its rim, and beyond.
  const PolygonMesh fan = shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 1}},
                                             {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  for (const double y : {0.0, -0.5}) {
    Stored stored(fan);
    stored.point({2, 2, 1}) = {2, y, 0};
    EXPECT_EQ(stored.check().fault, RoundedFault::kTurnedOver) << y;
    EXPECT_EQ(stored.check().count, 1u) << y;
  }
}

/// The two prongs of a slotted plate lean towards each other. From a quarter on they lie over each other.
Vec3 leaning(Vec3 p, double lean) {
  if (p.y > 1) p.x += (p.x < 2.5 ? lean : -lean) * (p.y - 1);
  return p;
}

TEST(rounded_check, a_slot_of_a_large_patch_that_closes_is_seen_though_no_triangle_turns_over) {
  Stored plate(shapes::slotted_plate(1), with_edges(0.7));
  ASSERT_GT(plate.result.mesh.faces.size(), 30u);
  EXPECT_EQ(plate.result.rounding_input.normals.size(), 1u);
  plate.result.rounding_input.is_refined = false;  // sizes are not what is tested here
  // The slot is between x = 2 and x = 3, from y = 1 on. The prongs beside it lean towards each other, and over.
  for (const double lean : {0.2, 0.6}) {
    for (std::size_t v = 0; v < plate.points.size(); ++v)
      plate.points[v] = leaning(plate.result.mesh.positions[VertexId(v)], lean);
    if (lean < 0.25) {
      EXPECT_FALSE(plate.check().fault);
    }
  }
  EXPECT_EQ(plate.check().fault, RoundedFault::kNewIntersections);
}

TEST(rounded_check, patches_that_come_to_lie_in_each_other_are_seen_and_known_ones_are_not_new) {
  const PolygonMesh two = shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::box({1, 1, 1}), {2, 0, 0}));
  Stored boxes(two);
  for (Vec3& p : boxes.points)
    if (p.x >= 2) p.x -= 1.5;
  EXPECT_EQ(boxes.check().fault, RoundedFault::kNewIntersections);
  Stored sunk(shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::box({1, 1, 1}), {0.5, 0.5, 0.5})));
  ASSERT_FALSE(sunk.result.rounding_input.intersections.patches.empty());
  for (Vec3& p : sunk.points) p.x *= 1.001;
  EXPECT_FALSE(sunk.check().fault);
  EXPECT_FALSE(sunk.check().intersections.empty());
}

TEST(rounded_check, what_rounding_costs_is_listed_and_nothing_else) {
  Stored box(shapes::box({3, 3, 3}), with_edges(1.5));
  ASSERT_TRUE(box.result.rounding_input.unrefined.faces.empty());
  box.allowed = 10;
  for (Vec3& p : box.points) p.z *= 0.3;
  EXPECT_EQ(box.check().fault, RoundedFault::kUnlisted);
  UnrefinedFaces all;
  for (std::uint32_t f = 0; f < box.result.mesh.faces.size(); ++f) {
    const Triangle& t = box.result.mesh.faces[FaceId(f)];
    double largest_cosine = -1;
    for (int i = 0; i < 3; ++i) {
      const Vec3& at = box.points[t[i].value];
      const Vec3 a = box.points[t[(i + 1) % 3].value] - at, b = box.points[t[(i + 2) % 3].value] - at;
      largest_cosine = std::max(largest_cosine, dot(a, b) / (norm(a) * norm(b)));
    }
    const double least_angle_deg = std::acos(largest_cosine) * 180 / std::numbers::pi;
    if (least_angle_deg >= box.result.rounding_input.goals.min_angle_deg) continue;
    all.faces.emplace_back(f);
    all.reasons.push_back(UnrefinedReason::kOutputRounding);
  }
  ASSERT_FALSE(all.faces.empty());
  box.unrefined = all;
  EXPECT_FALSE(box.check().fault);
  // Neither may the reason be another one, nor the list longer.
  box.unrefined->reasons[0] = UnrefinedReason::kSizeFloor;
  EXPECT_EQ(box.check().fault, RoundedFault::kWrongReason);
  box.unrefined = all;
  for (Vec3& p : box.points) p.z /= 0.3;
  box.points[0].z += 1e-9;
  EXPECT_EQ(box.check().fault, RoundedFault::kListedInVain);
}

TEST(rounded_check, an_edge_as_long_as_allowed_may_be_rounded_up) {
  // Ten edges to a side, and 0.1 is no float: some come out a little longer.
  Stored box(shapes::box({1, 1, 1}), with_edges(0.1));
  ASSERT_TRUE(box.result.rounding_input.unrefined.faces.empty());
  double longest = 0;
  for (Vec3& p : box.points) p = rounded_to_float(p);
  for (const Triangle& t : box.result.mesh.faces)
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, norm(box.points[t[i].value] - box.points[t[(i + 1) % 3].value]));
  ASSERT_GT(longest, 0.1 * (1 + 1e-8));
  EXPECT_FALSE(box.check().fault);
}

TEST(rounded_check, a_face_that_missed_the_goals_before_keeps_its_reason) {
  // A corner of ten degrees that no refinement can mend.
  Stored wedge(shapes::triangle(10, 3, 4), Options{});
  const UnrefinedFaces before = wedge.result.rounding_input.unrefined;
  ASSERT_FALSE(before.faces.empty());
  for (Vec3& p : wedge.points) p = 1.001 * p;
  EXPECT_FALSE(wedge.check().fault);
  wedge.unrefined = before;
  wedge.unrefined->reasons[0] = UnrefinedReason::kOutputRounding;
  EXPECT_EQ(wedge.check().fault, RoundedFault::kWrongReason);
}

/// Finds flat faces and intersections by their definitions, pair by pair.
struct Oracle {
  bool has_flat = false, has_intersection = false;

  Oracle(const std::vector<Vec3>& points, const std::vector<Triangle>& faces) {
    const CgalIntersection do_intersect(points);
    std::vector<Box3> boxes(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const VertexId v : faces[f]) boxes[f].add(points[v.value]);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      has_flat = has_flat || !do_intersect.has_area(faces[f]);
      for (std::size_t g = 0; g < f && !has_intersection; ++g)
        has_intersection = do_meet(boxes[f], boxes[g]) && do_intersect(faces[f], faces[g]);
    }
  }
  static bool do_meet(const Box3& a, const Box3& b) {
    for (int axis = 0; axis < 3; ++axis)
      if (a.max[axis] < b.min[axis] || b.max[axis] < a.min[axis]) return false;
    return true;
  }
};

TEST(rounded_check, what_passes_intersects_nowhere_whatever_is_moved) {
  Random random(base_seed(3601));
  int passed = 0, crossed = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const bool is_plate = random.chance(0.7);
    const Vec3 axis{random.unit(), random.unit(), 1};
    const double angle = random.uniform(0, 90);
    const PolygonMesh shape = is_plate ? shapes::slotted_plate(1) : shapes::l_bracket(1);
    Stored stored(shape, with_edges(random.uniform(0.6, 1)));
    const double lean = random.uniform(0, 0.5), noise = std::exp(random.uniform(std::log(0.001), std::log(0.3)));
    for (Vec3& p : stored.points) {
      if (is_plate) p = leaning(p, lean);
      p += noise * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    }
    const auto turn = [&](std::vector<Vec3>& points) {
      PolygonMesh cloud;
      cloud.positions.items() = points;
      points = shapes::rotated(cloud, axis, angle).positions.items();
    };
    for (std::vector<Vec3>* points :
         {&stored.points, &stored.result.mesh.positions.items(), &stored.result.rounding_input.normals.items()})
      turn(*points);
    stored.result.rounding_input.is_refined = false;
    const RoundedVerdict verdict = stored.check();
    const Oracle oracle(stored.points, stored.result.mesh.faces.items());
    if (!verdict.fault) {
      ++passed;
      EXPECT_FALSE(oracle.has_flat || oracle.has_intersection) << trial;
    } else if (verdict.fault == RoundedFault::kNewIntersections) {
      ++crossed;
      EXPECT_TRUE(oracle.has_intersection) << trial;
    }
  }
  // Both must occur for this to say anything.
  EXPECT_GT(passed, 5);
  EXPECT_GT(crossed, 2);
}

TEST(rounded_check, triangles_of_a_curved_patch_are_compared_with_themselves) {
  // Four panes of a round wall, a third of a circle, whose normal belongs to none of them.
  std::vector<Vec3> before;
  std::vector<Triangle> faces;
  for (std::uint32_t k = 0; k <= 4; ++k) {
    before.push_back({std::cos(0.5 * k), std::sin(0.5 * k), 0});
    before.push_back({std::cos(0.5 * k), std::sin(0.5 * k), 1});
    if (k == 0) continue;
    const auto v = [&](std::uint32_t i) { return VertexId(2 * k - 2 + i); };
    faces.push_back({v(0), v(2), v(3)});
    faces.push_back({v(0), v(3), v(1)});
  }
  const std::vector<PatchId> patches(faces.size(), PatchId(0));
  const std::vector<Vec3> normals{{0, 0, 1}};
  const std::vector<std::uint8_t> is_curved{1};
  const auto fault = [&](const std::vector<Vec3>& stored, bool is_told) {
    RoundedClaim claim;
    claim.positions = before;
    claim.stored = stored;
    claim.storage = Storage::kDouble;
    claim.faces = faces;
    claim.face_patch = patches;
    claim.normals = normals;
    claim.allowed_move = 10;
    if (is_told) claim.is_curved = is_curved;
    RunControl control;
    return check_rounded(claim, control).fault;
  };
  std::vector<Vec3> moved = before;
  for (Vec3& p : moved) p += {1e-3 * p.y, 0, -1e-3 * p.x};
  EXPECT_EQ(fault(moved, true), std::nullopt);
  EXPECT_EQ(fault(moved, false), RoundedFault::kTurnedOver);
  moved[2] = moved[0] + 2.5 * (moved[6] - moved[0]);  // beyond its neighbours
  EXPECT_EQ(fault(moved, true), RoundedFault::kTurnedOver);
}

}  // namespace
}  // namespace remesh
