// gpu-check, first part: every kernel on this machine's GPU against the same kernels emulated on the CPU, bit for bit,
// and against distances by definition in double precision. Small grids; scripts run it under compute-sanitizer too.
//
// check [--quick]: prints a line per case and how many were wrong; exit code 0 where none was.
// Built as plain C++ it checks itself: the emulation takes the GPU's part.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>

#include "difi/error.h"
#include "scenes/scenes.h"
#include "tests/gpu/field_on_device.cuh"
#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"

namespace difi {
namespace {

struct Case {
  std::string name;
  Mesh mesh;
  Grid grid;
  double thickness;
};

/// The field from the emulated kernels: host memory is their device memory.
struct Reference {
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  cuda::Outcome outcome;
};

struct alignas(256) Aligned {
  char bytes[256];
};

Reference emulate(const Case& c, Method method) {
  const auto samples = static_cast<std::size_t>(c.grid.sample_count());
  Reference r{std::vector<float>(samples), std::vector<std::uint32_t>(samples), {}};
  cuda::Task task;
  task.mesh = {&c.mesh.vertices.data()->x, static_cast<std::int64_t>(c.mesh.vertices.size()),
               c.mesh.triangles.data()->data(), static_cast<std::int64_t>(c.mesh.triangles.size())};
  task.grid = c.grid;
  task.thickness = c.thickness;
  task.method = method;
  task.output = {r.values.data(), r.nearest.data(), nullptr, 0};
  task.outcome = &r.outcome;
  std::int64_t entries = cuda::likely_entries(task.mesh.triangle_count, c.grid, c.thickness, method);
  do {
    const std::int64_t bytes =
        emulated::workspace_bytes(task.mesh.triangle_count, c.grid, c.thickness, method, entries);
    std::vector<Aligned> workspace(static_cast<std::size_t>(bytes) / sizeof(Aligned) + 1);
    emulated::enqueue(task, workspace.data(), bytes);
    entries *= 4;
  } while (r.outcome.stopped != 0 && r.outcome.bad_triangle == cuda::Outcome::kNone);
  cuda::check(r.outcome, task);
  return r;
}

template <class T>
std::int64_t different(const std::vector<T>& a, const std::vector<T>& b) {
  std::int64_t count = a.size() != b.size();
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) count += std::memcmp(&a[n], &b[n], sizeof(T)) != 0;
  return count;
}

/// Samples beyond the promised error, of about `most` tried. Requires a method without a skip rule.
std::int64_t inexact(const Case& c, const std::vector<float>& values, std::int64_t most) {
  const std::int64_t samples = c.grid.sample_count(), step = std::max<std::int64_t>(1, samples / most) | 1;
  std::int64_t wrong = 0;
  for (std::int64_t n = 0; n < samples; n += step) {
    const Size3& s = c.grid.size;
    const Vec3 p = c.grid.position(n % s.x, n / s.x % s.y, n / (s.x * s.y));
    const double expected = std::min(testing::reference_distance(c.mesh, p), c.thickness);
    wrong += !(std::abs(values[static_cast<std::size_t>(n)] - expected) <= testing::promised_error(c.grid, expected));
  }
  return wrong;
}

int run(const Case& c, Method method) {
  using namespace DIFI_PLATFORM;
  const char* const method_name = method == Method::thesis ? "thesis" : "tiles";
  const Reference reference = emulate(c, method);
  int faults = 0;
  for (const Layout layout : {Layout::dense, Layout::sparse}) {
    FieldOnDevice field(c.mesh, c.grid, c.thickness, method, layout, true);
    const cuda::Outcome outcome = field.run();
    const std::vector<float> values = field.values();
    const std::int64_t in_values = different(values, reference.values),
                       in_nearest = different(field.nearest(), reference.nearest),
                       off = method == Method::tiles && layout == Layout::dense ? inexact(c, values, 200) : 0;
    const bool good =
        in_values == 0 && in_nearest == 0 && off == 0 && outcome.samples_band == reference.outcome.samples_band;
    std::printf("%-6s %-7s %-6s %-28s thickness %-9.4g %lld values and %lld nearest triangles differ, %lld inexact\n",
                good ? "ok" : "WRONG", method_name, layout == Layout::dense ? "dense" : "sparse", c.name.c_str(),
                c.thickness, static_cast<long long>(in_values), static_cast<long long>(in_nearest),
                static_cast<long long>(off));
    std::fflush(stdout);
    faults += !good;
  }
  return faults;
}

std::vector<Case> cases(bool quick) {
  std::vector<Case> all;
  const auto add = [&all](std::string name, Mesh mesh, const Grid& grid) {
    for (const double spacings : {1.5, 6.0, std::numeric_limits<double>::infinity()})
      all.push_back({name, mesh, grid, spacings * grid.max_spacing()});
  };
  const Grid grid{{27, 22, 19}, {-6, -5, -4.5}, {0.5, 0.45, 0.5}};
  add("nasty soup", testing::nasty_soup(71, 60, 6), grid);
  if (quick) return all;
  add("short triangles", testing::random_soup(72, 400, 6, 0.6), grid);
  add("long triangles", testing::random_soup(73, 12, 8, 20), grid);
  add("a crowded tile", testing::random_soup(74, 900, 0.7, 0.5), grid);
  const Vec3 far{1e6, -3e5, 77};
  Grid there = grid;
  there.origin = there.origin + far;
  add("far from the origin", testing::random_soup(75, 100, 6, 2, far), there);
  for (const scenes::Scene& scene : scenes::all()) {
    const Mesh mesh = scenes::make(scene.name, std::min<std::int64_t>(scene.triangles, 1000));
    add(scene.name, mesh, fit_samples(bounds(mesh), 24, 0));
  }
  return all;
}

/// Wrong input must be said, and leave everything usable.
int run_faults() {
  using namespace DIFI_PLATFORM;
  const Grid grid{{9, 9, 9}, {-2, -2, -2}, {0.5, 0.5, 0.5}};
  Mesh mesh = testing::random_soup(76, 20, 2, 1);
  mesh.triangles[7][1] = 4000000000u;
  int faults = 1;
  try {
    FieldOnDevice(mesh, grid, 1, Method::tiles, Layout::dense, false).run();
  } catch (const Error& error) {
    faults = error.code() != ErrorCode::input;
  }
  std::printf("%-6s a triangle with an index out of range is named\n", faults ? "WRONG" : "ok");
  return faults;
}

int run_all(bool quick) {
  int faults = run_faults(), count = 1;
  for (const Case& c : cases(quick)) {
    for (const Method method : {Method::tiles, Method::thesis}) {
      faults += run(c, method);
      count += 2;
    }
  }
  std::printf("%d of %d checks went wrong\n", faults, count);
  return faults == 0 ? 0 : 7;
}

}  // namespace
}  // namespace difi

int main(int argc, char** argv) {
  try {
    return difi::run_all(argc > 1 && std::string(argv[1]) == "--quick");
  } catch (const difi::Error& error) {
    std::fprintf(stderr, "check: error: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
