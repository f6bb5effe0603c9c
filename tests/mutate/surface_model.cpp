#include "tests/mutate/surface_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "tests/support/cgal_space.h"

namespace remesh::mutate {
namespace {

/// Merges vertices with equal coordinates.
class Merger {
 public:
  explicit Merger(std::vector<Vec3>& positions) : positions_(positions) {}
  std::uint32_t id(Vec3 p) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += 0.0;  // -0 becomes 0
    const auto [at, is_new] = ids_.try_emplace(p, static_cast<std::uint32_t>(positions_.size()));
    if (is_new) positions_.push_back(p);
    return at->second;
  }

 private:
  std::vector<Vec3>& positions_;
  std::map<Vec3, std::uint32_t> ids_;
};

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double length = norm_squared(side);
  const double t = length > 0 ? std::clamp(dot(p - a, side) / length, 0.0, 1.0) : 0;
  return norm(p - (a + t * side));
}

double distance_to_box(const Vec3& p, const Box3& box) {
  Vec3 out;
  for (int axis = 0; axis < 3; ++axis) out[axis] = std::max({box.min[axis] - p[axis], p[axis] - box.max[axis], 0.0});
  return norm(out);
}

int smallest_axis(const Vec3& v) {
  const Vec3 a{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)};
  return a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
}

int largest_axis(const Vec3& v) {
  const Vec3 a{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)};
  return a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
}

}  // namespace

Vec3 Scale::apply(const Vec3& p) const {
  const Vec3 q = p - centre;
  return {std::ldexp(q.x, -exponent), std::ldexp(q.y, -exponent), std::ldexp(q.z, -exponent)};
}
double Scale::length(double l) const { return std::ldexp(l, -exponent); }

Scale scale_of(const PolygonMesh& mesh) {
  Box3 box;
  // A face whose corners are at fewer than three places is dropped, so it does not count for the scale.
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    std::set<Vec3> places;
    for (const VertexId v : mesh.face(FaceId(f))) places.insert(mesh.positions[v]);
    if (places.size() < 3) continue;
    for (const Vec3& p : places) box.add({p, p});
  }
  Scale scale;
  scale.centre = 0.5 * box.min + 0.5 * box.max;
  const Vec3 half = 0.5 * box.max - 0.5 * box.min;
  std::frexp(std::max({half.x, half.y, half.z}), &scale.exponent);
  return scale;
}

SurfaceModel::SurfaceModel(const PolygonMesh& mesh, const Scale& scale, double flatness) : flatness_(flatness) {
  Merger merger(originals_);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<std::uint32_t> face;
    for (const VertexId v : mesh.face(FaceId(f))) face.push_back(merger.id(mesh.positions[v]));
    add_face(std::move(face));
  }
  for (const Vec3& p : originals_) positions_.push_back(scale.apply(p));
  finish();
}

SurfaceModel::SurfaceModel(const WrittenMesh& mesh, const Scale& scale) {
  Merger merger(originals_);
  for (const auto& t : mesh.faces) {
    std::vector<std::uint32_t> face;
    for (const std::uint32_t v : t) face.push_back(merger.id(mesh.positions[v]));
    add_face(std::move(face));
  }
  for (const Vec3& p : originals_) positions_.push_back(scale.apply(p));
  finish();
}

void SurfaceModel::add_face(std::vector<std::uint32_t> face) {
  for (std::size_t k = 0; k < face.size(); ++k) {
    const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
    if (a == b) continue;
    EdgeUse& use = edges_[std::minmax(a, b)];
    ++(a < b ? use.forward : use.backward);
  }
  faces_.push_back(std::move(face));
}

bool SurfaceModel::crosses_itself(const std::vector<std::uint32_t>& face, const Vec3& normal) const {
  const std::size_t n = face.size();
  if (n < 4) return false;
  const int axis = largest_axis(normal);
  const auto seen = [&](std::size_t k) {
    const Vec3& p = positions_[face[k % n]];
    return Vec2{p[(axis + 1) % 3], p[(axis + 2) % 3]};
  };
  const auto side = [](const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      const Vec2 a = seen(i), b = seen(i + 1), c = seen(j), d = seen(j + 1);
      if (i == 0 && j == n - 1) continue;  // they are neighbours
      // To touch is to cross: then triangles of such a polygon may lie on each other, which is told.
      if (side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0) return true;
    }
  return false;
}

void SurfaceModel::finish() {
  for (const auto& face : faces_) {
    Vec3 normal;
    Box3 box;
    for (std::size_t k = 0; k < face.size(); ++k) box.add({positions_[face[k]], positions_[face[k]]});
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      normal += cross(positions_[face[k]] - positions_[face[0]], positions_[face[k + 1]] - positions_[face[0]]);
    const Vec3 unit = normalized(normal);
    double thickness = 0;
    for (const std::uint32_t v : face)
      if (face.size() > 3) thickness = std::max(thickness, std::fabs(dot(positions_[v] - positions_[face[0]], unit)));
    // An outline that crosses itself has no surface that everybody would agree on, and neither has one without a
    // plane. If the parts that it winds around cancel, there is no normal along which to look at it.
    constexpr double kNoNormal = 1e-9;
    const double extent = box.diagonal();
    const bool has_normal = norm(normal) > kNoNormal * extent * extent;
    if ((face.size() > 3 && !has_normal) || crosses_itself(face, normal)) thickness = std::max(thickness, extent);
    normals_.push_back(normal);
    boxes_.push_back(box);
    thickness_.push_back(thickness);
  }
}

bool SurfaceModel::is_of_triangles() const {
  return std::all_of(faces_.begin(), faces_.end(), [](const auto& face) { return face.size() == 3; });
}

Box3 SurfaceModel::box() const {
  Box3 box;
  for (const Vec3& p : positions_) box.add({p, p});
  return box;
}

bool SurfaceModel::is_closed_manifold() const {
  return std::all_of(edges_.begin(), edges_.end(),
                     [](const auto& edge) { return edge.second.forward == 1 && edge.second.backward == 1; });
}

bool SurfaceModel::is_balanced() const {
  return std::all_of(edges_.begin(), edges_.end(),
                     [](const auto& edge) { return edge.second.forward == edge.second.backward; });
}

std::int64_t SurfaceModel::euler() const {
  return static_cast<std::int64_t>(positions_.size() + faces_.size()) - static_cast<std::int64_t>(edges_.size());
}

std::size_t SurfaceModel::faces_without_area() const {
  std::size_t count = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& face = faces_[f];
    if (height(f) > 1e-12 * boxes_[f].diagonal()) continue;
    bool is_line = true;
    for (std::size_t i = 0; i < face.size() && is_line; ++i)
      is_line = cgal_is_collinear(originals_[face[i]], originals_[face[(i + 1) % face.size()]],
                                  originals_[face[(i + 2) % face.size()]]);
    count += is_line ? 1 : 0;
  }
  return count;
}

double SurfaceModel::area() const {
  double sum = 0;
  for (const Vec3& normal : normals_) sum += norm(normal) / 2;
  return sum;
}

double SurfaceModel::volume() const {
  double sum = 0;
  for (const auto& face : faces_)
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      sum += dot(positions_[face[0]], cross(positions_[face[k]], positions_[face[k + 1]])) / 6;
  return sum;
}

double SurfaceModel::rounding_of_volume() const {
  double sum = 0;
  for (const auto& face : faces_)
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      sum += norm(positions_[face[0]]) * norm(positions_[face[k]]) * norm(positions_[face[k + 1]]);
  return 0x1p-50 * sum;
}

double SurfaceModel::length_of_edges() const {
  double sum = 0;
  for (const auto& [ends, use] : edges_) sum += norm(positions_[ends.second] - positions_[ends.first]);
  return sum;
}

double SurfaceModel::height(std::size_t f) const {
  const double extent = boxes_[f].diagonal();
  return extent > 0 ? norm(normals_[f]) / extent : 0;
}

/// True if a point is within the face, seen along its normal: the outline winds around the point.
bool SurfaceModel::is_over(std::size_t f, const Vec3& p) const {
  Vec3 axis;
  axis[smallest_axis(normals_[f])] = 1;
  const Vec3 u = normalized(cross(normalized(normals_[f]), axis)), v = cross(normalized(normals_[f]), u);
  const auto seen = [&](const Vec3& q) { return Vec2{dot(q - p, u), dot(q - p, v)}; };
  int winding = 0;
  const auto& face = faces_[f];
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Vec2 a = seen(positions_[face[k]]), b = seen(positions_[face[(k + 1) % face.size()]]);
    const double side = cross(a, b);
    if (a.y <= 0 && b.y > 0 && side > 0) ++winding;
    if (a.y > 0 && b.y <= 0 && side < 0) --winding;
  }
  return winding != 0;
}

bool SurfaceModel::has_spike(std::size_t f, double reach) const {
  const auto& face = faces_[f];
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Vec3 &before = positions_[face[k]], &tip = positions_[face[(k + 1) % face.size()]],
               &after = positions_[face[(k + 2) % face.size()]];
    if (distance_to_segment(before, tip, after) <= reach || distance_to_segment(after, tip, before) <= reach)
      return true;
  }
  return false;
}

Vec3 SurfaceModel::sample(std::size_t f, Random& random) const {
  const auto& face = faces_[f];
  const auto corner = [&](std::size_t k) { return positions_[face[k % face.size()]]; };
  const std::size_t k = static_cast<std::size_t>(random.below(static_cast<int>(face.size())));
  // The fan of a concave plane polygon leaves the polygon. In that case the point is taken from its outline.
  for (int i = 0; i < 4 && thickness_[f] <= flatness_; ++i) {
    double s = random.unit(), t = random.unit();
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3 p = corner(k) + s * (corner(k + 1) - corner(k)) + t * (corner(k + 2) - corner(k));
    if (face.size() == 3 || is_over(f, p)) return p;
  }
  return corner(k) + random.unit() * (corner(k + 1) - corner(k));
}

double SurfaceModel::distance(std::size_t f, const Vec3& p) const {
  const auto& face = faces_[f];
  // The surface of a polygon without a plane is not defined, so any point of its box counts.
  if (thickness_[f] > flatness_) return distance_to_box(p, boxes_[f]);
  double least = HUGE_VAL;
  const Vec3 unit = normalized(normals_[f]);
  if (unit != Vec3{}) {
    const double above = dot(p - positions_[face[0]], unit);
    if (is_over(f, p - above * unit)) least = std::max(0.0, std::fabs(above) - thickness_[f]);
  }
  // The normal of a needle is mostly rounding, so its edges are always looked at as well.
  for (std::size_t k = 0; k < face.size(); ++k)
    least = std::min(least, distance_to_segment(p, positions_[face[k]], positions_[face[(k + 1) % face.size()]]));
  return least;
}

double SurfaceModel::distance(const Vec3& p) const {
  double least = HUGE_VAL;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    if (distance_to_box(p, boxes_[f]) < least) least = std::min(least, distance(f, p));
  return least;
}

}  // namespace remesh::mutate
