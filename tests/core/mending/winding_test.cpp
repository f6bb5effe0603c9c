#include "core/mending/faces/winding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

struct Wound {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

template <class Stage>
Wound run(const PolygonMesh& mesh, MendMode mend, const Stage& stage) {
  RunControl control;
  Wound result{shapes::surface(mesh), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners, control);
  result.is_changed = stage(result.surface, edges, mend, result.diagnostics, control);
  return result;
}
Wound unify(const PolygonMesh& mesh, MendMode mend = MendMode::kYes) {
  return run(mesh, mend,
             [&](Surface& surface, const Adjacency& edges, MendMode if_asked, auto& diagnostics, auto& control) {
               return unify_winding(surface, edges, mesh.labels, if_asked, diagnostics, control);
             });
}
Wound turn(const PolygonMesh& mesh, MendMode mend = MendMode::kYes) {
  return run(mesh, mend,
             [&](Surface& surface, const Adjacency& edges, MendMode if_asked, auto& diagnostics, auto& control) {
               return turn_inside_out(surface, edges, mesh.labels, if_asked, diagnostics, control);
             });
}

PolygonMesh with_turned(PolygonMesh mesh, const std::vector<std::size_t>& faces) {
  for (const std::size_t f : faces)
    std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
  return mesh;
}

double volume(const Surface& surface) {
  double sum = 0;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      sum += dot(surface.positions[loop[0]], cross(surface.positions[loop[i]], surface.positions[loop[i + 1]])) / 6;
  }
  return sum;
}

TEST(unify_winding, a_sound_surface_is_left_alone) {
  const Wound result = unify(shapes::box({1, 2, 3}, 3));
  EXPECT_FALSE(result.is_changed);
  EXPECT_TRUE(result.diagnostics.empty());
}

TEST(unify_winding, the_faces_that_look_inwards_or_are_of_less_area_turn_and_are_listed) {
  const PolygonMesh box = shapes::box({1, 2, 3}, 2);
  const Wound result = unify(with_turned(box, {3, 17, 18}));
  EXPECT_TRUE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kInconsistentWinding);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{3, 17, 18}));
  EXPECT_DOUBLE_EQ(volume(result.surface), 6);
  // The larger area decides only where nothing is enclosed.
  EXPECT_DOUBLE_EQ(volume(unify(with_turned(shapes::turned_over(box), {5})).surface), 6);
  const PolygonMesh sheet = shapes::turned_over(shapes::sheet(1, 1, 3, 3));
  EXPECT_EQ(unify(with_turned(sheet, {5, 7})).diagnostics[0].elements, (std::vector<std::uint64_t>{5, 7}));
}

TEST(unify_winding, faces_turned_at_random_agree_again_and_pieces_do_so_each_by_itself) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    PolygonMesh mesh =
        shapes::joined(shapes::box({1, 2, 3}, 4), shapes::moved(shapes::quad_box({1, 1, 1}, 3), {5, 0, 0}));
    std::vector<std::size_t> turned;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      if (random.chance(0.5)) turned.push_back(f);
    const Wound once = unify(with_turned(mesh, turned));
    EXPECT_TRUE(once.is_changed);
    const double v = volume(once.surface);
    EXPECT_TRUE(std::fabs(std::fabs(v) - 7) < 1e-12 || std::fabs(std::fabs(v) - 5) < 1e-12) << v;
  }
}

TEST(unify_winding, a_closed_mixture_faces_outwards_and_a_cavity_inwards_whatever_the_areas) {
  // One or three of four faces of a tetrahedron are turned, so the larger area faces inwards once.
  const PolygonMesh tetrahedron =
      shapes::from_lists({{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const PolygonMesh cavity = shapes::moved(shapes::scaled(tetrahedron, 0.125), {0.5, 0.5, 0.5});
  for (const std::vector<std::size_t>& turned : {std::vector<std::size_t>{0}, {0, 1, 2}, {2}, {0, 2}}) {
    EXPECT_NEAR(volume(unify(with_turned(tetrahedron, turned)).surface), 36, 1e-12);
    PolygonMesh hollow = shapes::joined(tetrahedron, with_turned(cavity, turned));
    for (unsigned seed = 0; seed < 3; ++seed) {
      const double inner = 36.0 / 512;
      EXPECT_NEAR(volume(unify(shapes::renumbered(hollow, seed)).surface), 36 - inner, 1e-12);
      // A body of another material inside is a body.
      PolygonMesh filled = hollow;
      filled.labels.material.names = {"a", "b"};
      filled.labels.material.of_face.assign(8, 0);
      for (std::size_t f = 4; f < 8; ++f) filled.labels.material.of_face[FaceId(f)] = 1;
      EXPECT_NEAR(volume(unify(shapes::renumbered(filled, seed)).surface), 36 + inner, 1e-12);
    }
  }
}

TEST(unify_winding, a_moebius_strip_stays_and_is_reported) {
  constexpr int kQuads = 12;
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < kQuads; ++i) {
    const double turn = 2 * std::numbers::pi * i / kQuads, half = turn / 2;
    for (const double side : {-0.3, 0.3})
      points.push_back({(1 + side * std::cos(half)) * std::cos(turn), (1 + side * std::cos(half)) * std::sin(turn),
                        side * std::sin(half)});
  }
  for (std::uint32_t i = 0; i < kQuads; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1;
    const bool is_last = i + 1 == kQuads;
    const std::uint32_t c = is_last ? 0 : b + 2, d = is_last ? 1 : a + 2;
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  }
  const Wound result = unify(shapes::from_lists(points, faces));
  EXPECT_FALSE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
  EXPECT_EQ(result.diagnostics[0].elements, std::vector<std::uint64_t>{0});
}

TEST(unify_winding, where_nothing_is_to_be_mended_the_edges_are_counted) {
  const Wound result = unify(with_turned(shapes::box({1, 1, 1}), {0}), MendMode::kNo);
  EXPECT_FALSE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 3u);
}

TEST(unify_winding, edges_of_more_than_two_faces_connect_nothing) {
  const PolygonMesh mesh = with_turned(shapes::three_pages(), {0, 1});
  EXPECT_FALSE(unify(mesh).is_changed);
}

TEST(turn_inside_out, a_closed_piece_that_looks_inwards_is_reported_and_turned_where_asked) {
  const PolygonMesh mesh =
      shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::turned_over(shapes::box({1, 1, 1})), {3, 0, 0}));
  const Wound found = turn(mesh, MendMode::kNo);
  EXPECT_FALSE(found.is_changed);
  ASSERT_EQ(found.diagnostics.size(), 1u);
  EXPECT_EQ(found.diagnostics[0].code, DiagnosticCode::kInsideOut);
  EXPECT_EQ(found.diagnostics[0].elements, std::vector<std::uint64_t>{12});
  EXPECT_DOUBLE_EQ(volume(turn(mesh).surface), 2);
}

TEST(turn_inside_out, polygons_are_judged_as_what_they_cover) {
  const std::vector<Vec2> u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  const PolygonMesh solid = shapes::prism(u, 1), small = shapes::quad_box({0.5, 0.5, 0.5});
  const auto in_notch = shapes::moved(small, {1.25, 2, 0.25}), in_arm = shapes::moved(small, {0.25, 2, 0.25});
  const std::vector<std::uint64_t> inner{solid.face_count()};
  const auto elements = [&](const PolygonMesh& body) {
    const Wound found = turn(shapes::joined(solid, body), MendMode::kNo);
    return found.diagnostics.empty() ? std::vector<std::uint64_t>{} : found.diagnostics[0].elements;
  };
  EXPECT_EQ(elements(in_arm), inner);
  EXPECT_TRUE(elements(shapes::turned_over(in_arm)).empty());
  EXPECT_TRUE(elements(in_notch).empty());
  EXPECT_EQ(elements(shapes::turned_over(in_notch)), inner);
  EXPECT_DOUBLE_EQ(volume(turn(shapes::joined(solid, in_arm)).surface), 7 - 0.125);
}

TEST(turn_inside_out, each_kind_of_label_tells_bodies_apart) {
  PolygonMesh mesh = shapes::joined(shapes::box({3, 3, 3}), shapes::moved(shapes::box({1, 1, 1}), {1, 1, 1}));
  EXPECT_DOUBLE_EQ(volume(turn(mesh).surface), 26);
  for (LabelSet FaceLabels::*kind : {&FaceLabels::object, &FaceLabels::group, &FaceLabels::material}) {
    PolygonMesh labelled = mesh;
    LabelSet& set = labelled.labels.*kind;
    set.names = {"cladding", "fuel"};
    set.of_face.assign(24, 0);
    EXPECT_DOUBLE_EQ(volume(turn(labelled).surface), 26) << "one name is used";
    for (std::uint32_t f = 12; f < 24; ++f) set.of_face[FaceId(f)] = 1;
    EXPECT_FALSE(turn(labelled).is_changed);
  }
}

}  // namespace
}  // namespace remesh
