#include "core/mending/edges/openings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/planes/projection.h"
#include "core/geometry/trees/box_tree.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/patch_triangulation.h"
#include "core/triangulation/triangulation_2d.h"
#include "core/triangulation/triangulation_outcome.h"

namespace remesh {
namespace {

/// Vertices of rims by their numbers, which ascend with their coordinates.
using RimNumbers = std::vector<std::uint32_t>;

/// The open edges of a surface, in the direction of the faces that would close it.
class RimEdges {
 public:
  RimEdges(const Surface& surface, const Adjacency& edges, RunControl& control) : surface_(surface), control_(control) {
    std::vector<OpenHalfEdge> open;
    StopCheck check(control);
    for (const EdgeId e : edges.odd_edges()) {
      check();
      const auto around = edges.half_edges(e);
      const VertexId from = edges.to(around[0]), to = edges.from(around[0]);
      if (around.size() != 1 || from == to) continue;
      open.push_back({from, to, edges.face_of(around[0])});
      vertices_.insert(vertices_.end(), {from, to});
    }
    sort_stoppable(vertices_.begin(), vertices_.end(), control, [&](VertexId v, VertexId w) {
      return std::tie(surface.positions[v], v) < std::tie(surface.positions[w], w);
    });
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    number(open, check);
    cut_dead_ends(check);
    find_partners(check);
  }

  VertexId vertex(std::uint32_t number) const { return vertices_[number]; }
  const Vec3& place(std::uint32_t number) const { return surface_.local[vertices_[number]]; }

  /// Takes the edges apart into loops that pass no vertex twice.
  std::vector<RimNumbers> take_loops() {
    std::vector<RimNumbers> loops;
    std::vector<std::uint32_t> at(vertices_.size(), kNone);  // the place of each vertex on the path
    StopCheck check(control_);
    RimNumbers path, path_edges;  // with each vertex the edge that leads to it, but for the first one
    for (std::uint32_t start = 0; start < vertices_.size(); ++start) {
      while (first_left(start) != kNone) {
        path.assign(1, start);
        path_edges.assign(1, kNone);
        at[start] = 0;
        while (!path.empty()) {
          check();
          const std::uint32_t edge = choose(path, path_edges.back());
          if (edge == kNone) {
            at[path.back()] = kNone;
            path.pop_back();
            path_edges.pop_back();
            continue;
          }
          is_taken_[edge] = 1;
          const std::uint32_t to = edges_[edge].to;
          if (at[to] == kNone) {
            at[to] = static_cast<std::uint32_t>(path.size());
            path.push_back(to);
            path_edges.push_back(edge);
            continue;
          }
          const std::size_t begin = at[to];
          loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(begin), path.end());
          for (std::size_t i = begin + 1; i < path.size(); ++i) at[path[i]] = kNone;
          path.resize(begin + 1);
          path_edges.resize(begin + 1);
          // A loop that passes a vertex twice is taken off in two parts. The rest of the path continues as the first
          // part would have.
          if (path_edges.back() != kNone) partner_[path_edges.back()] = partner_[edge];
        }
      }
    }
    return loops;
  }

 private:
  /// An open edge in the direction of a face that would close it, and the face that is there.
  struct OpenHalfEdge {
    VertexId from, to;
    FaceId face;
  };
  /// The same edge, by the numbers of its vertices.
  struct RimEdge {
    std::uint32_t from, to;
    FaceId face;
  };

  void number(const std::vector<OpenHalfEdge>& open, StopCheck& check) {
    std::vector<std::pair<VertexId, std::uint32_t>> numbers;
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) numbers.emplace_back(vertices_[i], i);
    sort_stoppable(numbers.begin(), numbers.end(), control_);
    const auto number_of = [&](VertexId v) {
      return std::lower_bound(numbers.begin(), numbers.end(), std::pair(v, 0u))->second;
    };
    for (const auto& [from, to, face] : open) {
      check();
      edges_.push_back({number_of(from), number_of(to), face});
    }
    sort_stoppable(edges_.begin(), edges_.end(), control_,
                   [](const RimEdge& a, const RimEdge& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
    begin_.assign(vertices_.size() + 1, 0);
    head_begin_.assign(vertices_.size() + 1, 0);
    for (const RimEdge& edge : edges_) {
      ++begin_[edge.from + 1];
      ++head_begin_[edge.to + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::partial_sum(head_begin_.begin(), head_begin_.end(), head_begin_.begin());
    next_ = {begin_.begin(), begin_.end() - 1};
    by_head_.resize(edges_.size());
    std::vector<std::uint32_t> at(head_begin_.begin(), head_begin_.end() - 1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) by_head_[at[edges_[e].to]++] = e;
    is_taken_.assign(edges_.size(), 0);
  }

  /// Takes away the edges that cannot be part of a loop, because no edge follows or precedes them.
  void cut_dead_ends(StopCheck& check) {
    std::vector<std::uint32_t> out(vertices_.size()), in(vertices_.size()), queue;
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      check();
      out[v] = begin_[v + 1] - begin_[v];
      in[v] = head_begin_[v + 1] - head_begin_[v];
      if (out[v] == 0 || in[v] == 0) queue.push_back(v);
    }
    const auto take = [&](std::uint32_t e) {
      check();
      if (is_taken_[e] != 0) return;
      is_taken_[e] = 1;
      if (--out[edges_[e].from] == 0) queue.push_back(edges_[e].from);
      if (--in[edges_[e].to] == 0) queue.push_back(edges_[e].to);
    };
    while (!queue.empty()) {
      const std::uint32_t v = queue.back();
      queue.pop_back();
      for (std::uint32_t e = begin_[v]; e < begin_[v + 1]; ++e) take(e);
      for (std::uint32_t i = head_begin_[v]; i < head_begin_[v + 1]; ++i) take(by_head_[i]);
    }
  }

  /// At a vertex where several open edges end, finds for each of them the edge with which it bounds a gap between the
  /// faces there. Seen from outside, along the mean of the faces' normals, faces and gaps take turns around the vertex.
  /// A gap runs counter-clockwise from an edge that leaves the vertex to one that ends there.
  void find_partners(StopCheck& check) {
    partner_.assign(edges_.size(), kNone);
    struct Around {
      double angle;
      bool leaves;
      std::uint32_t edge;
    };
    std::vector<Around> around;
    std::unordered_map<std::uint32_t, Vec3> normals;
    const auto normal_of = [&](FaceId f) {
      const auto [entry, is_new] = normals.try_emplace(f.value);
      if (is_new) {
        std::vector<Vec3> loop;
        for (const VertexId v : surface_.face(f)) loop.push_back(surface_.local[v]);
        entry->second = normalized(newell_normal(loop));
      }
      return entry->second;
    };
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      check();
      if (begin_[v + 1] - begin_[v] < 2) continue;
      around.clear();
      Vec3 mean;
      const auto add = [&](std::uint32_t e, bool leaves) {
        check();
        if (is_taken_[e] != 0) return;
        around.push_back({0, leaves, e});
        mean += normal_of(edges_[e].face);
      };
      for (std::uint32_t e = begin_[v]; e < begin_[v + 1]; ++e) add(e, true);
      for (std::uint32_t i = head_begin_[v]; i < head_begin_[v + 1]; ++i) add(by_head_[i], false);
      const Vec3 up = normalized(mean), x = unit_across(up), y = cross(up, x);
      if (up == Vec3{}) continue;
      for (Around& a : around) {
        const Vec3 way = place(a.leaves ? edges_[a.edge].to : edges_[a.edge].from) - place(v);
        a.angle = std::atan2(dot(way, y), dot(way, x));
      }
      std::sort(around.begin(), around.end(), [&](const Around& a, const Around& b) {
        return std::tie(a.angle, a.leaves, a.edge) < std::tie(b.angle, b.leaves, b.edge);
      });
      const std::size_t n = around.size();
      bool do_take_turns = n % 2 == 0;
      for (std::size_t i = 0; i < n; ++i)
        do_take_turns = do_take_turns && around[i].leaves != around[i + 1 == n ? 0 : i + 1].leaves;
      if (!do_take_turns) continue;
      for (std::size_t i = 0; i < n; ++i)
        if (!around[i].leaves) partner_[around[i].edge] = around[i == 0 ? n - 1 : i - 1].edge;
    }
  }

  /// Returns the first edge from a vertex that is not taken yet, or kNone.
  std::uint32_t first_left(std::uint32_t v) {
    std::uint32_t& next = next_[v];
    while (next < begin_[v + 1] && is_taken_[next] != 0) ++next;
    return next < begin_[v + 1] ? next : kNone;
  }

  /// Returns the edge by which a path continues, or kNone: the partner of the last edge, or the edge that bends out of
  /// the plane of the edges before by the smallest angle.
  std::uint32_t choose(const RimNumbers& path, std::uint32_t last_edge) {
    constexpr std::uint32_t kMaxLooks = 16;
    const std::uint32_t v = path.back(), first = first_left(v);
    if (first == kNone || first + 1 == begin_[v + 1]) return first;
    const std::uint32_t partner = last_edge == kNone ? kNone : partner_[last_edge];
    if (partner != kNone && is_taken_[partner] == 0) return partner;
    const Vec3 normal = last_normal(path);
    std::uint32_t best = first;
    double least = HUGE_VAL;
    for (std::uint32_t e = first; e < std::min(begin_[v + 1], first + kMaxLooks); ++e) {
      if (is_taken_[e] != 0) continue;
      const double bend = std::fabs(dot(normal, normalized(place(edges_[e].to) - place(v))));
      if (bend < least) {
        least = bend;
        best = e;
      }
    }
    return best;
  }

  /// Returns the normal of the plane of the last edges of a path, of any length, or 0 if they are on one line.
  Vec3 last_normal(const RimNumbers& path) const {
    constexpr std::size_t kMaxEdges = 16;
    const std::size_t n = path.size();
    Vec3 best;
    if (n < 3) return best;
    const Vec3 last = normalized(place(path[n - 1]) - place(path[n - 2]));
    for (std::size_t i = n - 2; i > 0 && n - i <= kMaxEdges; --i) {
      const Vec3 normal = cross(normalized(place(path[i]) - place(path[i - 1])), last);
      if (norm(normal) > norm(best)) best = normal;
    }
    return best;
  }

  const Surface& surface_;
  RunControl& control_;
  std::vector<VertexId> vertices_;           ///< by number
  std::vector<RimEdge> edges_;               ///< by the numbers of their ends
  std::vector<std::uint32_t> begin_, next_;  ///< of the edges that leave each vertex; the first that may be left
  std::vector<std::uint32_t> head_begin_, by_head_;  ///< the edges that end at each vertex
  std::vector<std::uint32_t> partner_;               ///< the edge that follows on each, or kNone
  std::vector<std::uint8_t> is_taken_;
};

/// A loop of open edges that passes no vertex twice, and the plane through it.
struct RimLoop {
  RimNumbers numbers;
  Vec3 centre, normal;
  double twice_area = 0;
  OpeningKind kind = OpeningKind::kNotFlat;
};

/// Edges of one plane, which divide it into parts.
class RimPlane {
 public:
  RimPlane(const RimEdges& rims, const Adjacency& edges, double tolerance, RunControl& control)
      : rims_(rims), edges_(edges), tolerance_(tolerance), control_(control) {}

  /// Divides the plane.
  /// Input:  loops in one plane, at least one of which encloses an area.
  /// Output: false if edges cross each other, or if a vertex lies on an edge.
  bool divide(std::span<const RimLoop* const> loops) {
    const RimLoop& largest = **std::max_element(
        loops.begin(), loops.end(), [](const RimLoop* a, const RimLoop* b) { return a->twice_area < b->twice_area; });
    lay_out(loops, largest);
    for (std::size_t i = 1; i < uv_.size(); ++i)
      if (uv_[i] == uv_[i - 1]) return false;
    mesh_ = triangulate_points(uv_, control_);
    if (mesh_.triangle_count() == 0) return false;
    if (constraint_recovery(uv_, segments_, mesh_, control_) != TriangulationOutcome::kDone) return false;
    find_parts();
    return true;
  }

  /// Makes an opening of each bounded part.
  void add_openings(std::vector<Opening>& openings) {
    StopCheck check(control_);
    for (std::size_t begin = 0, end; begin < bounds_.size(); begin = end) {
      const std::uint32_t part = part_[bounds_[begin] / 3];
      for (end = begin + 1; end < bounds_.size() && part_[bounds_[end] / 3] == part; ++end) check();
      if (parts_[part].is_bounded)
        openings.push_back(make_opening({bounds_.data() + begin, end - begin}, parts_[part]));
    }
  }

 private:
  /// A part of the plane without an edge inside.
  struct Part {
    bool is_bounded = true;
    std::uint32_t depth = kNone;
    bool is_left = false;   ///< of an edge
    bool is_right = false;  ///< of an edge
  };
  using HalfEdges = std::vector<std::uint32_t>;

  void lay_out(std::span<const RimLoop* const> loops, const RimLoop& largest) {
    std::vector<Vec3> points;
    StopCheck check(control_);
    for (const RimLoop* loop : loops)
      for (std::size_t i = 0; i < loop->numbers.size(); ++i) {
        check();
        numbers_.push_back(loop->numbers[i]);
        segments_.push_back({loop->numbers[i], loop->numbers[i + 1 == loop->numbers.size() ? 0 : i + 1]});
        points.push_back(rims_.place(loop->numbers[i]));
      }
    const std::vector<Vec2> places = lay_out_polygon(points, largest.centre, largest.normal, control_);
    std::vector<std::pair<Vec2, std::uint32_t>> sorted;
    for (std::size_t i = 0; i < places.size(); ++i) sorted.emplace_back(places[i], numbers_[i]);
    sort_unique(sorted, control_);
    sort_unique(numbers_, control_);
    std::vector<std::uint32_t> point_of(numbers_.size());
    for (std::uint32_t i = 0; i < sorted.size(); ++i) {
      check();
      uv_.push_back(sorted[i].first);
      point_of[index_of(sorted[i].second)] = i;
    }
    for (Segment& segment : segments_) segment = {point_of[index_of(segment[0])], point_of[index_of(segment[1])]};
    for (std::size_t i = 0; i < sorted.size(); ++i) numbers_[i] = sorted[i].second;
    sort_stoppable(segments_.begin(), segments_.end(), control_);
  }
  /// Returns where a number stands in `numbers_`, while these are sorted.
  std::size_t index_of(std::uint32_t number) const {
    return static_cast<std::size_t>(std::lower_bound(numbers_.begin(), numbers_.end(), number) - numbers_.begin());
  }

  void find_parts() {
    part_.assign(mesh_.triangle_count(), kNone);
    std::vector<std::uint32_t> stack;
    StopCheck check(control_);
    for (std::uint32_t seed = 0; seed < mesh_.triangle_count(); ++seed) {
      check();
      if (part_[seed] != kNone) continue;
      const auto part = static_cast<std::uint32_t>(parts_.size());
      Part& of = parts_.emplace_back();
      part_[seed] = part;
      stack.assign(1, seed);
      while (!stack.empty()) {
        check();
        const std::uint32_t t = stack.back();
        stack.pop_back();
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          const std::uint32_t twin = mesh_.twin(h);
          if (mesh_.is_constrained(h)) {
            bounds_.push_back(h);
            const Segment along{mesh_.from(h), mesh_.to(h)};
            (std::binary_search(segments_.begin(), segments_.end(), along) ? of.is_left : of.is_right) = true;
          } else if (twin == kNoHalfEdge) {
            of.is_bounded = false;
          } else if (part_[twin / 3] == kNone) {
            part_[twin / 3] = part;
            stack.push_back(twin / 3);
          }
        }
      }
    }
    find_depths();
    is_bridge_.assign(mesh_.half_edge_count(), 0);
    sort_stoppable(bounds_.begin(), bounds_.end(), control_, [&](std::uint32_t g, std::uint32_t h) {
      const auto key = [&](std::uint32_t e) {
        return std::tuple(part_[e / 3], numbers_[mesh_.from(e)], numbers_[mesh_.to(e)]);
      };
      return key(g) < key(h);
    });
  }

  /// Walks from outside into the parts, across their edges.
  void find_depths() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours;
    std::vector<std::uint32_t> reached;
    const auto reach = [&](std::uint32_t part, std::uint32_t depth) {
      if (parts_[part].depth != kNone) return;
      parts_[part].depth = depth;
      reached.push_back(part);
    };
    StopCheck check(control_);
    for (std::uint32_t part = 0; part < parts_.size(); ++part)
      if (!parts_[part].is_bounded) reach(part, 0);
    for (const std::uint32_t h : bounds_) {
      check();
      const std::uint32_t part = part_[h / 3], twin = mesh_.twin(h);
      if (twin == kNoHalfEdge)
        reach(part, 1);
      else
        neighbours.emplace_back(part, part_[twin / 3]);
    }
    // Parts outside come first, although some parts inside were reached before.
    std::stable_sort(reached.begin(), reached.end(),
                     [&](std::uint32_t p, std::uint32_t q) { return parts_[p].depth < parts_[q].depth; });
    sort_stoppable(neighbours.begin(), neighbours.end(), control_);
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const std::uint32_t part = reached[i];
      for (auto n = std::lower_bound(neighbours.begin(), neighbours.end(), std::pair(part, 0u));
           n != neighbours.end() && n->first == part; ++n) {
        check();
        reach(n->second, parts_[part].depth + 1);
      }
    }
  }

  /// Returns the next edge along the boundary of a part. Bridges count as boundaries.
  std::uint32_t next_bound(std::uint32_t h) const {
    h = Triangulation2d::next(h);
    while (!mesh_.is_constrained(h) && is_bridge_[h] == 0) h = Triangulation2d::next(mesh_.twin(h));
    return h;
  }

  /// Walks along the boundary of a part, and returns the vertices there.
  RimNumbers walk(std::uint32_t start) const {
    RimNumbers walked;
    StopCheck check(control_);
    std::uint32_t h = start;
    do {
      check();
      walked.push_back(numbers_[mesh_.from(h)]);
      h = next_bound(h);
    } while (h != start);
    return walked;
  }

  double twice_area(std::uint32_t start) const {
    double sum = 0;
    std::uint32_t h = start;
    const Vec2 origin = uv_[mesh_.from(start)];
    do {
      sum += cross(uv_[mesh_.from(h)] - origin, uv_[mesh_.to(h)] - origin);
      h = next_bound(h);
    } while (h != start);
    return sum;
  }

  /// Makes an opening of a part with these boundary edges.
  Opening make_opening(std::span<const std::uint32_t> bounds, const Part& part) {
    // The loops of the boundary, by their first edges. The outer one comes first.
    HalfEdges starts;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> loop_of;  // of the point where each boundary edge begins
    StopCheck check(control_);
    std::vector<std::uint32_t> sorted(bounds.begin(), bounds.end());
    sort_stoppable(sorted.begin(), sorted.end(), control_);
    std::vector<std::uint8_t> is_visited(sorted.size(), 0);
    for (const std::uint32_t start : bounds) {
      const auto place = [&](std::uint32_t h) {
        return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), h) - sorted.begin());
      };
      if (is_visited[place(start)] != 0) continue;
      std::uint32_t h = start;
      do {
        check();
        is_visited[place(h)] = 1;
        loop_of.emplace_back(mesh_.from(h), static_cast<std::uint32_t>(starts.size()));
        h = next_bound(h);
      } while (h != start);
      starts.push_back(start);
    }
    Opening opening;
    opening.depth = part.depth;
    const bool is_reversed = !part.is_left;
    const auto as_vertices = [&](RimNumbers numbers) {
      if (is_reversed) std::reverse(numbers.begin() + 1, numbers.end());
      std::vector<VertexId> vertices;
      for (const std::uint32_t number : numbers) vertices.push_back(rims_.vertex(number));
      return vertices;
    };
    const auto outer = static_cast<std::size_t>(
        std::find_if(starts.begin(), starts.end(), [&](std::uint32_t h) { return twice_area(h) > 0; }) -
        starts.begin());
    if (outer == starts.size() || (part.is_left && part.is_right)) opening.kind = OpeningKind::kMixed;
    for (const std::uint32_t start : starts) opening.rims.push_back({as_vertices(walk(start)), {}, 0, 0});
    if (opening.kind == OpeningKind::kMixed) return opening;
    std::rotate(opening.rims.begin(), opening.rims.begin() + static_cast<std::ptrdiff_t>(outer),
                opening.rims.begin() + static_cast<std::ptrdiff_t>(outer) + 1);
    if (!build_bridges(bounds, loop_of, starts.size())) {
      opening.kind = OpeningKind::kNoBridge;
      return opening;
    }
    const RimNumbers outline = walk(starts[outer]);
    opening.outline = as_vertices(outline);
    opening.kind = is_flat(outline) ? OpeningKind::kFlat : OpeningKind::kNotFlat;
    return opening;
  }

  /// Joins the loops of a part's boundary by the shortest edges inside that join them.
  /// Input:  `loop_of` - the loop of each boundary point.
  /// Output: false if that needs edges that the surface has already.
  bool build_bridges(std::span<const std::uint32_t> bounds,
                     std::vector<std::pair<std::uint32_t, std::uint32_t>>& loop_of, std::size_t loops) {
    if (loops == 1) return true;
    sort_stoppable(loop_of.begin(), loop_of.end(), control_);
    const auto loop_at = [&](std::uint32_t point) {
      return std::lower_bound(loop_of.begin(), loop_of.end(), std::pair(point, 0u))->second;
    };
    HalfEdges candidates;
    StopCheck check(control_);
    for (const std::uint32_t bound : bounds)
      // All edges of the part begin at points of its boundary, so walks around these points meet every edge.
      for (std::uint32_t h = Triangulation2d::next(bound); !mesh_.is_constrained(h);
           h = Triangulation2d::next(mesh_.twin(h))) {
        check();
        if (mesh_.from(h) < mesh_.to(h) && loop_at(mesh_.from(h)) != loop_at(mesh_.to(h))) candidates.push_back(h);
      }
    const auto key = [&](std::uint32_t h) {
      const Vec2 along = uv_[mesh_.to(h)] - uv_[mesh_.from(h)];
      return std::tuple(dot(along, along), numbers_[mesh_.from(h)], numbers_[mesh_.to(h)]);
    };
    sort_stoppable(candidates.begin(), candidates.end(), control_,
                   [&](std::uint32_t g, std::uint32_t h) { return key(g) < key(h); });
    UnionFind joined(loops);
    std::size_t left = loops - 1;
    for (const std::uint32_t h : candidates) {
      check();
      const VertexId from = rims_.vertex(numbers_[mesh_.from(h)]), to = rims_.vertex(numbers_[mesh_.to(h)]);
      if (edges_.find(from, to).is_valid() || !joined.join(loop_at(mesh_.from(h)), loop_at(mesh_.to(h)))) continue;
      is_bridge_[h] = is_bridge_[mesh_.twin(h)] = 1;
      if (--left == 0) return true;
    }
    return false;
  }

  bool is_flat(const RimNumbers& outline) const {
    std::vector<Vec3> points;
    Vec3 centre;
    for (const std::uint32_t number : outline) {
      points.push_back(rims_.place(number));
      centre += (1.0 / static_cast<double>(outline.size())) * points.back();
    }
    const Vec3 normal = normalized(newell_normal(points));
    return std::all_of(points.begin(), points.end(),
                       [&](const Vec3& p) { return std::fabs(dot(p - centre, normal)) <= tolerance_; });
  }

  const RimEdges& rims_;
  const Adjacency& edges_;
  double tolerance_;
  RunControl& control_;
  std::vector<std::uint32_t> numbers_;  ///< the rim vertex of each point
  std::vector<Vec2> uv_;                ///< the points, in lexicographic order
  std::vector<Segment> segments_;       ///< sorted
  Triangulation2d mesh_;
  std::vector<std::uint32_t> part_;  ///< of each triangle
  std::vector<Part> parts_;
  HalfEdges bounds_;  ///< the constrained half-edges, by part and by the coordinates of their ends
  std::vector<std::uint8_t> is_bridge_;
};

class OpeningSearch {
 public:
  OpeningSearch(const Surface& surface, const Adjacency& edges, double tolerance, RunControl& control)
      : surface_(surface), edges_(edges), tolerance_(tolerance), control_(control), rims_(surface, edges, control) {}

  std::vector<Opening> run() {
    for (RimNumbers& numbers : rims_.take_loops()) loops_.push_back(measure(std::move(numbers)));
    for (const std::vector<const RimLoop*>& loops : loops_of_planes()) {
      if (divide(loops)) continue;
      if (loops.size() == 1)
        add_rim(*loops.front(), OpeningKind::kTangled);
      else
        for (const RimLoop* loop : loops)
          if (!divide({loop})) add_rim(*loop, OpeningKind::kTangled);
    }
    for (const RimLoop& loop : loops_)
      if (loop.kind != OpeningKind::kFlat) add_rim(loop, loop.kind);
    StopCheck check(control_);
    for (Opening& opening : openings_)
      for (Rim& rim : opening.rims) measure(rim, check);
    sort_stoppable(openings_.begin(), openings_.end(), control_, [&](const Opening& a, const Opening& b) {
      const auto key = [&](const Opening& o) {
        const std::vector<VertexId>& rim = o.rims.front().vertices;
        return std::tie(surface_.positions[rim[0]], surface_.positions[rim[1]], surface_.positions[rim.back()], o.kind);
      };
      return key(a) < key(b);
    });
    return std::move(openings_);
  }

 private:
  struct LoopBox {
    Box3 box;
    void join(const LoopBox& other) { box.add(other.box); }
  };
  using Tree = BoxTree<LoopBox>;

  RimLoop measure(RimNumbers&& numbers) const {
    RimLoop loop;
    std::vector<Vec3> points;
    double length = 0;
    StopCheck check(control_);
    std::rotate(numbers.begin(), std::min_element(numbers.begin(), numbers.end()), numbers.end());
    for (const std::uint32_t number : numbers) {
      check();
      points.push_back(rims_.place(number));
      loop.centre += (1.0 / static_cast<double>(numbers.size())) * points.back();
      if (points.size() > 1) length += norm(points.back() - points[points.size() - 2]);
    }
    length += norm(points.front() - points.back());
    const Vec3 twice_area = newell_normal(points);
    loop.normal = normalized(twice_area);
    loop.twice_area = norm(twice_area);
    loop.numbers = std::move(numbers);
    double height = 0;
    for (const Vec3& p : points) height = std::max(height, std::fabs(dot(p - loop.centre, loop.normal)));
    if (height <= tolerance_)
      loop.kind = loop.twice_area > tolerance_ * length ? OpeningKind::kFlat : OpeningKind::kWithoutArea;
    return loop;
  }

  /// Puts the flat loops together that lie in one plane, one of them in the box around another one.
  std::vector<std::vector<const RimLoop*>> loops_of_planes() {
    // If there are too many pairs, some loops stay alone. Then, if one loop lies in the other, the test of a closing
    // face finds that it touches the other loop.
    constexpr std::size_t kFew = 4096, kMaxPerLoop = 64;
    std::vector<std::uint32_t> flat;
    for (std::uint32_t i = 0; i < loops_.size(); ++i)
      if (loops_[i].kind == OpeningKind::kFlat) flat.push_back(i);
    UnionFind same(flat.size());
    if (flat.size() > 1) {
      StopCheck check(control_);
      const Tree tree(Tree::make_entries(flat.size(), control_,
                                         [&](std::size_t i, Tree::Entry& entry) {
                                           for (const std::uint32_t number : loops_[flat[i]].numbers) {
                                             entry.box.add(rims_.place(number));
                                             entry.tag.box.add(rims_.place(number));
                                           }
                                         }),
                      control_);
      std::size_t looks = 0;
      for (std::uint32_t i = 0; i < flat.size() && looks <= kFew + kMaxPerLoop * flat.size(); ++i) {
        const Vec3 at = rims_.place(loops_[flat[i]].numbers.front());
        const double reach = std::max(2 * tolerance_, 1e-300);
        const auto bound = [&](const Tree::Entry& entry) {
          const Box3& box = entry.tag.box;
          return norm({excess(box.min.x, box.max.x, at.x), excess(box.min.y, box.max.y, at.y),
                       excess(box.min.z, box.max.z, at.z)});
        };
        tree.search(reach, bound, [&](std::size_t slot) {
          check();
          ++looks;
          const std::uint32_t j = tree.number(slot);
          if (i != j && lies_in_plane(loops_[flat[i]], loops_[flat[j]])) same.join(i, j);
        });
      }
    }
    std::vector<std::vector<const RimLoop*>> planes(flat.size());
    for (std::uint32_t i = 0; i < flat.size(); ++i) planes[same.find(i)].push_back(&loops_[flat[i]]);
    std::erase_if(planes, [](const auto& loops) { return loops.empty(); });
    return planes;
  }

  bool lies_in_plane(const RimLoop& loop, const RimLoop& of) const {
    return std::all_of(loop.numbers.begin(), loop.numbers.end(), [&](std::uint32_t number) {
      return std::fabs(dot(rims_.place(number) - of.centre, of.normal)) <= tolerance_;
    });
  }

  bool divide(const std::vector<const RimLoop*>& loops) {
    RimPlane plane(rims_, edges_, tolerance_, control_);
    if (!plane.divide(loops)) return false;
    plane.add_openings(openings_);
    return true;
  }

  /// Adds a rim that no face closes.
  void add_rim(const RimLoop& loop, OpeningKind kind) {
    Opening& opening = openings_.emplace_back();
    opening.kind = kind;
    opening.rims.emplace_back();
    for (const std::uint32_t number : loop.numbers) opening.rims.front().vertices.push_back(rims_.vertex(number));
  }

  void measure(Rim& rim, StopCheck& check) const {
    const std::size_t n = rim.vertices.size();
    Vec3 sum;
    for (std::size_t i = 0; i < n; ++i) {
      check();
      const Vec3 &a = surface_.local[rim.vertices[i]], &b = surface_.local[rim.vertices[i + 1 == n ? 0 : i + 1]];
      const double length = norm(b - a);
      rim.length += length;
      sum += length * (0.5 * a + 0.5 * b);
    }
    if (rim.length > 0) rim.middle = (1 / rim.length) * sum;
    for (const VertexId v : rim.vertices) rim.size = std::max(rim.size, 2 * norm(surface_.local[v] - rim.middle));
  }

  const Surface& surface_;
  const Adjacency& edges_;
  double tolerance_;
  RunControl& control_;
  RimEdges rims_;
  std::vector<RimLoop> loops_;
  std::vector<Opening> openings_;
};

}  // namespace

std::vector<Opening> find_openings(const Surface& surface, const Adjacency& edges, double tolerance,
                                   RunControl& control) {
  if (edges.odd_edges().empty()) return {};
  return OpeningSearch(surface, edges, tolerance, control).run();
}

}  // namespace remesh
