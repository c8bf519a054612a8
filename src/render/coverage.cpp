// SPDX-License-Identifier: Apache-2.0
// After the accumulation buffer of font-rs (Levien 2016): each line adds the area to its right.
#include "render/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace standoff {

Coverage::Coverage(int width, int height)
    : width_(width),
      height_(height),
      changes_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height)) {}

void Coverage::add_line(double x0, double y0, double x1, double y1) {
  if (y0 == y1) return;
  const double sign = y0 < y1 ? 1 : -1;
  if (sign < 0) {
    std::swap(x0, x1);
    std::swap(y0, y1);
  }
  const double slope = (x1 - x0) / (y1 - y0);
  const double top = std::max(y0, 0.0), bottom = std::min(y1, static_cast<double>(height_));
  for (double y = top; y < bottom;) {
    const double row = std::floor(y), next = std::min(row + 1, bottom);
    add_in_row(static_cast<int>(row), x0 + (y - y0) * slope, x0 + (next - y0) * slope, sign * (next - y));
    y = next;
  }
}

// A piece within a row: cut where it passes from one pixel to the next.
void Coverage::add_in_row(int row, double x0, double x1, double height) {
  if (x0 > x1) std::swap(x0, x1);
  const double left = std::clamp(x0, 0.0, static_cast<double>(width_)),
               right = std::clamp(x1, 0.0, static_cast<double>(width_));
  double* changes = changes_.data() + static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(row);
  const double per_x = x1 > x0 ? height / (x1 - x0) : 0;
  // What lies left of the window covers all of it; what lies right of it, nothing.
  if (x0 >= width_) return;
  changes[0] += x1 <= 0 ? height : (left - x0) * per_x;
  if (x1 <= 0) return;
  if (left == right) {
    const auto pixel = static_cast<int>(left);
    const double share = left - pixel;
    changes[pixel] += height * (1 - share);
    changes[pixel + 1] += height * share;
    return;
  }
  for (double x = left; x < right;) {
    const double pixel = std::floor(x), next = std::min(pixel + 1, right);
    const double part = (next - x) * per_x, share = (x + next) / 2 - pixel;
    changes[static_cast<int>(pixel)] += part * (1 - share);
    changes[static_cast<int>(pixel) + 1] += part * share;
    x = next;
  }
}

std::vector<float> Coverage::shares() const {
  std::vector<float> shares;
  shares.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int row = 0; row < height_; ++row) {
    const double* change = changes_.data() + static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(row);
    double covered = 0;
    for (int x = 0; x < width_; ++x)
      shares.push_back(static_cast<float>(std::min(1.0, std::abs(covered += change[x]))));
  }
  return shares;
}

}  // namespace standoff
