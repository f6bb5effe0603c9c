#include "tests/recognition/step_truth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <stdexcept>

#include "tests/support/claims.h"
#include "tests/support/shared_meshes.h"

namespace remesh::recognition {
namespace {

using test::PlainSurface;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaxDistanceSteps = 9;
constexpr double kMaxRadiusSteps = 3;

SurfaceKind kind_from_name(const std::string& name) {
  if (name == "other") return SurfaceKind::kFree;
  for (const SurfaceKind kind :
       {SurfaceKind::kPlane, SurfaceKind::kCylinder, SurfaceKind::kCone, SurfaceKind::kSphere, SurfaceKind::kTorus})
    if (kind_name(kind) == name) return kind;
  throw std::runtime_error("the table of surfaces has the kind '" + name + "'");
}

/// The factor by which an arc of this angle shows its radius less well than one of 90 degrees.
double lever(double degrees) {
  const auto height = [](double turn) { return 1 - std::cos(std::min(turn, 180.0) / 2 * kDegree); };
  return std::max(1.0, height(90) / std::max(height(degrees), 1e-9));
}

/// Calls `use` with each corner of the face's triangles.
template <class Use>
void for_each_triangle(const PolygonMesh& mesh, const StepFace& face, const Use& use) {
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f) use(test::corners_of(mesh, FaceId(f)));
}

}  // namespace

std::optional<std::vector<StepFace>> truth_beside(const std::string& mesh_path) {
  const std::filesystem::path path(mesh_path.substr(0, mesh_path.rfind('.')) + ".surfaces.tsv");
  if (!std::filesystem::exists(path)) return std::nullopt;
  std::vector<StepFace> faces;
  for (const test::TableRow& cell : test::read_table(path)) {
    const auto number = [&](const char* column) { return cell.at(column).empty() ? 0.0 : std::stod(cell.at(column)); };
    StepFace& face = faces.emplace_back();
    face.number = std::stoi(cell.at("face"));
    face.first = static_cast<std::uint32_t>(std::stoul(cell.at("first")));
    face.count = static_cast<std::uint32_t>(std::stoul(cell.at("count")));
    PlainSurface& s = face.surface;
    s.kind = kind_from_name(cell.at("kind"));
    s.point = {number("px"), number("py"), number("pz")};
    s.axis = {number("ax"), number("ay"), number("az")};
    s.radius = number("r1");
    s.tube = number("r2");
    s.half_deg = number("half_angle");
    face.detail = cell.at("detail");
  }
  return faces;
}

FaceShape shape_of(const PolygonMesh& mesh, const StepFace& face, const IdVector<FaceId, PatchId>& face_patch) {
  FaceShape shape;
  std::set<PatchId> facets;
  std::vector<Vec3> corners;
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f) {
    shape.area += test::area_of(mesh, FaceId(f));
    if (face_patch[FaceId(f)].is_valid()) facets.insert(face_patch[FaceId(f)]);
    for (const Vec3& p : test::corners_of(mesh, FaceId(f))) corners.push_back(p);
  }
  shape.facets = facets.size();
  const PlainSurface& s = face.surface;
  if (s.kind == SurfaceKind::kFree) return shape;
  for (const Vec3& p : corners) shape.off = std::max(shape.off, s.distance(p));
  const test::Arcs arcs = test::arcs_of(s, corners);
  shape.turn_deg = arcs.turn;
  shape.tube_deg = arcs.tube;
  if (s.kind == SurfaceKind::kCone) {
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end(), [&](const Vec3& a, const Vec3& b) {
      return norm(a - s.point) < norm(b - s.point);
    });
    shape.length = norm(*high - s.point) - norm(*low - s.point);
  }
  return shape;
}

bool ClaimError::is_right(double step) const {
  return is_kind_right && distance <= kMaxDistanceSteps * step && radius <= radius_bound;
}

ClaimError error_of(const PolygonMesh& mesh, const StepFace& face, const FaceShape& shape, const PlainSurface& claim,
                    double step) {
  ClaimError error;
  const PlainSurface& s = face.surface;
  error.is_kind_right = claim.kind == s.kind;
  if (s.kind == SurfaceKind::kFree || claim.kind == SurfaceKind::kFree) return error;
  for_each_triangle(mesh, face, [&](const std::vector<Vec3>& t) {
    const auto measure = [&](const Vec3& p) {
      error.distance = std::max(error.distance, claim.distance(s.nearest(p)));
    };
    for (const Vec3& p : t) measure(p);
    for (std::size_t i = 0; i < 3; ++i) measure(0.5 * (t[i] + t[(i + 1) % 3]));
    measure((1.0 / 3) * (t[0] + t[1] + t[2]));
  });
  if (!error.is_kind_right) return error;
  const double unit = kMaxRadiusSteps * std::max(step, shape.off);
  switch (s.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere:
      error.radius = std::fabs(claim.radius - s.radius);
      error.radius_bound = unit * lever(shape.turn_deg);
      break;
    case SurfaceKind::kCone:
      error.radius = std::fabs(claim.half_deg - s.half_deg) * kDegree * shape.length;
      error.radius_bound = unit * lever(shape.turn_deg);
      break;
    case SurfaceKind::kTorus: {
      const double tube_bound = unit * lever(shape.tube_deg);
      const double ring_bound = tube_bound * lever(shape.turn_deg);
      // Both errors are given in units of the tube's, so that one bound holds for both.
      error.radius =
          std::max(std::fabs(claim.tube - s.tube), std::fabs(claim.radius - s.radius) * tube_bound / ring_bound);
      error.radius_bound = tube_bound;
      break;
    }
    default: break;
  }
  return error;
}

}  // namespace remesh::recognition
