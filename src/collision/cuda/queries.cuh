// SPDX-License-Identifier: Apache-2.0
// Batches of queries: from host memory to the kernel that answers them and back, a warp per query.
#pragma once

#include <algorithm>
#include <span>

#include "collision/cuda/node_stack.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The next query for the calling warp: some take a thousand times as long as others.
STANDOFF_DEVICE std::uint32_t take_query(std::uint32_t* next) {
  std::uint32_t n = 0;
  if (lane_in_warp() == 0) n = atomicAdd(next, std::uint32_t{1});
  return __shfl_sync(kWarp, n, 0);
}

/// Answers queries until none is left, a warp each: its search of a task, a query and the warp's shared memory.
template <class Search, class Task, class Shared>
STANDOFF_DEVICE void answer_queries(const Task& task, Shared* shared) {
  for (;;) {
    const std::uint32_t n = take_query(task.next);
    if (n >= task.count) return;
    const auto answer = Search(task, task.queries[n], shared[threadIdx.x / 32]).run();
    if (lane_in_warp() == 0) task.answers[n] = answer;
  }
}

/// Runs a kernel over queries on the current device. make_task gets queries, answers and a counter in device memory.
template <unsigned kThreads, class Task, class Query, class Answer, class MakeTask>
void run_queries(const char* label, void (*kernel)(Task), std::span<const Query> queries, std::span<Answer> answers,
                 MakeTask make_task) {
  const auto count = static_cast<std::int64_t>(queries.size());
  const auto query_bytes = static_cast<std::int64_t>(queries.size_bytes()),
             answer_bytes = static_cast<std::int64_t>(answers.size_bytes());
  const Memory query_memory(query_bytes), answer_memory(answer_bytes), next(sizeof(std::uint32_t));
  copy_in(query_memory.as<void>(), queries.data(), query_bytes);
  fill_bytes(nullptr, next.as<void>(), 0, sizeof(std::uint32_t));
  const Task task = make_task(query_memory.as<Query>(), answer_memory.as<Answer>(), static_cast<std::uint32_t>(count),
                              next.as<std::uint32_t>());
  constexpr std::int64_t kWarps = kThreads / 32;
  launch(nullptr, label, kernel, std::min<std::int64_t>(kManyBlocks, (count + kWarps - 1) / kWarps), kThreads, task);
  copy_out(answers.data(), answer_memory.as<void>(), answer_bytes);
}

}  // namespace standoff::STANDOFF_PLATFORM
