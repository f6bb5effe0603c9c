#include "core/geometry/inside_out.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/predicates.h"
#include "core/geometry/predicates_3d.h"
#include "core/geometry/triangle_tree.h"

namespace remesh {
namespace {

/// A volume counts as negative from here, of the piece's area times its extent: a doubled sheet has none but rounding.
constexpr double kNoVolume = 1e-12;

/// Triangles that all rays together may look at where they go on to the end.
constexpr std::size_t kMostTests = 10'000'000;

/// Between two points of cancellation.
constexpr std::size_t kTestsBetweenChecks = 4096;

class Pieces {
 public:
  Pieces(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin, std::span<const VertexId> corners,
         const Adjacency& edges, RunControl& control)
      : positions_(positions), face_begin_(face_begin), corners_(corners), edges_(edges), control_(control) {}

  InsideOut find() {
    connect();
    InsideOut result;
    std::vector<std::uint32_t> negative;
    add_volumes();
    for (std::uint32_t p = 0; p < pieces_.size(); ++p)
      if (pieces_[p].is_closed && pieces_[p].volume < 0) negative.push_back(p);
    if (negative.empty()) return result;
    measure([](const Piece& piece) { return piece.is_closed && piece.volume < 0; });
    negative.erase(
        std::remove_if(negative.begin(), negative.end(), [&](std::uint32_t p) { return is_flat(pieces_[p]); }),
        negative.end());
    const auto closed = std::count_if(pieces_.begin(), pieces_.end(), [](const Piece& p) { return p.is_closed; });
    if (closed > 1 && !negative.empty()) drop_cavities(negative);
    if (negative.empty()) return result;
    for (const std::uint32_t p : negative) result.first_faces.push_back(pieces_[p].first);
    result.is_inside_out.resize(face_count());
    for_blocks(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        result.is_inside_out[f] = std::binary_search(negative.begin(), negative.end(), piece_of_[f]);
    });
    return result;
  }

 private:
  struct Piece {
    FaceId first;
    bool is_closed = true;
    double volume = 0, area = 0;
    Box3 box;
    Vec3 least{HUGE_VAL, HUGE_VAL, HUGE_VAL};  ///< lexicographically
  };

  std::size_t face_count() const { return face_begin_.size() - 1; }
  std::span<const VertexId> face(std::size_t f) const {
    return corners_.subspan(face_begin_[f], face_begin_[f + 1] - face_begin_[f]);
  }

  void connect() {
    UnionFind sets(face_count());
    for_blocks(edges_.edge_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) {
        const auto around = edges_.half_edges(EdgeId(e));
        if (around.size() == 2) sets.join(edges_.face_of(around[0]).value, edges_.face_of(around[1]).value);
      }
    });
    for_blocks(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) sets.flatten(static_cast<std::uint32_t>(f));
    });
    const auto firsts = select_ids<FaceId>(face_count(), kItemsPerBlock, control_, [&](std::size_t f) {
      return sets.root_of(static_cast<std::uint32_t>(f)) == f;
    });
    piece_of_.resize(face_count());
    pieces_.resize(firsts.size());
    StopCheck check(control_);
    for (std::size_t p = 0; p < firsts.size(); ++p) {
      check();
      pieces_[p].first = firsts[p];
      piece_of_[firsts[p].value] = static_cast<std::uint32_t>(p);
    }
    for_blocks(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f)
        if (const std::uint32_t first = sets.root_of(f); first != f) piece_of_[f] = piece_of_[first];
    });
    for (const EdgeId e : edges_.odd_edges())
      for (const std::uint32_t h : edges_.half_edges(e)) {
        check();
        if (edges_.from(h) != edges_.to(h)) pieces_[piece_of_[edges_.face_of(h).value]].is_closed = false;
      }
  }

  Vec3 twice_area_of(std::span<const VertexId> loop) const {
    const Vec3 first = positions_[loop[0].value];
    Vec3 sum;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      sum += cross(positions_[loop[i].value] - first, positions_[loop[i + 1].value] - first);
    return sum;
  }

  void add_volumes() {
    // Each block sums what follows each other in one piece.
    using Sums = std::vector<std::pair<std::uint32_t, double>>;
    for (const Sums& sums :
         map_blocks<Sums>(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
           Sums of_block;
           for (std::size_t f = begin; f < end; ++f) {
             if (!pieces_[piece_of_[f]].is_closed) continue;
             if (of_block.empty() || of_block.back().first != piece_of_[f]) of_block.push_back({piece_of_[f], 0});
             of_block.back().second += volume_under(f);
           }
           return of_block;
         }))
      for (const auto& [piece, volume] : sums) pieces_[piece].volume += volume;
  }

  /// Of the tetrahedra between a face and a point of its piece: from afar it would drown in rounding.
  double volume_under(std::size_t f) const {
    const Vec3 from = positions_[face(pieces_[piece_of_[f]].first.value)[0].value];
    return dot(positions_[face(f)[0].value] - from, twice_area_of(face(f))) / 6;
  }

  static bool is_flat(const Piece& piece) {
    return std::fabs(piece.volume) <= kNoVolume * piece.area * piece.box.diagonal();
  }

  /// What is asked of few pieces only.
  template <class IsAsked>
  void measure(const IsAsked& is_asked) {
    for (std::uint32_t f = 0; f < face_count(); ++f) {
      if (f % kTestsBetweenChecks == 0) control_.check();
      Piece& piece = pieces_[piece_of_[f]];
      if (!is_asked(piece)) continue;
      piece.area += norm(twice_area_of(face(f))) / 2;
      for (const VertexId v : face(f)) {
        piece.box.add(positions_[v.value]);
        piece.least = std::min(piece.least, positions_[v.value]);
      }
    }
  }

  /// Leaves those that lie within an even number of closed pieces.
  void drop_cavities(std::vector<std::uint32_t>& negative) {
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> piece_of;
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < face_count(); ++f) {
      check();
      if (!pieces_[piece_of_[f]].is_closed) continue;
      const auto loop = face(f);
      for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        triangles.push_back({loop[0], loop[i], loop[i + 1]});
        piece_of.push_back(piece_of_[f]);
      }
    }
    const Triangles all{TriangleTree(positions_, triangles, control_), triangles, piece_of};
    std::size_t tests = 0;
    std::vector<std::uint8_t> is_in_odd;
    const auto is_cavity = [&](std::uint32_t piece) {
      if (tests < kMostTests) {
        const bool is_within = is_in_odd_number(piece, all, tests);
        if (tests < kMostTests) return is_within;
      }
      // Very many lie in one line.
      if (is_in_odd.empty()) is_in_odd = nearest_first(all);
      return is_in_odd[piece] != 0;
    };
    negative.erase(std::remove_if(negative.begin(), negative.end(), is_cavity), negative.end());
  }

  /// Those of the closed pieces.
  struct Triangles {
    TriangleTree tree;
    std::span<const Triangle> corners;
    std::span<const std::uint32_t> piece;
  };

  /// Does a piece lie within an odd number of others? By all that lies on one side of it; stops at kMostTests.
  bool is_in_odd_number(std::uint32_t piece, const Triangles& all, std::size_t& tests) const {
    const Vec3 p = pieces_[piece].least;
    std::vector<std::pair<std::uint32_t, int>> hits;
    all.tree.visit_meeting({p, Vec3{HUGE_VAL, p.y, p.z}}, 0, [&](std::size_t slot) {
      if (tests % kTestsBetweenChecks == 0) control_.check();
      const std::uint32_t t = all.tree.face(slot).value;
      if (all.piece[t] != piece)
        if (const auto [turns, is_beyond] = crossing(all.corners[t], p); turns != 0 && is_beyond)
          hits.push_back({all.piece[t], turns});
      return ++tests < kMostTests;
    });
    sort_stoppable(hits.begin(), hits.end(), control_);
    std::size_t depth = 0;
    for (std::size_t i = 0; i < hits.size();) {
      const std::uint32_t other = hits[i].first;
      int turns = 0;
      for (; i < hits.size() && hits[i].first == other; ++i) turns += hits[i].second;
      depth += turns != 0;
    }
    return depth % 2 == 1;
  }

  /// The same for all pieces, by the nearest other one in the direction of -x from each: it lies in that one, or in all
  /// that this one lies in. That one's own smallest vertex comes first.
  std::vector<std::uint8_t> nearest_first(const Triangles& all) {
    measure([](const Piece& piece) { return piece.is_closed && piece.volume >= 0; });
    std::vector<std::uint32_t> order(pieces_.size()), rank(pieces_.size());
    std::iota(order.begin(), order.end(), 0u);
    // Of two pieces at one vertex the outer one comes first.
    sort_stoppable(order.begin(), order.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(pieces_[a].least, -std::fabs(pieces_[a].volume), a) <
             std::tuple(pieces_[b].least, -std::fabs(pieces_[b].volume), b);
    });
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    double end = HUGE_VAL;
    for (const Piece& piece : pieces_) end = std::min(end, piece.least.x);
    std::vector<std::uint8_t> is_in_odd(pieces_.size(), 0);
    std::size_t tests = 0;
    StopCheck check(control_);
    for (const std::uint32_t piece : order) {
      check();
      if (!pieces_[piece].is_closed) continue;
      const Vec3 p = pieces_[piece].least;
      std::uint32_t nearest = Id<FaceTag>::kInvalid;
      double greatest_x = -HUGE_VAL;
      bool is_within = false;
      // In ever larger steps: what is far is looked at only where nothing is near.
      double reach = pieces_[piece].box.diagonal() / static_cast<double>(all.corners.size());
      for (bool is_last = false; !is_last && nearest == Id<FaceTag>::kInvalid; reach *= 4) {
        is_last = !(p.x - reach > end) || !(reach > 0);
        all.tree.visit_meeting({Vec3{is_last ? end : p.x - reach, p.y, p.z}, p}, 0, [&](std::size_t slot) {
          if (++tests % kTestsBetweenChecks == 0) control_.check();
          const std::uint32_t t = all.tree.face(slot).value, other = all.piece[t];
          if (rank[other] >= rank[piece] || is_flat(pieces_[other])) return true;
          const auto [turns, is_beyond] = crossing(all.corners[t], p);
          if (turns == 0 || is_beyond) return true;
          const double x = where_passed(all.corners[t], p);
          if (!is_last && x < p.x - reach) return true;  // there may be a nearer one outside the box
          if (nearest == Id<FaceTag>::kInvalid || x > greatest_x) {
            nearest = other;
            greatest_x = x;
            is_within = (turns < 0) == (pieces_[other].volume > 0);
          }
          return true;
        });
      }
      if (nearest != Id<FaceTag>::kInvalid) is_in_odd[piece] = (is_in_odd[nearest] != 0) != is_within;
    }
    return is_in_odd;
  }

  /// The place along x where the line through p along x passes a triangle's plane, as far as rounding tells.
  double where_passed(const Triangle& triangle, const Vec3& p) const {
    const Vec3 &a = positions_[triangle[0].value], &b = positions_[triangle[1].value],
               &c = positions_[triangle[2].value];
    const Vec3 normal = cross(b - a, c - a);
    const double x = a.x - (normal.y * (p.y - a.y) + normal.z * (p.z - a.z)) / normal.x;
    const auto [low, high] = std::minmax({a.x, b.x, c.x});
    return std::clamp(x, low, std::max(low, std::min(high, p.x)));
  }

  struct Crossing {
    int turns = 0;           ///< 1 in the direction of the triangle's normal, -1 against it, 0 not
    bool is_beyond = false;  ///< on the way from p along x; else against it
  };
  /// How the line through p along x passes a triangle in the direction of x. As if p were moved by an infinitesimal, so
  /// that a line through an edge passes just one of the faces there.
  Crossing crossing(const Triangle& triangle, const Vec3& p) const {
    int turns = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &from = positions_[triangle[i].value], &to = positions_[triangle[(i + 1) % 3].value];
      const bool is_up = from.z <= p.z && p.z < to.z, is_down = to.z <= p.z && p.z < from.z;
      if (!is_up && !is_down) continue;
      const int side = orient2d({from.y, from.z}, {to.y, to.z}, {p.y, p.z});
      if (is_up && side > 0) ++turns;
      if (is_down && side < 0) --turns;
    }
    if (turns == 0) return {};
    const int side =
        orient3d(positions_[triangle[0].value], positions_[triangle[1].value], positions_[triangle[2].value], p);
    return {turns, side * turns < 0};
  }

  std::span<const Vec3> positions_;
  std::span<const std::uint32_t> face_begin_;
  std::span<const VertexId> corners_;
  const Adjacency& edges_;
  RunControl& control_;
  std::vector<Piece> pieces_;                                      ///< in the order of their first faces
  std::vector<std::uint32_t, LeftUnset<std::uint32_t>> piece_of_;  ///< of each face
};

}  // namespace

InsideOut find_inside_out(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                          std::span<const VertexId> corners, const Adjacency& edges, RunControl& control) {
  if (face_begin.size() < 2) return {};
  return Pieces(positions, face_begin, corners, edges, control).find();
}

}  // namespace remesh
