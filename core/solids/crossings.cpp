#include "core/solids/crossings.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/exact/twofold.h"

namespace remesh {
namespace {

using exact::Bounded;
using exact::Bounded3;
using exact::Twofold;

constexpr std::size_t kCrossingsPerBlock = 512;

/// Curves in one face are held against each other at most so many times for each pair of faces, and always so often.
constexpr std::size_t kTestsPerPair = 256, kTestsAlways = 1 << 22;

/// The point in which an edge passes through a face.
struct Pierced {
  EdgeId edge;
  FaceId face;
  friend auto operator<=>(const Pierced&, const Pierced&) = default;
};

/// An end of a curve: where an edge passes through a face, or a common corner of both faces.
struct CurveEnd {
  Pierced pierced;
  VertexId vertex;  ///< known once points have numbers
};

/// The curve of two faces.
struct Curve {
  FaceId f, g;
  std::array<CurveEnd, 2> ends;

  FaceId other(FaceId face) const { return face == f ? g : f; }
};

Bounded times(const Bounded& a, const Bounded& b) { return a * b; }

class CrossingSearch {
 public:
  CrossingSearch(Soup& soup, const SoupEdges& edges, RunControl& control)
      : soup_(soup), edges_(edges), control_(control) {}

  Crossings run(const std::vector<std::pair<FaceId, FaceId>>& pairs) {
    find_curves(pairs);
    number_points();
    result_.curves = curves_.size();
    find_triple_points(kTestsPerPair * pairs.size() + kTestsAlways);
    add_pieces();
    return std::move(result_);
  }

 private:
  const Vec3& at(VertexId v) const { return soup_.positions[v.value]; }
  const Triangle& corners(FaceId f) const { return soup_.faces[f.value]; }

  int side(FaceId f, const Vec3& p) const {
    const Triangle& t = corners(f);
    return orient3d(at(t[0]), at(t[1]), at(t[2]), p);
  }

  /// Returns whether an edge passes through the inside of a face from one side to the other.
  bool does_pierce(EdgeId e, FaceId f) const {
    const auto [a, b] = edges_.ends(e);
    const Triangle& t = corners(f);
    for (const VertexId v : t)
      if (v == a || v == b) return false;
    if (side(f, at(a)) * side(f, at(b)) >= 0) return false;
    const int first = orient3d(at(a), at(b), at(t[0]), at(t[1]));
    return first != 0 && orient3d(at(a), at(b), at(t[1]), at(t[2])) == first &&
           orient3d(at(a), at(b), at(t[2]), at(t[0])) == first;
  }

  void find_curves(const std::vector<std::pair<FaceId, FaceId>>& pairs) {
    struct Found {
      std::vector<Pierced> pierced;
      std::vector<Curve> curves;
    };
    const auto blocks =
        map_blocks<Found>(pairs.size(), kCrossingsPerBlock, control_, [&](std::size_t i, std::size_t end) {
          Found found;
          for (; i < end; ++i) {
            const auto [f, g] = pairs[i];
            Curve curve{f, g, {}};
            std::size_t count = 0;
            const auto add = [&](const CurveEnd& at_end) {
              if (count < 2) curve.ends[count] = at_end;
              ++count;
            };
            for (const VertexId v : corners(f))
              for (const VertexId w : corners(g))
                if (v == w) add({{}, v});
            if (count > 1) continue;
            for (std::size_t k = 0; k < 3; ++k) {
              if (does_pierce(edges_.of(f, k), g)) add({{edges_.of(f, k), g}, {}});
              if (does_pierce(edges_.of(g, k), f)) add({{edges_.of(g, k), f}, {}});
            }
            for (std::size_t k = 0; k < std::min<std::size_t>(count, 2); ++k)
              if (!curve.ends[k].vertex.is_valid()) found.pierced.push_back(curve.ends[k].pierced);
            if (count == 2) found.curves.push_back(curve);
          }
          return found;
        });
    for (const Found& found : blocks) {
      pierced_.insert(pierced_.end(), found.pierced.begin(), found.pierced.end());
      curves_.insert(curves_.end(), found.curves.begin(), found.curves.end());
    }
    sort_stoppable(pierced_.begin(), pierced_.end(), control_);
    pierced_.erase(std::unique(pierced_.begin(), pierced_.end()), pierced_.end());
  }

  /// A plane's normal and its first corner.
  struct TwofoldPlane {
    Vec3 corner;
    Bounded3 normal;
  };
  TwofoldPlane plane(FaceId f) const {
    const Triangle& t = corners(f);
    return {at(t[0]), exact::cross(exact::difference(at(t[1]), at(t[0])), exact::difference(at(t[2]), at(t[0])))};
  }

  /// The place of a pierced point on its edge is numerator / denominator from the smaller end on.
  struct Place {
    Bounded numerator, denominator;
  };
  Place place_of(const Pierced& p) const {
    const auto [a, b] = edges_.ends(p.edge);
    const TwofoldPlane through = plane(p.face);
    return {exact::dot(through.normal, exact::difference(through.corner, at(a))),
            exact::dot(through.normal, exact::difference(at(b), at(a)))};
  }

  Vec3 rounded(const Pierced& p) const {
    const auto [a, b] = edges_.ends(p.edge);
    const Place place = place_of(p);
    const Twofold share = exact::quotient(place.numerator.number, place.denominator.number);
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const Twofold way = exact::product(share, exact::two_sum(at(b)[axis], -at(a)[axis]));
      point[axis] = exact::sum({at(a)[axis], 0}, way).value;
    }
    return point;
  }

  /// On which side of a face's plane a curve's end lies; 0 if it cannot be told from lying in the plane.
  int side_of_end(FaceId face, const CurveEnd& end) const {
    if (!end.pierced.edge.is_valid()) return side(face, at(end.vertex));
    const auto [a, b] = edges_.ends(end.pierced.edge);
    const TwofoldPlane of = plane(face);
    const Place place = place_of(end.pierced);
    const Bounded from_a = exact::dot(of.normal, exact::difference(at(a), of.corner));
    const Bounded along = exact::dot(of.normal, exact::difference(at(b), at(a)));
    const int sign = (times(from_a, place.denominator) + times(along, place.numerator)).sign();
    return sign * place.denominator.sign();
  }

  /// Rounds a point in which three faces meet.
  Vec3 rounded(FaceId f, FaceId g, FaceId h) const {
    const TwofoldPlane p = plane(f), q = plane(g), r = plane(h);
    const Bounded3 qr = exact::cross(q.normal, r.normal), rp = exact::cross(r.normal, p.normal),
                   pq = exact::cross(p.normal, q.normal);
    const Bounded determinant = exact::dot(p.normal, qr);
    const Vec3& origin = p.corner;
    const Bounded of_q = exact::dot(q.normal, exact::difference(q.corner, origin)),
                  of_r = exact::dot(r.normal, exact::difference(r.corner, origin));
    Vec3 point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Bounded way = of_q * rp[axis] + of_r * pq[axis];
      const double start = origin[static_cast<int>(axis)];
      point[static_cast<int>(axis)] = exact::sum({start, 0}, exact::quotient(way.number, determinant.number)).value;
    }
    return point;
  }

  /// Gives numbers to points, in their order. A point with the coordinates of a vertex is this vertex.
  std::vector<VertexId> numbers_of(std::span<const Vec3> places) {
    const std::vector<Vec3>& positions = soup_.positions;
    std::vector<std::uint32_t> by_place(positions.size());
    std::iota(by_place.begin(), by_place.end(), 0U);
    sort_stoppable(by_place.begin(), by_place.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(positions[a], a) < std::pair(positions[b], b);
    });
    const auto known = [&](const Vec3& p) {
      const auto at_place = std::lower_bound(by_place.begin(), by_place.end(), p,
                                             [&](std::uint32_t v, const Vec3& q) { return positions[v] < q; });
      return at_place != by_place.end() && positions[*at_place] == p ? VertexId(*at_place) : VertexId();
    };
    std::vector<std::uint32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0U);
    sort_stoppable(order.begin(), order.end(), control_,
                   [&](std::uint32_t a, std::uint32_t b) { return std::pair(places[a], a) < std::pair(places[b], b); });
    std::vector<VertexId> numbers(places.size());
    std::vector<Vec3> made;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Vec3& p = places[order[i]];
      VertexId number = i > 0 && places[order[i - 1]] == p ? numbers[order[i - 1]] : known(p);
      if (!number.is_valid()) {
        number = VertexId(positions.size() + made.size());
        made.push_back(p);
      }
      numbers[order[i]] = number;
    }
    soup_.positions.insert(soup_.positions.end(), made.begin(), made.end());
    return numbers;
  }

  void number_points() {
    std::vector<Vec3> places(pierced_.size());
    for_blocks(places.size(), kCrossingsPerBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) places[i] = rounded(pierced_[i]);
    });
    const std::vector<VertexId> numbers = numbers_of(places);
    for (std::size_t i = 0; i < pierced_.size(); ++i) {
      result_.plan.on_edges.push_back({pierced_[i].edge, numbers[i]});
      result_.plan.in_faces.push_back({pierced_[i].face, numbers[i]});
    }
    for (Curve& curve : curves_)
      for (CurveEnd& end : curve.ends)
        if (!end.vertex.is_valid())
          end.vertex = numbers[static_cast<std::size_t>(
              std::lower_bound(pierced_.begin(), pierced_.end(), end.pierced) - pierced_.begin())];
  }

  bool do_cross(const Curve& c, FaceId g, const Curve& d, FaceId h) const {
    return side_of_end(h, c.ends[0]) * side_of_end(h, c.ends[1]) < 0 &&
           side_of_end(g, d.ends[0]) * side_of_end(g, d.ends[1]) < 0;
  }

  Box3 box_of(const Curve& curve) const {
    Box3 box;
    for (const CurveEnd& end : curve.ends) box.add(at(end.vertex));
    return box;
  }

  /// Finds the points in which three faces meet: where two curves cross in the smallest of the faces.
  void find_triple_points(std::size_t max_tests) {
    inner_.resize(curves_.size());
    std::vector<std::pair<FaceId, std::uint32_t>> of_face;
    for (std::uint32_t c = 0; c < curves_.size(); ++c) {
      of_face.push_back({curves_[c].f, c});
      of_face.push_back({curves_[c].g, c});
    }
    sort_stoppable(of_face.begin(), of_face.end(), control_);
    struct Triple {
      FaceId f, g, h;
      std::uint32_t c, d;
    };
    std::vector<Triple> triples;
    std::size_t tests = 0;
    StopCheck check(control_);
    for (std::size_t begin = 0, end = 0; begin < of_face.size(); begin = end) {
      const FaceId f = of_face[begin].first;
      // Only curves with larger faces count here.
      std::vector<std::pair<Box3, std::uint32_t>> mine;
      for (; end < of_face.size() && of_face[end].first == f; ++end) {
        const Curve& curve = curves_[of_face[end].second];
        if (curve.f == f) mine.push_back({box_of(curve), of_face[end].second});
      }
      // They are swept along the axis on which the face is longest.
      Box3 box;
      for (const VertexId v : corners(f)) box.add(at(v));
      const Vec3 extent = box.max - box.min;
      int axis = 0;
      for (int other = 1; other < 3; ++other)
        if (extent[other] > extent[axis]) axis = other;
      std::sort(mine.begin(), mine.end(), [&](const auto& a, const auto& b) {
        return std::pair(a.first.min[axis], a.second) < std::pair(b.first.min[axis], b.second);
      });
      for (std::size_t i = 0; i < mine.size(); ++i)
        for (std::size_t j = i + 1; j < mine.size() && mine[j].first.min[axis] <= mine[i].first.max[axis]; ++j) {
          check();
          if (++tests > max_tests) {
            result_.is_too_much = true;
            return;
          }
          if (!do_meet(mine[i].first, mine[j].first)) continue;
          const auto [low, high] = std::minmax(mine[i].second, mine[j].second);
          const Curve &c = curves_[low], &d = curves_[high];
          if (do_cross(c, c.g, d, d.g)) triples.push_back({f, c.g, d.g, low, high});
        }
    }
    std::vector<Vec3> places(triples.size());
    for_blocks(places.size(), kCrossingsPerBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) places[i] = rounded(triples[i].f, triples[i].g, triples[i].h);
    });
    const std::vector<VertexId> numbers = numbers_of(places);
    for (std::size_t i = 0; i < triples.size(); ++i) {
      const Triple& triple = triples[i];
      inner_[triple.c].push_back(numbers[i]);
      inner_[triple.d].push_back(numbers[i]);
      const auto [g, h] = std::minmax(triple.g, triple.h);
      const auto third =
          std::lower_bound(curves_.begin(), curves_.end(), std::pair(g, h),
                           [](const Curve& c, const auto& faces) { return std::pair(c.f, c.g) < faces; });
      if (third != curves_.end() && third->f == g && third->g == h)
        inner_[static_cast<std::size_t>(third - curves_.begin())].push_back(numbers[i]);
    }
  }

  static bool do_meet(const Box3& a, const Box3& b) {
    for (int axis = 0; axis < 3; ++axis)
      if (a.min[axis] > b.max[axis] || b.min[axis] > a.max[axis]) return false;
    return true;
  }

  /// Adds the pieces of curves between their points.
  void add_pieces() {
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const Curve& curve = curves_[c];
      const VertexId first = curve.ends[0].vertex, last = curve.ends[1].vertex;
      const Vec3 way = at(last) - at(first);
      std::vector<std::pair<double, VertexId>> points;
      for (const VertexId v : inner_[c]) points.push_back({dot(at(v) - at(first), way), v});
      std::sort(points.begin(), points.end());
      VertexId from = first;
      const auto add = [&](VertexId to) {
        if (from == to) return;
        const auto [low, high] = std::minmax(from, to);
        for (const FaceId f : {curve.f, curve.g}) result_.plan.constraints.push_back({f, low, high});
        from = to;
      };
      for (const auto& [place, v] : points) add(v);
      add(last);
    }
  }

  Soup& soup_;
  const SoupEdges& edges_;
  RunControl& control_;
  Crossings result_;
  std::vector<Pierced> pierced_;              ///< ascending
  std::vector<Curve> curves_;                 ///< ascending by their faces
  std::vector<std::vector<VertexId>> inner_;  ///< by curve: where it meets others
};

}  // namespace

Crossings find_crossings(Soup& soup, const SoupEdges& edges, const std::vector<std::pair<FaceId, FaceId>>& pairs,
                         RunControl& control) {
  return CrossingSearch(soup, edges, control).run(pairs);
}

}  // namespace remesh
