#include "core/verify/patches/curved_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/verify/curved_example.h"

namespace remesh {
namespace {

const CurvedPlace kCylinder{SurfaceKind::kCylinder, 1};
const CurvedPlace kCone{SurfaceKind::kCone, 0, 0, 0.5};
const CurvedPlace kSphere{SurfaceKind::kSphere, 1};
const CurvedPlace kTorus{SurfaceKind::kTorus, 2, 0.7};

struct Piece {
  CurvedPlace place;
  Vec2 low, high;
  std::string name;
};

const std::vector<Piece> kPieces{
    {kCylinder, {0, 0}, {2, 1.5}, "cylinder"},     {kCone, {0.2, 1}, {2, 2.5}, "cone"},
    {kCone, {0, 0}, {2.5, 2}, "cone with apex"},   {kSphere, {0, -0.7}, {1.5, 0.8}, "sphere"},
    {kTorus, {0, -1}, {1.3, 1.2}, "outer torus"},  {kTorus, {0, 2}, {1.5, 4}, "inner torus"},
    {kTorus, {0, 0.5}, {1, 2.5}, "top of a torus"}};

/// Claims that a grid of a x b cells was remeshed to one of c x d cells. Vertices inside the latter are moved on the
/// surface.
Example remeshed(const Piece& of, const CurvedPlace& place, int a, int b, int c, int d, double tolerance) {
  PatchedMesh input, output;
  input.add_grid(PatchId(0), place, of.low, of.high, a, b);
  output.add_grid(PatchId(0), place, of.low, of.high, c, d, 0.2);
  return curved_example(input, output, {place.shape()}, tolerance);
}
Example remeshed(const Piece& of) { return remeshed(of, of.place, 10, 8, 6, 5, 0.1); }

/// Makes the same claim with the faces turned over, as they are in a hole.
Example turned_over(Example e) {
  e.surface.corners.change([&](std::vector<VertexId>& corners) {
    for (std::size_t i = 0; i < corners.size(); i += 3) std::swap(corners[i + 1], corners[i + 2]);
  });
  for (Triangle& face : e.faces) std::swap(face[1], face[2]);
  return e;
}

/// Returns a vertex inside the output. Around it, each neighbour is once the next corner of a face and once the one
/// before.
VertexId vertex_inside(const Example& e) {
  std::vector<int> sum(e.positions.size(), 0);
  for (const Triangle& face : e.faces)
    for (int i = 0; i < 3; ++i)
      sum[face[i].value] += static_cast<int>(face[(i + 1) % 3].value) - static_cast<int>(face[(i + 2) % 3].value);
  for (std::size_t v = 0; v < sum.size(); ++v)
    if (sum[v] == 0) return VertexId(v);
  throw std::invalid_argument("no vertex inside");
}

TEST(verify, the_bound_of_a_curved_patch_is_never_below_the_distance_and_not_far_above_it) {
  std::vector<double> ratios;
  for (const Piece& of : kPieces)
    for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{{12, 9, 5, 4}, {6, 5, 13, 10}, {9, 3, 7, 5}}) {
      const CurvedPlace place = of.place.turned({1, 2, 3}, 40, {0.3, -2, 1});
      const Example e = remeshed(of, place, a, b, c, d, 0.2);
      EXPECT_TRUE(is_verified(e)) << of.name << " " << a << " " << c;
      const Verdict v = e.verify();
      ASSERT_EQ(v.patch_bounds.size(), 1u);
      const double truth = true_distance(e, PatchId(0), 0.02 * v.patch_bounds[0]);
      EXPECT_GE(v.patch_bounds[0], truth * (1 - 1e-9)) << of.name << " " << a << " " << c;
      EXPECT_EQ(v.distance_bound.input_to_output, v.patch_bounds[0]);
      EXPECT_EQ(v.distance_bound.output_to_input, v.patch_bounds[0]);
      ratios.push_back(v.patch_bounds[0] / truth);
    }
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.25);
  EXPECT_LE(ratios.back(), 2);
}

TEST(verify, faces_of_a_hole_are_verified_as_those_of_a_shaft) {
  for (const Piece& of : kPieces) {
    const Example e = remeshed(of), hole = turned_over(e);
    EXPECT_TRUE(is_verified(e)) << of.name;
    EXPECT_TRUE(is_verified(hole)) << of.name;
    // The corners of a face come in another order, so the bounds may differ by rounding.
    const double of_hole = hole.verify().patch_bounds.at(0), of_shaft = e.verify().patch_bounds.at(0);
    EXPECT_NEAR(of_hole, of_shaft, 1e-13 * of_shaft) << of.name;
  }
}

TEST(verify, the_tolerance_of_a_curved_patch_is_held_exactly) {
  for (const Piece& of : kPieces) {
    Example e = remeshed(of);
    e.plane_tolerance = 1e-12;
    // The bound depends a little on the tolerance.
    for (int i = 0; i < 5; ++i) e.curved[0].tolerance = e.verify().patch_bounds[0];
    const double bound = e.curved[0].tolerance;
    e.curved[0].tolerance = 1.001 * bound;
    EXPECT_TRUE(is_verified(e)) << of.name;
    e.curved[0].tolerance = 0.999 * bound;
    EXPECT_FALSE(e.verify().surface) << of.name;
  }
}

/// Returns how far the faces of the input are from a surface, by samples.
double sampled_depth(const Example& e, const AnalyticSurface& shape) {
  double depth = 0;
  for (std::uint32_t f = 0; f < e.surface.face_count(); ++f) {
    const auto face = e.surface.face(FaceId(f));
    constexpr int kSteps = 24;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = 1.0 * i / kSteps, v = 1.0 * j / kSteps;
        const Vec3 p = (1 - u - v) * e.surface.positions[face[0]] + u * e.surface.positions[face[1]] +
                       v * e.surface.positions[face[2]];
        depth = std::max(depth, std::fabs(shape.distance(p)));
      }
  }
  return depth;
}

/// Returns whether no test says that facets and options do not explain the tolerance.
bool is_tolerance_explained(const Example& e) {
  const std::vector<std::string> failures = e.verify().failures;
  return std::none_of(failures.begin(), failures.end(),
                      [](const std::string& f) { return f.find("do not explain") != std::string::npos; });
}

TEST(verify, the_facets_of_an_honest_tessellation_explain_their_distance_and_not_much_more) {
  for (const Piece& of : kPieces)
    for (const auto& [a, b] : std::vector<std::array<int, 2>>{{12, 9}, {9, 14}}) {
      SCOPED_TRACE(of.name + " " + std::to_string(a) + " by " + std::to_string(b));
      Example e = remeshed(of, of.place, a, b, 3 * a, 3 * b, 0);
      e.plane_tolerance = 1e-9;
      const double depth = sampled_depth(e, of.place.shape());
      CurvedClaim& claim = e.curved[0];
      claim.surface_tolerance.reset();
      claim.tolerance = 1.01 * depth;
      EXPECT_TRUE(is_tolerance_explained(e));
      // Coarser pieces are too far, unless a number of elements explains its own chord height as well.
      Example coarser = remeshed(of, of.place, a, b, a / 2, b / 2, 0);
      coarser.plane_tolerance = 1e-9;
      coarser.curved[0].surface_tolerance.reset();
      coarser.curved[0].tolerance = 10 * depth;
      EXPECT_FALSE(is_tolerance_explained(coarser));
      coarser.curved[0].elements_per_circle = 4;
      EXPECT_TRUE(is_tolerance_explained(coarser));
    }
}

TEST(verify, one_ring_of_facets_is_no_evidence_for_a_sphere) {
  // The corners of a bore of radius 1 lie on a sphere, too. It bulges by 0.35 between them.
  constexpr double kHalf = 0.9;
  const CurvedPlace bore{SurfaceKind::kCylinder, 1}, ball{SurfaceKind::kSphere, std::hypot(1, kHalf)};
  const double latitude = std::asin(kHalf / ball.shape().radius);
  PatchedMesh input, output;
  input.add_grid(PatchId(0), bore, {0, -kHalf}, {2, kHalf}, 10, 1);
  output.add_grid(PatchId(0), ball, {0, -latitude}, {2, latitude}, 10, 8);
  Example e = curved_example(input, output, {ball.shape()}, 0.45);
  EXPECT_TRUE(is_tolerance_explained(e));
  e.curved[0].surface_tolerance.reset();
  e.curved[0].elements_per_circle = 16;
  EXPECT_FALSE(is_tolerance_explained(e));
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, an_unchanged_curved_patch_passes_with_bound_0_whatever_is_claimed) {
  for (const Piece& of : kPieces) {
    PatchedMesh mesh;
    mesh.add_grid(PatchId(0), of.place, of.low, of.high, 4, 3);
    AnalyticSurface shape = of.place.shape();
    shape.radius *= 3;
    shape.half_angle /= 2;
    const Example e = curved_example(mesh, mesh, {shape}, 1e-6);
    EXPECT_TRUE(is_verified(e)) << of.name;
    EXPECT_EQ(e.verify().patch_bounds[0], 0) << of.name;
  }
}

TEST(verify, any_scale_gives_the_same_verdict_on_a_curved_patch) {
  for (const Piece& of : kPieces)
    for (const double factor : {0x1p-400, 0x1p-30, 0x1p20, 0x1p600}) {
      const Example e = remeshed(of);
      Example other = e;
      other.move([&](Vec3& p) { p = factor * p; });
      for (Vec3& p : other.positions) p = factor * p;
      other.plane_tolerance *= factor;
      other.curved[0].tolerance *= factor;
      other.curved[0].shape = test::scaled(other.curved[0].shape, factor);
      EXPECT_TRUE(is_verified(other)) << of.name << " " << factor;
      EXPECT_EQ(other.verify().patch_bounds[0], factor * e.verify().patch_bounds[0]) << of.name << " " << factor;
      other.remove_face(0);
      EXPECT_FALSE(other.verify().surface) << of.name << " " << factor;
    }
}

/// A change of a correct claim that must be refused.
struct Mutation {
  std::string name;
  std::function<void(Example&, const Piece&)> apply;
};

/// The direction across a surface, by differences.
Vec3 normal_at(const Piece& of, const Vec3& p) {
  const AnalyticSurface shape = of.place.shape();
  const double h = 1e-6;
  const auto slope = [&](const Vec3& d) { return (shape.distance(p + h * d) - shape.distance(p - h * d)) / (2 * h); };
  return normalized({slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})});
}

const std::vector<Mutation> kMutations{
    {"a vertex moved out by twice the tolerance",
     [](Example& e, const Piece& of) {
       Vec3& p = e.positions[vertex_inside(e).value];
       p += 2 * e.curved[0].tolerance * normal_at(of, p);
     }},
    {"a vertex moved in by twice the tolerance",
     [](Example& e, const Piece& of) {
       Vec3& p = e.positions[vertex_inside(e).value];
       p += -2 * e.curved[0].tolerance * normal_at(of, p);
     }},
    {"a face turned over", [](Example& e, const Piece&) { std::swap(e.faces[7][0], e.faces[7][1]); }},
    {"a face missing inside",
     [](Example& e, const Piece&) {
       const VertexId v = vertex_inside(e);
       for (std::size_t f = 0; f < e.faces.size(); ++f)
         if (e.faces[f][0] == v) return e.remove_face(f);
       throw std::invalid_argument("no face");
     }},
    {"a face missing at the boundary", [](Example& e, const Piece&) { e.remove_face(0); }},
    {"a face twice",
     [](Example& e, const Piece&) {
       e.faces.push_back(e.faces[3]);
       e.face_patch.push_back(e.face_patch[3]);
       e.project();
     }},
    {"a vertex moved over its neighbours inside the shell",
     [](Example& e, const Piece&) {
       const VertexId v = vertex_inside(e);
       for (const Triangle& face : e.faces)
         for (int i = 0; i < 3; ++i)
           if (face[i] == v) {
             const Vec3 a = e.positions[face[(i + 1) % 3].value], b = e.positions[face[(i + 2) % 3].value];
             Vec3& p = e.positions[v.value];
             p = p + 1.3 * (0.5 * (a + b) - p);
             return;
           }
     }},
    {"no surface",
     [](Example& e, const Piece&) {
       e.curved[0].shape = {SurfaceKind::kPlane, {}, {0, 0, 1}, 0, 0, 0};
     }},
    {"an axis that is not a unit vector",
     [](Example& e, const Piece&) {
       e.curved[0].shape.axis = {0, 0, 1.001};
       if (e.curved[0].shape.kind == SurfaceKind::kSphere) e.curved[0].shape.radius = 0;
     }},
    {"a number that is none", [](Example& e, const Piece&) { e.curved[0].shape.origin.y = std::nan(""); }},
    {"a tolerance that is none", [](Example& e, const Piece&) { e.curved[0].tolerance = std::nan(""); }},
    {"a radius or an angle that is wrong",
     [](Example& e, const Piece&) {
       e.curved[0].shape.radius += 2.5 * e.curved[0].tolerance;
       e.curved[0].shape.half_angle += 2.5 * e.curved[0].tolerance;
     }},
    {"a centre that is wrong",
     [](Example& e, const Piece& of) {
       const Vec3 off = normal_at(of, e.positions[vertex_inside(e).value]);
       e.curved[0].shape.origin += 2.5 * e.curved[0].tolerance * off;
     }},
};

TEST(verify, every_mutation_of_a_curved_patch_is_refused) {
  for (const Piece& of : kPieces) {
    Example correct = remeshed(of, of.place, 16, 12, 8, 7, 0.03);
    correct.curved[0].tolerance = 1.01 * correct.verify().patch_bounds[0];
    ASSERT_TRUE(is_verified(correct)) << of.name;
    for (const Mutation& mutation : kMutations) {
      Example e = correct;
      mutation.apply(e, of);
      const Verdict v = e.verify();
      EXPECT_FALSE(v.surface && v.conforming) << of.name << ": " << mutation.name;
      EXPECT_TRUE(blames(v, PatchId(0))) << of.name << ": " << mutation.name;
    }
  }
}

TEST(verify, a_direction_of_the_axis_that_is_wrong_is_refused) {
  for (const Piece& of : kPieces) {
    Example e = remeshed(of);
    e.curved[0].tolerance = 1.01 * e.verify().patch_bounds[0];
    const AnalyticSurface right = e.curved[0].shape;
    if (right.kind == SurfaceKind::kSphere) continue;
    // About the middle of the piece, corners move by about 0.3 times its size.
    const Vec3 middle = of.place.point((of.low.x + of.high.x) / 2, (of.low.y + of.high.y) / 2);
    const CurvedPlace wrong = of.place.turned(middle - right.origin, 20, {});
    e.curved[0].shape = wrong.shape();
    EXPECT_FALSE(e.verify().surface) << of.name;
  }
}

TEST(verify, a_fold_inside_the_shell_is_found_by_orientation_alone) {
  // Two inner vertices that changed places: boundary, edges and shell are as they were.
  const Piece& of = kPieces[0];
  PatchedMesh input, output;
  const auto at = [&](double u, double v) { return of.place.point(u, v); };
  const std::vector<Vec3> corners{at(0, 0), at(0.4, 0), at(0.4, 0.4), at(0, 0.4)};
  for (const bool is_folded : {false, true}) {
    PatchedMesh mesh;
    const Vec3 left = at(is_folded ? 0.3 : 0.1, 0.2), right = at(is_folded ? 0.1 : 0.3, 0.2);
    mesh.add(PatchId(0), corners[0], corners[1], left);
    mesh.add(PatchId(0), corners[1], right, left);
    mesh.add(PatchId(0), corners[1], corners[2], right);
    mesh.add(PatchId(0), corners[2], corners[3], right);
    mesh.add(PatchId(0), corners[3], left, right);
    mesh.add(PatchId(0), corners[3], corners[0], left);
    input = PatchedMesh();
    input.add_fan(PatchId(0), corners);
    const Example e = curved_example(input, mesh, {of.place.shape()}, 0.1);
    EXPECT_EQ(e.verify().surface, !is_folded) << all_words(e.verify());
    EXPECT_EQ(all_words(e.verify()).find("turned over") != std::string::npos, is_folded);
  }
}

TEST(verify, a_sphere_that_is_covered_once_more_is_found) {
  const auto add_ball = [](PatchedMesh& mesh, double turn) {
    const CurvedPlace place = kSphere.turned({0.2, 1, 0.5}, turn, {});
    mesh.add_grid(PatchId(0), place, {0, -kPi / 2}, {kPi, kPi / 2}, 8, 8);
    mesh.add_grid(PatchId(0), place, {kPi, -kPi / 2}, {2 * kPi, kPi / 2}, 8, 8);
  };
  // Exact values at the poles and along the seams keep the ball closed.
  PatchedMesh piece, twice;
  piece.add_grid(PatchId(0), kSphere, {0.1, -0.5}, {1, 0.5}, 4, 4);
  twice.add_grid(PatchId(0), kSphere, {0.1, -0.5}, {1, 0.5}, 5, 5);
  EXPECT_TRUE(is_verified(curved_example(piece, twice, {kSphere.shape()}, 0.2)));
  PatchedMesh ball;
  add_ball(ball, 33);
  for (const Triangle& face : ball.faces)
    twice.add(PatchId(0), ball.positions[face[0].value], ball.positions[face[1].value], ball.positions[face[2].value]);
  const Verdict v = curved_example(piece, twice, {kSphere.shape()}, 0.2).verify();
  EXPECT_FALSE(v.surface);
  EXPECT_NE(all_words(v).find("another number of times"), std::string::npos) << all_words(v);
}

TEST(verify, the_complement_of_a_piece_of_a_sphere_is_refused) {
  // Octants of a sphere: the input is one of them, the output the other seven, looking either way.
  const PolygonMesh fine = shapes::sphere(3), coarse = shapes::sphere(2);
  const auto is_first = [](const PolygonMesh& mesh, std::size_t f) {
    Vec3 middle;
    for (const VertexId v : mesh.face(FaceId(f))) middle += mesh.positions[v];
    return middle.x > 0 && middle.y > 0 && middle.z > 0;
  };
  const auto select = [&](const PolygonMesh& mesh, bool is_rest, bool is_turned) {
    PatchedMesh out;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      if (is_first(mesh, f) == is_rest) continue;
      const auto face = mesh.face(FaceId(f));
      const auto at = [&](std::size_t k) { return mesh.positions[face[k]]; };
      out.add(PatchId(0), at(0), at(is_turned ? 2 : 1), at(is_turned ? 1 : 2));
    }
    return out;
  };
  const auto claim = [&](const PatchedMesh& output) {
    return curved_example(select(fine, false, false), output, {kSphere.shape()}, 0.2);
  };
  EXPECT_TRUE(is_verified(claim(select(coarse, false, false))));
  EXPECT_FALSE(claim(select(coarse, true, false)).verify().surface);
  EXPECT_FALSE(claim(select(coarse, true, true)).verify().surface);
  EXPECT_FALSE(claim(select(coarse, false, true)).verify().surface);
}

TEST(verify, an_apex_that_is_off_by_the_noise_of_the_input_is_taken_as_the_apex) {
  const Piece& of = kPieces[2];
  Example e = remeshed(of);
  const double noise = e.plane_tolerance;
  for (const Vec3& off : {Vec3{0, 0, -noise}, Vec3{noise, 0, 0}, Vec3{-noise, -noise, noise}, Vec3{0, 0, 6 * noise}}) {
    Example moved = e;
    moved.move([&](Vec3& p) {
      if (p == Vec3{}) p += off;
    });
    for (Vec3& p : moved.positions)
      if (p == Vec3{}) p += off;
    EXPECT_TRUE(is_verified(moved)) << off.x << " " << off.z;
  }
  // This is no noise any more: the corner is behind the apex.
  Example wrong = e;
  wrong.move([&](Vec3& p) {
    if (p == Vec3{}) p.z -= 1e-3;
  });
  for (Vec3& p : wrong.positions)
    if (p == Vec3{}) p.z -= 1e-3;
  EXPECT_FALSE(wrong.verify().surface);
}

TEST(verify, gaps_between_curved_patches_are_measured_along_their_normals) {
  // Two shells, one in the other, at a distance of 0.2. Their faces are about 0.4 long.
  const CurvedPlace inner{SurfaceKind::kCylinder, 1}, outer{SurfaceKind::kCylinder, 1.2};
  PatchedMesh input, output;
  const std::vector<AnalyticSurface> surfaces{inner.shape(), outer.shape()};
  for (const auto& [patch, place] : {std::pair(PatchId(0), inner), std::pair(PatchId(1), outer)}) {
    input.add_grid(patch, place, {0, 0}, {1.5, 1.5}, 12, 2);
    output.add_grid(patch, place, {0, 0}, {1.5, 1.5}, 5, 4);
  }
  Example e = curved_example(input, output, surfaces, 0.02);
  e.goals->proximity = 0.1;
  EXPECT_TRUE(is_verified(e));
  e.goals->proximity = 4;
  EXPECT_FALSE(*e.verify().quality);
  for (std::size_t f = 0; f < e.faces.size(); ++f) list(e, f, UnrefinedReason::kEffort);
  EXPECT_TRUE(is_verified(e));
}

}  // namespace
}  // namespace remesh
