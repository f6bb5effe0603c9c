#include "core/stages/lifting.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/stages/patch_locator.h"

namespace remesh {
namespace {

/// Shortest edge at which noise of one tolerance turns faces by so little that angles keep their bound: the change is
/// of second order.
constexpr double kLeastEdge = 100;
/// What is flatter than this, of its coordinates, is flat but for rounding.
constexpr double kFlat = 0x1p-46;

class PatchLift {
 public:
  PatchLift(const Surface& surface, const PatchSet& patches, PatchId p, const PatchMesh& mesh)
      : surface_(surface), faces_(patches.faces_of(p)), mesh_(mesh) {}

  bool is_flat() const {
    double low = 0, high = 0, magnitude = 0;
    for (const FaceId f : faces_)
      for (const VertexId v : surface_.face(f)) {
        const Vec3& position = surface_.positions[v];
        low = std::min(low, height(position));
        high = std::max(high, height(position));
        magnitude = std::max({magnitude, std::fabs(position.x), std::fabs(position.y), std::fabs(position.z)});
      }
    return high - low <= kFlat * magnitude;
  }

  void run(std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions, RunControl& control) {
    const std::size_t old = surface_.vertex_count();
    std::vector<double> shortest(mesh_.vertices.size(), HUGE_VAL);
    for (std::uint32_t h = 0; h < mesh_.mesh.half_edge_count(); ++h) {
      const std::uint32_t a = mesh_.mesh.from(h), b = mesh_.mesh.to(h);
      const double length = norm(mesh_.uv[b] - mesh_.uv[a]) * mesh_.frame.scale;
      shortest[a] = std::min(shortest[a], length);
      shortest[b] = std::min(shortest[b], length);
    }
    const PatchLocator locator(surface_, faces_, mesh_.frame, control);
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
      if (i % 1024 == 0) control.check();
      const std::size_t v = mesh_.vertices[i].value;
      if (v < old + first_inner || shortest[i] < kLeastEdge * plane_tolerance) continue;
      Vec3& position = new_positions[v - old];
      const double wanted = height_under(locator.nearest(mesh_.uv[i]), mesh_.uv[i]);
      position += (wanted - height(position)) * mesh_.frame.normal;
    }
  }

 private:
  double height(const Vec3& p) const { return dot(p - mesh_.frame.origin, mesh_.frame.normal); }

  /// Between the heights of the triangle's corners.
  double height_under(const PatchLocator::Place& place, Vec2 p) const {
    double weight[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = place.uv[(k + 1) % 3], b = place.uv[(k + 2) % 3];
      weight[k] = std::max(0.0, cross(b - a, p - a));
      sum += weight[k];
    }
    double result = 0;
    for (int k = 0; k < 3; ++k)
      result += (sum > 0 ? weight[k] / sum : 1.0 / 3) * height(surface_.positions[place.corners[k]]);
    return result;
  }

  const Surface& surface_;
  std::span<const FaceId> faces_;
  const PatchMesh& mesh_;
};

}  // namespace

void lift_new_vertices(const Surface& surface, const PatchSet& patches, const std::vector<PatchMesh>& meshes,
                       std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions,
                       RunControl& control) {
  for_all(tbb::blocked_range<std::size_t>(0, meshes.size(), 64), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      control.check();
      const PatchMesh& mesh = meshes[p];
      const bool has_inner = std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                         [&](VertexId v) { return v.value >= surface.vertex_count() + first_inner; });
      if (!has_inner || patches.faces_of(PatchId(p)).size() == 1) continue;
      PatchLift lift(surface, patches, PatchId(p), mesh);
      if (!lift.is_flat()) lift.run(first_inner, plane_tolerance, new_positions, control);
    }
  });
}

}  // namespace remesh
