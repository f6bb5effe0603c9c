// Tests that the proof of a removal of details accepts maps that are right, with the distance that they have, and no
// others.

#include "core/verify/detail_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace remesh {
namespace {

Triangle triangle(int a, int b, int c) { return {VertexId(a), VertexId(b), VertexId(c)}; }

/// A claim with its own arrays.
struct OwnClaim {
  std::vector<Vec3> positions_before, positions_after;
  std::vector<Triangle> faces_before, faces_after;
  DetailMap map;

  std::optional<double> proven() const {
    RunControl control;
    return prove_details({positions_before, faces_before, positions_after, faces_after, map}, control);
  }
};

/// A square of two triangles, 0 1 2 and 0 2 3, with a flat corner 4 near the middle of its side from 0 to 1. The side
/// is cut in its middle, and the cut, which is point 5, goes to 4.
OwnClaim closed_sliver() {
  OwnClaim claim;
  claim.positions_before = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, -0.125, 0}};
  claim.faces_before = {triangle(0, 1, 2), triangle(0, 2, 3), triangle(0, 4, 1)};
  claim.positions_after = claim.positions_before;
  claim.faces_after = {triangle(0, 4, 2), triangle(4, 1, 2), triangle(0, 2, 3)};
  claim.map.cuts = {{VertexId(0), VertexId(1), 0.5}};
  claim.map.pieces = {{triangle(0, 5, 2), FaceId(0)},
                      {triangle(5, 1, 2), FaceId(0)},
                      {triangle(0, 2, 3), FaceId(1)},
                      {triangle(0, 4, 5), FaceId(2)},
                      {triangle(5, 4, 1), FaceId(2)}};
  for (int i = 0; i < 5; ++i) claim.map.image.push_back(VertexId(i));
  claim.map.image.push_back(VertexId(4));
  return claim;
}

TEST(detail_check, proves_the_distance_that_the_corners_move) {
  const OwnClaim claim = closed_sliver();
  ASSERT_TRUE(claim.proven());
  EXPECT_NEAR(*claim.proven(), 0.125, 1e-13);
  EXPECT_GE(*claim.proven(), 0.125);
}

TEST(detail_check, proves_the_same_at_any_scale) {
  for (const int exponent : {-900, -300, 300, 1000}) {
    OwnClaim claim = closed_sliver();
    for (auto* places : {&claim.positions_before, &claim.positions_after})
      for (Vec3& p : *places) p = std::ldexp(1.0, exponent) * p;
    ASSERT_TRUE(claim.proven()) << exponent;
    EXPECT_NEAR(std::ldexp(*claim.proven(), -exponent), 0.125, 1e-13) << exponent;
  }
}

/// The same, and a triangle of its own, 5 6 7, that goes to the middle of the face 0 2 3. The cut is point 8.
OwnClaim closed_sliver_and_speck() {
  OwnClaim claim = closed_sliver();
  claim.positions_before.insert(claim.positions_before.end(),
                                {{0.25, 0.75, 0.25}, {0.25, 0.75, 0.5}, {0.5, 0.75, 0.5}});
  claim.faces_before.push_back(triangle(5, 6, 7));
  for (DetailMap::Piece& piece : claim.map.pieces)
    for (VertexId& v : piece.corners)
      if (v == VertexId(5)) v = VertexId(8);
  claim.map.pieces.push_back({triangle(5, 6, 7), FaceId(3)});
  claim.map.image = {};
  for (int i = 0; i < 5; ++i) claim.map.image.push_back(VertexId(i));
  for (int i = 5; i < 8; ++i) {
    claim.map.image.push_back(VertexId());
    claim.map.anchors.push_back({VertexId(i), FaceId(2), {0.25, 0.25, 0.5}});
  }
  claim.map.image.push_back(VertexId(4));
  return claim;
}

TEST(detail_check, proves_how_far_parts_are_from_the_point_to_which_they_go) {
  const OwnClaim claim = closed_sliver_and_speck();
  ASSERT_TRUE(claim.proven());
  // The point is a quarter of (0, 0, 0) and (1, 1, 0) each, and a half of (0, 1, 0).
  EXPECT_NEAR(*claim.proven(), norm(Vec3{0.5, 0.75, 0.5} - Vec3{0.25, 0.75, 0}), 1e-13);
}

TEST(detail_check, refuses_parts_that_go_in_another_way) {
  const std::vector<std::pair<std::string, std::function<void(OwnClaim&)>>> faults{
      {"a corner goes nowhere", [](OwnClaim& c) { c.map.anchors.pop_back(); }},
      {"a corner goes to another point",
       [](OwnClaim& c) {
         c.map.anchors[1].weights = {0.5, 0.25, 0.25};
       }},
      {"a corner goes to another face", [](OwnClaim& c) { c.map.anchors[1].face = FaceId(1); }},
      {"a corner goes to a vertex", [](OwnClaim& c) { c.map.image[VertexId(5)] = VertexId(0); }},
      {"a corner goes to a vertex as well",
       [](OwnClaim& c) {
         c.map.image[VertexId(5)] = VertexId(0);
         c.map.anchors.erase(c.map.anchors.begin());
       }},
      {"the point lies outside of its face",
       [](OwnClaim& c) {
         for (DetailMap::Anchor& a : c.map.anchors) a.weights = {-0.25, 0.75, 0.5};
       }},
      {"the weights are too large",
       [](OwnClaim& c) {
         for (DetailMap::Anchor& a : c.map.anchors) a.weights = {0.5, 0.5, 0.5};
       }},
      {"the face does not exist",
       [](OwnClaim& c) {
         for (DetailMap::Anchor& a : c.map.anchors) a.face = FaceId(3);
       }},
      {"the anchors are not in order", [](OwnClaim& c) { std::swap(c.map.anchors[0], c.map.anchors[1]); }},
      {"a vertex of the rest is anchored",
       [](OwnClaim& c) {
         c.map.image[VertexId(3)] = VertexId();
         c.map.anchors.insert(c.map.anchors.begin(), {VertexId(3), FaceId(2), {0.25, 0.25, 0.5}});
       }},
      {"the part hangs together with the rest",
       [](OwnClaim& c) {
         c.faces_before[3] = triangle(3, 6, 7);
         c.map.pieces.back().corners = triangle(3, 6, 7);
       }},
  };
  for (const auto& [name, change] : faults) {
    OwnClaim claim = closed_sliver_and_speck();
    change(claim);
    EXPECT_FALSE(claim.proven()) << name;
  }
}

TEST(detail_check, refuses_maps_that_prove_nothing) {
  const std::vector<std::pair<std::string, std::function<void(OwnClaim&)>>> faults{
      {"a piece is missing", [](OwnClaim& c) { c.map.pieces.erase(c.map.pieces.begin()); }},
      {"the pieces of a face are missing", [](OwnClaim& c) { c.map.pieces.resize(3); }},
      {"a piece is there twice", [](OwnClaim& c) { c.map.pieces.insert(c.map.pieces.begin(), c.map.pieces.front()); }},
      {"a piece is turned over",
       [](OwnClaim& c) { std::swap(c.map.pieces[2].corners[0], c.map.pieces[2].corners[1]); }},
      {"a piece belongs to another face", [](OwnClaim& c) { c.map.pieces[1].of = FaceId(1); }},
      {"a piece belongs to no face", [](OwnClaim& c) { c.map.pieces.back().of = FaceId(7); }},
      {"the cut lies on another edge", [](OwnClaim& c) { c.map.cuts[0].to = VertexId(2); }},
      {"the cut lies beyond the edge", [](OwnClaim& c) { c.map.cuts[0].at = 1.5; }},
      {"the cut is made from itself", [](OwnClaim& c) { c.map.cuts[0].to = VertexId(5); }},
      {"the cut goes elsewhere", [](OwnClaim& c) { c.map.image[VertexId(5)] = VertexId(3); }},
      {"a vertex goes nowhere", [](OwnClaim& c) { c.map.image[VertexId(3)] = VertexId(); }},
      {"a face comes from nothing", [](OwnClaim& c) { c.faces_after.push_back(triangle(0, 1, 3)); }},
      {"a face is missing", [](OwnClaim& c) { c.faces_after.pop_back(); }},
      {"a face is turned over", [](OwnClaim& c) { std::swap(c.faces_after[1][0], c.faces_after[1][1]); }},
      {"a place is infinite", [](OwnClaim& c) { c.positions_after[0].x = HUGE_VAL; }},
      {"there are no places", [](OwnClaim& c) { c.map.image.clear(); }},
  };
  for (const auto& [what, spoil] : faults) {
    OwnClaim claim = closed_sliver();
    spoil(claim);
    EXPECT_FALSE(claim.proven()) << what;
  }
}

TEST(detail_check, refuses_a_component_that_is_gone) {
  OwnClaim claim = closed_sliver();
  // A speck becomes one point, which no face has.
  for (const Vec3& p : {Vec3{5, 5, 5}, Vec3{5, 5.01, 5}, Vec3{5, 5, 5.01}}) claim.positions_before.push_back(p);
  claim.positions_after.push_back({5, 5, 5});
  claim.faces_before.push_back(triangle(5, 6, 7));
  claim.map.cuts[0] = {VertexId(0), VertexId(1), 0.5};
  claim.map.pieces.clear();
  claim.map.pieces = {{triangle(0, 8, 2), FaceId(0)}, {triangle(8, 1, 2), FaceId(0)}, {triangle(0, 2, 3), FaceId(1)},
                      {triangle(0, 4, 8), FaceId(2)}, {triangle(8, 4, 1), FaceId(2)}, {triangle(5, 6, 7), FaceId(3)}};
  claim.map.image.clear();
  for (const int image : {0, 1, 2, 3, 4, 5, 5, 5, 4}) claim.map.image.push_back(VertexId(image));
  EXPECT_FALSE(claim.proven());
  // With the speck's face, all is well.
  claim.positions_after.push_back({5, 5.01, 5});
  claim.positions_after.push_back({5, 5, 5.01});
  claim.faces_after.push_back(triangle(5, 6, 7));
  claim.map.image[VertexId(6)] = VertexId(6);
  claim.map.image[VertexId(7)] = VertexId(7);
  EXPECT_TRUE(claim.proven());
}

/// A claim in which some vertices go to others.
OwnClaim claim_of(const std::vector<Vec3>& positions, const std::vector<Triangle>& faces,
                  const std::vector<std::pair<int, int>>& joined) {
  OwnClaim claim;
  claim.positions_before = claim.positions_after = positions;
  claim.faces_before = faces;
  for (std::size_t v = 0; v < positions.size(); ++v) claim.map.image.push_back(VertexId(v));
  for (const auto& [from, to] : joined) claim.map.image[VertexId(from)] = VertexId(to);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    claim.map.pieces.push_back({faces[f], FaceId(f)});
    const Triangle image{claim.map.image[faces[f][0]], claim.map.image[faces[f][1]], claim.map.image[faces[f][2]]};
    if (image[0] != image[1] && image[1] != image[2] && image[2] != image[0]) claim.faces_after.push_back(image);
  }
  return claim;
}

/// A flat ring of six faces around the hole 0 1 2. If 2 goes to 1, the edges from 0 to both become one.
const std::vector<Vec3> kRing{{0, 0, 0}, {1, 0, 0}, {1, 0.25, 0}, {-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
std::vector<Triangle> ring_faces() {
  return {triangle(0, 3, 4), triangle(0, 4, 1), triangle(1, 4, 5),
          triangle(1, 5, 2), triangle(2, 5, 3), triangle(2, 3, 0)};
}

/// Adds a torus of three by three vertices. Those of the first ring are returned.
std::vector<int> add_torus(std::vector<Vec3>& positions, std::vector<Triangle>& faces) {
  const int first = static_cast<int>(positions.size());
  const auto vertex = [&](int i, int j) { return first + 3 * (i % 3) + j % 3; };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double u = 2.1 * i, v = 2.1 * j, r = 2 + std::cos(v);
      positions.push_back({10 + r * std::cos(u), r * std::sin(u), std::sin(v)});
      faces.push_back(triangle(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)));
      faces.push_back(triangle(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)));
    }
  return {vertex(0, 0), vertex(0, 1), vertex(0, 2)};
}

TEST(detail_check, a_hole_may_be_closed) {
  const OwnClaim claim = claim_of(kRing, ring_faces(), {{2, 1}});
  EXPECT_EQ(claim.faces_after.size(), 5u);
  ASSERT_TRUE(claim.proven());
  EXPECT_NEAR(*claim.proven(), 0.25, 1e-13);
}

TEST(detail_check, a_handle_may_not_be_pinched_off_even_if_a_hole_is_closed) {
  std::vector<Vec3> positions = kRing;
  std::vector<Triangle> faces = ring_faces();
  const std::vector<int> ring = add_torus(positions, faces);
  EXPECT_TRUE(claim_of(positions, faces, {{2, 1}}).proven());
  EXPECT_FALSE(claim_of(positions, faces, {{ring[1], ring[0]}, {ring[2], ring[0]}}).proven());
  EXPECT_FALSE(claim_of(positions, faces, {{2, 1}, {ring[1], ring[0]}, {ring[2], ring[0]}}).proven());
}

TEST(detail_check, rims_that_meet_are_not_closed) {
  // The rims of two sheets get a vertex in common, which lets the Euler number fall by 1. Each torus that is pinched
  // lets it grow by 1.
  std::vector<Vec3> positions = kRing;
  std::vector<Triangle> faces = ring_faces();
  for (const Vec3& p : kRing) positions.push_back({p.x, p.y, 1});
  for (const Triangle& t : ring_faces())
    faces.push_back({VertexId(t[0].value + 6), VertexId(t[1].value + 6), VertexId(t[2].value + 6)});
  std::vector<std::pair<int, int>> joined{{6, 0}};
  EXPECT_TRUE(claim_of(positions, faces, joined).proven());
  for (int i = 0; i < 2; ++i) {
    const std::vector<int> ring = add_torus(positions, faces);
    joined.insert(joined.end(), {{ring[1], ring[0]}, {ring[2], ring[0]}});
  }
  EXPECT_FALSE(claim_of(positions, faces, joined).proven());
}

}  // namespace
}  // namespace remesh
