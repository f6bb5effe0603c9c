#include "core/geometry/planes/plane_fit.h"

#include <algorithm>
#include <cmath>

namespace remesh {

void PointMoments::add(const Vec3& p) {
  count += 1;
  sum += p;
  const std::array<double, 6> terms{p.x * p.x, p.x * p.y, p.x * p.z, p.y * p.y, p.y * p.z, p.z * p.z};
  for (std::size_t i = 0; i < terms.size(); ++i) products[i] += terms[i];
}

void PointMoments::merge(const PointMoments& other) {
  count += other.count;
  sum += other.sum;
  for (std::size_t i = 0; i < products.size(); ++i) products[i] += other.products[i];
}

PrincipalAxes principal_axes(const PointMoments& moments) {
  const Vec3 m = moments.mean();
  const auto& s = moments.products;
  const double n = moments.count;
  double a[3][3] = {{s[0] / n - m.x * m.x, s[1] / n - m.x * m.y, s[2] / n - m.x * m.z},
                    {s[1] / n - m.x * m.y, s[3] / n - m.y * m.y, s[4] / n - m.y * m.z},
                    {s[2] / n - m.x * m.z, s[4] / n - m.y * m.z, s[5] / n - m.z * m.z}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int kSweeps = 12;  // convergence is quadratic: five or six are enough
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1 / (std::fabs(theta) + std::sqrt(theta * theta + 1)), theta);
        const double c = 1 / std::sqrt(t * t + 1), sn = t * c;
        for (auto& row : a) {
          const double x = row[p], y = row[q];
          row[p] = c * x - sn * y;
          row[q] = sn * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - sn * y;
          a[q][k] = sn * x + c * y;
        }
        for (auto& row : v) {
          const double x = row[p], y = row[q];
          row[p] = c * x - sn * y;
          row[q] = sn * x + c * y;
        }
      }
    }
  }
  PrincipalAxes result;
  for (int i = 0; i < 3; ++i) {
    result.axes[i] = {v[0][i], v[1][i], v[2][i]};
    result.squares[i] = a[i][i];
  }
  return result;
}

PlaneFit fit_plane(const PointMoments& moments) {
  const auto [axes, squares] = principal_axes(moments);
  const auto least = static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
  return {normalized(axes[least]), std::sqrt(std::max(0.0, squares[least]))};
}

}  // namespace remesh
