// Tests that each triangle is listed that does not meet its bound on sizes. The gaps are measured here over all facets,
// one by one, in a way that is neither the pipeline's nor the checker's.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

/// By the contract, an edge may be a tenth longer than the size at a place plus what sizes grow by on the way from
/// there.
constexpr double kSlack = 1.1;
/// The square of the sine of 51 degrees.
constexpr double kSteep = 0.604;
/// A value that is nearer than this to a limit may be on either side of it without being a fault.
constexpr double kRelativeSlack = 1e-6;

using TrianglePlaces = std::array<Vec3, 3>;

Vec3 nearest_on_line(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double squared = dot(side, side);
  return squared > 0 ? a + std::clamp(dot(p - a, side) / squared, 0.0, 1.0) * side : a;
}

Vec3 nearest(const Vec3& p, const TrianglePlaces& t) {
  const Vec3 normal = normalized(cross(t[1] - t[0], t[2] - t[0]));
  bool is_over = true;
  for (std::size_t k = 0; k < 3; ++k) is_over = is_over && dot(cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0;
  if (is_over) return p - dot(p - t[0], normal) * normal;
  Vec3 best = t[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 q = nearest_on_line(p, t[k], t[(k + 1) % 3]);
    if (norm(q - p) < norm(best - p)) best = q;
  }
  return best;
}

/// Returns the length of the shortest way from p to q over a line. It is found by trying, since the length is a convex
/// function of the place where the line is crossed.
double way_over(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const auto way = [&](double t) { return norm(p - (a + t * (b - a))) + norm(q - (a + t * (b - a))); };
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = low + (high - low) / 3, t = high - (high - low) / 3;
    (way(s) < way(t) ? high : low) = way(s) < way(t) ? t : s;
  }
  return way(0.5 * (low + high));
}

/// A refined surface, patch by patch.
class Facets {
 public:
  explicit Facets(const Result& result) : mesh_(result.mesh), patch_(result.face_patch) {
    const std::size_t patches = result.report.patches.size();
    faces_.resize(patches);
    vertices_.resize(patches);
    edges_.resize(patches);
    std::map<std::array<VertexId, 2>, std::vector<std::pair<PatchId, bool>>> uses;
    for (std::uint32_t f = 0; f < mesh_.faces.size(); ++f) {
      const PatchId p = patch_[FaceId(f)];
      faces_[p.value].push_back(f);
      const Triangle& t = mesh_.faces[FaceId(f)];
      const TrianglePlaces c = corners(f);
      centre_.push_back((1.0 / 3) * (c[0] + c[1] + c[2]));
      radius_.push_back(std::max({norm(c[0] - centre_[f]), norm(c[1] - centre_[f]), norm(c[2] - centre_[f])}));
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId a = t[k], b = t[(k + 1) % 3];
        vertices_[p.value].insert(a);
        edges_[p.value].insert({std::min(a, b), std::max(a, b)});
        uses[{std::min(a, b), std::max(a, b)}].emplace_back(p, a < b);
      }
    }
    for (const PatchSummary& p : result.report.patches) normals_.push_back(p.normal);
    // A body: patches that are joined over edges, all of which have two faces that run along them in opposite ways.
    body_.resize(patches);
    std::iota(body_.begin(), body_.end(), 0u);
    std::set<std::uint32_t> open;
    for (const auto& [edge, at] : uses)
      for (const auto& [p, is_forward] : at) {
        const std::uint32_t from = body_[p.value], to = body_[at[0].first.value];
        std::replace(body_.begin(), body_.end(), from, to);
      }
    for (const auto& [edge, at] : uses)
      if (at.size() != 2 || at[0].second == at[1].second) open.insert(body_[at[0].first.value]);
    for (std::uint32_t& b : body_)
      if (open.count(b) != 0) b = kOpen;
  }

  TrianglePlaces corners(std::uint32_t f) const {
    const Triangle& t = mesh_.faces[FaceId(f)];
    return {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]};
  }

  /// How near another patch is whose nearest point is seen steeply, that no closed surface hides, and that is at least
  /// three times as far over the surface. Infinity if none is within the limit.
  double gap(const Vec3& place, PatchId p, double limit, double touching) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t q = 0; q < faces_.size(); ++q) {
      if (q == p.value) continue;
      Vec3 there;
      double d = std::numeric_limits<double>::infinity();
      for (const std::uint32_t f : faces_[q]) {
        if (norm(centre_[f] - place) > std::min(limit, d) + radius_[f]) continue;
        if (const Vec3 at = nearest(place, corners(f)); norm(at - place) < d) {
          there = at;
          d = norm(at - place);
        }
      }
      if (d >= std::min(limit, least) || d <= touching * (1 + kRelativeSlack)) continue;
      const Vec3 way = (1 / d) * (there - place);
      const double up = dot(way, normals_[p.value]), into = dot(way, normals_[q]);
      if (up * up < kSteep + kRelativeSlack) continue;
      if (body_[q] != kOpen && body_[q] == body_[p.value] && up * into > -kRelativeSlack) continue;
      if (is_way_over_surface(place, p, there, q, 3 * d * (1 + kRelativeSlack))) continue;
      if (is_across_wedge(place, p, there, q, d)) continue;
      least = d;
    }
    return least;
  }

 private:
  static constexpr std::uint32_t kOpen = 0xffffffffu;

  /// Is there a way over a vertex or an edge of both patches that is no longer than that?
  bool is_way_over_surface(const Vec3& from, PatchId p, const Vec3& to, std::uint32_t q, double most) const {
    const auto& at = mesh_.positions;
    for (const VertexId v : vertices_[p.value])
      if (norm(at[v] - from) + norm(at[v] - to) <= most && vertices_[q].count(v) != 0) return true;
    return std::any_of(edges_[p.value].begin(), edges_[p.value].end(), [&](const std::array<VertexId, 2>& e) {
      const Vec3 &a = at[e[0]], &b = at[e[1]];
      return norm(a - from) <= most + norm(b - a) && edges_[q].count(e) != 0 && way_over(from, to, a, b) <= most;
    });
  }

  /// Is there an edge of both patches with an angle below 60 degrees, and is the way over it not much longer?
  bool is_across_wedge(const Vec3& from, PatchId p, const Vec3& to, std::uint32_t q, double d) const {
    const auto& at = mesh_.positions;
    return std::any_of(edges_[p.value].begin(), edges_[p.value].end(), [&](const std::array<VertexId, 2>& e) {
      if (edges_[q].count(e) == 0) return false;
      const Vec3 &a = at[e[0]], &b = at[e[1]], along = normalized(b - a);
      const Vec3 u = normalized((from - a) - dot(from - a, along) * along);
      const Vec3 v = normalized((to - a) - dot(to - a, along) * along);
      const double sine = 0.5 * norm(u - v);  // of half the angle
      return sine < 0.5 + kRelativeSlack && way_over(from, to, a, b) <= 2 / sine * d * (1 + kRelativeSlack);
    });
  }

  const TriangleMesh& mesh_;
  const IdVector<FaceId, PatchId>& patch_;
  std::vector<std::vector<std::uint32_t>> faces_;  ///< by patch
  std::vector<std::set<VertexId>> vertices_;
  std::vector<std::set<std::array<VertexId, 2>>> edges_;
  std::vector<Vec3> normals_;
  std::vector<std::uint32_t> body_;
  std::vector<Vec3> centre_;  ///< one per face
  std::vector<double> radius_;
};

struct Measured {
  std::array<double, 3> length;
  std::array<Vec3, 3> middle;
  Vec3 centroid;

  explicit Measured(const TrianglePlaces& t) : centroid((1.0 / 3) * (t[0] + t[1] + t[2])) {
    for (std::size_t k = 0; k < 3; ++k) {
      length[k] = norm(t[(k + 1) % 3] - t[k]);
      middle[k] = 0.5 * (t[(k + 1) % 3] + t[k]);
    }
  }
};

/// Returns the faces that are larger than their gaps allow.
std::vector<std::uint32_t> faces_beyond_gaps(const Result& result, const Options& options) {
  const Facets facets(result);
  const double slope = options.gradation.value_or(1.5) - 1, tolerance = result.report.plane_tolerance;
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = 0; f < result.mesh.faces.size(); ++f) {
    const Measured face(facets.corners(f));
    const auto is_missed_at = [&](const Vec3& place) {
      double limit = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double size = face.length[k] / kSlack - slope * norm(face.middle[k] - place);
        limit = std::max(limit, size * options.proximity - tolerance);
      }
      return facets.gap(place, result.face_patch[FaceId(f)], limit * (1 - kRelativeSlack), tolerance) < HUGE_VAL;
    };
    if (is_missed_at(face.centroid) || std::any_of(face.middle.begin(), face.middle.end(), is_missed_at))
      found.push_back(f);
  }
  return found;
}

/// Expects that these faces are listed. If a reason has more faces than places, only the number of faces is compared.
void expect_listed(const std::vector<std::uint32_t>& faces, const Result& result) {
  EXPECT_LE(faces.size(), listed(result.report)) << listed_in_words(result.report);
  const auto& all = result.report.unrefined;
  if (std::any_of(all.begin(), all.end(), [](const Unrefined& u) { return u.count > u.places.size(); })) return;
  for (const std::uint32_t f : faces) {
    Vec3 centroid;
    for (const VertexId v : result.mesh.faces[FaceId(f)]) centroid += (1.0 / 3) * result.mesh.positions[v];
    const auto is_here = [&](const Vec3& p) { return norm(p - centroid) <= 1e-9 * (norm(p) + norm(centroid)); };
    EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                            [&](const Unrefined& u) { return std::any_of(u.places.begin(), u.places.end(), is_here); }))
        << "face " << f << " is beyond its gap and not listed; " << listed_in_words(result.report);
  }
}

/// Makes two narrow strips of length 1 that meet at an edge. A body would have two more sides, and gaps between these.
PolygonMesh wedge(double degrees) {
  const double angle = degrees * std::numbers::pi / 180, width = 0.006;
  const Vec3 up{std::cos(angle), 0, std::sin(angle)}, along{0, width, 0};
  return shapes::from_lists({{0, 0, 0}, along, Vec3{1, 0, 0}, Vec3{1, 0, 0} + along, up, up + along},
                            {{0, 2, 3, 1}, {0, 1, 5, 4}});
}
PolygonMesh stairs() {
  return shapes::prism({{-1.42, -0.09},
                        {1.42, -0.09},
                        {1.42, 1.91},
                        {0.71, 1.91},
                        {0.71, 1.54},
                        {0.18, 1.54},
                        {0.18, 1.16},
                        {-0.36, 1.16},
                        {-0.36, 0.79},
                        {-0.89, 0.79},
                        {-0.89, 0.41},
                        {-1.42, 0.41}},
                       2);
}
PolygonMesh slot() {
  return shapes::prism({{0, 0}, {2, 0}, {2, 1}, {1.08, 1}, {1.08, 0.3}, {0.92, 0.3}, {0.92, 1}, {0, 1}}, 0.5);
}
PolygonMesh notch() {
  return shapes::prism({{-1, -1}, {1, -1}, {1, 0.5}, {0.3, 0.5}, {0.05, -0.5}, {-0.05, -0.5}, {-0.3, 0.5}, {-1, 0.5}},
                       0.5);
}
PolygonMesh nested_boxes() {
  return shapes::joined(shapes::box({1, 1, 1}),
                        shapes::moved(shapes::turned_over(shapes::box({0.7, 0.7, 0.6})), {0.15, 0.12, 0.2}));
}
/// Makes two small sheets that are nearer to each other than the smallest size that gaps ask for.
PolygonMesh nearly_touching() {
  return shapes::joined(shapes::sheet(4, 4, 1, 1), shapes::moved(shapes::sheet(0.05, 0.04, 1, 1), {1, 1, 1e-4}));
}
PolygonMesh tilted_sheets() {
  const PolygonMesh over = shapes::rotated(shapes::sheet(0.8, 0.7, 1, 1), {0.2, -1, 0}, 20);
  return shapes::joined(shapes::sheet(2, 2, 1, 1), shapes::moved(over, {0.4, 0.3, 0.05}));
}

struct Scene {
  const char* name;
  PolygonMesh mesh;
};
std::vector<Scene> scenes() {
  return {{"plate", shapes::box({1.03, 0.77, 0.15})},
          {"tube", solids::tube(1, 0.5, 0.12)},
          {"slot", slot()},
          {"notch", notch()},
          {"nested boxes", nested_boxes()},
          {"wedge of 3 degrees", wedge(3)},
          {"wedge of 12 degrees", wedge(12)},
          {"wedge of 30 degrees", wedge(30)},
          {"stairs", stairs()},
          {"nearly touching", nearly_touching()},
          {"tilted sheets", tilted_sheets()},
          {"cylinder", shapes::cylinder(16, 0.5, 0.3)}};
}

/// Refines a mesh, and expects that the result is verified and that all faces that miss their gaps are listed.
/// Output: how many faces miss their gaps.
std::size_t expect_all_listed(const PolygonMesh& mesh, const Options& options) {
  const Result result = refined(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true())
      << (result.report.verified.failures.empty() ? "" : result.report.verified.failures[0]);
  const std::vector<std::uint32_t> beyond = faces_beyond_gaps(result, options);
  expect_listed(beyond, result);
  return beyond.size();
}

Options with_proximity(double proximity) {
  Options options;
  options.proximity = proximity;
  options.min_angle_deg = 20;
  return options;
}

TEST(size_promise, what_is_beyond_its_gap_is_listed) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    expect_all_listed(scene.mesh, with_proximity(1));
  }
}

TEST(size_promise, it_holds_however_a_part_lies_and_whatever_its_size) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.name);
    const PolygonMesh turned = shapes::rotated(scene.mesh, {1, 2, 3}, 33);
    expect_all_listed(shapes::moved(shapes::scaled(turned, 1e3), {17, -5, 300}), with_proximity(1));
  }
}

TEST(size_promise, it_holds_with_every_other_option_beside_it) {
  const std::pair<const char*, std::function<void(Options&)>> others[] = {
      {"half a gap", [](Options& o) { o.proximity = 0.5; }},
      {"no angle", [](Options& o) { o.min_angle_deg = 0; }},
      {"shortest edge", [](Options& o) { o.min_edge_length = 0.2; }},
      {"slow growth", [](Options& o) { o.gradation = 1.2; }},
      {"fast growth", [](Options& o) { o.gradation = 4; }},
      {"boundaries stay", [](Options& o) { o.split_boundaries = false; }},
      {"few faces", [](Options& o) { o.max_output_faces = 150; }},
      {"longest edge", [](Options& o) { o.max_edge_length = 0.4; }}};
  for (const auto& [name, change] : others)
    for (const Scene& scene : scenes()) {
      // Those with many faces take the oracle long.
      if (scene.name == std::string("wedge of 3 degrees") || scene.name == std::string("nearly touching")) continue;
      SCOPED_TRACE(std::string(name) + ", " + scene.name);
      Options options = with_proximity(1);
      change(options);
      try {
        expect_all_listed(scene.mesh, options);
      } catch (const Error& error) {
        EXPECT_EQ(error.code, Code::kOutputTooLarge) << error.what();
      }
    }
}

TEST(size_promise, a_gradation_of_any_size_is_checked_as_it_was_aimed_at) {
  // Three triangles in a fan about a corner, and one beside them. The fan's rim has short edges.
  const double far = 0.8947617251079392;
  const PolygonMesh mesh = shapes::from_lists({{far, far, 0},
                                               {0, 0, 0},
                                               {-far, far, 0},
                                               {-0.11579068764336044, 0.43213672932835917, 0},
                                               {-0.2236904312769849, 0.3874431921387319, 0},
                                               {-0.31634604168499864, 0.3163460416849987, 0}},
                                              {{2, 3, 1}, {2, 4, 3}, {2, 5, 4}, {0, 2, 1}});
  for (const double gradation : {1e3, 1e10, 1e12, 1e13, 1e20, 1e100, 1e300}) {
    Options options;
    options.gradation = gradation;
    expect_promises(mesh, options, refined(mesh, options));
  }
}

TEST(size_promise, what_is_thinner_than_the_smallest_size_is_listed_for_that) {
  const Options options = with_proximity(1);
  const Result result = refined(nearly_touching(), options);
  const std::size_t beyond = faces_beyond_gaps(result, options).size();
  EXPECT_GT(beyond, 50u);
  EXPECT_GE(listed(result.report, UnrefinedReason::kSizeFloor), beyond) << listed_in_words(result.report);
  EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kSizeFloor));
  // The two sides of a knife meet at its edge, so they are no gap.
  EXPECT_EQ(listed(refined(wedge(3), options).report), 0u);
}

TEST(size_promise, what_the_shortest_edge_keeps_from_its_gap_is_listed_for_that) {
  Options options = with_proximity(1);
  options.min_edge_length = 0.2;
  const PolygonMesh plate = shapes::box({1.03, 0.77, 0.05});
  const Result result = refined(plate, options);
  EXPECT_GT(faces_beyond_gaps(result, options).size(), 10u);
  EXPECT_GE(listed(result.report, UnrefinedReason::kMinEdgeLength), faces_beyond_gaps(result, options).size());
  EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kMinEdgeLength))
      << listed_in_words(result.report);
}

TEST(size_promise, what_the_budget_keeps_from_its_gap_is_listed_for_that) {
  Options options = with_proximity(1);
  options.max_output_faces = 100;
  const PolygonMesh plate = shapes::box({1.03, 0.77, 0.05});
  const Result result = refined(plate, options);
  EXPECT_LE(result.mesh.faces.size(), 100u);
  EXPECT_GT(faces_beyond_gaps(result, options).size(), 10u);
  EXPECT_GE(listed(result.report, UnrefinedReason::kBudget), 10u) << listed_in_words(result.report);
}

TEST(size_promise, what_meets_its_gaps_is_not_listed) {
  for (const PolygonMesh& mesh : {shapes::box({1.03, 0.77, 0.15}), shapes::box({1, 1, 1}), slot(), nested_boxes()}) {
    const Result result = refined(mesh, with_proximity(1));
    EXPECT_EQ(listed(result.report), 0u) << listed_in_words(result.report);
  }
}

/// Returns the segments of an input without collinear vertices, which are its edges that are not inside a plane.
std::vector<std::array<Vec3, 2>> sharp_edges(const PolygonMesh& mesh) {
  std::vector<std::array<Vec3, 2>> found;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t k = 0; k < face.size(); ++k)
      found.push_back({mesh.positions[face[k]], mesh.positions[face[(k + 1) % face.size()]]});
  }
  return found;
}

TEST(size_promise, edges_beside_short_ones_grow_as_asked_or_are_listed) {
  // A nick of 1/32, and one of a hundred thousandth: shorter than anything is made for gradation's sake.
  for (const double nick : {1.0 / 32, 1e-5})
    for (const double gradation : {1.2, 1.5, 3.0}) {
      const PolygonMesh mesh =
          shapes::polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2 + nick}, {nick, 2 + nick}, {nick, 2}, {0, 2}});
      Options options;
      options.min_angle_deg = 20;
      options.gradation = gradation;
      const Result result = refined(mesh, options);
      EXPECT_TRUE(result.report.verified.all_true());
      const auto edges = sharp_edges(mesh);
      std::vector<std::uint32_t> beyond;
      for (std::uint32_t f = 0; f < result.mesh.faces.size(); ++f) {
        const Triangle& t = result.mesh.faces[FaceId(f)];
        const Measured face({result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]});
        bool is_beyond = false;
        for (std::size_t k = 0; k < 3; ++k)
          for (const auto& [a, b] : edges) {
            const double way = norm(face.middle[k] - nearest_on_line(face.middle[k], a, b));
            const double size = norm(b - a) + (gradation - 1) * way;
            is_beyond = is_beyond || face.length[k] > kSlack * size * (1 + kRelativeSlack);
          }
        if (is_beyond) beyond.push_back(f);
      }
      expect_listed(beyond, result);
      // Where sizes may grow as fast as triangles of 20 degrees do, the bound on angles makes them grow no faster.
      if (gradation < 2) {
        EXPECT_EQ(beyond.empty(), nick > 1e-3) << nick << ' ' << gradation;
      }
      EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kSizeFloor));
    }
}

/// Makes a cylinder without ends whose last side does not quite come back to its first.
PolygonMesh cracked_cylinder(int sides, double crack) {
  std::vector<Vec3> points;
  for (int i = 0; i <= sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vec3 at{std::cos(angle), i == sides ? -crack : std::sin(angle), 0};
    points.push_back(at);
    points.push_back(at + Vec3{0, 0, 2});
  }
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i)
    faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  return shapes::from_lists(points, faces);
}
/// Makes a plate with a slit that is no wider than rounding, so that its border comes back to itself.
PolygonMesh slit_plate(double width) {
  return shapes::polygon({{0, 0}, {4, 0}, {4, 3}, {2 + width, 3}, {2 + width, 1}, {2, 1}, {2, 3}, {0, 3}});
}

TEST(boundary_locked, is_no_reason_where_nothing_is_locked) {
  const std::pair<const char*, PolygonMesh> cases[] = {{"crack of 6e-15", cracked_cylinder(24, 6e-15)},
                                                       {"crack of 1e-12", cracked_cylinder(24, 1e-12)},
                                                       {"slit of 4e-16", slit_plate(4e-16)},
                                                       {"slit of 1e-13", slit_plate(1e-13)},
                                                       {"slit of 1e-10", slit_plate(1e-10)}};
  std::uint64_t without_room = 0;
  for (const auto& [name, mesh] : cases)
    for (const double length : {0.0, 0.3}) {
      SCOPED_TRACE(name);
      Options options = with_angle(25);
      options.repair = {false, false, false, false, false, false};
      if (length > 0) options.max_edge_length = length;
      const Result result = refined(mesh, options);
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_EQ(listed(result.report, UnrefinedReason::kBoundaryLocked), 0u) << listed_in_words(result.report);
      without_room += listed(result.report, UnrefinedReason::kSizeFloor);
    }
  EXPECT_GT(without_room, 0u);
}

}  // namespace
}  // namespace remesh
