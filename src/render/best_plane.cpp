// SPDX-License-Identifier: Apache-2.0
#include "render/best_plane.h"

#include <algorithm>
#include <cmath>

#include "core/tile_count.h"

namespace standoff {
namespace {

constexpr double kUnit = 256;          // a whole number for each share: sums do not depend on their order
constexpr double kNearlyAsMuch = 0.9;  // such planes compete for the middle
constexpr double kFarthest = 3;        // samples count up to so many spacings from the surface,
constexpr double kNearestShare =
    1.0 / 3.0;  // and from this share of that on: nearer ones see the kink of unsigned fields

std::array<std::int64_t, 3> coordinates(const Size3& s) { return {s.x, s.y, s.z}; }

// A tile's samples that count, each added to its three planes.
class ShownCounter {
 public:
  ShownCounter(const DistanceField& field, PlaneScores& scores)
      : size_(coordinates(field.grid().size)),
        spacing_{field.grid().spacing.x, field.grid().spacing.y, field.grid().spacing.z},
        scores_(scores) {
    far_ = std::min(field.thickness(), kFarthest * std::max({spacing_[0], spacing_[1], spacing_[2]}));
  }

  void add(const DistanceField::Tile& tile) {
    first_ = coordinates(tile.at);
    for (std::size_t c = 0; c < 3; ++c) {
      first_[c] *= kTileSide;
      last_[c] = static_cast<int>(std::min<std::int64_t>(kTileSide, size_[c] - first_[c])) - 1;
    }
    for (int n = 0; n < DistanceField::kTileSamples; ++n) {
      const double distance = std::abs(static_cast<double>(tile.values[static_cast<std::size_t>(n)]));
      if (distance >= kNearestShare * far_ && distance < far_)
        add(tile.values, {n % kTileSide, n / kTileSide % kTileSide, n / (kTileSide * kTileSide)});
    }
  }

 private:
  void add(DistanceField::TileValues values, const std::array<int, 3>& at) {
    constexpr std::array<int, 3> kStride{1, kTileSide, kTileSide * kTileSide};
    const int index = at[0] + kTileSide * at[1] + kTileSide * kTileSide * at[2];
    std::array<double, 3> squared{};
    for (std::size_t c = 0; c < 3; ++c) {
      if (at[c] > last_[c]) return;  // beyond the grid
      const int before = std::max(at[c] - 1, 0) - at[c], after = std::min(at[c] + 1, last_[c]) - at[c];
      if (before == after) continue;
      const auto value = [&](int steps) {
        return static_cast<double>(values[static_cast<std::size_t>(index + steps * kStride[c])]);
      };
      const double slope = (value(after) - value(before)) / ((after - before) * spacing_[c]);
      squared[c] = slope * slope;
    }
    const double sum = squared[0] + squared[1] + squared[2];
    if (!(sum > 0) || !std::isfinite(sum)) return;
    for (std::size_t c = 0; c < 3; ++c)
      scores_.along[c][static_cast<std::size_t>(first_[c] + at[c])] += std::llround(kUnit * (1 - squared[c] / sum));
  }

  std::array<std::int64_t, 3> size_, first_{};
  std::array<double, 3> spacing_;
  std::array<int, 3> last_{};
  double far_ = 0;
  PlaneScores& scores_;
};

}  // namespace

PlaneScores plane_scores(const DistanceField& field) {
  const auto& [size, origin, h] = field.grid();
  PlaneScores scores;
  scores.area = {h.y * h.z, h.x * h.z, h.x * h.y};
  for (std::size_t c = 0; c < 3; ++c) scores.along[c].resize(static_cast<std::size_t>(coordinates(size)[c]));
  ShownCounter counter(field, scores);
  for (const DistanceField::Tile& tile : field.tiles()) counter.add(tile);
  return scores;
}

std::int64_t best_plane(const std::vector<std::int64_t>& scores) {
  const std::int64_t most = *std::ranges::max_element(scores);
  if (most == 0) return -1;
  const auto shows = [](std::int64_t score) { return score > 0; };
  const auto first = std::ranges::find_if(scores, shows) - scores.begin();
  const auto end = std::find_if(scores.rbegin(), scores.rend(), shows).base() - scores.begin();
  const std::int64_t twice_middle = first + end - 1;
  std::int64_t best = -1;
  for (std::int64_t n = 0; n < std::ssize(scores); ++n) {
    if (static_cast<double>(scores[static_cast<std::size_t>(n)]) < kNearlyAsMuch * static_cast<double>(most)) continue;
    if (best < 0 || std::abs(2 * n - twice_middle) < std::abs(2 * best - twice_middle)) best = n;
  }
  return best;
}

}  // namespace standoff
