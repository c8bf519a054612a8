// SPDX-License-Identifier: Apache-2.0
// The same query many times, spread over threads.
#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/threads.h"
#include "standoff/error.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// Throws Error{usage} that names the first pose that is not rigid.
inline void validate_all(std::span<const Pose> poses) {
  for (std::size_t n = 0; n < poses.size(); ++n) try {
      validate(poses[n]);
    } catch (const Error& error) {
      throw Error(error.code(), std::string(error.what()) + " (pose " + std::to_string(n) + ")", error.details());
    }
}

/// The results of query(0) to query(count - 1), in this order. Queries are handed out in small groups: some take a
/// thousand times as long as others.
template <class Result, class Query>
std::vector<Result> for_each(std::size_t count, int threads, Query query) {
  std::vector<Result> results(count);
  if (count == 1) {
    results[0] = query(0);
    return results;
  }
  Threads(threads).run([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) results[n] = query(n);
    });
  });
  return results;
}

}  // namespace standoff::collision
