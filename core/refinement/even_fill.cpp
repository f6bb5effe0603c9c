#include "core/refinement/even_fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace remesh {
namespace {

/// No point of the lattice is nearer to the boundary's points than this, in sizes. Smaller, and the rim gets flat
/// triangles that refinement must mend; larger, and it gets holes that refinement must fill.
constexpr double kClearance = 0.6;

/// The boundary's points by cells of one size, to ask what is near.
class PointGrid {
 public:
  PointGrid(std::vector<Vec2> points, Vec2 origin, double cell)
      : points_(std::move(points)), origin_(origin), cell_(cell) {
    std::sort(points_.begin(), points_.end(), [&](Vec2 a, Vec2 b) { return key(a) < key(b); });
    keys_.reserve(points_.size());
    for (const Vec2 p : points_) keys_.push_back(key(p));
  }

  bool has_point_within(Vec2 p, double distance) const {
    const auto [row, column] = key(p);
    for (std::int64_t r = row - 1; r <= row + 1; ++r) {
      auto at = std::lower_bound(keys_.begin(), keys_.end(), Key{r, column - 1});
      for (; at != keys_.end() && at->first == r && at->second <= column + 1; ++at) {
        const Vec2 d = points_[static_cast<std::size_t>(at - keys_.begin())] - p;
        if (dot(d, d) < distance * distance) return true;
      }
    }
    return false;
  }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  Key key(Vec2 p) const {
    return {static_cast<std::int64_t>(std::floor((p.y - origin_.y) / cell_)),
            static_cast<std::int64_t>(std::floor((p.x - origin_.x) / cell_))};
  }

  std::vector<Vec2> points_;
  Vec2 origin_;
  double cell_;
  std::vector<Key> keys_;
};

}  // namespace

std::vector<Vec2> even_fill(std::span<const std::array<Vec2, 2>> pieces, double size, RunControl& control) {
  Vec2 low = pieces[0][0], high = low;
  std::vector<Vec2> rim;
  for (const auto& [a, b] : pieces) {
    low = {std::min(low.x, a.x), std::min(low.y, a.y)};
    high = {std::max(high.x, a.x), std::max(high.y, a.y)};
    rim.push_back(a);
    rim.push_back(0.5 * (a + b));
  }
  const double rows = std::ceil((high.y - low.y) / (size * std::numbers::sqrt3 / 2));
  const double columns = std::ceil((high.x - low.x) / size);
  const double row_height = (high.y - low.y) / rows, step = (high.x - low.x) / columns;

  // Where the rows meet the boundary.
  struct Crossing {
    std::int64_t row;
    double x;
    bool operator<(const Crossing& other) const { return row != other.row ? row < other.row : x < other.x; }
  };
  std::vector<Crossing> crossings;
  for (const auto& [a, b] : pieces) {
    const Vec2 from = a.y <= b.y ? a : b, to = a.y <= b.y ? b : a;
    // A row at exactly a point's height meets the piece above it only.
    auto row = static_cast<std::int64_t>(std::ceil((from.y - low.y) / row_height));
    for (; low.y + static_cast<double>(row) * row_height < to.y; ++row) {
      const double y = low.y + static_cast<double>(row) * row_height;
      if (y < from.y) continue;
      crossings.push_back({row, from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x)});
    }
  }
  std::sort(crossings.begin(), crossings.end());

  const PointGrid grid(std::move(rim), low, size);
  std::vector<Vec2> points;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    if (i % 256 == 0) control.check();
    const Crossing &in = crossings[i], &out = crossings[i + 1];
    if (in.row != out.row) break;  // rounding has lost one: better no more points than wrong ones
    const double y = low.y + static_cast<double>(in.row) * row_height;
    const double shift = in.row % 2 == 0 ? 0 : 0.5;
    for (double column = std::ceil((in.x - low.x) / step - shift); low.x + (column + shift) * step < out.x; ++column) {
      const Vec2 p{low.x + (column + shift) * step, y};
      if (p.x > in.x && !grid.has_point_within(p, kClearance * size)) points.push_back(p);
    }
  }
  return points;
}

}  // namespace remesh
