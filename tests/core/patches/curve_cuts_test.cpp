#include "core/patches/curve_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include "core/base/error.h"
#include "core/mesh/pinched_vertices.h"
#include "tests/support/errors.h"
#include "tests/support/primitives.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kPi = std::numbers::pi;

/// A mesh whose groups are its patches, and what is known of each patch.
struct Part {
  PolygonMesh mesh;
  std::vector<AnalyticSurface> shapes;  ///< by group; kPlane for a planar patch
};

AnalyticSurface shape_of(const test::PlainSurface& s) {
  AnalyticSurface shape;
  shape.kind = s.kind;
  shape.origin = s.point;
  shape.axis = normalized(s.axis);
  shape.radius = s.radius;
  shape.minor_radius = s.tube;
  shape.half_angle = s.half_deg * kPi / 180;
  return shape;
}

Part part_of(const primitives::Model& model) {
  Part part{with_groups(model.mesh, model.surface_of.items()), {}};
  for (const test::PlainSurface& s : model.surfaces) part.shapes.push_back(shape_of(s));
  return part;
}

/// Gives the faces of a group to two groups: those for whose centroids `is_second` is true get a new one.
Part with_halves(Part part, std::uint32_t group, const std::function<bool(const Vec3&)>& is_second) {
  auto groups = part.mesh.labels.group.of_face.items();
  for (std::size_t f = 0; f < part.mesh.face_count(); ++f) {
    const auto face = part.mesh.face(FaceId(f));
    Vec3 sum;
    for (const VertexId v : face) sum += part.mesh.positions[v];
    if (groups[f] == group && is_second((1.0 / static_cast<double>(face.size())) * sum))
      groups[f] = static_cast<std::uint32_t>(part.shapes.size());
  }
  part.shapes.push_back(part.shapes[group]);
  part.mesh = with_groups(part.mesh, groups);
  return part;
}

Part scaled(Part part, double factor) {
  part.mesh = shapes::scaled(std::move(part.mesh), factor);
  for (AnalyticSurface& s : part.shapes) {
    s.origin = factor * s.origin;
    s.radius *= factor;
    s.minor_radius *= factor;
  }
  return part;
}

Part turned(Part part, const Vec3& axis, double degrees, const Vec3& by) {
  part.mesh = shapes::moved(shapes::rotated(std::move(part.mesh), axis, degrees), by);
  const auto turned_vector = [&](const Vec3& p) {
    return shapes::rotated(shapes::from_lists({p, {}, {}}, {{0, 1, 2}}), axis, degrees).positions[VertexId(0)];
  };
  for (AnalyticSurface& s : part.shapes) {
    s.origin = turned_vector(s.origin) + by;
    s.axis = normalized(turned_vector(s.axis));
  }
  return part;
}

/// The limits that are asked of curved patches. With elements per circle, the tolerance is their chord height on a
/// circle of a given radius, on top of the input's own.
struct Asked {
  double tolerance = 0;
  double max_turn = kPi;
  double max_depth = HUGE_VAL;
  double max_length_per_width = HUGE_VAL;
  double along = 0;  ///< 0: as the tolerance
};
Asked elements(int n, double radius, double own) {
  return {radius * (1 - std::cos(kPi / n)) + own, 2 * kPi / n, HUGE_VAL, HUGE_VAL, 0};
}

/// A part with its boundaries cut.
class CutPart {
 public:
  explicit CutPart(const Part& part, const Asked& asked, const std::vector<Vec3>& forced_places = {},
                   double fit_tolerance = 0)
      : surface(shapes::surface(part.mesh)),
        adjacency(surface.vertex_count(), surface.face_begin, surface.corners, control),
        shapes_(part.shapes) {
    const auto& groups = part.mesh.labels.group.of_face;
    std::vector<std::vector<FaceId>> faces(part.shapes.size());
    for (std::size_t f = 0; f < surface.face_count(); ++f) {
      patches.of_face.push_back(PatchId(groups[FaceId(f)]));
      faces[groups[FaceId(f)]].push_back(FaceId(f));
    }
    for (const auto& of_patch : faces) {
      for (const FaceId f : of_patch) patches.faces.push_back(f);
      patches.face_begin.push_back(static_cast<std::uint32_t>(patches.faces.size()));
      patches.planes.push_back(plane_of(of_patch));
      patches.deviation.push_back(0);
    }
    loops = boundary_loops(surface, adjacency, patches, control);
    forced.assign(surface.vertex_count(), 0);
    for (const Vec3& p : forced_places) forced[at(p)] = 1;
    pinched = pinched_vertices(surface, adjacency, control);
    const double unit = surface.unit;
    essential = essential_vertices(surface, adjacency, loops, forced, pinched, 1e-9, control);
    for (std::size_t p = 0; p < shapes_.size(); ++p) {
      PatchSurface s;
      s.plane = patches.planes[PatchId(p)];
      if (shapes_[p].kind != SurfaceKind::kPlane)
        s = {&shapes_[p], {}, asked.tolerance, asked.max_turn, 0, asked.max_depth, area_of(PatchId(p)), asked.along};
      surfaces.push_back(s);
    }
    rules = {fit_tolerance > 0 ? fit_tolerance : 1e-9 * unit, kPi / 6, asked.max_length_per_width};
    cuts = cut_curves({surface, adjacency, patches, loops, essential, forced, pinched}, surfaces, rules, control);
  }

  VertexId at(const Vec3& place) const {
    for (std::size_t v = 0; v < surface.vertex_count(); ++v)
      if (surface.positions[VertexId(v)] == place) return VertexId(v);
    throw std::invalid_argument("no vertex there");
  }

  Vec3 position(VertexId v) const {
    return v.value < surface.vertex_count() ? surface.positions[v] : cuts.positions[v.value - surface.vertex_count()];
  }
  /// Returns the vertices of a loop as a caller puts them together.
  std::vector<VertexId> loop(std::uint32_t l, const EssentialVertices& staying, bool with_new = true) const {
    std::vector<VertexId> vertices;
    for (const std::uint32_t h : loops.loop(l)) {
      if (!staying[adjacency.from(h)]) continue;
      vertices.push_back(adjacency.from(h));
      if (with_new)
        for (const VertexId v : cuts.between(h)) vertices.push_back(v);
    }
    return vertices;
  }
  std::vector<VertexId> loop(std::uint32_t l) const { return loop(l, cuts.essential); }
  std::vector<Vec3> points(std::uint32_t l) const { return positions(loop(l)); }
  std::vector<Vec3> points_before(std::uint32_t l) const { return positions(loop(l, essential, false)); }
  std::uint32_t first_loop(std::uint32_t patch) const { return loops.patch_begin[patch]; }
  std::uint32_t loop_count() const { return static_cast<std::uint32_t>(loops.loop_begin.size() - 1); }
  std::vector<Vec3> essential_places() const {
    std::vector<Vec3> places;
    for (std::size_t v = 0; v < surface.vertex_count(); ++v)
      if (cuts.essential[VertexId(v)]) places.push_back(surface.positions[VertexId(v)]);
    std::sort(places.begin(), places.end());
    return places;
  }
  double largest_coordinate() const {
    double largest = 0;
    for (const Vec3& p : surface.positions)
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::fabs(p[axis]));
    return largest;
  }

  mutable RunControl control;
  Surface surface;
  Adjacency adjacency;
  PatchSet patches;
  BoundaryLoops loops;
  EssentialVertices essential;
  IdVector<VertexId, std::uint8_t> forced;
  std::vector<VertexId> pinched;
  IdVector<PatchId, PatchSurface> surfaces;
  CurveRules rules;
  CurveCuts cuts;

 private:
  double area_of(PatchId p) const {
    double area = 0;
    for (const FaceId f : patches.faces_of(p)) {
      const std::vector<Vec3> corners = corners_of(f);
      Vec3 twice;
      for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        twice += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
      area += norm(twice) / 2;
    }
    return area;
  }

  std::vector<Vec3> positions(const std::vector<VertexId>& vertices) const {
    std::vector<Vec3> places;
    for (const VertexId v : vertices) places.push_back(position(v));
    return places;
  }

  /// Returns the corners of a face, from the smallest one on.
  std::vector<Vec3> corners_of(FaceId f) const {
    std::vector<Vec3> corners;
    for (const VertexId v : surface.face(f)) corners.push_back(surface.local[v]);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
  }

  /// Returns the plane of the smallest one of some faces, so that it does not depend on their order.
  Plane plane_of(const std::vector<FaceId>& faces) const {
    std::vector<Vec3> smallest = corners_of(faces.front());
    for (const FaceId f : faces) smallest = std::min(smallest, corners_of(f));
    Vec3 area;
    for (std::size_t i = 1; i + 1 < smallest.size(); ++i)
      area += cross(smallest[i] - smallest[0], smallest[i + 1] - smallest[0]);
    return {smallest[0], normalized(area)};
  }

  std::vector<AnalyticSurface> shapes_;
};

/// Expects that patches see the same vertices along common boundaries, and that no loop has become too short.
/// Input: a closed surface, of which every edge has two faces.
void expect_conforming(const CutPart& part) {
  std::map<std::pair<VertexId, VertexId>, int> edges;
  for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
    const std::vector<VertexId> loop = part.loop(l);
    EXPECT_GE(std::set<VertexId>(loop.begin(), loop.end()).size(), 3u) << l;
    for (std::size_t i = 0; i < loop.size(); ++i) ++edges[{loop[i], loop[(i + 1) % loop.size()]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1) << edge.first << " " << edge.second;
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1u) << edge.first << " " << edge.second;
  }
}

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp(dot(p - a, b - a) / norm_squared(b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}
/// Returns the largest distance of points of one closed polyline from another, found by trying many.
double farthest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    for (int k = 0; k < 16; ++k) {
      const Vec3 p = from[i] + (k / 16.0) * (from[(i + 1) % from.size()] - from[i]);
      double nearest = HUGE_VAL;
      for (std::size_t j = 0; j < to.size(); ++j)
        nearest = std::min(nearest, to_segment(p, to[j], to[(j + 1) % to.size()]));
      largest = std::max(largest, nearest);
    }
  return largest;
}
/// Expects that each loop of a planar patch is within the tolerance of what it was, both ways.
void expect_near(const CutPart& part, double tolerance) {
  for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
    const auto before = part.points_before(l), now = part.points(l);
    EXPECT_LE(farthest(before, now), tolerance * (1 + 1e-6)) << l;
    EXPECT_LE(farthest(now, before), tolerance * (1 + 1e-6)) << l;
  }
}

/// Returns the lengths of the edges of a closed polyline.
std::vector<double> lengths(const std::vector<Vec3>& points) {
  std::vector<double> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.push_back(norm(points[(i + 1) % points.size()] - points[i]));
  return result;
}
/// Expects that all edges of a closed polyline are `length` long, up to rounding.
void expect_equal_edges(const std::vector<Vec3>& points, double length, double rounding) {
  for (const double l : lengths(points)) EXPECT_NEAR(l, length, rounding);
}

double chord(double radius, double pieces) { return 2 * radius * std::sin(kPi / pieces); }
double height(double radius, double pieces) { return radius * (1 - std::cos(kPi / pieces)); }

constexpr double kRadius = 10, kHeight = 30;
Part barrel(int n = 72) { return part_of(primitives::cylinder(n, kRadius, kHeight)); }
// The groups of a barrel.
constexpr std::uint32_t kSide = 0, kTop = 1, kBottom = 2;

TEST(curve_cuts, the_rims_of_a_cylinder_get_as_many_equal_pieces_as_were_asked_for) {
  for (const int n : {3, 4, 7, 12, 16, 25, 36, 71, 73, 100, 250}) {
    const Asked asked = elements(n, kRadius, height(kRadius, 72));
    const CutPart part(barrel(), asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    EXPECT_EQ(part.cuts.cut_chains, 2u);
    EXPECT_EQ(part.cuts.capped, 0u);
    for (const std::uint32_t patch : {kTop, kBottom}) {
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
      expect_equal_edges(points, chord(kRadius, n), 1e-12);
      for (const Vec3& p : points) {
        EXPECT_EQ(p.z, patch == kTop ? kHeight : 0);
        EXPECT_NEAR(std::hypot(p.x, p.y), kRadius, 4 * 0x1p-49);  // 2^-49 is a step of numbers from 8 to 16
      }
    }
  }
}

TEST(curve_cuts, pieces_are_no_deeper_below_their_surfaces_than_is_allowed) {
  // A chord of a circle of a cone is below the surface by the cosine of the half angle of its height.
  const double lower = 4, upper = 1, along = 7, cosine = std::cos(std::atan2(lower - upper, along));
  const Part part = part_of(primitives::frustum(72, lower, upper, along));
  for (const double depth : {0.3, 0.1, 0.03, 0.01}) {
    const CutPart cut(part, {lower, kPi, depth, HUGE_VAL});
    std::multiset<std::size_t> rims, expected;
    for (const double radius : {lower, upper}) {
      std::size_t pieces = 6;
      while (height(radius, static_cast<double>(pieces)) * cosine > depth) ++pieces;
      expected.insert(pieces);
    }
    for (std::uint32_t p = 0; p < part.shapes.size(); ++p)
      if (part.shapes[p].kind == SurfaceKind::kPlane) rims.insert(cut.points(cut.first_loop(p)).size());
    EXPECT_EQ(rims, expected) << depth;
  }
}

TEST(curve_cuts, rims_of_a_narrow_patch_have_pieces_that_are_as_short_as_its_width_asks_for) {
  for (const double width : {4.0, 12.0, 30.0}) {
    const Part part = part_of(primitives::cylinder(72, kRadius, width));
    for (const double ratio : {0.5, 1.0, 2.0}) {
      Asked asked = elements(8, kRadius, height(kRadius, 72));
      asked.max_length_per_width = ratio;
      const CutPart cut(part, asked);
      // The input's circle is a polygon, too.
      const double circle = 72 * chord(kRadius, 72);
      const double expected = std::clamp(std::ceil(circle / (ratio * width) * (1 - 1e-9)), 8.0, 72.0);
      for (const std::uint32_t patch : {kTop, kBottom})
        EXPECT_EQ(cut.points(cut.first_loop(patch)).size(), static_cast<std::size_t>(expected))
            << width << " " << ratio;
    }
  }
}

TEST(curve_cuts, as_many_pieces_as_there_are_keep_the_vertices_of_the_input) {
  const CutPart part(barrel(), elements(72, kRadius, height(kRadius, 72)));
  EXPECT_TRUE(part.cuts.positions.empty());
  EXPECT_EQ(part.cuts.cut_chains, 0u);
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
}

TEST(curve_cuts, what_asks_for_no_other_pieces_leaves_the_input) {
  // The default: edges may turn by what the input's facets turn, and move by their height.
  const CutPart part(barrel(), {height(kRadius, 72), 2 * kPi / 72 * (1 - 1e-12)});
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
  EXPECT_TRUE(part.cuts.positions.empty());
}

TEST(curve_cuts, a_division_of_the_number_of_facets_takes_vertices_of_the_input) {
  const CutPart part(barrel(), elements(12, kRadius, height(kRadius, 72)));
  EXPECT_TRUE(part.cuts.positions.empty());
  EXPECT_EQ(part.essential_places().size(), 24u);
}

TEST(curve_cuts, a_tolerance_alone_gives_the_fewest_pieces_within_it_and_never_fewer_than_six_a_circle) {
  std::size_t before = 72;
  for (const double tolerance : {0.012, 0.03, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 100.0}) {
    const CutPart part(barrel(), {tolerance, kPi});
    int fewest = 6;
    while (height(kRadius, fewest) > tolerance) ++fewest;
    const std::size_t count = part.points(part.first_loop(kTop)).size();
    EXPECT_EQ(count, static_cast<std::size_t>(fewest)) << tolerance;
    EXPECT_LE(count, before);
    before = count;
    expect_near(part, tolerance);
  }
}

TEST(curve_cuts, a_tolerance_below_the_height_of_the_inputs_pieces_leaves_them) {
  for (const int n : {12, 100}) {
    const CutPart part(barrel(), {0.9 * height(kRadius, 72), 2 * kPi / n});
    EXPECT_EQ(part.cuts.essential.stays, part.essential.stays) << n;
    EXPECT_TRUE(part.cuts.positions.empty()) << n;
  }
}

TEST(curve_cuts, without_a_curved_patch_everything_stays) {
  Part part = barrel();
  part.mesh = shapes::cylinder(12, 1, 1);
  std::vector<std::uint32_t> groups;
  for (std::uint32_t f = 0; f < part.mesh.face_count(); ++f) groups.push_back(f);
  part.mesh = with_groups(part.mesh, groups);
  part.shapes.assign(groups.size(), {SurfaceKind::kPlane, {}, {}, 0, 0, 0});
  const CutPart cut(part, {1, 1});
  EXPECT_EQ(cut.cuts.essential.stays, cut.essential.stays);
  EXPECT_TRUE(cut.cuts.positions.empty());
}

TEST(curve_cuts, half_cylinders_share_the_pieces_of_a_rim) {
  const Part halves = with_halves(barrel(), kSide, [](const Vec3& p) { return p.y < 0; });
  for (const int n : {4, 6, 8, 12, 16, 100}) {
    const Asked asked = elements(n, kRadius, height(kRadius, 72));
    const CutPart part(halves, asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    EXPECT_EQ(part.cuts.cut_chains, 4u);
    EXPECT_EQ(part.cuts.capped, 0u);
    const std::vector<Vec3> points = part.points(part.first_loop(kTop));
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(kRadius, n), 1e-12);
    // The corners of the seam stay.
    for (const Vec3& corner : {Vec3{kRadius, 0, 0}, Vec3{kRadius, 0, kHeight}})
      EXPECT_TRUE(part.cuts.essential[part.at(corner)]);
    EXPECT_EQ(part.points(part.first_loop(kSide)).size(), static_cast<std::size_t>(n + 2));
  }
}

TEST(curve_cuts, turned_and_moved_rims_have_the_same_counts_and_stay_on_circle_and_plane) {
  const Vec3 by{1000, -300, 50};
  for (const double degrees : {17.0, 93.0, 201.0})
    for (const int n : {7, 12, 16, 100}) {
      const Part input = turned(barrel(), {1, 2, 3}, degrees, by);
      const CutPart part(input, elements(n, kRadius, height(kRadius, 72)), {}, 1e-11 * 1000);
      SCOPED_TRACE(n);
      expect_conforming(part);
      const double step = part.largest_coordinate() * 0x1p-52;
      for (const std::uint32_t patch : {kTop, kBottom}) {
        const std::vector<Vec3> points = part.points(part.first_loop(patch));
        ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
        const AnalyticSurface& side = input.shapes[kSide];
        for (const Vec3& p : points) {
          EXPECT_NEAR(norm(cross(p - side.origin, side.axis)), kRadius, 4 * step);
          EXPECT_NEAR(dot(p - side.origin, side.axis), patch == kTop ? kHeight : 0, 4 * step);
        }
      }
    }
}

TEST(curve_cuts, both_rims_of_a_frustum_are_cut) {
  const double lower = 10, upper = 4;
  for (const int n : {12, 16}) {
    const Asked asked = elements(n, lower, height(lower, 72));
    const CutPart part(part_of(primitives::frustum(72, lower, upper, 9)), asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    expect_equal_edges(part.points(part.first_loop(1)), chord(upper, n), 1e-12);
    expect_equal_edges(part.points(part.first_loop(2)), chord(lower, n), 1e-12);
    EXPECT_EQ(part.points(part.first_loop(1)).size(), static_cast<std::size_t>(n));
    EXPECT_EQ(part.points(part.first_loop(2)).size(), static_cast<std::size_t>(n));
  }
}

/// A solid cylinder or cone about z whose top is the plane z = 12 + slope * x.
Part cut_off(int n, double slope, double half_angle) {
  const AnalyticSurface cylinder{SurfaceKind::kCylinder, {}, {0, 0, 1}, 5, 0, 0};
  const AnalyticSurface cone{SurfaceKind::kCone, {0, 0, -5 / std::tan(half_angle)}, {0, 0, 1}, 0, 0, half_angle};
  std::vector<Vec3> places;
  for (int i = 0; i < n; ++i) {
    const double c = std::cos(2 * kPi * i / n), s = std::sin(2 * kPi * i / n), widening = std::tan(half_angle);
    const double z = (12 + slope * 5 * c) / (1 - slope * widening * c);
    places.push_back({5 * c, 5 * s, 0});
    places.push_back({(5 + z * widening) * c, (5 + z * widening) * s, z});
  }
  std::vector<std::vector<std::uint32_t>> faces(2);
  std::vector<std::uint32_t> groups{kBottom, kTop};
  for (int i = 0; i < n; ++i) {
    const auto at = [&](int k, int level) { return static_cast<std::uint32_t>(2 * (k % n) + level); };
    faces[0].push_back(at(n - i, 0));
    faces[1].push_back(at(i, 1));
    faces.push_back({at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)});
    groups.push_back(kSide);
  }
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  return {with_groups(shapes::from_lists(places, faces), groups), {half_angle > 0 ? cone : cylinder, plane, plane}};
}

TEST(curve_cuts, an_oblique_cut_has_pieces_of_equal_angles_on_the_surface_and_in_the_plane) {
  for (const double half_angle : {0.0, 0.2})
    for (const double slope : {0.1, 0.7, 1.5})
      for (const int n : {12, 16, 25, 90}) {
        const Part input = cut_off(60, slope, half_angle);
        const Asked asked{5, 2 * kPi / n};
        const CutPart part(input, asked);
        SCOPED_TRACE(slope);
        SCOPED_TRACE(n);
        expect_conforming(part);
        expect_near(part, asked.tolerance);
        const std::vector<Vec3> points = part.points(part.first_loop(kTop));
        ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
        std::vector<double> angles;
        for (const Vec3& p : points) {
          EXPECT_NEAR(std::hypot(p.x, p.y), 5 + p.z * std::tan(half_angle), 4 * 0x1p-48);
          EXPECT_NEAR(p.z, 12 + slope * p.x, 4 * 0x1p-48);
          angles.push_back(std::atan2(p.y, p.x));
        }
        std::sort(angles.begin(), angles.end());
        for (std::size_t i = 1; i < angles.size(); ++i) EXPECT_NEAR(angles[i] - angles[i - 1], 2 * kPi / n, 1e-12);
      }
}

TEST(curve_cuts, the_pieces_of_an_ellipse_are_within_the_tolerance_with_hardly_one_too_many) {
  const double slope = 1.5;
  for (const double tolerance : {0.03, 0.1, 0.3}) {
    const CutPart part(cut_off(120, slope, 0), {tolerance, kPi});
    expect_near(part, tolerance);
    // The highest arc is that at the end of the long axis. Its height is that of a circle of this radius.
    const double long_axis = 5 * std::hypot(1, slope);
    int fewest = 6;
    while (height(long_axis, fewest) > tolerance) ++fewest;
    const auto count = static_cast<int>(part.points(part.first_loop(kTop)).size());
    EXPECT_LE(count, fewest);
    EXPECT_GE(count, fewest - 2);
  }
}

/// Returns how far a chord of the oblique section of the cylinder leaves the section along the surface.
double way_along_surface(const Vec3& from, const Vec3& to, double slope) {
  constexpr int kSteps = 200;
  double farthest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const Vec3 p = from + part * (to - from);
    const double angle = std::atan2(p.y, p.x);
    double nearest = HUGE_VAL;
    // In the unrolled cylinder, the section is a wave.
    for (int k = -kSteps; k <= kSteps; ++k) {
      const double turn = 0.3 * k / kSteps;
      nearest = std::min(nearest, std::hypot(5 * turn, 12 + slope * 5 * std::cos(angle + turn) - p.z));
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

TEST(curve_cuts, an_oblique_cut_leaves_its_section_along_the_surface_by_no_more_than_is_allowed) {
  const double tolerance = 0.2;
  for (const double slope : {0.5, 1.0, 1.5})
    for (const double along : {0.01, 0.03}) {
      SCOPED_TRACE(slope);
      SCOPED_TRACE(along);
      const Part input = cut_off(360, slope, 0);
      const CutPart part(input, {tolerance, kPi, HUGE_VAL, HUGE_VAL, along}), free(input, {tolerance, kPi});
      const std::vector<Vec3> points = part.points(part.first_loop(kTop));
      double farthest = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        farthest = std::max(farthest, way_along_surface(points[i], points[(i + 1) % points.size()], slope));
      EXPECT_LE(farthest, 1.05 * along);
      // There are not many pieces too many: the way grows with the square of their length.
      EXPECT_GE(farthest, 0.7 * along);
      EXPECT_GT(points.size(), free.points(free.first_loop(kTop)).size());
      // Chords of the circle around the axis leave it in depth only.
      EXPECT_EQ(part.points(part.first_loop(kBottom)), free.points(free.first_loop(kBottom)));
    }
}

TEST(curve_cuts, the_equator_between_two_halves_of_a_globe_is_a_circle) {
  for (const int n : {7, 12, 16}) {
    const Asked asked = elements(n, 3, height(3, 40));
    const CutPart part(with_halves(part_of(primitives::globe(40, 20, 3)), 0, [](const Vec3& p) { return p.z < 0; }),
                       asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    const std::vector<Vec3> points = part.points(0);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(3, n), 1e-14);
    for (const Vec3& p : points) EXPECT_NEAR(norm(p), 3, 4 * 0x1p-51);
  }
}

TEST(curve_cuts, the_circles_of_a_torus_are_cut_around_its_axis_and_around_its_tube) {
  const primitives::Model model = primitives::torus(64, 16, 40, 6, 2);  // a quarter, which is open at both ends
  const Part halves = with_halves(part_of(model), 0, [](const Vec3& p) { return p.z < 0; });
  for (const int n : {8, 12, 20}) {
    const Asked asked{1, 2 * kPi / n};
    const CutPart part(halves, asked);
    SCOPED_TRACE(n);
    expect_near(part, asked.tolerance);
    for (std::uint32_t patch = 0; patch < 2; ++patch) {
      // Half of the tube's circle at both ends, a quarter of the outer and of the inner circle.
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), static_cast<std::size_t>(2 * (n / 2) + 2 * (n / 4)));
      for (const Vec3& p : points) EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 6, p.z), 2, 4 * 0x1p-50);
      std::map<int, int> long_edges;
      for (const double l : lengths(points))
        for (const double radius : {2.0, 4.0, 8.0})
          if (std::fabs(l - chord(radius, n)) < 1e-12) ++long_edges[static_cast<int>(radius)];
      EXPECT_EQ(long_edges[2], n);
      EXPECT_EQ(long_edges[4], n / 4);
      EXPECT_EQ(long_edges[8], n / 4);
    }
  }
}

TEST(curve_cuts, a_circle_along_which_a_torus_touches_a_plane_is_cut_as_its_vertices_lie) {
  // The torus r = 6 +- 2 from its highest circle outwards and down to the middle, with a disc above and one below.
  const int n = 60, rows = 6;
  std::vector<Vec3> places;
  std::vector<std::vector<std::uint32_t>> faces(2);
  std::vector<std::uint32_t> groups{1, 2};
  for (int k = 0; k <= rows; ++k)
    for (int i = 0; i < n; ++i) {
      const double tilt = k == 0 ? kPi / 2 : kPi / 2 * (rows - k) / rows, turn = 2 * kPi * i / n;
      const double r = k == 0 ? 6 : 6 + 2 * std::cos(tilt);
      places.push_back({r * std::cos(turn), r * std::sin(turn), 2 * std::sin(tilt)});
    }
  const auto at = [&](int k, int i) { return static_cast<std::uint32_t>(k * n + (i + n) % n); };
  for (int i = 0; i < n; ++i) {
    faces[0].push_back(at(0, i));
    faces[1].push_back(at(rows, -i));
    for (int k = 0; k < rows; ++k) {
      faces.push_back({at(k, i), at(k + 1, i), at(k + 1, i + 1), at(k, i + 1)});
      groups.push_back(0);
    }
  }
  const AnalyticSurface torus{SurfaceKind::kTorus, {}, {0, 0, 1}, 6, 2, 0}, plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  const CutPart part({with_groups(shapes::from_lists(places, faces), groups), {torus, plane, plane}},
                     elements(16, 8, height(8, n)));
  expect_conforming(part);
  const std::vector<Vec3> upper = part.points(part.first_loop(1)), lower = part.points(part.first_loop(2));
  ASSERT_EQ(upper.size(), 16u);
  ASSERT_EQ(lower.size(), 16u);
  for (const Vec3& p : upper) {
    EXPECT_EQ(p.z, 2);
    EXPECT_NEAR(std::hypot(p.x, p.y), 6, 4 * 0x1p-50);
  }
  for (const Vec3& p : lower) EXPECT_NEAR(std::hypot(p.x, p.y), 8, 4 * 0x1p-49);
}

/// Expects of a polyline that was thinned out that its vertices are those of the input, that those dropped are near,
/// and that normals turn by no more than was asked for where vertices were dropped.
void expect_thinned(const CutPart& part, std::uint32_t l, const std::vector<AnalyticSurface>& shapes,
                    const Asked& asked) {
  const std::vector<Vec3> before = part.points_before(l), now = part.points(l);
  ASSERT_FALSE(now.empty());
  std::size_t i = 0;
  while (before[i] != now[0]) ++i;
  for (std::size_t j = 0; j < now.size(); ++j) {
    const Vec3 a = now[j], b = now[(j + 1) % now.size()];
    std::vector<Vec3> dropped;
    for (i = (i + 1) % before.size(); before[i] != b; i = (i + 1) % before.size()) dropped.push_back(before[i]);
    for (const Vec3& p : dropped) {
      EXPECT_LE(to_segment(p, a, b), asked.tolerance * (1 + 1e-6));
      for (const AnalyticSurface& s : shapes)
        EXPECT_LE(std::acos(std::clamp(dot(s.normal(a), s.normal(p)), -1.0, 1.0)), asked.max_turn * (1 + 1e-6));
    }
    if (dropped.empty()) continue;
    for (const AnalyticSurface& s : shapes)
      EXPECT_LE(std::acos(std::clamp(dot(s.normal(a), s.normal(b)), -1.0, 1.0)), asked.max_turn * (1 + 1e-6));
  }
}

TEST(curve_cuts, where_two_cylinders_meet_vertices_of_the_input_are_left_out) {
  for (const int facets : {48, 96})
    for (const int n : {6, 8, 12, 16, 24}) {
      const primitives::Model model = primitives::tee(facets);
      const Part input = part_of(model);
      const Asked asked = elements(n, 4, height(4, facets));
      const CutPart part(input, asked);
      SCOPED_TRACE(n);
      // The branch is the second surface. One of its loops is its open end, and the other one is the cut.
      bool is_found = false;
      for (std::uint32_t l = part.loops.patch_begin[1]; l < part.loops.patch_begin[2]; ++l) {
        const std::vector<Vec3> points = part.points(l);
        if (points.front().z == 7) {
          EXPECT_EQ(points.size(), static_cast<std::size_t>(n));
          continue;
        }
        is_found = true;
        expect_thinned(part, l, {input.shapes[0], input.shapes[1]}, asked);
        // On the branch, which is narrower, at most n pieces would be asked for if vertices were anywhere. The input's
        // vertices leave gaps of up to a facet.
        const double turn = 2 * kPi / n, facet = 2 * kPi / facets;
        EXPECT_LE(static_cast<double>(points.size()), std::ceil(2 * kPi / (turn - facet) + 1));
        EXPECT_GE(static_cast<double>(points.size()), n);
      }
      EXPECT_TRUE(is_found);
    }
}

TEST(curve_cuts, nothing_is_dropped_where_two_cylinders_meet_if_the_tolerance_is_tiny) {
  const CutPart part(part_of(primitives::tee(48)), {1e-6, kPi});
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
  EXPECT_TRUE(part.cuts.positions.empty());
}

TEST(curve_cuts, the_rims_of_a_thin_ring_do_not_cross) {
  const int facets = 360;
  for (const double wall : {0.05, 0.2, 1.0, 4.0}) {
    const Asked asked = elements(12, kRadius, height(kRadius, facets));
    const CutPart part(part_of(primitives::tube(facets, kRadius, wall, 30)), asked);
    SCOPED_TRACE(wall);
    expect_conforming(part);
    const double gap = (kRadius - wall) * std::cos(kPi / facets);  // to the nearest place of the other rim, about
    double outer_in = HUGE_VAL, inner_out = 0;
    std::size_t most = 0;
    for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
      const std::vector<Vec3> points = part.points(l);
      most = std::max(most, points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 middle = 0.5 * (points[i] + points[(i + 1) % points.size()]);
        const double at_corner = std::hypot(points[i].x, points[i].y), r = std::hypot(middle.x, middle.y);
        if (at_corner > kRadius - wall / 2)
          outer_in = std::min(outer_in, r);
        else
          inner_out = std::max(inner_out, at_corner);
      }
    }
    EXPECT_GT(outer_in, inner_out);
    EXPECT_LE(kRadius - outer_in, (kRadius - gap) / 4);
    const bool is_wide = height(kRadius, 12) <= wall / 4;
    EXPECT_EQ(part.cuts.capped, is_wide ? 0u : 4u);
    if (is_wide) {
      EXPECT_EQ(most, 12u);
    } else {
      int fewest = 12;
      while (height(kRadius, fewest) > wall / 4) ++fewest;
      EXPECT_GE(most, static_cast<std::size_t>(fewest));
      EXPECT_LE(most, static_cast<std::size_t>(fewest + 2));
    }
  }
}

/// A prism over a part of a disc: an arc of so many degrees in `n` pieces, and its chord.
Part segment_of_disc(int n, double degrees) {
  std::vector<Vec2> base;
  for (int i = 0; i <= n; ++i) {
    const double angle = degrees * kPi / 180 * i / n;
    base.push_back({4 * std::cos(angle), 4 * std::sin(angle)});
  }
  const PolygonMesh mesh = shapes::prism(base, 3);
  std::vector<std::uint32_t> groups;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    const Vec3 a = mesh.positions[face[0]];
    const bool is_cap = std::all_of(face.begin(), face.end(), [&](VertexId v) { return mesh.positions[v].z == a.z; });
    bool is_flat = true;
    const Vec3 start{base.front().x, base.front().y, 0}, end{base.back().x, base.back().y, 0};
    for (const VertexId v : face) {
      const Vec3 p{mesh.positions[v].x, mesh.positions[v].y, 0};
      is_flat = is_flat && (p == start || p == end);
    }
    groups.push_back(is_cap ? (a.z == 0 ? 1 : 2) : is_flat ? 3 : 0);
  }
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  return {with_groups(mesh, groups), {{SurfaceKind::kCylinder, {}, {0, 0, 1}, 4, 0, 0}, plane, plane, plane}};
}

TEST(curve_cuts, an_arc_of_one_piece_and_its_chord_do_not_become_one_edge) {
  for (const int n : {5, 9, 14}) {
    const CutPart part(segment_of_disc(n, 70), {100, 2 * kPi / 3});
    SCOPED_TRACE(n);
    expect_conforming(part);
    for (const std::uint32_t patch : {1u, 2u}) {
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), 3u);
      // The additional vertex is in the middle of the arc.
      const double middle = 35 * kPi / 180;
      const double z = patch == 1 ? 0 : 3;
      EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const Vec3& p) {
        return norm(p - Vec3{4 * std::cos(middle), 4 * std::sin(middle), z}) < 1e-14;
      }));
    }
  }
}

TEST(curve_cuts, half_a_disc_is_cut_like_a_circle) {
  for (const int n : {3, 4, 12}) {
    const CutPart part(segment_of_disc(40, 180), {100, 2 * kPi / n});
    expect_conforming(part);
    EXPECT_EQ(part.points(part.first_loop(1)).size(), static_cast<std::size_t>((n + 1) / 2 + 1)) << n;
  }
}

TEST(curve_cuts, two_arcs_of_one_piece_do_not_become_one_edge) {
  // A lens on a sphere, between two points that are 90 degrees apart. No plane is near.
  const int facets = 12;
  const Vec3 from{4 * std::sqrt(0.5), -4 * std::sqrt(0.5), 0}, to{4 * std::sqrt(0.5), 4 * std::sqrt(0.5), 0};
  const Vec3 middle = 0.5 * (from + to);
  std::vector<std::vector<Vec3>> arcs;
  for (const double tilt : {-0.35, 0.35}) {
    // The plane of the arc contains both points. It is turned about their chord.
    const Vec3 normal{-std::sin(tilt), 0, std::cos(tilt)};
    const Vec3 centre = dot(middle, normal) * normal;
    const Vec3 x = normalized(from - centre), y = cross(normal, x);
    const double radius = norm(from - centre), turn = 2 * std::asin(norm(to - from) / (2 * radius));
    std::vector<Vec3> arc{from};
    for (int i = 1; i < facets; ++i)
      arc.push_back(centre + radius * (std::cos(turn * i / facets) * x + std::sin(turn * i / facets) * y));
    arc.push_back(to);
    arcs.push_back(arc);
  }
  std::vector<Vec3> places(arcs[0]);
  places.insert(places.end(), arcs[1].begin() + 1, arcs[1].end() - 1);
  std::vector<std::vector<std::uint32_t>> faces;
  const auto on_second = [&](int i) { return static_cast<std::uint32_t>(i == 0 || i == facets ? i : facets + i); };
  for (int i = 0; i < facets; ++i) {
    std::vector<std::uint32_t> face{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1)};
    if (i + 1 < facets) face.push_back(on_second(i + 1));
    if (i > 0) face.push_back(on_second(i));
    faces.push_back(face);
  }
  const PolygonMesh mesh = shapes::from_lists(places, faces);
  const CutPart part(
      {with_groups(mesh, std::vector<std::uint32_t>(faces.size(), 0)), {{SurfaceKind::kSphere, {}, {}, 4, 0, 0}}},
      {100, 2 * kPi / 3});
  const std::vector<Vec3> points = part.points(0);
  ASSERT_EQ(points.size(), 4u);
  for (const Vec3& p : points) EXPECT_NEAR(norm(p), 4, 1e-14);
  // Each arc has got its middle.
  for (const double side : {-1, 1})
    EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                            [&](const Vec3& p) { return std::fabs(p.y) < 1e-14 && side * p.z > 0.1; }));
}

/// Returns whether two edges of a closed polyline in a plane z = constant cross or touch, other than neighbours in
/// their common vertex.
bool crosses_itself(const std::vector<Vec3>& points) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& p) {
    const double area = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const Vec3 &a = points[i], &b = points[i + 1], &c = points[j], &d = points[(j + 1) % n];
      if (side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0) return true;
    }
  return false;
}

TEST(curve_cuts, the_arcs_of_a_crescent_do_not_cross) {
  // Two arcs between (-3, 0) and (3, 0), as high as this in the middle.
  std::size_t fewest = 60;
  for (const double lower : {0.2, 0.9})
    for (const double upper : {1.0, 2.5})
      for (const int n : {3, 6, 8, 10, 16, 40}) {
        const int facets = 30;
        std::vector<Vec2> base;
        std::vector<AnalyticSurface> shapes;
        for (const double high : {lower, upper}) {
          const double radius = (9 + high * high) / (2 * high), half = std::asin(3 / radius);
          const int sign = high == lower ? 1 : -1;
          for (int i = 0; i < facets; ++i) {
            const double angle = sign * half * (2.0 * i / facets - 1);
            base.push_back({radius * std::sin(angle), high - radius + radius * std::cos(angle)});
          }
          shapes.push_back({SurfaceKind::kCylinder, {0, high - radius, 0}, {0, 0, 1}, radius, 0, 0});
        }
        base[0] = {-3, 0};
        base[facets] = {3, 0};
        const PolygonMesh mesh = shapes::prism(base, 1);
        std::vector<std::uint32_t> groups;
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
          const auto face = mesh.face(FaceId(f));
          Vec3 sum;
          for (const VertexId v : face) sum += mesh.positions[v];
          const Vec3 middle = 0.25 * sum;
          if (face.size() != 4)
            groups.push_back(mesh.positions[face[0]].z == 0 ? 2 : 3);
          else
            groups.push_back(std::fabs(shapes[0].distance(middle)) < std::fabs(shapes[1].distance(middle)) ? 0 : 1);
        }
        shapes.resize(4, {SurfaceKind::kPlane, {}, {}, 0, 0, 0});
        const CutPart part({with_groups(mesh, groups), shapes}, {100, 2 * kPi / n});
        SCOPED_TRACE(n);
        expect_conforming(part);
        ASSERT_FALSE(crosses_itself(part.points_before(part.first_loop(2))));
        EXPECT_FALSE(crosses_itself(part.points(part.first_loop(2)))) << lower << " " << upper;
        fewest = std::min(fewest, part.points(part.first_loop(2)).size());
      }
  EXPECT_LT(fewest, 20u);  // the arcs are really cut anew
}

TEST(curve_cuts, an_open_sheet_has_corners_where_its_border_bends) {
  // Two arcs of 50 degrees and two rulings, all beside the same patch.
  const CutPart part(part_of(primitives::arc(72, 10, kRadius, kHeight)), elements(36, kRadius, height(kRadius, 72)));
  const std::vector<Vec3> points = part.points(0);
  EXPECT_EQ(points.size(), 12u);  // 50 degrees are five pieces of 10
  std::vector<double> sides = lengths(points);
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(sides[i], chord(kRadius, 36), 1e-12);
  EXPECT_NEAR(sides[10], kHeight, 1e-12);
}

TEST(curve_cuts, a_chain_with_a_forced_vertex_stays_as_it_is) {
  const Part input = barrel();
  const auto& bottom = input.mesh.positions;
  const auto on_bottom = std::find_if(bottom.begin(), bottom.end(), [](const Vec3& p) { return p.z == 0; });
  const CutPart part(input, elements(12, kRadius, height(kRadius, 72)), {*on_bottom});
  expect_conforming(part);
  EXPECT_EQ(part.points(part.first_loop(kBottom)).size(), 72u);
  EXPECT_EQ(part.points(part.first_loop(kTop)).size(), 12u);
}

TEST(curve_cuts, uneven_pieces_are_cut_evenly) {
  // A cylinder whose facets are 5 and 10 degrees wide by turns: 48 facets.
  std::vector<Vec2> base;
  for (int i = 0; i < 24; ++i)
    for (const double degrees : {15.0 * i, 15.0 * i + 5})
      base.push_back({6 * std::cos(degrees * kPi / 180), 6 * std::sin(degrees * kPi / 180)});
  const PolygonMesh mesh = shapes::prism(base, 4);
  std::vector<std::uint32_t> groups;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    groups.push_back(mesh.face(FaceId(f)).size() == 4 ? 0 : mesh.positions[mesh.face(FaceId(f))[0]].z == 0 ? 1 : 2);
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  const Part input{with_groups(mesh, groups), {{SurfaceKind::kCylinder, {}, {0, 0, 1}, 6, 0, 0}, plane, plane}};
  for (const int n : {36, 48}) {
    const Asked asked{height(6, n) + height(6, 36), 2 * kPi / n};
    const CutPart part(input, asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    const std::vector<Vec3> points = part.points(part.first_loop(1));
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(6, n), 1e-12);
  }
}

std::vector<Part> samples() {
  return {barrel(),
          with_halves(barrel(), kSide, [](const Vec3& p) { return p.y < 0; }),
          part_of(primitives::frustum(48, 10, 4, 9)),
          cut_off(60, 0.7, 0.2),
          cut_off(50, 1.2, 0),
          part_of(primitives::tee(48)),
          part_of(primitives::tube(90, kRadius, 1, 5)),
          with_halves(part_of(primitives::globe(40, 20, 3)), 0, [](const Vec3& p) { return p.z < 0; }),
          segment_of_disc(9, 70),
          part_of(primitives::arc(72, 10, kRadius, kHeight))};
}

TEST(curve_cuts, the_order_of_faces_and_vertices_does_not_matter) {
  for (const Part& input : samples())
    for (const int n : {7, 16}) {
      const CutPart part(input, {2, 2 * kPi / n});
      ASSERT_GT(part.cuts.cut_chains, 0u);
      for (unsigned seed = 1; seed <= 5; ++seed) {
        Part other = input;
        other.mesh = shapes::renumbered(input.mesh, seed);
        const CutPart shuffled(other, {2, 2 * kPi / n});
        EXPECT_EQ(shuffled.essential_places(), part.essential_places());
        EXPECT_EQ(shuffled.cuts.positions, part.cuts.positions);
        EXPECT_EQ(shuffled.cuts.capped, part.cuts.capped);
        EXPECT_EQ(shuffled.cuts.cut_chains, part.cuts.cut_chains);
      }
    }
}

TEST(curve_cuts, powers_of_two_scale_the_result) {
  for (const Part& input : samples())
    for (const int n : {7, 16}) {
      const CutPart part(input, {2, 2 * kPi / n});
      for (const int exponent : {-40, -3, 1, 60}) {
        const double factor = std::ldexp(1.0, exponent);
        const CutPart other(scaled(input, factor), {2 * factor, 2 * kPi / n});
        EXPECT_EQ(other.cuts.essential.stays, part.cuts.essential.stays);
        ASSERT_EQ(other.cuts.positions.size(), part.cuts.positions.size());
        for (std::size_t i = 0; i < part.cuts.positions.size(); ++i)
          EXPECT_EQ(other.cuts.positions[i], factor * part.cuts.positions[i]);
      }
    }
}

TEST(curve_cuts, turned_parts_have_the_same_counts) {
  for (const Part& input : samples())
    for (const int n : {7, 16, 25}) {
      const CutPart part(input, {2, 2 * kPi / n});
      const CutPart other(turned(input, {3, -1, 2}, 77, {5, -8, 3}), {2, 2 * kPi / n});
      std::multiset<std::size_t> counts, other_counts;
      for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
        counts.insert(part.points(l).size());
        other_counts.insert(other.points(l).size());
      }
      EXPECT_EQ(other_counts, counts);
    }
}

TEST(curve_cuts, rounded_coordinates_of_floats_are_seen_through) {
  for (const int n : {12, 16, 100}) {
    Part input = turned(barrel(), {1, 2, 3}, 40, {});
    for (Vec3& p : input.mesh.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
    const double step = 0x1p-19;  // of floats from 16 to 32
    const CutPart part(input, elements(n, kRadius, height(kRadius, 72)), {}, 10 * step);
    EXPECT_EQ(part.points(part.first_loop(kTop)).size(), static_cast<std::size_t>(n));
    EXPECT_EQ(part.points(part.first_loop(kBottom)).size(), static_cast<std::size_t>(n));
    for (const Vec3& p : part.cuts.positions)
      EXPECT_NEAR(norm(cross(p - input.shapes[kSide].origin, input.shapes[kSide].axis)), kRadius, 4 * 0x1p-48);
  }
}

TEST(curve_cuts, it_can_be_stopped) {
  const CutPart part(barrel(), {2, 1});
  RunControl control;
  control.cancel();
  const Error error = test::error_of([&] {
    cut_curves({part.surface, part.adjacency, part.patches, part.loops, part.essential, part.forced, part.pinched},
               part.surfaces, part.rules, control);
  });
  EXPECT_EQ(error.code, Code::kCancelled);
}

}  // namespace
}  // namespace remesh
