#include "core/mending/edges/t_junctions.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/loop_progress.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/geometry/exact/expansion.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mending/edges/relative_orientation.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/mesh/face_geometry.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 256;

/// The number of tests of vertices near open edges that is allowed per corner of the surface. On ordinary surfaces
/// there are one or two. If thousands of edges and vertices lie along one line, splitting the edges would take
/// quadratic time and memory.
constexpr std::size_t kMaxLooksPerCorner = 4;
constexpr std::size_t kFewLooks = 4096;

/// This is the same bound for looks at nodes of the tree of vertices. On ordinary surfaces there are some twenty for
/// each open edge, and few open edges. If all edges span the surface, each comes near a large part of the vertices, and
/// finding those on it would take quadratic time.
constexpr std::size_t kMaxNodesPerCorner = 128;
constexpr std::size_t kFewNodes = 1 << 22;

/// The tag of the tree's boxes: the box in full precision. The tolerance is far smaller than single precision can
/// resolve.
struct ExactBox {
  Box3 box;
  void join(const ExactBox& other) { box.add(other.box); }
};
using VertexTree = BoxTree<ExactBox>;

/// A vertex on an open edge. `place` is its position along the edge, and `distance` that from the edge.
struct Junction {
  FaceId face;
  VertexId vertex;
  double distance = 0;
  std::uint32_t half_edge = 0;
  double place = 0;
};

/// The order of vertices along an edge. Two edges that run along each other get the same vertices and must have them in
/// the same order, or they meet twisted, as in a Moebius strip. The directions of such edges differ by noise, so
/// vertices beside each other, as on both sides of a seam, would come in any order. Therefore the direction is tilted a
/// little, the same way for an edge and for one that runs back. The tilt is larger than noise and decides the order of
/// such vertices. Apart from that, the order is exact, however near vertices are to each other.
class Order {
 public:
  explicit Order(const Vec3& way) : is_backwards_(dot(way, kTowards) < 0) {
    const Vec3 tilted = (1 / norm(way)) * way + (is_backwards_ ? -kTilt : kTilt) * kTowards;
    for (int axis = 0; axis < 3; ++axis) direction_[axis] = std::round(tilted[axis] * kSteps) * (kUnit / kSteps);
  }

  /// The approximate place along the edge, in local units times kUnit.
  double place(const Vec3& p) const { return dot(p, direction_); }
  /// Returns whether two places are so far apart that rounding did not decide their order.
  static bool is_clear(double a, double b) { return std::fabs(a - b) > 1e-14 * kUnit; }

  bool is_before(const Surface& surface, VertexId p, VertexId q) const {
    const auto along = [&](int axis) {
      return exact::difference(surface.local[q][axis], surface.local[p][axis]) * direction_[axis];
    };
    const int sign = (along(0) + along(1) + along(2)).sign();
    if (sign != 0) return sign > 0;
    // Local units may not distinguish the two vertices.
    return is_backwards_ ? surface.positions[q] < surface.positions[p] : surface.positions[p] < surface.positions[q];
  }

 private:
  /// The tilt is far more than noise, but so small that it only swaps vertices whose places along the edge differ by at
  /// most this part of the tolerance.
  static constexpr double kTilt = 1.0 / 64;
  /// The components have no simple ratios, so that edges at right angles to this direction are rare.
  static constexpr Vec3 kTowards{1, 0.7548776662466927, 0.5698402909980532};
  /// With these steps and units no product underflows, whatever the coordinates are.
  static constexpr double kSteps = 0x1p30, kUnit = 0x1p900;

  bool is_backwards_;
  Vec3 direction_;
};

/// Returns whether the segment comes within `margin` of the box. Rounding alone never makes it false.
bool is_near(const Vec3& a, const Vec3& b, double margin, const Box3& box) {
  double from = 0, to = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - margin, high = box.max[axis] + margin, way = b[axis] - a[axis];
    if (way == 0) {
      if (a[axis] < low || a[axis] > high) return false;
      continue;
    }
    const double first = (low - a[axis]) / way, second = (high - a[axis]) / way;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
  }
  constexpr double kRounding = 1e-12;
  return from <= to + kRounding;
}

/// Returns whether all of the box is within `distance` of the place. The result is monotone in the box, even with
/// rounding.
bool is_within(const Vec3& place, double distance, const Box3& box) {
  if (std::fabs(box.min.x - place.x) > distance) return false;  // true in nearly all cases
  Vec3 farthest;
  for (int axis = 0; axis < 3; ++axis)
    farthest[axis] = std::max(std::fabs(box.min[axis] - place[axis]), std::fabs(box.max[axis] - place[axis]));
  return norm(farthest) <= distance;
}

struct Found {
  std::vector<Junction> junctions;  ///< by half-edge, in order along it; each vertex at most once per face
  bool is_complete = true;          ///< false if there are more
};

class Search {
 public:
  Search(const Surface& surface, const Adjacency& edges, double tolerance,
         const std::vector<std::uint8_t>& keep_verbatim, RunControl& control)
      : surface_(surface), edges_(edges), tolerance_(tolerance), keep_verbatim_(keep_verbatim), control_(control) {}

  Found run() {
    Found result;
    find_boundary();
    if (open_.empty()) return result;
    const auto entries = VertexTree::make_entries(vertices_.size(), control_, [&](std::size_t i, auto& entry) {
      entry.box.add(surface_.local[vertices_[i]]);
      entry.tag.box.add(surface_.local[vertices_[i]]);
    });
    const VertexTree tree(entries, control_);
    const Looks most{kFewLooks + kMaxLooksPerCorner * surface_.corners.size(),
                     kFewNodes + kMaxNodesPerCorner * surface_.corners.size()};
    std::atomic<std::size_t> vertices{0}, nodes{0};
    const auto are_too_many = [&] {
      return vertices.load(std::memory_order_relaxed) > most.vertices ||
             nodes.load(std::memory_order_relaxed) > most.nodes;
    };
    LoopProgress progress(control_, open_.size());
    const auto found =
        map_blocks<std::vector<Junction>>(open_.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
          std::vector<Junction> junctions;
          for (std::size_t i = begin; i < end && !are_too_many(); ++i) {
            const Looks looks = find_on(open_[i], tree, [&](const Junction& j) { junctions.push_back(j); });
            vertices.fetch_add(looks.vertices, std::memory_order_relaxed);
            nodes.fetch_add(looks.nodes, std::memory_order_relaxed);
          }
          progress.add(end - begin);
          return junctions;
        });
    // The order in which edges are tested does not decide whether the counts exceed the limits.
    result.is_complete = !are_too_many();
    std::vector<Junction>& all = result.junctions;
    if (result.is_complete)
      for (const auto& junctions : found) all.insert(all.end(), junctions.begin(), junctions.end());
    else
      all = find_first(tree, most);
    const auto key = [](const Junction& j) { return std::tuple(j.face, j.vertex, j.distance, j.half_edge); };
    sort_stoppable(all.begin(), all.end(), control_,
                   [&](const Junction& a, const Junction& b) { return key(a) < key(b); });
    drop_own_vertices(all);
    // If a face has several edges near a vertex, only the nearest one gets it.
    all.erase(
        std::unique(all.begin(), all.end(),
                    [](const Junction& a, const Junction& b) { return a.face == b.face && a.vertex == b.vertex; }),
        all.end());
    sort_stoppable(all.begin(), all.end(), control_, [&](const Junction& a, const Junction& b) {
      return a.half_edge != b.half_edge          ? a.half_edge < b.half_edge
             : Order::is_clear(a.place, b.place) ? a.place < b.place
                                                 : Order(way(a.half_edge)).is_before(surface_, a.vertex, b.vertex);
    });
    return result;
  }

 private:
  /// The numbers of vertices and of tree nodes that were tested.
  struct Looks {
    std::size_t vertices = 0, nodes = 0;
  };

  void find_boundary() {
    std::uint32_t looks = 0;
    for (const EdgeId e : edges_.odd_edges()) {
      if (looks++ % 4096 == 0) control_.check_and_move();
      const std::uint32_t h = edges_.half_edges(e)[0];
      if (edges_.half_edges(e).size() > 1 || edges_.from(h) == edges_.to(h)) continue;
      vertices_.insert(vertices_.end(), {edges_.from(h), edges_.to(h)});
      const FaceId f = edges_.face_of(h);
      const bool takes_vertices = keep_verbatim_.empty() || keep_verbatim_[surface_.face_source[f].value] == 0;
      if (takes_vertices && !is_without_area(surface_, f)) open_.push_back(h);
    }
    if (open_.empty()) return;
    sort_unique(vertices_, control_);
  }

  Vec3 way(std::uint32_t h) const { return surface_.local[edges_.to(h)] - surface_.local[edges_.from(h)]; }

  /// Calls visit(junction) for the vertices on an edge, including those of its own face.
  template <class Visit>
  Looks find_on(std::uint32_t h, const VertexTree& tree, const Visit& visit) const {
    const Vec3 a = surface_.local[edges_.from(h)], b = surface_.local[edges_.to(h)];
    const Vec3 ab = way(h);
    const double length = norm(ab);
    if (!(length > 2 * tolerance_)) return {};
    Looks looks;
    const auto bound = [&](const VertexTree::Entry& entry) {
      const Box3& box = entry.tag.box;
      if (++looks.nodes % 4096 == 0) control_.check_and_move();
      const bool is_of_interest =
          is_near(a, b, tolerance_, box) && !is_within(a, tolerance_, box) && !is_within(b, tolerance_, box);
      return is_of_interest ? 0 : HUGE_VAL;
    };
    const Order order(ab);
    const double all = 1;
    tree.search(all, bound, [&](std::size_t slot) {
      ++looks.vertices;
      const VertexId v = vertices_[tree.number(slot)];
      const Vec3 p = surface_.local[v];
      const double along = dot(p - a, ab) / (length * length);
      const double distance = norm(p - (a + along * ab));
      if (!(distance <= tolerance_) || !(norm(p - a) > tolerance_) || !(norm(p - b) > tolerance_)) return;
      if (!(along > 0 && along < 1)) return;
      visit({edges_.face_of(h), v, distance, h, order.place(p)});
    });
    return looks;
  }

  /// The junctions that are found until there are more tests than allowed. They do not depend on which tests the
  /// threads have made before.
  std::vector<Junction> find_first(const VertexTree& tree, const Looks& most) const {
    std::vector<Junction> junctions;
    Looks all;
    LoopProgress progress(control_, most.nodes);
    for (std::size_t i = 0; i < open_.size() && all.vertices <= most.vertices && all.nodes <= most.nodes; ++i) {
      const Looks looks = find_on(open_[i], tree, [&](const Junction& j) { junctions.push_back(j); });
      all.vertices += looks.vertices;
      all.nodes += looks.nodes;
      progress.add(looks.nodes);
    }
    return junctions;
  }

  /// Removes junctions whose vertex is a corner of the edge's face. Input: sorted by face.
  void drop_own_vertices(std::vector<Junction>& junctions) const {
    std::vector<VertexId> corners;
    FaceId last;
    std::size_t looks = 0;
    const auto is_own = [&](const Junction& j) {
      if (++looks % 4096 == 0) control_.check_and_move();
      if (j.face != last) {
        last = j.face;
        const auto loop = surface_.face(j.face);
        corners.assign(loop.begin(), loop.end());
        sort_stoppable(corners.begin(), corners.end(), control_);
      }
      return std::binary_search(corners.begin(), corners.end(), j.vertex);
    };
    junctions.erase(std::remove_if(junctions.begin(), junctions.end(), is_own), junctions.end());
  }

  const Surface& surface_;
  const Adjacency& edges_;
  double tolerance_;
  const std::vector<std::uint8_t>& keep_verbatim_;
  RunControl& control_;
  std::vector<std::uint32_t> open_;  ///< half-edges
  std::vector<VertexId> vertices_;   ///< vertices of the open boundary
};

/// The surface's faces with their open edges split.
struct Split {
  FaceList faces;
  std::vector<std::uint32_t> junction_of;  ///< one per corner; kNone for corners that the face had before

  Split(const Surface& surface, const std::vector<Junction>& junctions, RunControl& control) {
    std::vector<VertexId> loop;
    std::uint32_t next = 0;
    StopCheck check(control);
    for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
      loop.clear();
      for (std::uint32_t h = surface.face_begin[f]; h < surface.face_begin[f + 1]; ++h) {
        check();
        loop.push_back(surface.corners[h]);
        junction_of.push_back(kNone);
        for (; next < junctions.size() && junctions[next].half_edge == h; ++next) {
          loop.push_back(junctions[next].vertex);
          junction_of.push_back(next);
        }
      }
      faces.add_face(loop, surface.face_source[FaceId(f)], surface.label(FaceId(f)));
    }
  }
};

/// Finds two kinds of vertices: those that would join faces so that a two-sided piece becomes one-sided, and those that
/// would make faces turn over because of an edge that is too short to show their orientation.
/// Output: a junction for each new edge that does this; empty in nearly all cases.
std::vector<std::uint32_t> twisting_junctions(const Surface& surface, const Split& split,
                                              const std::vector<Junction>& junctions, double tolerance,
                                              RunControl& control) {
  constexpr double kShort = 4;
  const Adjacency edges(surface.vertex_count(), split.faces.face_begin, split.faces.corners, control);
  const auto of_edge = [&](std::uint32_t h) {
    return std::array{split.junction_of[h], split.junction_of[edges.next(h)]};
  };
  const auto is_new = [&](std::uint32_t h) { return of_edge(h) != std::array{kNone, kNone}; };
  const auto runs_one_way = [&](std::span<const std::uint32_t> around) {
    return edges.from(around[0]) == edges.from(around[1]);
  };
  const auto odd = edges.odd_edges();
  if (std::none_of(odd.begin(), odd.end(), [&](EdgeId e) {
        const auto around = edges.half_edges(e);
        return around.size() == 2 && runs_one_way(around) && (is_new(around[0]) || is_new(around[1]));
      }))
    return {};
  // The edges that were there before come first, then the new ones, the long ones before the short ones.
  RelativeOrientation orientation(split.faces.face_count());
  std::vector<std::pair<double, EdgeId>> new_edges;
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
    if (e % 4096 == 0) control.check_and_move();
    const auto around = edges.half_edges(EdgeId(e));
    if (around.size() != 2) continue;
    const std::uint32_t h = around[0], other = around[1];
    if (is_new(h) || is_new(other))
      new_edges.emplace_back(-norm(surface.local[edges.to(h)] - surface.local[edges.from(h)]), EdgeId(e));
    else
      orientation.join(orientation.of(edges.face_of(h)), orientation.of(edges.face_of(other)), runs_one_way(around));
  }
  sort_stoppable(new_edges.begin(), new_edges.end(), control);
  std::vector<std::uint32_t> twisting;
  std::uint32_t looks = 0;
  for (const auto& [minus_length, e] : new_edges) {
    if (looks++ % 4096 == 0) control.check_and_move();
    const auto around = edges.half_edges(e);
    const RelativeOrientation::Side a = orientation.of(edges.face_of(around[0])),
                                    b = orientation.of(edges.face_of(around[1]));
    const bool is_opposite = runs_one_way(around);
    const bool is_twisted = a.piece == b.piece ? (a.is_turned != b.is_turned) != is_opposite
                                               : is_opposite && -minus_length < kShort * tolerance;
    if (!is_twisted) {
      orientation.join(a, b, is_opposite);
      continue;
    }
    // Among the vertices that made the edge, the one furthest away from its original edge is chosen.
    std::uint32_t worst = kNone;
    for (const std::uint32_t h : around)
      for (const std::uint32_t j : of_edge(h))
        if (j != kNone && (worst == kNone || junctions[worst].distance < junctions[j].distance)) worst = j;
    twisting.push_back(worst);
  }
  sort_unique(twisting, control);
  return twisting;
}

Diagnostic told(const Surface& surface, const std::vector<Junction>& junctions, const char* message) {
  Diagnostic found{DiagnosticCode::kTJunction, 0, {}, message};
  for (const Junction& j : junctions) found.add(surface.vertex_source[j.vertex].value);
  return found;
}

}  // namespace

bool split_t_junctions(Surface& surface, const Adjacency& edges, double tolerance,
                       const std::vector<std::uint8_t>& keep_verbatim, MendMode mend,
                       std::vector<Diagnostic>& diagnostics, RunControl& control) {
  Found found = Search(surface, edges, tolerance, keep_verbatim, control).run();
  std::vector<Junction>& junctions = found.junctions;
  if (!found.is_complete) {
    diagnostics.push_back(told(surface, junctions,
                               "vertices lie on an open edge of a face that does not use them, so many that no edge "
                               "was split; there are more than were counted; `elements` lists the vertices by number"));
    return false;
  }
  if (junctions.empty()) return false;
  const FaceGeometries geometry = face_geometry(surface, control);
  junctions.erase(std::remove_if(junctions.begin(), junctions.end(),
                                 [&](const Junction& j) { return geometry[j.face].height < kThinFace * tolerance; }),
                  junctions.end());
  if (junctions.empty()) return false;
  if (mend == MendMode::kNo) {
    diagnostics.push_back(
        told(surface, junctions,
             "vertices lie on an open edge of a face that does not use them; `elements` lists the vertices by number"));
    return false;
  }
  Split split(surface, junctions, control);
  std::vector<Junction> left;
  // If one vertex is left out, another may become harmless or harmful. If this does not end, no vertex is inserted.
  constexpr int kMaxPasses = 16;
  for (int pass = 0;; ++pass) {
    const auto twisting = twisting_junctions(surface, split, junctions, tolerance, control);
    if (twisting.empty()) break;
    if (pass == kMaxPasses) {
      left.insert(left.end(), junctions.begin(), junctions.end());
      junctions.clear();
      break;
    }
    std::vector<Junction> rest;
    auto next = twisting.begin();
    for (std::uint32_t j = 0; j < junctions.size(); ++j) {
      const bool is_twisting = next != twisting.end() && *next == j;
      (is_twisting ? left : rest).push_back(junctions[j]);
      next += is_twisting;
    }
    junctions = std::move(rest);
    split = Split(surface, junctions, control);
  }
  if (!left.empty())
    diagnostics.push_back(told(surface, left,
                               "vertices lie on an open edge of a face that does not use them; the edge was not split "
                               "there, because that would twist the surface; `elements` lists the vertices by number"));
  if (junctions.empty()) return false;
  diagnostics.push_back(told(surface, junctions,
                             "vertices lie on an open edge of a face that does not use them; the edge was split there; "
                             "`elements` lists the vertices by number"));
  surface.take_faces(std::move(split.faces));
  return true;
}

}  // namespace remesh
