/// Eigenvalues and eigenvectors of small symmetric matrices.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace remesh {

template <std::size_t N>
using Matrix = std::array<std::array<double, N>, N>;

template <std::size_t N>
struct Eigen {
  std::array<double, N> values;  ///< ascending
  Matrix<N> vectors;             ///< vectors[i] belongs to values[i], and has unit length
};

/// Decomposes a symmetric matrix.
/// Cost:   O(N^3) for each of some ten sweeps.
/// Source: C. G. J. Jacobi's method, with rotations row by row: Golub, Van Loan, Matrix Computations, section 8.5.
template <std::size_t N>
Eigen<N> symmetric_eigen(Matrix<N> a) {
  Matrix<N> v{};
  for (std::size_t i = 0; i < N; ++i) v[i][i] = 1;
  constexpr int kMaxSweeps = 12;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off = 0, size = 0;
    for (std::size_t i = 0; i < N; ++i) {
      size += a[i][i] * a[i][i];
      for (std::size_t j = i + 1; j < N; ++j) off += a[i][j] * a[i][j];
    }
    if (!(off > 1e-26 * size)) break;
    for (std::size_t p = 0; p < N; ++p)
      for (std::size_t q = p + 1; q < N; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < N; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < N; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
        for (std::size_t k = 0; k < N; ++k) {
          const double kp = v[k][p], kq = v[k][q];
          v[k][p] = c * kp - s * kq;
          v[k][q] = s * kp + c * kq;
        }
      }
  }
  std::array<std::size_t, N> order;
  for (std::size_t i = 0; i < N; ++i) {
    std::size_t at = i;
    for (; at > 0 && a[order[at - 1]][order[at - 1]] > a[i][i]; --at) order[at] = order[at - 1];
    order[at] = i;
  }
  Eigen<N> result;
  for (std::size_t i = 0; i < N; ++i) {
    result.values[i] = a[order[i]][order[i]];
    for (std::size_t k = 0; k < N; ++k) result.vectors[i][k] = v[k][order[i]];
  }
  return result;
}

/// Solves a x = b for a symmetric positive matrix by Cholesky decomposition without roots.
/// Output: false if the matrix is not positive up to rounding.
template <std::size_t N>
bool solve_symmetric(Matrix<N> a, std::array<double, N>& b, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) {
    const double diagonal = a[j][j];
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k] * a[k][k];
    if (!(a[j][j] > 1e-15 * diagonal)) return false;
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
  for (std::size_t i = 0; i < n; ++i) b[i] /= a[i][i];
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
  return true;
}

}  // namespace remesh
