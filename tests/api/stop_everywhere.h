// SPDX-License-Identifier: Apache-2.0
// Stops work at each of its reports.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "standoff/error.h"
#include "standoff/progress.h"

namespace standoff::testing {

/// Stops `work` at its first report, then at its second, and so on, until it comes to its end. Returns how often.
inline int stop_everywhere(const std::function<void(const ProgressCallback&)>& work) {
  for (int at = 1;; ++at) {
    int reports = 0;
    double last = 0;
    try {
      work([&](const Progress& now) {
        EXPECT_GE(now.fraction, last);
        last = now.fraction;
        return ++reports < at;
      });
      EXPECT_EQ(last, 1);
      return at - 1;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::interrupted) throw;
      EXPECT_EQ(reports, at);
    }
    if (at > 10000) return at;
  }
}

}  // namespace standoff::testing
