#include "core/refinement/sizes/wedges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/refinement/sizes/patch_contacts.h"

namespace remesh {
namespace {

/// Two patches that meet at less than this angle make a wedge. The constant is the sine of half the angle, 30 degrees.
constexpr double kSineOfHalfWedge = 0.5;
/// At an edge with more faces than this, no wedges are searched.
constexpr std::size_t kMaxFacesOfWedge = 8;
/// The way over an edge may be longer by this factor than at places that are directly opposite each other.
constexpr double kAskew = 2;

}  // namespace

Wedges::Wedges(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, const PatchSlabs& slabs,
               double feature_angle_deg, RunControl& control)
    : surface_(&surface), side_of_(patches.count()) {
  const double feature = std::sin(feature_angle_deg * std::numbers::pi / 360);
  UnionFind sides(patches.count());
  struct IntoPatch {
    PatchId patch;
    Vec3 way;  ///< across the edge, into the patch
  };
  std::vector<IntoPatch> around;
  struct Sharp {
    PatchId p, q;
    VertexId a, b;
    double sine;  ///< of half the angle
  };
  std::vector<Sharp> sharp;
  StopCheck check(control);
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    check();
    const auto half_edges = adjacency.half_edges(EdgeId(e));
    if (half_edges.size() < 2 || half_edges.size() > kMaxFacesOfWedge) continue;
    if (half_edges.size() == 2 && !is_patch_boundary(adjacency, patches, half_edges[0])) continue;
    around.clear();
    for (const std::uint32_t h : half_edges) {
      const Vec3 &a = surface.local[adjacency.from(h)], &b = surface.local[adjacency.to(h)];
      const PatchId p = patches.of_face[adjacency.face_of(h)];
      const Vec3 way = cross(slabs.normal(p, 0.5 * (a + b)), b - a);
      if (const double length = norm(way); length > 0) around.push_back({p, (1 / length) * way});
    }
    for (std::size_t i = 0; i < around.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const auto& [p, out] = around[i];
        const auto& [q, there] = around[j];
        if (p == q) continue;
        if (0.5 * norm(out + there) < feature) sides.join(p.value, q.value);
        const double sine = 0.5 * norm(out - there);
        if (sine < kSineOfHalfWedge)
          sharp.push_back({p, q, adjacency.from(half_edges[0]), adjacency.to(half_edges[0]), sine});
      }
  }
  if (sharp.empty()) return;
  for (std::uint32_t p = 0; p < patches.count(); ++p) side_of_[PatchId(p)] = sides.find(p);
  edges_.reserve(sharp.size());
  for (const Sharp& s : sharp) {
    const auto [low, high] = std::minmax(side_of_[s.p], side_of_[s.q]);
    edges_.push_back({{low, high}, s.a, s.b, static_cast<float>(kAskew / s.sine)});
  }
  group_edges(control);
}

void Wedges::group_edges(RunControl& control) {
  sort_stoppable(edges_.begin(), edges_.end(), control, [](const Edge& x, const Edge& y) {
    return std::tie(x.sides, x.a, x.b) < std::tie(y.sides, y.a, y.b);
  });
  for (std::uint32_t begin = 0; begin < edges_.size();) {
    control.check();
    Group group{begin, begin, 0, kNoTree};
    for (; group.end < edges_.size() && edges_[group.end].sides == edges_[begin].sides; ++group.end)
      group.most = std::max(group.most, edges_[group.end].factor);
    if (group.end - begin > kManyEdges) {
      std::vector<BoxTree<Factor>::Entry> entries;
      entries.reserve(group.end - begin);
      for (std::uint32_t e = begin; e < group.end; ++e) {
        FloatBox box;
        box.add(surface_->local[edges_[e].a]);
        box.add(surface_->local[edges_[e].b]);
        entries.push_back({box, {edges_[e].factor}});
      }
      group.tree = static_cast<std::uint32_t>(trees_.size());
      trees_.emplace_back(entries, control);
    }
    groups_.push_back(group);
    begin = group.end;
  }
}

bool Wedges::is_across(const Edge& edge, const Vec3& from, const Vec3& to, double distance) const {
  return way_over(surface_->local[edge.a], surface_->local[edge.b], from, to) <= double{edge.factor} * distance;
}

bool Wedges::is_across(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double distance) const {
  if (edges_.empty()) return false;
  const auto [low, high] = std::minmax(side_of_[p], side_of_[q]);
  const std::array sides{low, high};
  const auto group = std::lower_bound(groups_.begin(), groups_.end(), sides,
                                      [&](const Group& g, const auto& of) { return edges_[g.begin].sides < of; });
  if (group == groups_.end() || edges_[group->begin].sides != sides) return false;
  if (group->tree == kNoTree)
    return std::any_of(edges_.begin() + group->begin, edges_.begin() + group->end,
                       [&](const Edge& edge) { return is_across(edge, from, to, distance); });
  const BoxTree<Factor>& tree = trees_[group->tree];
  bool is_found = false;
  // The search ends as soon as it has found an edge over which the way is short enough.
  double best = std::nextafter(0.0, 1.0);
  tree.search(
      best,
      [&](const auto& entry) {
        const double way = std::sqrt(squared_distance(entry.box, from)) + std::sqrt(squared_distance(entry.box, to));
        return std::max(0.0, way - double{entry.tag.most} * distance);
      },
      [&](std::size_t slot) {
        is_found = is_found || is_across(edges_[group->begin + tree.number(slot)], from, to, distance);
        if (is_found) best = -1;
      });
  return is_found;
}

}  // namespace remesh
