#include "core/verify/goals/gap_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/mending/polygons/polygon_split.h"

namespace remesh::verification {
namespace {

/// The relative margin by which a test must be met to count as clear. It is far more than the rounding errors of
/// well-shaped triangles.
constexpr double kMargin = 1e-6;
/// A bound on the distance by which rounding moves a point, in local units.
constexpr double kRounding = 0x1p-44;

/// The length of the way from p to q over the straight line a-b, with both sides unfolded into one plane.
double length_over(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 line = b - a;
  const double squared = norm_squared(line);
  if (!(squared > 0)) return norm(p - a) + norm(q - a);
  const double s = dot(p - a, line) / squared, t = dot(q - a, line) / squared;
  const double height = norm(p - (a + s * line)), depth = norm(q - (a + t * line));
  // The straight way crosses the line between s and t, in the ratio of the two heights. If the crossing is not on the
  // line, the way passes through an end.
  const double across = height + depth > 0 ? (s * depth + t * height) / (height + depth) : s;
  const Vec3 by = a + std::clamp(across, 0.0, 1.0) * line;
  return norm(p - by) + norm(q - by);
}

}  // namespace

GapCheck::GapCheck(const Claim& claim, const NumberedClaim& numbered, const BoundaryGraph& seams, RunControl& control)
    : numbered_(numbered) {
  // Coordinates are relative to the middle of the surface, so that single precision can distinguish its parts wherever
  // the surface lies.
  Box3 box;
  for (std::size_t v = 0; v < numbered.surface_vertex_count; ++v) box.add(numbered.points[v]);
  centre_ = 0.5 * box.min + 0.5 * box.max;
  const double reach = largest_coordinate(box.max - centre_);
  unit_ = reach > 0 ? 1 / reach : 1;
  // The refiner's places are rounded as model coordinates, and this rounding grows with the distance from the origin.
  rounding_ = kRounding * (1 + unit_ * largest_coordinate(centre_));
  min_height_ = unit_ * numbered.scale * claim.refinement->goals.min_gap;
  find_facets(claim, control);
  find_bodies(seams, control);
  find_contacts(control);
  find_borders(seams, control);
  if (numbered.has_curved()) find_sides();
  find_wedges(seams, claim.refinement->goals.feature_angle_deg, control);
  if (claim.intersections != nullptr) {
    crossing_ = claim.intersections->patches;
    is_crossing_known_ = claim.intersections->is_complete;
  }
}

/// The first triangle of a curved patch shows which way all its triangles look.
void GapCheck::find_sides() {
  is_turned_.assign(numbered_.patch_count(), 0);
  for (std::size_t slot = triangles_.size(); slot-- > 0;) {
    const PatchId p = facets_[slot].tag.patch;
    if (!is_curved(p)) continue;
    const auto& [a, b, c] = corners(slot);
    const Vec3 middle = centre_ + (1 / (3 * unit_)) * (a + b + c);
    is_turned_[p.value] = dot(cross(b - a, c - a), numbered_.curved_surface(p)->shape.normal(middle)) < 0 ? 1 : 0;
  }
}

Vec3 GapCheck::normal(PatchId p, const Vec3& place) const {
  if (!is_curved(p)) return numbered_.normal(p);
  const Vec3 outwards = numbered_.curved_surface(p)->shape.normal(centre_ + (1 / unit_) * place);
  return is_turned_[p.value] != 0 ? -outwards : outwards;
}

void GapCheck::find_facets(const Claim& claim, RunControl& control) {
  std::vector<PatchId> patch_of;
  for (std::uint32_t f = 0; f < numbered_.input.count(); ++f) {
    if (f % kItemsPerBlock == 0) control.check_and_move();
    visit_triangles(claim.surface, FaceId(f), control, [&](const Triangle& t) {
      triangles_.push_back({t[0], t[1], t[2]});
      patch_of.push_back(numbered_.input.patch[f]);
    });
  }
  const auto entries = Facets::make_entries(triangles_.size(), control, [&](std::size_t i, Facets::Entry& entry) {
    entry.tag.patch = patch_of[i];
    for (const VertexId v : triangles_[i]) entry.box.add(point(v));
  });
  facets_ = Facets(entries, control);
}

/// Joins patches over the edges that bound them. A body is closed and consistent if all of its edges are closed and
/// consistent.
void GapCheck::find_bodies(const BoundaryGraph& seams, RunControl& control) {
  UnionFind joined(numbered_.patch_count());
  std::vector<std::uint8_t> is_open(numbered_.patch_count(), 0);
  std::size_t looked_at = 0;
  for (const Edge& edge : seams.edges()) {
    if (looked_at++ % kItemsPerBlock == 0) control.check_and_move();
    const bool is_sound = edge.uses.size() == 2 && edge.uses[0].is_forward() != edge.uses[1].is_forward();
    for (const Use& use : edge.uses) joined.join(edge.uses[0].patch().value, use.patch().value);
    if (!is_sound) is_open[edge.uses[0].patch().value] = 1;
  }
  for (std::uint32_t p = 0; p < numbered_.patch_count(); ++p)
    if (is_open[p] != 0) is_open[joined.find(p)] = 1;
  body_.resize(numbered_.patch_count());
  for (std::uint32_t p = 0; p < numbered_.patch_count(); ++p)
    body_[p] = is_open[joined.find(p)] != 0 ? kOpen : joined.find(p);
}

void GapCheck::find_contacts(RunControl& control) {
  // Most vertices have one patch only. They are left out before anything is sorted.
  std::vector<PatchId> first(numbered_.surface_vertex_count);
  for (const bool is_second_time : {false, true})
    for (std::uint32_t f = 0; f < numbered_.input.count(); ++f) {
      if (f % kItemsPerBlock == 0) control.check_and_move();
      const PatchId p = numbered_.input.patch[f];
      for (const VertexId v : numbered_.input.face(f)) {
        if (!is_second_time && !first[v.value].is_valid()) first[v.value] = p;
        if (is_second_time && first[v.value] != p) contacts_.emplace_back(v, p);
      }
    }
  sort_unique(contacts_, control);
  const std::size_t others = contacts_.size();
  for (std::size_t i = 0; i < others; ++i)
    if (const VertexId v = contacts_[i].first; i == 0 || contacts_[i - 1].first != v)
      contacts_.emplace_back(v, first[v.value]);
  sort_stoppable(contacts_.begin(), contacts_.end(), control);
}

void GapCheck::find_borders(const BoundaryGraph& seams, RunControl& control) {
  std::size_t looked_at = 0;
  for (const Edge& edge : seams.edges()) {
    if (looked_at++ % kItemsPerBlock == 0) control.check_and_move();
    for (const Use& use : edge.uses) edges_.push_back({{edge.low, edge.high}, use.patch()});
  }
  const auto before = [](const auto& x, const auto& y) {
    return std::tie(x.first.a, x.first.b, x.second) < std::tie(y.first.a, y.first.b, y.second);
  };
  const auto same = [](const auto& x, const auto& y) {
    return std::tie(x.first.a, x.first.b, x.second) == std::tie(y.first.a, y.first.b, y.second);
  };
  sort_stoppable(edges_.begin(), edges_.end(), control, before);
  edges_.erase(std::unique(edges_.begin(), edges_.end(), same), edges_.end());
  const auto part = [&](std::uint32_t i) {
    if (i < edges_.size()) return edges_[i];
    const auto& [v, patch] = contacts_[i - edges_.size()];
    return std::pair(Part{v, v}, patch);
  };
  const auto patch_of = [&](std::uint32_t i) { return part(i).second.value; };
  const Grouping by_patch = group_by(edges_.size() + contacts_.size(), numbered_.patch_count(), patch_of, control);
  border_begin_ = by_patch.begin;
  border_parts_.reserve(by_patch.items.size());
  for (const std::uint32_t i : by_patch.items) border_parts_.push_back(part(i).first);
  border_tree_.assign(numbered_.patch_count(), kNoTree);
  for (std::size_t p = 0; p < numbered_.patch_count(); ++p) {
    if (p % kItemsPerBlock == 0) control.check_and_move();
    const std::span<const Part> border = border_of(PatchId(p));
    if (border.size() <= kLongBorder) continue;
    const auto entries = BoxTree<NoTag>::make_entries(border.size(), control, [&](std::size_t i, auto& entry) {
      for (const VertexId v : {border[i].a, border[i].b}) entry.box.add(point(v));
    });
    border_tree_[p] = static_cast<std::uint32_t>(trees_.size());
    trees_.emplace_back(entries, control);
  }
}

/// Measures edges with a margin, so that every possible wedge counts as one.
void GapCheck::find_wedges(const BoundaryGraph& seams, double feature_angle_deg, RunControl& control) {
  constexpr double kDoubt = 1e-3, kSineOfHalfWedge = 0.5, kFactor = 2;
  constexpr std::size_t kMaxFaces = 8;
  const double smooth = std::sin(feature_angle_deg * std::numbers::pi / 360) + kDoubt;
  UnionFind joined(numbered_.patch_count());
  std::vector<std::pair<PatchId, Vec3>> inwards;
  std::vector<std::pair<std::array<PatchId, 2>, Wedge>> sharp;
  std::size_t looked_at = 0;
  for (const Edge& edge : seams.edges()) {
    if (looked_at++ % kItemsPerBlock == 0) control.check_and_move();
    if (edge.uses.size() < 2 || edge.uses.size() > kMaxFaces) continue;
    const Vec3 a = point(edge.low), b = point(edge.high);
    inwards.clear();
    for (const Use& use : edge.uses) {
      const Vec3 way = cross(normal(use.patch(), 0.5 * (a + b)), use.is_forward() ? b - a : a - b);
      if (norm(way) > 0) inwards.emplace_back(use.patch(), normalized(way));
    }
    for (std::size_t i = 1; i < inwards.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (inwards[i].first == inwards[j].first) continue;
        if (norm(inwards[i].second + inwards[j].second) < 2 * smooth)
          joined.join(inwards[i].first.value, inwards[j].first.value);
        const double sine = norm(inwards[i].second - inwards[j].second) / 2;
        if (sine < kSineOfHalfWedge + kDoubt)
          sharp.push_back({{inwards[i].first, inwards[j].first},
                           {{}, edge.low, edge.high, (kFactor + kDoubt) / std::max(0.0, sine - kMargin)}});
      }
  }
  if (sharp.empty()) return;
  side_.resize(numbered_.patch_count());
  for (std::uint32_t p = 0; p < side_.size(); ++p) side_[p] = joined.find(p);
  for (auto& [patches, wedge] : sharp) {
    wedge.sides = std::minmax(side_[patches[0].value], side_[patches[1].value]);
    wedges_.push_back(wedge);
  }
  sort_stoppable(wedges_.begin(), wedges_.end(), control, [](const Wedge& v, const Wedge& w) {
    return std::tie(v.sides, v.a, v.b) < std::tie(w.sides, w.a, w.b);
  });
}

/// Returns whether the way over a wedge between the two patches may be as short as in a wedge.
/// Input: `length` - the max length of the straight way.
bool GapCheck::may_be_in_wedge(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double length,
                               std::size_t& looks) const {
  if (wedges_.empty()) return false;
  const std::pair<std::uint32_t, std::uint32_t> sides = std::minmax(side_[p.value], side_[q.value]);
  auto wedge = std::lower_bound(wedges_.begin(), wedges_.end(), sides,
                                [](const Wedge& w, const auto& wanted) { return w.sides < wanted; });
  for (; wedge != wedges_.end() && wedge->sides == sides; ++wedge) {
    if (++looks > kMaxLooks) return true;
    if (length_over(from, to, point(wedge->a), point(wedge->b)) <= wedge->factor * length) return true;
  }
  return false;
}

Corners3 GapCheck::corners(std::size_t slot) const {
  const auto& [a, b, c] = triangles_[facets_.number(slot)];
  return {point(a), point(b), point(c)};
}

bool GapCheck::are_crossing(PatchId p, PatchId q) const {
  return std::binary_search(crossing_.begin(), crossing_.end(), std::pair(std::min(p, q), std::max(p, q)));
}

bool GapCheck::is_at(VertexId v, PatchId p) const {
  return std::binary_search(contacts_.begin(), contacts_.end(), std::pair(v, p));
}

bool GapCheck::is_edge_of(const Part& part, PatchId p) const {
  const auto found = std::lower_bound(
      edges_.begin(), edges_.end(), std::tie(part.a, part.b, p),
      [](const auto& e, const auto& wanted) { return std::tie(e.first.a, e.first.b, e.second) < wanted; });
  return found != edges_.end() && found->first.a == part.a && found->first.b == part.b && found->second == p;
}

/// True if there is a way over the surface that is no longer than `most`.
bool GapCheck::is_over_surface(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double most,
                               std::size_t& looks) const {
  if (border_of(q).size() < border_of(p).size()) std::swap(p, q);
  const std::span<const Part> border = border_of(p);
  const auto is_short = [&](const Part& part) {
    ++looks;
    const bool is_shared = part.a == part.b ? is_at(part.a, q) : is_edge_of(part, q);
    return is_shared && length_over(from, to, point(part.a), point(part.b)) <= most;
  };
  if (border_tree_[p.value] == kNoTree) return std::any_of(border.begin(), border.end(), is_short);
  const BoxTree<NoTag>& tree = trees_[border_tree_[p.value]];
  bool is_found = false;
  double best = std::nextafter(most, HUGE_VAL);
  tree.search(
      best,
      [&](const auto& entry) {
        if (++looks > kMaxLooks) return HUGE_VAL;
        return std::sqrt(squared_distance(entry.box, from)) + std::sqrt(squared_distance(entry.box, to));
      },
      [&](std::size_t slot) {
        is_found = is_found || is_short(border[tree.number(slot)]);
        if (is_found) best = -1;
      });
  return is_found;
}

/// True if the patch has a point whose squared distance is smaller than `squared`.
bool GapCheck::is_any_nearer(PatchId q, const Vec3& to, double squared, std::size_t& looks) const {
  bool is_found = false;
  double best = squared * (1 - kMargin);
  facets_.search(
      best,
      [&](const Facets::Entry& entry) {
        if (++looks > kMaxLooks || (entry.tag.patch.is_valid() && entry.tag.patch != q)) return HUGE_VAL;
        return squared_distance(entry.box, to);
      },
      [&](std::size_t slot) {
        if (facets_[slot].tag.patch != q || !(norm_squared(nearest_on_triangle(to, corners(slot)) - to) < best)) return;
        is_found = true;
        best = -1;
      });
  return is_found;
}

/// Returns whether the straight way from `from`, a point of patch p, to `there`, a point of patch q, certainly crosses
/// a gap between the two patches.
/// Input: `there` - the point nearest to `from` on one of q's triangles.
bool GapCheck::is_clear_gap(const Vec3& from, PatchId p, const Vec3& there, PatchId q, std::size_t& looks) const {
  const Vec3 way = there - from;
  const double squared = norm_squared(way), d = std::sqrt(squared);
  // Both ends may be this far from the places for which sizes were made, because of the tolerance.
  const double off = 2 * unit_ * numbered_.tolerance + kMargin * d;
  const Vec3 up = normal(p, from);
  double rise = std::fabs(dot(way, up)), length = d;
  if (is_curved(p) || is_curved(q)) {
    // Both ends may be off their facets along the normals.
    const double across = squared - rise * rise;
    rise -= curved_tolerance(p) + curved_tolerance(q);
    length = std::sqrt(std::max(0.0, across) + rise * rise);
  }
  const double height = rise - off, steep = is_curved(p) ? kSteepAtCurved : kSteep;
  if (!(height > 0 && height * height > steep * (length + off) * (length + off))) return false;
  const bool is_one_body = body_[p.value] != kOpen && body_[p.value] == body_[q.value];
  if (is_one_body && !(dot(way, up) * dot(way, normal(q, there)) < -off * d)) return false;
  if (are_crossing(p, q) || may_be_in_wedge(p, from, q, there, d + 2 * off, looks)) return false;
  return !is_over_surface(p, from, q, there, kDetour * (d + off) + 2 * off, looks) &&
         !is_any_nearer(q, from, squared, looks);
}

/// Returns whether a gap that is too narrow to count may exist on the same side of patch p, no farther away than
/// `there`, a point across a gap. Parts that are not searched may contain such a gap.
/// Input: `there` - the point of patch q that is nearest to `from`.
bool GapCheck::may_be_narrow(const Vec3& from, PatchId p, const Vec3& there, PatchId q, std::size_t& looks) const {
  // If patches were divided into other triangles, other points might be the nearest ones. These are hidden up to about
  // the same distance.
  constexpr double kOfOtherPoints = 0.94;
  if (!(min_height_ > 0)) return false;
  const Vec3 up = dot(there - from, normal(p, from)) > 0 ? normal(p, from) : -normal(p, from);
  const double off = 2 * unit_ * numbered_.tolerance + curved_tolerance(p);
  const double narrow = min_height_ * (1 + kMargin) + off;
  if (dot(there - from, up) < narrow) return true;
  const double steep = is_curved(p) ? 0 : kSteep * (1 - kMargin);
  bool is_found = false;
  double best = norm_squared(there - from) * (1 + kMargin);
  facets_.search(
      best,
      [&](const Facets::Entry& entry) {
        const bool is_known = entry.tag.patch == p || (entry.tag.patch.is_valid() && entry.tag.patch == q);
        return ++looks > kMaxLooks || is_known ? HUGE_VAL : squared_distance(entry.box, from);
      },
      [&](std::size_t slot) {
        const Corners3 triangle = corners(slot);
        const Vec3 nearest = nearest_on_triangle(from, triangle);
        const double squared = norm_squared(nearest - from);
        const auto [lowest, highest] =
            std::minmax({dot(triangle[0] - from, up), dot(triangle[1] - from, up), dot(triangle[2] - from, up)});
        if (!(squared < best) || lowest > narrow || !(highest > 0 && highest * highest > steep * squared)) return;
        const double way = kOfOtherPoints * kDetour * std::sqrt(squared);
        if (is_over_surface(p, from, facets_[slot].tag.patch, nearest, way, looks)) return;
        is_found = true;
        best = -1;
      });
  return is_found || looks > kMaxLooks;
}

bool GapCheck::is_any_within(const Vec3& place, PatchId patch, double distance, Doubt doubt) const {
  const bool must_be_clear = doubt == Doubt::kIsNone;
  if (must_be_clear && !is_crossing_known_) return false;
  const Vec3 p = local(place);
  const Vec3 up = normal(patch, p);
  const double off = curved_tolerance(patch);
  const double reach = unit_ * distance + (must_be_clear ? -off : off);
  const double touching = must_be_clear ? unit_ * numbered_.tolerance * (1 + kMargin) + off + rounding_ : 0;
  if (!(reach > touching)) return false;
  // If a point is seen steeply, its height over the patch's plane is more than this share of its distance.
  const double steep = must_be_clear ? kSteep : is_curved(patch) ? 0 : kSteep * (1 - kMargin);
  // A triangle that is nowhere as high as the smallest gap that counts is no gap.
  const double narrow_off = 2 * unit_ * numbered_.tolerance + off + kMargin * min_height_;

  std::size_t looks = 0;
  bool is_found = false;
  double best = reach * reach;
  facets_.search(
      best,
      [&](const Facets::Entry& entry) {
        if (++looks > kMaxLooks || entry.tag.patch == patch) return HUGE_VAL;
        const double squared = squared_distance(entry.box, p);
        double middle = 0, range = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const double low = entry.box.min[axis], high = entry.box.max[axis];
          middle += up[axis] * (0.5 * (low + high) - p[axis]);
          range += std::fabs(up[axis]) * 0.5 * (high - low);
        }
        const double highest = std::fabs(middle) + range + kRounding;
        return highest * highest < steep * squared ? HUGE_VAL : squared;
      },
      [&](std::size_t slot) {
        if (looks > kMaxLooks) return;
        const Corners3 triangle = corners(slot);
        const Vec3 there = nearest_on_triangle(p, triangle);
        const double squared = norm_squared(there - p);
        if (!(squared < reach * reach)) return;
        // Facets that touch make no gap, but rounding decides whether two facets touch or just do not.
        if (must_be_clear) {
          if (!(squared > touching * touching)) return;
          is_found = is_clear_gap(p, patch, there, facets_[slot].tag.patch, looks) &&
                     !may_be_narrow(p, patch, there, facets_[slot].tag.patch, looks) && looks <= kMaxLooks;
        } else {
          double highest = 0;
          for (const Vec3& corner : triangle) highest = std::max(highest, std::fabs(dot(corner - p, up)));
          is_found = highest * highest > steep * squared && highest + narrow_off > min_height_;
        }
        if (is_found) best = -1;
      });
  return is_found || (looks > kMaxLooks && !must_be_clear);
}

}  // namespace remesh::verification
