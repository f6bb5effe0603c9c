#include "core/output/run/free_part.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

/// A plane with more than this many times the area of the median free facet is a plane that somebody has made.
constexpr double kLargePlane = 20;
/// Unless it is smooth all around, and its triangles are not larger than this many median free facets.
constexpr double kLargeFacet = 4;
/// A plane is a needle if it is narrower than this share of its length.
constexpr double kNeedle = 0.2;
/// Needles are facets of one surface if one is at most so many times as wide as the other.
constexpr double kWiderNeedle = 4;

/// The normals of faces, as long as twice the faces' areas.
class FaceNormals {
 public:
  FaceNormals(const Surface& surface, const Triangulated& triangles, double feature_angle_deg, RunControl& control)
      : least_cosine_(std::cos(feature_angle_deg * M_PI / 180)) {
    of_face_.assign(surface.face_count(), Vec3());
    StopCheck check(control);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      check();
      const Triangle corners = triangles.triangle(t);
      const Vec3& a = surface.local[corners[0]];
      of_face_[triangles.face(t)] += cross(surface.local[corners[1]] - a, surface.local[corners[2]] - a);
    }
  }
  double area(FaceId f) const { return norm(of_face_[f]) / 2; }
  bool are_smooth(FaceId f, FaceId g) const {
    return dot(of_face_[f], of_face_[g]) >= least_cosine_ * norm(of_face_[f]) * norm(of_face_[g]);
  }

 private:
  double least_cosine_;
  IdVector<FaceId, Vec3> of_face_;
};

SurfaceKind kind_of(const FreeContext& context, PatchId p) {
  return context.recognised.surfaces[context.recognised.of_patch[p]].shape.kind;
}

/// Returns the median area of the faces of free surfaces; 0 if there are none.
double median_area(const FreeContext& context, const FaceNormals& normals) {
  std::vector<double> areas;
  for (PatchId p(0); p.value < context.patches.count(); ++p.value)
    if (kind_of(context, p) == SurfaceKind::kFree)
      for (const FaceId f : context.patches.faces_of(p)) areas.push_back(normals.area(f));
  if (areas.empty()) return 0;
  const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::nth_element(areas.begin(), middle, areas.end());
  return *middle;
}

/// The roles of planes. Where a free surface is flat, its facets are planes of one or two triangles.
class PlaneRoles {
 public:
  PlaneRoles(const FreeContext& context, const FaceNormals& normals, RunControl& control)
      : context_(context), normals_(normals), check_(control), is_free_(context.patches.count(), 0) {
    const double median = median_area(context, normals);
    for (PatchId p(0); p.value < context.patches.count(); ++p.value)
      if (kind_of(context, p) == SurfaceKind::kFree || (is_plane(p) && is_free_plane(p, median))) is_free_[p] = 1;
    free_needles();
  }

  bool is_free(PatchId p) const { return is_free_[p] != 0; }

 private:
  PatchId patch_of(FaceId f) const { return context_.patches.of_face[f]; }
  bool is_plane(PatchId p) const { return kind_of(context_, p) == SurfaceKind::kPlane; }

  /// Calls `visit` with the half-edge of each edge of a patch's border, and with the face that goes on smoothly beyond
  /// it; that is invalid where none does.
  template <class Visit>
  void for_each_border_edge(PatchId p, const Visit& visit) {
    for (const FaceId f : context_.patches.faces_of(p)) {
      check_();
      for (std::uint32_t h = context_.surface.face_begin[f.value]; h < context_.surface.face_begin[f.value + 1]; ++h) {
        if (!is_patch_boundary(context_.adjacency, context_.patches, h)) continue;
        const std::uint32_t twin = context_.adjacency.twin(h);
        const FaceId g = twin == kNone ? FaceId() : context_.adjacency.face_of(twin);
        const bool is_smooth =
            g.is_valid() && context_.surface.label(f) == context_.surface.label(g) && normals_.are_smooth(f, g);
        visit(h, is_smooth ? g : FaceId());
      }
    }
  }

  /// Returns whether a plane is a part of the free surface around it, because of its size.
  bool is_free_plane(PatchId p, double median) {
    double area = 0;
    std::size_t triangles = 0;
    for (const FaceId f : context_.patches.faces_of(p)) {
      check_();
      area += normals_.area(f);
      triangles += context_.surface.face_begin[f.value + 1] - context_.surface.face_begin[f.value] - 2;
    }
    bool is_any_smooth = false, is_any_other = false;
    for_each_border_edge(p, [&](std::uint32_t, FaceId g) {
      (g.is_valid() && kind_of(context_, patch_of(g)) == SurfaceKind::kFree ? is_any_smooth : is_any_other) = true;
    });
    if (!is_any_smooth) return false;
    return area <= kLargePlane * median ||
           (!is_any_other && area <= kLargeFacet * median * static_cast<double>(triangles));
  }

  double length(std::uint32_t h) const {
    const auto& local = context_.surface.local;
    return norm(local[context_.adjacency.to(h)] - local[context_.adjacency.from(h)]);
  }

  /// Returns how far a face of few corners goes to one side of an edge, about.
  double height(FaceId f, double edge) const {
    return (context_.surface.face(f).size() == 3 ? 2 : 1) * normals_.area(f) / edge;
  }

  struct Needle {
    double length = 0;  ///< 0 for all other patches
    double width = 0;
  };
  /// Returns the size of a plane that is a needle: of one or two triangles, and narrow.
  Needle needle_of(PatchId p) {
    double area = 0, longest = 0;
    std::size_t triangles = 0;
    for (const FaceId f : context_.patches.faces_of(p)) {
      area += normals_.area(f);
      triangles += context_.surface.face(f).size() - 2;
      if (triangles > 2) return {};
    }
    for_each_border_edge(p, [&](std::uint32_t h, FaceId) { longest = std::max(longest, length(h)); });
    const double width = (triangles == 1 ? 2 : 1) * area / longest;
    return width <= kNeedle * longest ? Needle{longest, width} : Needle{};
  }

  /// Returns whether a needle goes on smoothly to one side, to free faces or other needles of about its width.
  bool goes_on_sideways(PatchId p, const IdVector<PatchId, Needle>& needles) {
    bool does = false;
    for_each_border_edge(p, [&](std::uint32_t h, FaceId g) {
      if (!g.is_valid() || (is_free_[patch_of(g)] == 0 && !(needles[patch_of(g)].length > 0))) return;
      const double edge = length(h);
      if (edge >= needles[p].length / 2 && needles[p].width <= kWiderNeedle * height(g, edge)) does = true;
    });
    return does;
  }

  /// Needles side by side are facets of a surface that is flat along them. Those that go on smoothly to a free surface,
  /// over other such needles or by themselves, belong to it.
  void free_needles() {
    IdVector<PatchId, Needle> needles(context_.patches.count());
    for (PatchId p(0); p.value < needles.size(); ++p.value)
      if (is_free_[p] == 0 && is_plane(p)) needles[p] = needle_of(p);
    IdVector<PatchId, std::uint8_t> waits(needles.size(), 0);
    std::vector<PatchId> waiting, reached;
    for (PatchId p(0); p.value < needles.size(); ++p.value)
      if (needles[p].length > 0 && goes_on_sideways(p, needles)) waiting.push_back(p);
    for (const PatchId p : waiting) waits[p] = 1;
    const auto reach = [&](PatchId p) {
      waits[p] = 0;
      is_free_[p] = 1;
      reached.push_back(p);
    };
    for (const PatchId p : waiting) {
      bool is_beside = false;
      for_each_border_edge(p,
                           [&](std::uint32_t, FaceId g) { is_beside |= g.is_valid() && is_free_[patch_of(g)] != 0; });
      if (is_beside && waits[p] != 0) reach(p);
    }
    for (std::size_t i = 0; i < reached.size(); ++i)
      for_each_border_edge(reached[i], [&](std::uint32_t, FaceId g) {
        if (g.is_valid() && waits[patch_of(g)] != 0) reach(patch_of(g));
      });
  }

  const FreeContext& context_;
  const FaceNormals& normals_;
  StopCheck check_;
  IdVector<PatchId, std::uint8_t> is_free_;
};

}  // namespace

FilledIdVector<FaceId, FaceRole> roles_of(const FreeContext& context, const Triangulated& triangles,
                                          RunControl& control) {
  FilledIdVector<FaceId, FaceRole> roles(context.surface.face_count());
  std::fill(roles.begin(), roles.end(), FaceRole::kStays);
  const auto& surfaces = context.recognised.surfaces;
  if (std::none_of(surfaces.begin(), surfaces.end(),
                   [](const RecognisedSurface& s) { return s.shape.kind == SurfaceKind::kFree; }))
    return roles;
  const FaceNormals normals(context.surface, triangles, context.feature_angle_deg, control);
  const PlaneRoles planes(context, normals, control);
  for (PatchId p(0); p.value < context.patches.count(); ++p.value) {
    const bool is_plane = kind_of(context, p) == SurfaceKind::kPlane;
    const FaceRole role = planes.is_free(p) ? FaceRole::kFree : is_plane ? FaceRole::kPlane : FaceRole::kStays;
    for (const FaceId f : context.patches.faces_of(p)) roles[f] = role;
  }
  for (const auto& [f, g] : context.crossing) roles[f] = roles[g] = FaceRole::kStays;
  for (const FaceId f : context.surface.caps) roles[f] = FaceRole::kStays;
  return roles;
}

std::size_t sharp_patches(const FreeContext& context, const FreePart& part, double min_angle_deg, RunControl& control) {
  std::vector<FaceId> faces;
  for (FaceId f(0); f.value < part.faces.size(); ++f.value)
    if (part.is_free(f)) faces.push_back(f);
  const auto patch = [&](FaceId f) { return context.patches.of_face[part.face[f]]; };
  std::stable_sort(faces.begin(), faces.end(), [&](FaceId f, FaceId g) { return patch(f) < patch(g); });
  std::size_t sharp = 0;
  std::vector<std::pair<VertexId, double>> angles;
  StopCheck check(control);
  for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    check();
    angles.clear();
    for (end = begin; end < faces.size() && patch(faces[end]) == patch(faces[begin]); ++end) {
      const Triangle& t = part.faces[faces[end]];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 ahead = part.positions[t[(k + 1) % 3]] - part.positions[t[k]];
        const Vec3 back = part.positions[t[(k + 2) % 3]] - part.positions[t[k]];
        angles.emplace_back(t[k], std::atan2(norm(cross(ahead, back)), dot(ahead, back)));
      }
    }
    std::sort(angles.begin(), angles.end());
    double least = M_PI;
    for (std::size_t i = 0; i < angles.size();) {
      double sum = 0;
      for (const VertexId v = angles[i].first; i < angles.size() && angles[i].first == v; ++i) sum += angles[i].second;
      least = std::min(least, sum);
    }
    sharp += least * 180 / M_PI < min_angle_deg ? 1 : 0;
  }
  return sharp;
}

FreePart::FreePart(const FreeContext& context, const Triangulated& triangles,
                   const FilledIdVector<FaceId, FaceRole>& roles, RunControl& control) {
  const Surface& surface = context.surface;
  StopCheck check(control);
  IdVector<VertexId, std::uint8_t> is_free_vertex(surface.vertex_count(), 0), is_at_other(surface.vertex_count(), 0);
  for (FaceId f(0); f.value < roles.size(); ++f.value) {
    check();
    if (roles[f] == FaceRole::kPlane) continue;
    for (const VertexId v : surface.face(f)) (roles[f] == FaceRole::kFree ? is_free_vertex : is_at_other)[v] = 1;
  }
  const auto is_part = [&](FaceId f) {
    const auto corners = surface.face(f);
    return std::any_of(corners.begin(), corners.end(), [&](VertexId v) { return is_free_vertex[v] != 0; });
  };
  IdVector<VertexId, VertexId> number(surface.vertex_count());
  // Free faces with different labels are different regions, and so are planes.
  std::map<std::pair<FaceRole, std::uint32_t>, std::uint32_t> regions;
  std::vector<VertexId> corners;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    check();
    const FaceId f = triangles.face(t);
    const Triangle triangle = triangles.triangle(t);
    if (roles[f] != FaceRole::kFree && !is_part(f)) {
      kept.push_back(triangle);
      continue;
    }
    Triangle own;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = triangle[k];
      if (!number[v].is_valid()) {
        number[v] = positions.push_back(surface.local[v]);
        vertex.push_back(v);
        is_held.push_back(is_free_vertex[v] == 0 || is_at_other[v] != 0 ? 1 : 0);
      }
      own[k] = number[v];
      corners.push_back(own[k]);
    }
    faces.push_back(own);
    face.push_back(f);
    const bool is_free_face = roles[f] == FaceRole::kFree;
    free_faces += is_free_face ? 1 : 0;
    is_of_plane.push_back(is_free_face ? 0 : 1);
    const std::pair key(roles[f], is_free_face ? surface.label(f) : context.patches.of_face[f].value);
    region.push_back(regions.emplace(key, static_cast<std::uint32_t>(regions.size())).first->second);
  }
  const auto begins = triangle_begins(faces.size(), control);
  const Adjacency adjacency(positions.size(), begins, corners, control);
  twins.resize(corners.size());
  edges.assign(corners.size(), FreeForm::Edge::kSmooth);
  const double least_cosine = std::cos(context.feature_angle_deg * M_PI / 180);
  const auto normal = [&](FaceId f) {
    const Triangle& t = faces[f];
    return cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
  };
  for_blocks(faces.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value)
      for (std::uint32_t h = 3 * f.value; h < 3 * f.value + 3; ++h) {
        twins[h] = adjacency.twin(h);
        if (twins[h] == kNone) continue;
        const FaceId g(twins[h] / 3);
        if (region[f] != region[g]) {
          edges[h] = FreeForm::Edge::kBorder;
        } else if (is_of_plane[f.value] == 0) {
          const Vec3 one = normal(f), other = normal(g);
          if (dot(one, other) < least_cosine * norm(one) * norm(other)) edges[h] = FreeForm::Edge::kFeature;
        }
      }
  });
}

}  // namespace remesh
