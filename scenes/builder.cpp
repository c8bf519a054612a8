// SPDX-License-Identifier: Apache-2.0
#include "scenes/builder.h"

#include <algorithm>
#include <utility>

#include "scenes/random.h"

namespace standoff::scenes {
namespace {

constexpr double kMostPieces = 4096;  // per direction: bounds the work of a wrong request

int pieces(double wanted, int least) { return std::max(least, static_cast<int>(std::min(wanted + 0.5, kMostPieces))); }

}  // namespace

Builder::Builder(double edge, bool counting, double slender, double paired_share)
    : edge_(edge), counting_(counting), slender_(slender), paired_share_(paired_share) {
  choose_order();
}

int Builder::segments(double length, int least) const { return pieces(length / (edge_ * slender_), least); }

int Builder::sides(double radius, int least) const {
  const double wanted = 2 * kPi * radius / edge_;
  // A prism of four sides is the coarsest stand-in for a circle; `least` holds once a quarter of it is asked for.
  return pieces(wanted, std::clamp(static_cast<int>(4 * wanted), 4, least));
}

void Builder::stitch(Ring a, Ring b) {
  const int n = std::max(a.count, b.count);
  const int quads = n - (a.closed && b.closed ? 0 : 1);
  if (counting_) {
    count_only((a.count == 1 || b.count == 1 ? 1 : 2) * std::int64_t{quads});
    return;
  }
  for (int i = 0; i < quads; ++i) {
    const auto here = static_cast<std::uint32_t>(i);
    const auto next = static_cast<std::uint32_t>(i + 1 == n ? 0 : i + 1);
    if (a.count == 1) {
      triangle(a.first, b.first + next, b.first + here);
    } else if (b.count == 1) {
      triangle(a.first + here, a.first + next, b.first);
    } else {
      quad(a.first + here, a.first + next, b.first + next, b.first + here);
    }
  }
  end_row();
}

void Builder::end_row() {
  constexpr std::size_t kMany = 6;  // fewer would put a quadrilateral's halves next to each other
  if (seconds_.size() >= kMany) flush();
}

void Builder::end_part() {
  flush();
  ++part_;
  choose_order();
}

void Builder::flush() {
  mesh_.triangles.insert(mesh_.triangles.end(), seconds_.begin(), seconds_.end());
  seconds_.clear();
}

void Builder::choose_order() { paired_ = uniform(0x9a1f, part_) < paired_share_; }

Mesh Builder::take() {
  flush();
  return std::move(mesh_);
}

}  // namespace standoff::scenes
