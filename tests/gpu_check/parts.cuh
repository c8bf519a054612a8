// SPDX-License-Identifier: Apache-2.0
// Fields with parts left out, to see what these cost (Table 5.4 of the thesis).
#pragma once

#include <string>

#include "tests/gpu_check/field_on_device.cuh"
#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// A job's output that leaves parts out, and what to put on the stream for it.
struct Part {
  const char* output;
  void (*enqueue)(const Task&, void*, std::int64_t, Stream);
};
inline constexpr Part kParts[] = {
    {"through_lists", enqueue_until<StopAfter::lists>}, {"through_set_up", enqueue_until<StopAfter::set_up>},
    {"through_rows", enqueue_until<StopAfter::rows>},   {"through_distance", enqueue_until<StopAfter::distance>},
    {"through_read", enqueue_until<StopAfter::read>},   {"write_always", enqueue_until<StopAfter::always>},
};

/// The part of that name, or null.
inline const Part* find_part(const std::string& output) {
  for (const Part& part : kParts)
    if (part.output == output) return &part;
  return nullptr;
}

}  // namespace standoff::STANDOFF_PLATFORM
