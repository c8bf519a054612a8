// SPDX-License-Identifier: Apache-2.0
// What one core of this machine can do at most of the three things that every distance field needs: write samples, read
// triangles, and measure a sample's distance to a triangle.
#include <cstddef>
#include <numeric>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "driver.h"
#include "geometry/triangle_frame.h"
#include "measure.h"

namespace {

using namespace standoff;

// Much larger than the caches.
constexpr std::size_t kBytes = std::size_t{256} << 20;

// The least seconds of a call; the first call, which touches memory for the first time, does not count.
double least_seconds(int repeats, const std::function<void()>& job) {
  job();
  double least = 1e300;
  for (int call = 0; call < repeats; ++call) {
    const bench::Clock clock;
    job();
    least = std::min(least, clock.processor());
  }
  return least;
}

double write_seconds(int repeats) {
  std::vector<float> memory(kBytes / sizeof(float));
  float value = 0;
  return least_seconds(repeats, [&] { std::fill(memory.begin(), memory.end(), ++value); });
}

double read_seconds(int repeats, std::size_t& sum) {
  const std::vector<std::size_t> memory(kBytes / sizeof(std::size_t), 1);
  return least_seconds(repeats, [&] { sum += std::accumulate(memory.begin(), memory.end(), std::size_t{0}); });
}

// Seconds for a sample, in rows along x as in a brick: all that a kernel does for a sample but find the triangle.
double measure_seconds(int repeats, float& sum) {
  constexpr int kRow = 4096, kRows = 256;
  const TriangleFrame<float> f =
      make_frame(Triple<float>{0.3f, 0.1f, 0.2f}, {1.9f, 0.4f, 0.1f}, {0.8f, 1.7f, 0.6f}, 1e-12f);
  std::vector<float> x(kRow), best(kRow, 1e30f);
  for (int n = 0; n < kRow; ++n) x[static_cast<std::size_t>(n)] = static_cast<float>(n % 16) - 7.5f;
  const float* const along = x.data();
  float* const out = best.data();
  const double seconds = least_seconds(repeats, [&] {
    for (int row = 0; row < kRows; ++row) {
      const float y = 0.5f * static_cast<float>(row % 16) - 3;
      const float q0 = y * f.q.g.y + f.q.c, y0 = y * f.y.g.y + f.y.c, z0 = y * f.z.g.y + f.z.c;
      for (int n = 0; n < kRow; ++n)
        out[n] = min(out[n], frame_distance_sq(f, fma(along[n], f.q.g.x, q0), fma(along[n], f.y.g.x, y0),
                                               fma(along[n], f.z.g.x, z0)));
    }
  });
  sum += std::accumulate(best.begin(), best.end(), 0.0f);
  return seconds / (double{kRow} * kRows);
}

struct Options {
  int repeats = 9;
  explicit Options(CLI::App& app) {
    app.add_option("--repeats", repeats, "calls of each, of which the quickest counts");
  }
  int make() const { return repeats; }
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("what one core can do at most", "bench_limits");
  const Options options(app);
  return bench::run_driver(app, options, argc, argv, [](int repeats) {
    std::size_t read = 0;
    float measured = 0;
    nlohmann::json line;
    line["write_s_per_byte"] = write_seconds(repeats) / double{kBytes};
    line["read_s_per_byte"] = read_seconds(repeats, read) / double{kBytes};
    line["measure_s"] = measure_seconds(repeats, measured);
    line["sums"] = {read, measured};  // so that no work is left out
    return line;
  });
}
