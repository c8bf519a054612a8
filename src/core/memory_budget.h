// SPDX-License-Identifier: Apache-2.0
// Counts the bytes that a call holds, against the limit that its caller set.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/field_bytes.h"
#include "standoff/error.h"

namespace standoff {

/// May be used by many threads at once.
class MemoryBudget {
 public:
  /// `limit`: bytes; 0 is none. `where` begins its errors, and `what_to_do` ends them.
  MemoryBudget(const char* where, std::int64_t limit, const char* what_to_do)
      : where_(where), what_to_do_(what_to_do), limit_(limit) {}

  /// To be called before so many bytes are allocated. Throws Error{limit} where they are too many.
  void take(std::size_t bytes) {
    const std::int64_t needed =
        held_.fetch_add(static_cast<std::int64_t>(bytes), std::memory_order_relaxed) + static_cast<std::int64_t>(bytes);
    if (limit_ == 0 || needed <= limit_) return;
    const auto all = static_cast<double>(needed), limit = static_cast<double>(limit_);
    throw Error(ErrorCode::limit,
                std::string(where_) + ": the memory limit is too low: it needs " + over_the_limit(all, limit) + "; " +
                    what_to_do_,
                {.bytes_needed = needed, .bytes_limit = limit_});
  }
  void give_back(std::size_t bytes) noexcept {
    held_.fetch_sub(static_cast<std::int64_t>(bytes), std::memory_order_relaxed);
  }

 private:
  const char *where_, *what_to_do_;
  std::int64_t limit_;
  std::atomic<std::int64_t> held_{0};
};

/// What is held for as long as this lives.
class MemoryShare {
 public:
  explicit MemoryShare(MemoryBudget& budget) : budget_(budget) {}
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;
  ~MemoryShare() { budget_.give_back(bytes_); }

  void take(std::size_t bytes) {
    bytes_ += bytes;
    budget_.take(bytes);
  }
  MemoryBudget& budget() { return budget_; }

 private:
  MemoryBudget& budget_;
  std::size_t bytes_ = 0;
};

}  // namespace standoff
