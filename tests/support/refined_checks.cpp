#include "tests/support/refined_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "core/geometry/intersections/patch_intersections.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/triangle_corners.h"
#include "core/patches/planar/input_intersections.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using Corners3 = std::array<Vec3, 3>;

Corners3 corners_of(const TriangleMesh& mesh, FaceId f) {
  const Triangle& t = mesh.faces[f];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

double angle_deg(const Vec3& at, const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a - at, b - at)), dot(a - at, b - at)) * 180 / std::numbers::pi;
}

double smallest_angle_deg(const Corners3& t) {
  return std::min({angle_deg(t[0], t[1], t[2]), angle_deg(t[1], t[2], t[0]), angle_deg(t[2], t[0], t[1])});
}

double longest_side(const Corners3& t) { return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])}); }

double area_of(const Corners3& t) { return norm(cross(t[1] - t[0], t[2] - t[0])) / 2; }

double distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double t = dot(side, side) > 0 ? std::clamp(dot(p - a, side) / dot(side, side), 0.0, 1.0) : 0;
  return norm(p - (a + t * side));
}

double distance(const Vec3& p, const Corners3& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  bool is_over = norm(normal) > 0;
  for (std::size_t k = 0; k < 3; ++k) is_over = is_over && dot(cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0;
  if (is_over) return std::fabs(dot(p - t[0], normalized(normal)));
  return std::min({distance(p, t[0], t[1]), distance(p, t[1], t[2]), distance(p, t[2], t[0])});
}

double distance(const Vec3& p, const std::vector<Corners3>& surface) {
  double least = HUGE_VAL;
  for (const Corners3& t : surface) least = std::min(least, distance(p, t));
  return least;
}

/// Returns the input as the triangles that the pipeline sees. The choice of diagonals does not matter, because planes
/// are exact.
std::vector<Corners3> triangles_of(const PolygonMesh& mesh) {
  RunControl control;
  const Surface surface = mended(mesh);
  std::vector<Corners3> all;
  const Triangulated triangles(surface, control);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = triangles.triangle(i);
    all.push_back({surface.positions[a], surface.positions[b], surface.positions[c]});
  }
  return all;
}

/// Returns the edges by their ends, with the faces at each.
std::map<std::array<Vec3, 2>, std::vector<FaceId>> edges_of(const TriangleMesh& mesh) {
  std::map<std::array<Vec3, 2>, std::vector<FaceId>> edges;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Corners3 t = corners_of(mesh, FaceId(f));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges[{low, high}].push_back(FaceId(f));
    }
  }
  return edges;
}

/// Returns the total length of edges by their number of faces. Edges with two faces are left out.
std::map<std::size_t, double> lengths_of_special_edges(const PolygonMesh& mesh) {
  std::map<std::array<Vec3, 2>, std::size_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto [low, high] = std::minmax(mesh.positions[face[k]], mesh.positions[face[(k + 1) % face.size()]]);
      ++faces[{low, high}];
    }
  }
  std::map<std::size_t, double> lengths;
  for (const auto& [ends, count] : faces)
    if (count != 2) lengths[count] += norm(ends[1] - ends[0]);
  return lengths;
}

Vec3 apex_of(const TriangleMesh& mesh, FaceId f, const std::array<Vec3, 2>& edge) {
  for (const Vec3& p : corners_of(mesh, f))
    if (p != edge[0] && p != edge[1]) return p;
  return {};
}

void expect_locally_delaunay(const Result& result) {
  const auto edges = edges_of(result.mesh);
  for (const auto& [edge, faces] : edges) {
    if (faces.size() != 2 || result.face_patch[faces[0]] != result.face_patch[faces[1]]) continue;
    const Vec3 c = apex_of(result.mesh, faces[0], edge), d = apex_of(result.mesh, faces[1], edge);
    if (angle_deg(c, edge[0], edge[1]) + angle_deg(d, edge[0], edge[1]) <= 180 + 1e-4) continue;
    // The chord rule applies: the better edge belongs to another patch.
    const auto [low, high] = std::minmax(c, d);
    EXPECT_TRUE(edges.count({low, high})) << "an edge that a flip would improve";
  }
}

std::size_t intersecting_pairs(const TriangleMesh& mesh) {
  RunControl control;
  return self_intersections(mesh.positions.items(), mesh.faces.items(), {}, 1000, control).pairs.size();
}

/// Counts the intersecting pairs of faces. If there are many faces, only those of different patches are compared:
/// needles side by side would take the square of their number. (patch_intersections_test compares the two methods.)
std::size_t intersecting_pairs(const Result& result) {
  constexpr std::size_t kMany = 8000;
  if (result.mesh.faces.size() <= kMany) return intersecting_pairs(result.mesh);
  std::vector<Vec3> normals;
  for (const PatchSummary& patch : result.report.patches) normals.push_back(patch.normal);
  const std::vector<std::uint8_t> is_simple(normals.size(), 1);
  RunControl control;
  return patch_intersections({result.mesh.positions.items(), corners_of(result.mesh.faces.items()),
                              result.face_patch.items(), normals, is_simple},
                             1000, control)
      .pairs.size();
}

}  // namespace

Result refined(const PolygonMesh& mesh, const Options& options, int workers) {
  RunControl control;
  return remesh_surface(mesh, options, RunSettings{workers, false}, control);
}

double predicted_faces(const PolygonMesh& mesh, const Options& options, int workers) {
  RunControl control;
  return static_cast<double>(analyze_surface(mesh, options, RunSettings{workers, false}, control).predicted_faces);
}

/// Curved surfaces keep their facets, so that what refinement makes of facets is tested, and not of joined patches.
Options with_angle(double degrees) {
  Options options;
  options.coarsens_fine_facets = false;
  options.min_angle_deg = degrees;
  return options;
}

Options with_length(double length) {
  Options options;
  options.coarsens_fine_facets = false;
  options.max_edge_length = length;
  return options;
}

Bounds bounds_of(const Options& options) {
  Bounds bounds;
  if (!options.refine) return bounds;
  bounds.min_angle_deg = options.min_angle_deg.value_or(25);
  if (options.max_radius_edge_ratio)
    bounds.min_angle_deg = std::min(33.0, std::asin(0.5 / *options.max_radius_edge_ratio) * 180 / std::numbers::pi);
  bounds.max_edge_length = options.max_edge_length.value_or(bounds.max_edge_length);
  bounds.max_area = options.max_area.value_or(bounds.max_area);
  return bounds;
}

bool do_sizes_vary(const Options& options) { return options.refine && (options.proximity > 0 || options.gradation); }

std::vector<FaceId> faces_beyond(const TriangleMesh& mesh, const Bounds& bounds, double slack) {
  std::vector<FaceId> found;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Corners3 t = corners_of(mesh, FaceId(f));
    if (smallest_angle_deg(t) < bounds.min_angle_deg * (1 - slack) ||
        longest_side(t) > bounds.max_edge_length * (1 + slack) || area_of(t) > bounds.max_area * (1 + slack))
      found.emplace_back(f);
  }
  return found;
}

double smallest_angle_deg(const TriangleMesh& mesh) {
  double least = 180;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    least = std::min(least, smallest_angle_deg(corners_of(mesh, FaceId(f))));
  return least;
}

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    longest = std::max(longest, longest_side(corners_of(mesh, FaceId(f))));
  return longest;
}

double shortest_edge(const TriangleMesh& mesh) {
  double shortest = HUGE_VAL;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Corners3 t = corners_of(mesh, FaceId(f));
    shortest = std::min({shortest, norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  }
  return shortest;
}

std::uint64_t listed(const Report& report, UnrefinedReason reason) {
  for (const Unrefined& u : report.unrefined)
    if (u.reason == reason) return u.count;
  return 0;
}

std::uint64_t listed(const Report& report) {
  std::uint64_t count = 0;
  for (const Unrefined& u : report.unrefined) count += u.count;
  return count;
}

std::string listed_in_words(const Report& report) {
  std::string words;
  for (const Unrefined& u : report.unrefined)
    words += (words.empty() ? "" : ", ") + std::string(unrefined_name(u.reason)) + ' ' + std::to_string(u.count);
  return words;
}

std::vector<Vec3> new_vertices(const PolygonMesh& input, const TriangleMesh& output) {
  const std::set<Vec3> old(input.positions.begin(), input.positions.end());
  std::vector<Vec3> fresh;
  std::copy_if(output.positions.begin(), output.positions.end(), std::back_inserter(fresh),
               [&](const Vec3& p) { return old.count(p) == 0; });
  return fresh;
}

void expect_promises(const PolygonMesh& input, const Options& options, const Result& result, double tolerance) {
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true()) << (report.verified.failures.empty() ? "" : report.verified.failures[0]);
  EXPECT_EQ(report.verified.quality.has_value(), options.refine);
  for (const PatchSummary& p : report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed) << reason_name(p.reason);

  // The output must be the same surface.
  const double size = report.input.bounding_box.diagonal();
  EXPECT_NEAR(report.output.area / report.input.area, 1, 10 * tolerance);
  EXPECT_EQ(report.output.closed, report.input.closed);
  EXPECT_EQ(report.output.euler, report.input.euler);
  EXPECT_EQ(report.output.components, report.input.components);
  ASSERT_EQ(report.output.volume.has_value(), report.input.volume.has_value());
  if (report.input.volume) {
    EXPECT_NEAR(*report.output.volume, *report.input.volume, 10 * tolerance * size * report.input.area);
  }
  const std::vector<Corners3> before = triangles_of(input);
  std::vector<Corners3> after;
  for (std::uint32_t f = 0; f < result.mesh.faces.size(); ++f) after.push_back(corners_of(result.mesh, FaceId(f)));
  if (before.size() * result.mesh.positions.size() < 3'000'000) {
    for (const Vec3& p : new_vertices(input, result.mesh)) ASSERT_LE(distance(p, before), tolerance * size);
    for (const Vec3& p : input.positions) ASSERT_LE(distance(p, after), tolerance * size);
  }

  // The output must conform.
  const auto special_before = lengths_of_special_edges(input);
  const auto special_after = lengths_of_special_edges(shapes::polygons(result.mesh));
  ASSERT_EQ(special_after.size(), special_before.size());
  for (const auto& [faces, length] : special_before) {
    ASSERT_TRUE(special_after.count(faces)) << "edges of " << faces << " faces";
    EXPECT_NEAR(special_after.at(faces) / length, 1, 10 * tolerance) << "edges of " << faces << " faces";
  }
  TriangleMesh cut;
  for (const Corners3& t : before)
    for (const Vec3& p : t) cut.positions.push_back(p);
  for (std::uint32_t f = 0; f < before.size(); ++f)
    cut.faces.push_back({VertexId(3 * f), VertexId(3 * f + 1), VertexId(3 * f + 2)});
  if (intersecting_pairs(shapes::triangles(shapes::welded(shapes::polygons(cut)))) == 0) {
    EXPECT_EQ(intersecting_pairs(result), 0u);
  }

  // The output must reach the quality that was asked for.
  expect_locally_delaunay(result);
  const Bounds bounds = bounds_of(options);
  EXPECT_LE(faces_beyond(result.mesh, bounds, 1e-8).size(), listed(report)) << listed_in_words(report);
  // refinement_size_promise_test measures the sizes that gaps and short edges ask for.
  if (!do_sizes_vary(options)) {
    EXPECT_GE(faces_beyond(result.mesh, bounds, -1e-8).size(), listed(report)) << listed_in_words(report);
  }
}

}  // namespace remesh
