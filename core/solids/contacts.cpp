#include "core/solids/contacts.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/pair_search.h"
#include "core/geometry/triangles/distances.h"
#include "core/geometry/triangles/triangle_intersection.h"
#include "core/solids/active_faces.h"

namespace remesh {
namespace {

/// Faces that are near each other are triangulated together only if their common points are at least this many
/// distances off a line. Points along a common side may be that far off it.
constexpr double kFlat = 4;
/// A point on an edge is the same as another one on it within this many distances.
constexpr double kSamePlace = 2;

constexpr std::size_t kPairsPerBlock = 512;

bool has_corner(const Triangle& face, VertexId v) { return face[0] == v || face[1] == v || face[2] == v; }

/// The places where two segments are nearest to each other.
struct Passing {
  double s, t;  ///< 0 to 1 along each
  Vec3 p, q;
};

Passing nearest_of_segments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = d - c, w = a - c;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double determinant = uu * vv - uv * uv;
  double s = determinant > 0 ? std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0) : 0;
  double t = vv > 0 ? (uv * s + vw) / vv : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0;
  }
  return {s, t, a + s * u, c + t * v};
}

/// The contacts of features, by numbers.
struct Contacts {
  std::vector<std::pair<VertexId, VertexId>> vertices;  ///< the smaller one first
  std::vector<std::pair<EdgeId, VertexId>> on_edges;
  std::vector<std::pair<EdgeId, EdgeId>> passing;  ///< the smaller one first
  std::vector<std::pair<FaceId, VertexId>> in_faces;

  void append(const Contacts& more) {
    const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    add(vertices, more.vertices);
    add(on_edges, more.on_edges);
    add(passing, more.passing);
    add(in_faces, more.in_faces);
  }
  void make_unique(const RunControl& control) {
    const auto sort = [&](auto& list) {
      sort_stoppable(list.begin(), list.end(), control);
      list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    sort(vertices);
    sort(on_edges);
    sort(passing);
    sort(in_faces);
  }
};

/// The points on a face.
struct PointsOnFace {
  std::vector<VertexId> outline;
  std::vector<VertexId> all;                               ///< those in its inside, too; ascending
  std::vector<std::pair<VertexId, std::uint32_t>> places;  ///< of the points in the outline, ascending

  /// Calls visit(i) for the places of a point in the outline.
  template <class Visit>
  void for_each_place(VertexId v, const Visit& visit) const {
    const std::pair first(v, std::uint32_t{0});
    for (auto at = std::lower_bound(places.begin(), places.end(), first); at != places.end() && at->first == v; ++at)
      visit(at->second);
  }
  VertexId after(std::size_t i) const { return outline[i + 1 < outline.size() ? i + 1 : 0]; }
  /// Returns whether the outline runs from one point to the other, in either direction.
  bool has_piece(VertexId v, VertexId w) const {
    bool is_there = false;
    for_each_place(v, [&](std::size_t i) { is_there = is_there || after(i) == w; });
    for_each_place(w, [&](std::size_t i) { is_there = is_there || after(i) == v; });
    return is_there;
  }
};

/// Finds the common points of two ascending lists, of which one may be much longer than the other.
void find_common(const std::vector<VertexId>& a, const std::vector<VertexId>& b, std::vector<VertexId>& common) {
  const auto& [few, many] = a.size() < b.size() ? std::tie(a, b) : std::tie(b, a);
  common.clear();
  for (const VertexId v : few)
    if (std::binary_search(many.begin(), many.end(), v)) common.push_back(v);
}

/// Adds the pieces of another face's outline that lie in a face and are none of its own.
void add_pieces(FaceId f, const PointsOnFace& own, const PointsOnFace& other, const std::vector<VertexId>& common,
                std::vector<CutPlan::Constraint>& constraints) {
  for (const VertexId v : common)
    other.for_each_place(v, [&](std::size_t i) {
      const VertexId w = other.after(i);
      if (v == w || !std::binary_search(common.begin(), common.end(), w) || own.has_piece(v, w)) return;
      const auto [low, high] = std::minmax(v, w);
      constraints.push_back({f, low, high});
    });
}

class ContactSearch {
 public:
  ContactSearch(Soup& soup, const SoupEdges& edges, double distance, std::span<const std::uint8_t> active,
                RunControl& control)
      : soup_(soup), edges_(edges), distance_(distance), active_(active), control_(control) {}

  std::optional<CutPlan> run() {
    if (!find_near()) return std::nullopt;
    CutPlan plan;
    plan.are_all_apart = near_.empty() && active_.empty() && !do_any_intersect_;
    if (near_.empty()) return plan;
    find_features();
    join_vertices(plan);
    put_on_edges(plan);
    sides_.emplace(soup_, edges_, plan, control_);
    put_in_faces(plan);
    find_common_pieces(plan);
    const bool is_any_joined = std::any_of(contacts_.vertices.begin(), contacts_.vertices.end(),
                                           [&](const auto& pair) { return plan.image_of(pair.second) != pair.second; });
    if (!is_any_joined) plan.image.clear();
    return plan;
  }

 private:
  bool is_active(FaceId f) const { return active_.empty() || active_[f.value] != 0; }
  const Vec3& at(VertexId v) const { return soup_.positions[v.value]; }
  Corners3 corners(FaceId f) const {
    const Triangle& t = soup_.faces[f.value];
    return {at(t[0]), at(t[1]), at(t[2])};
  }
  double length(EdgeId e) const {
    const auto [a, b] = edges_.ends(e);
    return norm(at(b) - at(a));
  }

  /// Sees all nodes of a tree.
  struct AllNodes {
    bool is_of_no_interest(FaceId, std::size_t, std::size_t) const { return false; }
    bool lose_interest(std::span<const std::uint32_t>) { return false; }
  };

  /// Finds the pairs of faces that are near each other where they share nothing.
  /// Output: false if there are too many.
  bool find_near() {
    const std::size_t n = soup_.faces.size();
    constexpr std::size_t kPairsPerFace = 64, kAlways = 1 << 12;
    const SearchLimits limits(kPairsPerFace * n + kAlways, SearchLimits::steps_for(n));
    PairSearch search(limits, control_);
    const SelectedFaces selected = select_near_active(soup_, active_, distance_, control_);
    const std::span<const Triangle> faces = selected.faces(soup_);
    if (faces.empty()) return true;
    SearchedTriangles searched{soup_.positions, faces};
    searched.margin = distance_;
    find_pairs(
        searched, [&](FaceId f) { return selected.number(f); }, [](const TriangleTree&) { return AllNodes(); },
        [&](FaceId i, FaceId j) {
          const FaceId f = selected.number(i), g = selected.number(j);
          return (is_active(f) || is_active(g)) && are_near(f, g);
        },
        search);
    near_ = std::move(search.result().pairs);
    sort_stoppable(near_.begin(), near_.end(), control_);
    return search.goes_on();
  }

  /// Returns whether two faces surely neither intersect nor have a contact, but for what they share.
  bool are_clearly_apart(const Triangle& f, const Triangle& g) const {
    VertexId shared[3];
    std::size_t count = 0;
    for (const VertexId v : f)
      if (has_corner(g, v)) shared[count++] = v;
    if (count < 2) return does_plane_part(f, g, count == 1 ? shared[0] : VertexId());
    return count == 2 && do_turn_away(f, g, shared);
  }

  /// Returns whether a plane parts two faces and is far from both, but for the corner that they may share.
  bool does_plane_part(const Triangle& f, const Triangle& g, VertexId shared) const {
    // More than the rounding of what is computed here.
    constexpr double kRounding = 32 * kSoupRoundingStep;
    Vec3 way;
    for (std::size_t k = 0; k < 3; ++k) way = way + (at(g[k]) - at(f[k]));
    const double gap = (distance_ + kRounding) * norm(way);
    const Vec3& origin = at(shared.is_valid() ? shared : f[0]);
    double end_of_f = -HUGE_VAL, begin_of_g = HUGE_VAL;
    for (const VertexId v : f)
      if (v != shared) end_of_f = std::max(end_of_f, dot(way, at(v) - origin));
    for (const VertexId v : g)
      if (v != shared) begin_of_g = std::min(begin_of_g, dot(way, at(v) - origin));
    return shared.is_valid() ? end_of_f < -gap && begin_of_g > gap : begin_of_g - end_of_f > gap;
  }

  /// Returns whether two faces turn away from each other at their common side.
  bool do_turn_away(const Triangle& f, const Triangle& g, const VertexId (&shared)[3]) const {
    const auto apex = [&](const Triangle& t) {
      return *std::find_if(t.begin(), t.end(), [&](VertexId v) { return v != shared[0] && v != shared[1]; });
    };
    const Vec3 side = at(shared[1]) - at(shared[0]);
    const double squared = dot(side, side);
    if (!(squared > 0)) return false;
    const auto height = [&](VertexId v) {
      const Vec3 from = at(v) - at(shared[0]);
      return from - (dot(from, side) / squared) * side;
    };
    const Vec3 a = height(apex(f)), b = height(apex(g));
    const double a_length = norm(a), b_length = norm(b);
    constexpr double kLargeTurn = 0.5;  // the cosine of the angle between the faces
    return a_length > kFlat * distance_ && b_length > kFlat * distance_ && dot(a, b) < kLargeTurn * a_length * b_length;
  }

  bool are_near(FaceId f, FaceId g) const {
    const Triangle &s = soup_.faces[f.value], &t = soup_.faces[g.value];
    if (are_clearly_apart(s, t)) return false;
    if (!do_any_intersect_.load(std::memory_order_relaxed) && do_intersect(s, t, soup_.positions))
      do_any_intersect_.store(true, std::memory_order_relaxed);
    const bool is_any_shared = has_corner(t, s[0]) || has_corner(t, s[1]) || has_corner(t, s[2]);
    if (!is_any_shared) return norm(shortest_way(corners(f), corners(g))) <= distance_;
    Contacts found;
    compare(f, g, found);
    return !found.vertices.empty() || !found.on_edges.empty() || !found.passing.empty() || !found.in_faces.empty();
  }

  bool is_within(const Vec3& a, const Vec3& b) const { return norm(b - a) <= distance_; }

  /// Finds the contacts of two faces: the corners of each are held against the other face, and sides against sides.
  void compare(FaceId f, FaceId g, Contacts& found) const {
    compare_corners(f, g, found);
    compare_corners(g, f, found);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const auto [low, high] = std::minmax({edges_.of(f, i), edges_.of(g, j)});
        const auto [a, b] = edges_.ends(low);
        const auto [c, d] = edges_.ends(high);
        if (a == c || a == d || b == c || b == d) continue;
        const Passing passing = nearest_of_segments(at(a), at(b), at(c), at(d));
        if (is_within(passing.p, passing.q)) found.passing.push_back({low, high});
      }
  }

  void compare_corners(FaceId f, FaceId g, Contacts& found) const {
    const Triangle& other = soup_.faces[g.value];
    const Corners3 triangle = corners(g);
    for (const VertexId v : soup_.faces[f.value]) {
      if (has_corner(other, v)) continue;
      const Vec3& p = at(v);
      if (!is_within(p, nearest_on_triangle(p, triangle))) continue;
      bool is_at_rim = false;
      for (const VertexId w : other)
        if (is_within(p, at(w))) {
          found.vertices.push_back(std::minmax(v, w));
          is_at_rim = true;
        }
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId a = other[k], b = other[(k + 1) % 3];
        if (!is_within(p, nearest_on_segment(p, at(a), at(b)))) continue;
        if (!is_within(p, at(a)) && !is_within(p, at(b))) found.on_edges.push_back({edges_.of(g, k), v});
        is_at_rim = true;
      }
      if (!is_at_rim) found.in_faces.push_back({g, v});
    }
  }

  void find_features() {
    const auto blocks =
        map_blocks<Contacts>(near_.size(), kPairsPerBlock, control_, [&](std::size_t i, std::size_t end) {
          Contacts found;
          for (; i < end; ++i) compare(near_[i].first, near_[i].second, found);
          return found;
        });
    for (const Contacts& found : blocks) contacts_.append(found);
    // A corner may be near the side of its own face.
    std::vector<FaceId> faces;
    for (const auto& [f, g] : near_) faces.insert(faces.end(), {f, g});
    sort_stoppable(faces.begin(), faces.end(), control_);
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (const FaceId f : faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle& t = soup_.faces[f.value];
        const Vec3 &p = at(t[(k + 2) % 3]), &a = at(t[k]), &b = at(t[(k + 1) % 3]);
        if (is_within(p, nearest_on_segment(p, a, b)) && !is_within(p, a) && !is_within(p, b))
          contacts_.on_edges.push_back({edges_.of(f, k), t[(k + 2) % 3]});
      }
    contacts_.make_unique(control_);
    faces_ = std::move(faces);
  }

  /// Joins vertices to the smallest one near them that has not been joined itself. So chains do not collapse.
  void join_vertices(CutPlan& plan) const {
    plan.image.resize(soup_.positions.size());
    for (std::size_t v = 0; v < plan.image.size(); ++v) plan.image[v] = VertexId(v);
    for (const auto& [v, w] : contacts_.vertices)
      if (plan.image[v.value] == v && plan.image[w.value] == w) plan.image[w.value] = v;
  }

  void put_on_edges(CutPlan& plan) {
    // The points on edges, by their places along these.
    std::map<std::pair<EdgeId, double>, VertexId> points;
    const auto put = [&](EdgeId e, VertexId v) {
      const auto [a, b] = edges_.ends(e);
      if (v == plan.image_of(a) || v == plan.image_of(b)) return;
      const Vec3 side = at(b) - at(a);
      points.insert({{e, dot(at(v) - at(a), side) / dot(side, side)}, v});
      plan.on_edges.push_back({e, v});
    };
    // Returns the point of an edge that is at a place, if there is one.
    const auto find = [&](EdgeId e, double place) {
      const auto [a, b] = edges_.ends(e);
      const double slack = kSamePlace * distance_ / length(e);
      if (place <= slack) return plan.image_of(a);
      if (place >= 1 - slack) return plan.image_of(b);
      const auto near = points.lower_bound({e, place - slack});
      const bool is_there = near != points.end() && near->first.first == e && near->first.second <= place + slack;
      return is_there ? near->second : VertexId();
    };
    StopCheck check(control_);
    for (const auto& [e, v] : contacts_.on_edges) {
      check();
      put(e, plan.image_of(v));
    }
    for (const auto& [e, g] : contacts_.passing) {
      check();
      const auto [a, b] = edges_.ends(e);
      const auto [c, d] = edges_.ends(g);
      const auto is_end_of_g = [&, c = c, d = d](VertexId v) {
        return plan.image_of(v) == plan.image_of(c) || plan.image_of(v) == plan.image_of(d);
      };
      if (is_end_of_g(a) || is_end_of_g(b)) continue;
      const Passing passing = nearest_of_segments(at(a), at(b), at(c), at(d));
      const VertexId on_e = find(e, passing.s), on_g = find(g, passing.t);
      if (on_e.is_valid()) {
        if (on_g != on_e) put(g, on_e);
      } else if (on_g.is_valid()) {
        put(e, on_g);
      } else {
        const VertexId made(soup_.positions.size());
        soup_.positions.push_back(0.5 * (passing.p + passing.q));
        plan.image.push_back(made);
        put(e, made);
        put(g, made);
      }
    }
  }

  /// Puts vertices into faces if they are not on their outlines.
  void put_in_faces(CutPlan& plan) const {
    std::vector<VertexId> outline;
    FaceId of_outline;
    StopCheck check(control_);
    for (const auto& [f, v] : contacts_.in_faces) {
      check();
      if (f != of_outline) {
        of_outline = f;
        outline.clear();
        sides_->append_outline(f, outline);
        std::sort(outline.begin(), outline.end());
      }
      const VertexId image = plan.image_of(v);
      if (!std::binary_search(outline.begin(), outline.end(), image)) plan.in_faces.push_back({f, image});
    }
    sort_stoppable(plan.in_faces.begin(), plan.in_faces.end(), control_);
    plan.in_faces.erase(std::unique(plan.in_faces.begin(), plan.in_faces.end()), plan.in_faces.end());
  }

  PointsOnFace points_on(FaceId f, const CutPlan& plan) const {
    PointsOnFace points;
    sides_->append_outline(f, points.outline);
    for (std::uint32_t i = 0; i < points.outline.size(); ++i) points.places.push_back({points.outline[i], i});
    std::sort(points.places.begin(), points.places.end());
    points.all = points.outline;
    const std::pair<FaceId, VertexId> low(f, VertexId(0));
    for (auto p = std::lower_bound(plan.in_faces.begin(), plan.in_faces.end(), low);
         p != plan.in_faces.end() && p->first == f; ++p)
      points.all.push_back(p->second);
    std::sort(points.all.begin(), points.all.end());
    points.all.erase(std::unique(points.all.begin(), points.all.end()), points.all.end());
    return points;
  }

  /// Finds the pieces of sides that lie in other faces, and the faces that lie on each other.
  void find_common_pieces(CutPlan& plan) const {
    std::vector<PointsOnFace> on(faces_.size());  // in the order of faces_
    for_blocks(faces_.size(), kPairsPerBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) on[i] = points_on(faces_[i], plan);
    });
    struct Found {
      std::vector<CutPlan::Constraint> constraints;
      std::vector<std::pair<FaceId, FaceId>> in_one_plane;
    };
    const auto index_of = [&](FaceId f) {
      return static_cast<std::size_t>(std::lower_bound(faces_.begin(), faces_.end(), f) - faces_.begin());
    };
    const auto blocks = map_blocks<Found>(near_.size(), kPairsPerBlock, control_, [&](std::size_t i, std::size_t end) {
      Found found;
      std::vector<VertexId> common;
      for (; i < end; ++i) {
        const std::size_t f = index_of(near_[i].first), g = index_of(near_[i].second);
        find_common(on[f].all, on[g].all, common);
        if (common.size() < 2) continue;
        add_pieces(faces_[f], on[f], on[g], common, found.constraints);
        add_pieces(faces_[g], on[g], on[f], common, found.constraints);
        if (is_wide(common)) found.in_one_plane.push_back(near_[i]);
      }
      return found;
    });
    for (const Found& found : blocks) {
      plan.constraints.insert(plan.constraints.end(), found.constraints.begin(), found.constraints.end());
      plan.in_one_plane.insert(plan.in_one_plane.end(), found.in_one_plane.begin(), found.in_one_plane.end());
    }
    sort_stoppable(plan.constraints.begin(), plan.constraints.end(), control_);
    plan.constraints.erase(std::unique(plan.constraints.begin(), plan.constraints.end()), plan.constraints.end());
  }

  /// Returns whether points are not all near one line.
  bool is_wide(const std::vector<VertexId>& points) const {
    if (points.size() < 3) return false;
    const auto far_from = [&](VertexId v) {
      return *std::max_element(points.begin(), points.end(),
                               [&](VertexId a, VertexId b) { return norm(at(a) - at(v)) < norm(at(b) - at(v)); });
    };
    const VertexId first = far_from(points.front()), last = far_from(first);
    return std::any_of(points.begin(), points.end(), [&](VertexId v) {
      return norm(at(v) - nearest_on_segment(at(v), at(first), at(last))) > kFlat * distance_;
    });
  }

  Soup& soup_;
  const SoupEdges& edges_;
  const double distance_;
  const std::span<const std::uint8_t> active_;
  RunControl& control_;
  mutable std::atomic<bool> do_any_intersect_ = false;  ///< some faces that were compared do
  FacePairs near_;                                      ///< ascending
  std::vector<FaceId> faces_;                           ///< those of near_, ascending
  Contacts contacts_;
  std::optional<CutSides> sides_;
};

}  // namespace

std::optional<CutPlan> find_contacts(Soup& soup, const SoupEdges& edges, double distance,
                                     std::span<const std::uint8_t> active, RunControl& control) {
  return ContactSearch(soup, edges, distance, active, control).run();
}

}  // namespace remesh
