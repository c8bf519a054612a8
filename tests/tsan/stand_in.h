// SPDX-License-Identifier: Apache-2.0
// What standoff uses of TBB, made of std::thread, for builds under the thread sanitizer alone: Debian's libtbb is not
// built for it, so that it sees no task begin after the one that made it, and takes nearly every use of the result for
// a race. Here all order between threads is by thread starts and joins, which it sees. Races of our own loop bodies are
// found; those of TBB itself, and of our use of its schedulers, are not.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace tbb {

struct split {};

namespace stand_in {

// Threads that may be started, all loops of the process together: loops within loops run on what is left.
inline constexpr int kHelpers = 3;
inline std::atomic<bool> taken[kHelpers];
inline thread_local bool alone = false;  // inside an arena of one thread
inline thread_local int place = 0;       // in the arena: the caller's, or one of the helpers'

// The place of a thread that may be started; 0 for none.
inline int take_place() {
  for (int n = 0; n < kHelpers; ++n)
    if (!taken[n].exchange(true)) return n + 1;
  return 0;
}

// task(0), ..., task(count - 1), side by side; the first exception is thrown again.
template <class Task>
void run(std::size_t count, const Task& task) {
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t n; (n = next.fetch_add(1, std::memory_order_relaxed)) < count;) task(n);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::pair<std::thread, int>> helpers;
  while (!alone && helpers.size() + 1 < count) {
    const int at = take_place();
    if (at == 0) break;
    helpers.emplace_back([&work, at] { place = at, work(); }, at);
  }
  work();
  for (auto& [helper, at] : helpers) {
    helper.join();
    taken[at - 1] = false;
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace stand_in

template <class Value>
class blocked_range {
 public:
  blocked_range(Value begin, Value end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
  Value begin() const { return begin_; }
  Value end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  bool empty() const { return !(begin_ < end_); }

  // Not for users: the part [n * step, (n + 1) * step), with at most 16 parts of no less than a grain.
  std::size_t parts() const { return empty() ? 0 : std::min<std::size_t>(16, (size() + grain_ - 1) / grain_); }
  blocked_range part(std::size_t n) const {
    const std::size_t count = parts();
    return {static_cast<Value>(begin_ + static_cast<Value>(size() * n / count)),
            static_cast<Value>(begin_ + static_cast<Value>(size() * (n + 1) / count)), grain_};
  }

 private:
  Value begin_, end_;
  std::size_t grain_;
};

struct simple_partitioner {};
struct auto_partitioner {};
struct static_partitioner {};

template <class Value, class Body, class... Partitioner>
void parallel_for(const blocked_range<Value>& range, const Body& body, const Partitioner&...) {
  stand_in::run(range.parts(), [&](std::size_t n) { body(range.part(n)); });
}

// A range of the caller's own: at most 16 parts of it.
template <class Range, class Body>
requires std::is_constructible_v<Range, Range&, split>
void parallel_for(const Range& range, const Body& body) {
  std::vector<Range> parts{range};
  for (std::size_t n = 0; n < parts.size() && parts.size() < 16;) {
    if (!parts[n].is_divisible()) {
      ++n;
      continue;
    }
    Range rest(parts[n], split{});
    parts.push_back(std::move(rest));
  }
  stand_in::run(parts.size(), [&](std::size_t n) { body(parts[n]); });
}

template <class Index, class Body>
requires std::is_integral_v<Index>
void parallel_for(Index first, Index last, const Body& body) {
  parallel_for(blocked_range<Index>(first, last), [&](const blocked_range<Index>& range) {
    for (Index n = range.begin(); n < range.end(); ++n) body(n);
  });
}

template <class Container, class Body>
void parallel_for_each(Container&& items, const Body& body) {
  std::vector<std::decay_t<decltype(*std::begin(items))>*> all;
  for (auto& item : items) all.push_back(const_cast<std::decay_t<decltype(item)>*>(&item));
  stand_in::run(all.size(), [&](std::size_t n) { body(*all[n]); });
}

template <class... Functions>
void parallel_invoke(const Functions&... functions) {
  std::vector<void (*)(const void*)> calls{[](const void* f) { (*static_cast<const Functions*>(f))(); }...};
  const void* objects[] = {&functions...};
  stand_in::run(calls.size(), [&](std::size_t n) { calls[n](objects[n]); });
}

template <class Range, class Value, class Function, class Join>
requires std::is_invocable_v<const Function&, const Range&, Value> Value parallel_reduce(const Range& range,
                                                                                         const Value& identity,
                                                                                         const Function& function,
                                                                                         const Join& join) {
  struct Part {
    Value value;
  };
  std::vector<Part> found(range.parts(), Part{identity});  // a vector of bool would share words between threads
  stand_in::run(found.size(), [&](std::size_t n) { found[n].value = function(range.part(n), identity); });
  Value result = identity;
  for (const Part& part : found) result = join(result, part.value);
  return result;
}

template <class Range, class Value, class Function, class Join>
Value parallel_deterministic_reduce(const Range& range, const Value& identity, const Function& function,
                                    const Join& join) {
  return parallel_reduce(range, identity, function, join);
}

template <class Range, class Body, class... Partitioner>
requires std::is_constructible_v<Body, Body&, split>
void parallel_reduce(const Range& range, Body& body, const Partitioner&...) {
  std::vector<std::unique_ptr<Body>> bodies;
  for (std::size_t n = 0; n < range.parts(); ++n) bodies.push_back(std::make_unique<Body>(body, split{}));
  stand_in::run(bodies.size(), [&](std::size_t n) { (*bodies[n])(range.part(n)); });
  for (const auto& part : bodies) body.join(*part);
}

template <class Iterator, class... Compare>
void parallel_sort(Iterator begin, Iterator end, const Compare&... compare) {
  std::sort(begin, end, compare...);
}

template <class Container, class Compare>
requires requires(Container& items) { items.begin(); }
void parallel_sort(Container& items, const Compare& compare) { std::sort(items.begin(), items.end(), compare); }

class task_arena {
 public:
  static constexpr int automatic = -1;
  explicit task_arena(int threads = automatic) : threads_(threads) {}
  int max_concurrency() const { return threads_; }
  template <class Function>
  auto execute(const Function& function) {
    struct Restore {
      bool before = std::exchange(stand_in::alone, false);
      ~Restore() { stand_in::alone = before; }
    } restore;
    stand_in::alone = threads_ == 1;
    return function();
  }

 private:
  int threads_;
};

// Nobody asks for more than whether there is one.
namespace task {
inline const void* current_context() { return nullptr; }
}  // namespace task

namespace this_task_arena {
inline int max_concurrency() { return 1 + stand_in::kHelpers; }
inline int current_thread_index() { return stand_in::place; }
template <class Function>
auto isolate(const Function& function) {
  return function();
}
}  // namespace this_task_arena

// How many threads there are is not this stand-in's to change.
struct global_control {
  enum Parameter { max_allowed_parallelism, thread_stack_size };
  global_control(Parameter, std::size_t) {}
  static std::size_t active_value(Parameter) { return 1 + stand_in::kHelpers; }
};

template <class Value>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() = default;
  template <class Make>
  requires std::is_invocable_r_v<Value, const Make&>
  explicit enumerable_thread_specific(const Make& make) : make_([make] { return std::make_unique<Value>(make()); }) {}

  Value& local() {
    const std::lock_guard lock(mutex_);
    auto& value = values_[std::this_thread::get_id()];
    if (!value) value = make_ ? make_() : std::make_unique<Value>();
    return *value;
  }
  template <class Use>
  void combine_each(const Use& use) {
    for (auto& [thread, value] : values_) use(*value);
  }
  struct iterator {
    typename std::map<std::thread::id, std::unique_ptr<Value>>::iterator at;
    Value& operator*() const { return *at->second; }
    iterator& operator++() {
      ++at;
      return *this;
    }
    bool operator==(const iterator&) const = default;
  };
  iterator begin() const { return {values_.begin()}; }
  iterator end() const { return {values_.end()}; }

 private:
  std::function<std::unique_ptr<Value>()> make_;
  std::mutex mutex_;
  mutable std::map<std::thread::id, std::unique_ptr<Value>> values_;
};

}  // namespace tbb
