// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

// The lattice points on the surface of a box, numbered as they are met, so that faces share their edges.
class BoxSurface {
 public:
  BoxSurface(Builder& b, const Frame& f, Vec3 low, Vec3 high, std::array<int, 3> pieces)
      : b_(b),
        f_(f),
        low_(low),
        step_((high - low) / Vec3{double(pieces[0]), double(pieces[1]), double(pieces[2])}),
        pieces_(pieces),
        ids_(std::size_t(pieces[0] + 1) * (pieces[1] + 1) * (pieces[2] + 1), kNone) {}

  // The face where axis `fixed` is at its low or high end; its rows run along axis `u`, counterclockwise with `v`.
  void face(int fixed, bool high, int u, int v) {
    std::array<int, 3> at{};
    at[fixed] = high ? pieces_[fixed] : 0;
    const auto corner = [&](int i, int j) {
      at[u] = i;
      at[v] = j;
      return id(at);
    };
    for (int j = 0; j < pieces_[v]; ++j) {
      for (int i = 0; i < pieces_[u]; ++i) {
        // In braces: corners are numbered in this order whatever the compiler.
        const std::array ids{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
        b_.quad(ids[0], ids[1], ids[2], ids[3]);
      }
      b_.end_row();
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::uint32_t id(const std::array<int, 3>& at) {
    auto& id = ids_[at[0] + std::size_t(pieces_[0] + 1) * (at[1] + std::size_t(pieces_[1] + 1) * at[2])];
    if (id == kNone) id = b_.vertex(f_(low_ + step_ * Vec3{double(at[0]), double(at[1]), double(at[2])}));
    return id;
  }

  Builder& b_;
  const Frame& f_;
  Vec3 low_, step_;
  std::array<int, 3> pieces_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace

void box(Builder& b, const Frame& f, Vec3 low, Vec3 high) {
  const Vec3 extent = high - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double shortest = std::min({extent.x, extent.y, extent.z});
  if (b.hides(longest, extent.x + extent.y + extent.z - longest - shortest)) return;
  const std::array<int, 3> n{b.segments(extent.x), b.segments(extent.y), b.segments(extent.z)};
  if (b.counting()) {
    const std::int64_t x = n[0], y = n[1], z = n[2];
    b.count_only(4 * (x * y + y * z + z * x));
  } else {
    BoxSurface surface(b, f, low, high, n);
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      surface.face(axis, false, v, u);
      surface.face(axis, true, u, v);
    }
  }
  b.end_part();
}

void beam(Builder& b, const Frame& f, Vec3 from, Vec3 to, double width, double height) {
  box(b, f * along(from, to), {-width / 2, 0, -height / 2}, {width / 2, length(to - from), height / 2});
}

}  // namespace standoff::scenes
