#include "core/mending/details/remove_details.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mending/details/detail_complex.h"
#include "core/mending/details/detail_shapes.h"
#include "core/mending/details/narrow_notches.h"
#include "core/mending/details/tiny_components.h"

namespace remesh {
namespace {

/// If removing details has led to new intersections, these details stay in another attempt. This is the max number of
/// attempts.
constexpr int kMaxTries = 8;

/// Removes the details of one surface.
/// This class is larger than the bound because it treats two kinds of details with the same tests of shapes, links and
/// folds. The tests for narrow notches are in another class.
class DetailRemover {
 public:
  DetailRemover(const DetailRules& rules, const std::vector<std::uint8_t>& is_fixed, RunControl& control)
      : rules_(rules),
        complex_(rules.positions, rules.faces, control),
        is_fixed_(is_fixed),
        control_(control),
        work_(kWorkOfDetails.steps(rules.faces.size(), 0), &control),
        notches_(complex_, rules, is_fixed, work_) {
    DetailRules with_fixed = rules;
    with_fixed.is_fixed = is_fixed;
    tiny_components_ = find_tiny_components(with_fixed, control);
  }

  WithoutDetails run() {
    for (std::uint32_t t = 0; t < rules_.faces.size(); ++t)
      if (!tiny_components_.has(FaceId(t))) add_details_of(t);
    if (rules_.closes_narrow_notches)
      for (const std::uint32_t node : nodes_of_open_edges()) add_narrow_notch_at(node);
    while (!queue_.empty() && !work_.is_spent()) {
      control_.check();
      const Detail detail = queue_.top();
      queue_.pop();
      if (detail.kind == Kind::kEdge)
        remove_edge(detail);
      else if (detail.kind == Kind::kSliver)
        remove_sliver(detail);
      else
        close_narrow_notch(detail);
    }
    result_.is_effort_spent = work_.is_spent();
    return finish();
  }

 private:
  enum class Kind : std::uint8_t { kSliver, kEdge, kNarrowNotch };

  /// An edge between two nodes, a triangle over a crease, or a narrow notch.
  struct Detail {
    double size;
    Kind kind;
    std::uint32_t first, second;  ///< the edge's nodes; or the triangle, or the narrow notch's tip, twice
    /// Two places, the smaller one first: the ends of the edge, or of the triangle's longest edge; or the narrow
    /// notch's tip, twice.
    std::array<Vec3, 2> places;

    /// The smallest detail is the last in this order, since a priority queue serves the last one first.
    friend bool operator<(const Detail& a, const Detail& b) {
      return std::tie(b.size, b.kind, b.places, b.first, b.second) <
             std::tie(a.size, a.kind, a.places, a.first, a.second);
    }
  };

  /// The effect of a possible change on the triangles around it.
  struct Change {
    double lowest_before = std::numeric_limits<double>::infinity();
    double lowest_after = std::numeric_limits<double>::infinity();
    double bend = 0;  ///< how far planes and creases would be bent
  };

  void add_details_of(std::uint32_t triangle) {
    PresentTriangle t{};
    if (!complex_.find_present(triangle, t)) return;
    const Places places = places_of(t, complex_);
    const TriangleShape shape(places);
    for (int k = 0; k < 3; ++k)
      if (shape.length[k] < rules_.size)
        queue_.push({shape.length[k], Kind::kEdge, std::min(t.corners[k], t.corners[(k + 1) % 3]),
                     std::max(t.corners[k], t.corners[(k + 1) % 3]), in_order(places[k], places[(k + 1) % 3])});
    if (!shape.has_edge_below(rules_.size) && shape.height < rules_.size)
      queue_.push({shape.height, Kind::kSliver, triangle, triangle,
                   in_order(places[shape.longest], places[(shape.longest + 1) % 3])});
  }
  static std::array<Vec3, 2> in_order(const Vec3& a, const Vec3& b) {
    return a < b ? std::array{a, b} : std::array{b, a};
  }
  void add_details_at(std::uint32_t node) {
    complex_.collect(node, triangles_, work_);
    for (const PresentTriangle& t : triangles_) add_details_of(t.index);
    if (rules_.closes_narrow_notches) add_narrow_notch_at(node);
  }

  void add_narrow_notch_at(std::uint32_t node) {
    const std::optional<NarrowNotch> notch = notches_.find(node);
    const Vec3& place = complex_.place(node);
    if (notch) queue_.push({notch->width, Kind::kNarrowNotch, node, node, {place, place}});
  }

  /// Returns the nodes at edges of one face, ascending. Tiny components have none.
  std::vector<std::uint32_t> nodes_of_open_edges() const {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    control_.memory().ask_for<Edge>(3 * rules_.faces.size());
    std::vector<Edge> edges;
    edges.reserve(3 * rules_.faces.size());
    StopCheck check(control_);
    for (std::size_t f = 0; f < rules_.faces.size(); ++f) {
      check();
      if (tiny_components_.has(FaceId(f))) continue;
      for (std::size_t k = 0; k < 3; ++k)
        edges.push_back(std::minmax(rules_.faces[f][k].value, rules_.faces[f][(k + 1) % 3].value));
    }
    sort_stoppable(edges.begin(), edges.end(), control_);
    std::vector<std::uint32_t> nodes;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      check();
      while (end < edges.size() && edges[end] == edges[begin]) ++end;
      if (end - begin == 1) nodes.insert(nodes.end(), {edges[begin].first, edges[begin].second});
    }
    sort_unique(nodes, control_);
    return nodes;
  }

  void close_narrow_notch(const Detail& detail) {
    const std::uint32_t tip = detail.first;
    if (complex_.node_of(tip) != tip) return;
    const std::optional<NarrowNotch> notch = notches_.find(tip);
    if (!notch) return;
    if (notch->width != detail.size) {
      // The narrow notch has changed since it was found.
      add_narrow_notch_at(tip);
      return;
    }
    complex_.collect(tip, triangles_, work_);
    const FaceId at_tip = complex_.face_of(triangles_.front().index);
    const std::vector<std::uint32_t> joined = notches_.close(tip, *notch);
    if (joined.empty()) return;
    if (joined.size() == notch->steps.size())
      ++result_.closed_narrow_notches;
    else
      result_.joined_edges += joined.size();
    result_.at_narrow_notches.push_back(at_tip);
    for (const std::uint32_t node : joined)
      if (complex_.node_of(node) == node) add_details_at(node);
  }

  static std::size_t count_borders(const std::vector<Spoke>& spokes) {
    return static_cast<std::size_t>(
        std::count_if(spokes.begin(), spokes.end(), [](const Spoke& s) { return s.is_border; }));
  }
  bool is_fixed(std::uint32_t node) const { return node < is_fixed_.size() && is_fixed_[node] != 0; }

  void remove_edge(const Detail& detail) {
    const std::uint32_t u = detail.first, v = detail.second;
    if (complex_.node_of(u) != u || complex_.node_of(v) != v || is_fixed(u) || is_fixed(v)) return;
    std::vector<PresentTriangle> at_u, at_v;
    complex_.collect(u, at_u, work_);
    if (std::none_of(at_u.begin(), at_u.end(), [&](const PresentTriangle& t) { return t.has(v); })) return;
    complex_.collect(v, at_v, work_);
    const std::vector<Spoke> spokes_u = spokes_of(u, at_u, complex_, rules_),
                             spokes_v = spokes_of(v, at_v, complex_, rules_);
    const auto to_v = look_at_join(u, v, at_u, at_v, spokes_u, spokes_v);
    const auto to_u = look_at_join(v, u, at_v, at_u, spokes_v, spokes_u);
    if (!to_v && !to_u) return;
    const bool is_u_kept =
        !to_v ||
        (to_u && (to_u->bend < to_v->bend || (to_u->bend == to_v->bend && complex_.place(u) < complex_.place(v))));
    ++result_.joined_edges;
    complex_.join(is_u_kept ? v : u, is_u_kept ? u : v);
    add_details_at(is_u_kept ? u : v);
  }

  /// Tests whether a node may be joined to its neighbour. Output: nothing if it may not.
  std::optional<Change> look_at_join(std::uint32_t from, std::uint32_t to, const std::vector<PresentTriangle>& at_from,
                                     const std::vector<PresentTriangle>& at_to, const std::vector<Spoke>& spokes_from,
                                     const std::vector<Spoke>& spokes_to) {
    const Vec3& target = complex_.place(to);
    if (!(complex_.reach(from, target) <= rules_.allowed)) return {};
    const bool is_flap = hangs_on_edges_of(from, to, at_from, at_to);
    if (!keeps_links(from, to, at_from, at_to, spokes_from, spokes_to)) return {};
    if (!is_flap && !keeps_borders(to, spokes_from, spokes_to)) return {};
    Change change;
    if (!look_at_move(
            from, target, at_from, spokes_from, [&](const PresentTriangle& t) { return t.has(to); }, change))
      return {};
    for (const PresentTriangle& gone : at_from) {
      if (!gone.has(to)) continue;
      const std::uint32_t apex = third(gone, from, to);
      if (would_fold({from, to, at_from}, {to, from, at_to}, apex, target, complex_, rules_)) return {};
    }
    if (std::min(change.lowest_after, rules_.size) < change.lowest_before) return {};
    if (leaves_half_a_strip(from, to, at_from, at_to, spokes_from, spokes_to)) return {};
    return change;
  }

  /// Returns whether a narrow face at a node, to which another one has been joined, would separate two faces that must
  /// not become neighbours, or would have a border on both sides. Its other end could not be joined then.
  bool leaves_half_a_strip(std::uint32_t from, std::uint32_t to, const std::vector<PresentTriangle>& at_from,
                           const std::vector<PresentTriangle>& at_to, const std::vector<Spoke>& spokes_from,
                           const std::vector<Spoke>& spokes_to) const {
    const Vec3& target = complex_.place(to);
    struct Face {
      std::array<std::uint32_t, 2> others;
      bool is_narrow;
    };
    std::vector<Face> faces;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_other;
    const auto add = [&](const PresentTriangle& t, std::uint32_t node) {
      const int at = t.at(node);
      const Face face{{t.corners[(at + 1) % 3], t.corners[(at + 2) % 3]}, false};
      const double height =
          TriangleShape({target, complex_.place(face.others[0]), complex_.place(face.others[1])}).height;
      for (const std::uint32_t other : face.others)
        by_other.push_back({other, static_cast<std::uint32_t>(faces.size())});
      faces.push_back({face.others, height < rules_.size});
    };
    for (const PresentTriangle& t : at_from)
      if (!t.has(to)) add(t, from);
    for (const PresentTriangle& t : at_to)
      if (!t.has(from)) add(t, to);
    std::sort(by_other.begin(), by_other.end());
    // The directions in which the wide faces beyond an edge of a narrow face leave it.
    const auto sides_beyond = [&](std::uint32_t narrow, std::uint32_t end) {
      std::vector<Vec3> sides;
      const Vec3 along = normalized(complex_.place(end) - target);
      auto at = std::lower_bound(by_other.begin(), by_other.end(), std::pair(end, 0U));
      for (; at != by_other.end() && at->first == end; ++at) {
        const Face& face = faces[at->second];
        if (at->second == narrow || face.is_narrow) continue;
        const Vec3 out = complex_.place(face.others[0] == end ? face.others[1] : face.others[0]) - target;
        sides.push_back(normalized(out - dot(out, along) * along));
      }
      return sides;
    };
    const auto is_border = [&](std::uint32_t end) {
      const Spoke *const a = find_spoke(spokes_from, end), *const b = find_spoke(spokes_to, end);
      return (a != nullptr && a->is_border) || (b != nullptr && b->is_border);
    };
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      if (!faces[f].is_narrow) continue;
      if (is_border(faces[f].others[0]) && is_border(faces[f].others[1])) return true;
      const std::vector<Vec3> beyond_one = sides_beyond(f, faces[f].others[0]);
      const std::vector<Vec3> beyond_other = sides_beyond(f, faces[f].others[1]);
      for (const Vec3& a : beyond_one)
        for (const Vec3& b : beyond_other)
          if (dot(a, b) > kFoldedCosine) return true;
    }
    return false;
  }

  /// Tests the faces at a node that moves to another place. `goes` tells which faces vanish.
  /// Output: false if a face would turn too far.
  template <class Goes>
  bool look_at_move(std::uint32_t node, const Vec3& target, const std::vector<PresentTriangle>& at_node,
                    const std::vector<Spoke>& spokes, const Goes& goes, Change& change) const {
    const Vec3 move = target - complex_.place(node);
    for (const PresentTriangle& t : at_node) {
      Places places = places_of(t, complex_);
      const TriangleShape before(places);
      change.lowest_before = std::min(change.lowest_before, before.height);
      if (before.height >= rules_.size)
        change.bend = std::max(change.bend, std::fabs(dot(before.twice_area, move)) / norm(before.twice_area));
      if (goes(t)) continue;
      places[static_cast<std::size_t>(t.at(node))] = target;
      if (!take_face(before, TriangleShape(places), change)) return false;
    }
    for (const Spoke& spoke : spokes) {
      if (!spoke.is_crease) continue;
      const Vec3 along = complex_.place(spoke.to) - complex_.place(node);
      const double length = norm(along);
      // A crease to a face that vanishes is a detail itself.
      if (length < rules_.size || is_of_gone(spoke.to, at_node, goes)) continue;
      change.bend = std::max(change.bend, norm(cross(along, move)) / length);
    }
    return true;
  }
  template <class Goes>
  static bool is_of_gone(std::uint32_t node, const std::vector<PresentTriangle>& triangles, const Goes& goes) {
    return std::any_of(triangles.begin(), triangles.end(),
                       [&](const PresentTriangle& t) { return t.has(node) && goes(t); });
  }

  bool take_face(const TriangleShape& before, const TriangleShape& after, Change& change) const {
    change.lowest_after = std::min(change.lowest_after, after.height);
    return may_become(before, after, rules_);
  }

  /// Returns whether all faces of a node are at its edge to another node, and the outer edges of each of these faces
  /// have two faces that stay.
  static bool hangs_on_edges_of(std::uint32_t from, std::uint32_t to, const std::vector<PresentTriangle>& at_from,
                                const std::vector<PresentTriangle>& at_to) {
    return std::all_of(at_from.begin(), at_from.end(), [&](const PresentTriangle& t) {
      if (!t.has(to)) return false;
      const std::uint32_t apex = third(t, from, to);
      return std::count_if(at_to.begin(), at_to.end(),
                           [&](const PresentTriangle& other) { return other.has(apex) && !other.has(from); }) >= 2;
    });
  }

  /// The link condition in a surface: a node or edge that sees both ends of the joined edge belongs to a face at that
  /// edge.
  static bool keeps_links(std::uint32_t from, std::uint32_t to, const std::vector<PresentTriangle>& at_from,
                          const std::vector<PresentTriangle>& at_to, const std::vector<Spoke>& spokes_from,
                          const std::vector<Spoke>& spokes_to) {
    std::vector<std::uint32_t> apexes;
    for (const PresentTriangle& t : at_from)
      if (t.has(to)) apexes.push_back(third(t, from, to));
    sort_unique(apexes);
    const auto common = std::count_if(spokes_from.begin(), spokes_from.end(), [&](const Spoke& s) {
      return s.to != to && find_spoke(spokes_to, s.to) != nullptr;
    });
    if (static_cast<std::size_t>(common) != apexes.size()) return false;
    return !do_see_common_edge({from, to, at_from}, {to, from, at_to});
  }

  /// The link condition in the graph of borders.
  static bool keeps_borders(std::uint32_t to, const std::vector<Spoke>& spokes_from,
                            const std::vector<Spoke>& spokes_to) {
    const std::size_t of_from = count_borders(spokes_from), of_to = count_borders(spokes_to);
    if (of_from == 0 || of_to == 0) return true;
    if (!find_spoke(spokes_from, to)->is_border) return false;
    if (of_from != 2 && of_to != 2) return false;
    return std::none_of(spokes_from.begin(), spokes_from.end(), [&](const Spoke& s) {
      if (s.to == to || !s.is_border) return false;
      const Spoke* other = find_spoke(spokes_to, s.to);
      return other != nullptr && other->is_border;
    });
  }

  /// A narrow face over a crease: its long side from a to b, its corner c, and the place of c on the side.
  struct Sliver {
    std::uint32_t a, b, c;
    double at;
    double height;
  };

  void remove_sliver(const Detail& detail) {
    PresentTriangle t{};
    if (!complex_.find_present(detail.first, t)) return;
    const Places p = places_of(t, complex_);
    const TriangleShape shape(p);
    if (shape.height != detail.size || shape.has_edge_below(rules_.size)) return;
    const auto k = static_cast<std::size_t>(shape.longest);
    Sliver s{t.corners[k], t.corners[(k + 1) % 3], t.corners[(k + 2) % 3], 0, shape.height};
    // Begins with the end that has the smaller place, so that both faces at the edge give the same result.
    if (complex_.place(s.b) < complex_.place(s.a)) std::swap(s.a, s.b);
    const Vec3 side = complex_.place(s.b) - complex_.place(s.a);
    s.at = dot(complex_.place(s.c) - complex_.place(s.a), side) / norm_squared(side);
    if (!(s.at > 0 && s.at < 1) || is_fixed(s.c) || (is_fixed(s.a) && is_fixed(s.b))) return;

    std::vector<PresentTriangle> at_a, at_c, beside;
    complex_.collect(s.a, at_a, work_);
    complex_.collect(s.c, at_c, work_);
    for (const PresentTriangle& other : at_a)
      if (other.has(s.b) && !other.has(s.c)) beside.push_back(other);
    const std::vector<Spoke> spokes_a = spokes_of(s.a, at_a, complex_, rules_),
                             spokes_c = spokes_of(s.c, at_c, complex_, rules_);
    const Spoke& edge = *find_spoke(spokes_a, s.b);
    if (!edge.is_crease) return;
    for (const PresentTriangle& other : beside)
      if (find_spoke(spokes_c, third(other, s.a, s.b)) != nullptr) return;
    const bool is_flap = beside.size() >= 2 && std::all_of(at_c.begin(), at_c.end(), [&](const PresentTriangle& other) {
                           return other.has(s.a) && other.has(s.b);
                         });
    if (!is_flap && edge.is_border && count_borders(spokes_c) > 0) return;

    const auto to_corner = is_flap ? std::nullopt : look_at_bent_side(s, beside, at_c);
    const auto to_side = look_at_lowered_corner(s, beside, at_c, spokes_c);
    if (!to_corner && !to_side) return;
    ++result_.closed_slivers;
    const std::uint32_t node = complex_.cut(s.a, s.b, s.at, work_);
    const bool is_corner_kept = !to_side || (to_corner && to_corner->bend <= to_side->bend);
    complex_.join(is_corner_kept ? node : s.c, is_corner_kept ? s.c : node);
    add_details_at(is_corner_kept ? s.c : node);
  }

  bool is_gone(const Sliver& s, const PresentTriangle& t) const { return t.has(s.a) && t.has(s.b); }

  /// Tests cutting the long side and moving the cut to the corner.
  std::optional<Change> look_at_bent_side(const Sliver& s, const std::vector<PresentTriangle>& beside,
                                          const std::vector<PresentTriangle>& at_c) const {
    const Vec3& target = complex_.place(s.c);
    if (!(complex_.reach_on_edge(s.a, s.b, s.at, target) <= rules_.allowed)) return {};
    Change change;
    change.lowest_before = s.height;
    change.bend = s.height;
    for (const PresentTriangle& t : beside) {
      const TriangleShape before(places_of(t, complex_));
      change.lowest_before = std::min(change.lowest_before, before.height);
      for (const std::uint32_t end : {s.a, s.b}) {
        Places places = places_of(t, complex_);
        places[static_cast<std::size_t>(t.at(end))] = target;
        if (!take_face(before, TriangleShape(places), change)) return {};
      }
    }
    return accept(s, change, target, beside, at_c);
  }

  /// Tests moving the corner to the long side.
  std::optional<Change> look_at_lowered_corner(const Sliver& s, const std::vector<PresentTriangle>& beside,
                                               const std::vector<PresentTriangle>& at_c,
                                               const std::vector<Spoke>& spokes_c) const {
    const Vec3 target = complex_.place_on_edge(s.a, s.b, s.at);
    if (target == complex_.place(s.a) || target == complex_.place(s.b)) return {};
    if (!(complex_.reach(s.c, target) <= rules_.allowed)) return {};
    if (!(complex_.reach_on_edge(s.a, s.b, s.at, target) <= rules_.allowed)) return {};
    Change change;
    const auto goes = [&](const PresentTriangle& t) { return is_gone(s, t); };
    if (!look_at_move(s.c, target, at_c, spokes_c, goes, change)) return {};
    for (const PresentTriangle& t : beside) {
      const TriangleShape before(places_of(t, complex_));
      change.lowest_before = std::min(change.lowest_before, before.height);
      for (const std::uint32_t end : {s.a, s.b}) {
        Places places = places_of(t, complex_);
        places[static_cast<std::size_t>(t.at(end))] = target;
        change.lowest_after = std::min(change.lowest_after, TriangleShape(places).height);
      }
    }
    return accept(s, change, target, beside, at_c);
  }

  /// Output: the change, if no face becomes narrower and none lies on another one.
  std::optional<Change> accept(const Sliver& s, const Change& change, const Vec3& target,
                               const std::vector<PresentTriangle>& beside,
                               const std::vector<PresentTriangle>& at_c) const {
    if (!(std::min(change.lowest_after, rules_.size) > change.lowest_before)) return {};
    for (const std::uint32_t end : {s.a, s.b}) {
      const std::uint32_t other = end == s.a ? s.b : s.a;
      if (would_fold({s.c, other, at_c}, {other, kNone, beside}, end, target, complex_, rules_)) return {};
    }
    return change;
  }

  WithoutDetails finish() {
    std::vector<std::uint32_t> number(complex_.point_count(), kNone);
    std::vector<PresentTriangle> faces;
    PresentTriangle t{};
    StopCheck check(control_);
    for (std::uint32_t i = 0; i < complex_.triangle_count(); ++i) {
      check();
      if (!tiny_components_.has(complex_.face_of(i)) && complex_.find_present(i, t)) faces.push_back(t);
    }
    const std::vector<std::optional<PointOfTriangle>> near_component = find_points_near_tiny_components(faces);
    std::vector<std::uint32_t> kept;
    for (const PresentTriangle& face : faces) kept.push_back(face.index);
    for (std::uint32_t i = 0; i < tiny_components_.of_face.size(); ++i)
      if (tiny_components_.has(FaceId(i)) && !near_component[tiny_components_.of_face[i]] &&
          complex_.find_present(i, t))
        faces.push_back(t);
    std::stable_sort(faces.begin(), faces.end(), [&](const PresentTriangle& a, const PresentTriangle& b) {
      return complex_.face_of(a.index) < complex_.face_of(b.index);
    });
    for (const PresentTriangle& face : faces)
      for (const std::uint32_t node : face.corners) number[node] = 0;
    for (std::uint32_t point = 0; point < number.size(); ++point) {
      if (number[point] == kNone) continue;
      number[point] = static_cast<std::uint32_t>(result_.positions.size());
      result_.positions.push_back(complex_.place(point));
      result_.vertex.push_back(point < rules_.positions.size() ? VertexId(point) : VertexId());
    }
    std::vector<std::uint8_t> has_image(rules_.faces.size(), 0);
    for (const PresentTriangle& face : faces) {
      const FaceId of = complex_.face_of(face.index);
      result_.faces.push_back(
          {VertexId(number[face.corners[0]]), VertexId(number[face.corners[1]]), VertexId(number[face.corners[2]])});
      result_.source.push_back(of);
      has_image[of.value] = 1;
    }
    for (std::uint32_t f = 0; f < has_image.size(); ++f)
      if (has_image[f] == 0) result_.removed.push_back(FaceId(f));
    result_.map = complex_.take_map();
    for (VertexId& image : result_.map.image) image = VertexId(number[image.value]);
    anchor_tiny_components(near_component, kept, faces);
    return std::move(result_);
  }

  std::vector<std::optional<PointOfTriangle>> find_points_near_tiny_components(
      const std::vector<PresentTriangle>& faces) const {
    if (tiny_components_.count() == 0) return {};
    std::vector<Corners3> corners;
    corners.reserve(faces.size());
    for (const PresentTriangle& face : faces) corners.push_back(places_of(face, complex_));
    return points_near_tiny_components(tiny_components_, rules_.positions, corners, rules_.allowed, control_);
  }

  /// Anchors the vertices of removed tiny components at the points near them.
  /// Input: `kept` has the numbers of the triangles to which the points belong, and `faces` the result's triangles in
  ///        order.
  void anchor_tiny_components(const std::vector<std::optional<PointOfTriangle>>& points,
                              const std::vector<std::uint32_t>& kept, const std::vector<PresentTriangle>& faces) {
    if (tiny_components_.count() == 0) return;
    std::vector<std::uint32_t> face_of(complex_.triangle_count(), kNone);
    for (std::uint32_t f = 0; f < faces.size(); ++f) face_of[faces[f].index] = f;
    for (std::size_t s = 0; s < points.size(); ++s) {
      if (!points[s]) continue;
      ++result_.removed_tiny_components;
      for (const VertexId v : tiny_components_.vertices[s])
        result_.map.anchors.push_back({v, FaceId(face_of[kept[points[s]->triangle]]), points[s]->weights});
    }
    std::sort(result_.map.anchors.begin(), result_.map.anchors.end(),
              [](const DetailMap::Anchor& a, const DetailMap::Anchor& b) { return a.vertex < b.vertex; });
  }

  const DetailRules& rules_;
  DetailComplex complex_;
  const std::vector<std::uint8_t>& is_fixed_;
  RunControl& control_;
  WorkBound work_;
  NarrowNotches notches_;
  TinyComponents tiny_components_;
  std::priority_queue<Detail> queue_;
  std::vector<PresentTriangle> triangles_;  ///< scratch
  WithoutDetails result_;
};

/// Fixes the vertices of faces that intersect since details were removed.
/// Output: whether there were any such faces.
bool fix_new_intersections(const DetailRules& rules, const WithoutDetails& result, const SelfIntersections& before,
                           const SelfIntersections& after, std::vector<std::uint8_t>& is_fixed) {
  bool is_any = !after.is_complete;
  std::vector<std::uint8_t> is_node_at_fault(result.positions.size(), 0);
  for (const auto& [f, g] : after.pairs) {
    const FaceId of_f = result.source[f.value], of_g = result.source[g.value];
    if (std::binary_search(before.pairs.begin(), before.pairs.end(),
                           std::pair(std::min(of_f, of_g), std::max(of_f, of_g))))
      continue;
    is_any = true;
    for (const FaceId face : {f, g})
      for (const VertexId node : result.faces[face.value]) is_node_at_fault[node.value] = 1;
    for (const FaceId face : {of_f, of_g})
      for (const VertexId v : rules.faces[face.value]) is_fixed[v.value] = 1;
  }
  for (std::size_t v = 0; v < is_fixed.size(); ++v) {
    const VertexId image = result.map.image[VertexId(v)];
    if (image.is_valid() && is_node_at_fault[image.value] != 0) is_fixed[v] = 1;
  }
  return is_any;
}

}  // namespace

WithoutDetails remove_details(const DetailRules& rules, RunControl& control) {
  std::vector<std::uint8_t> is_fixed(rules.is_fixed.begin(), rules.is_fixed.end());
  is_fixed.resize(rules.positions.size(), 0);
  std::optional<SelfIntersections> before;
  const auto find_intersections = [&](std::span<const Vec3> positions, std::span<const Triangle> faces) {
    return self_intersections(positions, faces, {}, {SearchLimits::kEnoughPairs, SearchLimits::steps_for(faces.size())},
                              control);
  };
  for (int i = 0; i < kMaxTries; ++i) {
    WithoutDetails result = DetailRemover(rules, is_fixed, control).run();
    if (!result.is_changed()) return result;
    if (!before) before = find_intersections(rules.positions, rules.faces);
    if (!before->is_complete) break;
    const SelfIntersections after = find_intersections(result.positions, result.faces);
    if (!fix_new_intersections(rules, result, *before, after, is_fixed)) return result;
  }
  // Every vertex is fixed, so that no detail is removed.
  is_fixed.assign(is_fixed.size(), 1);
  return DetailRemover(rules, is_fixed, control).run();
}

}  // namespace remesh
