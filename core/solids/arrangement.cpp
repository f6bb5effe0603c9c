#include "core/solids/arrangement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/largest_coordinate.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/triangles/distances.h"
#include "core/solids/active_faces.h"
#include "core/solids/contacts.h"
#include "core/solids/crossings.h"
#include "core/solids/cut_faces.h"

namespace remesh {
namespace {

/// Contacts make new points, which may be near other faces. So they are looked for so often at most.
constexpr int kMaxPasses = 4;
/// Cut faces have new edges, which may touch others. Passes end if they find more than this many times the contacts of
/// the pass with the fewest.
constexpr std::size_t kMaxGrowthOfContacts = 4;
/// A contact moves features by up to its distance, which may make new contacts. Each time, the distance is smaller.
constexpr double kShareOfPass = 0.5;
/// Rounds end if more than this many times the pairs of the best one intersect.
constexpr std::size_t kMaxWorse = 4;
/// Rounds end if there are more than this many times the triangles of the best one.
constexpr std::size_t kMaxGrowth = 4;
/// Points are joined again after rounding so often at most.
constexpr int kMaxRounds = 6;
/// In the first round, features within so many rounding steps are joined. Each round multiplies that by the factor.
constexpr double kFirstSteps = 4, kRoundFactor = 16;
/// These distances stay below this share of how far points may move.
constexpr double kShareOfRounds = 0.125;
/// Rounds end if the pairs that intersect are more than a few, and more than one for so many triangles: then features
/// straddle the distance.
constexpr std::size_t kFacesPerPair = 16, kFewPairs = 64;
/// Flaps are thin up to so many distances of contacts.
constexpr double kThinFlap = 8;
/// Triangles are thin below this share of how far points may move. They are taken away in so many passes at most.
constexpr double kThin = 0.5;
constexpr int kMaxThinPasses = 16;
/// If more pairs of triangles cross after contacts than so many for each triangle of the input, and some always, they
/// are compared with those that crossed before.
constexpr std::size_t kPairsPerFace = 4, kPairsAlways = 1 << 10;
/// These are smaller shares of the distance within which features are joined. With the first one, joins that follow on
/// each other move points less far. With the second one, few features straddle the distance. With the last one, nothing
/// is joined at first but what rounding has parted, and thin triangles stay.
constexpr double kLessDistance = 0.5, kFewStraddle = 0x1p-4, kMinDistance = 0x1p-16;
/// A rounding of how far points have moved.
constexpr double kRoundingOfMoves = 1 + 0x1p-30;

double smallest_height(const Corners3& t) {
  const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  return longest > 0 ? norm(cross(t[1] - t[0], t[2] - t[0])) / longest : 0;
}

/// Arranges triangles once.
/// This class is larger than the bound because all of its steps work on one soup and on which of its faces are active.
class Arranging {
 public:
  /// Input: `limit` is how far points may move.
  Arranging(std::span<const Vec3> positions, std::span<const Triangle> faces, double distance, double limit,
            RunControl& control)
      : input_positions_(positions), input_faces_(faces), control_(control) {
    const double largest = largest_coordinate(positions, control);
    exponent_ = largest > 0 ? std::ilogb(largest) + 1 : 0;
    distance_ = std::ldexp(distance, -exponent_);
    limit_ = std::ldexp(limit, -exponent_);
  }

  Arrangement run() {
    start();
    join_copies();
    Arrangement result;
    if (!join_contacts(distance_)) return give_up(result);
    result.is_changed = is_changed_;
    active_.clear();
    if (!are_all_apart_ && !find_intersecting(result.left)) return give_up(result);
    if (have_contacts_made_pairs(result.left.size())) return give_up(result);
    if (!cut_until_nothing_crosses(result)) return give_up(result);
    if (result.is_changed && distance_ > kMinDistance * limit_) join_thin(result);
    if (result.is_changed) drop_flaps(result.left);
    finish(result);
    return result;
  }

 private:
  static Arrangement give_up(const Arrangement& so_far) {
    Arrangement none;
    none.is_given_up = true;
    none.rounds = so_far.rounds;
    return none;
  }

  /// Returns whether contacts have made many more triangles cross than crossed before.
  bool have_contacts_made_pairs(std::size_t pairs) const {
    if (pairs <= kPairsPerFace * input_faces_.size() + kPairsAlways) return false;
    Arranging before(input_positions_, input_faces_, 0, 0, control_);
    before.start();
    before.join_copies();
    std::vector<std::pair<FaceId, FaceId>> crossing;
    return before.find_intersecting(crossing) && pairs > kMaxWorse * crossing.size();
  }

  /// Cuts faces along the pairs that intersect. Where rounding makes new pairs, near points are joined, and so on.
  /// Output: false if that is too much.
  bool cut_until_nothing_crosses(Arrangement& result) {
    bool is_known = true;      // whether all pairs are
    std::optional<Soup> best;  // the one with the fewest pairs that intersect, if some do after the first cut
    std::vector<std::pair<FaceId, FaceId>> left_of_best;
    for (int round = 0; !result.left.empty(); ++round) {
      result.is_changed = true;
      if (!cut_crossings(result)) return false;
      // Faces that are not active are as they were when they intersected no others of these.
      is_known = find_intersecting(result.left);
      if (!is_known || result.left.empty()) break;
      if (!best || result.left.size() < left_of_best.size()) {
        best = soup_;
        left_of_best = result.left;
      }
      const bool is_too_much = soup_.faces.size() > kMaxGrowth * best->faces.size() ||
                               result.left.size() > std::max(kFewPairs, soup_.faces.size() / kFacesPerPair);
      if (round == kMaxRounds || is_too_much || result.left.size() > kMaxWorse * left_of_best.size()) break;
      ++result.rounds;
      activate(result.left);
      const double within = kFirstSteps * kSoupRoundingStep * std::pow(kRoundFactor, round);
      is_known = join_contacts(std::min(within, kShareOfRounds * limit_)) && find_intersecting(result.left);
      if (!is_known) break;
    }
    if (is_known && result.left.empty()) return true;
    // It did not help to join points. What is left is told.
    if (!best) return false;
    soup_ = *std::move(best);
    result.left = std::move(left_of_best);
    return true;
  }

  /// Takes away triangles that are thinner than a contact. Cuts leave such triangles where a curve runs beside an edge.
  /// Triangles stay where that would make others intersect, or move a point too far.
  void join_thin(Arrangement& result) {
    std::vector<std::uint8_t> is_fixed(soup_.positions.size(), 0);  // by vertex: it is not to be joined
    std::vector<FaceId> thin = thin_faces();
    for (int pass = 0; pass < kMaxThinPasses && !thin.empty() && result.left.empty(); ++pass) {
      control_.check_and_move();
      const SoupEdges edges(soup_, control_);
      CutPlan plan = plan_without_thin(thin, edges, is_fixed);
      if (plan.is_empty()) return;
      Soup before = soup_;
      take(cut_faces(soup_, edges, plan, {}, control_));
      std::vector<std::pair<FaceId, FaceId>> crossing;
      const bool is_known = find_intersecting(crossing);
      std::vector<FaceId> thin_now = thin_faces();
      if (is_known && crossing.empty() && thin_now.size() < thin.size()) {
        thin = std::move(thin_now);
        result.is_changed = true;
        continue;
      }
      for (const auto& [f, g] : crossing)
        for (const FaceId face : {f, g})
          for (const VertexId v : soup_.faces[face.value]) is_fixed[v.value] = 1;
      soup_ = std::move(before);
      if (!is_known || crossing.empty()) return;
    }
  }

  /// Plans what takes away thin triangles that share no corner: their shortest side becomes a point if it is short, and
  /// otherwise the corner at their longest side becomes a point of that side.
  CutPlan plan_without_thin(const std::vector<FaceId>& faces, const SoupEdges& edges,
                            const std::vector<std::uint8_t>& is_fixed) const {
    std::vector<std::pair<double, FaceId>> thin;
    for (const FaceId f : faces) thin.push_back({smallest_height(corners(f.value)), f});
    sort_stoppable(thin.begin(), thin.end(), control_);
    CutPlan plan;
    const Grouping at = group_by(
        3 * soup_.faces.size(), soup_.positions.size(),
        [&](std::uint32_t i) { return soup_.faces[i / 3][i % 3].value; }, control_);
    const auto faces_of = [&](VertexId v) {
      std::vector<std::uint32_t> found;
      for (const std::uint32_t i : at[v.value]) found.push_back(i / 3);
      return found;
    };
    std::vector<std::uint8_t> is_taken = is_fixed;
    std::vector<VertexId> image(soup_.positions.size());
    for (std::size_t v = 0; v < image.size(); ++v) image[v] = VertexId(v);
    bool is_any_joined = false;
    StopCheck check(control_);
    for (const auto& [height, f] : thin) {
      check();
      const Triangle& t = soup_.faces[f.value];
      if (std::any_of(t.begin(), t.end(), [&](VertexId v) { return is_taken[v.value] != 0; })) continue;
      const Corners3 c = corners(f.value);
      std::size_t shortest = 0, longest = 0;
      const auto length = [&](std::size_t k) { return norm(c[(k + 1) % 3] - c[k]); };
      for (std::size_t k = 1; k < 3; ++k) {
        if (length(k) < length(shortest)) shortest = k;
        if (length(k) > length(longest)) longest = k;
      }
      if (length(shortest) < kThin * limit_) {
        const auto [stays, goes] = std::minmax(t[shortest], t[(shortest + 1) % 3]);
        if (goes.value < vertex_.size() || !may_move(faces_of(goes), stays)) continue;
        image[goes.value] = stays;
        is_any_joined = true;
      } else {
        const VertexId apex = t[(longest + 2) % 3];
        const EdgeId side = edges.of(f, longest);
        std::vector<std::uint32_t> beyond;
        for (const std::uint32_t h : edges.half_edges(side)) beyond.push_back(h / 3);
        if (!may_move(beyond, apex)) continue;
        plan.on_edges.push_back({side, apex});
      }
      for (const VertexId v : t) is_taken[v.value] = 1;
    }
    if (is_any_joined) plan.image = std::move(image);
    return plan;
  }

  /// Returns whether a vertex is near enough to all triangles that some faces cover, to become a corner of these faces.
  bool may_move(std::span<const std::uint32_t> faces, VertexId to) const {
    const Vec3& p = soup_.positions[to.value];
    for (const std::uint32_t f : faces)
      for (const Cover& cover : soup_.covers_of(f)) {
        if (norm(p - nearest_on_triangle(p, corners_of_input(cover.face))) > limit_) return false;
      }
    return true;
  }

  Corners3 corners_of_input(FaceId f) const {
    const Triangle& t = input_faces_[f.value];
    return {scaled(input_positions_[t[0].value]), scaled(input_positions_[t[1].value]),
            scaled(input_positions_[t[2].value])};
  }

  std::vector<FaceId> thin_faces() const {
    return select_ids<FaceId>(soup_.faces.size(), kFacesPerBlock, control_,
                              [&](std::size_t f) { return smallest_height(corners(f)) < kThin * limit_; });
  }

  /// Numbers vertices by their coordinates, and triangles by their corners, so that numbers do not depend on the input.
  void start() {
    StopCheck check(control_);
    const std::size_t vertices = input_positions_.size();
    control_.memory().ask_for<Vec3>(2 * vertices);
    vertex_.resize(vertices);
    std::iota(vertex_.begin(), vertex_.end(), 0U);
    sort_stoppable(vertex_.begin(), vertex_.end(), control_, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(input_positions_[a], a) < std::pair(input_positions_[b], b);
    });
    std::vector<VertexId> number(vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
      check();
      number[vertex_[v]] = VertexId(v);
      soup_.positions.push_back(scaled(input_positions_[vertex_[v]]));
    }
    std::vector<std::pair<Triangle, FaceId>> faces;
    for (std::size_t f = 0; f < input_faces_.size(); ++f) {
      check();
      Triangle t = input_faces_[f];
      for (VertexId& v : t) v = number[v.value];
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      faces.push_back({t, FaceId(f)});
    }
    sort_stoppable(faces.begin(), faces.end(), control_);
    for (const auto& [t, f] : faces) {
      check();
      soup_.faces.push_back(t);
      soup_.covers.push_back({f, false});
      soup_.cover_begin.push_back(static_cast<std::uint32_t>(soup_.covers.size()));
    }
  }

  /// Joins triangles with the same corners.
  void join_copies() {
    std::vector<Triangle> sorted = soup_.faces;
    for (Triangle& t : sorted) std::sort(t.begin(), t.end());
    sort_stoppable(sorted.begin(), sorted.end(), control_);
    if (std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end()) return;
    CutPlan nothing;
    take(cut_faces(soup_, SoupEdges(soup_, control_), nothing, {}, control_));
    active_.clear();
  }

  Vec3 scaled(const Vec3& p) const {
    constexpr double kLeast = 0x1p-100;
    Vec3 q;
    for (int axis = 0; axis < 3; ++axis) {
      q[axis] = std::ldexp(p[axis], -exponent_);
      if (std::fabs(q[axis]) < kLeast) q[axis] = 0;
    }
    return q;
  }

  void take(CutSoup&& cut) {
    is_changed_ = true;
    soup_.faces = std::move(cut.faces);
    soup_.cover_begin = std::move(cut.cover_begin);
    soup_.covers = std::move(cut.covers);
    active_ = std::move(cut.is_active);
  }

  /// Makes shared what is within a distance.
  /// Output: false if that is too much.
  bool join_contacts(double distance) {
    largest_distance_ = std::max(largest_distance_, distance);
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (int pass = 0; pass < kMaxPasses; ++pass, distance *= kShareOfPass) {
      control_.check_and_move();
      const SoupEdges edges(soup_, control_);
      std::optional<CutPlan> plan = find_contacts(soup_, edges, distance, active_, control_);
      if (!plan) return false;
      are_all_apart_ = plan->are_all_apart;
      // Contacts become fewer in the end, or they are made by joining others, and would go on for ever.
      if (plan->is_empty() || plan->size() / kMaxGrowthOfContacts >= least) return true;
      least = std::min(least, plan->size());
      take(cut_faces(soup_, edges, *plan, active_, control_));
    }
    return true;
  }

  /// Finds the pairs of faces that intersect, of which one is active.
  /// Output: false if there are too many pairs.
  bool find_intersecting(std::vector<std::pair<FaceId, FaceId>>& pairs) {
    const std::size_t n = soup_.faces.size();
    constexpr std::size_t kPairsPerFace = 64, kAlways = 1 << 16;
    const SearchLimits limits(kPairsPerFace * n + kAlways, SearchLimits::steps_for(n));
    const SelectedFaces selected = select_near_active(soup_, active_, 0, control_);
    SelfIntersections found = self_intersections(soup_.positions, selected.faces(soup_), {}, limits, control_);
    for (auto& [f, g] : found.pairs) {
      f = selected.number(f);
      g = selected.number(g);
    }
    pairs = std::move(found.pairs);
    return found.is_complete;
  }

  /// Output: false if that is too much.
  bool cut_crossings(Arrangement& result) {
    const SoupEdges edges(soup_, control_);
    Crossings crossings = find_crossings(soup_, edges, result.left, control_);
    if (crossings.is_too_much) return false;
    if (result.rounds == 0) result.curves = crossings.curves;
    activate(result.left);
    take(cut_faces(soup_, edges, crossings.plan, active_, control_));
    return true;
  }

  /// Looks at these faces, and at those that share corners with them, in the next round.
  void activate(const std::vector<std::pair<FaceId, FaceId>>& pairs) {
    std::vector<std::uint8_t> is_near(soup_.positions.size(), 0);
    for (const auto& [f, g] : pairs)
      for (const FaceId face : {f, g})
        for (const VertexId v : soup_.faces[face.value]) is_near[v.value] = 1;
    active_.assign(soup_.faces.size(), 0);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f)
      for (const VertexId v : soup_.faces[f])
        if (is_near[v.value] != 0) active_[f] = 1;
  }

  /// Drops thin faces that cover as many triangles from one side as from the other, and have an edge of their own.
  /// Joins leave such faces where a part was hardly wider than the distance.
  /// Input: pairs of faces, which get the new numbers of faces that stay.
  void drop_flaps(std::vector<std::pair<FaceId, FaceId>>& pairs) {
    const SoupEdges edges(soup_, control_);
    StopCheck check(control_);
    std::vector<std::uint32_t> left(edges.count());
    std::vector<std::uint8_t> is_flap(soup_.faces.size(), 0);
    std::vector<FaceId> stack;
    for (EdgeId e(0); e.value < edges.count(); ++e.value)
      left[e.value] = static_cast<std::uint32_t>(edges.half_edges(e).size());
    const auto drop_if_flap = [&](FaceId f) {
      if (is_flap[f.value] != 0 || !is_balanced(f.value) ||
          smallest_height(corners(f.value)) > kThinFlap * largest_distance_)
        return;
      for (std::size_t k = 0; k < 3; ++k)
        if (left[edges.of(f, k).value] == 1) is_flap[f.value] = 1;
      if (is_flap[f.value] != 0) stack.push_back(f);
    };
    for (FaceId f(0); f.value < soup_.faces.size(); ++f.value) {
      check();
      drop_if_flap(f);
    }
    if (stack.empty()) return;
    while (!stack.empty()) {
      check();
      const FaceId f = stack.back();
      stack.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const EdgeId e = edges.of(f, k);
        if (--left[e.value] != 1) continue;
        for (const std::uint32_t h : edges.half_edges(e)) drop_if_flap(FaceId(h / 3));
      }
    }
    Soup kept;
    std::vector<FaceId> number(soup_.faces.size());
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      check();
      const auto covers = soup_.covers_of(f);
      if (is_flap[f] != 0) {
        flaps_.push_back({soup_.faces[f], {covers.begin(), covers.end()}});
        continue;
      }
      number[f] = FaceId(kept.faces.size());
      kept.faces.push_back(soup_.faces[f]);
      kept.covers.insert(kept.covers.end(), covers.begin(), covers.end());
      kept.cover_begin.push_back(static_cast<std::uint32_t>(kept.covers.size()));
    }
    for (auto& [f, g] : pairs) {
      f = number[f.value];
      g = number[g.value];
    }
    std::erase_if(pairs, [](const auto& pair) { return !pair.first.is_valid() || !pair.second.is_valid(); });
    kept.positions = std::move(soup_.positions);
    soup_ = std::move(kept);
  }

  Corners3 corners(std::size_t f) const {
    const Triangle& t = soup_.faces[f];
    return {soup_.positions[t[0].value], soup_.positions[t[1].value], soup_.positions[t[2].value]};
  }
  /// Returns whether as many triangles that a face covers face one way as the other.
  bool is_balanced(std::size_t f) const {
    const auto covers = soup_.covers_of(f);
    const auto reversed = std::count_if(covers.begin(), covers.end(), [](const Cover& c) { return c.is_reversed; });
    return 2 * static_cast<std::size_t>(reversed) == covers.size();
  }

  void finish(Arrangement& result) {
    StopCheck check(control_);
    std::vector<VertexId> number(soup_.positions.size());
    for (const Triangle& t : soup_.faces)
      for (const VertexId v : t) number[v.value] = VertexId(0);
    for (std::size_t v = 0; v < number.size(); ++v) {
      check();
      if (!number[v].is_valid()) continue;
      number[v] = VertexId(result.positions.size());
      const bool is_old = v < vertex_.size();
      result.vertex.push_back(is_old ? VertexId(vertex_[v]) : VertexId());
      result.positions.push_back(is_old ? input_positions_[vertex_[v]] : to_model(soup_.positions[v]));
    }
    for (Flap& flap : flaps_)
      for (VertexId& v : flap.corners) {
        if (!number[v.value].is_valid()) {
          number[v.value] = VertexId(result.positions.size() + result.flap_positions.size());
          const bool is_old = v.value < vertex_.size();
          result.flap_positions.push_back(is_old ? input_positions_[vertex_[v.value]]
                                                 : to_model(soup_.positions[v.value]));
        }
        v = number[v.value];
      }
    result.flaps = std::move(flaps_);
    result.moved = std::ldexp(find_moved(), exponent_);
    result.was_cut.assign(input_faces_.size(), 1);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      check();
      const auto covers = soup_.covers_of(f);
      if (covers.size() > 1) ++result.shared;
      Triangle t = soup_.faces[f];
      for (VertexId& v : t) v = number[v.value];
      // A triangle is whole if all its corners are those that it had.
      Triangle before = input_faces_[covers.front().face.value], after;
      std::transform(t.begin(), t.end(), after.begin(), [&](VertexId v) { return result.vertex[v.value]; });
      std::sort(before.begin(), before.end());
      std::sort(after.begin(), after.end());
      if (before == after) result.was_cut[covers.front().face.value] = 0;
      result.faces.push_back(t);
    }
    result.cover_begin = std::move(soup_.cover_begin);
    result.covers = std::move(soup_.covers);
  }

  Vec3 to_model(const Vec3& p) const {
    return {std::ldexp(p.x, exponent_), std::ldexp(p.y, exponent_), std::ldexp(p.z, exponent_)};
  }

  /// Returns how far points have moved: the largest distance of a corner from a triangle of which its face is a piece,
  /// and the height of triangles that have vanished.
  double find_moved() const {
    std::vector<std::uint8_t> is_there(input_faces_.size(), 0);
    for (const Cover& cover : soup_.covers) is_there[cover.face.value] = 1;
    const auto largest =
        map_blocks<double>(soup_.faces.size(), kFacesPerBlock, control_, [&](std::size_t f, std::size_t end) {
          double moved = 0;
          for (; f < end; ++f)
            for (const Cover& cover : soup_.covers_of(f)) {
              const Corners3 triangle = corners_of_input(cover.face);
              for (const VertexId v : soup_.faces[f]) {
                const Vec3& p = soup_.positions[v.value];
                if (std::find(triangle.begin(), triangle.end(), p) != triangle.end()) continue;
                moved = std::max(moved, norm(p - nearest_on_triangle(p, triangle)));
              }
            }
          return moved;
        });
    double moved = 0;
    for (const double of_block : largest) moved = std::max(moved, of_block);
    for (std::size_t f = 0; f < is_there.size(); ++f) {
      if (is_there[f] != 0) continue;
      moved = std::max(moved, smallest_height(corners_of_input(FaceId(f))) + largest_distance_);
    }
    return moved;
  }

  static constexpr std::size_t kFacesPerBlock = 1 << 12;

  std::span<const Vec3> input_positions_;
  std::span<const Triangle> input_faces_;
  RunControl& control_;
  int exponent_ = 0;                   ///< the soup's coordinates are the input's times 2^-exponent_
  double distance_ = 0, limit_ = 0;    ///< lengths in the soup's unit
  double largest_distance_ = 0;        ///< within which features were joined
  std::vector<std::uint32_t> vertex_;  ///< by vertex of the soup: that of the input; new vertices follow
  Soup soup_;
  std::vector<Flap> flaps_;           ///< with corners of the soup
  std::vector<std::uint8_t> active_;  ///< by face: it may have contacts; empty: all may
  bool is_changed_ = false;
  bool are_all_apart_ = false;  ///< it is known that no two faces meet
};

}  // namespace

std::optional<double> next_share(double share, ArrangementFault fault) {
  if (fault == ArrangementFault::kNone || share <= kMinDistance) return std::nullopt;
  if (fault == ArrangementFault::kTooMuch) return kMinDistance;
  if (share <= kFewStraddle) return fault == ArrangementFault::kFails ? std::optional(kMinDistance) : std::nullopt;
  return fault == ArrangementFault::kMovesTooFar && share > kLessDistance ? kLessDistance : kFewStraddle;
}

ArrangementFault fault_of(const Arrangement& arranged, double distance) {
  if (arranged.is_given_up) return ArrangementFault::kTooMuch;
  if (!arranged.left.empty()) return ArrangementFault::kFails;
  return arranged.moved > kRoundingOfMoves * distance ? ArrangementFault::kMovesTooFar : ArrangementFault::kNone;
}

Arrangement arrange(std::span<const Vec3> positions, std::span<const Triangle> faces, double distance,
                    RunControl& control, double share) {
  return Arranging(positions, faces, share * distance, distance, control).run();
}

}  // namespace remesh
