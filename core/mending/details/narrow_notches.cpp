#include "core/mending/details/narrow_notches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

namespace remesh {
namespace {

/// The faces at a tip span at least this angle: the gap between them is narrower than 135 degrees.
constexpr double kTipAngle = 1.25 * std::numbers::pi;
/// The sides of a narrow notch run in directions that differ by less than 60 degrees at its tip. Where they differ by
/// more, the narrow notch has its mouth, unless the sides have corners and are near each other beyond these. From 120
/// degrees on, it is a mouth in any case.
constexpr double kTipCosine = 0.5, kMouthCosine = -0.5;

}  // namespace

double NarrowNotches::max_width() const { return std::min(rules_.size, rules_.allowed); }

NarrowNotches::Around NarrowNotches::around(std::uint32_t node) const {
  Around around;
  complex_.collect(node, around.faces, work_);
  around.spokes = spokes_of(node, around.faces, complex_, rules_);
  return around;
}

double NarrowNotches::angle_around(std::uint32_t node, const Around& around) const {
  // The angles are added in the order of their sizes, so that the sum does not depend on the order of faces.
  std::vector<double> angles;
  for (const PresentTriangle& t : around.faces) {
    const auto at = static_cast<std::size_t>(t.at(node));
    const Places p = places_of(t, complex_);
    const Vec3 a = p[(at + 1) % 3] - p[at], b = p[(at + 2) % 3] - p[at];
    angles.push_back(std::atan2(norm(cross(a, b)), dot(a, b)));
  }
  std::sort(angles.begin(), angles.end());
  return std::accumulate(angles.begin(), angles.end(), 0.0);
}

/// Returns the two nodes to which open edges lead, if there are just two.
std::optional<std::array<std::uint32_t, 2>> NarrowNotches::open_neighbours(const Around& around) {
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
bool NarrowNotches::walk_on(Side& side) const {
  const auto neighbours = open_neighbours(around(side.node));
  if (!neighbours) return false;
  const std::uint32_t next = (*neighbours)[0] == side.previous ? (*neighbours)[1] : (*neighbours)[0];
  side = {side.node, next, complex_.place(side.node)};
  return true;
}

/// Returns whether `node` comes after the next node of a side.
bool NarrowNotches::is_next(Side side, std::uint32_t node) const { return walk_on(side) && side.node == node; }

/// Returns whether the node after the next one of a side is nearer to another node, and not that node itself.
bool NarrowNotches::is_next_nearer(Side side, std::uint32_t other) const {
  const Vec3 &here = complex_.place(side.node), &there = complex_.place(other);
  return walk_on(side) && side.node != other && norm(complex_.place(side.node) - there) < norm(here - there);
}

/// Finds the point nearest to a node on the way from a place to another node. Output: nothing if that point is an end
/// of the way.
std::optional<NarrowNotches::Foot> NarrowNotches::foot_on(const Vec3& from, std::uint32_t to,
                                                          std::uint32_t node) const {
  const Vec3 way = complex_.place(to) - from, apart = complex_.place(node) - from;
  const double at = dot(way, apart) / norm_squared(way);
  if (!(at > 0 && at < 1)) return {};
  return Foot{at, norm(apart - at * way)};
}

std::optional<NarrowNotch> NarrowNotches::find(std::uint32_t tip) const {
  const Around at_tip = around(tip);
  auto ends = open_neighbours(at_tip);
  if (!ends || angle_around(tip, at_tip) < kTipAngle) return {};
  // Which side is the first one depends on places, and not on numbers.
  if (complex_.place((*ends)[1]) < complex_.place((*ends)[0])) std::swap((*ends)[0], (*ends)[1]);
  Side a{tip, (*ends)[0], complex_.place(tip)}, b{tip, (*ends)[1], complex_.place(tip)};
  NarrowNotch notch;
  while (!work_.is_spent()) {
    work_.check();
    if (a.node == b.node || a.node == b.previous) return notch;
    const Vec3 to_a = complex_.place(a.node) - a.begin, to_b = complex_.place(b.node) - b.begin;
    const double cosine = dot(to_a, to_b) / (norm(to_a) * norm(to_b));
    const bool is_tip = notch.steps.empty();
    if (is_tip && !(cosine > kTipCosine) && !is_next(a, b.node)) return {};
    if (!is_tip && cosine <= kMouthCosine) return notch;
    const auto joins = step_over(a, b, notch.width);
    if (!joins) return !is_tip && cosine <= kTipCosine ? std::optional(notch) : std::nullopt;
    notch.steps.push_back({a.node, b.node, *joins});
    if (*joins != NarrowNotch::Step::Joins::kSecondToEdge && !walk_on(a)) return {};
    if (*joins != NarrowNotch::Step::Joins::kFirstToEdge && !walk_on(b)) return {};
  }
  return {};
}

/// Finds the next nodes to join. If the edge of a side is cut, the side begins at the cut from then on.
/// Input:  `width` - it becomes larger with a wider place.
/// Output: nothing if the narrow notch is too wide there.
std::optional<NarrowNotch::Step::Joins> NarrowNotches::step_over(Side& a, Side& b, double& width) const {
  using Joins = NarrowNotch::Step::Joins;
  const Vec3 &at_a = complex_.place(a.node), &at_b = complex_.place(b.node);
  const double length_a = norm(at_a - a.begin), length_b = norm(at_b - b.begin);
  const bool is_a_nearer = length_a < length_b || (length_a == length_b && at_a < at_b);
  const Side& near = is_a_nearer ? a : b;
  Side& far = is_a_nearer ? b : a;
  const double apart = norm(at_a - at_b);
  if (apart < max_width() && !is_next_nearer(near, far.node)) {
    if (!(std::min(complex_.reach(a.node, at_b), complex_.reach(b.node, at_a)) <= rules_.allowed)) return {};
    width = std::max(width, apart);
    return Joins::kNodes;
  }
  const auto foot = foot_on(far.begin, far.node, near.node);
  if (!foot || !(foot->distance < max_width())) return {};
  const double at = far.at + foot->at * (1 - far.at);
  if (!(complex_.reach_on_edge(far.previous, far.node, at, complex_.place(near.node)) <= rules_.allowed)) return {};
  width = std::max(width, foot->distance);
  far.begin += foot->at * (complex_.place(far.node) - far.begin);
  far.at = at;
  return is_a_nearer ? Joins::kFirstToEdge : Joins::kSecondToEdge;
}

std::vector<std::uint32_t> NarrowNotches::close(std::uint32_t tip, const NarrowNotch& notch) {
  std::vector<std::uint32_t> joined;
  for (const NarrowNotch::Step& step : notch.steps) {
    work_.check();
    if (step.joins == NarrowNotch::Step::Joins::kNodes) {
      const auto kept = join_nodes(step.first, step.second);
      if (!kept) break;
      tip = *kept;
    } else {
      const bool is_first = step.joins == NarrowNotch::Step::Joins::kFirstToEdge;
      const std::uint32_t node = is_first ? step.first : step.second;
      if (!join_to_edge(tip, node, is_first ? step.second : step.first)) break;
      tip = node;
    }
    joined.push_back(tip);
  }
  return joined;
}

/// Joins one of two nodes to the other one. Output: the node that is kept, or nothing if neither node may be joined.
std::optional<std::uint32_t> NarrowNotches::join_nodes(std::uint32_t first, std::uint32_t second) {
  const auto to_second = look_at_join(first, second), to_first = look_at_join(second, first);
  if (!to_second && !to_first) return {};
  const bool is_first_kept = !to_second || (to_first && std::pair(*to_first, complex_.place(first)) <
                                                            std::pair(*to_second, complex_.place(second)));
  const std::uint32_t kept = is_first_kept ? first : second;
  complex_.join(is_first_kept ? second : first, kept);
  return kept;
}

/// Cuts the edge from the tip to the node ahead, where it is nearest to another node, and joins the cut to that node.
bool NarrowNotches::join_to_edge(std::uint32_t tip, std::uint32_t node, std::uint32_t ahead) {
  const Vec3& target = complex_.place(node);
  const auto foot = foot_on(complex_.place(tip), ahead, node);
  if (!foot || is_fixed(node) || (is_fixed(tip) && is_fixed(ahead))) return false;
  if (!(complex_.reach_on_edge(tip, ahead, foot->at, target) <= rules_.allowed)) return false;
  const Around at_tip = around(tip), at_node = around(node);
  const Spoke *const edge = find_spoke(at_tip.spokes, ahead), *const back = find_spoke(at_node.spokes, tip);
  const Spoke* const onward = find_spoke(at_node.spokes, ahead);
  if (edge == nullptr || !edge->is_open() || back == nullptr || !back->is_open()) return false;
  if (!open_neighbours(at_node) || (onward != nullptr && !onward->is_open())) return false;
  const auto cut =
      std::find_if(at_tip.faces.begin(), at_tip.faces.end(), [&](const PresentTriangle& t) { return t.has(ahead); });
  if (find_spoke(at_node.spokes, third(*cut, tip, ahead)) != nullptr) return false;
  const TriangleShape before(places_of(*cut, complex_));
  for (const std::uint32_t end : {tip, ahead}) {
    Places places = places_of(*cut, complex_);
    places[static_cast<std::size_t>(cut->at(end))] = target;
    if (!may_become(before, TriangleShape(places), rules_)) return false;
  }
  const std::vector<PresentTriangle> at_edge{*cut};
  if (would_fold({ahead, kNone, at_edge}, {node, kNone, at_node.faces}, tip, target, complex_, rules_)) return false;
  if (onward != nullptr &&
      would_fold({tip, kNone, at_edge}, {node, kNone, at_node.faces}, ahead, target, complex_, rules_))
    return false;
  complex_.join(complex_.cut(tip, ahead, foot->at, work_), node);
  return true;
}

/// Tests whether a node may be joined to one on the other side.
/// Output: how far planes would be bent, if that is more than noise, or nothing if the nodes may not be joined.
std::optional<double> NarrowNotches::look_at_join(std::uint32_t from, std::uint32_t to) const {
  const Vec3& target = complex_.place(to);
  if (is_fixed(from) || is_fixed(to) || !(complex_.reach(from, target) <= rules_.allowed)) return {};
  const Around at_from = around(from), at_to = around(to);
  if (!keeps_links(from, to, at_from, at_to)) return {};
  const Vec3 move = target - complex_.place(from);
  double bend = rules_.noise;
  for (const PresentTriangle& t : at_from.faces) {
    Places places = places_of(t, complex_);
    const TriangleShape before(places);
    if (before.height >= rules_.size)
      bend = std::max(bend, std::fabs(dot(before.twice_area, move)) / norm(before.twice_area));
    if (t.has(to)) continue;
    places[static_cast<std::size_t>(t.at(from))] = target;
    if (!may_become(before, TriangleShape(places), rules_)) return {};
  }
  for (const Spoke& s : at_from.spokes) {
    const Spoke* const other = find_spoke(at_to.spokes, s.to);
    if (s.is_open() && other != nullptr && other->is_open() &&
        would_fold({from, to, at_from.faces}, {to, from, at_to.faces}, s.to, target, complex_, rules_))
      return {};
  }
  return bend;
}

/// Returns whether two nodes may become one: pairs of open edges then become edges between two faces that run in
/// opposite directions, and nothing else that differs becomes one. If the nodes are neighbours, the face at their edge
/// vanishes, and its two other edges become one. One of these must be no border then, or a label would vanish as well.
bool NarrowNotches::keeps_links(std::uint32_t from, std::uint32_t to, const Around& at_from, const Around& at_to) {
  if (!open_neighbours(at_from) || !open_neighbours(at_to)) return false;
  std::vector<std::uint32_t> apexes;
  for (const PresentTriangle& t : at_from.faces)
    if (t.has(to)) apexes.push_back(third(t, from, to));
  if (apexes.size() > 1) return false;
  for (const Spoke& s : at_from.spokes) {
    const Spoke* const other = find_spoke(at_to.spokes, s.to);
    if (s.to == to) continue;
    if (!apexes.empty() && s.to == apexes.front()) {
      if ((s.is_border && other->is_border) || s.faces > 2 || other->faces > 2) return false;
      continue;
    }
    if (other != nullptr && !(s.is_open() && other->is_open() && s.balance + other->balance == 0)) return false;
  }
  return !do_see_common_edge({from, to, at_from.faces}, {to, from, at_to.faces});
}

}  // namespace remesh
