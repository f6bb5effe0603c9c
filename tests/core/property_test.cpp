// Random polygons with holes on random planes in space, at all scales: what comes back is compared with formulas and
// with CGAL, not with what the pipeline says of itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "core/remesh.h"
#include "core/triangulation/patch_triangulation.h"
#include "tests/support/cgal_plane.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/triangulation_checks.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using polygons::Loop;
using polygons::Polygon;

const std::uint64_t kSeed = base_seed(20181);

struct Family {
  std::string name;
  std::function<Polygon(std::uint64_t)> make;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"star", [](std::uint64_t seed) { return polygons::star_with_holes(seed, 4 + static_cast<int>(seed % 60), 0); }},
      {"star with holes",
       [](std::uint64_t seed) { return polygons::star_with_holes(seed, 8 + static_cast<int>(seed % 60), 3); }},
      {"grown", [](std::uint64_t seed) { return polygons::grown(seed, 40, 16); }},
      {"rectilinear", [](std::uint64_t seed) { return polygons::rectilinear_with_holes(seed, 10); }},
  };
  return all;
}

/// Returns the number of corners at which the direction changes, which are those that must stay.
std::size_t corner_count(const Loop& loop) {
  std::size_t corners = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()], c = loop[(i + 2) % loop.size()];
    corners += cgal_orientation(a, b, c) != 0;
  }
  return corners;
}

std::size_t corner_count(const Polygon& polygon) {
  std::size_t corners = corner_count(polygon.outer);
  for (const Loop& hole : polygon.holes) corners += corner_count(hole);
  return corners;
}

/// A polygon that CGAL has cut into triangles. It has more points than its own corners, inside and on its sides.
struct Triangulated {
  std::vector<Vec2> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

bool is_inside(const Loop& loop, Vec2 p) {
  bool inside = false;  // a ray upwards
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
    if ((a.x <= p.x) != (b.x <= p.x)) {
      const bool above = cgal_orientation(std::min(a, b), std::max(a, b), p) < 0;
      inside = inside != above;
    }
  }
  return inside;
}

bool is_inside(const Polygon& polygon, Vec2 p) {
  return is_inside(polygon.outer, p) &&
         std::none_of(polygon.holes.begin(), polygon.holes.end(), [&](const Loop& hole) { return is_inside(hole, p); });
}

Triangulated randomly_triangulated(const Polygon& polygon, std::uint64_t seed) {
  Random random(seed);
  Triangulated result;
  std::vector<Segment> segments;
  const auto add_loop = [&](const Loop& loop) {
    const auto first = static_cast<std::uint32_t>(result.points.size());
    result.points.insert(result.points.end(), loop.begin(), loop.end());
    for (std::uint32_t i = 0; i < loop.size(); ++i)
      segments.push_back({first + i, first + (i + 1) % static_cast<std::uint32_t>(loop.size())});
  };
  add_loop(polygon.outer);
  for (const Loop& hole : polygon.holes) add_loop(hole);
  Vec2 low = polygon.outer[0], high = low;
  for (const Vec2 p : polygon.outer) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  for (int i = 0; i < 30; ++i) {
    const Vec2 p{random.uniform(low.x, high.x), random.uniform(low.y, high.y)};
    if (is_inside(polygon, p)) result.points.push_back(p);
  }
  for (const Corners& t : cgal_cdt(result.points, segments)) {
    const Vec2 centroid = (1.0 / 3) * (result.points[t[0]] + result.points[t[1]] + result.points[t[2]]);
    if (is_inside(polygon, centroid)) result.faces.push_back({t[0], t[1], t[2]});
  }
  return result;
}

/// Returns the polygon as one face. Every hole is joined by a bridge that crosses nothing to the loop made so far.
Loop bridged(const Polygon& polygon) {
  Loop walk = polygon.outer;
  std::vector<Loop> left = polygon.holes;
  const auto is_free = [&](Vec2 p, Vec2 q) {
    const auto blocks = [&](const Loop& loop) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::vector<Vec2> ends = {p, q, loop[i], loop[(i + 1) % loop.size()]};
        const bool touches = (ends[2] == p || ends[2] == q || ends[3] == p || ends[3] == q);
        if (!touches && segments_conflict(ends, {0, 1}, {2, 3})) return true;
        for (const Vec2 r : {ends[2], ends[3]})
          if (r != p && r != q && cgal_orientation(p, q, r) == 0 && std::min(p, q) < r && r < std::max(p, q))
            return true;
      }
      return false;
    };
    return !blocks(walk) && std::none_of(left.begin(), left.end(), blocks) && is_inside(polygon, 0.5 * (p + q));
  };
  while (!left.empty()) {
    bool is_joined = false;
    for (std::size_t h = 0; h < left.size() && !is_joined; ++h)
      for (std::size_t i = 0; i < walk.size() && !is_joined; ++i) {
        if (std::count(walk.begin(), walk.end(), walk[i]) > 1) continue;  // one bridge a corner
        for (std::size_t k = 0; k < left[h].size() && !is_joined; ++k) {
          if (!is_free(walk[i], left[h][k])) continue;
          Loop hole = left[h];
          std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(k), hole.end());
          hole.push_back(hole.front());
          hole.push_back(walk[i]);
          walk.insert(walk.begin() + static_cast<std::ptrdiff_t>(i) + 1, hole.begin(), hole.end());
          left.erase(left.begin() + static_cast<std::ptrdiff_t>(h));
          is_joined = true;
        }
      }
    if (!is_joined) return {};  // no free bridge left: the caller leaves this polygon out
  }
  return walk;
}

Segment undirected(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Expects the properties that every result for this polygon has, whatever triangulation of it was the input.
void expect_right(const Polygon& polygon, const polygons::Placement& place, const Result& result) {
  const double unit = norm(place.x_axis);
  const double area = polygons::area(polygon) * unit * unit;
  ASSERT_TRUE(result.report.verified.all_true());
  ASSERT_EQ(result.report.patches.size(), 1u);
  EXPECT_EQ(result.report.patches[0].status, PatchStatus::kRemeshed);
  EXPECT_EQ(result.report.patches[0].loops, 1 + polygon.holes.size());
  // A corner that turns by less than the tolerance may go; the families have none such, but where many are collinear.
  EXPECT_EQ(result.mesh.positions.size(), corner_count(polygon));
  EXPECT_EQ(result.mesh.faces.size(), corner_count(polygon) + 2 * polygon.holes.size() - 2);

  const Vec3 normal = normalized(cross(place.x_axis, place.y_axis));
  double sum = 0;
  std::map<std::pair<VertexId, VertexId>, std::vector<VertexId>> apexes;
  std::vector<Vec2> plane;
  for (const Vec3& p : result.mesh.positions)
    plane.push_back(
        {dot(p - place.origin, place.x_axis) / (unit * unit), dot(p - place.origin, place.y_axis) / (unit * unit)});
  for (const Triangle& t : result.mesh.faces) {
    const Vec3 a = result.mesh.positions[t[0]], b = result.mesh.positions[t[1]], c = result.mesh.positions[t[2]];
    const double twice = dot(cross(b - a, c - a), normal);
    EXPECT_GT(twice, 0) << "inverted";
    sum += twice / 2;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId u = t[k], v = t[(k + 1) % 3];
      apexes[std::minmax(u, v)].push_back(t[(k + 2) % 3]);
    }
  }
  EXPECT_NEAR(sum / area, 1, 1e-9);
  // Every output vertex is a corner; every edge with one face lies on the polygon's boundary, by length.
  double border = 0, perimeter = 0;
  const auto length_of = [](const Loop& loop) {
    double length = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) length += norm(loop[(i + 1) % loop.size()] - loop[i]);
    return length;
  };
  perimeter = length_of(polygon.outer);
  for (const Loop& hole : polygon.holes) perimeter += length_of(hole);
  for (const auto& [edge, opposite] : apexes) {
    ASSERT_LE(opposite.size(), 2u);
    const Vec2 a = plane[edge.first.value], b = plane[edge.second.value];
    if (opposite.size() == 1) {
      border += norm(b - a);
      continue;
    }
    // Locally Delaunay up to the rounding of the placement: the sine of the excess of the two angles.
    const auto angle = [&](VertexId v) {
      const Vec2 p = plane[v.value];
      return std::atan2(std::fabs(cross(a - p, b - p)), dot(a - p, b - p));
    };
    EXPECT_LT(angle(opposite[0]) + angle(opposite[1]), 3.14159265358979324 + 1e-7);
  }
  EXPECT_NEAR(border / perimeter, 1, 1e-9);
}

std::string name_of(const Family& family, std::uint64_t seed, double scale) {
  return family.name + ", seed " + std::to_string(seed) + ", scale " + std::to_string(scale);
}

constexpr double kScales[] = {1e-6, 1e-3, 1, 1e3, 1e6};

TEST(random_polygons, one_face_with_bridges_comes_back_with_its_area_and_loops) {
  int bridges = 0;
  for (std::uint64_t i = 0; i < 40; ++i)
    for (const Family& family : families()) {
      const std::uint64_t seed = kSeed + i;
      const double scale = kScales[i % 5];
      SCOPED_TRACE(name_of(family, seed, scale));
      const Polygon polygon = family.make(seed);
      const Loop walk = bridged(polygon);
      if (walk.empty()) continue;
      bridges += static_cast<int>(polygon.holes.size());
      const polygons::Placement place = polygons::random_placement(seed, scale);
      std::map<Vec2, std::uint32_t> index;
      std::vector<Vec3> positions;
      std::vector<std::uint32_t> face;
      for (const Vec2 p : walk) {
        const auto [it, is_new] = index.try_emplace(p, positions.size());
        if (is_new) positions.push_back(place(p));
        face.push_back(it->second);
      }
      expect_right(polygon, place, remeshed(shapes::from_lists(positions, {face})));
    }
  EXPECT_GT(bridges, 50);
}

TEST(random_polygons, any_triangulation_comes_back_with_its_area_and_loops) {
  for (std::uint64_t i = 0; i < 40; ++i)
    for (const Family& family : families()) {
      const std::uint64_t seed = kSeed + 1000 + i;
      const double scale = kScales[i % 5];
      SCOPED_TRACE(name_of(family, seed, scale));
      const Polygon polygon = family.make(seed);
      const Triangulated cut = randomly_triangulated(polygon, seed);
      const polygons::Placement place = polygons::random_placement(seed, scale);
      std::vector<Vec3> positions;
      for (const Vec2 p : cut.points) positions.push_back(place(p));
      expect_right(polygon, place, remeshed(shapes::from_lists(positions, cut.faces)));
    }
}

TEST(random_polygons, two_triangulations_of_one_polygon_give_the_same_surface) {
  for (std::uint64_t i = 0; i < 15; ++i)
    for (const Family& family : families()) {
      const std::uint64_t seed = kSeed + 2000 + i;
      SCOPED_TRACE(name_of(family, seed, 1));
      const Polygon polygon = family.make(seed);
      std::set<std::set<Vec3>> faces[2];
      for (const std::uint64_t k : {0u, 1u}) {
        const Triangulated cut = randomly_triangulated(polygon, 2 * seed + k);
        std::vector<Vec3> positions;
        for (const Vec2 p : cut.points) positions.push_back({p.x, p.y, 0});
        const Result result = remeshed(shapes::from_lists(positions, cut.faces));
        for (const Triangle& t : result.mesh.faces)
          faces[k].insert({result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]});
      }
      EXPECT_EQ(faces[0], faces[1]);
    }
}

TEST(random_polygons, the_triangles_are_those_of_the_oracle_where_no_tie_is_broken) {
  std::size_t compared = 0;
  for (std::uint64_t i = 0; i < 60; ++i)
    for (const Family& family : families()) {
      const std::uint64_t seed = kSeed + 3000 + i;
      SCOPED_TRACE(name_of(family, seed, 1));
      const Polygon polygon = family.make(seed);
      const polygons::PatchInput input = polygons::patch_input(polygon);
      RunControl control;
      const PatchTriangulation ours = triangulate_patch(input.points, input.edges, control);
      ASSERT_EQ(ours.outcome, TriangulationOutcome::kDone);
      std::vector<Corners> theirs;
      for (const Corners& t : cgal_cdt(input.points, input.edges))
        if (is_inside(polygon, (1.0 / 3) * (input.points[t[0]] + input.points[t[1]] + input.points[t[2]])))
          theirs.push_back(t);
      const auto mine = triangles_of(ours.mesh);
      ASSERT_EQ(mine.size(), theirs.size());
      // Edge by edge: one that only we have must be the diagonal of four cocircular points, by CGAL's exact predicate.
      std::set<Segment> oracle;
      for (const Corners& t : theirs)
        for (std::size_t k = 0; k < 3; ++k) oracle.insert(undirected(t[k], t[(k + 1) % 3]));
      const auto point = [&](std::uint32_t v) { return input.points[v]; };
      for (std::uint32_t h = 0; h < ours.mesh.half_edge_count(); ++h) {
        const std::uint32_t g = ours.mesh.twin(h);
        const Segment edge = undirected(ours.mesh.from(h), ours.mesh.to(h));
        if (g == Triangulation2d::kNoHalfEdge) {
          EXPECT_TRUE(oracle.count(edge));
          continue;
        }
        const int side = cgal_in_circle(point(ours.mesh.from(h)), point(ours.mesh.to(h)), point(ours.mesh.apex(h)),
                                        point(ours.mesh.apex(g)));
        EXPECT_LE(side, 0);
        if (side == 0) continue;
        // Two different circles: the edge is in every Delaunay triangulation, however ties fall.
        ++compared;
        EXPECT_TRUE(oracle.count(edge)) << edge[0] << '-' << edge[1];
      }
    }
  EXPECT_GT(compared, 3000u);
}

TEST(random_surfaces, steps_of_random_height_keep_area_volume_and_closedness) {
  // Blocks by a random drawing: many coplanar faces, edges of four faces, vertices where patches touch.
  for (std::uint64_t i = 0; i < 60; ++i) {
    const std::uint64_t seed = kSeed + 4000 + i;
    SCOPED_TRACE(seed);
    Random random(seed);
    const PolygonMesh mesh = shapes::renumbered(shapes::random_blocks(random, 5, 1 + static_cast<int>(seed % 2)),
                                                static_cast<unsigned>(seed));
    const Result result = remeshed(mesh);
    ASSERT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(result.report.output.area, result.report.input.area);
    EXPECT_EQ(result.report.output.euler, result.report.input.euler);
    EXPECT_EQ(result.report.output.non_manifold_edges * (1 + seed % 2), result.report.input.non_manifold_edges);
    for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
  }
}

/// Writes every coordinate in this format and reads it again. If the format is empty, it rounds them to floats.
PolygonMesh printed(PolygonMesh mesh, const std::string& format) {
  for (Vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      char text[64];
      std::snprintf(text, sizeof text, format.c_str(), p[axis]);
      p[axis] = format.empty() ? static_cast<double>(static_cast<float>(p[axis])) : std::strtod(text, nullptr);
    }
  return mesh;
}

TEST(random_surfaces, turned_blocks_have_the_same_patches_and_counts_in_every_number_format) {
  for (std::uint64_t i = 0; i < 12; ++i) {
    const std::uint64_t seed = kSeed + 7000 + i;
    Random random(seed);
    const PolygonMesh mesh = shapes::random_blocks(random, 4, 3);
    const Result exact = remeshed(mesh);
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const PolygonMesh turned = shapes::moved(shapes::rotated(mesh, axis, random.uniform(0, 360)), {1, -2, 0.5});
    for (const char* format : {"%.6f", "%.4f", "%g", "%.9g", "%.17g", ""}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", format " + format);
      const Result result = remeshed(printed(turned, format));
      ASSERT_TRUE(result.report.verified.all_true());
      EXPECT_EQ(result.report.patches.size(), exact.report.patches.size());
      EXPECT_EQ(result.mesh.positions.size(), exact.mesh.positions.size());
      EXPECT_EQ(result.mesh.faces.size(), exact.mesh.faces.size());
      EXPECT_EQ(result.report.output.euler, exact.report.output.euler);
      EXPECT_NEAR(result.report.output.area / exact.report.output.area, 1, 1e-3);
    }
  }
}

TEST(random_surfaces, terrain_of_whole_heights_keeps_its_area_and_border) {
  for (std::uint64_t i = 0; i < 40; ++i) {
    const std::uint64_t seed = kSeed + 5000 + i;
    SCOPED_TRACE(seed);
    Random random(seed);
    PolygonMesh mesh = shapes::sheet(8, 8, 8, 8);
    for (Vec3& p : mesh.positions) p.z = random.chance(0.15) ? random.integer(-1, 1) : 0;
    const Result result = remeshed(shapes::renumbered(mesh, static_cast<unsigned>(seed)));
    ASSERT_TRUE(result.report.verified.all_true());
    EXPECT_NEAR(result.report.output.area / result.report.input.area, 1, 1e-12);
    EXPECT_EQ(result.report.output.euler, 1);
    for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
  }
}

TEST(random_surfaces, noise_around_the_tolerance_never_breaks_the_result) {
  // The noise is from far below the tolerance to ten times it, and tolerances are up to the size of the faces.
  for (std::uint64_t seed = kSeed + 5500; seed < kSeed + 5600; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    PolygonMesh mesh = shapes::random_blocks(random, 4, 1 + static_cast<int>(seed % 4));
    Options options = unrefined();
    options.plane_tolerance = std::pow(10, random.uniform(-5, -0.7));
    const double noise = *options.plane_tolerance * std::pow(10, random.uniform(-1.5, 1));
    for (Vec3& p : mesh.positions) {
      const double x = random.uniform(-noise, noise), y = random.uniform(-noise, noise);
      p += {x, y, random.uniform(-noise, noise)};
    }
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_LE(result.report.verified.deviation, *options.plane_tolerance * (1 + 1e-9));
    EXPECT_EQ(result.report.output.closed, result.report.input.closed);
    EXPECT_EQ(result.report.output.euler, result.report.input.euler);
  }
}

/// Expects a verified answer, or an error that says why there is none: either no face has an area, or polygons on the
/// same vertices would have to share a diagonal, whatever their triangulations.
void expect_verified_or_refused(const PolygonMesh& mesh) {
  try {
    const Result result = remeshed(mesh);
    EXPECT_TRUE(result.report.verified.all_true());
    if (result.report.input.closed) {
      EXPECT_TRUE(result.report.output.closed);
    }
  } catch (const Error& error) {
    const bool is_shared_diagonal =
        error.code == Code::kVerificationFailed && std::string(error.what()).starts_with("faces on the same vertices");
    EXPECT_TRUE(error.code == Code::kEmptyMesh || is_shared_diagonal) << error.what();
  }
}

TEST(random_surfaces, any_soup_of_triangles_or_polygons_comes_back_verified) {
  for (const int max_corners : {3, 6})
    for (std::uint64_t seed = kSeed + 6000; seed < kSeed + 6450; ++seed) {
      SCOPED_TRACE(seed);
      Random random(seed);
      expect_verified_or_refused(shapes::random_soup(random, max_corners));
    }
}

}  // namespace
}  // namespace remesh
