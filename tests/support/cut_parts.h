/// Parts whose patches are known surfaces, and what the stage of curve cuts makes of their boundaries.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/mesh/pinched_vertices.h"
#include "core/patches/chains/curve_cuts.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"

namespace remesh::cut_parts {

constexpr double kPi = std::numbers::pi;

/// A mesh whose groups are its patches, and what is known of each patch.
struct Part {
  PolygonMesh mesh;
  std::vector<AnalyticSurface> shapes;  ///< by group; kPlane for a planar patch
};

Part part_of(const primitives::Model& model);
/// Gives the faces of a group to two groups: those for whose centroids `is_second` is true get a new one.
Part with_halves(Part part, std::uint32_t group, const std::function<bool(const Vec3&)>& is_second);
Part scaled(Part part, double factor);
Part turned(Part part, const Vec3& axis, double degrees, const Vec3& by);

constexpr double kRadius = 10, kHeight = 30;
/// Makes a cylinder of that radius and height.
Part barrel(int n = 72);
/// These are the groups of a barrel.
constexpr std::uint32_t kSide = 0, kTop = 1, kBottom = 2;
/// Makes a solid cylinder or cone about z whose top is the plane z = 12 + slope * x. It has the groups of a barrel.
Part cut_off(int n, double slope, double half_angle);
/// Makes a prism over a part of a disc: an arc of so many degrees in `n` pieces, and its chord.
Part segment_of_disc(int n, double degrees);

/// The limits that are asked of curved patches. With elements per circle, the tolerance is their chord height on a
/// circle of a given radius, on top of the input's own.
struct Asked {
  double tolerance = 0;
  double max_turn = kPi;
  double max_depth = HUGE_VAL;
  double max_length_per_width = HUGE_VAL;
  double along = 0;  ///< 0: as the tolerance
};
/// Returns the limits of a number of elements per circle.
Asked elements(int n, double radius, double own);

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
void expect_conforming(const CutPart& part);
/// Expects that each loop of a planar patch is within the tolerance of what it was, both ways.
void expect_near(const CutPart& part, double tolerance);
/// Returns the distance of p from the segment between a and b.
double to_segment(const Vec3& p, const Vec3& a, const Vec3& b);
/// Returns the lengths of the edges of a closed polyline.
std::vector<double> lengths(const std::vector<Vec3>& points);
/// Expects that all edges of a closed polyline are `length` long, up to rounding.
void expect_equal_edges(const std::vector<Vec3>& points, double length, double rounding);

/// Return the length of a chord of a circle that is divided into equal pieces, and its largest distance from the
/// circle.
double chord(double radius, double pieces);
double height(double radius, double pieces);

}  // namespace remesh::cut_parts
