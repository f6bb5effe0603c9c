#include "core/patches/charts/patch_chart.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/prefault_pages.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Returns the way from a frame's plane, whose origin is a vertex, to the plane that fits the patch best. It is null if
/// the two planes are the same up to rounding.
Vec3 plane_offset(const Surface& surface, const Plane& plane, const Vec3& origin) {
  const Vec3 local = (1 / surface.unit) * (origin - surface.centre);
  const double height = plane.distance(local);
  const double magnitude = std::max({std::fabs(origin.x), std::fabs(origin.y), std::fabs(origin.z), surface.unit});
  if (std::fabs(height) * surface.unit < 0x1p-48 * magnitude) return {};
  return (-height * surface.unit) * plane.normal;
}

/// Returns the power of two above the largest component of the sides, limited so that it has a reciprocal.
double unit_of(const std::array<Vec3, 3>& sides) {
  double largest = 0;
  for (const Vec3& s : sides) largest = std::max({largest, std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
  int exponent = 0;
  std::frexp(largest, &exponent);
  constexpr int kMax = 1022;
  return std::ldexp(1.0, std::clamp(exponent, -kMax, kMax));
}

/// Doubles the scale of a frame if there is too little room beside its points. Beside a curved patch, boundaries may be
/// cut again later, on arcs outside of the straight lines between the points. An edge turns by at most a sixth of a
/// circle, so its arc is no farther from it than 0.134 of its length.
void make_room_for_curves(Frame& frame, std::span<const Vec3> points) {
  constexpr double kRoom = 1.25;
  for (const Vec3& p : points) {
    const Vec3 way = p - frame.origin;
    const double reach = std::max(std::fabs(dot(way, frame.x_axis)), std::fabs(dot(way, frame.y_axis)));
    if (!(kRoom * reach > frame.scale)) continue;
    frame.scale *= 2;
    return;
  }
}

/// Returns whether two unit vectors point clearly along different lines. Null vectors do not.
bool is_across(const Vec3& a, const Vec3& b) {
  constexpr double kClearly = 1e-3;
  return norm(cross(a, b)) > kClearly;
}

/// The sides of a triangle, each from a corner to the next one. Differences of corners come first, so that a small
/// triangle far from the origin loses no digits. The differences are in the triangle's own unit: if it is far smaller
/// than the mesh, products would underflow in the mesh's unit.
struct Sides {
  double unit;
  std::array<Vec3, 3> side;
};

Sides sides_of(const Surface& surface, const std::array<VertexId, 3>& corner) {
  std::array<Vec3, 3> side;
  for (std::size_t i = 0; i < 3; ++i) side[i] = surface.positions[corner[(i + 1) % 3]] - surface.positions[corner[i]];
  const double unit = unit_of(side);
  for (Vec3& s : side) s = (1 / unit) * s;
  return {unit, side};
}

}  // namespace

double PatchChart::visible_step(Vec2 place, const Vec3& position) const {
  const double largest = std::max({std::fabs(position.x), std::fabs(position.y), std::fabs(position.z)});
  const double ulps = 0x1p-50 * largest / scale(place);
  return std::ceil(std::max(1.0, ulps / grid())) * grid();
}

Axes axes_along(const Vec3& normal, std::span<const Edge3> border) {
  return Axes(make_frame(normal, {}, {}, border, ReferenceAxis::kDominantEdge, {}, 1));
}

PatchCharts::PatchCharts(const Surface& surface, const PatchSet& patches, const CurvedPatches* curved,
                         const ProjectionRule& rule, RunControl& control)
    : surface_(&surface), patches_(&patches), rule_(rule) {
  if (curved != nullptr && curved->has_any()) {
    curved_at_ = curved->at;
    for (const CurvedPatch& patch : curved->curved) curved_.emplace_back(patch);
  }
  reserve_pages(stored_at_.items(), patches.count(), control);
  stored_at_.resize(patches.count(), kNone);
  triangle_kind_.resize(patches.count());
  std::uint32_t stored = 0;
  StopCheck check(control);
  for (std::size_t p = 0; p < patches.count(); ++p) {
    check();
    if (!is_triangle(PatchId(p))) stored_at_[PatchId(p)] = stored++;
  }
  stored_.resize(stored);
}

bool PatchCharts::is_triangle(PatchId p) const {
  const auto faces = patches_->faces_of(p);
  return faces.size() == 1 && surface_->face(faces[0]).size() == 3;
}

ListedFrames PatchCharts::frames(const std::function<bool(PatchId)>& is_kept, RunControl& control) const {
  ListedFrames listed;
  listed.of_patch.resize(size(), kNone);
  std::uint32_t count = 0;
  StopCheck check(control);
  for (std::size_t p = 0; p < size(); ++p) {
    check();
    if (stored_at_[PatchId(p)] != kNone || !is_kept(PatchId(p))) listed.of_patch[p] = count++;
  }
  reserve_pages(listed.frames, count, control);
  listed.frames.resize(count);
  for_blocks(size(), kItemsPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) {
      if (listed.of_patch[p] == kNone) continue;
      const std::uint32_t at = stored_at_[PatchId(p)];
      listed.frames[listed.of_patch[p]] = at != kNone ? stored_[at].plane() : frame_of_triangle(PatchId(p));
    }
  });
  return listed;
}

IdVector<PatchId, Vec3> PatchCharts::normals(RunControl& control) const {
  IdVector<PatchId, Vec3> normals;
  reserve_pages(normals.items(), size(), control);
  normals.resize(size());
  for_blocks(size(), kItemsPerBlock, control, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      const PatchId p(i);
      // A projection has the normal of the patch's plane.
      if (!curved_at_.empty() && curved_at_[p] != kNone) continue;
      const bool is_projection = stored_at_[p] == kNone && triangle_kind_[p] != TriangleKind::kLaidOut;
      normals[p] = is_projection ? patches_->planes[p].normal : (*this)[p].normal({});
    }
  });
  return normals;
}

PatchChart PatchCharts::with_offset(PatchId p, const Frame& frame) const {
  return PatchChart(frame, plane_offset(*surface_, patches_->planes[p], frame.origin));
}

Frame PatchCharts::projection(PatchId p, std::span<const Vec3> points, std::span<const Edge3> edges,
                              double grid) const {
  // The origin is a vertex, in model units, because differences of the input's own coordinates are nearly exact.
  const Vec3 origin = *std::min_element(points.begin(), points.end());
  Frame frame = make_frame(patches_->planes[p].normal, origin, points, edges, rule_.axis, rule_.direction, grid);
  if (has_curved()) make_room_for_curves(frame, points);
  return frame;
}

/// Makes the chart of a curved patch. All of the patch is in the plane between the vertices on its boundary.
PatchChart PatchCharts::develop(PatchId p, std::span<const Vec3> points, double grid) {
  CurvedChart& curved = curved_[curved_at_[p]];
  Vec2 low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (const Vec3& point : points) {
    const Vec2 q = curved.map().flat(point);
    low = {std::min(low.x, q.x), std::min(low.y, q.y)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y)};
  }
  curved.middle = 0.5 * (low + high);
  const Vec2 half = 0.5 * (high - low);
  const Axes& axes = curved.map().axes();
  Frame frame{{}, axes.x, axes.y, axes.z, 1, grid};
  int exponent = 0;
  std::frexp(std::max(half.x, half.y), &exponent);
  frame.scale = std::ldexp(1.0, exponent);
  return stored_[stored_at_[p]] = PatchChart(frame, curved);
}

PatchChart PatchCharts::project(PatchId p, std::span<const Vec3> points, std::span<const Edge3> edges, double grid) {
  if (!curved_at_.empty() && curved_at_[p] != kNone) return develop(p, points, grid);
  if (stored_at_[p] == kNone) {
    // Later callers know nothing of new vertices between the corners, so these do not count here either.
    triangle_kind_[p] = grid == kFineGrid ? TriangleKind::kFineGrid : TriangleKind::kCoarseGrid;
    return PatchChart(frame_of_triangle(p));
  }
  const Frame frame = projection(p, points, edges, grid);
  stored_[stored_at_[p]] = with_offset(p, frame);
  return PatchChart(frame);
}

PatchChart PatchCharts::lay_out(PatchId p) {
  triangle_kind_[p] = TriangleKind::kLaidOut;
  return PatchChart(layout(p));
}

std::array<VertexId, 3> PatchCharts::corners_from_longest(PatchId p) const {
  const auto loop = surface_->face(patches_->faces_of(p)[0]);
  std::array<VertexId, 3> corner{loop[0], loop[1], loop[2]};
  const Sides sides = sides_of(*surface_, corner);
  int longest = 0;
  for (int i = 1; i < 3; ++i)
    if (norm(sides.side[i]) > norm(sides.side[longest])) longest = i;
  std::rotate(corner.begin(), corner.begin() + longest, corner.end());
  return corner;
}

Frame PatchCharts::layout(PatchId p) const {
  const std::array<VertexId, 3> corner = corners_from_longest(p);
  const Sides sides = sides_of(*surface_, corner);
  const Vec3 ab = sides.side[0], ac = -sides.side[2];
  Frame frame;
  frame.origin = surface_->positions[corner[0]];
  frame.x_axis = normalized(ab);
  frame.normal = normalized(cross(ab, ac));
  for (const Vec3& other : {patches_->planes[p].normal, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    if (!is_across(frame.normal, frame.x_axis)) frame.normal = other;
  frame.normal = normalized(frame.normal - dot(frame.normal, frame.x_axis) * frame.x_axis);
  frame.normal = normalized(frame.normal - dot(frame.normal, frame.x_axis) * frame.x_axis);
  frame.y_axis = cross(frame.normal, frame.x_axis);
  frame.grid = kFineGrid;
  int exponent = 0;
  std::frexp(norm(ab), &exponent);
  frame.scale = std::ldexp(sides.unit, exponent);
  return frame;
}

Frame PatchCharts::frame_of_triangle(PatchId p) const {
  if (triangle_kind_[p] == TriangleKind::kLaidOut) return layout(p);
  const auto loop = surface_->face(patches_->faces_of(p)[0]);
  std::array<Vec3, 3> points;
  for (std::size_t i = 0; i < 3; ++i) points[i] = surface_->positions[loop[i]];
  const std::array<Edge3, 3> edges{{{points[0], points[1]}, {points[1], points[2]}, {points[2], points[0]}}};
  return projection(p, points, edges, triangle_kind_[p] == TriangleKind::kFineGrid ? kFineGrid : kPatchGrid);
}

}  // namespace remesh
