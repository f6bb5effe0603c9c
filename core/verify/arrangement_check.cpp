#include "core/verify/arrangement_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/largest_coordinate.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/shells/winding_number.h"
#include "core/geometry/triangles/distances.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh {
namespace {

using VertexPair = std::pair<VertexId, VertexId>;

/// Points on edges may be so many distances of contacts off these: joins take up to three distances, and are repeated
/// with smaller ones.
constexpr double kReachOfJoins = 8;
/// Triangles are thin if they are no higher than so many reaches.
constexpr double kThinReaches = 4;
/// A rounding of measures of coordinates that are at most 1.
constexpr double kRoundingOfProof = 0x1p-48;

constexpr std::size_t kTrianglesPerTest = 1 << 10;

/// Coordinates scaled by a power of two, so that the largest one is at most 1.
class Scale {
 public:
  Scale(std::span<const Vec3> before, std::span<const Vec3> after, RunControl& control) {
    const double largest = std::max(largest_coordinate(before, control), largest_coordinate(after, control));
    exponent_ = largest > 0 ? -1 - std::ilogb(largest) : 0;
  }
  Vec3 operator()(const Vec3& p) const { return {(*this)(p.x), (*this)(p.y), (*this)(p.z)}; }
  double operator()(double x) const { return std::ldexp(x, exponent_); }
  double back(double x) const { return std::ldexp(x, -exponent_); }
  std::vector<Vec3> all(std::span<const Vec3> places, RunControl& control) const {
    std::vector<Vec3> scaled(places.size());
    for_blocks(places.size(), kItemsPerBlock, control, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) scaled[i] = (*this)(places[i]);
    });
    return scaled;
  }

 private:
  int exponent_ = 0;
};

Vec3 twice_area_of(const Corners3& t) { return cross(t[1] - t[0], t[2] - t[0]); }

double longest_side_of(const Corners3& t) {
  return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
}

/// Returns the smallest height.
double height_of(const Corners3& t) {
  const double longest = longest_side_of(t);
  return longest > 0 ? norm(twice_area_of(t)) / longest : 0;
}

Corners3 corners_of(const Triangle& t, std::span<const Vec3> places) {
  return {places[t[0].value], places[t[1].value], places[t[2].value]};
}

class ArrangementTest {
 public:
  ArrangementTest(const ArrangementClaim& claim, RunControl& control)
      : claim_(claim),
        after_(claim.after),
        control_(control),
        scale_(claim.positions_before, claim.after.positions, control),
        reach_(kReachOfJoins * scale_(claim.distance) + kRoundingOfProof) {}

  ArrangementProof run() {
    if (!is_well_formed()) return fails("it is not well formed");
    before_ = scale_.all(claim_.positions_before, control_);
    places_ = scale_.all(after_.positions, control_);
    for (const Vec3& p : after_.flap_positions) places_.push_back(scale_(p));
    if (!are_kept_vertices_in_place()) return fails("a vertex that stays has moved");
    if (!are_flaps_thin()) return fails("a face was dropped that is not a flap");
    group_pieces();
    if (const char* fault = find_fault_of_pieces()) return fails(fault);
    if (!do_faces_meet_as_told()) return fails("faces meet that should not");
    const double lost = distance_of_incomplete();
    if (!(lost <= kReachOfJoins * claim_.distance)) return fails("what is left of a triangle is too far from it");
    return {std::max(scale_.back(distance_ + kRoundingOfProof), lost), {}};
  }

 private:
  static ArrangementProof fails(const char* why) { return {{}, why}; }

  /// Bounds how far the points of triangles are from the faces that stay, if pieces of these triangles are missing.
  double distance_of_incomplete() const {
    std::vector<Triangle> incomplete;
    StopCheck check(control_);
    for (std::size_t f = 0; f < is_incomplete_.size(); ++f) {
      check();
      if (is_incomplete_[f] != 0) incomplete.push_back(claim_.faces_before[f]);
    }
    if (incomplete.empty()) return 0;
    if (after_.faces.empty()) return HUGE_VAL;
    return verification::distance_from({claim_.positions_before, incomplete}, {after_.positions, after_.faces}, {},
                                       control_)
        .bound;
  }

  bool is_well_formed() const {
    const std::size_t before = claim_.faces_before.size();
    if (after_.cover_begin.size() != after_.faces.size() + 1 || after_.cover_begin.back() != after_.covers.size() ||
        after_.vertex.size() != after_.positions.size())
      return false;
    const auto are_below = [](const Triangle& t, std::size_t end) {
      return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] &&
             std::all_of(t.begin(), t.end(), [&](VertexId v) { return v.value < end; });
    };
    const auto are_covers_right = [&](std::span<const Cover> covers) {
      return !covers.empty() &&
             std::all_of(covers.begin(), covers.end(), [&](const Cover& c) { return c.face.value < before; });
    };
    StopCheck check(control_);
    for (std::size_t f = 0; f < after_.faces.size(); ++f) {
      check();
      if (after_.cover_begin[f] > after_.cover_begin[f + 1] || after_.cover_begin[f + 1] > after_.covers.size() ||
          !are_below(after_.faces[f], after_.positions.size()) || !are_covers_right(after_.covers_of(f)))
        return false;
    }
    const std::size_t all = after_.positions.size() + after_.flap_positions.size();
    for (const Flap& flap : after_.flaps)
      if (!are_below(flap.corners, all) || !are_covers_right(flap.covers)) return false;
    const auto is_old = [&](VertexId v) { return !v.is_valid() || v.value < claim_.positions_before.size(); };
    const auto are_finite = [](std::span<const Vec3> places) {
      return std::all_of(places.begin(), places.end(), [](const Vec3& p) { return is_finite(p); });
    };
    return std::all_of(after_.vertex.begin(), after_.vertex.end(), is_old) && are_finite(after_.positions) &&
           are_finite(after_.flap_positions) && std::isfinite(after_.moved) && std::isfinite(claim_.distance);
  }

  bool are_kept_vertices_in_place() const {
    std::vector<std::uint8_t> is_there(claim_.positions_before.size(), 0);
    StopCheck check(control_);
    for (std::size_t v = 0; v < after_.vertex.size(); ++v) {
      check();
      const VertexId old = after_.vertex[v];
      if (!old.is_valid()) continue;
      if (!(claim_.positions_before[old.value] == after_.positions[v])) return false;
      if (std::exchange(is_there[old.value], 1) != 0) return false;
    }
    return true;
  }

  bool are_flaps_thin() const {
    return std::all_of(after_.flaps.begin(), after_.flaps.end(), [&](const Flap& flap) {
      const auto reversed =
          std::count_if(flap.covers.begin(), flap.covers.end(), [](const Cover& cover) { return cover.is_reversed; });
      return 2 * static_cast<std::size_t>(reversed) == flap.covers.size() &&
             height_of(corners_of(flap.corners, places_)) <= reach_;
    });
  }

  /// A piece of a triangle before, with corners in the order of that triangle.
  struct Piece {
    FaceId of;
    Triangle corners;
    bool may_be_turned;  ///< it belongs to a face that is told to intersect another one
    bool is_there;       ///< false: it was dropped as a flap
  };

  void group_pieces() {
    std::vector<std::uint8_t> is_left(after_.faces.size(), 0);
    for (const auto& [f, g] : after_.left)
      for (const FaceId face : {f, g})
        if (face.value < is_left.size()) is_left[face.value] = 1;
    StopCheck check(control_);
    const auto add = [&](const Triangle& t, const Cover& cover, bool may_be_turned, bool is_there) {
      pieces_.push_back({cover.face, cover.is_reversed ? Triangle{t[0], t[2], t[1]} : t, may_be_turned, is_there});
    };
    control_.memory().ask_for<Piece>(after_.covers.size());
    for (std::size_t f = 0; f < after_.faces.size(); ++f) {
      check();
      for (const Cover& cover : after_.covers_of(f)) add(after_.faces[f], cover, is_left[f] != 0, true);
    }
    for (const Flap& flap : after_.flaps)
      for (const Cover& cover : flap.covers) add(flap.corners, cover, false, false);
    of_face_ = group_by(
        pieces_.size(), claim_.faces_before.size(), [&](std::uint32_t i) { return pieces_[i].of.value; }, control_);
  }

  /// The state of a test of some triangles.
  struct Tested {
    double distance = 0;
    const char* fault = nullptr;
  };

  const char* find_fault_of_pieces() {
    is_incomplete_.assign(claim_.faces_before.size(), 0);
    const auto blocks = map_blocks<Tested>(claim_.faces_before.size(), kTrianglesPerTest, control_,
                                           [&](std::size_t f, std::size_t end) {
                                             Tested tested;
                                             std::vector<VertexPair> edges;
                                             for (; f < end && tested.fault == nullptr; ++f)
                                               test_pieces(f, edges, tested);
                                             return tested;
                                           });
    for (const Tested& tested : blocks) {
      if (tested.fault != nullptr) return tested.fault;
      distance_ = std::max(distance_, tested.distance);
    }
    return nullptr;
  }

  void test_pieces(std::size_t f, std::vector<VertexPair>& edges, Tested& tested) {
    const Corners3 triangle = corners_of(claim_.faces_before[f], before_);
    const double height = height_of(triangle);
    const bool is_thin = height <= kThinReaches * reach_;
    const auto mine = of_face_[f];
    if (mine.empty()) {
      if (!is_thin) tested.fault = "a triangle has no pieces";
      is_incomplete_[f] = 1;
      return;
    }
    const double allowed = scale_(after_.moved) + kRoundingOfProof;
    const Vec3 twice_area = twice_area_of(triangle);
    const Vec3 normal = normalized(twice_area);
    double twice_sum = 0;
    edges.clear();
    for (const std::uint32_t i : mine) {
      const Piece& piece = pieces_[i];
      const Corners3 corners = corners_of(piece.corners, places_);
      if (!piece.is_there) is_incomplete_[f] = 1;
      for (const Vec3& p : corners) {
        const double away = norm(p - nearest_on_triangle(p, triangle));
        if (!(away <= allowed)) tested.fault = "a corner has moved too far";
        tested.distance = std::max(tested.distance, away);
      }
      const double seen = dot(twice_area_of(corners), normal);
      if (!is_thin && !piece.may_be_turned && !(seen > 0) && height_of(corners) > kThinReaches * reach_)
        tested.fault = "a piece faces the wrong way";
      twice_sum += seen;
      for (std::size_t k = 0; k < 3; ++k) edges.push_back({piece.corners[k], piece.corners[(k + 1) % 3]});
    }
    const Outline outline = test_outline(triangle, edges, is_thin, tested);
    // Where the outline is off, so are the areas. Rounding adds up over the pieces.
    const double missing = std::fabs(norm(twice_area) - twice_sum);
    const double slack = static_cast<double>(mine.size() + 4) * kRoundingOfProof;
    if (!is_thin && !(missing <= 2 * (outline.off + slack) * longest_side_of(triangle) * 3 + slack))
      tested.fault = "the pieces of a triangle do not have its area";
    // Points near the outline are near a point of it that a piece has, unless a sharp corner is missing.
    constexpr double kNearOutline = 3;
    if (outline.missing > kNearOutline * outline.off + slack || (is_thin && missing > slack)) is_incomplete_[f] = 1;
    tested.distance = std::max(tested.distance, 2 * kNearOutline * outline.off + slack);
  }

  struct Outline {
    double off = 0;      ///< how far the edges are from the sides of the triangle at most
    double missing = 0;  ///< by how much they are shorter or longer than a side at most
  };

  /// Tests that the edges, after those in opposite directions have cancelled, run along the sides of a triangle once.
  Outline test_outline(const Corners3& triangle, std::vector<VertexPair>& edges, bool is_thin, Tested& tested) const {
    std::sort(edges.begin(), edges.end());
    Outline outline;
    std::array<double, 3> covered{0, 0, 0};
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end] == edges[begin]) ++end;
      const auto opposite =
          std::equal_range(edges.begin(), edges.end(), VertexPair(edges[begin].second, edges[begin].first));
      const auto left = static_cast<std::ptrdiff_t>(end - begin) - (opposite.second - opposite.first);
      if (left > 1 && !is_thin) tested.fault = "an edge bounds the pieces of a triangle twice";
      if (left < 1) continue;
      const Vec3 &p = places_[edges[begin].first.value], &q = places_[edges[begin].second.value];
      std::size_t side = 0;
      double away = HUGE_VAL;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = triangle[k], &b = triangle[(k + 1) % 3];
        const double farthest = std::max(norm(p - nearest_on_segment(p, a, b)), norm(q - nearest_on_segment(q, a, b)));
        if (farthest < away) side = k;
        away = std::min(away, farthest);
      }
      if (!(away <= reach_)) tested.fault = "the pieces of a triangle have an edge inside it";
      outline.off = std::max(outline.off, away);
      covered[side] += dot(q - p, normalized(triangle[(side + 1) % 3] - triangle[side]));
    }
    // The sharper a corner is, the longer its sides are within reach of each other, and may have become one.
    const double twice_area = norm(twice_area_of(triangle));
    const auto tip = [&](std::size_t corner) {
      const Vec3 &p = triangle[corner], &q = triangle[(corner + 1) % 3], &r = triangle[(corner + 2) % 3];
      return kThinReaches * reach_ * norm(q - p) * norm(r - p) / twice_area;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const double missing = std::fabs(covered[k] - norm(triangle[(k + 1) % 3] - triangle[k]));
      outline.missing = std::max(outline.missing, missing);
      if (!is_thin && !(missing <= tip(k) + tip((k + 1) % 3)))
        tested.fault = "the pieces of a triangle do not reach along its sides";
    }
    return outline;
  }

  bool do_faces_meet_as_told() const {
    std::vector<Triangle> sorted = after_.faces;
    for (Triangle& t : sorted) std::sort(t.begin(), t.end());
    sort_stoppable(sorted.begin(), sorted.end(), control_);
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return false;
    std::vector<std::pair<FaceId, FaceId>> told = after_.left;
    for (auto& [f, g] : told)
      if (g < f) std::swap(f, g);
    std::sort(told.begin(), told.end());
    SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(after_.faces.size()));
    limits.is_expected = [&](FaceId f, FaceId g) {
      const auto [low, high] = std::minmax(f, g);
      return std::binary_search(told.begin(), told.end(), std::pair(low, high));
    };
    limits.max_unexpected = 0;
    const SelfIntersections found = self_intersections(after_.positions, after_.faces, {}, limits, control_);
    return found.is_complete && std::all_of(found.pairs.begin(), found.pairs.end(), [&](const auto& pair) {
             return limits.is_expected(pair.first, pair.second);
           });
  }

  const ArrangementClaim& claim_;
  const Arrangement& after_;
  RunControl& control_;
  const Scale scale_;
  const double reach_;
  std::vector<Vec3> before_, places_;  ///< scaled; the flaps' own vertices are behind the others
  std::vector<Piece> pieces_;
  Grouping of_face_;                         ///< the pieces by triangle before
  std::vector<std::uint8_t> is_incomplete_;  ///< by triangle before: pieces of it are missing
  double distance_ = 0;
};

class UnionTest {
 public:
  UnionTest(const UnionClaim& claim, RunControl& control)
      : claim_(claim),
        after_(claim.after),
        control_(control),
        scale_(claim.positions_before, claim.after.positions, control),
        before_(scale_.all(claim.positions_before, control)),
        places_(scale_.all(after_.positions, control)) {}

  std::string run() {
    const std::size_t n = after_.faces.size();
    if (claim_.stays.size() != n || claim_.is_turned.size() != n || claim_.weights.size() != claim_.faces_before.size())
      return "it is not well formed";
    find_neighbours();
    find_sheets();
    if (!do_sheets_stay_as_they_should()) return "a face of the union has no solid behind it, or one before it";
    const bool are_all_closed =
        std::all_of(claim_.weights.begin(), claim_.weights.end(), [](std::int32_t w) { return w != 0; });
    if (are_all_closed && !is_closed()) return "the union is not closed";
    return {};
  }

 private:
  /// A directed edge of a face, with its ends in ascending order.
  struct Side {
    VertexId low, high;
    std::uint32_t face;
    bool is_forward;  ///< the face runs from the lower end to the higher one
    auto operator<=>(const Side&) const = default;
  };

  void find_neighbours() {
    StopCheck check(control_);
    control_.memory().ask_for<Side>(3 * after_.faces.size());
    for (std::uint32_t f = 0; f < after_.faces.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        check();
        const VertexId a = after_.faces[f][k], b = after_.faces[f][(k + 1) % 3];
        sides_.push_back({std::min(a, b), std::max(a, b), f, a < b});
      }
    sort_stoppable(sides_.begin(), sides_.end(), control_);
    neighbours_.assign(3 * after_.faces.size(), {});
    std::vector<std::uint8_t> count(after_.faces.size(), 0);
    for_each_edge([&](std::span<const Side> around) {
      if (around.size() != 2) return;
      const bool is_alike = around[0].is_forward != around[1].is_forward;
      const auto add = [&](const Side& from, const Side& to) {
        neighbours_[3 * from.face + count[from.face]++] = {to.face, is_alike};
      };
      add(around[0], around[1]);
      add(around[1], around[0]);
    });
  }

  template <class Visit>
  void for_each_edge(const Visit& visit) const {
    StopCheck check(control_);
    for (std::size_t begin = 0, end = 0; begin < sides_.size(); begin = end) {
      check();
      while (end < sides_.size() && sides_[end].low == sides_[begin].low && sides_[end].high == sides_[begin].high)
        ++end;
      visit(std::span(sides_).subspan(begin, end - begin));
    }
  }

  /// Puts faces that hang together over edges of two faces into one sheet, with the way in which each faces there.
  void find_sheets() {
    const std::size_t n = after_.faces.size();
    is_along_.assign(n, 0);
    std::vector<std::uint8_t> is_seen(n, 0);
    StopCheck check(control_);
    sheet_begin_.assign(1, 0);
    for (std::uint32_t first = 0; first < n; ++first) {
      if (std::exchange(is_seen[first], 1) != 0) continue;
      is_along_[first] = 1;
      for (std::size_t at = members_.size(), end = (members_.push_back(first), at + 1); at < end; ++at) {
        check();
        const std::uint32_t f = members_[at];
        for (std::size_t k = 0; k < 3; ++k) {
          const Neighbour& next = neighbours_[3 * f + k];
          if (next.face == kNone || std::exchange(is_seen[next.face], 1) != 0) continue;
          is_along_[next.face] = next.is_alike ? is_along_[f] : 1 - is_along_[f];
          members_.push_back(next.face);
          ++end;
        }
      }
      sheet_begin_.push_back(members_.size());
    }
  }

  double height(std::uint32_t f) const { return height_of(corners_of(after_.faces[f], places_)); }

  bool do_sheets_stay_as_they_should() {
    // Triangles of shells that have to be turned over count the other way round.
    std::vector<Triangle> solid;
    for (std::size_t f = 0; f < claim_.faces_before.size(); ++f) {
      const Triangle& t = claim_.faces_before[f];
      const std::int32_t weight = claim_.weights[f];
      for (std::int32_t i = 0; i < std::abs(weight); ++i) solid.push_back(weight > 0 ? t : Triangle{t[0], t[2], t[1]});
    }
    const WindingNumber winding(before_, solid, control_);
    const double thin = kThinReaches * kReachOfJoins * scale_(claim_.distance) + kRoundingOfProof;
    std::vector<std::uint8_t> is_right(sheet_begin_.size() - 1, 0);
    constexpr std::size_t kSheetsPerBlock = 64;
    for_blocks(is_right.size(), kSheetsPerBlock, control_, [&](std::size_t s, std::size_t end) {
      for (; s < end; ++s) {
        const auto faces = std::span(members_).subspan(sheet_begin_[s], sheet_begin_[s + 1] - sheet_begin_[s]);
        const std::uint32_t widest = *std::max_element(
            faces.begin(), faces.end(), [&](std::uint32_t f, std::uint32_t g) { return height(f) < height(g); });
        is_right[s] = height(widest) <= thin || is_sheet_right(widest, faces, winding) ? 1 : 0;
      }
    });
    return std::find(is_right.begin(), is_right.end(), 0) == is_right.end();
  }

  /// Tests a sheet by the winding numbers on both sides of one of its faces.
  bool is_sheet_right(std::uint32_t of, std::span<const std::uint32_t> sheet, const WindingNumber& winding) {
    const Corners3 corners = corners_of(after_.faces[of], places_);
    constexpr double kThird = 1.0 / 3;
    const Vec3 middle = kThird * (corners[0] + corners[1] + corners[2]);
    // In the plane of a triangle, its solid angle is the mean of those on both sides, which is 0.
    double own = 0;
    std::int32_t step = 0;
    for (const Cover& cover : after_.covers_of(of)) {
      const std::int32_t weight = claim_.weights[cover.face.value];
      const Triangle& t = claim_.faces_before[cover.face.value];
      const Triangle counted = weight > 0 ? t : Triangle{t[0], t[2], t[1]};
      own += std::abs(weight) * solid_angle(corners_of(counted, before_), middle) / (4 * std::numbers::pi);
      step += cover.is_reversed ? -weight : weight;
    }
    // The number in front of the face is whole. Where it seems not to be, it is computed again with more care.
    constexpr double kSure = 0.25;
    double before = 0.5;
    for (double far = 2; far <= 32 && std::fabs(before - std::round(before)) > kSure; far *= 4)
      before = winding.at(middle, far) - own - 0.5 * step;
    if (std::fabs(before - std::round(before)) > kSure) return false;
    const bool is_before = before > 0.5, is_behind = before + step > 0.5;
    bool is_right = true;
    for (const std::uint32_t f : sheet) {
      const bool is_along = is_along_[f] == is_along_[of];
      const bool is_front = is_along ? is_before : is_behind, is_back = is_along ? is_behind : is_before;
      const auto covers = after_.covers_of(f);
      const bool is_loose = std::any_of(covers.begin(), covers.end(),
                                        [&](const Cover& cover) { return claim_.weights[cover.face.value] == 0; });
      const bool stays = is_front != is_back || (is_loose && !is_front);
      is_right = is_right && stays == (claim_.stays[f] != 0) && (is_front && !is_back) == (claim_.is_turned[f] != 0);
    }
    return is_right;
  }

  /// Returns whether as many faces that stay run one way along each edge as the other.
  bool is_closed() const {
    bool is_any_open = false;
    for_each_edge([&](std::span<const Side> around) {
      int sum = 0;
      for (const Side& side : around)
        if (claim_.stays[side.face] != 0) sum += side.is_forward != (claim_.is_turned[side.face] != 0) ? 1 : -1;
      is_any_open = is_any_open || sum != 0;
    });
    return !is_any_open;
  }

  struct Neighbour {
    std::uint32_t face = kNone;
    bool is_alike = true;  ///< both faces face the same way
  };

  const UnionClaim& claim_;
  const Arrangement& after_;
  RunControl& control_;
  const Scale scale_;
  const std::vector<Vec3> before_, places_;  ///< scaled
  std::vector<Side> sides_;                  ///< ascending
  std::vector<Neighbour> neighbours_;        ///< three by face, over edges of two faces
  std::vector<std::uint32_t> members_;       ///< faces, sheet by sheet
  std::vector<std::size_t> sheet_begin_;
  std::vector<std::uint8_t> is_along_;
};

}  // namespace

ArrangementProof prove_arrangement(const ArrangementClaim& claim, RunControl& control) {
  return ArrangementTest(claim, control).run();
}

std::string find_fault_of_union(const UnionClaim& claim, RunControl& control) {
  return UnionTest(claim, control).run();
}

}  // namespace remesh
