#include "core/geometry/shells/inside_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/mesh/adjacency.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// One label per face. If there are none, all faces are labelled alike.
using Labels = std::vector<std::uint32_t>;
using Found = std::vector<FaceId>;

BodyLabels body_labels(const Labels& of_face) {
  BodyLabels labels;
  labels.set_of = of_face;
  for (std::uint32_t n = 0; !of_face.empty() && n <= *std::max_element(of_face.begin(), of_face.end()); ++n) {
    labels.labels.push_back(n);
    labels.begin.push_back(n + 1);
  }
  return labels;
}

InsideOut find_in(const PolygonMesh& mesh, const BodyLabels& labels) {
  RunControl control;
  const Adjacency edges(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  return find_inside_out(mesh.positions.items(), mesh.corners, edges, labels, control);
}

/// Returns the first face of each shell that looks the wrong way. Expects that no such shell is left once these are
/// turned over.
Found found_in(const PolygonMesh& mesh, const Labels& labels = {}) {
  const InsideOut found = find_in(mesh, body_labels(labels));
  EXPECT_EQ(found.is_inside_out.empty(), found.first_faces.empty());
  for (const FaceId f : found.first_faces) EXPECT_EQ(found.is_inside_out[f.value], 1);
  PolygonMesh turned = mesh;
  for (std::size_t f = 0; f < found.is_inside_out.size(); ++f)
    if (found.is_inside_out[f]) std::swap(turned.corners[3 * f], turned.corners[3 * f + 1]);
  EXPECT_TRUE(find_in(turned, body_labels(labels)).first_faces.empty()) << "not mended by turning";
  return found.first_faces;
}

enum Way { kOut, kIn };

/// Makes a cube about a place that looks outwards or inwards.
PolygonMesh cube(double size, Way way, const Vec3& at = {}) {
  PolygonMesh mesh = shapes::moved(shapes::box({size, size, size}, 2), at - Vec3{size / 2, size / 2, size / 2});
  return way == kIn ? shapes::turned_over(mesh) : mesh;
}
constexpr std::uint32_t kCube = 48;
FaceId first_of(std::uint32_t cube) { return FaceId(kCube * cube); }

PolygonMesh all(const std::vector<PolygonMesh>& meshes) {
  PolygonMesh joined = meshes[0];
  for (std::size_t i = 1; i < meshes.size(); ++i) joined = shapes::joined(joined, meshes[i]);
  return joined;
}

/// Tests cubes in each other. `nest` describes each of them by two characters, the outermost cube first. "O" or "I"
/// says whether the cube looks outwards or inwards, and the digit behind it is its label.
/// Output: the numbers of the cubes that look the wrong way.
std::string wrong_of(const std::string& nest) {
  const std::size_t count = nest.size() / 2;
  std::vector<PolygonMesh> cubes;
  Labels labels;
  for (std::size_t i = 0; i < count; ++i) {
    cubes.push_back(cube(static_cast<double>(count - i), nest[2 * i] == 'I' ? kIn : kOut));
    labels.insert(labels.end(), kCube, static_cast<std::uint32_t>(nest[2 * i + 1] - '0'));
  }
  std::string wrong;
  for (const FaceId f : found_in(all(cubes), labels)) wrong += std::to_string(f.value / kCube);
  return wrong;
}

TEST(find_inside_out, bodies_look_outwards_and_cavities_inwards) {
  EXPECT_EQ(wrong_of("O0"), "");
  EXPECT_EQ(wrong_of("I0"), "0");
  EXPECT_EQ(wrong_of("O0I0"), "");    // a hollow body
  EXPECT_EQ(wrong_of("O0O0"), "1");   // its cavity looks as the outer shell does
  EXPECT_EQ(wrong_of("I0O0"), "01");  // mirrored as a whole
  EXPECT_EQ(wrong_of("I0I0"), "0");
  EXPECT_EQ(found_in(all({cube(1, kOut), cube(1, kIn, {3, 0, 0}), cube(1, kIn, {-3, 0, 0})})),
            (Found{first_of(1), first_of(2)}));
}

TEST(find_inside_out, shells_are_judged_by_how_deep_they_lie) {
  EXPECT_EQ(wrong_of("O0I0O0I0"), "");
  EXPECT_EQ(wrong_of("I0O0I0O0"), "0123");
  EXPECT_EQ(wrong_of("O0O0O0O0"), "13");
  EXPECT_EQ(wrong_of("O0I0I0"), "2");
  EXPECT_EQ(wrong_of("O0O0I0I0"), "12");
  // Two bodies in a cavity that looks the wrong way, one of them with a cavity.
  const PolygonMesh mesh = all({cube(9, kOut), cube(8, kOut), cube(3, kOut, {-2, 0, 0}), cube(3, kIn, {2, 0, 0}),
                                cube(1, kOut, {2, 0, 0}), cube(1, kIn, {-2, 0, 0})});
  EXPECT_EQ(found_in(mesh), (Found{first_of(1), first_of(3), first_of(4)}));
}

TEST(find_inside_out, what_has_labels_of_its_own_may_be_a_solid_or_a_cavity_with_a_name) {
  EXPECT_EQ(wrong_of("O0O1"), "");     // fuel in its cladding
  EXPECT_EQ(wrong_of("O0I1"), "");     // a cavity whose wall has a name
  EXPECT_EQ(wrong_of("O0I0O1"), "");   // fuel in the cavity of its cladding
  EXPECT_EQ(wrong_of("O0O0O1"), "1");  // only the cladding's cavity is wrong
  EXPECT_EQ(wrong_of("O0I0I1"), "2");  // the fuel is mirrored
  EXPECT_EQ(wrong_of("O0O1I1"), "");   // a pellet with a hole
  EXPECT_EQ(wrong_of("O0O1O1"), "2");  // its hole looks the wrong way
  EXPECT_EQ(wrong_of("O0I0O1O1"), "3");
  EXPECT_EQ(wrong_of("I0I1"), "01");   // mirrored as a whole
  EXPECT_EQ(wrong_of("I0O1"), "0");    // the cladding alone
  EXPECT_EQ(wrong_of("O0I1I0"), "2");  // in the named cavity is nothing that may look inwards
}

TEST(find_inside_out, labels_that_alternate_with_the_depth_are_judged_by_what_is_next_outside) {
  EXPECT_EQ(wrong_of("O0O1O0O1"), "");
  EXPECT_EQ(wrong_of("O0I1O0I1"), "");
  EXPECT_EQ(wrong_of("O0I0O1I1O0I0"), "");
  EXPECT_EQ(wrong_of("O0O0O1O1O0O0"), "135");
  EXPECT_EQ(wrong_of("I0O0I1O1"), "0123");
}

TEST(find_inside_out, a_shell_shares_a_body_if_one_of_its_faces_does) {
  const PolygonMesh mesh = all({cube(4, kOut), cube(2, kOut)});
  // Faces of each that are labelled as other faces are not, as places where something happens are.
  Labels labels(2 * kCube, 0);
  labels[3] = 1;
  labels[kCube + 5] = labels[kCube + 6] = 2;
  EXPECT_EQ(found_in(mesh, labels), Found{first_of(1)});
  // All but one of the inner one's faces have labels of their own.
  std::fill(labels.begin() + kCube, labels.end(), 2);
  labels[kCube + 7] = 1;
  EXPECT_EQ(found_in(mesh, labels), Found{first_of(1)});
  labels[kCube + 7] = 3;
  EXPECT_EQ(found_in(mesh, labels), Found{});
}

TEST(find_inside_out, faces_that_stand_for_several_have_all_their_labels) {
  const PolygonMesh mesh = all({cube(4, kOut), cube(2, kOut)});
  BodyLabels labels;  // the outer one's faces: 0 or 1; the inner one's: 1 or 2, or only 2
  labels.labels = {0, 1, 1, 2, 2};
  labels.begin = {0, 2, 4, 5};
  labels.set_of.assign(2 * kCube, 0);
  std::fill(labels.set_of.begin() + kCube, labels.set_of.end(), 2);
  EXPECT_TRUE(find_in(mesh, labels).first_faces.empty());
  labels.set_of.back() = 1;
  EXPECT_EQ(find_in(mesh, labels).first_faces, Found{first_of(1)});
}

/// Makes cubes in one another, the outermost first. They look outwards and inwards in turn, so they are solids and
/// their cavities. One of them looks the wrong way.
PolygonMesh nest(int count, int wrong) {
  PolygonMesh mesh;
  const PolygonMesh shape = shapes::box({2, 2, 2});
  mesh.face_begin = {0};
  for (int i = 0; i < count; ++i) {
    const double size = count - i;
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    for (const Vec3& p : shape.positions) mesh.positions.push_back(size * (p - Vec3{1, 1, 1}));
    for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
      std::vector<VertexId> loop;
      for (const VertexId v : shape.face(FaceId(f))) loop.push_back(VertexId(first + v.value));
      if ((i % 2 == 1) != (i == wrong)) std::reverse(loop.begin(), loop.end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
  }
  return mesh;
}

TEST(find_inside_out, a_nest_of_any_number_of_shells_is_judged_right) {
  constexpr std::uint32_t kFaces = 12;
  EXPECT_EQ(found_in(nest(20, 4)), Found{FaceId(4 * kFaces)});
  constexpr int kMany = 6'000;
  EXPECT_EQ(found_in(nest(kMany, -1)), Found{});
  for (const int wrong : {0, kMany - 1, kMany - 2})
    EXPECT_EQ(found_in(nest(kMany, wrong)), Found{FaceId(wrong * kFaces)});
  const PolygonMesh turned = shapes::rotated(nest(600, 400), {1, 2, 3}, 40);
  EXPECT_EQ(found_in(turned), Found{FaceId(400 * kFaces)});
  // Side by side in the innermost one.
  for (const int count : {kMany, kMany - 1}) {
    PolygonMesh mesh = nest(count, -1);
    Found inwards;
    for (int i = 0; i < 10; ++i) {
      inwards.push_back(FaceId(mesh.face_count()));
      mesh = shapes::joined(mesh, cube(0.1, kIn, {0.15 * i - 0.7, 0, 0}));
    }
    EXPECT_EQ(found_in(mesh), count % 2 == 0 ? inwards : Found{});
  }
}

/// Random bodies and cavities in each other. Which of them are wrong follows from the rule alone, because their making
/// tells which lies in which.
class RandomNest {
 public:
  explicit RandomNest(std::uint64_t seed, bool has_labels) : random_(seed), has_labels_(has_labels) {
    fill({-1, -1, -1}, 2, 0, nullptr);
  }

  std::vector<PolygonMesh> shells;
  std::vector<std::uint32_t> label;
  std::vector<std::uint8_t> is_wrong;
  double volume = 0;  ///< volume of the bodies without their cavities; right if all labels are alike

 private:
  struct Outer {
    std::uint32_t label;
    bool is_out, is_wrong;
  };

  /// Puts up to two shells into the two halves of a cubic place, and so on in each.
  void fill(const Vec3& corner, double size, int depth, const Outer* outer) {
    if (depth > 4) return;
    for (int half = 0; half < 2; ++half) {
      if (depth > 0 && random_.chance(0.3)) continue;
      const double inner = 0.45 * size;
      const Vec3 at = corner + Vec3{half * 0.5 * size + 0.02 * size, 0.2 * size, 0.3 * size};
      const Outer shell = judged(outer);
      PolygonMesh mesh = shapes::moved(shapes::box({inner, inner, inner}), at);
      shells.push_back(shell.is_out ? mesh : shapes::turned_over(mesh));
      label.push_back(shell.label);
      is_wrong.push_back(shell.is_wrong);
      volume += (depth % 2 == 0 ? 1 : -1) * inner * inner * inner;
      fill(at, inner, depth + 1, &shell);
    }
  }

  Outer judged(const Outer* outer) {
    Outer shell{has_labels_ ? static_cast<std::uint32_t>(random_.below(3)) : 0, random_.chance(0.5), false};
    const bool is_in_solid = outer != nullptr && outer->is_out != outer->is_wrong;
    if (!is_in_solid)
      shell.is_wrong = !shell.is_out;
    else if (shell.label == outer->label)
      shell.is_wrong = shell.is_out;
    else
      shell.is_wrong = !shell.is_out && outer->is_wrong;
    return shell;
  }

  Random random_;
  bool has_labels_;
};

double volume_of(const PolygonMesh& mesh) {
  double sum = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto t = mesh.face(FaceId(f));
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  }
  return sum;
}

TEST(find_inside_out, random_nests_are_judged_as_they_were_made_in_any_order_place_and_scale) {
  const std::uint64_t seed = base_seed(20240611);
  for (std::uint64_t i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const bool has_labels = i % 2 == 0;
    const RandomNest made(seed + i, has_labels);
    // Each shell's number goes with its faces.
    PolygonMesh mesh = all(made.shells);
    mesh.labels.object.names.resize(made.shells.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) mesh.labels.object.of_face.push_back(f / 12);
    const double turn = 7.0 * static_cast<double>(i % 5), scale = i % 3 == 0 ? 1 : 3e5;
    mesh = shapes::scaled(
        shapes::moved(shapes::rotated(shapes::renumbered(mesh, static_cast<unsigned>(i)), {1, 2, 3}, turn),
                      {i % 4 == 0 ? 0.0 : 5.0, 0, 0}),
        scale);
    Labels labels;
    for (const std::uint32_t shell : mesh.labels.object.of_face) labels.push_back(made.label[shell]);
    const InsideOut found = find_in(mesh, body_labels(labels));
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const std::uint32_t shell = mesh.labels.object.of_face[FaceId(f)];
      ASSERT_EQ(!found.is_inside_out.empty() && found.is_inside_out[f] != 0, made.is_wrong[shell] != 0)
          << "shell " << shell;
      if (!found.is_inside_out.empty() && found.is_inside_out[f])
        std::swap(mesh.corners[3 * f], mesh.corners[3 * f + 1]);
    }
    if (!has_labels) {
      EXPECT_NEAR(volume_of(mesh) / (scale * scale * scale), made.volume, 1e-6);
    }
  }
}

TEST(find_inside_out, it_does_not_matter_how_all_is_turned) {
  const PolygonMesh mesh = all({cube(5, kOut), cube(3, kIn), cube(1, kIn), cube(0.5, kOut, {0, 2, 0})});
  for (int i = 0; i < 30; ++i) {
    const PolygonMesh turned = shapes::rotated(mesh, {1, 2, 3}, 12.0 * i);
    EXPECT_EQ(found_in(turned), (Found{first_of(2), first_of(3)})) << i;
  }
}

TEST(find_inside_out, what_lies_in_a_notch_lies_outside) {
  const PolygonMesh solid = shapes::blocks({"#.#", "#.#", "###"});
  const auto n = static_cast<std::uint32_t>(solid.face_count());
  const Vec3 in_notch{1.5, 2, 0.5}, in_arm{0.5, 2, 0.5};
  EXPECT_EQ(found_in(shapes::joined(solid, cube(0.5, kIn, in_notch))), Found{FaceId(n)});
  EXPECT_EQ(found_in(shapes::joined(solid, cube(0.5, kOut, in_notch))), Found{});
  EXPECT_EQ(found_in(shapes::joined(solid, cube(0.5, kIn, in_arm))), Found{});
  EXPECT_EQ(found_in(shapes::joined(solid, cube(0.5, kOut, in_arm))), Found{FaceId(n)});
}

/// Makes a tetrahedron that looks outwards.
PolygonMesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const PolygonMesh mesh = shapes::from_lists({a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  return volume_of(mesh) > 0 ? mesh : shapes::turned_over(mesh);
}

/// Expects the right shells to be found for a cavity in a solid, where each of the two looks as it should or the other
/// way.
void expect_cavity_judged(const PolygonMesh& solid, const PolygonMesh& inner, const std::string& what) {
  ASSERT_GT(volume_of(inner), 0);
  const FaceId outer_first(0), inner_first(solid.face_count());
  const auto found = [&](bool is_solid_turned, bool is_inner_turned) {
    return found_in(shapes::welded(shapes::joined(is_solid_turned ? shapes::turned_over(solid) : solid,
                                                  is_inner_turned ? shapes::turned_over(inner) : inner)));
  };
  EXPECT_EQ(found(false, true), Found{}) << what;
  EXPECT_EQ(found(false, false), Found{inner_first}) << what;
  EXPECT_EQ(found(true, true), Found{outer_first}) << what;
  EXPECT_EQ(found(true, false), (Found{outer_first, inner_first})) << what;
}

TEST(find_inside_out, a_cavity_may_touch_the_outer_shell) {
  const PolygonMesh solid = shapes::moved(shapes::box({2, 2, 2}, 2), {-1, -1, -1});
  // It touches in a vertex of both, which is any of the outer shell's corners.
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 1.0 : -1, i & 2 ? 1.0 : -1, i & 4 ? 1.0 : -1};
    expect_cavity_judged(solid, tetrahedron(corner, {0, 0, 0}, {0.5 * corner.x, 0, 0}, {0, 0.5 * corner.y, 0}),
                         "corner " + std::to_string(i));
  }
  // It touches in a vertex of its own that lies in a face or in an edge of the outer shell.
  expect_cavity_judged(solid, tetrahedron({1, 0.25, 0.375}, {0.5, 0, 0}, {0.5, 0, 0.5}, {0.5, 0.5, 0}), "in a face");
  expect_cavity_judged(solid, tetrahedron({-1, 0.25, 0.375}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}), "in a face");
  expect_cavity_judged(solid, tetrahedron({1, 1, 0.25}, {0, 0, 0}, {0.5, 0, 0.25}, {0.25, 0.5, 0.5}), "in an edge");
  // It touches along an edge of both.
  expect_cavity_judged(solid, tetrahedron({-1, -1, -1}, {-1, -1, 0}, {0.5, 0, 0}, {0, 0.5, 0.5}), "along an edge");
  // With all of its vertices, and with all of its edges.
  expect_cavity_judged(
      solid,
      shapes::from_lists({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                         {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}),
      "an octahedron");
  expect_cavity_judged(solid, tetrahedron({1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}), "a tetrahedron");
}

TEST(find_inside_out, bodies_that_touch_from_outside_are_no_cavities) {
  const PolygonMesh block = shapes::blocks({"###", "#..", "###"});  // around a notch
  const auto n = static_cast<std::uint32_t>(block.face_count());
  // The bodies are in the notch. They touch a face of it in a vertex, a corner of it, an edge of it, or whole walls.
  for (const PolygonMesh& right : {tetrahedron({1.5, 1, 0.5}, {2, 1.5, 0.5}, {1.5, 1.5, 0.5}, {1.75, 1.5, 0.75}),
                                   tetrahedron({1, 1, 0}, {1.5, 1.25, 0.25}, {1.25, 1.5, 0.25}, {1.25, 1.25, 0.75}),
                                   tetrahedron({1, 1, 0}, {1, 1, 1}, {1.5, 1.25, 0.5}, {1.25, 1.5, 0.5}),
                                   shapes::moved(shapes::box({1, 1, 1}), {1, 1, 0})}) {
    // Bodies whose whole walls meet are not welded, since neither would be closed by itself there.
    for (const bool is_welded : {false, right.face_count() == 4}) {
      const auto as = [&](const PolygonMesh& mesh) { return is_welded ? shapes::welded(mesh) : mesh; };
      EXPECT_EQ(found_in(as(shapes::joined(block, right))), Found{});
      EXPECT_EQ(found_in(as(shapes::joined(block, shapes::turned_over(right)))), Found{FaceId(n)});
    }
  }
}

TEST(find_inside_out, a_second_body_along_an_edge_leaves_a_shell_closed) {
  const PolygonMesh body = shapes::turned_over(shapes::box({1, 1, 1}));
  const PolygonMesh beside = shapes::welded(shapes::joined(shapes::moved(shapes::box({1, 1, 1}), {-1, -1, 0}), body));
  EXPECT_EQ(found_in(beside), Found{FaceId(12)});
}

TEST(find_inside_out, a_shell_with_open_pieces_on_its_edges_is_not_judged_but_what_lies_in_it_is) {
  const PolygonMesh fin = shapes::from_lists({{0, 0, 0}, {0, 0, 3}, {-1, -1, 0}}, {{0, 1, 2}});
  const PolygonMesh body = shapes::welded(shapes::joined(shapes::box({3, 3, 3}), fin));
  EXPECT_EQ(found_in(body), Found{});
  EXPECT_EQ(found_in(shapes::turned_over(body)), Found{});
  const PolygonMesh inner = shapes::moved(shapes::box({1, 1, 1}), {1, 1, 1});
  EXPECT_EQ(found_in(shapes::joined(body, inner)), Found{FaceId(13)});
  EXPECT_EQ(found_in(shapes::joined(body, shapes::turned_over(inner))), Found{});
}

TEST(find_inside_out, two_bodies_with_a_wall_each_between_them_are_told_apart_by_their_labels) {
  const PolygonMesh left = shapes::box({1, 1, 1}), right = shapes::moved(left, {1, 0, 0});
  Labels labels(24, 0);
  std::fill(labels.begin() + 12, labels.end(), 1);
  EXPECT_EQ(found_in(shapes::welded(shapes::joined(left, right)), labels), Found{});
  EXPECT_EQ(found_in(shapes::welded(shapes::joined(left, shapes::turned_over(right))), labels), Found{FaceId(12)});
  // Fuel that fills the cavity of its cladding.
  const PolygonMesh outer = shapes::moved(shapes::box({3, 3, 3}), {-1, -1, -1});
  labels.assign(36, 0);
  std::fill(labels.begin() + 24, labels.end(), 1);
  for (const bool is_welded : {false, true}) {
    const auto found = [&](const PolygonMesh& cavity, const PolygonMesh& fuel) {
      const PolygonMesh mesh = all({outer, cavity, fuel});
      return found_in(is_welded ? shapes::welded(mesh) : mesh, labels);
    };
    const PolygonMesh inwards = shapes::turned_over(left);
    EXPECT_EQ(found(inwards, left), Found{});
    EXPECT_EQ(found(left, left), Found{FaceId(12)});
    EXPECT_EQ(found(inwards, inwards), Found{FaceId(24)});
  }
}

TEST(find_inside_out, shells_in_one_place_are_right_if_one_order_of_them_is) {
  const PolygonMesh outer = cube(4, kOut), cavity = cube(2, kIn), filling = cube(2, kOut);
  EXPECT_EQ(found_in(all({outer, cavity, filling})), Found{});
  EXPECT_EQ(found_in(all({outer, filling, cavity})), Found{});
  EXPECT_EQ(found_in(all({cavity, filling})), Found{}) << "a solid without thickness";
  EXPECT_EQ(found_in(all({cavity, cavity})), Found{first_of(0)});
  EXPECT_EQ(found_in(all({outer, cavity, filling, cube(1, kIn)})), Found{});
  // The filling may have other triangles than the cavity.
  const PolygonMesh fine = shapes::moved(shapes::box({2, 2, 2}, 3), {-1, -1, -1});
  EXPECT_EQ(found_in(all({outer, cavity, fine})), Found{});
  EXPECT_EQ(found_in(all({outer, fine, cavity})), Found{});
}

TEST(find_inside_out, a_solid_that_crosses_another_is_no_cavity_of_it) {
  // A pin that is flush with a plate: its sides cross those of the hole, which has other facets.
  const PolygonMesh plate = cube(4, kOut), pin = shapes::rotated(cube(2, kOut), {0, 0, 1}, 10);
  const PolygonMesh hole = shapes::moved(shapes::box({2, 2, 2}, 2), {-1, -1, -1});
  EXPECT_EQ(found_in(all({plate, shapes::turned_over(hole), pin})), Found{});
  EXPECT_EQ(found_in(all({plate, pin})), Found{first_of(1)}) << "alone it crosses nothing";
  EXPECT_EQ(found_in(all({plate, cube(2, kOut, {1.75, 0.25, 0.125})})), Found{}) << "half outside";
}

/// Makes a box from one corner to the opposite one. It looks outwards or inwards, as `way` says.
PolygonMesh block(const Vec3& low, const Vec3& high, Way way = kOut) {
  const PolygonMesh mesh = shapes::moved(shapes::box(high - low), low);
  return way == kIn ? shapes::turned_over(mesh) : mesh;
}

TEST(find_inside_out, shells_that_cross_are_cavities_of_what_is_around_them_all_the_same) {
  const PolygonMesh outer = block({0, 0, 0}, {16, 16, 16}), first = block({2, 2, 2}, {6, 6, 6});
  const Found both{FaceId(12), FaceId(24)};
  EXPECT_EQ(found_in(all({outer, first, block({3, 4, 5}, {7, 9, 8})})), both);
  EXPECT_EQ(found_in(all({outer, first, block({3, 4, 5}, {7, 9, 8}, kIn)})), Found{FaceId(12)});
  // The boxes are in special position first and then in general position, and all is turned.
  Random random(base_seed(3608));
  for (int i = 0; i < 20; ++i) {
    const double much = i == 0 ? 0 : 1e-6;
    const auto any = [&] { return random.uniform(-much, much); };
    const PolygonMesh mesh = all({outer, first, shapes::moved(first, {2 + any(), 2 + any(), 2 + any()})});
    EXPECT_EQ(found_in(mesh), both) << i;
    EXPECT_EQ(found_in(shapes::rotated(mesh, {1, 2, 3}, 17.0 * i)), both) << i;
  }
}

/// Makes a box whose sides are four triangles each, around their middles.
PolygonMesh crossed_block(const Vec3& low, const Vec3& high) {
  const PolygonMesh quads = shapes::moved(shapes::quad_box(high - low), low);
  PolygonMesh mesh;
  mesh.positions = quads.positions;
  for (std::uint32_t f = 0; f < quads.face_count(); ++f) {
    const auto loop = quads.face(FaceId(f));
    const VertexId middle(mesh.vertex_count());
    mesh.positions.push_back(0.5 * (quads.positions[loop[0]] + quads.positions[loop[2]]));
    for (std::size_t i = 0; i < 4; ++i) {
      mesh.corners.insert(mesh.corners.end(), {loop[i], loop[(i + 1) % 4], middle});
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
  }
  return mesh;
}

TEST(find_inside_out, a_solid_that_crosses_the_one_around_it_in_edges_only_is_no_cavity_of_it) {
  // A U whose walls have vertices wherever both coordinates are even, and a bar from an arm into the gap: where it
  // passes the wall are its edges, and the edges and vertices of the wall.
  const PolygonMesh u = shapes::scaled(shapes::blocks({"#.#", "#.#", "###"}, 4), 8);
  const FaceId bar_first(u.face_count());
  EXPECT_EQ(found_in(all({u, crossed_block({4, 12, 2}, {12, 16, 6})})), Found{});
  EXPECT_EQ(found_in(all({u, crossed_block({4, 13, 2.5}, {12, 17, 5})})), Found{}) << "in general position";
  EXPECT_EQ(found_in(all({u, crossed_block({4, 2, 2}, {12, 6, 6})})), Found{bar_first}) << "where all is solid";
}

TEST(find_inside_out, what_crosses_a_body_does_not_tell_where_a_cavity_of_it_lies) {
  // Bars through a wall on each side of the cavity.
  const PolygonMesh body = block({0, 0, 0}, {16, 16, 16});
  std::vector<PolygonMesh> meshes{body};
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-8.0, 8.0}) {
      Vec3 low{7, 7, 7}, high{9, 9, 9};
      low[axis] += side < 0 ? -12 : 2.5;
      high[axis] += side < 0 ? -2.5 : 12;
      meshes.push_back(block(low, high));
    }
  const auto with = [&](Way way) {
    std::vector<PolygonMesh> both = meshes;
    both.push_back(block({7, 7, 7}, {9, 9, 9}, way));
    return all(both);
  };
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(found_in(shapes::rotated(with(kIn), {1, 2, 3}, 13.0 * i)), Found{}) << i;
    EXPECT_EQ(found_in(shapes::rotated(with(kOut), {1, 2, 3}, 13.0 * i)), Found{FaceId(7 * 12)}) << i;
  }
}

TEST(find_inside_out, many_shells_in_a_row_are_placed_each_by_its_neighbour) {
  constexpr int kMany = 10'000;
  for (int axis = 0; axis < 3; ++axis) {
    PolygonMesh mesh = block({-1, -1, -1}, axis == 0   ? Vec3{kMany, 2, 2}
                                           : axis == 1 ? Vec3{2, kMany, 2}
                                                       : Vec3{2, 2, kMany});
    const PolygonMesh shape = shapes::box({0.5, 0.5, 0.5});
    const int wrong = kMany - 7;
    for (int i = 0; i < kMany - 1; ++i) {
      Vec3 at;
      at[axis] = i;
      const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
      for (const Vec3& p : shape.positions) mesh.positions.push_back(at + p);
      for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
        std::vector<VertexId> loop;
        for (const VertexId v : shape.face(FaceId(f))) loop.push_back(VertexId(first + v.value));
        if (i != wrong) std::reverse(loop.begin(), loop.end());
        mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
        mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
      }
    }
    EXPECT_EQ(found_in(mesh), Found{FaceId(12 * (1 + wrong))}) << axis;
  }
}

TEST(find_inside_out, open_and_doubled_sheets_enclose_nothing) {
  EXPECT_TRUE(found_in(shapes::turned_over(shapes::sheet(1, 1, 2, 2))).empty());
  EXPECT_TRUE(found_in(shapes::rotated(shapes::double_sheet(1), {1, 2, 3}, 33)).empty());
  EXPECT_TRUE(found_in(shapes::rotated(shapes::turned_over(shapes::double_sheet(1)), {1, 2, 3}, 33)).empty());
  // An open shell is none, around others or in them. It may be a body around what is in it.
  PolygonMesh open = cube(4, kOut);
  open.corners.resize(open.corners.size() - 3);
  open.face_begin.pop_back();
  EXPECT_EQ(found_in(shapes::joined(open, cube(2, kOut))), Found{});
  EXPECT_EQ(found_in(shapes::joined(open, cube(2, kIn))), Found{});
  EXPECT_EQ(found_in(all({cube(8, kOut), open})), Found{});
}

}  // namespace
}  // namespace remesh
