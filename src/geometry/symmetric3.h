// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of symmetric 3x3 matrices.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace standoff {

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Leaves the eigenvalues on the diagonal of m, and the eigenvectors in the columns of v: Jacobi's rotations.
inline void diagonalise(Matrix3& m, Matrix3& v) {
  v = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr int kMostSweeps = 12;  // five are enough, as each one squares the rest
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    const double off = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
    const double on = m[0][0] * m[0][0] + m[1][1] * m[1][1] + m[2][2] * m[2][2];
    if (off <= 1e-32 * on) return;
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double kp = m[k][p], kq = m[k][q];
          m[k][p] = c * kp - s * kq;
          m[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double pk = m[p][k], qk = m[q][k];
          m[p][k] = c * pk - s * qk;
          m[q][k] = s * pk + c * qk;
          const double vp = v[k][p], vq = v[k][q];
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
  }
}

}  // namespace standoff
