#include "core/geometry/shell_nesting.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/distances.h"
#include "core/geometry/predicates.h"
#include "core/geometry/predicates_3d.h"

namespace remesh {
namespace {

/// Volumes of shells that coincide differ by rounding only, relative to themselves.
constexpr double kSameVolume = 1e-9;

/// A point nearer to a shell than this part of its own shell's extent counts as touching it.
constexpr double kTouch = 1e-12;

/// Triangles that are looked at between two points of cancellation.
constexpr std::size_t kLooksBetweenChecks = 4096;

/// Shells to a task: their work varies.
constexpr std::size_t kShellsPerBlock = 16;

/// The directions in which a shell's outermost vertices are looked for. The first is the one in which other shells are
/// looked for then: on the way there is nothing of the shell itself, nor of what lies in it.
constexpr std::array<Vec3, 14> kDirections{{{-1, 0, 0},
                                            {1, 0, 0},
                                            {0, 1, 0},
                                            {0, -1, 0},
                                            {0, 0, 1},
                                            {0, 0, -1},
                                            {1, 1, 1},
                                            {-1, -1, -1},
                                            {1, 1, -1},
                                            {-1, -1, 1},
                                            {1, -1, 1},
                                            {-1, 1, -1},
                                            {-1, 1, 1},
                                            {1, -1, -1}}};

auto box_key(const Box3& box) { return std::tie(box.min, box.max); }

bool contains(const Box3& outer, const Box3& inner) {
  for (int axis = 0; axis < 3; ++axis)
    if (inner.min[axis] < outer.min[axis] || inner.max[axis] > outer.max[axis]) return false;
  return true;
}

bool contains(const FloatBox& outer, const Box3& inner) {
  for (int axis = 0; axis < 3; ++axis)
    if (inner.min[axis] < outer.min[axis] || inner.max[axis] > outer.max[axis]) return false;
  return true;
}

/// The least number of a nest in a node of a tree.
struct FirstNest {
  std::uint32_t nest = ShellNesting::kNone;
  void join(FirstNest other) { nest = std::min(nest, other.nest); }
};

struct Crossing {
  int turns = 0;           ///< 1 in the direction of the triangle's normal, -1 against it, 0 not
  bool is_beyond = false;  ///< on the way from p along x; else against it
};

/// How the line through p along x passes a triangle in the direction of x. As if p were moved by an infinitesimal, so
/// that a line through an edge passes just one of the faces there.
Crossing crossing(const Corners3& triangle, const Vec3& p) {
  int turns = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = triangle[i], &to = triangle[(i + 1) % 3];
    const bool is_up = from.z <= p.z && p.z < to.z, is_down = to.z <= p.z && p.z < from.z;
    if (!is_up && !is_down) continue;
    const int side = orient2d({from.y, from.z}, {to.y, to.z}, {p.y, p.z});
    if (is_up && side > 0) ++turns;
    if (is_down && side < 0) --turns;
  }
  if (turns == 0) return {};
  return {turns, orient3d(triangle[0], triangle[1], triangle[2], p) * turns < 0};
}

/// The place along x where the line through p along x passes a triangle's plane, as far as rounding tells.
double where_passed(const Corners3& triangle, const Vec3& p) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = cross(b - a, c - a);
  const double x = a.x - (normal.y * (p.y - a.y) + normal.z * (p.z - a.z)) / normal.x;
  const auto [low, high] = std::minmax({a.x, b.x, c.x});
  // Where the plane runs along the line, anywhere in the triangle's range will do.
  return std::isfinite(x) ? std::clamp(x, low, std::max(low, std::min(high, p.x))) : std::min(high, p.x);
}

/// Does an edge of `s` pass through the inside of `t`?
bool passes_through(const Corners3& s, const Corners3& t) {
  std::array<int, 3> side;
  for (std::size_t i = 0; i < 3; ++i) side[i] = orient3d(t[0], t[1], t[2], s[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (side[i] * side[j] >= 0) continue;
    const int first = orient3d(s[i], s[j], t[0], t[1]);
    if (first != 0 && first == orient3d(s[i], s[j], t[1], t[2]) && first == orient3d(s[i], s[j], t[2], t[0]))
      return true;
  }
  return false;
}

}  // namespace

/// Points of a shell, the same for any order of its faces: outermost vertices, then middles, to rounding, of its
/// longest edge and of its largest face of each direction.
struct ShellNesting::Samples {
  std::array<Vec3, kDirections.size()> vertices;
  std::vector<Vec3> middles;
};

ShellNesting::ShellNesting(std::span<const Vec3> positions, std::span<const VertexId> corners, const Shells& shells,
                           RunControl& control)
    : positions_(positions), corners_(corners), shells_(shells), control_(control) {
  group_by_place();
  const std::vector<std::uint32_t> inner = nests_in_boxes();
  if (inner.empty()) return;
  make_tree();
  std::vector<Link> links(inner.size());
  for_blocks(inner.size(), kShellsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) links[i] = link_of(inner[i]);
  });
  // What a link leads to comes before it.
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const Link& link = links[i];
    if (link.nest != kNone) nests_[inner[i]].around = link.is_within ? link.nest : nests_[link.nest].around;
  }
}

void ShellNesting::group_by_place() {
  std::vector<std::uint32_t> solids;
  for (std::uint32_t s = 0; s < shells_.all.size(); ++s)
    if (shells_.all[s].is_solid()) solids.push_back(s);
  const auto volume = [&](std::uint32_t s) { return std::fabs(shells_.all[s].volume); };
  const auto box = [&](std::uint32_t s) { return box_key(shells_.all[s].box); };
  sort_stoppable(solids.begin(), solids.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(box(a), -volume(a), a) < std::tuple(box(b), -volume(b), b);
  });
  control_.check();
  const auto is_alike = [&](std::uint32_t a, std::uint32_t b) {
    return box(a) == box(b) && volume(b) >= (1 - kSameVolume) * volume(a);
  };
  const auto is_like_last = [&](std::size_t i) { return i > 0 && is_alike(solids[i - 1], solids[i]); };
  bool has_alike = false;
  for (std::size_t i = 0; i < solids.size() && !has_alike; ++i) has_alike = is_like_last(i);
  const auto make_faces = [&] {
    faces_ = group_by(
        corners_.size() / 3, shells_.all.size(), [&](std::uint32_t f) { return shells_.of_face[f]; }, control_);
  };
  if (has_alike) make_faces();
  std::optional<Samples> samples_of_last;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    if (i % kLooksBetweenChecks == 0) control_.check();
    std::optional<Samples> samples;
    if (is_like_last(i) || (i + 1 < solids.size() && is_like_last(i + 1))) samples = samples_of(solids[i]);
    // In the same place they have the same outermost vertices, however they are triangulated.
    if (is_like_last(i) && samples->vertices == samples_of_last->vertices)
      nests_.back().shells.push_back(solids[i]);
    else
      nests_.push_back({{solids[i]}, kNone});
    samples_of_last = std::move(samples);
  }
  sort_stoppable(nests_.begin(), nests_.end(), control_, [&](const Nest& a, const Nest& b) {
    const std::uint32_t s = a.shells[0], t = b.shells[0];
    return std::tuple(-volume(s), box(s), s) < std::tuple(-volume(t), box(t), t);
  });
  nest_of_.assign(shells_.all.size(), kNone);
  for (std::uint32_t n = 0; n < nests_.size(); ++n) {
    boxes_.push_back(shells_.all[nests_[n].shells[0]].box);
    for (const std::uint32_t s : nests_[n].shells) nest_of_[s] = n;
  }
  if (nests_.size() > 1 && !faces_) make_faces();
}

bool ShellNesting::may_contain(std::uint32_t outer, std::uint32_t inner) const {
  return outer < inner && contains(boxes_[outer], boxes_[inner]);
}

/// The nests whose boxes lie in the box of an earlier one, ascending. Most meshes of many parts have few.
std::vector<std::uint32_t> ShellNesting::nests_in_boxes() const {
  if (nests_.size() < 2) return {};
  using Tree = BoxTree<FirstNest>;
  std::vector<Tree::Entry> entries(nests_.size());
  for (std::uint32_t n = 0; n < nests_.size(); ++n) {
    if (n % kLooksBetweenChecks == 0) control_.check();
    entries[n].box.add(boxes_[n].min);
    entries[n].box.add(boxes_[n].max);
    entries[n].tag.nest = n;
  }
  const Tree tree(entries, control_);
  return select_ids<std::uint32_t>(nests_.size(), kShellsPerBlock, control_, [&](std::size_t i) {
    const auto nest = static_cast<std::uint32_t>(i);
    double best = 1;
    const auto bound = [&](const Tree::Entry& entry) {
      return entry.tag.nest < nest && contains(entry.box, boxes_[nest]) ? 0 : HUGE_VAL;
    };
    tree.search(best, bound, [&](std::size_t slot) {
      if (may_contain(tree.number(slot), nest)) best = 0;
    });
    return best == 0;
  });
}

void ShellNesting::make_tree() {
  std::vector<Triangle> triangles;
  for (std::uint32_t f = 0; f < shells_.of_face.size(); ++f) {
    if (f % kLooksBetweenChecks == 0) control_.check();
    const std::uint32_t shell = shells_.of_face[f];
    if (nest_of_[shell] == kNone || nests_[nest_of_[shell]].shells[0] != shell) continue;
    triangles.push_back(triangle(f));
    faces_of_tree_.push_back({f, nest_of_[shell]});
  }
  tree_.emplace(positions_, triangles, control_);
  end_ = HUGE_VAL;
  for (std::uint32_t n = 0; n < nests_.size(); ++n) end_ = std::min(end_, boxes_[n].min.x);
}

ShellNesting::Samples ShellNesting::samples_of(std::uint32_t shell) const {
  struct Middle {
    double size = 0;
    Vec3 place;
    bool operator<(const Middle& other) const { return std::tie(size, place) < std::tie(other.size, other.place); }
  };
  using Outermost = std::pair<double, Vec3>;
  std::array<Outermost, kDirections.size()> vertices;
  vertices.fill({-HUGE_VAL, {}});
  std::array<Middle, 7> middles;  // of an edge; of faces by the axis that they face most, either way
  std::size_t looks = 0;
  for (const std::uint32_t f : (*faces_)[shell]) {
    if (looks++ % kLooksBetweenChecks == 0) control_.check();
    const Corners3 t = corners3(f);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t d = 0; d < kDirections.size(); ++d)
        vertices[d] = std::max(vertices[d], Outermost(dot(kDirections[d], t[i]), t[i]));
      const Vec3 &from = std::min(t[i], t[(i + 1) % 3]), &to = std::max(t[i], t[(i + 1) % 3]);
      middles[0] = std::max(middles[0], Middle{norm_squared(to - from), 0.5 * from + 0.5 * to});
    }
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (std::fabs(normal[static_cast<int>(i)]) > std::fabs(normal[static_cast<int>(axis)])) axis = i;
    Middle& middle = middles[1 + 2 * axis + (normal[static_cast<int>(axis)] < 0 ? 1 : 0)];
    constexpr double kThird = 1.0 / 3;
    middle = std::max(middle, Middle{norm(normal), kThird * t[0] + kThird * t[1] + kThird * t[2]});
  }
  Samples samples;
  for (std::size_t d = 0; d < vertices.size(); ++d) samples.vertices[d] = vertices[d].second;
  for (const Middle& middle : middles)
    if (middle.size > 0) samples.middles.push_back(middle.place);
  return samples;
}

/// By a point of the shell that is clear of all that may contain it. Where shells touch in places only, one of its
/// outermost vertices is clear, or else a middle of an edge or of a face.
ShellNesting::Link ShellNesting::link_of(std::uint32_t nest) const {
  const Box3& box = boxes_[nest];
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::fabs(box.min[axis]), std::fabs(box.max[axis])});
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  const double touch = std::max(kTouch * box.diagonal(), kRounding * largest);
  const Samples samples = samples_of(nests_[nest].shells[0]);
  for (const Vec3& p : samples.vertices)
    if (!is_touching(p, touch, nest)) return nearest(p, touch, nest);
  for (const Vec3& p : samples.middles)
    if (!is_touching(p, touch, nest)) return nearest(p, touch, nest);
  return nearest(samples.vertices[0], touch, nest);
}

bool ShellNesting::is_touching(const Vec3& p, double reach, std::uint32_t nest) const {
  const Vec3 margin{reach, reach, reach};
  bool is_touching = false;
  std::size_t looks = 0;
  tree_->visit_meeting({p - margin, p + margin}, 0, [&](std::size_t slot) {
    if (++looks % kLooksBetweenChecks == 0) control_.check();
    const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
    if (!may_contain(other, nest)) return true;
    const Corners3 t = corners3(f);
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    // Most are far from their plane. Twice the distance leaves room for rounding.
    if (std::fabs(dot(normal, p - t[0])) > 2 * reach * norm(normal)) return true;
    is_touching = norm(nearest_on_triangle(p, t) - p) <= reach;
    return !is_touching;
  });
  return is_touching;
}

/// The nearest face, in the direction of -x from p, of a shell that may contain this nest's. Either its shell does, or
/// both lie in the same: a shell between the two that contains one of them contains both.
ShellNesting::Link ShellNesting::nearest(const Vec3& p, double tie, std::uint32_t nest) const {
  struct Hit {
    double x;
    Link link;
  };
  std::vector<Hit> hits;
  std::size_t looks = 0;
  // In ever larger steps: what is far is looked at only where nothing is near.
  double reach = boxes_[nest].diagonal() / static_cast<double>(faces_of_tree_.size());
  constexpr double kStep = 16;
  for (bool is_last = false; !is_last && hits.empty(); reach *= kStep) {
    is_last = !(p.x - reach > end_) || !(reach > 0);
    const double begin = is_last ? end_ : p.x - reach;
    tree_->visit_meeting({Vec3{begin, p.y, p.z}, p}, 0, [&](std::size_t slot) {
      if (++looks % kLooksBetweenChecks == 0) control_.check();
      const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
      if (!may_contain(other, nest)) return true;
      // There may be a nearer one outside the box.
      const Corners3 t = corners3(f);
      const double x = where_passed(t, p);
      if (!is_last && x < begin) return true;
      const auto [turns, is_beyond] = crossing(t, p);
      if (turns != 0 && !is_beyond) hits.push_back({x, {other, (turns < 0) == (shell_of(other).volume > 0)}});
      return true;
    });
  }
  if (hits.empty()) return {};
  double nearest_x = -HUGE_VAL;
  for (const Hit& hit : hits) nearest_x = std::max(nearest_x, hit.x);
  // Where faces of several shells lie on each other, the innermost that contains this one counts.
  Link best;
  for (const auto& [x, link] : hits) {
    if (x < nearest_x - tie) continue;
    const auto key = [](const Link& l) { return std::pair(l.is_within, l.nest); };
    if (best.nest == kNone || key(best) < key(link)) best = link;
  }
  return best;
}

bool ShellNesting::is_crossing(std::uint32_t shell) const {
  if (!tree_) return false;
  const auto faces = (*faces_)[shell];
  std::atomic<bool> is_crossing = false;
  constexpr std::size_t kFacesPerBlock = 256;
  for_blocks(faces.size(), kFacesPerBlock, control_, [&](std::size_t begin, std::size_t end) {
    std::size_t looks = 0;
    for (std::size_t i = begin; i < end && !is_crossing; ++i) {
      const Corners3 s = corners3(faces[i]);
      Box3 box;
      for (const Vec3& p : s) box.add(p);
      tree_->visit_meeting(box, 0, [&](std::size_t slot) {
        if (++looks % kLooksBetweenChecks == 0) control_.check();
        const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
        if (other == nest_of_[shell]) return true;
        const Corners3 t = corners3(f);
        if (passes_through(s, t) || passes_through(t, s)) is_crossing = true;
        return !is_crossing.load();
      });
    }
  });
  return is_crossing;
}

}  // namespace remesh
