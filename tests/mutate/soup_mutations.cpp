#include "tests/mutate/soup_mutations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "tests/mutate/byte_mutations.h"

namespace remesh::mutate {
namespace {

std::size_t below(std::size_t n, Random& random) { return n == 0 ? 0 : static_cast<std::size_t>(random.bits() % n); }
double power_of_ten(int low, int high, Random& random) { return std::pow(10.0, random.integer(low, high)); }
Vec3 random_vector(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; }

/// Returns how many elements to change: one, or a part of all.
std::size_t some_of(std::size_t n, Random& random) {
  if (random.chance(0.5)) return std::min<std::size_t>(n, 1);
  return static_cast<std::size_t>(random.unit() * random.unit() * static_cast<double>(n));
}

Vec3& any_vertex(PolygonSoup& soup, Random& random) { return soup.positions[below(soup.positions.size(), random)]; }
std::vector<std::uint32_t>& any_face(PolygonSoup& soup, Random& random) {
  return soup.faces[below(soup.faces.size(), random)];
}

void add_face(PolygonSoup& soup, std::vector<std::uint32_t> face) {
  soup.faces.push_back(std::move(face));
  if (!soup.groups.empty()) soup.groups.push_back(soup.groups.back());
}

void scale_whole(PolygonSoup& soup, Random& random) {
  const double factor = random.chance(0.2)   ? std::ldexp(1, random.integer(-300, 300))
                        : random.chance(0.5) ? power_of_ten(-12, 12, random)
                                             : random.uniform(0.1, 10);
  for (Vec3& p : soup.positions) p = factor * p;
}

void scale_axis(PolygonSoup& soup, Random& random) {
  const int axis = random.below(3);
  const double factor = random.chance(0.1) ? 0 : power_of_ten(-8, 8, random);
  for (Vec3& p : soup.positions) p[axis] *= factor;
}

void move_far(PolygonSoup& soup, Random& random) {
  const Vec3 by = (box_of(soup).diagonal() * power_of_ten(-1, 8, random)) * random_vector(random);
  for (Vec3& p : soup.positions) p += by;
}

void turn(PolygonSoup& soup, Random& random) {
  const Vec3 axis = normalized(random_vector(random));
  const double angle = random.uniform(0, 2 * std::numbers::pi), c = std::cos(angle), s = std::sin(angle);
  for (Vec3& p : soup.positions) p = c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis;
}

void mirror(PolygonSoup& soup, Random& random) {
  const int axis = random.below(3);
  for (Vec3& p : soup.positions) p[axis] = -p[axis];
}

void move_vertices(PolygonSoup& soup, Random& random) {
  const double step = box_of(soup).diagonal() * power_of_ten(-16, 2, random);
  for (std::size_t i = some_of(soup.positions.size(), random); i-- > 0;)
    any_vertex(soup, random) += step * random_vector(random);
}

void add_noise(PolygonSoup& soup, Random& random) {
  const double step = box_of(soup).diagonal() * power_of_ten(-16, -2, random);
  for (Vec3& p : soup.positions) p += step * random_vector(random);
}

void round_all(PolygonSoup& soup, Random& random) {
  if (random.chance(0.3)) {
    for (Vec3& p : soup.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(static_cast<float>(p[axis]));
    return;
  }
  const double step =
      std::pow(10.0, std::round(std::log10(std::max(box_of(soup).diagonal(), 1e-200)))) * power_of_ten(-9, -1, random);
  for (Vec3& p : soup.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] / step) * step;
}

void snap_vertices(PolygonSoup& soup, Random& random) {
  for (std::size_t i = some_of(soup.positions.size(), random); i-- > 0;) {
    const Vec3 to = any_vertex(soup, random);
    any_vertex(soup, random) = to;
  }
}

void snap_corners(PolygonSoup& soup, Random& random) {
  // This makes an edge short or removes it: the ends of one side of a face coincide, or nearly so.
  for (std::size_t i = some_of(soup.faces.size(), random); i-- > 0;) {
    const auto& face = any_face(soup, random);
    if (face.size() < 2 || face[0] >= soup.positions.size() || face[1] >= soup.positions.size()) continue;
    const double rest = random.chance(0.5) ? 0 : power_of_ten(-12, -1, random);
    Vec3& p = soup.positions[face[0]];
    const Vec3& q = soup.positions[face[1]];
    p = q + rest * (p - q);
  }
}

void copy_coordinate(PolygonSoup& soup, Random& random) {
  const double value = any_vertex(soup, random)[random.below(3)];
  any_vertex(soup, random)[random.below(3)] = value;
}

void odd_coordinate(PolygonSoup& soup, Random& random) {
  constexpr std::array<double, 12> kValues{0,      -0.0, 1e-300, 1e300,  -1e150, 1e39,
                                           3.4e38, 1e22, 1e-30,  5e-324, 1e9,    1e-9};
  any_vertex(soup, random)[random.below(3)] = kValues[below(kValues.size(), random)];
}

void flip_faces(PolygonSoup& soup, Random& random) {
  for (std::size_t i = some_of(soup.faces.size(), random); i-- > 0;) {
    auto& face = any_face(soup, random);
    std::reverse(face.begin(), face.end());
  }
}

void turn_all_over(PolygonSoup& soup, Random&) {
  for (auto& face : soup.faces) std::reverse(face.begin(), face.end());
}

void double_faces(PolygonSoup& soup, Random& random) {
  for (std::size_t i = some_of(soup.faces.size(), random); i-- > 0;) {
    std::vector<std::uint32_t> face = any_face(soup, random);
    if (random.chance(0.5)) std::reverse(face.begin(), face.end());
    add_face(soup, std::move(face));
  }
}

void drop_faces(PolygonSoup& soup, Random& random) {
  for (std::size_t i = some_of(soup.faces.size(), random); i-- > 0 && soup.faces.size() > 1;) {
    const auto f = static_cast<std::ptrdiff_t>(below(soup.faces.size(), random));
    soup.faces.erase(soup.faces.begin() + f);
    if (!soup.groups.empty()) soup.groups.erase(soup.groups.begin() + f);
  }
}

void change_corner(PolygonSoup& soup, Random& random) {
  auto& face = any_face(soup, random);
  if (face.empty()) return;
  face[below(face.size(), random)] =
      static_cast<std::uint32_t>(below(soup.positions.size() + (random.chance(0.05) ? 2 : 0), random));
}

void part_vertices(PolygonSoup& soup, Random& random) {
  // This gives every face its own vertices, which are sometimes slightly displaced.
  const double step = random.chance(0.6) ? 0 : box_of(soup).diagonal() * power_of_ten(-16, -4, random);
  std::vector<Vec3> positions;
  for (auto& face : soup.faces) {
    for (std::uint32_t& v : face) {
      if (v >= soup.positions.size()) continue;
      positions.push_back(soup.positions[v] + step * random_vector(random));
      v = static_cast<std::uint32_t>(positions.size() - 1);
    }
  }
  if (!positions.empty()) soup.positions = std::move(positions);
}

void split_edges(PolygonSoup& soup, Random& random) {
  // This adds a vertex to an edge in one of its faces only, on the edge or slightly beside it.
  for (std::size_t i = some_of(soup.faces.size(), random); i-- > 0;) {
    auto& face = any_face(soup, random);
    if (face.size() < 3 || face[0] >= soup.positions.size() || face[1] >= soup.positions.size()) continue;
    const Vec3 a = soup.positions[face[0]], b = soup.positions[face[1]];
    Vec3 p = a + random.unit() * (b - a);
    if (random.chance(0.3)) p += (norm(b - a) * power_of_ten(-14, -2, random)) * random_vector(random);
    soup.positions.push_back(p);
    face.insert(face.begin() + 1, static_cast<std::uint32_t>(soup.positions.size() - 1));
  }
}

void add_spike(PolygonSoup& soup, Random& random) {
  auto& face = any_face(soup, random);
  if (face.size() < 3 || face[0] >= soup.positions.size() || face[1] >= soup.positions.size()) return;
  const Vec3 a = soup.positions[face[0]], b = soup.positions[face[1]];
  soup.positions.push_back(b + random.uniform(-1, 1) * (b - a) + random.uniform(-1, 1) * random_vector(random));
  const auto tip = static_cast<std::uint32_t>(soup.positions.size() - 1);
  face.insert(face.begin() + 2, {tip, face[1]});
}

void join_faces(PolygonSoup& soup, Random& random) {
  // This merges two triangles that share an edge into a quadrilateral, which may not be plane.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> face_of_edge;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    for (std::size_t k = 0; k < soup.faces[f].size(); ++k)
      face_of_edge[{soup.faces[f][k], soup.faces[f][(k + 1) % soup.faces[f].size()]}] = f;
  std::vector<bool> is_gone(soup.faces.size(), false);
  for (std::size_t i = some_of(soup.faces.size(), random) + 1; i-- > 0;) {
    const std::size_t f = below(soup.faces.size(), random);
    auto& face = soup.faces[f];
    if (is_gone[f] || face.size() != 3) continue;
    const auto other = face_of_edge.find({face[1], face[0]});
    if (other == face_of_edge.end() || is_gone[other->second] || other->second == f) continue;
    const auto& second = soup.faces[other->second];
    if (second.size() != 3) continue;
    const auto apex =
        std::find_if(second.begin(), second.end(), [&](std::uint32_t v) { return v != face[0] && v != face[1]; });
    if (apex == second.end()) continue;
    face.insert(face.begin() + 1, *apex);
    is_gone[other->second] = true;
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    if (is_gone[f]) continue;
    if (!soup.groups.empty()) soup.groups[kept] = soup.groups[f];
    soup.faces[kept++] = std::move(soup.faces[f]);
  }
  soup.faces.resize(kept);
  if (!soup.groups.empty()) soup.groups.resize(kept);
}

void label_faces(PolygonSoup& soup, Random& random) {
  const int labels = random.integer(1, 4);
  soup.groups.resize(soup.faces.size());
  for (std::uint32_t& group : soup.groups) group = static_cast<std::uint32_t>(random.below(labels));
}

void shuffle_faces(PolygonSoup& soup, Random& random) {
  for (std::size_t f = soup.faces.size(); f > 1; --f) std::swap(soup.faces[f - 1], soup.faces[below(f, random)]);
}

void add_copy(PolygonSoup& soup, Random& random) {
  if (soup.faces.size() < 5000) merge_soup(soup, soup, random);
}

using Change = void (*)(PolygonSoup&, Random&);
struct NamedChange {
  std::string_view words;
  Change change;
};

constexpr std::array<NamedChange, 25> kChanges{{{"scaled", scale_whole},
                                                {"an axis scaled", scale_axis},
                                                {"moved far", move_far},
                                                {"moved far", move_far},
                                                {"turned", turn},
                                                {"mirrored", mirror},
                                                {"vertices moved", move_vertices},
                                                {"vertices moved", move_vertices},
                                                {"noise", add_noise},
                                                {"rounded", round_all},
                                                {"vertices snapped", snap_vertices},
                                                {"corners snapped", snap_corners},
                                                {"coordinate copied", copy_coordinate},
                                                {"odd coordinate", odd_coordinate},
                                                {"faces flipped", flip_faces},
                                                {"all turned over", turn_all_over},
                                                {"faces doubled", double_faces},
                                                {"faces dropped", drop_faces},
                                                {"corner changed", change_corner},
                                                {"vertices parted", part_vertices},
                                                {"edges split", split_edges},
                                                {"spike added", add_spike},
                                                {"faces joined", join_faces},
                                                {"faces labelled", label_faces},
                                                {"copy added", add_copy}}};

}  // namespace

Box3 box_of(const PolygonSoup& soup) {
  Box3 box;
  for (const Vec3& p : soup.positions) box.add({p, p});
  return box;
}

void merge_soup(PolygonSoup& soup, PolygonSoup other, Random& random) {
  const Box3 box = box_of(soup), other_box = box_of(other);
  double factor = 1;
  Vec3 by;
  if (random.chance(0.7)) {
    factor =
        box.diagonal() / std::max(other_box.diagonal(), 1e-300) * (random.chance(0.5) ? 1 : random.uniform(0.1, 2));
    by = 0.5 * (box.min + box.max) - (0.5 * factor) * (other_box.min + other_box.max);
  }
  switch (random.below(4)) {
    case 0: break;
    case 1: by += (box.diagonal() * power_of_ten(-12, 0, random)) * random_vector(random); break;
    case 2: by[random.below(3)] += box.diagonal(); break;
    default: {  // two corners touch
      if (other.positions.empty() || soup.positions.empty()) break;
      by = any_vertex(soup, random) - factor * any_vertex(other, random);
    }
  }
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  for (const Vec3& p : other.positions) soup.positions.push_back(factor * p + by);
  const bool are_labelled = !soup.groups.empty() || !other.groups.empty() || random.chance(0.2);
  if (are_labelled) {
    soup.groups.resize(soup.faces.size());
    other.groups.resize(other.faces.size());
    for (const std::uint32_t group : other.groups) soup.groups.push_back(group + 7);
  }
  for (auto& face : other.faces) {
    for (std::uint32_t& v : face) v += first;
    soup.faces.push_back(std::move(face));
  }
}

std::string mutate_soup(PolygonSoup& soup, Random& random) {
  if (soup.positions.empty() || soup.faces.empty()) return "nothing";
  if (random.chance(0.05)) {
    shuffle_faces(soup, random);
    return "shuffled";
  }
  const NamedChange& change = kChanges[below(kChanges.size(), random)];
  change.change(soup, random);
  return std::string(change.words);
}

}  // namespace remesh::mutate
