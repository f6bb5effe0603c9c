#include "core/geometry/trees/split_by_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/largest_coordinate.h"
#include "core/base/symmetric_eigen.h"

namespace remesh {
namespace {

/// If there are more triangles, the direction is found from about this many of them.
constexpr std::size_t kShapeSamples = 64;

/// The number of triangles between two checks for cancellation.
constexpr std::size_t kItemsBetweenChecks = 1 << 16;

void add_product(Matrix<3>& sum, const Vec3& v, double weight = 1) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum[i][j] += weight * (v[i] * v[j]);
}

/// Sums from which the covariance of vectors follows.
class Covariance {
 public:
  explicit Covariance(const Vec3& first) : first_(first) {}
  void add(const Vec3& v) {
    add_product(products_, v - first_);
    sum_ += v - first_;
    ++count_;
  }
  Matrix<3> get() const {
    Matrix<3> result = products_;
    add_product(result, sum_, -1 / count_);
    return result;
  }

 private:
  Vec3 first_, sum_;
  Matrix<3> products_{};
  double count_ = 0;
};

Vec3 times(const Matrix<3>& rows, const Vec3& v) {
  Vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = rows[i][0] * v.x + rows[i][1] * v.y + rows[i][2] * v.z;
  return result;
}

/// A direction, and by how much more vectors vary along it than triangles are long.
struct Direction {
  double ratio = 0;
  Vec3 along;
};

/// Returns the power of two that brings the largest coordinate of the items to about 1. Without it, squares of squares
/// of lengths may overflow.
double scale_of(std::span<const ShapedItem> items) {
  double largest = 0;
  for (const ShapedItem& item : items)
    largest = std::max({largest, largest_coordinate(item.centre), largest_coordinate(item.reach)});
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, -std::clamp(exponent, -1000, 1000));
}

/// Finds the direction in which the vectors with this covariance vary most, in a frame in which triangles are equally
/// long in all directions. The rows of `whitened` are the axes of that frame.
Direction widest_direction(const Matrix<3>& whitened, const Matrix<3>& covariance) {
  Matrix<3> seen{};
  for (int i = 0; i < 3; ++i) {
    const Vec3 row = times(covariance, Vec3{whitened[i][0], whitened[i][1], whitened[i][2]});
    for (int j = 0; j < 3; ++j) seen[i][j] = row.x * whitened[j][0] + row.y * whitened[j][1] + row.z * whitened[j][2];
  }
  const Eigen<3> eigen = symmetric_eigen(seen);
  Direction widest{eigen.values[2], {}};
  for (int i = 0; i < 3; ++i)
    widest.along += eigen.vectors[2][i] * Vec3{whitened[i][0], whitened[i][1], whitened[i][2]};
  return widest;
}

}  // namespace

Vec3 place_of(const Triangle& face, std::span<const Vec3> positions) {
  return (2.0 / 3) * (positions[face[0].value] + positions[face[1].value] + positions[face[2].value]);
}

Vec3 reach_of(const Triangle& face, std::span<const Vec3> positions) {
  Vec3 longest;
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 side = positions[face[(i + 1) % 3].value] - positions[face[i].value];
    const double length = norm(side);
    if (!(length > most)) continue;
    most = length;
    longest = side;
  }
  int largest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::fabs(longest[axis]) > std::fabs(longest[largest])) largest = axis;
  return longest[largest] < 0 ? -longest : longest;
}

void split_by_shape(std::span<ShapedItem> items, std::size_t middle, RunControl& control) {
  control.check();
  const std::size_t step = std::max<std::size_t>(1, items.size() / kShapeSamples);
  const double scale = scale_of(items);
  Covariance places(scale * items[0].centre), reaches(scale * items[0].reach);
  Matrix<3> lengths{};
  for (std::size_t i = 0; i < items.size(); i += step) {
    const Vec3 reach = scale * items[i].reach;
    places.add(scale * items[i].centre);
    reaches.add(reach);
    add_product(lengths, reach);
  }
  // Twice a centre is compared with a whole length, so both have the same scale. A direction in which all triangles are
  // narrow counts as if they were a millionth as wide there as they are long, so that rounding is not taken for
  // distance.
  constexpr double kNarrow = 0x1p-40;
  Eigen<3> eigen = symmetric_eigen(lengths);
  const double smallest = kNarrow * eigen.values[2];
  Direction by_place, by_reach;
  if (smallest > 0) {
    for (int i = 0; i < 3; ++i)
      for (double& x : eigen.vectors[i]) x /= std::sqrt(std::max(smallest, eigen.values[i]));
    by_place = widest_direction(eigen.vectors, places.get());
    // A direction in which the sides differ little separates nothing, even if all sides are short there.
    const Eigen<3> of_reach = symmetric_eigen(reaches.get());
    by_reach.along = {of_reach.vectors[2][0], of_reach.vectors[2][1], of_reach.vectors[2][2]};
    by_reach.ratio = of_reach.values[2] / std::max(smallest, dot(by_reach.along, times(lengths, by_reach.along)));
  }
  const bool is_by_place = by_place.ratio >= by_reach.ratio;
  const Vec3 along = is_by_place ? by_place.along : by_reach.along;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i % kItemsBetweenChecks == 0) control.check_and_move();
    items[i].key = dot(along, scale * (is_by_place ? items[i].centre : items[i].reach));
  }
  std::uint32_t comparisons = 0;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [&](const ShapedItem& a, const ShapedItem& b) {
                     if (++comparisons % kItemsBetweenChecks == 0) control.check_and_move();
                     return a.key != b.key ? a.key < b.key : a.face < b.face;
                   });
}

}  // namespace remesh
