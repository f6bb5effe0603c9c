#include "tests/recognition/drawn_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tests/recognition/drawn_body.h"
#include "tests/support/claims.h"
#include "tests/support/polygons.h"

namespace remesh::recognition {
namespace {

constexpr double kPi = std::numbers::pi;

/// Draws a number evenly in its logarithm.
double log_uniform(Random& random, double low, double high) {
  return low * std::exp(random.unit() * std::log(high / low));
}
int drawn_facets(Random& random, int low, int high) {
  return static_cast<int>(std::lround(log_uniform(random, low, high)));
}
int rows_of(int n, double angle) {
  return std::max(2, static_cast<int>(std::lround(n * std::fabs(angle) / (2 * kPi))));
}

double with_digits(double x, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return std::strtod(text, nullptr);
}
double with_decimals(double x, int decimals) {
  char text[60];
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  return std::strtod(text, nullptr);
}

/// Tells where a solid lies.
struct Pose {
  std::function<Vec3(const Vec3&)> turned;
  Vec3 by;
};
Pose drawn_pose(Random& random, bool is_turned, double offset) {
  const polygons::Placement frame = polygons::random_placement(random.bits(), 1);
  const Vec3 z = cross(frame.x_axis, frame.y_axis);
  const auto turned = [=](const Vec3& p) { return is_turned ? p.x * frame.x_axis + p.y * frame.y_axis + p.z * z : p; };
  const auto shift = [&] { return random.uniform(-offset, offset); };
  return {turned, {shift(), shift(), shift()}};
}

/// How the numbers of a solid are written.
struct Rounding {
  std::string name;
  std::function<double(double)> round;
  double step = 0;
};
Rounding drawn_rounding(Random& random, double largest) {
  const int draw = random.below(8);
  if (draw < 4) {
    const int decimals = 3 + draw;
    return {std::to_string(decimals) + " decimals", [=](double x) { return with_decimals(x, decimals); },
            std::pow(10, -decimals)};
  }
  if (draw < 6) {
    const int digits = 2 + draw;
    return {std::to_string(digits) + " digits", [=](double x) { return with_digits(x, digits); },
            std::pow(10, std::floor(std::log10(largest)) + 1 - digits)};
  }
  if (draw == 6)
    return {"floats", [](double x) { return static_cast<double>(static_cast<float>(x)); },
            std::ldexp(1, std::ilogb(largest) - 23)};
  return {"doubles", [](double x) { return x; }, 1e-12 * largest};
}

/// An outline with round corners, counter-clockwise.
struct OutlineArc {
  Vec2 centre;
  double radius = 0;
  double from = 0, to = 0;  ///< angles; it turns to the right if `to` is smaller
  int facets = 0;           ///< 0: a sharp corner at the centre
};

/// Adds the walls of a prism and returns its rings at the bottom and the top.
std::pair<VertexRing, VertexRing> add_walls(DrawnBody& body, const std::vector<OutlineArc>& arcs, double height,
                                            const std::string& name) {
  VertexRing low, high;
  std::vector<std::uint32_t> wall;  // by side, which begins at the vertex of the same number
  std::vector<double> angle;
  std::vector<const OutlineArc*> arc_of;
  std::vector<Vec2> outline;
  for (const OutlineArc& arc : arcs) {
    const std::uint32_t s =
        arc.facets == 0
            ? 0
            : body.surface({SurfaceKind::kCylinder, {arc.centre.x, arc.centre.y, 0}, {0, 0, 1}, arc.radius, 0, 0, {}},
                           name, arc.radius * (1 - std::cos((arc.to - arc.from) / arc.facets / 2)));
    for (int i = 0; i <= arc.facets; ++i) {
      const double at = arc.facets == 0 ? 0 : arc.from + (arc.to - arc.from) * i / arc.facets;
      outline.push_back(arc.centre + arc.radius * Vec2{std::cos(at), std::sin(at)});
      wall.push_back(i < arc.facets ? s : kNone);
      arc_of.push_back(&arc);
      angle.push_back(at + (arc.facets == 0 ? 0 : (arc.to - arc.from) / arc.facets / 2));
    }
  }
  for (const Vec2 p : outline) {
    low.push_back(body.vertex({p.x, p.y, 0}));
    high.push_back(body.vertex({p.x, p.y, height}));
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t j = (i + 1) % outline.size();
    std::vector<Vec3> points;
    std::uint32_t s = wall[i];
    if (s == kNone) {
      const Vec2 d = outline[j] - outline[i];
      s = body.surface({SurfaceKind::kPlane, {outline[i].x, outline[i].y, 0}, normalized({d.y, -d.x, 0}), 0, 0, 0, {}},
                       "plane");
    } else {
      const Vec2 p = arc_of[i]->centre + arc_of[i]->radius * Vec2{std::cos(angle[i]), std::sin(angle[i])};
      points = {{p.x, p.y, height / 2}, {p.x, p.y, 0}, {p.x, p.y, height}};
    }
    body.triangle(low[i], low[j], high[j], s, points);
    body.triangle(low[i], high[j], high[i], s, points);
  }
  return {low, high};
}

std::vector<OutlineArc> rectangle(double width, double depth, double radius, int facets) {
  std::vector<OutlineArc> arcs;
  for (int k = 0; k < 4; ++k) {
    const double x = k == 0 || k == 3 ? width / 2 - radius : radius - width / 2;
    const double y = k < 2 ? depth / 2 - radius : radius - depth / 2;
    arcs.push_back({{x, y}, radius, k * kPi / 2, (k + 1) * kPi / 2, facets});
  }
  return arcs;
}

/// The features stand on a plate or are cut into it.
enum class Feature {
  kBore,
  kFilletedBore,
  kCountersunk,
  kBlindHole,
  kPin,
  kTaperedBoss,
  kTaperedBore,
  kDome,
  kBall,
  kOgive,
  kRoundEnd,
  kFilletedBoss,
  kEllipse,
  kSpline,
  kCount
};

/// A feature of a radius at most `r` on a plate of a height.
struct DrawnFeature {
  std::string part;
  std::vector<ProfilePiece> profile;
  Section section;
  bool is_through = false;
};

/// Returns a section that is not a circle.
Section drawn_section(Random& random, bool is_ellipse) {
  const double first = random.uniform(0, 2 * kPi);
  if (is_ellipse)
    return [=](double a) {
      const double x = 1.01 * std::cos(a), y = std::sin(a) / 1.01;
      return Vec2{x * std::cos(first) - y * std::sin(first), x * std::sin(first) + y * std::cos(first)};
    };
  const double third = random.uniform(0.003, 0.02), fifth = random.uniform(0, 0.01);
  return [=](double a) {
    const double r = 1 + third * std::cos(3 * a + first) + fifth * std::cos(5 * a);
    return Vec2{r * std::cos(a), r * std::sin(a)};
  };
}

DrawnFeature drawn_feature(Random& random, Feature feature, double r, double h, int n) {
  DrawnFeature f;
  const double up = h + random.uniform(0.5, 2.5) * r;
  const double draft = (up - h) * std::tan(0.5 * kPi / 180);
  switch (feature) {
    case Feature::kBore: return {"bore", {line_piece({r, h}, {r, 0}, "bore", random.integer(1, 2))}, {}, true};
    case Feature::kFilletedBore: {
      const double a = random.uniform(0.2, 0.5) * std::min(r, h);
      return {"filleted bore",
              {arc_piece({r, h - a}, a, kPi / 2, kPi, rows_of(n, kPi / 2), "fillet"),
               line_piece({r - a, h - a}, {r - a, 0}, "bore")},
              {},
              true};
    }
    case Feature::kCountersunk: {
      const double a = random.uniform(0.2, 0.5) * std::min(r, h);
      return {"countersunk bore",
              {line_piece({r, h}, {r - a, h - random.uniform(0.5, 1.5) * a}, "countersink"), {}},
              {},
              true};
    }
    case Feature::kBlindHole: {
      const double depth = h - random.uniform(0.3, 0.7) * h;
      return {"blind hole",
              {line_piece({r, h}, {r, depth}, "bore"), line_piece({r, depth}, {0, depth}, "plane")},
              {},
              false};
    }
    case Feature::kPin:
      return {"pin", {line_piece({r, h}, {r, up}, "pin"), line_piece({r, up}, {0, up}, "plane")}, {}, false};
    case Feature::kTaperedBoss:
      return {"tapered boss",
              {line_piece({r, h}, {r - draft, up}, "tapered boss"), line_piece({r - draft, up}, {0, up}, "plane")},
              {},
              false};
    case Feature::kTaperedBore:
      return {"tapered bore", {line_piece({r, h}, {r - h * std::tan(0.5 * kPi / 180), 0}, "tapered bore")}, {}, true};
    case Feature::kDome: {
      const double ball = random.uniform(1.02, 2.5) * r;
      const double below = std::sqrt(ball * ball - r * r);
      const double from = std::atan2(below, r);
      return {"dome", {arc_piece({0, h - below}, ball, from, kPi / 2, rows_of(n, kPi / 2 - from), "dome")}, {}, false};
    }
    case Feature::kBall:
      return {"pin with a ball",
              {line_piece({r, h}, {r, up}, "pin"), arc_piece({0, up}, r, 0, kPi / 2, rows_of(n, kPi / 2), "ball")},
              {},
              false};
    case Feature::kOgive: {
      const double beyond = random.uniform(0.3, 3) * r;
      const double to = std::acos(beyond / (r + beyond));
      return {
          "ogive",
          {line_piece({r, h}, {r, up}, "pin"), arc_piece({-beyond, up}, r + beyond, 0, to, rows_of(n, to), "ogive")},
          {},
          false};
    }
    case Feature::kRoundEnd: {
      const double a = random.uniform(0.25, 0.9) * r;
      return {
          "round end",
          {line_piece({r, h}, {r, up}, "pin"), arc_piece({r - a, up}, a, 0, kPi / 2, rows_of(n, kPi / 2), "round end"),
           line_piece({r - a, up + a}, {0, up + a}, "plane")},
          {},
          false};
    }
    case Feature::kFilletedBoss: {
      const double a = random.uniform(0.2, 0.45) * r;
      return {"filleted boss",
              {arc_piece({r, h + a}, a, 1.5 * kPi, kPi, rows_of(n, kPi / 2), "fillet"),
               line_piece({r - a, h + a}, {r - a, up + a}, "pin"), line_piece({r - a, up + a}, {0, up + a}, "plane")},
              {},
              false};
    }
    case Feature::kEllipse:
    case Feature::kSpline: {
      const bool is_ellipse = feature == Feature::kEllipse;
      const std::string name = is_ellipse ? "ellipse" : "nearly round";
      return {name, {line_piece({r, h}, {r, 0}, name)}, drawn_section(random, is_ellipse), true};
    }
    default: throw std::logic_error("no such feature");
  }
}

/// Makes a plate with round or sharp corners, on or in which are up to four features.
std::string add_plate(DrawnBody& body, Random& random, int most_facets) {
  const double cell = random.uniform(8, 20);
  const double height = random.uniform(3, 12);
  const int columns = random.integer(1, 2), rows = random.integer(1, 2);
  const double radius = random.chance(0.5) ? random.uniform(0.1, 0.24) * cell : 0;
  const int facets = radius == 0 ? 0 : std::max(2, drawn_facets(random, 7, most_facets) / 4);
  const auto [low, high] =
      add_walls(body, rectangle(cell * columns, cell * rows, radius, facets), height, "round corner");
  std::vector<VertexRing> above, below;
  std::string part;
  for (int x = 0; x < columns; ++x)
    for (int y = 0; y < rows; ++y) {
      const Vec2 centre{cell * (x - 0.5 * (columns - 1)), cell * (y - 0.5 * (rows - 1))};
      const auto kind = static_cast<Feature>(random.below(static_cast<int>(Feature::kCount)));
      const int n = drawn_facets(random, 7, most_facets);
      const double r = random.uniform(0.08, 0.3) * cell;
      DrawnFeature f = drawn_feature(random, kind, r, height, n);
      if (kind == Feature::kCountersunk) {
        const Vec2 end = f.profile[0].at(1);
        if (end.y <= 0.05 * height) continue;
        f.profile[1] = line_piece(end, {end.x, 0}, "bore");
      }
      const auto [first, last] = body.turn(n, f.profile, centre, f.section);
      above.push_back(first);
      if (f.is_through) below.push_back(last);
      part = columns * rows == 1 ? f.part : "plate of many";
    }
  body.plane(high, above, true);
  body.plane(VertexRing(low.begin(), low.end()), below, false);
  return part.empty() ? "plate" : part;
}

/// Makes a body of revolution: a shaft with steps, a tube, or a ring.
std::string add_turned(DrawnBody& body, Random& random, int most_facets) {
  const int n = drawn_facets(random, 7, most_facets);
  const double r = log_uniform(random, 2, 12), length = random.uniform(0.5, 4) * r;
  std::vector<ProfilePiece> profile;
  switch (random.below(4)) {
    case 0: {
      const double a = r * random.uniform(0.15, 0.9);
      const int m = std::max(5, drawn_facets(random, 7, std::min(most_facets, 4000 / n)));
      body.turn(n, {arc_piece({r, 0}, a, 0, 2 * kPi, m, "whole torus")}, {}, {}, true);
      return "whole torus";
    }
    case 1: {
      const double a = r * random.uniform(0.15, 0.8);
      profile = {line_piece({0, 0}, {r, 0}, "plane"), line_piece({r, 0}, {r, length}, "shaft", random.integer(1, 3)),
                 arc_piece({r - a, length}, a, 0, kPi / 2, rows_of(n, kPi / 2), "round end"),
                 line_piece({r - a, length + a}, {0, length + a}, "plane")};
      body.turn(n, profile);
      return "round shaft";
    }
    case 2: {
      const double a = r * random.uniform(0.1, 0.6), small = r * random.uniform(0.4, 0.7);
      profile = {line_piece({0, 0}, {r, 0}, "plane"),
                 line_piece({r, 0}, {r, length}, "shaft"),
                 line_piece({r, length}, {small + a * small / r, length}, "plane"),
                 arc_piece({small + a * small / r, length + a * small / r}, a * small / r, 1.5 * kPi, kPi,
                           rows_of(n, kPi / 2), "fillet"),
                 line_piece({small, length + a * small / r}, {small, 2 * length + a}, "shaft"),
                 line_piece({small, 2 * length + a}, {0.8 * small, 2 * length + a + 0.2 * small}, "chamfer"),
                 line_piece({0.8 * small, 2 * length + a + 0.2 * small}, {0, 2 * length + a + 0.2 * small}, "plane")};
      if (small + a * small / r >= 0.98 * r) profile.erase(profile.begin() + 2, profile.begin() + 4);
      if (profile.size() == 5)
        profile = {line_piece({0, 0}, {r, 0}, "plane"), line_piece({r, 0}, {0.6 * r, length}, "cone"),
                   line_piece({0.6 * r, length}, {0, length}, "plane")};
      body.turn(n, profile);
      return "stepped shaft";
    }
    default: {
      const double wall = r * random.uniform(0.1, 0.4);
      profile = {line_piece({r - wall, 0}, {r, 0}, "plane"), line_piece({r, 0}, {r, length}, "shaft"),
                 line_piece({r, length}, {r - wall, length}, "plane"),
                 line_piece({r - wall, length}, {r - wall, 0}, "bore")};
      body.turn(n, profile, {}, {}, true);
      return "tube";
    }
  }
}

/// Makes a hose along a sine, an elbow, or a loft from a circle to a rounded square.
std::string add_swept(DrawnBody& body, Random& random, int most_facets) {
  const int kind = random.below(3);
  // An elbow whose tube has fewer facets is a stack of cones.
  const int n = drawn_facets(random, kind == 1 ? 13 : 7, std::clamp(most_facets, 14, 60));
  const double r = log_uniform(random, 0.5, 4);
  std::function<Vec3(double, double)> at;
  int count = 0;
  std::uint32_t s = 0;
  std::string part;
  const double first = random.uniform(0, 1);
  const auto around = [n, first](double i) { return 2 * kPi * (i + first) / n; };
  const bool is_coarse = 2 * kPi / n > kFeatureTurn;
  if (kind == 0) {
    part = "hose";
    count = random.integer(8, 48);
    const double length = random.uniform(12, 25) * r, wave = random.uniform(0.03, 0.12) * length;
    const double periods = random.uniform(0.5, 1.5), last = count - 1;
    at = [=](double i, double k) {
      const double t = k / last, a = 2 * kPi * periods * t;
      const Vec3 along = normalized({0, wave * 2 * kPi * periods * std::cos(a), length});
      const Vec3 up{1, 0, 0}, side = cross(along, up);
      return Vec3{0, wave * std::sin(a), length * t} + r * std::cos(around(i)) * up + r * std::sin(around(i)) * side;
    };
    s = body.surface({}, is_coarse ? coarse_name(part) : part, r * (1 - std::cos(kPi / n)));
  } else if (kind == 1) {
    part = "elbow";
    const double ring = random.uniform(1.3, 5) * r, sweep = random.uniform(30, 300) * kPi / 180;
    count = 2 + static_cast<int>(drawn_facets(random, 13, std::max(14, most_facets)) * sweep / (2 * kPi));
    count = std::min(count, std::max(14, 5000 / n));
    const double last = count - 1;
    at = [=](double i, double k) {
      const double a = sweep * k / last, d = ring + r * std::cos(around(i));
      return Vec3{d * std::cos(a), d * std::sin(a), -r * std::sin(around(i))};
    };
    s = body.surface({SurfaceKind::kTorus, {}, {0, 0, 1}, ring, r, 0, {}}, part,
                     r * (1 - std::cos(kPi / n)) + (ring + r) * (1 - std::cos(sweep / last / 2)));
  } else {
    part = "loft";
    count = random.integer(2, 12);
    const double length = random.uniform(2, 6) * r, bump = random.uniform(0.02, 0.12), last = count - 1;
    at = [=](double i, double k) {
      const double t = k / last, d = r * (1 + t * bump * std::cos(4 * around(i)) + 0.1 * t * t);
      return Vec3{d * std::cos(around(i)), d * std::sin(around(i)), length * t};
    };
    s = body.surface({}, is_coarse ? coarse_name(part) : part, r * (1 - std::cos(kPi / n)));
  }
  // Facets that turn by more than the feature angle meet in edges, so the true surface runs straight between these.
  const auto between_edges = [&](double i, double k) {
    const double low = std::floor(i), part = i - low;
    return part == 0 ? at(i, k) : (1 - part) * at(low, k) + part * at(low + 1, k);
  };
  const auto [low, high] = body.sweep(n, count, is_coarse ? std::function<Vec3(double, double)>(between_edges) : at, s);
  if (kind == 2) {
    body.plane(low, {}, false);
    body.plane(high, {}, true);
  } else {
    body.cap(VertexRing(low.rbegin(), low.rend()));
    body.cap(high);
  }
  return part;
}

std::string add_solid(DrawnBody& body, Random& random, int most_facets) {
  const int draw = random.below(10);
  return draw < 6   ? add_plate(body, random, most_facets)
         : draw < 8 ? add_turned(body, random, most_facets)
                    : add_swept(body, random, most_facets);
}

double shortest_edge_of(const PolygonMesh& mesh) {
  double shortest = HUGE_VAL;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(FaceId(f));
    for (std::size_t i = 0; i < corners.size(); ++i)
      shortest =
          std::min(shortest, norm(mesh.positions[corners[i]] - mesh.positions[corners[(i + 1) % corners.size()]]));
  }
  return shortest;
}

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number) { return (seed << 32) ^ (number * 2 + 1); }

}  // namespace

DrawnSolid drawn_solid(std::uint64_t seed, std::uint64_t number) {
  constexpr double kShortestSteps = 20;
  Random random(seed_of(seed, number));
  // If rounding would leave little of the facets, the next draw has fewer of them.
  for (int most_facets = 200;; most_facets = std::max(10, most_facets * 2 / 3)) {
    const bool is_sloppy = random.chance(0.15);
    DrawnBody body(random, is_sloppy);
    const std::string part = add_solid(body, random, most_facets);
    const bool is_far = random.chance(0.25);
    const Pose pose = drawn_pose(random, random.chance(0.6), is_far ? log_uniform(random, 100, 5000) : 5);
    const double largest = 60 + std::max({std::fabs(pose.by.x), std::fabs(pose.by.y), std::fabs(pose.by.z)});
    const Rounding rounding = drawn_rounding(random, largest);
    DrawnSolid solid = body.take(part, pose.turned, pose.by, rounding.round);
    solid.step = rounding.step;
    solid.rounding = rounding.name + (is_far ? ", far" : "") + (is_sloppy ? ", sloppy" : "");
    if (shortest_edge_of(solid.model.mesh) >= kShortestSteps * rounding.step) return solid;
  }
}

DrawnSolid drawn_bore(std::uint64_t seed, std::uint64_t number) {
  constexpr double kLowestSteps = 4;
  Random random(seed_of(seed ^ 0x62, number));
  while (true) {
    const int decimals = random.integer(3, 5);
    const double step = std::pow(10, -decimals);
    // Rounding to a step of 4e-5 moves a coordinate by up to 2e-5.
    const double step_part = log_uniform(random, 1e-6, 4e-5);
    const double diagonal = step / step_part;
    // People draw plates in whole numbers at the origin, and programs put them anywhere.
    const bool is_plain = random.chance(0.4);
    const double thick = random.uniform(0.1, 0.5);
    const double any_width = diagonal / std::sqrt(2 + thick * thick);
    const double width = is_plain ? 100 * step * std::ceil(any_width / (100 * step)) : any_width;
    DrawnBody body(random, false);
    const int kind = random.below(3);
    const int n = drawn_facets(random, kind == 0 ? 6 : 24, 200);
    const int facets = kind == 0 ? n : n / 4;
    const double any_r = random.uniform(0.03, 0.42) * width, any_h = thick * width;
    const double h = is_plain ? 100 * step * std::ceil(any_h / (100 * step)) : any_h;
    const double r = is_plain && random.chance(0.5) ? 100 * step * std::ceil(any_r / (100 * step)) : any_r;
    const double chord = r * (1 - std::cos(kPi / (kind == 0 ? n : 4 * facets)));
    if (facets < 6 || chord < kLowestSteps * step) continue;
    std::string part;
    if (kind == 0) {
      part = "bore";
      const auto [low, high] = add_walls(body, rectangle(width, width, 0, 0), h, part);
      const auto [first, last] = body.turn(n, {line_piece({r, h}, {r, 0}, part)});
      body.plane(high, {first}, true);
      body.plane(low, {last}, false);
    } else {
      part = kind == 1 ? "round corner" : "fillet";
      std::vector<OutlineArc> outline = rectangle(width, width, 0, 0);
      if (kind == 1) {
        outline[0] = {{width / 2 - r, width / 2 - r}, r, 0, kPi / 2, facets};
      } else {
        const double a = random.uniform(0.1, 0.5) * (width - r) - width / 2;
        const OutlineArc arc{{a + r, a + r}, r, 1.5 * kPi, kPi, facets};
        outline = {{{width / 2, -width / 2}}, {{width / 2, a}},          arc,
                   {{a, width / 2}},          {{-width / 2, width / 2}}, {{-width / 2, -width / 2}}};
      }
      const auto [low, high] = add_walls(body, outline, h, part);
      body.plane(high, {}, true);
      body.plane(low, {}, false);
    }
    Pose pose = drawn_pose(random, !is_plain && random.chance(0.7), is_plain ? 0 : 0.1 * width);
    if (is_plain && random.chance(0.5)) pose.by = {width / 2, width / 2, 0};
    DrawnSolid solid = body.take(part, pose.turned, pose.by, [=](double x) { return with_decimals(x, decimals); });
    solid.step = step;
    const char* const size = step_part <= 5e-6   ? "5e-6"
                             : step_part <= 1e-5 ? "1e-5"
                             : step_part <= 2e-5 ? "2e-5"
                                                 : "4e-5";
    solid.rounding = std::string("steps to ") + size + (is_plain ? ", plain" : "");
    return solid;
  }
}

void write_solid(const DrawnSolid& solid, const std::string& path) {
  const primitives::Model& model = solid.model;
  std::ofstream mesh(path + ".obj"), truth(path + ".truth.tsv");
  mesh.precision(17);
  truth.precision(12);
  mesh << "# " << solid.part << ", " << solid.rounding << "\n";
  for (const Vec3& p : model.mesh.positions) mesh << "v " << p.x << " " << p.y << " " << p.z << "\n";
  truth << "face\tsurface\tname\tkind\tpx\tpy\tpz\tax\tay\taz\tr1\tr2\thalf_angle\tchord\n";
  for (std::uint32_t f = 0; f < model.mesh.face_count(); ++f) {
    mesh << "f";
    for (const VertexId v : model.mesh.face(FaceId(f))) mesh << " " << v.value + 1;
    mesh << "\n";
    const std::uint32_t of = model.surface_of[FaceId(f)];
    const test::PlainSurface& s = model.surfaces[of];
    truth << f << "\t" << of << "\t" << solid.names[of] << "\t" << kind_name(s.kind);
    for (const double x :
         {s.point.x, s.point.y, s.point.z, s.axis.x, s.axis.y, s.axis.z, s.radius, s.tube, s.half_deg, solid.chord[of]})
      truth << "\t" << x;
    truth << "\n";
  }
  if (!mesh || !truth) throw std::runtime_error(path + " cannot be written");
}

}  // namespace remesh::recognition
