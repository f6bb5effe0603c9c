#include "core/refinement/refiner/patch_boundary.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/patch_subject.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

PatchBoundary boundary_of(const PatchSubject& subject, PatchId p = PatchId(0)) {
  return PatchBoundary(subject.patch(p), std::pmr::get_default_resource());
}

/// Returns a square with a fin on a line inside it. The square has a slit there.
PolygonMesh square_with_fin() {
  PolygonMesh mesh;
  for (const Vec3& p :
       std::vector<Vec3>{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {1, 5, 0}, {9, 5, 0}, {9, 5, 4}, {1, 5, 4}})
    mesh.positions.push_back(p);
  mesh.face_begin = {0};
  for (const std::array<int, 3>& face : std::vector<std::array<int, 3>>{
           {0, 1, 5}, {0, 5, 4}, {1, 2, 5}, {2, 3, 4}, {2, 4, 5}, {3, 0, 4}, {4, 5, 6}, {4, 6, 7}}) {
    for (const int v : face) mesh.corners.push_back(VertexId(v));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

/// Returns the ends of all pieces of a segment, and expects that these follow one another from 0 to 1.
std::vector<double> ends_of_pieces(const PatchBoundary& boundary, SegmentId segment) {
  std::vector<std::uint32_t> pieces;
  boundary.list_pieces(segment, pieces);
  std::vector<double> ends{0};
  for (const std::uint32_t s : pieces) {
    EXPECT_EQ(boundary.segment_of(s), segment);
    EXPECT_EQ(boundary.side(s).t0, ends.back());
    ends.push_back(boundary.side(s).t1);
  }
  EXPECT_EQ(ends.back(), 1);
  return ends;
}

TEST(patch_boundary, a_patch_has_one_side_of_each_segment_around_it) {
  const PatchSubject subject(shapes::sheet(4, 2, 1, 1));
  const PatchBoundary boundary = boundary_of(subject);
  EXPECT_EQ(boundary.side_count(), 4u);
  EXPECT_EQ(boundary.chain_count(), 4u);
  for (std::uint32_t s = 0; s < 4; ++s) {
    EXPECT_EQ(boundary.side(s).partner, kNone);
    EXPECT_EQ(ends_of_pieces(boundary, boundary.segment_of(s)), (std::vector<double>{0, 1}));
    EXPECT_EQ(boundary.cost_of_cut(boundary.segment_of(s)), 1u);
  }
}

TEST(patch_boundary, pieces_cover_their_segment_however_it_is_cut) {
  const PatchSubject subject(shapes::sheet(4, 2, 1, 1));
  PatchBoundary split = boundary_of(subject), divided = boundary_of(subject);
  const std::vector<double> cuts{0.25, 0.5, 0.75};
  for (std::uint32_t s = 0; s < 4; ++s) {
    const SegmentId segment = split.segment_of(s);
    for (const double t : {0.5, 0.25, 0.75}) {
      std::vector<std::uint32_t> pieces;
      split.list_pieces(segment, pieces);
      for (const std::uint32_t piece : pieces)
        if (split.side(piece).t0 < t && t < split.side(piece).t1) {
          split.split(piece, t);
          split.add_to_chain(split.side_count() - 1);
          break;
        }
    }
    EXPECT_EQ(divided.divide(s, cuts), 4 + 3 * s);
    EXPECT_EQ(ends_of_pieces(split, segment), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
    EXPECT_EQ(ends_of_pieces(divided, segment), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  }
}

TEST(patch_boundary, the_two_sides_of_a_slit_have_the_same_pieces) {
  const PatchSubject subject(square_with_fin());
  int slits = 0;
  for (std::uint32_t p = 0; p < subject.chain.meshes.size(); ++p) {
    const PatchBoundary whole = boundary_of(subject, PatchId(p));
    PatchBoundary split = whole, divided = whole;
    for (std::uint32_t s = 0; s < whole.side_count(); ++s) {
      const std::uint32_t partner = whole.side(s).partner;
      divided.divide(s, std::vector<double>{0.25, 0.5});
      if (partner == kNone || partner < s) continue;
      ++slits;
      EXPECT_EQ(partner, s + 1);
      EXPECT_NE(whole.side(s).is_forward, whole.side(partner).is_forward);
      split.split(s, 0.25);
      split.add_to_chain(split.side_count() - 1);
      split.split(partner, 0.25);
      split.pair_pieces(s, partner);
      EXPECT_EQ(ends_of_pieces(split, split.segment_of(s)), (std::vector<double>{0, 0.25, 1}));
    }
    for (const PatchBoundary* boundary : {&split, &divided})
      for (std::uint32_t s = 0; s < boundary->side_count(); ++s) {
        const PatchBoundary::Side& side = boundary->side(s);
        if (side.partner == kNone) continue;
        const PatchBoundary::Side& other = boundary->side(side.partner);
        EXPECT_EQ(other.partner, s);
        EXPECT_EQ(other.t0, side.t0);
        EXPECT_EQ(other.t1, side.t1);
        EXPECT_NE(other.is_forward, side.is_forward);
      }
  }
  EXPECT_EQ(slits, 1);
}

TEST(patch_boundary, the_stronger_reason_is_the_one_that_would_hold_alone) {
  using enum UnrefinedReason;
  EXPECT_EQ(stronger(kMinEdgeLength, kSizeFloor), kSizeFloor);
  EXPECT_EQ(stronger(kSizeFloor, kMinEdgeLength), kSizeFloor);
  EXPECT_EQ(stronger(kSizeFloor, kBoundaryLocked), kBoundaryLocked);
  EXPECT_EQ(stronger(kBoundaryLocked, kMinEdgeLength), kBoundaryLocked);
  EXPECT_EQ(why_near({0.5, true}), kMinEdgeLength);
  EXPECT_EQ(why_near({0.5, false}), kSizeFloor);

  Options options;
  options.split_boundaries = false;
  const PatchSubject locked(shapes::sheet(4, 2, 1, 1), options), open(shapes::sheet(4, 2, 1, 1));
  const std::vector<std::uint32_t> sides{0, 1};
  EXPECT_TRUE(boundary_of(locked).is_any_locked(sides));
  EXPECT_EQ(boundary_of(locked).why_uncut(sides, kSizeFloor), kBoundaryLocked);
  EXPECT_FALSE(boundary_of(locked).cut_of(0));
  EXPECT_FALSE(boundary_of(open).is_any_locked(sides));
  EXPECT_EQ(boundary_of(open).why_uncut(sides, kMinEdgeLength), kMinEdgeLength);
  EXPECT_TRUE(boundary_of(open).cut_of(0));
}

TEST(patch_boundary, cuts_at_the_same_distance_from_a_sharp_corner_are_across_it) {
  const double angle = 20 * std::numbers::pi / 180;
  const PatchSubject subject(shapes::polygon({{0, 0}, {7, 0}, {7 * std::cos(angle), 7 * std::sin(angle)}}));
  const PatchBoundary boundary = boundary_of(subject);
  const VertexId tip = subject.chain.at({0, 0, 0});
  std::vector<SegmentId> at_tip;
  std::vector<bool> is_tip_first;
  for (std::uint32_t s = 0; s < boundary.side_count(); ++s) {
    const BoundarySegment& segment = subject.table[boundary.segment_of(s)];
    if (segment.from != tip && segment.to != tip) continue;
    at_tip.push_back(boundary.segment_of(s));
    is_tip_first.push_back(segment.from == tip);
  }
  ASSERT_EQ(at_tip.size(), 2u);
  const auto cut = [&](std::size_t i, double share) {
    return VertexPlace::on_segment(at_tip[i], is_tip_first[i] ? share : 1 - share);
  };
  const auto is_across = [&](double first, double second) {
    const double distance = 7 * std::sqrt(first * first + second * second - 2 * first * second * std::cos(angle));
    return boundary.is_across_input_angle({3, cut(0, first)}, {4, cut(1, second)}, distance);
  };
  EXPECT_TRUE(is_across(0.25, 0.25));
  EXPECT_FALSE(is_across(0.25, 0.2));
  EXPECT_FALSE(boundary.is_across_input_angle({3, cut(0, 0.25)}, {4, cut(0, 0.25)}, 0.1)) << "one segment";
  EXPECT_FALSE(boundary.is_across_input_angle({3, cut(0, 0.25)}, {4, cut(1, 0.25)}, 1.75)) << "60 degrees";
  // The two other corners are as far from the tip.
  const PatchMesh& patch = subject.chain.meshes[PatchId(0)];
  std::vector<PatchBoundary::Vertex> others;
  for (std::uint32_t v = 0; v < 3; ++v)
    if (patch.vertices[v] != tip) others.push_back({v, VertexPlace::original({1})});
  EXPECT_TRUE(boundary.is_across_input_angle(others[0], others[1], 14 * std::sin(angle / 2)));
}

}  // namespace
}  // namespace remesh
