#include "tests/support/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

namespace remesh::shapes {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Collects faces given by coordinates; equal coordinates become one vertex.
class Builder {
 public:
  void face(const std::vector<Vec3>& points) {
    for (const Vec3& p : points) mesh_.corners.push_back(vertex(p));
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }
  /// Adds the parallelogram at `corner` that u and v span (u x v points outwards), in nu x nv squares of two
  /// triangles.
  void square(const Vec3& corner, const Vec3& u, const Vec3& v, int nu, int nv, bool as_quads = false) {
    const auto at = [&](int i, int j) {
      return corner + static_cast<double>(i) / nu * u + static_cast<double>(j) / nv * v;
    };
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < nu; ++i) {
        const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
        if (as_quads) {
          face({a, b, c, d});
        } else {
          face({a, b, c});
          face({a, c, d});
        }
      }
  }
  /// Adds a triangle, divided into n x n smaller ones.
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c, int n) {
    const auto at = [&](int i, int j) {
      return a + static_cast<double>(i) / n * (b - a) + static_cast<double>(j) / n * (c - a);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        face({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) face({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  PolygonMesh take() { return std::move(mesh_); }

 private:
  VertexId vertex(const Vec3& p) {
    const auto [it, is_new] = ids_.try_emplace(p, mesh_.positions.size());
    if (is_new) mesh_.positions.push_back(p);
    return it->second;
  }

  PolygonMesh mesh_;
  std::map<Vec3, VertexId> ids_;
};

bool is_filled(const std::vector<std::string_view>& rows, int x, int y) {
  const int row = static_cast<int>(rows.size()) - 1 - y;
  if (row < 0 || row >= static_cast<int>(rows.size()) || x < 0 || x >= static_cast<int>(rows[row].size())) return false;
  return rows[row][x] == '#';
}

/// Calls cell(x, y) for every '#', bottom row first.
template <class F>
void for_each_cell(const std::vector<std::string_view>& rows, F&& cell) {
  for (int y = 0; y < static_cast<int>(rows.size()); ++y)
    for (int x = 0; x < static_cast<int>(rows[rows.size() - 1 - y].size()); ++x)
      if (is_filled(rows, x, y)) cell(x, y);
}

PolygonMesh box_of(const Vec3& size, int n, bool as_quads) {
  const Vec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  Builder b;
  b.square({}, y, x, n, n, as_quads);
  b.square(z, x, y, n, n, as_quads);
  b.square({}, x, z, n, n, as_quads);
  b.square(y, z, x, n, n, as_quads);
  b.square({}, z, y, n, n, as_quads);
  b.square(x, y, z, n, n, as_quads);
  return b.take();
}

}  // namespace

PolygonMesh from_lists(const std::vector<Vec3>& positions, const std::vector<std::vector<std::uint32_t>>& faces) {
  PolygonMesh mesh;
  mesh.positions.items() = positions;
  for (const auto& face : faces) {
    for (const std::uint32_t v : face) mesh.corners.push_back(VertexId(v));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

TriangleMesh as_triangles(const PolygonMesh& mesh) {
  TriangleMesh triangles;
  triangles.positions = mesh.positions;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    triangles.faces.push_back({face[0], face[1], face[2]});
  }
  return triangles;
}

PolygonMesh flat(const std::vector<std::string_view>& rows, int cuts) {
  Builder b;
  for_each_cell(rows, [&](int x, int y) {
    b.square({static_cast<double>(x), static_cast<double>(y), 0}, {1, 0, 0}, {0, 1, 0}, cuts, cuts);
  });
  return b.take();
}

PolygonMesh polygon(const std::vector<Vec2>& points) {
  std::vector<Vec3> face;
  for (const Vec2& p : points) face.push_back({p.x, p.y, 0});
  Builder b;
  b.face(face);
  return b.take();
}

PolygonMesh triangle(double degrees, double first, double second) {
  const double angle = degrees * kPi / 180;
  return polygon({{0, 0}, {first, 0}, {second * std::cos(angle), second * std::sin(angle)}});
}

PolygonMesh sheet(double width, double height, int nx, int ny) {
  Builder b;
  b.square({}, {width, 0, 0}, {0, height, 0}, nx, ny);
  return b.take();
}

PolygonMesh ring(int cuts) {
  const Vec3 outer[4] = {{-4, -4, 1}, {4, -4, 1}, {4, 4, 1}, {-4, 4, 1}};
  const Vec3 inner[4] = {{-3, -3, 1}, {3, -3, 1}, {3, 3, 1}, {-3, 3, 1}};
  Builder b;
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    b.triangle(outer[i], outer[j], inner[i], cuts);
    b.triangle(outer[j], inner[j], inner[i], cuts);
  }
  return b.take();
}

PolygonMesh plate_with_round_hole(int sides) {
  if (sides < 4 || sides % 4 != 0) throw std::invalid_argument("sides must be a multiple of 4");
  // Corners and hole vertices see each other in the order of their angle. The hole's quarter points face the corners.
  const Vec3 corner[4] = {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}};
  const auto hole = [&](int i) {
    const double angle = kPi / 4 + 2 * kPi * (i % sides) / sides;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  Builder b;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int begin = quarter * (sides / 4), middle = begin + sides / 8, end = begin + sides / 4;
    const Vec3& from = corner[quarter];
    const Vec3& to = corner[(quarter + 1) % 4];
    for (int i = begin; i < end; ++i) b.face({i < middle ? from : to, hole(i + 1), hole(i)});
    b.face({from, to, hole(middle)});
  }
  return b.take();
}

PolygonMesh slotted_plate(int cuts) { return flat({"##.##", "##.##", "#####"}, cuts); }

PolygonMesh two_squares_touching_at_a_vertex(int cuts) { return flat({".#", "#."}, cuts); }

PolygonMesh double_sheet(int cuts) {
  Builder b;
  b.square({}, {1, 0, 0}, {0, 1, 0}, cuts, cuts);
  b.square({}, {0, 1, 0}, {1, 0, 0}, cuts, cuts);
  return b.take();
}

PolygonMesh noisy_sheet(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double dx = i > 0 && i < n ? noise(random) : 0;
      const double dy = j > 0 && j < n ? noise(random) : 0;
      positions.push_back({i + dx, j + dy, 0});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto middle = static_cast<std::uint32_t>(positions.size());
      const std::uint32_t around[4] = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      Vec3 sum;
      for (const std::uint32_t v : around) sum += positions[v];
      positions.push_back(0.25 * sum);
      for (int k = 0; k < 4; ++k) faces.push_back({around[k], around[(k + 1) % 4], middle});
    }
  return from_lists(positions, faces);
}

PolygonMesh box(const Vec3& size, int n) { return box_of(size, n, false); }
PolygonMesh quad_box(const Vec3& size, int n) { return box_of(size, n, true); }

PolygonMesh blocks(const std::vector<std::string_view>& rows, int cuts) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  Builder b;
  for_each_cell(rows, [&](int i, int j) {
    const Vec3 p{static_cast<double>(i), static_cast<double>(j), 0};
    b.square(p, y, x, cuts, cuts);
    b.square(p + z, x, y, cuts, cuts);
    if (!is_filled(rows, i, j - 1)) b.square(p, x, z, cuts, cuts);
    if (!is_filled(rows, i, j + 1)) b.square(p + y, z, x, cuts, cuts);
    if (!is_filled(rows, i - 1, j)) b.square(p, z, y, cuts, cuts);
    if (!is_filled(rows, i + 1, j)) b.square(p + x, y, z, cuts, cuts);
  });
  return b.take();
}

PolygonMesh random_blocks(Random& random, int side, int cuts) {
  std::vector<std::string> rows(static_cast<std::size_t>(side), std::string(static_cast<std::size_t>(side), '.'));
  for (std::string& row : rows)
    for (char& cell : row) cell = random.chance(0.6) ? '#' : '.';
  rows[2][2] = '#';
  return blocks({rows.begin(), rows.end()}, cuts);
}

PolygonMesh random_soup(Random& random, int max_corners) {
  const int side = random.integer(1, 3), height = random.integer(0, 2);
  std::vector<Vec3> positions;
  for (int x = 0; x <= side; ++x)
    for (int y = 0; y <= side; ++y)
      for (int z = 0; z <= height; ++z)
        positions.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  std::vector<std::vector<std::uint32_t>> faces;
  for (int f = random.integer(1, 25); f > 0; --f) {
    faces.emplace_back();
    for (int k = random.chance(0.8) ? 3 : random.integer(3, max_corners); k > 0; --k)
      faces.back().push_back(static_cast<std::uint32_t>(random.below(static_cast<int>(positions.size()))));
  }
  return from_lists(positions, faces);
}

PolygonMesh l_bracket(int cuts) { return blocks({"#.", "##"}, cuts); }

PolygonMesh prism(const std::vector<Vec2>& base, double height) {
  const std::size_t n = base.size();
  std::vector<Vec3> bottom, top;
  for (const Vec2& p : base) {
    bottom.push_back({p.x, p.y, 0});
    top.push_back({p.x, p.y, height});
  }
  Builder b;
  b.face({bottom.rbegin(), bottom.rend()});
  b.face(top);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    b.face({bottom[i], bottom[j], top[j], top[i]});
  }
  return b.take();
}

PolygonMesh cylinder(int sides, double radius, double height) {
  std::vector<Vec2> base;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * kPi * i / sides;
    base.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return prism(base, height);
}

PolygonMesh sphere(int levels) {
  const int n = 1 << levels;
  PolygonMesh mesh;
  Builder b;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 x{octant & 1 ? -1.0 : 1.0, 0, 0}, y{0, octant & 2 ? -1.0 : 1.0, 0}, z{0, 0, octant & 4 ? -1.0 : 1.0};
    if (dot(cross(x, y), z) > 0)
      b.triangle(x, y, z, n);
    else
      b.triangle(y, x, z, n);
  }
  mesh = b.take();
  for (Vec3& p : mesh.positions) p = normalized(p);
  return mesh;
}

PolygonMesh three_pages(int cuts) {
  const Vec3 spine{0, 0, 1};
  Builder b;
  b.square({}, {1, 0, 0}, spine, cuts, cuts);
  b.square({}, {-1, 1, 0}, spine, cuts, cuts);
  b.square({}, {-1, -1, 0}, spine, cuts, cuts);
  return b.take();
}

PolygonMesh cube_with_needle(double height) {
  return from_lists({{0, 0, 0},
                     {1, 0, 0},
                     {1, 1, 0},
                     {0, 1, 0},
                     {0, 0, 1},
                     {1, 0, 1},
                     {1, 1, 1},
                     {0, 1, 1},
                     {0.5, -height / 2, 1 - height}},
                    {{0, 3, 2, 1},
                     {4, 5, 6, 7},
                     {1, 2, 6, 5},
                     {2, 3, 7, 6},
                     {3, 0, 4, 7},
                     {0, 1, 8},
                     {1, 5, 8},
                     {4, 0, 8},
                     {5, 4, 8}});
}

PolygonMesh sheet_with_flap(double height, bool is_closed) {
  std::vector<std::vector<std::uint32_t>> faces{{0, 1, 4, 3}, {1, 2, 5, 4}, {1, 4, 6}};
  if (is_closed) faces.push_back({4, 1, 6});
  return from_lists({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 0.5, height}}, faces);
}

PolygonMesh moved(PolygonMesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.positions) p += by;
  return mesh;
}

PolygonMesh scaled(PolygonMesh mesh, double factor) {
  for (Vec3& p : mesh.positions) p = factor * p;
  return mesh;
}

PolygonMesh rotated(PolygonMesh mesh, const Vec3& axis, double angle_deg) {
  const Vec3 k = normalized(axis);
  const double c = std::cos(angle_deg * kPi / 180), s = std::sin(angle_deg * kPi / 180);
  for (Vec3& p : mesh.positions) p = c * p + s * cross(k, p) + (1 - c) * dot(k, p) * k;  // Rodrigues' rotation formula
  return mesh;
}

PolygonMesh rounded(PolygonMesh mesh, double step) {
  for (Vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::nearbyint(p[axis] / step) * step;
  return mesh;
}

PolygonMesh renumbered(const PolygonMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> new_vertex(mesh.vertex_count()), face_order(mesh.face_count());
  std::iota(new_vertex.begin(), new_vertex.end(), 0u);
  std::iota(face_order.begin(), face_order.end(), 0u);
  std::shuffle(new_vertex.begin(), new_vertex.end(), random);
  std::shuffle(face_order.begin(), face_order.end(), random);

  PolygonMesh out;
  out.positions.resize(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    out.positions[VertexId(new_vertex[v])] = mesh.positions[VertexId(v)];
  for (const std::uint32_t f : face_order) {
    const auto face = mesh.face(FaceId(f));
    const std::size_t first = random() % face.size();
    for (std::size_t i = 0; i < face.size(); ++i)
      out.corners.push_back(VertexId(new_vertex[face[(first + i) % face.size()].value]));
    out.face_begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
  }
  out.labels = mesh.labels;
  for (LabelSet* set : {&out.labels.object, &out.labels.group, &out.labels.material}) {
    if (!set->is_used()) continue;
    const auto old = set->of_face;
    for (std::size_t f = 0; f < face_order.size(); ++f) set->of_face[FaceId(f)] = old[FaceId(face_order[f])];
  }
  return out;
}

PolygonMesh turned_over(PolygonMesh mesh) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
  return mesh;
}

PolygonMesh strip_over_itself() {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= 40; ++i) {
    const double angle = 450.0 / 40 * i * 3.14159265358979 / 180;
    for (const double radius : {1.0, 2.0 + 0.001 * i})
      positions.push_back({radius * std::cos(angle) + 0.0005 * i, radius * std::sin(angle), 0});
    const auto k = static_cast<std::uint32_t>(2 * i);
    if (i < 40) faces.push_back({k, k + 1, k + 3, k + 2});
  }
  return from_lists(positions, faces);
}

PolygonMesh joined(const PolygonMesh& a, const PolygonMesh& b) {
  PolygonMesh out = a;
  out.labels = {};
  for (const Vec3& p : b.positions) out.positions.push_back(p);
  for (const VertexId v : b.corners) out.corners.push_back(VertexId(a.vertex_count() + v.value));
  for (std::size_t f = 1; f < b.face_begin.size(); ++f)
    out.face_begin.push_back(static_cast<std::uint32_t>(a.corners.size() + b.face_begin[f]));
  return out;
}

PolygonMesh welded(const PolygonMesh& mesh) {
  Builder b;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<Vec3> points;
    for (const VertexId v : mesh.face(FaceId(f))) points.push_back(mesh.positions[v]);
    b.face(points);
  }
  PolygonMesh out = b.take();
  out.labels = mesh.labels;
  return out;
}

PolygonMesh fan_triangulated(const PolygonMesh& mesh) {
  PolygonMesh out;
  out.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      for (const VertexId v : {face[0], face[i], face[i + 1]}) out.corners.push_back(v);
      out.face_begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
    }
  }
  return out;
}

TriangleMesh triangles(const PolygonMesh& mesh) {
  TriangleMesh out;
  out.positions = mesh.positions;
  out.labels = mesh.labels;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    if (face.size() != 3) throw std::invalid_argument("not a triangle: face " + std::to_string(f));
    out.faces.push_back({face[0], face[1], face[2]});
  }
  return out;
}

PolygonMesh polygons(const TriangleMesh& mesh) {
  PolygonMesh out;
  out.positions = mesh.positions;
  out.labels = mesh.labels;
  for (const Triangle& face : mesh.faces) {
    out.corners.insert(out.corners.end(), face.begin(), face.end());
    out.face_begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
  }
  return out;
}

Surface surface(const PolygonMesh& mesh) {
  Surface out;
  out.positions = mesh.positions.items();
  Box3 box;
  for (const Vec3& p : out.positions) box.add(p);
  if (!box.is_empty()) {
    out.centre = 0.5 * box.min + 0.5 * box.max;
    const Vec3 half = box.max - out.centre;
    out.unit = std::ldexp(1.0, std::ilogb(std::max({half.x, half.y, half.z})) + 1);
  }
  for (const Vec3& p : out.positions) out.local.push_back((1 / out.unit) * (p - out.centre));
  out.face_begin = mesh.face_begin;
  out.corners = mesh.corners;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) out.vertex_source.push_back(VertexId(v));
  for (std::size_t f = 0; f < mesh.face_count(); ++f) out.face_source.push_back(FaceId(f));
  out.face_label.assign(mesh.face_count(), 0);
  return out;
}

}  // namespace remesh::shapes
