// The lists of models, and what is done to them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <utility>

#include "tests/support/claims.h"
#include "tests/support/primitives.h"
#include "tests/support/random.h"

namespace remesh::primitives {
namespace {

using test::PlainSurface;

double with_six_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return std::strtod(text, nullptr);
}

/// Turns a point or a direction by a fixed angle around a fixed axis. No axis of the models stays as it is.
Vec3 turned(const Vec3& p) {
  const Vec3 axis = normalized(Vec3{0.6, -0.35, 0.7});
  constexpr double kAngle = 37 * std::numbers::pi / 180;
  return std::cos(kAngle) * p + std::sin(kAngle) * cross(axis, p) + (1 - std::cos(kAngle)) * dot(axis, p) * axis;
}

double diagonal(const PolygonMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box.diagonal();
}

double largest(const PolygonMesh& mesh) {
  double result = 0;
  for (const Vec3& p : mesh.positions) result = std::max({result, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return result;
}

/// Adds the same model made of triangles.
void add_both(std::vector<Model>& models, const Model& model) {
  models.push_back(model);
  models.push_back(triangulated(model));
}

}  // namespace

std::vector<Model> explained() {
  std::vector<Model> models;
  for (const int n : {13, 16, 24, 37, 72, 360, 1000}) models.push_back(cylinder(n, 8, 20));
  add_both(models, cylinder(24, 8, 20, 4));
  models.push_back(subdivided(cylinder(24, 8, 20)));
  models.push_back(arc(48, 48, 3, 10));
  for (const auto& [n, count] : {std::pair{18, 4}, {24, 5}, {36, 9}, {72, 36}, {1000, 100}})
    models.push_back(arc(n, count, 8, 5));
  models.push_back(subdivided(arc(24, 6, 8, 5)));
  for (const int n : {13, 24, 100}) add_both(models, frustum(n, 8, 5, 6));
  models.push_back(subdivided(frustum(24, 3, 7, 6)));
  for (const int n : {13, 24, 72}) models.push_back(cone(n, 5, 9));
  models.push_back(cone(48, 8, 2));
  models.push_back(subdivided(cone(24, 5, 9)));
  for (const auto& [n, m] : {std::pair{24, 12}, {60, 30}, {16, 16}}) add_both(models, globe(n, m, 7));
  models.push_back(icosphere(2, 7));
  models.push_back(icosphere(3, 7));
  add_both(models, torus(48, 48, 24, 6, 2));
  models.push_back(torus(24, 24, 16, 8, 3));
  models.push_back(torus(48, 12, 20, 7, 2));
  models.push_back(torus_with_flat_rings(48, 24, 6, 2));
  for (const int k : {4, 6}) add_both(models, rounded_box({5, 3, 2}, 1.5, k));
  for (const int n : {24, 48}) add_both(models, countersunk_plate(n));
  models.push_back(tube(96, 8, 0.16, 20));
  models.push_back(plates_with_a_common_bore(36));
  models.push_back(pin_in_its_bore(36));
  models.push_back(tee(48));
  models.push_back(vase(40, 24));
  models.push_back(thread(48, 4));
  for (const int k : {4, 5, 12}) models.push_back(bar_with_round_corner(k));
  models.push_back(nut(6, 24));
  models.push_back(d_shaft(48, 5));
  models.push_back(
      joined(cylinder(24, 3, 5), varied(globe(24, 12, 2), {"moved", Storage::kDoubles, true, true}, nullptr)));
  return models;
}

std::vector<Model> declined() {
  std::vector<Model> models;
  models.push_back(nut(6, 0));
  models.push_back(nut(8, 0));
  models.push_back(planks("unequal planks", {28, 9, 9, 26, 9, 9}));
  models.push_back(bar_with_three_planks());
  models.push_back(arc(18, 3, 8, 5));
  for (PlainSurface& s : models.back().surfaces) s = {SurfaceKind::kPlane, {}, {0, 0, 1}, 0, 0, 0, {}};
  return models;
}

Model triangulated(const Model& model) {
  Model result;
  result.name = model.name + " of triangles";
  result.mesh.positions = model.mesh.positions;
  result.surfaces = model.surfaces;
  for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
    const auto corners = model.mesh.face(FaceId(f));
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      for (const VertexId v : {corners[0], corners[i], corners[i + 1]}) result.mesh.corners.push_back(v);
      result.mesh.face_begin.push_back(static_cast<std::uint32_t>(result.mesh.corners.size()));
      result.surface_of.push_back(model.surface_of[FaceId(f)]);
    }
  }
  return result;
}

Model subdivided(const Model& model) {
  const Model coarse = triangulated(model);
  Model result;
  result.name = model.name + " subdivided";
  result.mesh.positions = coarse.mesh.positions;
  result.surfaces = coarse.surfaces;
  std::map<std::pair<VertexId, VertexId>, VertexId> middles;
  const auto middle = [&](VertexId a, VertexId b) {
    const auto [it, is_new] = middles.try_emplace(std::minmax(a, b));
    if (is_new)
      it->second = result.mesh.positions.push_back(0.5 * (coarse.mesh.positions[a] + coarse.mesh.positions[b]));
    return it->second;
  };
  for (std::uint32_t f = 0; f < coarse.mesh.face_count(); ++f) {
    const auto c = coarse.mesh.face(FaceId(f));
    const VertexId ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
    for (const auto& t : {std::array{c[0], ab, ca}, {c[1], bc, ab}, {c[2], ca, bc}, {ab, bc, ca}}) {
      result.mesh.corners.insert(result.mesh.corners.end(), t.begin(), t.end());
      result.mesh.face_begin.push_back(static_cast<std::uint32_t>(result.mesh.corners.size()));
      result.surface_of.push_back(coarse.surface_of[FaceId(f)]);
    }
  }
  return result;
}

Model joined(const Model& a, const Model& b) {
  Model result = a;
  result.name = a.name + " and " + b.name;
  const std::size_t before = a.mesh.vertex_count();
  for (const Vec3& p : b.mesh.positions) result.mesh.positions.push_back(p);
  for (std::uint32_t f = 0; f < b.mesh.face_count(); ++f) {
    for (const VertexId v : b.mesh.face(FaceId(f))) result.mesh.corners.push_back(VertexId(before + v.value));
    result.mesh.face_begin.push_back(static_cast<std::uint32_t>(result.mesh.corners.size()));
    result.surface_of.push_back(static_cast<std::uint32_t>(a.surfaces.size()) + b.surface_of[FaceId(f)]);
  }
  result.surfaces.insert(result.surfaces.end(), b.surfaces.begin(), b.surfaces.end());
  return result;
}

std::vector<Variant> variants() {
  return {{"doubles", Storage::kDoubles, false, false},
          {"doubles, rotated and moved", Storage::kDoubles, true, true},
          {"floats", Storage::kFloats, false, false},
          {"floats, rotated", Storage::kFloats, true, false},
          {"floats, rotated and moved", Storage::kFloats, true, true},
          {"six digits", Storage::kSixDigits, false, false},
          {"six digits, rotated", Storage::kSixDigits, true, false},
          {"noisy, rotated", Storage::kNoisyDoubles, true, false}};
}

Model varied(const Model& model, const Variant& variant, double* step) {
  Model result = model;
  result.name += " (" + variant.name + ")";
  const Vec3 by = variant.is_moved ? Vec3{31.7, -47.3, 12.9} : Vec3{};
  const auto placed = [&](const Vec3& p) { return (variant.is_rotated ? turned(p) : p) + by; };
  for (PlainSurface& s : result.surfaces) {
    s.point = placed(s.point);
    if (variant.is_rotated) s.axis = turned(s.axis);
  }
  const double size = diagonal(model.mesh);
  Random random(7);
  for (Vec3& p : result.mesh.positions) {
    p = placed(p);
    for (int axis = 0; axis < 3; ++axis) switch (variant.storage) {
        case Storage::kDoubles: break;
        case Storage::kFloats: p[axis] = static_cast<double>(static_cast<float>(p[axis])); break;
        case Storage::kSixDigits: p[axis] = with_six_digits(p[axis]); break;
        case Storage::kNoisyDoubles: p[axis] += random.uniform(-1e-9, 1e-9) * size; break;
      }
  }
  if (step == nullptr) return result;
  switch (variant.storage) {
    case Storage::kDoubles: *step = 1e-12 * std::max(size, largest(result.mesh)); break;
    case Storage::kFloats: *step = test::float_step(result.mesh); break;
    case Storage::kSixDigits: *step = std::pow(10, std::floor(std::log10(largest(result.mesh))) - 5); break;
    case Storage::kNoisyDoubles: *step = 2e-9 * size; break;
  }
  return result;
}

double lowest_chord_height(const Model& model) {
  std::map<std::uint32_t, double> highest;
  for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
    const std::uint32_t s = model.surface_of[FaceId(f)];
    const PlainSurface& surface = model.surfaces[s];
    if (surface.kind == SurfaceKind::kPlane || surface.kind == SurfaceKind::kFree) continue;
    const std::vector<Vec3> corners = test::corners_of(model.mesh, FaceId(f));
    for (std::size_t i = 0; i < corners.size(); ++i)
      highest[s] = std::max(highest[s], surface.distance(0.5 * (corners[i] + corners[(i + 1) % corners.size()])));
  }
  double lowest = HUGE_VAL;
  for (const auto& [s, height] : highest) lowest = std::min(lowest, height);
  return lowest;
}

}  // namespace remesh::primitives
