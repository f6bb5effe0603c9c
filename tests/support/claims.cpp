#include "tests/support/claims.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/remesh.h"

namespace remesh::test {
namespace {

bool is_curved_kind(SurfaceKind kind) { return kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree; }

Vec3 area_vector(const std::vector<Vec3>& corners) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += 0.5 * cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

/// The part of a facet around one vertex.
struct Wedge {
  std::uint32_t surface = 0;
  std::uint32_t patch = 0;
  Vec3 at;
  double angle = 0;  ///< of the facet at the vertex
  double edge = 0;   ///< the shortest edge at the vertex

  auto key() const { return std::tie(surface, patch, at); }
  /// True if the facet has a corner here that rounding cannot have made from a straight side or from its inside.
  bool is_corner(double step) const {
    constexpr double kSteps = 8;
    return std::fabs(angle - std::numbers::pi) * edge > kSteps * step &&
           std::fabs(angle - 2 * std::numbers::pi) * edge > kSteps * step;
  }
};

}  // namespace

SurfaceId Claims::surface_of(FaceId f) const {
  const PatchId p = face_patch[f];
  return p.is_valid() ? report.surfaces.of_patch[p] : SurfaceId();
}

SurfaceKind Claims::kind_of(FaceId f) const {
  const SurfaceId s = surface_of(f);
  return s.is_valid() ? surfaces()[s].shape.kind : SurfaceKind::kFree;
}

bool Claims::is_curved(FaceId f) const { return is_curved_kind(kind_of(f)); }

Claims claims_of(const PolygonMesh& mesh, RunControl& control, int workers, Options options) {
  options.refine = false;
  RunSettings settings;
  settings.workers = workers;
  settings.want_face_source = true;
  Result result = remesh_surface(mesh, options, settings, control);
  return {std::move(result.report), std::move(result.input_face_patch)};
}

std::vector<ClaimFit> fit_of_claims(const PolygonMesh& mesh, const Claims& claims, double rounding_step) {
  std::vector<Wedge> wedges;
  std::map<SurfaceId, ClaimFit> fits;
  std::map<std::uint32_t, Vec3> patch_area;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!claims.is_curved(FaceId(f))) continue;
    const std::vector<Vec3> corners = corners_of(mesh, FaceId(f));
    const std::uint32_t s = claims.surface_of(FaceId(f)).value;
    patch_area[claims.face_patch[FaceId(f)].value] += area_vector(corners);
    fits[SurfaceId(s)].surface = SurfaceId(s);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 to_next = corners[(i + 1) % corners.size()] - corners[i];
      const Vec3 to_last = corners[(i + corners.size() - 1) % corners.size()] - corners[i];
      wedges.push_back({s, claims.face_patch[FaceId(f)].value, corners[i], angle_between(to_next, to_last),
                        std::min(norm(to_next), norm(to_last))});
    }
  }
  std::sort(wedges.begin(), wedges.end(), [](const Wedge& a, const Wedge& b) { return a.key() < b.key(); });
  std::map<SurfaceId, PlainSurface> surfaces;
  for (const auto& [s, fit] : fits) surfaces[s] = plain(claims.surfaces()[s]);
  for (std::size_t begin = 0, end = 0; begin < wedges.size(); begin = end) {
    Wedge whole = wedges[begin];
    for (end = begin + 1; end < wedges.size() && wedges[end].key() == whole.key(); ++end) {
      whole.angle += wedges[end].angle;
      whole.edge = std::min(whole.edge, wedges[end].edge);
    }
    if (!whole.is_corner(rounding_step)) continue;
    ClaimFit& fit = fits[SurfaceId(whole.surface)];
    const double distance = surfaces[SurfaceId(whole.surface)].distance(whole.at);
    ++fit.corners;
    if (!(distance <= fit.deviation)) {
      fit.deviation = distance;
      fit.farthest = whole.at;
    }
  }
  // A needle has no normal of its own, so the facet as a whole is compared, at the middle of each of its faces.
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!claims.is_curved(FaceId(f))) continue;
    const SurfaceId s = claims.surface_of(FaceId(f));
    const std::vector<Vec3> corners = corners_of(mesh, FaceId(f));
    Vec3 middle;
    for (const Vec3& c : corners) middle += (1.0 / static_cast<double>(corners.size())) * c;
    const Vec3 facet = patch_area[claims.face_patch[FaceId(f)].value];
    const double angle = angle_between(facet, surfaces[s].normal(middle)) * 180 / std::numbers::pi;
    fits[s].tilt_deg = std::max(fits[s].tilt_deg, std::min(angle, 180 - angle));
  }
  std::vector<ClaimFit> result;
  for (const auto& [s, fit] : fits) result.push_back(fit);
  return result;
}

double float_step(const PolygonMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.positions) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return largest > 0 ? std::ldexp(1, std::ilogb(largest) - 23) : 0;
}

double written_step(const PolygonMesh& mesh) {
  const auto all = [&](const auto& holds) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(),
                       [&](const Vec3& p) { return holds(p.x) && holds(p.y) && holds(p.z); });
  };
  double largest = 0;
  for (const Vec3& p : mesh.positions) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  if (largest == 0) return 0;
  // A value near 0 may show digits of the arithmetic that made it.
  const auto is_zero = [&](double value) { return std::fabs(value) < 1e-12 * largest; };
  for (int digits = 3; digits <= 9; ++digits) {
    const auto is_short = [&](double value) {
      char text[40];
      std::snprintf(text, sizeof text, "%.*g", digits, value);
      return is_zero(value) || std::strtod(text, nullptr) == value;
    };
    if (all(is_short)) return std::pow(10, std::floor(std::log10(largest)) + 1 - digits);
  }
  const auto is_float = [&](double value) {
    return is_zero(value) || static_cast<double>(static_cast<float>(value)) == value;
  };
  return all(is_float) ? float_step(mesh) : 0;
}

std::vector<Vec3> corners_of(const PolygonMesh& mesh, FaceId f) {
  std::vector<Vec3> corners;
  for (const VertexId v : mesh.face(f)) corners.push_back(mesh.positions[v]);
  return corners;
}

double area_of(const PolygonMesh& mesh, FaceId f) { return norm(area_vector(corners_of(mesh, f))); }

}  // namespace remesh::test
