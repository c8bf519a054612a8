// SPDX-License-Identifier: Apache-2.0
// Which kernels are chosen, of those that are compiled and those that this processor can run.
#include <gtest/gtest.h>

#include <string>

#include "simd/dispatch.h"

namespace standoff::testing {
namespace {

struct Kernels {
  int lanes;
};
constexpr Kernels kFour{4}, kEight{8}, kSixteen{16};

Dispatch<Kernels> all_sets() {
  return Dispatch<Kernels>({{Simd::avx512, &kSixteen}, {Simd::avx2, &kEight}, {Simd::portable, &kFour}});
}

TEST(Dispatch, GivesTheSetAskedForWhereTheProcessorHasIt) {
  const Dispatch<Kernels> kernels = all_sets();
  EXPECT_EQ(&kernels.of(Simd::portable, "test"), &kFour);
  if (processor_has(Simd::avx2)) {
    EXPECT_EQ(&kernels.of(Simd::avx2, "test"), &kEight);
  }
  if (processor_has(Simd::avx512)) {
    EXPECT_EQ(&kernels.of(Simd::avx512, "test"), &kSixteen);
  }
}

TEST(Dispatch, AutomaticIsTheBestTheProcessorHas) {
  const Dispatch<Kernels> kernels = all_sets();
  const Kernels* const best = processor_has(Simd::avx512) ? &kSixteen : processor_has(Simd::avx2) ? &kEight : &kFour;
  EXPECT_EQ(&kernels.best(), best);
  EXPECT_EQ(&kernels.of(Simd::automatic, "test"), best);
}

TEST(Dispatch, ListsWhatTheProcessorCanRunBestFirst) {
  const Dispatch<Kernels> kernels = all_sets();
  ASSERT_EQ(kernels.all().size(), 1u + processor_has(Simd::avx2) + processor_has(Simd::avx512));
  EXPECT_EQ(kernels.all().front(), &kernels.best());
  EXPECT_EQ(kernels.all().back(), &kFour);
}

// As on a processor that lacks the set: there is no row of it that could be run.
TEST(Dispatch, RefusesASetThatCannotRun) {
  const Dispatch<Kernels> kernels({{Simd::portable, &kFour}});
  EXPECT_EQ(&kernels.best(), &kFour);
  for (const Simd set : {Simd::avx2, Simd::avx512}) {
    try {
      kernels.of(set, "compute");
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_EQ(std::string(error.what()).rfind("compute: ", 0), 0u) << error.what();
    }
  }
}

}  // namespace
}  // namespace standoff::testing
