#include "tests/mutate/hostile_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "api/quoting.h"
#include "core/base/number_text.h"
#include "tests/mutate/polygon_soup.h"
#include "tests/support/hostile.h"
#include "tests/support/hostile_families.h"
#include "tests/support/hostile_solids.h"

namespace remesh::mutate {
namespace {

using Index = std::uint32_t;

/// A mesh, and options that go with it.
struct Hostile {
  PolygonSoup soup;
  OptionTexts options;
};

Vec3 random_point(Random& random) { return {random.unit(), random.unit(), random.unit()}; }

Index add(PolygonSoup& soup, const Vec3& p) {
  soup.positions.push_back(p);
  return static_cast<Index>(soup.positions.size() - 1);
}

void add_triangle(PolygonSoup& soup, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Index first = add(soup, a);
  add(soup, b);
  add(soup, c);
  soup.faces.push_back({first, first + 1, first + 2});
}

void add_box(PolygonSoup& soup, const Vec3& at, const Vec3& size) {
  const auto first = static_cast<Index>(soup.positions.size());
  for (int corner = 0; corner < 8; ++corner)
    add(soup, at + Vec3{corner & 1 ? size.x : 0, corner & 2 ? size.y : 0, corner & 4 ? size.z : 0});
  constexpr std::array<std::array<Index, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& s : kSides) {
    soup.faces.push_back({first + s[0], first + s[1], first + s[2]});
    soup.faces.push_back({first + s[0], first + s[2], first + s[3]});
  }
}

/// Makes a grid of n x n squares over the unit square, of triangles or quadrilaterals. `height` gives the height of
/// each vertex.
template <class Height>
PolygonSoup grid(int n, bool is_of_quads, const Height& height) {
  PolygonSoup soup;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) add(soup, {double(i) / n, double(j) / n, height(i, j)});
  const auto at = [n](int i, int j) { return static_cast<Index>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Index a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (is_of_quads) {
        soup.faces.push_back({a, b, c, d});
      } else {
        soup.faces.push_back({a, b, c});
        soup.faces.push_back({a, c, d});
      }
    }
  }
  return soup;
}

int side_of(double faces) { return std::max(2, static_cast<int>(std::sqrt(faces / 2))); }

/// Makes triangles around one vertex in no order, so that no fan connects them.
Hostile pinched_vertex(double size, Random& random) {
  Hostile made;
  const int n = std::max(3, static_cast<int>(200'000 * size));
  const Index centre = add(made.soup, {});
  for (int i = 0; i < n; ++i) {
    const Vec3 p = random_point(random) - Vec3{0.5, 0.5, 0.5};
    const Index a = add(made.soup, p);
    const Index b = add(made.soup, p + 0.01 * random_point(random));
    made.soup.faces.push_back({centre, a, b});
  }
  return made;
}

/// Makes triangles that all pass through one small ball, so that every pair is near.
Hostile crossing_star(double size, Random& random) {
  Hostile made;
  for (int i = std::max(2, static_cast<int>(3000 * size)); i-- > 0;) {
    const Vec3 p = random_point(random) - Vec3{0.5, 0.5, 0.5};
    add_triangle(made.soup, p, -p, random_point(random) - Vec3{0.5, 0.5, 0.5});
  }
  return made;
}

Hostile noisy_grid(double size, Random& random) {
  const double noise = std::pow(10.0, random.integer(-9, -2));
  return {grid(side_of(600'000 * size), random.chance(0.3), [&](int, int) { return noise * random.unit(); }), {}};
}

Hostile plane_grid(double size, Random& random) {
  return {grid(side_of(1'000'000 * size), random.chance(0.3), [](int, int) { return 0.0; }),
          {{"refine", random.chance(0.7) ? "false" : "true"}}};
}

Hostile many_boxes(double size, Random& random) {
  Hostile made;
  const int n = std::max(2, static_cast<int>(37 * std::cbrt(size)));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) add_box(made.soup, {double(i), double(j), double(k)}, 0.4 * random_point(random));
  if (random.chance(0.3)) made.options.emplace_back("proximity", "1");
  return made;
}

/// Makes boxes within boxes. Each of them encloses all smaller ones.
Hostile nested_boxes(double size, Random& random) {
  Hostile made;
  const int n = std::max(2, static_cast<int>(10'000 * size));
  for (int i = 0; i < n; ++i) {
    const double half = 1 + double(i) / n;
    add_box(made.soup, {-half, -half, -half}, {2 * half, 2 * half, 2 * half});
  }
  made.options.emplace_back("refine", random.chance(0.5) ? "false" : "true");
  return made;
}

Hostile fine_plate(double size, Random& random) {
  Hostile made;
  add_box(made.soup, {}, {1, 1, 0.01});
  const double edge = 0.002 / std::sqrt(size);
  if (random.chance(0.5))
    made.options.emplace_back("max_edge_length", shortest_text(edge));
  else
    made.options.emplace_back("max_area", shortest_text(edge * edge / 2));
  if (random.chance(0.3)) made.options.emplace_back("min_angle_deg", "33");
  return made;
}

/// Makes a plate with many small holes, which are as far apart as they are wide.
Hostile perforated_plate(double size, Random& random) {
  const int n = std::max(3, static_cast<int>(500 * std::sqrt(size))) | 1;
  Hostile made{grid(n, true, [](int, int) { return 0.0; }), {}};
  std::vector<std::vector<Index>> kept;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      if (i % 2 == 0 || j % 2 == 0) kept.push_back(made.soup.faces[static_cast<std::size_t>(j * n + i)]);
  made.soup.faces = std::move(kept);
  if (random.chance(0.3)) made.options.emplace_back("proximity", "1");
  return made;
}

/// Makes two rough sheets, one slightly above the other, so that there are gaps everywhere.
Hostile thin_gap(double size, Random& random) {
  const int n = side_of(20'000 * size);
  Hostile made{grid(n, false, [&](int, int) { return 0.002 * random.unit(); }), {}};
  const PolygonSoup above = grid(n, false, [&](int, int) { return 0.01 + 0.002 * random.unit(); });
  const auto first = static_cast<Index>(made.soup.positions.size());
  made.soup.positions.insert(made.soup.positions.end(), above.positions.begin(), above.positions.end());
  for (const auto& face : above.faces) made.soup.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
  made.options.emplace_back("proximity", random.chance(0.5) ? "1" : "0.3");
  return made;
}

/// Makes vertices that weld in clusters and chains.
Hostile near_vertices(double size, Random& random) {
  Hostile made;
  for (int i = std::max(2, static_cast<int>(200'000 * size)); i-- > 0;)
    add_triangle(made.soup, random_point(random), random_point(random), random_point(random));
  for (Vec3& p : made.soup.positions) p.z *= 0.001;
  made.options.emplace_back("weld_tolerance", random.chance(0.5) ? "0.001" : "0.02");
  return made;
}

/// Makes a closed noisy ball of longitudes and latitudes. Every facet is a plane, and there are needles at its poles.
Hostile rough_ball(double size, Random& random) {
  Hostile made;
  const int n = std::max(4, static_cast<int>(500 * std::sqrt(size)));
  const Index south = add(made.soup, {0, 0, -1}), north = add(made.soup, {0, 0, 1});
  const auto at = [&](int i, int j) { return static_cast<Index>(2 + (j - 1) * n + i % n); };
  for (int j = 1; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n, b = std::numbers::pi * (double(j) / n - 0.5);
      const double r = 1 + 0.001 * random.unit();
      add(made.soup, {r * std::cos(a) * std::cos(b), r * std::sin(a) * std::cos(b), r * std::sin(b)});
    }
  }
  for (int i = 0; i < n; ++i) {
    made.soup.faces.push_back({south, at(i + 1, 1), at(i, 1)});
    made.soup.faces.push_back({north, at(i, n - 1), at(i + 1, n - 1)});
    for (int j = 1; j + 1 < n; ++j) {
      made.soup.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      made.soup.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return made;
}

/// Makes a surface of tests/support/hostile.h with a part of so many faces.
template <auto kMake, int kFaces>
Hostile of_size(double size, Random&) {
  return {soup_of(kMake(std::max<std::size_t>(10, static_cast<std::size_t>(kFaces * size)))), {}};
}

Hostile crossing_soup(double size, Random& random) {
  const auto count = std::max<std::size_t>(2, static_cast<std::size_t>(30'000 * size));
  return {soup_of(hostile::soup(count, static_cast<unsigned>(random.below(1000)))), {}};
}

/// Makes a member of a family that grows without end (tests/support/hostile_families.h).
Hostile of_a_family(double size, Random& random) {
  const auto families = hostile::families();
  const hostile::Family& family = families[static_cast<std::size_t>(random.below(static_cast<int>(families.size())))];
  return {soup_of(family.make(std::max<std::size_t>(10, static_cast<std::size_t>(200'000 * size)))), {}};
}

/// Makes a member of a family of solids and sheets that meet, which are to be cut or united.
template <const char* kRepair>
Hostile that_meet(double size, Random& random) {
  const auto families = hostile::meeting_families();
  const hostile::Family& family = families[static_cast<std::size_t>(random.below(static_cast<int>(families.size())))];
  return {soup_of(family.make(std::max<std::size_t>(10, static_cast<std::size_t>(200'000 * size)))),
          {{"repair", kRepair}}};
}
constexpr char kCut[] = "+self_intersections", kUnite[] = "+union";

struct Kind {
  std::string_view name;
  Hostile (*make)(double size, Random& random);
};

constexpr std::array<Kind, 25> kKinds{{{"many components", of_size<hostile::components, 250'000>},
                                       {"cone", of_size<hostile::cone, 300'000>},
                                       {"pinched vertex", pinched_vertex},
                                       {"crossing soup", crossing_soup},
                                       {"crossing star", crossing_star},
                                       {"noisy grid", noisy_grid},
                                       {"plane grid", plane_grid},
                                       {"many boxes", many_boxes},
                                       {"nested boxes", nested_boxes},
                                       {"fine plate", fine_plate},
                                       {"perforated plate", perforated_plate},
                                       {"thin gap", thin_gap},
                                       {"large polygon", of_size<hostile::polygon, 200'000>},
                                       {"vertices on an edge", of_size<hostile::torn_edge, 100'000>},
                                       {"line of nothing", of_size<hostile::flat_fan, 300'000>},
                                       {"near vertices", near_vertices},
                                       {"repeated faces", of_size<hostile::repeated, 500'000>},
                                       {"book", of_size<hostile::double_book, 100'000>},
                                       {"rough ball", rough_ball},
                                       {"plane grid", plane_grid},
                                       {"member of a family", of_a_family},
                                       {"member of a family", of_a_family},
                                       {"member of a family", of_a_family},
                                       {"solids to cut", that_meet<kCut>},
                                       {"solids to unite", that_meet<kUnite>}}};

}  // namespace

Case make_hostile_case(double size, std::string_view word, Random& random) {
  std::vector<const Kind*> kinds;
  for (const Kind& kind : kKinds)
    if (kind.name.find(word) != std::string_view::npos) kinds.push_back(&kind);
  if (kinds.empty()) throw std::invalid_argument("no kind of mesh has this word in its name: " + std::string(word));
  const Kind& kind = *kinds[static_cast<std::size_t>(random.below(static_cast<int>(kinds.size())))];
  const double part = size * std::pow(10.0, random.uniform(-1, 0));
  Hostile made = kind.make(part, random);
  auto format = static_cast<SoupFormat>(random.below(kSoupFormatCount));
  const bool has_polygons =
      std::any_of(made.soup.faces.begin(), made.soup.faces.end(), [](const auto& f) { return f.size() > 255; });
  if (has_polygons && format != SoupFormat::kOff && format != SoupFormat::kJson) format = SoupFormat::kObj;
  Case c;
  c.origin = std::string(kind.name) + ", " + std::to_string(made.soup.faces.size()) + " faces";
  c.bytes = write_soup(made.soup, format);
  c.format = format_of(format);
  c.options = std::move(made.options);
  for (const auto& drawn : draw_options(random, 1)) {
    const auto& name = drawn.first;
    const api::OptionSpec* spec = api::find_option(name);
    const bool is_taken = std::any_of(c.options.begin(), c.options.end(), [&](const auto& given) {
      const api::OptionSpec* other = api::find_option(given.first);
      return given.first == name || given.first == spec->excludes || (other != nullptr && other->excludes == name);
    });
    if (!is_taken) c.options.push_back(drawn);
  }
  c.workers = random.chance(0.3) ? 2 : 1;
  return c;
}

}  // namespace remesh::mutate
