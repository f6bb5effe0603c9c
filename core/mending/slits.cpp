#include "core/mending/slits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace remesh {
namespace {

/// The faces at a tip span at least this angle: the gap between them is narrower than 135 degrees.
constexpr double kTipAngle = 1.25 * std::numbers::pi;
/// The open edges of a mouth leave it in directions that differ by at least 60 degrees.
constexpr double kMouthCosine = 0.5;

}  // namespace

double Slits::max_width() const { return std::min(rules_.size, rules_.allowed); }

Slits::Around Slits::around(std::uint32_t node) const {
  Around around;
  complex_.collect(node, around.faces, work_);
  around.spokes = spokes_of(node, around.faces, complex_, rules_);
  return around;
}

double Slits::angle_around(std::uint32_t node, const Around& around) const {
  double sum = 0;
  for (const PresentTriangle& t : around.faces) {
    const auto at = static_cast<std::size_t>(t.at(node));
    const Places p = places_of(t, complex_);
    const Vec3 a = p[(at + 1) % 3] - p[at], b = p[(at + 2) % 3] - p[at];
    sum += std::atan2(norm(cross(a, b)), dot(a, b));
  }
  return sum;
}

/// Returns the two nodes to which open edges lead, if there are just two.
std::optional<std::array<std::uint32_t, 2>> Slits::open_neighbours(const Around& around) {
  std::array<std::uint32_t, 2> nodes{};
  std::size_t count = 0;
  for (const Spoke& spoke : around.spokes) {
    if (!spoke.is_open()) continue;
    if (count == 2) return {};
    nodes[count++] = spoke.to;
  }
  if (count < 2) return {};
  return nodes;
}

/// Goes to the next node of a side. Output: false if there is no single next one.
bool Slits::walk_on(Side& side) const {
  const auto neighbours = open_neighbours(around(side.node));
  if (!neighbours) return false;
  const std::uint32_t next = (*neighbours)[0] == side.previous ? (*neighbours)[1] : (*neighbours)[0];
  side = {side.node, next, complex_.place(side.node)};
  return true;
}

/// Returns whether the node after that of a side is nearer to another node, and not the same.
bool Slits::is_next_nearer(Side side, std::uint32_t other) const {
  const Vec3 &here = complex_.place(side.node), &there = complex_.place(other);
  return walk_on(side) && side.node != other && norm(complex_.place(side.node) - there) < norm(here - there);
}

/// Finds the point nearest to a node on the way from a place to another node, if it is not an end.
std::optional<Slits::Foot> Slits::foot_on(const Vec3& from, std::uint32_t to, std::uint32_t node) const {
  const Vec3 way = complex_.place(to) - from, apart = complex_.place(node) - from;
  const double at = dot(way, apart) / norm_squared(way);
  if (!(at > 0 && at < 1)) return {};
  return Foot{at, norm(apart - at * way)};
}

std::optional<Slit> Slits::find(std::uint32_t tip) const {
  const Around at_tip = around(tip);
  auto ends = open_neighbours(at_tip);
  if (!ends || angle_around(tip, at_tip) < kTipAngle) return {};
  // Which side is the first one depends on places, and not on numbers.
  if (complex_.place((*ends)[1]) < complex_.place((*ends)[0])) std::swap((*ends)[0], (*ends)[1]);
  Side a{tip, (*ends)[0], complex_.place(tip)}, b{tip, (*ends)[1], complex_.place(tip)};
  Slit slit;
  while (true) {
    if (a.node == b.node || a.node == b.previous) return slit;
    const Vec3 to_a = complex_.place(a.node) - a.begin, to_b = complex_.place(b.node) - b.begin;
    const double length_a = norm(to_a), length_b = norm(to_b);
    if (!slit.steps.empty() && !(dot(to_a, to_b) > kMouthCosine * length_a * length_b)) return slit;
    const bool is_a_nearer =
        length_a < length_b || (length_a == length_b && complex_.place(a.node) < complex_.place(b.node));
    const Side& near = is_a_nearer ? a : b;
    Side& far = is_a_nearer ? b : a;
    using Joins = Slit::Step::Joins;
    Joins joins = Joins::kNodes;
    double width = norm(complex_.place(a.node) - complex_.place(b.node));
    if (width < max_width() && !is_next_nearer(near, far.node)) {
      if (!(std::min(complex_.reach(a.node, complex_.place(b.node)), complex_.reach(b.node, complex_.place(a.node))) <=
            rules_.allowed))
        return {};
    } else {
      joins = is_a_nearer ? Joins::kFirstToEdge : Joins::kSecondToEdge;
      const auto foot = foot_on(far.begin, far.node, near.node);
      if (!foot || !(foot->distance < max_width())) return {};
      width = foot->distance;
      far.begin += foot->at * (is_a_nearer ? to_b : to_a);
      far.at += foot->at * (1 - far.at);
      if (!(complex_.reach_on_edge(far.previous, far.node, far.at, complex_.place(near.node)) <= rules_.allowed))
        return {};
    }
    slit.width = std::max(slit.width, width);
    slit.steps.push_back({a.node, b.node, joins});
    if (joins != Joins::kSecondToEdge && !walk_on(a)) return {};
    if (joins != Joins::kFirstToEdge && !walk_on(b)) return {};
    if (work_.is_spent()) return {};
  }
}

std::vector<std::uint32_t> Slits::close(std::uint32_t tip, const Slit& slit) {
  std::vector<std::uint32_t> joined;
  for (const Slit::Step& step : slit.steps) {
    work_.check();
    if (step.joins == Slit::Step::Joins::kNodes) {
      const auto kept = join_nodes(step.first, step.second);
      if (!kept) break;
      tip = *kept;
    } else {
      const bool is_first = step.joins == Slit::Step::Joins::kFirstToEdge;
      const std::uint32_t node = is_first ? step.first : step.second;
      if (!join_to_edge(tip, node, is_first ? step.second : step.first)) break;
      tip = node;
    }
    joined.push_back(tip);
  }
  return joined;
}

/// Joins one of two nodes to the other one. Output: the one that is kept, or nothing if neither may go.
std::optional<std::uint32_t> Slits::join_nodes(std::uint32_t first, std::uint32_t second) {
  const auto to_second = look_at_join(first, second), to_first = look_at_join(second, first);
  if (!to_second && !to_first) return {};
  const bool is_first_kept =
      !to_second || (to_first && (*to_first < *to_second ||
                                  (*to_first == *to_second && complex_.place(first) < complex_.place(second))));
  const std::uint32_t kept = is_first_kept ? first : second;
  complex_.join(is_first_kept ? second : first, kept);
  return kept;
}

/// Cuts the edge from the tip to the node ahead, where it is nearest to another node, and joins the cut to that node.
bool Slits::join_to_edge(std::uint32_t tip, std::uint32_t node, std::uint32_t ahead) {
  const auto foot = foot_on(complex_.place(tip), ahead, node);
  if (!foot || is_fixed(node) || (is_fixed(tip) && is_fixed(ahead))) return false;
  if (!(complex_.reach_on_edge(tip, ahead, foot->at, complex_.place(node)) <= rules_.allowed)) return false;
  const std::uint32_t cut = complex_.cut(tip, ahead, foot->at, work_);
  if (!look_at_join(cut, node)) return false;
  complex_.join(cut, node);
  return true;
}

/// Looks at joining a node to one on the other side.
/// Output: how far planes would be bent, or nothing if it may not be done.
std::optional<double> Slits::look_at_join(std::uint32_t from, std::uint32_t to) const {
  const Vec3& target = complex_.place(to);
  if (is_fixed(from) || is_fixed(to) || !(complex_.reach(from, target) <= rules_.allowed)) return {};
  const Around at_from = around(from), at_to = around(to);
  if (!keeps_links(from, to, at_from, at_to)) return {};
  const Vec3 move = target - complex_.place(from);
  double bend = 0;
  for (const PresentTriangle& t : at_from.faces) {
    Places places = places_of(t, complex_);
    const TriangleShape before(places);
    if (before.height >= rules_.size)
      bend = std::max(bend, std::fabs(dot(before.twice_area, move)) / norm(before.twice_area));
    if (t.has(to)) continue;
    places[static_cast<std::size_t>(t.at(from))] = target;
    if (!may_become(before, TriangleShape(places), rules_)) return {};
  }
  return bend;
}

/// Returns whether two nodes may become one: pairs of open edges then become edges between two faces, which have them in
/// opposite directions, and nothing else that is different becomes one.
bool Slits::keeps_links(std::uint32_t from, std::uint32_t to, const Around& at_from, const Around& at_to) {
  if (!open_neighbours(at_from) || !open_neighbours(at_to)) return false;
  std::vector<std::uint32_t> apexes;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> opposite;
  for (const PresentTriangle& t : at_from.faces) {
    if (t.has(to)) {
      apexes.push_back(third(t, from, to));
      continue;
    }
    const int at = t.at(from);
    opposite.push_back(std::minmax(t.corners[(at + 1) % 3], t.corners[(at + 2) % 3]));
  }
  if (apexes.size() > 1) return false;
  for (const Spoke& s : at_from.spokes) {
    if (s.to == to || (!apexes.empty() && s.to == apexes.front())) continue;
    const Spoke* const other = find_spoke(at_to.spokes, s.to);
    if (other != nullptr && !(s.is_open() && other->is_open() && s.balance + other->balance == 0)) return false;
  }
  std::sort(opposite.begin(), opposite.end());
  return std::none_of(at_to.faces.begin(), at_to.faces.end(), [&](const PresentTriangle& t) {
    if (t.has(from)) return false;
    const int at = t.at(to);
    const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(t.corners[(at + 1) % 3], t.corners[(at + 2) % 3]);
    return std::binary_search(opposite.begin(), opposite.end(), edge);
  });
}

}  // namespace remesh
