#include "core/solids/cut_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/exact/predicates.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/patch_triangulation.h"

namespace remesh {
namespace {

/// Triangles are flat below this height.
constexpr double kFlatHeight = 4 * kSoupRoundingStep;

/// A new triangle, and the faces of the soup that it is a piece of.
struct Piece {
  Triangle corners;
  std::vector<std::pair<FaceId, bool>> of;  ///< true: the face is the other way round
};

/// The pieces of the faces of one plane.
struct Pieces {
  std::vector<Piece> all;
  std::size_t failed = 0;
};

Vec3 twice_area_of(const Soup& soup, FaceId f) {
  const Triangle& t = soup.faces[f.value];
  const Vec3& a = soup.positions[t[0].value];
  return cross(soup.positions[t[1].value] - a, soup.positions[t[2].value] - a);
}

/// The plane of coordinates to which faces are projected. No coordinate is rounded by that.
class Projected {
 public:
  explicit Projected(const Vec3& normal) {
    for (int axis = 0; axis < 3; ++axis)
      if (std::fabs(normal[axis]) > std::fabs(normal[axis_])) axis_ = axis;
    is_mirrored_ = normal[axis_] < 0;
  }
  Vec2 operator()(const Vec3& p) const {
    const double u = p[(axis_ + 1) % 3], v = p[(axis_ + 2) % 3];
    return is_mirrored_ ? Vec2{v, u} : Vec2{u, v};
  }

 private:
  int axis_ = 0;
  bool is_mirrored_ = false;
};

/// Cuts the faces of one plane.
class PlaneCut {
 public:
  PlaneCut(const Soup& soup, const CutPlan& plan, const CutSides& sides, const Grouping& in_face,
           const Grouping& constraints, RunControl& control)
      : soup_(soup), plan_(plan), sides_(sides), in_face_(in_face), constraints_(constraints), control_(control) {}

  /// Cuts faces that lie on each other, or a single face.
  Pieces cut(std::span<const std::uint32_t> faces) {
    if (auto pieces = triangulate(faces, true)) return *std::move(pieces);
    Pieces all;
    for (const std::uint32_t& f : faces) {
      const std::span one(&f, 1);
      auto pieces = faces.size() > 1 ? triangulate(one, true) : std::nullopt;
      if (!pieces) {
        pieces = triangulate(one, false);
        if (!pieces) pieces = fan(FaceId(f));
        ++all.failed;
      }
      std::move(pieces->all.begin(), pieces->all.end(), std::back_inserter(all.all));
    }
    return all;
  }

 private:
  /// The directed edges around a face that are left when those in both directions are dropped.
  using Outline = std::vector<std::pair<VertexId, VertexId>>;

  Outline outline_of(FaceId f) const {
    std::vector<VertexId> points;
    sides_.append_outline(f, points);
    Outline outline;
    for (std::size_t i = 0; i < points.size() && points.size() > 2; ++i)
      outline.push_back({points[i], points[(i + 1) % points.size()]});
    std::sort(outline.begin(), outline.end());
    Outline left;
    for (std::size_t i = 0, next = 0; i < outline.size(); i = next) {
      while (next < outline.size() && outline[next] == outline[i]) ++next;
      const auto back =
          std::equal_range(outline.begin(), outline.end(), std::pair(outline[i].second, outline[i].first));
      const std::size_t times = next - i, times_back = static_cast<std::size_t>(back.second - back.first);
      for (std::size_t k = times_back; k < times; ++k) left.push_back(outline[i]);
    }
    return left;
  }

  /// Triangulates the faces together.
  /// Output: nothing, if points or constraints are in each other's way.
  std::optional<Pieces> triangulate(std::span<const std::uint32_t> faces, bool with_constraints) {
    Vec3 normal = {};
    double largest = 0;
    std::vector<Outline> outlines;
    for (const std::uint32_t f : faces) {
      control_.check();
      const Vec3 of_face = twice_area_of(soup_, FaceId(f));
      if (dot(of_face, of_face) > largest) normal = of_face;
      largest = std::max(largest, dot(of_face, of_face));
      outlines.push_back(outline_of(FaceId(f)));
    }
    const Projected project(normal);
    if (!make_points(faces, outlines, with_constraints, project)) return std::nullopt;
    if (vertices_.size() < 3) return Pieces{};
    if (uv_.empty()) return std::nullopt;
    mesh_ = triangulate_points(uv_, control_);
    if (mesh_.triangle_count() == 0) return are_all_empty(outlines) ? std::optional(Pieces{}) : std::nullopt;
    if (constraint_recovery(uv_, segments_, mesh_, control_) != TriangulationOutcome::kDone) return std::nullopt;
    flip_flat_triangles();
    return assign(faces, outlines, normal);
  }

  static bool are_all_empty(const std::vector<Outline>& outlines) {
    return std::all_of(outlines.begin(), outlines.end(), [](const Outline& o) { return o.empty(); });
  }

  /// Collects the points and the segments.
  /// Output: false if two points have the same place in the plane.
  bool make_points(std::span<const std::uint32_t> faces, const std::vector<Outline>& outlines, bool with_constraints,
                   const Projected& project) {
    std::vector<std::pair<VertexId, VertexId>> lines;
    vertices_.clear();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      control_.check();
      if (outlines[i].empty()) continue;
      for (const auto& [a, b] : outlines[i]) lines.push_back(std::minmax(a, b));
      if (!with_constraints) continue;
      for (const std::uint32_t p : in_face_[faces[i]]) vertices_.push_back(plan_.image_of(plan_.in_faces[p].second));
      for (const std::uint32_t c : constraints_[faces[i]]) {
        const VertexId a = plan_.image_of(plan_.constraints[c].from), b = plan_.image_of(plan_.constraints[c].to);
        if (a != b) lines.push_back(std::minmax(a, b));
      }
    }
    sort_unique(lines, control_);
    for (const auto& [a, b] : lines) vertices_.insert(vertices_.end(), {a, b});
    sort_unique(vertices_, control_);
    std::vector<std::pair<Vec2, VertexId>> places;
    for (const VertexId v : vertices_) places.push_back({project(soup_.positions[v.value]), v});
    sort_stoppable(places.begin(), places.end(), control_);
    uv_.clear();
    std::vector<std::uint32_t> number(vertices_.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      if (i > 0 && places[i].first == places[i - 1].first) return false;
      uv_.push_back(places[i].first);
      number[index_of(places[i].second)] = i;
    }
    segments_.clear();
    for (const auto& [a, b] : lines) segments_.push_back({number[index_of(a)], number[index_of(b)]});
    number_ = number;
    vertex_at_.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) vertex_at_[i] = places[i].second;
    return true;
  }

  /// Output: the smallest height of a triangle. It does not depend on the order of the corners, so that no flip is
  /// undone because of rounding.
  double height(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (a > b) std::swap(a, b);
    if (b > c) std::swap(b, c);
    if (a > b) std::swap(a, b);
    const Vec2 ab = uv_[b] - uv_[a], bc = uv_[c] - uv_[b], ca = uv_[a] - uv_[c];
    return std::fabs(cross(ab, bc)) / std::sqrt(std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)}));
  }

  /// Flips edges of flat triangles where that makes the smallest height of the two triangles larger. Points on one
  /// line are rounded, so that a triangle between three of them has hardly any height, and its long side passes the
  /// middle point. If the triangle beyond that side has a smaller angle, the Delaunay property keeps both. The list of
  /// all heights, the smallest first, grows with each flip, so flips end.
  void flip_flat_triangles() {
    std::vector<std::uint32_t> flat;
    const auto add_if_flat = [&](std::uint32_t t) {
      if (height(mesh_.from(3 * t), mesh_.to(3 * t), mesh_.apex(3 * t)) < kFlatHeight) flat.push_back(t);
    };
    StopCheck check(control_);
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      check();
      add_if_flat(t);
    }
    while (!flat.empty()) {
      check();
      const std::uint32_t t = flat.back();
      flat.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t twin = mesh_.twin(h);
        if (mesh_.is_constrained(h) || twin == kNoHalfEdge) continue;
        const std::uint32_t a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(twin);
        const bool is_convex = orient2d(uv_[d], uv_[c], uv_[a]) > 0 && orient2d(uv_[c], uv_[d], uv_[b]) > 0;
        if (!is_convex || std::min(height(d, c, a), height(c, d, b)) <= std::min(height(a, b, c), height(b, a, d)))
          continue;
        mesh_.flip(h);
        // The triangles beside may be flipped now, too.
        for (const std::uint32_t first : {3 * (h / 3), 3 * (twin / 3)})
          for (std::uint32_t g = first; g < first + 3; ++g) {
            add_if_flat(g / 3);
            if (mesh_.twin(g) != kNoHalfEdge) add_if_flat(mesh_.twin(g) / 3);
          }
        break;
      }
    }
  }

  std::size_t index_of(VertexId v) const {
    return static_cast<std::size_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  }

  /// Finds which triangles each face covers: those on the inner side of its outline.
  /// Output: nothing, if some outline does not go around triangles.
  std::optional<Pieces> assign(std::span<const std::uint32_t> faces, const std::vector<Outline>& outlines,
                               const Vec3& normal) {
    using HalfEdge = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
    std::vector<HalfEdge> half_edges;
    for (std::uint32_t h = 0; h < mesh_.half_edge_count(); ++h) half_edges.push_back({mesh_.from(h), mesh_.to(h), h});
    sort_stoppable(half_edges.begin(), half_edges.end(), control_);
    const auto find = [&](VertexId from, VertexId to) {
      const std::uint32_t a = number_[index_of(from)], b = number_[index_of(to)];
      const auto at = std::lower_bound(half_edges.begin(), half_edges.end(), HalfEdge{a, b, 0});
      const bool is_there = at != half_edges.end() && std::get<0>(*at) == a && std::get<1>(*at) == b;
      return is_there ? std::get<2>(*at) : kNoHalfEdge;
    };
    std::vector<std::vector<std::pair<FaceId, bool>>> of(mesh_.triangle_count());
    std::vector<std::uint32_t> rim(mesh_.half_edge_count(), kNone), seen(mesh_.triangle_count(), kNone), stack;
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      control_.check();
      const FaceId f(faces[i]);
      const bool is_reversed = dot(twice_area_of(soup_, f), normal) < 0;
      stack.clear();
      for (const auto& [a, b] : outlines[i]) {
        const std::uint32_t inner = is_reversed ? find(b, a) : find(a, b);
        if (inner == kNoHalfEdge) return std::nullopt;
        rim[inner] = i;
        stack.push_back(inner / 3);
      }
      while (!stack.empty()) {
        const std::uint32_t t = stack.back();
        stack.pop_back();
        if (std::exchange(seen[t], i) == i) continue;
        of[t].push_back({f, is_reversed});
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          if (rim[h] == i) continue;
          const std::uint32_t twin = mesh_.twin(h);
          // Beyond a side that is seen from outside, or the hull, the flood has left the face.
          if (twin == kNoHalfEdge || rim[twin] == i) return std::nullopt;
          stack.push_back(twin / 3);
        }
      }
    }
    Pieces pieces;
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (of[t].empty()) continue;
      const auto corner = [&](std::uint32_t k) { return vertex_at_[mesh_.from(3 * t + k)]; };
      pieces.all.push_back({{corner(0), corner(1), corner(2)}, std::move(of[t])});
    }
    return pieces;
  }

  /// Divides a face into triangles with a common corner, whatever their shapes.
  Pieces fan(FaceId f) const {
    std::vector<VertexId> points;
    sides_.append_outline(f, points);
    Pieces pieces;
    for (std::size_t i = 1; i + 1 < points.size(); ++i)
      if (points[0] != points[i] && points[i] != points[i + 1] && points[0] != points[i + 1])
        pieces.all.push_back({{points[0], points[i], points[i + 1]}, {{f, false}}});
    return pieces;
  }

  const Soup& soup_;
  const CutPlan& plan_;
  const CutSides& sides_;
  const Grouping &in_face_, &constraints_;  ///< by face
  RunControl& control_;
  std::vector<VertexId> vertices_, vertex_at_;  ///< ascending, and in the order of their places
  std::vector<std::uint32_t> number_;           ///< the place of each of `vertices_` in that order
  std::vector<Vec2> uv_;
  std::vector<Segment> segments_;
  Triangulation2d mesh_;
};

/// Returns whether sorting the corners turns a triangle over.
bool sort_corners(Triangle& t) {
  bool is_turned = false;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (t[i] < t[j]) return;
    std::swap(t[i], t[j]);
    is_turned = !is_turned;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return is_turned;
}

/// Collects the triangles of a cut, and joins those with the same corners.
class Collector {
 public:
  explicit Collector(const Soup& soup) : soup_(soup) {}

  void add(const Triangle& corners, std::span<const std::pair<FaceId, bool>> of, bool is_new) {
    Entry entry{corners, static_cast<std::uint32_t>(covers_.size()), 0, false, is_new};
    entry.is_turned = sort_corners(entry.sorted);
    for (const auto& [f, is_reversed] : of)
      for (const Cover& cover : soup_.covers_of(f.value))
        covers_.push_back({cover.face, cover.is_reversed != (is_reversed != entry.is_turned)});
    entry.end = static_cast<std::uint32_t>(covers_.size());
    entries_.push_back(entry);
  }

  CutSoup collect(RunControl& control) {
    sort_stoppable(entries_.begin(), entries_.end(), control,
                   [](const Entry& a, const Entry& b) { return a.sorted < b.sorted; });
    CutSoup cut;
    StopCheck check(control);
    std::vector<Cover> covers;
    for (std::size_t i = 0; i < entries_.size();) {
      check();
      const std::size_t first = i;
      bool is_new = false;
      covers.clear();
      for (; i < entries_.size() && entries_[i].sorted == entries_[first].sorted; ++i) {
        is_new = is_new || entries_[i].is_new;
        covers.insert(covers.end(), covers_.begin() + entries_[i].begin, covers_.begin() + entries_[i].end);
      }
      std::sort(covers.begin(), covers.end());
      Triangle corners = entries_[first].sorted;
      // The first cover faces as the triangle does.
      if (covers.front().is_reversed) {
        std::swap(corners[1], corners[2]);
        for (Cover& cover : covers) cover.is_reversed = !cover.is_reversed;
      }
      cut.faces.push_back(corners);
      cut.covers.insert(cut.covers.end(), covers.begin(), covers.end());
      cut.cover_begin.push_back(static_cast<std::uint32_t>(cut.covers.size()));
      cut.is_active.push_back(is_new ? 1 : 0);
    }
    return cut;
  }

 private:
  struct Entry {
    Triangle sorted;
    std::uint32_t begin, end;  ///< of its covers, seen with sorted corners
    bool is_turned, is_new;
  };
  const Soup& soup_;
  std::vector<Entry> entries_;
  std::vector<Cover> covers_;
};

}  // namespace

CutSoup cut_faces(const Soup& soup, const SoupEdges& edges, CutPlan& plan, std::span<const std::uint8_t> active,
                  RunControl& control) {
  const std::size_t n = soup.faces.size();
  const CutSides sides(soup, edges, plan, control);
  const Grouping in_face = group_by(
      plan.in_faces.size(), n, [&](std::uint32_t i) { return plan.in_faces[i].first.value; }, control);
  const Grouping constraints = group_by(
      plan.constraints.size(), n, [&](std::uint32_t i) { return plan.constraints[i].face.value; }, control);
  UnionFind planes(n);
  for (const auto& [f, g] : plan.in_one_plane) planes.join(f.value, g.value);
  const Grouping plane = group_by(
      n, n, [&](std::uint32_t f) { return planes.find(f); }, control);
  const auto is_cut = [&](std::uint32_t f) {
    bool is_any = !in_face[f].empty() || !constraints[f].empty();
    for (std::size_t k = 0; k < 3; ++k) is_any = is_any || sides.has_points(edges.of(FaceId(f), k));
    return is_any;
  };

  Collector collector(soup);
  std::vector<std::uint32_t> to_cut;
  StopCheck check(control);
  for (std::uint32_t f = 0; f < n; ++f) {
    check();
    const auto together = plane[planes.find(f)];
    if (together.size() > 1 || is_cut(f)) {
      if (together.front() == f) to_cut.push_back(f);
      continue;
    }
    const Triangle& t = soup.faces[f];
    const Triangle image{plan.image_of(t[0]), plan.image_of(t[1]), plan.image_of(t[2])};
    if (image[0] == image[1] || image[1] == image[2] || image[2] == image[0]) continue;
    const std::pair<FaceId, bool> itself(FaceId(f), false);
    collector.add(image, {&itself, 1}, image != t || (!active.empty() && active[f] != 0));
  }
  constexpr std::size_t kPlanesPerBlock = 16;
  const auto cut = map_blocks<Pieces>(to_cut.size(), kPlanesPerBlock, control, [&](std::size_t i, std::size_t end) {
    PlaneCut plane_cut(soup, plan, sides, in_face, constraints, control);
    Pieces all;
    for (; i < end; ++i) {
      Pieces pieces = plane_cut.cut(plane[planes.find(to_cut[i])]);
      std::move(pieces.all.begin(), pieces.all.end(), std::back_inserter(all.all));
      all.failed += pieces.failed;
    }
    return all;
  });
  std::size_t failed = 0;
  for (const Pieces& pieces : cut) {
    failed += pieces.failed;
    for (const Piece& piece : pieces.all) {
      check();
      collector.add(piece.corners, piece.of, true);
    }
  }
  CutSoup result = collector.collect(control);
  result.failed = failed;
  return result;
}

}  // namespace remesh
