#include "core/patches/curved/torus_limits.h"

#include <algorithm>
#include <cstdint>

#include "core/base/stoppable.h"
#include "core/patches/curved/curved_limits.h"

namespace remesh {
namespace {

/// Facets and result together take up this share of the tolerance in depth, unless the facets alone take up half of it.
/// The rest is for the way of boundaries along the surface.
constexpr double kDepthOfBoth = 0.9;

/// A torus may end where its tube is highest. The edges there are outside of the tube by less than this part of the
/// depth of facets inside.
constexpr double kHardly = 0x1p-5;

/// Returns for each surface whether it is a torus with a facet outside of the tube. An edge around the axis is farthest
/// outside in its middle.
std::vector<std::uint8_t> find_outside(const TorusFacets& input, RunControl& control) {
  std::vector<std::uint8_t> is_outside(input.recognised.surfaces.size(), 0);
  StopCheck check(control);
  for (std::size_t p = 0; p < input.facets.count(); ++p) {
    const SurfaceId s = input.recognised.of_patch[PatchId(p)];
    const AnalyticSurface& torus = input.recognised.surfaces[s].shape;
    if (torus.kind != SurfaceKind::kTorus || is_outside[s.value] != 0) continue;
    const double hardly = std::max(input.plane_tolerance, kHardly * input.recognised.surfaces[s].input_chord_height);
    for (const FaceId f : input.facets.faces_of(PatchId(p))) {
      const auto face = input.surface.face(f);
      Vec3 before = input.surface.positions[face.back()];
      for (const VertexId v : face) {
        check();
        const Vec3 here = input.surface.positions[v];
        if (torus.distance(0.5 * (before + here)) > hardly) is_outside[s.value] = 1;
        before = here;
      }
    }
  }
  return is_outside;
}

}  // namespace

void fit_limits_of_tori(const TorusFacets& input, const CurvedGoals& goals, std::vector<CurvedLimits>& limits,
                        RunControl& control) {
  const auto is_torus = [&](std::size_t i) {
    return limits[i].tolerance > 0 && input.recognised.surfaces[SurfaceId(i)].shape.kind == SurfaceKind::kTorus;
  };
  bool is_any = false;
  for (std::size_t i = 0; i < limits.size(); ++i) is_any = is_any || is_torus(i);
  if (!is_any) return;
  const std::vector<std::uint8_t> is_outside = find_outside(input, control);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (!is_torus(i)) continue;
    CurvedLimits& of_surface = limits[i];
    const double own = input.recognised.surfaces[SurfaceId(i)].input_chord_height;
    if (is_outside[i] == 0) {
      of_surface.max_height = std::max(of_surface.max_height, of_surface.boundary_tolerance);
      if (!goals.is_refined && of_surface.tightened().max_height < own) of_surface = {};
    } else if (!goals.may_have_elements()) {
      const double depth = kDepthOfBoth * of_surface.tolerance - own;
      if (depth >= own) {
        of_surface.max_height = std::min(of_surface.max_height, depth);
      } else if (!goals.is_refined) {
        of_surface = {};
      }
      of_surface.boundary_tolerance = std::min(of_surface.boundary_tolerance, of_surface.max_height);
    }
  }
}

}  // namespace remesh
