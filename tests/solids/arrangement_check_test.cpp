// Tests that the proof of an arrangement and of a union accepts what is right, and finds every mutant.

#include "core/verify/arrangement_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/triangle_corners.h"
#include "core/solids/solid_union.h"
#include "tests/solids/solid_rows.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// An arrangement and its union, with all that their proofs ask for.
struct Arranged {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;
  double tolerance = 0;
  Arrangement arrangement;
  std::vector<std::int32_t> weights;
  UnionFaces united;

  explicit Arranged(const PolygonMesh& mesh) {
    RunControl control;
    const PolygonMesh welded = shapes::welded(shapes::fan_triangulated(mesh));
    positions.assign(welded.positions.begin(), welded.positions.end());
    for (const Triangle& t : shapes::triangles(welded).faces) faces.push_back(t);
    Box3 box;
    for (const Vec3& p : positions) box.add(p);
    tolerance = 1e-9 * box.diagonal();
    arrangement = arrange(positions, faces, tolerance, control);
    const auto begins = triangle_begins(faces.size(), control);
    const Adjacency edges(positions.size(), begins, corners_of(faces), control);
    const Shells shells = find_shells(positions, corners_of(faces), edges, {}, control);
    united = find_union(arrangement, positions, faces, shells, control);
    for (const std::uint32_t s : shells.of_face) {
      const bool is_turned =
          std::find(united.turned_shells.begin(), united.turned_shells.end(), s) != united.turned_shells.end();
      weights.push_back(!shells.all[s].is_closed ? 0 : is_turned ? -1 : 1);
    }
  }

  ArrangementProof proof() const { return proof_of(arrangement); }
  ArrangementProof proof_of(const Arrangement& other) const {
    RunControl control;
    return prove_arrangement({positions, faces, other, tolerance}, control);
  }
  std::string fault_of_union(const UnionFaces& other) const {
    RunControl control;
    return find_fault_of_union({positions, faces, weights, arrangement, other.stays, other.is_turned, tolerance},
                               control);
  }
};

std::vector<Arranged> examples() {
  std::vector<Arranged> all;
  for (const SolidRow& row : solid_rows()) {
    if (row.is_large || row.parts.size() > 60) continue;
    for (const double degrees : {0.0, 37.0}) {
      std::vector<PolygonMesh> parts;
      for (const PolygonMesh& part : row.parts)
        parts.push_back(degrees == 0 ? part : shapes::rotated(part, {1, 2, 5}, degrees));
      all.emplace_back(as_one(parts));
    }
  }
  return all;
}

TEST(arrangement_check, proves_what_is_right) {
  for (const Arranged& example : examples()) {
    const ArrangementProof proof = example.proof();
    EXPECT_EQ(proof.failure, "");
    ASSERT_TRUE(proof.distance);
    EXPECT_LE(*proof.distance, example.tolerance);
    EXPECT_EQ(example.fault_of_union(example.united), "");
  }
}

TEST(arrangement_check, solids_that_touch_in_a_corner_only_lose_nothing) {
  // Which way a ray from the common corner runs depends on how the solids are turned.
  const SolidRow row = solid_rows()[8];
  for (int degrees = 0; degrees < 360; degrees += 9) {
    std::vector<PolygonMesh> parts;
    for (const PolygonMesh& part : row.parts) parts.push_back(shapes::rotated(part, {1, 2, 5}, degrees));
    const Arranged example(as_one(parts));
    EXPECT_EQ(example.united.dropped, 0u) << degrees;
    EXPECT_EQ(example.fault_of_union(example.united), "") << degrees;
  }
}

TEST(arrangement_check, finds_every_mutant) {
  Random random(base_seed(63));
  const std::vector<Arranged> all = examples();
  std::map<std::string, int> tried, missed;
  const auto judge = [&](const std::string& kind, bool is_found) {
    ++tried[kind];
    if (!is_found) ++missed[kind];
  };
  const auto number = [&](std::size_t below) {
    return static_cast<std::size_t>(random.below(static_cast<int>(below)));
  };
  for (const Arranged& example : all)
    for (int round = 0; round < 4; ++round) {
      const Arrangement& right = example.arrangement;
      const std::size_t n = right.faces.size(), f = number(n);
      const auto does_fail = [&](const Arrangement& mutant) { return !example.proof_of(mutant).distance; };
      Arrangement mutant = right;
      std::swap(mutant.faces[f][1], mutant.faces[f][2]);
      judge("a face flipped", does_fail(mutant));

      // A face that covers a triangle from the wrong side.
      mutant = right;
      mutant.covers[number(mutant.covers.size())].is_reversed ^= true;
      judge("a cover reversed", does_fail(mutant));

      mutant = right;
      mutant.faces.erase(mutant.faces.begin() + static_cast<std::ptrdiff_t>(f));
      const std::uint32_t begin = right.cover_begin[f], end = right.cover_begin[f + 1];
      mutant.covers.erase(mutant.covers.begin() + begin, mutant.covers.begin() + end);
      mutant.cover_begin.erase(mutant.cover_begin.begin() + static_cast<std::ptrdiff_t>(f) + 1);
      for (std::size_t g = f + 1; g < mutant.cover_begin.size(); ++g) mutant.cover_begin[g] -= end - begin;
      judge("a face dropped", does_fail(mutant));

      // Without a constraint, two faces with a common side have the other diagonal.
      mutant = right;
      const std::size_t k = number(3);
      const VertexId a = mutant.faces[f][k], b = mutant.faces[f][(k + 1) % 3], c = mutant.faces[f][(k + 2) % 3];
      for (std::size_t g = 0; g < n; ++g) {
        Triangle& other = mutant.faces[g];
        for (std::size_t i = 0; i < 3; ++i) {
          if (other[i] != b || other[(i + 1) % 3] != a) continue;
          const VertexId d = other[(i + 2) % 3];
          if (g == f || d == c) continue;
          other = {d, c, a};
          mutant.faces[f] = {c, d, b};
          // A flip within one triangle of the input, away from curves, is another arrangement that is right as well.
          const bool is_other = right.covers_of(f)[0].face != right.covers_of(g)[0].face;
          if (is_other) judge("a constraint dropped", does_fail(mutant));
          g = n - 1;
          break;
        }
      }

      // The points of an edge in the other order: both become each other in all faces of one triangle of the input.
      mutant = right;
      const VertexId u = right.faces[f][k], v = right.faces[f][(k + 1) % 3];
      const FaceId of = right.covers_of(f)[0].face;
      for (std::size_t g = 0; g < n; ++g) {
        if (right.covers_of(g)[0].face != of) continue;
        for (VertexId& w : mutant.faces[g]) w = w == u ? v : w == v ? u : w;
      }
      judge("two points of an edge exchanged", does_fail(mutant));

      // A vertex moved by twice the bound, out of the plane of one of its faces.
      mutant = right;
      const Vec3 &p = right.positions[a.value], &q = right.positions[b.value], &r = right.positions[c.value];
      const Vec3 normal = normalized(cross(q - p, r - p));
      Box3 box;
      for (const Vec3& place : example.positions) box.add(place);
      const double bound = 2 * (right.moved + 0x1p-47 * (norm(box.max) + norm(box.min)));
      mutant.positions[a.value] = p + bound * normal;
      judge("a vertex moved", does_fail(mutant));

      // A coincident face kept: a face that is there twice, each with some of the covers.
      mutant = right;
      mutant.faces.push_back(mutant.faces[f]);
      mutant.covers.push_back(right.covers_of(f)[0]);
      mutant.cover_begin.push_back(static_cast<std::uint32_t>(mutant.covers.size()));
      judge("a coincident face kept", does_fail(mutant));

      UnionFaces united = example.united;
      united.stays[f] ^= 1;
      judge("a face of the union kept or dropped", !example.fault_of_union(united).empty());
      united = example.united;
      if (united.stays[f] != 0) {
        united.is_turned[f] ^= 1;
        judge("a face of the union turned", !example.fault_of_union(united).empty());
      }

      // A cell called solid that is not, or the other way round.
      RunControl control;
      const std::vector<std::int32_t> none(n, 0);
      const Cells cells = find_cells({right.positions, right.faces, none}, control);
      const auto cell = static_cast<std::uint32_t>(number(cells.winding.size()));
      united = example.united;
      for (std::size_t g = 0; g < n; ++g) {
        const bool is_front = cells.of_side[2 * g] == cell, is_back = cells.of_side[2 * g + 1] == cell;
        if (is_front != is_back) united.stays[g] ^= 1;
      }
      judge("a cell called solid that is not", !example.fault_of_union(united).empty());
    }
  int count = 0;
  for (const auto& [kind, times] : tried) {
    EXPECT_EQ(missed[kind], 0) << kind << ", of " << times;
    EXPECT_GT(times, 10) << kind;
    count += times;
  }
  EXPECT_GE(count, 200);
}

TEST(arrangement_check, a_claim_that_is_not_well_formed_proves_nothing) {
  const Arranged example(as_one(solid_rows().front().parts));
  Arrangement mutant = example.arrangement;
  mutant.faces[0][0] = VertexId(mutant.positions.size());
  EXPECT_FALSE(example.proof_of(mutant).distance);
  mutant = example.arrangement;
  mutant.covers[0].face = FaceId(example.faces.size());
  EXPECT_FALSE(example.proof_of(mutant).distance);
  mutant = example.arrangement;
  mutant.cover_begin.pop_back();
  EXPECT_FALSE(example.proof_of(mutant).distance);
  mutant = example.arrangement;
  mutant.positions[0].x = std::nan("");
  EXPECT_FALSE(example.proof_of(mutant).distance);
  UnionFaces united = example.united;
  united.stays.pop_back();
  EXPECT_NE(example.fault_of_union(united), "");
}

TEST(arrangement_check, a_bound_that_is_too_small_proves_nothing) {
  // The corner of a box is put on the plane below, from which it is half of the tolerance away.
  PolygonMesh below = shapes::box({4, 4, 1}), above = shapes::moved(shapes::box({1, 1, 1}), {1, 1, 1 + 2e-9});
  const Arranged example(shapes::joined(below, above));
  ASSERT_TRUE(example.arrangement.is_changed);
  EXPECT_NEAR(example.arrangement.moved, 2e-9, 1e-12);
  ASSERT_TRUE(example.proof().distance);
  EXPECT_GE(*example.proof().distance, 1.9e-9);
  Arrangement mutant = example.arrangement;
  mutant.moved /= 2;
  EXPECT_FALSE(example.proof_of(mutant).distance);
}

}  // namespace
}  // namespace remesh
