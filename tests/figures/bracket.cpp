#include "tests/figures/bracket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh::figures {
namespace {

using Loop = std::vector<Vec2>;

// Millimetres. The base lies on z = 0 along x, the wall stands on it at x = 0, the rib joins them at y = 0.
constexpr double kLength = 84;
constexpr double kHalfWidth = 32;
constexpr double kHeight = 92;
constexpr double kThickness = 10;
constexpr double kCorner = 14;    // radius
constexpr double kRib = 4;        // half of its thickness
constexpr double kRibEnd = 52;    // where it ends on the base, and on the wall
constexpr int kQuarterSteps = 5;  // facets in a quarter of a circle

void append_arc(Loop& loop, Vec2 centre, double radius, double from_deg, double to_deg) {
  const int steps = static_cast<int>(std::lround((to_deg - from_deg) / 90 * kQuarterSteps));
  for (int i = 0; i <= steps; ++i) {
    const double angle = (from_deg + (to_deg - from_deg) * i / steps) * std::numbers::pi / 180;
    loop.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
}

Loop circle(Vec2 centre, double radius) {
  Loop loop;
  append_arc(loop, centre, radius, 0, 360);
  loop.pop_back();
  return loop;
}

Loop slot(double from_x, double to_x, double y, double radius) {
  Loop loop;
  append_arc(loop, {to_x, y}, radius, -90, 90);
  append_arc(loop, {from_x, y}, radius, 90, 270);
  return loop;
}

double doubled_area(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

bool crosses(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return doubled_area(a, b, c) * doubled_area(a, b, d) < 0 && doubled_area(c, d, a) * doubled_area(c, d, b) < 0;
}

/// Joins a hole (counter-clockwise, as drawn) to the outline by the shortest pair of vertices that see each other.
void bridge(Loop& outline, const Loop& hole, const std::vector<Loop>& holes) {
  double shortest = HUGE_VAL;
  std::size_t at = 0, hole_at = 0;
  const auto is_blocked = [](Vec2 a, Vec2 b, const Loop& loop) {
    for (std::size_t k = 0; k < loop.size(); ++k)
      if (crosses(a, b, loop[k], loop[(k + 1) % loop.size()])) return true;
    return false;
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double length = norm(outline[i] - hole[j]);
      if (length >= shortest || is_blocked(outline[i], hole[j], outline)) continue;
      if (std::any_of(holes.begin(), holes.end(), [&](const Loop& h) { return is_blocked(outline[i], hole[j], h); }))
        continue;
      shortest = length;
      at = i;
      hole_at = j;
    }
  }
  Loop inserted;
  for (std::size_t k = 0; k <= hole.size(); ++k) inserted.push_back(hole[(hole_at + hole.size() - k) % hole.size()]);
  inserted.push_back(outline[at]);
  outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(at) + 1, inserted.begin(), inserted.end());
}

/// Triangulates by ear clipping. The best-shaped ear is cut first, so that no sliver is left for the end.
std::vector<std::array<Vec2, 3>> triangulate(Loop loop, const std::vector<Loop>& holes) {
  for (const Loop& hole : holes) bridge(loop, hole, holes);
  std::vector<std::array<Vec2, 3>> triangles;
  while (loop.size() >= 3) {
    std::size_t best = loop.size();
    double best_shape = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 a = loop[(i + loop.size() - 1) % loop.size()], b = loop[i], c = loop[(i + 1) % loop.size()];
      const double area = doubled_area(a, b, c);
      const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
      const double shape = area / (longest * longest);
      if (shape <= std::max(best_shape, 1e-9)) continue;
      const bool is_empty = std::none_of(loop.begin(), loop.end(), [&](Vec2 p) {
        if (p == a || p == b || p == c) return false;
        return doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0;
      });
      if (is_empty) {
        best = i;
        best_shape = shape;
      }
    }
    if (best == loop.size()) break;  // what is left has no area
    triangles.push_back({loop[(best + loop.size() - 1) % loop.size()], loop[best], loop[(best + 1) % loop.size()]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return triangles;
}

/// Triangles that are welded as they are added. They can be cut at any edge, in the faces on both sides at once.
class Cutter {
 public:
  void add(const std::array<Vec3, 3>& corners) {
    Face face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = vertex_of_.try_emplace(corners[k], positions_.size());
      if (is_new) positions_.push_back(corners[k]);
      face[k] = at->second;
    }
    faces_.push_back(face);
    link(faces_.size() - 1);
  }

  /// Cuts edges, mostly the longest, at irregular places until there are `face_count` faces.
  void cut_until(std::size_t face_count) {
    for (const auto& [edge, faces] : faces_of_) enqueue(edge);
    while (faces_.size() < face_count) {
      const Edge edge = queue_.top().second;
      if (faces_of_.contains(edge))
        cut(longest_near(edge));
      else
        queue_.pop();
    }
  }

  PolygonMesh mesh() const {
    PolygonMesh mesh;
    const auto rounded = [](double x) { return std::round(x * 1e6) / 1e6 + 0.0; };
    for (const Vec3& p : positions_) mesh.positions.push_back({rounded(p.x), rounded(p.y), rounded(p.z)});
    for (const Face& face : faces_) {
      for (const std::size_t v : face) mesh.corners.emplace_back(v);
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    return mesh;
  }

 private:
  using Face = std::array<std::size_t, 3>;
  using Edge = std::pair<std::size_t, std::size_t>;  // smaller vertex first

  static Edge edge_of(const Face& face, std::size_t k) {
    const auto [low, high] = std::minmax(face[k], face[(k + 1) % 3]);
    return {low, high};
  }
  void link(std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k) faces_of_[edge_of(faces_[face], k)].push_back(face);
  }
  void unlink(std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto entry = faces_of_.find(edge_of(faces_[face], k));
      std::erase(entry->second, face);
      if (entry->second.empty()) faces_of_.erase(entry);
    }
  }
  void enqueue(Edge edge) { queue_.emplace(length(edge) * random_.uniform(0.5, 1.5), edge); }
  double length(Edge edge) const { return norm(positions_[edge.first] - positions_[edge.second]); }

  /// Returns the edge to cut instead. It goes from an edge to a longer one in the faces beside it, until it comes to
  /// one that is the longest of both of its faces. Cutting only such edges keeps needles from becoming ever thinner
  /// (Rivara).
  Edge longest_near(Edge edge) const {
    for (bool is_longest = false; !is_longest;) {
      is_longest = true;
      for (const std::size_t f : faces_of_.at(edge)) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Edge other = edge_of(faces_[f], k);
          if (length(other) <= length(edge)) continue;
          edge = other;
          is_longest = false;
          break;
        }
        if (!is_longest) break;
      }
    }
    return edge;
  }

  void cut(Edge edge) {
    const double t = random_.uniform(0.3, 0.7);
    const std::size_t middle = positions_.size();
    positions_.push_back((1 - t) * positions_[edge.first] + t * positions_[edge.second]);
    const std::vector<std::size_t> beside = faces_of_.at(edge);
    for (const std::size_t f : beside) {
      unlink(f);
      const Face old = faces_[f];
      std::size_t k = 0;
      while (edge_of(old, k) != edge) ++k;
      const std::size_t a = old[k], b = old[(k + 1) % 3], apex = old[(k + 2) % 3];
      faces_[f] = {a, middle, apex};
      faces_.push_back({middle, b, apex});
      link(f);
      link(faces_.size() - 1);
      enqueue(std::minmax({middle, apex}));
    }
    enqueue({edge.first, middle});
    enqueue({edge.second, middle});
  }

  std::vector<Vec3> positions_;
  std::vector<Face> faces_;
  std::map<Vec3, std::size_t> vertex_of_;
  std::map<Edge, std::vector<std::size_t>> faces_of_;
  std::priority_queue<std::pair<double, Edge>> queue_;
  Random random_{2018};
};

using Placement = std::function<Vec3(Vec2)>;
enum class Side { kFront, kBack };

void add_plate(Cutter& part, const Loop& outline, const std::vector<Loop>& holes, const Placement& place, Side side) {
  for (auto [a, b, c] : triangulate(outline, holes)) {
    if (side == Side::kBack) std::swap(b, c);
    part.add({place(a), place(b), place(c)});
  }
}

/// Makes the strip between two copies of a line of points. Seen from outside, `low` runs to the right below `high`.
void add_strip(Cutter& part, const Loop& line, const Placement& low, const Placement& high) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    part.add({low(line[i]), low(line[i + 1]), high(line[i + 1])});
    part.add({low(line[i]), high(line[i + 1]), high(line[i])});
  }
}

void add_hole(Cutter& part, Loop hole, const Placement& low, const Placement& high) {
  hole.push_back(hole.front());
  std::reverse(hole.begin(), hole.end());
  add_strip(part, hole, low, high);
}

}  // namespace

PolygonMesh make_bracket(std::size_t face_count) {
  // In (x, y): the free end of the base; in (y, z): the free end of the wall.
  Loop base_end, wall_end;
  append_arc(base_end, {kLength - kCorner, -kHalfWidth + kCorner}, kCorner, -90, 0);
  append_arc(base_end, {kLength - kCorner, kHalfWidth - kCorner}, kCorner, 0, 90);
  append_arc(wall_end, {kHalfWidth - kCorner, kHeight - kCorner}, kCorner, 0, 90);
  append_arc(wall_end, {-kHalfWidth + kCorner, kHeight - kCorner}, kCorner, 90, 180);
  const std::vector<Loop> base_holes{slot(34, 58, -17, 5.5), slot(34, 58, 17, 5.5)};
  const std::vector<Loop> wall_holes{circle({-16, 66}, 8), circle({16, 66}, 8)};

  const Placement bottom = [](Vec2 p) { return Vec3{p.x, p.y, 0}; };
  const Placement top = [](Vec2 p) { return Vec3{p.x, p.y, kThickness}; };
  const Placement back = [](Vec2 p) { return Vec3{0, p.x, p.y}; };
  const Placement front = [](Vec2 p) { return Vec3{kThickness, p.x, p.y}; };
  const auto beside = [](double y) { return [y](Vec2 p) { return Vec3{p.x, y, p.y}; }; };

  const auto closed_by = [](Loop loop, const Loop& rest) {
    loop.insert(loop.end(), rest.begin(), rest.end());
    return loop;
  };

  Cutter part;
  add_plate(part, closed_by(base_end, {{0, kHalfWidth}, {0, -kHalfWidth}}), base_holes, bottom, Side::kBack);
  add_plate(part,
            closed_by(base_end, {{kThickness, kHalfWidth},
                                 {kThickness, kRib},
                                 {kRibEnd, kRib},
                                 {kRibEnd, -kRib},
                                 {kThickness, -kRib},
                                 {kThickness, -kHalfWidth}}),
            base_holes, top, Side::kFront);
  add_strip(part, base_end, bottom, top);
  for (const Loop& hole : base_holes) add_hole(part, hole, bottom, top);

  add_plate(part, closed_by(wall_end, {{-kHalfWidth, 0}, {kHalfWidth, 0}}), wall_holes, back, Side::kBack);
  add_plate(part,
            closed_by(wall_end, {{-kHalfWidth, kThickness},
                                 {-kRib, kThickness},
                                 {-kRib, kRibEnd},
                                 {kRib, kRibEnd},
                                 {kRib, kThickness},
                                 {kHalfWidth, kThickness}}),
            wall_holes, front, Side::kFront);
  add_strip(part, wall_end, back, front);
  for (const Loop& hole : wall_holes) add_hole(part, hole, back, front);

  const Loop profile{{0, 0},
                     {kLength - kCorner, 0},
                     {kLength - kCorner, kThickness},
                     {kThickness, kThickness},
                     {kThickness, kHeight - kCorner},
                     {0, kHeight - kCorner}};
  add_plate(part, profile, {}, beside(-kHalfWidth), Side::kFront);
  add_plate(part, profile, {}, beside(kHalfWidth), Side::kBack);

  const Loop rib{{kThickness, kThickness}, {kRibEnd, kThickness}, {kThickness, kRibEnd}};
  add_plate(part, rib, {}, beside(-kRib), Side::kFront);
  add_plate(part, rib, {}, beside(kRib), Side::kBack);
  add_strip(part, {rib[1], rib[2]}, beside(kRib), beside(-kRib));

  part.cut_until(face_count);
  return part.mesh();
}

}  // namespace remesh::figures
