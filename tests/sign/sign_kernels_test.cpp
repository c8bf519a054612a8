// SPDX-License-Identifier: Apache-2.0
// Kernels of the sign for each instruction set against plain loops: winding numbers along rows, and negation.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "sign/cpu/kernels.h"
#include "sign/signs.h"
#include "simd/dispatch.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

template <class Use>
void for_each_set(const Use& use) {
  for (const Simd simd : {Simd::avx512, Simd::avx2, Simd::portable})
    if (processor_has(simd)) use(dispatch_of<cpu::SignKernels>().of(simd, "sign"), static_cast<int>(simd));
}

// Steps in some tiles, of which some rows come back to 0 and some do not.
TEST(SignKernels, MarkInside) {
  constexpr std::size_t kTiles = 9, kRows = 64;
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    std::vector<std::int8_t> steps(kRows * 8 * kTiles);
    std::vector<std::uint8_t> is_stepped(kTiles);
    const bool returns = n % 2 == 0;
    for (std::uint32_t pairs = random.below(40); pairs > 0; --pairs) {
      const std::size_t row = random.below(kRows), from = random.below(8 * kTiles), to = random.below(8 * kTiles);
      steps[kRows * from + row] = static_cast<std::int8_t>(steps[kRows * from + row] + 1);
      is_stepped[from / 8] = 1;
      if (!returns && pairs % 3 == 0) continue;
      steps[kRows * to + row] = static_cast<std::int8_t>(steps[kRows * to + row] - 1);
      is_stepped[to / 8] = 1;
    }
    for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd}) {
      std::vector<std::uint8_t> expected(kRows * kTiles);
      for (std::size_t row = 0; row < kRows; ++row) {
        std::int32_t winding = 0;
        for (std::size_t i = 0; i < 8 * kTiles; ++i) {
          winding += steps[kRows * i + row];
          if (is_inside(winding, rule)) expected[kRows * (i / 8) + row] |= static_cast<std::uint8_t>(1 << i % 8);
        }
      }
      for_each_set([&](const cpu::SignKernels& kernels, int set) {
        auto own_steps = steps;
        auto own_stepped = is_stepped;
        std::vector<std::uint8_t> inside(kRows * kTiles);
        const auto [first, end] =
            kernels.mark_inside(own_steps.data(), own_stepped.data(), kTiles, rule, inside.data());
        EXPECT_EQ(inside, expected) << "set " << set;
        EXPECT_EQ(own_steps, std::vector<std::int8_t>(steps.size()));
        EXPECT_EQ(own_stepped, std::vector<std::uint8_t>(kTiles));
        for (std::size_t at = 0; at < inside.size(); ++at)
          if (const auto tile = static_cast<std::int64_t>(at / kRows); tile < first || tile >= end) {
            EXPECT_EQ(inside[at], 0) << "tile " << tile << " of " << first << " to " << end;
          }
      });
    }
  }
}

// Zero stays zero, and what is behind the last value stays as it is.
TEST(SignKernels, Negate) {
  Random random(2);
  for (std::int64_t count = 0; count < 70; ++count) {
    std::vector<float> values;
    std::vector<std::uint8_t> inside;
    for (int n = 0; n < 80; ++n) values.push_back(static_cast<float>(random.below(4)));
    for (int n = 0; n < 10; ++n)
      inside.push_back(static_cast<std::uint8_t>(random.below(3) == 0 ? random.below(256) : 0));
    std::vector<std::uint32_t> expected;
    for (std::size_t n = 0; n < values.size(); ++n) {
      const bool changes = static_cast<std::int64_t>(n) < count && (inside[n / 8] >> n % 8 & 1) != 0 && values[n] != 0;
      expected.push_back(std::bit_cast<std::uint32_t>(changes ? -values[n] : values[n]));
    }
    for_each_set([&](const cpu::SignKernels& kernels, int set) {
      auto own = values;
      kernels.negate(inside.data(), count, own.data());
      std::vector<std::uint32_t> bits;
      for (const float value : own) bits.push_back(std::bit_cast<std::uint32_t>(value));
      EXPECT_EQ(bits, expected) << count << " values, set " << set;
    });
  }
}

}  // namespace
}  // namespace standoff::testing
