#include "core/refinement/refiner/lattice_fill.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory_resource>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/small_blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// No point of a lattice is nearer to the boundary's points than this multiple of the size. A smaller clearance leaves
/// flat triangles along the boundary that refinement must mend, and a larger one leaves holes that refinement must
/// fill. See experiments.md, Lattices.
constexpr double kClearance = 0.8;
/// Sizes that differ by no more than this factor are treated as one size, their minimum.
constexpr double kEvenSpacing = 1.05;
/// The clearance of a lattice of one size that is stretched to fit. Every second row of the lattice ends half a column
/// from the side, which is allowed. The clearance is a multiple of the column, or of the size where columns are
/// narrower than kWideColumn sizes. In that case there are only one to three columns, and no points are needed between
/// them and the sides.
constexpr double kClearanceOfOneSize = 0.49;
constexpr double kWideColumn = 0.75;

/// The work grows with the number of cells. A region that is long and narrow, or where sizes change abruptly, has many
/// cells without a point of their own. A fill is given up if it would look at more cells than kFewCells, plus
/// kMaxCellsEach for each point that is allowed, for each point of the boundary and for each triangle, over the cost of
/// a look-up.
constexpr std::size_t kMaxCellsEach = 16;
constexpr std::size_t kFewCells = 256;
/// A fill with more cells would take minutes.
constexpr std::size_t kMaxCells = std::size_t{1} << 30;

/// Sorts points into square cells, to find out whether there is a point near a place.
class PointGrid {
 public:
  /// Input: The cells must be so large that their numbers fit into 32 bits.
  PointGrid(std::span<const Vec2> points, Vec2 origin, double cell, RunControl& control)
      : points_(points.begin(), points.end()), origin_(origin), cell_(cell) {
    sort_stoppable(points_.begin(), points_.end(), control, [&](Vec2 a, Vec2 b) { return key(a) < key(b); });
    keys_.reserve(points_.size());
    StopCheck check(control);
    for (const Vec2 p : points_) {
      check();
      keys_.push_back(key(p));
    }
  }

  /// Where sizes grow fast, the distance may be millions of cells, so the search visits only rows with points.
  bool has_point_within(Vec2 p, double distance) const {
    const Key low = key({p.x - distance, p.y - distance}), high = key({p.x + distance, p.y + distance});
    auto at = std::lower_bound(keys_.begin(), keys_.end(), low);
    while (at != keys_.end() && at->first <= high.first) {
      const std::int64_t row = at->first;
      at = std::lower_bound(at, keys_.end(), Key{row, low.second});
      for (; at != keys_.end() && at->first == row && at->second <= high.second; ++at) {
        const Vec2 d = points_[static_cast<std::size_t>(at - keys_.begin())] - p;
        if (dot(d, d) < distance * distance) return true;
      }
      at = std::lower_bound(at, keys_.end(), Key{row + 1, low.second});
    }
    return false;
  }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  Key key(Vec2 p) const { return {number((p.y - origin_.y) / cell_), number((p.x - origin_.x) / cell_)}; }
  static std::int64_t number(double cells) {
    constexpr double kBeyondAll = 0x1p60;
    return static_cast<std::int64_t>(std::floor(std::clamp(cells, -kBeyondAll, kBeyondAll)));
  }

  std::vector<Vec2> points_;
  Vec2 origin_;
  double cell_;
  std::vector<Key> keys_;
};

/// Summarises the sizes at the triangles: the edge of a lattice that suits most of them, and the smallest and largest
/// size.
struct Spacing {
  double best, smallest, largest;
};

/// A lattice and its halvings give each place the largest of their edges that is allowed there. This function returns
/// the coarsest lattice's edge with which all these lattices have the fewest points. It tries sizes that differ by a
/// 32nd of an octave.
Spacing best_spacing(std::span<const std::array<Vec2, 3>> triangles, const PlaneSizes& sizes, RunControl& control) {
  constexpr int kSteps = 32;
  std::array<double, kSteps> points{}, smallest{};
  double least_size = HUGE_VAL, largest = 0;
  StopCheck check(control);
  for (const auto& [a, b, c] : triangles) {
    check();
    const double size = sizes.at((1.0 / 3) * (a + b + c));
    int octave = 0;
    const double part = 2 * std::frexp(size, &octave);  // between 1 and 2
    const auto step = static_cast<std::size_t>(std::min(kSteps - 1.0, std::floor(kSteps * std::log2(part))));
    points[step] += cross(b - a, c - a) / (size * size);
    if (smallest[step] == 0 || part < smallest[step]) smallest[step] = part;
    least_size = std::min(least_size, size);
    largest = std::max(largest, size);
  }
  double best = 1, lowest_cost = HUGE_VAL;
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (smallest[i] == 0) continue;
    double cost = 0;
    for (std::size_t j = 0; j < kSteps; ++j) {
      if (smallest[j] == 0) continue;
      double ratio = smallest[j] / smallest[i];
      if (ratio < 1) ratio *= 2;
      cost += points[j] * ratio * ratio;
    }
    if (cost < lowest_cost) {
      lowest_cost = cost;
      best = smallest[i];
    }
  }
  return {best, least_size, largest};
}

/// A cell of one of the lattices is a parallelogram.
struct Cell {
  int level;
  double share;  ///< the cell's edge over the coarsest lattice's edge: 2^-level
  std::int64_t i, j;
  std::size_t first = 0, last = 0;  ///< the triangles that may reach into the cell: a range of `Cells::triangles`
};

/// Holds cells, and the triangles that may reach into each of them. The triangles of one cell follow those of the cell
/// before.
struct Cells {
  std::pmr::vector<Cell> cells;
  std::pmr::vector<std::uint32_t> triangles;

  explicit Cells(std::pmr::memory_resource* memory) : cells(memory), triangles(memory) {}
};

/// A relative slack for rounding, so that a width of ten sizes makes ten columns whatever its last digits are.
constexpr double kRelativeSlack = 1 - 1e-11;

/// Holds the vertices along the lower or the upper side of a region's box.
class SideRow {
 public:
  SideRow(std::span<const Vec2> vertices, Vec2 corner, double width, double size) : width_(width) {
    const double same = 1e-2 * size;
    for (const Vec2 p : vertices) {
      const Vec2 d = p - corner;
      if (std::fabs(d.y) > same) continue;
      const bool is_first = d.x < same;
      const bool is_last = d.x > width - same;
      has_first_ |= is_first;
      has_last_ |= is_last;
      // Corners fit any number of columns, so they are left out.
      if (!is_first && !is_last) inner_.push_back(d.x);
    }
  }

  /// Returns whether the row reaches from corner to corner.
  bool is_whole() const { return has_first_ && has_last_; }

  /// Returns the number of vertices without the corners.
  double inner_count() const { return static_cast<double>(inner_.size()); }

  /// Returns how the vertices lie relative to the columns: 1 if columns end at the vertices, -1 if they end half a
  /// column beside the vertices, and a value in between otherwise. A single vertex may lie anywhere.
  double phase(double columns) const {
    if (inner_.size() < 2) return 1;
    double sum = 0;
    for (const double x : inner_) sum += std::cos(2 * std::numbers::pi * columns * x / width_);
    return sum / inner_count();
  }

 private:
  double width_;
  std::vector<double> inner_;
  bool has_first_ = false, has_last_ = false;
};

/// These are limits for SideRow::phase(). Beyond kInStep, the row is in step with the columns. Below kBetween, its
/// vertices are nearer to the middles of columns than to their ends.
constexpr double kInStep = 0.9, kBetween = -0.5;
/// Columns are added if the number of additional points is at most this number of rows' points.
constexpr double kRowsOutOfStep = 1.2;

/// Walks through the cells of the lattices. Each cell has four children with half its edge.
class Lattice {
 public:
  Lattice(std::span<const std::array<Vec2, 3>> triangles, const PlaneSizes& sizes, RunControl& control)
      : sizes_(sizes), triangles_(triangles), control_(control), low_(triangles[0][0]) {
    Vec2 high = low_;
    for (const auto& triangle : triangles)
      for (const Vec2 p : triangle) {
        low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
    const Spacing spacing = best_spacing(triangles, sizes, control);
    is_even_ = sizes.is_uniform || spacing.largest <= kEvenSpacing * spacing.smallest;
    // The edge of the coarsest lattice is allowed at one place at least.
    edge_ = is_even_ ? spacing.smallest
                     : std::ldexp(spacing.best, std::ilogb(spacing.largest / spacing.best * (1 + 1e-12)));
    if (is_even_) edge_ *= 1 - sizes.noise;
    width_ = high.x - low_.x;
    height_ = high.y - low_.y;
    along_ = {edge_, 0};
    up_ = {edge_ / 2, edge_ * std::numbers::sqrt3 / 2};
    if (is_even_) fit_columns(std::ceil(width_ / edge_ * kRelativeSlack));
  }

  /// Fits the lattice to the vertices along the lower and the upper side of the box, so that the points of the lattice
  /// are in step with them. If the lattice has cells of several sizes, nothing changes.
  void match(std::span<const Vec2> vertices) {
    if (!is_even_) return;
    const SideRow lower(vertices, low_, width_, edge_), upper(vertices, low_ + Vec2{0, height_}, width_, edge_);
    const double columns = match_columns(lower), phase = lower.phase(columns);
    lean(lower.is_whole() && upper.is_whole(), phase, upper.phase(columns));
    if (phase < kBetween) low_.x -= along_.x / 2;
  }

  /// Returns a lower bound on the number of cells that reach into the region. It holds because the region is connected.
  double least_cells() const { return std::max(width_, height_) / edge_; }

  Vec2 origin() const { return low_; }
  double edge() const { return edge_; }
  /// Returns the smallest distance from the boundary at which a point may lie, if `size` is the size there.
  double clearance(double size) const {
    if (!is_even_) return kClearance * size;
    return kClearanceOfOneSize * (along_.x >= kWideColumn * edge_ ? along_.x : size);
  }

  /// Returns cells that together cover the region.
  Cells cover(std::pmr::memory_resource* memory) const {
    Cells all(memory), cover(memory);
    all.triangles.resize(triangles_.size());
    std::iota(all.triangles.begin(), all.triangles.end(), 0u);
    // The origin of the lattice is at the lower left corner of the box, or half a column to the left of it. Each row of
    // the lattice begins further to the right than the row below it. So there must also be cells to the left of the
    // origin: they cover the upper left part of the box.
    const double extent = 2 * std::max(width_, height_);
    const int levels_above = std::max(0, std::ilogb(extent / std::min(along_.x, up_.y)) + 1);
    const double share = std::ldexp(1.0, levels_above);
    for (const std::int64_t i : {-1, 0}) add({-levels_above, share, i, 0, 0, triangles_.size()}, all, cover);
    return cover;
  }

  /// Calls take(point) for the lattice point at the cell's corner, if there is one. Appends the cells into which this
  /// cell has to be divided to `parts`. `of` is the list that the cell is from; it may be the same object as `parts`.
  template <class Take>
  // cppcheck-suppress passedByValue ; a reference into `parts` would not outlive its growth
  void visit(const Cell cell, const Cells& of, Cells& parts, const Take& take) const {
    const double radius = cell.share * edge_;
    if (cell.level >= 0) {
      const Vec2 corner = place(cell, 0);
      const bool is_new = cell.level == 0 || cell.i % 2 != 0 || cell.j % 2 != 0;
      if (is_new && is_covered(corner, cell, of) &&
          (cell.level == 0 || !sizes_.allows(2 * radius * kAlmost, corner, 0)))
        take(corner);
      // The cell's edge is allowed at every place in the cell, so none of the children's points would be taken.
      if (sizes_.allows(radius * kAlmost, place(cell, 0.5), radius)) return;
    }
    for (const auto& [di, dj] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
      add({cell.level + 1, cell.share / 2, 2 * cell.i + di, 2 * cell.j + dj, cell.first, cell.last}, of, parts);
  }

 private:
  static constexpr double kAlmost = 1 - 1e-9;

  /// Sets the number of columns. The narrower the columns are, the higher the rows may be. A region that is narrower
  /// than one column is not fitted: along a needle, there would be far too many cells as thin as the needle.
  void fit_columns(double columns) {
    if (width_ > edge_) along_ = {width_ / columns, 0};
    const double highest = std::sqrt(edge_ * edge_ - along_.x * along_.x / 4);
    up_ = {along_.x / 2, height_ > highest ? height_ / std::ceil(height_ / highest * kRelativeSlack) : highest};
  }

  /// Makes as many columns as the lower side has pieces, if these are only a few more than the columns so far. Returns
  /// the number of columns.
  double match_columns(const SideRow& lower) {
    const double columns = std::round(width_ / along_.x), rows = std::max(1.0, std::round(height_ / up_.y));
    double best = columns;
    if (!lower.is_whole()) return best;
    // A row that is out of step with its side costs about one point too many for each column.
    const double max_pieces = columns * (1 + kRowsOutOfStep / rows);
    // If the columns are shifted, the pieces at both ends are half as long, so the side has one piece more.
    for (const double pieces : {lower.inner_count(), lower.inner_count() + 1})
      if (pieces > columns && pieces <= max_pieces && std::fabs(lower.phase(pieces)) > std::fabs(lower.phase(best)))
        best = pieces;
    if (best > columns) fit_columns(best);
    return best;
  }

  /// If the last row would be out of step with its side, all rows lean a little more, as long as there is room for
  /// that.
  void lean(bool are_whole, double phase_below, double phase_above) {
    if (!are_whole || !(std::fabs(phase_below) > kInStep && std::fabs(phase_above) > kInStep)) return;
    const double rows = std::max(1.0, std::round(height_ / up_.y));
    const bool is_odd = std::fmod(rows, 2) == 1, is_shifted = (phase_below < 0) != (phase_above < 0);
    const double x = along_.x * (0.5 + 0.5 / rows);
    if (is_odd != is_shifted && x * x + up_.y * up_.y <= edge_ * edge_) up_.x = x;
  }

  Vec2 place(const Cell& cell, double part) const {
    return low_ + (cell.share * (static_cast<double>(cell.i) + part)) * along_ +
           (cell.share * (static_cast<double>(cell.j) + part)) * up_;
  }

  /// Adds the cell, with those of its triangles that may reach into it. A cell without such a triangle is not added.
  void add(Cell cell, const Cells& of, Cells& to) const {
    const Vec2 centre = place(cell, 0.5);
    const double radius = cell.share * edge_;
    const std::size_t first = to.triangles.size();
    StopCheck check(control_);
    for (std::size_t k = cell.first; k < cell.last; ++k) {
      check();
      if (const std::uint32_t t = of.triangles[k]; !is_apart(triangles_[t], centre, radius)) to.triangles.push_back(t);
    }
    cell.first = first;
    cell.last = to.triangles.size();
    if (cell.first < cell.last) to.cells.push_back(cell);
  }

  bool is_covered(Vec2 p, const Cell& cell, const Cells& of) const {
    for (std::size_t k = cell.first; k < cell.last; ++k)
      if (is_inside(triangles_[of.triangles[k]], p)) return true;
    return false;
  }
  static bool is_inside(const std::array<Vec2, 3>& t, Vec2 p) {
    return cross(t[1] - t[0], p - t[0]) >= 0 && cross(t[2] - t[1], p - t[1]) >= 0 && cross(t[0] - t[2], p - t[2]) >= 0;
  }
  static bool is_apart(const std::array<Vec2, 3>& t, Vec2 centre, double radius) {
    // The boxes are compared first: a place far beyond the tip of a needle is not far outside any of its sides.
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    if (centre.x + radius < left || centre.x - radius > right || centre.y + radius < low || centre.y - radius > high)
      return true;
    for (int k = 0; k < 3; ++k) {
      const Vec2 side = t[(k + 1) % 3] - t[k];
      const double outside = -cross(side, centre - t[k]);
      if (outside > 0 && outside * outside > radius * radius * dot(side, side)) return true;
    }
    return false;
  }

  const PlaneSizes& sizes_;
  std::span<const std::array<Vec2, 3>> triangles_;
  RunControl& control_;
  Vec2 low_, along_, up_;
  double width_ = 0, height_ = 0, edge_ = 0;
  bool is_even_ = false;
};

}  // namespace

std::vector<Vec2> lattice_fill(std::span<const std::array<Vec2, 3>> triangles, std::span<const Vec2> boundary,
                               std::size_t vertex_count, const PlaneSizes& sizes, double shortest,
                               std::size_t max_points, RunControl& control) {
  const std::size_t cells_each = std::min(
      kMaxCells, kFewCells + kMaxCellsEach * (std::min(max_points, kMaxCells) + boundary.size() + triangles.size()));
  const auto max_cells = static_cast<std::size_t>(static_cast<double>(cells_each) / sizes.look_up_cost);
  Lattice lattice(triangles, sizes, control);
  // The test comes before any number becomes an integer, because the number of cells may be far too large for an
  // integer.
  if (!(lattice.least_cells() <= static_cast<double>(max_cells))) return {};
  lattice.match(boundary.first(vertex_count));
  const PointGrid grid(boundary, lattice.origin(), std::max(lattice.edge(), shortest), control);
  const auto is_near = [&](Vec2 p) {
    return grid.has_point_within(p, std::max(shortest, lattice.clearance(sizes.at(p))));
  };
  // The points found and the cells visited by all finished work.
  std::atomic<std::size_t> count = 0, cells = 0;
  // Adds the points that come from one cell.
  const auto collect = [&](const Cell& cell, const Cells& of, Cells& parts, std::vector<Vec2>& points) {
    // A cell may have thousands of triangles and sizes, so every cell checks for cancellation.
    control.check();
    lattice.visit(cell, of, parts, [&](Vec2 p) {
      if (!is_near(p)) points.push_back(p);
    });
  };

  // Cells are divided level by level until there are enough for all cores.
  constexpr std::size_t kEnough = 256;
  StackMemory memory;
  std::vector<Vec2> points;
  Cells front = lattice.cover(&memory);
  while (!front.cells.empty() && front.cells.size() < kEnough && points.size() <= max_points) {
    cells += front.cells.size();
    Cells next(&memory);
    for (const Cell& cell : front.cells) collect(cell, front, next, points);
    front = std::move(next);
  }
  count = points.size();

  // From here on cells are divided depth first, so that few of them wait.
  const auto collect_below = [&](std::size_t first, std::size_t) {
    std::vector<Vec2> found;
    StackMemory memory_below;
    Cells waiting(&memory_below);
    collect(front.cells[first], front, waiting, found);
    std::size_t n = 0;
    for (; !waiting.cells.empty() && count + found.size() <= max_points && cells + n <= max_cells; ++n) {
      const Cell cell = waiting.cells.back();
      waiting.cells.pop_back();
      waiting.triangles.resize(cell.last);
      collect(cell, waiting, waiting, found);
    }
    count += found.size();
    cells += n;
    return found;
  };
  for (const auto& found : map_blocks<std::vector<Vec2>>(front.cells.size(), 1, control, collect_below))
    points.insert(points.end(), found.begin(), found.end());
  if (count > max_points || cells > max_cells) return {};
  sort_stoppable(points.begin(), points.end(), control);
  return points;
}

}  // namespace remesh
