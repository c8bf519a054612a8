// SPDX-License-Identifier: Apache-2.0
#include "surface/qef.h"

#include <cmath>
#include <limits>

namespace standoff {
namespace {

using QefRow = std::array<double, 3>;
using Matrix = std::array<QefRow, 3>;

QefRow row_of(Vec3 v) { return {v.x, v.y, v.z}; }

// Eigenvalues on the diagonal of m, eigenvectors in the columns of v: Jacobi's rotations.
void diagonalise(Matrix& m, Matrix& v) {
  v = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr int kMostSweeps = 12;  // five are enough, for each one squares what is left
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

// Solves the equations of the coordinates that are free; the others keep their values. Positive definite.
QefRow solve_free(const Matrix& m, const QefRow& right, QefRow x, unsigned free) {
  Matrix a{};
  QefRow b{};
  std::array<std::size_t, 3> index{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if ((free >> i & 1) != 0) index[n++] = i;
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = right[index[i]];
    for (std::size_t j = 0; j < 3; ++j)
      if ((free >> j & 1) == 0) b[i] -= m[index[i]][j] * x[j];
    for (std::size_t j = 0; j < n; ++j) a[i][j] = m[index[i]][index[j]];
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k][i] / a[i][i];
      for (std::size_t j = i; j < n; ++j) a[k][j] -= factor * a[i][j];
      b[k] -= factor * b[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    double sum = b[i];
    for (std::size_t j = i + 1; j < n; ++j) sum -= a[i][j] * x[index[j]];
    x[index[i]] = sum / a[i][i];
  }
  return x;
}

// The least value of a positive definite form in a box: of all faces, edges and corners, the best point that is in the
// box. `x` are coordinates relative to the mass point.
QefRow least_in_box(const Matrix& m, const QefRow& right, const QefRow& low, const QefRow& high) {
  QefRow best{};
  double least = std::numeric_limits<double>::infinity();
  for (unsigned sides = 0; sides < 27; ++sides) {
    QefRow x{};
    unsigned free = 0;
    for (unsigned i = 0, rest = sides; i < 3; ++i, rest /= 3) {
      if (rest % 3 == 0) free |= 1u << i;
      x[i] = rest % 3 == 1 ? low[i] : rest % 3 == 2 ? high[i] : 0;
    }
    x = solve_free(m, right, x, free);
    bool in_box = true;
    double value = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      in_box &= x[i] >= low[i] && x[i] <= high[i];
      value -= 2 * right[i] * x[i];
      for (std::size_t j = 0; j < 3; ++j) value += x[i] * m[i][j] * x[j];
    }
    if (in_box && value < least) {
      least = value;
      best = x;
    }
  }
  return best;
}

}  // namespace

void PlaneFit::add(Vec3 point, Vec3 normal) {
  if (count_++ == 0) first_ = point;
  sum_ = sum_ + point;
  normal_sum_ = normal_sum_ + normal;
  const double at = dot(normal, point - first_);
  right_ = right_ + normal * at;
  normals_[0] += normal.x * normal.x;
  normals_[1] += normal.x * normal.y;
  normals_[2] += normal.x * normal.z;
  normals_[3] += normal.y * normal.y;
  normals_[4] += normal.y * normal.z;
  normals_[5] += normal.z * normal.z;
}

Vec3 PlaneFit::minimum(const Box& box, double tolerance) const {
  const Vec3 mass = mass_point();
  const QefRow offset = row_of(mass - first_);
  const auto& a = normals_;
  const Matrix m{{{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}}};
  QefRow right = row_of(right_);  // about the mass point
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) right[i] -= m[i][j] * offset[j];
  // The sum of the two lesser eigenvalues is at most that of the squared deviations from the mean normal. Where it
  // counts as 0 the planes are parallel, as nearly everywhere on smooth surfaces, and no eigenvalue is needed.
  const double trace = a[0] + a[3] + a[5], along_mean = dot(normal_sum_, normal_sum_) / count_;
  if (trace - along_mean <= tolerance * along_mean) {
    const QefRow direction = row_of(normal_sum_ * (1 / std::sqrt(along_mean * count_)));
    double rise = 0, slope = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      rise += direction[i] * right[i];
      for (std::size_t k = 0; k < 3; ++k) slope += direction[i] * m[i][k] * direction[k];
    }
    const Vec3 found = mass + normal_sum_ * (rise / slope / std::sqrt(along_mean * count_));
    if (max(found, box.min) == found && min(found, box.max) == found) return found;
  }
  Matrix values = m, vectors;
  diagonalise(values, vectors);
  const double largest = std::max({values[0][0], values[1][1], values[2][2]});
  if (!(largest > 0)) return mass;
  QefRow x{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (values[k][k] <= tolerance * largest) continue;
    double along = 0;
    for (std::size_t i = 0; i < 3; ++i) along += vectors[i][k] * right[i];
    for (std::size_t i = 0; i < 3; ++i) x[i] += vectors[i][k] * along / values[k][k];
  }
  const QefRow low = row_of(box.min - mass), high = row_of(box.max - mass);
  bool in_box = true;
  for (std::size_t i = 0; i < 3; ++i) in_box &= x[i] >= low[i] && x[i] <= high[i];
  if (!in_box) {
    // The same with a weak pull to the mass point in place of the cut, so that there is one minimum in the box.
    constexpr double kPull = 0.01;
    Matrix pulled = m;
    for (std::size_t i = 0; i < 3; ++i) pulled[i][i] += kPull * tolerance * largest;
    x = least_in_box(pulled, right, low, high);
  }
  return mass + Vec3{x[0], x[1], x[2]};
}

}  // namespace standoff
