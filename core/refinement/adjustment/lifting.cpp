#include "core/refinement/adjustment/lifting.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/blocks.h"
#include "core/base/large_first.h"
#include "core/patches/charts/patch_locator.h"

namespace remesh {
namespace {

/// A vertex is moved only if all its edges are at least this number of plane tolerances long. At this length, noise of
/// one tolerance turns faces so little that their angles keep the bound, because the change of angles is of second
/// order.
constexpr double kMinEdge = 100;
/// A patch is flat up to rounding if its faces leave the plane by no more than this fraction of its largest coordinate.
constexpr double kFlat = 0x1p-46;

class PatchLift {
 public:
  PatchLift(const Surface& surface, const PatchSet& patches, PatchId p, const PatchMesh& mesh, const PatchChart& chart)
      : surface_(surface), faces_(patches.faces_of(p)), mesh_(mesh), chart_(chart) {}

  bool is_flat(RunControl& control) const {
    struct Extent {
      double low = 0, high = 0, magnitude = 0;
    };
    const auto extent_of = [&](std::size_t begin, std::size_t end) {
      Extent e;
      for (const FaceId f : faces_.subspan(begin, end - begin))
        for (const VertexId v : surface_.face(f)) {
          const Vec3& position = surface_.positions[v];
          e.low = std::min(e.low, chart_.height(position));
          e.high = std::max(e.high, chart_.height(position));
          e.magnitude = std::max({e.magnitude, std::fabs(position.x), std::fabs(position.y), std::fabs(position.z)});
        }
      return e;
    };
    Extent all;
    for (const Extent& e : map_blocks<Extent>(faces_.size(), kItemsPerBlock, control, extent_of))
      all = {std::min(all.low, e.low), std::max(all.high, e.high), std::max(all.magnitude, e.magnitude)};
    return all.high - all.low <= kFlat * all.magnitude;
  }

  void run(std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions, RunControl& control) {
    const std::size_t old = surface_.vertex_count();
    const auto has_short_edge = vertices_with_short_edges(kMinEdge * plane_tolerance, control);
    const PatchLocator locator(surface_, faces_, chart_, control);
    for_blocks(mesh_.vertices.size(), kLookUps, control, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        control.check();  // if faces are needles, many of them are near a place
        const std::size_t v = mesh_.vertices[i].value;
        if (v < old + first_inner || has_short_edge[i]) continue;
        Vec3& position = new_positions[v - old];
        const double wanted = height_under(locator.nearest(mesh_.uv[i]), mesh_.uv[i]);
        position += (wanted - chart_.height(position)) * chart_.normal(mesh_.uv[i]);
      }
    });
  }

 private:
  std::vector<std::uint8_t> vertices_with_short_edges(double limit, RunControl& control) const {
    std::vector<std::uint8_t> has_one(mesh_.vertices.size(), 0);
    for_blocks(mesh_.mesh.half_edge_count(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t a = mesh_.mesh.from(h), b = mesh_.mesh.to(h);
        if (!(norm(mesh_.uv[b] - mesh_.uv[a]) * chart_.scale(mesh_.uv[a]) < limit)) continue;
        for (const std::uint32_t v : {a, b}) std::atomic_ref(has_one[v]).store(1, std::memory_order_relaxed);
      }
    });
    return has_one;
  }

  /// Returns the height at p, interpolated between the heights of the triangle's corners.
  double height_under(const PatchLocator::Place& place, Vec2 p) const {
    double weight[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = place.uv[(k + 1) % 3], b = place.uv[(k + 2) % 3];
      weight[k] = std::max(0.0, cross(b - a, p - a));
      sum += weight[k];
    }
    double result = 0;
    for (int k = 0; k < 3; ++k)
      result += (sum > 0 ? weight[k] / sum : 1.0 / 3) * chart_.height(surface_.positions[place.corners[k]]);
    return result;
  }

  const Surface& surface_;
  std::span<const FaceId> faces_;
  const PatchMesh& mesh_;
  const PatchChart chart_;
};

}  // namespace

void lift_new_vertices(const Surface& surface, const PatchSet& patches, const TriangulatedPatches& triangulated,
                       std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions,
                       RunControl& control) {
  const PatchMeshes& meshes = triangulated.meshes;
  const auto work = [&](std::size_t p) {
    return patches.faces_of(PatchId(p)).size() + meshes[PatchId(p)].vertices.size();
  };
  for_large_first(meshes.size(), kLargePatch, work, control, [&](std::size_t p) {
    const PatchMesh& mesh = meshes[PatchId(p)];
    const bool has_inner = std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                       [&](VertexId v) { return v.value >= surface.vertex_count() + first_inner; });
    // New vertices of a curved patch are on its surface already.
    if (!has_inner || patches.faces_of(PatchId(p)).size() == 1) return;
    if (triangulated.charts[PatchId(p)].curved() != nullptr) return;
    PatchLift lift(surface, patches, PatchId(p), mesh, triangulated.charts[PatchId(p)]);
    if (!lift.is_flat(control)) lift.run(first_inner, plane_tolerance, new_positions, control);
  });
}

}  // namespace remesh
