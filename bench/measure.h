// SPDX-License-Identifier: Apache-2.0
// Time and memory of one job, repeated in one process.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace standoff::bench {

inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// The bytes of a line of /proc/self/status that counts kilobytes; 0 if the system has no such file.
inline std::int64_t process_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != key + ":") continue;
    std::int64_t kilobytes = 0;
    status >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

/// Resets the peak to the memory in use now, so that loading the mesh does not count.
inline void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

struct Measured {
  double cold = 0;           ///< seconds of the first call
  std::vector<double> warm;  ///< seconds of the others
  double cold_cpu = 0;       ///< the same of all processors together
  std::vector<double> warm_cpu;
  std::int64_t bytes_before = 0, bytes_peak = 0;  ///< resident: before the first call, and at most during it

  void write(nlohmann::json& line) const {
    line["cold_s"] = cold;
    line["warm_s"] = median(warm);
    line["cold_cpu_s"] = cold_cpu;
    line["warm_cpu_s"] = median(warm_cpu);
    line["calls"] = 1 + warm.size();
    line["memory_before"] = bytes_before;
    line["memory_peak"] = bytes_peak;
  }
};

/// Seconds since its construction: of the wall clock, and of all processors for this process.
class Clock {
 public:
  double wall() const { return now() - wall_; }
  double processor() const { return processor_now() - processor_; }

 private:
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  static double processor_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  double wall_ = now(), processor_ = processor_now();
};

/// Calls `job` `repeats` times and returns its last result. Results are freed between calls, outside the timing. After
/// `enough` seconds there is no further call, unless it is 0.
template <class Job>
auto measure(int repeats, Measured& measured, Job&& job, double enough = 0) {
  std::optional<decltype(job())> result;
  double spent = 0;
  forget_peak();
  measured.bytes_before = process_bytes("VmRSS");
  for (int call = 0; call < repeats && !(enough > 0 && spent > enough); ++call) {
    result.reset();
    const Clock clock;
    result.emplace(job());
    const double seconds = clock.wall(), processor = clock.processor();
    spent += seconds;
    if (call == 0) {
      measured.cold = seconds;
      measured.cold_cpu = processor;
      measured.bytes_peak = process_bytes("VmHWM");
    } else {
      measured.warm.push_back(seconds);
      measured.warm_cpu.push_back(processor);
    }
  }
  return std::move(*result);
}

/// The medians of several calls of `job`, under NAME_s and NAME_cpu_s.
inline void measure_calls(int repeats, const std::string& name, nlohmann::json& line,
                          const std::function<void()>& job) {
  std::vector<double> on_wall, of_processors;
  for (int call = 0; call < repeats; ++call) {
    const Clock clock;
    job();
    on_wall.push_back(clock.wall());
    of_processors.push_back(clock.processor());
  }
  line[name + "_s"] = median(on_wall);
  line[name + "_cpu_s"] = median(of_processors);
}

}  // namespace standoff::bench
