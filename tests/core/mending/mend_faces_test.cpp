#include "core/mending/polygons/mend_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "core/mending/polygons/faces_without_area.h"
#include "core/mending/weld/weld.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"

namespace remesh {
namespace {

std::uint64_t count_of(const std::vector<Diagnostic>& diagnostics, DiagnosticCode code) {
  for (const Diagnostic& d : diagnostics)
    if (d.code == code) return d.count;
  return 0;
}

/// Returns the number of half-edges without a counterpart that runs the other way. It is 0 if the surface is closed and
/// consistently wound.
int open_half_edges(const Surface& surface) {
  std::map<std::pair<VertexId, VertexId>, int> balance;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const VertexId a = loop[i], b = loop[(i + 1) % loop.size()];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  int open = 0;
  for (const auto& [ends, count] : balance) open += std::abs(count);
  return open;
}

/// Expects what a Surface promises of its faces and vertices.
void expect_holds(const Surface& surface) {
  std::vector<int> uses(surface.vertex_count());
  ASSERT_EQ(surface.face_source.size(), surface.face_count());
  ASSERT_EQ(surface.face_label.size(), surface.face_label.empty() ? 0 : surface.face_count());
  ASSERT_EQ(surface.local.size(), surface.vertex_count());
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    ASSERT_GE(loop.size(), 3u);
    bool has_area = false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      ++uses[loop[i].value];
      EXPECT_NE(loop[i], loop[(i + 1) % loop.size()]);
      has_area =
          has_area || !is_collinear(surface.positions[loop[0]], surface.positions[loop[1]], surface.positions[loop[i]]);
    }
    EXPECT_TRUE(has_area) << FaceId(f);
  }
  for (const int n : uses) EXPECT_GT(n, 0);
}

TEST(is_collinear, it_is_exact) {
  EXPECT_TRUE(is_collinear({0, 0, 0}, {1, 2, 3}, {2, 4, 6}));
  EXPECT_TRUE(is_collinear({1, 1, 1}, {1, 1, 1}, {5, 6, 7}));
  EXPECT_FALSE(is_collinear({0, 0, 0}, {1, 2, 3}, {2, 4, std::nextafter(6.0, 7.0)}));
  EXPECT_FALSE(is_collinear({0, 0, 0}, {0, 1, 0}, {1, 0, 0}));
  EXPECT_FALSE(is_collinear({0, 0, 0}, {0, 0, 1}, {0, 1, 0}));
}

TEST(mend_faces, a_sound_surface_stays_as_it_is) {
  for (const PolygonMesh& mesh : {shapes::box({1, 2, 3}, 2), shapes::cylinder(7, 1, 2), shapes::ring(4)}) {
    std::vector<Diagnostic> diagnostics;
    const Surface surface = mended(mesh, 1e-9, diagnostics);
    EXPECT_EQ(surface.face_begin, mesh.face_begin);
    EXPECT_EQ(surface.corners, mesh.corners);
    EXPECT_TRUE(diagnostics.empty());
    expect_holds(surface);
  }
}

TEST(mend_faces, a_planar_concave_polygon_stays_one) {
  const Surface surface = mended(shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}));
  EXPECT_EQ(surface.face_count(), 1u);
}

TEST(mend_faces, a_polygon_that_touches_itself_as_along_a_bridge_comes_as_triangles_and_is_no_finding) {
  const PolygonMesh mesh =
      shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}});
  std::vector<Diagnostic> diagnostics;
  const Surface surface = mended(mesh, 1e-9, diagnostics);
  EXPECT_EQ(surface.face_count(), 8u);
  EXPECT_TRUE(diagnostics.empty());
  EXPECT_EQ(open_half_edges(surface), 8);
}

TEST(mend_faces, a_polygon_that_leaves_its_plane_comes_as_triangles_with_its_boundary) {
  std::vector<Diagnostic> diagnostics;
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0.1}},
                                              {{0, 1, 2, 3}, {1, 4, 5, 2}});
  const Surface surface = mended(mesh, 1e-3, diagnostics);
  EXPECT_EQ(surface.face_count(), 3u);
  EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kNonplanarPolygon), 1u);
  EXPECT_EQ(surface.face_source.items(), (FilledIdVector<FaceId, FaceId>::Items{FaceId(0), FaceId(0), FaceId(1)}));
  EXPECT_EQ(open_half_edges(surface), 6);
  expect_holds(surface);
}

TEST(mend_faces, the_tolerance_decides_what_is_planar) {
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.01}, {0, 1, 0}}, {{0, 1, 2, 3}});
  EXPECT_EQ(mended(mesh, 0.02).face_count(), 1u);
  EXPECT_EQ(mended(mesh, 1e-4).face_count(), 2u);
}

TEST(mend_faces, a_bow_tie_comes_as_triangles) {
  std::vector<Diagnostic> diagnostics;
  const Surface surface = mended(shapes::polygon({{0, 0}, {3, 1}, {3, 0}, {0, 2}}), 1e-6, diagnostics);
  EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kNonplanarPolygon), 1u);
  EXPECT_EQ(surface.face_count(), 2u);
  expect_holds(surface);
}

TEST(mend_faces, repeated_corners_are_one_and_their_faces_counted) {
  std::vector<Diagnostic> diagnostics;
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}},
                                              {{1, 4, 2}, {0, 1, 1, 2, 3, 3, 0}, {0, 0, 1}});
  const Surface surface = mended(mesh, 1e-6, diagnostics);
  EXPECT_EQ(surface.face_count(), 2u);
  EXPECT_EQ(surface.face(FaceId(1)).size(), 4u);
  EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kZeroAreaFace), 1u);
  ASSERT_EQ(count_of(diagnostics, DiagnosticCode::kDuplicateVertex), 1u);
  EXPECT_EQ(diagnostics.front().elements, (std::vector<std::uint64_t>{1}));
}

TEST(mend_faces, a_triangle_with_a_vertex_on_its_longest_edge_hands_it_over) {
  // A tetrahedron 0 1 2 3 whose edge 0-1 has the vertex 4 in it on one side only, the gap filled by triangle 0 4 1.
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}},
                                              {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 4}});
  std::vector<Diagnostic> diagnostics;
  const Surface surface = mended(mesh, 1e-6, diagnostics);
  EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kZeroAreaFace), 1u);
  EXPECT_EQ(surface.face_count(), 5u);
  EXPECT_EQ(surface.face(FaceId(0)).size(), 4u);
  EXPECT_EQ(open_half_edges(surface), 0);
  expect_holds(surface);
}

TEST(mend_faces, a_chain_of_zero_area_triangles_leaves_a_closed_surface_closed) {
  // As above, with many vertices on the edge and the gap filled by a random triangulation of the flat polygon.
  for (int seed = 0; seed < 40; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const int inner = random.integer(1, 9);
    std::vector<Vec3> positions = {{0, 0, 0}, {16, 0, 0}, {0, 16, 0}, {0, 0, 16}};
    std::vector<std::uint32_t> chain{0};
    for (int i = 1; i <= inner; ++i) {
      chain.push_back(static_cast<std::uint32_t>(positions.size()));
      positions.push_back({static_cast<double>(i), 0, 0});
    }
    chain.push_back(1);
    std::vector<std::vector<std::uint32_t>> faces = {{0, 2, 1}, {1, 2, 3}, {0, 3, 2}};
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) faces.push_back({chain[i], chain[i + 1], 3});
    std::vector<std::uint32_t> polygon(chain.rbegin(), chain.rend());  // 1 .. 0, and back along 0-1
    while (polygon.size() > 2) {
      const auto ear = static_cast<std::size_t>(random.integer(1, static_cast<int>(polygon.size()) - 2));
      faces.push_back({polygon[ear - 1], polygon[ear], polygon[ear + 1]});
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    const PolygonMesh mesh = shapes::renumbered(shapes::from_lists(positions, faces), static_cast<unsigned>(seed));
    ASSERT_EQ(open_half_edges(shapes::surface(mesh)), 0);
    std::vector<Diagnostic> diagnostics;
    const Surface surface = mended(mesh, 1e-6, diagnostics);
    EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kZeroAreaFace), static_cast<std::uint64_t>(inner)) << seed;
    EXPECT_EQ(open_half_edges(surface), 0) << seed;
    EXPECT_EQ(surface.vertex_count(), positions.size()) << seed;
    expect_holds(surface);
  }
}

TEST(mend_faces, a_flat_polygon_without_area_is_dropped_as_a_triangle_is) {
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {1, 0, 0}, {2, 0, 0}},
                         {{0, 2, 1}, {0, 4, 3}, {4, 5, 3}, {5, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 5, 4}});
  std::vector<Diagnostic> diagnostics;
  const Surface surface = mended(mesh, 1e-6, diagnostics);
  EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kZeroAreaFace), 1u);
  EXPECT_EQ(open_half_edges(surface), 0);
  expect_holds(surface);
}

TEST(mend_faces, a_polygon_that_only_runs_back_along_itself_is_dropped) {
  // None of these points is on a line with two others, so it is the order of the corners alone.
  const std::vector<Vec3> points{{4, 2, 2}, {0, 0, 2}, {1, 4, 0}, {1, 0, 4}};
  const std::vector<std::vector<std::uint32_t>> nothing{{3, 0, 2, 0},       {0, 3, 0, 2},       {0, 1, 2, 1, 3, 1},
                                                        {2, 1, 3, 1, 0, 1}, {0, 1, 2, 3, 2, 1}, {2, 3, 2, 1, 0, 1}};
  for (const auto& polygon : nothing) {
    std::vector<Diagnostic> diagnostics;
    const Surface surface = mended(shapes::from_lists(points, {{0, 1, 2}, polygon}), 1e-6, diagnostics);
    expect_holds(surface);
    EXPECT_EQ(surface.face_count(), 1u);
    EXPECT_EQ(count_of(diagnostics, DiagnosticCode::kZeroAreaFace), 1u);
  }
  // A triangle that a way leads to and back from is one.
  const Surface surface = mended(shapes::from_lists(points, {{0, 1, 2, 3, 2}}));
  EXPECT_GE(surface.face_count(), 1u);
}

TEST(mend_faces, only_zero_area_faces_are_an_empty_mesh) {
  try {
    mended(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kEmptyMesh);
  }
}

TEST(mend_faces, vertices_of_dropped_faces_go_with_them) {
  const Surface surface = mended(
      shapes::from_lists({{5, 5, 5}, {6, 6, 6}, {7, 7, 7}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(surface.vertex_count(), 3u);
  EXPECT_EQ(surface.vertex_source[VertexId(0)], VertexId(3));
  EXPECT_EQ(surface.face_source[FaceId(0)], FaceId(1));
}

TEST(mend_faces, a_stop_is_obeyed_while_faces_without_area_are_dropped) {
  constexpr int kCells = 500;
  PolygonMesh mesh = shapes::sheet(1, 1, kCells, kCells);
  mesh.corners.insert(mesh.corners.end(), {VertexId(0), VertexId(1), VertexId(2)});
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  RunControl control, of_weld;
  std::vector<Diagnostic> diagnostics;
  Surface surface = weld(mesh, {}, diagnostics, of_weld);
  // All faces have been looked at by then, which is half of the way.
  const double looked_at = 0.5 - 0x1p12 / static_cast<double>(mesh.face_count());
  std::atomic<bool> is_over = false;
  test::Seconds asked{0};
  std::thread watcher([&] {
    while (control.fraction() < looked_at && !is_over) std::this_thread::yield();
    asked = test::processor_time();
    control.cancel();
  });
  bool is_stopped = false;
  try {
    mend_faces(surface, 1e-6, {}, MendMode::kYes, diagnostics, control);
  } catch (const Error& error) {
    is_stopped = error.code == Code::kCancelled;
  }
  const test::Seconds ended = test::processor_time();
  is_over = true;
  watcher.join();
  // If the run was not stopped, it was asked to stop when nearly all was done. The time is that of the processor, so
  // other programs do not count.
  if (!is_stopped) test::expect_within(test::Seconds(0.02), ended - asked);
}

}  // namespace
}  // namespace remesh
