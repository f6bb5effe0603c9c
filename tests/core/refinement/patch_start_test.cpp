#include "core/refinement/refiner/patch_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>

#include "core/refinement/refiner/working_patch.h"
#include "tests/support/patch_subject.h"
#include "tests/support/polygons.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

struct Started {
  explicit Started(const PolygonMesh& mesh, const Options& options, std::uint64_t quota = 1000000)
      : subject(mesh, options),
        sizes(subject.patch(), subject.criteria, subject.chain.control),
        start(start_patch(subject.patch(), sizes, subject.cuts, quota, scratch, std::pmr::get_default_resource(),
                          subject.chain.control)) {}

  const PatchMesh& patch() const { return subject.chain.meshes[PatchId(0)]; }

  PatchSubject subject;
  PatchSizes sizes;
  DelaunayMesh::Scratch scratch;
  PatchStart start;
};

/// Expects that every vertex is where its place says. Vertices of the patch come first, then cuts, then points inside.
void expect_sound(const Started& started) {
  const PatchStart& start = started.start;
  ASSERT_EQ(start.places.size(), start.mesh.vertex_slots());
  ASSERT_EQ(start.boundary.side_count(), start.mesh.side_count());
  const PatchChart chart = started.subject.chart();
  std::size_t original = 0, on_segment = 0;
  for (std::uint32_t v = 0; v < start.places.size(); ++v) {
    const VertexPlace& place = start.places[v];
    if (place.is_original()) {
      ASSERT_EQ(original++, v);
      EXPECT_EQ(start.mesh.point(v), started.patch().uv[v]);
      EXPECT_GT(place.spacing().length, 0);
    } else if (place.is_on_segment()) {
      ASSERT_EQ(original + on_segment++, v);
      EXPECT_EQ(start.mesh.point(v), chart.to_plane(start.boundary.position(place.segment(), place.parameter())));
    }
  }
  EXPECT_EQ(original, started.patch().vertices.size());
  // Each side lies between the two vertices at the ends of its piece.
  for (std::uint32_t s = 0; s < start.mesh.side_count(); ++s) {
    const PatchBoundary::Side& side = start.boundary.side(s);
    const std::uint32_t h = start.mesh.half_edge_of_side(s);
    const SegmentId segment = start.boundary.segment_of(s);
    const auto expect_at = [&](std::uint32_t v, double t) {
      EXPECT_EQ(start.mesh.point(v), chart.to_plane(start.boundary.position(segment, t)));
    };
    expect_at(start.mesh.from(h), side.is_forward ? side.t0 : side.t1);
    expect_at(start.mesh.to(h), side.is_forward ? side.t1 : side.t0);
  }
}

TEST(patch_start, without_sizes_a_patch_begins_as_it_was_triangulated) {
  const Started started(solids::region(polygons::sieve(3)), with_angle(30));
  expect_sound(started);
  EXPECT_EQ(started.start.mesh.triangle_count(), started.patch().mesh.triangle_count());
  EXPECT_EQ(started.start.places.size(), started.patch().vertices.size());
}

TEST(patch_start, with_a_size_sides_are_cut_and_the_inside_is_filled) {
  Options options;
  for (const auto& [polygon, length] : {std::pair(polygons::l_shape(), 0.1), std::pair(polygons::sieve(3), 0.1)}) {
    options.max_edge_length = length;
    const Started started(solids::region(polygon), options);
    expect_sound(started);
    std::size_t cuts = 0, free = 0;
    for (const VertexPlace& place : started.start.places) {
      cuts += place.is_on_segment() ? 1 : 0;
      free += place.is_free() ? 1 : 0;
    }
    EXPECT_GT(cuts, 0u);
    EXPECT_GT(free, 0u);
    EXPECT_EQ(started.start.boundary.side_count(), started.patch().vertices.size() + cuts);
  }
}

TEST(patch_start, within_a_small_quota_no_point_is_put_inside) {
  Options options;
  options.max_edge_length = 0.1;
  const Started started(shapes::sheet(4, 4, 1, 1), options, 30);
  expect_sound(started);
  for (const VertexPlace& place : started.start.places) EXPECT_FALSE(place.is_free());
}

TEST(patch_start, a_patch_that_is_small_enough_stays_as_it_is) {
  Options options;
  options.max_edge_length = 100;
  const Started started(shapes::sheet(4, 4, 1, 1), options);
  expect_sound(started);
  EXPECT_EQ(started.start.mesh.triangle_count(), 2u);
}

TEST(working_patch, a_point_that_is_not_finite_has_no_room) {
  Options options;
  options.max_edge_length = 0.2;
  Started started(shapes::box({1, 1, 1}), options);
  const PatchChart chart = started.subject.chart();
  WorkingPatch patch(std::move(started.start), started.subject.patch(), chart, std::pmr::get_default_resource());
  std::uint32_t live = 0;
  while (!patch.mesh.is_live(live)) ++live;
  const Vec2 corner = patch.mesh.point(patch.mesh.from(3 * live));
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (const Vec2 p : {Vec2{none, corner.y}, Vec2{corner.x, none}, Vec2{none, none}}) {
      const PointPlace place = patch.look_at(p, live);
      EXPECT_FALSE(place.is_hidden());
      EXPECT_FALSE(place.has_room());
    }
}

}  // namespace
}  // namespace remesh
