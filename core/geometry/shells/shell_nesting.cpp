#include "core/geometry/shells/shell_nesting.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/trees/box_tree.h"

namespace remesh {
namespace {

/// The volumes of shells that coincide differ only by rounding, by at most this fraction.
constexpr double kSameVolume = 1e-9;

/// A point counts as touching a shell if it is nearer to it than this fraction of its own shell's extent.
constexpr double kTouch = 1e-12;

/// The number of triangles that are tested between two checks for cancellation.
constexpr std::size_t kTrianglesBetweenChecks = 4096;

/// The number of shells per task. It is small because their work varies.
constexpr std::size_t kShellsPerBlock = 16;

/// The directions in which a shell's outermost vertices are searched. Later, other shells are searched in the first
/// direction, because on that way there is no part of the shell itself and nothing inside it.
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

double volume(const Box3& box) {
  return box.is_empty() ? 0 : (box.max.x - box.min.x) * (box.max.y - box.min.y) * (box.max.z - box.min.z);
}

/// Returns whether half of a box's volume or more is in another box.
bool is_half_in(const Box3& box, const Box3& other) {
  Box3 both;
  for (int axis = 0; axis < 3; ++axis) {
    both.min[axis] = std::max(box.min[axis], other.min[axis]);
    both.max[axis] = std::min(box.max[axis], other.max[axis]);
    if (both.min[axis] > both.max[axis]) return false;
  }
  return 2 * volume(both) >= volume(box);
}

void sort_out(std::vector<std::uint32_t>& numbers) { sort_unique(numbers); }

/// The smallest number of a nest in a node of a tree.
struct FirstNest {
  std::uint32_t nest = kNone;
  void join(FirstNest other) { nest = std::min(nest, other.nest); }
};

struct Crossing {
  int turns = 0;  ///< 1 in the direction of the triangle's normal, -1 against it, 0 if the line misses the triangle
  bool is_beyond = false;  ///< the crossing is on the way from p along x, not against it
};

/// Computes how the line through p along x crosses a triangle. The point p is treated as if it were moved by an
/// infinitesimal, so that a line through an edge crosses exactly one of the faces there.
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

/// The x at which the line through p along x crosses a triangle's plane, up to rounding.
double where_passed(const Corners3& triangle, const Vec3& p) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = cross(b - a, c - a);
  const double x = a.x - (normal.y * (p.y - a.y) + normal.z * (p.z - a.z)) / normal.x;
  const auto [low, high] = std::minmax({a.x, b.x, c.x});
  // If the plane is parallel to the line, any value in the triangle's range will do.
  return std::isfinite(x) ? std::clamp(x, low, std::max(low, std::min(high, p.x))) : std::min(high, p.x);
}

/// Returns whether an edge of `s` passes through the inside of `t`.
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

/// Points of a shell. They are the same for any order of its faces: first the outermost vertices, then the midpoints,
/// up to rounding, of its longest edge and of its largest face in each direction.
struct ShellNesting::Samples {
  std::array<Vec3, kDirections.size()> vertices;
  /// Never empty. The first one is on a face that faces -x, so that a line from there meets the shells that stand
  /// beside.
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
    for (std::size_t i = begin; i < end; ++i) links[i] = link_of(inner[i], Tellers::kAll);
  });
  correct(inner, links);
  follow(inner, links);
}

/// Corrects links. If the link of a shell leads to a second shell, and that one crosses a third which may contain the
/// first, then it does not follow from the second shell where the first one lies. Instead, a link is looked for among
/// the shells that may contain the first one.
void ShellNesting::correct(const std::vector<std::uint32_t>& inner, std::vector<Link>& links) const {
  const auto is_beside = [&](std::size_t i) { return links[i].nest != kNone && !links[i].is_within; };
  std::vector<std::uint32_t> beside;
  for (std::size_t i = 0; i < inner.size(); ++i)
    if (is_beside(i)) beside.push_back(links[i].nest);
  sort_unique(beside, control_);
  std::vector<std::vector<std::uint32_t>> crossed(beside.size());
  for_blocks(beside.size(), kShellsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) crossed[i] = crossed_by(beside[i]);
  });
  for_blocks(inner.size(), kShellsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_beside(i)) continue;
      const auto at = std::lower_bound(beside.begin(), beside.end(), links[i].nest) - beside.begin();
      const std::vector<std::uint32_t>& others = crossed[static_cast<std::size_t>(at)];
      if (std::any_of(others.begin(), others.end(), [&](std::uint32_t other) { return may_contain(other, inner[i]); }))
        links[i] = link_of(inner[i], Tellers::kLarger);
    }
  });
}

/// Finds the nest around each inner nest, by its link. The nests are visited by ascending x, because a link leads to a
/// nest that begins at a smaller x, or at the same x and is larger.
void ShellNesting::follow(const std::vector<std::uint32_t>& inner, const std::vector<Link>& links) {
  std::vector<std::uint32_t> order(inner.size());
  std::iota(order.begin(), order.end(), 0u);
  sort_stoppable(order.begin(), order.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(boxes_[inner[a]].min.x, a) < std::tuple(boxes_[inner[b]].min.x, b);
  });
  StopCheck check(control_);
  for (const std::uint32_t i : order) {
    check();
    nests_[inner[i]].around = around(links[i], inner[i]);
  }
}

/// The nest around a shell of `nest` that has this link. `nest` itself need not have been followed yet.
std::uint32_t ShellNesting::around(const Link& link, std::uint32_t nest) const {
  if (link.nest == kNone || link.is_within) return link.nest;
  // If shells cross, or touch up to rounding, the other shell may lie in shells that do not contain this one.
  std::uint32_t around = nests_[link.nest].around;
  while (around != kNone && !may_contain(around, nest)) {
    control_.check();
    around = nests_[around].around;
  }
  return around;
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
    if (i % kTrianglesBetweenChecks == 0) control_.check_and_move();
    std::optional<Samples> samples;
    if (is_like_last(i) || (i + 1 < solids.size() && is_like_last(i + 1))) samples = samples_of(solids[i]);
    // Shells in the same place have the same outermost vertices, however they are triangulated.
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

/// The nests whose boxes lie in the box of an earlier one, ascending. Most meshes with many parts have few.
std::vector<std::uint32_t> ShellNesting::nests_in_boxes() const {
  if (nests_.size() < 2) return {};
  using Tree = BoxTree<FirstNest>;
  const auto entries = Tree::make_entries(nests_.size(), control_, [&](std::size_t n, Tree::Entry& entry) {
    entry.box.add(boxes_[n].min);
    entry.box.add(boxes_[n].max);
    entry.tag.nest = static_cast<std::uint32_t>(n);
  });
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
    if (f % kTrianglesBetweenChecks == 0) control_.check_and_move();
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
  // The first entry is the middle of an edge. The others are middles of faces, by the axis to which their normals are
  // nearest, in either direction.
  std::array<Middle, 7> middles;
  std::size_t looks = 0;
  for (const std::uint32_t f : (*faces_)[shell]) {
    if (looks++ % kTrianglesBetweenChecks == 0) control_.check_and_move();
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
  std::swap(middles[0], middles[shells_.all[shell].volume > 0 ? 2 : 1]);
  for (const Middle& middle : middles)
    if (middle.size > 0) samples.middles.push_back(middle.place);
  return samples;
}

/// Finds the link of a nest with a point of its shell that touches no shell which may contain it. If shells touch only
/// in places, one of the outermost vertices is such a point, or else the middle of an edge or of a face.
ShellNesting::Link ShellNesting::link_of(std::uint32_t nest, Tellers tellers) const {
  const double touch = touch_of(nest);
  const Samples samples = samples_of(nests_[nest].shells[0]);
  for (const std::span<const Vec3> points :
       {std::span(samples.middles).first(1), std::span<const Vec3>(samples.vertices),
        std::span(samples.middles).subspan(1)})
    for (const Vec3& p : points)
      if (!is_touching(p, touch, nest)) return nearest(p, touch, nest, tellers);
  return nearest(samples.vertices[0], touch, nest, tellers);
}

/// A point nearer to a nest's shell than this counts as touching it.
double ShellNesting::touch_of(std::uint32_t nest) const {
  const Box3& box = boxes_[nest];
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::fabs(box.min[axis]), std::fabs(box.max[axis])});
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  return std::max(kTouch * box.diagonal(), kRounding * largest);
}

bool ShellNesting::is_touching(const Vec3& p, double reach, std::uint32_t nest) const {
  const Vec3 margin{reach, reach, reach};
  bool is_touching = false;
  std::size_t looks = 0;
  tree_->visit_meeting({p - margin, p + margin}, 0, [&](std::size_t slot) {
    if (++looks % kTrianglesBetweenChecks == 0) control_.check_and_move();
    const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
    if (!may_contain(other, nest)) return true;
    const Corners3 t = corners3(f);
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    // Most triangles' planes are far from p. Twice the distance leaves room for rounding.
    if (std::fabs(dot(normal, p - t[0])) > 2 * reach * norm(normal)) return true;
    is_touching = norm(nearest_on_triangle(p, t) - p) <= reach;
    return !is_touching;
  });
  return is_touching;
}

/// Returns whether the place of this nest's shell may follow from the place of another shell. If the other shell is the
/// nearest one seen from this one and does not contain it, both lie in the same shell. Otherwise a shell that contains
/// only one of them would be nearer, because such shells count, too.
bool ShellNesting::may_tell(std::uint32_t other, std::uint32_t nest) const {
  return may_contain(other, nest) || boxes_[other].min.x < boxes_[nest].min.x;
}

/// Finds the nearest face, from p in the direction of -x, of a shell from which the place of this nest may follow. If
/// many shells stand in a row, that face is near.
ShellNesting::Link ShellNesting::nearest(const Vec3& p, double tie, std::uint32_t nest, Tellers tellers) const {
  struct Hit {
    double x;
    Link link;
  };
  std::vector<Hit> hits;
  std::size_t looks = 0;
  // The search goes in ever larger steps, so that far faces are tested only if there are no near ones.
  double reach = boxes_[nest].diagonal() / static_cast<double>(faces_of_tree_.size());
  constexpr double kStep = 16;
  for (bool is_last = false; !is_last && hits.empty(); reach *= kStep) {
    is_last = !(p.x - reach > end_) || !(reach > 0);
    const double begin = is_last ? end_ : p.x - reach;
    tree_->visit_meeting({Vec3{begin, p.y, p.z}, p}, 0, [&](std::size_t slot) {
      if (++looks % kTrianglesBetweenChecks == 0) control_.check_and_move();
      const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
      if (other == nest || !(tellers == Tellers::kAll ? may_tell(other, nest) : may_contain(other, nest))) return true;
      // There may be a nearer face outside the box.
      const Corners3 t = corners3(f);
      const double x = where_passed(t, p);
      if (!is_last && x < begin) return true;
      const auto [turns, is_beyond] = crossing(t, p);
      if (turns == 0 || is_beyond) return true;
      const bool is_from_inside = (turns < 0) == (shell_of(other).volume > 0);
      hits.push_back({x, {other, is_from_inside && may_contain(other, nest)}});
      return true;
    });
  }
  if (hits.empty()) return {};
  double nearest_x = -HUGE_VAL;
  for (const Hit& hit : hits) nearest_x = std::max(nearest_x, hit.x);
  // If faces of several shells lie on each other, the innermost shell that contains this one counts. If none contains
  // it, the largest one counts, because the others may lie in it.
  Link best;
  for (const auto& [x, link] : hits) {
    if (x < nearest_x - tie) continue;
    const bool is_better = link.is_within != best.is_within
                               ? link.is_within
                               : (link.is_within ? link.nest > best.nest : link.nest < best.nest);
    if (best.nest == kNone || is_better) best = link;
  }
  return best;
}

/// The other nests that cross this one, ascending: an edge of theirs passes through a face of this nest's first shell,
/// or the other way round. Touching does not count. Where the boxes of faces separate too few of them, as around a
/// common apex, all nests whose boxes meet this one's count.
std::vector<std::uint32_t> ShellNesting::crossed_by(std::uint32_t nest) const {
  const auto faces = (*faces_)[nests_[nest].shells[0]];
  constexpr std::size_t kFacesPerBlock = 256, kMaxLooksPerFace = 256, kMaxLooksPerFaceOfTree = 32;
  const std::size_t most_looks = kMaxLooksPerFace * faces.size() + kMaxLooksPerFaceOfTree * faces_of_tree_.size();
  std::atomic<std::size_t> looks{0};
  const auto are_too_many = [&] { return looks.load(std::memory_order_relaxed) > most_looks; };
  std::vector<std::uint32_t> crossed;
  for (const std::vector<std::uint32_t>&of_block : map_blocks<std::vector<std::uint32_t>>(
           faces.size(), kFacesPerBlock, control_, [&](std::size_t begin, std::size_t end) {
             std::vector<std::uint32_t> found;
             for (std::size_t i = begin; i < end && !are_too_many(); ++i) {
               const Corners3 s = corners3(faces[i]);
               Box3 box;
               for (const Vec3& p : s) box.add(p);
               std::size_t looks_here = 0;
               tree_->visit_meeting(box, 0, [&](std::size_t slot) {
                 if (++looks_here % kTrianglesBetweenChecks == 0) control_.check_and_move();
                 const auto [f, other] = faces_of_tree_[tree_->face(slot).value];
                 if (other == nest || (!found.empty() && found.back() == other)) return true;
                 const Corners3 t = corners3(f);
                 if (passes_through(s, t) || passes_through(t, s)) found.push_back(other);
                 return true;
               });
               looks.fetch_add(looks_here, std::memory_order_relaxed);
             }
             sort_out(found);
             return found;
           }))
    crossed.insert(crossed.end(), of_block.begin(), of_block.end());
  // The order in which faces are looked at does not decide whether there are too many looks.
  if (are_too_many()) {
    crossed.clear();
    for (std::uint32_t other = 0; other < boxes_.size(); ++other)
      if (other != nest && do_meet(boxes_[other], boxes_[nest])) crossed.push_back(other);
  }
  sort_out(crossed);
  return crossed;
}

bool ShellNesting::is_place_in_doubt(std::uint32_t shell) const {
  const std::uint32_t nest = nest_of_[shell];
  if (!tree_ || nest == kNone) return false;
  for (const std::uint32_t other : crossed_by(nest))
    if (other == nests_[nest].around || is_half_in(boxes_[nest], boxes_[other])) return true;
  // The shell may cross the one around it only in edges.
  const double touch = touch_of(nest);
  const Samples samples = samples_of(nests_[nest].shells[0]);
  const auto is_told = [&](const Vec3& p, Tellers tellers) {
    return around(nearest(p, touch, nest, tellers), nest) == nests_[nest].around;
  };
  const auto is_elsewhere = [&](const Vec3& p) {
    return !is_touching(p, touch, nest) && !is_told(p, Tellers::kAll) && !is_told(p, Tellers::kLarger);
  };
  return std::any_of(samples.vertices.begin(), samples.vertices.end(), is_elsewhere) ||
         std::any_of(samples.middles.begin(), samples.middles.end(), is_elsewhere);
}

}  // namespace remesh
