#include "tests/recognition/drawn_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tests/support/solids.h"

namespace remesh::recognition {
namespace {

using test::PlainSurface;

constexpr double kTurn = 2 * std::numbers::pi;
/// CAD programs put corners off a surface by up to this part of the chord height.
constexpr double kSloppyPart = 1.0 / 3;

/// Returns the profile with cones for the arcs whose rows turn by more than the feature angle: then each row is a
/// surface of its own.
std::vector<ProfilePiece> without_coarse_arcs(const std::vector<ProfilePiece>& profile) {
  std::vector<ProfilePiece> pieces;
  for (const ProfilePiece& piece : profile) {
    if (piece.row_turn <= kFeatureTurn) {
      pieces.push_back(piece);
      continue;
    }
    for (int row = 0; row < piece.rows; ++row) {
      const auto at = [&](int k) { return piece.at(static_cast<double>(k) / piece.rows); };
      pieces.push_back(line_piece(at(row), at(row + 1), coarse_name(piece.name)));
      pieces.back().also = piece.surface;
    }
  }
  return pieces;
}

Vec2 of_grid(const Vec3& p) { return {std::round(p.x * 0x1p30) * 0x1p-30, std::round(p.y * 0x1p30) * 0x1p-30}; }

}  // namespace

std::string coarse_name(const std::string& name) { return name.starts_with("coarse ") ? name : "coarse " + name; }

ProfilePiece line_piece(Vec2 from, Vec2 to, const std::string& name, int rows) {
  ProfilePiece piece;
  piece.at = [=](double t) { return t == 1 ? to : from + t * (to - from); };
  piece.rows = rows;
  piece.name = name;
  const Vec2 d = to - from;
  if (d.y == 0) {
    piece.surface = {SurfaceKind::kPlane, {0, 0, from.y}, {0, 0, d.x < 0 ? 1.0 : -1.0}, 0, 0, 0, {}};
    piece.name = "plane";
  } else if (d.x == 0) {
    piece.surface = {SurfaceKind::kCylinder, {}, {0, 0, 1}, from.x, 0, 0, {}};
  } else {
    const double apex = from.y - from.x * d.y / d.x;
    const double half = std::atan(std::fabs(d.x / d.y)) * 360 / kTurn;
    piece.surface = {SurfaceKind::kCone, {0, 0, apex}, {0, 0, from.y + to.y > 2 * apex ? 1.0 : -1.0}, 0, 0, half, {}};
  }
  return piece;
}

ProfilePiece arc_piece(Vec2 centre, double radius, double from, double to, int rows, const std::string& name) {
  ProfilePiece piece;
  piece.at = [=](double t) {
    const double angle = from + t * (to - from);
    return centre + radius * Vec2{std::cos(angle), std::sin(angle)};
  };
  piece.rows = rows;
  piece.name = name;
  piece.row_turn = std::fabs(to - from) / rows;
  piece.chord = radius * (1 - std::cos(piece.row_turn / 2));
  piece.surface = {centre.x == 0 ? SurfaceKind::kSphere : SurfaceKind::kTorus,
                   {0, 0, centre.y},
                   {0, 0, 1},
                   centre.x == 0 ? radius : std::fabs(centre.x),
                   centre.x == 0 ? 0 : radius,
                   0,
                   {}};
  return piece;
}

std::uint32_t DrawnBody::surface(const PlainSurface& s, const std::string& name, double chord,
                                 const PlainSurface& also) {
  solid_.model.surfaces.push_back(s);
  solid_.names.push_back(name);
  solid_.chord.push_back(chord);
  solid_.also.push_back(also);
  return static_cast<std::uint32_t>(solid_.names.size() - 1);
}

std::uint32_t DrawnBody::vertex(const Vec3& p) {
  positions_.push_back(p);
  return static_cast<std::uint32_t>(positions_.size() - 1);
}

void DrawnBody::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t surface,
                         const std::vector<Vec3>& true_points) {
  faces_.push_back({a, b, c});
  solid_.model.surface_of.push_back(surface);
  solid_.true_points.push_back(true_points);
}

std::pair<VertexRing, VertexRing> DrawnBody::turn(int n, const std::vector<ProfilePiece>& drawn, Vec2 centre,
                                                  const Section& section, bool is_closed) {
  const std::vector<ProfilePiece> profile = without_coarse_arcs(drawn);
  const double first_angle = random_.uniform(0, kTurn / n);
  const auto point = [&](double i, Vec2 p) {
    const double angle = first_angle + kTurn * i / n;
    const Vec2 d = section ? section(angle) : Vec2{std::cos(angle), std::sin(angle)};
    return Vec3{centre.x + p.x * d.x, centre.y + p.x * d.y, p.y};
  };
  double size = 0;
  for (const ProfilePiece& piece : profile)
    for (const double t : {0.0, 0.5, 1.0}) size = std::max({size, piece.at(t).x, std::fabs(piece.at(t).y)});
  const auto is_on_axis = [&](Vec2 p) { return p.x < 1e-9 * size; };
  const auto ring_at = [&](Vec2 p, double profile_chord) {
    if (is_on_axis(p)) return VertexRing{vertex({centre.x, centre.y, p.y})};
    double height = p.x * (1 - std::cos(kTurn / n / 2));
    if (profile_chord > 0) height = std::min(height, profile_chord);
    VertexRing ring;
    for (int i = 0; i < n; ++i) {
      const double push = is_sloppy_ ? random_.uniform(-kSloppyPart, kSloppyPart) * height : 0;
      solid_.off = std::max(solid_.off, std::fabs(push));
      ring.push_back(vertex(point(i, {p.x + push, p.y})));
    }
    return ring;
  };
  // A ring between two pieces may not be moved by more than the lower one of their chords excuses.
  const auto chord_between = [&](std::size_t k, std::size_t next) {
    const double a = profile[k].chord, b = next < profile.size() ? profile[next].chord : 0;
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
  };
  const bool is_first_plane = profile.front().surface.kind == SurfaceKind::kPlane;
  const VertexRing first = ring_at(profile.front().at(0), is_first_plane ? 0 : chord_between(0, profile.size()));
  VertexRing last = first;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const ProfilePiece& piece = profile[k];
    PlainSurface truth = piece.surface;
    PlainSurface also = piece.also;
    for (PlainSurface* const moved : {&truth, &also}) moved->point += Vec3{centre.x, centre.y, 0};
    if (section && truth.kind != SurfaceKind::kPlane) truth = {};
    const bool is_plane = truth.kind == SurfaceKind::kPlane;
    const double widest = std::max({piece.at(0).x, piece.at(0.5).x, piece.at(1).x});
    const std::uint32_t s = surface(truth, is_plane || kTurn / n <= kFeatureTurn ? piece.name : coarse_name(piece.name),
                                    is_plane ? 0 : piece.chord + widest * (1 - std::cos(kTurn / n / 2)), also);
    const int diagonals = random_.below(3);
    for (int row = 0; row < piece.rows; ++row) {
      const double t = static_cast<double>(row) / piece.rows, u = static_cast<double>(row + 1) / piece.rows;
      const bool is_end = row + 1 == piece.rows;
      const VertexRing next = is_end && is_closed && k + 1 == profile.size()
                                  ? first
                                  : ring_at(piece.at(u), is_end ? chord_between(k, k + 1) : piece.chord);
      if (is_plane && (last.size() == 1 || next.size() == 1)) {
        // The axis needs no vertex in a plane.
        if (next.size() == 1) {
          positions_.pop_back();
          cap(last);
        } else {
          cap(VertexRing(next.rbegin(), next.rend()));
        }
        // A cap has a surface of its own.
        last = next;
        continue;
      }
      for (int i = 0; i < n; ++i) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>((i + 1) % n);
        std::vector<Vec3> points;
        if (!is_plane)
          points = {point(i + 0.5, piece.at((t + u) / 2)), point(i + 0.5, piece.at(t)), point(i + 0.5, piece.at(u)),
                    point(i, piece.at((t + u) / 2)), point(i + 1, piece.at((t + u) / 2))};
        if (last.size() == 1) {
          triangle(last[0], next[b], next[a], s, points);
        } else if (next.size() == 1) {
          triangle(last[a], last[b], next[0], s, points);
        } else if (diagonals == 0 || (diagonals == 1 && (i + row) % 2 == 0)) {
          triangle(last[a], last[b], next[b], s, points);
          triangle(last[a], next[b], next[a], s, points);
        } else {
          triangle(last[a], last[b], next[a], s, points);
          triangle(last[b], next[b], next[a], s, points);
        }
      }
      last = next;
    }
  }
  return {first, last};
}

std::pair<VertexRing, VertexRing> DrawnBody::sweep(int n, int count, const std::function<Vec3(double, double)>& at,
                                                   std::uint32_t surface, bool is_closed) {
  std::vector<VertexRing> rings;
  for (int k = 0; k < count; ++k) {
    VertexRing& ring = rings.emplace_back();
    for (int i = 0; i < n; ++i) ring.push_back(vertex(at(i, k)));
  }
  for (int k = 0; k + (is_closed ? 0 : 1) < count; ++k) {
    const VertexRing &low = rings[static_cast<std::size_t>(k)],
                     &high = rings[static_cast<std::size_t>((k + 1) % count)];
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>((i + 1) % n);
      const std::vector<Vec3> points{at(i + 0.5, k + 0.5), at(i + 0.5, k), at(i + 0.5, k + 1), at(i, k + 0.5),
                                     at(i + 1, k + 0.5)};
      triangle(low[a], low[b], high[b], surface, points);
      triangle(low[a], high[b], high[a], surface, points);
    }
  }
  return {rings.front(), rings.back()};
}

void DrawnBody::plane(const VertexRing& outer, const std::vector<VertexRing>& holes, bool is_upward) {
  const double z = positions_[outer[0]].z;
  const std::uint32_t s =
      surface({SurfaceKind::kPlane, {0, 0, z}, {0, 0, is_upward ? 1.0 : -1.0}, 0, 0, 0, {}}, "plane");
  std::map<Vec2, std::uint32_t> at;
  polygons::Polygon polygon;
  const auto loop = [&](const VertexRing& ring, bool is_reversed) {
    polygons::Loop points;
    for (const std::uint32_t v : ring) {
      points.push_back(of_grid(positions_[v]));
      at[points.back()] = v;
    }
    if (is_reversed) std::reverse(points.begin(), points.end());
    return points;
  };
  polygon.outer = loop(outer, false);
  for (const VertexRing& hole : holes) polygon.holes.push_back(loop(hole, true));
  const PolygonMesh mesh = solids::region(polygon);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(FaceId(f));
    std::array<std::uint32_t, 3> t{};
    for (std::size_t i = 0; i < 3; ++i) t[i] = at.at({mesh.positions[corners[i]].x, mesh.positions[corners[i]].y});
    if (!is_upward) std::swap(t[1], t[2]);
    triangle(t[0], t[1], t[2], s);
  }
}

void DrawnBody::cap(const VertexRing& ring) {
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    normal += cross(positions_[ring[i]] - positions_[ring[0]], positions_[ring[i + 1]] - positions_[ring[0]]);
  const std::uint32_t s = surface({SurfaceKind::kPlane, positions_[ring[0]], normalized(normal), 0, 0, 0, {}}, "plane");
  if (random_.chance(0.5)) {
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) triangle(ring[0], ring[i], ring[i + 1], s);
    return;
  }
  std::size_t low = 0, high = ring.size() - 1;
  while (high - low > 1) {
    triangle(ring[low], ring[low + 1], ring[high], s);
    ++low;
    if (high - low > 1) {
      triangle(ring[low], ring[high - 1], ring[high], s);
      --high;
    }
  }
}

DrawnSolid DrawnBody::take(const std::string& part, const std::function<Vec3(const Vec3&)>& turned, const Vec3& by,
                           const std::function<double(double)>& round) {
  solid_.part = part;
  primitives::Model& model = solid_.model;
  model.name = part;
  for (const Vec3& p : positions_) {
    const Vec3 q = turned(p) + by;
    model.mesh.positions.push_back({round(q.x), round(q.y), round(q.z)});
  }
  for (auto* const surfaces : {&model.surfaces, &solid_.also})
    for (PlainSurface& s : *surfaces) {
      s.point = turned(s.point) + by;
      s.axis = turned(s.axis);
    }
  for (std::vector<Vec3>& points : solid_.true_points)
    for (Vec3& p : points) p = turned(p) + by;
  for (const auto& face : faces_) {
    for (const std::uint32_t v : face) model.mesh.corners.push_back(VertexId(v));
    model.mesh.face_begin.push_back(static_cast<std::uint32_t>(model.mesh.corners.size()));
  }
  return std::move(solid_);
}

}  // namespace remesh::recognition
