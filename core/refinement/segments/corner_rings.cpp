#include "core/refinement/segments/corner_rings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {
namespace {

/// A corner is sharp if the distance between its sides, at the distance 1 from it, is at most this share of the tangent
/// of the min angle. In wider corners, pieces as long as the size already give triangles in one row that meet the
/// bound.
constexpr double kSharp = 0.7;
/// A corner is not cut by rings if a corner beside it is sharper by more than this factor. Otherwise one sliver in a
/// fan would cause the whole fan to be cut as finely as the sliver.
constexpr double kAlikeWidths = 2;
/// Sides that are farther apart than this multiple of the size are no longer near each other: a row of the largest
/// triangles has some room between them.
constexpr double kFarApart = 0.85;
/// Pieces are shorter by this factor than the bound on angles allows, because rows are not quite regular. A smaller
/// factor gives more triangles, and a factor above 1.02 gives far more. See experiments.md, Sharp corners.
constexpr double kMargin = 0.98;
/// Where sizes vary, the triangle in a corner is this multiple of the size long. Shorter ones give more tetrahedra;
/// longer ones give more flat tetrahedra. See experiments.md, Sharp corners.
constexpr double kTip = 0.54;
/// In wider corners, the triangle in the corner is this multiple of the size long. Two such triangles beside a slight
/// bend have their four corners nearly on a circle. If they are short, they fit between the walls as a flat tetrahedron
/// over the bend; if they are long, they meet the vertices of the far wall. See experiments.md, Sharp corners.
constexpr double kTipOfWide = 0.66;
constexpr double kWide = 0.12;  ///< distance between the sides at the distance 1 from the corner; some 7 degrees
/// No piece is shorter than this multiple of the size. Where shorter pieces would be needed, the bound on angles is
/// given up.
constexpr double kMinPiece = 0x1p-5;
/// The rest of a side behind its last ring is no shorter than this multiple of the last piece.
constexpr double kMinRest = 0.5;
/// Two sides are cut together for at most this many pieces; behind that, each is cut on its own. No real model
/// needs more. But a strip of a billion sizes would fill the memory before the limit on faces is reached. Many corners
/// together get kStopsPerFace times the faces that are allowed, but at least kMinStops each.
constexpr std::uint64_t kMaxStops = 1 << 20, kMinStops = 1 << 10, kStopsPerFace = 8;

std::size_t max_stops_of(std::size_t sides, std::uint64_t max_faces) {
  const std::uint64_t faces = std::min(max_faces / std::max<std::size_t>(sides, 1), kMaxStops);
  return std::clamp(kStopsPerFace * faces, kMinStops, kMaxStops);
}

/// Returns how far apart the sides of a corner are at the distance 1 from it.
double width_of(double angle) { return 2 * std::sin(angle / 2); }

/// This is a side of a sharp corner. Two corners that lie beside each other share one.
struct Side {
  SegmentEnd end;
  double length;
  double floor;
  double reach;  ///< the max distance up to which both this side and the other side of one of its corners extend
  double width;  ///< distance to the other side of its sharpest corner, per distance from the corner
  bool is_between = false;
  double common = 0;  ///< the distance up to which this side is near the other side of a corner
};

/// Returns one Side for each end of a segment at a sharp corner, sorted by end.
std::vector<Side> sides_of(std::span<const Corner> corners, const SegmentTable& table, RunControl& control) {
  std::vector<Side> sides;
  StopCheck check(control);
  for (const Corner& c : corners) {
    check();
    const BoundarySegment &a = table[c.end.segment()], &b = table[c.other.segment()];
    const double reach = std::min(a.length, b.length), width = width_of(c.angle);
    sides.push_back({c.end, a.length, a.floor, reach, width});
    sides.push_back({c.other, b.length, b.floor, reach, width});
  }
  sort_stoppable(sides.begin(), sides.end(), control, [](const Side& a, const Side& b) { return a.end < b.end; });
  std::size_t count = 0;
  for (const Side& side : sides) {
    if (count == 0 || sides[count - 1].end != side.end) {
      sides[count++] = side;
      continue;
    }
    Side& same = sides[count - 1];
    same.reach = std::max(same.reach, side.reach);
    same.width = std::min(same.width, side.width);
  }
  sides.resize(count);
  return sides;
}

using Pair = std::array<std::uint32_t, 2>;

/// Decides which sides around a vertex are cut between the common distances: every second one. In a ring with an odd
/// number of sides, two neighbours are cut alike.
void take_turns(std::span<const Pair> pairs, std::span<Side> sides, RunControl& control) {
  std::vector<std::uint8_t> is_seen(sides.size(), 0);
  std::vector<std::uint32_t> queue;
  StopCheck check(control);
  for (std::uint32_t seed = 0; seed < sides.size(); ++seed) {
    if (is_seen[seed] != 0) continue;
    is_seen[seed] = 1;
    queue.assign(1, seed);
    for (std::size_t k = 0; k < queue.size(); ++k)
      for (auto pair = std::lower_bound(pairs.begin(), pairs.end(), Pair{queue[k], 0});
           pair != pairs.end() && (*pair)[0] == queue[k]; ++pair) {
        check();
        const std::uint32_t next = (*pair)[1];
        if (std::exchange(is_seen[next], 1) != 0) continue;
        sides[next].is_between = !sides[queue[k]].is_between;
        queue.push_back(next);
      }
  }
}

/// Measures the way from a vertex along the sides of its sharp corners in pieces.
class Way {
 public:
  Way(const SegmentTable& table, const SizeField& sizes, double tangent, std::size_t max_stops, RunControl& control)
      : table_(table), sizes_(sizes), tangent_(tangent), max_stops_(max_stops), control_(control) {}

  /// Walks from the vertex as long as sides are near each other, and sets `common` of each side. `members` are indices
  /// of sides.
  void walk(std::span<Side> sides, std::vector<std::uint32_t> members) {
    stops_.clear();
    floor_ = 0;
    double size = HUGE_VAL, nearest_end = HUGE_VAL;
    for (const std::uint32_t i : members) {
      size = std::min(size, size_at(sides[i], 0));
      floor_ = std::max(floor_, sides[i].floor);
      nearest_end = std::min(nearest_end, sides[i].reach);
    }
    Piece piece{size, true};
    double width = HUGE_VAL;
    for (const std::uint32_t i : members) width = std::min(width, sides[i].width);
    // The length for wide corners is not used if the pieces behind the triangle would be as short as the floor.
    const bool is_wide = width >= kWide && width * kTipOfWide * size >= 2 * floor_;
    const double tip = (is_wide ? kTipOfWide : kTip) * size;
    if (!sizes_.is_uniform() && tip >= floor_) piece.length = tip;
    // Without this rule, a side that ends soon would stay uncut because it lacks room, while the other sides are cut.
    if (nearest_end > piece.length && nearest_end < 2 * piece.length) {
      if (nearest_end <= size)
        piece.length = nearest_end;
      else if (nearest_end / 2 >= floor_)
        piece.length = nearest_end / 2;
    }
    double step = piece.length;
    // If no side is cut, only the first distance is used: other sides at the vertex begin with it.
    const bool is_any_cut = std::any_of(members.begin(), members.end(),
                                        [&](std::uint32_t i) { return !table_[sides[i].end.segment()].is_locked(); });
    const std::size_t max_stops = is_any_cut ? max_stops_ : 1;
    for (Stop from; stops_.size() < max_stops; from = stops_.back()) {
      std::erase_if(members, [&](std::uint32_t i) {
        return !(sides[i].reach > from.distance) || !(sides[i].width * from.distance < kFarApart * size);
      });
      if (members.empty()) return;
      double farthest = 0;
      for (const std::uint32_t i : members) farthest = std::max(farthest, sides[i].reach);
      // The triangle in the corner counts as one piece, whatever the lengths of the other pieces.
      const bool is_first = stops_.empty();
      if (!is_first) step = longest_piece(sides, members, from.distance, size).length / 2;
      const double to = std::min(farthest, from.distance + step);
      size = HUGE_VAL;
      for (const std::uint32_t i : members) {
        const double middle = from.distance + (to - from.distance) / 2;
        size = std::min(size, size_at(sides[i], std::min(middle, sides[i].length)));
        sides[i].common = std::min(to, sides[i].reach);
      }
      if (!is_first) piece = longest_piece(sides, members, from.distance, size);
      stops_.push_back({to, is_first ? 0 : from.pieces + (to - from.distance) / piece.length, piece.is_row});
    }
  }

  /// Appends two lists of distances from the corner, equally long. Both begin with the length of the triangle in the
  /// corner. The first list is for the sides that are not `is_between`. It continues with the ends of the pieces behind
  /// that triangle. Each of these pieces is the same fraction of the longest piece that is allowed at its place. The
  /// second list is for the sides that are `is_between`. Where a single row of triangles meets the bound on angles, it
  /// has the middles of the same pieces; elsewhere it has their ends.
  void add_distances(std::vector<double>& distances) const {
    distances.push_back(stops_[0].distance);
    std::vector<double> between{stops_[0].distance};
    const double all = stops_.back().pieces;
    const auto count = static_cast<std::size_t>(std::ceil(all * (1 - 1e-12)));
    std::size_t k = 1;
    // Returns the distance at which piece i ends; i - 0.5 gives its middle. The argument must not get smaller from one
    // call to the next.
    const auto place = [&](double i) {
      const double pieces = all * (i / static_cast<double>(count));
      while (k + 1 < stops_.size() && stops_[k].pieces < pieces) ++k;
      const Stop &a = stops_[k - 1], &b = stops_[k];
      return a.distance + (pieces - a.pieces) / (b.pieces - a.pieces) * (b.distance - a.distance);
    };
    for (std::size_t i = 1; i <= count; ++i) {
      const double middle = place(static_cast<double>(i) - 0.5);
      const bool is_row = stops_[k].is_row;
      distances.push_back(i < count ? place(static_cast<double>(i)) : stops_.back().distance);
      between.push_back(is_row ? middle : distances.back());
    }
    distances.insert(distances.end(), between.begin(), between.end());
  }

 private:
  struct Stop {
    double distance = 0, pieces = 0;
    /// True if the pieces before this stop meet the bound on angles, as a single row of triangles.
    bool is_row = true;
  };
  struct Piece {
    double length;
    bool is_row;
  };

  /// Returns the longest piece, at that distance from the corner, that gives triangles in one row which meet the bound.
  /// Along the sides, the end of a piece of one side and the end of a piece of the other side are then apart by the
  /// distance between the sides over the tangent.
  Piece longest_piece(std::span<const Side> sides, std::span<const std::uint32_t> members, double distance,
                      double size) const {
    double width = HUGE_VAL;
    for (const std::uint32_t i : members) width = std::min(width, sides[i].width);
    const double longest = kMargin * 2 * std::log1p(width / tangent_) * distance;
    // The pieces are a little shorter than the size, because the edges that join their ends across the corner are a
    // little longer than the pieces and must not exceed the size either.
    if (longest < std::max(2 * floor_, kMinPiece * size)) return {(1 - kMinPiece * kMinPiece) * size, false};
    return {std::min(longest, size), true};
  }

  double size_at(const Side& side, double distance) const {
    control_.check();
    const double t = distance / side.length;
    return sizes_.at(table_.position(side.end.segment(), side.end.is_from() ? t : 1 - t));
  }

  const SegmentTable& table_;
  const SizeField& sizes_;
  double tangent_;
  std::size_t max_stops_;
  RunControl& control_;
  double floor_ = 0;
  std::vector<Stop> stops_;
};

/// Counts the distances of a group that lie on the side and leave enough of the side behind the last one.
std::size_t count_near(const Side& side, std::span<const double> distances) {
  double before = 0;
  std::size_t count = 0;
  for (const double here : distances) {
    if (here > side.common * (1 + 1e-9) || side.length - here < kMinRest * (here - before)) break;
    before = here;
    ++count;
  }
  return count;
}

}  // namespace

CornerRings::CornerRings(const SegmentTable& table, std::vector<Corner> corners, const Goals& goals,
                         const SizeField& sizes, RunControl& control) {
  if (goals.min_angle_deg == 0 || (sizes.is_uniform() && !std::isfinite(sizes.largest()))) return;
  const double tangent = std::tan(goals.min_angle_deg * std::numbers::pi / 180);
  std::erase_if(corners, [&](const Corner& c) { return width_of(c.angle) >= kSharp * tangent; });
  std::vector<Side> sides = sides_of(corners, table, control);
  const auto slot = [&](SegmentEnd end) {
    return static_cast<std::uint32_t>(
        std::lower_bound(sides.begin(), sides.end(), end, [](const Side& s, SegmentEnd e) { return s.end < e; }) -
        sides.begin());
  };
  std::erase_if(corners, [&](const Corner& c) {
    return width_of(c.angle) > kAlikeWidths * std::min(sides[slot(c.end)].width, sides[slot(c.other)].width);
  });
  sides = sides_of(corners, table, control);
  std::vector<Pair> pairs;
  UnionFind together(sides.size());
  StopCheck check(control);
  for (const Corner& c : corners) {
    check();
    const std::uint32_t a = slot(c.end), b = slot(c.other);
    together.join(a, b);
    pairs.insert(pairs.end(), {{a, b}, {b, a}});
  }
  sort_stoppable(pairs.begin(), pairs.end(), control);
  take_turns(pairs, sides, control);

  // The sides that follow each other around a vertex form a group. Each group has its own way.
  const Grouping groups = group_by(
      sides.size(), sides.size(), [&](std::uint32_t i) { return together.find(i); }, control);
  ranges_.resize(sides.size());
  struct Block {
    std::vector<double> distances;
    std::vector<std::uint32_t> sides;
  };
  constexpr std::size_t kGroups = 256;
  const std::size_t max_stops = max_stops_of(sides.size(), goals.max_faces);
  const auto blocks = map_blocks<Block>(sides.size(), kGroups, control, [&](std::size_t g, std::size_t end) {
    Block block;
    Way way(table, sizes, tangent, max_stops, control);
    for (; g < end; ++g) {
      if (groups[g].empty()) continue;
      control.check();
      const std::size_t first = block.distances.size();
      way.walk(sides, {groups[g].begin(), groups[g].end()});
      way.add_distances(block.distances);
      const std::size_t count = (block.distances.size() - first) / 2;
      for (const std::uint32_t i : groups[g]) {
        const std::size_t begin = sides[i].is_between ? first + count : first;
        ranges_[i] = {sides[i].end, begin, count_near(sides[i], std::span(block.distances).subspan(begin, count))};
        block.sides.push_back(i);
      }
    }
    return block;
  });
  for (const Block& block : blocks) {
    for (const std::uint32_t i : block.sides) ranges_[i].begin += distances_.size();
    distances_.insert(distances_.end(), block.distances.begin(), block.distances.end());
  }
}

std::span<const double> CornerRings::at(SegmentEnd end) const {
  const auto found =
      std::lower_bound(ranges_.begin(), ranges_.end(), end, [](const Range& r, SegmentEnd e) { return r.end < e; });
  if (found == ranges_.end() || found->end != end) return {};
  return std::span(distances_).subspan(found->begin, found->size);
}

}  // namespace remesh
